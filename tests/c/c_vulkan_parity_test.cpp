// The C interface on Vulkan gives the C++ interface's bits, on a borrowed device with the caller's allocator;
// and it refuses what it has to.
#include <cstring>

#include "c/c_vulkan_scene.h"
#include "limn/c/limn_vulkan.h"

namespace limn::vk::test {
namespace {

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
