// Vectors of three doubles.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace limn::test {

using Vector = std::array<double, 3>;

inline Vector operator-(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Vector& a) {
    return std::sqrt(dot(a, a));
}
inline Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector vector_at(std::span<const double> values, size_t i) {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}
// Angle between directions in degrees.
inline double angle(const Vector& a, const Vector& b) {
    return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

}  // namespace limn::test
