#include "limn/vulkan/scheme_evaluator.h"

#include <algorithm>

#include "limn/shared/normals_params.h"
#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/recording.h"
#include "limn/vulkan/table_upload.h"
#include "limn_kernels/normals.h"
#include "limn_kernels/normals_texel.h"

namespace limn::vk {
namespace {

using shared::NormalsParams;

constexpr uint32_t kMostAtOnce = 1u << 20;  // vertices of a dispatch: what is bound stays below 128 MiB

/// `count` points from `first` on, and where they begin in what is bound.
BoundBuffer bind_points(const Device& device, const PointBuffer& points, uint32_t first, uint32_t count, bool texel,
                        uint32_t& base) {
    const VkPhysicalDeviceLimits& limits = device.properties.limits;
    const uint64_t alignment =
        std::max<uint64_t>(4, texel ? limits.minTexelBufferOffsetAlignment : limits.minStorageBufferOffsetAlignment);
    const uint64_t begin = byte_of(points, first, 0), bound = begin - begin % alignment;
    base = static_cast<uint32_t>((begin - bound) / 4);
    return {points.buffer, bound, byte_of(points, first + count - 1, 3) - bound,
            texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_FORMAT_R32_SFLOAT};
}

Result<void> check(const SchemeEvaluationInfo& info) {
    if (info.surface == nullptr) return bad_argument("there is no surface to evaluate");
    for (const PointBuffer* points : {&info.points, &info.positions})
        if (auto checked = check_points(*points, 3); !checked) return checked;
    return info.normals.buffer == VK_NULL_HANDLE ? Result<void>() : check_points(info.normals, 3);
}

}  // namespace

VkDeviceSize DeviceSchemeSurface::bytes() const {
    VkDeviceSize sum = triangles.size_bytes;
    for (const DeviceStencilTable& table : tables) sum += table.bytes();
    return sum;
}

Result<SchemeSurfaceUpload> record_scheme_surface_upload(const Device& device, VkCommandBuffer command_buffer,
                                                         const SchemeSurface& surface) {
    SchemeSurfaceUpload upload;
    DeviceSchemeSurface& out = upload.table;
    out.control_count = surface.control_count;
    out.vertex_count = surface.vertex_count;
    out.triangle_count = static_cast<uint32_t>(surface.triangles.size() / 3);
    out.tables.reserve(surface.tables.size() + 1);
    const auto add = [&](const StencilTable& table) -> Result<void> {
        auto recorded = record_stencil_table_upload(device, command_buffer, table);
        if (!recorded) return recorded.error();
        out.tables.push_back(std::move(recorded->table));
        upload.staging.push_back(std::move(recorded->staging));
        return {};
    };
    for (const StencilTable& table : surface.tables)
        if (auto added = add(table); !added) return added.error();
    if (auto added = add(surface.limit); !added) return added.error();
    auto buffer = create_table_buffer(device, command_buffer, surface.triangles.bytes(), upload.staging,
                                      kPointUsage | VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    if (!buffer) return buffer.error();
    if (!surface.triangles.empty()) std::memcpy(buffer->second, surface.triangles.data(), surface.triangles.bytes());
    out.triangles = std::move(buffer->first);
    return upload;
}

Result<MemoryNeed> upload_memory(const SchemeSurface& surface) {
    auto need = upload_memory(surface.limit);
    for (const StencilTable& table : surface.tables) {
        if (!need) break;
        const auto more = upload_memory(table);
        if (!more) return more.error();
        *need += *more;
    }
    if (need) *need += table_memory(surface.triangles.bytes());
    return need;
}

Result<DeviceSchemeSurface> upload_scheme_surface(const Device& device, const SchemeSurface& surface) {
    return upload_and_wait(
        device, [&](VkCommandBuffer commands) { return record_scheme_surface_upload(device, commands, surface); });
}

struct SchemeEvaluation::State {
    const Device* device = nullptr;
    std::vector<Buffer> points;  ///< between tables; then both tangents
    std::vector<StencilEvaluation> steps;
    Recording normals;
};
SchemeEvaluation::SchemeEvaluation() : state_(std::make_unique<State>()) {}
SchemeEvaluation::SchemeEvaluation(SchemeEvaluation&&) noexcept = default;
SchemeEvaluation& SchemeEvaluation::operator=(SchemeEvaluation&&) noexcept = default;
SchemeEvaluation::~SchemeEvaluation() = default;

void SchemeEvaluation::record(VkCommandBuffer command_buffer) const {
    const State& state = *state_;
    // What the frame before read of the points in between is done: they are written again.
    record_barrier(*state.device, command_buffer, kKernelReads, kKernelWrites);
    for (const StencilEvaluation& step : state.steps) {
        step.record(command_buffer);
        if (&step != &state.steps.back())
            record_barrier(*state.device, command_buffer, kKernelWrites, kKernelReads);
    }
    if (state.normals.dispatches.empty()) return;
    record_barrier(*state.device, command_buffer, kKernelWrites, kKernelReads);
    state.normals.record(command_buffer);
}

uint32_t SchemeEvaluation::dispatch_count() const {
    auto count = static_cast<uint32_t>(state_->normals.dispatches.size());
    for (const StencilEvaluation& step : state_->steps) count += step.dispatch_count();
    return count;
}

VkDeviceSize SchemeEvaluation::bytes() const {
    VkDeviceSize sum = 0;
    for (const Buffer& buffer : state_->points) sum += buffer.size_bytes;
    return sum;
}

struct SchemeEvaluator::State {
    const Device* device = nullptr;
    std::optional<Evaluator> evaluator;
    Kernel normals;
    bool texel = false;

    Result<void> prepare_normals(const SchemeEvaluationInfo& info, const PointBuffer tangents[2], Recording& out) const;
};
SchemeEvaluator::SchemeEvaluator() : state_(std::make_unique<State>()) {}
SchemeEvaluator::SchemeEvaluator(SchemeEvaluator&&) noexcept = default;
SchemeEvaluator& SchemeEvaluator::operator=(SchemeEvaluator&&) noexcept = default;
SchemeEvaluator::~SchemeEvaluator() = default;

Result<SchemeEvaluator> SchemeEvaluator::create(const Device& device) {
    SchemeEvaluator out;
    State& state = *out.state_;
    state.device = &device;
    auto evaluator = Evaluator::create(device);
    if (!evaluator) return evaluator.error();
    state.evaluator.emplace(std::move(*evaluator));
    state.texel = reads_texels(device);
    std::vector<VkDescriptorType> bindings(
        shared::kNormalsBindingCount,
        state.texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
    bindings[shared::kNormalsBinding] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    const std::span<const uint32_t> spirv = state.texel ? std::span<const uint32_t>(kNormalsTexel) : kNormals;
    auto kernel = create_kernel(device, {spirv, bindings, sizeof(NormalsParams)});
    if (!kernel) return kernel.error();
    state.normals = std::move(*kernel);
    return out;
}

Result<void> SchemeEvaluator::State::prepare_normals(const SchemeEvaluationInfo& info, const PointBuffer tangents[2],
                                                     Recording& out) const {
    out.device = device;
    out.layout = normals.layout;
    out.push_constant_bytes = sizeof(NormalsParams);
    auto pipeline = normals.pipeline({});
    if (!pipeline) return pipeline.error();
    const uint32_t vertices = info.surface->vertex_count;
    for (uint32_t first = 0; first < vertices; first += std::min(kMostAtOnce, vertices - first)) {
        NormalsParams params = {};
        params.vertex_count = std::min(kMostAtOnce, vertices - first);
        params.normal_stride = info.normals.stride;
        const BoundBuffer bound[shared::kNormalsBindingCount] = {
            bind_points(*device, tangents[0], first, params.vertex_count, texel, params.tangent1_base),
            bind_points(*device, tangents[1], first, params.vertex_count, texel, params.tangent2_base),
            bind_points(*device, info.normals, first, params.vertex_count, false, params.normal_base)};
        auto set = out.add_set(normals.set_layout, bound);
        if (!set) return set.error();
        out.add_dispatch(*pipeline, *set, (params.vertex_count - 1) / shared::kNormalsWorkgroupSize + 1, params);
    }
    return {};
}

Result<SchemeEvaluation> SchemeEvaluator::prepare(const SchemeEvaluationInfo& info) const {
    if (auto checked = check(info); !checked) return checked.error();
    const Device& device = *state_->device;
    const bool with_normals = info.normals.buffer != VK_NULL_HANDLE;
    SchemeEvaluation out;
    SchemeEvaluation::State& state = *out.state_;
    state.device = &device;
    auto add_points = [&](uint64_t count, uint32_t stride) -> Result<PointBuffer> {
        auto buffer = create_buffer(device, 4 * stride * count, kSourceUsage, MemoryUse::device);
        if (!buffer) return buffer.error();
        state.points.push_back(std::move(*buffer));
        return PointBuffer{.buffer = state.points.back().handle, .stride = stride};
    };
    const uint32_t stride = state_->texel ? 4 : 3;  // between tables
    PointBuffer source = info.points, tangents[2];
    for (const DeviceStencilTable& table : info.surface->tables) {
        StencilEvaluationInfo step = {.table = &table,
                                      .source = source,
                                      .destination = info.positions,
                                      .padded_source = stride == 4 && &table != &info.surface->tables.front()};
        if (&table != &info.surface->tables.back()) {
            auto points = add_points(table.row_count, stride);
            if (!points) return points.error();
            step.destination = *points;
        } else if (with_normals) {
            for (PointBuffer& tangent : tangents) {
                auto points = add_points(table.row_count, 3);
                if (!points) return points.error();
                tangent = *points;
            }
            step.tangent1 = tangents[0];
            step.tangent2 = tangents[1];
        }
        auto prepared = state_->evaluator->prepare(step);
        if (!prepared) return prepared.error();
        state.steps.push_back(std::move(*prepared));
        source = step.destination;
    }
    if (with_normals)
        if (auto prepared = state_->prepare_normals(info, tangents, state.normals); !prepared) return prepared.error();
    return out;
}

}  // namespace limn::vk
