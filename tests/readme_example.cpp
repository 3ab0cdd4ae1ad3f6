// The README's example, run: the limit surface of a cube, read back and looked at.
#include <cmath>
#include <cstdio>
#include <vector>

// [readme]
#include <limn/vulkan/surface_evaluator.h>

// Once per topology: the surface, and what 9 x 9 samples of each face weigh. Thread-safe, on the CPU only.
struct Tables {
    limn::PatchTable patches;
    limn::GridTable grid;
};
limn::Result<Tables> build_tables(const limn::ControlMeshDescription& description) {
    const auto mesh = limn::ControlMesh::create(description);
    if (!mesh) return mesh.error();
    auto patches = limn::build_patch_table<float>(*mesh, {});
    if (!patches) return patches.error();
    auto grid = limn::build_grid_table(*patches, {.rate = 8});
    if (!grid) return grid.error();
    return Tables{std::move(*patches), std::move(*grid)};
}

// Every frame, in your command buffer, on your buffers. `points` reads the control points and makes the few
// points that faces share; `grid` writes vertices: position and normal, 24 bytes each.
void record_surface(const limn::vk::Device& device, VkCommandBuffer commands,
                    const limn::vk::StencilEvaluation& points, const limn::vk::SurfaceEvaluation& grid) {
    points.record(commands);
    limn::vk::record_barrier(device, commands, limn::vk::kKernelWrites, limn::vk::kKernelReads);
    grid.record(commands);  // owed: a barrier from kKernelWrites to whatever reads the vertices
}
// [/readme]

namespace {

constexpr uint32_t kFaceSizes[] = {4, 4, 4, 4, 4, 4};
constexpr uint32_t kFaces[] = {0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4};
constexpr float kCube[] = {-1, -1, 1,  1, -1, 1,  -1, 1,  1,  1, 1,  1,
                           -1, 1,  -1, 1, 1,  -1, -1, -1, -1, 1, -1, -1};

int fail(const limn::Error& error) {
    std::fprintf(stderr, "%s\n", error.message.c_str());
    return 1;
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
    const auto patches = vk::upload_patch_table(device, tables->patches);
    if (!patches) return fail(patches.error());
    const auto grid = vk::upload_grid_table(device, tables->grid);
    if (!grid) return fail(grid.error());

    // Control points, and room for the level-1 points behind them.
    const auto points = vk::create_buffer(device, VkDeviceSize{12} * patches->point_count, vk::kPointUsage,
                                          vk::MemoryUse::device);
    if (!points) return fail(points.error());
    if (auto ok = vk::upload_bytes(device, *points, 0, std::as_bytes(std::span(kCube))); !ok)
        return fail(ok.error());
    const auto vertices =
        vk::create_buffer(device, 24 * grid->sample_count(), vk::kPointUsage, vk::MemoryUse::device);
    if (!vertices) return fail(vertices.error());
    const auto level1 =
        evaluator->prepare_points({.patches = &*patches, .points = {.buffer = points->handle}});
    if (!level1) return fail(level1.error());
    const auto samples =
        evaluator->prepare_grid({.patches = &*patches,
                                 .grid = &*grid,
                                 .points = {.buffer = points->handle},
                                 .values = {.buffer = vertices->handle, .stride = 6},
                                 .normals = {.buffer = vertices->handle, .first = 3, .stride = 6}});
    if (!samples) return fail(samples.error());

    auto commands = vk::Commands::begin(device);
    if (!commands) return fail(commands.error());
    record_surface(device, *commands, *level1, *samples);
    record_barrier(device, *commands, vk::kKernelWrites, vk::kCopyReads);
    if (auto done = commands->submit_and_wait(); !done) return fail(done.error());
    const size_t count = grid->sample_count();
    const auto out = vk::download<float>(device, *vertices, 6 * count);
    if (!out) return fail(out.error());

    // The middle of the first face of a cube lies on its axis, at the height that the rules give, and looks
    // along it.
    const float* middle = out->data() + size_t{6} * (4 * 9 + 4);
    std::printf("%zu vertices on %s; the first face's middle: %g %g %g, normal %g %g %g\n", count,
                device.name(), double(middle[0]), double(middle[1]), double(middle[2]), double(middle[3]),
                double(middle[4]), double(middle[5]));
    const bool right = count == 486 && std::abs(middle[0]) < 1e-6f && std::abs(middle[1]) < 1e-6f &&
                       middle[2] > 0.5f && middle[2] < 1.0f && std::abs(middle[5] - 1) < 1e-6f;
    return right ? 0 : 1;
}
