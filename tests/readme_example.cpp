// The README's example, run: a cube refined three times on the device, its points read back and looked at.
#include <cmath>
#include <cstdio>
#include <vector>

// [readme]
#include <limn/refinement.h>
#include <limn/stencil_table.h>
#include <limn/vulkan/evaluator.h>

// Once per topology: what each refined point is made of.
limn::Result<std::vector<limn::StencilTable>> build_tables(const limn::ControlMeshDescription& description) {
    const auto mesh = limn::ControlMesh::create(description);
    if (!mesh) return mesh.error();
    const auto refinement = limn::build_refinement(*mesh, {.level = 3});
    if (!refinement) return refinement.error();
    std::vector<limn::StencilTable> tables;
    for (uint32_t level = 1; level < refinement->level_count(); ++level) {
        auto table = limn::build_step_table<float>(*refinement, level);
        if (!table) return table.error();
        tables.push_back(std::move(*table));
    }
    return tables;  // the faces are in refinement->last().face_vertices
}

// Every frame, in your command buffer, on your buffers: points[0] are the control points, points[3] the
// result.
void record_refinement(const limn::vk::Device& device, VkCommandBuffer commands,
                       const std::vector<limn::vk::StencilEvaluation>& steps) {
    for (const limn::vk::StencilEvaluation& step : steps) {
        step.record(commands);
        limn::vk::record_barrier(device, commands, limn::vk::kKernelWrites, limn::vk::kKernelReads);
    }
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
    const auto evaluator = vk::Evaluator::create(device);
    if (!evaluator) return fail(evaluator.error());

    std::vector<vk::DeviceStencilTable> device_tables;
    std::vector<vk::Buffer> points;
    std::vector<vk::StencilEvaluation> steps;
    device_tables.reserve(tables->size());
    auto control = vk::create_point_buffer(device, kCube);
    if (!control) return fail(control.error());
    points.push_back(std::move(*control));
    for (const limn::StencilTable& table : *tables) {
        auto uploaded = vk::upload_stencil_table(device, table);
        if (!uploaded) return fail(uploaded.error());
        device_tables.push_back(std::move(*uploaded));
        auto out = vk::create_buffer(device, table.row_count() * 12, vk::kPointUsage, vk::MemoryUse::device);
        if (!out) return fail(out.error());
        auto step = evaluator->prepare({.table = &device_tables.back(),
                                        .source = {.buffer = points.back().handle},
                                        .destination = {.buffer = out->handle}});
        if (!step) return fail(step.error());
        steps.push_back(std::move(*step));
        points.push_back(std::move(*out));
    }
    auto commands = vk::Commands::begin(device);
    if (!commands) return fail(commands.error());
    record_refinement(device, *commands, steps);
    if (auto done = commands->submit_and_wait(); !done) return fail(done.error());
    const uint32_t count = tables->back().row_count();
    const auto refined = vk::download<float>(device, points.back(), size_t{3} * count);
    if (!refined) return fail(refined.error());

    // The first face point of a cube refined three times lies on its axis, at the height that the rules give.
    const float* face_point = refined->data() + size_t{3} * 8;
    std::printf("%u points on %s; first face point %g %g %g\n", count, device.name(), double(face_point[0]),
                double(face_point[1]), double(face_point[2]));
    const bool right = count == 386 && std::abs(face_point[0]) < 1e-6f && std::abs(face_point[1]) < 1e-6f &&
                       face_point[2] > 0.5f && face_point[2] < 1.0f;
    return right ? 0 : 1;
}
