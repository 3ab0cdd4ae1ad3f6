// Uniform refinement: one generic step parent -> child, level after level.
#pragma once

#include <cstdint>
#include <vector>

#include "limn/result.h"
#include "limn/topology.h"

namespace limn {

inline constexpr uint32_t kMaxRefinementLevel = 10;

struct RefinementOptions {
    uint32_t level = 1;            ///< 0 .. kMaxRefinementLevel
    bool full_last_level = false;  ///< edges and stars of the last level, too
    BuildPart control = {};        ///< a BuildControl*, to cancel the build and to see its progress; may be null
};

/// Levels 0 .. level. Children are numbered as in OpenSubdiv: the vertices of a level are, in this order, one
/// for each vertex, face (not Loop) and edge of its parent; a face's children follow its corners (Loop: the
/// centre comes last). A child of a vertex keeps the vertex's index, at every level.
struct Refinement {
    std::vector<Topology> levels;
    /// With Chaikin creasing, a face-varying channel keeps the base level of the mesh that it was cut from.
    std::vector<Topology> uncut;
    uint32_t control_count = 0;       ///< control points that tables refer to
    Array<uint32_t> control_indices;  ///< control point of each base vertex; empty when they are the same

    uint32_t level_count() const { return static_cast<uint32_t>(levels.size()); }
    const Topology& last() const { return levels.back(); }
};

/// Refines the mesh for vertex and varying data.
/// Errors: invalid_argument (level), too_large when a level would hold more than 2^31 - 1 corners, unsupported
/// (Doo-Sabin), cancelled.
Result<Refinement> build_refinement(const ControlMesh& mesh, const RefinementOptions& options);

/// Refines one face-varying channel: the same faces in the same order at every level, cut along its seams;
/// table columns are the channel's values. levels[l].face_vertices are then indices of refined values.
/// Errors: as build_refinement, index_out_of_range; of Doo-Sabin meshes channels that are linear everywhere
/// (FaceVaryingInterpolation::all) are refined.
Result<Refinement> build_face_varying_refinement(const ControlMesh& mesh, uint32_t channel,
                                                 const RefinementOptions& options);

/// Levels after which no finite sharpness of this one is left: ceil of the largest, and one more where a
/// face-varying value can outlast it. Limits can be taken from there on.
uint32_t count_sharp_levels(const Topology& level);

/// Index of the child vertex of a vertex, face (not Loop) or edge of `parent`.
inline uint32_t child_of_vertex(uint32_t v) {
    return v;
}
inline uint32_t child_of_face(const Topology& parent, uint32_t f) {
    return parent.vertex_count + f;
}
inline uint32_t child_of_edge(const Topology& parent, uint32_t e) {
    return parent.vertex_count + (parent.options.scheme == Scheme::loop ? 0 : parent.face_count) + e;
}

}  // namespace limn
