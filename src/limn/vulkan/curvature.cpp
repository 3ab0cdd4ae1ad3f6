#include "limn/vulkan/curvature.h"

#include <algorithm>

#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/recording.h"
#include "limn_kernels/curvature.h"

namespace limn::vk {
namespace {

using shared::CurvatureParams;

constexpr uint32_t kQuotientFloats = 18;

Result<void> check(const CurvatureInfo& info) {
    if (info.width != 3 && info.width != 4)
        return bad_argument("curvature is of points of 3 components, or of 4 homogeneous ones");
    if (auto checked = check_points(info.values, 6 * info.width); !checked) return checked;
    if (auto checked = check_points(info.curvatures, shared::kCurvatureFloats); !checked) return checked;
    if (info.quotients.buffer == VK_NULL_HANDLE) return {};
    if (info.width != 4) return bad_argument("there is nothing to divide in points of 3 components");
    return check_points(info.quotients, kQuotientFloats);
}

/// Records [first, end) of a buffer, and where the first of them begins in what is bound, in floats.
BoundBuffer bind(const VkPhysicalDeviceLimits& limits, const PointBuffer& points, uint32_t floats,
                 uint64_t first, uint64_t end, uint32_t& base) {
    uint64_t begin = byte_of(points, first, 0);
    const uint64_t past = byte_of(points, end - 1, floats),
                   offset = begin % limits.minStorageBufferOffsetAlignment;
    begin -= offset;
    base = static_cast<uint32_t>(offset / 4);
    return {points.buffer, begin, past - begin, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_FORMAT_UNDEFINED};
}

/// As many at once as the device can bind of any of the buffers.
uint64_t window_size(const CurvatureInfo& info, const VkPhysicalDeviceLimits& limits) {
    const uint64_t largest =
        4ull * std::max({info.values.stride, info.curvatures.stride, info.quotients.stride});
    return std::max<uint64_t>(
        1, (limits.maxStorageBufferRange - limits.minStorageBufferOffsetAlignment) / largest);
}

}  // namespace

struct CurvatureEvaluation::State {
    Recording recording;
};
CurvatureEvaluation::CurvatureEvaluation() : state_(std::make_unique<State>()) {}
CurvatureEvaluation::CurvatureEvaluation(CurvatureEvaluation&&) noexcept = default;
CurvatureEvaluation& CurvatureEvaluation::operator=(CurvatureEvaluation&&) noexcept = default;
CurvatureEvaluation::~CurvatureEvaluation() = default;
void CurvatureEvaluation::record(VkCommandBuffer command_buffer) const {
    state_->recording.record(command_buffer);
}

struct CurvatureEvaluator::State {
    const Device* device = nullptr;
    Kernel kernel;
};
CurvatureEvaluator::CurvatureEvaluator() : state_(std::make_unique<State>()) {}
CurvatureEvaluator::CurvatureEvaluator(CurvatureEvaluator&&) noexcept = default;
CurvatureEvaluator& CurvatureEvaluator::operator=(CurvatureEvaluator&&) noexcept = default;
CurvatureEvaluator::~CurvatureEvaluator() = default;

Result<CurvatureEvaluator> CurvatureEvaluator::create(const Device& device) {
    const std::vector<VkDescriptorType> bindings(shared::kCurvatureBindingCount,
                                                 VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
    auto kernel = create_kernel(device, {kCurvature, bindings, sizeof(CurvatureParams)});
    if (!kernel) return kernel.error();
    CurvatureEvaluator evaluator;
    evaluator.state_->device = &device;
    evaluator.state_->kernel = std::move(*kernel);
    return evaluator;
}

Result<CurvatureEvaluation> CurvatureEvaluator::prepare(const CurvatureInfo& info) const {
    if (auto checked = check(info); !checked) return checked.error();
    const Device& device = *state_->device;
    const VkPhysicalDeviceLimits& limits = device.properties.limits;
    CurvatureEvaluation evaluation;
    Recording& recording = evaluation.state_->recording;
    recording.device = &device;
    recording.layout = state_->kernel.layout;
    recording.push_constant_bytes = sizeof(CurvatureParams);
    const bool quotients = info.quotients.buffer != VK_NULL_HANDLE;
    auto pipeline = state_->kernel.pipeline(std::vector<uint32_t>{info.width, quotients});
    if (!pipeline) return pipeline.error();
    const uint64_t size = window_size(info, limits);
    for (uint64_t first = 0; first < info.sample_count; first += size) {
        const uint64_t end = std::min<uint64_t>(first + size, info.sample_count);
        CurvatureParams params = {};
        params.sample_count = static_cast<uint32_t>(end - first);
        params.value_stride = info.values.stride;
        params.result_stride = info.curvatures.stride;
        params.quotient_stride = info.quotients.stride;
        const BoundBuffer values = bind(limits, info.values, 6 * info.width, first, end, params.value_base);
        const BoundBuffer results =
            bind(limits, info.curvatures, shared::kCurvatureFloats, first, end, params.result_base);
        const BoundBuffer bound[shared::kCurvatureBindingCount] = {
            values, results,
            quotients ? bind(limits, info.quotients, kQuotientFloats, first, end, params.quotient_base)
                      : results};
        auto set = recording.add_set(state_->kernel.set_layout, bound);
        if (!set) return set.error();
        recording.add_dispatch(*pipeline, *set, (end - first - 1) / shared::kCurvatureWorkgroupSize + 1,
                               params);
    }
    return evaluation;
}

}  // namespace limn::vk
