// The C interface on Vulkan gives the C++ interface's bits, on a borrowed device with the caller's allocator;
// and it refuses what it has to.
#include "c/c_vulkan_objects.h"

namespace limn::vk::test {
namespace {
using limn::test::sweep, limn::test::sweep_after;

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
    grid.values = points_of(in.output, at.packed_grid), grid.normals = points_of(in.output, at.packed_normals);
    grid.packed_normals = 1;
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
    auto locations = sized<limn_vk_locations_info>();
    locations.patches = t.patches, locations.samples = in.samples.handle, locations.sample_count = kSampleCount;
    locations.places = points_of(in.output, at.locations);
    locations.statuses = points_of(in.output, at.location_statuses);
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_locations, evaluator, &locations));
    auto refined = sized<limn_vk_refined_info>();
    refined.grid = t.refined, refined.source = points_of(in.points), refined.refined = points_of(in.output, at.refined);
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_refined, evaluator, &refined));
    refined.grid = t.refined_channel, refined.width = 2;
    refined.source = points_of(in.values), refined.refined = points_of(in.output, at.refined_channel);
    out.all.push_back(
        LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_refined, evaluator, &refined));
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
          Layout().samples, Layout().tree_samples, Layout().stencils, Layout().tangent2, Layout().locations,
          Layout().refined, Layout().refined_channel})
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
    const auto refined_options = sized<limn_refined_grid_table_options>();
    LIMN_SWEEP(limn_refined_grid_table_create, 0b10, limn_refined_grid_table, t.mesh, &refined_options);
    LIMN_SWEEP(limn_refined_grid_table_create_channel, 0b100, limn_refined_grid_table, t.mesh, 0, &refined_options);
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
    LIMN_SWEEP(limn_vk_refined_grid_create, 0, limn_vk_refined_grid, upload, t.refined);
    const limn_patch_trees* const channels[] = {t.channel_trees};
    LIMN_SWEEP(limn_vk_tessellation_table_create, 0, limn_vk_tessellation_table, upload, t.topology, t.trees,
               channels, 1);
    LIMN_SWEEP(limn_vk_evaluator_create, 0, limn_vk_evaluator, context);
    LIMN_SWEEP(limn_vk_tessellator_create, 0, limn_vk_tessellator, context);
    LIMN_SWEEP(limn_vk_hardware_tessellator_create, 0, limn_vk_hardware_tessellator, context,
               LIMN_VK_TESSELLATION_SHADER_ENABLED);
    auto* hardware = LIMN_NEW(objects, limn_vk_hardware_tessellator, limn_vk_hardware_tessellator_create, context,
                              LIMN_VK_TESSELLATION_SHADER_ENABLED);
    auto stages = sized<limn_vk_hardware_stages>();
    sweep(limn_vk_hardware_tessellator_get_stages, 0, hardware, LIMN_SCHEME_LOOP, &stages, &error);
    EXPECT_EQ(limn_vk_hardware_tessellator_get_stages(hardware, 4, &stages, &error), LIMN_ERROR_INVALID_ARGUMENT);
    limn_vk_device_description device_description;
    uint32_t device_count = 0;
    sweep(limn_vk_list_devices, 0, &device_description, 1, &device_count, &error);

    const auto points = sized<limn_vk_points_info>();  // whose buffers and tables are null: refused, too
    const auto stencils = sized<limn_vk_stencils_info>();
    const auto grid = sized<limn_vk_grid_info>();
    const auto local = sized<limn_vk_local_points_info>();
    const auto samples = sized<limn_vk_samples_info>();
    const auto locations = sized<limn_vk_locations_info>();
    const auto refined = sized<limn_vk_refined_info>();
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
    EXPECT_EQ(limn_vk_evaluator_prepare_locations(evaluator, &locations, &evaluation, &error),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_evaluator_prepare_refined(evaluator, &refined, &evaluation, &error),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_tessellator_prepare(tessellator, &empty, &none, &error), LIMN_ERROR_INVALID_ARGUMENT);
    LIMN_SWEEP(limn_vk_evaluator_prepare_points, 0, limn_vk_evaluation, evaluator, &points);
    LIMN_SWEEP(limn_vk_evaluator_prepare_stencils, 0, limn_vk_evaluation, evaluator, &stencils);
    LIMN_SWEEP(limn_vk_evaluator_prepare_grid, 0, limn_vk_evaluation, evaluator, &grid);
    LIMN_SWEEP(limn_vk_evaluator_prepare_local_points, 0, limn_vk_evaluation, evaluator, &local);
    LIMN_SWEEP(limn_vk_evaluator_prepare_samples, 0, limn_vk_evaluation, evaluator, &samples);
    LIMN_SWEEP(limn_vk_evaluator_prepare_locations, 0, limn_vk_evaluation, evaluator, &locations);
    LIMN_SWEEP(limn_vk_evaluator_prepare_refined, 0, limn_vk_evaluation, evaluator, &refined);
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
    LIMN_SWEEP(limn_vk_hardware_tessellator_prepare, 0, limn_vk_hardware_tessellation, hardware, tessellation);
    limn_vk_hardware_tessellation_record_draw(nullptr, commands, VK_NULL_HANDLE, nullptr);
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
