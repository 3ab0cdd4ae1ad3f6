// Loops over all cores. Not part of the public interface.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdint>

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

}  // namespace limn
