// limn bench: measures limn and its peers side by side, and compares what was measured.
#include "cli/program.h"
#include "compare.h"
#include "limn/file.h"
#include "report_html.h"
#include "report_json.h"
#include "scenarios.h"
#include "summary.h"

namespace limn::cli {
namespace {

struct BenchOptions {
    std::vector<std::string> models, compare;
    std::string only, json, html;
    DeviceOption device;
    bool quick = false, list = false;
};

/// "a,b" as a and b; none of "".
std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find(',', at), text.size());
        parts.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

int list_scenarios() {
    for (const bench::Scenario& scenario : bench::scenarios())
        std::printf("%-13s %s\n", scenario.name, scenario.summary);
    return 0;
}

Result<bench::ReportData> read_report(const std::string& path) {
    const auto file = read_file(path);
    if (!file) return file.error();
    return bench::parse_json(file->text(), path);
}

int compare(const std::vector<std::string>& paths) {
    const auto first = read_report(paths[0]);
    if (!first) return fail(first.error());
    const auto second = read_report(paths[1]);
    if (!second) return fail(second.error());
    bench::print_comparison(*first, *second);
    return 0;
}

Result<void> write_files(const BenchOptions& options, const bench::ReportData& data) {
    if (!options.json.empty())
        if (auto written = bench::write_text(options.json, bench::to_json(data)); !written) return written;
    if (options.html.empty()) return {};
    const auto script = bench::read_chart_script();
    if (!script)
        std::fprintf(stderr, "limn: %s has no charts: %s\n", printable(options.html).c_str(),
                     script.error().message.c_str());
    return bench::write_text(options.html, bench::to_html(data, script ? std::string_view(*script) : ""));
}

uint32_t device_index(const std::string& device) {
    return device == "auto"  ? vk::kAutomaticDevice
           : device == "cpu" ? vk::kCpuDevice
                             : static_cast<uint32_t>(std::stoul(device));
}

int run(const BenchOptions& options) {
    if (options.list) return list_scenarios();
    if (!options.compare.empty()) return compare(options.compare);
    const auto selected = bench::select_scenarios(split(options.only));
    if (!selected) return fail(selected.error());
    Progress progress;
    const bench::Options measured{
        options.models, options.quick, device_index(options.device.device),
        [&](const std::string& what) { what.empty() ? progress.clear() : progress.show(what); }};
    const std::vector<bench::BenchModel> models = bench::load_models(measured);
    bench::show_progress(measured, "measuring how fast copies are");
    const bench::Machines machines = bench::open_machines(measured);
    bench::Report report(measured, machines.header(options.quick));
    for (const bench::Scenario& scenario : *selected) {
        bench::show_progress(measured, scenario.name);
        scenario.run({measured, machines, models, report});
    }
    progress.clear();
    bench::print_summary(report.data());
    const auto written = write_files(options, report.data());
    return written ? 0 : fail(written.error());
}

/// Empty where all names are those of scenarios: CLI11's way to say so.
std::string check_scenarios(const std::string& names) {
    const auto selected = bench::select_scenarios(split(names));
    return selected ? "" : selected.error().message;
}

}  // namespace

void add_bench(CLI::App& program, int& status) {
    auto options = std::make_shared<BenchOptions>();
    CLI::App* command =
        program.add_subcommand("bench", "Measure limn beside OpenSubdiv and plain loops, in one run");
    command->add_option("MODEL", options->models, "OBJ files; without any, generated models");
    command->add_option("--json", options->json, "Write what was measured here");
    command->add_option("--html", options->html, "And as a page with charts");
    command
        ->add_option("--only", options->only, "Scenarios to run, NAME[,NAME...], see --list")

        ->check(check_scenarios);
    command->add_flag("--quick", options->quick, "Small models, one repetition: not for comparison");
    command
        ->add_option("--device", options->device.device,
                     "Vulkan device: a number from 'limn devices'; 'cpu' for the first that is a CPU; 'auto'")
        ->check(check_device)
        ->capture_default_str();
    command->add_flag("--list", options->list, "List the scenarios");
    command
        ->add_option("--compare", options->compare,
                     "Two files of --json: what got faster or slower beyond noise")
        ->expected(2);
    command->callback([options, &status] { status = run(*options); });
}

}  // namespace limn::cli
