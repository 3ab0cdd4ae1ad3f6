// The C interface on Vulkan gives the C++ interface's bits: rates of the caller's for each edge, displacement by heights
// of his, hardware tessellation; and it names the devices that there are.
#include "c/c_vulkan_objects.h"
#include "limn/c/interop.h"
#include "limn/vulkan/hardware_tessellation.h"

namespace limn::vk::test {
namespace {

struct Displacement {
    Buffer edge_rates, heights;
};
Displacement make_displacement(const Device& device, uint32_t rate_edge_count) {
    std::vector<float> rates(rate_edge_count);
    for (size_t e = 0; e < rates.size(); ++e) rates[e] = static_cast<float>(1 + e * 7 % 6);
    const std::vector<float> heights = some_floats(3 * kVertexCapacity, 0.002f);
    return {*create_point_buffer(device, rates), *create_point_buffer(device, heights)};
}

class CInterfaceTessellation : public VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        if (HasFatalFailure()) return;
        tables_ = build_in_c(objects_);
        more_ = make_displacement(device(), tables_.topology->value.rate_edge_count);
    }
    std::vector<uint32_t> displace_in_cpp(bool level);
    std::vector<uint32_t> displace_in_c(bool by_passes);

    Objects objects_;
    CTables tables_ = {};
    Displacement more_;
};

/// `level`: with heights of 0.
std::vector<uint32_t> CInterfaceTessellation::displace_in_cpp(bool level) {
    const Inputs in = make_inputs(device());
    const Layout at;
    const std::vector<float> zeros(3 * kVertexCapacity);
    const Buffer flat = *create_point_buffer(device(), zeros);
    const DevicePatchTable patches = *upload_patch_table(device(), tables_.patches->value);
    const DeviceTessellationTable table = *upload_tessellation_table(
        device(), tables_.topology->value, tables_.trees->value, std::array{&std::as_const(tables_.channel_trees->value)});
    const SurfaceEvaluator surfaces = *SurfaceEvaluator::create(device());
    const Tessellator tessellator = *Tessellator::create(device());
    const StencilEvaluation refined =
        *surfaces.prepare_points({.patches = &patches, .points = {.buffer = in.points.handle}});
    const vk::Tessellation tessellation =
        *tessellator.prepare({.patches = &patches,
                              .table = &table,
                              .points = {.buffer = in.points.handle},
                              .mode = RateMode::per_edge,
                              .edge_rates = {more_.edge_rates.handle},
                              .vertex_capacity = kVertexCapacity,
                              .triangle_capacity = kTriangleCapacity,
                              .positions = {.buffer = in.output.handle, .offset_bytes = at.positions},
                              .normals = {.buffer = in.output.handle, .offset_bytes = at.normals},
                              .heights = {.buffer = level ? flat.handle : more_.heights.handle},
                              .indices = {in.output.handle, at.indices},
                              .command = {in.output.handle, at.command},
                              .result = {in.output.handle, at.result}});
    Commands commands = *Commands::begin(device());
    refined.record(commands);
    record_barrier(device(), commands, kKernelWrites, kKernelReads);
    EXPECT_TRUE(tessellation.record(commands, {.mode = RateMode::per_edge, .max_rate = 16}));
    record_barrier(device(), commands, kKernelWrites, {kKernelReads.stages, kKernelReads.access | kKernelWrites.access});
    tessellation.record_displacement(commands);
    EXPECT_TRUE(commands.submit_and_wait());
    return read_output(device(), in);
}

std::vector<uint32_t> CInterfaceTessellation::displace_in_c(bool by_passes) {
    const Inputs in = make_inputs(device());
    const Layout at;
    CountingAllocator allocator{device()};
    Objects objects;
    limn_error error = {};
    limn_vk_context* context = borrow_in_c(objects, device(), allocator);
    Commands commands = *Commands::begin(device());
    auto* upload = LIMN_NEW(objects, limn_vk_upload, limn_vk_upload_create, context, commands.handle());
    const CDeviceTables on_device = upload_in_c(objects, upload, tables_);
    auto* evaluator = LIMN_NEW(objects, limn_vk_evaluator, limn_vk_evaluator_create, context);
    auto* tessellator = LIMN_NEW(objects, limn_vk_tessellator, limn_vk_tessellator_create, context);
    auto points = sized<limn_vk_points_info>();
    points.patches = on_device.patches, points.points = points_of(in.points);
    auto* refined = LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_points, evaluator, &points);
    auto info = sized<limn_vk_tessellation_info>();
    info.patches = on_device.patches, info.table = on_device.topology, info.points = points_of(in.points);
    info.mode = LIMN_RATE_PER_EDGE, info.edge_rates = {more_.edge_rates.handle, 0};
    info.vertex_capacity = kVertexCapacity, info.triangle_capacity = kTriangleCapacity;
    info.positions = points_of(in.output, at.positions), info.normals = points_of(in.output, at.normals);
    info.heights = points_of(more_.heights);
    info.indices = {in.output.handle, at.indices}, info.command = {in.output.handle, at.command};
    info.result = {in.output.handle, at.result};
    auto* tessellation = LIMN_NEW(objects, limn_vk_tessellation, limn_vk_tessellator_prepare, tessellator, &info);
    const limn_vk_stage_access writes = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_WRITES};
    const limn_vk_stage_access reads = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_READS};
    auto settings = sized<limn_vk_rate_settings>();
    settings.max_rate = 16, settings.width = settings.height = 1;
    limn_vk_evaluation_record(refined, commands);
    limn_vk_record_barrier(context, commands, writes, reads);
    for (uint32_t pass = 1; by_passes && pass <= LIMN_VK_PASS_DISPLACEMENT; pass *= 2)
        EXPECT_EQ(limn_vk_tessellation_record_passes(tessellation, commands, pass, &settings, &error), LIMN_SUCCESS)
            << error.message;
    if (!by_passes) {
        EXPECT_EQ(limn_vk_tessellation_record(tessellation, commands, &settings, &error), LIMN_SUCCESS) << error.message;
        EXPECT_EQ(limn_vk_tessellation_record_passes(tessellation, commands, LIMN_VK_PASS_DISPLACEMENT, nullptr, &error),
                  LIMN_SUCCESS) << error.message;
    }
    EXPECT_TRUE(commands.submit_and_wait());
    return read_output(device(), in);
}

TEST_F(CInterfaceTessellation, TakesRatesOfEdgesAndHeights) {
    const std::vector<uint32_t> expected = displace_in_cpp(false);
    EXPECT_EQ(expected[Layout().result / 4], LIMN_TESSELLATION_COMPLETE);
    EXPECT_GT(expected[Layout().result / 4 + 2], 20u);
    EXPECT_NE(expected, displace_in_cpp(true));  // heights make a difference
    for (const bool by_passes : {false, true}) EXPECT_EQ(displace_in_c(by_passes), expected) << by_passes;
}

/// What a draw records, noted in place of being recorded: no pipeline, nor the feature, is needed for that.
struct Noted {
    std::vector<uint32_t> pushed;
    std::vector<std::array<uint32_t, 4>> draws;
    uint32_t bound = 0;
    bool operator==(const Noted&) const = default;
};
Noted noted;
PFN_vkGetDeviceProcAddr next_get = nullptr;

VKAPI_ATTR void VKAPI_CALL note_sets(VkCommandBuffer, VkPipelineBindPoint point, VkPipelineLayout, uint32_t first,
                                     uint32_t count, const VkDescriptorSet*, uint32_t, const uint32_t*) {
    noted.bound += point == VK_PIPELINE_BIND_POINT_GRAPHICS && first == 0 && count == 1 ? 1 : 100;
}
VKAPI_ATTR void VKAPI_CALL note_constants(VkCommandBuffer, VkPipelineLayout, VkShaderStageFlags, uint32_t offset,
                                          uint32_t size, const void* values) {
    noted.pushed.resize((offset + size) / 4);
    std::memcpy(noted.pushed.data() + offset / 4, values, size);
}
VKAPI_ATTR void VKAPI_CALL note_draw(VkCommandBuffer, uint32_t vertices, uint32_t instances, uint32_t first,
                                     uint32_t first_instance) {
    noted.draws.push_back({vertices, instances, first, first_instance});
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_noting(VkDevice device, const char* name) {
    const std::string_view wanted = name;
    if (wanted == "vkCmdBindDescriptorSets") return reinterpret_cast<PFN_vkVoidFunction>(note_sets);
    if (wanted == "vkCmdPushConstants") return reinterpret_cast<PFN_vkVoidFunction>(note_constants);
    if (wanted == "vkCmdDraw") return reinterpret_cast<PFN_vkVoidFunction>(note_draw);
    return next_get(device, name);
}

/// Rates for the stages, without outputs.
limn_vk_tessellation_info rates_alone(const CDeviceTables& t, const Inputs& in) {
    auto info = sized<limn_vk_tessellation_info>();
    info.patches = t.patches, info.table = t.topology, info.points = points_of(in.points);
    info.result = {in.output.handle, Layout().result};
    return info;
}

TEST_F(CInterfaceTessellation, GivesStagesAndDraws) {
    next_get = device().functions.GetDeviceProcAddr;
    const Inputs in = make_inputs(device());
    CountingAllocator allocator{device()};
    Objects objects;
    limn_error error = {};
    limn_vk_context* plain = borrow_in_c(objects, device(), allocator);
    limn_vk_hardware_tessellator* none = nullptr;
    EXPECT_EQ(limn_vk_hardware_tessellator_create(plain, 0, &none, &error), LIMN_ERROR_UNSUPPORTED);
    EXPECT_EQ(none, nullptr);
    Commands commands = *Commands::begin(device());
    auto* upload = LIMN_NEW(objects, limn_vk_upload, limn_vk_upload_create, plain, commands.handle());
    const CDeviceTables on_device = upload_in_c(objects, upload, tables_);
    auto* tessellator = LIMN_NEW(objects, limn_vk_tessellator, limn_vk_tessellator_create, plain);
    const limn_vk_tessellation_info info = rates_alone(on_device, in);
    auto* tessellation = LIMN_NEW(objects, limn_vk_tessellation, limn_vk_tessellator_prepare, tessellator, &info);
    limn_vk_context* context = borrow_in_c(objects, device(), allocator, get_noting);
    auto* hardware = LIMN_NEW(objects, limn_vk_hardware_tessellator, limn_vk_hardware_tessellator_create, context,
                              LIMN_VK_TESSELLATION_SHADER_ENABLED);
    auto* drawn = LIMN_NEW(objects, limn_vk_hardware_tessellation, limn_vk_hardware_tessellator_prepare, hardware,
                           tessellation);

    Device noting = device();
    noting.functions.CmdBindDescriptorSets = note_sets;
    noting.functions.CmdPushConstants = note_constants;
    noting.functions.CmdDraw = note_draw;
    const HardwareTessellator in_cpp = *HardwareTessellator::create({&noting, true});
    for (const limn_scheme scheme : {LIMN_SCHEME_CATMULL_CLARK, LIMN_SCHEME_LOOP, LIMN_SCHEME_BILINEAR}) {
        auto stages = sized<limn_vk_hardware_stages>();
        ASSERT_EQ(limn_vk_hardware_tessellator_get_stages(hardware, scheme, &stages, &error), LIMN_SUCCESS);
        EXPECT_NE(stages.set_layout, VkDescriptorSetLayout{});
        EXPECT_EQ(std::memcmp(&stages.push_constants, &kHardwarePushConstants, sizeof kHardwarePushConstants), 0);
        const HardwareStages expected = in_cpp.stages(static_cast<Scheme>(scheme));
        EXPECT_TRUE(std::ranges::equal(std::span(stages.vertex.words, stages.vertex.word_count), expected.vertex));
        EXPECT_TRUE(std::ranges::equal(std::span(stages.control.words, stages.control.word_count), expected.control));
        EXPECT_TRUE(
            std::ranges::equal(std::span(stages.evaluation.words, stages.evaluation.word_count), expected.evaluation));
    }

    const DevicePatchTable patches = *upload_patch_table(device(), tables_.patches->value);
    const DeviceTessellationTable table = *upload_tessellation_table(
        device(), tables_.topology->value, tables_.trees->value, std::array{&std::as_const(tables_.channel_trees->value)});
    const Tessellator tessellator_in_cpp = *Tessellator::create(device());
    const vk::Tessellation rates = *tessellator_in_cpp.prepare({.patches = &patches,
                                                                .table = &table,
                                                                .points = {.buffer = in.points.handle},
                                                                .result = {in.output.handle, Layout().result}});
    const HardwareTessellation drawn_in_cpp = *in_cpp.prepare(rates);
    const float clip[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    const auto layout = reinterpret_cast<VkPipelineLayout>(uint64_t{8});  // of no pipeline
    noted = {};
    drawn_in_cpp.record_draw(commands, layout, clip);
    const Noted expected = std::exchange(noted, {});
    EXPECT_EQ(expected.bound, 1u);
    ASSERT_EQ(expected.draws.size(), 1u);
    EXPECT_EQ(expected.draws[0][0], tables_.topology->value.face_count);
    limn_vk_hardware_tessellation_record_draw(drawn, commands, layout, clip);
    EXPECT_EQ(noted, expected);
    const float other[16] = {};
    noted = {};
    limn_vk_hardware_tessellation_record_draw(drawn, commands, layout, other);
    EXPECT_NE(noted, expected);
    EXPECT_TRUE(commands.submit_and_wait());
}

TEST_F(CInterfaceTessellation, NamesDevices) {
    const auto expected = *list_devices();
    uint32_t count = 0;
    ASSERT_EQ(limn_vk_list_devices(nullptr, 0, &count, nullptr), LIMN_SUCCESS);
    ASSERT_EQ(count, expected.size());
    std::vector<limn_vk_device_description> devices(count + 1);
    ASSERT_EQ(limn_vk_list_devices(devices.data(), count + 1, &count, nullptr), LIMN_SUCCESS);
    for (size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(devices[i].name, expected[i].name);
        EXPECT_EQ(devices[i].type, expected[i].type);
        EXPECT_EQ(devices[i].api_version, expected[i].api_version);
        EXPECT_EQ(devices[i].driver_version, expected[i].driver_version);
        EXPECT_EQ(devices[i].usable, expected[i].usable ? 1u : 0u);
    }
    EXPECT_EQ(devices.back().name[0], 0);
}

}  // namespace
}  // namespace limn::vk::test
