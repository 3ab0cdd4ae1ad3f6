// From an edit of the topology to its first frame: one crease gets another sharpness, tables are made again
// (limn: with a warm cache of plans), uploaded, and a grid is evaluated. OpenSubdiv's evaluators run on the
// host: nothing is uploaded.
#include <cmath>

#include "limn_patches.h"
#include "osd_patches.h"
#include "patch_samples.h"
#include "session.h"

namespace limn::bench {
namespace {

constexpr uint32_t kRate = 7, kIsolationLevel = 3;

/// A mesh whose crease 0 can be edited; one along the first edge where there is none.
BenchModel with_crease(const BenchModel& model) {
    BenchModel edited = model;
    if (edited.mesh.crease_sharpness.empty()) {
        edited.mesh.crease_edges = {edited.mesh.face_vertices[0], edited.mesh.face_vertices[1]};
        edited.mesh.crease_sharpness = {1};
    }
    return edited;
}

Row row_of(const BenchModel& model, const char* task, const char* evaluator, Side side) {
    return {.scenario = "edit",
            .model = model.name,
            .faces = model.mesh.face_count(),
            .parameters = {{"rate", kRate}},
            .task = task,
            .evaluator = evaluator,
            .side = side,
            .items = static_cast<double>(model.mesh.face_count()),
            .unit = "faces"};
}

struct Setup {
    const Session& session;
    const LimnDevice& limn;
    BenchModel model;
    std::vector<double> truth = {};  ///< of the mesh as it is

    /// The edit itself. `known`: between two values that have been seen before.
    void edit(uint32_t step, bool known) {
        model.mesh.crease_sharpness[0] =
            known ? (step % 2 == 0 ? 1.5f : 2.25f) : 1 + 0.001f * static_cast<float>(step);
    }
    std::vector<PatchSample> samples(const PatchTableDouble& table) {
        auto list = grid_samples(table, kRate);
        truth = evaluate_samples(table, list, model.positions, Derivatives::none);
        return list;
    }
};

PatchCandidate make_limn(const Setup& s, const PlanCache& cache) {
    const Options& options = s.session.options;
    const auto table = value_or_fail(options, build_patch_table<float>(s.model.mesh, {}, &cache));
    return value_or_fail(
        options, make_limn_grid_candidate(s.limn, table, s.model.positions, kRate, PatchTask::derivatives));
}

PatchCandidate make_osd(const Setup& s, OsdEvaluator evaluator, std::span<const PatchSample> samples) {
    const auto places = std::make_shared<OsdPlaces>();
    places->patches = build_osd_patches(OsdMesh(s.model.mesh), kIsolationLevel);
    if (places->patches) places->places = find_osd_patches(*places->patches, samples);
    if (places->places.size() != samples.size())
        fail(s.session.options,
             {ErrorCode::unsupported, s.model.name + ": OpenSubdiv has no patch at some place"});
    return make_osd_patch_candidate(evaluator, PatchTask::derivatives, places, s.model.positions, 3, 0);
}

void verify(const Setup& s, const Row& row, const PatchCandidate& candidate, double tolerance) {
    if (!candidate.frame())
        fail(s.session.options, {ErrorCode::unsupported, row_name(row) + ": cannot be evaluated"});
    const double difference = largest_difference(candidate.values().positions, s.truth);
    if (!(difference <= tolerance))
        fail(s.session.options,
             {ErrorCode::unsupported,
              row_name(row) + format(": positions are %.3g off, more than %.3g", difference, tolerance)});
}

void bench_limn(Setup& s, const char* task, bool known) {
    const Options& options = s.session.options;
    const PlanCache cache;
    Row row = row_of(s.model, task, "limn", Side::limn);
    for (uint32_t step = 0; step < 2; ++step) {  // both values get known
        s.edit(step, true);
        const auto truth = value_or_fail(options, build_patch_table<double>(s.model.mesh, {}));
        s.samples(truth);
        verify(s, row, make_limn(s, cache), tolerance_for(s.model.positions).in_float);
    }
    uint32_t step = 0;
    row.timing = measure(options, [&] {
        s.edit(step++, known);
        return make_limn(s, cache).frame();
    });
    row.note = "tables, upload, buffers, commands, first frame";
    s.session.report.add(row);
}

void bench_osd(Setup& s, const char* task, OsdEvaluator evaluator, bool known) {
    const Options& options = s.session.options;
    Row row = row_of(s.model, task, evaluator == OsdEvaluator::cpu ? "osd_cpu" : "osd_omp", Side::peer);
    s.edit(0, true);
    const auto truth = value_or_fail(options, build_patch_table<double>(s.model.mesh, {}));
    const auto samples = s.samples(truth);
    const double size = tolerance_for(s.model.positions).size;
    verify(s, row, make_osd(s, evaluator, samples), size * largest_osd_error(kIsolationLevel));
    uint32_t step = 0;
    row.timing = measure(options, [&] {
        s.edit(step++, known);
        return make_osd(s, evaluator, samples).frame();
    });
    row.note = "refiner, patches at level 3, stencils, places, first frame";
    s.session.report.add(row);
}

}  // namespace

void bench_edit(const Session& session) {
    const auto evaluator =
        value_or_fail(session.options, vk::SurfaceEvaluator::create(session.machines.device()));
    const LimnDevice limn{session.machines.device(), evaluator, session.machines.copy.device};
    for (const BenchModel& model : session.models)
        for (const auto& [task, known] :
             {std::pair{"known_sharpness", true}, std::pair{"new_sharpness", false}}) {
            show_progress(session.options, "edit " + model.name + " " + task);
            Setup s{session, limn, with_crease(model)};
            bench_limn(s, task, known);
            bench_osd(s, task, OsdEvaluator::cpu, known);
            bench_osd(s, task, OsdEvaluator::omp, known);
        }
}

}  // namespace limn::bench
