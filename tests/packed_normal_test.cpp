#include "limn/packed_normal.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limn::test {
namespace {

double degrees_between(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    double sum = 0, cross = 0;
    for (size_t k = 0; k < 3; ++k) {
        const size_t i = (k + 1) % 3, j = (k + 2) % 3;
        sum += double{a[k]} * double{b[k]};
        cross += std::pow(double{a[i]} * double{b[j]} - double{a[j]} * double{b[i]}, 2);
    }
    return std::atan2(std::sqrt(cross), sum) * 180 / 3.14159265358979323846;
}

/// All over the sphere, poles, equator and octant borders included.
TEST(PackedNormals, AreOffByFourThousandths) {
    double worst = 0;
    for (int i = 0; i <= 360; ++i)
        for (int j = 0; j < 720; ++j) {
            const double theta = i * 3.14159265358979323846 / 360, phi = j * 3.14159265358979323846 / 360;
            const std::array<float, 3> n = {static_cast<float>(std::sin(theta) * std::cos(phi)),
                                            static_cast<float>(std::sin(theta) * std::sin(phi)),
                                            static_cast<float>(std::cos(theta))};
            const auto back = unpack_normal(pack_normal(n));
            worst = std::max(worst, degrees_between(n, back));
            ASSERT_NEAR(std::hypot(back[0], back[1], back[2]), 1, 1e-6);
        }
    EXPECT_LT(worst, 0.004);
    EXPECT_GT(worst, 0.001);  // 16 bits are not more
}

TEST(PackedNormals, AxesAreExact) {
    for (int k = 0; k < 3; ++k)
        for (const float sign : {-1.0f, 1.0f}) {
            std::array<float, 3> axis = {};
            axis[static_cast<size_t>(k)] = 5 * sign;  // of any length
            const auto back = unpack_normal(pack_normal(axis));
            for (size_t i = 0; i < 3; ++i) EXPECT_EQ(back[i], axis[i] / 5);
        }
    EXPECT_EQ(unpack_normal(0x80018001u), unpack_normal(0x80008000u));  // -32767 and -32768 are both -1
}

}  // namespace
}  // namespace limn::test
