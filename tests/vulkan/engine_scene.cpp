#include "vulkan/engine_scene.h"

#include "shapes/shapes.h"

namespace limn::vk::test {
namespace {

constexpr VkBufferUsageFlags kOutputUsage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

}  // namespace

SceneTables build_scene() {
    limn::test::TestMesh mesh;
    for (uint32_t v = 0; v < 8; ++v) mesh.add_vertex(v & 1 ? 1 : -1, v & 2 ? 1 : -1, v & 4 ? 1 : -1);
    for (const auto& face : {std::vector<uint32_t>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        mesh.add_face(face);
    mesh.add_crease(0, 1, 1.5);
    const ControlMesh control = *ControlMesh::create(mesh.description());
    SceneTables out;
    out.patches = *build_patch_table<float>(control, {});
    out.topology = *build_tessellation_table(control, {});
    out.trees = *build_patch_trees(out.patches, {.max_rate = 8});
    out.sample_trees = *build_patch_trees(out.patches, {.max_rate = 8, .relative = true});
    out.grid = *build_grid_table(out.patches, {.rate = 3});
    out.control = mesh.positions;
    return out;
}

Result<SceneKernels> SceneKernels::create(const Device& device) {
    auto surfaces = SurfaceEvaluator::create(device);
    if (!surfaces) return surfaces.error();
    auto tessellator = Tessellator::create(device);
    if (!tessellator) return tessellator.error();
    return SceneKernels{std::move(*surfaces), std::move(*tessellator)};
}

Result<SceneUpload> SceneUpload::record(const Device& device, VkCommandBuffer commands, const SceneTables& tables) {
    SceneUpload out;
    const auto take = [&](auto&& upload, auto& table) -> Result<void> {
        if (!upload) return upload.error();
        table = std::move(upload->table);
        for (Buffer& buffer : upload->staging) out.staging.push_back(std::move(buffer));
        return {};
    };
    if (auto ok = take(record_patch_table_upload(device, commands, tables.patches), out.patches); !ok) return ok.error();
    if (auto ok = take(record_tessellation_table_upload(device, commands, tables.topology, tables.trees), out.topology); !ok)
        return ok.error();
    if (auto ok = take(record_patch_trees_upload(device, commands, tables.sample_trees), out.sample_trees); !ok)
        return ok.error();
    if (auto ok = take(record_grid_table_upload(device, commands, tables.grid), out.grid); !ok) return ok.error();
    return out;
}

Result<SceneFrame> SceneFrame::create(const Device& device, const SceneKernels& kernels, const SceneUpload& tables) {
    const std::pair<uint64_t, VkBufferUsageFlags> sizes[] = {{12ull * tables.patches.point_count, kPointUsage},
                                                             {24ull * kSceneVertices, kOutputUsage},
                                                             {12ull * kSceneTriangles, kOutputUsage},
                                                             {20, kOutputUsage},
                                                             {16ull * tables.sample_trees.local_count, kPointUsage},
                                                             {12ull * kSceneSamples, kPointUsage},
                                                             {36ull * kSceneSamples, kOutputUsage}};
    std::vector<Buffer> b;
    for (const auto& [bytes, usage] : sizes) {
        auto buffer = create_buffer(device, bytes, usage, MemoryUse::device);
        if (!buffer) return buffer.error();
        b.push_back(std::move(*buffer));
    }
    const PointBuffer points = {.buffer = b[0].handle};
    auto refined = kernels.surfaces.prepare_points({.patches = &tables.patches, .points = points});
    if (!refined) return refined.error();
    auto tessellation = kernels.tessellator.prepare({.patches = &tables.patches,
                                                     .table = &tables.topology,
                                                     .points = points,
                                                     .vertex_capacity = kSceneVertices,
                                                     .triangle_capacity = kSceneTriangles,
                                                     .fit_capacity = false,
                                                     .positions = {.buffer = b[1].handle, .stride = 6},
                                                     .normals = {.buffer = b[1].handle, .first = 3, .stride = 6},
                                                     .indices = {b[2].handle},
                                                     .command = {b[3].handle}});
    if (!tessellation) return tessellation.error();
    auto local = kernels.surfaces.prepare_local_points(
        {.patches = &tables.patches, .trees = &tables.sample_trees, .points = points, .local_points = b[4].handle});
    if (!local) return local.error();
    auto sampled = kernels.surfaces.prepare_samples({.patches = &tables.patches,
                                                     .points = points,
                                                     .samples = {b[5].handle, 0, kSceneSamples},
                                                     .results = {.buffer = b[6].handle, .stride = 9},
                                                     .trees = &tables.sample_trees,
                                                     .local_points = b[4].handle});
    if (!sampled) return sampled.error();
    return SceneFrame{std::move(b[0]),     std::move(b[1]), std::move(b[2]),     std::move(b[3]),         std::move(b[4]),
                      std::move(b[5]),     std::move(b[6]), std::move(*refined), std::move(*tessellation), std::move(*local),
                      std::move(*sampled)};
}

Result<void> SceneFrame::record(const Device& device, VkCommandBuffer commands, bool with_samples) const {
    refined.record(commands);
    record_barrier(device, commands, kKernelWrites, kKernelReads);
    auto recorded = tessellation.record(commands, {.value = 2, .max_rate = 8});
    if (!with_samples) return recorded;
    local.record(commands);
    record_barrier(device, commands, kKernelWrites, kKernelReads);
    sampled.record(commands);
    return recorded;
}

}  // namespace limn::vk::test
