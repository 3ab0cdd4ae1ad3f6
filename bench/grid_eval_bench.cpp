// Grids of places of each ptex face, from control points: points alone, with normals, with derivatives; limn
// on a Vulkan device against OpenSubdiv's evaluators, which have du and dv in place of normals, and a plain
// loop, in the same run.
#include "limn_patches.h"
#include "patch_bench.h"
#include "patch_samples.h"
#include "plain_loops.h"

namespace limn::bench {
namespace {

/// 4 x 4, 8 x 8 and 16 x 16 samples.
constexpr uint32_t kRates[] = {3, 7, 15};
constexpr std::pair<PatchTask, const char*> kTasks[] = {
    {PatchTask::points, "points"}, {PatchTask::normals, "normals"}, {PatchTask::derivatives, "derivatives"}};

void bench_model(const Session& session, const LimnDevice& limn, const BenchModel& model) {
    const Options& options = session.options;
    const auto truth = value_or_fail(options, build_patch_table<double>(model.mesh, {}));
    const auto table = value_or_fail(options, build_patch_table<float>(model.mesh, {}));
    for (const uint32_t rate : kRates)
        for (const auto& [task, name] : kTasks) {
            show_progress(options, "grid_eval " + model.name + " rate " + std::to_string(rate) + " " + name);
            const Row row{.scenario = "grid_eval", .parameters = {{"rate", rate}}, .task = name};
            PatchBench bench(session, model, row, task, truth, grid_samples(truth, rate));
            const auto run_limn = [&](GridLayout layout) {
                bench.run(value_or_fail(
                    options, make_limn_grid_candidate(limn, table, model.positions, rate, task, layout)));
            };
            run_limn(GridLayout::interleaved);
            if (task == PatchTask::normals) {
                run_limn(GridLayout::packed);
                run_limn(GridLayout::separate);
            }
            bench.run(value_or_fail(options, make_loop_grid_candidate(table, model.positions, rate, task,
                                                                      session.machines.copy.host_all_cores)));
            bench.run_osd();
        }
}

}  // namespace

void bench_grid_eval(const Session& session) {
    const auto evaluator =
        value_or_fail(session.options, vk::SurfaceEvaluator::create(session.machines.device()));
    const LimnDevice limn{session.machines.device(), evaluator, session.machines.copy.device};
    for (const BenchModel& model : session.models) bench_model(session, limn, model);
}

}  // namespace limn::bench
