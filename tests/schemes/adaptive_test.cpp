// Adaptive subdivision: closed, balanced, on the uniform refinement's limits, as near as is asked for.
#include "limn/schemes/adaptive.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "limn/schemes/scheme_limit.h"
#include "schemes/scheme_meshes.h"

namespace limn::test {
namespace {

std::vector<SubdivisionScheme> adaptive_schemes() {
    std::vector<SubdivisionScheme> schemes;
    for (const SubdivisionScheme& scheme : subdivision_schemes())
        if (is_adaptive(scheme)) schemes.push_back(scheme);
    return schemes;
}

class EveryAdaptive : public testing::TestWithParam<SubdivisionScheme> {
  protected:
    /// One of the table: tables of limits keep its address.
    const SubdivisionScheme& scheme() const { return *find_subdivision_scheme(GetParam().name); }
    bool in_four() const {
        return scheme().passes[0].split == SplitKind::quads ||
               scheme().passes[0].split == SplitKind::triangles;
    }
    bool is_linear() const { return scheme().rings == 1; }
    /// Steps that cut edges in four or so.
    uint32_t steps() const { return in_four() ? 2 : 4; }
};

std::vector<double> apply_table(const StencilTableDouble& table, const std::vector<double>& points) {
    std::vector<double> out(size_t{3} * table.row_count());
    apply_stencil_table<double>(table, points, out, 3);
    return out;
}

/// Limits of all vertices of a uniform refinement.
std::vector<double> uniform_limits(const SchemeRefinementDouble& refined, std::vector<double> points) {
    for (const auto& table : refined.tables) points = apply_table(table, points);
    const auto limits = build_scheme_limit_table(refined, false);
    EXPECT_TRUE(limits);
    return apply_table(*limits, points);
}

AdaptiveSurfaceDouble build(const RefinedMesh& mesh, const SubdivisionScheme& scheme,
                            const AdaptiveSurfaceOptions& options) {
    auto surface = build_adaptive_surface<double>(control_mesh_of(mesh), scheme, mesh.points, options);
    EXPECT_TRUE(surface) << surface.error().message;
    return surface ? std::move(*surface) : AdaptiveSurfaceDouble{};
}

/// The face to the left of each edge, by its vertices; fails where there are two.
using Edge = std::pair<uint32_t, uint32_t>;
template <class Faces>
std::map<Edge, uint32_t> edges_of(const Faces& sizes, std::span<const uint32_t> vertices) {
    std::map<Edge, uint32_t> edges;
    size_t begin = 0;
    for (uint32_t f = 0; f < sizes.size(); begin += sizes[f++])
        for (size_t i = 0; i < sizes[f]; ++i)
            EXPECT_TRUE(
                edges.emplace(Edge{vertices[begin + i], vertices[begin + (i + 1) % sizes[f]]}, f).second);
    return edges;
}

/// Loops of edges with nothing on one side, and V - E + F: a hanging vertex or a crack changes one of them.
struct Shape {
    size_t loops = 0;
    int64_t characteristic = 0;
    bool operator==(const Shape&) const = default;
};
Shape shape_of(const std::map<Edge, uint32_t>& edges, size_t face_count) {
    std::set<uint32_t> vertices;
    std::map<uint32_t, uint32_t> next;  // around what is open
    int64_t edge_count = 0;
    for (const auto& [edge, face] : edges) {
        vertices.insert(edge.first);
        const bool open = edges.count({edge.second, edge.first}) == 0;
        edge_count += open || edge.first < edge.second;
        if (!open) continue;
        EXPECT_TRUE(next.emplace(edge.first, edge.second).second);
    }
    Shape out;
    out.characteristic =
        static_cast<int64_t>(vertices.size()) - edge_count + static_cast<int64_t>(face_count);
    while (!next.empty()) {
        ++out.loops;
        for (auto at = next.begin(); at != next.end();) {
            const uint32_t to = at->second;
            next.erase(at);
            at = next.find(to);
        }
    }
    return out;
}

std::vector<uint32_t> sizes_of(const AdaptiveSurfaceDouble& surface) {
    std::vector<uint32_t> sizes;
    for (size_t f = 0; f + 1 < surface.face_offsets.size(); ++f)
        sizes.push_back(surface.face_offsets[f + 1] - surface.face_offsets[f]);
    return sizes;
}

/// Five times the triangles of the control mesh, which no even refinement makes: neither all that so many
/// steps make nor none.
AdaptiveSurfaceDouble build_some(const RefinedMesh& mesh, const SubdivisionScheme& scheme, uint32_t steps) {
    const size_t few = mesh.face_vertices.size() - 2 * mesh.face_sizes.size();
    return build(mesh, scheme, {.max_level = steps, .max_triangles = static_cast<uint32_t>(5 * few)});
}

TEST_P(EveryAdaptive, IsClosedAndBalanced) {
    if (is_linear()) return;  // AsFlatAsTheControlMesh
    // Wide masks take long where no two neighbourhoods are alike.
    const bool random = scheme().faces != FaceKind::quads && scheme().rings <= 3;
    for (const bool open : {false, true})
        for (uint64_t seed = 1; seed <= 2; ++seed) {
            SCOPED_TRACE(testing::Message() << (open ? "open " : "closed ") << seed);
            const RefinedMesh mesh = random && seed == 1 ? make_random_manifold(scheme(), open, seed)
                                                         : make_irregular_mesh(scheme(), open, seed);
            const AdaptiveSurfaceDouble surface = build_some(mesh, scheme(), steps() + in_four());
            const auto sizes = sizes_of(surface);
            const auto edges = edges_of(sizes, surface.face_vertices);
            EXPECT_EQ(shape_of(edges, sizes.size()),
                      shape_of(edges_of(mesh.face_sizes, mesh.face_vertices), mesh.face_sizes.size()));
            EXPECT_EQ(shape_of(edges, sizes.size()).loops == 0, !open);
            size_t unlike = 0;
            for (const auto& [edge, face] : edges) {
                const auto beside = edges.find({edge.second, edge.first});
                if (beside == edges.end()) continue;
                const int difference = surface.face_levels[face] - surface.face_levels[beside->second];
                EXPECT_LE(std::abs(difference), 1);
                unlike += difference != 0;
            }
            EXPECT_GT(unlike, 0u);
            const std::vector<uint32_t> threes(surface.triangles.size() / 3, 3);
            EXPECT_EQ(shape_of(edges_of(threes, surface.triangles), threes.size()),
                      shape_of(edges, sizes.size()));
        }
}

TEST_P(EveryAdaptive, VerticesAreThoseOfUniformRefinement) {
    for (const bool open : {false, true}) {
        SCOPED_TRACE(open ? "open" : "closed");
        const RefinedMesh mesh = make_irregular_mesh(scheme(), open, 5);
        const AdaptiveSurfaceDouble surface = build_some(mesh, scheme(), steps());
        const auto refined =
            build_scheme_refinement<double>(control_mesh_of(mesh), scheme(), {steps(), true});
        ASSERT_TRUE(refined);
        const std::vector<double> limits = uniform_limits(*refined, mesh.points);
        const std::vector<double> points = apply_table(surface.limit, mesh.points);
        ASSERT_EQ(points.size(), 3 * surface.uniform_vertices.size());
        for (size_t v = 0; v < surface.uniform_vertices.size(); ++v)
            for (size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(points[3 * v + k], limits[3 * size_t{surface.uniform_vertices[v]} + k], 1e-13);
    }
}

TEST_P(EveryAdaptive, EverywhereIsUniform) {
    if (is_linear()) return;
    for (const bool open : {false, true}) {
        SCOPED_TRACE(open ? "open" : "closed");
        const RefinedMesh mesh = make_irregular_mesh(scheme(), open, 6);
        const AdaptiveSurfaceDouble surface = build(mesh, scheme(), {0, steps()});
        const auto refined =
            build_scheme_refinement<double>(control_mesh_of(mesh), scheme(), {steps(), true});
        ASSERT_TRUE(refined);
        ASSERT_EQ(surface.face_vertices.size(), refined->mesh().corner_count());
        for (size_t c = 0; c < surface.face_vertices.size(); ++c)
            ASSERT_EQ(surface.uniform_vertices[surface.face_vertices[c]], refined->mesh().face_vertices[c]);
        EXPECT_EQ(surface.level, steps());
        EXPECT_FALSE(surface.reached);
    }
}

TEST_P(EveryAdaptive, AsFlatAsTheControlMesh) {
    const RefinedMesh mesh = make_irregular_mesh(scheme(), false, 7);
    const AdaptiveSurfaceDouble coarse = build(mesh, scheme(), {1e-12, 3});
    EXPECT_EQ(coarse.level == 0, scheme().name == std::string("linear"));
    const AdaptiveSurfaceDouble any = build(mesh, scheme(), {1e3, 3});
    EXPECT_EQ(any.level, 0u);
    EXPECT_TRUE(any.reached);
    EXPECT_EQ(sizes_of(any), mesh.face_sizes);
}

std::string name_of_scheme(const testing::TestParamInfo<SubdivisionScheme>& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Schemes, EveryAdaptive, testing::ValuesIn(adaptive_schemes()), name_of_scheme);

/// The nearest point of a triangle, by its barycentric coordinates (least squares within all of its sides).
double distance_to(const Eigen::Vector3d& p, const Eigen::Vector3d (&t)[3]) {
    double least = INFINITY;
    Eigen::Matrix<double, 3, 2> sides;
    sides << t[1] - t[0], t[2] - t[0];
    const Eigen::Vector2d uv = sides.colPivHouseholderQr().solve(p - t[0]);
    if (uv.minCoeff() >= 0 && uv.sum() <= 1) least = (t[0] + sides * uv - p).norm();
    for (size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d side = t[(i + 1) % 3] - t[i];
        const double at = std::clamp(side.dot(p - t[i]) / side.squaredNorm(), 0.0, 1.0);
        least = std::min(least, (t[i] + at * side - p).norm());
    }
    return least;
}

/// How far the farthest of `points` is from the triangles.
double farthest(const std::vector<double>& points, const AdaptiveSurfaceDouble& surface,
                const std::vector<double>& vertices) {
    const auto at = [](const std::vector<double>& from, size_t i) {
        return Eigen::Vector3d(from[3 * i], from[3 * i + 1], from[3 * i + 2]);
    };
    double most = 0;
    for (size_t i = 0; i < points.size() / 3; ++i) {
        double least = INFINITY;
        for (size_t k = 0; k < surface.triangles.size(); k += 3) {
            const Eigen::Vector3d triangle[3] = {at(vertices, surface.triangles[k]),
                                                 at(vertices, surface.triangles[k + 1]),
                                                 at(vertices, surface.triangles[k + 2])};
            least = std::min(least, distance_to(at(points, i), triangle));
        }
        most = std::max(most, least);
    }
    return most;
}

TEST(Adaptive, MissesByNoMoreThanTheTolerance) {
    for (const char* name : {"kobbelt", "sabin", "loop-warren", "sqrt3", "sqrt3-interpolatory", "4-8"}) {
        SCOPED_TRACE(name);
        const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
        const bool fast =
            scheme.passes[0].split == SplitKind::quads || scheme.passes[0].split == SplitKind::triangles;
        const RefinedMesh mesh = make_irregular_mesh(scheme, false, 3);
        const auto refined =
            build_scheme_refinement<double>(control_mesh_of(mesh), scheme, {fast ? 3u : 5u, true});
        ASSERT_TRUE(refined);
        const std::vector<double> dense = uniform_limits(*refined, mesh.points);
        size_t triangles = 0;
        double last = INFINITY;
        for (const double tolerance : {0.1, 0.02, 0.005}) {
            const AdaptiveSurfaceDouble surface = build(mesh, scheme, {tolerance, fast ? 6u : 10u});
            EXPECT_TRUE(surface.reached);
            const double missed = farthest(dense, surface, apply_table(surface.limit, mesh.points));
            // Children may miss their parent's children again: a quarter or so each time.
            EXPECT_LE(missed, 2 * tolerance);
            EXPECT_LT(missed, last);
            EXPECT_GT(surface.triangles.size(), triangles);
            last = missed;
            triangles = surface.triangles.size();
        }
    }
}

TEST(Adaptive, KeepsToAMostOfTriangles) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme("sqrt3");
    const RefinedMesh mesh = make_random_manifold(scheme, false, 4);
    const size_t few = build(mesh, scheme, {0, 0}).triangles.size() / 3;
    size_t last = 0;
    for (const size_t most : {few, 2 * few, 5 * few}) {
        const AdaptiveSurfaceDouble surface =
            build(mesh, scheme, {.max_level = 4, .max_triangles = static_cast<uint32_t>(most)});
        const size_t count = surface.triangles.size() / 3;
        EXPECT_LE(count, most);
        EXPECT_GT(count, last);
        last = count;
        const AdaptiveSurfaceDouble again = build(mesh, scheme, {surface.tolerance, 4});
        EXPECT_EQ(again.triangles.size(), surface.triangles.size());
        const AdaptiveSurfaceDouble finer = build(mesh, scheme, {surface.tolerance * (1 - 1e-9), 4});
        EXPECT_GT(finer.triangles.size() / 3, most) << "the least tolerance";
    }
    const auto refused = build_adaptive_surface<double>(control_mesh_of(mesh), scheme, mesh.points,
                                                        {.max_triangles = static_cast<uint32_t>(few - 1)});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::too_large);
}

TEST(Adaptive, EvaluatesAsASchemeSurface) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme("kobbelt");
    const RefinedMesh mesh = make_irregular_mesh(scheme, false, 2);
    const AdaptiveSurfaceDouble surface = build(mesh, scheme, {0.02, 5});
    auto single = build_adaptive_surface<float>(control_mesh_of(mesh), scheme, mesh.points, {0.02, 5});
    ASSERT_TRUE(single);
    const SchemeSurface frame = make_scheme_surface(std::move(*single));
    const std::vector<float> points(mesh.points.begin(), mesh.points.end());
    const SchemeVertices vertices = apply_scheme_surface(frame, points);
    const std::vector<double> expected = apply_table(surface.limit, mesh.points);
    ASSERT_EQ(vertices.positions.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(vertices.positions[i], expected[i], 2e-6);
    for (size_t v = 0; v < expected.size();
         v += 3) {  // a closed shape around the origin: normals point out of it
        double length = 0;
        for (size_t k = 0; k < 3; ++k)
            length += double{vertices.normals[v + k]} * double{vertices.normals[v + k]};
        EXPECT_NEAR(length, 1, 1e-5);
    }
}

TEST(Adaptive, SaysWhatIsWrong) {
    const SubdivisionScheme& doo_sabin = *find_subdivision_scheme("doo-sabin");
    const RefinedMesh mesh = make_irregular_mesh(doo_sabin, false, 1);
    const auto code = [&](const SubdivisionScheme& scheme, std::span<const double> points, double tolerance) {
        const auto surface =
            build_adaptive_surface<double>(control_mesh_of(mesh), scheme, points, {tolerance, 1});
        EXPECT_FALSE(surface);
        return surface ? ErrorCode::cancelled : surface.error().code;
    };
    const SubdivisionScheme& sabin = *find_subdivision_scheme("sabin");
    EXPECT_EQ(code(doo_sabin, mesh.points, 0.1), ErrorCode::unsupported);
    EXPECT_EQ(code(sabin, std::span(mesh.points).first(3), 0.1), ErrorCode::invalid_argument);
    EXPECT_EQ(code(sabin, mesh.points, -1), ErrorCode::invalid_argument);
    EXPECT_EQ(code(sabin, mesh.points, NAN), ErrorCode::invalid_argument);
    EXPECT_EQ(code(*find_subdivision_scheme("sqrt3"), mesh.points, 0.1), ErrorCode::not_a_triangle);
}

}  // namespace
}  // namespace limn::test
