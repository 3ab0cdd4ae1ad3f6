// Position, du and dv at random places of the surface, from control points: limn on a Vulkan device against
// OpenSubdiv's evaluators, in the same run.
#include "limn_patches.h"
#include "patch_bench.h"
#include "patch_samples.h"

namespace limn::bench {
namespace {

constexpr uint32_t kSamples = 1'000'000, kQuickSamples = 200'000;

void bench_model(const Session& session, const LimnDevice& limn, const BenchModel& model) {
    const Options& options = session.options;
    show_progress(options, "patch_eval " + model.name);
    const uint32_t count = options.quick ? kQuickSamples : kSamples;
    const auto truth = value_or_fail(options, build_patch_table<double>(model.mesh, {}));
    const Row row{.scenario = "patch_eval", .parameters = {{"samples", count}}};
    PatchBench bench(session, model, row, PatchTask::derivatives, truth, random_samples(truth, count));
    const auto table = value_or_fail(options, build_patch_table<float>(model.mesh, {}));
    bench.run(value_or_fail(options,
                            make_limn_patch_eval_candidate(limn, table, nullptr, bench.samples(), model.positions)));
    const auto trees = value_or_fail(options, build_patch_trees(table, {.max_rate = 16, .relative = true}));
    bench.run(value_or_fail(options,
                            make_limn_patch_eval_candidate(limn, table, &trees, bench.samples(), model.positions)));
    bench.run(make_limn_host_patch_eval_candidate(table, bench.samples(), model.positions,
                                                  session.machines.copy.host_all_cores));
    bench.run_osd();
}

}  // namespace

void bench_patch_eval(const Session& session) {
    const auto evaluator =
        value_or_fail(session.options, vk::SurfaceEvaluator::create(session.machines.device()));
    const LimnDevice limn{session.machines.device(), evaluator, session.machines.copy.device};
    for (const BenchModel& model : session.models) bench_model(session, limn, model);
}

}  // namespace limn::bench
