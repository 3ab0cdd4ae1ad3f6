// Points in a pose on the device: against the host's, and on through level-1 points to a tessellation.
#include "limn/vulkan/skinning.h"

#include <cstring>
#include <numbers>

#include "limn/batch.h"
#include "shapes/skins.h"
#include "vulkan/device_tessellation.h"

namespace limn::vk::test {
namespace {

using limn::test::make_pose;
using limn::test::make_skin;
using limn::test::TestPose;
using limn::test::TestSkin;

constexpr float kUntouched = -7.5f;

/// Where things begin in buffers of the caller's: matrices at 16 bytes, weights at 4, points at 20 floats with 2 between.
constexpr uint32_t kMatrixFloats = 4, kWeightFloats = 1, kFirstPoint = 20, kStride = 5;

class SkinningOnDevice : public TessellatorTest {
  protected:
    Buffer floats(uint32_t skipped, std::span<const float> values) {
        std::vector<float> all(std::max<size_t>(4, skipped + values.size()), kUntouched);
        std::copy(values.begin(), values.end(), all.begin() + skipped);
        return *create_point_buffer(device(), all);
    }
    /// All floats of the buffer of points.
    std::vector<float> skin(const SkinTable& table, const TestPose& pose);
    void expect_as_host(const SkinTable& table, const TestPose& pose);
    void expect_as_hosts_for_all_counts();
};

std::vector<float> SkinningOnDevice::skin(const SkinTable& table, const TestPose& pose) {
    const auto skinner = Skinner::create(device());
    const auto device_table = upload_skin_table(device(), table);
    EXPECT_TRUE(skinner && device_table);
    const size_t count = kFirstPoint + size_t{kStride} * table.point_count;
    const Buffer points = floats(0, std::vector<float>(count, kUntouched));
    const Buffer matrices = floats(kMatrixFloats, pose.joint_matrices), weights = floats(kWeightFloats, pose.morph_weights);
    const auto skinning = skinner->prepare(
        {.table = &*device_table,
         .joint_matrices = {table.joint_count != 0 ? matrices.handle : VK_NULL_HANDLE, 4 * kMatrixFloats},
         .morph_weights = {table.morph_weight_count != 0 ? weights.handle : VK_NULL_HANDLE, 4 * kWeightFloats},
         .points = {.buffer = points.handle, .offset_bytes = 4 * 8, .first = kFirstPoint - 8, .stride = kStride}});
    EXPECT_TRUE(skinning) << skinning.error().message;
    run([&](VkCommandBuffer commands) { skinning->record(commands); });
    return *download<float>(device(), points, count);
}

void SkinningOnDevice::expect_as_host(const SkinTable& table, const TestPose& pose) {
    std::vector<double> host(size_t{3} * table.point_count, kUntouched);
    skin_points(table, pose.pose(), host);
    const std::vector<float> made = skin(table, pose), again = skin(table, pose);
    EXPECT_EQ(std::memcmp(made.data(), again.data(), 4 * made.size()), 0);
    const double tolerance = tolerance_of({host.begin(), host.end()}, 3);
    EXPECT_TRUE(points_match({host, 3}, {made, kFirstPoint, kStride}, tolerance));
    for (size_t i = 0; i < made.size(); ++i)
        if (i < kFirstPoint || (i - kFirstPoint) % kStride >= 3) {
            ASSERT_EQ(made[i], kUntouched) << i;
        }
}

/// Meshes of every number of influences, with targets and without, some of several workgroups; each twice, with gaps.
void SkinningOnDevice::expect_as_hosts_for_all_counts() {
    std::vector<TestSkin> skins;
    for (uint32_t influences = 0; influences <= kMaxInfluences; ++influences)
        for (const uint32_t targets : {0u, 6u})
            skins.push_back(make_skin(limn::test::make_torus(5 + 3 * influences, 5).positions, influences, 9, targets,
                                      10 * influences + targets));
    std::vector<SkinMesh> meshes;
    for (TestSkin& s : skins) meshes.push_back(s.mesh());
    std::vector<SkinInstance> instances;
    uint32_t point = 1;
    for (uint32_t i = 0; i < 2 * meshes.size(); ++i) {
        const auto mesh = static_cast<uint32_t>((7 * i) % meshes.size());
        instances.push_back({mesh, point, 2 + 9 * i, 3 + 6 * i});
        point += static_cast<uint32_t>(skins[mesh].point_count()) + 1;
    }
    const auto table = build_skin_table(meshes, instances);
    ASSERT_TRUE(table);
    expect_as_host(*table, make_pose(table->joint_count, table->morph_weight_count, 5));
}

TEST_F(SkinningOnDevice, PointsAreAsTheHosts) {
    expect_as_hosts_for_all_counts();
}

TEST_F(SkinningOnDevice, StorageBuffersGiveTheHostsToo) {
    pretend_gpu();
    expect_as_hosts_for_all_counts();
}

// To the bit: without anything that moves it, and with what moves it by nothing.
TEST_F(SkinningOnDevice, WhatDoesNotMoveRests) {
    const auto expect_rest = [&](TestSkin rest, const TestPose& pose) {
        const SkinMesh mesh = rest.mesh();
        const SkinInstance instance = {};
        const std::vector<float> made = skin(*build_skin_table({&mesh, 1}, {&instance, 1}), pose);
        for (size_t i = 0; i < rest.rest_points.size(); ++i)
            ASSERT_EQ(made[kFirstPoint + i / 3 * kStride + i % 3], rest.rest_points[i]);
    };
    const std::vector<float> points = limn::test::make_torus(9, 9).positions;
    const std::vector<float> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    expect_rest(make_skin(points, 0, 0, 0, 1), {});
    expect_rest(make_skin(points, 0, 0, 3, 1), {{}, {0, 0, 0}});
    TestSkin quarters = make_skin(points, 4, 1, 0, 1);
    std::fill(quarters.weights.begin(), quarters.weights.end(), 0.25f);
    expect_rest(std::move(quarters), {identity, {}});
}

TEST_F(SkinningOnDevice, NothingAtAllIsRecorded) {
    const auto skinner = Skinner::create(device());
    const auto table = upload_skin_table(device(), *build_skin_table({}, {}));
    ASSERT_TRUE(skinner && table);
    const Buffer points = floats(0, {});
    const auto skinning = skinner->prepare({.table = &*table, .points = {.buffer = points.handle}});
    ASSERT_TRUE(skinning);
    run([&](VkCommandBuffer commands) { skinning->record(commands); });
    EXPECT_EQ(*download<float>(device(), points, 4), std::vector<float>(4, kUntouched));
}

TEST_F(SkinningOnDevice, RefusesBadArguments) {
    TestSkin skin = make_skin(limn::test::make_torus(7, 5).positions, 2, 3, 2, 1);
    const SkinMesh mesh = skin.mesh();
    const SkinInstance instance = {};
    const auto refuse = [&](ErrorCode code, const auto& damage) {
        const auto skinner = Skinner::create(device());
        const auto table = upload_skin_table(device(), *build_skin_table({&mesh, 1}, {&instance, 1}));
        const Buffer points = floats(0, std::vector<float>(skin.rest_points.size())),
                     pose = floats(0, std::vector<float>(64));
        SkinningInfo info = {&*table, {pose.handle, 0}, {pose.handle, 0}, {.buffer = points.handle}};
        damage(info);
        const auto skinning = skinner->prepare(info);
        ASSERT_FALSE(skinning);
        EXPECT_EQ(skinning.error().code, code);
    };
    constexpr auto kBad = ErrorCode::invalid_argument;
    refuse(kBad, [](SkinningInfo& info) { info.table = nullptr; });
    refuse(kBad, [](SkinningInfo& info) { info.joint_matrices = {}; });
    refuse(kBad, [](SkinningInfo& info) { info.joint_matrices.offset_bytes = 8; });
    refuse(kBad, [](SkinningInfo& info) { info.morph_weights = {}; });
    refuse(kBad, [](SkinningInfo& info) { info.morph_weights.offset_bytes = 2; });
    refuse(kBad, [](SkinningInfo& info) { info.points = {}; });
    refuse(kBad, [](SkinningInfo& info) { info.points.stride = 2; });
    refuse(kBad, [](SkinningInfo& info) { info.points.offset_bytes = 1; });
    pretend_gpu(64);
    refuse(ErrorCode::unsupported, [](SkinningInfo&) {});
}

/// A crowd that is drawn: tables of shapes merged, and a skin for all of them.
struct SkinnedCrowd {
    PatchTable patches;
    TessellationTable topology;
    SkinTable skin;
};
SkinnedCrowd make_crowd(const std::vector<limn::test::TestMesh>& shapes) {
    std::vector<PatchTable> patches;
    std::vector<TessellationTable> topologies;
    std::vector<TestSkin> skins;
    for (const limn::test::TestMesh& shape : shapes) {
        const auto mesh = ControlMesh::create(shape.description());
        patches.push_back(*build_patch_table<float>(*mesh, {}));
        topologies.push_back(*build_tessellation_table(*mesh, {}));
        skins.push_back(make_skin(shape.positions, 4, 3, 4, skins.size()));
    }
    std::vector<const PatchTable*> patch_pointers;
    std::vector<const TessellationTable*> topology_pointers;
    std::vector<SkinMesh> meshes;
    for (size_t i = 0; i < shapes.size(); ++i) {
        patch_pointers.push_back(&patches[i]);
        topology_pointers.push_back(&topologies[i]);
        meshes.push_back(skins[i].mesh());
    }
    PatchBatch batch = *merge_patch_tables<float>(patch_pointers);
    std::vector<SkinInstance> instances;
    for (uint32_t i = 0; i < shapes.size(); ++i)
        instances.push_back({i, batch.meshes[i].control_points.first, 3 * i, 4 * i});
    return {std::move(batch.table), std::move(merge_tessellation_tables(topology_pointers)->table),
            *build_skin_table(meshes, instances)};
}

struct Vertices {
    TessellationResult result;
    std::vector<uint32_t> indices;
    std::vector<float> positions, normals;
};

/// Positions to tolerance, normals to a tenth of a degree, the same triangles.
void expect_same_vertices(const Vertices& a, const Vertices& b, double tolerance) {
    ASSERT_EQ(a.result.status, TessellationStatus::complete);
    EXPECT_EQ(a.indices, b.indices);
    EXPECT_TRUE(points_match({{a.positions.begin(), a.positions.end()}, 3}, {b.positions}, tolerance));
    const double sine = 0.1 * std::numbers::pi / 180;
    EXPECT_TRUE(points_match({{a.normals.begin(), a.normals.end()}, 3}, {b.normals}, sine));
}

// One command buffer from joints to vertices; beside it the same tessellation of points that the host moved.
TEST_F(SkinningOnDevice, AFrameFromJointsToVertices) {
    const SkinnedCrowd crowd = make_crowd({limn::test::make_torus(8, 6), limn::test::make_globe(5, 3),
                                           limn::test::make_torus(8, 6), limn::test::make_prism(5)});
    const TestPose pose = make_pose(crowd.skin.joint_count, crowd.skin.morph_weight_count, 7);
    const DevicePatchTable patches = *upload_patch_table(device(), crowd.patches);
    const DeviceTessellationTable table =
        *upload_tessellation_table(device(), crowd.topology, *build_patch_trees(crowd.patches, {.max_rate = 8}));
    const auto skinner = Skinner::create(device());
    const DeviceSkinTable skin_table = *upload_skin_table(device(), crowd.skin);
    const Buffer matrices = floats(0, pose.joint_matrices), weights = floats(0, pose.morph_weights);
    ASSERT_EQ(crowd.skin.point_count, crowd.patches.control_count);

    std::vector<double> moved(size_t{3} * crowd.skin.point_count);
    skin_points(crowd.skin, pose.pose(), moved);
    const auto draw = [&](bool on_device) {
        std::vector<float> initial(size_t{3} * crowd.patches.point_count(), 0.0f);
        if (!on_device) std::copy(moved.begin(), moved.end(), initial.begin());
        const Buffer points = floats(0, initial);
        constexpr uint32_t kMost = 1 << 16;
        const Buffer vertices = floats(0, std::vector<float>(size_t{6} * kMost)),
                     indices = floats(0, std::vector<float>(size_t{3} * kMost)), words = floats(0, std::vector<float>(16));
        const auto skinning = skinner->prepare({.table = &skin_table,
                                                .joint_matrices = {matrices.handle},
                                                .morph_weights = {weights.handle},
                                                .points = {.buffer = points.handle}});
        const auto refined = surfaces_->prepare_points({.patches = &patches, .points = {.buffer = points.handle}});
        const auto surface = tessellator_->prepare({.patches = &patches,
                                                    .table = &table,
                                                    .points = {.buffer = points.handle},
                                                    .vertex_capacity = kMost,
                                                    .triangle_capacity = kMost,
                                                    .fit_capacity = false,
                                                    .positions = {.buffer = vertices.handle, .stride = 6},
                                                    .normals = {.buffer = vertices.handle, .first = 3, .stride = 6},
                                                    .indices = {indices.handle},
                                                    .command = {words.handle},
                                                    .result = {words.handle, 32}});
        EXPECT_TRUE(skinning && refined && surface);
        run([&](VkCommandBuffer commands) {
            if (on_device) skinning->record(commands);
            record_barrier(device(), commands, kKernelWrites, kKernelReads);
            refined->record(commands);
            record_barrier(device(), commands, kKernelWrites, kKernelReads);
            EXPECT_TRUE(surface->record(commands, {.value = 4, .max_rate = 8}));
        });
        Vertices out = {(*download<TessellationResult>(device(), words, 1, 32))[0], {}, {}, {}};
        out.indices = *download<uint32_t>(device(), indices, size_t{3} * out.result.triangle_count);
        const std::vector<float> both = *download<float>(device(), vertices, size_t{6} * out.result.vertex_count);
        for (size_t i = 0; i < both.size(); ++i) (i % 6 < 3 ? out.positions : out.normals).push_back(both[i]);
        return out;
    };
    expect_same_vertices(draw(false), draw(true), tolerance_of({moved.begin(), moved.end()}, 3));
}

}  // namespace
}  // namespace limn::vk::test
