// Normals in one word, as kernels pack them (limn/shared/octahedral.h).
#pragma once

#include <array>
#include <cstdint>

namespace limn {

/// The unit vector that a word of two 16-bit signed normalised numbers (VK_FORMAT_R16G16_SNORM, the first in its low
/// half) stands for.
std::array<float, 3> unpack_normal(uint32_t word);

/// The word of a vector of any length but zero, the nearest one to within a rounding of each number.
uint32_t pack_normal(const std::array<float, 3>& normal);

}  // namespace limn
