// Ranges of numbers that are given out, come back, and are given out again. Not part of the public interface.
#pragma once

#include <map>

#include "limn/topology.h"

namespace limn {

class SlotRanges {
  public:
    SlotRanges() = default;
    /// Numbers [0, capacity), all of them free. No range crosses a multiple of `boundary` (0: there are
    /// none).
    explicit SlotRanges(uint32_t capacity, uint32_t boundary = 0) : boundary_(boundary) {
        if (capacity != 0) free_[0] = capacity;
    }
    /// The first of `count` numbers, from the smallest hole that they fit into; kInvalidIndex where there is
    /// none. Of no numbers it is 0.
    uint32_t take(uint32_t count);
    void give_back(uint32_t first, uint32_t count);

  private:
    /// The first number from `first` on that a range may begin with.
    uint64_t begin_of(uint64_t first, uint32_t count) const {
        if (boundary_ == 0 || first / boundary_ == (first + count - 1) / boundary_) return first;
        return (first / boundary_ + 1) * boundary_;
    }

    std::map<uint32_t, uint32_t> free_;  ///< holes: the first number of each, and how many there are
    uint32_t boundary_ = 0;
};

}  // namespace limn
