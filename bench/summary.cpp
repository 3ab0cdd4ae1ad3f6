#include "summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace limn::bench {
namespace {

void keep_faster(const Row*& best, const Row& row) {
    if (best == nullptr || row.timing.median < best->timing.median) best = &row;
}

SummaryLine::Ratios ratios_of(const std::vector<double>& values) {
    SummaryLine::Ratios ratios;
    double logs = 0;
    size_t count = 0;
    for (const double value : values) {
        if (!(value > 0)) continue;
        logs += std::log(value);
        ratios.min = count == 0 ? value : std::min(ratios.min, value);
        ratios.max = std::max(ratios.max, value);
        ++count;
    }
    if (count != 0) ratios.mean = std::exp(logs / static_cast<double>(count));
    return ratios;
}

SummaryLine summarize_groups(const std::vector<const Group*>& groups, CacheClass cache) {
    SummaryLine line{groups[0]->scenario, cache, groups.size(), {}, {}, {}, 0};
    std::vector<double> osd, loop, peer, shares;
    for (const Group* group : groups) {
        osd.push_back(Group::ratio(group->limn, group->osd));
        loop.push_back(Group::ratio(group->limn, group->loop));
        peer.push_back(Group::ratio(group->limn, group->peer));
        if (copy_share(*group->limn) > 0) shares.push_back(copy_share(*group->limn));
    }
    line.osd = ratios_of(osd);
    line.loop = ratios_of(loop);
    line.peer = ratios_of(peer);
    line.copy_share = timing_of(shares).median;
    return line;
}

std::string text_of(const SummaryLine::Ratios& ratios) {
    return ratios.mean > 0 ? format("%.2f (%.2f..%.2f)", ratios.mean, ratios.min, ratios.max) : "";
}

}  // namespace

double Group::ratio(const Row* limn, const Row* peer) {
    return limn != nullptr && peer != nullptr ? peer->timing.median / limn->timing.median : 0;
}

std::vector<Group> group_rows(const std::vector<Row>& rows) {
    std::vector<Group> groups;
    for (const Row& row : rows) {
        const std::string name = group_name(row);
        auto group =
            std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.name == name; });
        if (group == groups.end()) group = groups.insert(groups.end(), {name, row.scenario});
        if (!row.measured()) continue;
        if (row.side == Side::limn) {
            keep_faster(group->limn, row);
        } else {
            keep_faster(group->peer, row);
            keep_faster(row.evaluator.rfind("loop", 0) == 0 ? group->loop : group->osd, row);
        }
    }
    return groups;
}

std::vector<SummaryLine> summarize(const ReportData& data) {
    const std::vector<Group> groups = group_rows(data.rows);
    std::vector<std::string> names;
    for (const Group& group : groups)
        if (std::find(names.begin(), names.end(), group.scenario) == names.end())
            names.push_back(group.scenario);
    std::vector<SummaryLine> lines;
    for (const std::string& name : names)
        for (const CacheClass cache : {CacheClass::below, CacheClass::above, CacheClass::unknown}) {
            std::vector<const Group*> chosen;
            for (const Group& group : groups)
                if (group.scenario == name && group.limn != nullptr &&
                    cache_class(*group.limn, data.cache_bytes) == cache)
                    chosen.push_back(&group);
            if (!chosen.empty()) lines.push_back(summarize_groups(chosen, cache));
        }
    return lines;
}

void print_summary(const ReportData& data) {
    std::printf(
        "\nHow many times faster limn is than the best of OpenSubdiv (in schemes: of CGAL and OpenMesh) and than "
        "the best plain loop: geometric mean (least..most).\ncache: what a frame of limn's touches, against the last level of the cache");
    std::puts(data.cache_bytes != 0
                  ? format(", %.4g MiB.", static_cast<double>(data.cache_bytes) / (1 << 20)).c_str()
                  : ", whose size is unknown.");
    std::printf("%-14s %-6s %6s  %-22s %-22s %s\n", "scenario", "cache", "tasks", "OpenSubdiv / limn",
                "loop / limn", "copy share, median");
    for (const SummaryLine& line : summarize(data)) {
        const std::string share = line.copy_share > 0 ? format("%.2f", line.copy_share) : "";
        const char* cache = line.cache == CacheClass::unknown ? "-" : to_text(line.cache);
        std::printf("%-14s %-6s %6zu  %-22s %-22s %s\n", line.scenario.c_str(), cache, line.group_count,
                    text_of(line.osd).c_str(), text_of(line.loop).c_str(), share.c_str());
    }
}

}  // namespace limn::bench
