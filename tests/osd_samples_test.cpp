// How benchmarks verify OpenSubdiv's tables: they are limn's with the same end caps, and a fault in either is noticed.
#include "osd_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "patch_samples.h"
#include "shapes/random_mesh.h"

namespace limn::bench {
namespace {

constexpr uint32_t kSampleCount = 500;

/// As many times as far apart as rounding allows.
double difference_of(const BenchModel& model, uint32_t level) {
    const auto table = build_patch_table<float>(model.mesh, {});
    EXPECT_TRUE(table);
    const auto samples = random_samples(*table, kSampleCount);
    if (samples.empty()) return 0;  // all faces are holes
    const auto places = find_osd_places(model.mesh, level, samples);
    if (places == nullptr) return INFINITY;
    return osd_difference(model, level, samples, evaluate_osd_places(*places, model.positions));
}

TEST(OsdSamples, tables_equal_limns_with_the_same_end_caps) {
    for (const BenchModel& model : {make_cube(), make_random_torus(24, 16, 1), make_smooth_torus("smooth", 200)})
        for (const uint32_t level : {3u, 6u}) EXPECT_LE(difference_of(model, level), 1) << model.name << " " << level;
}

TEST(OsdSamples, random_tables_equal_limns_with_the_same_end_caps) {
    uint32_t compared = 0;
    for (uint64_t seed = 1; seed <= 150; ++seed) {
        const test::TestMesh mesh = test::random_mesh(seed);
        auto control = ControlMesh::create(mesh.description());
        ASSERT_TRUE(control);
        const BenchModel model{mesh.name, std::move(*control), mesh.positions};
        if (!has_equal_patches(model.mesh)) continue;
        ++compared;
        EXPECT_LE(difference_of(model, 3), 1) << "seed " << seed;
    }
    EXPECT_GT(compared, 50u);
}

// Another sharpness, far from the limit as both surfaces may be; and one value.
TEST(OsdSamples, faults_are_noticed) {
    const BenchModel model = make_random_torus(24, 16, 1);
    BenchModel other = model;
    other.mesh.crease_sharpness[0] -= 0.01f;
    const auto samples = random_samples(*build_patch_table<float>(model.mesh, {}), 20000);
    auto values = evaluate_osd_places(*find_osd_places(other.mesh, 3, samples), model.positions);
    EXPECT_GT(osd_difference(model, 3, samples, values), 1);
    EXPECT_LE(osd_difference(other, 3, samples, values), 1);
    values[9 * 77 + 1] += 1e-4;
    EXPECT_GT(osd_difference(other, 3, samples, values), 1);
    values[9 * 77 + 1] = NAN;
    EXPECT_GT(osd_difference(other, 3, samples, values), 1);
    values.pop_back();
    EXPECT_GT(osd_difference(other, 3, samples, values), 1);
}

}  // namespace
}  // namespace limn::bench
