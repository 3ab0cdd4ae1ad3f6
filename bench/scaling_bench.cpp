// Time per face over the size of the mesh, for each stage: building tables, level 1 of uniform refinement, a
// grid of 4 x 4 samples of each face. OpenSubdiv builds beside it where that takes no minutes.
#include <algorithm>
#include <map>

#include "compare.h"
#include "limn_patches.h"
#include "limn_stencils.h"
#include "osd_patches.h"
#include "patch_samples.h"
#include "session.h"

namespace limn::bench {
namespace {

constexpr std::pair<const char*, uint32_t> kSizes[] = {{"torus_1k", 1'000},
                                                       {"torus_10k", 10'000},
                                                       {"torus_100k", 100'000},
                                                       {"torus_1M", 1'000'000},
                                                       {"torus_4M", 4'000'000}};
constexpr size_t kQuickSizes = 3;
constexpr uint32_t kMostOsdFaces = 150'000, kRate = 3, kSideSamples = kRate + 1;
constexpr Repetitions kRepetitions{3, 100, 0.25}, kLargeRepetitions{2, 100, 0.25};
constexpr uint32_t kLargeFaces = 500'000;
constexpr size_t kCheckedSamples = 20'000;

struct Setup {
    const Session& session;
    const vk::Evaluator& evaluator;
    const LimnDevice& limn;
    const BenchModel& model;

    bool has_osd() const { return model.mesh.face_count() <= kMostOsdFaces; }
    Row row_of(const char* task, const char* name, Side side) const {
        return {.scenario = "scaling",
                .model = model.name,
                .faces = model.mesh.face_count(),
                .task = task,
                .evaluator = name,
                .side = side,
                .items = static_cast<double>(model.mesh.face_count()),
                .unit = "faces"};
    }
    Timing time(const std::function<bool()>& step, const std::function<void()>& reset = {}) const {
        const bool large = model.mesh.face_count() >= kLargeFaces;
        return measure(session.options, step, reset, large ? kLargeRepetitions : kRepetitions);
    }
    [[noreturn]] void fail_verification(const Row& row, double difference) const {
        fail(session.options,
             {ErrorCode::unsupported, row_name(row) + format(": points are %.3g off", difference)});
    }
};

/// Times frames, once they are known to be right; reports rows without times where they cannot be made.
template <class AnyCandidate>
void add_frames(const Setup& s, Row row, const AnyCandidate& candidate) {
    std::vector<double> device;
    row.timing = s.time([&] {
        const bool done = candidate.frame();
        if (candidate.device_milliseconds) device.push_back(candidate.device_milliseconds());
        return done;
    });
    if (!device.empty()) row.device = timing_of({device.begin() + 1, device.end()});
    row.bytes = static_cast<double>(candidate.bytes);
    row.flops = candidate.flops;
    row.copy_rate = s.session.machines.copy.device;
    row.note = std::to_string(candidate.dispatch_count) + " dispatches";
    s.session.report.add(row);
}

StencilTable bench_level1_build(const Setup& s) {
    const Options& options = s.session.options;
    std::optional<StencilTable> table;
    Row limn = s.row_of("level1_build", "limn", Side::limn);
    limn.timing = s.time(
        [&] {
            const auto base = value_or_fail(options, build_refinement(s.model.mesh, {.level = 0}));
            table = value_or_fail(options, build_stencil_table<float>(base, 1));
            return true;
        },
        [&] { table.reset(); });
    limn.note = megabytes(table->bytes());
    s.session.report.add(limn);
    if (!s.has_osd()) return std::move(*table);
    const OsdMesh mesh(s.model.mesh);
    std::optional<OsdTable> built;
    Row osd = s.row_of("level1_build", "osd_far", Side::peer);
    osd.timing =
        s.time([&] { return built = build_osd_table(*mesh.refine(1), OsdTableKind::last_level), true; },
               [&] { built.reset(); });
    s.session.report.add(osd);
    return std::move(*table);
}

/// Level 1 in double: by OpenSubdiv or, where that takes too long, by limn's own sums on the host.
std::vector<double> level1_points(const Setup& s, const StencilTable& table) {
    if (s.has_osd()) return osd_points(*OsdMesh(s.model.mesh).refine(1), s.model.positions);
    std::vector<float> points(size_t{3} * table.row_count());
    apply_stencil_table<float>(table, s.model.positions, points, 3);
    return {points.begin(), points.end()};
}

void bench_level1(const Setup& s) {
    const StencilTable table = bench_level1_build(s);
    Row row = s.row_of("level1_frame", "limn", Side::limn);
    const auto candidate = make_limn_candidate(s.session.machines.device(), s.evaluator, std::span(&table, 1),
                                               s.model.positions, 3);
    if (!candidate) {
        row.note = candidate.error().message;
        return s.session.report.add(row);
    }
    candidate->frame();
    const double difference = largest_difference(candidate->points(), level1_points(s, table));
    if (!(difference <= tolerance_for(s.model.positions).in_float)) s.fail_verification(row, difference);
    add_frames(s, row, *candidate);
}

PatchTable bench_table_build(const Setup& s) {
    std::optional<PatchTable> table;
    Row limn = s.row_of("table_build", "limn", Side::limn);
    limn.timing = s.time(
        [&] {
            table = value_or_fail(s.session.options, build_patch_table<float>(s.model.mesh, {}));
            return true;
        },
        [&] { table.reset(); });
    limn.note = megabytes(table->bytes()) + ", " + std::to_string(table->plans.size()) + " plans";
    s.session.report.add(limn);
    if (!s.has_osd()) return std::move(*table);
    const OsdMesh mesh(s.model.mesh);
    std::unique_ptr<const OsdPatches> patches;
    Row osd = s.row_of("table_build", "osd_far", Side::peer);
    osd.timing =
        s.time([&] { return (patches = build_osd_patches(mesh, 3)) != nullptr; }, [&] { patches.reset(); });
    s.session.report.add(osd);
    return std::move(*table);
}

/// How far some of the values are from the truth. There are no holes: samples follow each other face by face.
double grid_difference(const Setup& s, const PatchTable& table, const std::vector<float>& values) {
    const size_t face_samples = kSideSamples * kSideSamples,
                 count = table.ptex_surfaces.size() * face_samples;
    if (values.size() != 3 * count) return HUGE_VAL;
    std::vector<PatchSample> samples;
    std::vector<float> chosen;
    for (size_t at = 0; at < count; at += count / kCheckedSamples + 1) {
        const size_t within = at % face_samples;
        samples.push_back({static_cast<uint32_t>(at / face_samples),
                           static_cast<double>(within % kSideSamples) / kRate,
                           static_cast<double>(within / kSideSamples) / kRate});
        for (size_t axis = 0; axis < 3; ++axis) chosen.push_back(values[3 * at + axis]);
    }
    return largest_difference(chosen, evaluate_samples(table, samples, s.model.positions, Derivatives::none));
}

void bench_grid(const Setup& s) {
    const PatchTable table = bench_table_build(s);
    Row row = s.row_of("grid_frame", "limn", Side::limn);
    const auto candidate =
        make_limn_grid_candidate(s.limn, table, s.model.positions, kRate, PatchTask::points);
    if (!candidate) {
        row.note = candidate.error().message;
        return s.session.report.add(row);
    }
    candidate->frame();
    const double difference = grid_difference(s, table, candidate->values().positions);
    if (!(difference <= tolerance_for(s.model.positions).in_float)) s.fail_verification(row, difference);
    add_frames(s, row, *candidate);
}

void report_growth(Report& report) {
    std::map<std::string, std::vector<SizeTiming>> stages;
    for (const Row& row : report.data().rows)
        if (row.scenario == "scaling" && row.measured())
            stages[row.task + ", " + row.evaluator].push_back({static_cast<double>(row.faces), row.timing});
    for (const auto& [stage, sizes] : stages)
        report.add_finding("scaling/" + stage + ": " + describe_growth(sizes));
}

}  // namespace

void bench_scaling(const Session& session) {
    const vk::Device& device = session.machines.device();
    const auto evaluator = value_or_fail(session.options, vk::Evaluator::create(device));
    const auto surfaces = value_or_fail(session.options, vk::SurfaceEvaluator::create(device));
    const LimnDevice limn{device, surfaces, session.machines.copy.device};
    for (size_t i = 0; i < (session.options.quick ? kQuickSizes : std::size(kSizes)); ++i) {
        show_progress(session.options, std::string("scaling ") + kSizes[i].first);
        const BenchModel model = make_smooth_torus(kSizes[i].first, kSizes[i].second);
        const Setup setup{session, evaluator, limn, model};
        bench_grid(setup);
        bench_level1(setup);
    }
    report_growth(session.report);
}

}  // namespace limn::bench
