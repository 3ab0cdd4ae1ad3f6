// One way to evaluate the surface at many places: what patch_eval_bench and grid_eval_bench verify, time and
// compare.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace limn::bench {

/// x y z per sample, in the order of the samples. Either du and dv or normals, which need not have length 1.
struct PatchValues {
    std::vector<float> positions, du, dv, normals;
};

struct PatchCandidate {
    std::string name;
    bool is_limn = false;
    uint64_t sample_count = 0;
    uint32_t dispatch_count = 0;  ///< 0 where it runs on the host
    uint64_t bytes = 0;           ///< tables, places, points read and written and results, once each
    double copy_rate = 0;         ///< bytes per second of a plain copy where it runs
    std::string note = {};        ///< for the table
    /// From the control points that lie where it wants them to the values of all samples; waits for the end.
    std::function<bool()> frame;
    /// Milliseconds of the latest frame by the device's own clock, or empty.
    std::function<double()> device_milliseconds = {};
    /// After a frame.
    std::function<PatchValues()> values;
};

}  // namespace limn::bench
