// One way to evaluate the surface at many places: what patch_eval_bench and grid_eval_bench verify, time and
// compare.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace limn::bench {

/// What a candidate makes of each sample.
enum class PatchTask : uint8_t {
    points,
    normals,      ///< and points; OpenSubdiv has du and dv in place of normals
    derivatives,  ///< du and dv, and points
};

/// x y z per sample, in the order of the samples. du and dv, or normals, which need not have length 1, or
/// neither.
struct PatchValues {
    std::vector<float> positions, du, dv, normals;
};

struct PatchCandidate {
    std::string name;
    bool is_limn = false;
    uint64_t sample_count = 0;
    uint32_t dispatch_count = 0;  ///< 0 where it runs on the host
    uint64_t bytes = 0;           ///< tables, places, points read and written and results, once each
    double flops = 0;             ///< multiply-adds, counted as two; 0: unknown
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
