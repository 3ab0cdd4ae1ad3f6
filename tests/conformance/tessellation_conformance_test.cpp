// Vertices of tessellations against OpenSubdiv's limit surface at the same places: adaptive patches of Far at level 10.
// Within end caps, which are 2^-10 of a face large, both may differ by a share of that.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "conformance/osd_patch_oracle.h"
#include "conformance/patch_checks.h"
#include "limn/tessellate.h"
#include "shapes/tessellation_checks.h"

namespace limn::test {
namespace {

struct Compared {
    size_t regular = 0, capped = 0;
};

/// Empty where OpenSubdiv is no reference: it refuses the mesh, or departs from itself (patch_conformance_test.cpp).
void compare(const TestMesh& shape, TessellationSpacing spacing, uint32_t seed, Compared& compared) {
    if (shape.options.creasing == CreasingMethod::chaikin || shape.max_finite_sharpness() > 5) return;
    std::string error;
    const auto oracle = OsdPatchOracle::create(shape, 10, &error);
    if (oracle == nullptr) return;
    const auto mesh = ControlMesh::create(shape.description());
    ASSERT_TRUE(mesh);
    const auto patches = build_patch_table<float>(*mesh, {});
    const auto table = build_tessellation_table(*mesh, {});
    ASSERT_TRUE(patches && table);
    std::mt19937 random(seed);
    const auto t = tessellate(*table, random_rates(*mesh, *table, spacing, 5, random), spacing);
    ASSERT_TRUE(t);
    std::vector<double> points(size_t{patches->point_count()} * 3), positions(t->places.size() * 3),
        normals(positions.size());
    build_patch_points<float>(*patches, shape.positions_double(), 3, points);
    evaluate_tessellation(*patches, *t, points, positions, normals);
    const auto places = oracle->far_places(shape.positions_double(), t->places);
    const double size = shape.size();
    for (size_t i = 0; i < places.size(); ++i) {
        ASSERT_TRUE(places[i].valid) << shape.name << " vertex " << i;
        const auto& p = places[i].values[0];
        const double off = std::hypot(positions[3 * i] - p[0], positions[3 * i + 1] - p[1], positions[3 * i + 2] - p[2]);
        ASSERT_LE(off, 2e-6 * size + kCapTolerance * places[i].cap_size)
            << shape.name << " vertex " << i << " of face " << t->places[i].face << " at " << t->places[i].u << ' '
            << t->places[i].v;
        ++(places[i].regular ? compared.regular : compared.capped);
    }
}

TEST(TessellationConformance, VerticesLieOnTheSurfaceOfOpenSubdiv) {
    Compared compared;
    const std::vector<TestMesh> shapes = all_shapes();
    for (uint32_t i = 0; i < shapes.size(); i += 5)
        compare(shapes[i], static_cast<TessellationSpacing>(i / 5 % 3), i, compared);
    EXPECT_GT(compared.regular, 30000u);
    EXPECT_GT(compared.capped, 300u);
    std::printf("%zu vertices in regular patches, %zu in end caps\n", compared.regular, compared.capped);
}

}  // namespace
}  // namespace limn::test
