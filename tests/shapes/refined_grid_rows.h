// Rows of a refined grid, as a stencil table would have them.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "limn/refined_grid.h"

namespace limn::test {

/// Weights of each point by control point; zeros left out. Fails where a point has no row, or two.
inline std::vector<std::map<uint32_t, double>> rows_of_refined_grid(const RefinedGridTable& table) {
    std::vector<std::map<uint32_t, double>> rows(table.point_count());
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
            if (v >= rows.size()) {
                ADD_FAILURE() << "there is no point " << v;
                continue;
            }
            ++count[v];
            for (uint32_t j = 0; j < c.ring_size; ++j) {
                const size_t group = c.first_weight + size_t{j / 4} * c.sample_count + s;
                const float weight = table.grid.weights[4 * group + j % 4];
                if (weight != 0) rows[v][table.ring_points[surface.first_ring + j]] += static_cast<double>(weight);
            }
        }
    }
    for (size_t v = 0; v < count.size(); ++v) EXPECT_EQ(count[v], 1u) << "point " << v;
    return rows;
}

}  // namespace limn::test
