#include "limn/slot_ranges.h"

#include <cassert>

namespace limn {

uint32_t SlotRanges::take(uint32_t count) {
    if (count == 0) return 0;
    if (boundary_ != 0 && count > boundary_) return kInvalidIndex;
    auto best = free_.end();
    for (auto hole = free_.begin(); hole != free_.end(); ++hole) {
        const bool fits = begin_of(hole->first, count) + count <= uint64_t{hole->first} + hole->second;
        if (fits && (best == free_.end() || hole->second < best->second)) best = hole;
    }
    if (best == free_.end()) return kInvalidIndex;
    const auto [hole, size] = *best;
    const auto first = static_cast<uint32_t>(begin_of(hole, count));
    free_.erase(best);
    if (first != hole) free_[hole] = first - hole;
    if (first + count != hole + size) free_[first + count] = hole + size - (first + count);
    return first;
}

void SlotRanges::give_back(uint32_t first, uint32_t count) {
    if (count == 0) return;
    auto next = free_.lower_bound(first);
    assert(next == free_.end() || first + count <= next->first);
    if (next != free_.end() && next->first == first + count) {
        count += next->second;
        next = free_.erase(next);
    }
    if (next != free_.begin()) {
        const auto before = std::prev(next);
        assert(before->first + before->second <= first);
        if (before->first + before->second == first) {
            before->second += count;
            return;
        }
    }
    free_[first] = count;
}

}  // namespace limn
