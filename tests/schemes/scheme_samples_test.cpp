// Samples of schemes without patches: against limits of refined vertices, and against plans where there are any.
#include <gtest/gtest.h>

#include <cmath>

#include "limn/evaluate.h"
#include "limn/schemes/scheme_limit.h"
#include "limn/schemes/scheme_samples.h"
#include "schemes/scheme_meshes.h"

namespace limn::test {
namespace {

std::vector<double> apply_table(const StencilTableDouble& table, const std::vector<double>& points) {
    std::vector<double> out(size_t{3} * table.row_count());
    apply_stencil_table<double>(table, points, out, 3);
    return out;
}

TEST(SchemeSamples, AreLimitsOfRefinedVertices) {
    for (const SubdivisionScheme& scheme : subdivision_schemes()) {
        if (!has_coordinates(scheme)) continue;
        SCOPED_TRACE(scheme.name);
        for (const bool open : {false, true}) {
            const RefinedMesh mesh = make_irregular_mesh(scheme, open, 11);
            const ControlMesh control = control_mesh_of(mesh);
            const auto refined = build_scheme_refinement<double>(control, scheme, {2, true});
            ASSERT_TRUE(refined);
            const auto limits = build_scheme_limit_table(*refined, false);
            ASSERT_TRUE(limits);
            std::vector<double> points = mesh.points;
            for (const auto& table : refined->tables) points = apply_table(table, points);
            points = apply_table(*limits, points);
            // The corners of the first level-2 faces are samples of ptex faces: child by child, as faces are numbered.
            const bool triangles = scheme.faces == FaceKind::triangles;
            std::vector<PatchSample> samples;
            std::vector<uint32_t> vertices;
            const Topology& t = refined->mesh();
            const uint32_t polygons = !triangles && mesh.face_sizes[0] != 4 ? 1 : 0;
            if (polygons == 0) {  // level-2 face 0 lies at corner 0 of face 0
                    samples = {{0, 0, 0}, {0, 0.25, 0}, {0, triangles ? 0 : 0.25, 0.25}};
                vertices = {t.face_vertices[0], t.face_vertices[1], t.face_vertices[2]};
            } else {  // ptex face 0 is level-1 face 0
                samples = {{0, 0, 0}, {0, 0.5, 0}, {0, 0.5, 0.5}};
                vertices = {t.face_vertices[0], t.face_vertices[1], t.face_vertices[2]};
            }
            const auto table = build_scheme_sample_table<double>(control, scheme, samples);
            ASSERT_TRUE(table) << table.error().message;
            const std::vector<double> values = apply_table(table->table, mesh.points);
            for (size_t i = 0; i < samples.size(); ++i)
                for (size_t k = 0; k < 3; ++k)
                    EXPECT_NEAR(values[3 * i + k], points[3 * size_t{vertices[i]} + k], 1e-12) << i << (open ? " open" : " closed");
        }
    }
}

TEST(SchemeSamples, EqualPlansAtAnyDepth) {
    for (const char* name : {"catmark", "loop"}) {
        SCOPED_TRACE(name);
        const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
        SchemeOptions options;
        options.scheme = scheme.faces == FaceKind::triangles ? Scheme::loop : Scheme::catmull_clark;
        const RefinedMesh mesh = make_irregular_mesh(scheme, true, 12);
        const ControlMesh control = control_mesh_of(mesh, options);
        std::vector<PatchSample> samples;
        for (uint32_t face = 0; face < 10; ++face)
            for (const uint32_t depth : {0u, 1u, 2u, 5u, 9u, 20u}) {
                const double step = std::ldexp(1.0, -static_cast<int>(depth));
                samples.push_back({face, step, 0.25 * step});
                samples.push_back({face, 0.25 + step / 4, 0.5 - step / 4});
            }
        const auto table = build_scheme_sample_table<double>(control, scheme, samples);
        ASSERT_TRUE(table) << table.error().message;
        const auto patches = build_patch_table<double>(control, {});
        ASSERT_TRUE(patches);
        const std::vector<double> values = apply_table(table->table, mesh.points);
        std::vector<double> points(size_t{3} * patches->point_count()), expected(3 * samples.size());
        build_patch_points<double>(*patches, mesh.points, 3, points);
        std::vector<SampleStatus> statuses(samples.size());
        evaluate_patches<double>(*patches, samples, points, 3, Derivatives::none, expected, statuses);
        EXPECT_EQ(table->statuses, statuses);
        size_t compared = 0;
        for (size_t i = 0; i < samples.size(); ++i) {
            if (statuses[i] != SampleStatus::valid) continue;
            for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(values[3 * i + k], expected[3 * i + k], 1e-12) << i;
            ++compared;
        }
        EXPECT_GT(compared, 60u);
    }
}

TEST(SchemeSamples, RefusesWhatHasNoCoordinates) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme("sqrt3");
    const ControlMesh mesh = control_mesh_of(make_irregular_mesh(scheme, false, 1));
    const PatchSample sample = {0, 0.5, 0.25};
    const auto table = build_scheme_sample_table<double>(mesh, scheme, {&sample, 1});
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().code, ErrorCode::unsupported);
}

}  // namespace
}  // namespace limn::test
