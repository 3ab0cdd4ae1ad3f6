// limn bench as scripts see it.
#include <nlohmann/json.hpp>
#include <regex>

#include "program_fixture.h"

namespace limn {
namespace {

using Json = nlohmann::json;

class BenchProgram : public Program {
  protected:
    Json read_json(const std::string& name) const { return Json::parse(read(name), nullptr, false); }
    /// A file with one row that took so long.
    void write_report(const std::string& name, double ms) const {
        const Json row = {
            {"scenario", "latency"}, {"model", "cube"},     {"parameters", {{"faces", 6}, {"rate", 7}}},
            {"evaluator", "limn"},   {"side", "limn"},      {"median_ms", ms},
            {"min_ms", ms * 0.99},   {"max_ms", ms * 1.01}, {"count", 5},
            {"items", 384},          {"unit", "samples"}};
        const Json other = {{"scenario", "edit"},  {"model", name},  {"parameters", {{"faces", 6}}},
                            {"evaluator", "limn"}, {"side", "limn"}, {"median_ms", 1},
                            {"min_ms", 1},         {"max_ms", 1},    {"count", 5},
                            {"items", 1},          {"unit", "faces"}};
        write(name, Json{{"format", "limn bench"},
                         {"version", 1},
                         {"quick", false},
                         {"facts", {{"host", name}}},
                         {"rows", {row, other}}}
                        .dump());
    }
};

TEST_F(BenchProgram, refuses_what_it_does_not_know) {
    expect_failure("bench --nonsense", 2, "--nonsense");
    expect_failure("bench --only latency,nothing", 2, "there is no scenario 'nothing'");
    expect_failure("bench --device x", 2, "a device is a number");
    expect_failure("bench --compare cube.obj", 2, "--compare");
    expect_failure("bench missing.obj --quick --json result.json", 1, "missing.obj");
    write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    expect_failure("bench bad.obj --only latency --html result.html", 1, "bad.obj:2");
    expect_failure("bench --device 99 --only latency --json result.json", 3, "99");
}

TEST_F(BenchProgram, lists_scenarios) {
    const Outcome outcome = run("bench --list");
    EXPECT_EQ(outcome.status, 0);
    for (const char* name : {"refine ", "patch_table ", "stencil_eval ", "grid_eval ", "patch_eval ",
                             "osd_interop ", "tessellate ", "latency ", "edit ", "scaling "})
        EXPECT_NE(outcome.output.find(name), std::string::npos) << name;
    EXPECT_EQ(outcome.errors, "");
}

TEST_F(BenchProgram, writes_rows_with_all_fields) {
    const Outcome outcome = run("bench cube.obj --quick --only grid_eval --json out.json");
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_EQ(outcome.errors, "");
    const Json json = read_json("out.json");
    ASSERT_TRUE(json.is_object());
    EXPECT_EQ(json["format"], "limn bench");
    EXPECT_EQ(json["version"], 1);
    EXPECT_EQ(json["quick"], true);
    for (const char* fact : {"device", "host", "cores", "cache", "compiler", "commit", "date"})
        EXPECT_TRUE(json["facts"].contains(fact)) << fact;
    EXPECT_GT(json["device_copy_bytes_per_second"], 0);
    std::vector<std::string> evaluators;
    for (const Json& row : json["rows"]) {
        SCOPED_TRACE(row.dump());
        EXPECT_EQ(row["scenario"], "grid_eval");
        EXPECT_EQ(row["model"], "cube");
        EXPECT_EQ(row["parameters"]["faces"], 6);
        EXPECT_TRUE(row["parameters"]["rate"].is_number());
        EXPECT_EQ(row["unit"], "samples");
        EXPECT_TRUE(row["side"] == "limn" || row["side"] == "peer");
        evaluators.push_back(row["evaluator"]);
        if (row["count"] == 0) {
            EXPECT_NE(row["note"], "");  // says why
            continue;
        }
        for (const char* number : {"median_ms", "min_ms", "max_ms", "items", "bytes", "flops", "copy_share"})
            EXPECT_GT(row[number], 0) << number;
        const bool has_class = row.contains("cache") && (row["cache"] == "below" || row["cache"] == "above");
        EXPECT_EQ(has_class, json["cache_bytes"] > 0);
    }
    for (const char* name : {"limn", "limn_separate", "loop", "osd_cpu", "osd_omp_xyzw"})
        EXPECT_NE(std::find(evaluators.begin(), evaluators.end(), name), evaluators.end()) << name;
}

TEST_F(BenchProgram, writes_a_page_that_needs_no_network) {
    const Outcome outcome = run("bench --quick --only latency --html page.html --json out.json");
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    const std::string page = read("page.html");
    EXPECT_NE(page.find("latency/cube/rate=7/normals/limn"), std::string::npos);
    EXPECT_NE(page.find("</html>"), std::string::npos);
    const bool has_charts = page.find("id=\"charts\"") != std::string::npos;
    EXPECT_EQ(has_charts, page.find("Charts by Chart.js") != std::string::npos);
    EXPECT_EQ(has_charts, outcome.errors.empty()) << outcome.errors;
    EXPECT_FALSE(std::regex_search(page, std::regex("<(link|iframe|img|script)[^>]*(src|href)")));
    for (const char* reference : {"src=\"http", "href=\"http", "src='http", "@import", "url(http"})
        EXPECT_EQ(page.find(reference), std::string::npos) << reference;
    // What was just written compares with itself.
    const Outcome same = run("bench --compare out.json out.json");
    EXPECT_EQ(same.status, 0);
    EXPECT_EQ(same.output.find("beyond noise"), std::string::npos) << same.output;
}

// Darts, an n-gon, channels, creases that outlast OpenSubdiv's isolation level: its surface is far from the limit
// there, and still what it should be.
TEST_F(BenchProgram, runs_a_model_that_has_everything) {
    const Outcome outcome =
        run("bench " LIMN_DEMO_MODEL " --quick --only patch_table,patch_eval,osd_interop,edit --json out.json");
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_EQ(outcome.errors, "");
    const Json json = read_json("out.json");
    std::vector<std::string> evaluators;
    for (const Json& row : json["rows"])
        if (row["scenario"] == "osd_interop" || row["scenario"] == "patch_eval") evaluators.push_back(row["evaluator"]);
    for (const char* name : {"limn_trees", "limn_osd", "osd_cpu", "osd_omp_xyzw"})
        EXPECT_NE(std::find(evaluators.begin(), evaluators.end(), name), evaluators.end()) << name;
}

TEST_F(BenchProgram, finds_what_got_slower) {
    write_report("a.json", 1);
    write_report("b.json", 1.5);
    const Outcome slower = run("bench --compare a.json b.json");
    EXPECT_EQ(slower.status, 0);
    EXPECT_NE(slower.output.find("slower beyond noise: 1\n  latency/cube/rate=7/limn"), std::string::npos)
        << slower.output;
    EXPECT_NE(slower.output.find("1.50 x"), std::string::npos);
    EXPECT_NE(slower.output.find("only in the first: 1\n  edit/a.json/limn"), std::string::npos);
    EXPECT_NE(slower.output.find("only in the second: 1\n  edit/b.json/limn"), std::string::npos);
    EXPECT_NE(run("bench --compare b.json a.json").output.find("faster beyond noise: 1\n"),
              std::string::npos);
    write_report("b.json", 1.01);
    EXPECT_EQ(run("bench --compare a.json b.json").output.find("beyond noise"), std::string::npos);
    write("foreign.json", "{\"rows\": []}");
    expect_failure("bench --compare a.json foreign.json", 1, "foreign.json: ");
    expect_failure("bench --compare cube.obj a.json", 1, "cube.obj: ");
    expect_failure("bench --compare missing.json a.json", 1, "missing.json");
}

}  // namespace
}  // namespace limn
