// Crowds on the device: merged tables against those that they were made of, to the bit where both are given
// the same points; and no more dispatches for more meshes.
#include "limn/batch.h"

#include <cstring>

#include "shapes/random_mesh.h"
#include "vulkan/device_tessellation.h"

namespace limn::vk::test {
namespace {

using limn::test::TestMesh;

/// Tables of a mesh, or of a crowd, and the points that they are evaluated with: of level 1, too.
struct Surfaces {
    PatchTable patches;
    TessellationTable topology;
    std::vector<float> control, points;
};

std::vector<float> points_of(const PatchTable& table, const std::vector<float>& control) {
    std::vector<double> points(size_t{3} * table.point_count());
    build_patch_points<float>(table, std::vector<double>(control.begin(), control.end()), 3, points);
    return {points.begin(), points.end()};
}

Surfaces surfaces_of(const TestMesh& shape) {
    static const PlanCache cache;
    const auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh) << shape.name;
    Surfaces out{*build_patch_table<float>(*mesh, {}, &cache),
                 *build_tessellation_table(*mesh, {}),
                 shape.positions,
                 {}};
    out.points = points_of(out.patches, out.control);
    return out;
}

struct Crowd {
    Surfaces merged;
    std::vector<PatchBatchMesh> meshes;
};
Crowd merge(const std::vector<Surfaces>& all) {
    std::vector<const PatchTable*> patches;
    std::vector<const TessellationTable*> topologies;
    Crowd crowd;
    for (const Surfaces& s : all) {
        patches.push_back(&s.patches);
        topologies.push_back(&s.topology);
        crowd.merged.control.insert(crowd.merged.control.end(), s.control.begin(), s.control.end());
    }
    PatchBatch batch = *merge_patch_tables<float>(patches);
    crowd.merged.patches = std::move(batch.table);
    crowd.merged.topology = merge_tessellation_tables(topologies)->table;
    crowd.merged.points = points_of(crowd.merged.patches, crowd.merged.control);
    crowd.meshes = std::move(batch.meshes);
    return crowd;
}

/// What a device makes of surfaces.
struct Drawn {
    std::vector<uint32_t> grid_values, grid_normals;  ///< the bits of 3 floats per sample
    std::vector<uint32_t> samples, statuses;  ///< the bits of 9 floats per sample: all those of the grid
    std::vector<uint32_t> indices, triangle_faces, positions, normals, commands;
    TessellationResult result = {};
    uint32_t samples_per_face = 0;
};

constexpr uint32_t kGridRate = 3;
constexpr float kTessellationRate = 5;

/// How triangles are made; by default all alike.
struct Request {
    RateSettings settings = {.value = kTessellationRate, .max_rate = 8, .cull_backfaces = true};
    std::vector<TessellationInstance> instances = {};
    uint32_t triangle_capacity = 0;  ///< 0: what all edges need at kTessellationRate, and no fitting
};

class BatchOnDevice : public TessellatorTest {
  protected:
    Buffer words(size_t count) {
        Buffer buffer =
            *create_buffer(device(), 4 * std::max<size_t>(count, 4), kPointUsage, MemoryUse::device);
        const std::vector<uint32_t> filled(count, 7);
        EXPECT_TRUE(upload_bytes(device(), buffer, 0, std::as_bytes(std::span(filled))));
        return buffer;
    }
    Buffer filled(std::span<const std::byte> bytes) {
        Buffer buffer =
            *create_buffer(device(), std::max<size_t>(bytes.size(), 16), kPointUsage, MemoryUse::device);
        EXPECT_TRUE(upload_bytes(device(), buffer, 0, bytes));
        return buffer;
    }
    template <class Record>
    void run(const Record& record) {
        Result<Commands> commands = Commands::begin(device());
        record(commands->handle());
        record_barrier(device(), *commands, kKernelWrites, kCopyReads);
        EXPECT_TRUE(commands->submit_and_wait());
    }
    std::vector<uint32_t> read(Buffer& buffer, size_t count) {
        return *download<uint32_t>(device(), buffer, count);
    }

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
    void expect_instances_as_alone(RateMode mode, float value);
    Drawn draw(const Surfaces& s) {
        Drawn out;
        const DevicePatchTable patches = *upload_patch_table(device(), s.patches);
        const Buffer points = filled(std::as_bytes(std::span(s.points)));
        draw_grid(s, patches, points, out);
        draw_samples(s, patches, points, out);
        draw_triangles(s, patches, points, out);
        return out;
    }
    void expect_as_alone(const std::vector<TestMesh>& shapes);
    std::array<uint32_t, 3> count_dispatches(const Surfaces& s);
};

void BatchOnDevice::draw_grid(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points,
                              Drawn& out) {
    const DeviceGridTable grid = *upload_grid_table(
        device(), *build_grid_table(s.patches, {.rate = kGridRate, .samples_per_pass = 20'000}));
    const size_t count = 3 * grid.sample_count();
    Buffer values = words(count), normals = words(count);
    const auto evaluation = surfaces_->prepare_grid({.patches = &patches,
                                                     .grid = &grid,
                                                     .points = {.buffer = points.handle},
                                                     .values = {.buffer = values.handle},
                                                     .normals = {.buffer = normals.handle}});
    ASSERT_TRUE(evaluation);
    run([&](VkCommandBuffer commands) { evaluation->record(commands); });
    out.samples_per_face = grid.samples_per_face;
    out.grid_values = read(values, count);
    out.grid_normals = read(normals, count);
}

void BatchOnDevice::draw_samples(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points,
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

void BatchOnDevice::draw_triangles(const Surfaces& s, const DevicePatchTable& patches, const Buffer& points,
                                   Drawn& out, const Request& request) {
    const RateSettings& settings = request.settings;
    const std::vector<uint32_t> rates(s.topology.rate_edge_count, settings.max_rate * shared::kRateOne);
    const TessellationCounts most = count_tessellation(s.topology, rates, TessellationSpacing::integer);
    const auto trees = build_patch_trees(s.patches, {.max_rate = 8});
    const DeviceTessellationTable table = *upload_tessellation_table(device(), s.topology, *trees);
    Buffer positions = words(3 * most.vertices), normals = words(3 * most.vertices),
           indices = words(3 * most.triangles), faces = words(most.triangles), command = words(5),
           result = words(4), commands_of_instances = words(5 * size_t{s.topology.instance_count()});
    const Buffer instances = filled(std::as_bytes(std::span(request.instances)));
    const bool fits = request.triangle_capacity != 0;
    const auto tessellation =
        tessellator_->prepare({.patches = &patches,
                               .table = &table,
                               .points = {.buffer = points.handle},
                               .mode = settings.mode,
                               .cull_outside = settings.cull_outside,
                               .cull_backfaces = settings.cull_backfaces,
                               .instances = {request.instances.empty() ? VK_NULL_HANDLE : instances.handle},
                               .vertex_capacity = static_cast<uint32_t>(most.vertices),
                               .triangle_capacity = fits ? request.triangle_capacity : static_cast<uint32_t>(most.triangles),
                               .fit_capacity = fits,
                               .positions = {.buffer = positions.handle},
                               .normals = {.buffer = normals.handle},
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
}

/// Words [first, first + alone.size()) of those of the crowd are the mesh's own.
void expect_same_words(const std::vector<uint32_t>& merged, uint64_t first,
                       const std::vector<uint32_t>& alone) {
    ASSERT_LE(first + alone.size(), merged.size());
    EXPECT_EQ(std::memcmp(merged.data() + first, alone.data(), 4 * alone.size()), 0);
}

/// Triangles of the mesh, from number `first` of the crowd's: the same faces, vertices of the same bits.
void expect_same_triangles(const Drawn& merged, size_t first, const Drawn& alone, uint32_t first_face) {
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
    }
}

void BatchOnDevice::expect_as_alone(const std::vector<TestMesh>& shapes) {
    std::vector<Surfaces> all;
    for (const TestMesh& shape : shapes) all.push_back(surfaces_of(shape));
    const Crowd crowd = merge(all);
    const Drawn merged = draw(crowd.merged);
    EXPECT_EQ(merged.result.status, TessellationStatus::complete);
    size_t triangle = 0;
    for (size_t m = 0; m < all.size(); ++m) {
        SCOPED_TRACE(shapes[m].name);
        const Drawn alone = draw(all[m]);
        const uint32_t face = crowd.meshes[m].ptex_faces.first;
        const uint64_t sample = uint64_t{face} * alone.samples_per_face;
        expect_same_words(merged.grid_values, 3 * sample, alone.grid_values);
        expect_same_words(merged.grid_normals, 3 * sample, alone.grid_normals);
        expect_same_words(merged.samples, 9 * sample, alone.samples);
        expect_same_words(merged.statuses, sample, alone.statuses);
        expect_same_triangles(merged, triangle, alone, face);
        triangle += alone.triangle_faces.size();
    }
    EXPECT_EQ(merged.triangle_faces.size(), triangle);
}

// Some of every kind: holes, creases, larger faces, boundaries, what is no manifold; one of them twice.
TEST_F(BatchOnDevice, DrawsWhatEachMeshAloneDoes) {
    for (const std::vector<TestMesh>& alike : limn::test::shapes_by_options()) {
        constexpr size_t kMost = 7;
        std::vector<TestMesh> shapes;
        for (size_t i = 0; i < std::min(kMost, alike.size()); ++i)
            shapes.push_back(alike[i * alike.size() / std::min(kMost, alike.size())]);
        shapes.push_back(shapes[0]);
        expect_as_alone(shapes);
    }
}

TEST_F(BatchOnDevice, StorageBuffersAreAsTexelBuffers) {
    pretend_gpu();
    expect_as_alone(
        {limn::test::make_prism(5), limn::test::make_globe(5, 2), limn::test::make_quad_star(3, 2)});
}

// Level-1 points, which the device makes by other sums than for a mesh alone: rows are sorted into other
// runs.
TEST_F(BatchOnDevice, MakesPointsAsTheHostDoes) {
    std::vector<Surfaces> all;
    for (uint64_t seed = 0; seed < 12; ++seed)
        all.push_back(surfaces_of(limn::test::make_messy_torus(8, 8, seed)));
    const Surfaces merged = merge(all).merged;
    const DevicePatchTable patches = *upload_patch_table(device(), merged.patches);
    std::vector<float> initial = merged.points;
    std::fill(initial.begin() + static_cast<ptrdiff_t>(merged.control.size()), initial.end(), 7.0f);
    const Buffer points = filled(std::as_bytes(std::span(initial)));
    const auto refined =
        surfaces_->prepare_points({.patches = &patches, .points = {.buffer = points.handle}});
    ASSERT_TRUE(refined);
    run([&](VkCommandBuffer commands) { refined->record(commands); });
    const size_t first = size_t{3} * merged.patches.first_refined;
    const std::vector<float> made = *download<float>(device(), points, merged.points.size());
    EXPECT_TRUE(
        points_match({{merged.points.begin() + static_cast<ptrdiff_t>(first), merged.points.end()}, 3},
                     {made, first, 3}, tolerance_of(merged.control, 3)));
}

/// A turn about an axis by quarters, a size and a place for each: exact in float, so that the camera that sees an instance
/// from its own coordinates is.
TessellationInstance make_instance(uint32_t i) {
    TessellationInstance instance = {};
    const float size = i % 2 == 0 ? 1.0f : 0.5f;
    const uint32_t from[3] = {i % 3, (i + 1) % 3, (i + 2) % 3};
    for (uint32_t row = 0; row < 3; ++row) instance.object_to_world[4 * row + from[row]] = size;
    instance.object_to_world[3] = static_cast<float>(i) - 1.5f;
    instance.object_to_world[11] = 0.25f * static_cast<float>(i);
    instance.value_scale = i % 2 == 0 ? 1.0f : 2.0f;
    return instance;
}

/// camera * object_to_world.
Camera camera_of(const Camera& camera, const TessellationInstance& instance) {
    Camera out = camera;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            float sum = j == 3 ? camera.matrix[12 + i] : 0;
            for (int k = 0; k < 3; ++k) sum += camera.matrix[4 * k + i] * instance.object_to_world[4 * k + j];
            out.matrix[4 * j + i] = sum;
        }
    return out;
}

/// 8 units before the origin, looking at it: coefficients that sums of a few stay exact with.
constexpr Camera kCamera = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 7, 8}, 512, 512};

// Every instance, but those hidden, as its mesh alone through camera * object_to_world and with its own value; commands
// say where its triangles are, and come to all of them.
void BatchOnDevice::expect_instances_as_alone(RateMode mode, float value) {
    std::vector<Surfaces> all;
    for (const TestMesh& shape : {limn::test::make_prism(5), limn::test::make_torus(6, 4), limn::test::make_cube(),
                                  limn::test::make_torus(20, 12)})
        all.push_back(surfaces_of(shape));
    const Crowd crowd = merge(all);
    Request request = {{.mode = mode, .value = value, .max_rate = 8, .camera = kCamera, .cull_outside = true,
                        .cull_backfaces = true}};
    for (uint32_t i = 0; i < all.size(); ++i) request.instances.push_back(make_instance(i));
    for (const uint32_t hidden : {~0u, 1u, 3u}) {
        if (hidden != ~0u) request.instances[hidden].flags |= shared::kInstanceHidden;
        const Drawn merged = draw_triangles(crowd.merged, request);
        EXPECT_EQ(merged.result.status, TessellationStatus::complete);
        uint32_t triangle = 0;
        for (uint32_t i = 0; i < all.size(); ++i) {
            Request own = request;
            own.instances.clear();
            own.settings.camera = camera_of(kCamera, request.instances[i]);
            own.settings.value = value * request.instances[i].value_scale;
            const bool is_hidden = request.instances[i].flags != 0;
            const Drawn alone = is_hidden ? Drawn{} : draw_triangles(all[i], own);
            EXPECT_EQ(is_hidden, alone.result.triangle_count == 0);
            const std::vector<uint32_t> command(merged.commands.begin() + 5 * i, merged.commands.begin() + 5 * i + 5);
            EXPECT_EQ(command, (std::vector<uint32_t>{3 * alone.result.triangle_count, 1, 3 * triangle, 0, i}));
            expect_same_triangles(merged, triangle, alone, crowd.meshes[i].ptex_faces.first);
            triangle += alone.result.triangle_count;
        }
        EXPECT_EQ(triangle, merged.result.triangle_count);
    }
}

TEST_F(BatchOnDevice, InstancesAreDrawnAsAloneInTheirPlaces) {
    expect_instances_as_alone(RateMode::uniform, 2);
    expect_instances_as_alone(RateMode::screen_length, 4);
    expect_instances_as_alone(RateMode::pixel_error, 0.1f);
    expect_instances_as_alone(RateMode::distance, 16);
}

TEST_F(BatchOnDevice, InstancesInStorageBuffersToo) {
    pretend_gpu();
    expect_instances_as_alone(RateMode::screen_length, 4);
}

// All instances share what fits; their commands still come to what is drawn.
TEST_F(BatchOnDevice, CapacityIsFittedAcrossInstances) {
    const Surfaces torus = surfaces_of(limn::test::make_torus(6, 4));
    const Crowd crowd = merge({torus, torus, torus});
    Request request = {{.value = 8, .max_rate = 8}};
    for (uint32_t i = 0; i < 3; ++i) request.instances.push_back(make_instance(2 * i));
    const auto scale_of = [&] {
        const Drawn drawn = draw_triangles(crowd.merged, request);
        EXPECT_EQ(drawn.commands[0] + drawn.commands[5] + drawn.commands[10], 3 * drawn.result.triangle_count);
        EXPECT_LE(drawn.result.triangle_count, request.triangle_capacity);
        EXPECT_GT(drawn.result.triangle_count, request.triangle_capacity / 2);
        return drawn.result.rate_scale;
    };
    request.triangle_capacity = 3 * 24 * 2 * 25;  // of 64 cells a face 25 or fewer
    const float all = scale_of();
    EXPECT_LT(all, 1);
    request.instances[0].flags = shared::kInstanceHidden;  // more for the others
    EXPECT_GT(scale_of(), all);
}

/// Of level-1 points, a grid, and local points of a tessellation.
std::array<uint32_t, 3> BatchOnDevice::count_dispatches(const Surfaces& s) {
    const DevicePatchTable patches = *upload_patch_table(device(), s.patches);
    const DeviceGridTable grid =
        *upload_grid_table(device(), *build_grid_table(s.patches, {.rate = kGridRate}));
    const DeviceTessellationTable table =
        *upload_tessellation_table(device(), s.topology, *build_patch_trees(s.patches, {.max_rate = 8}));
    return {static_cast<uint32_t>(patches.points.runs.size()), static_cast<uint32_t>(grid.batches.size()),
            static_cast<uint32_t>(table.vertices.local_points.batches.size())};
}

// Meshes of the same kinds share dispatches, as long as they fit one pass.
TEST_F(BatchOnDevice, MoreMeshesTakeNoMoreDispatches) {
    std::vector<Surfaces> all;
    const auto add = [&](uint32_t copies) {
        for (uint32_t i = 0; i < copies; ++i)
            for (uint64_t seed = 0; seed < 15; ++seed)
                all.push_back(surfaces_of(limn::test::make_messy_torus(8, 8, seed)));
        return count_dispatches(merge(all).merged);
    };
    const std::array<uint32_t, 3> few = add(4), many = add(4);
    EXPECT_EQ(many[1], few[1]);
    EXPECT_EQ(many[2], few[2]);
    EXPECT_LE(many[0], 2 * few[0]);  // rows that are many enough get runs that need no weights
    for (const uint32_t count : many) EXPECT_LT(count, 30u);
}

}  // namespace
}  // namespace limn::vk::test
