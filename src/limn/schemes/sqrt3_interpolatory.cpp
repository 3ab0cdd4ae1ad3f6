// Labsik and Greiner 2000, interpolatory sqrt(3)-subdivision. Boundaries are ternary four-point curves, cut
// in three each second step. The paper's text says nothing of faces at boundaries: those with a boundary edge
// follow OpenMesh; elsewhere boundary vertices count as regular and missing points are reflections.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

bool is_regular(const Topology& t, uint32_t v) {
    return is_boundary_vertex(t, v) || edge_valence(t, v) == 6;
}

/// The rule of an irregular vertex for the face between its neighbours i and i + 1.
void add_irregular_corner(const Topology& t, uint32_t v, uint32_t i, double weight, Row& row) {
    const uint32_t n = edge_valence(t, v);
    const double a = 2.0 / 3 * std::cos(std::numbers::pi / n);
    auto ring_weight = [&](uint32_t j) {
        if (n == 3) return j < 2 ? 4.0 / 27 : -5.0 / 27;
        if (n == 4) return j < 2 ? 2.0 / 9 : -1.0 / 9;
        const double turn = (2.0 * j - 1) * std::numbers::pi / n;
        return (a * a + 2 * a * std::cos(turn) + 2 * a * a * std::cos(2 * turn)) / n;
    };
    add(row, v, weight * (n == 3 ? 8.0 / 9 : n == 4 ? 7.0 / 9 : 1 - a * a));
    for (uint32_t j = 0; j < n; ++j) add(row, neighbor(t, v, (i + j) % n), weight * ring_weight(j));
}

/// The part of a regular face's rule that lies at corner c and across the edge that begins there.
void add_regular_corner(const Topology& t, uint32_t c, Row& row) {
    add(row, t.face_vertices[c], 32.0 / 81);
    add_apex_across(t, c, -1.0 / 81, row);
    const uint32_t beyond = opposite_corner(t, c);
    add_apex_across(t, t.next_corner(beyond), -2.0 / 81, row);
    add_apex_across(t, t.previous_corner(beyond), -2.0 / 81, row);
}

/// A face with one boundary edge, that which begins at corner c.
void add_face_at_edge(const Topology& t, uint32_t c, Row& row) {
    const uint32_t apex = apex_vertex(t, c);
    if (!is_regular(t, apex))
        return add_irregular_corner(t, apex, edge_position(t, apex, t.face_edges[t.previous_corner(c)]), 1,
                                    row);
    add(row, apex, 1.0 / 2);
    add(row, t.face_vertices[c], 1.0 / 3);
    add(row, end_vertex(t, c), 1.0 / 3);
    add_apex_across(t, t.next_corner(c), -1.0 / 12, row);
    add_apex_across(t, t.previous_corner(c), -1.0 / 12, row);
}

/// A face with two boundary edges; the third begins at corner c.
void add_ear(const Topology& t, uint32_t c, Row& row) {
    add(row, apex_vertex(t, c), 7.0 / 24);
    add(row, t.face_vertices[c], 3.0 / 8);
    add(row, end_vertex(t, c), 3.0 / 8);
    add_apex_across(t, c, -1.0 / 24, row);
}

void face_row(const Stage& p, uint32_t f, Row& row) {
    const Topology& t = p.topology;
    const uint32_t first = t.face_begin(f);
    uint32_t open = 0, irregular = 0, open_corner = first, closed_corner = first;
    for (uint32_t c = first; c < first + 3; ++c) {
        const bool is_open = is_boundary_edge(t, t.face_edges[c]);
        (is_open ? open_corner : closed_corner) = c;
        open += is_open;
        irregular += !is_regular(t, t.face_vertices[c]);
    }
    if (open == 3) return face_centroid(p, f, row);
    if (open == 2) return add_ear(t, closed_corner, row);
    if (open == 1) return add_face_at_edge(t, open_corner, row);
    for (uint32_t c = first; c < first + 3; ++c) {
        const uint32_t v = t.face_vertices[c];
        if (irregular == 0)
            add_regular_corner(t, c, row);
        else if (!is_regular(t, v))
            add_irregular_corner(t, v, edge_position(t, v, t.face_edges[c]), 1.0 / irregular, row);
    }
}

/// A third of the way from vertex a to b along the boundary.
void edge_end_row(const Stage& p, uint32_t end, Row& row) {
    const Topology& t = p.topology;
    const uint32_t a = t.edge_vertices[end], b = t.edge_vertices[end ^ 1];
    add(row, a, 60.0 / 81);
    add(row, b, 30.0 / 81);
    add_boundary_beyond(t, a, b, -5.0 / 81, row);
    add_boundary_beyond(t, b, a, -4.0 / 81, row);
}

}  // namespace

std::span<const Pass> sqrt3_interpolatory_passes() {
    static constexpr Pass passes[] = {
        {SplitKind::sqrt3, {keep_vertex, face_row, nullptr, nullptr, edge_end_row}}};
    return passes;
}

}  // namespace limn::schemes
