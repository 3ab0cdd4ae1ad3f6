// Tables brought up to date by what differs: word for word those of a fresh upload.
#include "limn/vulkan/table_update.h"

#include "shapes/random_mesh.h"
#include "vulkan/device_tessellation.h"

namespace limn::vk::test {
namespace {

using limn::test::TestMesh;

constexpr float kReserve = 0.5f;

/// All tables of a mesh, with its first channel where it has one.
struct HostTables {
    PatchTable patches, channel;
    TessellationTable topology;
    PatchTreeTable trees, channel_trees;
    GridTable grid;
    const PatchTreeTable* channels[1];

    TessellationTables tessellation() const {
        const bool has_channel = channel.point_count() != 0;
        return {&topology, &trees, std::span(channels).first(has_channel ? 1 : 0)};
    }
};

std::unique_ptr<HostTables> build(const TestMesh& shape) {
    static const PlanCache cache;
    auto out = std::make_unique<HostTables>();
    const auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh) << shape.name;
    const std::vector<uint32_t> channels(shape.channels.empty() ? 0 : 1, 0);
    out->patches = *build_patch_table<float>(*mesh, {}, &cache);
    if (!channels.empty()) out->channel = *build_face_varying_patch_table<float>(*mesh, 0, {}, &cache);
    out->topology = *build_tessellation_table(*mesh, {.channels = channels});
    out->trees = *build_patch_trees(out->patches, {.max_rate = 8});
    out->channel_trees = *build_patch_trees(out->channel, {.max_rate = 8});
    out->grid = *build_grid_table(out->patches, {.rate = 5});
    out->channels[0] = &out->channel_trees;
    return out;
}

struct DeviceTables {
    DevicePatchTable patches;
    DeviceTessellationTable topology;
    DeviceGridTable grid;
};

/// Of words of a buffer, as many as there are in the host's table.
struct Section {
    const Buffer* buffer;
    uint64_t offset, count;
};

class TableUpdates : public TessellatorTest {
  protected:
    std::vector<TableUpdate> update(DeviceTables& tables, const HostTables& before, const HostTables& after,
                                    float reserve);
    DeviceTables upload(const HostTables& tables);
    void expect_same_words(const Section& a, const Section& b);
    void expect_same(const DeviceTables& a, const DeviceTables& b, const HostTables& host);
    void expect_same(const DeviceGridTable& a, const DeviceGridTable& b);
    void run_edits();
};

std::vector<TableUpdate> TableUpdates::update(DeviceTables& tables, const HostTables& before,
                                              const HostTables& after, float reserve) {
    std::vector<TableUpdate> updates;
    auto need = *update_memory(device(), tables.patches, before.patches, after.patches, reserve);
    need += *update_memory(device(), tables.topology, before.tessellation(), after.tessellation(), reserve);
    need += *update_memory(device(), tables.grid, before.grid, after.grid, reserve);
    VkDeviceSize old_bytes = tables.patches.bytes() + tables.topology.bytes() + tables.grid.bytes(),
                 staged = 0;
    run([&](VkCommandBuffer commands) {
        updates.push_back(*record_patch_table_update(device(), commands, tables.patches, before.patches,
                                                     after.patches, reserve));
        updates.push_back(*record_tessellation_table_update(
            device(), commands, tables.topology, before.tessellation(), after.tessellation(), reserve));
        updates.push_back(
            *record_grid_table_update(device(), commands, tables.grid, before.grid, after.grid, reserve));
    });
    for (const TableUpdate& u : updates) {
        for (const Buffer& buffer : u.staging) staged += buffer.size_bytes;
        for (const Buffer& buffer : u.replaced) old_bytes -= buffer.size_bytes;
    }
    EXPECT_EQ(need.staging_bytes, staged);
    EXPECT_EQ(old_bytes + need.device_bytes,
              tables.patches.bytes() + tables.topology.bytes() + tables.grid.bytes());
    return updates;
}

/// An update of nothing where ordinary uploads cannot be read back.
DeviceTables TableUpdates::upload(const HostTables& tables) {
    DeviceTables out;
    if (!device().has_host_memory()) {
        HostTables none;
        none.channels[0] = &none.channel_trees;
        none.channel.first_refined = tables.channel.first_refined;  // as many channels
        update(out, none, tables, 0);
        return out;
    }
    const TessellationTables tessellation = tables.tessellation();
    out.patches = *upload_patch_table(device(), tables.patches);
    out.topology = *upload_tessellation_table(device(), tables.topology, tables.trees, tessellation.channels);
    out.grid = *upload_grid_table(device(), tables.grid);
    return out;
}

void TableUpdates::expect_same_words(const Section& a, const Section& b) {
    ASSERT_EQ(a.count, b.count);
    EXPECT_EQ(*download<uint32_t>(device(), *a.buffer, a.count, 4 * a.offset),
              *download<uint32_t>(device(), *b.buffer, b.count, 4 * b.offset));
}

void TableUpdates::expect_same(const DeviceGridTable& a, const DeviceGridTable& b) {
    EXPECT_EQ(a.batches, b.batches);
    EXPECT_EQ(a.sample_count(), b.sample_count());
    EXPECT_EQ(a.ptex_count, b.ptex_count);
    expect_same_words({&a.words, 0, b.words.size_bytes / 4}, {&b.words, 0, b.words.size_bytes / 4});
    expect_same_words({&a.weights, 0, b.weights.size_bytes / 4}, {&b.weights, 0, b.weights.size_bytes / 4});
}

void TableUpdates::expect_same(const DeviceTables& a, const DeviceTables& b, const HostTables& host) {
    EXPECT_EQ(a.patches.control_count, b.patches.control_count);
    EXPECT_EQ(a.patches.point_count, b.patches.point_count);
    EXPECT_EQ(a.patches.ptex_count, b.patches.ptex_count);
    EXPECT_EQ(a.patches.max_ring_size, b.patches.max_ring_size);
    EXPECT_EQ(a.patches.narrow_rings, b.patches.narrow_rings);
    EXPECT_EQ(a.patches.points.runs, b.patches.points.runs);
    EXPECT_EQ(a.patches.points.row_count, b.patches.points.row_count);
    const auto patch_words = [&](const auto& array, uint32_t shared::PatchTableOffsets::*offset) {
        expect_same_words({&a.patches.words, a.patches.offsets.*offset, array.bytes() / 4},
                          {&b.patches.words, b.patches.offsets.*offset, array.bytes() / 4});
    };
    patch_words(host.patches.ptex_surfaces, &shared::PatchTableOffsets::ptex_surfaces);
    patch_words(host.patches.surfaces, &shared::PatchTableOffsets::surfaces);
    patch_words(host.patches.ring_points.words, &shared::PatchTableOffsets::ring_points);
    patch_words(host.patches.plans, &shared::PatchTableOffsets::plans);
    patch_words(host.patches.plan_nodes, &shared::PatchTableOffsets::plan_nodes);
    patch_words(host.patches.plan_points, &shared::PatchTableOffsets::plan_points);
    patch_words(host.patches.plan_weights, &shared::PatchTableOffsets::plan_weights);
    const Buffer &a_points = a.patches.points.data, &b_points = b.patches.points.data;
    if (host.patches.refined_count != 0)
        expect_same_words({&a_points, 0, b_points.size_bytes / 4}, {&b_points, 0, b_points.size_bytes / 4});
    const DeviceTessellationTable &t = a.topology, &u = b.topology;
    EXPECT_EQ(t.face_count, u.face_count);
    EXPECT_EQ(t.row_count, u.row_count);
    EXPECT_EQ(t.corner_count, u.corner_count);
    EXPECT_EQ(t.rate_edge_count, u.rate_edge_count);
    EXPECT_EQ(t.corner_copy_count, u.corner_copy_count);
    EXPECT_EQ(t.max_rate, u.max_rate);
    const auto words = [&](uint64_t a_offset, uint64_t b_offset, uint64_t bytes) {
        expect_same_words({&t.words, a_offset, bytes / 4}, {&u.words, b_offset, bytes / 4});
    };
    words(t.offsets.faces, u.offsets.faces, host.topology.faces.bytes());
    words(t.offsets.rows, u.offsets.rows, host.topology.rows.bytes());
    words(t.offsets.corners, u.offsets.corners, host.topology.corners.bytes());
    words(t.offsets.rate_edges, u.offsets.rate_edges, host.topology.rate_edges.bytes());
    words(t.offsets.copies, u.offsets.copies,
          host.topology.corner_copies.bytes() + host.topology.row_copies.bytes());
    words(t.instances_offset, u.instances_offset, list_instances(host.topology).bytes());
    const auto trees = [&](const DevicePatchTrees& v, const DevicePatchTrees& w,
                           const PatchTreeTable& table) {
        words(v.offsets.ptex_surfaces, w.offsets.ptex_surfaces, table.ptex_surfaces.bytes());
        words(v.offsets.surfaces, w.offsets.surfaces, table.surfaces.bytes());
        words(v.offsets.nodes, w.offsets.nodes, table.nodes.bytes());
        words(v.offsets.leaf_points, w.offsets.leaf_points, table.leaf_points.bytes());
        EXPECT_EQ(v.local_count, w.local_count);
        expect_same(v.local_points, w.local_points);
    };
    trees(t.vertices, u.vertices, host.trees);
    ASSERT_EQ(t.channels.size(), u.channels.size());
    for (size_t c = 0; c < t.channels.size(); ++c) trees(t.channels[c], u.channels[c], host.channel_trees);
    expect_same(a.grid, b.grid);
}

/// One mesh after the other in the same tables: larger, smaller, with another crease, the same.
void TableUpdates::run_edits() {
    std::vector<TestMesh> shapes = {limn::test::make_torus(9, 9), limn::test::make_messy_torus(9, 9, 1)};
    TestMesh creased = shapes.back();
    creased.add_crease(creased.face_vertices[0], creased.face_vertices[1], 1.5);
    shapes.push_back(creased);
    shapes.push_back(creased);
    for (uint64_t seed = 2; seed < 5; ++seed)
        shapes.push_back(limn::test::make_messy_torus(9, 9 + seed % 2, seed));
    shapes.push_back(limn::test::make_cube());
    shapes.push_back(limn::test::make_messy_torus(20, 20, 9));
    HostTables none;
    none.channels[0] = &none.channel_trees;
    DeviceTables tables;
    std::vector<std::unique_ptr<HostTables>> states;
    uint32_t in_place = 0;
    for (size_t i = 0; i < shapes.size(); ++i) {
        SCOPED_TRACE(i);
        states.push_back(build(shapes[i]));
        const auto updates = update(tables, i == 0 ? none : *states[i - 1], *states[i], kReserve);
        expect_same(tables, upload(*states[i]), *states[i]);
        for (const TableUpdate& u : updates) {
            in_place += i != 0 && u.replaced.empty();
            if (i == 3) {
                EXPECT_EQ(u.copied_bytes, 0u);
                EXPECT_FALSE(u.prepare_again);
            }
            if (i == 0) {
                EXPECT_TRUE(u.prepare_again);
            }
        }
    }
    EXPECT_GT(in_place, shapes.size());
}

TEST_F(TableUpdates, AreFreshUploads) {
    run_edits();
}
TEST_F(TableUpdates, AreFreshUploadsByStaging) {
    pretend_gpu();
    run_edits();
}

TEST_F(TableUpdates, OfChannels) {
    for (const TestMesh& shape : limn::test::face_varying_shapes()) {
        if (shape.options.scheme != Scheme::catmull_clark || shape.creases.empty()) continue;
        SCOPED_TRACE(shape.name);
        TestMesh edited = shape;
        edited.crease_sharpness[0] += 1;
        const auto mesh = ControlMesh::create(edited.description());
        if (!build_face_varying_patch_table<float>(*mesh, 0, {}))
            continue;  // Chaikin creases and smooth channels
        const auto before = build(shape), after = build(edited);
        DeviceTables tables = upload(*before);
        update(tables, *before, *after, kReserve);
        expect_same(tables, upload(*after), *after);
    }
}

TEST_F(TableUpdates, RefuseOtherMeshesAndChannels) {
    const auto cube = build(limn::test::make_cube()), torus = build(limn::test::make_torus(5, 4));
    DeviceTables tables = upload(*cube);
    Result<Commands> commands = Commands::begin(device());
    const TessellationTables mixed = {&torus->topology, &cube->trees, {}};
    EXPECT_EQ(
        record_tessellation_table_update(device(), *commands, tables.topology, cube->tessellation(), mixed)
            .error()
            .code,
        ErrorCode::invalid_argument);
    const TessellationTables more = {&torus->topology, &torus->trees, torus->channels};
    EXPECT_EQ(update_memory(device(), tables.topology, cube->tessellation(), more).error().code,
              ErrorCode::invalid_argument);
    expect_same(tables, upload(*cube), *cube);
}

}  // namespace
}  // namespace limn::vk::test
