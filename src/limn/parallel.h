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

}  // namespace limn
