// A report as one page that opens without a network: tables, and charts by Chart.js.
#pragma once

#include "report.h"

namespace limn::bench {

/// `chart_script`: the text of Chart.js 3, or empty: then the page has tables only, and says so.
std::string to_html(const ReportData& data, std::string_view chart_script);

/// Chart.js as Debian installs it (libjs-chart.js), found when limn was built. Errors: as read_file.
Result<std::string> read_chart_script();

/// For text between tags and in attributes.
std::string escape_html(std::string_view text);

// The page's own style and script (report_page.cpp). The script draws what the element "data" holds, which is
// to_json().
extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace limn::bench
