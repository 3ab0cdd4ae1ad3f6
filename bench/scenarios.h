// The table of what can be measured.
#pragma once

#include <span>

#include "session.h"

namespace limn::bench {

struct Scenario {
    const char* name;
    const char* summary;  ///< one line
    void (*run)(const Session& session);
};

/// In the order in which they run. A new one is a file bench/<name>_bench.cpp that defines
/// bench_<name>(const Session&), and a line in scenarios.cpp.
std::span<const Scenario> scenarios();

/// Those named, in the order of the table; all for an empty list. Errors: invalid_argument (no such name).
Result<std::vector<Scenario>> select_scenarios(const std::vector<std::string>& names);

}  // namespace limn::bench
