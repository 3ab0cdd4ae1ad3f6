// Pieces that build base topologies: of the mesh and, cut along seams, of its face-varying channels. Not
// public.
#pragma once

#include <algorithm>

#include "limn/parallel.h"
#include "limn/topology.h"

namespace limn {

/// counts[i] entries for item i -> offsets with a final total.
inline Array<uint32_t> offsets_from_counts(const Array<uint32_t>& counts) {
    Array<uint32_t> offsets;
    offsets.allocate(counts.size() + 1);
    uint32_t sum = 0;
    for (size_t i = 0; i < counts.size(); ++i) {
        offsets[i] = sum;
        sum += counts[i];
    }
    offsets.back() = sum;
    return offsets;
}

/// Topology::face_of_corner, next_corner and previous_corner, without a division where all faces are quads.
inline uint32_t face_at(const Topology& t, uint32_t c) {
    return t.face_size == 4 ? c / 4 : t.face_of_corner(c);
}
inline uint32_t next_in_face(const Topology& t, uint32_t c) {
    return t.face_size == 4 ? (c & ~3u) | ((c + 1) & 3u) : t.next_corner(c);
}
inline uint32_t previous_in_face(const Topology& t, uint32_t c) {
    return t.face_size == 4 ? (c & ~3u) | ((c + 3) & 3u) : t.previous_corner(c);
}

/// Groups 0 .. count - 1 by key(i) < key_count, ascending within each group.
template <class Key>
void group_by(uint32_t count, uint32_t key_count, const Key& key, Array<uint32_t>& offsets,
              Array<uint32_t>& members, const BuildPart& part = {}) {
    Array<uint32_t> cursor;
    cursor.assign(key_count, 0);
    for_each_in_order(count, part.part(0, 0.4f), [&](uint32_t i) { ++cursor[key(i)]; });
    offsets = offsets_from_counts(cursor);
    std::copy(offsets.begin(), offsets.end() - 1, cursor.begin());
    members.allocate(count);
    for_each_in_order(count, part.part(0.4f, 1), [&](uint32_t i) { members[cursor[key(i)]++] = i; });
}

/// A topology in the making has options, vertex_count, face_count, face_offsets and face_vertices. This finds face_size
/// or corner_faces.
void index_faces(Topology& t, const BuildPart& part = {});
/// Then this the rest, with the creases, corners and holes of `tags`.
void complete_topology(const ControlMesh& tags, Topology& t, const BuildPart& part = {});

/// Edges and stars from face_vertices. `first[c]` is the corner at which corner c's edge appears first; edges
/// are numbered in that order. Stars come in corner and edge order.
void build_incidence(Topology& t, const Array<uint32_t>& first, const BuildPart& part = {});

/// Both at once for an oriented manifold, faster, with the same result: edges and ordered stars from face_vertices.
/// False where the mesh is none, or not a plain one; what was made so far is then of no use.
bool build_manifold_incidence(Topology& t, const BuildPart& part = {});

/// Orders the stars of vertices flagged in vertex_manifold counter-clockwise; clears the flag where that
/// fails.
void order_stars(Topology& t, const BuildPart& part = {});

/// build_topology in two steps. Faces, edges and stars; `non_manifold_edges` receives, for each edge, 1 where
/// it joins more than two faces, faces of opposite winding, or nothing.
Topology build_connectivity(const ControlMesh& mesh, Array<uint8_t>& non_manifold_edges,
                            const BuildPart& part = {});
/// And what sharpness and holes make of them.
void assign_sharpness(const ControlMesh& mesh, Topology& t, const Array<uint8_t>& non_manifold_edges,
                      const BuildPart& part = {});

/// The edge between two vertices, or kInvalidIndex.
uint32_t find_edge(const Topology& t, uint32_t a, uint32_t b);

inline float clamp_sharpness(float sharpness) {
    return std::min(sharpness, kInfiniteSharpness);
}

/// Whatever sharpness the mesh gives it.
inline bool is_always_infinite(const Topology& t, uint32_t e, const Array<uint8_t>& non_manifold_edges) {
    return t.corners_of_edge(e).size() < 2 || non_manifold_edges[e] != 0;
}

/// Sharpness and rule of one vertex, whose sharpness is that of the mesh; once edges are sharpened.
void sharpen_vertex(Topology& t, uint32_t v, const Array<uint8_t>& non_manifold_edges);

/// With no boundary interpolation, faces that touch a boundary edge which the mesh does not make infinitely
/// sharp are holes.
inline bool hides_boundary_faces(const SchemeOptions& options) {
    return options.boundary == BoundaryInterpolation::none && options.scheme != Scheme::bilinear;
}
/// Whether vertex v makes the faces around it holes then; `sharpness_of(e)` is the mesh's.
template <class SharpnessOf>
bool hides_faces(const Topology& t, uint32_t v, const SharpnessOf& sharpness_of) {
    const auto edges = t.edges_of_vertex(v);
    return std::any_of(edges.begin(), edges.end(), [&](uint32_t e) {
        return t.corners_of_edge(e).size() == 1 && !is_infinite(sharpness_of(e));
    });
}

/// What Chaikin creasing looks at.
inline SemiSharpEdges semi_sharp_edges_around(const Topology& t, uint32_t v) {
    SemiSharpEdges around;
    for (const uint32_t e : t.edges_of_vertex(v)) around.add(t.edge_sharpness[e]);
    return around;
}

/// The rules that the children of a vertex and of an edge have in the next level.
VertexRule child_rule_of_vertex(const Topology& parent, uint32_t v);
VertexRule child_rule_of_edge(const Topology& parent, uint32_t e);

/// One refinement step. `full`: with edges and stars.
Topology refine_once(const Topology& parent, bool full, const BuildPart& part = {});
/// The same into a topology that has been made by it before, or is new.
void refine_once(const Topology& parent, bool full, Topology& child, const BuildPart& part = {});

/// Chaikin creasing looks at all edges around a vertex of the mesh, also beyond seams: gives the edges of a
/// channel's level the half_edge_sharpness (and dependent_seam_sharpness) that the uncut level has for them.
/// Corners of both correspond.
void copy_half_edge_sharpness(const Topology& uncut, Topology& channel, const BuildPart& part = {});

/// Chaikin creasing: fills half_edge_sharpness from the stars. Does nothing for uniform creasing.
void build_half_edge_sharpness(Topology& t, const BuildPart& part = {});

}  // namespace limn
