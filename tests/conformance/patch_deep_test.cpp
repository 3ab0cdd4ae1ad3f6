// The surface close to irregular vertices, down to 2^-24 of a face, against the neighbourhood of the vertex
// refined by OpenSubdiv again and again. The limits there are its own, of vertices beside the irregular one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "conformance/neighbourhood.h"
#include "conformance/osd_oracle.h"
#include "conformance/patch_checks.h"

namespace limn::test {
namespace {

constexpr uint32_t kSteps = 23;
// Of what is left of the faces, and of the size of the mesh.
constexpr double kRelativeTolerance = 1e-9, kAbsoluteTolerance = 1e-14;
// Fading sharpness is float arithmetic in OpenSubdiv: it moves the surface, but not places on it apart.
constexpr double kFadedTolerance = 1e-7;

// The place x along the edge that leaves corner c of a ptex face and y along the one that comes to it.
PatchSample place_from_corner(const SurfaceUnderTest& s, uint32_t ptex, uint32_t c, double x, double y) {
    if (s.triangles)
        return c == 0   ? PatchSample{ptex, x, y}
               : c == 1 ? PatchSample{ptex, 1 - x - y, x}
                        : PatchSample{ptex, y, 1 - x - y};
    return c == 0   ? PatchSample{ptex, x, y}
           : c == 1 ? PatchSample{ptex, 1 - y, x}
           : c == 2 ? PatchSample{ptex, 1 - x, 1 - y}
                    : PatchSample{ptex, y, 1 - x};
}

// The faces around vertex 0, in ascending order: the ptex face, and which of its corners the vertex is.
struct FaceAtVertex {
    uint32_t ptex, corner;
    bool whole;
};
std::vector<FaceAtVertex> faces_at_vertex_0(const SurfaceUnderTest& s) {
    std::vector<FaceAtVertex> result;
    for (uint32_t f = 0; f < s.base.face_count; ++f) {
        const auto vertices = s.base.vertices_of_face(f);
        for (uint32_t c = 0; c < vertices.size(); ++c) {
            if (vertices[c] != 0) continue;
            const bool whole = s.ptex_faces[s.first_ptex[f]].whole;
            result.push_back({s.first_ptex[f] + (whole ? 0 : c), whole ? c : 0, whole});
        }
    }
    return result;
}

// The limits of the corners of the faces around vertex 0, one step on from `n`, which has been made in
// `steps`.
struct LimitsAround {
    std::vector<PatchSample> places;
    std::vector<Vector> positions;
};
LimitsAround limits_around(const SurfaceUnderTest& s, const Neighbourhood& n, uint32_t steps,
                           bool vertex_itself) {
    LimitsAround result;
    std::string error;
    const auto oracle = OsdOracle::create(n.mesh, 1, &error);
    EXPECT_TRUE(oracle) << error;
    if (!oracle) return result;
    const std::vector<double> limits = oracle->limits(n.points).positions;
    const std::vector<uint32_t> vertices = oracle->face_vertices(1);
    const uint32_t face_size = s.triangles ? 3 : 4;
    const std::vector<FaceAtVertex> faces = faces_at_vertex_0(s);
    size_t next = 0;
    for (size_t begin = 0; begin < vertices.size(); begin += face_size) {
        uint32_t c = 0;
        while (c < face_size && vertices[begin + c] != 0) ++c;
        if (c == face_size) continue;
        const FaceAtVertex& face = faces.at(next++);
        const double h = std::exp2(-static_cast<double>(face.whole ? steps + 1 : steps));
        for (uint32_t k = vertex_itself ? 0 : 1; k < face_size; ++k) {
            const double x = k == 1 || (k == 2 && !s.triangles) ? h : 0, y = k >= 2 ? h : 0;
            result.places.push_back(place_from_corner(s, face.ptex, face.corner, x, y));
            const Vector at = vector_at(limits, vertices[begin + (c + k) % face_size]);
            Vector position;
            for (size_t i = 0; i < 3; ++i) position[i] = n.origin[i] + n.unit * at[i];
            result.positions.push_back(position);
        }
    }
    EXPECT_EQ(next, faces.size());
    return result;
}

double& worst_seen() {
    static double worst = 0;
    return worst;
}

// `vertex_itself` is false where OpenSubdiv's limit of it is known to be another.
void expect_surface(const TestMesh& mesh, bool vertex_itself = true) {
    const SurfaceUnderTest surface(mesh, false);
    const auto sharp_steps = static_cast<uint32_t>(std::ceil(mesh.max_finite_sharpness()));
    Neighbourhood n{mesh, mesh.positions_double()};
    for (uint32_t step = 0; step < kSteps; ++step, n = refine_around(n)) {
        if (step < sharp_steps) continue;
        const LimitsAround expected = limits_around(surface, n, step, vertex_itself);
        const auto ours = surface.evaluate(expected.places, Derivatives::none);
        const double tolerance = kRelativeTolerance * n.unit + kAbsoluteTolerance * surface.size +
                                 (sharp_steps > 0 ? kFadedTolerance * surface.size : 0);
        for (size_t i = 0; i < expected.places.size(); ++i) {
            ASSERT_EQ(ours.statuses[i], SampleStatus::valid);
            const double error = length(ours.at(i, 0) - expected.positions[i]);
            if (sharp_steps == 0) worst_seen() = std::max(worst_seen(), error / surface.size);
            ASSERT_LE(error, tolerance)
                << mesh.name << ", step " << step << ", ptex face " << expected.places[i].face;
        }
    }
}

TestMesh with(TestMesh mesh, Scheme scheme) {
    mesh.options.scheme = scheme;
    mesh.perturb(0.1);
    return mesh;
}
TestMesh make_full(Scheme scheme, uint32_t valence) {
    return with(scheme == Scheme::loop ? make_triangle_star(valence, 2) : make_quad_star(valence, 2), scheme);
}
TestMesh make_half(Scheme scheme, uint32_t faces) {
    return with(scheme == Scheme::loop ? make_triangle_half_star(faces, 2) : make_quad_half_star(faces, 2),
                scheme);
}
constexpr Scheme kSchemes[] = {Scheme::catmull_clark, Scheme::loop};

class PatchDeep : public testing::Test {
  public:
    static void TearDownTestSuite() {
        std::printf("worst difference near irregular vertices: %.1e\n", worst_seen());
    }
};

TEST_F(PatchDeep, smooth_vertices) {
    for (Scheme scheme : kSchemes)
        for (uint32_t n : {3u, 4u, 5u, 6u, 7u, 8u, 12u, 20u}) expect_surface(make_full(scheme, n));
}

TEST_F(PatchDeep, smooth_vertices_of_two_faces) {
    expect_surface(make_full(Scheme::catmull_clark, 2), false);
}

TEST_F(PatchDeep, boundaries_and_corners) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t k = 1; k <= 7; ++k) {
            TestMesh mesh = make_half(scheme, k);
            expect_surface(mesh);
            mesh.add_corner(0, 10);
            expect_surface(mesh);
        }
    }
}

TEST_F(PatchDeep, creases) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n : {3u, 4u, 5u, 7u}) {
            for (double sharpness : {1.0, 2.5, 10.0}) {
                TestMesh mesh = make_full(scheme, n);
                mesh.add_crease_path({2, 1, 0, 1 + 2 * (n / 2), 2 + 2 * (n / 2)}, sharpness);
                expect_surface(mesh);
            }
        }
    }
}

TEST_F(PatchDeep, darts) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n : {3u, 4u, 6u, 8u}) {
            for (double sharpness : {1.6, 10.0}) {
                TestMesh mesh = make_full(scheme, n);
                mesh.add_crease_path({0, 1, 2}, sharpness);
                expect_surface(mesh, sharpness < 10);
            }
        }
    }
}

TEST_F(PatchDeep, polygons) {
    TestMesh globe = with(make_globe(5, 1), Scheme::catmull_clark);
    expect_surface(globe);
    globe.options.triangles = TriangleSubdivision::smooth;
    expect_surface(globe);
    expect_surface(with(make_prism(6), Scheme::catmull_clark));
}

TEST_F(PatchDeep, notices_another_surface) {
    TestMesh mesh = make_full(Scheme::catmull_clark, 5);
    const SurfaceUnderTest surface(mesh, false);
    mesh.positions[3] += 1e-6f;  // of a neighbour of vertex 0
    Neighbourhood n{mesh, mesh.positions_double()};
    for (uint32_t step = 0; step < 3; ++step) n = refine_around(n);
    const LimitsAround moved = limits_around(surface, n, 3, true);
    const auto ours = surface.evaluate(moved.places, Derivatives::none);
    EXPECT_GT(length(ours.at(0, 0) - moved.positions[0]), kRelativeTolerance * n.unit);
}

// By limit tangents: secants would be lost in rounding where the valence is small, and bend where it is
// large.
TEST_F(PatchDeep, normals_at_extraordinary_vertices) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n : {3u, 4u, 5u, 6u, 8u, 9u, 12u, 20u}) {
            const TestMesh mesh = make_full(scheme, n);
            const SurfaceUnderTest surface(mesh, false);
            std::string error;
            const auto oracle = OsdOracle::create(mesh, 1, &error);
            ASSERT_TRUE(oracle);
            const OsdOracle::Limits limits = oracle->limits(surface.control_points);
            const FaceAtVertex face = faces_at_vertex_0(surface)[0];
            const std::vector<PatchSample> place = {place_from_corner(surface, face.ptex, face.corner, 0, 0)};
            const auto ours = surface.evaluate(place, Derivatives::first);
            const double degrees =
                angle(ours.normal(0), cross(vector_at(limits.tangents1, 0), vector_at(limits.tangents2, 0)));
            EXPECT_LE(degrees, kLimitNormalTolerance) << name_of(scheme) << " valence " << n;
        }
    }
}

// A vertex that is not manifold, a crease of two infinitely sharp edges, and one of its fans begins and ends
// at the same one of them.
TEST_F(PatchDeep, loop_creases_whose_edges_lie_in_different_fans) {
    TestMesh mesh;
    mesh.options.scheme = Scheme::loop;
    constexpr double kPoints[6][3] = {{0, 0, 0},      {1, 0, 0.2},     {0.3, 1, 0.5},
                                      {-1, 0.4, 0.1}, {-0.5, -1, 0.3}, {0.6, -0.9, -0.4}};
    for (const auto& p : kPoints) mesh.add_vertex(p[0], p[1], p[2]);
    for (const auto& [a, b, c] :
         {std::array{1u, 2u, 0u}, {1u, 0u, 3u}, {4u, 3u, 0u}, {4u, 0u, 1u}, {5u, 2u, 0u}, {5u, 0u, 1u}})
        mesh.add_face({a, b, c});
    std::string error;
    const auto oracle = OsdOracle::create(mesh, 3, &error);
    ASSERT_TRUE(oracle) << error;
    const SurfaceUnderTest surface(mesh, false);
    const std::vector<double> limits = oracle->limits(surface.control_points).positions;
    std::vector<PatchSample> places;
    const std::vector<RefinedCorner> corners = refined_corners(*oracle, true);
    for (const RefinedCorner& corner : corners) places.push_back(corner.place);
    const auto ours = surface.evaluate(places, Derivatives::none);
    double worst = 0;
    for (size_t c = 0; c < corners.size(); ++c)
        worst = std::max(worst, length(ours.at(c, 0) - vector_at(limits, corners[c].vertex)));
    EXPECT_LE(worst, kSurfaceTolerance);
}

}  // namespace
}  // namespace limn::test
