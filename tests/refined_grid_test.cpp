// Refined grids against composed stencil tables, whose rows are compared with OpenSubdiv elsewhere.
#include "limn/refined_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "limn/stencil_table.h"
#include "shapes/shapes.h"

namespace limn {
namespace {

using Entries = std::map<uint32_t, double>;

/// Row of each point, by control point. Fails where a point has none, or two.
void find_rows(const RefinedGridTable& table, std::vector<Entries>& rows) {
    rows.assign(table.point_count(), {});
    std::vector<uint32_t> count(table.point_count());
    for (const GridSurface& surface : table.grid.surfaces) {
        const GridClass& c = table.grid.classes[surface.grid_class];
        const GridPlacement& placement = table.grid.placements[surface.placement];
        EXPECT_EQ(placement.count, c.sample_count);
        for (uint32_t s = 0; s < c.sample_count; ++s) {
            const uint32_t word = table.grid.placement_samples[placement.first + s];
            const uint32_t slot = table.grid.slots[surface.ptex_face + (word >> shared::kGridOffsetBits)];
            if (slot == kInvalidIndex) continue;
            const uint32_t v = slot + word % (1u << shared::kGridOffsetBits);
            ASSERT_LT(v, rows.size());
            ++count[v];
            for (uint32_t j = 0; j < c.ring_size; ++j) {
                const size_t group = c.first_weight + size_t{j / 4} * c.sample_count + s;
                rows[v][table.ring_points[surface.first_ring + j]] +=
                    static_cast<double>(table.grid.weights[4 * group + j % 4]);
            }
        }
    }
    for (size_t v = 0; v < count.size(); ++v) ASSERT_EQ(count[v], 1u) << "point " << v;
}

std::vector<Entries> rows_of(const StencilTableDouble& table) {
    std::vector<Entries> rows(table.row_count());
    for (uint32_t r = 0; r < table.row_count(); ++r)
        for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k) rows[r][table.indices[k]] += table.weights[k];
    return rows;
}

double largest_difference(const Entries& a, const Entries& b) {
    double largest = 0;
    for (const auto& [index, weight] : a) {
        const auto at = b.find(index);
        largest = std::max(largest, std::abs(weight - (at == b.end() ? 0 : at->second)));
    }
    return largest;
}

using test::TestMesh;

class RefinedGridShape : public testing::TestWithParam<TestMesh> {};
INSTANTIATE_TEST_SUITE_P(All, RefinedGridShape, testing::ValuesIn(test::all_shapes()),
                         [](const auto& info) { return info.param.name; });

TEST_P(RefinedGridShape, HasTheRowsOfStencilTables) {
    const auto mesh = ControlMesh::create(GetParam().description());
    ASSERT_TRUE(mesh);
    const auto base = build_refinement(*mesh, {.level = 0});
    for (const uint32_t level : {1u, 3u}) {
        const auto grid = build_refined_grid_table(*base, {.level = level});
        const auto stencils = build_stencil_table<double>(*base, level);
        ASSERT_EQ(grid.has_value(), stencils.has_value());
        if (!grid) continue;
        const std::vector<Entries> expected = rows_of(*stencils);
        std::vector<Entries> got;
        ASSERT_NO_FATAL_FAILURE(find_rows(*grid, got)) << "level " << level;
        ASSERT_EQ(got.size(), expected.size());
        for (size_t r = 0; r < got.size(); ++r) {
            ASSERT_LT(largest_difference(got[r], expected[r]), 1e-6) << "level " << level << ", row " << r;
            ASSERT_LT(largest_difference(expected[r], got[r]), 1e-6) << "level " << level << ", row " << r;
        }
    }
}

}  // namespace
}  // namespace limn
