// OpenSubdiv's own tables, evaluated by limn::osd on a Vulkan device and by OpenSubdiv's evaluators, in the same run:
// stencils of uniform refinement; and of adaptive refinement, with patches at random places.
#include <cmath>

#include "level_bench.h"
#include "limn_osd.h"
#include "patch_bench.h"
#include "patch_samples.h"

namespace limn::bench {
namespace {

constexpr uint32_t kLevel = 4, kQuickLevel = 2, kSamples = 1'000'000, kQuickSamples = 200'000;
constexpr OsdFrame kFrames[] = {OsdFrame::recorded, OsdFrame::submitted};

void bench_stencils(const Session& session, const BenchModel& model, uint32_t level) {
    const OsdRefiner refiner = OsdMesh(model.mesh).refine(level);
    if (!refiner) fail(session.options, {ErrorCode::unsupported, model.name + ": OpenSubdiv refuses this mesh"});
    for (const OsdTableKind kind : {OsdTableKind::all_levels_chained, OsdTableKind::last_level}) {
        LevelBench bench(session, "osd_interop", model, level, 0);
        bench.set_truth(osd_points(*refiner, model.positions));
        const auto table = std::make_shared<const OsdTable>(build_osd_table(*refiner, kind));
        for (const OsdFrame how : kFrames)
            bench.run_or_say(make_limn_osd_candidate(session.machines.device(), table, model.positions, how,
                                                     session.machines.copy.device),
                             "limn_osd", Side::limn);
        run_osd(session, model, bench, table);
    }
}

void bench_patches(const Session& session, const BenchModel& model, uint32_t count) {
    const auto truth = value_or_fail(session.options, build_patch_table<double>(model.mesh, {}));
    const Row row{.scenario = "osd_interop", .parameters = {{"samples", count}}};
    PatchBench bench(session, model, row, PatchTask::derivatives, truth, random_samples(truth, count));
    const OsdSamples osd = bench.find_osd();
    for (const OsdFrame how : kFrames)
        bench.run(value_or_fail(session.options,
                                make_limn_osd_patch_candidate(session.machines.device(), osd.places, model.positions,
                                                              how, session.machines.copy.device)),
                  osd);
    bench.run_osd(osd);
}

}  // namespace

void bench_osd_interop(const Session& session) {
    const bool quick = session.options.quick;
    for (const BenchModel& model : session.models) {
        show_progress(session.options, "osd_interop " + model.name);
        bench_stencils(session, model, quick ? kQuickLevel : kLevel);
        bench_patches(session, model, quick ? kQuickSamples : kSamples);
    }
}

}  // namespace limn::bench
