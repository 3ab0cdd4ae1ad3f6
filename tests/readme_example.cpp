// The README's example, run: the limit surface of a cube as triangles, read back and looked at.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

// [readme]
#include <limn/vulkan/surface_evaluator.h>
#include <limn/vulkan/tessellator.h>

// Once per topology: the surface, the vertices that faces share, and how places are evaluated. Thread-safe, on the CPU.
struct Tables {
    limn::PatchTable patches;
    limn::TessellationTable topology;
    limn::PatchTreeTable trees;
};
limn::Result<Tables> build_tables(const limn::ControlMeshDescription& description) {
    const auto mesh = limn::ControlMesh::create(description);
    if (!mesh) return mesh.error();
    auto patches = limn::build_patch_table<float>(*mesh, {});
    if (!patches) return patches.error();
    auto topology = limn::build_tessellation_table(*mesh, {});
    if (!topology) return topology.error();
    auto trees = limn::build_patch_trees(*patches, {.max_rate = 64});
    if (!trees) return trees.error();
    return Tables{std::move(*patches), std::move(*topology), std::move(*trees)};
}

// Every frame, in your command buffer, on your buffers: from control points to positions, normals, indices and the
// command for vkCmdDrawIndexedIndirect, as fine as the camera needs it, closed wherever the control mesh is.
limn::Result<void> record_surface(const limn::vk::Device& device, VkCommandBuffer commands,
                                  const limn::vk::StencilEvaluation& points, const limn::vk::Tessellation& surface,
                                  const limn::Camera& camera) {
    points.record(commands);  // the few points that faces share, behind the control points
    limn::vk::record_barrier(device, commands, limn::vk::kKernelWrites, limn::vk::kKernelReads);
    auto recorded = surface.record(commands, {.value = 0.25f, .camera = camera});  // a quarter of a pixel off at most
    limn::vk::record_barrier(device, commands, limn::vk::kKernelWrites,
                             {VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_VERTEX_INPUT_BIT,
                              VK_ACCESS_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_INDEX_READ_BIT |
                                  VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT});
    return recorded;
}
// [/readme]

namespace {

constexpr uint32_t kFaceSizes[] = {4, 4, 4, 4, 4, 4};
constexpr uint32_t kFaces[] = {0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4};
constexpr float kCube[] = {-1, -1, 1,  1, -1, 1,  -1, 1,  1,  1, 1,  1,
                           -1, 1,  -1, 1, 1,  -1, -1, -1, -1, 1, -1, -1};
constexpr uint32_t kMaxVertices = 20'000, kMaxTriangles = 40'000;

int fail(const limn::Error& error) {
    std::fprintf(stderr, "%s\n", error.message.c_str());
    return 1;
}

/// From z = 6 along -z, 53 degrees wide.
limn::Camera make_camera() {
    limn::Camera camera{.width = 1280, .height = 1280};
    const float matrix[16] = {2, 0, 0, 0, 0, -2, 0, 0, 0, 0, -1, -1, 0, 0, 5.9f, 6};
    std::copy(std::begin(matrix), std::end(matrix), camera.matrix);
    return camera;
}

}  // namespace

int main() {
    namespace vk = limn::vk;
    const auto tables = build_tables({.vertex_count = 8, .face_sizes = kFaceSizes, .face_vertices = kFaces});
    if (!tables) return fail(tables.error());
    const auto context = vk::Context::create();
    if (!context) return fail(context.error());
    const vk::Device& device = context->device();
    const auto evaluator = vk::SurfaceEvaluator::create(device);
    if (!evaluator) return fail(evaluator.error());
    const auto tessellator = vk::Tessellator::create(device);
    if (!tessellator) return fail(tessellator.error());
    const auto patches = vk::upload_patch_table(device, tables->patches);
    if (!patches) return fail(patches.error());
    const auto table = vk::upload_tessellation_table(device, tables->topology, tables->trees);
    if (!table) return fail(table.error());

    // Control points, and room for the level-1 points behind them; then what limn writes.
    const uint64_t sizes[] = {uint64_t{12} * patches->point_count, 24ull * kMaxVertices, 12ull * kMaxTriangles,
                              sizeof(VkDrawIndexedIndirectCommand), sizeof(vk::TessellationResult)};
    std::vector<vk::Buffer> buffers;
    for (const uint64_t size : sizes) {
        auto buffer = vk::create_buffer(device, size, vk::kPointUsage, vk::MemoryUse::device);
        if (!buffer) return fail(buffer.error());
        buffers.push_back(std::move(*buffer));
    }
    const vk::Buffer &points = buffers[0], &vertices = buffers[1], &result = buffers[4];
    if (auto ok = vk::upload_bytes(device, points, 0, std::as_bytes(std::span(kCube))); !ok) return fail(ok.error());
    const auto level1 = evaluator->prepare_points({.patches = &*patches, .points = {.buffer = points.handle}});
    if (!level1) return fail(level1.error());
    const auto surface = tessellator->prepare({.patches = &*patches,
                                               .table = &*table,
                                               .points = {.buffer = points.handle},
                                               .mode = limn::RateMode::pixel_error,
                                               .vertex_capacity = kMaxVertices,
                                               .triangle_capacity = kMaxTriangles,
                                               .positions = {.buffer = vertices.handle, .stride = 6},
                                               .normals = {.buffer = vertices.handle, .first = 3, .stride = 6},
                                               .indices = {buffers[2].handle},
                                               .command = {buffers[3].handle},
                                               .result = {result.handle}});
    if (!surface) return fail(surface.error());

    auto commands = vk::Commands::begin(device);
    if (!commands) return fail(commands.error());
    if (auto ok = record_surface(device, *commands, *level1, *surface, make_camera()); !ok) return fail(ok.error());
    vk::record_barrier(device, *commands, vk::kKernelWrites, vk::kCopyReads);
    if (auto done = commands->submit_and_wait(); !done) return fail(done.error());
    const auto out = vk::download<vk::TessellationResult>(device, result, 1);
    if (!out) return fail(out.error());
    const vk::TessellationResult& made = out->front();
    const auto floats = vk::download<float>(device, vertices, size_t{6} * made.vertex_count);
    if (!floats) return fail(floats.error());

    // A closed surface of genus 0: Euler's formula. Vertex 0 is a corner of the cube's surface, and looks outwards.
    std::printf("%u vertices, %u triangles on %s\n", made.vertex_count, made.triangle_count, device.name());
    const float* v = floats->data();
    const bool right = made.status == vk::TessellationStatus::complete && made.triangle_count > 1000 &&
                       made.vertex_count == made.triangle_count / 2 + 2 &&
                       std::abs(v[0] * v[3] + v[1] * v[4] + v[2] * v[5] - std::hypot(v[0], v[1], v[2])) < 1e-5f;
    return right ? 0 : 1;
}
