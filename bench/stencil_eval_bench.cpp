// Uniform refinement, every frame: points of levels 2 to 6 from control points, limn on a Vulkan device
// against OpenSubdiv's evaluators and plain loops, in the same run.
#include <cmath>

#include "limn_stencils.h"
#include "osd.h"
#include "osd_gl.h"
#include "osd_stencils.h"
#include "plain_loops.h"
#include "session.h"

namespace limn::bench {
namespace {

constexpr uint32_t kFirstLevel = 2, kLastLevel = 6, kLastQuickLevel = 3;
constexpr Repetitions kRepetitions{3, 1000, 0.25};
constexpr double kMostBytes = 3.0 * (1 << 30);  // of memory, while a table is built
/// Of a table over the control points a row has about 16 entries; of a step about 7, on 4/3 of the rows.
constexpr double kComposedRowBytes = 8 + 16 * 8, kChainRowBytes = 4.0 / 3 * (8 + 7 * 8);
constexpr double kOsdPeak = 4.2;  // measured: OpenSubdiv's factory holds that much of its table

/// One model at one level: verifies and times candidates one after the other, so that only one of them takes
/// memory.
class LevelBench {
  public:
    LevelBench(const Session& session, const BenchModel& model, uint32_t level, double row_count)
        : session_(session) {
        row_.scenario = "stencil_eval";
        row_.model = model.name;
        row_.faces = model.mesh.face_count();
        row_.parameters = {{"level", level}};
        row_.items = row_count;  // of the last level: rates count what is asked for, not the way there
        row_.unit = "points";
        tolerance_ = tolerance_for(model.positions).in_float;
    }

    void set_truth(std::vector<double> truth) {
        truth_ = std::move(truth);
        row_.items = static_cast<double>(truth_.size() / 3);
    }

    void run(const Candidate& candidate) {
        const Options& options = session_.options;
        Row row = row_;
        row.evaluator = candidate.name;
        row.side = candidate.is_limn ? Side::limn : Side::peer;
        if (!candidate.frame())
            fail(options, {ErrorCode::unsupported, row_name(row) + ": cannot be evaluated"});
        const double difference = largest_difference(candidate.points(), truth_);
        if (!(difference <= tolerance_))
            fail(options,
                 {ErrorCode::unsupported, row_name(row) + format(": points are wrong by %.3g, more than %.3g",
                                                                 difference, tolerance_)});
        std::vector<double> device;
        const auto frame = [&] {
            const bool done = candidate.frame();
            if (candidate.device_milliseconds) device.push_back(candidate.device_milliseconds());
            return done;
        };
        row.timing = measure(options, frame, {}, kRepetitions);
        if (!device.empty())
            row.device = timing_of({device.begin() + 1, device.end()});  // without the warm-up
        row.bytes = static_cast<double>(candidate.bytes);
        row.flops = candidate.flops;
        row.copy_rate = candidate.copy_rate;
        if (candidate.dispatch_count != 0)
            row.note = std::to_string(candidate.dispatch_count) + " dispatches";
        session_.report.add(row);
    }

    /// Times what could be made; says why it could not be.
    void run_or_say(const Result<Candidate>& candidate, const std::string& name, Side side) {
        if (candidate) return run(*candidate);
        add_missing(name, side, candidate.error().message);
    }

    void add_missing(const std::string& name, Side side, const std::string& why) {
        Row row = row_;
        row.evaluator = name;
        row.side = side;
        row.note = why;
        session_.report.add(row);
    }

    /// False where tables and points would take too much; a row says so.
    bool fits(const std::string& name, Side side, double bytes) {
        if (bytes <= kMostBytes) return true;
        add_missing(name, side, format("left out: about %.1f GiB, more than 3", bytes / (1 << 30)));
        return false;
    }

  private:
    const Session& session_;
    Row row_;
    std::vector<double> truth_;
    double tolerance_ = 0;
};

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

void run_osd(const Session& session, const BenchModel& model, LevelBench& bench, OsdTable built) {
    const Machines& machines = session.machines;
    const auto table = std::make_shared<const OsdTable>(std::move(built));
    for (const uint32_t width : {3u, 4u}) {
        bench.run(make_osd_candidate(OsdEvaluator::cpu, table, model.positions, width, machines.copy.host));
        bench.run(make_osd_candidate(OsdEvaluator::omp, table, model.positions, width,
                                     machines.copy.host_all_cores));
        const std::string name = describe_osd_candidate("gl", *table, width).name;
        bench.run_or_say(
            machines.gl ? make_osd_gl_candidate(*machines.gl, table, model.positions, width, machines.copy.gl)
                        : Result<Candidate>(machines.gl.error()),
            name, Side::peer);
    }
}

void bench_level(const Session& session, const vk::Evaluator& evaluator, const vk::SurfaceEvaluator& surfaces,
                 const BenchModel& model, uint32_t level) {
    const Options& options = session.options;
    show_progress(options, "stencil_eval " + model.name + " level " + std::to_string(level));
    // Each step makes four corners, and so about four vertices, of each corner.
    const double row_count = static_cast<double>(model.mesh.face_vertices.size()) *
                             std::ldexp(1.0, 2 * static_cast<int>(level) - 2);
    LevelBench bench(session, model, level, row_count);
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
        run_osd(session, model, bench, build_osd_table(*refiner, OsdTableKind::all_levels_chained));
    if (bench.fits("osd_composed", Side::peer, kOsdPeak * composed_bytes))
        run_osd(session, model, bench, build_osd_table(*refiner, OsdTableKind::last_level));
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
