#include "viewer/surface_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "limn/evaluate.h"
#include "limn/vulkan/surface_evaluator.h"

namespace limn::viewer {
namespace {

constexpr uint32_t kMaxRate = 64;
constexpr uint32_t kVertexFloats = 6;

/// What the host knows once per topology and rate.
struct HostGrid {
    std::vector<uint32_t> indices, triangle_faces, face_rates;
    std::vector<uint32_t> places;  ///< 4 words a vertex, as RenderMesh
    std::vector<uint32_t> segments;
};

void add_quad_face(HostGrid& out, uint32_t face, uint32_t first, uint32_t rate) {
    const uint32_t row = rate + 1;
    for (uint32_t j = 0; j < rate; ++j)
        for (uint32_t i = 0; i < rate; ++i) {
            const uint32_t a = first + j * row + i;
            out.indices.insert(out.indices.end(), {a, a + 1, a + row + 1, a, a + row + 1, a + row});
            out.triangle_faces.insert(out.triangle_faces.end(), 2, face);
        }
}

void add_triangle_face(HostGrid& out, uint32_t face, uint32_t first, uint32_t rate) {
    for (uint32_t j = 0, at = first; j < rate; ++j) {
        const uint32_t length = rate + 1 - j, above = at + length;
        for (uint32_t i = 0; i + 1 < length; ++i) {
            out.indices.insert(out.indices.end(), {at + i, at + i + 1, above + i});
            out.triangle_faces.push_back(face);
            if (i + 2 == length) continue;
            out.indices.insert(out.indices.end(), {at + i + 1, above + i + 1, above + i});
            out.triangle_faces.push_back(face);
        }
        at = above;
    }
}

/// How deep each node lies in the tree of its plan.
std::vector<uint32_t> node_depths(const PatchTable& table) {
    std::vector<uint32_t> depths(table.plan_nodes.size(), 0);
    for (const Plan& plan : table.plans) {
        std::vector<uint32_t> open = {0};
        while (!open.empty()) {
            const uint32_t n = open.back();
            open.pop_back();
            const PlanNode& node = table.plan_nodes[plan.first_node + n];
            if (node.kind() > PlanNodeKind::split_v) continue;
            const uint32_t children = node.kind() == PlanNodeKind::split ? 4 : 2;
            for (uint32_t c = 0; c < children; ++c) {
                depths[plan.first_node + node.first + c] = depths[plan.first_node + n] + 1;
                open.push_back(node.first + c);
            }
        }
    }
    return depths;
}

void add_places(HostGrid& out, const PatchTable& table, uint32_t rate) {
    const auto samples =
        list_grid_samples(table.options.scheme, static_cast<uint32_t>(table.ptex_surfaces.size()), rate);
    std::vector<SurfacePlace> found(samples.size());
    std::vector<SampleStatus> statuses(samples.size());
    locate_patches<float>(table, samples, found, statuses);
    const std::vector<uint32_t> depths = node_depths(table);
    out.places.reserve(4 * samples.size());
    for (size_t s = 0; s < samples.size(); ++s) {
        const PatchSample& sample = samples[s];
        const uint32_t node = table.plans[found[s].plan].first_node + found[s].node;
        const uint32_t surfaces = table.ptex_surfaces[sample.face];
        const uint32_t level =
            depths[node] + (surfaces != shared::kPtexHole && (surfaces & shared::kPtexSplit) != 0);
        const auto kind = static_cast<uint32_t>(table.plan_nodes[node].kind());
        out.places.insert(out.places.end(),
                          {sample.face, std::bit_cast<uint32_t>(static_cast<float>(sample.u)),
                           std::bit_cast<uint32_t>(static_cast<float>(sample.v)), kind | level << 8});
    }
}

HostGrid build_host_grid(const PatchTable& table, const GridTable& grid, const ControlMesh& mesh,
                         const SurfaceMeshOptions& options) {
    HostGrid out;
    for (uint32_t f = 0; f < grid.ptex_count; ++f) {
        if (table.ptex_surfaces[f] == shared::kPtexHole) continue;
        const uint32_t first = f * grid.samples_per_face;
        if (table.options.scheme == Scheme::loop)
            add_triangle_face(out, f, first, grid.rate);
        else
            add_quad_face(out, f, first, grid.rate);
    }
    out.face_rates.assign(grid.ptex_count, grid.rate | grid.rate << 16);
    if (options.places) add_places(out, table, grid.rate);
    const Topology topology = build_topology(mesh);
    out.segments.assign(topology.edge_vertices.begin(), topology.edge_vertices.end());
    return out;
}

Result<vk::Buffer> upload(const vk::Device& device, std::span<const uint32_t> words,
                          VkBufferUsageFlags usage) {
    auto buffer = vk::create_buffer(device, words.size_bytes(),
                                    usage | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                        VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                    vk::MemoryUse::device);
    if (!buffer) return buffer.error();
    if (auto done = vk::upload_bytes(device, *buffer, 0, std::as_bytes(words)); !done) return done.error();
    return buffer;
}

}  // namespace

struct SurfaceMesh::State {
    const vk::Device* device = nullptr;
    std::optional<vk::SurfaceEvaluator> evaluator;
    vk::DevicePatchTable patches;
    vk::DeviceGridTable grid;
    vk::Buffer points, vertices, indices, indirect, places, triangle_faces, face_rates, segments;
    uint32_t segment_count = 0;
    std::optional<vk::StencilEvaluation> points_evaluation;
    std::optional<vk::SurfaceEvaluation> grid_evaluation;

    Result<void> upload_grid(const HostGrid& host);
    Result<void> prepare();
};

Result<void> SurfaceMesh::State::upload_grid(const HostGrid& host) {
    const VkDrawIndexedIndirectCommand command = {static_cast<uint32_t>(host.indices.size()), 1, 0, 0, 0};
    static_assert(sizeof command == 5 * sizeof(uint32_t));
    const auto command_words = std::bit_cast<std::array<uint32_t, 5>>(command);
    const struct {
        vk::Buffer& place;
        std::span<const uint32_t> words;
        VkBufferUsageFlags usage;
    } buffers[] = {{indices, host.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT},
                   {indirect, command_words, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT},
                   {places, host.places, 0},
                   {triangle_faces, host.triangle_faces, 0},
                   {face_rates, host.face_rates, 0},
                   {segments, host.segments, 0}};
    const VkDeviceSize vertex_bytes = grid.sample_count() * kVertexFloats * sizeof(float);
    VkDeviceSize largest = vertex_bytes;
    for (const auto& buffer : buffers) largest = std::max<VkDeviceSize>(largest, buffer.words.size_bytes());
    if (largest > device->properties.limits.maxStorageBufferRange)
        return Error{ErrorCode::too_large, "at rate " + std::to_string(grid.rate) +
                                               " there are more vertices or triangles than " +
                                               device->name() + " reads at once"};
    for (const auto& [place, words, usage] : buffers) {
        if (words.empty()) continue;
        auto buffer = upload(*device, words, usage);
        if (!buffer) return buffer.error();
        place = std::move(*buffer);
    }
    segment_count = static_cast<uint32_t>(host.segments.size() / 2);
    auto buffer = vk::create_buffer(*device, vertex_bytes, vk::kPointUsage, vk::MemoryUse::device);
    if (!buffer) return buffer.error();
    vertices = std::move(*buffer);
    return {};
}

Result<void> SurfaceMesh::State::prepare() {
    const vk::PointBuffer point_buffer = {.buffer = points.handle};
    auto level1 = evaluator->prepare_points({.patches = &patches, .points = point_buffer});
    if (!level1) return level1.error();
    auto samples = evaluator->prepare_grid(
        {.patches = &patches,
         .grid = &grid,
         .points = point_buffer,
         .values = {.buffer = vertices.handle, .stride = kVertexFloats},
         .normals = {.buffer = vertices.handle, .first = 3, .stride = kVertexFloats}});
    if (!samples) return samples.error();
    points_evaluation.emplace(std::move(*level1));
    grid_evaluation.emplace(std::move(*samples));
    return {};
}

SurfaceMesh::SurfaceMesh() : state_(std::make_unique<State>()) {}
SurfaceMesh::SurfaceMesh(SurfaceMesh&&) noexcept = default;
SurfaceMesh& SurfaceMesh::operator=(SurfaceMesh&&) noexcept = default;
SurfaceMesh::~SurfaceMesh() = default;

Result<SurfaceMesh> SurfaceMesh::create(const vk::Device& device, const ControlMesh& mesh,
                                        std::span<const float> positions, const SurfaceMeshOptions& options) {
    if (options.rate < 1 || options.rate > kMaxRate)
        return Error{ErrorCode::invalid_argument, "a rate is 1 to " + std::to_string(kMaxRate)};
    const auto table = build_patch_table<float>(mesh, {});
    if (!table) return table.error();
    const auto grid = build_grid_table(*table, {.rate = options.rate});
    if (!grid) return grid.error();
    SurfaceMesh out;
    State& state = *out.state_;
    state.device = &device;
    auto evaluator = vk::SurfaceEvaluator::create(device);
    if (!evaluator) return evaluator.error();
    state.evaluator.emplace(std::move(*evaluator));
    auto patches = vk::upload_patch_table(device, *table);
    if (!patches) return patches.error();
    state.patches = std::move(*patches);
    auto device_grid = vk::upload_grid_table(device, *grid);
    if (!device_grid) return device_grid.error();
    state.grid = std::move(*device_grid);
    auto points = vk::create_buffer(device, VkDeviceSize{12} * table->point_count(), vk::kPointUsage,
                                    vk::MemoryUse::device);
    if (!points) return points.error();
    state.points = std::move(*points);
    if (auto done = vk::upload_bytes(device, state.points, 0, std::as_bytes(positions)); !done)
        return done.error();
    const HostGrid host = build_host_grid(*table, *grid, mesh, options);
    if (auto done = state.upload_grid(host); !done) return done.error();
    if (auto done = state.prepare(); !done) return done.error();
    return out;
}

void SurfaceMesh::record(VkCommandBuffer commands) const {
    const vk::Device& device = *state_->device;
    state_->points_evaluation->record(commands);
    vk::record_barrier(device, commands, vk::kKernelWrites, vk::kKernelReads);
    state_->grid_evaluation->record(commands);
    vk::record_barrier(device, commands, vk::kKernelWrites, kRenderReads);
}

RenderMesh SurfaceMesh::mesh() const {
    return {.vertices = state_->vertices.handle,
            .vertex_stride_floats = kVertexFloats,
            .indices = state_->indices.handle,
            .indirect = state_->indirect.handle,
            .places = state_->places.handle,
            .triangle_faces = state_->triangle_faces.handle,
            .face_rates = state_->face_rates.handle};
}

RenderLines SurfaceMesh::control_lines() const {
    return {state_->points.handle, state_->segments.handle, state_->segment_count};
}

VkBuffer SurfaceMesh::control_points() const {
    return state_->points.handle;
}

uint32_t SurfaceMesh::control_point_count() const {
    return state_->patches.control_count;
}

Result<SurfaceMesh::Counts> SurfaceMesh::count() const {
    const auto index_count = vk::download<uint32_t>(*state_->device, state_->indirect, 1);
    if (!index_count) return index_count.error();
    return Counts{state_->grid.sample_count(), (*index_count)[0] / 3};
}

Result<Bounds> SurfaceMesh::measure() const {
    const auto counts = count();
    if (!counts) return counts.error();
    const auto indices = vk::download<uint32_t>(*state_->device, state_->indices, 3 * counts->triangles);
    if (!indices) return indices.error();
    const auto vertices =
        vk::download<float>(*state_->device, state_->vertices, counts->vertices * kVertexFloats);
    if (!vertices) return vertices.error();
    Bounds bounds = {glm::vec3(HUGE_VALF), glm::vec3(-HUGE_VALF)};
    for (const uint32_t index : *indices) {
        const float* at = vertices->data() + size_t{index} * kVertexFloats;
        const glm::vec3 position(at[0], at[1], at[2]);
        if (!std::isfinite(position.x + position.y + position.z))
            return Error{ErrorCode::invalid_argument, "the surface has positions that are not finite"};
        bounds.low = glm::min(bounds.low, position);
        bounds.high = glm::max(bounds.high, position);
    }
    if (counts->triangles == 0) return Error{ErrorCode::invalid_argument, "there is no surface to draw"};
    return bounds;
}

}  // namespace limn::viewer
