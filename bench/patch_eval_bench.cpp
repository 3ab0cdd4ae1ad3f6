// Position, du and dv at random places of the surface, from control points: limn on a Vulkan device against
// OpenSubdiv's evaluators, in the same run.
#include "bench.h"
#include "limn_patches.h"
#include "machines.h"
#include "models.h"
#include "patch_bench.h"
#include "patch_samples.h"

namespace limn::bench {
namespace {

void bench_model(const Options& options, const Machines& machines, const LimnDevice& limn,
                 const BenchModel& model, Report& report) {
    const auto truth = value_or_fail(options, build_patch_table<double>(model.mesh, {}));
    PatchBench bench(options, model, report, "patch_eval/" + model.name + "/", truth,
                     random_samples(truth, options.quick ? 200'000 : 1'000'000));
    const auto table = value_or_fail(options, build_patch_table<float>(model.mesh, {}));
    bench.run(value_or_fail(options,
                            make_limn_patch_eval_candidate(limn, table, nullptr, bench.samples(), model.positions)));
    const auto trees = value_or_fail(options, build_patch_trees(table, {.max_rate = 16, .relative = true}));
    bench.run(value_or_fail(options,
                            make_limn_patch_eval_candidate(limn, table, &trees, bench.samples(), model.positions)));
    bench.run(make_limn_host_patch_eval_candidate(table, bench.samples(), model.positions,
                                                  machines.copy.host_all_cores));
    bench.run_osd(machines);
    bench.finish();
}

}  // namespace
}  // namespace limn::bench

int main(int argc, char** argv) {
    using namespace limn;
    using namespace limn::bench;
    const Options options = parse_options(argc, argv, vk::kAutomaticDevice, vk::kCpuDevice);
    const std::vector<BenchModel> models = load_models(options);
    const Machines machines = open_machines(options);
    const auto evaluator = value_or_fail(options, vk::SurfaceEvaluator::create(machines.device()));
    const LimnDevice limn{machines.device(), evaluator, machines.copy.device};
    Report report(options, "patch_eval", machines.facts(), "samples");
    for (const BenchModel& model : models) bench_model(options, machines, limn, model, report);
    value_or_fail(options, report.finish());
    return 0;
}
