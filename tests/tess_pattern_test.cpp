// Patterns in the parameter domain: what holds for every face, whatever its surface.
#include "limn/shared/tess_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace limn::shared {
namespace {

struct Point {
    double u, v;
};
using Triangle = std::array<TessVertex, 3>;

struct Face {
    TessPattern pattern;
    uint32_t rates[4];
    std::vector<Triangle> triangles;

    Point locate(TessVertex x) const {
        Point p = {};
        if (x.side == kInside) {
            locate_inner_vertex(pattern, x.i, p.u, p.v);
        } else {
            const uint32_t n = pattern.segments[x.side];
            double t;
            if (!pattern.halves[x.side])
                t = point_on_side(rates[x.side], pattern.fractional, x.i);
            else if (2 * x.i <= n)
                t = point_on_side(rates[x.side], pattern.fractional, x.i) / 2;
            else
                t = 0.5 + point_on_side(rates[x.side], pattern.fractional, x.i - n / 2) / 2;
            locate_on_side(pattern.triangle, x.side, t, p.u, p.v);
        }
        return p;
    }
    double area(const Triangle& t) const {
        const Point a = locate(t[0]), b = locate(t[1]), c = locate(t[2]);
        return ((b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u)) / 2;
    }
    /// The same number for the same vertex: corners belong to two sides.
    uint32_t number(TessVertex x) const {
        if (x.side == kInside) return x.i;
        uint32_t at = inner_vertex_count(pattern) + x.i;
        for (uint32_t k = 0; k < x.side; ++k) at += pattern.segments[k];
        return at == inner_vertex_count(pattern) + boundary_segments(pattern) ? inner_vertex_count(pattern) : at;
    }
};

Face make_face(bool triangle, uint32_t spacing, const std::array<uint32_t, 4>& rates, uint32_t halves) {
    Face face{make_pattern(triangle, spacing, rates[0], rates[1], rates[2], rates[3], halves), {}, {}};
    std::copy(rates.begin(), rates.end(), face.rates);
    const TessPattern& p = face.pattern;
    Triangle t = {};
    for (uint32_t i = 0; i < inner_triangle_count(p); ++i) {
        inner_triangle(p, i, t[0], t[1], t[2]);
        face.triangles.push_back(t);
    }
    for (uint32_t k = 0; k < side_count(p); ++k) {
        for (uint32_t i = 0; i < strip_triangle_count(p, k); ++i) {
            strip_triangle(p, k, i, t[0], t[1], t[2]);
            face.triangles.push_back(t);
        }
    }
    return face;
}

/// Empty where all is well.
std::string find_fault(const Face& face) {
    const TessPattern& p = face.pattern;
    if (face.triangles.size() != triangle_count(p)) return "triangles are not as many as the closed form says";
    const uint32_t inner = inner_vertex_count(p), count = inner + boundary_segments(p);
    std::vector<uint32_t> used(count, 0);
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    double area = 0;
    for (const Triangle& t : face.triangles) {
        const double a = face.area(t);
        if (!(a > 0)) return "a triangle is degenerate or inverted";
        area += a;
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t from = face.number(t[c]), to = face.number(t[(c + 1) % 3]);
            if (from >= count || to >= count) return "a vertex is out of range";
            ++used[from];
            if (++edges[{from, to}] != 1) return "an edge is used twice in one direction";
        }
    }
    if (std::abs(area - (p.triangle ? 0.5 : 1)) > 1e-12) return "triangles do not fill the face";
    for (const uint32_t u : used)
        if (u == 0) return "a vertex is not used";
    for (const auto& [edge, uses] : edges) {
        const bool has_twin = edges.count({edge.second, edge.first}) != 0;
        const bool boundary = edge.first >= inner && edge.second == (edge.first + 1 == count ? inner : edge.first + 1);
        if (boundary == has_twin) return boundary ? "a boundary segment has two triangles" : "an edge is open";
    }
    return "";
}

// Below 6 all combinations, among them all that are hollow.
TEST(TessPattern, SmallRatesFillTheFace) {
    for (const bool triangle : {false, true}) {
        for (uint32_t code = 0; code < 6 * 6 * 6 * 6; ++code) {
            const std::array<uint32_t, 4> n = {1 + code % 6, 1 + code / 6 % 6, 1 + code / 36 % 6, 1 + code / 216};
            const Face face = make_face(triangle, kSpacingInteger,
                                        {n[0] * kRateOne, n[1] * kRateOne, n[2] * kRateOne, n[3] * kRateOne}, 0);
            ASSERT_EQ(find_fault(face), "") << triangle << ' ' << n[0] << ' ' << n[1] << ' ' << n[2] << ' ' << n[3];
        }
    }
}

TEST(TessPattern, RandomRatesFillTheFace) {
    std::mt19937 random(1);
    for (uint32_t i = 0; i < 1500; ++i) {
        const bool triangle = (random() & 1) != 0, fractional = (random() & 1) != 0;
        const auto halves = static_cast<uint32_t>(triangle ? 0 : random() & random() & 15);
        std::array<uint32_t, 4> rates;
        for (uint32_t k = 0; k < 4; ++k) {
            const uint32_t least = fractional ? 2 : 1, most = (halves >> k & 1) != 0 ? 64 : 128;
            const uint32_t span = (random() & 1) != 0 ? 8 : most - least;
            const auto number = static_cast<uint32_t>(random());
            rates[k] = fractional ? least * kRateOne + 1 + number % (span * kRateOne)
                                  : (least + number % (span + 1)) * kRateOne;
        }
        const Face face = make_face(triangle, fractional ? kSpacingFractional : kSpacingInteger, rates, halves);
        ASSERT_EQ(find_fault(face), "") << i << ' ' << triangle << fractional << ' ' << halves << ' ' << rates[0] << ' '
                                        << rates[1] << ' ' << rates[2] << ' ' << rates[3];
    }
}

TEST(TessPattern, EqualRatesHaveTheFewestTriangles) {
    for (uint32_t n = 1; n <= 128; ++n) {
        const uint32_t r = n * kRateOne;
        EXPECT_EQ(triangle_count(make_pattern(false, kSpacingInteger, r, r, r, r, 0)), 2 * n * n);
        EXPECT_EQ(triangle_count(make_pattern(true, kSpacingInteger, r, r, r, 0, 0)), n * n);
        if (n % 2 != 0) continue;
        EXPECT_EQ(triangle_count(make_pattern(false, kSpacingFractional, r, r, r, r, 0)), 2 * n * n);
        EXPECT_EQ(triangle_count(make_pattern(true, kSpacingFractional, r, r, r, 0, 0)), 3 * n * n / 2);
    }
}

/// A curved function, linear over each triangle, at (u, v).
double interpolate(const Face& face, double u, double v) {
    const auto f = [](Point p) { return std::sin(3 * p.u + p.v) + p.u * p.v + std::cos(4 * p.v); };
    for (const Triangle& t : face.triangles) {
        const Point a = face.locate(t[0]), b = face.locate(t[1]), c = face.locate(t[2]);
        const double area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
        const double x = ((u - a.u) * (c.v - a.v) - (v - a.v) * (c.u - a.u)) / area;
        const double y = ((b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u)) / area;
        if (x >= -1e-9 && y >= -1e-9 && x + y <= 1 + 1e-9) return f(a) + x * (f(b) - f(a)) + y * (f(c) - f(a));
    }
    return NAN;
}

// The triangulated surface as a whole, not its vertices alone: where triangles were joined anew it would jump.
double largest_jump(uint32_t spacing) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.01, 0.49);
    const uint32_t others[4] = {5 * kRateOne + 1234, 11 * kRateOne, 3 * kRateOne + 7, 8 * kRateOne};
    double jump = 0;
    for (const bool triangle : {false, true}) {
        for (uint32_t moving = 0; moving < 8; ++moving) {
            const uint32_t halves = triangle ? 0 : moving * 5 & 15;
            const Point at = {unit(random) * (triangle ? 1 : 2), unit(random) * (triangle ? 1 : 2)};
            double last = NAN;
            for (uint32_t step = 0; step < 500; ++step) {
                std::array<uint32_t, 4> rates = {others[0], others[1], others[2], others[3]};
                const uint32_t rate = 2 * kRateOne + step * (kRateOne / 32) + (spacing == kSpacingFractional ? 1 : 0);
                rates[moving % 4] = rate;
                if (moving >= 4) rates[(moving + 2) % 4] = rate;  // the inside follows
                if (spacing != kSpacingFractional)
                    for (uint32_t& r : rates) r -= r % kRateOne;
                const double value = interpolate(make_face(triangle, spacing, rates, halves), at.u, at.v);
                if (step != 0) jump = std::max(jump, std::abs(value - last));
                last = value;
            }
        }
    }
    return jump;
}
TEST(TessPattern, FractionalRatesDoNotPop) {
    EXPECT_LT(largest_jump(kSpacingFractional), 0.02);
    EXPECT_GT(largest_jump(kSpacingInteger), 0.03);  // which shows what a jump would look like
}

// Steps so small that nothing moves far: what remains would be a jump.
TEST(TessPattern, FractionalRatesAreContinuousWhereSegmentsAppear) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.01, 0.99);
    for (uint32_t i = 0; i < 400; ++i) {
        const bool triangle = (random() & 1) != 0;
        const auto halves = static_cast<uint32_t>(triangle ? 0 : random() & random() & 15);
        std::array<uint32_t, 4> low, high;
        for (uint32_t k = 0; k < 4; ++k) {
            low[k] = (2 + 2 * (static_cast<uint32_t>(random()) % 8)) * kRateOne;  // a segment begins above, none does below
            high[k] = low[k] + ((random() & 1) != 0 ? 1 : 0);
        }
        double u = unit(random), v = unit(random);
        if (triangle && u + v > 1) u = 1 - u, v = 1 - v;
        const double a = interpolate(make_face(triangle, kSpacingFractional, low, halves), u, v);
        const double b = interpolate(make_face(triangle, kSpacingFractional, high, halves), u, v);
        EXPECT_NEAR(a, b, 2e-4) << i << ' ' << triangle << ' ' << halves << ' ' << low[0] << ' ' << low[1] << ' ' << low[2]
                               << ' ' << low[3];
    }
}

}  // namespace
}  // namespace limn::shared
