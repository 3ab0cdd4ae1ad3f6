#include "viewer/scheme_mesh.h"

#include <cmath>

namespace limn::viewer {
namespace {

constexpr uint32_t kVertexFloats = 6;

Result<vk::Buffer> upload(const vk::Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags more = 0) {
    auto buffer = vk::create_buffer(device, bytes.size(), vk::kPointUsage | more, vk::MemoryUse::device);
    if (!buffer) return buffer.error();
    if (auto copied = vk::upload_bytes(device, *buffer, 0, bytes); !copied) return copied.error();
    return buffer;
}

}  // namespace

struct SchemeMesh::State {
    const vk::Device* device = nullptr;
    vk::DeviceSchemeSurface surface;
    vk::Buffer points, segments, vertices, command;
    uint32_t segment_count = 0;
    std::optional<vk::SchemeEvaluation> evaluation;

    Result<void> create_buffers(const SchemeSurface& tables, std::span<const float> positions);
};

Result<void> SchemeMesh::State::create_buffers(const SchemeSurface& tables, std::span<const float> positions) {
    const uint64_t most = device->properties.limits.maxStorageBufferRange;
    const uint64_t vertex_bytes = uint64_t{surface.vertex_count} * kVertexFloats * sizeof(float);
    if (vertex_bytes > most || surface.triangles.size_bytes > most)
        return Error{ErrorCode::too_large, std::to_string(surface.triangle_count) + " triangles are more than " +
                                               device->name() + " draws at once"};
    segment_count = static_cast<uint32_t>(tables.edges.size() / 2);
    const VkDrawIndexedIndirectCommand draw = {3 * surface.triangle_count, 1, 0, 0, 0};
    const struct {
        vk::Buffer& place;
        std::span<const std::byte> bytes;
        VkBufferUsageFlags usage;
    } uploads[] = {
        {points, std::as_bytes(positions), 0},
        {segments, std::as_bytes(std::span(tables.edges.data(), tables.edges.size())), 0},
        {command, std::as_bytes(std::span(&draw, 1)), VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT}};
    for (const auto& [place, bytes, usage] : uploads) {
        auto buffer = upload(*device, bytes, usage);
        if (!buffer) return buffer.error();
        place = std::move(*buffer);
    }
    auto buffer = vk::create_buffer(*device, vertex_bytes, vk::kPointUsage, vk::MemoryUse::device);
    if (!buffer) return buffer.error();
    vertices = std::move(*buffer);
    return {};
}

SchemeMesh::SchemeMesh() : state_(std::make_unique<State>()) {}
SchemeMesh::SchemeMesh(SchemeMesh&&) noexcept = default;
SchemeMesh& SchemeMesh::operator=(SchemeMesh&&) noexcept = default;
SchemeMesh::~SchemeMesh() = default;

Result<SchemeMesh> SchemeMesh::create(const vk::Device& device, const vk::SchemeEvaluator& evaluator,
                                      const SchemeSurface& surface, std::span<const float> positions) {
    SchemeMesh out;
    State& state = *out.state_;
    state.device = &device;
    auto uploaded = vk::upload_scheme_surface(device, surface);
    if (!uploaded) return uploaded.error();
    state.surface = std::move(*uploaded);
    if (auto done = state.create_buffers(surface, positions); !done) return done.error();
    auto evaluation =
        evaluator.prepare({.surface = &state.surface,
                           .points = {.buffer = state.points.handle},
                           .positions = {.buffer = state.vertices.handle, .stride = kVertexFloats},
                           .normals = {.buffer = state.vertices.handle, .first = 3, .stride = kVertexFloats}});
    if (!evaluation) return evaluation.error();
    state.evaluation.emplace(std::move(*evaluation));
    return out;
}

void SchemeMesh::record(VkCommandBuffer commands, PassTimer* timer) const {
    state_->evaluation->record(commands);
    vk::record_barrier(*state_->device, commands, vk::kKernelWrites, kRenderReads);
    if (timer != nullptr) timer->record_mark(commands, "vertices");
}

Result<Bounds> SchemeMesh::evaluate() const {
    auto commands = vk::Commands::begin(*state_->device);
    if (!commands) return commands.error();
    record(*commands);
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    const auto vertices = vk::download<float>(*state_->device, state_->vertices, size_t{vertex_count()} * kVertexFloats);
    if (!vertices) return vertices.error();
    Bounds bounds = {glm::vec3(HUGE_VALF), glm::vec3(-HUGE_VALF)};
    for (size_t at = 0; at < vertices->size(); at += kVertexFloats) {
        const glm::vec3 position((*vertices)[at], (*vertices)[at + 1], (*vertices)[at + 2]);
        if (!std::isfinite(position.x + position.y + position.z))
            return Error{ErrorCode::not_finite, "a vertex of the surface is not finite"};
        bounds.low = glm::min(bounds.low, position);
        bounds.high = glm::max(bounds.high, position);
    }
    return bounds;
}

RenderMesh SchemeMesh::mesh() const {
    return {.vertices = state_->vertices.handle,
            .vertex_stride_floats = kVertexFloats,
            .indices = state_->surface.triangles.handle,
            .indirect = state_->command.handle};
}

RenderLines SchemeMesh::control_lines() const {
    return {state_->points.handle, state_->segments.handle, state_->segment_count};
}

VkBuffer SchemeMesh::control_points() const {
    return state_->points.handle;
}

uint32_t SchemeMesh::vertex_count() const {
    return state_->surface.vertex_count;
}

uint32_t SchemeMesh::triangle_count() const {
    return state_->surface.triangle_count;
}

}  // namespace limn::viewer
