// Doo and Sabin 1978: generalises biquadratic B-splines. A boundary is a uniform quadratic B-spline of the boundary
// polygon (vertex doubling, Nasri 1987), which the surface meets with a vanishing cross derivative; with
// BoundaryInterpolation::none it shrinks by half a face a step.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

void corner_row(const Stage& p, uint32_t corner, Row& row) {
    const Topology& t = p.topology;
    const uint32_t f = t.face_of_corner(corner), first = t.face_begin(f), n = t.size_of_face(f);
    static constexpr double quad[4] = {9.0 / 16, 3.0 / 16, 1.0 / 16, 3.0 / 16};  // what is below, without cosines
    for (uint32_t j = 0; j < n; ++j) {
        const double weight = n == 4   ? quad[j]
                              : j == 0 ? (n + 5.0) / (4.0 * n)
                                       : (3 + 2 * std::cos(2 * std::numbers::pi * j / n)) / (4.0 * n);
        add(row, t.face_vertices[first + (corner - first + j) % n], weight);
    }
}

}  // namespace

std::span<const Pass> doo_sabin_passes() {
    static constexpr Pass passes[] = {
        {SplitKind::corners, {keep_vertex, nullptr, nullptr, corner_row, chaikin_edge_end}}};
    return passes;
}

}  // namespace limn::schemes
