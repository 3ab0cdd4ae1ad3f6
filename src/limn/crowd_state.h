// What a crowd holds, and the arrays that devices get of it. Not part of the public interface.
#pragma once

#include <array>

#include "limn/batch_copy.h"
#include "limn/crowd.h"
#include "limn/crowd_points.h"
#include "limn/crowd_tiles.h"

namespace limn {

/// What is handed out by ranges.
enum CrowdRange : uint32_t {
    kControlPoints,
    kRefinedPoints,
    kPtexFaces,
    kSurfaces,
    kRingPoints,
    kPointRuns,
    kPointIndices,
    kPointWeights,
    kRows,
    kCorners,
    kRateEdges,
    kCornerCopies,  ///< words, as kRowCopies
    kRowCopies,
    kLocalPoints,
    kCrowdRangeCount
};

/// Arrays of device tables.
enum CrowdArray : uint32_t {
    kPtexArray,
    kSurfaceArray,
    kRingArray,
    kPlanArray,
    kPlanNodeArray,
    kPlanPointArray,
    kPlanWeightArray,
    kTreeSurfaceArray,
    kTreeNodeArray,
    kLeafArray,
    kFaceArray,
    kRowArray,
    kCornerArray,
    kRateEdgeArray,
    kCornerCopyArray,
    kRowCopyArray,
    kInstanceArray,
    kWeightArray,  ///< of local points
    kTileArray,    ///< CrowdTiles::words
    kPointArray,   ///< CrowdPoints::words
    kCrowdArrayCount
};

struct Crowd::State {
    /// A plan that surfaces have: its tree.
    struct TreeClass {
        GridClass grid;
        uint32_t local_count, root, hull_count;
    };
    struct Slot {
        bool is_live = false;
        BatchMesh mesh = {};
        CrowdInstance instance = {};
        std::array<uint32_t, kCrowdRangeCount> first = {}, count = {};
        std::vector<PointItems> point_items = {};
        uint32_t tiled_surfaces = 0;  ///< that have a place in tiles
    };
    /// An array's words, and how many the device has room for.
    struct Words {
        const void* data;
        uint64_t count, capacity;
    };

    CrowdOptions options;
    std::shared_ptr<const PatchTreeCache> trees = std::make_shared<PatchTreeCache>();  ///< of all layouts
    uint64_t layout = 0;
    uint32_t instance_count = 0, instance_capacity = 0;
    PatchTable patches;
    TessellationTable topology;
    Array<TreeSurface> tree_surfaces;
    Array<uint32_t> tree_nodes, leaf_points, instance_words;
    Array<float> local_weights;
    std::vector<TreeClass> classes;
    std::vector<uint32_t> class_of_plan;
    std::unordered_map<PlanIdentity, uint32_t, PlanIdentityHash> plan_numbers;
    CrowdTiles tiles;
    CrowdPoints points;
    std::array<SlotRanges, kCrowdRangeCount> free;
    std::array<uint32_t, kCrowdRangeCount> capacity = {};
    std::array<uint64_t, kCrowdArrayCount> array_capacity = {};
    std::array<WordChanges, kCrowdArrayCount> own_changes;
    std::vector<Slot> slots;  ///< instance_capacity of them, more only while one is added

    Words words(CrowdArray array) const;
    const WordChanges& changes(CrowdArray array) const;
};

}  // namespace limn
