// T-meshes against their blending functions, evaluated one by one (Cox and de Boor).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "limn/schemes/t_mesh.h"
#include "schemes/scheme_meshes.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr int kSize = 11;
using GridPoint = std::array<int, 2>;

int wrapped(int i) {
    return (i % kSize + kSize) % kSize;
}

/// A torus of kSize x kSize quads without three of its vertices, and the lines that met there on both sides.
struct TTorus {
    std::array<std::vector<double>, 2> intervals;
    std::map<GridPoint, uint32_t> vertices;
    RefinedMesh mesh;
    std::vector<uint8_t> straight;
    std::vector<double> corner_intervals;

    /// Whether a line crosses direction 0 (or 1) at (i, j).
    static bool has_line(int direction, int i, int j) {
        return direction == 0 ? !(i == 6 && j == 6) : !(j == 5 && (i == 3 || i == 4));
    }
    static bool exists(int i, int j) {
        return has_line(0, wrapped(i), wrapped(j)) && has_line(1, wrapped(i), wrapped(j));
    }

    TTorus() {
        RandomNumbers random(1);
        for (auto& along : intervals)
            for (int i = 0; i < kSize; ++i) along.push_back(random.uniform(0.5, 2));
        for (int j = 0; j < kSize; ++j)
            for (int i = 0; i < kSize; ++i) {
                if (!exists(i, j)) continue;
                vertices[{i, j}] = mesh.vertex_count();
                for (int k = 0; k < 3; ++k) mesh.points.push_back(random.uniform(-1, 1));
            }
        for (int j = 0; j < kSize; ++j)
            for (int i = 0; i < kSize; ++i) {
                const bool tall = i >= 2 && i <= 4, wide = j == 5 || j == 6;
                if ((tall && j == 5) || (wide && i == 6)) continue;  // parts of others
                add_face(i, j, i + (wide && i == 5 ? 2 : 1), j + (tall && j == 4 ? 2 : 1));
            }
    }
    double length(int direction, int from, int to) const {
        double sum = 0;
        for (int i = from; i < to; ++i)
            sum += intervals[static_cast<size_t>(direction)][static_cast<size_t>(wrapped(i))];
        return sum;
    }
    void add_face(int i0, int j0, int i1, int j1) {
        std::vector<GridPoint> around;
        for (int i = i0; i < i1; ++i) around.push_back({i, j0});
        for (int j = j0; j < j1; ++j) around.push_back({i1, j});
        for (int i = i1; i > i0; --i) around.push_back({i, j1});
        for (int j = j1; j > j0; --j) around.push_back({i0, j});
        std::erase_if(around, [](const GridPoint& p) { return !exists(p[0], p[1]); });
        mesh.face_sizes.push_back(static_cast<uint32_t>(around.size()));
        for (size_t k = 0; k < around.size(); ++k) {
            const auto [i, j] = around[k];
            const auto [next_i, next_j] = around[(k + 1) % around.size()];
            mesh.face_vertices.push_back(vertices.at({wrapped(i), wrapped(j)}));
            straight.push_back((i != i0 && i != i1) || (j != j0 && j != j1));
            corner_intervals.push_back(length(0, std::min(i, next_i), std::max(i, next_i)) +
                                       length(1, std::min(j, next_j), std::max(j, next_j)));
        }
    }
    /// The five knots of a point in one direction, around its own place: where lines cross, or all of the torus's.
    std::vector<double> knots(int direction, const GridPoint& at, bool all) const {
        const int own = at[static_cast<size_t>(direction)];
        std::vector<double> out = {0, 0, 0, 0, 0};
        for (const int sign : {-1, 1})
            for (int i = own, found = 0; found < 2;) {
                i += sign;
                GridPoint p = at;
                p[static_cast<size_t>(direction)] = wrapped(i);
                if (!all && !has_line(direction, p[0], p[1])) continue;
                ++found;
                out[static_cast<size_t>(2 + sign * found)] =
                    sign > 0 ? length(direction, own, i) : -length(direction, i, own);
            }
        return out;
    }
    /// The blending function of a point at (u, v), measured from grid point (0, 0).
    double blend(const GridPoint& at, const std::array<double, 2>& uv, bool all) const;
};

/// The cubic B-spline on five knots.
double spline(const std::vector<double>& t, size_t first, size_t degree, double x) {
    if (degree == 0) return x >= t[first] && x < t[first + 1] ? 1 : 0;
    return (x - t[first]) / (t[first + degree] - t[first]) * spline(t, first, degree - 1, x) +
           (t[first + degree + 1] - x) / (t[first + degree + 1] - t[first + 1]) * spline(t, first + 1, degree - 1, x);
}

double TTorus::blend(const GridPoint& at, const std::array<double, 2>& uv, bool all) const {
    double product = 1;
    for (int d = 0; d < 2; ++d) {
        const auto t = knots(d, at, all);
        const double period = length(d, 0, kSize), own = length(d, 0, at[static_cast<size_t>(d)]);
        double sum = 0;
        for (const int turn : {-1, 0, 1}) sum += spline(t, 0, 3, uv[static_cast<size_t>(d)] - own + turn * period);
        product *= sum;
    }
    return product;
}

/// Where the vertices of a converted torus lie: those of the T-mesh are known, faces tell the others.
std::vector<GridPoint> grid_points(const TTorus& torus, const ControlMesh& mesh) {
    constexpr GridPoint kUnknown = {-1, -1};
    std::vector<GridPoint> points(mesh.vertex_count, kUnknown);
    for (const auto& [at, vertex] : torus.vertices) points[vertex] = at;
    for (int round = 0; round < 4; ++round)
        for (size_t c = 0; c < mesh.face_vertices.size(); ++c) {
            const size_t face = c / 4 * 4;
            auto corner = [&](size_t i) -> GridPoint& { return points[mesh.face_vertices[face + (c + i) % 4]]; };
            if (corner(0) == kUnknown || corner(1) == kUnknown) continue;
            auto step = [](int from, int to) { return wrapped(to - from + 1) - 1; };
            const int du = step(corner(0)[0], corner(1)[0]), dv = step(corner(0)[1], corner(1)[1]);
            EXPECT_EQ(std::abs(du) + std::abs(dv), 1);
            for (const size_t i : {size_t{1}, size_t{0}}) {  // to the left
                const GridPoint to = {wrapped(corner(i)[0] - dv), wrapped(corner(i)[1] + du)};
                GridPoint& known = corner(3 - i);
                EXPECT_TRUE(known == kUnknown || known == to);
                known = to;
            }
        }
    return points;
}

TEST(TMesh, ConvertedMeshesHaveTheSameSurface) {
    const TTorus torus;
    const auto converted = convert_t_mesh(control_mesh_of(torus.mesh), torus.straight, torus.corner_intervals);
    ASSERT_TRUE(converted) << converted.error().message;
    EXPECT_EQ(converted->mesh.vertex_count, static_cast<uint32_t>(kSize * kSize));
    EXPECT_EQ(converted->mesh.face_count(), static_cast<uint32_t>(kSize * kSize));
    EXPECT_TRUE(converted->rational);
    std::vector<double> points, quads(size_t{4} * converted->mesh.vertex_count);
    for (uint32_t v = 0; v < torus.mesh.vertex_count(); ++v) {
        for (size_t k = 0; k < 3; ++k) points.push_back(torus.mesh.points[3 * size_t{v} + k]);
        points.push_back(1);
    }
    apply_stencil_table<double>(converted->points, points, quads, 4);
    const auto places = grid_points(torus, converted->mesh);
    RandomNumbers random(2);
    for (int sample = 0; sample < 200; ++sample) {
        const std::array<double, 2> uv = {random.uniform(0, 1) * torus.length(0, 0, kSize),
                                          random.uniform(0, 1) * torus.length(1, 0, kSize)};
        std::array<double, 4> expected = {}, found = {};
        for (const auto& [at, vertex] : torus.vertices)
            for (size_t k = 0; k < 4; ++k) expected[k] += torus.blend(at, uv, false) * points[4 * size_t{vertex} + k];
        for (size_t v = 0; v < places.size(); ++v)
            for (size_t k = 0; k < 4; ++k) found[k] += torus.blend(places[v], uv, true) * quads[4 * v + k];
        for (size_t k = 0; k < 4; ++k) ASSERT_NEAR(found[k], expected[k], 1e-12);
    }
    // What nurss needs: intervals of all corners.
    for (size_t c = 0; c < converted->intervals.size(); ++c) {
        const GridPoint a = places[converted->mesh.face_vertices[c]],
                        b = places[converted->mesh.face_vertices[c / 4 * 4 + (c + 1) % 4]];
        const int d = a[0] == b[0] ? 1 : 0;
        const auto k = static_cast<size_t>(d);
        const int from = wrapped(b[k] - a[k]) == 1 ? a[k] : b[k];
        EXPECT_NEAR(converted->intervals[c], torus.length(d, from, from + 1), 1e-14);
    }
    const auto refined =
        build_scheme_refinement<double>(converted->mesh, *find_subdivision_scheme("nurss"), {2}, converted->intervals);
    EXPECT_TRUE(refined);
}

/// A cube of 8 x 8 x 6 quads without one edge: its ends become T-junctions.
TEST(TMesh, IrregularVerticesNeedRoom) {
    TestMesh shape = make_cube();
    RefinedMesh cube{shape.positions_double(), shape.face_sizes, shape.face_vertices};
    cube = refine_mesh(cube, *find_subdivision_scheme("bilinear"), 3);
    const uint32_t faces = static_cast<uint32_t>(cube.face_sizes.size());
    uint32_t converted_count = 0, refused_count = 0;
    for (uint32_t f = 0; f < faces; f += 2) {
        // The face beyond f's first edge, and the corner at which it begins there.
        const uint32_t* own = cube.face_vertices.data() + size_t{4} * f;
        uint32_t beyond = 0;
        while (cube.face_vertices[beyond] != own[1] || cube.face_vertices[beyond / 4 * 4 + (beyond + 1) % 4] != own[0])
            ++beyond;
        const uint32_t* other = cube.face_vertices.data() + size_t{beyond} / 4 * 4;
        RefinedMesh mesh;
        mesh.points = cube.points;
        mesh.face_sizes = {6};
        std::vector<uint8_t> straight = {1, 0, 0, 1, 0, 0};
        for (uint32_t i = 1; i < 4; ++i) mesh.face_vertices.push_back(own[i]);
        for (uint32_t i = 1; i < 4; ++i) mesh.face_vertices.push_back(other[(beyond + i) % 4]);
        for (uint32_t g = 0; g < faces; ++g) {
            if (g == f || g == beyond / 4) continue;
            mesh.face_sizes.push_back(4);
            straight.insert(straight.end(), 4, 0);
            mesh.face_vertices.insert(mesh.face_vertices.end(), cube.face_vertices.begin() + 4 * g,
                                      cube.face_vertices.begin() + 4 * g + 4);
        }
        const std::vector<double> intervals(straight.size(), 1.0);
        const auto converted = convert_t_mesh(control_mesh_of(mesh), straight, intervals);
        converted_count += converted.has_value();
        refused_count += !converted;
        if (!converted) {
            EXPECT_EQ(converted.error().code, ErrorCode::unsupported);
            continue;
        }
        EXPECT_EQ(converted->mesh.vertex_count, cube.vertex_count());
        EXPECT_EQ(converted->mesh.face_count(), faces);
        EXPECT_EQ(converted->points.offsets[8], 8u) << "the cube's corners stay";
    }
    EXPECT_GT(converted_count, 10u);
    EXPECT_GT(refused_count, 10u);
}

/// A torus of 3 x 3 quads, cut and glued again a little further on: lines that go round and round.
TEST(TMesh, LinesThatNeverMeetAreAnError) {
    const double shift = std::sqrt(0.1);
    RefinedMesh mesh;  // below the seam: vertices 0 to 2; above it 3 to 5, on the same line; then two rows
    mesh.points.resize(3 * 12);
    std::vector<uint8_t> straight;
    std::vector<double> intervals;
    for (uint32_t i = 0; i < 3; ++i) {
        const uint32_t next = (i + 1) % 3;
        mesh.face_sizes.insert(mesh.face_sizes.end(), {5, 4, 5});
        mesh.face_vertices.insert(mesh.face_vertices.end(), {3 + i, i, 3 + next, 6 + next, 6 + i});
        straight.insert(straight.end(), {0, 1, 0, 0, 0});
        intervals.insert(intervals.end(), {shift, 1 - shift, 1, 1, 1});
        mesh.face_vertices.insert(mesh.face_vertices.end(), {6 + i, 6 + next, 9 + next, 9 + i});
        straight.insert(straight.end(), {0, 0, 0, 0});
        intervals.insert(intervals.end(), {1, 1, 1, 1});
        mesh.face_vertices.insert(mesh.face_vertices.end(), {9 + i, 9 + next, next, 3 + next, i});
        straight.insert(straight.end(), {0, 0, 0, 1, 0});
        intervals.insert(intervals.end(), {1, 1, shift, 1 - shift, 1});
    }
    const auto converted = convert_t_mesh(control_mesh_of(mesh), straight, intervals);
    ASSERT_FALSE(converted);
    EXPECT_EQ(converted.error().code, ErrorCode::too_large);
}

TEST(TMesh, BadInputIsAnError) {
    const TTorus torus;
    const ControlMesh mesh = control_mesh_of(torus.mesh);
    auto error = [&](const std::vector<uint8_t>& straight, const std::vector<double>& intervals) {
        const auto converted = convert_t_mesh(mesh, straight, intervals);
        return converted ? ErrorCode::cancelled : converted.error().code;
    };
    EXPECT_EQ(error({}, torus.corner_intervals), ErrorCode::invalid_argument);
    EXPECT_EQ(error(std::vector<uint8_t>(torus.straight.size()), torus.corner_intervals), ErrorCode::invalid_argument);
    auto intervals = torus.corner_intervals;
    intervals[5] = 0;
    EXPECT_EQ(error(torus.straight, intervals), ErrorCode::invalid_argument);
    intervals[5] = 9;
    EXPECT_EQ(error(torus.straight, intervals), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace limn::test
