// Topology of one refinement level: incidence, sharpness and rules, as flat arrays.
#pragma once

#include <cstdint>
#include <span>

#include "limn/array.h"
#include "limn/build_control.h"
#include "limn/control_mesh.h"

namespace limn {

inline constexpr uint32_t kInvalidIndex = ~uint32_t{0};

/// A corner is one vertex of one face: corner c of face f is entry face_begin(f) + c. Edge c of a face joins
/// its corners c and c + 1. Where the faces around a vertex form one fan, its corners and edges are listed
/// counter-clockwise: corner i lies between edges i and i + 1, and a boundary vertex has one edge more than
/// corners. Base edges are numbered in order of first appearance, corner by corner. All this is OpenSubdiv's
/// numbering, too.
struct Topology {
    SchemeOptions options;
    uint32_t vertex_count = 0;
    uint32_t edge_count = 0;
    uint32_t face_count = 0;
    uint32_t face_size = 0;  ///< 3 or 4 when all faces have that many corners, else 0

    Array<uint32_t> face_offsets;   ///< face_count + 1; empty when face_size != 0
    Array<uint32_t> corner_faces;   ///< corner_count(); empty when face_size != 0
    Array<uint32_t> face_vertices;  ///< corner_count()
    // What follows, down to vertex_rules, is empty in the last level of a Refinement built without
    // full_last_level.
    Array<uint32_t> face_edges;           ///< corner_count()
    Array<uint32_t> edge_vertices;        ///< 2 * edge_count
    Array<uint32_t> edge_corner_offsets;  ///< edge_count + 1
    Array<uint32_t> edge_corners;  ///< corners at which each edge begins in its faces (base level: ascending)
    Array<uint32_t> vertex_corner_offsets;  ///< vertex_count + 1
    Array<uint32_t> vertex_corners;         ///< corner_count()
    Array<uint32_t> vertex_edge_offsets;    ///< vertex_count + 1
    Array<uint32_t> vertex_edges;           ///< 2 * edge_count
    Array<float> edge_sharpness;            ///< edge_count; boundary and non-manifold edges are infinite
    Array<float>
        half_edge_sharpness;  ///< Chaikin creasing: 2 * edge_count, see child_edge_sharpness; else empty
    Array<float> vertex_sharpness;   ///< vertex_count
    Array<uint8_t> vertex_manifold;  ///< vertex_count; 1 where the faces form one fan
    /// Face-varying values whose rule follows another's: pairs (vertex, the one it follows), ascending.
    /// Mostly empty.
    Array<uint32_t> dependent_vertices;
    /// One per pair: the largest finite sharpness that the mesh's edges along the seam there have in the next
    /// level. While it lasts, a value that has stopped following stays a corner for one more level, as in
    /// OpenSubdiv.
    Array<float> dependent_seam_sharpness;
    // Kept in every level.
    Array<VertexRule> vertex_rules;  ///< vertex_count
    Array<uint8_t> face_holes;       ///< face_count; 1 where the face is not part of the surface

    uint32_t corner_count() const { return static_cast<uint32_t>(face_vertices.size()); }
    uint32_t face_begin(uint32_t f) const { return face_size != 0 ? f * face_size : face_offsets[f]; }
    uint32_t size_of_face(uint32_t f) const {
        return face_size != 0 ? face_size : face_offsets[f + 1] - face_offsets[f];
    }
    uint32_t face_of_corner(uint32_t c) const { return face_size != 0 ? c / face_size : corner_faces[c]; }
    uint32_t next_corner(uint32_t c) const {
        const uint32_t f = face_of_corner(c), begin = face_begin(f);
        return c + 1 == begin + size_of_face(f) ? begin : c + 1;
    }
    uint32_t previous_corner(uint32_t c) const {
        const uint32_t f = face_of_corner(c), begin = face_begin(f);
        return c == begin ? begin + size_of_face(f) - 1 : c - 1;
    }
    std::span<const uint32_t> vertices_of_face(uint32_t f) const {
        return {face_vertices.data() + face_begin(f), size_of_face(f)};
    }
    std::span<const uint32_t> edges_of_face(uint32_t f) const {
        return {face_edges.data() + face_begin(f), size_of_face(f)};
    }
    std::span<const uint32_t> corners_of_edge(uint32_t e) const {
        return {edge_corners.data() + edge_corner_offsets[e],
                edge_corner_offsets[e + 1] - edge_corner_offsets[e]};
    }
    std::span<const uint32_t> corners_of_vertex(uint32_t v) const {
        return {vertex_corners.data() + vertex_corner_offsets[v],
                vertex_corner_offsets[v + 1] - vertex_corner_offsets[v]};
    }
    std::span<const uint32_t> edges_of_vertex(uint32_t v) const {
        return {vertex_edges.data() + vertex_edge_offsets[v],
                vertex_edge_offsets[v + 1] - vertex_edge_offsets[v]};
    }
    /// Sharpness that the child of edge e has next to the edge's vertex `end` (0 or 1).
    float child_sharpness_of_edge(uint32_t e, uint32_t end) const {
        return half_edge_sharpness.empty() ? child_sharpness(edge_sharpness[e])
                                           : half_edge_sharpness[2 * e + end];
    }
    /// Which end of the edge that begins at corner c (in c's face) that corner is.
    uint32_t end_at_corner(uint32_t c) const {
        return edge_vertices[2 * face_edges[c]] == face_vertices[c] ? 0 : 1;
    }
    static constexpr size_t kNotDependent = ~size_t{0};
    /// Which pair of dependent_vertices v follows in, or kNotDependent.
    size_t find_dependent(uint32_t v) const {
        size_t low = 0, high = dependent_seam_sharpness.size();
        while (low < high) {
            const size_t middle = (low + high) / 2;
            if (dependent_vertices[2 * middle] < v)
                low = middle + 1;
            else
                high = middle;
        }
        return low < dependent_seam_sharpness.size() && dependent_vertices[2 * low] == v ? low
                                                                                         : kNotDependent;
    }
    /// The vertex whose sharpness decides the rule of v: v itself, unless it is a dependent vertex.
    uint32_t leading_vertex(uint32_t v) const {
        const size_t pair = find_dependent(v);
        return pair == kNotDependent ? v : dependent_vertices[2 * pair + 1];
    }
    uint32_t other_vertex(uint32_t e, uint32_t v) const {
        return edge_vertices[2 * e] == v ? edge_vertices[2 * e + 1] : edge_vertices[2 * e];
    }
};

/// The topology of a control mesh: edges, stars, boundary and non-manifold rules, sharpness, holes. Not to be
/// used, here and below, where `part` is cancelled.
Topology build_topology(const ControlMesh& mesh, const BuildPart& part = {});

/// The topology of one of its face-varying channels, cut along its seams. Its vertices are the distinct
/// (vertex, value) pairs, ordered by vertex; `control_values[i]` receives the value index of pair i. Rules
/// follow the channel's interpolation. Faces, their order and sizes are those of `base`.
Topology build_face_varying_topology(const ControlMesh& mesh, const Topology& base, uint32_t channel,
                                     Array<uint32_t>& control_values, const BuildPart& part = {});

}  // namespace limn
