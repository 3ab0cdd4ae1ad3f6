// Random meshes against OpenSubdiv. LIMN_RANDOM_COUNT sets how many (500), LIMN_RANDOM_SEED the first seed
// (1).
#include <gtest/gtest.h>

#include <cstdlib>

#include "conformance/refinement_checks.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

uint64_t from_environment(const char* name, uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

TEST(RandomConformance, equals_opensubdiv) {
    const uint64_t count = from_environment("LIMN_RANDOM_COUNT", 500);
    const uint64_t first = from_environment("LIMN_RANDOM_SEED", 1);
    const CheckLimits limits = {
        .max_level = 3, .max_vertices = 30000, .max_stencil_rows = 1500, .max_face_varying_level = 3};
    uint32_t failures = 0;
    for (uint64_t seed = first; seed < first + count; ++seed) {
        SCOPED_TRACE("LIMN_RANDOM_SEED=" + std::to_string(seed));
        const int before =
            testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
        check_against_oracle(random_mesh(seed), limits);
        const int after = testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
        if (after > before && ++failures == 20) break;  // enough to see what is wrong
    }
    print_worst_errors();
}

TEST(RandomMesh, depends_on_its_seed_only) {
    const TestMesh a = random_mesh(17), b = random_mesh(17), c = random_mesh(18);
    EXPECT_EQ(a.face_vertices, b.face_vertices);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.crease_sharpness, b.crease_sharpness);
    EXPECT_NE(a.positions, c.positions);
    // splitmix64 of seed 0, from its author's reference code.
    EXPECT_EQ(RandomNumbers(0).next(), 0xe220a8397b1dcdafu);
}

TEST(RandomMesh, covers_every_option) {
    uint32_t schemes[3] = {}, boundaries[3] = {}, creasings[2] = {}, interpolations[6] = {};
    uint32_t left_handed = 0, holes = 0, polygons = 0, creases = 0, corners = 0, largest = 0;
    for (uint64_t seed = 1; seed <= 500; ++seed) {
        const TestMesh mesh = random_mesh(seed);
        ++schemes[static_cast<size_t>(mesh.options.scheme)];
        ++boundaries[static_cast<size_t>(mesh.options.boundary)];
        ++creasings[static_cast<size_t>(mesh.options.creasing)];
        for (const TestChannel& channel : mesh.channels)
            ++interpolations[static_cast<size_t>(channel.interpolation)];
        left_handed += mesh.left_handed;
        holes += !mesh.holes.empty();
        creases += !mesh.creases.empty();
        corners += !mesh.corners.empty();
        for (uint32_t size : mesh.face_sizes) polygons += size > 4;
        largest = std::max(largest, mesh.face_count());
    }
    for (uint32_t n : schemes) EXPECT_GT(n, 20u);
    for (uint32_t n : boundaries) EXPECT_GT(n, 100u);
    for (uint32_t n : creasings) EXPECT_GT(n, 100u);
    for (uint32_t n : interpolations) EXPECT_GT(n, 30u);
    for (uint32_t n : {left_handed, holes, polygons, creases, corners}) EXPECT_GT(n, 30u);
    EXPECT_LE(largest, 250u);
}

}  // namespace
}  // namespace limn::test
