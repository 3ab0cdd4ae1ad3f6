// What every benchmark needs: options, timing, peak memory, and the table that is printed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "limn/result.h"

namespace limn::bench {

/// PROGRAM [--json OUT] [--quick] [--device N|cpu] [MODEL.obj ...]
struct Options {
    std::string program;
    std::vector<std::string> models;
    std::string json;           ///< empty: none
    bool quick = false;         ///< one repetition: checks that everything works, times nothing well
    uint32_t device_index = 0;  ///< as vk::ContextOptions::device_index
};

/// Prints the usage line and exits, with 2 when the arguments are wrong. `default_device`: without --device.
Options parse_options(int argc, char** argv, uint32_t default_device, uint32_t cpu_device);

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
Timing timing_of(std::vector<double> milliseconds);

double milliseconds_now();

struct Repetitions {
    uint32_t min = 5, max = 1000;
    double seconds = 0.5;  ///< goes on until so much time has been measured
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

/// Bytes per second that a plain copy reads and writes, on one core or on all.
double measure_host_copy(const Options& options, uint32_t thread_count);

/// One line of the table; what is not given is left blank.
struct Row {
    std::string name = {};  ///< refine/rook/level=4/composed
    std::optional<Timing> limn = {}, peer = {};
    std::optional<Timing> device = {};  ///< of limn, by the device's own clock
    double items = 0;      ///< rows of the table, say: rates are for limn, or for the peer without limn
    double entries = 0;    ///< nonzeros
    double bytes = 0;      ///< that must move at least
    double copy_rate = 0;  ///< bytes per second of a plain copy on the same device
    std::string note = {};
};

/// Prints rows as they come, and keeps them for --json.
class Report {
  public:
    /// `facts`: lines of the header beside host, compiler and commit. `items`: what Row::items counts.
    using Facts = std::vector<std::pair<std::string, std::string>>;
    Report(const Options& options, std::string benchmark, Facts facts, std::string items = "rows");
    void add(const Row& row);
    void add_text(const std::string& line) const;
    /// Writes the JSON file when asked for. Errors: cannot_open.
    Result<void> finish() const;

  private:
    const Options& options_;
    std::string benchmark_;
    Facts facts_;
    std::string items_;
    std::vector<Row> rows_;
};

}  // namespace limn::bench
