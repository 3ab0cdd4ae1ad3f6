// Points of level 4 from control points: limn on a Vulkan device against OpenSubdiv's evaluators, in the same
// run.
#include <algorithm>
#include <cstdio>

#include "bench.h"
#include "limn_stencils.h"
#include "machines.h"
#include "models.h"
#include "osd.h"
#include "osd_gl.h"
#include "osd_stencils.h"

namespace limn::bench {
namespace {

constexpr uint32_t kLevel = 4;

struct Measured {
    std::string name;
    bool is_limn;
    Timing timing;
};

/// One model: verifies and times candidates one after the other, so that only one of them takes memory.
class ModelBench {
  public:
    ModelBench(const Options& options, const BenchModel& model, Report& report, const Refinement& refinement,
               std::vector<double> truth)
        : options_(options),
          report_(report),
          truth_(std::move(truth)),
          tolerance_(tolerance_for(model.positions).in_float),
          prefix_("stencil_eval/" + model.name + "/level=" + std::to_string(kLevel) + "/"),
          rows_(refinement.last().vertex_count) {}

    void run(const Candidate& candidate) {
        if (!candidate.frame())
            fail(options_, {ErrorCode::unsupported, prefix_ + candidate.name + ": cannot be evaluated"});
        const double difference = largest_difference(candidate.points(), truth_);
        if (!(difference <= tolerance_)) {
            char text[160];
            std::snprintf(text, sizeof text, ": points are wrong by %.3g, more than %.3g", difference,
                          tolerance_);
            fail(options_, {ErrorCode::unsupported, prefix_ + candidate.name + text});
        }
        std::vector<double> device;
        const Timing timing = measure(options_, [&] {
            const bool done = candidate.frame();
            if (candidate.device_milliseconds) device.push_back(candidate.device_milliseconds());
            return done;
        });
        Row row{.name = prefix_ + candidate.name};
        (candidate.is_limn ? row.limn : row.peer) = timing;
        if (!device.empty())
            row.device = timing_of({device.begin() + 1, device.end()});  // without the warm-up
        row.items = rows_;
        row.entries = static_cast<double>(candidate.entry_count);
        row.bytes = static_cast<double>(candidate.bytes);
        row.copy_rate = candidate.copy_rate;
        if (candidate.dispatch_count != 0)
            row.note = std::to_string(candidate.dispatch_count) + " dispatches";
        report_.add(row);
        measured_.push_back({candidate.name, candidate.is_limn, timing});
    }

    void add_missing(const std::string& name, const std::string& why) {
        report_.add({.name = prefix_ + name, .peer = Timing{}, .note = why});
    }

    /// The best of limn against the best of OpenSubdiv: of its GL evaluator, which runs on the same kind of
    /// device; of all at three floats a point; of all.
    void finish() {
        add_best("best_gl", "osd_gl", true);
        add_best("best_xyz", "osd", false);
        add_best("best", "osd", true);
    }

  private:
    /// Peers whose names start with `peers`; padded points where `padded`.
    void add_best(const char* name, const char* peers, bool padded) {
        const Measured *limn = nullptr, *peer = nullptr;
        for (const Measured& m : measured_) {
            if (m.timing.count == 0 || (!padded && m.name.find("xyzw") != std::string::npos)) continue;
            if (!m.is_limn && m.name.rfind(peers, 0) != 0) continue;
            const Measured*& best = m.is_limn ? limn : peer;
            if (best == nullptr || m.timing.median < best->timing.median) best = &m;
        }
        if (limn == nullptr || peer == nullptr) return;
        report_.add({.name = prefix_ + name,
                     .limn = limn->timing,
                     .peer = peer->timing,
                     .items = rows_,
                     .note = limn->name + " / " + peer->name});
    }

    const Options& options_;
    Report& report_;
    std::vector<double> truth_;
    double tolerance_;
    std::string prefix_;
    double rows_;  ///< of the last level: rates count what is asked for, not the way there
    std::vector<Measured> measured_;
};

void run_limn(const Options& options, const Machines& machines, const vk::Evaluator& evaluator,
              const BenchModel& model, ModelBench& bench, std::span<const StencilTable> tables) {
    for (const uint32_t width : {3u, 4u}) {
        Candidate candidate = value_or_fail(
            options, make_limn_candidate(machines.device(), evaluator, tables, model.positions, width));
        candidate.copy_rate = machines.copy.device;
        bench.run(candidate);
    }
}

void run_osd(const Options& options, const Machines& machines, const BenchModel& model, ModelBench& bench,
             OsdTable built) {
    const auto table = std::make_shared<const OsdTable>(std::move(built));
    for (const uint32_t width : {3u, 4u}) {
        bench.run(make_osd_candidate(OsdEvaluator::cpu, table, model.positions, width, machines.copy.host));
        bench.run(make_osd_candidate(OsdEvaluator::omp, table, model.positions, width,
                                     machines.copy.host_all_cores));
        if (machines.gl)
            bench.run(value_or_fail(options, make_osd_gl_candidate(*machines.gl, table, model.positions,
                                                                   width, machines.copy.gl)));
        else
            bench.add_missing(describe_osd_candidate("gl", *table, width).name, machines.gl.error().message);
    }
}

void bench_model(const Options& options, const Machines& machines, const vk::Evaluator& evaluator,
                 const BenchModel& model, Report& report) {
    const auto refinement = value_or_fail(options, build_refinement(model.mesh, {.level = kLevel}));
    const OsdRefiner refiner = OsdMesh(model.mesh).refine(kLevel);
    if (!refiner) fail(options, {ErrorCode::unsupported, model.name + ": OpenSubdiv refuses this mesh"});
    ModelBench bench(options, model, report, refinement, osd_points(*refiner, model.positions));
    {
        std::vector<StencilTable> tables;
        tables.push_back(value_or_fail(options, build_stencil_table<float>(refinement, kLevel)));
        run_limn(options, machines, evaluator, model, bench, tables);
        tables.clear();
        for (uint32_t level = 1; level <= kLevel; ++level)
            tables.push_back(value_or_fail(options, build_step_table<float>(refinement, level)));
        run_limn(options, machines, evaluator, model, bench, tables);
    }
    for (const OsdTableKind kind : {OsdTableKind::last_level, OsdTableKind::all_levels_chained})
        run_osd(options, machines, model, bench, build_osd_table(*refiner, kind));
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
    const vk::Evaluator evaluator = value_or_fail(options, vk::Evaluator::create(machines.device()));
    Report report(options, "stencil_eval", machines.facts());
    for (const BenchModel& model : models) bench_model(options, machines, evaluator, model, report);
    value_or_fail(options, report.finish());
    return 0;
}
