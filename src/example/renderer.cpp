// limn in a renderer: tables once, objects for each frame in flight, and what each frame records.
#include "renderer.h"

#include <cmath>
#include <cstring>
#include <optional>

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
    limn::vk::record_barrier(device, commands, limn::vk::kKernelWrites, limn::vk::kDrawReads);
    return recorded;
}
// [/readme]

namespace {

namespace vk = limn::vk;

constexpr uint32_t kFramesInFlight = 2;
constexpr uint32_t kMaxVertices = 200'000, kMaxTriangles = 400'000;  // limn draws coarser rather than more
constexpr float kBackground[] = {0.26f, 0.28f, 0.31f, 1};

/// What a Result holds. An example may end where it holds an error.
template <class T>
T take(limn::Result<T> result) {
    if (!result) fail(result.error().message.c_str());
    return std::move(*result);
}
void take(const limn::Result<void>& result) {
    if (!result) fail(result.error().message.c_str());
}

/// From eye to the middle of the vase, z up: limn's camera and the shader's view, of one matrix.
limn::Camera make_camera(VkExtent2D size, const float (&eye)[3]) {
    const float width = static_cast<float>(size.width), height = static_cast<float>(size.height);
    const float distance = std::sqrt(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]);
    const float flat = std::hypot(eye[0], eye[1]), near_plane = 1, far_plane = 20, zoom = 4.3f;
    const float forward[3] = {-eye[0] / distance, -eye[1] / distance, -eye[2] / distance};
    const float right[3] = {-eye[1] / flat, eye[0] / flat, 0};
    const float up[3] = {right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2],
                         right[0] * forward[1] - right[1] * forward[0]};
    const float depth = far_plane / (far_plane - near_plane);
    limn::Camera camera{.width = width, .height = height};
    for (uint32_t axis = 0; axis < 3; ++axis) {
        float* column = camera.matrix + 4 * axis;
        column[0] = zoom * height / width * right[axis];
        column[1] = -zoom * up[axis];
        column[2] = depth * forward[axis];
        column[3] = forward[axis];
    }
    const float translation[4] = {0, 0, depth * (distance - near_plane), distance};
    std::memcpy(camera.matrix + 12, translation, sizeof(translation));
    return camera;
}

/// All that a frame in flight must not share with the other: what the host or the device writes.
struct Frame {
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence done = VK_NULL_HANDLE;
    Target target;
    vk::Buffer upload, points, vertices, indices, command, result, picture;
    std::optional<vk::StencilEvaluation> level1;
    std::optional<vk::Tessellation> surface;
};

}  // namespace

struct Renderer::State {
    State(const Gpu& device, VkExtent2D extent) : gpu(device), size(extent), context(borrow(device)) {}

    static vk::Context borrow(const Gpu& gpu) {
        return take(vk::Context::borrow({.instance = gpu.instance,
                                         .physical_device = gpu.physical,
                                         .device = gpu.device,
                                         .queue_family_index = gpu.queue_family,
                                         .get_instance_proc_addr = vkGetInstanceProcAddr,
                                         .queue = gpu.queue}));
    }
    void create_frame(Frame& frame) const;
    void prepare_surface(Frame& frame) const;
    void record(const Frame& frame) const;
    void draw_surface(const Frame& frame) const;

    Gpu gpu;
    VkExtent2D size;
    vk::Context context;  // first of limn's: destroyed last
    vk::SurfaceEvaluator evaluator = take(vk::SurfaceEvaluator::create(context.device()));
    vk::Tessellator tessellator = take(vk::Tessellator::create(context.device()));
    std::optional<vk::DevicePatchTable> patches;  // shared by all frames: nothing writes them
    std::optional<vk::DeviceTessellationTable> table;
    Frame frames[kFramesInFlight];
    uint32_t frame_index = 0;  // of the next frame

    VkRenderPass pass = create_render_pass(gpu.device);
    VkPipelineLayout layout = create_layout(gpu.device);
    VkPipeline pipeline = create_pipeline(gpu.device, layout, pass, size);
    const float eye[3] = {1.8f, -7.2f, 3.0f};
    limn::Camera camera = make_camera(size, eye);
};

/// Objects of a frame: command buffer, fence, target, and buffers that are the renderer's own.
void Renderer::State::create_frame(Frame& frame) const {
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .queueFamilyIndex = gpu.queue_family};
    check(vkCreateCommandPool(gpu.device, &pool, nullptr, &frame.pool), "vkCreateCommandPool");
    const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                  .commandPool = frame.pool,
                                                  .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                  .commandBufferCount = 1};
    check(vkAllocateCommandBuffers(gpu.device, &commands, &frame.commands), "vkAllocateCommandBuffers");
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    check(vkCreateFence(gpu.device, &fence, nullptr, &frame.done), "vkCreateFence");
    frame.target = create_target(gpu, pass, size);

    const vk::Device& device = context.device();
    const auto make = [&](uint64_t bytes, VkBufferUsageFlags usage, vk::MemoryUse use) {
        return take(vk::create_buffer(device, bytes, usage, use));
    };
    constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    frame.upload = make(12ull * patches->control_count, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, vk::MemoryUse::upload);
    frame.points = make(12ull * patches->point_count, vk::kPointUsage, vk::MemoryUse::device);
    frame.vertices = make(24ull * kMaxVertices, kStorage | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, vk::MemoryUse::device);
    frame.indices = make(12ull * kMaxTriangles, kStorage | VK_BUFFER_USAGE_INDEX_BUFFER_BIT, vk::MemoryUse::device);
    frame.command = make(sizeof(VkDrawIndexedIndirectCommand), kStorage | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT,
                         vk::MemoryUse::device);
    frame.result = make(sizeof(vk::TessellationResult), kStorage, vk::MemoryUse::readback);
    frame.picture = make(4ull * size.width * size.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT, vk::MemoryUse::readback);
}

/// limn's objects of a frame: prepared once, recorded every frame.
void Renderer::State::prepare_surface(Frame& frame) const {
    frame.level1 = take(evaluator.prepare_points({.patches = &*patches, .points = {.buffer = frame.points.handle}}));
    frame.surface =
        take(tessellator.prepare({.patches = &*patches,
                                  .table = &*table,
                                  .points = {.buffer = frame.points.handle},
                                  .mode = limn::RateMode::pixel_error,
                                  .vertex_capacity = kMaxVertices,
                                  .triangle_capacity = kMaxTriangles,
                                  .positions = {.buffer = frame.vertices.handle, .stride = 6},
                                  .normals = {.buffer = frame.vertices.handle, .first = 3, .stride = 6},
                                  .indices = {frame.indices.handle},
                                  .command = {frame.command.handle},
                                  .result = {frame.result.handle}}));
}

/// Control points to the device, the surface, the picture, and both back to the host.
void Renderer::State::record(const Frame& frame) const {
    const vk::Device& device = context.device();
    const VkBufferCopy control = {0, 0, frame.upload.size_bytes};
    vkCmdCopyBuffer(frame.commands, frame.upload.handle, frame.points.handle, 1, &control);
    vk::record_barrier(device, frame.commands, vk::kCopyWrites, vk::kKernelReads);
    take(record_surface(device, frame.commands, *frame.level1, *frame.surface, camera));
    draw_surface(frame);

    VkBufferImageCopy whole = {};
    whole.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    whole.imageExtent = {size.width, size.height, 1};
    vkCmdCopyImageToBuffer(frame.commands, frame.target.resolved.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           frame.picture.handle, 1, &whole);
    vk::record_barrier(device, frame.commands, vk::kCopyWrites, vk::kHostReads);
    vk::record_barrier(device, frame.commands, vk::kKernelWrites, vk::kHostReads);
}

void Renderer::State::draw_surface(const Frame& frame) const {
    VkClearValue clear[2] = {};
    std::memcpy(clear[0].color.float32, kBackground, sizeof(kBackground));
    clear[1].depthStencil.depth = 1;
    const VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                         .renderPass = pass,
                                         .framebuffer = frame.target.framebuffer,
                                         .renderArea = {{0, 0}, size},
                                         .clearValueCount = 2,
                                         .pClearValues = clear};
    View view = {.clip_from_world = {}, .eye = {eye[0], eye[1], eye[2], 1}};
    std::memcpy(view.clip_from_world, camera.matrix, sizeof(camera.matrix));
    const VkDeviceSize start = 0;
    vkCmdBeginRenderPass(frame.commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(frame.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    vkCmdPushConstants(frame.commands, layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(view), &view);
    vkCmdBindVertexBuffers(frame.commands, 0, 1, &frame.vertices.handle, &start);
    vkCmdBindIndexBuffer(frame.commands, frame.indices.handle, 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexedIndirect(frame.commands, frame.command.handle, 0, 1, sizeof(VkDrawIndexedIndirectCommand));
    vkCmdEndRenderPass(frame.commands);
}

Renderer::Renderer(const Gpu& gpu, VkExtent2D size) : state_(std::make_unique<State>(gpu, size)) {
    const Tables tables = take(build_tables(make_vase().description()));
    const vk::Device& device = state_->context.device();
    state_->patches = take(vk::upload_patch_table(device, tables.patches));
    state_->table = take(vk::upload_tessellation_table(device, tables.topology, tables.trees));
    for (Frame& frame : state_->frames) {
        state_->create_frame(frame);
        state_->prepare_surface(frame);
    }
}

Renderer::~Renderer() {
    VkDevice device = state_->gpu.device;
    vkDeviceWaitIdle(device);
    for (Frame& frame : state_->frames) {
        destroy_target(device, frame.target);
        vkDestroyFence(device, frame.done, nullptr);
        vkDestroyCommandPool(device, frame.pool, nullptr);
    }
    vkDestroyPipeline(device, state_->pipeline, nullptr);
    vkDestroyPipelineLayout(device, state_->layout, nullptr);
    vkDestroyRenderPass(device, state_->pass, nullptr);
}

void Renderer::draw(const Mesh& mesh, float time) {
    const Gpu& gpu = state_->gpu;
    const Frame& frame = state_->frames[state_->frame_index++ % kFramesInFlight];
    check(vkWaitForFences(gpu.device, 1, &frame.done, VK_TRUE, ~uint64_t{0}), "vkWaitForFences");
    check(vkResetFences(gpu.device, 1, &frame.done), "vkResetFences");
    animate(mesh, time, static_cast<float*>(frame.upload.mapped()));

    check(vkResetCommandPool(gpu.device, frame.pool, 0), "vkResetCommandPool");
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                            .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(frame.commands, &begin), "vkBeginCommandBuffer");
    state_->record(frame);
    check(vkEndCommandBuffer(frame.commands), "vkEndCommandBuffer");
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &frame.commands};
    check(vkQueueSubmit(gpu.queue, 1, &submit, frame.done), "vkQueueSubmit");
}

vk::TessellationResult Renderer::read(std::vector<uint8_t>& pixels) {
    const Frame& frame = state_->frames[(state_->frame_index + kFramesInFlight - 1) % kFramesInFlight];
    check(vkWaitForFences(state_->gpu.device, 1, &frame.done, VK_TRUE, ~uint64_t{0}), "vkWaitForFences");
    const auto* bytes = static_cast<const uint8_t*>(frame.picture.mapped());
    pixels.assign(bytes, bytes + frame.picture.size_bytes);
    vk::TessellationResult result;
    std::memcpy(&result, frame.result.mapped(), sizeof(result));
    return result;
}
