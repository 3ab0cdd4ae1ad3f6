// The C interface on Vulkan gives the C++ interface's bits, on a borrowed device with the caller's allocator;
// it refuses what it has to; and its structs and values stay as they are.
#include <cstddef>
#include <cstring>

#include "limn/batch.h"
#include "limn/c/limn_vulkan.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk::test {
namespace {

#define LIMN_PIN(type, member, offset) static_assert(offsetof(type, member) == (offset))
static_assert(sizeof(limn_vk_memory_block) == 32 && sizeof(limn_vk_allocator) == 24 &&
              sizeof(limn_vk_stage_access) == 8);
static_assert(sizeof(limn_vk_borrowed_handles) == 72 && sizeof(limn_vk_context_options) == 16);
static_assert(sizeof(limn_vk_context_info) == 312 && sizeof(limn_vk_points) == 32 &&
              sizeof(limn_vk_words) == 16);
static_assert(sizeof(limn_vk_points_info) == 48 && sizeof(limn_vk_stencils_info) == 152);
static_assert(sizeof(limn_vk_grid_info) == 184 && sizeof(limn_vk_local_points_info) == 64);
static_assert(sizeof(limn_vk_samples_info) == 152 && sizeof(limn_vk_tessellated_channel) == 80);
static_assert(sizeof(limn_vk_height_texture) == 32 && sizeof(limn_vk_tessellation_info) == 456);
static_assert(sizeof(limn_vk_tessellation_result) == 16 && sizeof(limn_vk_instance) == 64);
static_assert(sizeof(limn_vk_rate_settings) == 88);
LIMN_PIN(limn_vk_memory_block, mapped, 16);
LIMN_PIN(limn_vk_memory_block, user, 24);
LIMN_PIN(limn_vk_allocator, free, 16);
LIMN_PIN(limn_vk_borrowed_handles, device, 24);
LIMN_PIN(limn_vk_borrowed_handles, allocator, 48);
LIMN_PIN(limn_vk_context_info, queue, 32);
LIMN_PIN(limn_vk_context_info, validation_message_count, 48);
LIMN_PIN(limn_vk_context_info, device_name, 56);
LIMN_PIN(limn_vk_points, first, 16);
LIMN_PIN(limn_vk_points, stride, 24);
LIMN_PIN(limn_vk_points_info, points, 16);
LIMN_PIN(limn_vk_stencils_info, destination, 48);
LIMN_PIN(limn_vk_stencils_info, first_row, 144);
LIMN_PIN(limn_vk_grid_info, values, 56);
LIMN_PIN(limn_vk_grid_info, dv, 152);
LIMN_PIN(limn_vk_local_points_info, local_points, 56);
LIMN_PIN(limn_vk_samples_info, points, 24);
LIMN_PIN(limn_vk_samples_info, results, 72);
LIMN_PIN(limn_vk_samples_info, trees, 136);
LIMN_PIN(limn_vk_tessellated_channel, points, 16);
LIMN_PIN(limn_vk_height_texture, layout, 16);
LIMN_PIN(limn_vk_height_texture, bias, 28);
LIMN_PIN(limn_vk_tessellation_info, points, 24);
LIMN_PIN(limn_vk_tessellation_info, vertex_capacity, 64);
LIMN_PIN(limn_vk_tessellation_info, edge_rates, 72);
LIMN_PIN(limn_vk_tessellation_info, positions, 104);
LIMN_PIN(limn_vk_tessellation_info, channels, 232);
LIMN_PIN(limn_vk_tessellation_info, previous_points, 248);
LIMN_PIN(limn_vk_tessellation_info, heights, 312);
LIMN_PIN(limn_vk_tessellation_info, height_texture, 344);
LIMN_PIN(limn_vk_tessellation_info, indices, 376);
LIMN_PIN(limn_vk_tessellation_info, result, 440);
LIMN_PIN(limn_vk_instance, value_scale, 48);
LIMN_PIN(limn_vk_tessellation_result, rate_scale, 12);
LIMN_PIN(limn_vk_rate_settings, matrix, 16);
LIMN_PIN(limn_vk_rate_settings, height, 84);
static_assert(LIMN_VK_DEVICE_INDEX == 2 && LIMN_RATE_DISTANCE == 5 && LIMN_SPACING_FRACTIONAL == 2);
static_assert(LIMN_VK_TESSELLATION_FIRST_INSTANCE_0 == 32 && LIMN_VK_PASS_DISPLACEMENT == 32);

// Two quads and a triangle; a crease, a boundary and a channel with a seam.
constexpr uint32_t kSizes[] = {4, 4, 3}, kFaces[] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 6};
constexpr uint32_t kCrease[] = {1, 4}, kValues[] = {0, 1, 4, 3, 7, 2, 5, 8, 3, 4, 6}, kChannels[] = {0};
constexpr float kSharpness[] = {10};
constexpr uint32_t kVertexCount = 7, kValueCount = 9, kVertexCapacity = 2048, kTriangleCapacity = 4096;
constexpr uint32_t kGridRate = 4, kSampleCount = 40, kLevel = 2;

/// Where everything is in the one buffer that a device writes, in bytes.
struct Layout {
    VkDeviceSize end = 0;
    VkDeviceSize add(VkDeviceSize words) {
        const VkDeviceSize begin = end;
        end += 4 * words;
        return begin;
    }
    VkDeviceSize positions = add(3 * kVertexCapacity), normals = add(3 * kVertexCapacity),
                 places = add(4 * kVertexCapacity), tangents = add(4 * kVertexCapacity),
                 channel = add(2 * kVertexCapacity), previous = add(3 * kVertexCapacity),
                 indices = add(3 * kTriangleCapacity), triangle_faces = add(kTriangleCapacity),
                 command = add(5), instance_commands = add(10), result = add(4), grid = add(3 * 1024),
                 grid_normals = add(3 * 1024), samples = add(9 * kSampleCount), statuses = add(kSampleCount),
                 tree_samples = add(9 * kSampleCount), stencils = add(3 * 1024), tangent1 = add(3 * 1024),
                 tangent2 = add(3 * 1024);
};

/// The caller's: made with the C++ interface for both.
struct Inputs {
    Buffer points, previous_points, values, instances, samples, local_points, output;
    static constexpr VkDeviceSize kPointBytes = 1 << 16;
};
std::vector<float> some_floats(size_t count, float scale) {
    std::vector<float> out(count);
    for (size_t i = 0; i < count; ++i) out[i] = scale * static_cast<float>(i * i % 23);
    return out;
}
Buffer filled_buffer(const Device& device, std::span<const std::byte> bytes, VkDeviceSize size) {
    Buffer buffer = *create_buffer(device, size, kPointUsage, MemoryUse::device);
    const std::vector<std::byte> zeros(size);
    EXPECT_TRUE(upload_bytes(device, buffer, 0, zeros));
    EXPECT_TRUE(upload_bytes(device, buffer, 0, bytes));
    return buffer;
}
Inputs make_inputs(const Device& device) {
    const auto floats = [&](size_t count, float scale) {
        const std::vector<float> values = some_floats(count, scale);
        return filled_buffer(device, std::as_bytes(std::span(values)), Inputs::kPointBytes);
    };
    TessellationInstance instances[2] = {{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 1, 0, {}},
                                         {{2, 0, 0, 5, 0, 2, 0, 0, 0, 0, 2, 0}, 0.5f, 0, {}}};
    struct Sample {
        uint32_t face;
        float u, v;
    };
    std::vector<Sample> samples;
    for (uint32_t i = 0; i < kSampleCount; ++i)
        samples.push_back({i % 6, static_cast<float>(i % 7) / 7, static_cast<float>(i % 11) / 11});
    return {floats(2 * 3 * kVertexCount, 0.1f),
            floats(2 * 3 * kVertexCount, 0.12f),
            floats(2 * 2 * kValueCount, 0.05f),
            filled_buffer(device, std::as_bytes(std::span(instances)), sizeof(instances)),
            filled_buffer(device, std::as_bytes(std::span(samples)), sizeof(Sample) * kSampleCount),
            filled_buffer(device, {}, 1 << 16),
            filled_buffer(device, {}, Layout().end)};
}
std::vector<uint32_t> read_output(const Device& device, const Inputs& inputs) {
    return *download<uint32_t>(device, inputs.output, Layout().end / 4);
}

/// With the C++ interface.
std::vector<uint32_t> run_in_cpp(const Device& device) {
    const Inputs in = make_inputs(device);
    const Layout at;
    const FaceVaryingDescription channels[] = {{kValueCount, kValues, FaceVaryingInterpolation::all}};
    const ControlMesh mesh = *ControlMesh::create({.vertex_count = kVertexCount,
                                                   .face_sizes = kSizes,
                                                   .face_vertices = kFaces,
                                                   .crease_vertices = kCrease,
                                                   .crease_sharpness = kSharpness,
                                                   .channels = channels});
    const PatchTable one = *build_patch_table<float>(mesh, {}),
                     one_channel = *build_face_varying_patch_table<float>(mesh, 0, {});
    const PatchTable* const twice[] = {&one, &one};
    const PatchTable* const channel_twice[] = {&one_channel, &one_channel};
    const PatchTable patches = merge_patch_tables<float>(twice)->table;
    const PatchTable channel = merge_patch_tables<float>(channel_twice)->table;
    const TessellationTable one_topology = *build_tessellation_table(mesh, {.channels = kChannels});
    const TessellationTable* const topology_twice[] = {&one_topology, &one_topology};
    const TessellationTable topology = merge_tessellation_tables(topology_twice)->table;
    const PatchTreeTable trees = *build_patch_trees(patches, {}),
                         channel_trees = *build_patch_trees(channel, {});
    const PatchTreeTable* const all_channel_trees[] = {&channel_trees};
    const DevicePatchTable device_patches = *upload_patch_table(device, patches);
    const DevicePatchTable device_channel = *upload_patch_table(device, channel);
    const DeviceTessellationTable table =
        *upload_tessellation_table(device, topology, trees, all_channel_trees);
    const DevicePatchTrees sample_trees =
        *upload_patch_trees(device, *build_patch_trees(patches, {.max_rate = 16, .relative = true}));
    const DeviceGridTable grid = *upload_grid_table(device, *build_grid_table(patches, {.rate = kGridRate}));
    const DeviceStencilTable stencils = *upload_stencil_table(
        device, *build_limit_table<float>(*build_refinement(mesh, {.level = 0, .full_last_level = true}),
                                          kLevel, true));
    EXPECT_LE(grid.sample_count(), 1024u);
    EXPECT_LE(stencils.row_count, 1024u);
    EXPECT_LE(12 * patches.point_count(), Inputs::kPointBytes);
    EXPECT_LE(16 * sample_trees.local_count, uint32_t{1} << 16);

    const SurfaceEvaluator surfaces = *SurfaceEvaluator::create(device);
    const Evaluator evaluator = *Evaluator::create(device);
    const Tessellator tessellator = *Tessellator::create(device);
    const auto refine = [&](const DevicePatchTable& of, const Buffer& points, uint32_t width) {
        return *surfaces.prepare_points(
            {.patches = &of, .width = width, .points = {.buffer = points.handle, .stride = width}});
    };
    const auto output = [&](VkDeviceSize offset, uint32_t stride = 3) {
        return PointBuffer{in.output.handle, offset, 0, stride};
    };
    const StencilEvaluation refined[] = {refine(device_patches, in.points, 3),
                                         refine(device_patches, in.previous_points, 3),
                                         refine(device_channel, in.values, 2)};
    const TessellatedChannel tessellated[] = {{.channel = 0,
                                               .patches = &device_channel,
                                               .points = {.buffer = in.values.handle, .stride = 2},
                                               .values = output(at.channel, 2)}};
    const vk::Tessellation tessellation =
        *tessellator.prepare({.patches = &device_patches,
                              .table = &table,
                              .points = {.buffer = in.points.handle},
                              .mode = RateMode::pixel_error,
                              .spacing = TessellationSpacing::fractional,
                              .cull_outside = true,
                              .instances = {in.instances.handle},
                              .vertex_capacity = kVertexCapacity,
                              .triangle_capacity = kTriangleCapacity,
                              .positions = output(at.positions),
                              .normals = output(at.normals),
                              .places = output(at.places, 4),
                              .tangents = output(at.tangents, 4),
                              .tangent_channel = 0,
                              .channels = tessellated,
                              .previous_points = {.buffer = in.previous_points.handle},
                              .previous_positions = output(at.previous),
                              .indices = {in.output.handle, at.indices},
                              .clockwise = true,
                              .triangle_faces = {in.output.handle, at.triangle_faces},
                              .command = {in.output.handle, at.command},
                              .instance_commands = {in.output.handle, at.instance_commands},
                              .number_instances = false,
                              .result = {in.output.handle, at.result}});
    const SurfaceEvaluation on_grid = *surfaces.prepare_grid({.patches = &device_patches,
                                                              .grid = &grid,
                                                              .points = {.buffer = in.points.handle},
                                                              .values = output(at.grid),
                                                              .normals = output(at.grid_normals)});
    const SurfaceEvaluation local = *surfaces.prepare_local_points({.patches = &device_patches,
                                                                    .trees = &sample_trees,
                                                                    .points = {.buffer = in.points.handle},
                                                                    .local_points = in.local_points.handle});
    PatchEvaluationInfo samples{.patches = &device_patches,
                                .points = {.buffer = in.points.handle},
                                .samples = {in.samples.handle, 0, kSampleCount},
                                .results = output(at.samples, 9),
                                .statuses = output(at.statuses, 1)};
    const SurfaceEvaluation at_samples = *surfaces.prepare_samples(samples);
    samples.results = output(at.tree_samples, 9);
    samples.statuses = {};
    samples.trees = &sample_trees;
    samples.local_points = in.local_points.handle;
    const SurfaceEvaluation at_tree_samples = *surfaces.prepare_samples(samples);
    const StencilEvaluation limits = *evaluator.prepare({.table = &stencils,
                                                         .source = {.buffer = in.points.handle},
                                                         .destination = output(at.stencils),
                                                         .tangent1 = output(at.tangent1),
                                                         .tangent2 = output(at.tangent2),
                                                         .first_row = 3});
    Commands commands = *Commands::begin(device);
    for (const StencilEvaluation& r : refined) r.record(commands);
    record_barrier(device, commands, kKernelWrites, kKernelReads);
    RateSettings settings{.mode = RateMode::pixel_error,
                          .value = 0.5f,
                          .spacing = TessellationSpacing::fractional,
                          .max_rate = 16,
                          .cull_outside = true,
                          .bound = 0.25f};
    settings.camera.width = 300, settings.camera.height = 200;
    settings.camera.matrix[0] = settings.camera.matrix[5] = 0.2f;
    EXPECT_TRUE(tessellation.record(commands, settings));
    on_grid.record(commands);
    local.record(commands);
    record_barrier(device, commands, kKernelWrites, kKernelReads);
    at_samples.record(commands);
    at_tree_samples.record(commands);
    limits.record(commands);
    EXPECT_TRUE(commands.submit_and_wait());
    return read_output(device, in);
}

/// The caller's allocator: memory of kernels is not mapped, so that uploads are staged.
struct CountingAllocator {
    const Device& device;
    int live = 0, staged = 0;

    static VkResult allocate(void* user, const VkMemoryRequirements* needs, limn_vk_memory_use use,
                             limn_vk_memory_block* block) {
        auto& self = *static_cast<CountingAllocator*>(user);
        constexpr VkMemoryPropertyFlags kHost =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        VkMemoryAllocateInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        info.allocationSize = needs->size;
        const auto fits = [&](uint32_t type) {
            return (needs->memoryTypeBits >> type & 1) != 0 &&
                   (self.device.memory_properties.memoryTypes[type].propertyFlags & kHost) == kHost;
        };
        while (!fits(info.memoryTypeIndex))
            if (++info.memoryTypeIndex == self.device.memory_properties.memoryTypeCount)
                return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        const Functions& f = self.device.functions;
        const VkResult result = f.AllocateMemory(self.device.handle, &info, nullptr, &block->memory);
        if (result != VK_SUCCESS) return result;
        ++self.live;
        block->user = &self;
        if (use == LIMN_VK_MEMORY_DEVICE) return VK_SUCCESS;
        ++self.staged;
        return f.MapMemory(self.device.handle, block->memory, 0, VK_WHOLE_SIZE, 0, &block->mapped);
    }
    static void release(void* user, const limn_vk_memory_block* block) {
        auto& self = *static_cast<CountingAllocator*>(user);
        EXPECT_EQ(block->user, user);
        --self.live;
        self.device.functions.FreeMemory(self.device.handle, block->memory, nullptr);
    }
};

/// Objects of the C interface, destroyed in reverse.
struct Objects {
    std::vector<std::pair<void*, void (*)(void*)>> all;

    template <auto destroy, class Object, class Create, class... Args>
    Object* add(Create create, Args... args) {
        Object* object = nullptr;
        limn_error error = {};
        EXPECT_EQ(create(args..., &object, &error), LIMN_SUCCESS) << error.message;
        all.push_back({object, [](void* o) { destroy(static_cast<Object*>(o)); }});
        return object;
    }
    ~Objects() {
        for (; !all.empty(); all.pop_back()) all.back().second(all.back().first);
    }
};
#define LIMN_NEW(objects, type, create, ...) (objects).add<type##_destroy, type>(create, __VA_ARGS__)

template <class Info>
Info sized() {
    Info info = {};
    info.struct_size = sizeof(info);
    return info;
}
limn_vk_points points_of(const Buffer& buffer, VkDeviceSize offset = 0) {
    return {buffer.handle, offset, 0, 0, 0};
}

limn_control_mesh_description describe_in_c(const limn_face_varying_channel& channel) {
    auto d = sized<limn_control_mesh_description>();
    d.vertex_count = kVertexCount;
    d.channel_count = 1;
    d.channels = &channel;
    d.face_sizes = kSizes, d.face_count = 3;
    d.face_vertices = kFaces, d.face_vertex_count = 11;
    d.crease_vertices = kCrease, d.crease_vertex_count = 2;
    d.crease_sharpness = kSharpness, d.crease_sharpness_count = 1;
    return d;
}

limn_vk_context* borrow_in_c(Objects& objects, const Device& device, CountingAllocator& allocator) {
    auto handles = sized<limn_vk_borrowed_handles>();
    handles.queue_family_index = device.queue_family_index;
    handles.instance = device.instance;
    handles.physical_device = device.physical_device;
    handles.device = device.handle;
    handles.get_instance_proc_addr = device.functions.GetInstanceProcAddr;
    handles.allocator = {&allocator, CountingAllocator::allocate, CountingAllocator::release};
    return LIMN_NEW(objects, limn_vk_context, limn_vk_context_borrow, &handles);
}

/// All that is made once per topology.
struct CTables {
    limn_control_mesh* mesh;
    limn_patch_table *patches, *channel;
    limn_patch_trees *trees, *channel_trees, *sample_trees;
    limn_tessellation_table* topology;
    limn_grid_table* grid;
    limn_stencil_table* stencils;
};
CTables build_in_c(Objects& objects) {
    CTables t = {};
    const limn_face_varying_channel channel = {kValues, 11, kValueCount, LIMN_FACE_VARYING_ALL};
    const limn_control_mesh_description description = describe_in_c(channel);
    t.mesh = LIMN_NEW(objects, limn_control_mesh, limn_control_mesh_create, &description);
    auto* one = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create, t.mesh, nullptr, nullptr);
    auto* one_channel =
        LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_channel, t.mesh, 0, nullptr, nullptr);
    const limn_patch_table* const twice[] = {one, one};
    const limn_patch_table* const channel_twice[] = {one_channel, one_channel};
    t.patches = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_merged, twice, 2);
    t.channel = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_merged, channel_twice, 2);
    auto topology = sized<limn_tessellation_table_options>();
    topology.channels = kChannels, topology.channel_count = 1;
    const limn_tessellation_table* const one_topology =
        LIMN_NEW(objects, limn_tessellation_table, limn_tessellation_table_create, t.mesh, &topology);
    const limn_tessellation_table* const topology_twice[] = {one_topology, one_topology};
    t.topology =
        LIMN_NEW(objects, limn_tessellation_table, limn_tessellation_table_create_merged, topology_twice, 2);
    t.trees = LIMN_NEW(objects, limn_patch_trees, limn_patch_trees_create, t.patches, nullptr);
    t.channel_trees = LIMN_NEW(objects, limn_patch_trees, limn_patch_trees_create, t.channel, nullptr);
    auto trees = sized<limn_patch_trees_options>();
    trees.max_rate = 16;
    trees.flags = LIMN_PATCH_TREES_RELATIVE;
    t.sample_trees = LIMN_NEW(objects, limn_patch_trees, limn_patch_trees_create, t.patches, &trees);
    auto grid = sized<limn_grid_table_options>();
    grid.rate = kGridRate;
    t.grid = LIMN_NEW(objects, limn_grid_table, limn_grid_table_create, t.patches, &grid);
    auto stencils = sized<limn_stencil_table_options>();
    stencils.level = kLevel;
    stencils.flags = LIMN_STENCIL_TABLE_LIMIT | LIMN_STENCIL_TABLE_TANGENTS;
    t.stencils = LIMN_NEW(objects, limn_stencil_table, limn_stencil_table_create, t.mesh, &stencils);
    return t;
}

struct CDeviceTables {
    limn_vk_patch_table *patches, *channel;
    limn_vk_tessellation_table* topology;
    limn_vk_patch_trees* sample_trees;
    limn_vk_grid_table* grid;
    limn_vk_stencil_table* stencils;
};
CDeviceTables upload_in_c(Objects& objects, limn_vk_upload* upload, const CTables& t) {
    const limn_patch_trees* const channels[] = {t.channel_trees};
    return {LIMN_NEW(objects, limn_vk_patch_table, limn_vk_patch_table_create, upload, t.patches),
            LIMN_NEW(objects, limn_vk_patch_table, limn_vk_patch_table_create, upload, t.channel),
            LIMN_NEW(objects, limn_vk_tessellation_table, limn_vk_tessellation_table_create, upload,
                     t.topology, t.trees, channels, 1),
            LIMN_NEW(objects, limn_vk_patch_trees, limn_vk_patch_trees_create, upload, t.sample_trees),
            LIMN_NEW(objects, limn_vk_grid_table, limn_vk_grid_table_create, upload, t.grid),
            LIMN_NEW(objects, limn_vk_stencil_table, limn_vk_stencil_table_create, upload, t.stencils)};
}

limn_vk_tessellation_info describe_tessellation(const CDeviceTables& t,
                                                const limn_vk_tessellated_channel& channel,
                                                const Inputs& in) {
    const Layout at;
    const auto output = [&](VkDeviceSize offset) { return points_of(in.output, offset); };
    const auto words = [&](VkDeviceSize offset) { return limn_vk_words{in.output.handle, offset}; };
    auto i = sized<limn_vk_tessellation_info>();
    i.flags = LIMN_VK_TESSELLATION_CULL_OUTSIDE | LIMN_VK_TESSELLATION_CLOCKWISE |
              LIMN_VK_TESSELLATION_CHANNEL_TANGENTS | LIMN_VK_TESSELLATION_FIRST_INSTANCE_0;
    i.patches = t.patches, i.table = t.topology;
    i.points = points_of(in.points);
    i.mode = LIMN_RATE_PIXEL_ERROR, i.spacing = LIMN_SPACING_FRACTIONAL;
    i.vertex_capacity = kVertexCapacity, i.triangle_capacity = kTriangleCapacity;
    i.instances = {in.instances.handle, 0};
    i.positions = output(at.positions), i.normals = output(at.normals);
    i.places = output(at.places), i.tangents = output(at.tangents);
    i.channels = &channel, i.channel_count = 1;
    i.previous_points = points_of(in.previous_points), i.previous_positions = output(at.previous);
    i.indices = words(at.indices), i.triangle_faces = words(at.triangle_faces);
    i.command = words(at.command), i.instance_commands = words(at.instance_commands),
    i.result = words(at.result);
    return i;
}

/// `refined` makes level-1 points, `all` the rest, in this order but for a barrier behind the first.
struct CEvaluations {
    std::vector<limn_vk_evaluation*> refined, all;
};
CEvaluations prepare_in_c(Objects& objects, limn_vk_evaluator* evaluator, const CDeviceTables& t,
                          const Inputs& in) {
    const Layout at;
    CEvaluations out;
    const auto refine = [&](const limn_vk_patch_table* patches, const Buffer& points, uint32_t width) {
        auto info = sized<limn_vk_points_info>();
        info.patches = patches, info.width = width, info.points = points_of(points);
        out.refined.push_back(
            LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_points, evaluator, &info));
    };
    refine(t.patches, in.points, 0);
    refine(t.patches, in.previous_points, 3);
    refine(t.channel, in.values, 2);
    auto grid = sized<limn_vk_grid_info>();
    grid.patches = t.patches, grid.grid = t.grid, grid.points = points_of(in.points);
    grid.values = points_of(in.output, at.grid), grid.normals = points_of(in.output, at.grid_normals);
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_grid, evaluator, &grid));
    auto local = sized<limn_vk_local_points_info>();
    local.patches = t.patches, local.trees = t.sample_trees, local.points = points_of(in.points);
    local.local_points = in.local_points.handle;
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_local_points, evaluator, &local));
    auto samples = sized<limn_vk_samples_info>();
    samples.patches = t.patches, samples.derivatives = LIMN_DERIVATIVES_FIRST;
    samples.points = points_of(in.points), samples.samples = in.samples.handle,
    samples.sample_count = kSampleCount;
    samples.results = points_of(in.output, at.samples), samples.statuses = points_of(in.output, at.statuses);
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_samples, evaluator, &samples));
    samples.results = points_of(in.output, at.tree_samples), samples.statuses = {};
    samples.trees = t.sample_trees, samples.local_points = in.local_points.handle;
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_samples, evaluator, &samples));
    auto stencils = sized<limn_vk_stencils_info>();
    stencils.table = t.stencils, stencils.source = points_of(in.points), stencils.first_row = 3;
    stencils.destination = points_of(in.output, at.stencils);
    stencils.tangent1 = points_of(in.output, at.tangent1),
    stencils.tangent2 = points_of(in.output, at.tangent2);
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_stencils, evaluator, &stencils));
    return out;
}

limn_vk_rate_settings settings_in_c() {
    auto settings = sized<limn_vk_rate_settings>();
    settings.value = 0.5f, settings.max_rate = 16, settings.bound = 0.25f;
    settings.width = 300, settings.height = 200;
    settings.matrix[0] = settings.matrix[5] = 0.2f, settings.matrix[10] = settings.matrix[15] = 1;
    return settings;
}

/// With the C interface; by passes one after the other where `by_passes`.
std::vector<uint32_t> run_in_c(const Device& device, CountingAllocator& allocator, bool by_passes) {
    const Inputs in = make_inputs(device);
    Objects objects;
    limn_error error = {};
    limn_vk_context* context = borrow_in_c(objects, device, allocator);
    const CTables tables = build_in_c(objects);
    Commands commands = *Commands::begin(device);
    limn_vk_upload* upload =
        LIMN_NEW(objects, limn_vk_upload, limn_vk_upload_create, context, commands.handle());
    const CDeviceTables on_device = upload_in_c(objects, upload, tables);
    auto* evaluator = LIMN_NEW(objects, limn_vk_evaluator, limn_vk_evaluator_create, context);
    auto* tessellator = LIMN_NEW(objects, limn_vk_tessellator, limn_vk_tessellator_create, context);
    const limn_vk_tessellated_channel channel = {on_device.channel, 0, 0, points_of(in.values),
                                                 points_of(in.output, Layout().channel)};
    const limn_vk_tessellation_info info = describe_tessellation(on_device, channel, in);
    auto* tessellation =
        LIMN_NEW(objects, limn_vk_tessellation, limn_vk_tessellator_prepare, tessellator, &info);
    const CEvaluations evaluations = prepare_in_c(objects, evaluator, on_device, in);
    const limn_vk_stage_access writes = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_WRITES};
    const limn_vk_stage_access reads = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_READS};
    for (const limn_vk_evaluation* e : evaluations.refined) limn_vk_evaluation_record(e, commands);
    limn_vk_record_barrier(context, commands, writes, reads);
    const limn_vk_rate_settings settings = settings_in_c();
    for (uint32_t pass = 1; by_passes && pass < LIMN_VK_PASS_DISPLACEMENT; pass *= 2)
        EXPECT_EQ(limn_vk_tessellation_record_passes(tessellation, commands, pass, &settings, &error),
                  LIMN_SUCCESS);
    if (!by_passes) {
        EXPECT_EQ(limn_vk_tessellation_record(tessellation, commands, &settings, &error), LIMN_SUCCESS);
    }
    for (const limn_vk_evaluation* e : evaluations.all) {
        limn_vk_evaluation_record(e, commands);
        limn_vk_record_barrier(context, commands, writes, reads);
    }
    EXPECT_TRUE(commands.submit_and_wait());
    EXPECT_GT(limn_vk_tessellation_get_state_bytes(tessellation), 0u);
    return read_output(device, in);
}

class CInterfaceOnVulkan : public VulkanTest {};

TEST_F(CInterfaceOnVulkan, GivesTheBitsOfTheCppInterface) {
    const std::vector<uint32_t> expected = run_in_cpp(device());
    const uint32_t* result = expected.data() + Layout().result / 4;
    EXPECT_LE(result[0], LIMN_TESSELLATION_SCALED);
    EXPECT_GT(result[2], 20u);  // triangles
    for (const VkDeviceSize output :
         {Layout().normals, Layout().channel, Layout().previous, Layout().tangents, Layout().grid,
          Layout().samples, Layout().tree_samples, Layout().stencils, Layout().tangent2})
        EXPECT_TRUE(std::any_of(expected.begin() + static_cast<ptrdiff_t>(output / 4),
                                expected.begin() + static_cast<ptrdiff_t>(output / 4 + 30),
                                [](uint32_t w) { return w != 0; }))
            << "nothing at byte " << output;
    for (const bool by_passes : {false, true}) {
        CountingAllocator allocator{device()};
        EXPECT_EQ(run_in_c(device(), allocator, by_passes), expected);
        EXPECT_GT(allocator.staged, 0);
        EXPECT_EQ(allocator.live, 0);
    }
}

/// Calls `f` with null in place of each pointer that is not `optional` (a bit for each argument) but the last
/// one, and with wrong sizes of each struct. None of these succeeds, nor crashes.
template <class Before, class... Parameters, class... Args>
void sweep_after(const Before& before, limn_result (*f)(Parameters...) noexcept, uint32_t optional,
                 Args... args) {
    const std::tuple<Parameters...> good(args...);
    const auto refused = [&](const std::tuple<Parameters...>& bad, size_t argument) {
        before();
        EXPECT_EQ(std::apply(f, bad), LIMN_ERROR_INVALID_ARGUMENT) << "argument " << argument;
    };
    const auto sweep_one = [&]<size_t i>(std::integral_constant<size_t, i>) {
        using Parameter = std::tuple_element_t<i, std::tuple<Parameters...>>;
        if constexpr (std::is_pointer_v<Parameter> && i + 1 < sizeof...(Parameters)) {
            auto bad = good;
            std::get<i>(bad) = nullptr;
            if ((optional >> i & 1) == 0) refused(bad, i);
            if constexpr (requires { std::get<i>(good)->struct_size; }) {
                auto changed = *std::get<i>(good);
                std::get<i>(bad) = &changed;
                for (const uint32_t size : {0u, 4u, static_cast<uint32_t>(sizeof(changed)) - 1, 4097u, ~0u}) {
                    changed.struct_size = size;
                    refused(bad, i);
                }
            }
        }
    };
    [&]<size_t... i>(std::index_sequence<i...>) {
        (sweep_one(std::integral_constant<size_t, i>()), ...);
    }
    (std::index_sequence_for<Parameters...>());
}

template <class... Parameters, class... Args>
void sweep(limn_result (*f)(Parameters...) noexcept, uint32_t optional, Args... args) {
    sweep_after([] {}, f, optional, args...);
}

TEST_F(CInterfaceOnVulkan, RefusesNullAndWrongSizes) {
    const Inputs in = make_inputs(device());
    CountingAllocator allocator{device()};
    Objects objects;
    limn_error error = {};
    limn_vk_context* context = borrow_in_c(objects, device(), allocator);
    const CTables t = build_in_c(objects);
    Commands commands = *Commands::begin(device());
    limn_vk_upload* upload =
        LIMN_NEW(objects, limn_vk_upload, limn_vk_upload_create, context, commands.handle());
    const CDeviceTables d = upload_in_c(objects, upload, t);
    auto* evaluator = LIMN_NEW(objects, limn_vk_evaluator, limn_vk_evaluator_create, context);
    auto* tessellator = LIMN_NEW(objects, limn_vk_tessellator, limn_vk_tessellator_create, context);
    const auto out = [&error]<class Object>(Object*) {
        static Object* object;
        return std::pair(&object, &error);
    };
#define LIMN_SWEEP(f, optional, type, ...)                   \
    {                                                        \
        auto [object, e] = out(static_cast<type*>(nullptr)); \
        sweep(f, optional, __VA_ARGS__, object, e);          \
    }
    const auto trees = sized<limn_patch_trees_options>();
    const auto topology = sized<limn_tessellation_table_options>();
    const auto grid_options = sized<limn_grid_table_options>();
    const auto stencil_options = sized<limn_stencil_table_options>();
    const auto patch_options = sized<limn_patch_table_options>();
    const limn_patch_table* const patch_tables[] = {t.patches};
    const limn_tessellation_table* const topologies[] = {t.topology};
    LIMN_SWEEP(limn_patch_table_create, 0b110, limn_patch_table, t.mesh, &patch_options, nullptr);
    LIMN_SWEEP(limn_patch_table_create_channel, 0b1100, limn_patch_table, t.mesh, 0, &patch_options, nullptr);
    LIMN_SWEEP(limn_patch_table_create_merged, 0, limn_patch_table, patch_tables, 1);
    LIMN_SWEEP(limn_patch_trees_create, 0b10, limn_patch_trees, t.patches, &trees);
    LIMN_SWEEP(limn_tessellation_table_create, 0b10, limn_tessellation_table, t.mesh, &topology);
    LIMN_SWEEP(limn_tessellation_table_create_merged, 0, limn_tessellation_table, topologies, 1);
    LIMN_SWEEP(limn_grid_table_create, 0b10, limn_grid_table, t.patches, &grid_options);
    LIMN_SWEEP(limn_stencil_table_create, 0, limn_stencil_table, t.mesh, &stencil_options);
    auto topology_info = sized<limn_tessellation_table_info>();
    sweep(limn_tessellation_table_get_info, 0, t.topology, &topology_info, &error);

    const auto handles = sized<limn_vk_borrowed_handles>();
    auto context_info = sized<limn_vk_context_info>();
    auto options = sized<limn_vk_context_options>();
    options.device = 3;  // there is no such choice
    LIMN_SWEEP(limn_vk_context_borrow, 0, limn_vk_context, &handles);
    LIMN_SWEEP(limn_vk_context_create, 1, limn_vk_context, &options);
    sweep(limn_vk_context_get_info, 0, context, &context_info, &error);
    LIMN_SWEEP(limn_vk_upload_create, 0, limn_vk_upload, context, commands.handle());
    LIMN_SWEEP(limn_vk_patch_table_create, 0, limn_vk_patch_table, upload, t.patches);
    LIMN_SWEEP(limn_vk_patch_trees_create, 0, limn_vk_patch_trees, upload, t.sample_trees);
    LIMN_SWEEP(limn_vk_grid_table_create, 0, limn_vk_grid_table, upload, t.grid);
    LIMN_SWEEP(limn_vk_stencil_table_create, 0, limn_vk_stencil_table, upload, t.stencils);
    const limn_patch_trees* const channels[] = {t.channel_trees};
    LIMN_SWEEP(limn_vk_tessellation_table_create, 0, limn_vk_tessellation_table, upload, t.topology, t.trees,
               channels, 1);
    LIMN_SWEEP(limn_vk_evaluator_create, 0, limn_vk_evaluator, context);
    LIMN_SWEEP(limn_vk_tessellator_create, 0, limn_vk_tessellator, context);

    const auto points = sized<limn_vk_points_info>();  // whose buffers and tables are null: refused, too
    const auto stencils = sized<limn_vk_stencils_info>();
    const auto grid = sized<limn_vk_grid_info>();
    const auto local = sized<limn_vk_local_points_info>();
    const auto samples = sized<limn_vk_samples_info>();
    const auto empty = sized<limn_vk_tessellation_info>();
    limn_vk_evaluation* evaluation = nullptr;
    limn_vk_tessellation* none = nullptr;
    EXPECT_EQ(limn_vk_evaluator_prepare_points(evaluator, &points, &evaluation, nullptr),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_evaluator_prepare_stencils(evaluator, &stencils, &evaluation, &error),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_evaluator_prepare_grid(evaluator, &grid, &evaluation, &error),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_evaluator_prepare_local_points(evaluator, &local, &evaluation, &error),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_evaluator_prepare_samples(evaluator, &samples, &evaluation, &error),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_tessellator_prepare(tessellator, &empty, &none, &error), LIMN_ERROR_INVALID_ARGUMENT);
    LIMN_SWEEP(limn_vk_evaluator_prepare_points, 0, limn_vk_evaluation, evaluator, &points);
    LIMN_SWEEP(limn_vk_evaluator_prepare_stencils, 0, limn_vk_evaluation, evaluator, &stencils);
    LIMN_SWEEP(limn_vk_evaluator_prepare_grid, 0, limn_vk_evaluation, evaluator, &grid);
    LIMN_SWEEP(limn_vk_evaluator_prepare_local_points, 0, limn_vk_evaluation, evaluator, &local);
    LIMN_SWEEP(limn_vk_evaluator_prepare_samples, 0, limn_vk_evaluation, evaluator, &samples);
    LIMN_SWEEP(limn_vk_tessellator_prepare, 0, limn_vk_tessellation, tessellator, &empty);

    const limn_vk_tessellated_channel channel = {d.channel, 0, 0, points_of(in.values), {}};
    const limn_vk_tessellation_info info = describe_tessellation(d, channel, in);
    auto* tessellation =
        LIMN_NEW(objects, limn_vk_tessellation, limn_vk_tessellator_prepare, tessellator, &info);
    const limn_vk_rate_settings settings = settings_in_c();
    // What is wrong with settings has the device draw nothing, so that each of these records something.
    const StageAccess all = {VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                             VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
    const auto wait = [&] { record_barrier(device(), commands, all, all); };
    sweep_after(wait, limn_vk_tessellation_record, 0, tessellation, commands.handle(), &settings, &error);
    sweep_after(wait, limn_vk_tessellation_record_passes, 0, tessellation, commands.handle(),
                LIMN_VK_PASS_RATES, &settings, &error);
    EXPECT_EQ(limn_vk_tessellation_record_passes(tessellation, commands, 64, &settings, &error),
              LIMN_ERROR_INVALID_ARGUMENT);
    limn_vk_evaluation_record(nullptr, commands);
    limn_vk_record_barrier(nullptr, commands, {}, {});
    EXPECT_EQ(limn_vk_patch_trees_get_local_count(nullptr), 0u);
    EXPECT_EQ(limn_vk_tessellation_get_state_bytes(nullptr), 0u);
    EXPECT_TRUE(commands.submit_and_wait());
    const std::vector<uint32_t> output = read_output(device(), in);
    EXPECT_EQ(output[Layout().command / 4], 0u);
    EXPECT_EQ(output[Layout().result / 4], LIMN_TESSELLATION_BAD_SETTINGS);
}

TEST(CInterfaceBuilds, StopWhereControlSaysSo) {
    Objects objects;
    const limn_face_varying_channel channel = {kValues, 11, kValueCount, LIMN_FACE_VARYING_ALL};
    const limn_control_mesh_description description = describe_in_c(channel);
    auto* mesh = LIMN_NEW(objects, limn_control_mesh, limn_control_mesh_create, &description);
    limn_build_control* control = nullptr;
    ASSERT_EQ(limn_build_control_create(&control, nullptr), LIMN_SUCCESS);
    auto options = sized<limn_patch_table_options>();
    options.control = control;
    limn_patch_table* table = nullptr;
    limn_build_control_cancel(control);
    EXPECT_EQ(limn_patch_table_create(mesh, &options, nullptr, &table, nullptr), LIMN_ERROR_CANCELLED);
    EXPECT_EQ(table, nullptr);
    limn_build_control_reset(control);
    EXPECT_EQ(limn_patch_table_create(mesh, &options, nullptr, &table, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(limn_build_control_get_progress(control), 1.0f);
    limn_patch_table_destroy(table);
    limn_build_control_destroy(control);
    EXPECT_EQ(limn_build_control_create(nullptr, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace limn::vk::test
