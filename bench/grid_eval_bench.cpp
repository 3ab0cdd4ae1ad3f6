// Position and normal at a grid of places of each ptex face, from control points: limn on a Vulkan device
// against OpenSubdiv's evaluators, which have du and dv in place of normals, in the same run.
#include "bench.h"
#include "limn_patches.h"
#include "machines.h"
#include "models.h"
#include "patch_bench.h"
#include "patch_samples.h"

namespace limn::bench {
namespace {

constexpr uint32_t kRates[] = {4, 8, 16};

void bench_model(const Options& options, const Machines& machines, const LimnDevice& limn,
                 const BenchModel& model, Report& report) {
    const auto truth = value_or_fail(options, build_patch_table<double>(model.mesh, {}));
    const auto table = value_or_fail(options, build_patch_table<float>(model.mesh, {}));
    for (const uint32_t rate : kRates) {
        PatchBench bench(options, model, report,
                         "grid_eval/" + model.name + "/rate=" + std::to_string(rate) + "/", truth,
                         grid_samples(truth, rate));
        for (const GridLayout layout : {GridLayout::interleaved, GridLayout::separate})
            bench.run(
                value_or_fail(options, make_limn_grid_candidate(limn, table, model.positions, rate, layout)));
        bench.run_osd(machines);
        bench.finish();
    }
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
    Report report(options, "grid_eval", machines.facts(), "samples");
    for (const BenchModel& model : models) bench_model(options, machines, limn, model, report);
    value_or_fail(options, report.finish());
    return 0;
}
