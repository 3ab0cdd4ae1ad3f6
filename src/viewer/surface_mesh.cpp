#include "viewer/surface_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "limn/patch_tree.h"
#include "limn/topology.h"
#include "limn_shaders/face_rates_comp.h"
#include "viewer/compute_pass.h"

namespace limn::viewer {
namespace {

constexpr uint32_t kVertexFloats = 6;
constexpr uint32_t kMostTriangles = 1u << 26;

/// As face_rates.comp has it.
struct FaceRatesParams {
    uint32_t faces, rows, rates, face_count;
};

Result<vk::Buffer> create_words(const vk::Device& device, uint64_t count, VkBufferUsageFlags more = 0) {
    return vk::create_buffer(device, count * sizeof(uint32_t), vk::kPointUsage | more, vk::MemoryUse::device);
}

void mark(PassTimer* timer, VkCommandBuffer commands, const char* name) {
    if (timer != nullptr) timer->record_mark(commands, name);
}

}  // namespace

struct SurfaceMesh::State {
    const vk::Device* device = nullptr;
    const SurfaceKernels* kernels = nullptr;
    vk::DevicePatchTable patches;
    vk::DeviceTessellationTable table;
    vk::Buffer points, segments, command, result, face_rates;
    uint32_t segment_count = 0;
    std::optional<vk::StencilEvaluation> level1_points;
    std::optional<ComputePass> face_rates_pass;
    // What depends on options.
    SurfaceMeshOptions options;
    vk::Buffer vertices, places, indices, triangle_faces;
    std::optional<vk::Tessellation> tessellation;
    std::optional<vk::HardwareTessellation> hardware;

    Result<void> upload_tables(const BakedMesh& tables);
    Result<void> prepare_hardware(const SurfaceMeshOptions& wanted);
    Result<void> prepare_triangles(const SurfaceMeshOptions& wanted, uint32_t triangles);
    Result<void> create_buffers(const BakedMesh& tables);
    uint64_t max_vertices() const {
        return device->properties.limits.maxStorageBufferRange / (kVertexFloats * sizeof(float));
    }
    void record_points(VkCommandBuffer commands, PassTimer* timer) const;
    void record_face_rates(VkCommandBuffer commands) const;
    void record_vertices(VkCommandBuffer commands, PassTimer* timer, uint32_t largest_rate = shared::kMaxSideRate) const;
};

Result<void> SurfaceMesh::State::upload_tables(const BakedMesh& tables) {
    auto uploaded_patches = vk::upload_patch_table(*device, tables.patches);
    if (!uploaded_patches) return uploaded_patches.error();
    auto uploaded_table = vk::upload_tessellation_table(*device, tables.tessellation, tables.trees);
    if (!uploaded_table) return uploaded_table.error();
    patches = std::move(*uploaded_patches);
    table = std::move(*uploaded_table);
    return {};
}

Result<void> SurfaceMesh::State::create_buffers(const BakedMesh& tables) {
    segment_count = static_cast<uint32_t>(tables.edges.size() / 2);
    const struct {
        vk::Buffer& place;
        uint64_t words;
        VkBufferUsageFlags usage;
    } buffers[] = {{points, uint64_t{3} * patches.point_count, 0},
                   {segments, tables.edges.size(), 0},
                   {command, 5, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT},
                   {result, sizeof(vk::TessellationResult) / sizeof(uint32_t), 0},
                   {face_rates, table.face_count, 0}};
    for (const auto& [place, words, usage] : buffers) {
        auto buffer = create_words(*device, words, usage);
        if (!buffer) return buffer.error();
        place = std::move(*buffer);
    }
    const std::span<const float> positions(tables.positions.data(), tables.positions.size());
    if (auto done = vk::upload_bytes(*device, points, 0, std::as_bytes(positions)); !done)
        return done.error();
    const std::span<const uint32_t> pairs(tables.edges.data(), tables.edges.size());
    return vk::upload_bytes(*device, segments, 0, std::as_bytes(pairs));
}

void SurfaceMesh::State::record_face_rates(VkCommandBuffer commands) const {
    const FaceRatesParams params = {table.offsets.faces, table.offsets.rows,
                                    shared::tess_rates(table.rate_edge_count), table.face_count};
    vk::record_barrier(*device, commands, vk::kKernelWrites, vk::kKernelReads);
    face_rates_pass->record(commands, params, table.face_count);
}

SurfaceMesh::SurfaceMesh() : state_(std::make_unique<State>()) {}
SurfaceMesh::SurfaceMesh(SurfaceMesh&&) noexcept = default;
SurfaceMesh& SurfaceMesh::operator=(SurfaceMesh&&) noexcept = default;
SurfaceMesh::~SurfaceMesh() = default;

Result<SurfaceKernels> SurfaceKernels::create(const vk::Device& device, bool has_tessellation_shader) {
    auto evaluator = vk::SurfaceEvaluator::create(device);
    if (!evaluator) return evaluator.error();
    auto tessellator = vk::Tessellator::create(device);
    if (!tessellator) return tessellator.error();
    SurfaceKernels out = {std::move(*evaluator), std::move(*tessellator), {}};
    if (has_tessellation_shader) {
        auto hardware = vk::HardwareTessellator::create({&device, true});
        if (!hardware) return hardware.error();
        out.hardware.emplace(std::move(*hardware));
    }
    return out;
}

Result<SurfaceMesh> SurfaceMesh::create(const vk::Device& device, const SurfaceKernels& kernels,
                                        const ControlMesh& mesh, std::span<const float> positions,
                                        const SurfaceMeshOptions& options) {
    BakedMesh tables;
    auto patches = build_patch_table<float>(mesh, {});
    if (!patches) return patches.error();
    auto trees = build_patch_trees(*patches, {});
    if (!trees) return trees.error();
    auto tessellation = build_tessellation_table(mesh, {});
    if (!tessellation) return tessellation.error();
    tables.patches = std::move(*patches);
    tables.trees = std::move(*trees);
    tables.tessellation = std::move(*tessellation);
    tables.positions = Array<float>::borrow(positions.data(), positions.size());
    tables.edges = build_topology(mesh).edge_vertices;
    return create(device, kernels, tables, options);
}

Result<SurfaceMesh> SurfaceMesh::create(const vk::Device& device, const SurfaceKernels& kernels,
                                        const BakedMesh& tables, const SurfaceMeshOptions& options) {
    SurfaceMesh out;
    State& state = *out.state_;
    state.device = &device;
    state.kernels = &kernels;
    auto pass = ComputePass::create(device, kFaceRatesComp, 3, sizeof(FaceRatesParams));
    if (!pass) return pass.error();
    state.face_rates_pass.emplace(std::move(*pass));
    if (auto done = state.upload_tables(tables); !done) return done.error();
    if (auto done = state.create_buffers(tables); !done) return done.error();
    auto level1 = kernels.evaluator.prepare_points(
        {.patches = &state.patches, .points = {.buffer = state.points.handle}});
    if (!level1) return level1.error();
    state.level1_points.emplace(std::move(*level1));
    if (auto done = out.prepare(options); !done) return done.error();
    return out;
}

uint32_t SurfaceMesh::max_triangle_capacity() const {
    const uint64_t most = state_->device->properties.limits.maxStorageBufferRange / (3 * sizeof(uint32_t));
    return static_cast<uint32_t>(std::min<uint64_t>(most, kMostTriangles));
}

/// Frees what held vertices and triangles.
Result<void> SurfaceMesh::State::prepare_hardware(const SurfaceMeshOptions& wanted) {
    auto rates = kernels->tessellator.prepare({.patches = &patches,
                                               .table = &table,
                                               .points = {.buffer = points.handle},
                                               .mode = wanted.mode,
                                               .spacing = wanted.spacing,
                                               .edge_rates = {wanted.edge_rates},
                                               .result = {result.handle}});
    if (!rates) return rates.error();
    auto drawn = kernels->hardware->prepare(*rates);
    if (!drawn) return drawn.error();
    hardware.emplace(std::move(*drawn));
    tessellation.emplace(std::move(*rates));
    for (vk::Buffer* buffer : {&vertices, &places, &indices, &triangle_faces}) *buffer = {};
    return {};
}

Result<void> SurfaceMesh::State::prepare_triangles(const SurfaceMeshOptions& wanted, uint32_t triangles) {
    // Half as many vertices as triangles lie within faces; more on borders where faces share none.
    const auto vertex_capacity = static_cast<uint32_t>(std::min<uint64_t>(
        uint64_t{triangles} / 4 * 3 + uint64_t{10} * table.face_count, max_vertices()));
    auto new_vertices = create_words(*device, uint64_t{vertex_capacity} * kVertexFloats);
    if (!new_vertices) return new_vertices.error();
    vk::Buffer new_places;
    if (wanted.places) {
        auto buffer = create_words(*device, uint64_t{vertex_capacity} * 4);
        if (!buffer) return buffer.error();
        new_places = std::move(*buffer);
    }
    auto new_indices = create_words(*device, uint64_t{triangles} * 3, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    if (!new_indices) return new_indices.error();
    auto new_faces = create_words(*device, triangles);
    if (!new_faces) return new_faces.error();
    auto prepared = kernels->tessellator.prepare(
        {.patches = &patches,
         .table = &table,
         .points = {.buffer = points.handle},
         .mode = wanted.mode,
         .spacing = wanted.spacing,
         .edge_rates = {wanted.edge_rates},
         .vertex_capacity = vertex_capacity,
         .triangle_capacity = triangles,
         .positions = {.buffer = new_vertices->handle, .stride = kVertexFloats},
         .normals = {.buffer = new_vertices->handle, .first = 3, .stride = kVertexFloats},
         .places = {.buffer = new_places.handle, .stride = 4},
         .indices = {new_indices->handle},
         .triangle_faces = {new_faces->handle},
         .command = {command.handle},
         .result = {result.handle}});
    if (!prepared) return prepared.error();
    hardware.reset();
    tessellation.emplace(std::move(*prepared));
    vertices = std::move(*new_vertices);
    places = std::move(new_places);
    indices = std::move(*new_indices);
    triangle_faces = std::move(*new_faces);
    return {};
}

Result<void> SurfaceMesh::prepare(const SurfaceMeshOptions& options) {
    State& state = *state_;
    if (options.hardware && !state.kernels->hardware)
        return Error{ErrorCode::unsupported, std::string(state.device->name()) + " has no tessellation stages"};
    const uint32_t triangles = std::clamp(options.triangle_capacity, 1u, max_triangle_capacity());
    auto prepared = options.hardware ? state.prepare_hardware(options) : state.prepare_triangles(options, triangles);
    if (!prepared) return prepared;
    state.options = options;
    state.options.triangle_capacity = triangles;
    state.face_rates_pass->set_buffers(
        std::array{state.table.words.handle, state.tessellation->state_buffer(), state.face_rates.handle});
    return {};
}

const SurfaceMeshOptions& SurfaceMesh::options() const {
    return state_->options;
}

void SurfaceMesh::State::record_points(VkCommandBuffer commands, PassTimer* timer) const {
    level1_points->record(commands);
    vk::record_barrier(*device, commands, vk::kKernelWrites, vk::kKernelReads);
    tessellation->record_points(commands);
    mark(timer, commands, "points");
}

void SurfaceMesh::State::record_vertices(VkCommandBuffer commands, PassTimer* timer, uint32_t largest_rate) const {
    tessellation->record_vertices(commands, largest_rate);
    vk::record_barrier(*device, commands, vk::kKernelWrites, hardware ? kHardwareRenderReads : kRenderReads);
    mark(timer, commands, "vertices");
}

Result<void> SurfaceMesh::record(VkCommandBuffer commands, const RateSettings& settings,
                                 PassTimer* timer) const {
    const State& state = *state_;
    const uint32_t largest = state.tessellation->largest_rate(settings);
    state.record_points(commands, timer);
    auto recorded = state.tessellation->record_rates(commands, settings);
    state.record_face_rates(commands);
    mark(timer, commands, "rates");
    state.tessellation->record_triangles(commands, largest);
    mark(timer, commands, "triangles");
    state.record_vertices(commands, timer, largest);
    return recorded;
}

void SurfaceMesh::record_vertices(VkCommandBuffer commands, PassTimer* timer) const {
    state_->record_points(commands, timer);
    state_->record_vertices(commands, timer);
}

RenderMesh SurfaceMesh::mesh() const {
    return {.vertices = state_->vertices.handle,
            .vertex_stride_floats = kVertexFloats,
            .indices = state_->indices.handle,
            .indirect = state_->hardware ? VK_NULL_HANDLE : state_->command.handle,
            .places = state_->places.handle,
            .triangle_faces = state_->triangle_faces.handle,
            .face_rates = state_->face_rates.handle,
            .hardware = state_->hardware ? &*state_->hardware : nullptr};
}

Scheme SurfaceMesh::scheme() const {
    return state_->table.scheme;
}

uint32_t SurfaceMesh::face_count() const {
    return state_->table.face_count;
}

VkDeviceSize SurfaceMesh::tessellation_bytes() const {
    VkDeviceSize sum = state_->tessellation->state_bytes();
    for (const vk::Buffer* buffer : {&state_->vertices, &state_->places, &state_->indices, &state_->triangle_faces})
        sum += buffer->size_bytes;
    return sum;
}

RenderLines SurfaceMesh::control_lines() const {
    return {state_->points.handle, state_->segments.handle, state_->segment_count};
}

VkBuffer SurfaceMesh::control_points() const {
    return state_->points.handle;
}

Result<vk::TessellationResult> SurfaceMesh::result() const {
    const auto results = vk::download<vk::TessellationResult>(*state_->device, state_->result, 1);
    if (!results) return results.error();
    return (*results)[0];
}

Result<vk::TessellationResult> SurfaceMesh::tessellate(const RateSettings& settings) {
    using Status = vk::TessellationStatus;
    while (true) {
        auto commands = vk::Commands::begin(*state_->device);
        if (!commands) return commands.error();
        if (auto recorded = record(*commands, settings); !recorded) return recorded.error();
        if (auto done = commands->submit_and_wait(); !done) return done.error();
        const auto outcome = result();
        if (!outcome) return outcome.error();
        if (outcome->status == Status::not_finite)
            return Error{ErrorCode::not_finite, "a control point of the surface is not finite"};
        const bool full = outcome->status == Status::scaled || outcome->status == Status::too_small;
        SurfaceMeshOptions more = options();
        if (!full || more.triangle_capacity == max_triangle_capacity()) return outcome;
        more.triangle_capacity = std::min(max_triangle_capacity(), 4 * more.triangle_capacity);
        if (auto made = prepare(more); !made) return made.error();
    }
}

Result<Bounds> SurfaceMesh::measure() const {
    const auto outcome = result();
    if (!outcome) return outcome.error();
    if (outcome->triangle_count == 0)
        return Error{ErrorCode::invalid_argument, "there is no surface to draw"};
    const auto vertices =
        vk::download<float>(*state_->device, state_->vertices, size_t{outcome->vertex_count} * kVertexFloats);
    if (!vertices) return vertices.error();
    const auto indices =
        vk::download<uint32_t>(*state_->device, state_->indices, size_t{outcome->triangle_count} * 3);
    if (!indices) return indices.error();
    Bounds bounds = {glm::vec3(HUGE_VALF), glm::vec3(-HUGE_VALF)};
    for (const uint32_t index : *indices) {
        const float* at = vertices->data() + size_t{index} * kVertexFloats;
        bounds.low = glm::min(bounds.low, glm::vec3(at[0], at[1], at[2]));
        bounds.high = glm::max(bounds.high, glm::vec3(at[0], at[1], at[2]));
    }
    return bounds;
}

}  // namespace limn::viewer
