#include "limn/osd/patch_evaluator.h"

#include <algorithm>

#include "limn/shared/osd_patch_eval_params.h"
#include "limn/vulkan/pipeline.h"
#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/recording.h"
#include "limn_kernels/osd_patch_eval.h"
#include "limn_kernels/osd_patch_eval_texel.h"

namespace limn::osd {

using shared::OsdPatchEvalParams;

struct PatchEvaluation::State : vk::Recording {};

struct PatchEvaluator::State {
    const vk::Device* device = nullptr;
    vk::Kernel storage, texel;
    bool prefer_texel = false;
};

PatchEvaluation::PatchEvaluation() : state_(std::make_unique<State>()) {}
PatchEvaluation::PatchEvaluation(PatchEvaluation&&) noexcept = default;
PatchEvaluation& PatchEvaluation::operator=(PatchEvaluation&&) noexcept = default;
PatchEvaluation::~PatchEvaluation() = default;
void PatchEvaluation::record(VkCommandBuffer command_buffer) const {
    state_->record(command_buffer);
}

PatchEvaluator::PatchEvaluator() : state_(std::make_unique<State>()) {}
PatchEvaluator::PatchEvaluator(PatchEvaluator&&) noexcept = default;
PatchEvaluator& PatchEvaluator::operator=(PatchEvaluator&&) noexcept = default;
PatchEvaluator::~PatchEvaluator() = default;

Result<PatchEvaluator> PatchEvaluator::create(const vk::Device& device) {
    VkDescriptorType storage[shared::kOsdBindingCount], texel[shared::kOsdBindingCount];
    for (uint32_t b = 0; b < shared::kOsdBindingCount; ++b) {
        storage[b] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        texel[b] = b < shared::kOsdOutputBinding ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : storage[b];
    }
    PatchEvaluator evaluator;
    State& state = *evaluator.state_;
    state.device = &device;
    state.prefer_texel = vk::reads_texels(device);
    auto kernel = vk::create_kernel(device, {kOsdPatchEval, storage, sizeof(OsdPatchEvalParams)});
    if (!kernel) return kernel.error();
    state.storage = std::move(*kernel);
    kernel = vk::create_kernel(device, {kOsdPatchEvalTexel, texel, sizeof(OsdPatchEvalParams)});
    if (!kernel) return kernel.error();
    state.texel = std::move(*kernel);
    return evaluator;
}

namespace {

Result<void> check(const PatchEvaluationInfo& info) {
    if (info.patches == nullptr || info.patches->arrays.empty())
        return vk::bad_argument("there are no patches");
    if (info.width == 0) return vk::bad_argument("points have no components");
    if (info.coords == VK_NULL_HANDLE) return vk::bad_argument("the buffer of patch coordinates is null");
    if (auto checked = vk::check_points(info.source, info.width); !checked) return checked;
    for (const vk::PointBuffer& output : info.outputs)
        if (output.buffer != VK_NULL_HANDLE)
            if (auto checked = vk::check_points(output, info.width); !checked) return checked;
    return {};
}

/// Three outputs, value and first derivatives or second ones, for a window of coordinates.
class WindowPlanner {
  public:
    WindowPlanner(const vk::Device& device, const vk::Kernel& kernel, bool texel,
                  const PatchEvaluationInfo& info, vk::Recording& recording)
        : limits_(device.properties.limits),
          kernel_(kernel),
          texel_(texel),
          info_(info),
          recording_(recording) {}

    /// Coordinates whose outputs can be bound at once.
    uint64_t window() const {
        uint64_t bytes_each = 4 * shared::kOsdCoordWords;
        for (const vk::PointBuffer& output : info_.outputs)
            if (output.buffer != VK_NULL_HANDLE)
                bytes_each = std::max(bytes_each, uint64_t{4} * output.stride);
        return std::max<uint64_t>(1, (limits_.maxStorageBufferRange - 65536) / bytes_each);
    }

    Result<void> add(uint32_t second, uint64_t first, uint64_t count) {
        const vk::PointBuffer* const outputs = info_.outputs + second * shared::kOsdOutputCount;
        uint32_t wanted = 0;
        for (uint32_t i = 0; i < shared::kOsdOutputCount; ++i)
            wanted |= outputs[i].buffer != VK_NULL_HANDLE ? 1u << i : 0;
        if (wanted == 0) return {};

        const DevicePatches& patches = *info_.patches;
        OsdPatchEvalParams params = {};
        params.coord_count = static_cast<uint32_t>(count);
        params.array_count = static_cast<uint32_t>(patches.arrays.size());
        params.source_stride = info_.source.stride;
        std::vector<vk::BoundBuffer> bound;
        bound.push_back(whole(patches.array_words));
        bound.push_back(whole(patches.indices));
        bound.push_back(whole(patches.params));
        const uint64_t coord_bytes = 4 * shared::kOsdCoordWords;
        bound.push_back(read(info_.coords, first * coord_bytes, (first + count) * coord_bytes,
                             VK_FORMAT_R32_UINT, params.coord_base));
        const uint64_t last_point = std::max(patches.source_count, 1u) - 1;
        bound.push_back(read(info_.source.buffer, vk::byte_of(info_.source, 0, 0),
                             vk::byte_of(info_.source, last_point, info_.width), VK_FORMAT_R32_SFLOAT,
                             params.source_base));
        for (uint32_t i = 0; i < shared::kOsdOutputCount; ++i) {
            // What is not wanted binds something that is.
            const vk::PointBuffer& output = outputs[(wanted >> i & 1) != 0 ? i : lowest(wanted)];
            params.output_stride[i] = output.stride;
            bound.push_back(range(output.buffer, vk::byte_of(output, first, 0),
                                  vk::byte_of(output, first + count - 1, info_.width),
                                  limits_.minStorageBufferOffsetAlignment, params.output_base[i]));
        }
        auto set = recording_.add_set(kernel_.set_layout, bound);
        if (!set) return set.error();
        return add_dispatches(*set, second, wanted, params);
    }

  private:
    static uint32_t lowest(uint32_t bits) { return (bits & 1) != 0 ? 0 : (bits & 2) != 0 ? 1 : 2; }

    /// Four components a dispatch.
    Result<void> add_dispatches(VkDescriptorSet set, uint32_t second, uint32_t wanted,
                                OsdPatchEvalParams params) {
        const uint64_t groups = (params.coord_count - 1) / shared::kOsdPatchWorkgroupSize + 1;
        for (uint32_t c = 0; c < info_.width; c += 4) {
            const uint32_t constants[4] = {std::min(4u, info_.width - c), second, wanted,
                                           info_.patches->types};
            auto pipeline = kernel_.pipeline(constants);
            if (!pipeline) return pipeline.error();
            recording_.add_dispatch(*pipeline, set, groups, params);
            params.source_base += 4;
            for (uint32_t& base : params.output_base) base += 4;
        }
        return {};
    }

    /// Bytes [begin, end), from an aligned one; `base` is the first of them, in words from there.
    vk::BoundBuffer range(VkBuffer buffer, uint64_t begin, uint64_t end, uint64_t alignment,
                          uint32_t& base) const {
        const uint64_t aligned = begin - begin % std::max<uint64_t>(alignment, 4);
        base = static_cast<uint32_t>((begin - aligned) / 4);
        return {buffer, aligned, end - aligned};
    }
    vk::BoundBuffer read(VkBuffer buffer, uint64_t begin, uint64_t end, VkFormat format,
                         uint32_t& base) const {
        if (!texel_) return range(buffer, begin, end, limits_.minStorageBufferOffsetAlignment, base);
        vk::BoundBuffer bound = range(buffer, begin, end, limits_.minTexelBufferOffsetAlignment, base);
        bound.type = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
        bound.format = format;
        return bound;
    }
    vk::BoundBuffer whole(const vk::Buffer& buffer) const {
        uint32_t base = 0;
        return read(buffer.handle, 0, buffer.size_bytes, VK_FORMAT_R32_UINT, base);
    }

    const VkPhysicalDeviceLimits& limits_;
    const vk::Kernel& kernel_;
    bool texel_;
    const PatchEvaluationInfo& info_;
    vk::Recording& recording_;
};

}  // namespace

Result<PatchEvaluation> PatchEvaluator::prepare(const PatchEvaluationInfo& info) const {
    if (auto checked = check(info); !checked) return checked.error();
    const bool texel = state_->prefer_texel && !info.storage_only;
    const vk::Kernel& kernel = texel ? state_->texel : state_->storage;
    PatchEvaluation evaluation;
    PatchEvaluation::State& state = *evaluation.state_;
    state.device = state_->device;
    state.layout = kernel.layout;
    state.push_constant_bytes = sizeof(OsdPatchEvalParams);
    WindowPlanner planner(*state_->device, kernel, texel, info, state);
    const uint64_t window = planner.window();
    for (uint64_t first = 0; first < info.coord_count; first += window)
        for (uint32_t second : {0u, 1u})
            if (auto added = planner.add(second, first, std::min(window, info.coord_count - first)); !added)
                return added.error();
    return evaluation;
}

}  // namespace limn::osd
