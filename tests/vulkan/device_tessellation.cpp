#include "vulkan/device_tessellation.h"

#include <bit>
#include <cstring>

namespace limn::vk::test {
namespace {

constexpr float kUntouched = -7.5f;

/// A buffer full of kUntouched.
Buffer create_floats(const Device& device, size_t count) {
    Buffer buffer = *create_buffer(device, std::max<size_t>(4, 4 * count), kPointUsage, MemoryUse::device);
    const std::vector<float> filled(count, kUntouched);
    EXPECT_TRUE(upload_bytes(device, buffer, 0, std::as_bytes(std::span(filled))));
    return buffer;
}

/// Control points on the device, with room for the level-1 points.
Buffer upload_points(const Device& device, const PatchTable& patches, const std::vector<float>& control, uint32_t width) {
    Buffer points = *create_buffer(device, VkDeviceSize{4} * width * patches.point_count(), kPointUsage, MemoryUse::device);
    EXPECT_TRUE(upload_bytes(device, points, 0,
                             std::as_bytes(std::span(control).first(size_t{patches.control_count} * width))));
    return points;
}

std::vector<double> host_points(const PatchTable& patches, const std::vector<float>& control, uint32_t width) {
    std::vector<double> points(size_t{patches.point_count()} * width);
    build_patch_points<float>(patches, std::vector<double>(control.begin(), control.end()), width, points);
    return points;
}

}  // namespace

void TessellatorTest::SetUp() {
    VulkanTest::SetUp();
    if (HasFatalFailure()) return;
    static const SurfaceEvaluator* const surfaces = [this] {
        Result<SurfaceEvaluator> created = SurfaceEvaluator::create(device());
        return created ? new SurfaceEvaluator(std::move(*created)) : nullptr;  // outlive the tests, as the device does
    }();
    static const Tessellator* const tessellator = [this] {
        Result<Tessellator> created = Tessellator::create(device());
        return created ? new Tessellator(std::move(*created)) : nullptr;
    }();
    surfaces_ = surfaces;
    tessellator_ = tessellator;
    ASSERT_NE(surfaces_, nullptr);
    ASSERT_NE(tessellator_, nullptr);
}

TessellatorTest::GridBits TessellatorTest::evaluate_grid(const DeviceGridTable& grid, const DevicePatchTable& patches,
                                                         const Buffer& points) {
    const size_t count = 3 * grid.sample_count();
    const Buffer values = words(count), normals = words(count);
    const auto evaluation = surfaces_->prepare_grid({.patches = &patches,
                                                     .grid = &grid,
                                                     .points = {.buffer = points.handle},
                                                     .values = {.buffer = values.handle},
                                                     .normals = {.buffer = normals.handle}});
    EXPECT_TRUE(evaluation);
    if (!evaluation) return {};
    run([&](VkCommandBuffer commands) { evaluation->record(commands); });
    return {read(values, count), read(normals, count)};
}

void TessellatorTest::pretend_gpu(uint32_t max_range) {
    VulkanTest::pretend_gpu(max_range);
    gpu_surfaces_.emplace(*SurfaceEvaluator::create(device()));
    gpu_tessellator_.emplace(*Tessellator::create(device()));
    surfaces_ = &*gpu_surfaces_;
    tessellator_ = &*gpu_tessellator_;
}

TessellatedShape TessellatorTest::tessellate_on_device(const limn::test::TestMesh& shape,
                                                       const TessellationRequest& request) {
    TessellatedShape out;
    ControlMeshDescription description = shape.description();
    description.positions = {};  // which may hold what is no number
    out.mesh = *ControlMesh::create(description);
    out.patches = *build_patch_table<float>(out.mesh, {});
    out.points = host_points(out.patches, shape.positions, 3);
    out.size = shape.size();
    out.tolerance = tolerance_of(shape.positions, 3);
    std::vector<uint32_t> channels;
    for (uint32_t c = 0; request.outputs && c < shape.channels.size(); ++c) {
        auto patches = build_face_varying_patch_table<float>(out.mesh, c, {});
        if (!patches) continue;  // smooth ones with Chaikin creases have none
        channels.push_back(c);
        out.channel_points.push_back(host_points(*patches, shape.channels[c].values, 2));
        out.channel_patches.push_back(std::move(*patches));
    }
    out.table = *build_tessellation_table(out.mesh, {.channels = channels});
    const PatchTreeTable trees = *build_patch_trees(out.patches, {.max_rate = request.max_rate});
    std::vector<PatchTreeTable> channel_trees;
    std::vector<const PatchTreeTable*> channel_pointers;
    for (const PatchTable& patches : out.channel_patches)
        channel_trees.push_back(*build_patch_trees(patches, {.max_rate = request.max_rate}));
    for (const PatchTreeTable& table : channel_trees) channel_pointers.push_back(&table);

    const DevicePatchTable patches = *upload_patch_table(device(), out.patches);
    const DeviceTessellationTable table = *upload_tessellation_table(device(), out.table, trees, channel_pointers);
    const Buffer points = upload_points(device(), out.patches, shape.positions, 3);
    std::vector<float> moved = shape.positions;
    for (size_t i = 0; i < moved.size(); i += 3) moved[i] += 1;
    const Buffer previous_points = upload_points(device(), out.patches, moved, 3);
    std::vector<StencilEvaluation> refined;
    const auto refine = [&](const DevicePatchTable& of, const Buffer& buffer, uint32_t width) {
        auto prepared = surfaces_->prepare_points(
            {.patches = &of, .width = width, .points = {.buffer = buffer.handle, .stride = width}});
        EXPECT_TRUE(prepared);
        refined.push_back(std::move(*prepared));
    };
    refine(patches, points, 3);
    refine(patches, previous_points, 3);

    const size_t vertices = request.vertex_capacity, triangles = request.triangle_capacity, before = request.offset_words;
    const VkDeviceSize offset_bytes = 4ull * before;
    Buffer positions = create_floats(device(), before + vertices * request.stride), places = create_floats(device(), before + 4 * vertices),
           tangents = create_floats(device(), before + 4 * vertices), indices = create_floats(device(), before + 3 * triangles),
           faces = create_floats(device(), before + triangles), command = create_floats(device(), before + 5),
           result = create_floats(device(), before + 4), previous = create_floats(device(), before + 3 * vertices),
           edge_rates = create_floats(device(), before + request.edge_rates.size()),
           heights = create_floats(device(), before + 5 * vertices);
    if (!request.edge_rates.empty()) {
        EXPECT_TRUE(upload_bytes(device(), edge_rates, offset_bytes, std::as_bytes(std::span(request.edge_rates))));
    }
    std::vector<DevicePatchTable> channel_tables;
    std::vector<Buffer> channel_buffers, channel_values;
    std::vector<TessellatedChannel> channel_infos;
    channel_tables.reserve(channels.size());
    for (size_t c = 0; c < channels.size(); ++c) {
        channel_tables.push_back(*upload_patch_table(device(), out.channel_patches[c]));
        channel_buffers.push_back(upload_points(device(), out.channel_patches[c], shape.channels[channels[c]].values, 2));
        refine(channel_tables.back(), channel_buffers.back(), 2);
        channel_values.push_back(create_floats(device(), before + 2 * vertices));
        channel_infos.push_back({.channel = static_cast<uint32_t>(c),
                                 .patches = &channel_tables.back(),
                                 .points = {.buffer = channel_buffers.back().handle, .stride = 2},
                                 .values = {channel_values.back().handle, offset_bytes, 0, 2}});
    }
    TessellationInfo info{.patches = &patches,
                          .table = &table,
                          .points = {.buffer = points.handle},
                          .mode = request.settings.mode,
                          .spacing = request.settings.spacing,
                          .cull_outside = request.settings.cull_outside,
                          .cull_backfaces = request.settings.cull_backfaces,
                          .vertex_capacity = request.vertex_capacity,
                          .triangle_capacity = request.triangle_capacity,
                          .fit_capacity = request.fit_capacity,
                          .positions = {positions.handle, offset_bytes, 0, request.stride},
                          .channels = channel_infos,
                          .indices = {indices.handle, offset_bytes},
                          .clockwise = request.clockwise,
                          .command = {command.handle, offset_bytes},
                          .result = {result.handle, offset_bytes}};
    if (request.settings.mode == RateMode::per_edge) info.edge_rates = {edge_rates.handle, offset_bytes};
    if (request.outputs) {
        info.normals = {positions.handle, offset_bytes, 3, request.stride};
        info.places = {places.handle, offset_bytes, 0, 4};
        info.tangents = {tangents.handle, offset_bytes, 0, 4};
        if (!channels.empty()) info.tangent_channel = 0;
        info.triangle_faces = {faces.handle, offset_bytes};
    }
    if (request.rates_only) {
        info.vertex_capacity = info.triangle_capacity = 0;
        info.positions = {};
        info.channels = {};
        info.indices = info.command = {};
    }
    if (request.previous) {
        info.previous_points = {.buffer = previous_points.handle};
        info.previous_positions = {previous.handle, offset_bytes, 0, 3};
    }
    if (request.heights || (request.texture != nullptr && !request.own_heights)) info.heights = {heights.handle, offset_bytes, 0, 5};
    if (request.texture != nullptr) info.height_texture = *request.texture;
    auto tessellation = tessellator_->prepare(info);
    EXPECT_TRUE(tessellation) << (tessellation ? "" : tessellation.error().message);
    if (!tessellation) return out;
    const MemoryNeed need = tessellation_memory({.table = &out.table,
                                                 .vertices = &trees,
                                                 .channels = std::span(channel_pointers).first(info.channels.size()),
                                                 .own_height_count = request.own_heights ? request.vertex_capacity : 0,
                                                 .previous_points = request.previous,
                                                 .rates_only = request.rates_only});
    EXPECT_EQ(tessellation->state_bytes(), need.device_bytes);
    Result<Commands> commands = Commands::begin(device());
    for (const StencilEvaluation& evaluation : refined) evaluation.record(*commands);
    record_barrier(device(), *commands, kKernelWrites, kKernelReads);
    out.recorded = tessellation->record(*commands, request.settings);
    record_barrier(device(), *commands, kKernelWrites, kCopyReads);
    EXPECT_TRUE(commands->submit_and_wait());

    if (!request.later_positions.empty()) {
        EXPECT_TRUE(upload_bytes(device(), points, 0, std::as_bytes(std::span(request.later_positions))));
        Result<Commands> again = Commands::begin(device());
        refined[0].record(*again);
        record_barrier(device(), *again, kKernelWrites, kKernelReads);
        device().functions.CmdFillBuffer(*again, indices.handle, offset_bytes, VK_WHOLE_SIZE, 0);
        record_barrier(device(), *again, kCopyWrites, kKernelWrites);
        tessellation->record_points(*again);
        tessellation->record_triangles(*again);
        tessellation->record_vertices(*again);
        record_barrier(device(), *again, kKernelWrites, kCopyReads);
        EXPECT_TRUE(again->submit_and_wait());
        out.points = host_points(out.patches, request.later_positions, 3);
    }
    out.result = (*download<TessellationResult>(device(), result, 1, offset_bytes))[0];
    if (request.heights) {  // the hook, on the host
        const auto place_words = *download<uint32_t>(device(), places, size_t{4} * out.result.vertex_count, offset_bytes);
        std::vector<float> written(size_t{5} * out.result.vertex_count, 0.0f);
        for (size_t i = 0; i < out.result.vertex_count; ++i) {
            const auto h = request.heights(place_words[4 * i], std::bit_cast<float>(place_words[4 * i + 1]),
                                           std::bit_cast<float>(place_words[4 * i + 2]));
            std::copy(h.begin(), h.end(), written.begin() + static_cast<std::ptrdiff_t>(5 * i));
        }
        EXPECT_TRUE(upload_bytes(device(), heights, offset_bytes, std::as_bytes(std::span(written))));
        Result<Commands> displacing = Commands::begin(device());
        tessellation->record_displacement(*displacing);
        record_barrier(device(), *displacing, kKernelWrites, kCopyReads);
        EXPECT_TRUE(displacing->submit_and_wait());
    }
    const auto words = *download<uint32_t>(device(), command, 5, offset_bytes);
    std::copy(words.begin(), words.end(), out.command);
    const size_t count = std::min<size_t>(out.result.vertex_count, vertices);
    const size_t triangle_count = std::min<size_t>(out.result.triangle_count, triangles);
    out.indices = *download<uint32_t>(device(), indices, 3 * triangle_count, offset_bytes);
    const auto interleaved = *download<float>(device(), positions, before + vertices * request.stride);
    for (size_t i = 0; i < interleaved.size(); ++i) {
        const size_t at = i < before ? 0 : (i - before) % request.stride, v = i < before ? 0 : (i - before) / request.stride;
        if (i < before || v >= count || at >= (request.outputs ? 6u : 3u))
            out.untouched.push_back(interleaved[i]);
        else
            (at < 3 ? out.positions : out.normals).push_back(interleaved[i]);
    }
    if (request.outputs) {
        out.triangle_faces = *download<uint32_t>(device(), faces, triangle_count, offset_bytes);
        out.places = *download<uint32_t>(device(), places, 4 * count, offset_bytes);
        out.tangents = *download<float>(device(), tangents, 4 * count, offset_bytes);
    }
    if (request.heights || (request.texture != nullptr && !request.own_heights)) {
        const auto all = *download<float>(device(), heights, 5 * count, offset_bytes);
        for (size_t i = 0; i < all.size(); ++i)
            if (i % 5 < 3) out.heights.push_back(all[i]);
    }
    if (request.previous) out.previous = *download<float>(device(), previous, 3 * count, offset_bytes);
    for (const Buffer& values : channel_values) out.channels.push_back(*download<float>(device(), values, 2 * count, offset_bytes));
    out.rates.resize(table.rate_edge_count);
    Buffer copy = *create_buffer(device(), 4 * std::max<size_t>(1, out.rates.size()), kPointUsage, MemoryUse::readback);
    Result<Commands> copying = Commands::begin(device());
    const VkBufferCopy region = {4ull * shared::tess_rates(table.rate_edge_count), 0, 4 * out.rates.size()};
    device().functions.CmdCopyBuffer(*copying, tessellation->state_buffer(), copy.handle, 1, &region);
    record_barrier(device(), *copying, kCopyWrites, kHostReads);
    EXPECT_TRUE(copying->submit_and_wait());
    std::memcpy(out.rates.data(), copy.mapped(), 4 * out.rates.size());
    for (const float value : out.untouched) {
        EXPECT_EQ(value, kUntouched);
        if (value != kUntouched) break;
    }
    return out;
}

limn::Tessellation tessellate_on_host(const TessellatedShape& shape, TessellationSpacing spacing) {
    auto t = tessellate(shape.table, shape.rates, spacing);
    EXPECT_TRUE(t);
    return std::move(*t);
}

}  // namespace limn::vk::test
