// Walking around vertices, edges and faces, as masks do. Not part of the public interface.
#pragma once

#include "limn/schemes/subdivision_scheme.h"

namespace limn {

inline void add(Row& row, uint32_t index, double weight) {
    if (weight != 0) row.push_back({index, weight});
}
inline void add_centroid(const Topology& t, uint32_t face, double weight, Row& row) {
    const auto vertices = t.vertices_of_face(face);
    for (const uint32_t v : vertices) add(row, v, weight / static_cast<double>(vertices.size()));
}

/// Scales by `weight` what `append` appends to the row.
template <class Append>
void add_scaled(Row& row, double weight, const Append& append) {
    const size_t begin = row.size();
    append();
    for (size_t i = begin; i < row.size(); ++i) row[i].weight *= weight;
}

inline bool is_boundary_edge(const Topology& t, uint32_t e) {
    return t.corners_of_edge(e).size() == 1;
}
/// Faces around v; of a boundary vertex one less than edges.
inline uint32_t face_valence(const Topology& t, uint32_t v) {
    return static_cast<uint32_t>(t.corners_of_vertex(v).size());
}
inline uint32_t edge_valence(const Topology& t, uint32_t v) {
    return static_cast<uint32_t>(t.edges_of_vertex(v).size());
}
inline bool is_boundary_vertex(const Topology& t, uint32_t v) {
    return edge_valence(t, v) != face_valence(t, v);
}
/// Neighbour i of v, counter-clockwise; a boundary vertex's first and last lie on the boundary.
inline uint32_t neighbor(const Topology& t, uint32_t v, uint32_t i) {
    return t.other_vertex(t.edges_of_vertex(v)[i], v);
}
/// Which neighbour of v the other end of edge e is.
inline uint32_t edge_position(const Topology& t, uint32_t v, uint32_t e) {
    const auto edges = t.edges_of_vertex(v);
    uint32_t i = 0;
    while (i < edges.size() && edges[i] != e) ++i;
    return i;
}
/// The corner at the other end of the edge that begins at corner c, in the face beyond; kInvalidIndex at a boundary.
inline uint32_t opposite_corner(const Topology& t, uint32_t c) {
    const auto at = t.corners_of_edge(t.face_edges[c]);
    if (at.size() < 2) return kInvalidIndex;
    return at[0] == c ? at[1] : at[0];
}
/// The end of the edge that begins at corner c.
inline uint32_t end_vertex(const Topology& t, uint32_t c) {
    return t.face_vertices[t.next_corner(c)];
}
/// The neighbours of boundary vertex v along the boundary: backwards (its last edge) and forwards (its first).
struct BoundaryNeighbors {
    uint32_t previous, next;
};
inline BoundaryNeighbors boundary_neighbors(const Topology& t, uint32_t v) {
    return {neighbor(t, v, edge_valence(t, v) - 1), neighbor(t, v, 0)};
}
/// A boundary vertex that stays where it is: one face, and boundaries with corners.
inline bool is_fixed_corner(const Topology& t, uint32_t v) {
    return t.vertex_rules[v] == VertexRule::corner;
}
/// Adds the point that follows boundary edge b-a beyond a; at a fixed corner, where none does, b mirrored.
inline void add_boundary_beyond(const Topology& t, uint32_t a, uint32_t b, double weight, Row& row) {
    if (is_fixed_corner(t, a)) {
        add(row, a, 2 * weight);
        return add(row, b, -weight);
    }
    const auto [previous, next] = boundary_neighbors(t, a);
    add(row, previous == b ? next : previous, weight);
}
/// The third vertex of the triangle with corner c, away from the edge that begins there.
inline uint32_t apex_vertex(const Topology& t, uint32_t c) {
    return t.face_vertices[t.previous_corner(c)];
}
/// Adds the vertex of a triangle mesh across the edge that begins at corner c; at a boundary, where there is
/// none, the apex on this side, reflected in the middle of the edge.
inline void add_apex_across(const Topology& t, uint32_t c, double weight, Row& row) {
    const uint32_t beyond = opposite_corner(t, c);
    if (beyond != kInvalidIndex) return add(row, apex_vertex(t, beyond), weight);
    add(row, t.face_vertices[c], weight);
    add(row, end_vertex(t, c), weight);
    add(row, apex_vertex(t, c), -weight);
}
/// The corner of the face at which a boundary edge begins, the first of them; kInvalidIndex where there is none.
inline uint32_t boundary_corner(const Topology& t, uint32_t f) {
    for (uint32_t c = t.face_begin(f); c < t.face_begin(f) + t.size_of_face(f); ++c)
        if (is_boundary_edge(t, t.face_edges[c])) return c;
    return kInvalidIndex;
}

}  // namespace limn
