// Refined grids against composed stencil tables, at levels and on shapes that conformance/ does not compare with OpenSubdiv.
#include "limn/refined_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "limn/stencil_table.h"
#include "shapes/refined_grid_rows.h"
#include "shapes/shapes.h"

namespace limn {
namespace {

using Entries = std::map<uint32_t, double>;

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
        const std::vector<Entries> got = test::rows_of_refined_grid(*grid);
        ASSERT_FALSE(HasFailure()) << "level " << level;
        ASSERT_EQ(got.size(), expected.size());
        for (size_t r = 0; r < got.size(); ++r) {
            ASSERT_LT(largest_difference(got[r], expected[r]), 1e-6) << "level " << level << ", row " << r;
            ASSERT_LT(largest_difference(expected[r], got[r]), 1e-6) << "level " << level << ", row " << r;
        }
    }
}

}  // namespace
}  // namespace limn
