// Crowds on the device: merged tables, and what a device makes of them or of a mesh alone.
#pragma once

#include "limn/batch.h"

#include <cstring>

#include "shapes/random_mesh.h"
#include "vulkan/device_tessellation.h"

namespace limn::vk::test {
using limn::test::TestMesh;

/// Tables of a mesh, or of a crowd, and the points that they are evaluated with: of level 1, too.
struct Surfaces {
    PatchTable patches;
    TessellationTable topology;
    std::vector<float> control, points;
    PatchTable channel = {};  ///< of two components; without points where there is none
    std::vector<float> channel_control = {}, channel_points = {};
};

inline std::vector<float> points_of(const PatchTable& table, const std::vector<float>& control, uint32_t width = 3) {
    std::vector<double> points(size_t{width} * table.point_count());
    build_patch_points<float>(table, std::vector<double>(control.begin(), control.end()), width, points);
    return {points.begin(), points.end()};
}

/// With the first face-varying channel where that is asked for, and there is one.
inline Surfaces surfaces_of(const TestMesh& shape, bool channel = false) {
    static const PlanCache cache;
    const auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh) << shape.name;
    Surfaces out{*build_patch_table<float>(*mesh, {}, &cache),
                 *build_tessellation_table(*mesh, {}),
                 shape.positions,
                 {}};
    out.points = points_of(out.patches, out.control);
    if (!channel || shape.channels.empty()) return out;
    out.topology = *build_tessellation_table(*mesh, {.channels = std::vector<uint32_t>{0}});
    out.channel = *build_face_varying_patch_table<float>(*mesh, 0, {}, &cache);
    out.channel_control = shape.channels[0].values;
    out.channel_points = points_of(out.channel, out.channel_control, 2);
    return out;
}

struct Crowd {
    Surfaces merged;
    std::vector<PatchBatchMesh> meshes;
    std::vector<TessellationBatchMesh> topologies;
};
inline Crowd merge(const std::vector<Surfaces>& all) {
    std::vector<const PatchTable*> patches, channels;
    std::vector<const TessellationTable*> topologies;
    Crowd crowd;
    Surfaces& merged = crowd.merged;
    for (const Surfaces& s : all) {
        patches.push_back(&s.patches);
        if (s.channel.point_count() != 0) channels.push_back(&s.channel);
        topologies.push_back(&s.topology);
        merged.control.insert(merged.control.end(), s.control.begin(), s.control.end());
        merged.channel_control.insert(merged.channel_control.end(), s.channel_control.begin(), s.channel_control.end());
    }
    PatchBatch batch = *merge_patch_tables<float>(patches);
    TessellationBatch topology = *merge_tessellation_tables(topologies);
    merged.patches = std::move(batch.table);
    merged.topology = std::move(topology.table);
    merged.points = points_of(merged.patches, merged.control);
    merged.channel = std::move(merge_patch_tables<float>(channels)->table);
    merged.channel_points = points_of(merged.channel, merged.channel_control, 2);
    crowd.meshes = std::move(batch.meshes);
    crowd.topologies = std::move(topology.meshes);
    return crowd;
}

/// What a device makes of surfaces.
struct Drawn {
    std::vector<uint32_t> grid_values, grid_normals;  ///< the bits of 3 floats per sample
    std::vector<uint32_t> samples, statuses;  ///< the bits of 9 floats per sample: all those of the grid
    std::vector<uint32_t> indices, triangle_faces, positions, normals, commands;
    std::vector<uint32_t> channel;  ///< the bits of 2 floats per vertex, where there is one
    std::vector<float> targets;     ///< of all rate edges
    TessellationResult result = {};
    uint32_t samples_per_face = 0;
};

inline constexpr uint32_t kGridRate = 3;
inline constexpr float kTessellationRate = 5;

/// How triangles are made; by default all alike.
struct Request {
    RateSettings settings = {.value = kTessellationRate, .max_rate = 8, .cull_backfaces = true};
    std::vector<TessellationInstance> instances = {};
    std::vector<float> edge_rates = {};
    uint32_t triangle_capacity = 0;  ///< 0: what all edges need at kTessellationRate, and no fitting
};

class CrowdTest : public TessellatorTest {
  protected:
    Buffer filled(std::span<const std::byte> bytes) {
        Buffer buffer =
            *create_buffer(device(), std::max<size_t>(bytes.size(), 16), kPointUsage, MemoryUse::device);
        EXPECT_TRUE(upload_bytes(device(), buffer, 0, bytes));
        return buffer;
    }

    std::vector<float> read_targets(VkBuffer state, uint32_t count);
    void draw_grid(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points, Drawn& out);
    void draw_samples(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points, Drawn& out);
    void draw_triangles(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points, Drawn& out,
                        const Request& request = {});
    Drawn draw_triangles(const Surfaces& s, const Request& request) {
        Drawn out;
        const DevicePatchTable patches = *upload_patch_table(device(), s.patches);
        draw_triangles(s, patches, filled(std::as_bytes(std::span(s.points))), out, request);
        return out;
    }
    Drawn draw(const Surfaces& s) {
        Drawn out;
        const DevicePatchTable patches = *upload_patch_table(device(), s.patches);
        const Buffer points = filled(std::as_bytes(std::span(s.points)));
        draw_grid(s, patches, points, out);
        draw_samples(s, patches, points, out);
        draw_triangles(s, patches, points, out);
        return out;
    }
};

inline void CrowdTest::draw_grid(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points,
                              Drawn& out) {
    const DeviceGridTable grid = *upload_grid_table(
        device(), *build_grid_table(s.patches, {.rate = kGridRate, .samples_per_pass = 20'000}));
    GridBits bits = evaluate_grid(grid, patches, points);
    out.samples_per_face = grid.samples_per_face;
    out.grid_values = std::move(bits.values);
    out.grid_normals = std::move(bits.normals);
}

inline void CrowdTest::draw_samples(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points,
                                 Drawn& out) {
    struct Place {
        uint32_t face;
        float u, v;
    };
    std::vector<Place> places;
    for (const PatchSample& p : list_grid_samples(s.patches.options.scheme, patches.ptex_count, kGridRate))
        places.push_back({p.face, static_cast<float>(p.u), static_cast<float>(p.v)});
    const Buffer list = filled(std::as_bytes(std::span(places)));
    const auto count = static_cast<uint32_t>(places.size());
    Buffer results = words(size_t{9} * count), statuses = words(count);
    const auto evaluation =
        surfaces_->prepare_samples({.patches = &patches,
                                    .points = {.buffer = points.handle},
                                    .samples = {list.handle, 0, count},
                                    .results = {.buffer = results.handle, .stride = 9},
                                    .statuses = {.buffer = statuses.handle, .stride = 1}});
    ASSERT_TRUE(evaluation);
    run([&](VkCommandBuffer commands) { evaluation->record(commands); });
    out.samples = read(results, size_t{9} * count);
    out.statuses = read(statuses, count);
}

inline void CrowdTest::draw_triangles(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points,
                                   Drawn& out, const Request& request) {
    const RateSettings& settings = request.settings;
    const std::vector<uint32_t> rates(s.topology.rate_edge_count, settings.max_rate * shared::kRateOne);
    const TessellationCounts most = count_tessellation(s.topology, rates, TessellationSpacing::integer);
    const PatchTreeTable trees = *build_patch_trees(s.patches, {.max_rate = 8}),
                         channel_trees = *build_patch_trees(s.channel, {.max_rate = 8});
    const bool has_channel = s.channel.point_count() != 0;
    const PatchTreeTable* const channels[] = {&channel_trees};
    const DeviceTessellationTable table =
        *upload_tessellation_table(device(), s.topology, trees, std::span(channels).first(has_channel ? 1 : 0));
    const DevicePatchTable channel_patches = *upload_patch_table(device(), s.channel);
    const Buffer channel_points = filled(std::as_bytes(std::span(s.channel_points)));
    Buffer channel_values = words(2 * most.vertices);
    const TessellatedChannel channel_infos[] = {{.patches = &channel_patches,
                                                 .points = {.buffer = channel_points.handle, .stride = 2},
                                                 .values = {.buffer = channel_values.handle, .stride = 2}}};
    Buffer positions = words(3 * most.vertices), normals = words(3 * most.vertices),
           indices = words(3 * most.triangles), faces = words(most.triangles), command = words(5),
           result = words(4), commands_of_instances = words(5 * size_t{s.topology.instance_count()});
    const Buffer instances = filled(std::as_bytes(std::span(request.instances)));
    const Buffer edge_rates = filled(std::as_bytes(std::span(request.edge_rates)));
    const bool fits = request.triangle_capacity != 0;
    const auto tessellation =
        tessellator_->prepare({.patches = &patches,
                               .table = &table,
                               .points = {.buffer = points.handle},
                               .mode = settings.mode,
                               .cull_outside = settings.cull_outside,
                               .cull_backfaces = settings.cull_backfaces,
                               .edge_rates = {edge_rates.handle},
                               .instances = {request.instances.empty() ? VK_NULL_HANDLE : instances.handle},
                               .vertex_capacity = static_cast<uint32_t>(most.vertices),
                               .triangle_capacity = fits ? request.triangle_capacity : static_cast<uint32_t>(most.triangles),
                               .fit_capacity = fits,
                               .positions = {.buffer = positions.handle},
                               .normals = {.buffer = normals.handle},
                               .channels = std::span(channel_infos).first(has_channel ? 1 : 0),
                               .indices = {indices.handle},
                               .triangle_faces = {faces.handle},
                               .command = {command.handle},
                               .instance_commands = {commands_of_instances.handle},
                               .result = {result.handle}});
    ASSERT_TRUE(tessellation);
    run([&](VkCommandBuffer commands) {
        EXPECT_TRUE(tessellation->record(commands, settings));
    });
    out.result = (*download<TessellationResult>(device(), result, 1))[0];
    out.commands = read(commands_of_instances, 5 * size_t{s.topology.instance_count()});
    out.indices = read(indices, 3 * size_t{out.result.triangle_count});
    out.triangle_faces = read(faces, out.result.triangle_count);
    out.positions = read(positions, 3 * size_t{out.result.vertex_count});
    out.normals = read(normals, 3 * size_t{out.result.vertex_count});
    if (has_channel) out.channel = read(channel_values, 2 * size_t{out.result.vertex_count});
    out.targets = read_targets(tessellation->state_buffer(), s.topology.rate_edge_count);
}

/// As limn/shared/tess_params.h lays them out.
inline std::vector<float> CrowdTest::read_targets(VkBuffer state, uint32_t count) {
    Buffer copy = words(count);
    run([&](VkCommandBuffer commands) {
        record_barrier(device(), commands, kKernelWrites, kCopyReads);
        const VkBufferCopy region = {4 * VkDeviceSize{shared::kTessTargets}, 0, 4 * VkDeviceSize{std::max(count, 1u)}};
        device().functions.CmdCopyBuffer(commands, state, copy.handle, 1, &region);
        record_barrier(device(), commands, kCopyWrites, kCopyReads);
    });
    return *download<float>(device(), copy, count);
}

/// Words [first, first + alone.size()) of those of the crowd are the mesh's own.
inline void expect_same_words(const std::vector<uint32_t>& merged, uint64_t first,
                       const std::vector<uint32_t>& alone) {
    ASSERT_LE(first + alone.size(), merged.size());
    EXPECT_EQ(std::memcmp(merged.data() + first, alone.data(), 4 * alone.size()), 0);
}

/// Triangles of the mesh, from number `first` of the crowd's: the same faces, vertices of the same bits.
inline void expect_same_triangles(const Drawn& merged, size_t first, const Drawn& alone, uint32_t first_face) {
    ASSERT_LE(first + alone.triangle_faces.size(), merged.triangle_faces.size());
    std::vector<uint32_t> vertices(alone.result.vertex_count, ~0u);
    for (size_t t = 0; t < alone.triangle_faces.size(); ++t) {
        ASSERT_EQ(merged.triangle_faces[first + t], alone.triangle_faces[t] + first_face);
        for (size_t k = 3 * t; k < 3 * t + 3; ++k) {
            const uint32_t own = alone.indices[k], vertex = merged.indices[3 * first + k];
            ASSERT_TRUE(vertices[own] == ~0u || vertices[own] == vertex);
            vertices[own] = vertex;
        }
    }
    for (size_t v = 0; v < vertices.size(); ++v) {
        if (vertices[v] == ~0u) continue;
        const size_t vertex = vertices[v];
        ASSERT_EQ(std::memcmp(&merged.positions[3 * vertex], &alone.positions[3 * v], 12), 0)
            << "vertex " << v;
        ASSERT_EQ(std::memcmp(&merged.normals[3 * vertex], &alone.normals[3 * v], 12), 0) << "vertex " << v;
        if (alone.channel.empty()) continue;
        ASSERT_EQ(std::memcmp(&merged.channel[2 * vertex], &alone.channel[2 * v], 8), 0) << "vertex " << v;
    }
}

}  // namespace limn::vk::test
