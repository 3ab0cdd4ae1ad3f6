// Curvatures on the device: the kernel against the same formula in double, and all the way from control
// points.
#include "limn/schemes/spline_mesh.h"
#include "limn/vulkan/curvature.h"
#include "schemes/rational_sphere.h"
#include "vulkan/surface_fixture.h"

namespace limn::vk::test {
namespace {

constexpr uint32_t kFloats = shared::kCurvatureFloats;

class CurvatureEval : public SurfaceTest {
  protected:
    void SetUp() override {
        SurfaceTest::SetUp();
        if (HasFatalFailure()) return;
        auto created = CurvatureEvaluator::create(device());
        ASSERT_TRUE(created);
        curvature_.emplace(std::move(*created));
    }

    struct Results {
        std::vector<float> curvatures, quotients;
    };
    /// Of records `stride` floats apart, behind `first` others.
    Results run_kernel(const std::vector<float>& values, uint32_t count, uint32_t width, uint32_t stride,
                       uint32_t first, bool quotients) {
        const Buffer source = *create_buffer(device(), 4 * values.size(), kPointUsage, MemoryUse::device);
        EXPECT_TRUE(upload_bytes(device(), source, 0, std::as_bytes(std::span(values))));
        const Buffer out = create_floats(size_t{count} * (kFloats + 3) + 5),
                     divided = create_floats(size_t{count} * 19);
        const auto evaluation = curvature_->prepare(
            {.sample_count = count,
             .width = width,
             .values = {.buffer = source.handle, .first = first, .stride = stride},
             .curvatures = {.buffer = out.handle, .offset_bytes = 4, .first = 2, .stride = kFloats + 3},
             .quotients = {.buffer = quotients ? divided.handle : VK_NULL_HANDLE, .stride = 19}});
        EXPECT_TRUE(evaluation) << evaluation.error().message;
        run([&](VkCommandBuffer commands) { evaluation->record(commands); });
        return {*download<float>(device(), out, size_t{count} * (kFloats + 3) + 5),
                *download<float>(device(), divided, size_t{count} * 19)};
    }

    /// Those of a rational surface's mesh, by the kernel of all stencils.
    std::vector<float> vertices_of(const SplineMesh& mesh, const BSplineSurface& surface) {
        const Result<Evaluator> evaluator = Evaluator::create(device());
        const Result<DeviceStencilTable> table = upload_stencil_table(device(), round_weights(mesh.vertices));
        EXPECT_TRUE(evaluator && table);
        const std::vector<float> control(surface.points.begin(), surface.points.end());
        const Buffer source = create_floats(control.size()),
                     out = create_floats(size_t{table->row_count} * 4);
        EXPECT_TRUE(upload_bytes(device(), source, 0, std::as_bytes(std::span(control))));
        const auto evaluation = evaluator->prepare({.table = &*table,
                                                    .width = 4,
                                                    .source = {.buffer = source.handle, .stride = 4},
                                                    .destination = {.buffer = out.handle, .stride = 4}});
        EXPECT_TRUE(evaluation);
        run([&](VkCommandBuffer commands) { evaluation->record(commands); });
        return *download<float>(device(), out, size_t{table->row_count} * 4);
    }

    std::optional<CurvatureEvaluator> curvature_;
};

/// As far apart as numbers may be that come of rounding: relative to the largest curvature, and for
/// directions to how far apart the two are.
void compare(const Curvature& c, const float* device, double tolerance) {
    const double scale = std::max({std::abs(c.first), std::abs(c.second), 1e-30});
    EXPECT_NEAR(device[0], c.gaussian, tolerance * scale * scale);
    EXPECT_NEAR(device[1], c.mean, tolerance * scale);
    EXPECT_NEAR(device[2], c.first, tolerance * scale);
    EXPECT_NEAR(device[3], c.second, tolerance * scale);
    const double apart = (c.first - c.second) / scale;
    if (apart < 1e-2) return;
    for (const double* direction : {c.first_direction, c.second_direction}) {
        const float* other = device + (direction == c.first_direction ? 4 : 7);
        const double sign =
            direction[0] * other[0] + direction[1] * other[1] + direction[2] * other[2] < 0 ? -1 : 1;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(sign * other[k], direction[k], tolerance / apart);
    }
}

/// Six values of a surface of any size, du and dv far from parallel; of width 4 with a weight, and
/// derivatives of it.
std::vector<float> random_values(uint32_t width, limn::test::RandomNumbers& random) {
    const double scale = std::exp2(random.uniform(-20, 20));
    std::vector<float> values;
    for (uint32_t k = 0; k < 6; ++k)
        for (uint32_t c = 0; c < width; ++c) {
            const bool along = (k == 1 && c == 0) || (k == 2 && c == 1);
            const double x = (along ? 2 : 0) + 0.4 * random.uniform(-1, 1);
            const double weight = (k == 0 ? 1.5 : 0) + 0.2 * random.uniform(-1, 1);
            values.push_back(static_cast<float>(c == 3 ? weight : scale * x));
        }
    return values;
}

TEST_F(CurvatureEval, kernel_equals_the_formula_in_double) {
    limn::test::RandomNumbers random(1);
    for (const uint32_t width : {3u, 4u}) {
        constexpr uint32_t kCount = 1000;
        const uint32_t stride = 6 * width + 1, first = 3;
        std::vector<float> values(first);
        std::vector<double> exact;
        for (uint32_t s = 0; s < kCount; ++s) {
            const std::vector<float> record = random_values(width, random);
            values.insert(values.end(), record.begin(), record.end());
            values.push_back(0);
            exact.insert(exact.end(), record.begin(), record.end());
        }
        std::vector<Curvature> truth(kCount);
        evaluate_curvature(exact, width, truth);
        const Results results = run_kernel(values, kCount, width, stride, first, width == 4);
        for (uint32_t s = 0; s < kCount; ++s) {
            const float* record = results.curvatures.data() + 3 + size_t{s} * (kFloats + 3);
            compare(truth[s], record, 1e-5);
            for (uint32_t k = 0; k < 3; ++k) EXPECT_EQ(record[kFloats + k], -7.5f);  // between records
            if (width == 3) continue;
            const std::span six = std::span(exact).subspan(size_t{s} * 24, 24);
            double quotients[18], largest = 0;
            limn::divide_surface_by_weight(six, 4, quotients);
            for (const double q : quotients) largest = std::max(largest, std::abs(q));
            for (uint32_t k = 0; k < 18; ++k)
                EXPECT_NEAR(results.quotients[size_t{s} * 19 + k], quotients[k], 1e-6 * largest);
            EXPECT_EQ(results.quotients[size_t{s} * 19 + 18], -7.5f);
        }
        // The comparison sees a difference.
        EXPECT_GT(std::abs(double{results.curvatures[4]} - truth[1].mean), 1e-3 * std::abs(truth[1].mean));
    }
}

TEST_F(CurvatureEval, of_surfaces_from_control_points) {
    TestMesh loop = limn::test::make_icosahedron();
    loop.options.scheme = Scheme::loop;
    for (const TestMesh& mesh : {limn::test::make_cube(), limn::test::make_prism(5), loop}) {
        const Surface s = surface_of(mesh);
        std::vector<PatchSample> samples;
        limn::test::RandomNumbers random(2);
        for (uint32_t f = 0; f < s.table.ptex_surfaces.size(); ++f)
            for (int i = 0; i < 40; ++i) {
                const double u = random.uniform(0.1, 0.45), v = random.uniform(0.1, 0.45);
                samples.push_back({f, static_cast<float>(u), static_cast<float>(v)});
            }
        const auto count = static_cast<uint32_t>(samples.size());
        const HostSamples host = evaluate_on_host(s, samples, Derivatives::second);
        std::vector<Curvature> truth(count);
        evaluate_curvature(host.values, 3, truth);
        const Buffer list = upload_samples(samples), values = create_floats(size_t{count} * 18),
                     out = create_floats(size_t{count} * kFloats);
        const auto derivatives =
            evaluator_->prepare_samples({.patches = &s.device_table,
                                         .derivatives = Derivatives::second,
                                         .points = {.buffer = s.points.handle},
                                         .samples = {list.handle, 0, count},
                                         .results = {.buffer = values.handle, .stride = 18}});
        const auto curvature = curvature_->prepare({.sample_count = count,
                                                    .values = {.buffer = values.handle, .stride = 18},
                                                    .curvatures = {.buffer = out.handle, .stride = kFloats}});
        ASSERT_TRUE(derivatives && curvature);
        run([&](VkCommandBuffer commands) {
            derivatives->record(commands);
            record_barrier(device(), commands, kKernelWrites, kKernelReads);
            curvature->record(commands);
        });
        const std::vector<float> results = *download<float>(device(), out, size_t{count} * kFloats);
        for (uint32_t i = 0; i < count; ++i) compare(truth[i], results.data() + size_t{i} * kFloats, 2e-4);
    }
}

// A NURBS surface, all on the device: vertices of its mesh from its control points, limit, division,
// curvature.
TEST_F(CurvatureEval, of_a_rational_sphere) {
    const std::vector<BSplineSurface> parts = split_at_full_knots(limn::test::make_sphere());
    for (const BSplineSurface& part : parts) {
        const auto mesh = build_spline_mesh(part);
        ASSERT_TRUE(mesh);
        const auto control = ControlMesh::create(mesh->description());
        ASSERT_TRUE(control);
        const std::vector<float> vertices = vertices_of(*mesh, part);
        const Surface s = make_surface(*build_patch_table<float>(*control, {}),
                                       *build_patch_table<double>(*control, {}), vertices, 4);
        std::vector<PatchSample> samples;
        for (int i = 0; i < 100; ++i) samples.push_back({4, 0.05 + i % 10 / 11.0, 0.05 + i / 10 / 11.0});
        const Samples values = evaluate_on_device(s, samples, Derivatives::second);
        const Results results = run_kernel(values.values, 100, 4, 24, 0, true);
        for (size_t i = 0; i < samples.size(); ++i) {
            const float *record = results.curvatures.data() + 3 + i * (kFloats + 3),
                        *p = results.quotients.data() + i * 19;
            EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), 1, 2e-6);
            for (int k = 0; k < 4; ++k) EXPECT_NEAR(record[k], 1, 1e-3);
        }
    }
}

TEST_F(CurvatureEval, takes_more_than_the_device_binds_and_refuses_what_makes_no_sense) {
    pretend_gpu(64 * 1024);
    auto created = CurvatureEvaluator::create(device());
    ASSERT_TRUE(created);
    curvature_.emplace(std::move(*created));
    constexpr uint32_t kCount = 2000;  // 144,000 bytes of values
    std::vector<float> values(size_t{kCount} * 18);
    for (uint32_t s = 0; s < kCount; ++s) {  // cylinders of radius s + 1
        float* v = values.data() + size_t{s} * 18;
        v[3] = v[7] = 1;
        v[11] = -1.0f / static_cast<float>(s + 1);
    }
    const Results results = run_kernel(values, kCount, 3, 18, 0, false);
    for (uint32_t s = 0; s < kCount; ++s)
        EXPECT_NEAR(results.curvatures[3 + size_t{s} * (kFloats + 3) + 2] * static_cast<float>(s + 1), 1,
                    1e-5);

    const Buffer buffer = create_floats(1000), other = create_floats(1000);
    const CurvatureInfo good = {.sample_count = 4,
                                .values = {.buffer = buffer.handle, .stride = 18},
                                .curvatures = {.buffer = other.handle, .stride = kFloats}};
    const auto refused = [&](auto change) {
        CurvatureInfo info = good;
        change(info);
        const auto evaluation = curvature_->prepare(info);
        return !evaluation && evaluation.error().code == ErrorCode::invalid_argument;
    };
    EXPECT_TRUE(curvature_->prepare(good));
    EXPECT_TRUE(refused([](CurvatureInfo& info) { info.width = 2; }));
    EXPECT_TRUE(refused([](CurvatureInfo& info) { info.values.buffer = VK_NULL_HANDLE; }));
    EXPECT_TRUE(refused([](CurvatureInfo& info) { info.values.stride = 17; }));
    EXPECT_TRUE(refused([](CurvatureInfo& info) { info.curvatures.stride = 9; }));
    EXPECT_TRUE(refused(
        [&](CurvatureInfo& info) { info.quotients = {.buffer = other.handle, .first = 200, .stride = 18}; }));
    CurvatureInfo none = good;
    none.sample_count = 0;
    EXPECT_TRUE(curvature_->prepare(none));
}

}  // namespace
}  // namespace limn::vk::test
