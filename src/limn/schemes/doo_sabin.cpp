// Doo and Sabin 1978: generalises biquadratic B-splines. A boundary is a uniform quadratic B-spline of the boundary
// polygon (vertex doubling, Nasri 1987), which the surface meets with a vanishing cross derivative; with
// BoundaryInterpolation::none it shrinks by half a face a step.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {

double doo_sabin_weight(uint32_t n, uint32_t j) {
    static constexpr double quad[4] = {9.0 / 16, 3.0 / 16, 1.0 / 16, 3.0 / 16};  // what is below, without cosines
    if (n == 4) return quad[j];
    return j == 0 ? (n + 5.0) / (4.0 * n) : (3 + 2 * std::cos(2 * std::numbers::pi * j / n)) / (4.0 * n);
}

void doo_sabin_corner(const Topology& t, uint32_t corner, Row& row) {
    const uint32_t f = t.face_of_corner(corner), first = t.face_begin(f), n = t.size_of_face(f);
    for (uint32_t j = 0; j < n; ++j)
        add(row, t.face_vertices[first + (corner - first + j) % n], doo_sabin_weight(n, j));
}

namespace {

void corner_row(const Stage& p, uint32_t corner, Row& row) {
    doo_sabin_corner(p.topology, corner, row);
}

}  // namespace

std::span<const Pass> doo_sabin_passes() {
    static constexpr Pass passes[] = {
        {SplitKind::corners, {keep_vertex, nullptr, nullptr, corner_row, chaikin_edge_end}}};
    return passes;
}

}  // namespace limn::schemes
