// Samples by patch trees on the device against the same surface in double, as surface_eval_test.cpp has them without.
#include "vulkan/surface_fixture.h"

namespace limn::vk::test {
namespace {

class TreeEval : public SurfaceTest {
  protected:
    TreeEval() { tree_rate_ = 8; }
};

TestMesh as_loop(TestMesh mesh) {
    if (mesh.face_sizes[0] == 3) mesh.options.scheme = Scheme::loop;
    return mesh;
}

TEST_F(TreeEval, samples_equal_the_surface_in_double) {
    for (const TestMesh& mesh : some_shapes(27)) {
        const Surface s = surface_of(mesh);
        check_samples(s, scattered_samples(s.table), Derivatives::first, mesh.name);
    }
}

TEST_F(TreeEval, random_meshes_equal_the_surface_in_double) {
    for (uint64_t seed = 0; seed < 24; ++seed) {
        const TestMesh mesh = limn::test::random_mesh(seed);
        const Surface s = surface_of(mesh);
        if (s.table.ptex_surfaces.empty()) continue;
        tree_rate_ = seed % 2 == 0 ? 8 : 64;
        check_samples(s, scattered_samples(s.table), seed % 3 == 0 ? Derivatives::second : Derivatives::first, mesh.name);
    }
}

TEST_F(TreeEval, doo_sabin_equals_the_surface_in_double) {
    for (const TestMesh& mesh : limn::test::doo_sabin_shapes()) {
        const Surface s = surface_of(mesh);
        check_samples(s, scattered_samples(s.table), Derivatives::first, mesh.name);
    }
}

// The kernels that devices other than CPUs run, on windows of the samples.
TEST_F(TreeEval, storage_buffers_are_as_texel_buffers) {
    pretend_gpu(1 << 20);
    const SurfaceEvaluator own = *SurfaceEvaluator::create(device());
    evaluator_ = &own;
    for (const TestMesh& mesh : some_shapes(360)) {
        const Surface s = surface_of(mesh);
        check_samples(s, scattered_samples(s.table), Derivatives::second, mesh.name);
    }
}

// More samples than a device binds at once: each window has a list of its own of samples next to irregular vertices.
TEST_F(TreeEval, windows) {
    pretend_gpu(200'000);
    const SurfaceEvaluator own = *SurfaceEvaluator::create(device());
    evaluator_ = &own;
    const Surface s = surface_of(limn::test::make_prism(5));
    const std::vector<PatchSample> some = scattered_samples(s.table);
    std::vector<PatchSample> samples;
    while (samples.size() < 12'000) samples.insert(samples.end(), some.begin(), some.end());
    check_samples(s, samples, Derivatives::first, "windows");
}

// Where trees end, and beyond: all samples are left to the general evaluation.
TEST_F(TreeEval, places_at_irregular_vertices) {
    for (const TestMesh& mesh : {limn::test::make_cube(), as_loop(limn::test::make_icosahedron())}) {
        const Surface s = surface_of(mesh);
        std::vector<PatchSample> samples;
        for (uint32_t f = 0; f < s.table.ptex_surfaces.size(); ++f)
            for (const double x : {0.0, 0x1p-5, 0x1p-9, 0x1p-20, 0x1p-60})
                for (const double y : {0.0, 0x1p-6, 0x1p-15}) samples.push_back({f, x, y});
        check_samples(s, samples, Derivatives::first, mesh.name);
    }
}

TEST_F(TreeEval, large_valences_equal_the_surface_in_double) {
    for (const TestMesh& mesh : {limn::test::make_quad_star(40, 2), as_loop(limn::test::make_triangle_star(60, 2))}) {
        const Surface s = surface_of(mesh);
        EXPECT_GT(s.device_table.max_ring_size, 64u);
        check_samples(s, scattered_samples(s.table), Derivatives::first, "star");
    }
}

// Far out coordinates are coarse, but what normals are made of are differences of them.
TEST_F(TreeEval, normals_far_from_the_origin) {
    TestMesh mesh = limn::test::make_prism(5);
    mesh.add_crease(mesh.face_vertices[0], mesh.face_vertices[1], 3.5);
    for (float& x : mesh.positions) x += 1000;
    const Surface s = surface_of(mesh);
    check_samples(s, scattered_samples(s.table), Derivatives::first, "far prism");
}

TEST_F(TreeEval, second_derivatives_equal_those_in_double) {
    for (TestMesh mesh : {limn::test::make_cube(), as_loop(limn::test::make_icosahedron())}) {
        mesh.add_crease(mesh.face_vertices[0], mesh.face_vertices[1], 1.5);
        const Surface s = surface_of(mesh);
        std::vector<PatchSample> samples;
        for (uint32_t f = 0; f < s.table.ptex_surfaces.size(); ++f)
            for (const auto& [u, v] : {std::pair{0.5, 0.5}, {0.375, 0.625}, {0.3125, 0.25}, {0.25, 0.5}})
                samples.push_back({f, u, v});
        const HostSamples host = evaluate_on_host(s, samples, Derivatives::second);
        Samples out = evaluate_on_device(s, samples, Derivatives::second);
        EXPECT_TRUE(points_match({host.values, 18}, {out.values, 0, 18}, 1e-4 * s.size)) << mesh.name;
        out.values[40] += 1e-2f;
        EXPECT_FALSE(points_match({host.values, 18}, {out.values, 0, 18}, 1e-4 * s.size)) << mesh.name;
    }
}

TEST_F(TreeEval, face_varying_and_varying_data) {
    size_t count = 0;
    for (const TestMesh& mesh : limn::test::face_varying_shapes()) {
        if (++count % 48 != 0) continue;
        const ControlMesh control = control_mesh(mesh);
        for (uint32_t channel = 0; channel < control.channels.size(); ++channel) {
            auto table = build_face_varying_patch_table<float>(control, channel, {});
            if (!table) continue;  // not all can be had
            const Surface s = make_surface(std::move(*table), *build_face_varying_patch_table<double>(control, channel, {}),
                                           mesh.channels[channel].values, 2);
            check_samples(s, scattered_samples(s.table), Derivatives::none, mesh.name);
        }
        const PatchTableOptions varying{.interpolation = Interpolation::varying};
        const Surface s = make_surface(*build_patch_table<float>(control, varying),
                                       *build_patch_table<double>(control, varying), mesh.positions, 3);
        check_samples(s, scattered_samples(s.table), Derivatives::first, mesh.name);
    }
}

TEST_F(TreeEval, flags_every_sample_that_is_not_on_the_surface) {
    TestMesh mesh = limn::test::make_cube();
    mesh.holes = {2};
    const Surface s = surface_of(mesh);
    const double nan = std::nan("");
    const std::vector<PatchSample> samples = {{0, 0.5, 0.5},  {2, 0.5, 0.5}, {6, 0, 0}, {~0u, 0, 0},   {0, 1.01, 0},
                                              {0, 0, nan},    {2, 0, 0},     {0, 0, 0}, {0, -0.001, 0}, {1, 1, 1}};
    const Samples out = evaluate_on_device(s, samples, Derivatives::first);
    const std::vector<uint32_t> expected = {0, 1, 2, 2, 2, 2, 1, 0, 2, 0};
    EXPECT_EQ(out.statuses, expected);
    for (size_t i = 0; i < samples.size(); ++i) {
        const bool zero = std::all_of(&out.values[9 * i], &out.values[9 * i] + 9, [](float x) { return x == 0; });
        EXPECT_EQ(zero, expected[i] != 0) << "sample " << i;
    }
}

// The same samples in another order, twice by the same evaluation: what is left to the general one comes in any order.
TEST_F(TreeEval, bits_do_not_depend_on_the_order) {
    const Surface s = surface_of(limn::test::make_prism(7));
    std::vector<PatchSample> samples = scattered_samples(s.table);
    const Samples one = evaluate_on_device(s, samples, Derivatives::second);
    std::reverse(samples.begin(), samples.end());
    const Samples two = evaluate_on_device(s, samples, Derivatives::second);
    for (size_t i = 0; i < samples.size(); ++i)
        ASSERT_EQ(std::memcmp(&one.values[18 * i], &two.values[18 * (samples.size() - 1 - i)], 72), 0) << i;
}

// An evaluation follows the points however often it is recorded, and writes no more than its records.
TEST_F(TreeEval, is_recorded_again_for_other_points) {
    const Surface s = surface_of(limn::test::make_prism(5));
    const std::vector<PatchSample> samples = scattered_samples(s.table);
    const Buffer list = upload_samples(samples);
    const auto count = static_cast<uint32_t>(samples.size());
    const HostSamples host = evaluate_on_host(s, samples, Derivatives::first);
    const Trees trees = make_trees(s);
    const PointBuffer points{.buffer = s.points.handle};
    const auto local = evaluator_->prepare_local_points(
        {.patches = &s.device_table, .trees = &trees.table, .points = points, .local_points = trees.local.handle});
    ASSERT_TRUE(local);
    for (const uint32_t stride : {9u, 10u, 12u}) {
        Buffer out = create_floats(3 + size_t{count} * stride);
        const auto evaluation = evaluator_->prepare_samples(
            {.patches = &s.device_table,
             .points = points,
             .samples = {list.handle, 0, count},
             .results = {.buffer = out.handle, .offset_bytes = stride == 12 ? 12u : 8u, .stride = stride},
             .trees = &trees.table,
             .local_points = trees.local.handle});
        ASSERT_TRUE(evaluation) << evaluation.error().message;
        EXPECT_EQ(evaluation->dispatch_count(), 2u);
        const size_t first = stride == 12 ? 3 : 2;
        for (const double scale : {1.0, 2.0}) {
            std::vector<float> moved(s.reference_points.begin(), s.reference_points.end());
            for (float& x : moved) x *= static_cast<float>(scale);
            EXPECT_TRUE(upload_bytes(device(), s.points, 0, std::as_bytes(std::span(moved))));
            run([&](VkCommandBuffer commands) {
                local->record(commands);
                record_barrier(device(), commands, kKernelWrites, kKernelReads);
                evaluation->record(commands);
                evaluation->record(commands);
            });
            const std::vector<float> written = *download<float>(device(), out, first + size_t{count} * stride);
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t k = 0; k < stride; ++k) {
                    const float value = written[first + size_t{i} * stride + k];
                    if (k >= 3 && k < 9) continue;
                    const double expected = k < 3 ? scale * host.values[9 * size_t{i} + k] : -7.5;
                    EXPECT_NEAR(value, expected, k < 3 ? 2e-5 * s.size : 0) << i;
                }
        }
    }
}

TEST_F(TreeEval, refuses_what_it_cannot_do) {
    const Surface s = surface_of(limn::test::make_cube()), other = surface_of(limn::test::make_prism(5));
    const Trees trees = make_trees(s);
    const PatchTreeTable absolute = *build_patch_trees(s.table, {.max_rate = 8});
    const DevicePatchTrees no_samples = *upload_patch_trees(device(), absolute);
    const PointBuffer points{.buffer = s.points.handle};
    PatchEvaluationInfo info{.patches = &s.device_table,
                             .points = points,
                             .samples = {s.points.handle, 0, 1},
                             .results = {.buffer = trees.local.handle, .stride = 9},
                             .trees = &trees.table,
                             .local_points = trees.local.handle};
    const auto code = [&] {
        const auto result = evaluator_->prepare_samples(info);
        return result ? ErrorCode::unsupported : result.error().code;
    };
    EXPECT_TRUE(evaluator_->prepare_samples(info));
    info.local_points = VK_NULL_HANDLE;
    EXPECT_EQ(code(), ErrorCode::invalid_argument);
    info.local_points = trees.local.handle;
    info.trees = nullptr;
    EXPECT_EQ(code(), ErrorCode::invalid_argument);
    info.trees = &no_samples;
    EXPECT_EQ(code(), ErrorCode::invalid_argument);
    info.trees = &trees.table;
    info.patches = &other.device_table;
    EXPECT_EQ(code(), ErrorCode::invalid_argument);
    const auto local = evaluator_->prepare_local_points({.patches = &s.device_table, .trees = &trees.table, .points = points});
    ASSERT_FALSE(local);
    EXPECT_EQ(local.error().code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace limn::vk::test
