// limn against CGAL's and OpenMesh's own refinement, all in double: the same vertices and the same faces, whatever their
// order. Where a library has another convention at boundaries, that there is a difference is what is expected.
#include "scheme_peers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "schemes/scheme_meshes.h"

namespace limn::test {
namespace {

using peers::Boundaries;

peers::PolygonMesh as_peer(const RefinedMesh& mesh) {
    return {mesh.points, mesh.face_sizes, mesh.face_vertices};
}

double size_of(const RefinedMesh& mesh) {
    double size = 0;
    for (const double x : mesh.points) size = std::max(size, std::abs(x));
    return 2 * size;
}

double distance(const double* a, const double* b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// For each point of `a` the only point of `b` within `tolerance`; kInvalidIndex where there is none, or no other.
std::vector<uint32_t> match(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
    std::vector<uint32_t> partner(a.size() / 3, kInvalidIndex);
    std::set<uint32_t> taken;
    for (size_t i = 0; i < partner.size(); ++i)
        for (uint32_t j = 0; j < b.size() / 3; ++j)
            if (distance(&a[3 * i], &b[3 * size_t{j}]) <= tolerance && taken.insert(j).second) {
                partner[i] = j;
                break;
            }
    return partner;
}

/// Faces as cycles that begin with their smallest vertex, sorted.
std::vector<std::vector<uint32_t>> cycles(const std::vector<uint32_t>& sizes, std::vector<uint32_t> vertices) {
    std::vector<std::vector<uint32_t>> faces;
    auto begin = vertices.begin();
    for (const uint32_t n : sizes) {
        std::rotate(begin, std::min_element(begin, begin + n), begin + n);
        faces.emplace_back(begin, begin + n);
        begin += n;
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

struct Case {
    const char* library;
    peers::PeerScheme peer;
};
void PrintTo(const Case& c, std::ostream* out) {
    *out << c.library << ' ' << c.peer.method;
}

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const peers::Library& library : {peers::cgal_schemes(), peers::openmesh_schemes()})
        for (const peers::PeerScheme& peer : library.schemes) cases.push_back({library.name, peer});
    return cases;
}

class SchemePeers : public testing::TestWithParam<Case> {
  protected:
    const peers::PeerScheme& peer() const { return GetParam().peer; }
    const SubdivisionScheme& scheme() const { return *find_subdivision_scheme(peer().name); }
    SchemeOptions options() const {
        SchemeOptions options;
        if (peer().boundaries == Boundaries::none) options.boundary = BoundaryInterpolation::none;
        return options;
    }

    void expect_equal(const RefinedMesh& mesh, uint32_t level) const {
        const RefinedMesh own = refine_mesh(mesh, scheme(), level, options());
        const peers::PolygonMesh other = peer().refine(as_peer(mesh), level, nullptr);
        ASSERT_FALSE(other.face_sizes.empty()) << "refuses this mesh";
        ASSERT_EQ(own.points.size(), other.points.size());
        const auto partner = match(other.points, own.points, 1e-12 * size_of(mesh));
        ASSERT_EQ(std::count(partner.begin(), partner.end(), kInvalidIndex), 0);
        std::vector<uint32_t> vertices;
        for (const uint32_t v : other.face_vertices) vertices.push_back(partner[v]);
        EXPECT_EQ(cycles(own.face_sizes, own.face_vertices), cycles(other.face_sizes, vertices));
    }
};

TEST_P(SchemePeers, RefineClosedMeshesAlike) {
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(seed);
        for (uint32_t level = 1; level <= 3; ++level) {
            expect_equal(make_irregular_mesh(scheme(), false, seed), level);
            if (level < 3) expect_equal(make_random_manifold(scheme(), false, seed), level);
        }
    }
}

TEST_P(SchemePeers, RefineOpenMeshesAlike) {
    if (peer().boundaries == Boundaries::crashing) return;  // closed meshes are all that it takes
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(seed);
        const RefinedMesh irregular = make_irregular_mesh(scheme(), true, seed),
                          random = make_random_manifold(scheme(), true, seed);
        for (uint32_t level = 1; level <= 2 && peer().boundaries != Boundaries::other; ++level) {
            expect_equal(random, level);
            if (peer().boundaries != Boundaries::none) expect_equal(irregular, level);
        }
        if (peer().boundaries != Boundaries::other) continue;
        // OpenMesh's Catmull-Clark moves boundary vertices by (1, 4, 1) / 6, and its interpolatory sqrt(3) takes what
        // comes next along the boundary for points beyond it: those points differ, and no others.
        const RefinedMesh own = refine_mesh(random, scheme(), 1);
        const peers::PolygonMesh other = peer().refine(as_peer(random), 1, nullptr);
        ASSERT_EQ(own.points.size(), other.points.size());
        const auto partner = match(other.points, own.points, 1e-12 * size_of(random));
        const auto different = static_cast<size_t>(std::count(partner.begin(), partner.end(), kInvalidIndex));
        EXPECT_GT(different, 0u);
        EXPECT_LT(different, partner.size() / 3);
    }
}

/// The comparison notices one point that is off by a little.
TEST_P(SchemePeers, AreComparedClosely) {
    RefinedMesh mesh = make_random_manifold(scheme(), false, 5);
    const peers::PolygonMesh other = peer().refine(as_peer(mesh), 1, nullptr);
    mesh.points[7] += 1e-9;
    const auto partner = match(other.points, refine_mesh(mesh, scheme(), 1).points, 1e-12 * size_of(mesh));
    EXPECT_GT(std::count(partner.begin(), partner.end(), kInvalidIndex), 0);
}

INSTANTIATE_TEST_SUITE_P(Libraries, SchemePeers, testing::ValuesIn(all_cases()), [](const auto& info) {
    return std::string(info.param.library) + "_" + info.param.peer.method;
});

}  // namespace
}  // namespace limn::test
