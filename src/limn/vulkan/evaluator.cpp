#include "limn/vulkan/evaluator.h"

#include <algorithm>
#include <tuple>

#include "limn/shared/stencil_eval_params.h"
#include "limn/vulkan/pipeline.h"
#include "limn/vulkan/point_buffers.h"
#include "limn_kernels/stencil_eval.h"
#include "limn_kernels/stencil_eval_texel.h"
#include "limn_kernels/stencil_eval_texel_point.h"

namespace limn::vk {
namespace {

using shared::StencilEvalParams;

constexpr uint32_t kBindingCount = 3;
constexpr uint32_t kMaxUnrolledEntries = 32;
constexpr VkDescriptorType kStorageBindings[kBindingCount] = {
    VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
constexpr VkDescriptorType kTexelBindings[kBindingCount] = {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
                                                            VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
                                                            VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
/// How a kernel reads table and source: storage buffers, texel buffers, or texel buffers whose texels are points of
/// three or four floats.
enum Variant : uint32_t { kStorage, kTexel, kTexel3, kTexel4, kVariantCount };

/// Texel formats of table and source.
constexpr VkFormat kTableFormat = VK_FORMAT_R32G32_UINT;
constexpr VkFormat kSourceFormats[kVariantCount] = {VK_FORMAT_UNDEFINED, VK_FORMAT_R32_SFLOAT,
                                                    VK_FORMAT_R32G32B32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT};
/// Floats of what a kernel reads of the source at once.
constexpr uint32_t kSourceFloats[kVariantCount] = {1, 1, 3, 4};

/// Bytes [begin, end) of a buffer.
struct Range {
    uint64_t begin = 0, end = 0;
};

/// What a descriptor set binds: table, source, destination.
struct BoundRanges {
    VkBuffer destination = VK_NULL_HANDLE;
    Range ranges[kBindingCount];
};

/// How much can be bound at once, and from where.
struct BindingLimit {
    uint64_t alignment = 4;  ///< of the first byte
    uint64_t element_bytes = 4;
    uint64_t max_bytes = 0;

    uint64_t align(uint64_t offset) const { return align_elements(offset, alignment, element_bytes); }
    bool fits(Range range) const { return range.end - align(range.begin) <= max_bytes; }
};

struct Dispatch {
    VkPipeline pipeline = VK_NULL_HANDLE;
    uint32_t set = 0;
    uint32_t groups[2] = {};
    StencilEvalParams params = {};
};

Result<void> check(const StencilEvaluationInfo& info) {
    if (info.table == nullptr) return bad_argument("there is no table to evaluate");
    if (info.width == 0) return bad_argument("points have no components");
    for (const PointBuffer* points : {&info.source, &info.destination, &info.tangent1, &info.tangent2}) {
        const bool tangent = points == &info.tangent1 || points == &info.tangent2;
        if (tangent && points->buffer == VK_NULL_HANDLE) continue;
        if (tangent && !info.table->has_tangents)
            return bad_argument("tangents are asked for, but the table has none");
        if (auto checked = check_points(*points, info.width); !checked) return checked;
    }
    return {};
}

}  // namespace

struct StencilEvaluation::State {
    const Device* device = nullptr;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkDescriptorPool pool = VK_NULL_HANDLE;
    std::vector<VkDescriptorSet> sets;
    std::vector<VkBufferView> views;
    std::vector<Dispatch> dispatches;

    ~State() {
        const Functions& functions = device->functions;
        for (const VkBufferView view : views) functions.DestroyBufferView(device->handle, view, device->host_allocator);
        if (pool != VK_NULL_HANDLE) functions.DestroyDescriptorPool(device->handle, pool, device->host_allocator);
    }
};

struct Evaluator::State {
    const Device* device = nullptr;
    Kernel kernels[kVariantCount];
    bool prefer_texel = false;
    bool has_texel3 = false;  ///< kTexel3's format

    Result<VkPipeline> pipeline(Variant variant, const StencilRun& run, uint32_t width) const {
        const bool unrolled = run.kind == shared::kStencilRunShared || run.entry_count <= kMaxUnrolledEntries;
        const uint32_t constants[4] = {run.kind, unrolled ? run.entry_count : 0, width, run.has_consecutive_rows()};
        return kernels[variant].pipeline(constants);
    }

    BindingLimit limit(Variant variant, uint32_t binding) const {
        const VkPhysicalDeviceLimits& limits = device->properties.limits;
        const bool table = binding == shared::kStencilEvalTableBinding;
        if (variant == kStorage || binding == shared::kStencilEvalDestinationBinding)
            return {std::max<uint64_t>(limits.minStorageBufferOffsetAlignment, table ? 8 : 4), table ? 8u : 4u,
                    limits.maxStorageBufferRange};
        const uint64_t element_bytes = table ? 8 : 4 * kSourceFloats[variant];
        return {std::max<uint64_t>(limits.minTexelBufferOffsetAlignment, 4), element_bytes,
                std::min<uint64_t>(limits.maxTexelBufferElements, 0x7fffffff) * element_bytes};
    }

    Variant choose(const StencilEvaluationInfo& info) const {
        if (!prefer_texel || info.storage_only_source) return kStorage;
        const uint64_t begin = byte_of(info.source, 0, 0);
        const bool threes = info.width == 3 && has_texel3;
        const bool fours = info.width % 4 == 0 || (info.width == 3 && info.padded_source);
        for (const Variant points : {kTexel4, kTexel3})
            if ((points == kTexel4 ? fours : threes) && info.source.stride % kSourceFloats[points] == 0 &&
                limit(points, shared::kStencilEvalSourceBinding).align(begin) <= begin)
                return points;
        return kTexel;
    }
};

namespace {

/// Collects the dispatches of an evaluation and the descriptor sets that they need.
class Planner {
  public:
    Planner(const StencilEvaluationInfo& info, Variant variant, const BindingLimit (&limits)[kBindingCount],
            const VkPhysicalDeviceLimits& device_limits)
        : info_(info),
          source_floats_(kSourceFloats[variant]),
          bound_width_(std::max(info.width, source_floats_)),
          limits_(limits),
          max_groups_(device_limits.maxComputeWorkGroupCount[0]) {}

    /// Appends the dispatch of rows [row_begin, row_end) of a run for components [component, component +
    /// width).
    Result<void> add(const StencilRun& run, uint32_t weight_set, const PointBuffer& destination, Range rows,
                     uint32_t component, VkPipeline pipeline) {
        const bool consecutive = run.has_consecutive_rows();
        const uint32_t row_begin = std::max(run.row_begin, static_cast<uint32_t>(rows.begin));
        const uint32_t row_end = std::min(run.row_end, static_cast<uint32_t>(rows.end));
        if (row_begin >= row_end) return {};
        Planned planned = {&run, weight_set, &destination, component, {}};
        Dispatch& dispatch = planned.dispatch;
        dispatch.pipeline = pipeline;
        StencilEvalParams& params = dispatch.params;
        params.first_item = consecutive ? row_begin - run.row_begin : 0;
        params.item_count = consecutive ? row_end - row_begin : run.item_count;
        params.first_row = run.row_begin;
        params.row_begin = row_begin;
        params.row_end = row_end;
        const uint32_t groups = (params.item_count - 1) / shared::kStencilEvalWorkgroupSize + 1;
        dispatch.groups[1] = (groups - 1) / max_groups_ + 1;
        dispatch.groups[0] = (groups - 1) / dispatch.groups[1] + 1;

        const Range source = source_range(run);
        if (!limits_[shared::kStencilEvalSourceBinding].fits(source))
            return Error{
                ErrorCode::unsupported,
                "stencil rows refer to source points further apart than the device can bind at once"};
        const BoundRanges needed = {
            destination.buffer,
            {table_range(run),
             source,
             {byte_of(destination, rows.begin, 0), byte_of(destination, rows.end - 1, info_.width)}}};
        dispatch.set = find_set(needed);
        planned_.push_back(planned);
        return {};
    }

    /// The sets, and the dispatches with positions relative to what their sets bind.
    std::vector<BoundRanges> finish(std::vector<Dispatch>& dispatches) {
        for (BoundRanges& set : sets_)
            for (uint32_t b = 0; b < kBindingCount; ++b)
                set.ranges[b].begin = limits_[b].align(set.ranges[b].begin);
        for (Planned& planned : planned_) {
            set_bases(planned);
            dispatches.push_back(planned.dispatch);
        }
        return sets_;
    }

  private:
    struct Planned {
        const StencilRun* run;
        uint32_t weight_set;
        const PointBuffer* destination;
        uint32_t component;
        Dispatch dispatch;
    };

    /// At least a pair: rows without entries may take no memory at all.
    Range table_range(const StencilRun& run) const {
        const uint64_t begin = std::min(run.begin * 8, info_.table->bytes() - 8);
        return {begin, std::max(run.end * 8, begin + 8)};
    }

    /// All source points if they can be bound at once, else those that the run refers to.
    Range source_range(const StencilRun& run) const {
        const uint64_t count = std::max(info_.table->source_count, 1u);
        const Range all = {byte_of(info_.source, 0, 0), byte_of(info_.source, count - 1, bound_width_)};
        if (limits_[shared::kStencilEvalSourceBinding].fits(all)) return all;
        if (run.source_min > run.source_max) return {all.begin, all.begin + 4 * source_floats_};
        return {byte_of(info_.source, run.source_min, 0), byte_of(info_.source, run.source_max, bound_width_)};
    }

    /// A set that binds at least what is needed: the last one, extended when possible, or a new one.
    uint32_t find_set(const BoundRanges& needed) {
        if (!sets_.empty() && sets_.back().destination == needed.destination) {
            BoundRanges both = sets_.back();
            bool fits = true;
            for (uint32_t b = 0; b < kBindingCount; ++b) {
                both.ranges[b].begin = std::min(both.ranges[b].begin, needed.ranges[b].begin);
                both.ranges[b].end = std::max(both.ranges[b].end, needed.ranges[b].end);
                fits = fits && limits_[b].fits(both.ranges[b]);
            }
            if (fits) {
                sets_.back() = both;
                return static_cast<uint32_t>(sets_.size() - 1);
            }
        }
        sets_.push_back(needed);
        return static_cast<uint32_t>(sets_.size() - 1);
    }

    void set_bases(Planned& planned) const {
        const StencilRun& run = *planned.run;
        const BoundRanges& set = sets_[planned.dispatch.set];
        StencilEvalParams& params = planned.dispatch.params;
        const auto pairs = [&](uint64_t offset) {
            return static_cast<uint32_t>(offset - set.ranges[0].begin / 8);
        };
        params.index_base = pairs(run.index_offset);
        params.weight_base = pairs(run.weight_offsets[planned.weight_set]);
        params.row_base = pairs(run.row_offset);
        params.pitch = run.item_count;
        params.pair_count = run.pair_count();
        std::copy(std::begin(run.weights), std::end(run.weights), params.weights);
        // Negative where only later points are bound.
        const auto source_bytes =
            static_cast<int64_t>(byte_of(info_.source, 0, planned.component) - set.ranges[1].begin);
        params.source_base = static_cast<uint32_t>(source_bytes / (int64_t{4} * source_floats_));
        params.source_stride = info_.source.stride / source_floats_;
        params.destination_base = static_cast<uint32_t>(
            (byte_of(*planned.destination, 0, planned.component) - set.ranges[2].begin) / 4);
        params.destination_stride = planned.destination->stride;
    }

    const StencilEvaluationInfo& info_;
    uint32_t source_floats_;
    uint32_t bound_width_;  ///< floats of a source point that are bound: whole texels
    const BindingLimit (&limits_)[kBindingCount];
    uint32_t max_groups_;
    std::vector<BoundRanges> sets_;
    std::vector<Planned> planned_;
};

/// Makes the descriptor sets of an evaluation.
class SetWriter {
  public:
    SetWriter(const Device& device, VkDescriptorPool pool, std::vector<VkBufferView>& views, Variant variant)
        : device_(device), pool_(pool), views_(views), variant_(variant) {}

    Result<VkDescriptorSet> write(VkDescriptorSetLayout layout, const VkBuffer (&buffers)[kBindingCount],
                                  const Range (&ranges)[kBindingCount]) {
        VkDescriptorSetAllocateInfo allocate = {};
        allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
        allocate.descriptorPool = pool_;
        allocate.descriptorSetCount = 1;
        allocate.pSetLayouts = &layout;
        VkDescriptorSet set = VK_NULL_HANDLE;
        const VkResult result = device_.functions.AllocateDescriptorSets(device_.handle, &allocate, &set);
        if (result != VK_SUCCESS) return vulkan_error("vkAllocateDescriptorSets", result);

        VkWriteDescriptorSet writes[kBindingCount] = {};
        VkDescriptorBufferInfo infos[kBindingCount] = {};
        VkBufferView views[kBindingCount] = {};
        for (uint32_t b = 0; b < kBindingCount; ++b) {
            writes[b].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
            writes[b].dstSet = set;
            writes[b].dstBinding = b;
            writes[b].descriptorCount = 1;
            writes[b].descriptorType = variant_ == kStorage ? kStorageBindings[b] : kTexelBindings[b];
            infos[b] = {buffers[b], ranges[b].begin, ranges[b].end - ranges[b].begin};
            writes[b].pBufferInfo = &infos[b];
            if (writes[b].descriptorType != VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER) continue;
            auto view = create_view(
                infos[b], b == shared::kStencilEvalTableBinding ? kTableFormat : kSourceFormats[variant_]);
            if (!view) return view.error();
            views[b] = *view;
            writes[b].pTexelBufferView = &views[b];
        }
        device_.functions.UpdateDescriptorSets(device_.handle, kBindingCount, writes, 0, nullptr);
        return set;
    }

  private:
    Result<VkBufferView> create_view(const VkDescriptorBufferInfo& range, VkFormat format) {
        VkBufferViewCreateInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
        info.buffer = range.buffer;
        info.format = format;
        info.offset = range.offset;
        info.range = range.range;
        VkBufferView view = VK_NULL_HANDLE;
        const VkResult result = device_.functions.CreateBufferView(device_.handle, &info, device_.host_allocator, &view);
        if (result != VK_SUCCESS) return vulkan_error("vkCreateBufferView", result);
        views_.push_back(view);
        return view;
    }

    const Device& device_;
    VkDescriptorPool pool_;
    std::vector<VkBufferView>& views_;
    Variant variant_;
};

Result<VkDescriptorPool> create_pool(const Device& device, uint32_t set_count, bool texel) {
    const VkDescriptorPoolSize sizes[2] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, set_count * (texel ? 1 : kBindingCount)},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, set_count * (kBindingCount - 1)}};
    VkDescriptorPoolCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.maxSets = set_count;
    info.poolSizeCount = texel ? 2 : 1;
    info.pPoolSizes = sizes;
    VkDescriptorPool pool = VK_NULL_HANDLE;
    const VkResult result = device.functions.CreateDescriptorPool(device.handle, &info, device.host_allocator, &pool);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateDescriptorPool", result);
    return pool;
}

}  // namespace

Evaluator::Evaluator() : state_(std::make_unique<State>()) {}
Evaluator::Evaluator(Evaluator&&) noexcept = default;
Evaluator& Evaluator::operator=(Evaluator&&) noexcept = default;
Evaluator::~Evaluator() = default;

Result<Evaluator> Evaluator::create(const Device& device) {
    Evaluator evaluator;
    State& state = *evaluator.state_;
    state.device = &device;
    // Weights in push constants and unrolled entries are part of what texel buffers gain: such loads are one scalar load
    // each.
    state.prefer_texel = reads_texels(device);
    state.has_texel3 = reads_point_texels(device);
    const KernelInfo infos[kVariantCount] = {{kStencilEval, kStorageBindings, sizeof(StencilEvalParams)},
                                             {kStencilEvalTexel, kTexelBindings, sizeof(StencilEvalParams)},
                                             {kStencilEvalTexelPoint, kTexelBindings, sizeof(StencilEvalParams)},
                                             {kStencilEvalTexelPoint, kTexelBindings, sizeof(StencilEvalParams)}};
    for (uint32_t variant = 0; variant < kVariantCount; ++variant) {
        auto kernel = create_kernel(device, infos[variant]);
        if (!kernel) return kernel.error();
        state.kernels[variant] = std::move(*kernel);
    }
    return evaluator;
}

Result<StencilEvaluation> Evaluator::prepare(const StencilEvaluationInfo& info) const {
    if (auto checked = check(info); !checked) return checked.error();
    const Device& device = *state_->device;
    const Variant variant = state_->choose(info);
    const DeviceStencilTable& table = *info.table;
    const BindingLimit limits[kBindingCount] = {state_->limit(variant, 0), state_->limit(variant, 1),
                                                state_->limit(variant, 2)};
    StencilEvaluation evaluation;
    StencilEvaluation::State& state = *evaluation.state_;
    state.device = &device;
    state.layout = state_->kernels[variant].layout;

    Planner planner(info, variant, limits, device.properties.limits);
    const PointBuffer* const destinations[3] = {&info.destination, &info.tangent1, &info.tangent2};
    const uint64_t first_row = std::min(info.first_row, table.row_count);
    const uint64_t end_row = std::min<uint64_t>(table.row_count, first_row + info.row_count);
    for (uint32_t d = 0; d < 3; ++d) {
        const PointBuffer& destination = *destinations[d];
        if (destination.buffer == VK_NULL_HANDLE) continue;
        // Destinations larger than the device can bind at once are cut into windows of rows.
        const BindingLimit& limit = limits[shared::kStencilEvalDestinationBinding];
        const uint64_t window =
            std::max<uint64_t>(1, (limit.max_bytes - limit.alignment) / (uint64_t{4} * destination.stride));
        for (uint64_t row = first_row; row < end_row; row += window) {
            for (const StencilRun& run : table.runs) {
                for (uint32_t c = 0; c < info.width; c += shared::kStencilEvalMaxWidth) {
                    auto pipeline = state_->pipeline(variant, run,
                                                     std::min(shared::kStencilEvalMaxWidth, info.width - c));
                    if (!pipeline) return pipeline.error();
                    const Range rows = {row, std::min(row + window, end_row)};
                    if (auto added = planner.add(run, d, destination, rows, c, *pipeline); !added)
                        return added.error();
                }
            }
        }
    }

    const std::vector<BoundRanges> sets = planner.finish(state.dispatches);
    if (sets.empty()) return evaluation;
    auto pool = create_pool(device, static_cast<uint32_t>(sets.size()), variant != kStorage);
    if (!pool) return pool.error();
    state.pool = *pool;
    SetWriter writer(device, state.pool, state.views, variant);
    for (const BoundRanges& set : sets) {
        const VkBuffer buffers[kBindingCount] = {table.data.handle, info.source.buffer, set.destination};
        auto written = writer.write(state_->kernels[variant].set_layout, buffers, set.ranges);
        if (!written) return written.error();
        state.sets.push_back(*written);
    }
    return evaluation;
}

StencilEvaluation::StencilEvaluation() : state_(std::make_unique<State>()) {}
StencilEvaluation::StencilEvaluation(StencilEvaluation&&) noexcept = default;
StencilEvaluation& StencilEvaluation::operator=(StencilEvaluation&&) noexcept = default;
StencilEvaluation::~StencilEvaluation() = default;

uint32_t StencilEvaluation::dispatch_count() const {
    return static_cast<uint32_t>(state_->dispatches.size());
}

void StencilEvaluation::record(VkCommandBuffer command_buffer) const {
    const Functions& functions = state_->device->functions;
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkDescriptorSet set = VK_NULL_HANDLE;
    for (const Dispatch& dispatch : state_->dispatches) {
        if (dispatch.pipeline != pipeline)
            functions.CmdBindPipeline(command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE, dispatch.pipeline);
        pipeline = dispatch.pipeline;
        if (state_->sets[dispatch.set] != set)
            functions.CmdBindDescriptorSets(command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE, state_->layout, 0,
                                            1, &state_->sets[dispatch.set], 0, nullptr);
        set = state_->sets[dispatch.set];
        functions.CmdPushConstants(command_buffer, state_->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                   sizeof(StencilEvalParams), &dispatch.params);
        functions.CmdDispatch(command_buffer, dispatch.groups[0], dispatch.groups[1], 1);
    }
}

}  // namespace limn::vk
