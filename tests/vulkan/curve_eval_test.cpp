// Curves on the device, by the kernel of all stencils: points, limits and derivatives against the same tables
// in double.
#include "limn/schemes/b_spline_surface.h"
#include "limn/schemes/curve.h"
#include "limn/vulkan/evaluator.h"
#include "shapes/random_mesh.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk::test {
namespace {

class CurveEval : public VulkanTest {
  protected:
    /// Weights, and the same as tangents where there are any: three results of a table on the device.
    void check(const StencilTable& table, const StencilTableDouble& exact, uint32_t width) {
        limn::test::RandomNumbers random(width);
        std::vector<float> control(size_t{table.source_count} * width);
        for (float& x : control) x = static_cast<float>(random.uniform(-1, 1));
        const Result<Evaluator> evaluator = Evaluator::create(device());
        const Result<DeviceStencilTable> uploaded = upload_stencil_table(device(), table);
        ASSERT_TRUE(evaluator && uploaded);
        const Buffer source = *create_buffer(device(), 4 * control.size(), kPointUsage, MemoryUse::device);
        ASSERT_TRUE(upload_bytes(device(), source, 0, std::as_bytes(std::span(control))));
        const size_t count = size_t{table.row_count()} * width;
        const bool tangents = !table.tangent1_weights.empty();
        const Buffer results[3] = {words(count), words(count), words(count)};
        const auto points = [&](size_t i) {
            return PointBuffer{.buffer = i == 0 || tangents ? results[i].handle : VK_NULL_HANDLE,
                               .stride = width};
        };
        const auto evaluation = evaluator->prepare({.table = &*uploaded,
                                                    .width = width,
                                                    .source = {.buffer = source.handle, .stride = width},
                                                    .destination = points(0),
                                                    .tangent1 = points(1),
                                                    .tangent2 = points(2)});
        ASSERT_TRUE(evaluation) << evaluation.error().message;
        run([&](VkCommandBuffer commands) { evaluation->record(commands); });
        const Array<double>* const weights[3] = {&exact.weights, &exact.tangent1_weights,
                                                 &exact.tangent2_weights};
        const std::vector<double> exact_control(control.begin(), control.end());
        for (size_t i = 0; i < (tangents ? 3u : 1u); ++i) {
            StencilTableDouble one = exact;
            one.weights = *weights[i];
            HostPoints host{std::vector<double>(count), width};
            apply_stencil_table<double>(one, exact_control, host.values, width);
            double largest = 1;  // derivatives are as large as weights are
            for (const double weight : one.weights) largest = std::max(largest, std::abs(weight));
            DevicePoints found{*download<float>(device(), results[i], count), 0, width};
            EXPECT_TRUE(points_match(host, found, 2e-6 * largest)) << "result " << i;
            found.values[count / 2] += static_cast<float>(1e-5 * largest);
            EXPECT_FALSE(points_match(host, found, 2e-6 * largest));
        }
    }
};

TEST_F(CurveEval, equals_the_curve_in_double) {
    uint32_t width = 1;
    for (const CurveEnds ends : {CurveEnds::closed, CurveEnds::interpolated, CurveEnds::free})
        for (const CurveScheme& scheme : {CurveScheme{CurveRule::lane_riesenfeld, ends, 2},
                                          {CurveRule::lane_riesenfeld, ends, 3},
                                          {CurveRule::lane_riesenfeld, ends, 6},
                                          {CurveRule::four_point, ends},
                                          {CurveRule::ternary_cubic, ends},
                                          {CurveRule::ternary_four_point, ends}}) {
            const uint32_t count = 40, level = 4;
            check(*build_curve_table<float>(scheme, count, level),
                  *build_curve_table<double>(scheme, count, level), width);
            check(*build_curve_limit_table<float>(scheme, count, level),
                  *build_curve_limit_table<double>(scheme, count, level), width);
            width = width % 5 + 1;
        }
}

TEST_F(CurveEval, equals_b_splines_in_double) {
    const KnotVector knots{3, {0, 0, 0, 0, 1, 1.5, 1.5, 3, 4, 4, 4, 4}};
    std::vector<double> parameters;
    for (uint32_t i = 0; i <= 500; ++i) parameters.push_back(i / 125.0);
    check(*build_b_spline_table<float>(knots, parameters), *build_b_spline_table<double>(knots, parameters),
          4);
    const KnotVector refined = insert_middle_knots(insert_middle_knots(knots));
    check(*build_oslo_table<float>(knots, refined), *build_oslo_table<double>(knots, refined), 3);
}

}  // namespace
}  // namespace limn::vk::test
