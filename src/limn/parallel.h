// Loops over all cores. Not part of the public interface.
//
// Loops that have a BuildPart leave out what is still to do once that is cancelled, and so does every such loop
// that comes after: none sees what another left unwritten. Other code looks first, with BuildPart::check().
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include "limn/build_control.h"

namespace limn {

/// body(i) for 0 <= i < count, in any order, on all cores.
template <class Body>
void for_each_index(uint32_t count, const Body& body, uint32_t grain = 1024) {
    if (count <= grain) {
        for (uint32_t i = 0; i < count; ++i) body(i);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, count, grain),
                      [&](const tbb::blocked_range<uint32_t>& r) {
                          for (uint32_t i = r.begin(); i != r.end(); ++i) body(i);
                      });
}

/// Steps of a part of a build, done on several threads.
class BuildSteps {
  public:
    BuildSteps(const BuildPart& part, uint64_t count) : part_(part), count_(count) {}
    bool is_cancelled() const { return part_.is_cancelled(); }
    void add(uint64_t count) {
        const uint64_t done = done_.fetch_add(count, std::memory_order_relaxed) + count;
        part_.advance(static_cast<float>(done) / static_cast<float>(count_));
    }

  private:
    const BuildPart part_;
    const uint64_t count_;
    std::atomic<uint64_t> done_ = 0;
};

/// body(begin, end) for blocks of up to `grain` indices below `count`, in any order, on all cores.
template <class Body>
void for_each_block(uint32_t count, const BuildPart& part, uint32_t grain, const Body& body) {
    BuildSteps steps(part, count);
    for_each_index(
        count / grain + (count % grain != 0),
        [&](uint32_t block) {
            if (steps.is_cancelled()) return;
            const uint32_t begin = block * grain, end = begin + std::min(grain, count - begin);
            body(begin, end);
            steps.add(end - begin);
        },
        1);
}

/// body(i) for 0 <= i < count, in any order, on all cores.
template <class Body>
void for_each_index(uint32_t count, const BuildPart& part, const Body& body, uint32_t grain = 1024) {
    for_each_block(count, part, grain, [&](uint32_t begin, uint32_t end) {
        for (uint32_t i = begin; i != end; ++i) body(i);
    });
}

/// body(i) for 0 <= i < count, in this order, on one core. Looks for a cancellation every `grain` of them.
template <class Body>
void for_each_in_order(uint32_t count, const BuildPart& part, const Body& body, uint32_t grain = 4096) {
    for (uint32_t i = 0; i < count && !part.is_cancelled();) {
        const uint32_t end = i + std::min(grain, count - i);
        for (; i < end; ++i) body(i);
        part.advance(static_cast<float>(end) / static_cast<float>(count));
    }
}

/// Sorts on all cores: blocks, then pairs of them merged. `less` orders any two items.
template <class T, class Less>
void sort_items(std::vector<T>& items, const BuildPart& part, const Less& less) {
    constexpr uint32_t kBlock = 8192, kLook = 4096;  // looks for a cancellation so often
    const auto count = static_cast<uint32_t>(items.size());
    const BuildPart still = part.part(0, 0);  // steps of a sort are no measure of anything
    for_each_block(count, still, kBlock, [&](uint32_t begin, uint32_t end) {
        std::sort(items.begin() + begin, items.begin() + end, less);
    });
    std::vector<T> merged;
    for (uint64_t width = kBlock; width < count && !part.is_cancelled(); width *= 2) {
        merged.resize(count);
        const auto merge = [&](uint32_t pair) {
            const uint64_t begin = 2 * width * pair, middle = std::min<uint64_t>(count, begin + width);
            const uint64_t end = std::min<uint64_t>(count, begin + 2 * width);
            for (uint64_t a = begin, b = middle, to = begin; to < end; ++to) {
                if (to % kLook == 0 && part.is_cancelled()) return;
                const bool first = a < middle && (b == end || !less(items[b], items[a]));
                merged[to] = first ? items[a++] : items[b++];
            }
        };
        for_each_index(static_cast<uint32_t>((count + 2 * width - 1) / (2 * width)), merge, 1);
        items.swap(merged);
    }
    part.advance(1);
}

}  // namespace limn
