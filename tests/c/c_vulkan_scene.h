// A surface, and all that is made of it on the device with the C++ interface: what C has to give to the bit.
#pragma once

#include <cstring>

#include "limn/batch.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk::test {

// Two quads and a triangle; a crease, a boundary and a channel with a seam.
inline constexpr uint32_t kSizes[] = {4, 4, 3}, kFaces[] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 6};
inline constexpr uint32_t kCrease[] = {1, 4}, kValues[] = {0, 1, 4, 3, 7, 2, 5, 8, 3, 4, 6}, kChannels[] = {0};
inline constexpr float kSharpness[] = {10};
inline constexpr uint32_t kVertexCount = 7, kValueCount = 9, kVertexCapacity = 2048, kTriangleCapacity = 4096;
inline constexpr uint32_t kGridRate = 4, kSampleCount = 40, kLevel = 2;

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
                 tangent2 = add(3 * 1024), locations = add(5 * kSampleCount),
                 location_statuses = add(kSampleCount), refined = add(3 * 1024), refined_channel = add(2 * 1024),
                 packed_grid = add(3 * 1024), packed_normals = add(1024);
};

/// The caller's: made with the C++ interface for both.
struct Inputs {
    Buffer points, previous_points, values, instances, samples, local_points, output;
    static constexpr VkDeviceSize kPointBytes = 1 << 16;
};
inline std::vector<float> some_floats(size_t count, float scale) {
    std::vector<float> out(count);
    for (size_t i = 0; i < count; ++i) out[i] = scale * static_cast<float>(i * i % 23);
    return out;
}
inline Buffer filled_buffer(const Device& device, std::span<const std::byte> bytes, VkDeviceSize size) {
    Buffer buffer = *create_buffer(device, size, kPointUsage, MemoryUse::device);
    const std::vector<std::byte> zeros(size);
    EXPECT_TRUE(upload_bytes(device, buffer, 0, zeros));
    EXPECT_TRUE(upload_bytes(device, buffer, 0, bytes));
    return buffer;
}
inline Inputs make_inputs(const Device& device) {
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
inline std::vector<uint32_t> read_output(const Device& device, const Inputs& inputs) {
    return *download<uint32_t>(device, inputs.output, Layout().end / 4);
}

/// With the C++ interface.
inline std::vector<uint32_t> run_in_cpp(const Device& device) {
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
    const RefinementOptions level0{.level = 0, .full_last_level = true};
    const DeviceStencilTable stencils = *upload_stencil_table(
        device, *build_limit_table<float>(*build_refinement(mesh, level0), kLevel, true));
    const DeviceRefinedGrid refined_grid = *upload_refined_grid_table(
        device, *build_refined_grid_table(*build_refinement(mesh, level0), {.level = kLevel}));
    const DeviceRefinedGrid refined_channel = *upload_refined_grid_table(
        device, *build_refined_grid_table(*build_face_varying_refinement(mesh, 0, level0), {.level = kLevel}));
    EXPECT_LE(refined_grid.point_count(), 1024u);
    EXPECT_LE(refined_channel.point_count(), 1024u);
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
    const SurfaceEvaluation on_packed_grid = *surfaces.prepare_grid({.patches = &device_patches,
                                                                     .grid = &grid,
                                                                     .points = {.buffer = in.points.handle},
                                                                     .values = output(at.packed_grid),
                                                                     .normals = output(at.packed_normals, 1),
                                                                     .packed_normals = true});
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
    const SurfaceEvaluation locations = *surfaces.prepare_locations({.patches = &device_patches,
                                                                     .samples = {in.samples.handle, 0, kSampleCount},
                                                                     .places = output(at.locations, 5),
                                                                     .statuses = output(at.location_statuses, 1)});
    const SurfaceEvaluation refined_points = *surfaces.prepare_refined(
        {.table = &refined_grid, .source = {.buffer = in.points.handle}, .refined = output(at.refined)});
    const SurfaceEvaluation refined_values =
        *surfaces.prepare_refined({.table = &refined_channel,
                                   .width = 2,
                                   .source = {.buffer = in.values.handle, .stride = 2},
                                   .refined = output(at.refined_channel, 2)});
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
    on_packed_grid.record(commands);
    local.record(commands);
    record_barrier(device, commands, kKernelWrites, kKernelReads);
    at_samples.record(commands);
    at_tree_samples.record(commands);
    limits.record(commands);
    locations.record(commands);
    refined_points.record(commands);
    refined_values.record(commands);
    EXPECT_TRUE(commands.submit_and_wait());
    return read_output(device, in);
}

}  // namespace limn::vk::test
