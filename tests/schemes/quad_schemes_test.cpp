// Schemes on quads against closed forms: each other, curves, and masks by valence (scheme_checks.json).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "schemes/scheme_meshes.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

const SubdivisionScheme& scheme_of(const char* name) {
    const SubdivisionScheme* scheme = find_subdivision_scheme(name);
    EXPECT_NE(scheme, nullptr) << name;
    return *scheme;
}

void expect_same_mesh(const RefinedMesh& a, const RefinedMesh& b, double tolerance) {
    EXPECT_EQ(a.face_vertices, b.face_vertices);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (size_t i = 0; i < a.points.size(); ++i) ASSERT_NEAR(a.points[i], b.points[i], tolerance) << i;
}

TEST(Stam, OneSmoothingIsCatmullClarkOrLoop) {
    for (const auto boundary : {BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner})
        for (const bool open : {false, true}) {
            SchemeOptions options;
            options.boundary = boundary;
            SubdivisionScheme quads = scheme_of("stam-4");
            quads.passes = quads.passes.first(2);  // degree 3: without the dual
            quads.faces = FaceKind::quads;         // polygons differ: in the first step, around edge points
            const RefinedMesh grid = make_irregular_mesh(quads, open, 1);
            expect_same_mesh(refine_mesh(grid, quads, 3, options), refine_mesh(grid, scheme_of("catmark"), 3, options),
                             1e-13);
            const SubdivisionScheme& triangles = scheme_of("stam-triangles-4");
            const RefinedMesh mesh = make_irregular_mesh(triangles, open, 2);
            expect_same_mesh(refine_mesh(mesh, triangles, 3, options), refine_mesh(mesh, scheme_of("loop"), 3, options),
                             1e-13);
        }
}

using Matrix = std::vector<std::vector<double>>;  // rows

/// A step of the four-point scheme on an open polygon of n points, continued by 2 a - b at its ends.
Matrix four_point_step(size_t n) {
    Matrix step(2 * n - 1, std::vector<double>(n));
    auto add = [&](size_t row, int64_t i, double weight) {
        const auto last = static_cast<int64_t>(n) - 1;
        if (i >= 0 && i <= last) {
            step[row][static_cast<size_t>(i)] += weight;
        } else {
            step[row][i < 0 ? 0 : n - 1] += 2 * weight;
            step[row][i < 0 ? 1 : n - 2] -= weight;
        }
    };
    for (size_t i = 0; i < n; ++i) add(2 * i, static_cast<int64_t>(i), 1);
    for (size_t i = 0; i + 1 < n; ++i)
        for (int64_t k = -1; k <= 2; ++k)
            add(2 * i + 1, static_cast<int64_t>(i) + k, k == 0 || k == 1 ? 9.0 / 16 : -1.0 / 16);
    return step;
}

/// Points of a grid, columns by rows, refined along both directions, as a set of points to look up.
std::vector<double> refine_grid(const std::vector<double>& points, size_t columns, const Matrix& u, const Matrix& v) {
    std::vector<double> out;
    for (const auto& row_v : v)
        for (const auto& row_u : u)
            for (size_t k = 0; k < 3; ++k) {
                double sum = 0;
                for (size_t j = 0; j < row_v.size(); ++j)
                    for (size_t i = 0; i < row_u.size(); ++i)
                        sum += row_v[j] * row_u[i] * points[3 * (j * columns + i) + k];
                out.push_back(sum);
            }
    return out;
}

/// The distance of the point from the nearest of `points`.
double distance_to(const double* point, const std::vector<double>& points) {
    double least = HUGE_VAL;
    for (size_t v = 0; v < points.size(); v += 3)
        least = std::min(least, std::hypot(point[0] - points[v], point[1] - points[v + 1], point[2] - points[v + 2]));
    return least;
}

void expect_same_points(const RefinedMesh& mesh, const std::vector<double>& points) {
    ASSERT_EQ(mesh.points.size(), points.size());
    for (size_t v = 0; v < points.size(); v += 3) {
        EXPECT_LT(distance_to(mesh.points.data() + v, points), 1e-12);
        EXPECT_LT(distance_to(points.data() + v, mesh.points), 1e-12);
    }
}

TEST(Kobbelt, OpenGridsAreTensorProductsOfFourPointCurves) {
    SchemeOptions options;
    options.boundary = BoundaryInterpolation::edge_and_corner;
    const size_t columns = 5, rows = 4;
    RandomNumbers random(3);
    RefinedMesh mesh;
    for (size_t i = 0; i < 3 * columns * rows; ++i) mesh.points.push_back(random.uniform(-1, 1));
    for (uint32_t j = 0; j + 1 < rows; ++j)
        for (uint32_t i = 0; i + 1 < columns; ++i) {
            const uint32_t a = j * static_cast<uint32_t>(columns) + i, d = a + static_cast<uint32_t>(columns);
            mesh.face_sizes.push_back(4);
            mesh.face_vertices.insert(mesh.face_vertices.end(), {a, a + 1, d + 1, d});
        }
    auto points = refine_grid(mesh.points, columns, four_point_step(columns), four_point_step(rows));
    expect_same_points(refine_mesh(mesh, scheme_of("kobbelt"), 1, options), points);
    points = refine_grid(points, 2 * columns - 1, four_point_step(2 * columns - 1), four_point_step(2 * rows - 1));
    expect_same_points(refine_mesh(mesh, scheme_of("kobbelt"), 2, options), points);
}

/// A vertex of valence n among quads whose other vertices are regular up to two rings out: index 0. Flat, n-fold.
RefinedMesh make_quad_star(uint32_t n, uint32_t rings) {
    RefinedMesh mesh;
    mesh.points = {0, 0, 0};
    auto at = [&](uint32_t sector, uint32_t i, uint32_t j) {  // i >= 1 along the sector's ray, j >= 0 beside it
        return i == 0 ? (j == 0 ? 0 : 1 + (((sector + 1) % n) * rings + j - 1) * (rings + 1))
                      : 1 + ((sector % n) * rings + i - 1) * (rings + 1) + j;
    };
    for (uint32_t s = 0; s < n; ++s)
        for (uint32_t i = 1; i <= rings; ++i)
            for (uint32_t j = 0; j <= rings; ++j) {
                const double a = 2 * M_PI * s / n, b = 2 * M_PI * (s + 1) / n;
                mesh.points.insert(mesh.points.end(),
                                   {i * std::cos(a) + j * std::cos(b), i * std::sin(a) + j * std::sin(b), 0});
            }
    for (uint32_t s = 0; s < n; ++s)
        for (uint32_t i = 0; i < rings; ++i)
            for (uint32_t j = 0; j < rings; ++j) {
                mesh.face_sizes.push_back(4);
                mesh.face_vertices.insert(mesh.face_vertices.end(),
                                          {at(s, i, j), at(s, i + 1, j), at(s, i + 1, j + 1), at(s, i, j + 1)});
            }
    return mesh;
}

/// The weight of control vertex `source` in the row of the first step's point at which `is_row` holds.
double weight_of(const StencilTableDouble& table, uint32_t row, uint32_t source) {
    double sum = 0;
    for (uint32_t k = table.offsets[row]; k < table.offsets[row + 1]; ++k)
        if (table.indices[k] == source) sum += table.weights[k];
    return sum;
}

TEST(Sabin, MasksByValence) {
    for (const auto& [valence, masks] : scheme_checks().at("masks").items()) {
        SCOPED_TRACE(valence);
        const auto n = static_cast<uint32_t>(std::stoul(valence));
        const ControlMesh mesh = control_mesh_of(make_quad_star(n, 2));
        const auto refined = build_scheme_refinement<double>(mesh, scheme_of("sabin"), {1});
        const auto stage = build_first_stage(mesh, scheme_of("sabin"));
        ASSERT_TRUE(refined && stage);
        const Topology& t = stage->topology;
        const auto& table = refined->tables[0];
        const double w = masks.at("sabin_cc").at("W").get<double>();
        const double gamma = masks.at("sabin_cc").at("gamma").get<double>();
        const uint32_t face = t.face_of_corner(t.corners_of_vertex(0)[0]), edge = t.edges_of_vertex(0)[0];
        EXPECT_NEAR(weight_of(table, t.vertex_count + face, 0), w / (w + 3), 1e-14);
        const double in_edge = (w + 2 * w / (w + 3)) / (w + 3);
        EXPECT_NEAR(weight_of(table, t.vertex_count + t.face_count + edge, 0), in_edge, 1e-14);
        EXPECT_NEAR(weight_of(table, 0, 0), in_edge - gamma * w / (w + 3) + gamma, 1e-14);
    }
}

}  // namespace
}  // namespace limn::test
