// Reports as files.
//
// {"format": "limn bench", "version": 1, "quick": false,
//  "facts": {"device": "...", "host": "...", ...}, "cache_bytes": N, "device_copy_bytes_per_second": N,
//  "findings": ["..."],
//  "rows": [{"name", "scenario", "model", "parameters": {"faces": N, "level": N, ...}, "task", "evaluator",
//            "side": "limn"|"peer", "median_ms", "min_ms", "max_ms", "count",
//            "device_ms": {"median_ms", "min_ms", "max_ms", "count"}, "items", "unit", "bytes", "flops",
//            "copy_bytes_per_second", "copy_share", "cache": "below"|"above", "note"}]}
// What was not measured has count 0, no times, and a note that says why; what is not known is left out.
#pragma once

#include "report.h"

namespace limn::bench {

std::string to_json(const ReportData& data);

/// Errors: parse_error, one line, where the text is no such file; `name` stands for it.
Result<ReportData> parse_json(std::string_view text, const std::string& name);

/// Written beside it and renamed. Errors: as FileWriter.
Result<void> write_text(const std::string& path, std::string_view text);

}  // namespace limn::bench
