#include "limn/vulkan/crowd_tables.h"

#include <algorithm>

#include "limn/crowd_state.h"
#include "limn/vulkan/table_copies.h"

namespace limn::vk {
namespace {

/// An array, and the word of its buffer that it begins at.
struct Place {
    CrowdArray array;
    uint32_t* offset;
};

/// Arrays of a buffer, each behind the one before it, and the words that they take.
struct PlacedBuffer {
    std::vector<Place> places;
    uint64_t words = 0;
};

struct CrowdOffsets {
    shared::PatchTableOffsets patches = {};
    shared::TreeOffsets trees = {};
    shared::TessOffsets topology = {};
    uint32_t instances = 0, row_copies = 0, only = 0;
};

/// Offsets are those that the crowd's capacities lead to. Errors: too_large.
Result<std::vector<PlacedBuffer>> place_arrays(const Crowd::State& state, CrowdOffsets& at) {
    std::vector<PlacedBuffer> buffers = {
        {{{kPtexArray, &at.patches.ptex_surfaces},
          {kSurfaceArray, &at.patches.surfaces},
          {kRingArray, &at.patches.ring_points},
          {kPlanArray, &at.patches.plans},
          {kPlanNodeArray, &at.patches.plan_nodes},
          {kPlanPointArray, &at.patches.plan_points},
          {kPlanWeightArray, &at.patches.plan_weights}}},
        {{{kPtexArray, &at.trees.ptex_surfaces},
          {kTreeSurfaceArray, &at.trees.surfaces},
          {kTreeNodeArray, &at.trees.nodes},
          {kLeafArray, &at.trees.leaf_points},
          {kFaceArray, &at.topology.faces},
          {kRowArray, &at.topology.rows},
          {kCornerArray, &at.topology.corners},
          {kRateEdgeArray, &at.topology.rate_edges},
          {kCornerCopyArray, &at.topology.copies},
          {kRowCopyArray, &at.row_copies},
          {kInstanceArray, &at.instances}}},
        {{{kPointArray, &at.only}}},
        {{{kTileArray, &at.only}}},
        {{{kWeightArray, &at.only}}}};
    for (PlacedBuffer& b : buffers) {
        for (const Place& place : b.places) {
            *place.offset = static_cast<uint32_t>(b.words);
            b.words += (state.words(place.array).capacity + 3) / 4 * 4;
        }
        if (b.words > 0xffffffffu) return Error{ErrorCode::too_large, "a table of 2^32 words or more"};
    }
    return buffers;
}

/// All arrays where the layout is another, else what has changed in them.
void plan(const Crowd::State& state, const std::vector<PlacedBuffer>& buffers, bool all,
          TableCopies& copies) {
    for (const PlacedBuffer& b : buffers) {
        const uint32_t target = copies.add_target(all ? 4 * b.words : 0);
        for (const Place& place : b.places) {
            const Crowd::State::Words words = state.words(place.array);
            const std::span bytes(static_cast<const std::byte*>(words.data), 4 * words.count);
            if (all)
                copies.add(target, uint64_t{4} * *place.offset, bytes);
            else
                for (const BatchRange& range : state.changes(place.array).merged(kChangeGap))
                    copies.add(target, 4 * (uint64_t{*place.offset} + range.first),
                               bytes.subspan(4 * size_t{range.first}, 4 * size_t{range.count}));
        }
    }
}

std::vector<StencilRun> list_runs(const Crowd::State& state) {
    std::vector<StencilRun> runs;
    for (const PointPool& pool : state.points.pools()) {
        StencilRun run;
        run.kind = pool.is_long ? shared::kStencilRunLong : shared::kStencilRunOwn;
        run.entry_count = pool.is_long ? 0 : 2 * pool.pair_count;
        run.item_count = pool.item_count;
        run.row_end = state.patches.refined_count;
        run.source_max = state.patches.control_count - 1;
        run.begin = pool.begin;
        run.end = pool.end;
        run.index_offset = pool.index_offset;
        run.weight_offsets[0] = pool.weight_offset;
        run.row_offset = pool.row_offset;
        runs.push_back(run);
    }
    return runs;
}

/// Those of a pass one after the other: they are bound together.
std::vector<GridBatch> list_batches(const Crowd::State& state) {
    std::vector<GridBatch> batches;
    for (const TilePool& pool : state.tiles.pools())
        batches.push_back({pool.group_count, pool.sample_count, shared::kGridCornersFirst, pool.pass,
                           shared::kGridMaxTileSurfaces,
                           state.tiles.tile_base() + pool.first_tile * kCrowdTileWords, pool.tile_count});
    std::stable_sort(batches.begin(), batches.end(),
                     [](const GridBatch& a, const GridBatch& b) { return a.pass < b.pass; });
    return batches;
}

void describe(const Crowd::State& state, const CrowdOffsets& at, DeviceCrowd& out) {
    const PatchTable& patches = state.patches;
    const TessellationTable& topology = state.topology;
    DevicePatchTable& p = out.patches;
    p.scheme = patches.options.scheme;
    p.end_cap = patches.end_cap;
    p.control_count = patches.control_count;
    p.first_refined = patches.first_refined;
    p.point_count = patches.point_count();
    p.ptex_count = topology.face_count;
    for (const Plan& plan : patches.plans) p.max_ring_size = std::max(p.max_ring_size, plan.ring_size);
    p.offsets = at.patches;
    p.points.source_count = patches.control_count;
    p.points.row_count = patches.refined_count;
    p.points.runs = list_runs(state);
    DeviceTessellationTable& t = out.topology;
    t.scheme = patches.options.scheme;
    t.face_count = topology.face_count;
    t.row_count = topology.row_count;
    t.corner_count = topology.corner_count;
    t.rate_edge_count = topology.rate_edge_count;
    t.corner_copy_count = topology.corner_copy_count();
    t.row_copy_count = topology.row_copy_count();
    t.instance_count = state.instance_capacity;
    t.max_rate = state.options.max_rate;
    t.offsets = at.topology;
    t.instances_offset = at.instances;
    t.vertices.offsets = at.trees;
    t.vertices.local_count = state.capacity[kLocalPoints];
    DeviceGridTable& grid = t.vertices.local_points;
    grid.value_count = 1;
    grid.ptex_count = topology.face_count;
    grid.samples_per_face = 1;
    grid.faces_per_pass = state.options.points_per_pass;
    grid.changes = true;
    grid.batches = list_batches(state);
    grid.total_sample_count = t.vertices.local_count;
}

}  // namespace

Result<TableUpdate> record_crowd_update(const Device& device, VkCommandBuffer command_buffer,
                                        const Crowd& crowd, DeviceCrowd& table) {
    const Crowd::State& state = crowd.state();
    TableUpdate update;
    CrowdOffsets offsets;
    const auto buffers = place_arrays(state, offsets);
    if (!buffers) return buffers.error();
    const bool all = table.layout != crowd.layout();
    update.prepare_again = all || table.patches.points.runs.size() != state.points.pools().size() ||
                           table.topology.vertices.local_points.batches.size() != state.tiles.pools().size();
    TableCopies copies;
    plan(state, *buffers, all, copies);
    DeviceGridTable& local_points = table.topology.vertices.local_points;
    Buffer* const targets[] = {&table.patches.words, &table.topology.words, &table.patches.points.data, &local_points.words,
                               &local_points.weights};
    if (auto recorded = copies.record(device, command_buffer, targets, update); !recorded) return recorded.error();
    const uint32_t max_ring_size = table.patches.max_ring_size;
    describe(state, offsets, table);
    update.prepare_again |= table.patches.max_ring_size != max_ring_size;  // evaluations of samples have room for that
    table.layout = crowd.layout();
    return update;
}

Result<MemoryNeed> crowd_update_memory(const Device& device, const Crowd& crowd, const DeviceCrowd& table) {
    const Crowd::State& state = crowd.state();
    CrowdOffsets offsets;
    const auto buffers = place_arrays(state, offsets);
    if (!buffers) return buffers.error();
    TableCopies copies;
    plan(state, *buffers, table.layout != crowd.layout(), copies);
    return copies.memory(device);
}

MemoryNeed crowd_tessellation_memory(const Crowd& crowd, bool previous_points) {
    const TessellationTable& topology = crowd.topology();
    const uint32_t local_count = crowd.state().capacity[kLocalPoints];
    MemoryNeed need = {
        4ull * shared::tess_state_words(topology.rate_edge_count, topology.face_count, topology.row_count), 0,
        1};
    for (int i = 0; i < (previous_points ? 2 : 1); ++i)
        need += {std::max<uint64_t>(16, uint64_t{16} * local_count), 0, 1};
    return need;
}

}  // namespace limn::vk
