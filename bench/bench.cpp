#include "bench.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>

namespace limn::bench {
namespace {

/// A number of bytes from a line of /proc/self/status, such as VmHWM.
uint64_t process_memory(const char* key) {
    std::FILE* file = std::fopen("/proc/self/status", "r");
    if (file == nullptr) return 0;
    uint64_t kilobytes = 0;
    char line[256];
    while (std::fgets(line, sizeof line, file) != nullptr)
        if (std::strncmp(line, key, std::strlen(key)) == 0)
            kilobytes = std::strtoull(line + std::strlen(key) + 1, nullptr, 10);
    std::fclose(file);
    return kilobytes * 1024;
}

/// False where the system does not let us.
bool reset_peak() {
    std::FILE* file = std::fopen("/proc/self/clear_refs", "w");
    if (file == nullptr) return false;
    const bool written = std::fputs("5", file) >= 0;
    return std::fclose(file) == 0 && written;
}

template <class T>
double difference(const std::vector<T>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return INFINITY;
    double largest = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double d = std::abs(static_cast<double>(a[i]) - b[i]);
        if (!std::isfinite(d)) return INFINITY;
        largest = std::max(largest, d);
    }
    return largest;
}

}  // namespace

void show_progress(const Options& options, const std::string& what) {
    if (options.progress) options.progress(what);
}

void fail(const Options& options, const Error& error) {
    show_progress(options, "");
    std::fflush(stdout);
    std::fprintf(stderr, "limn: %s\n", error.message.c_str());
    std::exit(error.code == ErrorCode::no_device ? 3 : 1);
}

std::string format(const char* pattern, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, pattern);
    std::vsnprintf(text, sizeof text, pattern, arguments);
    va_end(arguments);
    return text;
}

std::string megabytes(uint64_t bytes) {
    return format("%.2f MB", static_cast<double>(bytes) / 1e6);
}

Timing timing_of(std::vector<double> milliseconds) {
    Timing timing;
    if (milliseconds.empty()) return timing;
    std::sort(milliseconds.begin(), milliseconds.end());
    const size_t middle = milliseconds.size() / 2;
    timing.median = milliseconds.size() % 2 != 0 ? milliseconds[middle]
                                                 : (milliseconds[middle - 1] + milliseconds[middle]) / 2;
    timing.min = milliseconds.front();
    timing.max = milliseconds.back();
    timing.count = static_cast<uint32_t>(milliseconds.size());
    return timing;
}

double milliseconds_now() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double, std::milli>(now).count();
}

Timing measure(const Options& options, const std::function<bool()>& step, const std::function<void()>& reset,
               const Repetitions& repetitions) {
    if (reset) reset();
    if (!step()) return {};
    std::vector<double> times;
    double total = 0;
    const uint32_t least = options.quick ? 1 : repetitions.min, most = options.quick ? 1 : repetitions.max;
    while (times.size() < least || (times.size() < most && total < 1000 * repetitions.seconds)) {
        if (reset) reset();
        const double begin = milliseconds_now();
        if (!step()) return {};
        times.push_back(milliseconds_now() - begin);
        total += times.back();
    }
    return timing_of(std::move(times));
}

uint64_t peak_memory(const std::function<void()>& step) {
    malloc_trim(0);  // what earlier steps freed must not hide what this one takes
    if (!reset_peak()) return 0;
    const uint64_t before = process_memory("VmRSS");
    step();
    const uint64_t peak = process_memory("VmHWM");
    return peak > before ? peak - before : 0;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    return difference(a, b);
}
double largest_difference(const std::vector<float>& a, const std::vector<double>& b) {
    return difference(a, b);
}

Tolerance tolerance_for(const std::vector<float>& positions) {
    float size = 0, largest = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        float low = INFINITY, high = -INFINITY;
        for (size_t i = axis; i < positions.size(); i += 3) {
            low = std::min(low, positions[i]);
            high = std::max(high, positions[i]);
        }
        size = std::max(size, high - low);
        largest = std::max({largest, std::abs(low), std::abs(high)});
    }
    const float ulp = std::nextafter(largest, INFINITY) - largest;
    return {1e-12 * static_cast<double>(size),
            2e-6 * static_cast<double>(size) + 4 * static_cast<double>(ulp), static_cast<double>(size)};
}

double measure_host_copy(const Options& options, uint32_t thread_count) {
    const size_t bytes = size_t{256} << 20, share = bytes / thread_count;
    const auto from = std::make_unique<char[]>(bytes), to = std::make_unique<char[]>(bytes);
    std::memset(from.get(), 1, bytes);  // memory never written may not be there at all
    const Timing timing = measure(options, [&] {
        std::vector<std::thread> threads;
        for (uint32_t i = 1; i < thread_count; ++i)
            threads.emplace_back(
                [&, i] { std::memcpy(to.get() + i * share, from.get() + i * share, share); });
        std::memcpy(to.get(), from.get(), share);
        for (std::thread& thread : threads) thread.join();
        return to[0] == from[0];
    });
    return 2 * static_cast<double>(share * thread_count) / timing.median * 1000;
}

}  // namespace limn::bench
