// Which faces of a uniform refinement an adaptive one keeps, and how faces of unlike levels meet. Not part of
// the public interface.
//
// Splits in four (quads, triangles): a face may be split where the faces across its edges are there, so that
// those are at most one level coarser; what hangs on the edges of a face that stays are midpoints, and it is
// cut towards them. Splits around face points (sqrt3, sqrt2): a face of the next level belongs to an edge,
// and is there where both faces of that edge are split; where one is, a triangle fills its side. Nothing ever
// hangs. These triangles are the faces of odd generation of Kobbelt (2000), who turns an edge where a second
// one joins the first.
#pragma once

#include <span>
#include <vector>

#include "limn/schemes/split.h"

namespace limn {

/// A level of the uniform refinement. What is said of the next level is empty in the last.
struct AdaptiveLevel {
    Stage stage;
    uint32_t first_edge_point = 0;  ///< splits in four: the point of the next level on edge 0
    /// The point of the next level beside the edge of each corner: the face's, if it has one; where a
    /// boundary edge is cut in three instead, one of those two, and none (kInvalidIndex) at that edge. Empty
    /// for SplitKind::triangles.
    Array<uint32_t> corner_points;
    Array<uint32_t>
        child_parents;  ///< of each face of the next level: its face; its edge where splits are not in four
    Array<double> errors;  ///< of each face: by how much it misses the points that split it
    Array<uint8_t> split;  ///< 1 for faces that are split, and for those only that are there
};

/// What `split` says of the next level: all but stage, errors and split.
void note_split(const SplitMesh& split, SplitKind kind, AdaptiveLevel& level);

/// Splits each face that misses by more than `tolerance` or has a descendant that does, and what that takes
/// around it.
void choose_split_faces(std::span<AdaptiveLevel> levels, SplitKind kind, double tolerance);

/// The faces that are left. Vertices are those of the uniform refinement, which keep their numbers from level
/// to level.
struct AdaptiveFaces {
    std::vector<uint32_t> sizes, vertices;
    std::vector<uint8_t>
        levels;  ///< of each face; triangles around face points have that of the face that is split

    uint64_t triangle_count() const { return vertices.size() - 2 * sizes.size(); }
};
AdaptiveFaces collect_faces(std::span<const AdaptiveLevel> levels, SplitKind kind);

}  // namespace limn
