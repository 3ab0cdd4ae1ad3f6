// Building what evaluators take, from the mesh in memory: limn's patch tables against OpenSubdiv's
// feature-adaptive patches and stencils. And uploading limn's to a Vulkan device.
#include <algorithm>
#include <optional>

#include "limn/vulkan/surface_tables.h"
#include "osd.h"
#include "osd_samples.h"
#include "patch_samples.h"
#include "session.h"

namespace limn::bench {
namespace {

/// OpenSubdiv's isolation levels: the usual one, and one at which its surface is nearly right.
constexpr uint32_t kLevel = 3, kDeepLevel = 6;
constexpr uint32_t kSampleCount = 5000;
/// Levels of uniform refinement whose vertices limn's surface must go through.
constexpr uint32_t kRefinedLevel = 2;

struct Setup {
    const Options& options;
    const vk::Device& device;
    const BenchModel& model;
    Report& report;
    OsdMesh osd;
};

std::string peak_text(uint64_t peak) {
    return peak != 0 ? "peak " + megabytes(peak) : "peak n/a";
}

[[noreturn]] void fail_verification(const Setup& setup, const std::string& what) {
    fail(setup.options, {ErrorCode::unsupported, setup.model.name + ": " + what});
}

PatchTable build(const Setup& setup, const PlanCache* cache) {
    return value_or_fail(setup.options, build_patch_table<float>(setup.model.mesh, {}, cache));
}

std::unique_ptr<const OsdPatches> build_osd(const Setup& setup, uint32_t level) {
    auto patches = build_osd_patches(setup.osd, level);
    if (!patches) fail_verification(setup, "OpenSubdiv refuses this mesh");
    return patches;
}

/// How far the surface, with the weights in float that are timed, is from the limits of refined vertices: as
/// far as floats are, or this fails.
double verify_limits(const Setup& setup, const PatchTable& table, const char* what) {
    const RefinedCorners corners = refined_corners(setup.options, setup.model, kRefinedLevel);
    const double difference = largest_difference(
        evaluate_samples(table, corners.samples, setup.model.positions, Derivatives::none), corners.limits);
    const Tolerance tolerance = tolerance_for(setup.model.positions);
    if (!(difference <= tolerance.in_float)) {
        char text[160];
        std::snprintf(text, sizeof text, "%s is %.3g off the limits of level %u, more than %.3g", what,
                      difference, kRefinedLevel, tolerance.in_float);
        fail_verification(setup, text);
    }
    return difference / tolerance.size;
}

/// How far OpenSubdiv's surface is from the limit: what the level leaves, its patches being what they should.
double verify_osd(const Setup& setup, const PatchTable& table, uint32_t level) {
    const auto samples = random_samples(table, kSampleCount);
    return largest_difference(find_osd_samples(setup.options, setup.model, level, samples).points(),
                              evaluate_samples(table, samples, setup.model.positions, Derivatives::none)) /
           tolerance_for(setup.model.positions).size;
}

void verify(const Setup& setup) {
    const PlanCache cache;
    const PatchTable table = build(setup, nullptr);
    double worst = verify_limits(setup, table, "the patch table");
    for (int i = 0; i < 2; ++i)
        worst = std::max(worst, verify_limits(setup, build(setup, &cache), "a cached patch table"));
    setup.report.add_finding(
        format("patch_table/%s: %u faces, %zu ptex faces; within %.1e of the size of the limits at level %u; "
               "OpenSubdiv within %.1e at level %u, %.1e at level %u",
               setup.model.name.c_str(), setup.model.mesh.face_count(), table.ptex_surfaces.size(), worst,
               kRefinedLevel, verify_osd(setup, table, kLevel), kLevel, verify_osd(setup, table, kDeepLevel),
               kDeepLevel));
}

struct Built {
    Timing timing;
    std::string note;  ///< what it is, its bytes and the most memory that building it took
};

std::string device_bytes(const Setup& setup, const PatchTable& table) {
    const auto uploaded = value_or_fail(setup.options, vk::upload_patch_table(setup.device, table));
    return " (" + megabytes(uploaded.bytes()) + " on the device)";
}

Built measure_limn(const Setup& setup, const PlanCache* cache) {
    std::optional<PatchTable> table;
    const auto step = [&] { return table = build(setup, cache), true; };
    const auto reset = [&] { table.reset(); };
    Built built{measure(setup.options, step, reset), {}};
    reset();
    const uint64_t peak = peak_memory(step);
    built.note = std::to_string(table->surfaces.size()) + " surfaces, " +
                 std::to_string(table->plans.size()) + " plans, " + megabytes(table->bytes()) +
                 device_bytes(setup, *table) + ", " + peak_text(peak);
    return built;
}

/// From the mesh to tables that kernels can read.
Timing measure_upload(const Setup& setup, const PlanCache* cache) {
    std::optional<vk::DevicePatchTable> table;
    return measure(
        setup.options,
        [&] {
            table.emplace(
                value_or_fail(setup.options, vk::upload_patch_table(setup.device, build(setup, cache))));
            return true;
        },
        [&] { table.reset(); });
}

Built measure_osd(const Setup& setup, uint32_t level) {
    std::unique_ptr<const OsdPatches> patches;
    const auto step = [&] { return patches = build_osd(setup, level), true; };
    const auto reset = [&] { patches.reset(); };
    Built built{measure(setup.options, step, reset), {}};
    reset();
    const uint64_t peak = peak_memory(step);
    built.note = std::to_string(patches->patch_count()) + " patches, " +
                 std::to_string(patches->stencil_count()) + " stencils, " + megabytes(patches->bytes()) +
                 ", " + peak_text(peak);
    return built;
}

void add_row(const Setup& setup, const char* task, const char* evaluator, Side side, const Built& built) {
    setup.report.add({.scenario = "patch_table",
                      .model = setup.model.name,
                      .faces = setup.model.mesh.face_count(),
                      .task = task,
                      .evaluator = evaluator,
                      .side = side,
                      .timing = built.timing,
                      .items = static_cast<double>(setup.model.mesh.face_count()),
                      .unit = "faces",
                      .note = built.note});
}

void bench_model(const Session& session, const BenchModel& model) {
    show_progress(session.options, "patch_table " + model.name);
    const Setup setup{session.options, session.machines.device(), model, session.report, OsdMesh(model.mesh)};
    verify(setup);
    const Built osd = measure_osd(setup, kLevel), deep = measure_osd(setup, kDeepLevel);
    const auto add_task = [&](const char* task, const Built& limn) {
        add_row(setup, task, "limn", Side::limn, limn);
        add_row(setup, task, "osd_far_level3", Side::peer, osd);
        add_row(setup, task, "osd_far_level6", Side::peer, deep);
    };
    const auto add_upload = [&](const char* task, const PlanCache* cache) {
        add_row(setup, task, "limn", Side::limn, {measure_upload(setup, cache), "built and uploaded"});
    };
    add_task("cold", measure_limn(setup, nullptr));
    add_upload("cold_upload", nullptr);
    const PlanCache cache;
    build(setup, &cache);
    add_task("warm", measure_limn(setup, &cache));
    add_upload("warm_upload", &cache);
}

}  // namespace

void bench_patch_table(const Session& session) {
    for (const BenchModel& model : session.models) bench_model(session, model);
}

}  // namespace limn::bench
