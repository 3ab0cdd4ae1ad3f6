// Patch tables with Gregory end caps against OpenSubdiv's adaptive refinement to the same isolation level,
// place by place: the same patches, and its definition of derivatives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "conformance/patch_checks.h"
#include "conformance/refinement_checks.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

// Worst differences, for the log: by value, of size times 2^depth (4^depth) of the patch.
struct Worst {
    double values[6] = {};
    size_t places = 0, caps = 0;
};
Worst& worst_of_all() {
    static Worst worst;
    return worst;
}

std::vector<double> evaluate_with_caps(const TestMesh& mesh, EndCap end_cap, uint32_t level,
                                       std::span<const PatchSample> samples) {
    const auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control);
    const auto table = build_patch_table<double>(*control, {.end_cap = end_cap, .isolation_level = level});
    EXPECT_TRUE(table);
    std::vector<double> points(size_t{3} * table->point_count()), values(size_t{18} * samples.size());
    std::vector<SampleStatus> statuses(samples.size());
    build_patch_points(*table, mesh.positions_double(), 3, points);
    evaluate_patches(*table, samples, points, 3, Derivatives::second, values, statuses);
    return values;
}

testing::AssertionResult same_places(std::span<const OsdPlace> theirs, std::span<const double> ours,
                                     double tolerance, double size) {
    for (size_t s = 0; s < theirs.size(); ++s) {
        if (!theirs[s].valid) continue;
        ++worst_of_all().places;
        worst_of_all().caps += !theirs[s].regular;
        for (size_t k = 0; k < 6; ++k) {
            const double unit = size * std::exp2(theirs[s].depth * (k == 0 ? 0.0 : k < 3 ? 1.0 : 2.0));
            const double sign = k > 2 && theirs[s].turned ? -1 : 1;
            for (size_t i = 0; i < 3; ++i) {
                const double difference =
                    std::abs(ours[18 * s + 3 * k + i] - sign * theirs[s].values[k][i]) / unit;
                if (!(difference <= tolerance))
                    return testing::AssertionFailure()
                           << "place " << s << ", value " << k << ", depth " << theirs[s].depth
                           << (theirs[s].regular ? ", regular" : ", end cap") << ": off by " << difference;
                worst_of_all().values[k] = std::max(worst_of_all().values[k], difference);
            }
        }
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult same_caps(TestMesh mesh, uint32_t level, double perturbation = 0) {
    mesh.options.opensubdiv_compatible = true;
    std::string error;
    const auto oracle = OsdPatchOracle::create(mesh, level, &error);
    if (oracle == nullptr) return testing::AssertionFailure() << error;
    const auto samples = scattered_places(oracle->ptex_face_count(), mesh.options.scheme == Scheme::loop, 5);
    const auto theirs = oracle->far_places(mesh.positions_double(), samples);
    std::vector<double> ours = evaluate_with_caps(mesh, EndCap::gregory_opensubdiv, level, samples);
    for (double& x : ours) x += perturbation;
    const double tolerance = has_inexact_fading(mesh) ? 1e-6 : 1e-9;
    return same_places(theirs, ours, tolerance, mesh.size());
}

TEST(EndCapConformance, tables_equal_opensubdiv_at_the_same_level) {
    for (const TestMesh& mesh : all_shapes()) {
        if (mesh.options.scheme == Scheme::bilinear) continue;
        for (uint32_t level = 1; level <= 3; ++level)
            EXPECT_TRUE(same_caps(mesh, level)) << mesh.name << ", level " << level;
    }
    const Worst& w = worst_of_all();
    std::printf(
        "%zu places, %zu in end caps; worst: P %.2g, du %.2g, dv %.2g, duu %.2g, duv %.2g, dvv %.2g\n",
        w.places, w.caps, w.values[0], w.values[1], w.values[2], w.values[3], w.values[4], w.values[5]);
}

// Without Chaikin creasing, for which gregory_conformance_test.cpp has the reason.
TEST(EndCapConformance, random_tables_equal_opensubdiv_at_the_same_level) {
    for (uint64_t seed = 1; seed <= 300; ++seed) {
        const TestMesh mesh = random_mesh(seed);
        if (mesh.options.scheme == Scheme::bilinear || mesh.options.creasing == CreasingMethod::chaikin)
            continue;
        EXPECT_TRUE(same_caps(mesh, 2)) << "seed " << seed;
    }
}

TEST(EndCapConformance, comparison_notices_one_perturbed_value) {
    EXPECT_TRUE(same_caps(make_cube(), 2));
    EXPECT_FALSE(same_caps(make_cube(), 2, 1e-6));
}

TEST(EndCapConformance, true_derivatives_differ_from_opensubdivs_in_caps_only) {
    const TestMesh mesh = make_cube();
    const std::vector<PatchSample> samples = {{0, 0.03, 0.04}, {0, 0.4, 0.4}};
    const auto ours = evaluate_with_caps(mesh, EndCap::gregory, 2, samples);
    const auto theirs = evaluate_with_caps(mesh, EndCap::gregory_opensubdiv, 2, samples);
    double apart[2] = {};
    for (size_t s = 0; s < 2; ++s)
        for (size_t i = 0; i < 9; ++i) {
            const double difference = std::abs(ours[18 * s + i] - theirs[18 * s + i]);
            if (i < 3) {
                EXPECT_LE(difference, 1e-15);
            }
            apart[s] = std::max(apart[s], difference);
        }
    EXPECT_GT(apart[0], 1e-5);
    EXPECT_EQ(apart[1], 0);
}

}  // namespace
}  // namespace limn::test
