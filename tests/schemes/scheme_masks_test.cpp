// What schemes are on regular meshes: the column of a vertex is the mask of a spline, a box spline or an interpolatory
// rule, whose weights are known without any mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "schemes/scheme_meshes.h"

namespace limn::test {
namespace {

/// Weights of a mask by position in the refined lattice.
using Mask = std::map<std::pair<int, int>, double>;

Mask operator*(const Mask& a, const Mask& b) {
    Mask product;
    for (const auto& [p, u] : a)
        for (const auto& [q, v] : b) product[{p.first + q.first, p.second + q.second}] += u * v;
    return product;
}
Mask power(const Mask& a, uint32_t exponent) {
    Mask product = {{{0, 0}, 1}};
    for (uint32_t i = 0; i < exponent; ++i) product = product * a;
    return product;
}
/// (1 + z^d) / 2
Mask along(int x, int y) {
    return {{{0, 0}, 0.5}, {{x, y}, 0.5}};
}
Mask scaled(double factor, const Mask& a) {
    return Mask{{{0, 0}, factor}} * a;
}
/// Bidegree B-splines.
Mask tensor(uint32_t degree) {
    return scaled(4, power(along(1, 0) * along(0, 1), degree + 1));
}
/// Box splines of three directions, each `count` times.
Mask three_directions(uint32_t count) {
    return scaled(4, power(along(1, 0) * along(0, 1) * along(1, 1), count));
}
Mask four_directions(uint32_t count) {
    return scaled(4, power(along(1, 0) * along(0, 1) * along(1, 1) * along(1, -1), count));
}
/// The weights in a row, tensored.
Mask tensor_of(const std::vector<double>& weights) {
    Mask row, column;
    for (int i = 0; i < static_cast<int>(weights.size()); ++i) {
        row[{i, 0}] = weights[static_cast<size_t>(i)];
        column[{0, i}] = weights[static_cast<size_t>(i)];
    }
    return row * column;
}
/// A vertex and the six around it in the lattice of triangles.
Mask hexagon(double centre, double around) {
    return {{{0, 0}, centre},  {{1, 0}, around}, {{0, 1}, around},  {{-1, 0}, around},
            {{0, -1}, around}, {{1, 1}, around}, {{-1, -1}, around}};
}
/// So many of each weight, wherever they are.
Mask listed(const std::vector<std::pair<int, double>>& weights) {
    Mask mask;
    for (const auto& [count, weight] : weights)
        for (int i = 0; i < count; ++i) mask[{static_cast<int>(mask.size()), 0}] = weight;
    return mask;
}
Mask ten_point_butterfly(double w) {
    return listed({{1, 1}, {6, 0.5 - w}, {6, 0.125 + 2 * w}, {12, -0.0625 - w}, {6, w}});
}

enum class Lattice : uint8_t { quads, triangles, hexagons };
struct Regular {
    Lattice lattice;
    uint32_t steps;
    Mask mask;
};

std::map<std::string, Regular> regular_masks() {
    const Mask linear_sqrt3 = hexagon(1, 1.0 / 3), average = hexagon(1.0 / 3, 1.0 / 9);
    std::map<std::string, Regular> masks = {
        {"catmark", {Lattice::quads, 1, tensor(3)}},
        {"loop", {Lattice::triangles, 1, three_directions(2)}},
        {"loop-warren", {Lattice::triangles, 1, three_directions(2)}},
        {"bilinear", {Lattice::quads, 1, tensor(1)}},
        {"linear", {Lattice::triangles, 1, three_directions(1)}},
        {"doo-sabin", {Lattice::quads, 1, tensor(2)}},
        {"sabin", {Lattice::quads, 1, tensor(3)}},
        {"stam-5", {Lattice::quads, 1, tensor(5)}},
        {"stam-triangles-7", {Lattice::triangles, 1, three_directions(3)}},
        {"kobbelt", {Lattice::quads, 1, tensor_of({-0.0625, 0, 0.5625, 1, 0.5625, 0, -0.0625})}},
        {"butterfly", {Lattice::triangles, 1, ten_point_butterfly(0)}},
        {"butterfly-zorin", {Lattice::triangles, 1, ten_point_butterfly(0)}},
        {"push-back-loop", {Lattice::triangles, 1, ten_point_butterfly(-1.0 / 32)}},
        {"push-back-catmark",
         {Lattice::quads, 1,
          scaled(1.0 / 256, listed({{1, 256}, {4, 140}, {4, -12}, {8, 2}, {8, -2}, {4, 79}, {8, -7}, {4, -1}}))}},
        {"sqrt3", {Lattice::triangles, 1, scaled(1.0 / 18, listed({{1, 12}, {6, 6}, {6, 1}}))}},
        {"sqrt3-composite-2", {Lattice::triangles, 1, linear_sqrt3 * average}},
        {"sqrt3-composite-3", {Lattice::triangles, 1, linear_sqrt3 * average * average}},
        {"sqrt3-interpolatory",
         {Lattice::triangles, 1, scaled(1.0 / 81, listed({{1, 81}, {6, 32}, {6, -1}, {12, -2}}))}},
        {"4-8", {Lattice::quads, 2, four_directions(2)}},
        {"sqrt2-balanced", {Lattice::quads, 2, four_directions(2)}},
        {"sqrt2-interpolatory", {Lattice::quads, 1, scaled(1.0 / 32, listed({{1, 32}, {4, 10}, {8, -1}}))}},
        {"mid-edge", {Lattice::quads, 2, four_directions(1)}},
        {"midpoint", {Lattice::quads, 1, four_directions(1)}},
        {"midpoint-normalised", {Lattice::quads, 1, four_directions(1)}},
        {"honeycomb", {Lattice::hexagons, 1, scaled(1.0 / 18, listed({{6, 7}, {12, 1}}))}},
    };
    for (uint32_t degree = 2; degree <= 9; ++degree)
        masks["averaging-" + std::to_string(degree)] = {Lattice::quads, 1, tensor(degree)};
    return masks;
}

/// A torus of n * n / 2 hexagons, like a wall of bricks.
RefinedMesh make_hexagon_torus(uint32_t n) {
    RefinedMesh mesh = make_regular_torus(n, false);
    mesh.face_sizes.clear();
    mesh.face_vertices.clear();
    for (uint32_t j = 0; j < n; ++j)
        for (uint32_t i = j % 2; i < n; i += 2) {
            mesh.face_sizes.push_back(6);
            for (const auto& [x, y] : {std::pair{0u, 0u}, {1u, 0u}, {2u, 0u}, {2u, 1u}, {1u, 1u}, {0u, 1u}})
                mesh.face_vertices.push_back((j + y) % n * n + (i + x) % n);
        }
    return mesh;
}

RefinedMesh make_lattice(Lattice lattice) {
    constexpr uint32_t n = 12;  // wider than any mask
    return lattice == Lattice::hexagons ? make_hexagon_torus(n) : make_regular_torus(n, lattice == Lattice::triangles);
}

/// The weights with which each control point enters refined ones, sorted.
std::vector<std::vector<double>> columns_of(const RefinedMesh& mesh, const SubdivisionScheme& scheme, uint32_t steps) {
    const auto refined = build_scheme_refinement<double>(control_mesh_of(mesh), scheme, {steps});
    EXPECT_TRUE(refined);
    const auto table = multiply_tables<double>(refined->tables);
    EXPECT_TRUE(table);
    std::vector<std::vector<double>> columns(mesh.vertex_count());
    for (size_t k = 0; k < table->indices.size(); ++k)
        if (std::abs(table->weights[k]) > 1e-14) columns[table->indices[k]].push_back(table->weights[k]);
    for (auto& column : columns) std::sort(column.begin(), column.end());
    return columns;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return HUGE_VAL;
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
}

TEST(SchemeMasks, AreThoseOfSplines) {
    for (const auto& [name, regular] : regular_masks()) {
        SCOPED_TRACE(name);
        const SubdivisionScheme* scheme = find_subdivision_scheme(name);
        ASSERT_NE(scheme, nullptr);
        std::vector<double> expected;
        for (const auto& [position, weight] : regular.mask)
            if (weight != 0) expected.push_back(weight);
        std::sort(expected.begin(), expected.end());
        for (const auto& column : columns_of(make_lattice(regular.lattice), *scheme, regular.steps))
            ASSERT_LT(largest_difference(column, expected), 1e-12);
    }
}

/// A regular mesh, spacing 1, in the plane; open, so that it has coordinates.
RefinedMesh make_plane(uint32_t n, bool triangles) {
    RefinedMesh mesh = make_regular_torus(n, triangles);
    RefinedMesh out;
    out.points.resize(mesh.points.size());
    for (uint32_t v = 0; v < n * n; ++v) {
        out.points[3 * size_t{v}] = v % n;
        out.points[3 * size_t{v} + 1] = v / n;
    }
    auto begin = mesh.face_vertices.begin();
    for (const uint32_t size : mesh.face_sizes) {  // without those that go round
        const auto end = begin + size;
        const bool inside = std::none_of(begin, end, [&](uint32_t v) {
            return std::abs(out.points[3 * size_t{v}] - out.points[3 * size_t{*begin}]) > 1 ||
                   std::abs(out.points[3 * size_t{v} + 1] - out.points[3 * size_t{*begin} + 1]) > 1;
        });
        if (inside) {
            out.face_sizes.push_back(size);
            out.face_vertices.insert(out.face_vertices.end(), begin, end);
        }
        begin = end;
    }
    return out;
}

class RegularPlane : public testing::TestWithParam<SubdivisionScheme> {
  protected:
    static constexpr uint32_t kSide = 17, kMiddle = kSide / 2;
    const SubdivisionScheme& scheme() const { return *find_subdivision_scheme(GetParam().name); }
    RefinedMesh plane() const { return make_plane(kSide, scheme().faces == FaceKind::triangles); }
    static bool is_inside(const double* p, double margin) {
        return std::min(p[0], p[1]) >= margin && std::max(p[0], p[1]) <= kSide - 1 - margin;
    }
};

/// Away from boundaries a refined vertex is the mean of its neighbours.
TEST_P(RegularPlane, StaysRegular) {
    if (std::string(scheme().name) == "honeycomb") return;  // quads are not regular there
    const RefinedMesh mesh = refine_mesh(plane(), scheme(), 2);
    std::vector<std::set<uint32_t>> neighbors(mesh.vertex_count());
    size_t begin = 0;
    for (const uint32_t n : mesh.face_sizes) {
        for (size_t i = 0; i < n; ++i) {
            const uint32_t a = mesh.face_vertices[begin + i], b = mesh.face_vertices[begin + (i + 1) % n];
            neighbors[a].insert(b);
            neighbors[b].insert(a);
        }
        begin += n;
    }
    size_t count = 0;
    for (uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        const double* p = &mesh.points[3 * size_t{v}];
        if (!is_inside(p, 7)) continue;
        double x = 0, y = 0;
        for (const uint32_t w : neighbors[v]) {
            x += mesh.points[3 * size_t{w}] / static_cast<double>(neighbors[v].size());
            y += mesh.points[3 * size_t{w} + 1] / static_cast<double>(neighbors[v].size());
        }
        EXPECT_NEAR(x, p[0], 1e-12);
        EXPECT_NEAR(y, p[1], 1e-12);
        ++count;
    }
    EXPECT_GT(count, 4u);
}

/// Interpolatory schemes but the linear ones keep cubics.
TEST_P(RegularPlane, KeepsCubicsWhereItInterpolates) {
    if (!scheme().interpolates || scheme().rings == 1) return;
    const auto cubic = [](double x, double y) {
        x = x / kSide - 0.5;
        y = y / kSide - 0.3;
        return x * x * x - 2 * x * x * y + 0.5 * x * y * y + 3 * y * y * y - x * y + y;
    };
    RefinedMesh mesh = plane();
    for (size_t v = 0; v < mesh.points.size(); v += 3) mesh.points[v + 2] = cubic(mesh.points[v], mesh.points[v + 1]);
    const RefinedMesh refined = refine_mesh(mesh, scheme(), 3);
    for (size_t v = 0; v < refined.points.size(); v += 3) {
        const double* p = &refined.points[v];
        if (is_inside(p, 6)) {
            EXPECT_NEAR(p[2], cubic(p[0], p[1]), 1e-12);
        }
    }
}

/// Beside straight boundaries, too, interpolatory schemes put points at halves and thirds of the lattice.
TEST_P(RegularPlane, IsLinearAtBoundariesWhereItInterpolates) {
    if (!scheme().interpolates) return;
    const RefinedMesh refined = refine_mesh(plane(), scheme(), 1);
    for (size_t v = 0; v < refined.points.size(); v += 3) {
        const double* p = &refined.points[v];
        const bool near_corner = std::min(p[0], kSide - 1 - p[0]) < 4 && std::min(p[1], kSide - 1 - p[1]) < 4;
        for (size_t k = 0; k < 2 && !near_corner; ++k) {
            EXPECT_NEAR(6 * p[k], std::round(6 * p[k]), 1e-12) << p[0] << ' ' << p[1];
        }
    }
}

/// No control point reaches further than the scheme says.
TEST_P(RegularPlane, ReachesAsFarAsItSays) {
    const bool triangles = scheme().faces == FaceKind::triangles;
    const uint32_t levels = scheme().period == 1 ? 4 : triangles ? 5 : 7;
    RefinedMesh mesh = plane();
    mesh.points[3 * size_t{kMiddle * kSide + kMiddle} + 2] = 1;
    const RefinedMesh refined = refine_mesh(mesh, scheme(), levels);
    double reach = 0;
    for (size_t v = 0; v < refined.points.size(); v += 3) {
        const double* p = &refined.points[v];
        if (std::abs(p[2]) < 1e-15) continue;
        const double x = p[0] - kMiddle, y = p[1] - kMiddle;
        reach = std::max({reach, std::abs(x), std::abs(y), triangles ? std::abs(x - y) : 0.0});
    }
    EXPECT_LE(reach, scheme().rings);
    // Masks next to irregular vertices may reach a ring further.
    EXPECT_GT(reach, scheme().rings - 2.0) << "it says too much";
}

INSTANTIATE_TEST_SUITE_P(Schemes, RegularPlane,
                         testing::ValuesIn(subdivision_schemes().begin(), subdivision_schemes().end()),
                         [](const testing::TestParamInfo<SubdivisionScheme>& info) {
                             std::string name = info.param.name;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

/// The weight of neighbours at a vertex of each valence that bounds curvature (scheme_checks.json).
TEST(SchemeMasks, BalancedWeightsAreThoseThatWereVerified) {
    const auto& weights = scheme_checks().at("sqrt2_balanced_vertex_weight");
    for (uint32_t n = 3; n <= 12; ++n) {
        RefinedMesh star;  // a pyramid over an n-gon
        for (uint32_t v = 0; v <= n; ++v) star.points.insert(star.points.end(), {std::cos(v), std::sin(v), v * 0.1});
        star.face_sizes.assign(n, 3);
        for (uint32_t i = 0; i < n; ++i) star.face_vertices.insert(star.face_vertices.end(), {n, i, (i + 1) % n});
        star.face_sizes.push_back(n);
        for (uint32_t i = n; i > 0; --i) star.face_vertices.push_back(i - 1);
        const auto refined =
            build_scheme_refinement<double>(control_mesh_of(star), *find_subdivision_scheme("sqrt2-balanced"), {1});
        ASSERT_TRUE(refined);
        const StencilTableDouble& table = refined->tables[0];
        double kept = 0;
        for (uint32_t k = table.offsets[n]; k < table.offsets[n + 1]; ++k)
            if (table.indices[k] == n) kept = table.weights[k];
        const double expected = n == 3 ? 0.5 : weights.at(std::to_string(n)).get<double>();  // none bounds it at three
        EXPECT_NEAR(1 - kept, expected, 1e-11) << n;
    }
}

}  // namespace
}  // namespace limn::test
