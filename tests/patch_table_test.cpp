// Patch tables against the limits of uniformly refined vertices, which conformance tests compare with
// OpenSubdiv; and what tables must be, whatever the mesh.
#include "limn/patch_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "limn/evaluate.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr uint32_t kLevel = 2;

/// A corner of a refined face, as a place on the base face that it descends from.
struct Corner {
    uint32_t vertex;
    PatchSample sample;
};

/// Refined faces are visited in their order; coordinates go from those of a child to those of the base face.
struct Walk {
    const Topology& last;
    bool triangles;
    uint32_t next_face = 0;
    std::vector<Corner> corners;

    struct Frame {
        double u0, v0, size;  ///< size < 0: turned by 180 degrees
    };
    void visit(uint32_t ptex, Frame f, uint32_t levels) {
        if (levels == 0) {
            constexpr double us[2][4] = {{0, 1, 1, 0}, {0, 1, 0, 0}}, vs[2][4] = {{0, 0, 1, 1}, {0, 0, 1, 0}};
            const auto vertices = last.vertices_of_face(next_face);
            for (size_t k = 0; k < vertices.size(); ++k)
                corners.push_back(
                    {vertices[k],
                     {ptex, f.u0 + f.size * us[triangles][k], f.v0 + f.size * vs[triangles][k]}});
            ++next_face;
            return;
        }
        const double h = f.size / 2;
        visit(ptex, {f.u0, f.v0, h}, levels - 1);
        visit(ptex, {f.u0 + h, f.v0, h}, levels - 1);
        if (triangles) {
            visit(ptex, {f.u0, f.v0 + h, h}, levels - 1);
            visit(ptex, {f.u0 + h, f.v0 + h, -h}, levels - 1);
        } else {
            visit(ptex, {f.u0 + h, f.v0 + h, h}, levels - 1);
            visit(ptex, {f.u0, f.v0 + h, h}, levels - 1);
        }
    }
};

/// Every corner of every face over the base, and whether that face is part of the surface.
std::vector<Corner> refined_corners(const Refinement& refinement, std::vector<uint8_t>& present) {
    const Topology& base = refinement.levels[0];
    Walk walk{refinement.last(), base.options.scheme == Scheme::loop, 0, {}};
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t size = base.size_of_face(f);
        const bool whole = size == (walk.triangles ? 3u : 4u);
        for (uint32_t i = 0; i < (whole ? 1 : size); ++i)
            walk.visit(ptex++, {0, 0, 1}, refinement.level_count() - 1 - (whole ? 0 : 1));
        present.resize(walk.corners.size(), base.face_holes[f] == 0);
    }
    return walk.corners;
}

struct Evaluation {
    std::vector<double> values;
    std::vector<SampleStatus> statuses;
};
Evaluation evaluate(const PatchTableDouble& table, const std::vector<PatchSample>& samples,
                    const std::vector<double>& control, uint32_t width, Derivatives derivatives) {
    std::vector<double> points(size_t{table.point_count()} * width);
    build_patch_points(table, control, width, points);
    Evaluation out;
    out.values.resize(samples.size() * value_count(derivatives) * width);
    out.statuses.resize(samples.size());
    evaluate_patches(table, samples, points, width, derivatives, out.values, out.statuses);
    return out;
}

std::vector<PatchSample> samples_of(const std::vector<Corner>& corners) {
    std::vector<PatchSample> samples;
    for (const Corner& c : corners) samples.push_back(c.sample);
    return samples;
}

/// The largest distance between the surface and the limits of refined vertices, in sizes of the mesh.
double limit_error(TestMesh mesh, const PatchTableOptions& options) {
    mesh.options.opensubdiv_compatible = false;
    const auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control);
    const auto refinement = build_refinement(*control, {kLevel, false});
    EXPECT_TRUE(refinement);
    const auto limits = build_limit_table<double>(*refinement, kLevel);
    const auto table = build_patch_table<double>(*control, options);
    EXPECT_TRUE(limits && table);
    if (!limits || !table) return 1;
    std::vector<double> truth(size_t{limits->row_count()} * 3);
    apply_stencil_table<double>(*limits, mesh.positions_double(), truth, 3);
    std::vector<uint8_t> present;
    const std::vector<Corner> corners = refined_corners(*refinement, present);
    const Evaluation ours =
        evaluate(*table, samples_of(corners), mesh.positions_double(), 3, Derivatives::none);
    double worst = 0;
    for (size_t c = 0; c < corners.size(); ++c) {
        const SampleStatus expected = present[c] != 0 ? SampleStatus::valid : SampleStatus::hole;
        EXPECT_EQ(ours.statuses[c], expected);
        if (present[c] == 0) continue;
        for (size_t i = 0; i < 3; ++i) {
            const double difference =
                std::abs(ours.values[3 * c + i] - truth[corners[c].vertex * size_t{3} + i]);
            worst = std::isfinite(difference) ? std::max(worst, difference) : 1;
        }
    }
    return worst / mesh.size();
}

TEST(PatchTable, equals_the_limits_of_refined_vertices) {
    for (const TestMesh& mesh : all_shapes()) EXPECT_LE(limit_error(mesh, {}), 1e-12) << mesh.name;
}

TEST(PatchTable, equals_the_limits_of_refined_random_meshes) {
    for (uint64_t seed = 0; seed < 300; ++seed)
        EXPECT_LE(limit_error(random_mesh(seed), {}), 1e-12) << "seed " << seed;
}

}  // namespace
}  // namespace limn::test
