// The topological operators of subdivision schemes. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/schemes/subdivision_scheme.h"

namespace limn {

/// Points of one origin, numbered `first` and up: of element i, or of element parents[i].
struct PointBlock {
    Origin origin;
    uint32_t first, count;
    Array<uint32_t> parents;  ///< count entries; empty: 0 .. count - 1

    uint32_t parent(uint32_t i) const { return parents.empty() ? i : parents[i]; }
};

/// A vertex or a face.
struct Element {
    bool is_face = false;
    uint32_t index = kInvalidIndex;

    bool operator==(const Element&) const = default;
};

struct SplitMesh {
    std::vector<PointBlock> blocks;  ///< in the order of Origin
    Topology child;                  ///< empty for SplitKind::none: the parent's own
    /// Splits that make a face of a vertex: which one; kInvalidIndex where there is none. Else empty.
    Array<uint32_t> face_of_vertex;

    uint32_t point_count() const { return blocks.back().first + blocks.back().count; }
};

/// Splits `parent`, which has its edges and stars and is a manifold (no edge of more than two faces, each vertex one
/// fan, all faces one way round) unless `kind` is none, quads or triangles. `full`: the child gets edges and stars,
/// too.
SplitMesh split_mesh(const Stage& parent, SplitKind kind, bool full, const BuildPart& part = {});

/// The element of the child that `element` becomes: a vertex moves on or turns into a face, a face shrinks or turns
/// into its point. index == kInvalidIndex where there is none.
Element child_element(SplitKind kind, const SplitMesh& split, Element element);

/// Boundary option `none` hides no faces of schemes that have no such rule.
void show_all_faces(Topology& t);

/// The topology of faces alone, nothing sharp but boundaries, nothing hidden; without edges and stars unless `full`.
Topology topology_of_faces(const SchemeOptions& options, uint32_t vertex_count, Array<uint32_t> face_offsets,
                           Array<uint32_t> face_vertices, bool full, const BuildPart& part = {});

}  // namespace limn
