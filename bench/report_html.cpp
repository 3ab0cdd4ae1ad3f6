#include "report_html.h"

#include "limn/file.h"
#include "report_json.h"
#include "summary.h"

namespace limn::bench {
namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

std::string tag(const char* name, std::string_view text) {
    return std::string("<") + name + ">" + escape_html(text) + "</" + name + ">";
}

std::string table_row(const char* cell, const std::vector<std::string>& cells) {
    std::string row = "<tr>";
    for (const std::string& text : cells) row += tag(cell, text);
    return row + "</tr>\n";
}

std::string positive(const char* pattern, double value) {
    return value > 0 ? format(pattern, value) : "";
}

std::string milliseconds(const Timing& timing) {
    return timing.count == 0 ? "n/a" : format("%.4g (%.4g..%.4g)", timing.median, timing.min, timing.max);
}

std::string ratio_text(const SummaryLine::Ratios& ratios) {
    return ratios.mean > 0 ? format("%.2f (%.2f..%.2f)", ratios.mean, ratios.min, ratios.max) : "";
}

std::string facts_table(const ReportData& data) {
    std::string html = "<table class=\"facts\">\n";
    for (const auto& [name, text] : data.facts)
        html += "<tr>" + tag("th", name) + tag("td", text) + "</tr>\n";
    return html + "</table>\n";
}

std::string summary_table(const ReportData& data) {
    std::string html =
        "<table>\n" + table_row("th", {"scenario", "working set and cache", "tasks", "OpenSubdiv / limn",
                                       "loop / limn", "copy share, median"});
    for (const SummaryLine& line : summarize(data))
        html += table_row("td",
                          {line.scenario, line.cache == CacheClass::unknown ? "not counted" : to_text(line.cache),
                           std::to_string(line.group_count), ratio_text(line.osd), ratio_text(line.loop),
                           positive("%.2f", line.copy_share)});
    return html + "</table>\n";
}

std::string groups_table(const ReportData& data) {
    const auto best = [](const Row* row) {
        return row != nullptr ? format("%.4g ms, ", row->timing.median) + row->evaluator : "";
    };
    std::string html = "<table>\n" + table_row("th", {"task", "limn", "OpenSubdiv", "ratio", "plain loop",
                                                      "ratio", "cache"});
    for (const Group& group : group_rows(data.rows))
        html += table_row("td",
                          {group.name, best(group.limn), best(group.osd),
                           positive("%.2f", Group::ratio(group.limn, group.osd)), best(group.loop),
                           positive("%.2f", Group::ratio(group.limn, group.loop)),
                           group.limn != nullptr ? to_text(cache_class(*group.limn, data.cache_bytes)) : ""});
    return html + "</table>\n";
}

std::string rows_table(const ReportData& data) {
    std::string html = "<table>\n" + table_row("th", {"case", "ms (min..max)", "device ms", "M items/s",
                                                      "unit", "GB/s", "copy", "Gflop/s", "cache", "note"});
    for (const Row& row : data.rows) {
        const double rate = row.measured() ? 1000 / row.timing.median : 0;
        html += table_row(
            "td",
            {row_name(row), milliseconds(row.timing), row.device ? milliseconds(*row.device) : "",
             positive("%.2f", row.items * rate / 1e6), row.unit, positive("%.2f", row.bytes * rate / 1e9),
             positive("%.2f", copy_share(row)), positive("%.2f", row.flops * rate / 1e9),
             to_text(cache_class(row, data.cache_bytes)), row.note});
    }
    return html + "</table>\n";
}

/// The comment that Chart.js begins with holds its licence, and stays; "</script" would end the element too
/// early.
std::string charts(const ReportData& data, std::string_view chart_script) {
    if (chart_script.empty())
        return "<p>There are no charts: Chart.js was not found when this page was written (Debian: "
               "libjs-chart.js).</p>\n";
    std::string library(chart_script), json = to_json(data);
    replace_all(library, "</script", "<\\/script");
    replace_all(json, "<", "\\u003c");
    return "<div id=\"charts\"></div>\n<script type=\"application/json\" id=\"data\">" + json +
           "</script>\n<script>" + library + "</script>\n<script>" + kPageScript +
           "</script>\n<p class=\"small\">Charts by Chart.js, (c) Chart.js Contributors, released under the "
           "MIT "
           "licence.</p>\n";
}

}  // namespace

std::string escape_html(std::string_view text) {
    std::string escaped(text);
    replace_all(escaped, "&", "&amp;");
    replace_all(escaped, "<", "&lt;");
    replace_all(escaped, ">", "&gt;");
    replace_all(escaped, "\"", "&quot;");
    replace_all(escaped, "'", "&#39;");
    return escaped;
}

Result<std::string> read_chart_script() {
#if defined(LIMN_CHART_JS)
    const auto file = read_file(LIMN_CHART_JS);
    if (!file) return file.error();
    return std::string(file->text());
#else
    return Error{ErrorCode::cannot_open,
                 "Chart.js was not found when limn was built (Debian: libjs-chart.js)"};
#endif
}

std::string to_html(const ReportData& data, std::string_view chart_script) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>limn bench</title>\n<style>";
    html += std::string(kPageStyle) + "</style></head><body>\n<h1>limn bench</h1>\n" + facts_table(data);
    html += data.quick ? "<p><strong>A quick run: one repetition, not for comparison.</strong></p>\n"
                       : "<p>Medians of several runs, all sides in one run of the program.</p>\n";
    html +=
        "<h2>In short</h2>\n<p>How many times faster limn is than the best of OpenSubdiv (in schemes: of CGAL "
        "and OpenMesh), and than the best plain C++ loop: geometric mean (least..most). Tasks whose working set is below the size of the last level of "
        "the "
        "cache, and above it, are apart.</p>\n" +
        summary_table(data);
    html += "<h2>Charts</h2>\n" + charts(data, chart_script) + "<h2>Findings</h2>\n<ul>\n";
    for (const std::string& line : data.findings) html += tag("li", line) + "\n";
    html += "</ul>\n<h2>Best of each task</h2>\n<details open><summary>Tables</summary>\n" +
            groups_table(data) + "</details>\n";
    html += "<h2>All that was measured</h2>\n<details><summary>Tables</summary>\n" + rows_table(data) +
            "</details>\n";
    return html + "</body></html>\n";
}

}  // namespace limn::bench
