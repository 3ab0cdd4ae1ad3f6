// Which words of an array have changed. Not part of the public interface.
#pragma once

#include <algorithm>

#include "limn/batch.h"

namespace limn {

/// Words that lie closer than this are copied together.
inline constexpr uint32_t kChangeGap = 64;

struct WordChanges {
    std::vector<BatchRange> ranges;

    void mark(uint64_t first, uint64_t count) {
        if (count == 0) return;
        const auto begin = static_cast<uint32_t>(first);
        if (!ranges.empty() && ranges.back().first <= begin &&
            begin <= ranges.back().first + ranges.back().count) {
            const auto end = static_cast<uint32_t>(first + count);
            ranges.back().count = std::max(ranges.back().count, end - ranges.back().first);
        } else {
            ranges.push_back({begin, static_cast<uint32_t>(count)});
        }
    }
    /// In ascending order, those less than `gap` words apart as one.
    std::vector<BatchRange> merged(uint32_t gap) const {
        std::vector<BatchRange> sorted = ranges, out;
        std::sort(sorted.begin(), sorted.end(), [](BatchRange a, BatchRange b) { return a.first < b.first; });
        for (const BatchRange& range : sorted) {
            if (out.empty() || range.first - out.back().first >= out.back().count + gap)
                out.push_back(range);
            else
                out.back().count = std::max(out.back().count, range.first - out.back().first + range.count);
        }
        return out;
    }
};

}  // namespace limn
