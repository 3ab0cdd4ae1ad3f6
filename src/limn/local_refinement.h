// Refinement of the neighbourhood of one face, and the numbers that the refined vertices over it have in the
// whole mesh. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/refinement.h"

namespace limn {

/// Levels of a small part of a mesh. Vertices, edges and faces are numbered on their own; up to the asked
/// level the faces that descend from the first face of level 0 come first, in the order that they have in the
/// whole mesh.
struct LocalRefinement {
    std::vector<Topology> levels;
    std::vector<uint32_t> ring;  ///< vertices of the whole mesh that those of level 0 are
    /// For each level from 1, which child of the level before each vertex is; empty where it is the one it is
    /// numbered.
    std::vector<std::vector<uint32_t>> children;
    std::vector<uint32_t> targets;  ///< vertices of the last level that the target corners are
};

struct LocalRefinementOptions {
    uint32_t level;
    /// Go on, around the targets only, until their limits can be taken: at least to level 1, and until no
    /// finite sharpness is left. The last level then has complete stars at the targets.
    bool to_limit = false;
    /// The mesh that a face-varying base with Chaikin creasing was cut from, else null.
    const Topology* uncut = nullptr;
};

/// `faces`: a face of `base` and, after it, all others that touch it. `target_corners`: corners of the faces
/// over the first one at `level`, counted from the first of them.
void refine_locally(const Topology& base, const std::vector<uint32_t>& faces,
                    const std::vector<uint32_t>& target_corners, const LocalRefinementOptions& options,
                    LocalRefinement& out);

/// The part of a topology that consists of some of its faces, which keep their order. Stars keep their order,
/// too, and lose what lies outside. `vertices` receives the vertices that the new ones were.
Topology extract_faces(const Topology& from, const std::vector<uint32_t>& faces,
                       std::vector<uint32_t>& vertices);
/// The same into a topology that is new, or was extracted before from one with the same options and face_size.
void extract_faces(const Topology& from, const std::vector<uint32_t>& faces, std::vector<uint32_t>& vertices,
                   Topology& to);

/// A face and, after it, all that its corners' rules depend on: those that touch it.
std::vector<uint32_t> faces_touching_face(const Topology& t, uint32_t face);

/// Component counts of the levels of a mesh.
struct LevelCounts {
    uint32_t vertices, edges, faces, corners;
};
/// Counts of levels 0 .. level. Error: too_large when a level has more than 2^31 - 1 corners.
Result<std::vector<LevelCounts>> count_levels(const Topology& base, uint32_t level);

/// The vertices of the refined faces over face f, corner by corner, as the whole mesh numbers them at
/// `level`: what refinement.levels[level].face_vertices holds there, without refining anything.
void vertices_over_face(const Topology& base, const std::vector<LevelCounts>& counts, uint32_t level,
                        uint32_t f, std::vector<uint32_t>& vertices);

}  // namespace limn
