// What the benchmark report is made of: timings, noise, groups, files. Nothing here is timed.
#include <gtest/gtest.h>

#include "compare.h"
#include "host.h"
#include "report_html.h"
#include "report_json.h"
#include "scenarios.h"
#include "summary.h"

namespace limn::bench {
namespace {

Timing timing(double median, double min, double max, uint32_t count = 5) {
    return {median, min, max, count};
}

Row row(const std::string& evaluator, Side side, double median) {
    Row r{
        .scenario = "grid_eval", .model = "cube", .faces = 6, .parameters = {{"rate", 7}}, .task = "points"};
    r.evaluator = evaluator;
    r.side = side;
    r.timing = timing(median, median * 0.99, median * 1.01);
    r.unit = "samples";
    r.items = 384;
    return r;
}

TEST(Bench, timing_takes_the_middle_and_the_ends) {
    const Timing odd = timing_of({3, 1, 2});
    EXPECT_EQ(odd.median, 2);
    EXPECT_EQ(odd.min, 1);
    EXPECT_EQ(odd.max, 3);
    EXPECT_EQ(odd.count, 3u);
    EXPECT_EQ(timing_of({4, 1, 2, 10}).median, 3);
    EXPECT_EQ(timing_of({}).count, 0u);
}

TEST(Bench, measure_warms_up_repeats_and_stops_at_failures) {
    uint32_t steps = 0, resets = 0;
    const Repetitions repetitions{4, 4, 0};
    const Timing done = measure(
        {}, [&] { return ++steps, true; }, [&] { ++resets; }, repetitions);
    EXPECT_EQ(done.count, 4u);
    EXPECT_EQ(steps, 5u);
    EXPECT_EQ(resets, 5u);
    EXPECT_EQ(measure(
                  {}, [&] { return ++steps < 8; }, {}, repetitions)
                  .count,
              0u);
    EXPECT_EQ(steps, 8u);
    const Options quick{.quick = true};
    EXPECT_EQ(measure(
                  quick, [] { return true; }, {}, repetitions)
                  .count,
              1u);
}

TEST(Bench, noise_is_overlap_or_less_than_five_percent) {
    const Timing base = timing(10, 9, 11);
    EXPECT_EQ(compare_timings(base, timing(12, 10.9, 13)), Change::none);  // intervals overlap
    EXPECT_EQ(compare_timings(base, timing(12, 11.1, 13)), Change::slower);
    EXPECT_EQ(compare_timings(base, timing(8, 7, 8.9)), Change::faster);
    EXPECT_EQ(compare_timings(timing(10, 10, 10), timing(10.4, 10.4, 10.4)), Change::none);
    EXPECT_EQ(compare_timings(timing(10, 10, 10), timing(10.6, 10.6, 10.6)), Change::slower);
    EXPECT_EQ(compare_timings(timing(10, 10, 10), timing(9.4, 9.4, 9.4)), Change::faster);
}

TEST(Bench, rows_are_matched_by_name) {
    const std::vector<Row> first = {row("limn", Side::limn, 1), row("osd_cpu", Side::peer, 5),
                                    row("gone", Side::peer, 1)};
    std::vector<Row> second = {row("new", Side::peer, 1), row("osd_cpu", Side::peer, 5.01),
                               row("limn", Side::limn, 2)};
    Row unmeasured = row("gone", Side::peer, 1);
    unmeasured.timing = {};
    second.push_back(unmeasured);
    const auto changes = compare_rows(first, second);
    ASSERT_EQ(changes.size(), 4u);
    EXPECT_EQ(changes[0].name, "grid_eval/cube/rate=7/points/limn");
    EXPECT_EQ(changes[0].change, Change::slower);
    EXPECT_EQ(changes[0].first_ms, 1);
    EXPECT_EQ(changes[0].second_ms, 2);
    EXPECT_EQ(changes[1].change, Change::none);
    EXPECT_EQ(changes[2].change, Change::only_first);
    EXPECT_EQ(changes[3].change, Change::only_second);
    EXPECT_EQ(changes[3].name, "grid_eval/cube/rate=7/points/new");
}

TEST(Bench, growth_is_time_per_face_against_the_best_of_smaller_sizes) {
    const SizeTiming linear[] = {
        {1000, timing(2, 1.9, 2.1)}, {10000, timing(20, 19, 21)}, {100000, timing(150, 140, 160)}};
    EXPECT_EQ(describe_growth(linear), "2000, 2000, 1500 ns a face: does not grow beyond noise");
    const SizeTiming growing[] = {
        {1000, timing(2, 1.9, 2.1)}, {10000, timing(10, 9.5, 10.5)}, {100000, timing(150, 140, 160)}};
    EXPECT_EQ(describe_growth(growing),
              "2000, 1000, 1500 ns a face: grows, 1.50 times as long at 100000 faces as at 10000");
}

TEST(Bench, groups_find_the_best_of_each_side) {
    std::vector<Row> rows = {row("limn", Side::limn, 4), row("limn_separate", Side::limn, 2),
                             row("osd_cpu", Side::peer, 9), row("osd_omp", Side::peer, 6),
                             row("loop", Side::peer, 3)};
    rows.push_back(row("osd_gl", Side::peer, 0.1));
    rows.back().timing = {};  // not measured
    rows.push_back(row("limn", Side::limn, 1));
    rows.back().task = "normals";
    const auto groups = group_rows(rows);
    ASSERT_EQ(groups.size(), 2u);
    EXPECT_EQ(groups[0].limn, &rows[1]);
    EXPECT_EQ(groups[0].osd, &rows[3]);
    EXPECT_EQ(groups[0].loop, &rows[4]);
    EXPECT_EQ(groups[0].peer, &rows[4]);
    EXPECT_EQ(Group::ratio(groups[0].limn, groups[0].osd), 3);
    EXPECT_EQ(groups[1].peer, nullptr);
    EXPECT_EQ(Group::ratio(groups[1].limn, groups[1].peer), 0);
}

TEST(Bench, the_short_table_keeps_cache_classes_apart) {
    ReportData data;
    data.cache_bytes = 1000;
    for (const double bytes : {900.0, 1000.0, 1001.0}) {
        Row limn = row("limn", Side::limn, 2), osd = row("osd_cpu", Side::peer, bytes == 900 ? 4 : 16);
        limn.bytes = osd.bytes = bytes;
        limn.copy_rate = 1e6;  // bytes / 2 ms are bytes * 500 per second
        limn.model = osd.model = std::to_string(bytes);
        data.rows.push_back(limn);
        data.rows.push_back(osd);
    }
    const auto lines = summarize(data);
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].cache, CacheClass::below);
    EXPECT_EQ(lines[0].group_count, 2u);
    EXPECT_NEAR(lines[0].osd.mean, 4, 1e-12);  // of 2 and 8
    EXPECT_EQ(lines[0].osd.min, 2);
    EXPECT_EQ(lines[0].osd.max, 8);
    EXPECT_NEAR(lines[0].copy_share, 0.475, 1e-12);
    EXPECT_EQ(lines[1].cache, CacheClass::above);
    EXPECT_EQ(lines[1].loop.mean, 0);
}

TEST(Bench, cache_sizes_are_parsed) {
    EXPECT_EQ(parse_cache_size("32768K"), uint64_t{32} << 20);
    EXPECT_EQ(parse_cache_size("8M"), uint64_t{8} << 20);
    EXPECT_EQ(parse_cache_size("512"), 512u);
    for (const char* bad : {"", "K", "-1K", "12X", "12KB"}) EXPECT_EQ(parse_cache_size(bad), 0u) << bad;
}

TEST(Bench, scenarios_are_selected_in_the_order_of_the_table) {
    const auto all = select_scenarios({});
    ASSERT_TRUE(all);
    EXPECT_EQ(all->size(), scenarios().size());
    const auto two = select_scenarios({"latency", "refine"});
    ASSERT_TRUE(two);
    ASSERT_EQ(two->size(), 2u);
    EXPECT_STREQ((*two)[0].name, "refine");
    EXPECT_FALSE(select_scenarios({"refine", "nothing"}));
}

TEST(Bench, json_reads_back) {
    ReportData data;
    data.facts = {{"device", "a \"device\" </script>"}, {"host", "b"}};
    data.cache_bytes = 1 << 20;
    data.device_copy_rate = 2e10;
    data.findings = {"nothing grows"};
    data.rows = {row("limn", Side::limn, 2), row("osd_gl", Side::peer, 0)};
    data.rows[0].bytes = 4096;
    data.rows[0].flops = 1e6;
    data.rows[0].copy_rate = 1e10;
    data.rows[0].device = timing(1.5, 1, 2);
    data.rows[1].timing = {};
    data.rows[1].note = "no GL";
    const std::string text = to_json(data);
    const auto read = parse_json(text, "a.json");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(to_json(*read), text);
    EXPECT_EQ(row_name(read->rows[0]), row_name(data.rows[0]));
    EXPECT_EQ(read->rows[0].faces, 6u);
    EXPECT_EQ(read->rows[0].timing.min, data.rows[0].timing.min);
    EXPECT_FALSE(read->rows[1].measured());
}

TEST(Bench, json_that_is_none_or_foreign_is_refused) {
    ReportData data;
    data.rows = {row("limn", Side::limn, 2)};
    const std::string good = to_json(data);
    ASSERT_TRUE(parse_json(good, "good"));
    const auto damaged = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        const size_t at = text.find(from);
        EXPECT_NE(at, text.npos) << from;
        return text.replace(at, from.size(), to);
    };
    for (const std::string& bad :
         {std::string(), std::string("garbage"), std::string("[]"), std::string("{}"),
          good.substr(0, good.size() / 2), damaged("limn bench", "other"),
          damaged("\"version\": 1", "\"version\": 2"), damaged("\"rows\"", "\"lines\""),
          damaged("\"median_ms\": 2", "\"median_ms\": \"2\""),
          damaged("\"median_ms\": 2", "\"median_ms\": -2"),
          damaged("\"side\": \"limn\"", "\"side\": \"other\""), damaged("\"evaluator\"", "\"evaluated\""),
          damaged("\"rate\": 7", "\"rate\": null")}) {
        const auto read = parse_json(bad, "bad\n.json");
        ASSERT_FALSE(read) << bad;
        EXPECT_EQ(read.error().message.rfind("bad?.json: ", 0), 0u) << read.error().message;
        EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
    }
}

TEST(Bench, pages_escape_what_they_show) {
    EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
    ReportData data;
    data.facts = {{"device", "<b>&</b></script>"}};
    data.rows = {row("limn", Side::limn, 2)};
    data.rows[0].note = "</script><img src=x>";
    data.findings = {"<i>"};
    const std::string page = to_html(data, "/* library */ '</script>'");
    EXPECT_NE(page.find("&lt;b&gt;&amp;&lt;/b&gt;"), std::string::npos);
    for (const char* raw : {"<b>", "<img", "<i>", "'</script>'"})
        EXPECT_EQ(page.find(raw), std::string::npos) << raw;
    EXPECT_NE(page.find("/* library */"), std::string::npos);
    const std::string bare = to_html(data, "");
    EXPECT_EQ(bare.find("<script"), std::string::npos);
    EXPECT_NE(bare.find("There are no charts"), std::string::npos);
    EXPECT_NE(bare.find("grid_eval/cube/rate=7/points/limn"), std::string::npos);
}

}  // namespace
}  // namespace limn::bench
