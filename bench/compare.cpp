#include "compare.h"

#include <algorithm>
#include <cstdio>
#include <map>

namespace limn::bench {
namespace {

constexpr double kNoise = 0.05;

Timing per_face(const SizeTiming& size) {
    Timing scaled = size.timing;
    for (double* ms : {&scaled.median, &scaled.min, &scaled.max}) *ms *= 1e6 / size.faces;
    return scaled;
}

void print_changes(std::vector<RowChange> changes, Change which, const char* title) {
    std::erase_if(changes, [&](const RowChange& c) { return c.change != which; });
    if (changes.empty()) return;
    const auto factor = [](const RowChange& c) {
        return std::max(c.first_ms / c.second_ms, c.second_ms / c.first_ms);
    };
    const bool both = which == Change::faster || which == Change::slower;
    if (both)
        std::stable_sort(changes.begin(), changes.end(),
                         [&](const RowChange& a, const RowChange& b) { return factor(a) > factor(b); });
    std::printf("%s: %zu\n", title, changes.size());
    for (const RowChange& c : changes)
        if (both)
            std::printf("  %-64s %10.4f -> %10.4f ms  %.2f x\n", c.name.c_str(), c.first_ms, c.second_ms,
                        factor(c));
        else
            std::printf("  %s\n", c.name.c_str());
}

void print_differing_facts(const Facts& first, const Facts& second) {
    for (const auto& [name, text] : first)
        for (const auto& [other_name, other_text] : second)
            if (name == other_name && text != other_text)
                std::printf("%-9s %s -> %s\n", name.c_str(), text.c_str(), other_text.c_str());
}

}  // namespace

Change compare_timings(const Timing& first, const Timing& second) {
    if (first.min <= second.max && second.min <= first.max) return Change::none;
    const double ratio = second.median / first.median;
    if (ratio < 1 + kNoise && ratio > 1 - kNoise) return Change::none;
    return ratio < 1 ? Change::faster : Change::slower;
}

std::vector<RowChange> compare_rows(std::span<const Row> first, std::span<const Row> second) {
    std::map<std::string, const Row*> others;
    for (const Row& row : second)
        if (row.measured()) others.emplace(row_name(row), &row);
    std::vector<RowChange> changes;
    for (const Row& row : first) {
        if (!row.measured()) continue;
        const auto other = others.find(row_name(row));
        if (other == others.end()) {
            changes.push_back({row_name(row), Change::only_first, row.timing.median, 0});
            continue;
        }
        const Timing& timing = other->second->timing;
        changes.push_back(
            {other->first, compare_timings(row.timing, timing), row.timing.median, timing.median});
        others.erase(other);
    }
    for (const Row& row : second)
        if (const auto other = others.find(row_name(row)); other != others.end() && other->second == &row)
            changes.push_back({other->first, Change::only_second, 0, row.timing.median});
    return changes;
}

void print_comparison(const ReportData& first, const ReportData& second) {
    print_differing_facts(first.facts, second.facts);
    if (first.quick || second.quick)
        std::puts("A quick run times nothing well: only what is 5 % apart is noise here.");
    const std::vector<RowChange> changes = compare_rows(first.rows, second.rows);
    print_changes(changes, Change::slower, "slower beyond noise");
    print_changes(changes, Change::faster, "faster beyond noise");
    print_changes(changes, Change::only_first, "only in the first");
    print_changes(changes, Change::only_second, "only in the second");
    std::printf("within noise: %td\n", std::count_if(changes.begin(), changes.end(), [](const RowChange& c) {
                    return c.change == Change::none;
                }));
}

std::string describe_growth(std::span<const SizeTiming> sizes) {
    std::string values, growth;
    const SizeTiming* best = nullptr;
    for (const SizeTiming& size : sizes) {
        const Timing timing = per_face(size);
        values += (values.empty() ? "" : ", ") + format("%.4g", timing.median);
        if (best != nullptr && compare_timings(per_face(*best), timing) == Change::slower)
            growth += (growth.empty() ? "" : ", ") + format("%.2f times as long at %.0f faces as at %.0f",
                                                            timing.median / per_face(*best).median,
                                                            size.faces, best->faces);
        if (best == nullptr || timing.median < per_face(*best).median) best = &size;
    }
    return values + " ns a face: " + (growth.empty() ? "does not grow beyond noise" : "grows, " + growth);
}

}  // namespace limn::bench
