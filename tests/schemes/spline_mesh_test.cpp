// B-spline surfaces as control meshes, and back: patch tables give the same surface as de Boor's algorithm.
#include "limn/schemes/spline_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "schemes/rational_sphere.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr int kSteps = 13;

std::vector<double> random_points(size_t count, RandomNumbers& random) {
    std::vector<double> points(count);
    for (double& x : points) x = random.uniform(-1, 1);
    return points;
}
BSplineSurface random_surface(KnotVector u, KnotVector v, uint32_t width, uint64_t seed) {
    RandomNumbers random(seed);
    const size_t count = size_t{u.point_count()} * v.point_count();
    return {std::move(u), std::move(v), width, random_points(count * width, random)};
}

std::vector<double> apply(const StencilTableDouble& table, std::span<const double> points, uint32_t width) {
    std::vector<double> out(size_t{table.row_count()} * width);
    apply_stencil_table<double>(table, points, out, width);
    return out;
}

/// The limit surface of a control mesh at samples, six values each.
std::vector<double> evaluate(const ControlMesh& control, std::span<const double> vertices, uint32_t width,
                             const std::vector<PatchSample>& samples) {
    const auto table = build_patch_table<double>(control, {});
    EXPECT_TRUE(table);
    std::vector<double> points(size_t{table->point_count()} * width), values(samples.size() * 6 * width);
    std::vector<SampleStatus> statuses(samples.size());
    build_patch_points(*table, vertices, width, points);
    evaluate_patches(*table, samples, points, width, Derivatives::second, values, statuses);
    for (const SampleStatus status : statuses) EXPECT_EQ(status, SampleStatus::valid);
    return values;
}

/// The largest difference between six values of a surface and those of a mesh, at places given in both ways.
double worst_difference(const BSplineSurface& surface, const std::vector<double>& us,
                        const std::vector<double>& vs, const std::vector<double>& values, double u_scale,
                        double v_scale) {
    const double scales[6] = {1, u_scale, v_scale, u_scale * u_scale, u_scale * v_scale, v_scale * v_scale};
    double worst = 0;
    std::vector<double> truth(6 * size_t{surface.width});
    for (size_t s = 0; s < us.size(); ++s) {
        evaluate_b_spline_surface(surface, us[s], vs[s], truth);
        for (size_t k = 0; k < truth.size(); ++k) {
            const double difference =
                std::abs(values[s * truth.size() + k] - truth[k] * scales[k / surface.width]);
            worst = std::isfinite(difference) ? std::max(worst, difference) : HUGE_VAL;
        }
    }
    return worst;
}

/// Of the surface and its mesh; HUGE_VAL where there is none.
double conversion_error(const BSplineSurface& surface) {
    const auto mesh = build_spline_mesh(surface);
    EXPECT_TRUE(mesh) << mesh.error().message;
    if (!mesh) return HUGE_VAL;
    const auto control = ControlMesh::create(mesh->description());
    EXPECT_TRUE(control) << control.error().message;
    std::vector<double> us, vs;
    std::vector<PatchSample> samples;
    for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; j <= kSteps; ++j) {
            us.push_back(std::lerp(surface.u.begin(), surface.u.end(), i / double{kSteps}));
            vs.push_back(std::lerp(surface.v.begin(), surface.v.end(), j / double{kSteps}));
            samples.push_back(locate_on_spline_mesh(*mesh, us.back(), vs.back()));
        }
    const auto vertices = apply(mesh->vertices, surface.points, surface.width);
    const auto values = evaluate(*control, vertices, surface.width, samples);
    return worst_difference(surface, us, vs, values, mesh->u.knots[4] - mesh->u.knots[3],
                            mesh->v.knots[4] - mesh->v.knots[3]);
}

TEST(SplineMesh, surfaces_of_even_knots_are_their_control_points) {
    const BSplineSurface surface = random_surface(make_uniform_knots(3, 7), make_uniform_knots(3, 5), 3, 1);
    const auto mesh = build_spline_mesh(surface);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->u_count, 7u);
    EXPECT_EQ(mesh->v_count, 5u);
    const auto vertices = apply(mesh->vertices, surface.points, 3);
    for (size_t i = 0; i < vertices.size(); ++i) EXPECT_NEAR(vertices[i], surface.points[i], 1e-14);
    EXPECT_LE(conversion_error(surface), 1e-12);
}

TEST(SplineMesh, clamped_and_bezier_ends_are_exact) {
    EXPECT_LE(conversion_error(random_surface(make_clamped_knots(3, 7), make_clamped_knots(3, 4), 3, 2)),
              2e-12);
    EXPECT_LE(conversion_error(random_surface(make_clamped_knots(3, 4), make_clamped_knots(3, 4), 1, 3)),
              2e-12);
    // One end clamped, one as far away as it likes.
    const KnotVector mixed{3, {0, 0, 0, 0, 1, 2, 3, 3.7, 5, 5}};
    EXPECT_LE(conversion_error(random_surface(mixed, make_uniform_knots(3, 6), 4, 4)), 1e-10);
}

TEST(SplineMesh, intervals_of_a_common_measure_are_exact) {
    const KnotVector u{3, {0, 0, 0, 0, 1, 3, 3.5, 5, 5, 5, 5}};
    const BSplineSurface surface = random_surface(u, make_uniform_knots(3, 5), 3, 5);
    const auto mesh = build_spline_mesh(surface);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->u.point_count(), 13u);  // ten halves
    EXPECT_LE(conversion_error(surface), 1e-11);
    // In tenths, which are no binary fractions.
    const KnotVector tenths{3, {-0.3, 0.1, 0.2, 0.3, 0.4, 0.7, 0.9, 1.0, 1.1, 1.3}};
    EXPECT_LE(conversion_error(random_surface(tenths, u, 3, 6)), 1e-10);
}

TEST(SplineMesh, single_intervals_of_lower_degree_are_exact) {
    for (uint32_t u = 1; u <= 3; ++u)
        for (uint32_t v = 1; v <= 3; ++v)
            EXPECT_LE(conversion_error(random_surface(make_clamped_knots(u, u + 1),
                                                      make_uniform_knots(v, v + 1), 2, u + 3 * v)),
                      1e-12);
}

/// The first three rows again behind the last, in u, or in both directions.
BSplineSurface closed_surface(bool v_too, uint64_t seed) {
    BSplineSurface s = random_surface(make_uniform_knots(3, 9), make_uniform_knots(3, 8), 3, seed);
    for (uint32_t j = 0; j < 8; ++j)
        for (uint32_t i = 0; i < 9; ++i)
            for (uint32_t c = 0; c < 3; ++c)
                s.points[(j * 9 + i) * 3 + c] = s.points[((v_too ? j % 5 : j) * 9 + i % 6) * 3 + c];
    return s;
}

TEST(SplineMesh, closed_surfaces_are_closed_meshes) {
    for (const bool v_too : {false, true}) {
        const BSplineSurface surface = closed_surface(v_too, 7);
        const auto mesh = build_spline_mesh(surface);
        ASSERT_TRUE(mesh);
        EXPECT_TRUE(mesh->u_closed);
        EXPECT_EQ(mesh->v_closed, v_too);
        EXPECT_EQ(mesh->u_count, 6u);
        EXPECT_EQ(mesh->v_count, v_too ? 5u : 8u);
        EXPECT_EQ(mesh->face_sizes.size(), v_too ? 30u : 42u);
        EXPECT_LE(conversion_error(surface), 1e-12);
    }
    // The same surface with knots inserted until it begins at its control points: still found to be closed.
    BSplineSurface clamped = closed_surface(false, 7);
    KnotVector ends = clamped.u;
    std::fill_n(ends.knots.begin(), 3, ends.begin());
    std::fill_n(ends.knots.end() - 3, 3, ends.end());
    const auto along_u = build_blossom_table<double>(clamped.u, ends);
    const auto along_v = build_blossom_table<double>(clamped.v, clamped.v);
    ASSERT_TRUE(along_u && along_v);
    clamped.points = apply(*multiply_directions(*along_u, *along_v), clamped.points, 3);
    clamped.u = ends;
    const auto mesh = build_spline_mesh(clamped);
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(mesh->u_closed);
    EXPECT_LE(conversion_error(clamped), 1e-10);
}

TEST(SplineMesh, rational_spheres_are_exact) {
    EXPECT_FALSE(build_spline_mesh(make_sphere()));
    const std::vector<BSplineSurface> parts = split_at_full_knots(make_sphere());
    ASSERT_EQ(parts.size(), 8u);
    for (const BSplineSurface& part : parts) {
        ASSERT_TRUE(check_surface(part));
        EXPECT_LE(conversion_error(part), 1e-13);
        const auto mesh = build_spline_mesh(part);
        ASSERT_TRUE(mesh);
        const auto control = ControlMesh::create(mesh->description());
        const auto vertices = apply(mesh->vertices, part.points, 4);
        std::vector<PatchSample> samples;
        for (int i = 1; i < 10; ++i) samples.push_back({4, i / 10.0, 1 - i / 12.0});
        const auto values = evaluate(*control, vertices, 4, samples);
        for (size_t s = 0; s < samples.size(); ++s) {
            double p[18], truth[24], q[18];
            divide_surface_by_weight(std::span(values).subspan(s * 24, 24), 4, p);
            EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), 1, 1e-14);
            const double u = part.u.begin() + samples[s].u, v = part.v.begin() + samples[s].v;
            evaluate_b_spline_surface(make_sphere(), u, v, truth);
            divide_surface_by_weight(truth, 4, q);
            for (size_t k = 0; k < 18; ++k) EXPECT_NEAR(p[k], q[k], 1e-12);
            // x . x = 1, differentiated twice.
            const auto dot = [&](size_t a, size_t b) {
                return p[3 * a] * p[3 * b] + p[3 * a + 1] * p[3 * b + 1] + p[3 * a + 2] * p[3 * b + 2];
            };
            EXPECT_NEAR(dot(0, 1), 0, 1e-14);
            EXPECT_NEAR(dot(0, 3) + dot(1, 1), 0, 1e-13);
            EXPECT_NEAR(dot(0, 4) + dot(1, 2), 0, 1e-13);
        }
    }
}

// Doo and Sabin's rule in a grid: corner points are 9, 3, 3 and 1 sixteenths of the corners of a face.
TEST(SplineMesh, quadratic_surfaces_are_refined_by_doo_and_sabin) {
    BSplineSurface surface = random_surface(make_clamped_knots(2, 6), make_uniform_knots(2, 5), 3, 9);
    const auto mesh = build_spline_mesh(surface, {.degree = 2});
    ASSERT_TRUE(mesh) << mesh.error().message;
    const auto vertices = apply(mesh->vertices, surface.points, 3);
    const auto halves_of = [](const KnotVector& k) {
        KnotVector out{2, {}};
        for (size_t i = 0; i + 1 < k.knots.size(); ++i)
            out.knots.insert(out.knots.end(), {k.knots[i], (k.knots[i] + k.knots[i + 1]) / 2});
        out.knots.push_back(k.knots.back());
        out.knots = {out.knots.begin() + 2, out.knots.end() - 2};
        return out;
    };
    const KnotVector u = halves_of(mesh->u), v = halves_of(mesh->v);
    const auto refined =
        multiply_directions(*build_oslo_table<double>(mesh->u, u), *build_oslo_table<double>(mesh->v, v));
    ASSERT_TRUE(refined);
    const auto points = apply(*refined, vertices, 3);
    const uint32_t columns = u.point_count();
    ASSERT_EQ(columns, 2 * (mesh->u_count - 1));
    for (uint32_t f = 0; f < mesh->face_sizes.size(); ++f) {
        const uint32_t i = f % mesh->u_face_count(), j = f / mesh->u_face_count();
        constexpr uint32_t kPlaces[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        for (uint32_t corner = 0; corner < 4; ++corner)
            for (uint32_t c = 0; c < 3; ++c) {
                const auto at = [&](uint32_t k) {
                    return vertices[mesh->face_vertices[4 * f + (corner + k) % 4] * size_t{3} + c];
                };
                const uint32_t r = 2 * i + kPlaces[corner][0] + (2 * j + kPlaces[corner][1]) * columns;
                EXPECT_NEAR(points[size_t{r} * 3 + c], (9 * at(0) + 3 * at(1) + at(2) + 3 * at(3)) / 16,
                            1e-13);
            }
    }
    // And it is the surface.
    for (int i = 0; i <= kSteps; ++i) {
        const double x = std::lerp(surface.u.begin(), surface.u.end(), i / double{kSteps}),
                     y = surface.v.begin() + 1.1;
        double a[18], b[18];
        evaluate_b_spline_surface(surface, x, y, a);
        evaluate_b_spline_surface({mesh->u, mesh->v, 3, vertices}, x, y, b);
        for (int k = 0; k < 18; ++k) EXPECT_NEAR(a[k], b[k], 1e-12);
    }
}

struct QuadMesh {
    std::vector<uint32_t> face_vertices;
    uint32_t vertex_count;
};
/// Rows of quads, in an order of their own, each from a corner of its own, vertices renumbered.
QuadMesh make_rows(uint32_t columns, uint32_t rows, bool u_closed, bool v_closed, uint64_t seed) {
    RandomNumbers random(seed);
    const uint32_t us = columns + (u_closed ? 0 : 1), vs = rows + (v_closed ? 0 : 1);
    std::vector<uint32_t> names(us * vs), faces(columns * rows);
    for (uint32_t i = 0; i < names.size(); ++i) names[i] = i;
    for (uint32_t i = 0; i < faces.size(); ++i) faces[i] = i;
    for (auto* list : {&names, &faces})
        for (size_t i = list->size(); i > 1; --i)
            std::swap((*list)[i - 1], (*list)[random.below(static_cast<uint32_t>(i))]);
    QuadMesh mesh{{}, us * vs};
    for (const uint32_t f : faces) {
        const uint32_t i = f % columns, j = f / columns, turn = random.below(4);
        const auto vertex = [&](uint32_t a, uint32_t b) { return names[a % us + b % vs * us]; };
        const uint32_t corners[4] = {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)};
        for (uint32_t k = 0; k < 4; ++k) mesh.face_vertices.push_back(corners[(k + turn) % 4]);
    }
    return mesh;
}

/// Every place of the surface that build_b_spline_surface gives is one of the limit surface: compared as
/// sets, by the middles and other places of faces.
double back_conversion_error(const QuadMesh& quads, BoundaryInterpolation boundary, uint64_t seed) {
    RandomNumbers random(seed);
    const std::vector<double> points = random_points(size_t{quads.vertex_count} * 3, random);
    const std::vector<uint32_t> sizes(quads.face_vertices.size() / 4, 4);
    ControlMeshDescription description;
    description.options.boundary = boundary;
    description.vertex_count = quads.vertex_count;
    description.face_sizes = sizes;
    description.face_vertices = quads.face_vertices;
    const auto control = ControlMesh::create(description);
    EXPECT_TRUE(control);
    const auto surface = build_b_spline_surface(*control, points, 3);
    EXPECT_TRUE(surface) << surface.error().message;
    if (!surface) return HUGE_VAL;
    EXPECT_TRUE(check_surface(*surface));
    // The mesh of that surface again, whose patches have been compared with it.
    const auto mesh = build_spline_mesh(*surface);
    EXPECT_TRUE(mesh);
    EXPECT_LE(conversion_error(*surface), 1e-12);
    const auto table = build_patch_table<double>(*control, {});
    std::vector<double> all(size_t{table->point_count()} * 3);
    build_patch_points(*table, points, 3, all);
    const auto face_count = static_cast<uint32_t>(sizes.size());
    uint32_t found = 0, valid = 0;
    double worst = 0;
    for (uint32_t f = 0; f < face_count; ++f) {
        const PatchSample samples[1] = {{f, 0.5, 0.5}};
        double middle[3];
        SampleStatus status[1];
        evaluate_patches<double>(*table, samples, all, 3, Derivatives::none, middle, status);
        if (status[0] != SampleStatus::valid) continue;
        ++valid;
        double nearest = HUGE_VAL, out[18];
        for (double v = 0.5; v < surface->v.end(); ++v)
            for (double u = 0.5; u < surface->u.end(); ++u) {
                evaluate_b_spline_surface(*surface, u, v, out);
                nearest =
                    std::min(nearest, std::max({std::abs(out[0] - middle[0]), std::abs(out[1] - middle[1]),
                                                std::abs(out[2] - middle[2])}));
            }
        found += nearest < 1e-12;
        worst = std::max(worst, nearest);
    }
    EXPECT_EQ(valid, (surface->u.point_count() - 3) * (surface->v.point_count() - 3));
    EXPECT_EQ(found, valid);
    return worst;
}

TEST(SplineMesh, meshes_in_rows_are_surfaces) {
    using enum BoundaryInterpolation;
    EXPECT_LE(back_conversion_error(make_rows(6, 4, false, false, 1), none, 1), 1e-12);
    EXPECT_LE(back_conversion_error(make_rows(5, 4, false, false, 2), edge_and_corner, 2), 1e-12);
    EXPECT_LE(back_conversion_error(make_rows(1, 1, false, false, 3), edge_and_corner, 3), 1e-12);
    EXPECT_LE(back_conversion_error(make_rows(6, 3, true, false, 4), edge_only, 4), 1e-12);
    EXPECT_LE(back_conversion_error(make_rows(4, 5, false, true, 5), edge_and_corner, 5), 1e-12);
    EXPECT_LE(back_conversion_error(make_rows(5, 5, true, false, 6), none, 6), 1e-12);
    EXPECT_LE(back_conversion_error(make_rows(7, 5, true, true, 7), edge_only, 7), 1e-12);
}

TEST(SplineMesh, refuses_what_is_not_exact) {
    const auto code = [](const BSplineSurface& surface, const SplineMeshOptions& options = {}) {
        const auto mesh = build_spline_mesh(surface, options);
        return mesh ? std::optional<ErrorCode>() : mesh.error().code;
    };
    const KnotVector good = make_uniform_knots(3, 6);
    const auto along_u = [&](KnotVector knots) { return random_surface(std::move(knots), good, 2, 1); };
    EXPECT_FALSE(code(along_u(good)));
    EXPECT_EQ(code(along_u({3, {0, 0, 0, 0, 1, 1, 2, 2, 2, 2}})), ErrorCode::unsupported);  // twice
    EXPECT_EQ(code(along_u({3, {0, 0, 0, 0, 1, std::numbers::pi, std::numbers::pi, 4, 4, 4}})),
              ErrorCode::unsupported);
    EXPECT_EQ(code(along_u({3, {0, 0, 0, 0, 1, std::numbers::pi, 5, 5, 5, 5}})), ErrorCode::unsupported);
    EXPECT_EQ(code(along_u(make_uniform_knots(2, 6))), ErrorCode::unsupported);
    EXPECT_EQ(code(along_u(make_uniform_knots(4, 6))), ErrorCode::unsupported);
    EXPECT_EQ(code(along_u({3, {0, 0, 0, 0, 1, 100, 100, 100, 100}}), {.max_intervals = 99}),
              ErrorCode::unsupported);
    EXPECT_FALSE(code(along_u({3, {0, 0, 0, 0, 1, 100, 100, 100, 100}}), {.max_intervals = 100}));
    EXPECT_EQ(code(along_u({3, {0, 0, 0, 0, 1e-300, 1, 1, 1, 1}}), {.tolerance = 0}), ErrorCode::unsupported);
    EXPECT_EQ(code(along_u(good), {.degree = 4}), ErrorCode::invalid_argument);
    BSplineSurface bad = along_u(good);
    bad.points.pop_back();
    EXPECT_EQ(code(bad), ErrorCode::invalid_argument);
    bad.points.push_back(HUGE_VAL);
    EXPECT_EQ(code(bad), ErrorCode::not_finite);

    const auto refused = [](const TestMesh& mesh) {
        const auto control = ControlMesh::create(mesh.description());
        EXPECT_TRUE(control);
        const auto surface = build_b_spline_surface(*control, mesh.positions_double(), 3);
        return !surface && surface.error().code == ErrorCode::unsupported;
    };
    EXPECT_TRUE(refused(make_cube()));
    EXPECT_TRUE(refused(make_quad_star(5, 3)));
    EXPECT_TRUE(refused(make_prism(5)));
    EXPECT_TRUE(refused(make_grid(4, 4)));  // round corners
    TestMesh creased = make_grid(4, 4);
    creased.options.boundary = BoundaryInterpolation::edge_and_corner;
    EXPECT_FALSE(refused(creased));
    creased.add_crease(creased.face_vertices[2], creased.face_vertices[3], 2);
    EXPECT_TRUE(refused(creased));
    // A torus that is joined with a shift: rows never come back to where they began.
    QuadMesh twisted{{}, 20};
    for (uint32_t j = 0; j < 4; ++j)
        for (uint32_t i = 0; i < 5; ++i) {
            const auto vertex = [](uint32_t a, uint32_t b) { return (a + (b == 4 ? 2 : 0)) % 5 + b % 4 * 5; };
            for (const uint32_t v : {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)})
                twisted.face_vertices.push_back(v);
        }
    const std::vector<uint32_t> sizes(20, 4);
    ControlMeshDescription description;
    description.vertex_count = 20;
    description.face_sizes = sizes;
    description.face_vertices = twisted.face_vertices;
    const auto control = ControlMesh::create(description);
    ASSERT_TRUE(control);
    EXPECT_FALSE(build_b_spline_surface(*control, std::vector<double>(60), 3));
}

}  // namespace
}  // namespace limn::test
