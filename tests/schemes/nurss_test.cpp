// Non-uniform surfaces against knot insertion (Boehm 1980), one knot after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "limn/schemes/corner_values.h"
#include "schemes/tensor_grid.h"

namespace limn::test {
namespace {

const SubdivisionScheme& scheme_of(const char* name) {
    const SubdivisionScheme* scheme = find_subdivision_scheme(name);
    EXPECT_NE(scheme, nullptr) << name;
    return *scheme;
}

/// A curve's control points as sums of given ones, and its knots: point i has knots i to i + degree + 1.
struct Curve {
    size_t degree;
    Matrix points;
    std::vector<double> knots;

    void insert(double knot) {
        const size_t j = static_cast<size_t>(std::upper_bound(knots.begin(), knots.end(), knot) - knots.begin()) - 1;
        Matrix next;
        for (size_t i = 0; i <= points.size(); ++i) {
            if (i + degree <= j || i > j) {
                next.push_back(points[i <= j ? i : i - 1]);
                continue;
            }
            const double a = (knot - knots[i]) / (knots[i + degree] - knots[i]);
            next.emplace_back(points[0].size());
            for (size_t k = 0; k < next.back().size(); ++k)
                next.back()[k] = (i > 0 ? (1 - a) * points[i - 1][k] : 0) + (i < points.size() ? a * points[i][k] : 0);
        }
        points = std::move(next);
        knots.insert(knots.begin() + static_cast<std::ptrdiff_t>(j) + 1, knot);
    }
};

/// A step of a cubic curve with these intervals on the edges of its polygon, continued beyond both ends by reflection.
Matrix cubic_step(const std::vector<double>& intervals) {
    const auto n = static_cast<int>(intervals.size()) + 1, beyond = 4;
    Curve curve{3, {}, {0}};
    for (int i = -beyond; i < n + beyond; ++i) {
        const int end = i < 0 ? 0 : n - 1, mirrored = 2 * end - i;
        std::vector<double> point(static_cast<size_t>(n));
        if (i >= 0 && i < n) {
            point[static_cast<size_t>(i)] = 1;
        } else {
            point[static_cast<size_t>(end)] = 2;
            point[static_cast<size_t>(mirrored)] = -1;
        }
        curve.points.push_back(std::move(point));
    }
    auto interval = [&](int i) {  // of the edge after point i
        return intervals[static_cast<size_t>(i < 0 ? -i - 1 : i > n - 2 ? 2 * n - 3 - i : i)];
    };
    curve.knots = {-2, -1, 0};  // point i's own knot is that after the first two
    for (int i = -beyond; i + 1 < n + beyond; ++i) curve.knots.push_back(curve.knots.back() + interval(i));
    std::vector<double> middles;
    for (size_t i = 2; i + 1 < curve.knots.size(); ++i) middles.push_back((curve.knots[i] + curve.knots[i + 1]) / 2);
    curve.knots.push_back(curve.knots.back() + 1);
    curve.knots.push_back(curve.knots.back() + 1);
    for (const double knot : middles) curve.insert(knot);
    return {curve.points.begin() + 2 * beyond, curve.points.end() - 2 * beyond};
}

std::vector<double> halves(const std::vector<double>& intervals) {
    std::vector<double> out;
    for (const double d : intervals) out.insert(out.end(), {d / 2, d / 2});
    return out;
}

std::vector<double> points_after(const RefinedMesh& mesh, const char* name, uint32_t level,
                                 std::span<const double> intervals, BoundaryInterpolation boundary) {
    SchemeOptions options;
    options.boundary = boundary;
    const auto refined =
        build_scheme_refinement<double>(control_mesh_of(mesh, options), scheme_of(name), {level}, intervals);
    EXPECT_TRUE(refined);
    std::vector<double> points = mesh.points;
    for (const auto& table : refined->tables) {
        std::vector<double> next(size_t{3} * table.row_count());
        apply_stencil_table<double>(table, points, next, 3);
        points = std::move(next);
    }
    return points;
}

/// Intervals of a grid's corners, from those of its columns and rows.
std::vector<double> grid_intervals(const std::vector<double>& u, const std::vector<double>& v) {
    std::vector<double> out;
    for (const double b : v)
        for (const double a : u) out.insert(out.end(), {a, b, a, b});
    return out;
}

TEST(Nurss, OpenGridsAreTensorProductsByKnotInsertion) {
    for (const double third : {0.7, 0.0}) {
        const std::vector<double> u = {1, 2.5, third, 0.3, 1.9, 1.2}, v = {0.8, 0.5, 3, 1.1, 0.9};
        const RefinedMesh mesh = make_random_grid(7, 6, 1);
        const auto intervals = grid_intervals(u, v);
        auto expected = refine_grid(mesh.points, 7, cubic_step(u), cubic_step(v));
        const auto corners = BoundaryInterpolation::edge_and_corner;
        expect_same_points({points_after(mesh, "nurss", 1, intervals, corners), {}, {}}, expected);
        if (third == 0) continue;  // knots of multiplicity four and more are no curve's
        expected = refine_grid(expected, 13, cubic_step(halves(u)), cubic_step(halves(v)));
        expect_same_points({points_after(mesh, "nurss", 2, intervals, corners), {}, {}}, expected);
    }
}

TEST(Nurss, EqualIntervalsAreCatmullClark) {
    for (const bool open : {false, true})
        for (const double interval : {1.0, 3.0}) {
            const RefinedMesh mesh = make_irregular_mesh(scheme_of("nurss"), open, 3);
            const std::vector<double> intervals(mesh.face_vertices.size(), interval);
            const auto a = points_after(mesh, "nurss", 3, intervals, BoundaryInterpolation::edge_only),
                       b = points_after(mesh, "catmark", 3, {}, BoundaryInterpolation::edge_only);
            ASSERT_EQ(a.size(), b.size());
            for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-13);
        }
}

/// A step of a closed quadratic curve with these intervals at its points.
Matrix closed_quadratic_step(const std::vector<double>& intervals) {
    const size_t n = intervals.size();
    Curve curve{2, {}, {-1, 0}};  // point i's interval lies between the second and third of its knots
    for (size_t i = 0; i < 3 * n; ++i) {
        curve.points.emplace_back(n);
        curve.points.back()[i % n] = 1;
        curve.knots.push_back(curve.knots.back() + intervals[i % n]);
    }
    std::vector<double> middles;
    for (size_t i = 1; i + 1 < curve.knots.size(); ++i) middles.push_back((curve.knots[i] + curve.knots[i + 1]) / 2);
    curve.knots.push_back(curve.knots.back() + 1);
    for (const double knot : middles) curve.insert(knot);
    // Half intervals 2 i and 2 i + 1 are those of given interval i.
    const auto first = curve.points.begin() + static_cast<std::ptrdiff_t>(2 * n);
    return {first, first + static_cast<std::ptrdiff_t>(2 * n)};
}

TEST(NurssQuadratic, TorusesAreTensorProductsByKnotInsertion) {
    const std::vector<double> u = {1, 2.5, 0.7, 0, 1.9}, v = {0.8, 0.5, 3, 1.1, 0.9};
    const RefinedMesh mesh = make_regular_torus(5, false);
    std::vector<double> intervals;  // of corners at (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
    for (size_t j = 0; j < 5; ++j)
        for (size_t i = 0; i < 5; ++i) intervals.insert(intervals.end(), {u[i], v[j], u[(i + 1) % 5], v[(j + 1) % 5]});
    auto expected = refine_grid(mesh.points, 5, closed_quadratic_step(u), closed_quadratic_step(v));
    expect_same_points({points_after(mesh, "nurss-quadratic", 1, intervals, BoundaryInterpolation::edge_only), {}, {}},
                       expected);
    std::vector<double> positive = intervals;
    for (double& d : positive) d = d == 0 ? 0.4 : d;
    const std::vector<double> w = {1, 2.5, 0.7, 0.4, 1.9};
    expected = refine_grid(mesh.points, 5, closed_quadratic_step(w), closed_quadratic_step(v));
    expected = refine_grid(expected, 10, closed_quadratic_step(halves(w)), closed_quadratic_step(halves(v)));
    expect_same_points({points_after(mesh, "nurss-quadratic", 2, positive, BoundaryInterpolation::edge_only), {}, {}},
                       expected);
}

TEST(NurssQuadratic, EqualIntervalsAreDooSabin) {
    for (const auto boundary :
         {BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner, BoundaryInterpolation::none})
        for (const bool open : {false, true}) {
            const RefinedMesh mesh = make_irregular_mesh(scheme_of("nurss-quadratic"), open, 3);
            const std::vector<double> intervals(mesh.face_vertices.size(), 3);
            const auto a = points_after(mesh, "nurss-quadratic", 3, intervals, boundary),
                       b = points_after(mesh, "doo-sabin", 3, {}, boundary);
            ASSERT_EQ(a.size(), b.size());
            for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-13);
        }
}

/// Whatever the intervals, zeros among them.
TEST(NonUniform, RowsSumToOneAndOrderDoesNotMatter) {
    for (const char* name : {"nurss", "nurss-quadratic"})
        for (const bool open : {false, true}) {
            const RefinedMesh mesh = make_irregular_mesh(scheme_of(name), open, 4);
            RandomNumbers random(5);
            std::vector<double> intervals(mesh.face_vertices.size());
            for (double& d : intervals) d = std::max(0.0, random.uniform(-0.5, 2));
            // Faces begin one corner later.
            RefinedMesh turned = mesh;
            std::vector<double> turned_intervals = intervals;
            size_t begin = 0;
            for (const uint32_t n : mesh.face_sizes) {
                const auto at = static_cast<std::ptrdiff_t>(begin);
                std::rotate(turned.face_vertices.begin() + at, turned.face_vertices.begin() + at + 1,
                            turned.face_vertices.begin() + at + n);
                std::rotate(turned_intervals.begin() + at, turned_intervals.begin() + at + 1,
                            turned_intervals.begin() + at + n);
                begin += n;
            }
            const auto boundary = BoundaryInterpolation::edge_only;
            expect_same_points({points_after(turned, name, 3, turned_intervals, boundary), {}, {}},
                               points_after(mesh, name, 3, intervals, boundary));
            RefinedMesh ones = mesh;
            std::fill(ones.points.begin(), ones.points.end(), 1.0);
            for (const double x : points_after(ones, name, 3, intervals, boundary)) ASSERT_NEAR(x, 1, 1e-13);
            std::fill(intervals.begin(), intervals.end(), 0.0);
            for (const double x : points_after(ones, name, 2, intervals, boundary)) ASSERT_NEAR(x, 1, 1e-13);
        }
}

TEST(NonUniform, BadIntervalsAreErrors) {
    const RefinedMesh mesh = make_irregular_mesh(scheme_of("nurss"), false, 4);
    std::vector<double> intervals(mesh.face_vertices.size(), 1.0);
    auto code = [&] {
        const auto refined = build_scheme_refinement<double>(control_mesh_of(mesh), scheme_of("nurss"), {1}, intervals);
        return refined ? ErrorCode{} : refined.error().code;
    };
    intervals[3] = -1;
    EXPECT_EQ(code(), ErrorCode::invalid_argument);
    intervals[3] = NAN;
    EXPECT_EQ(code(), ErrorCode::invalid_argument);
    intervals.pop_back();
    EXPECT_EQ(code(), ErrorCode::invalid_argument);
}

TEST(CornerValues, IntervalsOfEdges) {
    RefinedMesh mesh;  // two quads beside each other
    mesh.points.resize(18);
    mesh.face_sizes = {4, 4};
    mesh.face_vertices = {0, 1, 4, 3, 1, 2, 5, 4};
    const ControlMesh control = control_mesh_of(mesh);
    const std::vector<uint32_t> edges = {1, 4, 0, 1, 4, 1, 0, 1};
    const std::vector<float> values = {2, 9, 3, 4};
    const auto intervals = corner_intervals(control, edges, values);
    ASSERT_TRUE(intervals);
    EXPECT_EQ(*intervals, (std::vector<double>{4, 2, 1, 1, 1, 1, 1, 3}));
    auto error = [&](std::vector<uint32_t> e, std::vector<float> v) {
        const auto result = corner_intervals(control, e, v);
        return result ? Error{ErrorCode::cancelled, "", 0} : result.error();
    };
    EXPECT_EQ(error({0, 1, 0, 4}, {1, 1}).code, ErrorCode::missing_edge);
    EXPECT_EQ(error({0, 1, 0, 4}, {1, 1}).element, 1u);
    EXPECT_EQ(error({0, 1, 7, 9}, {1, 1}).code, ErrorCode::missing_edge);
    EXPECT_EQ(error({0, 1}, {-1}).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error({0, 1}, {NAN}).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error({0, 1, 2}, {1}).code, ErrorCode::invalid_argument);
}

TEST(CornerValues, Angles) {
    RefinedMesh mesh;
    mesh.face_sizes = {3};
    mesh.face_vertices = {0, 1, 2};
    mesh.points.resize(9);
    const std::vector<float> positions = {0, 0, 1, 2, 0, 1, 0, 2, 1};
    const auto angles = corner_angles(control_mesh_of(mesh), positions);
    ASSERT_TRUE(angles);
    EXPECT_NEAR((*angles)[0], M_PI / 2, 1e-15);
    EXPECT_NEAR((*angles)[1], M_PI / 4, 1e-15);
    EXPECT_NEAR((*angles)[2], M_PI / 4, 1e-15);
    EXPECT_FALSE(corner_angles(control_mesh_of(mesh), std::span(positions).first(8)));
}

}  // namespace
}  // namespace limn::test
