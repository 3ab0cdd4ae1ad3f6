// Ranges of numbers: never given out twice, never lost.
#include "limn/slot_ranges.h"

#include <gtest/gtest.h>

#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

TEST(SlotRanges, TakeFromTheSmallestHoleAndJoinNeighbours) {
    SlotRanges ranges(10);
    EXPECT_EQ(ranges.take(4), 0u);
    EXPECT_EQ(ranges.take(2), 4u);
    EXPECT_EQ(ranges.take(4), 6u);
    EXPECT_EQ(ranges.take(1), kInvalidIndex);
    EXPECT_EQ(ranges.take(0), 0u);
    ranges.give_back(0, 4);
    ranges.give_back(6, 4);
    ranges.give_back(4, 2);
    EXPECT_EQ(ranges.take(10), 0u);
}

TEST(SlotRanges, NoRangeCrossesABoundary) {
    SlotRanges ranges(20, 8);
    EXPECT_EQ(ranges.take(9), kInvalidIndex);
    EXPECT_EQ(ranges.take(5), 0u);
    EXPECT_EQ(ranges.take(5), 8u);
    EXPECT_EQ(ranges.take(3), 5u);  // what was left before the boundary
    EXPECT_EQ(ranges.take(4), 16u);
}

TEST(SlotRanges, WhatIsTakenIsNobodyElses) {
    for (const uint32_t boundary : {0u, 64u}) {
        RandomNumbers random(7 + boundary);
        SlotRanges ranges(1000, boundary);
        std::vector<int> owner(1000, -1);
        std::map<int, std::pair<uint32_t, uint32_t>> taken;
        for (int step = 0; step < 4000; ++step) {
            if (random.below(2) == 0 && !taken.empty()) {
                const auto at = std::next(taken.begin(), random.below(static_cast<uint32_t>(taken.size())));
                const auto [first, count] = at->second;
                for (uint32_t i = first; i < first + count; ++i) {
                    ASSERT_EQ(owner[i], at->first);
                    owner[i] = -1;
                }
                ranges.give_back(first, count);
                taken.erase(at);
                continue;
            }
            const uint32_t count = 1 + random.below(40), first = ranges.take(count);
            if (first == kInvalidIndex) continue;
            ASSERT_LE(first + count, 1000u);
            if (boundary != 0) {
                ASSERT_EQ(first / boundary, (first + count - 1) / boundary);
            }
            for (uint32_t i = first; i < first + count; ++i) {
                ASSERT_EQ(owner[i], -1);
                owner[i] = step;
            }
            taken[step] = {first, count};
        }
        for (const auto& [step, range] : taken) ranges.give_back(range.first, range.second);
        EXPECT_EQ(ranges.take(boundary != 0 ? 64 : 1000), 0u);
    }
}

}  // namespace
}  // namespace limn::test
