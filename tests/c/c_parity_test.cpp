// The C interface gives the C++ interface's bits.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "limn/c/limn.h"
#include "limn/shared/tess_steps.h"
#include "limn/tessellate.h"

namespace {

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

/// The same tables for both.
class CInterfaceTessellation : public testing::Test {
  protected:
    void SetUp() override {
        const limn::FaceVaryingDescription channels[] = {
            {kValueCount, kValues, limn::FaceVaryingInterpolation::corners_plus1}};
        const uint32_t seams[] = {0};
        const auto mesh = limn::ControlMesh::create(describe(channels));
        ASSERT_TRUE(mesh);
        patches_ = *limn::build_patch_table<float>(*mesh, {});
        channel_ = *limn::build_face_varying_patch_table<float>(*mesh, 0, {});
        topology_ = *limn::build_tessellation_table(*mesh, {.channels = seams});
        const limn_face_varying_channel channel = {kValues, 11, kValueCount, LIMN_FACE_VARYING_CORNERS_PLUS1};
        const limn_control_mesh_description description = describe_in_c(channel);
        const limn_tessellation_table_options options = {sizeof(options), 0, seams, 1, nullptr};
        limn_control_mesh* mesh_in_c = nullptr;
        ASSERT_EQ(limn_control_mesh_create(&description, &mesh_in_c, nullptr), LIMN_SUCCESS);
        EXPECT_EQ(limn_patch_table_create(mesh_in_c, nullptr, nullptr, &patches_in_c_, nullptr), LIMN_SUCCESS);
        EXPECT_EQ(limn_patch_table_create_channel(mesh_in_c, 0, nullptr, nullptr, &channel_in_c_, nullptr), LIMN_SUCCESS);
        EXPECT_EQ(limn_tessellation_table_create(mesh_in_c, &options, &topology_in_c_, nullptr), LIMN_SUCCESS);
        limn_control_mesh_destroy(mesh_in_c);
        points_ = points_of(patches_, 3);
        values_ = points_of(channel_, 2);
    }
    void TearDown() override {
        limn_patch_table_destroy(patches_in_c_);
        limn_patch_table_destroy(channel_in_c_);
        limn_tessellation_table_destroy(topology_in_c_);
    }
    static std::vector<double> points_of(const limn::PatchTable& table, uint32_t width) {
        std::vector<double> control(size_t{width} * table.control_count), points(size_t{width} * table.point_count());
        for (size_t i = 0; i < control.size(); ++i) control[i] = static_cast<double>(i * i % 17) / 3;
        limn::build_patch_points(table, control, width, points);
        return points;
    }
    static limn_tessellation_options options_in_c() {
        limn_tessellation_options options = {};
        options.struct_size = sizeof(options);
        options.matrix[0] = options.matrix[5] = options.matrix[10] = options.matrix[15] = 0.5f;
        options.width = 200, options.height = 100;
        return options;
    }
    limn_result create(const limn_tessellation_options& options, limn_tessellation** out, limn_error* error = nullptr) {
        return limn_tessellation_create(patches_in_c_, topology_in_c_, points_.data(), points_.size(), &options, out, error);
    }
    void expect_same_vertices(const limn::Tessellation& expected, const limn_tessellation* in_c);

    limn::PatchTable patches_, channel_;
    limn::TessellationTable topology_;
    limn_patch_table *patches_in_c_ = nullptr, *channel_in_c_ = nullptr;
    limn_tessellation_table* topology_in_c_ = nullptr;
    std::vector<double> points_, values_;
};

void CInterfaceTessellation::expect_same_vertices(const limn::Tessellation& expected, const limn_tessellation* in_c) {
    const size_t count = expected.vertex_count();
    std::vector<double> heights(3 * count);
    for (size_t i = 0; i < heights.size(); ++i) heights[i] = static_cast<double>(i % 11) / 50;
    limn_tessellation_evaluation e = {};
    std::vector<double> ours[2], positions(3 * count), normals(3 * count);
    ours[0].resize(3 * count), ours[1].resize(3 * count);
    e.struct_size = sizeof(e);
    e.points = points_.data(), e.point_value_count = points_.size();
    e.positions = ours[0].data(), e.position_value_count = 3 * count;
    e.normals = ours[1].data(), e.normal_value_count = 3 * count;
    limn::evaluate_tessellation(patches_, expected, points_, positions, normals);
    ASSERT_EQ(limn_tessellation_evaluate(in_c, patches_in_c_, &e, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(ours[0], positions);
    EXPECT_EQ(ours[1], normals);
    e.heights = heights.data(), e.height_value_count = 3 * count;
    limn::displace_tessellation(patches_, expected, points_, heights, limn::shared::step_size(64), positions, normals);
    ASSERT_EQ(limn_tessellation_evaluate(in_c, patches_in_c_, &e, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(ours[0], positions);
    EXPECT_EQ(ours[1], normals);
    std::vector<double> values(2 * count), values_in_c(2 * count);
    limn::evaluate_tessellation_channel(channel_, expected, values_, 2, values);
    ASSERT_EQ(limn_tessellation_evaluate_channel(in_c, channel_in_c_, values_.data(), values_.size(), 2,
                                                 values_in_c.data(), 2 * count, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(values_in_c, values);
}

TEST_F(CInterfaceTessellation, GivesTheBitsOfTheCppInterface) {
    using limn::RateMode, limn::TessellationSpacing;
    const std::pair<RateMode, limn_rate_mode> modes[] = {
        {RateMode::uniform, LIMN_RATE_UNIFORM},         {RateMode::per_edge, LIMN_RATE_PER_EDGE},
        {RateMode::screen_length, LIMN_RATE_SCREEN_LENGTH}, {RateMode::pixel_error, LIMN_RATE_PIXEL_ERROR},
        {RateMode::chord_error, LIMN_RATE_CHORD_ERROR}, {RateMode::distance, LIMN_RATE_DISTANCE}};
    const std::pair<TessellationSpacing, limn_tessellation_spacing> spacings[] = {
        {TessellationSpacing::integer, LIMN_SPACING_INTEGER},
        {TessellationSpacing::power_of_two, LIMN_SPACING_POWER_OF_TWO},
        {TessellationSpacing::fractional, LIMN_SPACING_FRACTIONAL}};
    std::vector<float> edge_rates(topology_.rate_edge_count);
    for (size_t e = 0; e < edge_rates.size(); ++e) edge_rates[e] = static_cast<float>(1 + e * 7 % 5);
    for (const auto& [mode, mode_in_c] : modes)
        for (const auto& [spacing, spacing_in_c] : spacings) {
            SCOPED_TRACE(mode_in_c);
            limn_tessellation_options options = options_in_c();
            options.mode = mode_in_c, options.spacing = spacing_in_c;
            options.value = mode == RateMode::uniform ? 5.0f : 0.5f, options.max_rate = 16, options.scale = 0.75f;
            options.edge_rates = edge_rates.data(), options.edge_rate_count = edge_rates.size();
            limn::RateSettings settings;
            settings.mode = mode, settings.spacing = spacing, settings.value = options.value, settings.max_rate = 16;
            std::copy(options.matrix, options.matrix + 16, settings.camera.matrix);
            settings.camera.width = 200, settings.camera.height = 100;
            const bool per_edge = mode == RateMode::per_edge;
            const auto rates = limn::compute_rates(patches_, topology_, settings, points_,
                                                   per_edge ? std::span<const float>(edge_rates) : std::span<const float>(), 0.75);
            const auto expected = limn::tessellate(topology_, *rates, spacing);
            ASSERT_TRUE(expected);
            limn_tessellation* in_c = nullptr;
            limn_error error = {};
            ASSERT_EQ(create(options, &in_c, &error), LIMN_SUCCESS) << error.message;
            limn_tessellation_info info = {};
            info.struct_size = sizeof(info);
            ASSERT_EQ(limn_tessellation_get_info(in_c, &info, nullptr), LIMN_SUCCESS);
            ASSERT_EQ(info.vertex_count, expected->vertex_count());
            ASSERT_EQ(size_t{info.triangle_count}, expected->triangle_faces.size());
            EXPECT_GT(info.triangle_count, 10u);
            const auto same = [](const auto* a, const auto& b) { return std::equal(b.begin(), b.end(), a); };
            EXPECT_TRUE(same(info.indices, expected->indices));
            EXPECT_TRUE(same(info.triangle_faces, expected->triangle_faces));
            EXPECT_TRUE(same(info.position_sources, expected->position_sources));
            for (uint32_t i = 0; i < info.vertex_count; ++i) {  // not their padding
                const limn::PatchSample& place = expected->places[i];
                ASSERT_TRUE(info.places[i].face == place.face && info.places[i].u == place.u && info.places[i].v == place.v);
            }
            expect_same_vertices(*expected, in_c);
            limn_tessellation_destroy(in_c);
        }
}

TEST_F(CInterfaceTessellation, RefusesWhatDoesNotFit) {
    limn_tessellation* in_c = nullptr;
    limn_tessellation_options options = options_in_c();
    const auto refused = [&](const char* cause) {
        limn_error error = {};
        EXPECT_EQ(create(options, &in_c, &error), LIMN_ERROR_INVALID_ARGUMENT);
        EXPECT_NE(std::string(error.message).find(cause), std::string::npos) << error.message;
        EXPECT_EQ(in_c, nullptr);
        options = options_in_c();
    };
    options.mode = LIMN_RATE_PER_EDGE;
    refused("edge_rates");
    options.mode = 6;
    refused("rate mode");
    options.spacing = 3;
    refused("spacing");
    options.value = -1;
    refused("rate");
    options.struct_size = 8;
    refused("struct_size");
    const double* points = points_.data();
    const uint64_t count = points_.size();
    const auto create_with = [&](const limn_patch_table* patches, const limn_tessellation_table* table, const double* at,
                                 uint64_t size) { return limn_tessellation_create(patches, table, at, size, nullptr, &in_c, nullptr); };
    EXPECT_EQ(create_with(nullptr, topology_in_c_, points, count), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(create_with(patches_in_c_, nullptr, points, count), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(create_with(patches_in_c_, topology_in_c_, nullptr, count), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(create_with(patches_in_c_, topology_in_c_, points, count - 1), LIMN_ERROR_INVALID_ARGUMENT);
    ASSERT_EQ(create_with(patches_in_c_, topology_in_c_, points, count), LIMN_SUCCESS);
    limn_tessellation_info info = {};
    EXPECT_EQ(limn_tessellation_get_info(in_c, &info, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
    info.struct_size = sizeof(info);
    EXPECT_EQ(limn_tessellation_get_info(nullptr, &info, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
    ASSERT_EQ(limn_tessellation_get_info(in_c, &info, nullptr), LIMN_SUCCESS);
    std::vector<double> out(3 * info.vertex_count);
    limn_tessellation_evaluation e = {};
    const auto evaluation_refused = [&] {
        EXPECT_EQ(limn_tessellation_evaluate(in_c, patches_in_c_, &e, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
    };
    evaluation_refused();
    e.struct_size = sizeof(e);
    evaluation_refused();
    e.points = points, e.point_value_count = count;
    evaluation_refused();
    e.positions = out.data(), e.position_value_count = out.size() - 1;
    evaluation_refused();
    e.position_value_count = out.size();
    EXPECT_EQ(limn_tessellation_evaluate(in_c, patches_in_c_, &e, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(limn_tessellation_evaluate(in_c, nullptr, &e, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_tessellation_evaluate(nullptr, patches_in_c_, &e, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
    e.heights = points, e.height_value_count = out.size();
    evaluation_refused();  // no room for normals
    EXPECT_EQ(limn_tessellation_evaluate_channel(in_c, channel_in_c_, values_.data(), values_.size(), 0, out.data(), 99, nullptr),
              LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_tessellation_evaluate_channel(in_c, channel_in_c_, values_.data(), values_.size(), 2, out.data(),
                                                 2 * info.vertex_count - 1, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
    limn_tessellation_destroy(in_c);
}

}  // namespace
