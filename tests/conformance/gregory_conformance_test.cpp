// Gregory patches against OpenSubdiv's end caps, patch by patch, and their basis functions against its
// evaluation.
//
// NOT compared:
//   - bilinear meshes, which have no Gregory patches, and levels above 2;
//   - random meshes with Chaikin creasing (their creasing is made uniform): OpenSubdiv's adaptive refinement,
//     where it lacks edges around a vertex, takes other mean sharpness than its uniform refinement, so that
//     its own refined points differ. The shapes with Chaikin creasing are compared;
//   - patches at interior vertices of two faces where one infinitely sharp edge ends: in refined levels
//     OpenSubdiv 3.5 puts a vertex into the ring there that is no neighbour.
// Nothing else is left out: boundaries, creases, darts, corners, valence 2, non-manifold vertices and
// sharpness that outlasts the isolation level (which OpenSubdiv's end caps then ignore, and so do limn's) are
// all there. Where OpenSubdiv's arithmetic on sharpness is in float, the refined points that patches are made
// of carry its error: kFadingTolerance.
#include "limn/gregory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "conformance/osd_patches.h"
#include "conformance/refinement_checks.h"
#include "limn/shared/gregory_basis.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

using shared::Jet;
using Coordinates = std::array<double, 2>;
using Jets = std::array<Vector3, 6>;  // value, du, dv, duu, duv, dvv

Coordinates middle(const Coordinates& a, const Coordinates& b) {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
}

// Where a refined face lies: its ptex face, and its corners there. Faces that are not quads (Loop: triangles)
// have none before their first refinement.
struct Place {
    uint32_t ptex_face = 0;
    std::vector<Coordinates> corners;
};

std::vector<Place> base_places(const Topology& t) {
    const uint32_t size = t.options.scheme == Scheme::loop ? 3 : 4;
    std::vector<Place> places(t.face_count);
    uint32_t ptex_face = 0;
    for (uint32_t f = 0; f < t.face_count; ++f) {
        places[f].ptex_face = ptex_face;
        ptex_face += t.size_of_face(f) == size ? 1 : t.size_of_face(f);
        if (t.size_of_face(f) != size) continue;
        places[f].corners = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        if (size == 3) places[f].corners = {{0, 0}, {1, 0}, {0, 1}};
    }
    return places;
}

std::vector<Place> refine_places(const Topology& parent, const std::vector<Place>& places) {
    std::vector<Place> children;
    for (uint32_t f = 0; f < parent.face_count; ++f) {
        const auto& at = places[f].corners;
        const auto n = static_cast<uint32_t>(at.size());
        if (n == 0) {
            for (uint32_t j = 0; j < parent.size_of_face(f); ++j)
                children.push_back({places[f].ptex_face + j, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
            continue;
        }
        auto side = [&](uint32_t i) { return middle(at[i % n], at[(i + 1) % n]); };
        for (uint32_t j = 0; j < n; ++j) {
            Place child{places[f].ptex_face, std::vector<Coordinates>(n)};
            child.corners[j] = at[j];
            child.corners[(j + 1) % n] = side(j);
            if (n == 4) child.corners[(j + 2) % n] = middle(at[0], at[2]);
            child.corners[(j + n - 1) % n] = side(j + n - 1);
            children.push_back(std::move(child));
        }
        if (n == 3) children.push_back({places[f].ptex_face, {side(1), side(2), side(0)}});
    }
    return children;
}

using PlaceKey = std::array<double, 3>;
template <class Corners>
PlaceKey key_of(uint32_t ptex_face, const Corners& corners, size_t n) {
    PlaceKey key{static_cast<double>(ptex_face), 0, 0};
    for (size_t k = 0; k < n; ++k) {
        key[1] += corners[k][0];
        key[2] += corners[k][1];
    }
    // Sums of dyadic numbers: exact, once rounded.
    key[1] = std::round(key[1] * 4096);
    key[2] = std::round(key[2] * 4096);
    return key;
}

// limn's points of the patch, its corners counted from the one at which OpenSubdiv's patch begins.
std::vector<Vector3> apply_rows(const GregoryPoints& patch, std::span<const double> points,
                                uint32_t rotation) {
    const uint32_t n = patch.count == 18 ? 3 : 4;
    std::vector<Vector3> result(patch.count);
    for (uint32_t i = 0; i < patch.count; ++i) {
        const uint32_t from = i < 5 * n ? 5 * ((i / 5 + rotation) % n) + i % 5 : 15 + (i - 15 + rotation) % 3;
        for (const RowEntry& e : patch.points[from])
            for (size_t k = 0; k < 3; ++k) result[i][k] += e.weight * points[3 * e.index + k];
    }
    return result;
}

Jets evaluate(const std::vector<Vector3>& points, double u, double v, bool true_derivatives) {
    Jet basis[20];
    if (points.size() == 18) {
        Jet triangle[18];
        shared::gregory_triangle_basis(u, v, true_derivatives, triangle);
        std::copy(triangle, triangle + 18, basis);
    } else {
        shared::gregory_basis(u, v, true_derivatives, basis);
    }
    Jets result{};
    for (size_t k = 0; k < points.size(); ++k) {
        const double weights[6] = {basis[k].f, basis[k].u, basis[k].v, basis[k].uu, basis[k].uv, basis[k].vv};
        for (size_t d = 0; d < 6; ++d)
            for (size_t i = 0; i < 3; ++i) result[d][i] += weights[d] * points[k][i];
    }
    return result;
}

double difference(const Vector3& a, const Vector3& b) {
    double worst = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double d = std::abs(a[i] - b[i]);
        if (std::isnan(d)) return INFINITY;
        worst = std::max(worst, d);
    }
    return worst;
}

double worst_difference(std::span<const Vector3> a, std::span<const Vector3> b) {
    if (a.size() != b.size()) return INFINITY;
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, difference(a[i], b[i]));
    return worst;
}

Coordinates random_place(RandomNumbers& random, bool triangle) {
    Coordinates at{random.uniform(0, 1), random.uniform(0, 1)};
    if (triangle && at[0] + at[1] > 1) at = {1 - at[0], 1 - at[1]};
    return at;
}

// The worst differences seen, over the size of the mesh, and what they were seen in.
struct Tally {
    size_t meshes = 0, left_out = 0, patches[2] = {0, 0};  // quads, triangles
    double points = 0, fading_points = 0, values = 0;
};
Tally& tally() {
    static Tally all;
    return all;
}

constexpr double kValueTolerance = 1e-11;

testing::AssertionResult same_vectors(std::span<const Vector3> ours, std::span<const Vector3> theirs,
                                      double tolerance, double& worst) {
    const double apart = worst_difference(ours, theirs);
    worst = std::max(worst, apart);
    if (apart <= tolerance) return testing::AssertionSuccess();
    testing::AssertionResult result = testing::AssertionFailure() << "apart by " << apart << ", at";
    for (size_t i = 0; i < std::min(ours.size(), theirs.size()); ++i)
        if (!(difference(ours[i], theirs[i]) <= tolerance)) result << " " << i;
    return result;
}

// OpenSubdiv's patch, and limn's of the given points, at some places: value and derivatives in the patch's
// own coordinates, in which tolerances are the same at every level.
testing::AssertionResult same_evaluation(const OsdPatches& theirs, size_t index,
                                         const std::vector<Vector3>& points, RandomNumbers& random,
                                         double tolerance, double& worst) {
    const GregoryPatch& patch = theirs.gregory_patches()[index];
    const auto& c = patch.corners;
    // Corner 0 to corner 1 is where the patch's own u grows; a triangle may be turned by half.
    const double side = c[1][0] - c[0][0];
    // OpenSubdiv takes derivatives as if each level had halved the coordinates, which the first step of faces
    // other than quads does not.
    const double unit = std::copysign(std::ldexp(1, static_cast<int>(patch.depth)), side);
    for (int i = 0; i < 4; ++i) {
        const Coordinates at = random_place(random, points.size() == 18);
        const Jets ours = evaluate(points, at[0], at[1], false);
        Jets expected = theirs.evaluate(index, c[0][0] + at[0] * side, c[0][1] + at[1] * side);
        for (size_t d = 1; d < 6; ++d)
            for (double& x : expected[d]) x /= d < 3 ? unit : unit * unit;
        const testing::AssertionResult same = same_vectors(ours, expected, tolerance, worst);
        if (!same) return same;
    }
    return testing::AssertionSuccess();
}

// limn's refinement of a mesh, its faces found by where they lie in their ptex face.
struct RefinedMesh {
    Refinement refinement;
    std::vector<std::vector<double>> points;
    std::vector<std::vector<Place>> places;
    std::vector<std::map<PlaceKey, uint32_t>> faces;

    RefinedMesh(const TestMesh& mesh, uint32_t level) {
        ControlMeshDescription description = mesh.description();
        description.options.opensubdiv_compatible = true;
        const auto control = ControlMesh::create(description);
        refinement = build_refinement(*control, {level, true}).value();
        points = refine_by_steps(refinement, mesh.positions_double(), 3, Interpolation::vertex);
        for (uint32_t l = 0; l <= level; ++l) {
            places.push_back(l == 0 ? base_places(refinement.levels[0])
                                    : refine_places(refinement.levels[l - 1], places.back()));
            faces.emplace_back();
            for (uint32_t f = 0; f < places[l].size(); ++f)
                faces[l][key_of(places[l][f].ptex_face, places[l][f].corners, places[l][f].corners.size())] =
                    f;
        }
    }

    // The points of limn's patch where OpenSubdiv has `patch`; empty where there is none. `at_folded_dart`: a
    // corner is a dart of two faces.
    std::vector<Vector3> find(const GregoryPatch& patch, bool& at_folded_dart) const {
        const uint32_t n = patch.points.size() == 18 ? 3 : 4, level = patch.depth;
        const auto face = faces[level].find(key_of(patch.ptex_face, patch.corners, n));
        if (face == faces[level].end()) return {};
        const auto& corners = places[level][face->second].corners;
        uint32_t rotation = 0;
        while (rotation < n && std::hypot(corners[rotation][0] - patch.corners[0][0],
                                          corners[rotation][1] - patch.corners[0][1]) > 1e-9)
            ++rotation;
        GregoryPoints found;
        const Topology& t = refinement.levels[level];
        at_folded_dart = false;
        for (const uint32_t v : t.vertices_of_face(face->second)) {
            const auto edges = t.edges_of_vertex(v);
            at_folded_dart |=
                edges.size() == 2 && t.corners_of_vertex(v).size() == 2 &&
                is_infinite(t.edge_sharpness[edges[0]]) != is_infinite(t.edge_sharpness[edges[1]]);
        }
        if (rotation == n || !find_gregory_points(t, face->second, found)) return {};
        return apply_rows(found, points[level], rotation);
    }
};

void compare_patches(const TestMesh& mesh, uint32_t level) {
    std::string error;
    const auto theirs = OsdPatches::create(mesh, level, &error);
    ASSERT_TRUE(theirs) << error;
    const RefinedMesh ours(mesh, level);
    const double size = mesh.size();
    const bool fading = has_inexact_fading(mesh);
    RandomNumbers random(7);
    double points_apart = 0, values_apart = 0;
    for (size_t p = 0; p < theirs->gregory_patches().size(); ++p) {
        const GregoryPatch& expected = theirs->gregory_patches()[p];
        SCOPED_TRACE("level " + std::to_string(level) + ", depth " + std::to_string(expected.depth) +
                     ", ptex face " + std::to_string(expected.ptex_face));
        bool at_folded_dart = false;
        const std::vector<Vector3> points = ours.find(expected, at_folded_dart);
        EXPECT_EQ(points.size(), expected.points.size());
        tally().left_out += at_folded_dart;
        if (!at_folded_dart) {
            EXPECT_TRUE(same_vectors(points, expected.points,
                                     (fading ? kFadingTolerance : kDoubleTolerance) * size, points_apart));
        }
        EXPECT_TRUE(
            same_evaluation(*theirs, p, expected.points, random, kValueTolerance * size, values_apart));
        ++tally().patches[expected.points.size() == 18];
    }
    double& worst = fading ? tally().fading_points : tally().points;
    worst = std::max(worst, points_apart / size);
    tally().values = std::max(tally().values, values_apart / size);
}

void print_tally() {
    const Tally& t = tally();
    std::printf(
        "%zu quads and %zu triangles of %zu meshes (%zu at folded darts left out); worst differences: "
        "points %.2g (fading %.2g), values and derivatives %.2g\n",
        t.patches[0], t.patches[1], t.meshes, t.left_out, t.points, t.fading_points, t.values);
}

std::vector<TestMesh> smooth_shapes() {
    std::vector<TestMesh> shapes;
    for (TestMesh& mesh : all_shapes())
        if (mesh.options.scheme != Scheme::bilinear) shapes.push_back(std::move(mesh));
    return shapes;
}

class GregoryConformance : public testing::TestWithParam<size_t> {
  public:
    static const std::vector<TestMesh>& shapes() {
        static const std::vector<TestMesh> all = smooth_shapes();
        return all;
    }
    static void TearDownTestSuite() { print_tally(); }
};

TEST_P(GregoryConformance, equals_opensubdiv) {
    ++tally().meshes;
    for (uint32_t level = 1; level <= 2; ++level) compare_patches(shapes()[GetParam()], level);
}

INSTANTIATE_TEST_SUITE_P(Shapes, GregoryConformance,
                         testing::Range(size_t{0}, GregoryConformance::shapes().size()),
                         [](const auto& info) { return GregoryConformance::shapes()[info.param].name; });

TEST(GregoryRandom, equals_opensubdiv) {
    for (uint64_t seed = 1; seed <= 3000 && !testing::Test::HasFailure(); ++seed) {
        TestMesh mesh = random_mesh(seed);
        if (mesh.options.scheme == Scheme::bilinear) continue;
        mesh.options.creasing = CreasingMethod::uniform;
        SCOPED_TRACE("seed " + std::to_string(seed));
        ++tally().meshes;
        compare_patches(mesh, 1);
        compare_patches(mesh, 2);
    }
    print_tally();
}

// The comparisons, shown to notice one wrong point.
TEST(GregoryHelpers, patches_differ_when_one_point_is_perturbed) {
    for (const TestMesh& mesh : {make_cube(), [] {
                                     TestMesh loop = make_icosahedron();
                                     loop.options.scheme = Scheme::loop;
                                     return loop;
                                 }()}) {
        const auto theirs = OsdPatches::create(mesh, 1, nullptr);
        ASSERT_TRUE(theirs && !theirs->gregory_patches().empty());
        const GregoryPatch& patch = theirs->gregory_patches()[0];
        bool at_folded_dart = false;
        std::vector<Vector3> points = RefinedMesh(mesh, 1).find(patch, at_folded_dart);
        RandomNumbers random(1);
        double worst = 0;
        EXPECT_TRUE(same_vectors(points, patch.points, kDoubleTolerance, worst));
        EXPECT_TRUE(same_evaluation(*theirs, 0, points, random, kValueTolerance, worst));
        for (size_t k = 0; k < points.size(); ++k) {
            worst = 0;
            std::vector<Vector3> other = points;
            other[k][k % 3] += 3e-12;
            EXPECT_FALSE(same_vectors(other, patch.points, kDoubleTolerance, worst)) << k;
            other[k][k % 3] += 1e-8;
            EXPECT_FALSE(same_evaluation(*theirs, 0, other, random, kValueTolerance, worst)) << k;
            other[k][k % 3] = std::nan("");
            EXPECT_FALSE(same_vectors(other, patch.points, kDoubleTolerance, worst)) << k;
        }
        points.pop_back();
        EXPECT_FALSE(same_vectors(points, patch.points, kDoubleTolerance, worst));
    }
}

std::vector<Vector3> random_points(size_t count, RandomNumbers& random) {
    std::vector<Vector3> points(count);
    for (Vector3& p : points)
        for (double& x : p) x = random.uniform(-1, 1);
    return points;
}

TEST(GregoryBasis, true_derivatives_are_those_of_the_patch) {
    RandomNumbers random(3);
    constexpr double h = 1e-4;
    for (size_t count : {size_t{20}, size_t{18}}) {
        const std::vector<Vector3> points = random_points(count, random);
        double held_apart = 0;
        for (int i = 0; i < 200; ++i) {
            Coordinates at = random_place(random, count == 18);
            at = {0.03 + 0.9 * at[0], 0.03 + 0.9 * at[1]};  // the blends' derivatives grow towards corners
            const Jets jets = evaluate(points, at[0], at[1], true);
            const Jets held = evaluate(points, at[0], at[1], false);
            EXPECT_LT(difference(jets[0], held[0]), 1e-14);
            held_apart = std::max(held_apart, difference(jets[1], held[1]));
            // Value from value, then each derivative from the one before it.
            const size_t from[5] = {0, 0, 1, 1, 2};
            for (size_t d = 1; d < 6; ++d) {
                const bool by_u = d == 1 || d == 3;
                const double du = by_u ? h : 0, dv = by_u ? 0 : h;
                const Jets after = evaluate(points, at[0] + du, at[1] + dv, true);
                const Jets before = evaluate(points, at[0] - du, at[1] - dv, true);
                for (size_t k = 0; k < 3; ++k) {
                    const double slope = (after[from[d - 1]][k] - before[from[d - 1]][k]) / (2 * h);
                    EXPECT_NEAR(jets[d][k], slope, 2e-3) << "derivative " << d;
                }
            }
        }
        EXPECT_GT(held_apart, 0.1) << "the two definitions differ, or there would be no need of both";
    }
}

// Corners are where blends would divide by zero: the limits from within hold there, too, but for second
// derivatives, which depend on the way there.
TEST(GregoryBasis, is_continuous_at_corners_and_sums_to_one) {
    RandomNumbers random(4);
    for (size_t count : {size_t{20}, size_t{18}}) {
        const size_t n = count == 18 ? 3 : 4;
        const std::vector<Vector3> points = random_points(count, random);
        const std::vector<Vector3> ones(count, Vector3{1, 1, 1});
        const Coordinates quad[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, triangle[3] = {{0, 0}, {1, 0}, {0, 1}};
        for (bool true_derivatives : {false, true}) {
            for (size_t k = 0; k < n; ++k) {
                const Coordinates& at = n == 3 ? triangle[k] : quad[k];
                const Jets corner = evaluate(points, at[0], at[1], true_derivatives);
                EXPECT_LT(difference(corner[0], points[5 * k]), 1e-15);
                const double inner = n == 3 ? 1.0 / 3 : 0.5, step = 1e-9;
                const Jets near = evaluate(points, at[0] + step * (inner - at[0]),
                                           at[1] + step * (inner - at[1]), true_derivatives);
                for (size_t d = 0; d < 6; ++d) EXPECT_LT(difference(corner[d], near[d]), 1e-5) << d;
            }
            for (int i = 0; i < 20; ++i) {
                const Coordinates at = random_place(random, n == 3);
                const Jets sum = evaluate(ones, at[0], at[1], true_derivatives);
                EXPECT_LT(difference(sum[0], {1, 1, 1}), 1e-14);
                for (size_t d = 1; d < 6; ++d) EXPECT_LT(difference(sum[d], {0, 0, 0}), 1e-12) << d;
            }
        }
    }
}

TEST(GregoryPoints, are_missing_where_faces_are_not_quads) {
    const auto prism = ControlMesh::create(make_prism(5).description());
    const auto refinement = build_refinement(*prism, {1, true});
    ASSERT_TRUE(refinement);
    GregoryPoints points;
    for (uint32_t f = 0; f < refinement->levels[0].face_count; ++f)
        EXPECT_FALSE(find_gregory_points(refinement->levels[0], f, points));
    for (uint32_t f = 0; f < refinement->levels[1].face_count; ++f)
        EXPECT_TRUE(find_gregory_points(refinement->levels[1], f, points));
    TestMesh linear = make_cube();
    linear.options.scheme = Scheme::bilinear;
    const auto control = ControlMesh::create(linear.description());
    EXPECT_FALSE(find_gregory_points(build_topology(*control), 0, points));
}

}  // namespace
}  // namespace limn::test
