// What the smallest mesh costs: a cube's control points to a grid of 8 x 8 samples of each face, from
// submission to fence; OpenSubdiv on the host, where nothing is submitted.
#include "limn_patches.h"
#include "patch_bench.h"
#include "patch_samples.h"
#include "plain_loops.h"

namespace limn::bench {

void bench_latency(const Session& session) {
    constexpr uint32_t kRate = 7;
    const Options& options = session.options;
    const BenchModel model = make_cube();
    const auto evaluator = value_or_fail(options, vk::SurfaceEvaluator::create(session.machines.device()));
    const LimnDevice limn{session.machines.device(), evaluator, session.machines.copy.device};
    const auto truth = value_or_fail(options, build_patch_table<double>(model.mesh, {}));
    const auto table = value_or_fail(options, build_patch_table<float>(model.mesh, {}));
    const Row row{.scenario = "latency", .parameters = {{"rate", kRate}}, .task = "normals"};
    PatchBench bench(session, model, row, PatchTask::normals, truth, grid_samples(truth, kRate));
    bench.run(value_or_fail(
        options, make_limn_grid_candidate(limn, table, model.positions, kRate, PatchTask::normals)));
    bench.run(
        value_or_fail(options, make_loop_grid_candidate(table, model.positions, kRate, PatchTask::normals,
                                                        session.machines.copy.host_all_cores)));
    bench.run_osd(false);
}

}  // namespace limn::bench
