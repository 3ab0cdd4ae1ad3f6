// What holds for every scheme, whichever its masks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "limn/stencil_table.h"
#include "schemes/scheme_meshes.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

class EveryScheme : public testing::TestWithParam<SubdivisionScheme> {
  protected:
    const SubdivisionScheme& scheme() const { return *find_subdivision_scheme(GetParam().name); }
};

uint32_t steps_of(const SubdivisionScheme& scheme) {
    return scheme.passes.size() > 3 ? 2 : 3;
}

/// Schemes whose boundary vertices and edges leave nothing behind.
bool shrinks(const SubdivisionScheme& scheme) {
    return std::string(scheme.name) == "mid-edge" || std::string(scheme.name) == "honeycomb";
}

TEST_P(EveryScheme, RowsSumToOne) {
    for (const bool open : {false, true}) {
        const auto refined = build_scheme_refinement<double>(control_mesh_of(make_irregular_mesh(scheme(), open, 1)),
                                                             scheme(), {steps_of(scheme())});
        ASSERT_TRUE(refined) << refined.error().message;
        double worst = 0;
        for (const auto& table : refined->tables)
            for (uint32_t r = 0; r < table.row_count(); ++r) {
                double sum = 0;
                for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k) {
                    EXPECT_LT(table.indices[k], table.source_count);
                    sum += table.weights[k];
                }
                worst = std::max(worst, std::abs(sum - 1));
            }
        EXPECT_LT(worst, 1e-14) << (open ? "open" : "closed");
    }
}

/// Vertices - edges + faces.
int euler(const RefinedMesh& mesh) {
    std::set<std::pair<uint32_t, uint32_t>> edges, directed;
    size_t begin = 0;
    for (const uint32_t n : mesh.face_sizes) {
        for (size_t i = 0; i < n; ++i) {
            const uint32_t a = mesh.face_vertices[begin + i], b = mesh.face_vertices[begin + (i + 1) % n];
            edges.insert({std::min(a, b), std::max(a, b)});
            EXPECT_TRUE(directed.insert({a, b}).second) << "an edge twice the same way round";
        }
        begin += n;
    }
    return static_cast<int>(mesh.vertex_count()) - static_cast<int>(edges.size()) +
           static_cast<int>(mesh.face_sizes.size());
}

TEST_P(EveryScheme, TopologyIsKept) {
    for (const bool open : {false, true}) {
        const RefinedMesh mesh = make_irregular_mesh(scheme(), open, 2);
        for (uint32_t level = 1; level <= 3; ++level) {
            if (open && shrinks(scheme())) continue;  // what boundary vertices alone held together falls apart
            EXPECT_EQ(euler(refine_mesh(mesh, scheme(), level)), euler(mesh)) << (open ? "open" : "closed") << level;
        }
    }
}

/// Points as a sorted list, each rounded away from noise.
std::vector<std::array<double, 3>> sorted_points(const RefinedMesh& mesh) {
    std::vector<std::array<double, 3>> points;
    for (size_t v = 0; v < mesh.points.size(); v += 3) {
        std::array<double, 3> p;
        for (size_t k = 0; k < 3; ++k) p[k] = std::round(mesh.points[v + k] * 1e10) / 1e10 + 0.0;
        points.push_back(p);
    }
    std::sort(points.begin(), points.end());
    return points;
}

double largest_difference(const std::vector<std::array<double, 3>>& a, const std::vector<std::array<double, 3>>& b) {
    if (a.size() != b.size()) return HUGE_VAL;
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i)
        for (size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(a[i][k] - b[i][k]));
    return worst;
}

/// The same mesh, numbered otherwise: vertices, faces, where faces begin and, on request, which way round they go.
RefinedMesh renumber(const RefinedMesh& mesh, bool reversed, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<uint32_t> vertex(mesh.vertex_count()), face(mesh.face_sizes.size()), begin;
    std::iota(vertex.begin(), vertex.end(), 0u);
    std::iota(face.begin(), face.end(), 0u);
    for (size_t i = vertex.size(); i > 1; --i) std::swap(vertex[i - 1], vertex[random.below(static_cast<uint32_t>(i))]);
    for (size_t i = face.size(); i > 1; --i) std::swap(face[i - 1], face[random.below(static_cast<uint32_t>(i))]);
    uint32_t sum = 0;
    for (const uint32_t n : mesh.face_sizes) begin.push_back(std::exchange(sum, sum + n));
    RefinedMesh out;
    out.points.resize(mesh.points.size());
    for (size_t v = 0; v < vertex.size(); ++v)
        for (size_t k = 0; k < 3; ++k) out.points[3 * size_t{vertex[v]} + k] = mesh.points[3 * v + k];
    for (const uint32_t f : face) {
        const uint32_t n = mesh.face_sizes[f], turn = random.below(n);
        out.face_sizes.push_back(n);
        for (uint32_t i = 0; i < n; ++i)
            out.face_vertices.push_back(
                vertex[mesh.face_vertices[begin[f] + (reversed ? 2 * n - i + turn : i + turn) % n]]);
    }
    return out;
}

TEST_P(EveryScheme, OrderDoesNotMatter) {
    for (const bool open : {false, true})
        for (const bool reversed : {false, true}) {
            const RefinedMesh mesh = make_irregular_mesh(scheme(), open, 3);
            const uint32_t level = steps_of(scheme()) - 1;
            const auto a = sorted_points(refine_mesh(mesh, scheme(), level));
            const auto b = sorted_points(refine_mesh(renumber(mesh, reversed, 4), scheme(), level));
            EXPECT_LT(largest_difference(a, b), 1e-9) << (open ? "open" : "closed") << reversed;
        }
}

TEST_P(EveryScheme, AffineMapsCommute) {
    const RefinedMesh mesh = make_irregular_mesh(scheme(), true, 5);
    auto map = [](RefinedMesh m) {
        for (size_t v = 0; v < m.points.size(); v += 3) {
            const double x = m.points[v], y = m.points[v + 1], z = m.points[v + 2];
            m.points[v] = 2 * x - y + 3;
            m.points[v + 1] = x + 0.5 * z - 1;
            m.points[v + 2] = -x + y + z;
        }
        return m;
    };
    const RefinedMesh a = map(refine_mesh(mesh, scheme(), 2)), b = refine_mesh(map(mesh), scheme(), 2);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (size_t i = 0; i < a.points.size(); ++i) ASSERT_NEAR(a.points[i], b.points[i], 1e-13);
}

TEST_P(EveryScheme, InterpolatesWhereItSaysSo) {
    const RefinedMesh mesh = make_irregular_mesh(scheme(), false, 6);
    const auto refined = sorted_points(refine_mesh(mesh, scheme(), 2));
    size_t kept = 0;
    for (const auto& p : sorted_points(mesh)) kept += std::binary_search(refined.begin(), refined.end(), p);
    if (scheme().interpolates)
        EXPECT_EQ(kept, mesh.vertex_count());
    else
        EXPECT_LT(kept, mesh.vertex_count());
}

/// Boundary curves depend on boundary vertices alone: moving all others moves no boundary point.
TEST_P(EveryScheme, BoundariesStandAlone) {
    const RefinedMesh mesh = make_irregular_mesh(scheme(), true, 7);
    const ControlMesh control = control_mesh_of(mesh);
    const auto refined = build_scheme_refinement<double>(control, scheme(), {2, true});
    ASSERT_TRUE(refined) << refined.error().message;
    const auto table = multiply_tables<double>(refined->tables);
    ASSERT_TRUE(table);
    const auto stage = build_first_stage(control, scheme());
    ASSERT_TRUE(stage);
    auto on_boundary = [](const Topology& t, uint32_t v) {
        return t.edges_of_vertex(v).size() != t.corners_of_vertex(v).size();
    };
    for (uint32_t r = 0; !shrinks(scheme()) && r < table->row_count(); ++r) {
        if (!on_boundary(refined->mesh(), r)) continue;
        for (uint32_t k = table->offsets[r]; k < table->offsets[r + 1]; ++k)
            EXPECT_TRUE(on_boundary(stage->topology, table->indices[k]) || table->weights[k] == 0);
    }
}

/// Boundary vertices with one face stay where they are on request.
TEST_P(EveryScheme, FixedCornersStay) {
    SchemeOptions options;
    options.boundary = BoundaryInterpolation::edge_and_corner;
    const RefinedMesh mesh = make_irregular_mesh(scheme(), true, 9);
    const auto stage = build_first_stage(control_mesh_of(mesh, options), scheme());
    ASSERT_TRUE(stage);
    const auto refined = sorted_points(refine_mesh(mesh, scheme(), 3, options));
    // Averages of boundary edges know no vertices.
    const bool averages = std::any_of(scheme().passes.begin(), scheme().passes.end(),
                                      [](const Pass& pass) { return pass.split == SplitKind::dual; });
    for (uint32_t v = 0; v < mesh.vertex_count() && !shrinks(scheme()) && !averages; ++v) {
        if (stage->topology.corners_of_vertex(v).size() != 1) continue;
        std::array<double, 3> p;
        for (size_t k = 0; k < 3; ++k) p[k] = std::round(mesh.points[3 * size_t{v} + k] * 1e10) / 1e10 + 0.0;
        EXPECT_TRUE(std::binary_search(refined.begin(), refined.end(), p)) << "vertex " << v;
    }
}

std::string name_of_scheme(const testing::TestParamInfo<SubdivisionScheme>& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Schemes, EveryScheme,
                         testing::ValuesIn(subdivision_schemes().begin(), subdivision_schemes().end()), name_of_scheme);

TEST(SchemeRefinement, EqualsTheFirstThreeSchemes) {
    for (const char* name : {"catmark", "loop", "bilinear"}) {
        SCOPED_TRACE(name);
        const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
        SchemeOptions options;
        options.scheme = scheme.faces == FaceKind::triangles ? Scheme::loop
                         : scheme.interpolates               ? Scheme::bilinear
                                                             : Scheme::catmull_clark;
        const ControlMesh mesh = control_mesh_of(make_irregular_mesh(scheme, true, 8), options);
        const auto refined = build_scheme_refinement<double>(mesh, scheme, {3});
        ASSERT_TRUE(refined);
        const auto refinement = build_refinement(mesh, {3});
        ASSERT_TRUE(refinement);
        for (uint32_t level = 1; level <= 3; ++level) {
            const auto table = build_step_table<double>(*refinement, level);
            ASSERT_TRUE(table);
            const auto& own = refined->tables[level - 1];
            EXPECT_TRUE(std::ranges::equal(own.indices, table->indices));
            EXPECT_TRUE(std::ranges::equal(own.weights, table->weights));
        }
        EXPECT_TRUE(std::ranges::equal(refined->mesh().face_vertices, refinement->last().face_vertices));
    }
}

}  // namespace
}  // namespace limn::test
