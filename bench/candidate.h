// One way to get the points of the last level: what stencil_eval_bench verifies, times and compares.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace limn::bench {

struct Candidate {
    std::string name;
    bool is_limn = false;
    uint64_t row_count = 0;       ///< points that a frame makes, of all levels it goes through
    uint64_t entry_count = 0;     ///< nonzeros
    uint32_t dispatch_count = 0;  ///< 0 where it runs on the host
    uint64_t bytes = 0;           ///< tables, points read and points written, once each
    double flops = 0;             ///< multiply-adds, counted as two
    double copy_rate = 0;         ///< bytes per second of a plain copy where it runs
    /// All passes, from the control points that lie where it wants them to the last level; waits for the end.
    std::function<bool()> frame;
    /// Milliseconds of the latest frame by the device's own clock, or empty.
    std::function<double()> device_milliseconds = {};
    /// x y z of the last level, after a frame.
    std::function<std::vector<float>()> points;
};

/// x y z of each point, then zeros.
inline std::vector<float> pad_points(const std::vector<float>& positions, uint32_t width) {
    std::vector<float> padded(positions.size() / 3 * width);
    for (size_t i = 0; i < positions.size(); ++i) padded[i / 3 * width + i % 3] = positions[i];
    return padded;
}
/// The reverse.
inline std::vector<float> unpad_points(const float* values, size_t count, uint32_t width) {
    std::vector<float> points(3 * count);
    for (size_t i = 0; i < points.size(); ++i) points[i] = values[i / 3 * width + i % 3];
    return points;
}

}  // namespace limn::bench
