// Crowds on the device: merged tables against those that they were made of, to the bit where both are given
// the same points; and no more dispatches for more meshes.
#include "vulkan/crowd_fixture.h"

namespace limn::vk::test {
namespace {

class BatchOnDevice : public CrowdTest {
  protected:
    void expect_as_alone(const std::vector<TestMesh>& shapes);
    std::array<uint32_t, 3> count_dispatches(const Surfaces& s);
};

void BatchOnDevice::expect_as_alone(const std::vector<TestMesh>& shapes) {
    std::vector<Surfaces> all;
    for (const TestMesh& shape : shapes) all.push_back(surfaces_of(shape));
    const Crowd crowd = merge(all);
    const Drawn merged = draw(crowd.merged);
    EXPECT_EQ(merged.result.status, TessellationStatus::complete);
    size_t triangle = 0;
    for (size_t m = 0; m < all.size(); ++m) {
        SCOPED_TRACE(shapes[m].name);
        const Drawn alone = draw(all[m]);
        const uint32_t face = crowd.meshes[m].ptex_faces.first;
        const uint64_t sample = uint64_t{face} * alone.samples_per_face;
        expect_same_words(merged.grid_values, 3 * sample, alone.grid_values);
        expect_same_words(merged.grid_normals, 3 * sample, alone.grid_normals);
        expect_same_words(merged.samples, 9 * sample, alone.samples);
        expect_same_words(merged.statuses, sample, alone.statuses);
        expect_same_triangles(merged, triangle, alone, face);
        triangle += alone.triangle_faces.size();
    }
    EXPECT_EQ(merged.triangle_faces.size(), triangle);
}

// Some of every kind: holes, creases, larger faces, boundaries, what is no manifold; one of them twice.
TEST_F(BatchOnDevice, DrawsWhatEachMeshAloneDoes) {
    for (const std::vector<TestMesh>& alike : limn::test::shapes_by_options()) {
        constexpr size_t kMost = 7;
        std::vector<TestMesh> shapes;
        for (size_t i = 0; i < std::min(kMost, alike.size()); ++i)
            shapes.push_back(alike[i * alike.size() / std::min(kMost, alike.size())]);
        shapes.push_back(shapes[0]);
        expect_as_alone(shapes);
    }
}

TEST_F(BatchOnDevice, StorageBuffersAreAsTexelBuffers) {
    pretend_gpu();
    expect_as_alone(
        {limn::test::make_prism(5), limn::test::make_globe(5, 2), limn::test::make_quad_star(3, 2)});
}

// Level-1 points, which the device makes by other sums than for a mesh alone: rows are sorted into other
// runs.
TEST_F(BatchOnDevice, MakesPointsAsTheHostDoes) {
    std::vector<Surfaces> all;
    for (uint64_t seed = 0; seed < 12; ++seed)
        all.push_back(surfaces_of(limn::test::make_messy_torus(8, 8, seed)));
    const Surfaces merged = merge(all).merged;
    const DevicePatchTable patches = *upload_patch_table(device(), merged.patches);
    std::vector<float> initial = merged.points;
    std::fill(initial.begin() + static_cast<ptrdiff_t>(merged.control.size()), initial.end(), 7.0f);
    const Buffer points = filled(std::as_bytes(std::span(initial)));
    const auto refined =
        surfaces_->prepare_points({.patches = &patches, .points = {.buffer = points.handle}});
    ASSERT_TRUE(refined);
    run([&](VkCommandBuffer commands) { refined->record(commands); });
    const size_t first = size_t{3} * merged.patches.first_refined;
    const std::vector<float> made = *download<float>(device(), points, merged.points.size());
    EXPECT_TRUE(
        points_match({{merged.points.begin() + static_cast<ptrdiff_t>(first), merged.points.end()}, 3},
                     {made, first, 3}, tolerance_of(merged.control, 3)));
}

/// Of level-1 points, a grid, and local points of a tessellation.
std::array<uint32_t, 3> BatchOnDevice::count_dispatches(const Surfaces& s) {
    const DevicePatchTable patches = *upload_patch_table(device(), s.patches);
    const DeviceGridTable grid =
        *upload_grid_table(device(), *build_grid_table(s.patches, {.rate = kGridRate}));
    const DeviceTessellationTable table =
        *upload_tessellation_table(device(), s.topology, *build_patch_trees(s.patches, {.max_rate = 8}));
    return {static_cast<uint32_t>(patches.points.runs.size()), static_cast<uint32_t>(grid.batches.size()),
            static_cast<uint32_t>(table.vertices.local_points.batches.size())};
}

// Meshes of the same kinds share dispatches, as long as they fit one pass.
TEST_F(BatchOnDevice, MoreMeshesTakeNoMoreDispatches) {
    std::vector<Surfaces> all;
    const auto add = [&](uint32_t copies) {
        for (uint32_t i = 0; i < copies; ++i)
            for (uint64_t seed = 0; seed < 15; ++seed)
                all.push_back(surfaces_of(limn::test::make_messy_torus(8, 8, seed)));
        return count_dispatches(merge(all).merged);
    };
    const std::array<uint32_t, 3> few = add(4), many = add(4);
    EXPECT_EQ(many[1], few[1]);
    EXPECT_EQ(many[2], few[2]);
    EXPECT_LE(many[0], 2 * few[0]);  // rows that are many enough get runs that need no weights
    for (const uint32_t count : many) EXPECT_LT(count, 30u);
}

}  // namespace
}  // namespace limn::vk::test
