// What counts as faster or slower, and how two reports differ.
#pragma once

#include <span>

#include "report.h"

namespace limn::bench {

enum class Change : uint8_t {
    none,    ///< noise: min..max overlap, or medians are less than 5 % apart
    faster,  ///< the second
    slower,
    only_first,
    only_second,
};

Change compare_timings(const Timing& first, const Timing& second);

struct RowChange {
    std::string name;  ///< row_name
    Change change;
    double first_ms = 0, second_ms = 0;  ///< medians; 0 where there is none
};
/// All rows that either side has measured, matched by name: in the order of the first, then what only the
/// second has.
std::vector<RowChange> compare_rows(std::span<const Row> first, std::span<const Row> second);

/// Prints what got faster, slower or went missing, and which facts of the headers differ.
void print_comparison(const ReportData& first, const ReportData& second);

/// One stage at one size.
struct SizeTiming {
    double faces;
    Timing timing;
};
/// Nanoseconds per face at each size, ascending, and where that grows beyond noise against the best of
/// smaller sizes.
std::string describe_growth(std::span<const SizeTiming> sizes);

}  // namespace limn::bench
