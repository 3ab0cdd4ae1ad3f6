// What a report says of the machine and the build.
#pragma once

#include <cstdint>
#include <string>

namespace limn::bench {

/// Of the last level of the cache of the first core; 0 where the system does not tell.
uint64_t last_level_cache_bytes();
/// "32K" is 32768; 0 where that is no size.
uint64_t parse_cache_size(const std::string& text);

std::string processor_name();
std::string compiler_name();
/// $LIMN_COMMIT, which ./run sets, or "unknown".
std::string commit_name();
/// Today, UTC: "2025-03-01 12:30 UTC".
std::string date_text();

}  // namespace limn::bench
