// Oswald and Schroeder 2003, composite sqrt(3): triangles are split linearly, then values are averaged from
// vertices to faces and back, count - 1 times. Boundaries, each second step, are cut in three linearly and
// averaged over three points as often: B-splines of degree count.
#include <array>
#include <cassert>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

void linear_edge_end(const Stage& p, uint32_t end, Row& row) {
    add(row, p.topology.edge_vertices[end], 2.0 / 3);
    add(row, p.topology.edge_vertices[end ^ 1], 1.0 / 3);
}

void averaged_vertex(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    if (edge_valence(t, v) == 0) return add(row, v, 1);
    if (!is_boundary_vertex(t, v)) {
        for (const uint32_t c : t.corners_of_vertex(v))
            add_centroid(t, t.face_of_corner(c), 1.0 / face_valence(t, v), row);
        return;
    }
    if (p.step % 2 == 0 || is_fixed_corner(t, v)) return add(row, v, 1);
    const auto [previous, next] = boundary_neighbors(t, v);
    for (const uint32_t point : {v, previous, next}) add(row, point, 1.0 / 3);
}

}  // namespace

std::span<const Pass> sqrt3_composite_passes(uint32_t count) {
    static constexpr Pass split = {SplitKind::sqrt3,
                                   {keep_vertex, face_centroid, nullptr, nullptr, linear_edge_end}};
    static constexpr Pass average = {SplitKind::none, {averaged_vertex}};
    static constexpr std::array<Pass, 3> passes = {split, average, average};
    assert(count >= 2 && count <= passes.size());
    return {passes.data(), count};
}

}  // namespace limn::schemes
