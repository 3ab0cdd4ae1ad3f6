// Loop's scheme with the weights of Warren (Warren and Weimer 2001), as many libraries have it. Boundaries
// are cubic B-splines.
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

void vertex_row(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    const uint32_t n = edge_valence(t, v);
    if (n == 0) return add(row, v, 1);
    if (is_boundary_vertex(t, v)) return cubic_boundary_vertex(p, v, row);
    const double beta = n == 3 ? 3.0 / 16 : 3.0 / (8.0 * n);
    add(row, v, 1 - n * beta);
    for (uint32_t i = 0; i < n; ++i) add(row, neighbor(t, v, i), beta);
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    if (is_boundary_edge(t, e)) return edge_midpoint(p, e, row);
    for (const uint32_t c : t.corners_of_edge(e)) {
        add(row, t.face_vertices[c], 3.0 / 8);
        add(row, apex_vertex(t, c), 1.0 / 8);
    }
}

}  // namespace

std::span<const Pass> loop_warren_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {vertex_row, nullptr, edge_row}}};
    return passes;
}

}  // namespace limn::schemes
