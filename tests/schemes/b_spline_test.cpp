// B-splines: three ways to other knots against each other, against closed forms, and against de Boor's
// algorithm, which itself is compared with polynomials.
#include "limn/schemes/b_spline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "limn/schemes/b_spline_surface.h"
#include "limn/schemes/curve.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

/// Intervals of any length, some of no length; ends clamped or not.
KnotVector random_knots(uint32_t degree, uint32_t point_count, RandomNumbers& random) {
    KnotVector k{degree, {}};
    const bool clamped = random.chance(0.5);
    double at = random.uniform(-1, 1);
    bool twice = false;
    for (uint32_t i = 0; i <= point_count + degree; ++i) {
        const bool end = clamped && (i <= degree || i > point_count);
        twice = !twice && degree > 1 && i > degree + 1 && i < point_count && random.chance(0.25);
        if (!end && !twice) at += random.uniform(0.1, 1);
        k.knots.push_back(at);
    }
    return k;
}

std::vector<double> random_points(size_t count, RandomNumbers& random) {
    std::vector<double> points(count);
    for (double& x : points) x = random.uniform(-1, 1);
    return points;
}

std::vector<double> apply(const StencilTableDouble& table, const std::vector<double>& points,
                          uint32_t width) {
    std::vector<double> out(size_t{table.row_count()} * width);
    apply_stencil_table<double>(table, points, out, width);
    return out;
}

void expect_same_curve(const KnotVector& k, const std::vector<double>& points, const KnotVector& other,
                       const std::vector<double>& other_points, double tolerance, uint32_t derivatives = 2) {
    for (int i = 0; i <= 40; ++i) {
        const double u = k.begin() + (k.end() - k.begin()) * (i / 40.0);
        std::vector<double> a(2 * (derivatives + 1)), b(a.size());
        evaluate_b_spline(k, points, 2, u, derivatives, a);
        evaluate_b_spline(other, other_points, 2, u, derivatives, b);
        for (size_t c = 0; c < a.size(); ++c)
            ASSERT_NEAR(a[c], b[c], tolerance * std::pow(300.0, c / 2))
                << "degree " << k.degree << " at " << u;
    }
}

// Control points of a polynomial are its blossom at the knots between: what de Boor's algorithm must give
// back.
TEST(BSpline, reproduces_polynomials_and_their_derivatives) {
    RandomNumbers random(1);
    for (uint32_t degree = 1; degree <= 6; ++degree) {
        for (int round = 0; round < 20; ++round) {
            const KnotVector k = random_knots(degree, degree + 6, random);
            ASSERT_TRUE(check_knots(k));
            // u^2 (u of degree 1) and the product over (u + 1), of blossoms sum / binomial and product of (t
            // + 1).
            std::vector<double> points;
            for (uint32_t i = 0; i < k.point_count(); ++i) {
                double pairs = 0, product = 1, sum = 0;
                for (uint32_t a = 1; a <= degree; ++a) {
                    product *= k.knots[i + a] + 1;
                    sum += k.knots[i + a];
                    for (uint32_t b = 1; b < a; ++b) pairs += k.knots[i + a] * k.knots[i + b];
                }
                points.push_back(degree == 1 ? sum : pairs / (degree * (degree - 1) / 2.0));
                points.push_back(product);
            }
            for (int i = 0; i <= 20; ++i) {
                const double u = k.begin() + (k.end() - k.begin()) * (i / 20.0), n = degree;
                double out[6];
                evaluate_b_spline(k, points, 2, u, 2, out);
                const double power[3] = {std::pow(u + 1, n), n * std::pow(u + 1, n - 1),
                                         degree < 2 ? 0 : n * (n - 1) * std::pow(u + 1, n - 2)};
                const double square[3] = {degree == 1 ? u : u * u, degree == 1 ? 1 : 2 * u,
                                          degree == 1 ? 0.0 : 2.0};
                for (int d = 0; d < 3; ++d) {
                    ASSERT_NEAR(out[2 * d], square[d], 1e-9 * (1 + std::abs(square[d])));
                    ASSERT_NEAR(out[2 * d + 1], power[d], 1e-9 * (1 + std::abs(power[d])));
                }
            }
        }
    }
}

TEST(BSpline, inserted_knots_leave_the_curve_as_it_is) {
    RandomNumbers random(2);
    for (uint32_t degree = 1; degree <= 7; ++degree)
        for (int round = 0; round < 30; ++round) {
            const KnotVector k = random_knots(degree, degree + 1 + static_cast<uint32_t>(round) % 9, random);
            ASSERT_TRUE(check_knots(k)) << check_knots(k).error().message;
            const std::vector<double> points = random_points(2 * size_t{k.point_count()}, random);
            const double u = random.uniform(k.begin(), k.end());
            const auto boehm = build_boehm_table<double>(k, u);
            const KnotVector more = insert_knot(k, u);
            const auto oslo = build_oslo_table<double>(k, more);
            const auto blossom = build_blossom_table<double>(k, more);
            ASSERT_TRUE(boehm && oslo && blossom);
            const std::vector<double> a = apply(*boehm, points, 2), b = apply(*oslo, points, 2),
                                      c = apply(*blossom, points, 2);
            ASSERT_EQ(a.size(), 2 * size_t{more.point_count()});
            for (size_t i = 0; i < a.size(); ++i) {
                ASSERT_NEAR(a[i], b[i], 1e-12) << "degree " << degree;
                ASSERT_NEAR(a[i], c[i], 1e-12) << "degree " << degree;
            }
            expect_same_curve(k, points, more, a, 1e-13, std::min(degree - 1, 1u));
        }
}

// Until there are degree of them, at a knot that is there already, too.
TEST(BSpline, knots_can_be_inserted_until_the_curve_is_there) {
    RandomNumbers random(3);
    for (uint32_t degree = 2; degree <= 5; ++degree) {
        KnotVector k = random_knots(degree, degree + 5, random);
        std::vector<double> points = random_points(2 * size_t{k.point_count()}, random);
        const double u = k.begin() + 0.4 * (k.end() - k.begin());
        double on_curve[2];
        evaluate_b_spline(k, points, 2, u, 0, on_curve);
        for (uint32_t i = 0; i < degree; ++i) {
            points = apply(*build_boehm_table<double>(k, u), points, 2);
            k = insert_knot(k, u);
        }
        const auto first = std::lower_bound(k.knots.begin(), k.knots.end(), u) - k.knots.begin();
        const auto point = 2 * static_cast<size_t>(first - 1);
        EXPECT_NEAR(points[point], on_curve[0], 1e-13);
        EXPECT_NEAR(points[point + 1], on_curve[1], 1e-13);
        EXPECT_TRUE(build_boehm_table<double>(k, u));
        k = insert_knot(k, u);
        EXPECT_FALSE(build_boehm_table<double>(k, u));
    }
}

TEST(BSpline, many_knots_at_once) {
    RandomNumbers random(4);
    for (uint32_t degree = 1; degree <= 5; ++degree)
        for (int round = 0; round < 20; ++round) {
            const KnotVector k = random_knots(degree, degree + 4, random);
            const KnotVector refined = insert_middle_knots(insert_middle_knots(k));
            const std::vector<double> points = random_points(2 * size_t{k.point_count()}, random);
            const auto oslo = build_oslo_table<double>(k, refined);
            const auto blossom = build_blossom_table<double>(k, refined);
            ASSERT_TRUE(oslo && blossom);
            const std::vector<double> a = apply(*oslo, points, 2), b = apply(*blossom, points, 2);
            for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-11);
            expect_same_curve(k, points, refined, a, 1e-13, 0);
            // One by one.
            KnotVector grown = k;
            std::vector<double> by_boehm = points;
            for (const double u : refined.knots) {
                const auto count = std::count(grown.knots.begin(), grown.knots.end(), u);
                if (count > 0) continue;
                by_boehm = apply(*build_boehm_table<double>(grown, u), by_boehm, 2);
                grown = insert_knot(grown, u);
            }
            ASSERT_EQ(grown, refined);
            for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], by_boehm[i], 1e-12);
        }
}

// On even knots all of them are Lane and Riesenfeld's.
TEST(BSpline, even_knots_are_refined_as_subdivision_does) {
    RandomNumbers random(5);
    for (uint32_t degree = 1; degree <= 7; ++degree) {
        const uint32_t count = degree + 8;
        const KnotVector k = make_uniform_knots(degree, count);
        KnotVector halves{degree, {}};
        for (uint32_t i = 0; i + 1 < k.knots.size(); ++i)
            halves.knots.insert(halves.knots.end(), {k.knots[i], k.knots[i] + 0.5});
        halves.knots.push_back(k.knots.back());
        // Halves of intervals beyond the ends, too, of which the outermost need more points than there are.
        halves.knots = {halves.knots.begin() + degree, halves.knots.end() - degree};
        const std::vector<double> points = random_points(2 * size_t{count}, random);
        const auto curve = build_curve_table<double>({.ends = CurveEnds::free, .degree = degree}, count, 1);
        const auto oslo = build_oslo_table<double>(k, halves);
        const auto blossom = build_blossom_table<double>(k, halves);
        ASSERT_TRUE(curve && oslo && blossom);
        const std::vector<double> a = apply(*curve, points, 2), b = apply(*oslo, points, 2),
                                  c = apply(*blossom, points, 2);
        ASSERT_EQ(a.size(), b.size());
        for (size_t i = 0; i < a.size(); ++i) {
            EXPECT_NEAR(a[i], b[i], 1e-13) << "degree " << degree;
            EXPECT_NEAR(a[i], c[i], 1e-12) << "degree " << degree;
        }
    }
}

// Sederberg, Zheng, Sewell and Sabin 1998: what non-uniform subdivision surfaces generalise.
TEST(BSpline, middles_of_uneven_intervals_are_the_known_masks) {
    RandomNumbers random(6);
    std::vector<double> lengths(12);
    for (double& d : lengths) d = random.uniform(0.2, 2);
    KnotVector k{3, {0}};
    for (const double d : lengths) k.knots.push_back(k.knots.back() + d);
    const KnotVector refined = insert_middle_knots(k);
    std::vector<double> points = random_points(k.point_count(), random);
    const std::vector<double> cubic = apply(*build_oslo_table<double>(k, refined), points, 1);
    // Control point i is at knot i + 2, and the interval of edge (i, i + 1) is the one behind that knot.
    // Behind the first three knots, which stay, edge and vertex points take turns, beginning with the edge
    // from control point 1.
    const auto d = [&](size_t i) { return lengths[i + 2]; };
    const auto edge = [&](size_t i) {
        return ((d(i) + 2 * d(i + 1)) * points[i] + (d(i) + 2 * d(i - 1)) * points[i + 1]) /
               (2 * (d(i - 1) + d(i) + d(i + 1)));
    };
    for (size_t i = 2; i + 4 < points.size(); ++i) {
        const double vertex = (d(i) * edge(i - 1) + (d(i - 1) + d(i)) * points[i] + d(i - 1) * edge(i)) /
                              (2 * (d(i - 1) + d(i)));
        EXPECT_NEAR(cubic[2 * i], edge(i), 1e-13) << i;
        EXPECT_NEAR(cubic[2 * i - 1], vertex, 1e-13) << i;
    }
    // Quadratic: interval i is control point i's own, behind knot i + 1.
    k.degree = 2;
    const KnotVector halves = insert_middle_knots(k);
    points = random_points(k.point_count(), random);
    const std::vector<double> quadratic = apply(*build_oslo_table<double>(k, halves), points, 1);
    for (size_t i = 1; i + 2 < points.size(); ++i) {
        const double a = lengths[i + 1], b = lengths[i + 2];
        EXPECT_NEAR(quadratic[2 * i], ((a + 2 * b) * points[i] + a * points[i + 1]) / (2 * (a + b)), 1e-13)
            << i;
        EXPECT_NEAR(quadratic[2 * i + 1], (b * points[i] + (2 * a + b) * points[i + 1]) / (2 * (a + b)),
                    1e-13)
            << i;
    }
}

TEST(BSpline, blossoms_change_ends_and_raise_degrees) {
    RandomNumbers random(7);
    for (uint32_t degree = 1; degree <= 5; ++degree)
        for (int round = 0; round < 20; ++round) {
            const KnotVector k = random_knots(degree, degree + 1 + static_cast<uint32_t>(round) % 6, random);
            const std::vector<double> points = random_points(2 * size_t{k.point_count()}, random);
            KnotVector other = k;  // as long beyond the ends as random numbers say
            for (uint32_t i = degree; i > 0; --i) {
                other.knots[i - 1] = other.knots[i] - random.uniform(0, 0.5);
                const size_t last = other.knots.size() - i;
                other.knots[last] = other.knots[last - 1] + random.uniform(0, 0.5);
            }
            const auto ends = build_blossom_table<double>(k, other);
            ASSERT_TRUE(ends) << ends.error().message;
            expect_same_curve(k, points, other, apply(*ends, points, 2), 1e-10);
            KnotVector raised{degree + 2, {}};
            for (size_t i = 0; i < k.knots.size(); ++i) {
                const bool new_value = i == 0 || k.knots[i] != k.knots[i - 1];
                raised.knots.insert(raised.knots.end(), new_value ? 3 : 1, k.knots[i]);
            }
            // As many at the ends of the curve as before are too many.
            const auto begin = std::upper_bound(raised.knots.begin(), raised.knots.end(), k.begin());
            const auto end = std::lower_bound(raised.knots.begin(), raised.knots.end(), k.end());
            raised.knots = {begin, end};
            raised.knots.insert(raised.knots.begin(), degree + 3, k.begin());
            raised.knots.insert(raised.knots.end(), degree + 3, k.end());
            const auto more = build_blossom_table<double>(k, raised);
            ASSERT_TRUE(more) << more.error().message;
            expect_same_curve(k, points, raised, apply(*more, points, 2), 1e-11);
        }
}

TEST(BSpline, samples_are_rows) {
    RandomNumbers random(8);
    const KnotVector k = random_knots(3, 9, random);
    const std::vector<double> points = random_points(18, random);
    std::vector<double> parameters;
    for (int i = 0; i <= 30; ++i) parameters.push_back(k.begin() + (k.end() - k.begin()) * i / 30.0);
    auto table = build_b_spline_table<double>(k, parameters);
    ASSERT_TRUE(table);
    const std::vector<double> values = apply(*table, points, 2);
    table->weights = table->tangent1_weights;
    const std::vector<double> first = apply(*table, points, 2);
    table->weights = table->tangent2_weights;
    const std::vector<double> second = apply(*table, points, 2);
    for (size_t r = 0; r < parameters.size(); ++r) {
        double out[6];
        evaluate_b_spline(k, points, 2, parameters[r], 2, out);
        for (size_t c = 0; c < 2; ++c) {
            EXPECT_NEAR(values[2 * r + c], out[c], 1e-13);
            EXPECT_NEAR(first[2 * r + c], out[2 + c], 1e-12 * (1 + std::abs(out[2 + c])));
            EXPECT_NEAR(second[2 * r + c], out[4 + c], 1e-11 * (1 + std::abs(out[4 + c])));
        }
    }
}

// A quarter of a circle: of curvature 1, whatever the parameter.
TEST(BSpline, rational_curves_are_circles) {
    const double h = std::sqrt(0.5);
    const KnotVector k = make_clamped_knots(2, 3);
    const std::vector<double> points = {1, 0, 1, h, h, h, 0, 1, 1};
    for (int i = 0; i <= 16; ++i) {
        double homogeneous[9], p[6];
        evaluate_b_spline(k, points, 3, i / 16.0, 2, homogeneous);
        divide_by_weight(homogeneous, 3, p);
        EXPECT_NEAR(std::hypot(p[0], p[1]), 1, 1e-15);
        const double speed = std::hypot(p[2], p[3]);
        EXPECT_NEAR((p[2] * p[5] - p[3] * p[4]) / (speed * speed * speed), 1, 1e-13);
    }
}

TEST(BSpline, refuses_what_makes_no_sense) {
    const KnotVector good = make_clamped_knots(3, 6);
    EXPECT_TRUE(check_knots(good));
    const auto code = [&](auto change) {
        KnotVector k = good;
        change(k);
        const auto checked = check_knots(k);
        return checked ? std::optional<ErrorCode>() : checked.error().code;
    };
    EXPECT_EQ(code([](KnotVector& k) { k.degree = 0; }), ErrorCode::invalid_argument);
    EXPECT_EQ(code([](KnotVector& k) { k.degree = 99; }), ErrorCode::invalid_argument);
    EXPECT_EQ(code([](KnotVector& k) { k.knots.resize(7); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code([](KnotVector& k) { k.knots[4] = 9; }), ErrorCode::invalid_argument);
    EXPECT_EQ(code([](KnotVector& k) { k.knots[4] = 0; }), ErrorCode::invalid_argument);  // five equal ones
    EXPECT_EQ(code([](KnotVector& k) { k.knots[4] = std::nan(""); }), ErrorCode::not_finite);
    EXPECT_EQ(code([](KnotVector& k) { k.knots.assign(8, 1.0); }), ErrorCode::invalid_argument);
    KnotVector other = good;
    other.knots[5] = 1.5;
    EXPECT_FALSE(build_oslo_table<double>(good, other));
    EXPECT_FALSE(build_blossom_table<double>(good, make_clamped_knots(2, 5)));
    EXPECT_FALSE(build_oslo_table<double>(good, make_clamped_knots(3, 7)));
    EXPECT_FALSE(build_boehm_table<double>(good, -1));
    EXPECT_FALSE(build_boehm_table<double>(good, std::nan("")));
    EXPECT_FALSE(build_b_spline_table<double>(good, std::vector<double>{0, HUGE_VAL}));
}

}  // namespace
}  // namespace limn::test
