// Patch and grid evaluation on the device against the same surface in double, which other tests compare with
// OpenSubdiv and with deep refinement.
#include <bit>

#include "limn/packed_normal.h"
#include "vulkan/surface_fixture.h"

namespace limn::vk::test {
namespace {

class SurfaceEval : public SurfaceTest {
  protected:
    void check_grid(const Surface& s, uint32_t rate, const std::string& name,
                    uint32_t samples_per_pass = 3000);
};

void SurfaceEval::check_grid(const Surface& s, uint32_t rate, const std::string& name,
                             uint32_t samples_per_pass) {
    const Result<GridTable> grid =
        build_grid_table(s.table, {.rate = rate, .samples_per_pass = samples_per_pass});
    ASSERT_TRUE(grid) << grid.error().message;
    const DeviceGridTable device_grid = *upload_grid_table(device(), *grid);
    const std::vector<PatchSample> samples =
        list_grid_samples(s.table.options.scheme, device_grid.ptex_count, rate);
    ASSERT_EQ(samples.size(), grid->sample_count());
    const size_t count = samples.size();
    Buffer vertices = create_floats(count * 6), du = create_floats(count * 3), dv = create_floats(count * 3);
    const PointBuffer points{.buffer = s.points.handle, .stride = 3};
    Result<SurfaceEvaluation> normals =
        evaluator_->prepare_grid({.patches = &s.device_table,
                                  .grid = &device_grid,
                                  .points = points,
                                  .values = {.buffer = vertices.handle, .stride = 6},
                                  .normals = {.buffer = vertices.handle, .first = 3, .stride = 6}});
    ASSERT_TRUE(normals) << normals.error().message;
    run([&](VkCommandBuffer commands) { normals->record(commands); });
    const std::vector<float> out = *download<float>(device(), vertices, count * 6);
    Result<SurfaceEvaluation> derivatives =
        evaluator_->prepare_grid({.patches = &s.device_table,
                                  .grid = &device_grid,
                                  .points = points,
                                  .values = {.buffer = vertices.handle, .stride = 6},
                                  .du = {.buffer = du.handle},
                                  .dv = {.buffer = dv.handle}});
    ASSERT_TRUE(derivatives) << derivatives.error().message;
    run([&](VkCommandBuffer commands) { derivatives->record(commands); });
    const std::vector<float> us = *download<float>(device(), du, count * 3),
                             vs = *download<float>(device(), dv, count * 3);
    const HostSamples host = evaluate_on_host(s, samples, Derivatives::first);
    double worst = 0, worst_derivative = 0, worst_angle = 0;
    for (size_t i = 0; i < count; ++i) {
        if (host.statuses[i] == SampleStatus::hole) {
            EXPECT_EQ(out[6 * i], -7.5f) << name << " sample " << i << " of a hole was written";
            continue;
        }
        const double* b = host.values.data() + 9 * i;
        const Vector u = vector_at(b + 3), v = vector_at(b + 6), n = cross(u, v);
        const Vector device_n = vector_at(out.data() + 6 * i + 3);
        const double scale = std::max({length(u), length(v), s.size});
        // Between the children of a face another one may have the sample: where an extraordinary vertex of
        // theirs lies there, lengths of tangents carry no meaning.
        auto between = [](double x) { return x == 0.5; };
        const bool shared =
            between(samples[i].u) || between(samples[i].v) || between(samples[i].u + samples[i].v);
        for (size_t k = 0; k < 3; ++k) {
            worst = std::max(worst, std::abs(out[6 * i + k] - b[k]));
            if (shared) continue;
            worst_derivative = std::max({worst_derivative, std::abs(us[3 * i + k] - b[3 + k]) / scale,
                                         std::abs(vs[3 * i + k] - b[6 + k]) / scale});
        }
        ASSERT_NEAR(length(device_n), 1, 1e-5) << name << " sample " << i;
        if (length(n) <= kDegenerate * length(u) * length(v)) continue;
        if (std::min(length(u), length(v)) <= kShort * s.size) continue;
        worst_angle = std::max(worst_angle, degrees_between(n, device_n));
    }
    EXPECT_LE(worst, s.tolerance) << name << " rate " << rate;
    EXPECT_LE(worst_derivative, 1e-4) << name << " rate " << rate;
    EXPECT_LE(worst_angle, 0.1) << name << " rate " << rate;
}

/// Packed behind positions at any alignment, and in a buffer of their own: positions of the same bits, normals as near to
/// floats' as 16 bits are.
TEST_F(SurfaceEval, packed_normals_are_normals) {
    for (const TestMesh& mesh : some_shapes(40)) {
        const Surface s = surface_of(mesh);
        const GridTable grid = *build_grid_table(s.table, {.rate = 3});
        const DeviceGridTable device_grid = *upload_grid_table(device(), grid);
        const size_t count = grid.sample_count();
        auto evaluate = [&](const Buffer& out, const PointBuffer& values, const PointBuffer& normals, bool packed) {
            auto evaluation = evaluator_->prepare_grid({.patches = &s.device_table,
                                                        .grid = &device_grid,
                                                        .points = {.buffer = s.points.handle, .stride = 3},
                                                        .values = values,
                                                        .normals = normals,
                                                        .packed_normals = packed});
            EXPECT_TRUE(evaluation) << evaluation.error().message;
            run([&](VkCommandBuffer commands) { evaluation->record(commands); });
            return *download<float>(device(), out, out.size_bytes / 4);
        };
        const Buffer full = create_floats(6 * count);
        const auto expected = evaluate(full, {.buffer = full.handle, .stride = 6},
                                       {.buffer = full.handle, .first = 3, .stride = 6}, false);
        for (const auto& [first, stride] : {std::pair{0u, 4u}, {4u, 8u}, {1u, 4u}, {0u, 5u}}) {
            Buffer out = create_floats(first + stride * count);
            const auto written = evaluate(out, {.buffer = out.handle, .first = first, .stride = stride},
                                          {.buffer = out.handle, .first = first + 3, .stride = stride}, true);
            double worst = 0;
            for (size_t i = 0; i < count; ++i) {
                const float* at = written.data() + first + stride * i;
                for (size_t k = 0; k < 3; ++k) ASSERT_EQ(at[k], expected[6 * i + k]);
                for (size_t k = 4; k < stride; ++k) ASSERT_EQ(at[k], -7.5f);
                if (expected[6 * i] == -7.5f) continue;  // of a hole
                const auto n = unpack_normal(std::bit_cast<uint32_t>(at[3]));
                worst = std::max(worst, degrees_between(vector_at(n.data()), vector_at(expected.data() + 6 * i + 3)));
            }
            EXPECT_LT(worst, 0.005) << mesh.name;
            for (size_t i = 0; i < first; ++i) EXPECT_EQ(written[i], -7.5f);
        }
        const Buffer positions = create_floats(3 * count), normals = create_floats(count);
        const auto apart = evaluate(normals, {.buffer = positions.handle, .stride = 3},
                                    {.buffer = normals.handle, .stride = 1}, true);
        for (size_t i = 0; i < count; ++i) {
            if (expected[6 * i] == -7.5f) continue;
            const auto n = unpack_normal(std::bit_cast<uint32_t>(apart[i]));
            ASSERT_LT(degrees_between(vector_at(n.data()), vector_at(expected.data() + 6 * i + 3)), 0.005);
        }
    }
}

TEST_F(SurfaceEval, samples_equal_the_surface_in_double) {
    for (const TestMesh& mesh : some_shapes(9)) {
        const Surface s = surface_of(mesh);
        check_samples(s, scattered_samples(s.table), Derivatives::first, mesh.name);
    }
}

TEST_F(SurfaceEval, grids_equal_the_surface_in_double) {
    constexpr uint32_t rates[] = {1, 2, 5, 8};  // few: each needs pipelines of its own
    uint32_t next = 0;
    for (const TestMesh& mesh : some_shapes(9)) {
        const Surface s = surface_of(mesh);
        check_grid(s, rates[next++ % 4], mesh.name);
    }
}

TEST_F(SurfaceEval, random_meshes_equal_the_surface_in_double) {
    for (uint64_t seed = 0; seed < 60; ++seed) {
        const TestMesh mesh = limn::test::random_mesh(seed);
        const Surface s = surface_of(mesh);
        if (s.table.ptex_surfaces.empty()) continue;
        check_samples(s, scattered_samples(s.table), Derivatives::first, mesh.name);
        check_grid(s, 4, mesh.name);
    }
}

TEST_F(SurfaceEval, doo_sabin_equals_the_surface_in_double) {
    for (const TestMesh& mesh : limn::test::doo_sabin_shapes()) {
        const Surface s = surface_of(mesh);
        check_samples(s, scattered_samples(s.table), Derivatives::second, mesh.name);
        check_grid(s, 5, mesh.name);
    }
}

// The kernels that devices other than CPUs run.
TEST_F(SurfaceEval, storage_buffers_are_as_texel_buffers) {
    pretend_gpu();
    const SurfaceEvaluator own = *SurfaceEvaluator::create(device());
    evaluator_ = &own;
    for (const TestMesh& mesh : some_shapes(120)) {
        const Surface s = surface_of(mesh);
        check_samples(s, scattered_samples(s.table), Derivatives::second, mesh.name);
        check_grid(s, 5, mesh.name);
    }
}

// Rings of more points than a grid loads at once, and deep ones.
TEST_F(SurfaceEval, large_valences_equal_the_surface_in_double) {
    for (const TestMesh& mesh : {limn::test::make_quad_star(40, 2), limn::test::make_triangle_star(60, 2)}) {
        TestMesh loop = mesh;
        if (mesh.face_sizes[0] == 3) loop.options.scheme = Scheme::loop;
        const Surface s = surface_of(loop);
        EXPECT_GT(s.device_table.max_ring_size, 64u);
        check_samples(s, scattered_samples(s.table), Derivatives::first, "star");
        check_grid(s, 4, "star");
    }
}

// Far out coordinates are coarse, but what normals are made of are differences of them.
TEST_F(SurfaceEval, normals_far_from_the_origin) {
    TestMesh mesh = limn::test::make_prism(5);
    mesh.add_crease(mesh.face_vertices[0], mesh.face_vertices[1], 3.5);
    for (float& x : mesh.positions) x += 1000;
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    check_samples(s, scattered_samples(s.table), Derivatives::first, "far prism");
    check_grid(s, 8, "far prism");
}

// More points than 16 bits can number.
TEST_F(SurfaceEval, wide_rings) {
    const TestMesh mesh = limn::test::make_grid(270, 250);
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    ASSERT_FALSE(s.device_table.narrow_rings);
    std::vector<PatchSample> samples = scattered_samples(s.table);
    samples.erase(samples.begin(), samples.end() - 20000);
    check_samples(s, samples, Derivatives::first, "wide grid");
    check_grid(s, 1, "wide grid", 100000);
}

// A rate whose samples take several workgroups for each tile.
TEST_F(SurfaceEval, grids_of_many_samples) {
    const TestMesh mesh = limn::test::make_prism(5);
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    for (const uint32_t rate : {13u, 24u}) check_grid(s, rate, mesh.name);
}

TEST_F(SurfaceEval, gregory_end_caps_equal_those_in_double) {
    for (const TestMesh& mesh : {limn::test::make_cube(), limn::test::make_prism(5), [] {
                                     TestMesh loop = limn::test::make_icosahedron();
                                     loop.options.scheme = Scheme::loop;
                                     return loop;
                                 }()}) {
        const ControlMesh control = control_mesh(mesh);
        for (const EndCap end_cap : {EndCap::gregory, EndCap::gregory_opensubdiv}) {
            const PatchTableOptions options{.end_cap = end_cap, .isolation_level = 2};
            const Surface s = make_surface(*build_patch_table<float>(control, options),
                                           *build_patch_table<double>(control, options), mesh.positions, 3);
            check_samples(s, scattered_samples(s.table), Derivatives::first, mesh.name);
            check_grid(s, 5, mesh.name);
        }
    }
}

TEST_F(SurfaceEval, second_derivatives_equal_those_in_double) {
    const TestMesh mesh = limn::test::make_cube();
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    const std::vector<PatchSample> samples = {
        {0, 0.5, 0.5}, {1, 0.375, 0.625}, {2, 0.3125, 0.25}, {5, 0.75, 0.5}};
    const Samples device_samples = evaluate_on_device(s, samples, Derivatives::second);
    const HostSamples host = evaluate_on_host(s, samples, Derivatives::second);
    EXPECT_TRUE(points_match({host.values, 18}, {device_samples.values, 0, 18}, 2e-5 * s.size));
    std::vector<float> wrong = device_samples.values;
    wrong[40] += 1e-3f;
    EXPECT_FALSE(points_match({host.values, 18}, {wrong, 0, 18}, 2e-5 * s.size));
}

TEST_F(SurfaceEval, face_varying_and_varying_data) {
    size_t count = 0;
    for (const TestMesh& mesh : limn::test::face_varying_shapes()) {
        if (++count % 12 != 0) continue;
        const ControlMesh control = control_mesh(mesh);
        for (uint32_t channel = 0; channel < control.channels.size(); ++channel) {
            auto table = build_face_varying_patch_table<float>(control, channel, {});
            if (!table) {
                EXPECT_EQ(table.error().code, ErrorCode::unsupported) << mesh.name;
                continue;
            }
            const Surface s =
                make_surface(std::move(*table), *build_face_varying_patch_table<double>(control, channel, {}),
                             mesh.channels[channel].values, 2);
            check_samples(s, scattered_samples(s.table), Derivatives::none, mesh.name);
        }
        const PatchTableOptions varying{.interpolation = Interpolation::varying};
        const Surface s = make_surface(*build_patch_table<float>(control, varying),
                                       *build_patch_table<double>(control, varying), mesh.positions, 3);
        check_samples(s, scattered_samples(s.table), Derivatives::first, mesh.name);
        check_grid(s, 3, mesh.name);
    }
}

TEST_F(SurfaceEval, flags_every_sample_that_is_not_on_the_surface) {
    TestMesh mesh = limn::test::make_cube();
    mesh.holes = {2};
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    const double nan = std::nan(""), infinity = HUGE_VAL;
    const std::vector<PatchSample> samples = {
        {0, 0.5, 0.5}, {2, 0.5, 0.5},    {6, 0, 0},        {~0u, 0, 0}, {0, 1.01, 0},
        {0, 0, nan},   {0, infinity, 0}, {0, -0.001, 0.5}, {1, 1, 1},   {0, 1e-38, 0.0}};
    const Samples out = evaluate_on_device(s, samples, Derivatives::first);
    const std::vector<uint32_t> expected = {0, 1, 2, 2, 2, 2, 2, 2, 0, 0};
    EXPECT_EQ(out.statuses, expected);
    for (size_t i = 0; i < samples.size(); ++i)
        for (size_t k = 0; k < 9; ++k) {
            if (expected[i] != 0) {
                EXPECT_EQ(out.values[9 * i + k], 0.0f) << "sample " << i;
            }
            EXPECT_TRUE(std::isfinite(out.values[9 * i + k])) << "sample " << i;
        }
}

TEST_F(SurfaceEval, places_equal_those_on_the_host) {
    for (TestMesh mesh : {limn::test::make_prism(5), limn::test::make_icosahedron()}) {
        if (mesh.face_sizes[0] == 3) mesh.options.scheme = Scheme::loop;
        mesh.holes = {1};
        const ControlMesh control = control_mesh(mesh);
        const PatchTable table = *build_patch_table<float>(control, {});
        const DevicePatchTable device_table = *upload_patch_table(device(), table);
        std::vector<PatchSample> samples = scattered_samples(table);
        samples.push_back({~0u, 0, 0});
        const Buffer list = upload_samples(samples);
        Buffer places = create_floats(samples.size() * 5), statuses = create_floats(samples.size());
        const Result<SurfaceEvaluation> evaluation =
            evaluator_->prepare_locations({.patches = &device_table,
                                           .samples = {list.handle, 0, static_cast<uint32_t>(samples.size())},
                                           .places = {.buffer = places.handle, .stride = 5},
                                           .statuses = {.buffer = statuses.handle, .stride = 1}});
        ASSERT_TRUE(evaluation) << evaluation.error().message;
        run([&](VkCommandBuffer commands) { evaluation->record(commands); });
        const std::vector<uint32_t> out = *download<uint32_t>(device(), places, samples.size() * 5);
        const std::vector<uint32_t> device_statuses = *download<uint32_t>(device(), statuses, samples.size());
        std::vector<SurfacePlace> expected(samples.size());
        std::vector<SampleStatus> expected_statuses(samples.size());
        locate_patches(table, samples, expected, expected_statuses);
        for (size_t i = 0; i < samples.size(); ++i) {
            const SurfacePlace& place = expected[i];
            EXPECT_EQ(device_statuses[i], static_cast<uint32_t>(expected_statuses[i]));
            EXPECT_EQ(out[5 * i], place.surface) << i;
            EXPECT_EQ(out[5 * i + 1], place.plan) << i;
            EXPECT_EQ(out[5 * i + 2], place.node) << i;
            EXPECT_NEAR(std::bit_cast<float>(out[5 * i + 3]), place.u, 1e-3) << i;
            EXPECT_NEAR(std::bit_cast<float>(out[5 * i + 4]), place.v, 1e-3) << i;
        }
    }
}

TEST_F(SurfaceEval, two_runs_give_the_same_bits) {
    const TestMesh mesh = limn::test::make_prism(7);
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    const Samples one = evaluate_on_device(s, scattered_samples(s.table), Derivatives::second);
    const Samples two = evaluate_on_device(s, scattered_samples(s.table), Derivatives::second);
    EXPECT_EQ(std::memcmp(one.values.data(), two.values.data(), one.values.size() * 4), 0);
}

// Collapsed edges: the tangents vanish or are parallel, and a normal is wanted all the same.
TEST_F(SurfaceEval, normals_of_degenerate_surfaces_are_unit_vectors) {
    TestMesh mesh = limn::test::make_grid(5, 5);
    for (uint32_t row = 1; row < 4; ++row)  // three rows in one point
        for (uint32_t v = 0; v < 6; ++v)
            for (uint32_t k = 0; k < 3; ++k) mesh.positions[3 * (6 * row + v) + k] = 0.25f;
    TestMesh point = limn::test::make_cube();
    std::fill(point.positions.begin(), point.positions.end(), 1.0f);
    for (const TestMesh& degenerate : {mesh, point}) {
        const Surface s = surface_of(degenerate);
        const GridTable grid = *build_grid_table(s.table, {.rate = 4});
        const DeviceGridTable device_grid = *upload_grid_table(device(), grid);
        const size_t count = grid.sample_count();
        Buffer values = create_floats(count * 3), normals = create_floats(count * 3);
        const Result<SurfaceEvaluation> evaluation =
            evaluator_->prepare_grid({.patches = &s.device_table,
                                      .grid = &device_grid,
                                      .points = {.buffer = s.points.handle},
                                      .values = {.buffer = values.handle},
                                      .normals = {.buffer = normals.handle}});
        ASSERT_TRUE(evaluation);
        run([&](VkCommandBuffer commands) { evaluation->record(commands); });
        const std::vector<float> out = *download<float>(device(), normals, count * 3);
        for (size_t i = 0; i < count; ++i) EXPECT_NEAR(length(vector_at(out.data() + 3 * i)), 1, 1e-5);
    }
}

// Only what was asked for is written, wherever it is to go.
TEST_F(SurfaceEval, offsets_and_strides) {
    const TestMesh mesh = limn::test::make_cube();
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    const GridTable grid = *build_grid_table(s.table, {.rate = 2});
    const DeviceGridTable device_grid = *upload_grid_table(device(), grid);
    const size_t count = grid.sample_count();
    const HostSamples host =
        evaluate_on_host(s, list_grid_samples(Scheme::catmull_clark, grid.ptex_count, 2), Derivatives::none);
    for (const uint64_t first : {0u, 1u, 2u, 5u}) {
        for (const uint32_t stride : {6u, 7u, 8u}) {
            Buffer out = create_floats(first + 1 + count * stride);
            const Result<SurfaceEvaluation> evaluation = evaluator_->prepare_grid(
                {.patches = &s.device_table,
                 .grid = &device_grid,
                 .points = {.buffer = s.points.handle},
                 .values = {.buffer = out.handle, .offset_bytes = 4, .first = first, .stride = stride},
                 .normals = {.buffer = out.handle, .offset_bytes = 4, .first = first + 3, .stride = stride}});
            ASSERT_TRUE(evaluation) << evaluation.error().message;
            run([&](VkCommandBuffer commands) { evaluation->record(commands); });
            const std::vector<float> written = *download<float>(device(), out, first + 1 + count * stride);
            EXPECT_TRUE(points_match({host.values, 3}, {written, first + 1, stride}, 2e-6 * s.size));
            for (size_t i = 0; i <= first; ++i) EXPECT_EQ(written[i], -7.5f);
            for (size_t i = 0; i < count; ++i)
                for (size_t k = 6; k < stride; ++k) EXPECT_EQ(written[first + 1 + i * stride + k], -7.5f);
        }
    }
}

TEST_F(SurfaceEval, refuses_what_it_cannot_do) {
    const TestMesh mesh = limn::test::make_cube();
    const ControlMesh control = control_mesh(mesh);
    const Surface s = make_surface(*build_patch_table<float>(control, {}),
                                   *build_patch_table<double>(control, {}), mesh.positions, 3);
    const DeviceGridTable grid =
        *upload_grid_table(device(), *build_grid_table(s.table, {.derivatives = false}));
    const PointBuffer points{.buffer = s.points.handle};
    auto code = [](const auto& result) { return result ? ErrorCode::unsupported : result.error().code; };
    constexpr ErrorCode kInvalid = ErrorCode::invalid_argument;
    EXPECT_EQ(code(evaluator_->prepare_points({})), kInvalid);
    EXPECT_EQ(code(evaluator_->prepare_grid({})), kInvalid);
    EXPECT_EQ(code(evaluator_->prepare_samples({})), kInvalid);
    EXPECT_EQ(code(evaluator_->prepare_locations({})), kInvalid);
    GridEvaluationInfo info{.patches = &s.device_table, .grid = &grid, .points = points, .values = points};
    info.normals = points;  // the grid has no derivatives
    EXPECT_EQ(code(evaluator_->prepare_grid(info)), kInvalid);
    info.normals = {};
    info.packed_normals = true;  // of none
    EXPECT_EQ(code(evaluator_->prepare_grid(info)), kInvalid);
    info.packed_normals = false;
    info.du = points;  // and dv is missing
    EXPECT_EQ(code(evaluator_->prepare_grid(info)), kInvalid);
    info.du = {};
    info.width = 5;
    EXPECT_EQ(code(evaluator_->prepare_grid(info)), kInvalid);
    for (const uint32_t rate : {0u, 257u}) {
        const auto refused = build_grid_table(s.table, {.rate = rate});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, kInvalid);
    }
    const auto large = build_grid_table(s.table, {.rate = 64, .max_weight_bytes = 1000});
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, ErrorCode::too_large);
}

}  // namespace
}  // namespace limn::vk::test
