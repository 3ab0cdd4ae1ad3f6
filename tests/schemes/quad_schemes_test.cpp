// Schemes against closed forms: each other, curves, eigenvalues, and masks by valence (scheme_checks.json).
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "schemes/scheme_meshes.h"
#include "schemes/tensor_grid.h"

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

TEST(Kobbelt, OpenGridsAreTensorProductsOfFourPointCurves) {
    SchemeOptions options;
    options.boundary = BoundaryInterpolation::edge_and_corner;
    const uint32_t columns = 5, rows = 4;
    const RefinedMesh mesh = make_random_grid(columns, rows, 3);
    auto points = refine_grid(mesh.points, columns, four_point_step(columns), four_point_step(rows));
    expect_same_points(refine_mesh(mesh, scheme_of("kobbelt"), 1, options), points);
    points = refine_grid(points, 2 * columns - 1, four_point_step(2 * columns - 1), four_point_step(2 * rows - 1));
    expect_same_points(refine_mesh(mesh, scheme_of("kobbelt"), 2, options), points);
}

/// A vertex, index 0, with n sectors around it, closed or half open, and regular vertices else. Flat. Triangles: each
/// quad is two.
RefinedMesh make_star(uint32_t n, uint32_t rings, bool open, bool triangles) {
    RefinedMesh mesh;
    mesh.points = {0, 0, 0};
    // Point (i, j) of a sector: i along its ray, j along the next one; those of i > 0 are its own.
    auto at = [&](uint32_t s, uint32_t i, uint32_t j) -> uint32_t {
        if (i == 0 && j == 0) return 0;
        if (i == 0 && s + 1 == n && open) return n * rings * (rings + 1) + j;
        return i == 0 ? 1 + ((s + 1) % n * rings + j - 1) * (rings + 1) : 1 + (s * rings + i - 1) * (rings + 1) + j;
    };
    auto add_point = [&](uint32_t s, double i, double j) {
        const double turn = (open ? M_PI : 2 * M_PI) / n, a = turn * s, b = turn * (s + 1);
        mesh.points.insert(mesh.points.end(),
                           {i * std::cos(a) + j * std::cos(b), i * std::sin(a) + j * std::sin(b), 0});
    };
    for (uint32_t s = 0; s < n; ++s)
        for (uint32_t i = 1; i <= rings; ++i)
            for (uint32_t j = 0; j <= rings; ++j) add_point(s, i, j);
    for (uint32_t j = 1; open && j <= rings; ++j) add_point(n - 1, 0, j);
    auto add_face = [&](std::initializer_list<uint32_t> vertices) {
        mesh.face_sizes.push_back(static_cast<uint32_t>(vertices.size()));
        mesh.face_vertices.insert(mesh.face_vertices.end(), vertices);
    };
    for (uint32_t s = 0; s < n; ++s)
        for (uint32_t i = 0; i < rings; ++i)
            for (uint32_t j = 0; j < rings; ++j) {
                const uint32_t a = at(s, i, j), b = at(s, i + 1, j), c = at(s, i + 1, j + 1), d = at(s, i, j + 1);
                if (triangles) {
                    add_face({a, b, d});
                    add_face({b, c, d});
                } else {
                    add_face({a, b, c, d});
                }
            }
    return mesh;
}

/// What a step makes of some points: of those that take their place, by row of the step's table.
struct StarStep {
    Eigen::MatrixXd matrix;
    double outside = 0;  ///< the largest weight of any other point
};
StarStep step_between(const ControlMesh& mesh, const SubdivisionScheme& scheme, const std::vector<uint32_t>& points,
                      const std::vector<uint32_t>& rows, std::span<const double> angles = {}) {
    const auto refined = build_scheme_refinement<double>(mesh, scheme, {1}, angles);
    EXPECT_TRUE(refined);
    const auto& table = refined->tables[0];
    const auto count = static_cast<Eigen::Index>(points.size());
    StarStep step{Eigen::MatrixXd::Zero(count, count)};
    for (size_t r = 0; r < rows.size(); ++r)
        for (uint32_t k = table.offsets[rows[r]]; k < table.offsets[rows[r] + 1]; ++k) {
            const auto found = std::find(points.begin(), points.end(), table.indices[k]);
            if (found == points.end())
                step.outside = std::max(step.outside, std::abs(table.weights[k]));
            else
                step.matrix(static_cast<Eigen::Index>(r), found - points.begin()) += table.weights[k];
        }
    return step;
}

/// Of vertex 0, its neighbours and, in quads, the vertices opposite.
StarStep star_step(const ControlMesh& mesh, const SubdivisionScheme& scheme, std::span<const double> angles = {}) {
    const auto stage = build_first_stage(mesh, scheme);
    EXPECT_TRUE(stage);
    const Topology& t = stage->topology;
    const bool triangles = scheme.faces == FaceKind::triangles;
    std::vector<uint32_t> points = {0}, rows = {0};
    for (const uint32_t e : t.edges_of_vertex(0)) {
        points.push_back(t.other_vertex(e, 0));
        rows.push_back(t.vertex_count + (triangles ? 0 : t.face_count) + e);
    }
    for (const uint32_t c : t.corners_of_vertex(0)) {
        if (triangles) break;
        points.push_back(t.face_vertices[t.next_corner(t.next_corner(c))]);
        rows.push_back(t.vertex_count + t.face_of_corner(c));
    }
    return step_between(mesh, scheme, points, rows, angles);
}

/// Absolute values, the largest first.
std::vector<double> eigenvalues_of(const StarStep& step) {
    EXPECT_EQ(step.outside, 0);
    const Eigen::VectorXcd values = Eigen::EigenSolver<Eigen::MatrixXd>(step.matrix, false).eigenvalues();
    std::vector<double> sizes;
    for (const auto& value : values) sizes.push_back(std::abs(value));
    std::sort(sizes.rbegin(), sizes.rend());
    return sizes;
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
        const ControlMesh mesh = control_mesh_of(make_star(n, 2, false, false));
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

TEST(CurvatureContinuous, EigenvaluesAroundAVertex) {
    for (const char* name : {"catmark", "loop"})
        for (uint32_t n = 3; n <= 12; ++n) {
            SCOPED_TRACE(std::string(name) + " " + std::to_string(n));
            const bool triangles = name == std::string("loop");
            const ControlMesh mesh = control_mesh_of(make_star(n, 2, false, triangles));
            const StarStep ordinary = star_step(mesh, scheme_of(name)),
                           tuned = star_step(mesh, scheme_of((name + std::string("-g2")).c_str()));
            if (n == (triangles ? 6u : 4u)) {
                EXPECT_EQ(ordinary.matrix, tuned.matrix);
                continue;
            }
            const auto before = eigenvalues_of(ordinary), after = eigenvalues_of(tuned);
            EXPECT_NEAR(after[0], 1, 1e-12);
            EXPECT_NEAR(after[1], std::max(before[1], 0.4), 1e-12);
            EXPECT_NEAR(after[2], after[1], 1e-12);
            EXPECT_LT(after[3], 0.9 * after[1] * after[1] + 1e-12);
            EXPECT_GT(after[1] * after[1], 1.0 / 8);  // of the next ring
            EXPECT_GT(before[3], 0.9 * before[1] * before[1]) << "nothing to do";
            EXPECT_LT((ordinary.matrix - tuned.matrix).cwiseAbs().maxCoeff(), 0.14);
            EXPECT_LT((tuned.matrix.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
        }
}

/// Refined again and again the surroundings of a vertex become its characteristic map: no triangle may turn over.
TEST(ButterflyG1, CharacteristicMapsAreRegular) {
    for (const uint32_t n : {3u, 4u, 5u, 7u, 8u, 9u, 12u, 16u}) {
        SCOPED_TRACE(n);
        const RefinedMesh mesh = make_star(n, 4, false, true);
        const auto refined =
            build_scheme_refinement<double>(control_mesh_of(mesh), scheme_of("butterfly-g1"), {4, true});
        ASSERT_TRUE(refined);
        std::vector<double> points = mesh.points;
        for (const auto& table : refined->tables) {
            std::vector<double> next(size_t{3} * table.row_count());
            apply_stencil_table<double>(table, points, next, 3);
            points = std::move(next);
        }
        const Topology& t = refined->mesh();
        std::set<uint32_t> patch = {0};
        for (int ring = 0; ring < 3; ++ring)
            for (const uint32_t v : std::vector<uint32_t>(patch.begin(), patch.end()))
                for (const uint32_t e : t.edges_of_vertex(v)) patch.insert(t.other_vertex(e, v));
        auto at = [&](uint32_t v) { return Eigen::Vector2d(points[3 * size_t{v}], points[3 * size_t{v} + 1]); };
        for (const uint32_t v : patch)
            for (const uint32_t c : t.corners_of_vertex(v)) {
                const Eigen::Vector2d a = at(t.face_vertices[t.next_corner(c)]) - at(v),
                                      b = at(t.face_vertices[t.previous_corner(c)]) - at(v);
                EXPECT_GT(a.x() * b.y() - a.y() * b.x(), 0.01 * a.norm() * b.norm());
            }
    }
}

TEST(ButterflyG1, EigenvaluesAroundAVertex) {
    for (uint32_t n = 3; n <= 20; ++n) {
        SCOPED_TRACE(n);
        const ControlMesh mesh = control_mesh_of(make_star(n, 3, false, true));
        const auto stage = build_first_stage(mesh, scheme_of("butterfly-g1"));
        ASSERT_TRUE(stage);
        const Topology& t = stage->topology;
        // Neighbours, the points opposite, the points straight behind; and what becomes them.
        std::vector<uint32_t> points = {0}, rows = {0};
        for (const uint32_t e : t.edges_of_vertex(0)) {
            points.push_back(t.other_vertex(e, 0));
            rows.push_back(t.vertex_count + e);
        }
        for (const uint32_t c : t.corners_of_vertex(0)) {
            const uint32_t opposite = t.face_edges[t.next_corner(c)], u = t.face_vertices[t.next_corner(c)];
            for (const uint32_t at : t.corners_of_edge(opposite))
                if (t.face_of_corner(at) != t.face_of_corner(c))
                    points.push_back(t.face_vertices[t.previous_corner(at)]);
            rows.push_back(t.vertex_count + opposite);
            const auto around = t.edges_of_vertex(u);
            const auto own = std::find(around.begin(), around.end(), t.face_edges[c]) - around.begin();
            points.push_back(t.other_vertex(around[static_cast<size_t>(own + 3) % 6], u));
            rows.push_back(u);
        }
        const auto values = eigenvalues_of(step_between(mesh, scheme_of("butterfly-g1"), points, rows));
        EXPECT_NEAR(values[0], 1, 1e-12);
        EXPECT_NEAR(values[1], values[2], 1e-7);
        EXPECT_GT(values[1], 0.3999);
        EXPECT_LT(values[3], 0.9 * values[1] + 1e-7);
    }
}

/// Of a corner vertex with k faces: each with an equal share.
std::vector<double> angles_of(const ControlMesh& mesh, double angle, uint32_t k) {
    return std::vector<double>(mesh.face_vertices.size(), angle / k);
}

TEST(PiecewiseSmooth, TwoEigenvaluesOfOneHalfLead) {
    for (const char* name : {"catmark-blz", "loop-blz"})
        for (uint32_t k = 2; k <= 9; ++k)
            for (const double angle : {0.0, 0.4 * M_PI, 0.9 * M_PI, 1.1 * M_PI, 1.5 * M_PI, 1.9 * M_PI}) {
                SCOPED_TRACE(std::string(name) + " " + std::to_string(k) + " " + std::to_string(angle));
                RefinedMesh star = make_star(k, 2, true, name == std::string("loop-blz"));
                ControlMeshDescription description;
                description.vertex_count = star.vertex_count();
                description.face_sizes = star.face_sizes;
                description.face_vertices = star.face_vertices;
                const uint32_t corner = 0;
                const float sharpness = kInfiniteSharpness;
                if (angle != 0)
                    description.corner_vertices = {&corner, 1}, description.corner_sharpness = {&sharpness, 1};
                const auto mesh = ControlMesh::create(description);
                ASSERT_TRUE(mesh);
                const auto values = eigenvalues_of(star_step(*mesh, scheme_of(name), angles_of(*mesh, angle, k)));
                EXPECT_NEAR(values[0], 1, 1e-12);
                EXPECT_NEAR(values[1], 0.5, 1e-10);
                EXPECT_NEAR(values[2], 0.5, 1e-10);
                EXPECT_LT(values[3], 0.5 - 1e-3);
            }
}

TEST(PiecewiseSmooth, OrdinaryRulesLoseTheTangentPlane) {
    EXPECT_GT(eigenvalues_of(star_step(control_mesh_of(make_star(6, 2, true, false)), scheme_of("catmark")))[1], 0.51);
    EXPECT_GT(eigenvalues_of(star_step(control_mesh_of(make_star(8, 2, true, true)), scheme_of("loop")))[1], 0.51);
}

/// Left eigenvectors of one half, across the boundary.
TEST(PiecewiseSmooth, CrossTangents) {
    for (const bool triangles : {false, true})
        for (uint32_t k = 2; k <= 8; ++k) {
            const StarStep step = star_step(control_mesh_of(make_star(k, 2, true, triangles)),
                                            scheme_of(triangles ? "loop-blz" : "catmark-blz"));
            const double a = M_PI / k, c = std::cos(a);
            Eigen::RowVectorXd tangent = Eigen::RowVectorXd::Zero(step.matrix.cols());
            if (triangles) {
                const double gamma = 0.5 - c / 4;
                tangent(0) = -std::sin(a);
                tangent(1) = tangent(k + 1) = std::sin(a) / 4 - (0.75 - gamma) / std::tan(a / 2);
                for (uint32_t i = 1; i < k; ++i) tangent(1 + i) = std::sin(i * a);
            } else {
                const double r = (1 + c) / std::sin(a), d = k * (3 + c);
                tangent(0) = 4 * r * (c - 1) / d;
                tangent(1) = tangent(k + 1) = -r * (1 + 2 * c) / d;
                for (uint32_t i = 1; i < k; ++i) tangent(1 + i) = 4 * std::sin(i * a) / d;
                for (uint32_t i = 0; i < k; ++i) tangent(k + 2 + i) = (std::sin(i * a) + std::sin((i + 1) * a)) / d;
            }
            EXPECT_LT((tangent * step.matrix - tangent / 2).cwiseAbs().maxCoeff(), 1e-13) << triangles << k;
        }
}

std::vector<double> refine_creased(const RefinedMesh& mesh, const char* name, const std::vector<uint32_t>& chain,
                                   float sharpness) {
    ControlMeshDescription description;
    description.options.boundary = BoundaryInterpolation::edge_and_corner;
    description.vertex_count = mesh.vertex_count();
    description.face_sizes = mesh.face_sizes;
    description.face_vertices = mesh.face_vertices;
    const auto size = static_cast<uint32_t>(chain.size());
    description.crease_sizes = {&size, size == 0 ? 0u : 1u};
    description.crease_vertices = chain;
    description.crease_sharpness = {&sharpness, size == 0 ? 0u : 1u};
    const auto control = ControlMesh::create(description);
    EXPECT_TRUE(control);
    const auto refined = build_scheme_refinement<double>(*control, scheme_of(name), {3});
    EXPECT_TRUE(refined);
    std::vector<double> points = mesh.points;
    for (const auto& table : refined->tables) {
        std::vector<double> next(size_t{3} * table.row_count());
        apply_stencil_table<double>(table, points, next, 3);
        points = std::move(next);
    }
    return points;
}

/// Both sides of a crease that stays sharp are as if they were alone.
TEST(PiecewiseSmooth, CreasesAreBoundariesOfBothSides) {
    const RefinedMesh whole = make_random_grid(7, 4, 11);
    std::vector<uint32_t> crease;
    RefinedMesh half = make_random_grid(4, 4, 1);
    for (uint32_t j = 0; j < 4; ++j) {
        crease.push_back(7 * j + 3);
        for (uint32_t i = 0; i < 4; ++i)
            for (size_t k = 0; k < 3; ++k)
                half.points[3 * (size_t{4} * j + i) + k] = whole.points[3 * (size_t{7} * j + i) + k];
    }
    const auto all = refine_creased(whole, "catmark-blz", crease, kInfiniteSharpness);
    const auto side = refine_creased(half, "catmark-blz", {}, 0);
    for (size_t v = 0; v < side.size(); v += 3) EXPECT_LT(distance_to(side.data() + v, all), 1e-13);
}

/// While a crease does not stay sharp it is Catmull-Clark's and Loop's.
TEST(PiecewiseSmooth, SemiSharpCreasesAreOrdinary) {
    for (const bool triangles : {false, true}) {
        const RefinedMesh mesh = make_irregular_mesh(scheme_of(triangles ? "loop" : "catmark"), false, 12);
        const std::vector<uint32_t> edge = {mesh.face_vertices[0], mesh.face_vertices[1]};
        EXPECT_EQ(refine_creased(mesh, triangles ? "loop-blz" : "catmark-blz", edge, 1.6f),
                  refine_creased(mesh, triangles ? "loop" : "catmark", edge, 1.6f));
    }
}

TEST(PiecewiseSmooth, AnglesStayWithTheirCorners) {
    for (const char* name : {"catmark-blz", "loop-blz"}) {
        const SubdivisionScheme& scheme = scheme_of(name);
        const ControlMesh mesh = control_mesh_of(make_irregular_mesh(scheme, true, 9));
        std::vector<double> angles(mesh.face_vertices.size());
        std::iota(angles.begin(), angles.end(), 1);
        const auto refined = build_scheme_refinement<double>(mesh, scheme, {1, true}, angles);
        ASSERT_TRUE(refined);
        const Topology& t = refined->mesh();
        for (uint32_t c = 0; c < t.corner_count(); ++c) {
            if (t.face_vertices[c] >= mesh.vertex_count) continue;
            const uint32_t face = t.face_of_corner(c), parent = face / 4 * 3 + face % 4;
            EXPECT_EQ(refined->last.intervals[c], angles[scheme.faces == FaceKind::triangles ? parent : face]);
        }
    }
}

}  // namespace
}  // namespace limn::test
