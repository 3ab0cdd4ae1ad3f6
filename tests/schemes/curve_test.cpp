// Subdivision curves against B-splines evaluated by de Boor's algorithm, against what their rules reproduce,
// and against refined polygons of record.
#include "limn/schemes/curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "limn/schemes/b_spline.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

std::vector<CurveScheme> all_schemes(CurveEnds ends) {
    std::vector<CurveScheme> schemes;
    for (uint32_t degree = 1; degree <= 7; ++degree)
        schemes.push_back({CurveRule::lane_riesenfeld, ends, degree});
    schemes.push_back({CurveRule::four_point, ends});
    schemes.push_back({.rule = CurveRule::four_point, .ends = ends, .tension = 0.1});
    schemes.push_back({CurveRule::ternary_cubic, ends});
    schemes.push_back({CurveRule::ternary_four_point, ends});
    return schemes;
}
constexpr CurveEnds kAllEnds[] = {CurveEnds::closed, CurveEnds::interpolated, CurveEnds::free};

std::string name_of(const CurveScheme& s) {
    return "rule " + std::to_string(static_cast<int>(s.rule)) + " degree " + std::to_string(s.degree) +
           " ends " + std::to_string(static_cast<int>(s.ends)) + " tension " + std::to_string(s.tension);
}

std::vector<double> random_points(uint32_t count, uint32_t width, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<double> points(size_t{count} * width);
    for (double& x : points) x = random.uniform(-1, 1);
    return points;
}

std::vector<double> apply(const StencilTableDouble& table, const std::vector<double>& points,
                          uint32_t width) {
    std::vector<double> out(size_t{table.row_count()} * width);
    apply_stencil_table<double>(table, points, out, width);
    return out;
}
/// With tangent weights in place of weights.
std::vector<double> apply_tangents(const StencilTableDouble& table, const Array<double>& weights,
                                   const std::vector<double>& points, uint32_t width) {
    StencilTableDouble other = table;
    other.weights = weights;
    return apply(other, points, width);
}

// Sums over refined points, and over products of their coordinates, that an implementation of its own gave.
TEST(Curve, three_steps_equal_those_of_record) {
    const std::vector<double> polygon = {0.034,  1.36,  1.225,  -0.51, -0.298, -0.527, 0.57,
                                         -0.056, 0.747, -1.847, 1.567, -0.096, 0.68,   -0.137};
    struct Record {
        CurveScheme scheme;
        double products[3];
    };
    const Record records[] = {
        {{.degree = 2}, {31.782707271484373, -13.625816172851561, 24.904345556640624}},
        {{.degree = 3}, {30.09969363044739, -12.924774314079285, 21.608563332656864}},
        {{.rule = CurveRule::four_point}, {37.69558299513483, -16.003015370030283, 36.35664446375394}}};
    for (const Record& record : records) {
        const auto table = build_curve_table<double>(record.scheme, 7, 3);
        ASSERT_TRUE(table);
        const std::vector<double> points = apply(*table, polygon, 2);
        ASSERT_EQ(points.size(), 112u);
        double sum[2] = {0, 0}, products[3] = {0, 0, 0};
        for (size_t i = 0; i < points.size(); i += 2) {
            const double x = points[i], y = points[i + 1];
            const double terms[5] = {x, y, x * x, x * y, y * y};
            for (int k = 0; k < 2; ++k) sum[k] += terms[k];
            for (int k = 0; k < 3; ++k) products[k] += terms[2 + k];
        }
        EXPECT_NEAR(sum[0], 36.2, 1e-12);
        EXPECT_NEAR(sum[1], -14.504, 1e-12);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(products[k], record.products[k], 1e-12) << name_of(record.scheme);
    }
}

TEST(Curve, masks_are_those_of_the_literature) {
    const auto row = [](const CurveScheme& scheme, uint32_t r) {
        const auto table = build_curve_table<double>(scheme, 20, 1);
        std::vector<double> weights(20, 0.0);
        for (uint32_t k = table->offsets[r]; k < table->offsets[r + 1]; ++k)
            weights[table->indices[k]] += table->weights[k];
        return weights;
    };
    const auto expect = [](const std::vector<double>& weights, uint32_t first, std::vector<double> expected,
                           double scale) {
        for (uint32_t i = 0; i < weights.size(); ++i) {
            const uint32_t k = i - first;
            EXPECT_NEAR(weights[i], k < expected.size() ? expected[k] / scale : 0, 1e-15) << "point " << i;
        }
    };
    expect(row({.degree = 2}, 20), 10, {3, 1}, 4);
    expect(row({.degree = 2}, 21), 10, {1, 3}, 4);
    expect(row({.degree = 3}, 20), 9, {1, 6, 1}, 8);
    expect(row({.degree = 3}, 21), 10, {1, 1}, 2);
    expect(row({.rule = CurveRule::four_point}, 21), 9, {-1, 9, 9, -1}, 16);
    expect(row({.rule = CurveRule::ternary_cubic}, 30), 9, {4, 19, 4}, 27);
    expect(row({.rule = CurveRule::ternary_cubic}, 31), 9, {1, 16, 10}, 27);
    expect(row({.rule = CurveRule::ternary_cubic}, 32), 10, {10, 16, 1}, 27);
    expect(row({.rule = CurveRule::ternary_four_point}, 31), 9, {-5, 60, 30, -4}, 81);
    expect(row({.rule = CurveRule::ternary_four_point}, 32), 9, {-4, 30, 60, -5}, 81);
    // Next to ends.
    using enum CurveEnds;
    expect(row({.ends = interpolated, .degree = 3}, 0), 0, {1}, 1);
    expect(row({.ends = interpolated, .degree = 3}, 2), 0, {1, 6, 1}, 8);
    expect(row({.rule = CurveRule::four_point, .ends = interpolated}, 1), 0, {7, 10, -1}, 16);
    expect(row({.ends = interpolated, .degree = 2}, 1), 0, {1, 1}, 2);
    expect(row({.ends = interpolated, .degree = 2}, 2), 1, {3, 1}, 4);
    expect(row({.ends = free, .degree = 2}, 0), 0, {3, 1}, 4);
    expect(row({.ends = free, .degree = 3}, 0), 0, {1, 1}, 2);
}

/// The B-spline of a scheme's control points in curve_parameter: control points beyond ends from the ends'
/// definition.
struct Reference {
    KnotVector knots;
    std::vector<double> points;
};
Reference reference_of(const CurveScheme& s, uint32_t degree, std::vector<double> points, uint32_t width) {
    const auto count = static_cast<int64_t>(points.size() / width);
    const bool dual_ends = s.ends == CurveEnds::interpolated && degree % 2 == 0;
    const int64_t extra = s.ends == CurveEnds::free ? 0 : 2 * degree;
    const auto inner = [&](int64_t i) {  // a point of any number, of component c
        return [&, i](uint32_t c) {
            const auto at = [&](int64_t k) { return points[static_cast<size_t>(k) * width + c]; };
            if (s.ends != CurveEnds::interpolated) return at(((i % count) + count) % count);
            const int64_t last = count - 1;
            if (!dual_ends)
                return i < 0 ? 2 * at(0) - at(-i) : i > last ? 2 * at(last) - at(2 * last - i) : at(i);
            // inner point i is control point i + 1
            if (i < 0) return 2 * at(0) - at(-i);
            return i > last - 2 ? 2 * at(last) - at(2 * last - 2 - i) : at(i + 1);
        };
    };
    Reference out;
    const int64_t inner_count = dual_ends ? count - 2 : count;
    for (int64_t i = -extra; i < inner_count + extra; ++i)
        for (uint32_t c = 0; c < width; ++c) out.points.push_back(inner(i)(c));
    // Control point i is in the middle of its knots: those begin (degree + 1) / 2 before it.
    const double first = static_cast<double>(-extra) + (dual_ends ? 0.5 : 0) - (degree + 1) / 2.0;
    out.knots.degree = degree;
    const auto point_count = static_cast<uint32_t>(inner_count + 2 * extra);
    for (uint32_t k = 0; k < point_count + degree + 1; ++k) out.knots.knots.push_back(first + k);
    return out;
}

TEST(Curve, limits_are_points_and_derivatives_of_b_splines) {
    constexpr uint32_t kWidth = 3, kCount = 17;
    const std::vector<double> points = random_points(kCount, kWidth, 3);
    for (const CurveEnds ends : kAllEnds)
        for (const CurveScheme& scheme : all_schemes(ends)) {
            const bool ternary = scheme.rule == CurveRule::ternary_cubic;
            if (scheme.rule != CurveRule::lane_riesenfeld && !ternary) continue;
            const Reference reference = reference_of(scheme, ternary ? 3 : scheme.degree, points, kWidth);
            ASSERT_TRUE(check_knots(reference.knots));
            for (uint32_t level = 0; level <= 3; ++level) {
                const auto limits = build_curve_limit_table<double>(scheme, kCount, level);
                ASSERT_TRUE(limits) << limits.error().message;
                ASSERT_EQ(limits->row_count() + 2 * count_curve_margin(scheme),
                          *count_curve_points(scheme, kCount, level));
                const std::vector<double> ours[3] = {
                    apply(*limits, points, kWidth),
                    apply_tangents(*limits, limits->tangent1_weights, points, kWidth),
                    apply_tangents(*limits, limits->tangent2_weights, points, kWidth)};
                for (uint32_t r = 0; r < limits->row_count(); ++r) {
                    const double u = curve_parameter(scheme, kCount, level, r + count_curve_margin(scheme));
                    std::vector<double> truth(3 * kWidth);
                    evaluate_b_spline(reference.knots, reference.points, kWidth, u, 2, truth);
                    for (uint32_t k = 0; k < 3; ++k) {
                        // Derivatives that jump at knots have no one value there.
                        if (k >= scheme.degree && !ternary) continue;
                        const double tolerance = k == 0 ? 1e-13 : 1e-11;
                        for (uint32_t c = 0; c < kWidth; ++c)
                            ASSERT_NEAR(ours[k][r * kWidth + c], truth[k * kWidth + c], tolerance)
                                << name_of(scheme) << " level " << level << " row " << r << " derivative "
                                << k;
                    }
                }
            }
        }
}

TEST(Curve, limits_do_not_depend_on_the_level) {
    const uint32_t count = 15;
    const std::vector<double> points = random_points(count, 2, 8);
    for (const CurveEnds ends : kAllEnds)
        for (const CurveScheme& scheme : all_schemes(ends)) {
            const auto coarse = build_curve_limit_table<double>(scheme, count, 1);
            const auto fine = build_curve_limit_table<double>(scheme, count, 4);
            ASSERT_TRUE(coarse && fine);
            const uint32_t margin = count_curve_margin(scheme);
            uint32_t compared = 0, other = 0;
            for (uint32_t r = 0; r < coarse->row_count(); ++r) {
                const double u = curve_parameter(scheme, count, 1, r + margin);
                while (other < fine->row_count() &&
                       curve_parameter(scheme, count, 4, other + margin) < u - 1e-9)
                    ++other;
                if (other == fine->row_count() ||
                    curve_parameter(scheme, count, 4, other + margin) > u + 1e-9)
                    continue;
                ++compared;
                for (const Array<double> StencilTableDouble::*weights :
                     {&StencilTableDouble::weights, &StencilTableDouble::tangent1_weights}) {
                    const auto a = apply_tangents(*coarse, *coarse.*weights, points, 2);
                    const auto b = apply_tangents(*fine, *fine.*weights, points, 2);
                    for (uint32_t c = 0; c < 2; ++c)
                        ASSERT_NEAR(a[2 * r + c], b[2 * other + c], 1e-11) << name_of(scheme) << " at " << u;
                }
            }
            // Points of dual rules lie nowhere twice, but for their ends.
            const bool dual = scheme.rule == CurveRule::lane_riesenfeld && scheme.degree % 2 == 0;
            EXPECT_EQ(compared, !dual                             ? coarse->row_count()
                                : ends == CurveEnds::interpolated ? 2u
                                                                  : 0u)
                << name_of(scheme);
        }
}

TEST(Curve, rows_sum_to_one_and_reproduce_lines) {
    for (const CurveEnds ends : kAllEnds)
        for (const CurveScheme& scheme : all_schemes(ends)) {
            const uint32_t count = 12;
            std::vector<double> line(count);  // the parameters of control points
            for (uint32_t i = 0; i < count; ++i) line[i] = curve_parameter(scheme, count, 0, i);
            const auto table = build_curve_table<double>(scheme, count, 3);
            const auto limits = build_curve_limit_table<double>(scheme, count, 3);
            ASSERT_TRUE(table && limits);
            const std::vector<double> ones(count, 1.0);
            for (const double x : apply(*table, ones, 1)) EXPECT_NEAR(x, 1, 1e-13);
            for (const double x : apply_tangents(*limits, limits->tangent1_weights, ones, 1))
                EXPECT_NEAR(x, 0, 1e-11);
            const std::vector<double> refined = apply(*table, line, 1), ends_up = apply(*limits, line, 1),
                                      slopes = apply_tangents(*limits, limits->tangent1_weights, line, 1);
            const uint32_t margin = count_curve_margin(scheme);
            for (uint32_t r = 0; r < table->row_count(); ++r) {
                const double u = curve_parameter(scheme, count, 3, r);
                if (ends == CurveEnds::closed && (u < 5 || u > 6)) continue;  // where it closes, a line jumps
                EXPECT_NEAR(refined[r], u, 1e-12) << name_of(scheme);
                if (r < margin || r - margin >= limits->row_count()) continue;
                EXPECT_NEAR(ends_up[r - margin], u, 1e-12) << name_of(scheme);
                EXPECT_NEAR(slopes[r - margin], 1, 1e-11) << name_of(scheme);
            }
        }
}

TEST(Curve, four_points_reproduce_cubics) {
    for (const CurveRule rule : {CurveRule::four_point, CurveRule::ternary_four_point}) {
        const CurveScheme scheme = {rule, CurveEnds::free};
        const uint32_t count = 14;
        const auto cubic = [](double t) { return 0.3 * t * t * t - 2 * t * t + t - 5; };
        std::vector<double> points(count);
        for (uint32_t i = 0; i < count; ++i) points[i] = cubic(i);
        const auto table = build_curve_table<double>(scheme, count, 4);
        const auto limits = build_curve_limit_table<double>(scheme, count, 4);
        ASSERT_TRUE(table && limits);
        const std::vector<double> refined = apply(*table, points, 1),
                                  slopes = apply_tangents(*limits, limits->tangent1_weights, points, 1);
        for (uint32_t r = 0; r < table->row_count(); ++r)
            EXPECT_NEAR(refined[r], cubic(curve_parameter(scheme, count, 4, r)), 1e-10);
        for (uint32_t r = 0; r < limits->row_count(); ++r) {
            const double t = curve_parameter(scheme, count, 4, r + count_curve_margin(scheme));
            EXPECT_NEAR(slopes[r], 0.9 * t * t - 4 * t + 1, 1e-8);
        }
    }
}

TEST(Curve, interpolated_ends_are_control_points) {
    for (const CurveScheme& scheme : all_schemes(CurveEnds::interpolated)) {
        const uint32_t count = 6;
        const std::vector<double> points = random_points(count, 2, 4);
        const auto limits = build_curve_limit_table<double>(scheme, count, 3);
        ASSERT_TRUE(limits);
        const std::vector<double> curve = apply(*limits, points, 2);
        for (uint32_t c = 0; c < 2; ++c) {
            EXPECT_NEAR(curve[c], points[c], 1e-13) << name_of(scheme);
            EXPECT_NEAR(curve[curve.size() - 2 + c], points[points.size() - 2 + c], 1e-13) << name_of(scheme);
        }
    }
}

// Of degree 2, ends that are interpolated are those of double knots.
TEST(Curve, quadratic_ends_are_clamped) {
    const uint32_t count = 9;
    const CurveScheme scheme = {CurveRule::lane_riesenfeld, CurveEnds::interpolated, 2};
    const std::vector<double> points = random_points(count, 2, 6);
    const KnotVector knots = make_clamped_knots(2, count);
    const auto limits = build_curve_limit_table<double>(scheme, count, 3);
    ASSERT_TRUE(limits);
    const std::vector<double> curve = apply(*limits, points, 2);
    for (uint32_t r = 0; r < limits->row_count(); ++r) {
        double truth[2];
        evaluate_b_spline(knots, points, 2, curve_parameter(scheme, count, 3, r), 0, truth);
        for (uint32_t c = 0; c < 2; ++c) EXPECT_NEAR(curve[2 * r + c], truth[c], 1e-13);
    }
}

TEST(Curve, doubled_ends_under_chaikin_begin_at_them) {
    const std::vector<double> points = {1, 5, 5, 2};
    const CurveScheme scheme = {CurveRule::lane_riesenfeld, CurveEnds::free, 2};
    std::vector<double> doubled = {1, 1, 5, 5, 2, 2};
    const auto table = build_curve_table<double>(scheme, 6, 9);
    ASSERT_TRUE(table);
    const std::vector<double> refined = apply(*table, doubled, 1);
    EXPECT_NEAR(refined.front(), 1, 1e-12);
    EXPECT_NEAR(refined.back(), 2, 1e-12);
}

TEST(Curve, float_tables_are_double_ones_rounded) {
    const CurveScheme scheme = {CurveRule::four_point, CurveEnds::interpolated};
    const auto exact = build_curve_limit_table<double>(scheme, 9, 2);
    const auto rounded = build_curve_limit_table<float>(scheme, 9, 2);
    ASSERT_TRUE(exact && rounded);
    ASSERT_EQ(exact->indices.size(), rounded->indices.size());
    for (size_t k = 0; k < exact->indices.size(); ++k) {
        EXPECT_EQ(exact->indices[k], rounded->indices[k]);
        EXPECT_EQ(static_cast<float>(exact->weights[k]), rounded->weights[k]);
        EXPECT_EQ(static_cast<float>(exact->tangent1_weights[k]), rounded->tangent1_weights[k]);
    }
}

TEST(Curve, small_polygons_and_bad_arguments) {
    using enum CurveEnds;
    const auto code = [](const CurveScheme& scheme, uint32_t count, uint32_t level) {
        const auto table = build_curve_limit_table<double>(scheme, count, level);
        return table ? std::optional<ErrorCode>() : table.error().code;
    };
    for (uint32_t degree = 1; degree <= kMaxCurveDegree; ++degree) {
        EXPECT_FALSE(code({.ends = closed, .degree = degree}, 1, 3));
        EXPECT_FALSE(code({.ends = interpolated, .degree = degree}, degree % 2 == 0 ? 3 : 2, 2));
        EXPECT_EQ(code({.ends = interpolated, .degree = degree}, degree % 2 == 0 ? 2 : 1, 2),
                  ErrorCode::invalid_argument);
        EXPECT_FALSE(code({.ends = free, .degree = degree}, degree + 1, 1)) << degree;
    }
    EXPECT_EQ(code({.ends = free, .degree = 3}, 2, 1), ErrorCode::invalid_argument);
    EXPECT_EQ(code({.degree = 0}, 9, 1), ErrorCode::invalid_argument);
    EXPECT_EQ(code({.degree = kMaxCurveDegree + 1}, 9, 1), ErrorCode::invalid_argument);
    EXPECT_EQ(code({.rule = CurveRule::four_point, .tension = 0.2}, 9, 1), ErrorCode::invalid_argument);
    EXPECT_EQ(code({.rule = CurveRule::four_point, .tension = std::nan("")}, 9, 1),
              ErrorCode::invalid_argument);
    EXPECT_EQ(code({}, 9, kMaxCurveLevel + 1), ErrorCode::invalid_argument);
    EXPECT_EQ(code({}, 9, 29), ErrorCode::too_large);
    EXPECT_EQ(code({}, 0, 1), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace limn::test
