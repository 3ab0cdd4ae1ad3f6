// What stencil tables must be, whatever the mesh.
#include "limn/stencil_table.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "limn/row_table.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

Refinement refine(const TestMesh& mesh, uint32_t level) {
    const auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control) << mesh.name;
    auto refinement = build_refinement(*control, {level, false});
    EXPECT_TRUE(refinement) << mesh.name;
    return std::move(refinement).value();
}

std::vector<TestMesh> some_shapes(size_t step) {
    std::vector<TestMesh> all = all_shapes(), result;
    for (size_t i = 0; i < all.size(); i += step) result.push_back(std::move(all[i]));
    return result;
}

template <class Real>
testing::AssertionResult well_formed(const BasicStencilTable<Real>& table, double tolerance) {
    if (table.offsets.empty() || table.offsets[0] != 0 || table.offsets.back() != table.indices.size() ||
        table.weights.size() != table.indices.size()) {
        return testing::AssertionFailure() << "array sizes do not agree";
    }
    for (uint32_t r = 0; r < table.row_count(); ++r) {
        std::vector<uint32_t> row(table.indices.begin() + table.offsets[r],
                                  table.indices.begin() + table.offsets[r + 1]);
        std::sort(row.begin(), row.end());
        if (std::adjacent_find(row.begin(), row.end()) != row.end()) {
            return testing::AssertionFailure() << "row " << r << " repeats an index";
        }
        double sum = 0, sum1 = 0, sum2 = 0;
        for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k) {
            if (table.indices[k] >= table.source_count) {
                return testing::AssertionFailure() << "row " << r << " refers to source " << table.indices[k];
            }
            sum += static_cast<double>(table.weights[k]);
            if (table.tangent1_weights.empty()) continue;
            sum1 += static_cast<double>(table.tangent1_weights[k]);
            sum2 += static_cast<double>(table.tangent2_weights[k]);
        }
        if (!(std::abs(sum - 1) <= tolerance)) {
            return testing::AssertionFailure() << "weights of row " << r << " sum to 1 + " << sum - 1;
        }
        if (!(std::abs(sum1) <= 100 * tolerance && std::abs(sum2) <= 100 * tolerance)) {
            return testing::AssertionFailure()
                   << "tangents of row " << r << " sum to " << sum1 << ", " << sum2;
        }
    }
    return testing::AssertionSuccess();
}

template <class Real>
testing::AssertionResult identical(const BasicStencilTable<Real>& a, const BasicStencilTable<Real>& b) {
    auto same = [](const auto& x, const auto& y) {
        return x.bytes() == y.bytes() && (x.bytes() == 0 || std::memcmp(x.data(), y.data(), x.bytes()) == 0);
    };
    if (a.source_count != b.source_count) return testing::AssertionFailure() << "sources";
    if (!same(a.offsets, b.offsets)) return testing::AssertionFailure() << "offsets";
    if (!same(a.indices, b.indices)) return testing::AssertionFailure() << "indices";
    if (!same(a.weights, b.weights)) return testing::AssertionFailure() << "weights";
    if (!same(a.tangent1_weights, b.tangent1_weights)) return testing::AssertionFailure() << "first tangents";
    if (!same(a.tangent2_weights, b.tangent2_weights))
        return testing::AssertionFailure() << "second tangents";
    return testing::AssertionSuccess();
}

std::vector<double> apply_table(const StencilTableDouble& table, std::span<const double> source,
                                uint32_t width = 3) {
    std::vector<double> result(size_t{table.row_count()} * width);
    apply_stencil_table<double>(table, source, result, width);
    return result;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return INFINITY;
    double result = 0;
    for (size_t i = 0; i < a.size(); ++i) result = std::max(result, std::abs(a[i] - b[i]));
    return result;
}

TEST(StencilTable, rows_are_well_formed) {
    for (const TestMesh& mesh : some_shapes(4)) {
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 2);
        for (Interpolation interpolation : {Interpolation::vertex, Interpolation::varying}) {
            for (uint32_t level = 0; level <= 2; ++level) {
                const auto table = build_stencil_table<double>(refinement, level, interpolation);
                const auto float_table = build_stencil_table<float>(refinement, level, interpolation);
                ASSERT_TRUE(table && float_table);
                EXPECT_EQ(table->source_count, mesh.vertex_count);
                EXPECT_EQ(table->row_count(), refinement.levels[level].vertex_count);
                EXPECT_TRUE(well_formed(*table, 1e-13));
                EXPECT_TRUE(well_formed(*float_table, 1e-6));
                if (level == 0) continue;
                const auto step = build_step_table<double>(refinement, level, interpolation);
                ASSERT_TRUE(step);
                EXPECT_EQ(step->source_count, refinement.levels[level - 1].vertex_count);
                EXPECT_EQ(step->row_count(), refinement.levels[level].vertex_count);
                EXPECT_TRUE(well_formed(*step, 1e-14));
            }
        }
        const auto limits = build_limit_table<double>(refinement, 2, true);
        ASSERT_TRUE(limits);
        EXPECT_EQ(limits->row_count(), refinement.last().vertex_count);
        EXPECT_EQ(limits->tangent1_weights.size(), limits->indices.size());
        EXPECT_EQ(limits->tangent2_weights.size(), limits->indices.size());
        EXPECT_TRUE(well_formed(*limits, 1e-13));
    }
}

template <class Real>
bool indices_are_unique(const BasicStencilTable<Real>& table) {
    for (uint32_t r = 0; r < table.row_count(); ++r) {
        std::vector<uint32_t> row(table.indices.begin() + table.offsets[r],
                                  table.indices.begin() + table.offsets[r + 1]);
        std::sort(row.begin(), row.end());
        if (std::adjacent_find(row.begin(), row.end()) != row.end()) return false;
    }
    return true;
}

TEST(StencilTable, indices_within_rows_are_unique) {
    for (const TestMesh& mesh : {make_cube(), make_triangle_torus(5, 4), make_prism(5), make_torus(3, 3)}) {
        const Refinement refinement = refine(mesh, 2);
        EXPECT_TRUE(indices_are_unique(*build_step_table<double>(refinement, 2)));
        EXPECT_TRUE(indices_are_unique(*build_stencil_table<double>(refinement, 2)));
        EXPECT_TRUE(indices_are_unique(*build_stencil_table<float>(refinement, 2)));
        EXPECT_TRUE(indices_are_unique(*build_limit_table<double>(refinement, 2)));
    }
}

TEST(StencilTable, alike_rows_list_alike_weights) {
    const Refinement refinement = refine(make_torus(8, 6), 2);
    const auto table = build_step_table<double>(refinement, 2);
    ASSERT_TRUE(table);
    std::set<std::vector<double>> patterns;
    for (uint32_t r = 0; r < table->row_count(); ++r)
        patterns.emplace(table->weights.begin() + table->offsets[r],
                         table->weights.begin() + table->offsets[r + 1]);
    EXPECT_EQ(patterns.size(), 3u);  // vertex, face and edge points of a regular mesh
}

using Vector = std::array<double, 3>;
double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct LimitFrames {
    std::vector<double> positions, tangents1, tangents2;

    Vector normal(size_t v) const {
        const double *a = tangents1.data() + 3 * v, *b = tangents2.data() + 3 * v;
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
};

LimitFrames limit_frames(const StencilTableDouble& table, const std::vector<double>& source) {
    LimitFrames frames;
    auto apply = [&](const Array<double>& weights, std::vector<double>& out) {
        StencilTableDouble one = table;
        one.weights = weights;
        out.resize(size_t{table.row_count()} * 3);
        apply_stencil_table<double>(one, source, out, 3);
    };
    apply(table.weights, frames.positions);
    apply(table.tangent1_weights, frames.tangents1);
    apply(table.tangent2_weights, frames.tangents2);
    return frames;
}

TEST(StencilTable, limit_steps_continue_a_chain) {
    for (const TestMesh& mesh : some_shapes(17)) {
        SCOPED_TRACE(mesh.name);
        const Result<ControlMesh> control = ControlMesh::create(mesh.description());
        ASSERT_TRUE(control);
        const Result<Refinement> refinement = build_refinement(*control, {2, true});
        ASSERT_TRUE(refinement);
        if (count_sharp_levels(refinement->levels[0]) > 2)
            continue;  // the contract asks for more levels there
        const auto whole = build_limit_table<double>(*refinement, 2, true);
        const auto step = build_limit_step_table<double>(*refinement, true);
        const auto points = build_stencil_table<double>(*refinement, 2);
        ASSERT_TRUE(whole && step && points);
        std::vector<double> level(size_t{points->row_count()} * 3);
        apply_stencil_table<double>(*points, mesh.positions_double(), level, 3);
        const LimitFrames one = limit_frames(*step, level),
                          other = limit_frames(*whole, mesh.positions_double());
        for (size_t i = 0; i < level.size(); ++i)
            ASSERT_NEAR(one.positions[i], other.positions[i], 1e-12 * mesh.size()) << i;
        // Tangents may turn with the start of a star, and an interior crease has a tangent plane on either
        // side: normals of smooth vertices are what both tables must agree on.
        const Topology& last = refinement->last();
        for (uint32_t v = 0; v < last.vertex_count; ++v) {
            if (last.vertex_rules[v] != VertexRule::smooth || last.corners_of_vertex(v).size() < 3) continue;
            const auto a = one.normal(v), b = other.normal(v);
            const double aa = dot(a, a), bb = dot(b, b), ab = dot(a, b);
            if (bb < 1e-12) continue;  // folded over: no tangent plane
            ASSERT_GT(aa, 0) << "vertex " << v;
            ASSERT_GT(ab, 0) << "vertex " << v;
            ASSERT_NEAR(ab * ab / (aa * bb), 1, 1e-9) << "vertex " << v;
        }
    }
}

TEST(StencilTable, limit_steps_refuse_what_they_cannot_do) {
    const TestMesh prism = make_prism(5);
    const Result<ControlMesh> control = ControlMesh::create(prism.description());
    const auto without_edges = build_limit_step_table<float>(*build_refinement(*control, {2, false}));
    ASSERT_FALSE(without_edges);
    EXPECT_EQ(without_edges.error().code, ErrorCode::unsupported);
    const auto pentagons = build_limit_step_table<float>(*build_refinement(*control, {0, true}));
    ASSERT_FALSE(pentagons);
    EXPECT_EQ(pentagons.error().code, ErrorCode::unsupported);
}

TEST(StencilTable, huge_valences_are_for_chains) {
    TestMesh pole;
    const uint32_t count = 20000;
    pole.add_vertex(0, 0, 1);
    for (uint32_t i = 0; i < count; ++i) pole.add_vertex(std::cos(i * 3e-4), std::sin(i * 3e-4), 0);
    for (uint32_t i = 0; i < count; ++i) pole.add_face({0, 1 + i, 1 + (i + 1) % count});
    const Refinement refinement = refine(pole, 2);
    const auto composed = build_stencil_table<float>(refinement, 2);
    ASSERT_FALSE(composed);
    EXPECT_EQ(composed.error().code, ErrorCode::unsupported);
    EXPECT_TRUE(build_step_table<float>(refinement, 1));
    EXPECT_TRUE(build_step_table<float>(refinement, 2));
}

TEST(StencilTable, level_zero_is_the_identity) {
    const Refinement refinement = refine(make_prism(5), 2);
    const auto table = build_stencil_table<double>(refinement, 0);
    ASSERT_TRUE(table);
    ASSERT_EQ(table->row_count(), table->source_count);
    ASSERT_EQ(table->indices.size(), table->row_count());
    for (uint32_t r = 0; r < table->row_count(); ++r) {
        EXPECT_EQ(table->indices[r], r);
        EXPECT_EQ(table->weights[r], 1.0);
    }
}

TEST(StencilTable, steps_compose_to_the_whole) {
    for (const TestMesh& mesh : some_shapes(9)) {
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 3);
        std::vector<double> points = mesh.positions_double();
        for (uint32_t level = 1; level <= 3; ++level) {
            const auto step = build_step_table<double>(refinement, level);
            const auto whole = build_stencil_table<double>(refinement, level);
            ASSERT_TRUE(step && whole);
            points = apply_table(*step, points);
            EXPECT_LT(largest_difference(points, apply_table(*whole, mesh.positions_double())),
                      1e-13 * mesh.size());
        }
    }
}

TEST(StencilTable, is_affine_invariant) {
    for (const TestMesh& mesh : some_shapes(13)) {
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 2);
        const auto table = build_limit_table<double>(refinement, 2);
        ASSERT_TRUE(table);
        auto transform = [](std::vector<double> points) {
            for (size_t i = 0; i < points.size(); i += 3) {
                const double x = points[i], y = points[i + 1], z = points[i + 2];
                points[i] = 0.3 * x - 1.7 * y + 0.2 * z + 5;
                points[i + 1] = 1.1 * x + 0.4 * y - 0.6 * z - 3;
                points[i + 2] = -0.5 * x + 0.9 * y + 1.3 * z + 1;
            }
            return points;
        };
        const std::vector<double> points = mesh.positions_double();
        EXPECT_LT(largest_difference(apply_table(*table, transform(points)),
                                     transform(apply_table(*table, points))),
                  1e-12);
    }
}

TEST(StencilTable, float_weights_are_double_weights_rounded) {
    for (const TestMesh& mesh : some_shapes(17)) {
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 2);
        const auto precise = build_stencil_table<double>(refinement, 2);
        const auto rounded = build_stencil_table<float>(refinement, 2);
        ASSERT_TRUE(precise && rounded);
        ASSERT_EQ(precise->indices.size(), rounded->indices.size());
        for (size_t k = 0; k < precise->indices.size(); ++k) {
            EXPECT_EQ(precise->indices[k], rounded->indices[k]);
            EXPECT_EQ(static_cast<float>(precise->weights[k]), rounded->weights[k]);
        }
    }
}

TEST(StencilTable, is_bit_identical_for_any_number_of_threads) {
    TestMesh creased = make_torus(12, 10);
    creased.add_crease_path({0, 10, 20, 30, 31, 32}, 2.3);
    for (const TestMesh& mesh : {creased, make_globe(64, 3), random_mesh(3), random_mesh(8)}) {
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 4);
        std::vector<StencilTable> tables, limits;
        for (size_t threads : {1u, 2u, 3u, 16u}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            auto table = build_stencil_table<float>(refinement, 4);
            auto limit_table = build_limit_table<float>(refinement, 4, true);
            ASSERT_TRUE(table && limit_table);
            tables.push_back(std::move(*table));
            limits.push_back(std::move(*limit_table));
        }
        for (size_t i = 1; i < tables.size(); ++i) {
            EXPECT_TRUE(identical(tables[0], tables[i]));
            EXPECT_TRUE(identical(limits[0], limits[i]));
        }
    }
}

TEST(StencilTable, does_not_depend_on_how_far_the_mesh_is_refined) {
    for (const TestMesh& mesh : some_shapes(15)) {
        SCOPED_TRACE(mesh.name);
        const Refinement base = refine(mesh, 0), deep = refine(mesh, 3);
        for (uint32_t level : {1u, 3u}) {
            const auto a = build_stencil_table<float>(base, level),
                       b = build_stencil_table<float>(deep, level);
            ASSERT_TRUE(a && b);
            EXPECT_TRUE(identical(*a, *b));
            const auto c = build_limit_table<float>(base, level, true),
                       d = build_limit_table<float>(deep, level, true);
            ASSERT_TRUE(c && d);
            EXPECT_TRUE(identical(*c, *d));
        }
    }
}

TEST(StencilTable, refuses_levels_past_the_largest) {
    const Refinement refinement = refine(make_cube(), 1);
    const auto table = build_stencil_table<float>(refinement, kMaxRefinementLevel + 1);
    const auto limits = build_limit_table<float>(refinement, kMaxRefinementLevel + 1);
    ASSERT_FALSE(table || limits);
    EXPECT_EQ(table.error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(limits.error().code, ErrorCode::invalid_argument);
}

// Limits do not wait for sharpness to decay: those of level 0 are the first rows of every later level.
TEST(StencilTable, limits_are_the_same_at_every_level) {
    for (const TestMesh& mesh : some_shapes(7)) {
        if (mesh.max_finite_sharpness() > 4) continue;
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 0);
        const std::vector<double> points = mesh.positions_double();
        const auto first = build_limit_table<double>(refinement, 0);
        ASSERT_TRUE(first);
        const std::vector<double> limits = apply_table(*first, points);
        for (uint32_t level : {1u, 3u}) {
            const auto table = build_limit_table<double>(refinement, level);
            ASSERT_TRUE(table);
            std::vector<double> later = apply_table(*table, points);
            later.resize(limits.size());
            EXPECT_LT(largest_difference(limits, later), 1e-12 * mesh.size()) << "level " << level;
        }
    }
}

TEST(StencilTable, boundary_points_depend_on_boundary_points_only) {
    for (Scheme scheme : {Scheme::catmull_clark, Scheme::loop, Scheme::bilinear}) {
        TestMesh mesh = scheme == Scheme::loop ? make_triangle_grid(5, 4) : make_grid(5, 4);
        mesh.options.scheme = scheme;
        const Refinement refinement = refine(mesh, 3);
        auto is_boundary = [](uint32_t v) { return v % 6 == 0 || v % 6 == 5 || v < 6 || v >= 24; };
        const auto table = build_limit_table<double>(refinement, 3);
        ASSERT_TRUE(table);
        const auto control = ControlMesh::create(mesh.description());
        const auto full = build_refinement(*control, {3, true});
        const Topology& last = full->last();
        std::vector<uint8_t> on_boundary(last.vertex_count, 0);
        for (uint32_t e = 0; e < last.edge_count; ++e) {
            if (last.corners_of_edge(e).size() != 1) continue;
            on_boundary[last.edge_vertices[2 * e]] = on_boundary[last.edge_vertices[2 * e + 1]] = 1;
        }
        uint32_t count = 0;
        for (uint32_t r = 0; r < table->row_count(); ++r) {
            if (!on_boundary[r]) continue;
            ++count;
            for (uint32_t k = table->offsets[r]; k < table->offsets[r + 1]; ++k) {
                EXPECT_TRUE(is_boundary(table->indices[k]) || table->weights[k] == 0);
            }
        }
        EXPECT_EQ(count, 18u * 8);
    }
}

TEST(StencilTable, infinite_creases_separate_the_sides) {
    TestMesh mesh = make_grid(4, 4);
    mesh.add_crease_path({10, 11, 12, 13, 14}, 10);
    const Refinement refinement = refine(mesh, 3);
    const auto table = build_stencil_table<double>(refinement, 3);
    ASSERT_TRUE(table);
    for (uint32_t r = 0; r < table->row_count(); ++r) {
        bool below = false, above = false;
        for (uint32_t k = table->offsets[r]; k < table->offsets[r + 1]; ++k) {
            if (table->weights[k] == 0) continue;
            below |= table->indices[k] < 10;
            above |= table->indices[k] > 14;
        }
        EXPECT_FALSE(below && above) << "row " << r;
    }
}

// Regular weights that can be written down.
TEST(StencilTable, regular_rows_are_those_of_splines) {
    TestMesh torus = make_torus(8, 8);
    const Refinement quads = refine(torus, 1);
    const auto table = build_stencil_table<double>(quads, 1);
    const auto limits = build_limit_table<double>(refine(torus, 0), 0);
    ASSERT_TRUE(table && limits);
    auto weight = [](const StencilTableDouble& t, uint32_t row, uint32_t column) {
        for (uint32_t k = t.offsets[row]; k < t.offsets[row + 1]; ++k) {
            if (t.indices[k] == column) return t.weights[k];
        }
        return 0.0;
    };
    const uint32_t v = 3 * 8 + 3;
    EXPECT_NEAR(weight(*table, v, v), 9.0 / 16, 1e-15);
    EXPECT_NEAR(weight(*table, v, v + 1), 3.0 / 32, 1e-15);
    EXPECT_NEAR(weight(*table, v, v + 9), 1.0 / 64, 1e-15);
    EXPECT_NEAR(weight(*limits, v, v), 4.0 / 9, 1e-15);
    EXPECT_NEAR(weight(*limits, v, v - 8), 1.0 / 9, 1e-15);
    EXPECT_NEAR(weight(*limits, v, v - 9), 1.0 / 36, 1e-15);
    TestMesh triangles = make_triangle_torus(8, 8);
    triangles.options.scheme = Scheme::loop;
    const auto loop = build_stencil_table<double>(refine(triangles, 1), 1);
    const auto loop_limits = build_limit_table<double>(refine(triangles, 0), 0);
    ASSERT_TRUE(loop && loop_limits);
    EXPECT_NEAR(weight(*loop, v, v), 5.0 / 8, 1e-15);
    EXPECT_NEAR(weight(*loop, v, v + 1), 1.0 / 16, 1e-15);
    EXPECT_NEAR(weight(*loop_limits, v, v), 1.0 / 2, 1e-15);
    EXPECT_NEAR(weight(*loop_limits, v, v + 1), 1.0 / 12, 1e-15);
}

TEST(StencilTable, unused_vertices_stay) {
    TestMesh mesh = make_grid(2, 2);
    const uint32_t bare = mesh.add_vertex(7, 8, 9);
    const auto limits = build_limit_table<double>(refine(mesh, 2), 2, true);
    ASSERT_TRUE(limits);
    const std::vector<double> points = apply_table(*limits, mesh.positions_double());
    EXPECT_EQ(points[3 * bare], 7.0);
    EXPECT_EQ(points[3 * bare + 2], 9.0);
}

TEST(StencilTable, base_faces_are_ancestors) {
    const Refinement refinement = refine(make_prism(5), 3);
    const Array<uint32_t> level0 = build_base_faces(refinement, 0), level1 = build_base_faces(refinement, 1),
                          level3 = build_base_faces(refinement, 3);
    ASSERT_EQ(level0.size(), 7u);
    for (uint32_t f = 0; f < 7; ++f) EXPECT_EQ(level0[f], f);
    ASSERT_EQ(level1.size(), 30u);
    EXPECT_EQ(level1[3], 0u);
    EXPECT_EQ(level1[4], 1u);
    EXPECT_EQ(level1[29], 6u);
    ASSERT_EQ(level3.size(), 480u);
    for (uint32_t f = 0; f < 480; ++f) EXPECT_EQ(level3[f], level1[f / 16]);
}

TEST(StencilTable, apply_takes_any_width) {
    const TestMesh mesh = make_cube();
    const auto table = build_stencil_table<double>(refine(mesh, 1), 1);
    ASSERT_TRUE(table);
    const std::vector<double> points = mesh.positions_double(), together = apply_table(*table, points);
    for (size_t axis = 0; axis < 3; ++axis) {
        std::vector<double> column;
        for (size_t v = 0; v < mesh.vertex_count; ++v) column.push_back(points[3 * v + axis]);
        const std::vector<double> alone = apply_table(*table, column, 1);
        for (size_t r = 0; r < alone.size(); ++r) EXPECT_EQ(alone[r], together[3 * r + axis]);
    }
}

// The checks above can fail.
TEST(StencilTable, comparisons_notice_one_wrong_weight) {
    const auto table = build_limit_table<double>(refine(make_cube(), 2), 2, true);
    ASSERT_TRUE(table);
    EXPECT_TRUE(well_formed(*table, 1e-13));
    EXPECT_TRUE(identical(*table, *table));
    auto fails = [&](auto&& perturb) {
        StencilTableDouble other = *table;
        perturb(other);
        EXPECT_FALSE(well_formed(other, 1e-13));
        EXPECT_FALSE(identical(*table, other));
    };
    fails([](StencilTableDouble& t) { t.weights[5] += 1e-12; });
    fails([](StencilTableDouble& t) { t.tangent1_weights[5] += 1e-10; });
    fails([](StencilTableDouble& t) { t.tangent2_weights[5] += 1e-10; });
    fails([](StencilTableDouble& t) { t.indices[0] = t.indices[1]; });
    fails([](StencilTableDouble& t) { t.indices[7] = t.source_count; });
    StencilTableDouble other = *table;
    other.weights[3] = std::nextafter(other.weights[3], 2.0);
    EXPECT_FALSE(identical(*table, other));
}

// Tables of many rows are made some thousand rows at a time. Here none is like the one before, the first half is nearly
// empty, so that less is known than usual of how many entries there will be, and indices repeat.
TEST(RowTable, HasTheRowsThatItIsMadeOf) {
    const uint32_t row_count = 300'000;
    const auto size_of = [&](uint32_t r) { return r < row_count / 2 ? (r % 1000 == 0 ? 70 : 0) : 1 + r % 11; };
    const auto table = build_table_of_rows<double>(row_count, row_count, {}, [&](uint32_t r, Row& row) {
        for (uint32_t k = 0; k < size_of(r); ++k) row.push_back({(r + k) % row_count, 1.0 + r});
        if (!row.empty()) row.push_back({r, 1});
    });
    ASSERT_TRUE(table);
    ASSERT_EQ(table->row_count(), row_count);
    uint32_t at = 0, wrong = 0;
    for (uint32_t r = 0; r < row_count; ++r) {
        wrong += table->offsets[r] != at;
        std::vector<std::pair<uint32_t, double>> row, expected;
        for (uint32_t k = table->offsets[r]; k < table->offsets[r + 1]; ++k)
            row.emplace_back(table->indices[k], table->weights[k]);
        for (uint32_t k = 0; k < size_of(r); ++k) expected.emplace_back((r + k) % row_count, k == 0 ? 2.0 + r : 1.0 + r);
        if (expected.size() > 64) std::sort(expected.begin(), expected.end());  // as merging does with long rows
        wrong += row != expected;
        at += size_of(r);
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(table->offsets[row_count], at);
    EXPECT_EQ(table->indices.size(), at);
    EXPECT_EQ(table->weights.size(), at);
}

}  // namespace
}  // namespace limn::test
