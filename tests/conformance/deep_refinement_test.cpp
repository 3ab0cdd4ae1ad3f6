// The truth where OpenSubdiv is off, and everywhere else: limits and normals by refining the neighbourhood of
// a vertex again and again, and tangent masks by what they must be, left eigenvectors of the refinement. No
// limit mask of OpenSubdiv is used; its refinement steps are.
#include <gtest/gtest.h>

#include <cmath>

#include "conformance/neighbourhood.h"
#include "conformance/refinement_checks.h"
#include "conformance/vectors.h"

namespace limn::test {
namespace {

struct Truth {
    Vector limit;
    Vector normal;  // of the fan around the vertex, not of unit length
    double moved;   // by the last step
};

Truth refine_deeply(const TestMesh& mesh, uint32_t steps) {
    Neighbourhood n{mesh, mesh.positions_double()};
    Truth truth{};
    for (uint32_t i = 0; i < steps; ++i) {
        const Vector before = n.origin;
        n = refine_around(n);
        truth.moved = length(n.origin - before);
    }
    truth.limit = n.origin;
    size_t begin = 0;
    for (uint32_t size : n.mesh.face_sizes) {
        for (uint32_t c = 0; c < size; ++c) {
            if (n.mesh.face_vertices[begin + c] != 0) continue;
            const Vector a = vector_at(n.points, n.mesh.face_vertices[begin + (c + 1) % size]);
            const Vector b = vector_at(n.points, n.mesh.face_vertices[begin + (c + size - 1) % size]);
            const Vector product = cross(a, b);
            for (size_t k = 0; k < 3; ++k) truth.normal[k] += product[k];
        }
        begin += size;
    }
    return truth;
}

struct Ours {
    Vector limit, tangent1, tangent2;
    Vector normal() const { return cross(tangent1, tangent2); }
};

Ours limit_of_vertex_0(const TestMesh& mesh, uint32_t level) {
    const auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control);
    const auto refinement = build_refinement(*control, {level, false});
    EXPECT_TRUE(refinement);
    const auto table = build_limit_table<double>(*refinement, level, true);
    EXPECT_TRUE(table);
    const OsdOracle::Limits limits = apply_limit_table(*table, mesh.positions_double());
    return {vector_at(limits.positions, 0), vector_at(limits.tangents1, 0), vector_at(limits.tangents2, 0)};
}

// First level at which no finite sharpness is left.
uint32_t level_of_limits(const TestMesh& mesh) {
    return std::max(1u, static_cast<uint32_t>(std::ceil(mesh.max_finite_sharpness())));
}

void expect_limit(const TestMesh& mesh, double tolerance, uint32_t steps = 60) {
    const Truth truth = refine_deeply(mesh, steps);
    ASSERT_LT(truth.moved, tolerance / 10) << "the refinement has not converged";
    // Limits are exact at every level, also where sharpness is yet to decay.
    for (uint32_t level : {0u, 1u, level_of_limits(mesh), level_of_limits(mesh) + 1}) {
        const Ours ours = limit_of_vertex_0(mesh, level);
        EXPECT_LT(length(ours.limit - truth.limit), tolerance * mesh.size()) << "level " << level;
    }
}

// Where the two tangents shrink at different rates the ring soon looks like a line: too many steps leave the
// shorter one to rounding errors.
void expect_normal(const TestMesh& mesh, double degrees, uint32_t steps = 60) {
    const Truth truth = refine_deeply(mesh, steps);
    for (uint32_t level : {0u, 1u, level_of_limits(mesh)}) {
        const Ours ours = limit_of_vertex_0(mesh, level);
        ASSERT_GT(length(ours.normal()), 0.0) << "level " << level;
        EXPECT_LT(angle(ours.normal(), truth.normal), degrees) << "level " << level;
    }
}

// Tangent masks are left eigenvectors of the refinement: taken one level later they give the same directions,
// shorter.
void expect_eigenvectors(const TestMesh& mesh) {
    const uint32_t level = level_of_limits(mesh);
    const Ours first = limit_of_vertex_0(mesh, level), second = limit_of_vertex_0(mesh, level + 1);
    EXPECT_LT(length(first.limit - second.limit), 1e-12);
    for (const auto& [a, b] :
         {std::pair(first.tangent1, second.tangent1), std::pair(first.tangent2, second.tangent2)}) {
        ASSERT_GT(length(a), 1e-9);
        ASSERT_GT(length(b), 1e-9);
        EXPECT_LT(angle(a, b), 1e-6);
    }
}

TestMesh with(TestMesh mesh, Scheme scheme) {
    mesh.options.scheme = scheme;
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

TEST(DeepRefinement, smooth_vertices) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n = 3; n <= 9; ++n) {
            SCOPED_TRACE(std::string(name_of(scheme)) + " valence " + std::to_string(n));
            const TestMesh mesh = make_full(scheme, n);
            expect_limit(mesh, 1e-12);
            expect_normal(mesh, 1e-3);
            expect_eigenvectors(mesh);
        }
    }
}

TEST(DeepRefinement, smooth_vertices_of_two_faces) {
    // Catmull-Clark: three sides of each of two quads around vertex 0 lie on a larger ring.
    const TestMesh quads = make_full(Scheme::catmull_clark, 2);
    expect_limit(quads, 1e-12);
    // Loop: two triangles that share two edges would have a third edge in common; only the position exists.
    TestMesh triangles = with(make_triangle_star(2, 2), Scheme::loop);
    expect_limit(triangles, 1e-12);
}

TEST(DeepRefinement, valence_two_tangents_are_eigenvectors) {
    expect_eigenvectors(make_full(Scheme::catmull_clark, 2));
}

TEST(DeepRefinement, boundary_vertices) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t k = 1; k <= 6; ++k) {
            SCOPED_TRACE(std::string(name_of(scheme)) + ", faces at the boundary " + std::to_string(k));
            const TestMesh mesh = make_half(scheme, k);
            expect_limit(mesh, 1e-12);
            expect_eigenvectors(mesh);
            // From 4 quads (6 triangles) on, another mode shrinks no faster than the one along the boundary:
            // the surface has no tangent plane there, and the fan's normal no limit.
            if (k < (scheme == Scheme::loop ? 6u : 4u)) expect_normal(mesh, 0.01, k == 1 ? 20 : 100);
        }
    }
}

TEST(DeepRefinement, corners) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t k = 1; k <= 4; ++k) {
            SCOPED_TRACE(std::string(name_of(scheme)) + ", faces at the corner " + std::to_string(k));
            TestMesh mesh = make_half(scheme, k);
            mesh.add_corner(0, 10);
            expect_limit(mesh, 1e-12);
            if (k == 1) {
                mesh = make_half(scheme, k);
                mesh.options.boundary = BoundaryInterpolation::edge_and_corner;
                expect_limit(mesh, 1e-12);
                expect_normal(mesh, 1e-3);
                expect_eigenvectors(mesh);
            }
        }
    }
}

// A crease through vertex 0 with k faces on one side of n.
TestMesh make_creased(Scheme scheme, uint32_t n, uint32_t k, double sharpness) {
    TestMesh mesh = make_full(scheme, n);
    mesh.add_crease_path({2, 1, 0, 1 + 2 * k, 2 + 2 * k}, sharpness);
    return mesh;
}

TEST(DeepRefinement, infinite_creases) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n = 3; n <= 8; ++n) {
            for (uint32_t k = 1; k < n; ++k) {
                SCOPED_TRACE(std::string(name_of(scheme)) + " valence " + std::to_string(n) + ", side of " +
                             std::to_string(k));
                const TestMesh mesh = make_creased(scheme, n, k, 10);
                expect_limit(mesh, 1e-12);
                expect_eigenvectors(mesh);
            }
        }
    }
}

TEST(DeepRefinement, semi_sharp_creases) {
    for (Scheme scheme : kSchemes) {
        for (double sharpness : {0.4, 1.0, 1.7, 2.5}) {
            for (uint32_t n : {3u, 4u, 5u, 7u}) {
                SCOPED_TRACE(std::string(name_of(scheme)) + " valence " + std::to_string(n) + ", sharpness " +
                             std::to_string(sharpness));
                const TestMesh mesh = make_creased(scheme, n, n / 2, sharpness);
                expect_limit(mesh, 1e-7);  // the share of a fading rule is float arithmetic in OpenSubdiv
                expect_normal(mesh, 1e-3);
                TestMesh corner = make_full(scheme, n);
                corner.add_corner(0, sharpness);
                expect_limit(corner, 1e-7);
                expect_normal(corner, 1e-3);
            }
        }
    }
}

TEST(DeepRefinement, semi_sharp_darts) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n = 3; n <= 8; ++n) {
            SCOPED_TRACE(std::string(name_of(scheme)) + " valence " + std::to_string(n));
            TestMesh mesh = make_full(scheme, n);
            mesh.add_crease_path({0, 1, 2}, 1.6);
            expect_limit(mesh, 1e-7);
            expect_normal(mesh, 1e-3);
        }
    }
}

TEST(DeepRefinement, infinitely_sharp_darts) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n = 3; n <= 8; ++n) {
            SCOPED_TRACE(std::string(name_of(scheme)) + " valence " + std::to_string(n));
            TestMesh mesh = make_full(scheme, n);
            mesh.add_crease_path({0, 1, 2}, 10);
            expect_limit(mesh, 1e-12, 100);
            expect_eigenvectors(mesh);
            expect_normal(mesh, 0.1, 35);
        }
    }
}

// A crease of one kind that meets another: an infinite dart whose chain goes on semi-sharp.
TEST(DeepRefinement, infinite_crease_that_continues_semi_sharp) {
    for (Scheme scheme : kSchemes) {
        for (uint32_t n = 4; n <= 7; ++n) {
            SCOPED_TRACE(std::string(name_of(scheme)) + " valence " + std::to_string(n));
            TestMesh mesh = make_full(scheme, n);
            mesh.add_crease_path({0, 1, 2}, 10);
            mesh.add_crease_path({0, 5, 6}, 1.3);
            expect_limit(mesh, 1e-7, 100);
        }
    }
}

TEST(DeepRefinement, polygons_around_the_vertex) {
    TestMesh globe = make_globe(5, 1);  // triangles around vertex 0
    expect_limit(globe, 1e-12);
    expect_normal(globe, 1e-3);
    expect_eigenvectors(globe);
    TestMesh prism = make_prism(6);  // a hexagon and two quads
    expect_limit(prism, 1e-12);
    expect_normal(prism, 1e-3);
    globe.options.triangles = TriangleSubdivision::smooth;
    expect_limit(globe, 1e-12);
    expect_normal(globe, 1e-3);
}

TEST(DeepRefinement, bilinear) {
    for (uint32_t n = 3; n <= 6; ++n) {
        const TestMesh mesh = with(make_quad_star(n, 1), Scheme::bilinear);
        expect_limit(mesh, 1e-12, 10);
        EXPECT_LT(length(limit_of_vertex_0(mesh, 1).limit - vector_at(mesh.positions_double(), 0)), 1e-15);
        const TestMesh half = with(make_quad_half_star(n, 1), Scheme::bilinear);
        expect_limit(half, 1e-12, 10);
    }
}

// The checks above notice what they are there for.
TEST(DeepRefinement, opensubdiv_masks_fail_where_they_are_known_to) {
    TestMesh dart = make_full(Scheme::catmull_clark, 3);
    dart.add_crease_path({0, 1, 2}, 10);
    const Truth truth = refine_deeply(dart, 60);
    dart.options.opensubdiv_compatible = true;
    EXPECT_GT(length(limit_of_vertex_0(dart, 1).limit - truth.limit), 1e-3);
    for (Scheme scheme : kSchemes) {
        TestMesh half = make_half(scheme, scheme == Scheme::loop ? 4 : 3);
        half.options.opensubdiv_compatible = true;
        const Vector a = limit_of_vertex_0(half, 1).tangent2, b = limit_of_vertex_0(half, 2).tangent2;
        EXPECT_GT(angle(a, b), 0.1);
    }
}

}  // namespace
}  // namespace limn::test
