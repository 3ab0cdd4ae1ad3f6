// The table that benchmarks print, and its JSON twin.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench.h"
#include "limn/file.h"

namespace limn::bench {
namespace {

std::string format(const char* pattern, double a) {
    char text[64];
    std::snprintf(text, sizeof text, pattern, a);
    return text;
}

std::string milliseconds(double ms) {
    return format(ms < 1 ? "%.3f" : ms < 100 ? "%.2f" : "%.0f", ms);
}

std::string cell(const std::optional<Timing>& timing) {
    if (!timing) return "";
    if (timing->count == 0) return "n/a";
    return milliseconds(timing->median) + " (" + milliseconds(timing->min) + ".." +
           milliseconds(timing->max) + ")";
}

bool has(const std::optional<Timing>& timing) {
    return timing && timing->count != 0 && timing->median > 0;
}

double seconds_of(const Row& row) {
    const auto& timing = row.limn ? row.limn : row.peer;
    return has(timing) ? timing->median / 1000 : 0;
}

double ratio_of(const Row& row) {
    return has(row.limn) && has(row.peer) ? row.peer->median / row.limn->median : 0;
}

std::string processor_name() {
    std::FILE* file = std::fopen("/proc/cpuinfo", "r");
    if (file == nullptr) return "unknown processor";
    std::string name = "unknown processor";
    char line[256];
    while (std::fgets(line, sizeof line, file) != nullptr) {
        if (std::strncmp(line, "model name", 10) != 0) continue;
        const char* colon = std::strchr(line, ':');
        if (colon != nullptr) name = colon + 2;
        while (!name.empty() && name.back() == '\n') name.pop_back();
        break;
    }
    std::fclose(file);
    return name;
}

std::string compiler_name() {
#if defined(__clang__)
    std::string name = "clang " __clang_version__;
#elif defined(__GNUC__)
    std::string name = "g++ " __VERSION__;
#else
    std::string name = "unknown compiler";
#endif
#if !defined(NDEBUG)
    name += ", with assertions: not for timing";
#endif
    return name;
}

nlohmann::json json_of(const std::optional<Timing>& timing) {
    if (!has(timing)) return nullptr;
    return {{"median_ms", timing->median},
            {"min_ms", timing->min},
            {"max_ms", timing->max},
            {"count", timing->count}};
}

nlohmann::json json_of(const Row& row, const std::string& items) {
    nlohmann::json json = {{"case", row.name}};
    if (row.limn) json["limn"] = json_of(row.limn);
    if (row.peer) json["peer"] = json_of(row.peer);
    if (row.device) json["limn_device"] = json_of(row.device);
    if (ratio_of(row) > 0) json["ratio"] = ratio_of(row);
    if (row.items > 0) json[items] = row.items;
    if (row.entries > 0) json["entries"] = row.entries;
    if (row.bytes > 0) json["bytes"] = row.bytes;
    if (row.copy_rate > 0) json["copy_bytes_per_second"] = row.copy_rate;
    if (!row.note.empty()) json["note"] = row.note;
    return json;
}

constexpr const char* kTableRow = "%-50s %-24s %-24s %6s %-20s %10s %9s %7s %5s  %s\n";

}  // namespace

Report::Report(const Options& options, std::string benchmark, Facts facts, std::string items)
    : options_(options),
      benchmark_(std::move(benchmark)),
      facts_(std::move(facts)),
      items_(std::move(items)) {
    const char* commit = std::getenv("LIMN_COMMIT");
    facts_.emplace_back(
        "host", processor_name() + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores");
    facts_.emplace_back("compiler", compiler_name());
    facts_.emplace_back("commit", commit != nullptr ? commit : "unknown");
    for (const auto& [name, text] : facts_) std::printf("%-9s %s\n", name.c_str(), text.c_str());
    std::printf(
        "Medians (min..max) of %s. ratio: peer / limn. GB/s: table, source and destination points once "
        "each.\n"
        "copy: that, as a share of what a plain copy moves on the same device.\n",
        options.quick ? "one run: not for comparison" : "at least 5 runs");
    std::printf(kTableRow, "case", "limn ms", "peer ms", "ratio", "limn device ms",
                ("M" + items_ + "/s").c_str(), "Mnnz/s", "GB/s", "copy", "");
}

void Report::add(const Row& row) {
    rows_.push_back(row);
    const double seconds = seconds_of(row), rate = seconds > 0 ? 1 / seconds : 0, ratio = ratio_of(row);
    const auto number = [](const char* pattern, double value) {
        return value > 0 ? format(pattern, value) : "";
    };
    std::string line(512, '\0');
    const int length = std::snprintf(
        line.data(), line.size(), kTableRow, row.name.c_str(), cell(row.limn).c_str(), cell(row.peer).c_str(),
        number("%.2f", ratio).c_str(), cell(row.device).c_str(),
        number("%.2f", row.items * rate / 1e6).c_str(), number("%.1f", row.entries * rate / 1e6).c_str(),
        number("%.2f", row.bytes * rate / 1e9).c_str(),
        row.copy_rate > 0 ? number("%.2f", row.bytes * rate / row.copy_rate).c_str() : "", row.note.c_str());
    line.resize(std::min(line.size(), static_cast<size_t>(std::max(length, 0))));
    line.erase(line.find_last_not_of(" \n") + 1);
    std::puts(line.c_str());
    std::fflush(stdout);
}

void Report::add_text(const std::string& line) const {
    std::puts(line.c_str());
    std::fflush(stdout);
}

Result<void> Report::finish() const {
    if (options_.json.empty()) return {};
    nlohmann::json json = {{"benchmark", benchmark_}, {"quick", options_.quick}};
    for (const auto& [name, text] : facts_) json[name] = text;
    json["rows"] = nlohmann::json::array();
    for (const Row& row : rows_) json["rows"].push_back(json_of(row, items_));
    auto writer = FileWriter::create(options_.json);
    if (!writer) return writer.error();
    const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    for (size_t at = 0; at < text.size(); at += FileWriter::kBufferBytes)
        writer->append(std::string_view(text).substr(at, FileWriter::kBufferBytes));
    return writer->commit();
}

}  // namespace limn::bench
