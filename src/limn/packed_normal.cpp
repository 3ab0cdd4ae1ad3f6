#include "limn/packed_normal.h"

#include <algorithm>
#include <cmath>

#include "limn/shared/octahedral.h"

namespace limn {

std::array<float, 3> unpack_normal(uint32_t word) {
    auto number = [](uint32_t half) { return std::max(static_cast<int16_t>(half & 0xffff) / 32767.0, -1.0); };
    double n[3];
    shared::octahedral_direction(number(word), number(word >> 16), n);
    const double length = std::hypot(n[0], n[1], n[2]);
    return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length)};
}

uint32_t pack_normal(const std::array<float, 3>& normal) {
    double e[2];
    shared::octahedral_of(double{normal[0]}, double{normal[1]}, double{normal[2]}, e);
    auto half = [](double x) { return static_cast<uint16_t>(std::lround(x * 32767)); };
    return half(e[0]) | uint32_t{half(e[1])} << 16;
}

}  // namespace limn
