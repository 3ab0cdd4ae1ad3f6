// Gregory patches against OpenSubdiv's end caps, patch by patch, and their basis functions against its
// evaluation.
#include "limn/gregory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "conformance/osd_patches.h"
#include "conformance/refinement_checks.h"
#include "limn/shared/gregory_basis.h"

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
    // Dyadic, but for a third part that is left out: compares exactly once rounded.
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
        if (!(d <= worst)) worst = d;  // keeps what is not a number
    }
    return worst;
}

double worst_difference(std::span<const Vector3> a, std::span<const Vector3> b) {
    if (a.size() != b.size()) return INFINITY;
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double d = difference(a[i], b[i]);
        if (!(d <= worst)) worst = d;
    }
    return worst;
}

Coordinates random_place(std::mt19937& random, bool triangle) {
    std::uniform_real_distribution<double> uniform(0, 1);
    Coordinates at{uniform(random), uniform(random)};
    if (triangle && at[0] + at[1] > 1) at = {1 - at[0], 1 - at[1]};
    return at;
}

struct Tally {
    size_t patches = 0;
    double points = 0, values = 0;
};

// Both patches at some places, by the coordinates of the ptex face.
double compare_evaluation(const OsdPatches& theirs, size_t index, const std::vector<Vector3>& ours,
                          std::mt19937& random) {
    const GregoryPatch& patch = theirs.gregory_patches()[index];
    const auto& c = patch.corners;
    const bool triangle = ours.size() == 18;
    // Corner 0 to corner 1 is where the patch's own u grows; a triangle may be turned by half.
    const double scale = 1 / (c[1][0] - c[0][0]);
    // OpenSubdiv takes derivatives as if each level had halved the coordinates, which the first step of faces
    // other than quads does not.
    const double derivative_scale = std::copysign(std::ldexp(1, static_cast<int>(patch.depth)), scale);
    double worst = 0;
    for (int i = 0; i < 4; ++i) {
        const Coordinates at = random_place(random, triangle);
        const Jets mine = evaluate(ours, at[0], at[1], false);
        const Jets other = theirs.evaluate(index, c[0][0] + at[0] / scale, c[0][1] + at[1] / scale);
        // In the patch's own units, in which tolerances are the same at every level.
        for (size_t d = 0; d < 6; ++d) {
            const double unit = d == 0 ? 1 : d < 3 ? derivative_scale : derivative_scale * derivative_scale;
            for (size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(mine[d][k] - other[d][k] / unit));
        }
    }
    return worst;
}

void compare_patches(const TestMesh& mesh, uint32_t level, Tally& tally) {
    std::string error;
    const auto theirs = OsdPatches::create(mesh, level, &error);
    ASSERT_TRUE(theirs) << error;
    ControlMeshDescription description = mesh.description();
    description.options.opensubdiv_compatible = true;
    const auto control = ControlMesh::create(description);
    ASSERT_TRUE(control);
    const auto refinement = build_refinement(*control, {level, true});
    ASSERT_TRUE(refinement);
    const auto points = refine_by_steps(*refinement, mesh.positions_double(), 3, Interpolation::vertex);
    std::vector<std::vector<Place>> places = {base_places(refinement->levels[0])};
    for (uint32_t l = 0; l < level; ++l)
        places.push_back(refine_places(refinement->levels[l], places.back()));
    std::vector<std::map<PlaceKey, uint32_t>> faces(level + 1);
    for (uint32_t l = 0; l <= level; ++l)
        for (uint32_t f = 0; f < places[l].size(); ++f)
            faces[l][key_of(places[l][f].ptex_face, places[l][f].corners, places[l][f].corners.size())] = f;
    std::mt19937 random(7);
    GregoryPoints patch;
    for (size_t p = 0; p < theirs->gregory_patches().size(); ++p) {
        const GregoryPatch& expected = theirs->gregory_patches()[p];
        const uint32_t n = expected.points.size() == 18 ? 3 : 4;
        const auto face = faces[expected.depth].find(key_of(expected.ptex_face, expected.corners, n));
        ASSERT_NE(face, faces[expected.depth].end());
        const auto& corners = places[expected.depth][face->second].corners;
        uint32_t rotation = 0;
        while (rotation < n && difference({corners[rotation][0], corners[rotation][1]},
                                          {expected.corners[0][0], expected.corners[0][1]}) > 1e-9)
            ++rotation;
        ASSERT_LT(rotation, n);
        ASSERT_TRUE(find_gregory_points(refinement->levels[expected.depth], face->second, patch));
        const std::vector<Vector3> ours = apply_rows(patch, points[expected.depth], rotation);
        const double apart = worst_difference(ours, expected.points) / mesh.size();
        if (!(apart < 1e-12)) {
            std::string text;
            for (uint32_t i = 0; i < patch.count; ++i)
                if (difference(ours[i], expected.points[i]) > 1e-12 * mesh.size())
                    text += std::to_string(i) + " ";
            ADD_FAILURE() << "level " << level << " depth " << expected.depth << " ptex face "
                          << expected.ptex_face << ": " << apart << " at " << text;
        }
        const double eval = compare_evaluation(*theirs, p, expected.points, random) / mesh.size();
        EXPECT_LT(eval, 1e-11);
        ++tally.patches;
        tally.points = std::max(tally.points, apart);
        tally.values = std::max(tally.values, eval);
    }
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
};

TEST_P(GregoryConformance, equals_opensubdiv) {
    const TestMesh& mesh = shapes()[GetParam()];
    Tally tally;
    for (uint32_t level = 1; level <= 2; ++level) compare_patches(mesh, level, tally);
    std::printf("%s: %zu patches, points %.2g, values %.2g\n", mesh.name.c_str(), tally.patches, tally.points,
                tally.values);
}

INSTANTIATE_TEST_SUITE_P(Shapes, GregoryConformance,
                         testing::Range(size_t{0}, GregoryConformance::shapes().size()),
                         [](const auto& info) { return GregoryConformance::shapes()[info.param].name; });

}  // namespace
}  // namespace limn::test
