// Patch tables unrolled for evaluation at many places a frame: local points of each surface are made once a frame,
// by one dense matrix for each plan, and any place then takes 16 of them.
#pragma once

#include "limn/grid_table.h"
#include "limn/patch_table.h"
#include "limn/shared/patch_tree_layout.h"

namespace limn {

/// A surface's tree: its root, how the surface is turned against it, and where its local points begin.
struct TreeSurface {
    uint32_t word;  ///< shared::pack_surface(root, rotation)
    uint32_t first_local;
    uint32_t hull_count;  ///< the first so many local points have the surface in their convex hull
};

/// Plans refer to each other, so that places of any depth can be had; trees end where no place of a grid of
/// max_rate intervals can lie but the irregular vertex itself. Node n is the word nodes[n]
/// (limn/shared/patch_tree_layout.h); leaf l the words [l * kLeafWords, (l + 1) * kLeafWords) of leaf_points.
/// Places between those grids', in leaves of kind kNodeCorner, come out wrong.
struct PatchTreeTable {
    SchemeOptions options;
    uint32_t max_rate = 0;
    bool relative = false;
    uint32_t tree_count = 0;
    Array<uint32_t> nodes;
    Array<uint32_t> leaf_points;
    Array<TreeSurface> surfaces;     ///< as those of the patch table
    Array<uint32_t> ptex_surfaces;   ///< as the patch table's
    /// What makes the local points: sample s of the whole "grid" is local point s. No face's points cross a
    /// pass, so that some samples are never written.
    GridTable local_points;

    uint32_t local_count() const { return static_cast<uint32_t>(local_points.total_sample_count); }
    uint64_t bytes() const {
        return nodes.bytes() + leaf_points.bytes() + surfaces.bytes() + ptex_surfaces.bytes() +
               local_points.bytes();
    }
};

struct PatchTreeOptions {
    uint32_t max_rate = 64;  ///< 2 .. 128: intervals along any side of a ptex face, or of two where it is split
    uint64_t max_weight_bytes = uint64_t{256} << 20;  ///< as GridOptions
    uint32_t points_per_pass = uint32_t{1} << 22;     ///< as GridOptions::samples_per_pass
    /// For samples: the first local point of each surface is the first of its ring, and all others are relative to it,
    /// so that second derivatives, and first ones far from the origin, are as exact as without trees. Not for tessellation.
    bool relative = false;
    BuildPart control = {};  ///< as RefinementOptions::control
};

/// Errors: invalid_argument (max_rate), unsupported (end caps other than exact; a surface of 2^16 local
/// points or more), too_large (weights, 2^26 nodes, 2^32 local points; plans that refer to each other more
/// than those of meshes do: what a build takes is bounded by the size of the table), cancelled.
Result<PatchTreeTable> build_patch_trees(const PatchTable& table, const PatchTreeOptions& options);

}  // namespace limn
