// Points in a pose, from a table, against sums over what the caller gave; and what is refused.
#include "limn/skinning.h"

#include <gtest/gtest.h>

#include <limits>

#include "shapes/skins.h"

namespace limn::test {
namespace {

constexpr double kUntouched = 7.5;

std::vector<double> skin(const SkinTable& table, const TestPose& pose) {
    std::vector<double> points(size_t{3} * table.point_count, kUntouched);
    skin_points(table, pose.pose(), points);
    return points;
}

std::vector<float> torus_points() {
    return make_torus(7, 5).positions;
}

TestPose identity_pose(uint32_t joint_count, std::vector<float> weights) {
    TestPose pose = {{}, std::move(weights)};
    for (uint32_t j = 0; j < joint_count; ++j)
        for (const int x : {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}) pose.joint_matrices.push_back(static_cast<float>(x));
    return pose;
}

void expect_near(const std::vector<double>& points, size_t first_point, const std::vector<double>& expected,
                 double tolerance) {
    ASSERT_GE(points.size(), 3 * first_point + expected.size());
    for (size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(points[3 * first_point + i], expected[i], tolerance) << i / 3;
}

TEST(Skinning, WithoutInfluencesAndTargetsPointsRest) {
    TestSkin rest = make_skin(torus_points(), 0, 0, 0, 1);
    const SkinMesh mesh = rest.mesh();
    const SkinInstance instance = {};
    const auto table = build_skin_table({&mesh, 1}, {&instance, 1});
    ASSERT_TRUE(table);
    EXPECT_EQ(table->joint_count, 0u);
    EXPECT_EQ(table->morph_weight_count, 0u);
    EXPECT_EQ(skin(*table, {}), std::vector<double>(rest.rest_points.begin(), rest.rest_points.end()));
}

TEST(Skinning, IdentityLeavesPointsWhereTheyRest) {
    for (const uint32_t influences : {1u, 2u, 4u, 8u}) {
        TestSkin rest = make_skin(torus_points(), influences, 5, 3, 1);
        std::fill(rest.weights.begin(), rest.weights.end(), 1.0f / static_cast<float>(influences));
        const SkinMesh mesh = rest.mesh();
        const SkinInstance instance = {};
        const auto table = build_skin_table({&mesh, 1}, {&instance, 1});
        ASSERT_TRUE(table);
        EXPECT_EQ(table->morph_weight_count, 3u);
        expect_near(skin(*table, identity_pose(table->joint_count, {0, 0, 0})), 0,
                    {rest.rest_points.begin(), rest.rest_points.end()}, 1e-15);
    }
}

TEST(Skinning, MeshesAndInstancesAreAsTheCallersSums) {
    std::vector<TestSkin> skins;
    for (uint32_t influences = 0; influences <= kMaxInfluences; ++influences)
        for (const uint32_t targets : {0u, 1u, 5u})
            skins.push_back(make_skin(torus_points(), influences, 6, targets, 10 * influences + targets));
    std::vector<SkinMesh> meshes;
    for (TestSkin& s : skins) meshes.push_back(s.mesh());
    // Each mesh twice, in another order, with a gap of two points before each.
    std::vector<SkinInstance> instances;
    uint32_t point = 0;
    for (uint32_t i = 0; i < 2 * meshes.size(); ++i) {
        const auto mesh = static_cast<uint32_t>((7 * i) % meshes.size());
        instances.push_back({mesh, point + 2, 3 + 6 * i, 1 + 5 * i});
        point += 2 + static_cast<uint32_t>(skins[mesh].point_count());
    }
    const auto table = build_skin_table(meshes, instances);
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_EQ(table->point_count, point);
    const TestPose pose = make_pose(table->joint_count, table->morph_weight_count, 3);
    const std::vector<double> points = skin(*table, pose);
    for (const SkinInstance& instance : instances) {
        expect_near(points, instance.first_point,
                    skin_plainly(skins[instance.mesh], pose, instance.first_joint, instance.first_morph_weight), 1e-13);
        for (size_t i = 3 * (size_t{instance.first_point} - 2); i < size_t{3} * instance.first_point; ++i)
            EXPECT_EQ(points[i], kUntouched);
    }
}

TEST(Skinning, TablesHoldWhatMoves) {
    TestSkin rest = make_skin(torus_points(), 0, 0, 0, 1);
    rest.targets = {{{}, std::vector<float>(rest.rest_points.size(), 0)}, {{4, 2, 4}, {1, 0, 0, 0, 0, 0, 0, 2, 0}}, {}};
    const SkinMesh mesh = rest.mesh();
    const SkinInstance instance = {};
    const auto table = build_skin_table({&mesh, 1}, {&instance, 1});
    ASSERT_TRUE(table);
    EXPECT_EQ(table->morphs.size(), 2u);  // deltas of zero are nothing
    EXPECT_EQ(table->morph_weight_count, 3u);
    std::vector<double> expected(rest.rest_points.begin(), rest.rest_points.end());
    expected[12] += 0.5;
    expected[13] += 1;
    EXPECT_EQ(skin(*table, {{}, {9, 0.5f, 9}}), expected);
}

TEST(Skinning, NothingAtAllIsATable) {
    const auto table = build_skin_table({}, {});
    ASSERT_TRUE(table);
    EXPECT_TRUE(skin(*table, {}).empty());
}

/// A skin, broken by `damage`, is refused, and blamed.
template <class Damage>
void expect_refused(ErrorCode code, uint64_t element, const Damage& damage) {
    TestSkin rest = make_skin(torus_points(), 2, 3, 2, 1);
    const SkinMesh mesh = rest.mesh();
    SkinMesh meshes[2] = {mesh, mesh};
    SkinInstance instances[2] = {{0, 0, 0, 0}, {1, static_cast<uint32_t>(rest.point_count()), 0, 0}};
    ASSERT_TRUE(build_skin_table(meshes, instances));
    damage(rest, meshes, instances);
    const auto table = build_skin_table(meshes, instances);
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().code, code);
    EXPECT_EQ(table.error().element, element);
    EXPECT_FALSE(table.error().message.empty());
}

TEST(Skinning, RefusesArraysThatDoNotAgree) {
    using Meshes = SkinMesh(&)[2];
    using Instances = SkinInstance(&)[2];
    constexpr auto kBad = ErrorCode::invalid_argument;
    expect_refused(kBad, 1, [](TestSkin&, Meshes m, Instances) { m[1].rest_points = m[1].rest_points.first(4); });
    expect_refused(kBad, 1, [](TestSkin&, Meshes m, Instances) { m[1].rest_points = m[1].rest_points.first(6); });
    expect_refused(kBad, 1, [](TestSkin&, Meshes m, Instances) { m[1].joints = m[1].joints.first(6); });
    expect_refused(kBad, 1, [](TestSkin&, Meshes m, Instances) { m[1].weights = m[1].weights.first(6); });
    expect_refused(kBad, 0, [](TestSkin&, Meshes m, Instances) { m[0].influence_count = 0; });
    expect_refused(kBad, 0, [](TestSkin&, Meshes m, Instances) { m[0].influence_count = kMaxInfluences + 1; });
    expect_refused(kBad, 0, [](TestSkin& s, Meshes, Instances) { s.morph_targets[1].deltas = {}; });
    expect_refused(kBad, 0,
                   [](TestSkin& s, Meshes, Instances) { s.morph_targets[0].deltas = s.morph_targets[0].deltas.first(5); });
}

TEST(Skinning, RefusesWhatIsOutOfRange) {
    using Meshes = SkinMesh(&)[2];
    using Instances = SkinInstance(&)[2];
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    expect_refused(ErrorCode::index_out_of_range, 1, [](TestSkin&, Meshes, Instances i) { i[1].mesh = 2; });
    expect_refused(ErrorCode::index_out_of_range, 0, [](TestSkin& s, Meshes, Instances) { s.targets[1].points[0] = 35; });
    expect_refused(ErrorCode::not_finite, 0, [](TestSkin& s, Meshes, Instances) { s.rest_points[3] = kNan; });
    expect_refused(ErrorCode::not_finite, 0, [](TestSkin& s, Meshes, Instances) { s.weights[3] = kNan; });
    expect_refused(ErrorCode::not_finite, 0, [](TestSkin& s, Meshes, Instances) { s.targets[0].deltas[3] = kNan; });
    expect_refused(ErrorCode::too_large, 1, [](TestSkin&, Meshes, Instances i) { i[1].first_point = ~0u - 34; });
    expect_refused(ErrorCode::too_large, 1, [](TestSkin&, Meshes, Instances i) { i[1].first_joint = ~0u; });
    expect_refused(ErrorCode::too_large, 0, [](TestSkin&, Meshes, Instances i) { i[0].first_morph_weight = ~0u; });
    expect_refused(ErrorCode::too_large, 0, [](TestSkin& s, Meshes m, Instances) {
        s.morph_targets.assign(kMaxMorphTargets + 1, {});
        m[0].morph_targets = m[1].morph_targets = s.morph_targets;
    });
    expect_refused(ErrorCode::invalid_argument, 1, [](TestSkin&, Meshes, Instances i) { i[1].first_point = 34; });
}

}  // namespace
}  // namespace limn::test
