#include "limn/vulkan/surface_evaluator.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "limn/shared/grid_eval_params.h"
#include "limn/shared/tree_eval_params.h"
#include "limn/vulkan/surface_reads.h"
#include "limn_kernels/grid_eval.h"
#include "limn_kernels/grid_eval_texel.h"
#include "limn_kernels/grid_rows_texel.h"
#include "limn_kernels/patch_eval.h"
#include "limn_kernels/patch_eval_texel.h"
#include "limn_kernels/tree_eval.h"
#include "limn_kernels/tree_eval_texel.h"

namespace limn::vk {
namespace {

using shared::GridEvalParams;
using shared::PatchEvalParams;
using shared::TreeEvalParams;

enum KernelName : uint32_t { kGrid, kPatch, kTree, kGridRows, kKernelCount };  ///< the last for CPU devices only
constexpr uint32_t kMaxInvocations = 128;  // of a workgroup: what every device has

Result<void> check(const DevicePatchTable* patches, uint32_t width, const PointBuffer& points) {
    if (patches == nullptr) return bad_argument("there is no patch table to evaluate");
    if (width < 1 || width > 4) return bad_argument("points have 1 to 4 components here");
    return check_points(points, width);
}

Result<void> check(const GridEvaluationInfo& info) {
    if (auto checked = check(info.patches, info.width, info.points); !checked) return checked;
    if (info.grid == nullptr) return bad_argument("there is no grid to evaluate");
    if (info.grid->ptex_count != info.patches->ptex_count) return bad_argument("the grid is of another patch table");
    if (auto checked = check_points(info.values, info.width); !checked) return checked;
    const bool normals = info.normals.buffer != VK_NULL_HANDLE, du = info.du.buffer != VK_NULL_HANDLE,
               dv = info.dv.buffer != VK_NULL_HANDLE;
    if (du != dv || (normals && du)) return bad_argument("a grid gives normals, or both du and dv");
    if ((normals || du) && info.grid->value_count != 3) return bad_argument("the grid was built without derivatives");
    if (normals && info.width != 3) return bad_argument("normals are of points of three components");
    if (info.packed_normals && !normals) return bad_argument("there are no normals to pack");
    for (const PointBuffer* points : {&info.normals, &info.du, &info.dv})
        if (points->buffer != VK_NULL_HANDLE)
            if (auto checked = check_points(*points, info.packed_normals ? 1 : info.width); !checked) return checked;
    return {};
}

/// A grid, and where its rings are: in a patch table, or in a buffer of their own.
struct GridJob {
    GridEvaluationInfo info;
    VkBuffer rings;
    VkDeviceSize rings_bytes;
    uint32_t ring_base, narrow_rings, point_count;
    bool refined;
};

uint64_t group_count_of(const GridBatch& batch, uint32_t chunk_count) {
    return batch.by_rows ? (uint64_t{batch.tile_count} + shared::kGridRowsWorkgroupSize - 1) / shared::kGridRowsWorkgroupSize
                         : uint64_t{batch.tile_count} * chunk_count;
}

}  // namespace

struct SurfaceEvaluation::State {
    Recording recording;
    /// Samples that patch trees leave to the general evaluation (patch_eval_params.h), for each window, and where those begin.
    Buffer deferred;
    std::vector<VkDeviceSize> deferred_bytes;
    std::vector<Recording::Dispatch> deferred_dispatches;
    const DeviceGridTable* grid = nullptr;  ///< of one that changes: its batches are the dispatches

    void record_with_deferred(VkCommandBuffer command_buffer) const;
    void record_batches(VkCommandBuffer command_buffer) const;
};
SurfaceEvaluation::SurfaceEvaluation() : state_(std::make_unique<State>()) {}
SurfaceEvaluation::SurfaceEvaluation(SurfaceEvaluation&&) noexcept = default;
SurfaceEvaluation& SurfaceEvaluation::operator=(SurfaceEvaluation&&) noexcept = default;
SurfaceEvaluation::~SurfaceEvaluation() = default;
void SurfaceEvaluation::State::record_with_deferred(VkCommandBuffer commands) const {
    const Device& device = *recording.device;
    constexpr StageAccess kernels = kKernelReads | kKernelWrites, deferred_reads = kIndirectReads | kKernelReads;
    record_barrier(device, commands, deferred_reads, kCopyWrites);  // after what was recorded of it before
    for (const VkDeviceSize begin : deferred_bytes) {
        device.functions.CmdFillBuffer(commands, deferred.handle, begin, 8, 0);
        device.functions.CmdFillBuffer(commands, deferred.handle, begin + 8, 8, 1);
    }
    record_barrier(device, commands, kCopyWrites, kernels);
    recording.record(commands);
    record_barrier(device, commands, kKernelWrites, deferred_reads);
    recording.record(commands, deferred_dispatches);
}

/// With as many tiles as the table has now.
void SurfaceEvaluation::State::record_batches(VkCommandBuffer command_buffer) const {
    Recording::Bound bound;
    for (size_t i = 0; i < recording.dispatches.size(); ++i) {
        Recording::Dispatch dispatch = recording.dispatches[i];
        GridEvalParams params;
        std::memcpy(&params, dispatch.push_constants.data(), sizeof params);
        params.tile_count = grid->batches[i].tile_count;
        std::memcpy(dispatch.push_constants.data(), &params, sizeof params);
        recording.set_groups(dispatch, group_count_of(grid->batches[i], params.chunk_count));
        recording.record(command_buffer, dispatch, bound);
    }
}

void SurfaceEvaluation::record(VkCommandBuffer command_buffer) const {
    if (state_->grid != nullptr) return state_->record_batches(command_buffer);
    if (state_->deferred_dispatches.empty())
        state_->recording.record(command_buffer);
    else
        state_->record_with_deferred(command_buffer);
}
uint32_t SurfaceEvaluation::dispatch_count() const {
    return static_cast<uint32_t>(state_->recording.dispatches.size() + state_->deferred_dispatches.size());
}

struct SurfaceEvaluator::State {
    const Device* device = nullptr;
    Evaluator stencils;
    Kernel kernels[kKernelCount];
    bool texel = false, point_texels = false;

    explicit State(Evaluator evaluator) : stencils(std::move(evaluator)) {}
    Reads reads() const { return {device->properties.limits, texel, point_texels}; }

    Result<VkPipeline> pipeline(KernelName name, const std::vector<uint32_t>& constants) const {
        return kernels[name].pipeline(constants);
    }
    Result<SurfaceEvaluation> prepare(const PatchEvaluationInfo& info, uint32_t values);
    Result<SurfaceEvaluation> prepare(const GridJob& job) const;
    Result<SurfaceEvaluation> prepare_with_trees(const PatchEvaluationInfo& info, uint32_t values);
    void begin(KernelName name, uint32_t push_constant_bytes, Recording& recording) const {
        recording.device = device;
        recording.layout = kernels[name].layout;
        recording.push_constant_bytes = push_constant_bytes;
    }
};

SurfaceEvaluator::SurfaceEvaluator() = default;
SurfaceEvaluator::SurfaceEvaluator(SurfaceEvaluator&&) noexcept = default;
SurfaceEvaluator& SurfaceEvaluator::operator=(SurfaceEvaluator&&) noexcept = default;
SurfaceEvaluator::~SurfaceEvaluator() = default;

Result<SurfaceEvaluator> SurfaceEvaluator::create(const Device& device) {
    auto stencils = Evaluator::create(device);
    if (!stencils) return stencils.error();
    SurfaceEvaluator evaluator;
    evaluator.state_ = std::make_unique<State>(std::move(*stencils));
    State& state = *evaluator.state_;
    state.device = &device;
    state.texel = reads_texels(device);
    state.point_texels = reads_point_texels(device);
    const VkDescriptorType read =
        state.texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    std::vector<VkDescriptorType> grid(shared::kGridBindingCount, read),
        patch(shared::kPatchBindingCount, read);
    for (const uint32_t b :
         {shared::kGridValuesBinding, shared::kGridSecondBinding, shared::kGridThirdBinding})
        grid[b] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    for (const uint32_t b :
         {shared::kPatchResultsBinding, shared::kPatchStatusesBinding, shared::kPatchDeferredBinding})
        patch[b] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    const auto spirv = [&](std::span<const uint32_t> storage, std::span<const uint32_t> texel) {
        return state.texel ? texel : storage;
    };
    const KernelInfo infos[kKernelCount] = {
        {spirv(kGridEval, kGridEvalTexel), grid, sizeof(GridEvalParams)},
        {spirv(kPatchEval, kPatchEvalTexel), patch, sizeof(PatchEvalParams)},
        {spirv(kTreeEval, kTreeEvalTexel), patch, sizeof(PatchEvalParams)},  // of one layout, for both to be recorded
        {kGridRowsTexel, grid, sizeof(GridEvalParams)}};
    for (uint32_t k = 0; k < (state.texel ? kKernelCount : kGridRows); ++k) {
        auto kernel = create_kernel(device, infos[k]);
        if (!kernel) return kernel.error();
        state.kernels[k] = std::move(*kernel);
    }
    return evaluator;
}

Result<StencilEvaluation> SurfaceEvaluator::prepare_points(const SurfacePointsInfo& info) const {
    if (info.patches == nullptr) return bad_argument("there is no patch table to evaluate");
    PointBuffer refined = info.points;
    refined.first += uint64_t{info.patches->first_refined} * info.points.stride;
    return state_->stencils.prepare({.table = &info.patches->points,
                                     .width = info.width,
                                     .source = info.points,
                                     .destination = refined,
                                     .storage_only_source = info.storage_only_source});
}

namespace {

/// Position and normal of a sample are six floats in a row.
bool are_adjacent(const GridEvaluationInfo& info) {
    return info.normals.buffer == info.values.buffer && info.normals.stride == info.values.stride &&
           byte_of(info.normals, 0, 0) == byte_of(info.values, 0, 3);
}

/// Words of a normal, and of a value that has its normal behind it.
uint32_t normal_words(const GridEvaluationInfo& info) {
    return info.packed_normals ? 1 : 3;
}
uint32_t adjacent_words(const GridEvaluationInfo& info) {
    return info.packed_normals ? 4 : 6;
}
/// Whether value and normal are written at once, as kGridAdjacentConstant says.
bool are_written_at_once(const GridEvaluationInfo& info, uint32_t value_base) {
    const uint32_t alignment = info.packed_normals ? 4 : 2;
    return are_adjacent(info) && info.values.stride % alignment == 0 && value_base % alignment == 0;
}

/// What the batches of one pass bind.
std::vector<BoundBuffer> bind_grid(const GridJob& job, const Reads& reads, uint32_t pass) {
    const GridEvaluationInfo& info = job.info;
    const DeviceGridTable& grid = *info.grid;
    const uint64_t first = uint64_t{pass} * grid.faces_per_pass * grid.samples_per_face;
    const uint64_t last =
        std::min(grid.sample_count(), first + uint64_t{grid.faces_per_pass} * grid.samples_per_face) - 1;
    auto write = [&](const PointBuffer& points, uint32_t width) {
        const PointBuffer& p = points.buffer != VK_NULL_HANDLE ? points : info.values;
        return reads.write(p.buffer, byte_of(p, first, 0), byte_of(p, last, width));
    };
    const bool normals = info.normals.buffer != VK_NULL_HANDLE;
    return {reads.bind(job.rings, 0, job.rings_bytes, kWords),
            reads.bind(grid.words.handle, 0, grid.words.size_bytes, kWords),
            reads.bind(grid.weights.handle, 0, grid.weights.size_bytes, kGroups),
            reads.bind(info.points.buffer, byte_of(info.points, 0, 0), byte_of(info.points, job.point_count - 1, info.width),
                       reads.are_texels(info.points, info.width) ? kPoints : kFloats),
            write(info.values, are_adjacent(info) ? adjacent_words(info) : info.width),
            normals ? write(info.normals, normal_words(info)) : write(info.du, info.width),
            write(info.dv, info.width)};
}

/// Of a workgroup. Local points of patch trees (patch_tree.h) come in any number; with few sizes of workgroups there are
/// few pipelines.
uint32_t most_invocations(const DeviceGridTable& grid, const GridBatch& batch) {
    if (grid.rate != 0) return kMaxInvocations;
    for (const uint32_t size : {64u, 32u})
        if ((batch.sample_count + size - 1) / size * size <= batch.sample_count + batch.sample_count / 5) return size;
    return 16;
}

GridEvalParams grid_params(const GridJob& job, std::span<const BoundBuffer> bound, const GridBatch& batch) {
    const GridEvaluationInfo& info = job.info;
    const uint64_t first = uint64_t{batch.pass} * info.grid->faces_per_pass * info.grid->samples_per_face;
    const bool normals = info.normals.buffer != VK_NULL_HANDLE;
    const PointBuffer& second = normals ? info.normals : info.du;
    GridEvalParams params = {};
    params.tile_base = batch.tile_base;
    params.tile_count = batch.tile_count;
    params.rate = info.grid->rate;
    params.chunk_count = batch.by_rows ? 1 : (batch.sample_count - 1) / most_invocations(*info.grid, batch) + 1;
    params.sample_count = batch.sample_count;
    params.samples_per_face = info.grid->samples_per_face;
    params.ring_base = job.ring_base;
    params.point_base = Reads::base(info.points, 0, bound[shared::kGridPointsBinding]);
    params.point_stride = info.points.stride;
    if (bound[shared::kGridPointsBinding].format == kPoints) {
        params.point_base /= 3;
        params.point_stride /= 3;
    }
    params.value_base = Reads::base(info.values, first, bound[shared::kGridValuesBinding]);
    params.value_stride = info.values.stride;
    if (second.buffer != VK_NULL_HANDLE) {
        params.second_base = Reads::base(second, first, bound[shared::kGridSecondBinding]);
        params.second_stride = second.stride;
    }
    if (!normals && info.dv.buffer != VK_NULL_HANDLE) {
        params.third_base = Reads::base(info.dv, first, bound[shared::kGridThirdBinding]);
        params.third_stride = info.dv.stride;
    }
    return params;
}

/// Specialization of grid_eval. `lanes`: invocations of a workgroup are a multiple of it.
std::vector<uint32_t> tile_constants(const GridJob& job, const GridBatch& batch, uint32_t output, uint32_t adjacent,
                                     uint32_t texels, uint32_t lanes) {
    const GridEvaluationInfo& info = job.info;
    const uint32_t most = most_invocations(*info.grid, batch);
    const uint32_t per_chunk = (batch.sample_count - 1) / ((batch.sample_count - 1) / most + 1) + 1;
    const uint32_t invocations = info.grid->rate != 0 ? std::min(most, (per_chunk + lanes - 1) / lanes * lanes) : most;
    return {std::min(batch.group_count, 8u), output, info.width, job.narrow_rings, invocations, info.grid->value_count,
            batch.group_count > 8 ? batch.group_count / 8 : 1, batch.corners, batch.tile_surfaces, adjacent, job.refined,
            texels};
}

}  // namespace

Result<SurfaceEvaluation> SurfaceEvaluator::prepare_grid(const GridEvaluationInfo& info) const {
    if (auto checked = check(info); !checked) return checked.error();
    const DevicePatchTable& patches = *info.patches;
    return state_->prepare({info, patches.words.handle, patches.words.size_bytes, patches.offsets.ring_points,
                            patches.narrow_rings, patches.point_count, false});
}

Result<SurfaceEvaluation> SurfaceEvaluator::prepare_refined(const RefinedGridInfo& info) const {
    if (info.table == nullptr) return bad_argument("there is no refined grid to evaluate");
    if (info.width < 1 || info.width > 4) return bad_argument("points have 1 to 4 components here");
    for (const PointBuffer* points : {&info.source, &info.refined})
        if (auto checked = check_points(*points, info.width); !checked) return checked.error();
    return state_->prepare(
        {{.grid = &info.table->grid, .width = info.width, .points = info.source, .values = info.refined},
         info.table->rings.handle, info.table->rings.size_bytes, 0, false, info.table->source_count, true});
}

/// Checked.
Result<SurfaceEvaluation> SurfaceEvaluator::State::prepare(const GridJob& job) const {
    const GridEvaluationInfo& info = job.info;
    SurfaceEvaluation evaluation;
    if (info.grid->changes) evaluation.state_->grid = info.grid;
    Recording& recording = evaluation.state_->recording;
    begin(kGrid, sizeof(GridEvalParams), recording);
    const uint32_t output = info.grid->relative                     ? shared::kGridOutputRelative
                            : info.packed_normals                   ? shared::kGridOutputPackedNormal
                            : info.normals.buffer != VK_NULL_HANDLE ? shared::kGridOutputNormal
                            : info.du.buffer != VK_NULL_HANDLE    ? shared::kGridOutputDerivatives
                                                                  : shared::kGridOutputValue;
    std::vector<BoundBuffer> bound;
    VkDescriptorSet set = VK_NULL_HANDLE;
    uint32_t bound_pass = ~0u;
    for (const GridBatch& batch : info.grid->batches) {
        if (batch.pass != bound_pass) {
            bound_pass = batch.pass;
            bound = bind_grid(job, reads(), batch.pass);
            auto added = recording.add_set(kernels[kGrid].set_layout, bound);
            if (!added) return added.error();
            set = *added;
        }
        const GridEvalParams params = grid_params(job, bound, batch);
        const uint32_t adjacent = are_written_at_once(info, params.value_base);
        const uint32_t texels = bound[shared::kGridPointsBinding].format == kPoints;
        const bool rows = batch.by_rows;
        auto made = pipeline(rows ? kGridRows : kGrid,
                             rows ? std::vector<uint32_t>{0, output, info.width, job.narrow_rings, 0, 0, 0, 0, 0, adjacent,
                                                          job.refined, texels, batch.sample_count}
                                  : tile_constants(job, batch, output, adjacent, texels, texel ? 8 : 32));
        if (!made) return made.error();
        recording.add_dispatch(*made, set, group_count_of(batch, params.chunk_count), params);
    }
    return evaluation;
}

namespace {

Result<void> check(const SampleBuffer& samples, const PointBuffer& statuses) {
    if (samples.buffer == VK_NULL_HANDLE) return bad_argument("the buffer of samples is null");
    if (samples.offset_bytes % 4 != 0) return bad_argument("offset_bytes of samples is not a multiple of 4");
    if (statuses.buffer == VK_NULL_HANDLE) return {};
    if (statuses.stride != 1 || statuses.offset_bytes % 4 != 0)
        return bad_argument("statuses have a stride other than 1, or an offset that is not a multiple of 4");
    return {};
}

/// Of places and of values: `values` for each sample, 0 of places, whose records are as long as `record`.
struct SampleJob {
    const PatchEvaluationInfo& info;
    uint32_t values, record;
};

/// The part of the samples that one dispatch evaluates, and what is deferred of it, if anything can be.
struct SampleWindow {
    uint64_t first, end;
    BoundBuffer deferred = {};
};

/// What a window binds from its samples on.
void bind_window(const SampleJob& job, const Reads& reads, const SampleWindow& window, std::vector<BoundBuffer>& bound) {
    const PatchEvaluationInfo& info = job.info;
    const BoundBuffer results = reads.write(info.results.buffer, byte_of(info.results, window.first, 0),
                                            byte_of(info.results, window.end - 1, job.record));
    bound.push_back(reads.bind(info.samples.buffer, info.samples.offset_bytes + 12 * window.first,
                               info.samples.offset_bytes + 12 * window.end, kWords));
    bound.push_back(results);
    bound.push_back(info.statuses.buffer == VK_NULL_HANDLE
                        ? results
                        : reads.write(info.statuses.buffer, byte_of(info.statuses, window.first, 0),
                                      byte_of(info.statuses, window.end - 1, 1)));
    bound.push_back(window.deferred.buffer == VK_NULL_HANDLE ? results : window.deferred);
}

std::vector<BoundBuffer> bind_samples(const SampleJob& job, const Reads& reads, const SampleWindow& window) {
    const PatchEvaluationInfo& info = job.info;
    const VkBuffer words = info.patches->words.handle;
    const uint64_t table_bytes = info.patches->words.size_bytes;
    std::vector<BoundBuffer> bound = {
        reads.bind(words, 0, table_bytes, kWords), reads.bind(words, 0, table_bytes, kGroups),
        job.values == 0 ? reads.bind(words, 0, table_bytes, kFloats)  // not read
                        : reads.bind(info.points.buffer, byte_of(info.points, 0, 0),
                                     byte_of(info.points, info.patches->point_count - 1, info.width), kFloats)};
    bind_window(job, reads, window, bound);
    return bound;
}
std::vector<BoundBuffer> bind_trees(const SampleJob& job, const Reads& reads, const SampleWindow& window) {
    const DevicePatchTrees& trees = *job.info.trees;
    std::vector<BoundBuffer> bound = {
        reads.bind(trees.words.handle, 0, trees.words.size_bytes, kWords),
        reads.bind(trees.words.handle, 0, trees.words.size_bytes, kWordGroups),
        reads.bind(job.info.local_points, 0, std::max<uint64_t>(1, trees.local_count) * 16, kGroups)};
    bind_window(job, reads, window, bound);
    return bound;
}

shared::SampleParams list_params(const SampleJob& job, std::span<const BoundBuffer> bound, const SampleWindow& window) {
    const PatchEvaluationInfo& info = job.info;
    const uint64_t samples_at = info.samples.offset_bytes + 12 * window.first;
    shared::SampleParams params = {};
    params.ptex_count = info.patches->ptex_count;
    params.sample_count = static_cast<uint32_t>(window.end - window.first);
    params.first_sample =
        static_cast<uint32_t>((samples_at - bound[shared::kPatchSamplesBinding].offset_bytes) / 4);
    params.result_base = Reads::base(info.results, window.first, bound[shared::kPatchResultsBinding]);
    params.result_stride = info.results.stride;
    params.status_base = info.statuses.buffer == VK_NULL_HANDLE
                             ? shared::kPatchNoStatus
                             : Reads::base(info.statuses, window.first, bound[shared::kPatchStatusesBinding]);
    return params;
}

PatchEvalParams sample_params(const SampleJob& job, std::span<const BoundBuffer> bound, const SampleWindow& window) {
    PatchEvalParams params = {.list = list_params(job, bound, window), .table = job.info.patches->offsets};
    if (job.values != 0) {
        params.point_base = Reads::base(job.info.points, 0, bound[shared::kPatchPointsBinding]);
        params.point_stride = job.info.points.stride;
    }
    return params;
}

/// Of both kernels, in the order of the specialization constants.
std::vector<uint32_t> sample_constants(const SampleJob& job, bool deferred) {
    const PatchEvaluationInfo& info = job.info;
    const uint64_t first_word = byte_of(info.results, 0, 0) / 4;
    return {info.width,
            job.values,
            info.patches->narrow_rings,
            info.patches->scheme == Scheme::loop,
            std::bit_ceil(std::max(16u, job.values == 0 ? 1 : info.patches->max_ring_size)),
            static_cast<uint32_t>(info.patches->end_cap),
            deferred,
            info.results.stride % 2 == 0 && first_word % 2 == 0};
}

/// As many at once as the device can bind of any of the buffers, and as workgroups fit into one dimension.
uint64_t window_size(uint32_t result_stride, const VkPhysicalDeviceLimits& limits) {
    const uint64_t largest = std::max<uint64_t>(12, 4ull * result_stride);
    return std::clamp<uint64_t>((limits.maxStorageBufferRange - 256) / largest, 1,
                                uint64_t{limits.maxComputeWorkGroupCount[0]} * shared::kPatchWorkgroupSize);
}
/// Of the samples that a window defers.
uint64_t list_bytes(uint64_t sample_count, const VkPhysicalDeviceLimits& limits) {
    const uint64_t alignment = limits.minStorageBufferOffsetAlignment;
    return (4 * (sample_count + shared::kDeferredHeader) + alignment - 1) / alignment * alignment;
}
uint64_t group_count(const SampleWindow& window) {
    return (window.end - window.first + shared::kPatchWorkgroupSize - 1) / shared::kPatchWorkgroupSize;
}

Result<void> check_trees(const DevicePatchTable* patches, const DevicePatchTrees* trees, VkBuffer local_points) {
    if (trees == nullptr || local_points == VK_NULL_HANDLE)
        return bad_argument("patch trees and local points go together");
    if (trees->local_points.ptex_count != patches->ptex_count)
        return bad_argument("the patch trees are of another patch table");
    if (!trees->local_points.relative || trees->words.handle == VK_NULL_HANDLE)
        return bad_argument("these patch trees were not built for samples (PatchTreeOptions::relative)");
    return {};
}

}  // namespace

MemoryNeed sample_memory(const Device& device, uint32_t sample_count, uint32_t result_stride) {
    const VkPhysicalDeviceLimits& limits = device.properties.limits;
    const uint64_t size = window_size(result_stride, limits), windows = (sample_count + size - 1) / size;
    return {std::max<uint64_t>(4, windows * list_bytes(std::min<uint64_t>(size, sample_count), limits)), 0, 1};
}

Result<SurfaceEvaluation> SurfaceEvaluator::prepare_locations(const LocationInfo& info) const {
    if (info.patches == nullptr) return bad_argument("there is no patch table to evaluate");
    if (auto checked = check_points(info.places, 5); !checked) return checked.error();
    return state_->prepare(
        {.patches = info.patches, .samples = info.samples, .results = info.places, .statuses = info.statuses},
        0);
}

Result<SurfaceEvaluation> SurfaceEvaluator::prepare_local_points(const LocalPointsInfo& info) const {
    if (auto checked = check(info.patches, info.width, info.points); !checked) return checked.error();
    if (auto checked = check_trees(info.patches, info.trees, info.local_points); !checked) return checked.error();
    return prepare_grid({.patches = info.patches,
                         .grid = &info.trees->local_points,
                         .width = info.width,
                         .points = info.points,
                         .values = {.buffer = info.local_points, .stride = 4}});
}

Result<SurfaceEvaluation> SurfaceEvaluator::prepare_samples(const PatchEvaluationInfo& info) const {
    const uint32_t values = value_count(info.derivatives);
    if (auto checked = check(info.patches, info.width, info.points); !checked) return checked.error();
    if (auto checked = check_points(info.results, info.width * values); !checked) return checked.error();
    if (info.trees == nullptr && info.local_points == VK_NULL_HANDLE) return state_->prepare(info, values);
    if (auto checked = check_trees(info.patches, info.trees, info.local_points); !checked) return checked.error();
    return state_->prepare_with_trees(info, values);
}

/// Checked, but for samples and statuses.
Result<SurfaceEvaluation> SurfaceEvaluator::State::prepare(const PatchEvaluationInfo& info, uint32_t values) {
    if (auto checked = check(info.samples, info.statuses); !checked) return checked.error();
    SurfaceEvaluation evaluation;
    Recording& recording = evaluation.state_->recording;
    begin(kPatch, sizeof(PatchEvalParams), recording);
    const SampleJob job{info, values, values == 0 ? 5 : values * info.width};
    auto pipeline = this->pipeline(kPatch, sample_constants(job, false));
    if (!pipeline) return pipeline.error();
    const uint64_t size = window_size(info.results.stride, device->properties.limits);
    for (uint64_t first = 0; first < info.samples.count; first += size) {
        const SampleWindow window = {first, std::min<uint64_t>(info.samples.count, first + size)};
        const std::vector<BoundBuffer> bound = bind_samples(job, reads(), window);
        auto set = recording.add_set(kernels[kPatch].set_layout, bound);
        if (!set) return set.error();
        recording.add_dispatch(*pipeline, *set, group_count(window), sample_params(job, bound, window));
    }
    return evaluation;
}

/// Samples by their trees, and then the few that those leave.
Result<SurfaceEvaluation> SurfaceEvaluator::State::prepare_with_trees(const PatchEvaluationInfo& info, uint32_t values) {
    if (auto checked = check(info.samples, info.statuses); !checked) return checked.error();
    SurfaceEvaluation evaluation;
    SurfaceEvaluation::State& out = *evaluation.state_;
    begin(kTree, sizeof(PatchEvalParams), out.recording);
    const SampleJob job{info, values, values * info.width};
    auto tree_pipeline = pipeline(kTree, sample_constants(job, false));
    if (!tree_pipeline) return tree_pipeline.error();
    auto deferred_pipeline = pipeline(kPatch, sample_constants(job, true));
    if (!deferred_pipeline) return deferred_pipeline.error();
    const VkPhysicalDeviceLimits& limits = device->properties.limits;
    const uint64_t size = window_size(info.results.stride, limits), windows = (info.samples.count + size - 1) / size;
    auto deferred = create_buffer(*device, sample_memory(*device, info.samples.count, info.results.stride).device_bytes,
                                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                  MemoryUse::device);
    if (!deferred) return deferred.error();
    out.deferred = std::move(*deferred);
    for (uint64_t w = 0; w < windows; ++w) {
        const uint64_t first = w * size, end = std::min<uint64_t>(info.samples.count, first + size);
        const VkDeviceSize begin = w * list_bytes(size, limits);
        const SampleWindow window = {
            first, end, {out.deferred.handle, begin, list_bytes(end - first, limits), VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}};
        const std::vector<BoundBuffer> bound_trees = bind_trees(job, reads(), window),
                                       bound_samples = bind_samples(job, reads(), window);
        auto tree_set = out.recording.add_set(kernels[kTree].set_layout, bound_trees);
        if (!tree_set) return tree_set.error();
        auto deferred_set = out.recording.add_set(kernels[kPatch].set_layout, bound_samples);
        if (!deferred_set) return deferred_set.error();
        out.recording.add_dispatch(*tree_pipeline, *tree_set, group_count(window),
                                   TreeEvalParams{list_params(job, bound_trees, window), info.trees->offsets});
        auto dispatch = out.recording.make_dispatch(*deferred_pipeline, *deferred_set, 1,
                                                    sample_params(job, bound_samples, window));
        dispatch.indirect = out.deferred.handle;
        dispatch.indirect_bytes = begin + 4 * shared::kDeferredGroups;
        out.deferred_dispatches.push_back(dispatch);
        out.deferred_bytes.push_back(begin);
    }
    return evaluation;
}

}  // namespace limn::vk
