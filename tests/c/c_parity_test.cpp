// The C interface gives the C++ interface's bits, and structs and values that stay as they are.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <vector>

#include "limn/c/limn.h"
#include "limn/evaluate.h"

namespace {

#define LIMN_PIN(type, member, offset) static_assert(offsetof(type, member) == (offset))
static_assert(sizeof(limn_error) == 256 && sizeof(limn_face_varying_channel) == 24 && sizeof(limn_patch_sample) == 24);
static_assert(sizeof(limn_control_mesh_description) == 176 && sizeof(limn_patch_table_options) == 32);
static_assert(sizeof(limn_patch_table_info) == 40 && sizeof(limn_patch_evaluation) == 80);
static_assert(sizeof(limn_patch_trees_options) == 32 && sizeof(limn_tessellation_table_options) == 32);
static_assert(sizeof(limn_tessellation_table_info) == 40 && sizeof(limn_grid_table_options) == 24);
static_assert(sizeof(limn_stencil_table_options) == 16 && sizeof(limn_bake_options) == 32);
static_assert(sizeof(limn_baked_channel) == 16);
LIMN_PIN(limn_patch_table_options, control, 24);
LIMN_PIN(limn_patch_trees_options, max_weight_bytes, 16);
LIMN_PIN(limn_patch_trees_options, control, 24);
LIMN_PIN(limn_tessellation_table_options, channels, 8);
LIMN_PIN(limn_tessellation_table_options, control, 24);
LIMN_PIN(limn_tessellation_table_info, instance_count, 24);
LIMN_PIN(limn_tessellation_table_info, bytes, 32);
LIMN_PIN(limn_grid_table_options, samples_per_pass, 12);
LIMN_PIN(limn_grid_table_options, max_weight_bytes, 16);
LIMN_PIN(limn_stencil_table_options, interpolation, 12);
LIMN_PIN(limn_bake_options, patches, 16);
LIMN_PIN(limn_bake_options, channels, 24);
LIMN_PIN(limn_baked_channel, value_count, 8);
LIMN_PIN(limn_error, element, 8);
LIMN_PIN(limn_error, message, 16);
LIMN_PIN(limn_control_mesh_description, vertex_count, 24);
LIMN_PIN(limn_control_mesh_description, channels, 32);
LIMN_PIN(limn_control_mesh_description, crease_sharpness, 104);
LIMN_PIN(limn_control_mesh_description, positions, 160);
LIMN_PIN(limn_patch_table_options, isolation_level, 16);
LIMN_PIN(limn_patch_table_info, bytes, 32);
LIMN_PIN(limn_patch_evaluation, samples, 16);
LIMN_PIN(limn_patch_evaluation, statuses, 64);
static_assert(LIMN_ERROR_INVALID_ARGUMENT == 1 && LIMN_ERROR_VULKAN_FAILURE == 13 && LIMN_ERROR_UNSUPPORTED == 14 &&
              LIMN_ERROR_CANCELLED == 15);
static_assert(LIMN_PATCH_TREES_RELATIVE == 1 && LIMN_TESSELLATION_TABLE_JOIN_CREASES == 1 &&
              LIMN_GRID_TABLE_POINTS_ONLY == 1 && LIMN_STENCIL_TABLE_LIMIT == 1 && LIMN_STENCIL_TABLE_TANGENTS == 2);
static_assert(LIMN_BAKE_JOIN_CREASES == 1 && LIMN_BAKED_FILE_TRUSTED == 1 && LIMN_BAKED_FILE_READ == 2);
static_assert(LIMN_BOUNDARY_NONE == 2 && LIMN_FACE_VARYING_BOUNDARIES == 5 && LIMN_DERIVATIVES_SECOND == 2);

// Two quads and a triangle; a crease, a corner, a boundary and a channel with a seam.
constexpr uint32_t kSizes[] = {4, 4, 3}, kFaces[] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 6};
constexpr uint32_t kCrease[] = {1, 4}, kCorner[] = {2}, kValues[] = {0, 1, 4, 3, 7, 2, 5, 8, 3, 4, 6};
constexpr float kCreaseSharpness[] = {2.5f}, kCornerSharpness[] = {10};
constexpr uint32_t kValueCount = 9;

limn::ControlMeshDescription describe(std::span<const limn::FaceVaryingDescription> channels) {
    return {.options = {.boundary = limn::BoundaryInterpolation::edge_and_corner},
            .vertex_count = 7,
            .face_sizes = kSizes,
            .face_vertices = kFaces,
            .crease_sizes = {},
            .crease_vertices = kCrease,
            .crease_sharpness = kCreaseSharpness,
            .corner_vertices = kCorner,
            .corner_sharpness = kCornerSharpness,
            .holes = {},
            .channels = channels,
            .positions = {}};
}

limn_control_mesh_description describe_in_c(const limn_face_varying_channel& channel) {
    limn_control_mesh_description d = {};
    d.struct_size = sizeof(d);
    d.boundary = LIMN_BOUNDARY_EDGE_AND_CORNER;
    d.vertex_count = 7;
    d.channel_count = 1;
    d.channels = &channel;
    d.face_sizes = kSizes, d.face_count = 3;
    d.face_vertices = kFaces, d.face_vertex_count = 11;
    d.crease_vertices = kCrease, d.crease_vertex_count = 2;
    d.crease_sharpness = kCreaseSharpness, d.crease_sharpness_count = 1;
    d.corner_vertices = kCorner, d.corner_sharpness = kCornerSharpness, d.corner_count = 1;
    return d;
}

void expect_equal(const limn::PatchTable& table, const limn_patch_table* in_c) {
    std::vector<double> control(size_t{2} * table.control_count);
    for (size_t i = 0; i < control.size(); ++i) control[i] = static_cast<double>(i * i % 17) / 3;
    const size_t point_values = size_t{2} * table.point_count();
    std::vector<double> points(point_values), points_in_c(point_values);
    limn::build_patch_points(table, control, 2, points);
    ASSERT_EQ(limn_patch_table_build_points(in_c, control.data(), control.size(), 2, points_in_c.data(), point_values,
                                            nullptr), LIMN_SUCCESS);
    EXPECT_EQ(std::memcmp(points.data(), points_in_c.data(), point_values * sizeof(double)), 0);
    const std::vector<limn::PatchSample> samples = {{0, 0.25, 0.5}, {1, 1, 1}, {2, 0, 0}, {4, 0.5, 0.75}, {99, 0, 0}};
    std::vector<limn_patch_sample> samples_in_c;
    for (const limn::PatchSample& s : samples) samples_in_c.push_back({s.face, 0, s.u, s.v});
    std::vector<double> results(5 * 6 * 2, -1), results_in_c(results);
    std::vector<limn::SampleStatus> statuses(5);
    std::vector<limn_sample_status> statuses_in_c(5);
    limn::evaluate_patches(table, samples, points, 2, limn::Derivatives::second, results, statuses);
    const limn_patch_evaluation evaluation = {sizeof(evaluation), 2, LIMN_DERIVATIVES_SECOND, 0, samples_in_c.data(), 5,
                                              points_in_c.data(), point_values, results_in_c.data(), results_in_c.size(),
                                              statuses_in_c.data(), 5};
    ASSERT_EQ(limn_patch_table_evaluate(in_c, &evaluation, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(std::memcmp(results.data(), results_in_c.data(), results.size() * sizeof(double)), 0);
    EXPECT_EQ(std::memcmp(statuses.data(), statuses_in_c.data(), 5), 0);
    EXPECT_EQ(statuses_in_c[4], LIMN_SAMPLE_OUT_OF_RANGE);
}

TEST(CInterface, GivesTheBitsOfTheCppInterface) {
    const limn::FaceVaryingDescription channels[] = {
        {kValueCount, kValues, limn::FaceVaryingInterpolation::corners_plus1}};
    const auto mesh = limn::ControlMesh::create(describe(channels));
    ASSERT_TRUE(mesh);
    const limn_face_varying_channel channel = {kValues, 11, kValueCount, LIMN_FACE_VARYING_CORNERS_PLUS1};
    const limn_control_mesh_description description = describe_in_c(channel);
    limn_control_mesh* mesh_in_c = nullptr;
    ASSERT_EQ(limn_control_mesh_create(&description, &mesh_in_c, nullptr), LIMN_SUCCESS);
    limn_patch_table *table_in_c = nullptr, *channel_in_c = nullptr;
    ASSERT_EQ(limn_patch_table_create(mesh_in_c, nullptr, nullptr, &table_in_c, nullptr), LIMN_SUCCESS);
    ASSERT_EQ(limn_patch_table_create_channel(mesh_in_c, 0, nullptr, nullptr, &channel_in_c, nullptr), LIMN_SUCCESS);
    expect_equal(*limn::build_patch_table<float>(*mesh, {}), table_in_c);
    expect_equal(*limn::build_face_varying_patch_table<float>(*mesh, 0, {}), channel_in_c);
    limn_patch_table_destroy(channel_in_c);
    limn_patch_table_destroy(table_in_c);
    limn_control_mesh_destroy(mesh_in_c);
}

}  // namespace
