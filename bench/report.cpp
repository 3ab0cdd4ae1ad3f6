// Rows, and the table that is printed of them.
#include "report.h"

#include <algorithm>
#include <cassert>
#include <cstdio>

namespace limn::bench {
namespace {

constexpr const char* kTableRow = "%-58s %-24s %-22s %14s %7s %6s %8s %-6s %s";

std::string milliseconds(double ms) {
    return format(ms < 1 ? "%.4f" : ms < 100 ? "%.2f" : "%.0f", ms);
}

std::string cell(const Timing& timing) {
    if (timing.count == 0) return "n/a";
    return milliseconds(timing.median) + " (" + milliseconds(timing.min) + ".." + milliseconds(timing.max) +
           ")";
}

std::string positive(const char* pattern, double value) {
    return value > 0 ? format(pattern, value) : "";
}

std::string line_of(const Row& row, uint64_t cache_bytes) {
    const double rate = row.measured() ? 1000 / row.timing.median : 0;
    const std::string items = positive("%.2f M", row.items * rate / 1e6);
    char text[512];
    std::snprintf(text, sizeof text, kTableRow, row_name(row).c_str(), cell(row.timing).c_str(),
                  row.device ? cell(*row.device).c_str() : "", items.c_str(),
                  positive("%.2f", row.bytes * rate / 1e9).c_str(), positive("%.2f", copy_share(row)).c_str(),
                  positive("%.2f", row.flops * rate / 1e9).c_str(), to_text(cache_class(row, cache_bytes)),
                  row.note.c_str());
    std::string line = text;
    line.erase(line.find_last_not_of(' ') + 1);
    return line;
}

void print(const Options& options, const std::string& line) {
    show_progress(options, "");
    std::puts(line.c_str());
    std::fflush(stdout);
}

}  // namespace

std::string group_name(const Row& row) {
    std::string name = row.scenario + "/" + row.model;
    for (const auto& [key, value] : row.parameters) name += "/" + key + "=" + format("%.10g", value);
    return row.task.empty() ? name : name + "/" + row.task;
}

std::string row_name(const Row& row) {
    return group_name(row) + "/" + row.evaluator;
}

double copy_share(const Row& row) {
    if (!row.measured() || !(row.copy_rate > 0)) return 0;
    return row.bytes / row.timing.median * 1000 / row.copy_rate;
}

CacheClass cache_class(const Row& row, uint64_t cache_bytes) {
    if (cache_bytes == 0 || !(row.bytes > 0)) return CacheClass::unknown;
    return row.bytes <= static_cast<double>(cache_bytes) ? CacheClass::below : CacheClass::above;
}

const char* to_text(CacheClass cache) {
    return cache == CacheClass::below ? "below" : cache == CacheClass::above ? "above" : "";
}

const char* to_text(Side side) {
    return side == Side::limn ? "limn" : "peer";
}

Report::Report(const Options& options, ReportData header) : options_(options), data_(std::move(header)) {
    for (const auto& [name, text] : data_.facts) print(options_, format("%-9s ", name.c_str()) + text);
    print(options_, std::string("Medians (min..max) of ") +
                        (data_.quick ? "one run: not for comparison." : "several runs."));
    print(options_,
          "GB/s: tables, points and results once each. copy: that, as a share of what a plain copy moves on "
          "the same device.\nGflop/s: multiply-adds, counted as two. cache: those bytes against the last "
          "level of the cache.");
}

void Report::add(Row row) {
    assert(std::none_of(data_.rows.begin(), data_.rows.end(),
                        [&](const Row& other) { return row_name(other) == row_name(row); }));
    if (row.scenario != scenario_) {
        scenario_ = row.scenario;
        char text[512];
        std::snprintf(text, sizeof text, kTableRow, "\ncase", " ms", " device ms", (row.unit + "/s").c_str(),
                      "GB/s", "copy", "Gflop/s", "cache", "");
        print(options_, text);
    }
    print(options_, line_of(row, data_.cache_bytes));
    data_.rows.push_back(std::move(row));
}

void Report::add_finding(const std::string& line) {
    print(options_, line);
    data_.findings.push_back(line);
}

}  // namespace limn::bench
