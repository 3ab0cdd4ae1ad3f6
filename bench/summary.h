// Who is best at each task, and the short table at the end.
#pragma once

#include "report.h"

namespace limn::bench {

/// Rows that do the same work. Pointers are null where that side was not measured.
struct Group {
    std::string name;  ///< group_name
    std::string scenario;
    const Row* limn = nullptr;  ///< the fastest
    const Row* peer = nullptr;  ///< the fastest of all peers
    const Row* osd = nullptr;   ///< of OpenSubdiv
    const Row* loop = nullptr;  ///< of plain loops

    /// How many times faster limn is; 0 where either was not measured.
    static double ratio(const Row* limn, const Row* peer);
};

/// In the order of the rows, which must outlive them.
std::vector<Group> group_rows(const std::vector<Row>& rows);

/// One line of the short table: groups of a scenario that limn's working set puts into one cache class.
struct SummaryLine {
    std::string scenario;
    CacheClass cache;
    size_t group_count = 0;
    /// Geometric mean, smallest and largest of ratios to the best of OpenSubdiv and of loops; 0 where there
    /// are none.
    struct Ratios {
        double mean = 0, min = 0, max = 0;
    } osd, loop, peer;
    double copy_share = 0;  ///< of limn's rows, the median
};
std::vector<SummaryLine> summarize(const ReportData& data);

void print_summary(const ReportData& data);

}  // namespace limn::bench
