// Kobbelt 2000, sqrt(3)-subdivision. Boundaries are cubic B-splines, cut in three each second step.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

void vertex_row(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    const uint32_t n = edge_valence(t, v);
    if (n == 0 || (is_boundary_vertex(t, v) && (p.step % 2 == 0 || is_fixed_corner(t, v)))) return add(row, v, 1);
    if (is_boundary_vertex(t, v)) {
        const auto [previous, next] = boundary_neighbors(t, v);
        add(row, v, 19.0 / 27);
        add(row, previous, 4.0 / 27);
        add(row, next, 4.0 / 27);
        return;
    }
    const double alpha = (4 - 2 * std::cos(2 * std::numbers::pi / n)) / 9;
    add(row, v, 1 - alpha);
    for (uint32_t i = 0; i < n; ++i) add(row, neighbor(t, v, i), alpha / n);
}

/// A third of the way from vertex a to b along the boundary; beyond a lies its other boundary neighbour.
void edge_end_row(const Stage& p, uint32_t end, Row& row) {
    const Topology& t = p.topology;
    const uint32_t a = t.edge_vertices[end], b = t.edge_vertices[end ^ 1];
    if (is_fixed_corner(t, a)) {  // the neighbour beyond mirrored: 2 a - b
        add(row, a, 18.0 / 27);
        add(row, b, 9.0 / 27);
        return;
    }
    const auto [previous, next] = boundary_neighbors(t, a);
    add(row, a, 16.0 / 27);
    add(row, b, 10.0 / 27);
    add(row, previous == b ? next : previous, 1.0 / 27);
}

}  // namespace

std::span<const Pass> sqrt3_passes() {
    static constexpr Pass passes[] = {{SplitKind::sqrt3, {vertex_row, face_centroid, nullptr, nullptr, edge_end_row}}};
    return passes;
}

}  // namespace limn::schemes
