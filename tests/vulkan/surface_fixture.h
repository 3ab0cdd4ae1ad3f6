// What tests of surfaces on the device share: a surface on both sides, and the same samples evaluated on both.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <numbers>

#include "limn/vulkan/surface_evaluator.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk::test {

using limn::test::TestMesh;

/// A surface on the device, and in double on the host.
struct Surface {
    PatchTable table;
    PatchTableDouble reference;
    DevicePatchTable device_table;
    Buffer points;
    std::vector<double> reference_points;
    uint32_t width;
    double size, tolerance;
};

inline ControlMesh control_mesh(const TestMesh& mesh) {
    auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control) << mesh.name;
    return std::move(control).value();
}

class SurfaceTest : public VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        if (HasFatalFailure()) return;
        static const SurfaceEvaluator* const shared = [this] {
            Result<SurfaceEvaluator> created = SurfaceEvaluator::create(device());
            return created ? new SurfaceEvaluator(std::move(*created))
                           : nullptr;  // outlives the tests, as the device does
        }();
        evaluator_ = shared;
        ASSERT_NE(evaluator_, nullptr);
    }

    /// Uploads a table and makes its level-1 points on the device.
    Surface make_surface(PatchTable table, PatchTableDouble reference, const std::vector<float>& control,
                         uint32_t width) {
        Surface s{std::move(table),        std::move(reference),        {}, {}, {}, width,
                  size_of(control, width), tolerance_of(control, width)};
        s.device_table = *upload_patch_table(device(), s.table);
        s.points = *create_buffer(device(), VkDeviceSize{4} * width * s.table.point_count(), kPointUsage,
                                  MemoryUse::device);
        EXPECT_TRUE(
            upload_bytes(device(), s.points, 0,
                         std::as_bytes(std::span(control).first(size_t{s.table.control_count} * width))));
        Result<StencilEvaluation> refined =
            evaluator_->prepare_points({.patches = &s.device_table,
                                        .width = width,
                                        .points = {.buffer = s.points.handle, .stride = width}});
        EXPECT_TRUE(refined);
        run([&](VkCommandBuffer commands) { refined->record(commands); });
        s.reference_points.resize(size_t{s.reference.point_count()} * width);
        build_patch_points<double>(s.reference, std::vector<double>(control.begin(), control.end()), width,
                                   s.reference_points);
        return s;
    }

    Surface surface_of(const TestMesh& mesh) {
        const ControlMesh control = control_mesh(mesh);
        return make_surface(*build_patch_table<float>(control, {}), *build_patch_table<double>(control, {}),
                            mesh.positions, 3);
    }

    Buffer create_floats(size_t count) {
        Buffer buffer =
            *create_buffer(device(), std::max<size_t>(4, 4 * count), kPointUsage, MemoryUse::device);
        const std::vector<float> filled(count, -7.5f);
        EXPECT_TRUE(upload_bytes(device(), buffer, 0, std::as_bytes(std::span(filled))));
        return buffer;
    }

    Buffer upload_samples(const std::vector<PatchSample>& samples) {
        std::vector<uint32_t> words;
        for (const PatchSample& sample : samples)
            words.insert(words.end(), {sample.face, std::bit_cast<uint32_t>(static_cast<float>(sample.u)),
                                       std::bit_cast<uint32_t>(static_cast<float>(sample.v))});
        Buffer list = *create_buffer(device(), 4 * words.size(), kPointUsage, MemoryUse::device);
        EXPECT_TRUE(upload_bytes(device(), list, 0, std::as_bytes(std::span(words))));
        return list;
    }

    /// Patch trees, and their local points as of the surface's points.
    struct Trees {
        DevicePatchTrees table;
        Buffer local;
    };
    Trees make_trees(const Surface& s) {
        const PatchTreeTable trees = *build_patch_trees(s.table, {.max_rate = tree_rate_, .relative = true});
        Trees out = {*upload_patch_trees(device(), trees), create_floats(std::max<size_t>(4, size_t{4} * trees.local_count()))};
        const Result<SurfaceEvaluation> points =
            evaluator_->prepare_local_points({.patches = &s.device_table,
                                              .trees = &out.table,
                                              .width = s.width,
                                              .points = {.buffer = s.points.handle, .stride = s.width},
                                              .local_points = out.local.handle});
        EXPECT_TRUE(points) << points.error().message;
        run([&](VkCommandBuffer commands) { points->record(commands); });
        return out;
    }

    struct Samples {
        std::vector<float> values;
        std::vector<uint32_t> statuses;
    };
    Samples evaluate_on_device(const Surface& s, const std::vector<PatchSample>& samples,
                               Derivatives derivatives) {
        const Buffer list = upload_samples(samples);
        const uint32_t record = value_count(derivatives) * s.width;
        Buffer results = create_floats(samples.size() * record), statuses = create_floats(samples.size());
        const Trees trees = tree_rate_ != 0 ? make_trees(s) : Trees{};
        Result<SurfaceEvaluation> evaluation =
            evaluator_->prepare_samples({.patches = &s.device_table,
                                         .derivatives = derivatives,
                                         .width = s.width,
                                         .points = {.buffer = s.points.handle, .stride = s.width},
                                         .samples = {list.handle, 0, static_cast<uint32_t>(samples.size())},
                                         .results = {.buffer = results.handle, .stride = record},
                                         .statuses = {.buffer = statuses.handle, .stride = 1},
                                         .trees = tree_rate_ != 0 ? &trees.table : nullptr,
                                         .local_points = trees.local.handle});
        EXPECT_TRUE(evaluation) << evaluation.error().message;
        run([&](VkCommandBuffer commands) { evaluation->record(commands); });
        return {*download<float>(device(), results, samples.size() * record),
                *download<uint32_t>(device(), statuses, samples.size())};
    }

    void check_samples(const Surface& s, const std::vector<PatchSample>& samples, Derivatives derivatives,
                       const std::string& name);

    const SurfaceEvaluator* evaluator_ = nullptr;
    uint32_t tree_rate_ = 0;  ///< samples are evaluated with patch trees of this max_rate, or without any
};

struct HostSamples {
    std::vector<double> values;
    std::vector<SampleStatus> statuses;
};
inline HostSamples evaluate_on_host(const Surface& s, const std::vector<PatchSample>& samples,
                             Derivatives derivatives) {
    HostSamples out;
    out.values.resize(samples.size() * value_count(derivatives) * s.width);
    out.statuses.resize(samples.size());
    evaluate_patches<double>(s.reference, samples, s.reference_points, s.width, derivatives, out.values,
                             out.statuses);
    return out;
}

struct Vector {
    double x, y, z;
};
template <class T>
Vector vector_at(const T* v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}
inline Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double length(const Vector& a) {
    return std::sqrt(dot(a, a));
}
inline double degrees_between(const Vector& a, const Vector& b) {
    return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}
/// Below this sine of the angle between tangents a normal says nothing.
inline constexpr double kDegenerate = 1e-3;
/// Shorter tangents, in sizes of the mesh, are lost in the rounding of positions.
inline constexpr double kShort = 1e-4;

/// Places of every face, some of them next to its corners, exact in float.
inline std::vector<PatchSample> scattered_samples(const PatchTable& table) {
    limn::test::RandomNumbers random(11);
    const bool triangles = table.options.scheme == Scheme::loop;
    std::vector<PatchSample> samples;
    for (uint32_t f = 0; f < table.ptex_surfaces.size(); ++f) {
        for (uint32_t i = 0; i < 7; ++i) {
            double u = random.uniform(0, 1), v = random.uniform(0, 1);
            if (triangles && u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            const double scale = i < 3 ? 1 : std::exp2(-3.0 * (i - 2));
            u = static_cast<float>(u * scale);
            v = static_cast<float>(v * scale);
            // Towards another corner.
            if (!triangles && i == 4) u = 1 - u;
            samples.push_back({f, u, v});
        }
        samples.push_back({f, 0, 0});
        samples.push_back({f, 1, 0});
        samples.push_back({f, 0, 1});
    }
    return samples;
}

inline void SurfaceTest::check_samples(const Surface& s, const std::vector<PatchSample>& samples,
                                Derivatives derivatives, const std::string& name) {
    const Samples device_samples = evaluate_on_device(s, samples, derivatives);
    const HostSamples host = evaluate_on_host(s, samples, derivatives);
    const uint32_t record = value_count(derivatives) * s.width;
    double worst = 0, worst_angle = 0, worst_derivative = 0;
    for (size_t i = 0; i < samples.size(); ++i) {
        ASSERT_EQ(device_samples.statuses[i], static_cast<uint32_t>(host.statuses[i]))
            << name << " sample " << i;
        const float* a = device_samples.values.data() + i * record;
        const double* b = host.values.data() + i * record;
        for (uint32_t k = 0; k < s.width; ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
        if (derivatives == Derivatives::none || s.width != 3) continue;
        const Vector du = vector_at(b + 3), dv = vector_at(b + 6), n = cross(du, dv);
        const Vector device_n = cross(vector_at(a + 3), vector_at(a + 6));
        for (uint32_t k = 3; k < 9; ++k) {
            const double scale = std::max({length(du), length(dv), s.size});
            worst_derivative = std::max(worst_derivative, std::abs(a[k] - b[k]) / scale);
        }
        if (length(n) <= kDegenerate * length(du) * length(dv)) continue;
        if (std::min(length(du), length(dv)) <= kShort * s.size) continue;
        worst_angle = std::max(worst_angle, degrees_between(n, device_n));
    }
    EXPECT_LE(worst, s.tolerance) << name;
    EXPECT_LE(worst_derivative, 1e-4) << name;
    EXPECT_LE(worst_angle, 0.1) << name;
}

/// The step keeps the time short: shapes come in series, of which a device tells no difference.
inline std::vector<TestMesh> some_shapes(size_t step) {
    std::vector<TestMesh> all = limn::test::all_shapes(), result;
    for (size_t i = 0; i < all.size(); i += step) result.push_back(std::move(all[i]));
    return result;
}

}  // namespace limn::vk::test
