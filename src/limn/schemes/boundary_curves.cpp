// Curves that boundaries of more than one scheme follow.
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {

void chaikin_edge_end(const Stage& p, uint32_t end, Row& row) {
    add(row, p.topology.edge_vertices[end], 0.75);
    add(row, p.topology.edge_vertices[end ^ 1], 0.25);
}

void cubic_boundary_vertex(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    if (is_fixed_corner(t, v)) return add(row, v, 1);
    const auto [previous, next] = boundary_neighbors(t, v);
    add(row, v, 0.75);
    add(row, previous, 0.125);
    add(row, next, 0.125);
}

void four_point_boundary_edge(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    const uint32_t a = t.edge_vertices[2 * e], b = t.edge_vertices[2 * e + 1];
    add(row, a, 9.0 / 16);
    add(row, b, 9.0 / 16);
    add_boundary_beyond(t, a, b, -1.0 / 16, row);
    add_boundary_beyond(t, b, a, -1.0 / 16, row);
}

}  // namespace limn::schemes
