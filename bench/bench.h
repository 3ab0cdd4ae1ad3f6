// What every benchmark needs: options, timing, peak memory, what counts as right.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "limn/result.h"

namespace limn::bench {

/// What is measured, and where.
struct Options {
    std::vector<std::string> models;  ///< paths; empty: generated ones
    bool quick = false;               ///< one repetition: checks that everything works, times nothing well
    uint32_t device_index = 0;        ///< as vk::ContextOptions::device_index
    /// Says what goes on, on a terminal; "" clears that before other lines. May be empty.
    std::function<void(const std::string&)> progress = {};
};

void show_progress(const Options& options, const std::string& what);

/// One line on standard error, then exit: 3 when there is no usable device, else 1.
[[noreturn]] void fail(const Options& options, const Error& error);

/// The value, or fail().
template <class T>
T value_or_fail(const Options& options, Result<T> result) {
    if (!result) fail(options, result.error());
    return std::move(*result);
}
inline void value_or_fail(const Options& options, const Result<void>& result) {
    if (!result) fail(options, result.error());
}

/// Milliseconds.
struct Timing {
    double median = 0, min = 0, max = 0;
    uint32_t count = 0;
};
/// Of an even number the median is the mean of the two in the middle; of none all is 0.
Timing timing_of(std::vector<double> milliseconds);

double milliseconds_now();

struct Repetitions {
    uint32_t min = 5, max = 1000;
    double seconds = 0.25;  ///< goes on until so much time has been measured
};

/// Runs `step` once to warm up, then repeats it. A step returns false where it failed; the timing then has
/// count 0. `reset`, where given, runs before each step and is not timed: it frees what the one before made.
Timing measure(const Options& options, const std::function<bool()>& step,
               const std::function<void()>& reset = {}, const Repetitions& repetitions = {});

/// Peak memory in bytes that `step` needs beyond what the process holds before it; 0 where /proc cannot tell.
uint64_t peak_memory(const std::function<void()>& step);

/// The largest |a - b|, infinite where lengths differ or a value is not finite.
double largest_difference(const std::vector<double>& a, const std::vector<double>& b);
double largest_difference(const std::vector<float>& a, const std::vector<double>& b);
/// How far points may be from the truth, for x y z triples of this size: in double, and in float.
struct Tolerance {
    double in_double, in_float;
    double size;  ///< the largest side of the bounding box
};
Tolerance tolerance_for(const std::vector<float>& positions);

/// "0.21 MB"
std::string megabytes(uint64_t bytes);

/// printf into a string of at most 255 characters.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

/// Bytes per second that a plain copy reads and writes, on one core or on all.
double measure_host_copy(const Options& options, uint32_t thread_count);

}  // namespace limn::bench
