// Limits of any scheme against closed forms, limn's own tables and refinement itself.
#include "limn/schemes/scheme_limit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "limn/schemes/star_limit.h"
#include "schemes/scheme_meshes.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

using Points = std::vector<double>;

Points evaluate_rows(const StencilTableDouble& table, const Points& points, size_t channel = 0) {
    Points out(size_t{3} * table.row_count(), 0.0);
    const auto& weights = channel == 0 ? table.weights : channel == 1 ? table.tangent1_weights : table.tangent2_weights;
    for (uint32_t r = 0; r < table.row_count(); ++r)
        for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k)
            for (size_t i = 0; i < 3; ++i)
                out[3 * size_t{r} + i] += weights[k] * points[3 * size_t{table.indices[k]} + i];
    return out;
}

std::array<double, 3> unit_normal(const Points& t1, const Points& t2, size_t v) {
    const double *a = t1.data() + 3 * v, *b = t2.data() + 3 * v;
    std::array<double, 3> n = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (double& x : n) x /= length;
    return n;
}

class EveryLimit : public testing::TestWithParam<SubdivisionScheme> {
  protected:
    const SubdivisionScheme& scheme() const { return *find_subdivision_scheme(GetParam().name); }
};

/// The limit of a vertex as `limits` finds it from so many rings: a point and a normal of a surface without symmetry.
struct PointAndNormal {
    std::array<double, 3> point = {};
    std::array<double, 3> normal;
};
PointAndNormal limit_from_rings(const Stage& stage, StarStart start, const SubdivisionScheme& scheme, uint32_t rings,
                                StarLimits& limits) {
    StarWalk walk;
    walk.walk_manifold(stage.topology, start, rings);
    const auto mask = limits.make(make_patch(stage, start.element, scheme.period, rings, walk));
    EXPECT_TRUE(mask) << mask.error().message;
    PointAndNormal out;
    Points t1(3, 0.0), t2(3, 0.0);
    for (size_t i = 0; i < (*mask)->labels.size(); ++i)
        for (size_t k = 0; k < 3; ++k) {
            const double x = std::sin((12.9898 + 3.77 * static_cast<double>(k)) * walk.vertices[(*mask)->labels[i]]);
            out.point[k] += (*mask)->position[i] * x;
            t1[k] += (*mask)->tangent1[i] * x;
            t2[k] += (*mask)->tangent2[i] * x;
        }
    out.normal = unit_normal(t1, t2, 0);
    if (!(*mask)->smooth) out.normal = {};  // two edges of some face
    return out;
}

/// More rings make the same limits.
TEST_P(EveryLimit, RingsAreEnough) {
    const uint32_t rings = patch_rings(scheme());
    StarLimits near(scheme(), rings), far(scheme(), rings + 2);
    for (const bool open : {false, true})
        for (uint32_t level = 0; level < 2; ++level) {
            const auto refined = build_scheme_refinement<double>(
                control_mesh_of(make_irregular_mesh(scheme(), open, 9)), scheme(), {level, true});
            ASSERT_TRUE(refined) << refined.error().message;
            for (uint32_t v = 0; v < refined->mesh().vertex_count; v += 1 + refined->mesh().vertex_count / 20) {
                StarWalk walk;
                const StarStart start = canonical_start(refined->last, {false, v}, scheme().period, rings, walk);
                const auto a = limit_from_rings(refined->last, start, scheme(), rings, near);
                const auto b = limit_from_rings(refined->last, start, scheme(), rings + 2, far);
                for (size_t k = 0; k < 3; ++k) {
                    EXPECT_NEAR(a.point[k], b.point[k], 1e-12) << "vertex " << v;
                    EXPECT_NEAR(a.normal[k], b.normal[k], 1e-9) << "vertex " << v;
                }
            }
        }
}

TEST_P(EveryLimit, IsTheLimitOfTheNextLevel) {
    for (const bool open : {false, true})
        for (uint32_t level = 0; level < 2; ++level) {
            SCOPED_TRACE(std::string(open ? "open" : "closed") + ", level " + std::to_string(level));
            const auto refined = build_scheme_refinement<double>(
                control_mesh_of(make_irregular_mesh(scheme(), open, 10)), scheme(), {level, true});
            ASSERT_TRUE(refined) << refined.error().message;
            const auto table = build_scheme_limit_table(*refined, true);
            ASSERT_TRUE(table) << table.error().message;
            StarLimits limits(scheme(), patch_rings(scheme()));
            double worst = 0;
            for (uint32_t v = 0; v < refined->mesh().vertex_count; v += 1 + refined->mesh().vertex_count / 12) {
                const StageStep step = refine_stage(Stage(refined->last), scheme(), {false, v});
                if (step.element.index == kInvalidIndex) continue;
                StarWalk walk;
                canonical_start(step.child, step.element, scheme().period, patch_rings(scheme()), walk);
                const auto mask =
                    limits.make(make_patch(step.child, step.element, scheme().period, patch_rings(scheme()), walk));
                ASSERT_TRUE(mask) << mask.error().message;
                Points row(refined->mesh().vertex_count, 0.0);
                for (size_t i = 0; i < (*mask)->labels.size(); ++i)
                    for (const RowEntry& entry : step.rows[walk.vertices[(*mask)->labels[i]]])
                        row[entry.index] += (*mask)->position[i] * entry.weight;
                for (uint32_t k = table->offsets[v]; k < table->offsets[v + 1]; ++k)
                    row[table->indices[k]] -= table->weights[k];
                for (const double x : row) worst = std::max(worst, std::abs(x));
            }
            EXPECT_LT(worst, 1e-12);
        }
}

TEST_P(EveryLimit, RowsSumToOneAndTangentsToZero) {
    for (const bool open : {false, true}) {
        const auto refined = build_scheme_refinement<double>(control_mesh_of(make_irregular_mesh(scheme(), open, 11)),
                                                             scheme(), {1, true});
        ASSERT_TRUE(refined);
        const auto table = build_scheme_limit_table(*refined, true);
        ASSERT_TRUE(table) << table.error().message;
        ASSERT_EQ(table->row_count(), refined->mesh().vertex_count);
        for (uint32_t r = 0; r < table->row_count(); ++r) {
            double sum = 0, sum1 = 0, sum2 = 0, size1 = 0, size2 = 0;
            for (uint32_t k = table->offsets[r]; k < table->offsets[r + 1]; ++k) {
                sum += table->weights[k];
                sum1 += table->tangent1_weights[k];
                sum2 += table->tangent2_weights[k];
                size1 += std::abs(table->tangent1_weights[k]);
                size2 += std::abs(table->tangent2_weights[k]);
            }
            EXPECT_NEAR(sum, 1, 1e-12);
            EXPECT_NEAR(sum1, 0, 1e-12);
            EXPECT_NEAR(sum2, 0, 1e-12);
            EXPECT_GT(std::min(size1, size2), 0.5);
        }
    }
}

/// A few more steps bring points to their limits, and faces to the planes of the tangents.
TEST_P(EveryLimit, RefinementGoesThere) {
    for (const bool open : {false, true}) {
        SCOPED_TRACE(open ? "open" : "closed");
        const RefinedMesh mesh = make_irregular_mesh(scheme(), open, 12);
        const auto refined = build_scheme_refinement<double>(control_mesh_of(mesh), scheme(), {1, true});
        ASSERT_TRUE(refined);
        Points points = mesh.points;
        for (const auto& table : refined->tables) points = evaluate_rows(table, points);
        const auto table = build_scheme_limit_table(*refined, false);
        ASSERT_TRUE(table);
        const Points limit = evaluate_rows(*table, points);
        for (uint32_t v = 0; v < refined->mesh().vertex_count; v += 1 + refined->mesh().vertex_count / 10) {
            StarPatch patch = extract_patch(refined->last, {false, v}, scheme().period, patch_rings(scheme()));
            StarWalk walk;
            canonical_start(refined->last, {false, v}, scheme().period, patch_rings(scheme()), walk);
            Points at;
            for (const uint32_t w : walk.vertices)
                at.insert(at.end(), &points[3 * size_t{w}], &points[3 * size_t{w}] + 3);
            auto distance = [&] {
                double sum = 0;
                for (size_t k = 0; k < 3; ++k) sum = std::max(sum, std::abs(at[k] - limit[3 * size_t{v} + k]));
                return sum;
            };
            double before = distance();
            bool turns_into_nothing = false;
            for (uint32_t i = 0; i < 12; ++i) {
                PatchStep step = refine_patch(patch, scheme(), patch_rings(scheme()));
                turns_into_nothing = !step.exists;  // boundaries that shrink
                if (turns_into_nothing) break;
                Points next(3 * step.rows.size(), 0.0);
                for (size_t r = 0; r < step.rows.size(); ++r)
                    for (const RowEntry& entry : step.rows[r])
                        for (size_t k = 0; k < 3; ++k)
                            next[3 * r + k] += entry.weight * at[3 * size_t{entry.index} + k];
                at = std::move(next);
                patch = std::move(step.child);
                if (i == 3) before = distance();
            }
            if (!turns_into_nothing) {
                EXPECT_LT(distance(), std::max(1e-12, 0.2 * before)) << v;
            }
        }
    }
}

std::string name_of_scheme(const testing::TestParamInfo<SubdivisionScheme>& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Schemes, EveryLimit,
                         testing::ValuesIn(subdivision_schemes().begin(), subdivision_schemes().end()), name_of_scheme);

/// Closed, open and creased meshes whose limits limn has by closed forms.
std::vector<std::pair<std::string, ControlMesh>> meshes_with_limits(const SubdivisionScheme& scheme) {
    std::vector<std::pair<std::string, ControlMesh>> meshes;
    SchemeOptions options;
    options.scheme = scheme.faces == FaceKind::triangles ? Scheme::loop : Scheme::catmull_clark;
    for (const auto boundary : {BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner})
        for (const bool open : {false, true}) {
            options.boundary = boundary;
            const RefinedMesh mesh = make_irregular_mesh(scheme, open, 13);
            ControlMesh control = control_mesh_of(mesh, options);
            meshes.emplace_back(open ? "open" : "closed", control);
            // A dart, a crease and a corner, all of them sharp for ever.
            const uint32_t *a = &mesh.face_vertices[0], *b = &mesh.face_vertices[mesh.face_sizes[0]];
            control.crease_edges = {a[0], a[1]};
            control.crease_sharpness = {kInfiniteSharpness};
            meshes.emplace_back("a dart", control);
            control.crease_edges = {a[0], a[1], a[1], a[2], b[0], b[1]};
            control.crease_sharpness = {kInfiniteSharpness, kInfiniteSharpness, kInfiniteSharpness};
            control.corner_vertices = {b[2]};
            control.corner_sharpness = {kInfiniteSharpness};
            meshes.emplace_back("creases and a corner", control);
        }
    return meshes;
}

TEST(SchemeLimits, EqualClosedForms) {
    for (const char* name : {"catmark", "loop"}) {
        const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
        for (const auto& [kind, mesh] : meshes_with_limits(scheme)) {
            SCOPED_TRACE(std::string(name) + ", " + kind);
            const auto refined = build_scheme_refinement<double>(mesh, scheme, {1, true});
            const auto refinement = build_refinement(mesh, {.level = 1, .full_last_level = true});
            ASSERT_TRUE(refined && refinement);
            const auto own = build_scheme_limit_table(*refined, true);
            const auto closed = build_limit_step_table<double>(*refinement, true);
            ASSERT_TRUE(own && closed);
            Points points(size_t{3} * own->source_count);
            RandomNumbers random(14);
            for (double& x : points) x = random.uniform(-1, 1);
            const Points a = evaluate_rows(*own, points), b = evaluate_rows(*closed, points);
            const Points a1 = evaluate_rows(*own, points, 1), a2 = evaluate_rows(*own, points, 2);
            const Points b1 = evaluate_rows(*closed, points, 1), b2 = evaluate_rows(*closed, points, 2);
            double worst = 0, worst_normal = 0;
            for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
            for (uint32_t v = 0; v < own->row_count(); ++v) {
                // A corner without sharp edges has no plane: both take edges of one of its faces.
                const Topology& t = refinement->last();
                const auto edges = t.edges_of_vertex(v);
                const auto sharp = std::count_if(edges.begin(), edges.end(),
                                                 [&](uint32_t e) { return is_infinite(t.edge_sharpness[e]); });
                if (t.vertex_rules[v] == VertexRule::corner && sharp < 2) continue;
                const auto m = unit_normal(a1, a2, v), n = unit_normal(b1, b2, v);
                double off = 0;
                for (size_t k = 0; k < 3; ++k) off = std::max(off, std::abs(m[k] - n[k]));
                EXPECT_LT(off, 1e-10) << "normal of vertex " << v;
                worst_normal = std::max(worst_normal, off);
            }
            EXPECT_LT(worst, 1e-12);
            EXPECT_LT(worst_normal, 1e-10);
        }
    }
}

/// Sharpness that fades: limits from level 0 are those of build_limit_table, which follows it to its end.
TEST(SchemeLimits, FollowSharpnessToItsEnd) {
    for (const char* name : {"catmark", "loop"})
        for (const auto creasing : {CreasingMethod::uniform, CreasingMethod::chaikin}) {
            SCOPED_TRACE(std::string(name) + (creasing == CreasingMethod::chaikin ? ", chaikin" : ", uniform"));
            const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
            SchemeOptions options;
            options.scheme = scheme.faces == FaceKind::triangles ? Scheme::loop : Scheme::catmull_clark;
            options.creasing = creasing;
            TestMesh shape = make_grid(5, 4);
            if (scheme.faces == FaceKind::triangles) shape.triangulate();
            ControlMesh mesh =
                control_mesh_of({shape.positions_double(), shape.face_sizes, shape.face_vertices}, options);
            const uint32_t* a = mesh.face_vertices.data();
            mesh.crease_edges = {a[1], a[2], a[5], a[6], a[6], a[7], a[9], a[10]};
            if (scheme.faces == FaceKind::triangles)
                mesh.crease_edges = {a[0], a[1], a[6], a[7], a[7], a[8], a[13], a[14]};
            mesh.crease_sharpness = {2.5f, 0.7f, 3.2f, 1.4f};
            mesh.corner_vertices = {a[17]};
            mesh.corner_sharpness = {1.5f};
            const auto refined = build_scheme_refinement<double>(mesh, scheme, {0, true});
            const auto refinement = build_refinement(mesh, {});
            ASSERT_TRUE(refined && refinement);
            const auto own = build_scheme_limit_table(*refined, false);
            const auto exact = build_limit_table<double>(*refinement, 0);
            ASSERT_TRUE(own && exact);
            double worst = 0;
            for (uint32_t v = 0; v < own->row_count(); ++v) {
                Points row(mesh.vertex_count, 0.0);
                for (uint32_t k = own->offsets[v]; k < own->offsets[v + 1]; ++k)
                    row[own->indices[k]] += own->weights[k];
                for (uint32_t k = exact->offsets[v]; k < exact->offsets[v + 1]; ++k)
                    row[exact->indices[k]] -= exact->weights[k];
                for (const double x : row) worst = std::max(worst, std::abs(x));
            }
            EXPECT_LT(worst, 1e-12);
        }
}

}  // namespace
}  // namespace limn::test
