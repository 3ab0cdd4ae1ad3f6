// Uniform refinement, every frame: points of levels 2 to 6 from control points, limn on a Vulkan device
// against OpenSubdiv's evaluators and plain loops, in the same run.
#include <cmath>

#include "level_bench.h"
#include "limn_stencils.h"
#include "osd.h"
#include "osd_gl.h"
#include "osd_stencils.h"
#include "plain_loops.h"

namespace limn::bench {
namespace {

constexpr uint32_t kFirstLevel = 2, kLastLevel = 6, kLastQuickLevel = 3;
/// Of a table over the control points a row has about 16 entries; of a step about 7, on 4/3 of the rows.
constexpr double kComposedRowBytes = 8 + 16 * 8, kChainRowBytes = 4.0 / 3 * (8 + 7 * 8);
constexpr double kOsdPeak = 4.2;  // measured: OpenSubdiv's factory holds that much of its table

void run_limn(const Session& session, const vk::Evaluator& evaluator, const BenchModel& model,
              LevelBench& bench, std::span<const StencilTable> tables) {
    const std::string kind = tables.size() == 1 ? "_composed" : "_chain";
    for (const uint32_t width : {3u, 4u}) {
        auto candidate =
            make_limn_candidate(session.machines.device(), evaluator, tables, model.positions, width);
        if (candidate) candidate->copy_rate = session.machines.copy.device;
        bench.run_or_say(candidate, "limn" + kind + (width == 4 ? "_xyzw" : ""), Side::limn);
    }
    bench.run(make_loop_stencil_candidate(tables, model.positions, session.machines.copy.host_all_cores));
}

void run_refined_grid(const Session& session, const vk::SurfaceEvaluator& evaluator, const BenchModel& model,
                      uint32_t level, LevelBench& bench) {
    const auto base = value_or_fail(session.options, build_refinement(model.mesh, {.level = 0}));
    const auto table = build_refined_grid_table(base, {.level = level});
    for (const uint32_t width : {3u, 4u}) {
        auto candidate = table ? make_limn_refined_grid_candidate(session.machines.device(), evaluator, *table,
                                                                  model.positions, width)
                               : Result<Candidate>(table.error());
        if (candidate) candidate->copy_rate = session.machines.copy.device;
        bench.run_or_say(candidate, std::string("limn_refined_grid") + (width == 4 ? "_xyzw" : ""), Side::limn);
    }
}

void bench_level(const Session& session, const vk::Evaluator& evaluator, const vk::SurfaceEvaluator& surfaces,
                 const BenchModel& model, uint32_t level) {
    const Options& options = session.options;
    show_progress(options, "stencil_eval " + model.name + " level " + std::to_string(level));
    // Each step makes four corners, and so about four vertices, of each corner.
    const double row_count = static_cast<double>(model.mesh.face_vertices.size()) *
                             std::ldexp(1.0, 2 * static_cast<int>(level) - 2);
    LevelBench bench(session, "stencil_eval", model, level, row_count);
    const double chain_bytes = row_count * (kChainRowBytes + 4.0 / 3 * 16),
                 composed_bytes = row_count * (kComposedRowBytes + 16);
    if (!bench.fits("all", Side::limn, chain_bytes)) return;
    const OsdRefiner refiner = OsdMesh(model.mesh).refine(level);
    if (!refiner) fail(options, {ErrorCode::unsupported, model.name + ": OpenSubdiv refuses this mesh"});
    bench.set_truth(osd_points(*refiner, model.positions));
    run_refined_grid(session, surfaces, model, level, bench);
    {
        const auto refinement = value_or_fail(options, build_refinement(model.mesh, {.level = level}));
        std::vector<StencilTable> tables;
        for (uint32_t l = 1; l <= level; ++l)
            tables.push_back(value_or_fail(options, build_step_table<float>(refinement, l)));
        run_limn(session, evaluator, model, bench, tables);
        tables.clear();
        if (bench.fits("limn_composed", Side::limn, composed_bytes)) {
            tables.push_back(value_or_fail(options, build_stencil_table<float>(refinement, level)));
            run_limn(session, evaluator, model, bench, tables);
        }
    }
    if (bench.fits("osd_chain", Side::peer, kOsdPeak * row_count * kChainRowBytes))
        run_osd(session, model, bench, std::make_shared<const OsdTable>(build_osd_table(*refiner, OsdTableKind::all_levels_chained)));
    if (bench.fits("osd_composed", Side::peer, kOsdPeak * composed_bytes))
        run_osd(session, model, bench, std::make_shared<const OsdTable>(build_osd_table(*refiner, OsdTableKind::last_level)));
}

}  // namespace

void bench_stencil_eval(const Session& session) {
    const auto evaluator = value_or_fail(session.options, vk::Evaluator::create(session.machines.device()));
    const auto surfaces = value_or_fail(session.options, vk::SurfaceEvaluator::create(session.machines.device()));
    for (const BenchModel& model : session.models)
        for (uint32_t level = kFirstLevel; level <= (session.options.quick ? kLastQuickLevel : kLastLevel);
             ++level)
            bench_level(session, evaluator, surfaces, model, level);
}

}  // namespace limn::bench
