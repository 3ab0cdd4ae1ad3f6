// The simplest scheme: Peters and Reif 1997, Habib and Warren 1999. New vertices are the midpoints of edges;
// two such steps are one of a corner cutting scheme, the Zwart-Powell box spline on regular meshes. Mid-edge
// boundaries shrink; those of the double steps are quadratic B-splines, as Doo-Sabin's.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

void corner_row(const Stage& p, uint32_t c, Row& row) {
    const Topology& t = p.topology;
    add(row, t.face_vertices[c], 0.5);
    add(row, end_vertex(t, c), 0.25);
    add(row, t.face_vertices[t.previous_corner(c)], 0.25);
}

/// The same at four sides; else all frequencies of the face beyond the first shrink as they do there.
void normalised_corner_row(const Stage& p, uint32_t corner, Row& row) {
    const Topology& t = p.topology;
    const uint32_t f = t.face_of_corner(corner), first = t.face_begin(f), n = t.size_of_face(f);
    if (n == 4) return corner_row(p, corner, row);
    for (uint32_t i = 0; i < n; ++i) {
        double weight = 1;
        for (uint32_t j = 1; j <= (n - 1) / 2; ++j)
            weight += 2 * std::exp2(-static_cast<double>(j)) * std::cos(2 * std::numbers::pi * i * j / n);
        add(row, t.face_vertices[first + (corner - first + i) % n], weight / n);
    }
}

}  // namespace

std::span<const Pass> mid_edge_passes() {
    static constexpr Pass passes[] = {{SplitKind::midpoints, {nullptr, nullptr, edge_midpoint}}};
    return passes;
}
std::span<const Pass> midpoint_passes() {
    static constexpr Pass passes[] = {
        {SplitKind::corners, {keep_vertex, nullptr, nullptr, corner_row, chaikin_edge_end}}};
    return passes;
}
std::span<const Pass> midpoint_normalised_passes() {
    static constexpr Pass passes[] = {
        {SplitKind::corners, {keep_vertex, nullptr, nullptr, normalised_corner_row, chaikin_edge_end}}};
    return passes;
}

}  // namespace limn::schemes
