// Doo-Sabin patch tables against tensor-product splines, and against refinement, whose face centroids are
// limit points.
#include "limn/schemes/doo_sabin_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "limn/batch.h"
#include "limn/evaluate.h"
#include "limn/mesh_edit.h"
#include "limn/patch_tree.h"
#include "limn/refinement.h"
#include "limn/schemes/scheme_limit.h"
#include "limn/tessellate.h"
#include "schemes/scheme_meshes.h"
#include "schemes/tensor_grid.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

using Points = std::vector<double>;
using Vector = std::array<double, 3>;
constexpr SchemeOptions kDooSabin = {.scheme = Scheme::doo_sabin};

const SubdivisionScheme& scheme() {
    return *find_subdivision_scheme("doo-sabin");
}
Vector vector_at(const Points& points, size_t i) {
    return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double distance(const Vector& a, const Vector& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
/// 0 where both are directions of the same half line.
double apart(const Vector& a, const Vector& b) {
    const Vector n = cross(a, b);
    return dot(a, b) <= 0 ? 1 : std::sqrt(dot(n, n) / (dot(a, a) * dot(b, b)));
}

/// A mesh with its patch table in double, and all points.
struct Surfaces {
    RefinedMesh mesh;
    ControlMesh control;
    PatchTableDouble table;
    Points points;
};
Surfaces surfaces_of(const RefinedMesh& mesh, const PatchTableOptions& options = {},
                     const PlanCache* cache = nullptr) {
    Surfaces out{mesh, control_mesh_of(mesh, kDooSabin), {}, {}};
    auto table = build_patch_table<double>(out.control, options, cache);
    EXPECT_TRUE(table) << table.error().message;
    out.table = std::move(*table);
    out.points.resize(size_t{3} * out.table.point_count());
    build_patch_points<double>(out.table, mesh.points, 3, out.points);
    return out;
}

/// value, du, dv, duu, duv, dvv
std::vector<std::array<Vector, 6>> evaluate(const Surfaces& s, const std::vector<PatchSample>& samples) {
    Points values(18 * samples.size());
    std::vector<SampleStatus> statuses(samples.size());
    evaluate_patches<double>(s.table, samples, s.points, 3, Derivatives::second, values, statuses);
    std::vector<std::array<Vector, 6>> out(samples.size());
    for (size_t i = 0; i < samples.size(); ++i) {
        EXPECT_EQ(statuses[i], SampleStatus::valid);
        for (size_t k = 0; k < 6; ++k) out[i][k] = vector_at(values, 6 * i + k);
    }
    return out;
}

/// Closed, irregular, without symmetry: two n-gons, and a mess of triangles, quads and hexagons.
std::vector<RefinedMesh> closed_meshes() {
    std::vector<RefinedMesh> out;
    for (uint64_t seed = 0; seed < 3; ++seed) out.push_back(make_irregular_mesh(scheme(), false, seed));
    out.push_back(make_random_manifold(scheme(), false, 1));
    return out;
}

Vector centroid(const Topology& t, uint32_t face, const Points& points) {
    Vector sum = {};
    for (const uint32_t v : t.vertices_of_face(face))
        for (size_t k = 0; k < 3; ++k) sum[k] += points[3 * size_t{v} + k] / t.size_of_face(face);
    return sum;
}

/// The mesh after some steps, and what its points are.
struct Level {
    Topology topology;
    Points points;
};
Level refine(const RefinedMesh& mesh, uint32_t level) {
    auto refined = build_scheme_refinement<double>(control_mesh_of(mesh), scheme(), {level, true});
    EXPECT_TRUE(refined) << refined.error().message;
    Points points = mesh.points;
    for (const StencilTableDouble& table : refined->tables) {
        Points next(size_t{3} * table.row_count());
        apply_stencil_table<double>(table, points, next, 3);
        points = std::move(next);
    }
    return {std::move(refined->last.topology), std::move(points)};
}

/// The ptex face of each corner, and where the corner, its edge's middle and the face's middle are on it.
struct CornerPlaces {
    PatchSample vertex, edge, face;
};
std::vector<CornerPlaces> corner_places(const ControlMesh& mesh) {
    std::vector<CornerPlaces> out;
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < mesh.face_count(); ++f) {
        const uint32_t size = mesh.face_offsets[f + 1] - mesh.face_offsets[f];
        const double u[5] = {0, 1, 1, 0, 0}, v[5] = {0, 0, 1, 1, 0};
        for (uint32_t j = 0; j < size; ++j) {
            if (size == 4)
                out.push_back({{ptex, u[j], v[j]},
                               {ptex, (u[j] + u[j + 1]) / 2, (v[j] + v[j + 1]) / 2},
                               {ptex, 0.5, 0.5}});
            else
                out.push_back({{ptex + j, 0, 0}, {ptex + j, 1, 0}, {ptex + j, 1, 1}});
        }
        ptex += size == 4 ? 1 : size;
    }
    return out;
}

TEST(DooSabinPatches, are_the_biquadratic_spline_of_a_torus) {
    constexpr uint32_t n = 5;
    const Surfaces s = surfaces_of(make_regular_torus(n, false));
    EXPECT_EQ(s.table.plans.size(), 1u);
    RandomNumbers random(3);
    std::vector<PatchSample> samples;
    for (uint32_t i = 0; i < 500; ++i)
        samples.push_back({random.below(n * n), random.uniform(0, 1), random.uniform(0, 1)});
    const auto values = evaluate(s, samples);
    // Weights, first and second derivatives of three control points in a row; the middle one is `nearest`.
    auto spline = [](double x, double(&w)[3][3]) {
        const double nearest = std::floor(x + 0.5), t = x - nearest + 0.5;
        const double f[3][3] = {
            {(1 - t) * (1 - t) / 2, 0.5 + t * (1 - t), t * t / 2}, {t - 1, 1 - 2 * t, t}, {1, -2, 1}};
        std::copy_n(&f[0][0], 9, &w[0][0]);
        return static_cast<uint32_t>(nearest);
    };
    constexpr uint32_t order[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    for (size_t i = 0; i < samples.size(); ++i) {
        double wu[3][3], wv[3][3];
        const uint32_t column = samples[i].face % n + spline(samples[i].u, wu),
                       row = samples[i].face / n + spline(samples[i].v, wv);
        for (size_t k = 0; k < 6; ++k) {
            Vector sum = {};
            for (uint32_t b = 0; b < 3; ++b)
                for (uint32_t a = 0; a < 3; ++a)
                    for (size_t c = 0; c < 3; ++c)
                        sum[c] +=
                            wv[order[k][1]][b] * wu[order[k][0]][a] *
                            s.mesh.points[3 * ((row + b + n - 1) % n * n + (column + a + n - 1) % n) + c];
            EXPECT_LT(distance(values[i][k], sum), 1e-11) << i << " " << k;
        }
    }
}

// Level 1 has faces of faces, of edges and of vertices, in this order: their centroids are where ptex faces
// have their middles, the middles of their sides and their corners.
TEST(DooSabinPatches, corners_are_centroids_of_level_1) {
    for (const RefinedMesh& mesh : closed_meshes()) {
        const Surfaces s = surfaces_of(mesh);
        const Topology base = build_topology(s.control);
        const Level level = refine(mesh, 1);
        const std::vector<CornerPlaces> places = corner_places(s.control);
        std::vector<PatchSample> samples;
        for (const CornerPlaces& at : places) samples.insert(samples.end(), {at.vertex, at.edge, at.face});
        const auto values = evaluate(s, samples);
        for (uint32_t c = 0; c < base.corner_count(); ++c) {
            const uint32_t faces[3] = {base.face_count + base.edge_count + base.face_vertices[c],
                                       base.face_count + base.face_edges[c], base.face_of_corner(c)};
            for (size_t k = 0; k < 3; ++k)
                EXPECT_LT(distance(values[3 * c + k][0], centroid(level.topology, faces[k], level.points)),
                          1e-12);
        }
    }
}

/// All places whose coordinates are multiples of 2^-depth of the surface of a corner.
std::vector<PatchSample> dyadic_places(const Surfaces& s, uint32_t depth) {
    std::vector<PatchSample> out;
    for (const CornerPlaces& at : corner_places(s.control)) {
        const double steps = std::ldexp(1, static_cast<int>(depth));
        for (double j = 0; j <= steps; ++j)
            for (double i = 0; i <= steps; ++i)
                out.push_back({at.vertex.face, at.vertex.u + (at.face.u - at.vertex.u) * i / steps,
                               at.vertex.v + (at.face.v - at.vertex.v) * j / steps});
    }
    return out;
}

TEST(DooSabinPatches, go_through_all_centroids_of_refined_meshes) {
    constexpr uint32_t depth = 3;
    for (const RefinedMesh& mesh : closed_meshes()) {
        const Surfaces s = surfaces_of(mesh);
        const Level level = refine(mesh, 1 + depth);
        Points centroids, sampled;
        for (uint32_t f = 0; f < level.topology.face_count; ++f) {
            const Vector at = centroid(level.topology, f, level.points);
            centroids.insert(centroids.end(), at.begin(), at.end());
        }
        for (const auto& value : evaluate(s, dyadic_places(s, depth)))
            sampled.insert(sampled.end(), value[0].begin(), value[0].end());
        auto sorted = [](const Points& points) {
            std::vector<Vector> out;
            for (size_t i = 0; i < points.size() / 3; ++i) out.push_back(vector_at(points, i));
            std::sort(out.begin(), out.end());
            return out;
        };
        auto expect_within = [](const std::vector<Vector>& points, const std::vector<Vector>& others) {
            for (const Vector& p : points) {
                auto at = std::lower_bound(others.begin(), others.end(), Vector{p[0] - 1e-11, -1e9, -1e9});
                double least = 1;
                for (; at != others.end() && (*at)[0] <= p[0] + 1e-11; ++at)
                    least = std::min(least, distance(p, *at));
                EXPECT_LT(least, 1e-12);
            }
        };
        expect_within(sorted(sampled), sorted(centroids));
        expect_within(sorted(centroids), sorted(sampled));
    }
}

// Chords of the surface as small as doubles allow.
TEST(DooSabinPatches, derivatives_are_those_of_positions) {
    RandomNumbers random(5);
    for (const RefinedMesh& mesh : closed_meshes()) {
        const Surfaces s = surfaces_of(mesh);
        const auto faces = static_cast<uint32_t>(s.table.ptex_surfaces.size());
        constexpr double h = 1e-5;
        std::vector<PatchSample> samples;
        for (uint32_t i = 0; i < 300; ++i) {
            const PatchSample at = {random.below(faces), random.uniform(0.01, 0.99),
                                    random.uniform(0.01, 0.99)};
            samples.insert(samples.end(), {at,
                                           {at.face, at.u - h, at.v},
                                           {at.face, at.u + h, at.v},
                                           {at.face, at.u, at.v - h},
                                           {at.face, at.u, at.v + h}});
        }
        const auto values = evaluate(s, samples);
        for (size_t i = 0; i < values.size(); i += 5)
            for (size_t k = 0; k < 3; ++k) {
                EXPECT_NEAR(values[i][1][k], (values[i + 2][0][k] - values[i + 1][0][k]) / (2 * h), 1e-3);
                EXPECT_NEAR(values[i][2][k], (values[i + 4][0][k] - values[i + 3][0][k]) / (2 * h), 1e-3);
            }
    }
}

TEST(DooSabinPatches, normals_at_corners_are_those_of_limit_tables) {
    for (const RefinedMesh& mesh : closed_meshes()) {
        const Surfaces s = surfaces_of(mesh);
        auto refined = build_scheme_refinement<double>(control_mesh_of(mesh), scheme(), {0, true});
        const auto limit = build_scheme_limit_table(*refined, true);
        ASSERT_TRUE(limit) << limit.error().message;
        auto apply = [&](const Array<double>& weights) {
            Points out(size_t{3} * limit->row_count(), 0.0);
            for (uint32_t r = 0; r < limit->row_count(); ++r)
                for (uint32_t k = limit->offsets[r]; k < limit->offsets[r + 1]; ++k)
                    for (size_t i = 0; i < 3; ++i)
                        out[3 * size_t{r} + i] += weights[k] * mesh.points[3 * size_t{limit->indices[k]} + i];
            return out;
        };
        const Points position = apply(limit->weights), t1 = apply(limit->tangent1_weights),
                     t2 = apply(limit->tangent2_weights);
        std::vector<PatchSample> samples;
        for (const CornerPlaces& at : corner_places(s.control)) {
            // And what comes near it: beside a corner tangents turn as slowly as one likes.
            const double u = at.face.u - at.vertex.u, v = at.face.v - at.vertex.v;
            samples.insert(samples.end(),
                           {at.vertex, {at.vertex.face, at.vertex.u + 1e-7 * u, at.vertex.v + 2e-7 * v}});
        }
        const auto values = evaluate(s, samples);
        for (uint32_t c = 0; c < s.control.face_vertices.size(); ++c) {
            const uint32_t v = s.control.face_vertices[c];
            const Vector normal = cross(vector_at(t1, v), vector_at(t2, v));
            EXPECT_LT(distance(values[2 * c][0], vector_at(position, v)), 1e-12);
            EXPECT_LT(apart(cross(values[2 * c][1], values[2 * c][2]), normal), 1e-9) << v;
            EXPECT_LT(apart(cross(values[2 * c + 1][1], values[2 * c + 1][2]), normal), 1e-5) << v;
        }
    }
}

// Tangents run along the sides of surfaces, and all that meet at a corner agree in the normal.
TEST(DooSabinPatches, tangents_at_corners_are_along_sides) {
    for (const RefinedMesh& mesh : closed_meshes()) {
        const Surfaces s = surfaces_of(mesh);
        std::vector<PatchSample> samples;
        for (const CornerPlaces& at : corner_places(s.control))
            for (const PatchSample& corner : {at.vertex, at.face}) {
                auto beside = [&](double u, double v) {
                    return PatchSample{corner.face, corner.u + u * (corner.u > 0.5 ? -1 : 1),
                                       corner.v + v * (corner.v > 0.5 ? -1 : 1)};
                };
                if (corner.u == 0.5) continue;  // the middle of a quad is regular
                samples.insert(samples.end(), {corner, beside(1e-6, 0), beside(0, 1e-6)});
            }
        const auto values = evaluate(s, samples);
        for (size_t i = 0; i < values.size(); i += 3)
            for (size_t k = 1; k < 3; ++k) {
                EXPECT_LT(apart(values[i][k], values[i + k][k]), 1e-4);
                Vector chord = values[i + k][0];
                const bool back = (k == 1 ? samples[i].u : samples[i].v) > 0.5;
                for (size_t c = 0; c < 3; ++c) chord[c] = (chord[c] - values[i][0][c]) * (back ? -1 : 1);
                EXPECT_LT(apart(values[i][k], chord), 1e-4);
            }
    }
}

TEST(DooSabinPatches, do_not_depend_on_the_depth_of_plans_or_the_cache) {
    const RefinedMesh mesh = make_random_manifold(scheme(), false, 2);
    const PlanCache cache;
    const Surfaces one = surfaces_of(mesh, {.plan_depth = 1}),
                   again = surfaces_of(mesh, {.plan_depth = 1}, &cache),
                   deep = surfaces_of(mesh, {.plan_depth = 7}, &cache);
    EXPECT_EQ(one.table.plans.size(), again.table.plans.size());
    const auto plans = cache.size();
    EXPECT_EQ(plans, one.table.plans.size() + deep.table.plans.size());
    surfaces_of(mesh, {.plan_depth = 7}, &cache);
    EXPECT_EQ(cache.size(), plans);
    RandomNumbers random(1);
    std::vector<PatchSample> samples;
    for (uint32_t i = 0; i < 1000; ++i)
        samples.push_back({random.below(static_cast<uint32_t>(one.table.ptex_surfaces.size())),
                           std::pow(random.uniform(0, 1), 6), std::pow(random.uniform(0, 1), 6)});
    const auto a = evaluate(one, samples), b = evaluate(again, samples), c = evaluate(deep, samples);
    for (size_t i = 0; i < samples.size(); ++i) {
        EXPECT_EQ(a[i], b[i]);
        for (size_t k = 0; k < 3; ++k) EXPECT_LT(distance(a[i][k], c[i][k]), 1e-11);
    }
}

TEST(DooSabinPatches, rows_of_plans_sum_to_one) {
    PlanCache cache;
    for (const auto& [near, far] : {std::pair{4u, 4u}, {3u, 4u}, {7u, 4u}, {5u, 3u}, {3u, 3u}, {40u, 9u}}) {
        const BuiltPlan& plan = *find_doo_sabin_plan(near, far, 3, cache.impl());
        EXPECT_EQ(plan.ring_size, near + far + 1);
        const size_t stride = shared::plan_row_stride(plan.ring_size);
        for (uint32_t r = 0; r < plan.row_count; ++r) {
            double sum = 0;
            for (size_t j = 0; j < stride; ++j) sum += plan.weights[r * stride + j];
            const bool tangent = plan.has_corner_rows && (r == 1 || r == 2);
            EXPECT_NEAR(sum, tangent ? 0 : 1, 1e-12) << near << " " << far << " row " << r;
        }
    }
}

// Each edge of two triangles, once each way; and vertices where the patches of all faces around them are.
TEST(DooSabinPatches, tessellations_are_closed) {
    for (const RefinedMesh& mesh : closed_meshes()) {
        const Surfaces s = surfaces_of(mesh);
        const auto topology = build_tessellation_table(s.control, {});
        ASSERT_TRUE(topology) << topology.error().message;
        std::vector<uint32_t> rates(topology->rate_edge_count);
        for (uint32_t e = 0; e < rates.size(); ++e) rates[e] = (1 + e % 7) * shared::kRateOne;
        const auto tessellation = tessellate(*topology, rates, TessellationSpacing::integer);
        ASSERT_TRUE(tessellation) << tessellation.error().message;
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> edges;
        for (size_t i = 0; i < tessellation->indices.size(); ++i) {
            const size_t next = i % 3 == 2 ? i - 2 : i + 1;
            ++edges[{tessellation->indices[i], tessellation->indices[next]}];
        }
        for (const auto& [edge, count] : edges) {
            EXPECT_EQ(count, 1u);
            EXPECT_TRUE(edges.contains({edge.second, edge.first}));
        }
        // Both faces of an edge have the same points along it.
        const Topology base = build_topology(s.control);
        const std::vector<CornerPlaces> places = corner_places(s.control);
        auto on_edge = [&](uint32_t corner, double t) {  // t in [0, 1] from the corner to the next
            const CornerPlaces& from = places[corner];
            const uint32_t next_ptex = places[base.next_corner(corner)].vertex.face;
            if (from.face.u == 0.5)
                return PatchSample{from.vertex.face, from.vertex.u + 2 * t * (from.edge.u - from.vertex.u),
                                   from.vertex.v + 2 * t * (from.edge.v - from.vertex.v)};
            return t <= 0.5 ? PatchSample{from.vertex.face, 2 * t, 0} : PatchSample{next_ptex, 0, 2 - 2 * t};
        };
        std::vector<PatchSample> samples;
        for (uint32_t e = 0; e < base.edge_count; ++e)
            for (const double t : {0.0, 0.13, 0.4, 0.5, 0.77, 1.0})
                samples.insert(samples.end(), {on_edge(base.corners_of_edge(e)[0], t),
                                               on_edge(base.corners_of_edge(e)[1], 1 - t)});
        const auto values = evaluate(s, samples);
        for (size_t i = 0; i < values.size(); i += 2)
            EXPECT_LT(distance(values[i][0], values[i + 1][0]), 1e-12) << i;
    }
}

// As tables of other schemes they are merged, and have trees.
TEST(DooSabinPatches, tables_in_float_have_trees_and_batches) {
    const ControlMesh a = control_mesh_of(make_irregular_mesh(scheme(), false, 0), kDooSabin),
                      b = control_mesh_of(make_random_manifold(scheme(), false, 1), kDooSabin);
    const PatchTable first = *build_patch_table<float>(a, {}), second = *build_patch_table<float>(b, {});
    const auto trees = build_patch_trees(first, {.max_rate = 64});
    ASSERT_TRUE(trees) << trees.error().message;
    const PatchTable* tables[] = {&first, &second};
    const auto merged = merge_patch_tables<float>(tables);
    ASSERT_TRUE(merged) << merged.error().message;
    EXPECT_LT(merged->table.plans.size(), first.plans.size() + second.plans.size());
}

// Faces at boundaries are holes then, all others as if the mesh went on.
TEST(DooSabinPatches, open_meshes_end_before_their_boundaries) {
    const RefinedMesh grid = make_random_grid(5, 5, 1);
    const ControlMesh open = control_mesh_of(grid, {Scheme::doo_sabin, BoundaryInterpolation::none});
    const auto table = build_patch_table<double>(open, {});
    ASSERT_TRUE(table) << table.error().message;
    std::vector<uint32_t> drawn;
    for (uint32_t f = 0; f < 16; ++f)
        if (table->ptex_surfaces[f] != shared::kPtexHole) drawn.push_back(f);
    EXPECT_EQ(drawn, (std::vector<uint32_t>{5, 6, 9, 10}));
    const auto topology = build_tessellation_table(open, {});
    ASSERT_TRUE(topology) << topology.error().message;
    Points points(size_t{3} * table->point_count());
    build_patch_points<double>(*table, grid.points, 3, points);
    const std::vector<PatchSample> samples = {{5, 0, 0}, {10, 0.5, 0.5}};
    Points values(6);
    std::vector<SampleStatus> statuses(2);
    evaluate_patches<double>(*table, samples, points, 3, Derivatives::none, values, statuses);
    Vector vertex = {}, middle = {};  // weights 1, 6, 1 / 8 each way, and means of the middle four
    for (uint32_t j = 0; j < 5; ++j)
        for (uint32_t i = 0; i < 5; ++i)
            for (size_t k = 0; k < 3; ++k) {
                const double x = grid.points[3 * (5 * j + i) + k], w[5] = {1.0 / 8, 6.0 / 8, 1.0 / 8, 0, 0};
                vertex[k] += w[j] * w[i] * x;
                if (i >= 2 && i < 4 && j >= 2 && j < 4) middle[k] += x / 4;
            }
    EXPECT_LT(distance(vector_at(values, 0), vertex), 1e-12);
    EXPECT_LT(distance(vector_at(values, 1), middle), 1e-12);
}

TEST(DooSabinPatches, refuse_what_they_cannot_be_made_of) {
    auto code_of = [](const auto& result) {
        return result ? std::nullopt : std::optional(result.error().code);
    };
    auto mesh_of = [](const TestMesh& mesh) { return *ControlMesh::create(mesh.description()); };
    TestMesh grid = make_grid(3, 3);
    grid.options.scheme = Scheme::doo_sabin;
    EXPECT_EQ(code_of(build_patch_table<float>(mesh_of(grid), {})), ErrorCode::unsupported);
    TestMesh book = make_book(3, false);
    book.options.scheme = Scheme::doo_sabin;
    const auto of_book = build_patch_table<float>(mesh_of(book), {});
    EXPECT_EQ(code_of(of_book), ErrorCode::unsupported);
    TestMesh pillow;  // two squares, back to back
    for (uint32_t i = 0; i < 4; ++i) pillow.add_vertex(i == 1 || i == 2, i >= 2, 0);
    pillow.add_face({0, 1, 2, 3});
    pillow.add_face({3, 2, 1, 0});
    pillow.options.scheme = Scheme::doo_sabin;
    const auto of_pillow = build_patch_table<float>(mesh_of(pillow), {});
    ASSERT_EQ(code_of(of_pillow), ErrorCode::unsupported);
    EXPECT_NE(of_pillow.error().message.find("vertex 0"), std::string::npos);

    TestMesh column = make_prism(kMaxRingSize);
    column.options.scheme = Scheme::doo_sabin;
    EXPECT_EQ(code_of(build_patch_table<float>(mesh_of(column), {})), ErrorCode::unsupported);

    TestMesh cube = make_cube();
    cube.options.scheme = Scheme::doo_sabin;
    add_channel(cube, FaceVaryingInterpolation::none, [](uint32_t, uint32_t) { return false; });
    add_channel(cube, FaceVaryingInterpolation::all, [](uint32_t a, uint32_t b) { return a + b == 1; });
    EXPECT_EQ(code_of(build_patch_table<float>(mesh_of(cube), {.end_cap = EndCap::gregory})),
              ErrorCode::unsupported);
    EXPECT_EQ(code_of(build_refinement(mesh_of(cube), {1})), ErrorCode::unsupported);
    EXPECT_EQ(code_of(build_face_varying_patch_table<float>(mesh_of(cube), 0, {})), ErrorCode::unsupported);
    EXPECT_EQ(code_of(EditableMesh::create(mesh_of(cube), {})), ErrorCode::unsupported);
    // What is linear has the same ptex faces.
    const auto channel = build_face_varying_patch_table<float>(mesh_of(cube), 1, {});
    ASSERT_TRUE(channel) << channel.error().message;
    EXPECT_EQ(channel->ptex_surfaces.size(), 6u);
    const auto varying = build_patch_table<float>(mesh_of(cube), {.interpolation = Interpolation::varying});
    ASSERT_TRUE(varying) << varying.error().message;
    EXPECT_EQ(varying->ptex_surfaces.size(), 6u);
}

// Sharpness means nothing to the scheme.
TEST(DooSabinPatches, creases_are_left_out) {
    TestMesh cube = make_cube();
    cube.options.scheme = Scheme::doo_sabin;
    const ControlMesh smooth = *ControlMesh::create(cube.description());
    cube.add_crease(0, 1, 10);
    cube.add_corner(3, 2);
    const ControlMesh creased = *ControlMesh::create(cube.description());
    const PatchTable a = *build_patch_table<float>(smooth, {}), b = *build_patch_table<float>(creased, {});
    EXPECT_TRUE(std::equal(a.plan_weights.begin(), a.plan_weights.end(), b.plan_weights.begin(),
                           b.plan_weights.end()));
    EXPECT_TRUE(std::equal(a.point_weights.begin(), a.point_weights.end(), b.point_weights.begin(),
                           b.point_weights.end()));
    EXPECT_EQ(build_tessellation_table(smooth, {})->corner_count,
              build_tessellation_table(creased, {})->corner_count);
}

}  // namespace
}  // namespace limn::test
