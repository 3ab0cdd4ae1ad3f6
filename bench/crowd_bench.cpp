// A crowd of different meshes, merged and evaluated in one set of dispatches, beside one mesh of as many
// faces of the same kind: what being many costs. A frame is level-1 points, a grid of points and normals on
// each face, and a tessellation.
#include <cmath>
#include <cstdio>
#include <memory>

#include "limn/batch.h"
#include "limn/parallel.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "session.h"
#include "timestamps.h"

namespace limn::bench {
namespace {

constexpr uint32_t kGridRate = 7, kTessellationRate = 4;
constexpr const char* kPasses[] = {"points", "grid", "local points", "rates", "triangles", "vertices"};
constexpr uint32_t kPassCount = 6;

/// What is drawn: the tables and control points of one mesh, or of a whole crowd.
struct Surfaces {
    PatchTable patches;
    TessellationTable topology;
    std::vector<float> positions;
};

struct Bench {
    const Options& options;
    const vk::Device& device;
    const vk::SurfaceEvaluator& evaluator;
    const vk::Tessellator& tessellator;

    vk::Buffer create(uint64_t bytes) const {
        return value_or_fail(options,
                             vk::create_buffer(device, bytes, vk::kPointUsage, vk::MemoryUse::device));
    }
};

/// What frames write, one after the other.
struct Outputs {
    vk::Buffer grid, positions, normals, indices, command, result;
    uint32_t vertex_capacity, triangle_capacity;
};

/// Members are destroyed in reverse: commands before what they refer to.
struct Frame {
    explicit Frame(const vk::Device& device) : timestamps(device, kPassCount + 1) {}
    vk::DevicePatchTable patches;
    vk::DeviceGridTable grid_table;
    vk::DeviceTessellationTable topology;
    vk::Buffer points;
    std::optional<vk::StencilEvaluation> refined;
    std::optional<vk::SurfaceEvaluation> grid;
    std::optional<vk::Tessellation> tessellation;
    Timestamps timestamps;
    std::optional<vk::Commands> commands;
    std::vector<double> passes[kPassCount], totals;
};

std::vector<BenchModel> make_crowd(uint32_t count) {
    std::vector<BenchModel> models(count);
    for_each_index(
        count,
        [&](uint32_t i) {
            const auto around = static_cast<uint32_t>(16 + 12 * noise(3 * i));
            const auto across = static_cast<uint32_t>(10 + 17 * noise(3 * i + 1));
            models[i] = make_random_torus(around, across, i + 1);
        },
        1);
    return models;
}

Row row_of(uint32_t count, const char* model, const char* task, const char* evaluator) {
    return {.scenario = "crowd",
            .model = model,
            .parameters = {{"meshes", count}},
            .task = task,
            .evaluator = evaluator,
            .unit = "faces"};
}

/// Tables of all meshes, built in parallel by way of one cache, and merged.
Surfaces merge_crowd(const Bench& bench, const std::vector<BenchModel>& models, Report& report) {
    const auto count = static_cast<uint32_t>(models.size());
    std::vector<PatchTable> patches(count);
    std::vector<TessellationTable> topologies(count);
    const PlanCache cache;
    const auto build = [&] {
        for_each_index(
            count,
            [&](uint32_t i) {
                patches[i] =
                    value_or_fail(bench.options, build_patch_table<float>(models[i].mesh, {}, &cache));
                topologies[i] = value_or_fail(bench.options, build_tessellation_table(models[i].mesh, {}));
            },
            1);
        return true;
    };
    const Timing built = measure(bench.options, build);
    Surfaces out;
    std::vector<const PatchTable*> patch_tables;
    std::vector<const TessellationTable*> tessellation_tables;
    uint64_t plans = 0, bytes = 0;
    for (uint32_t i = 0; i < count; ++i) {
        patch_tables.push_back(&patches[i]);
        tessellation_tables.push_back(&topologies[i]);
        plans += patches[i].plans.size();
        bytes += patches[i].bytes() + topologies[i].bytes();
        out.positions.insert(out.positions.end(), models[i].positions.begin(), models[i].positions.end());
    }
    const auto free_merged = [&] { out.patches = {}, out.topology = {}; };
    const Timing merged = measure(
        bench.options,
        [&] {
            out.patches = value_or_fail(bench.options, merge_patch_tables<float>(patch_tables)).table;
            out.topology = value_or_fail(bench.options, merge_tessellation_tables(tessellation_tables)).table;
            return true;
        },
        free_merged);
    Row build_row = row_of(count, "crowd", "build", "limn"), merge_row = row_of(count, "crowd", "merge", "limn");
    build_row.timing = built;
    merge_row.timing = merged;
    build_row.items = merge_row.items = out.topology.face_count;
    build_row.note = "all cores, a warm cache";
    merge_row.bytes = static_cast<double>(bytes + out.patches.bytes() + out.topology.bytes());
    merge_row.note = std::to_string(plans) + " plans become " + std::to_string(out.patches.plans.size());
    report.add(build_row);
    report.add(merge_row);
    return out;
}

Surfaces build_one(const Bench& bench, const BenchModel& model) {
    return {value_or_fail(bench.options, build_patch_table<float>(model.mesh, {})),
            value_or_fail(bench.options, build_tessellation_table(model.mesh, {})), model.positions};
}

Outputs make_outputs(const Bench& bench, const std::vector<const Surfaces*>& surfaces) {
    Outputs out = {};
    uint64_t faces = 0, vertices = 0, triangles = 0;
    for (const Surfaces* s : surfaces) {
        const std::vector<uint32_t> rates(s->topology.rate_edge_count, kTessellationRate * shared::kRateOne);
        const TessellationCounts counts =
            count_tessellation(s->topology, rates, TessellationSpacing::integer);
        faces = std::max<uint64_t>(faces, s->topology.face_count);
        vertices = std::max(vertices, counts.vertices);
        triangles = std::max(triangles, counts.triangles);
    }
    out.grid = bench.create(24 * faces * (kGridRate + 1) * (kGridRate + 1));
    out.positions = bench.create(12 * vertices);
    out.normals = bench.create(12 * vertices);
    out.indices = bench.create(12 * triangles);
    out.command = bench.create(20);
    out.result = bench.create(sizeof(vk::TessellationResult));
    out.vertex_capacity = static_cast<uint32_t>(vertices);
    out.triangle_capacity = static_cast<uint32_t>(triangles);
    return out;
}

void record(const Bench& bench, Frame& f) {
    f.commands.emplace(value_or_fail(bench.options, vk::Commands::begin(bench.device)));
    vk::Commands& commands = *f.commands;
    uint32_t pass = 0;
    const auto end_pass = [&] {
        vk::record_barrier(bench.device, commands, vk::kKernelWrites, vk::kKernelReads);
        if (++pass < kPassCount) f.timestamps.record(commands, pass);
    };
    f.timestamps.record_begin(commands);
    f.refined->record(commands);
    end_pass();
    f.grid->record(commands);
    end_pass();
    f.tessellation->record_points(commands);
    end_pass();
    value_or_fail(bench.options, f.tessellation->record_rates(
                                     commands, {.value = kTessellationRate, .max_rate = kTessellationRate}));
    end_pass();
    f.tessellation->record_triangles(commands, kTessellationRate);
    end_pass();
    f.tessellation->record_vertices(commands, kTessellationRate);
    end_pass();
    f.timestamps.record_end(commands);
}

std::unique_ptr<Frame> make_frame(const Bench& bench, const Surfaces& surfaces, const Outputs& outputs) {
    const Options& options = bench.options;
    auto frame = std::make_unique<Frame>(bench.device);
    Frame& f = *frame;
    const auto grid = value_or_fail(options, build_grid_table(surfaces.patches, {.rate = kGridRate}));
    const auto trees =
        value_or_fail(options, build_patch_trees(surfaces.patches, {.max_rate = kTessellationRate}));
    f.patches = value_or_fail(options, vk::upload_patch_table(bench.device, surfaces.patches));
    f.grid_table = value_or_fail(options, vk::upload_grid_table(bench.device, grid));
    f.topology =
        value_or_fail(options, vk::upload_tessellation_table(bench.device, surfaces.topology, trees));
    f.points = bench.create(uint64_t{12} * surfaces.patches.point_count());
    value_or_fail(options,
                  vk::upload_bytes(bench.device, f.points, 0, std::as_bytes(std::span(surfaces.positions))));
    const vk::PointBuffer points = {.buffer = f.points.handle};
    f.refined.emplace(
        value_or_fail(options, bench.evaluator.prepare_points({.patches = &f.patches, .points = points})));
    f.grid.emplace(
        value_or_fail(options, bench.evaluator.prepare_grid({.patches = &f.patches,
                                                             .grid = &f.grid_table,
                                                             .points = points,
                                                             .values = {outputs.grid.handle, 0, 0, 6},
                                                             .normals = {outputs.grid.handle, 0, 3, 6}})));
    f.tessellation.emplace(
        value_or_fail(options, bench.tessellator.prepare({.patches = &f.patches,
                                                          .table = &f.topology,
                                                          .points = points,
                                                          .vertex_capacity = outputs.vertex_capacity,
                                                          .triangle_capacity = outputs.triangle_capacity,
                                                          .fit_capacity = false,
                                                          .positions = {outputs.positions.handle},
                                                          .normals = {outputs.normals.handle},
                                                          .indices = {outputs.indices.handle},
                                                          .command = {outputs.command.handle},
                                                          .result = {outputs.result.handle}})));
    record(bench, f);
    return frame;
}

/// Milliseconds of a frame; 0 where it failed.
double run(Frame& f) {
    const double begin = milliseconds_now();
    if (!f.commands->submit_and_wait()) return 0;
    const double total = milliseconds_now() - begin;
    f.totals.push_back(total);
    for (uint32_t p = 0; p < kPassCount && f.timestamps.available(); ++p)
        f.passes[p].push_back(f.timestamps.milliseconds(p, p + 1));
    return total;
}

std::string describe(const Frame& f) {
    std::string text = std::to_string(f.refined->dispatch_count()) + " + " +
                       std::to_string(f.grid->dispatch_count()) + " dispatches";
    for (uint32_t p = 0; p < kPassCount && f.timestamps.available(); ++p) {
        char pass[64];
        std::snprintf(pass, sizeof pass, ", %s %.1f ms", kPasses[p], timing_of(f.passes[p]).min);
        text += pass;
    }
    return text;
}

/// What both wrote: a mesh alone is compared with the crowd by tests.
void check_drawn(const Bench& bench, const Outputs& outputs, const char* what) {
    const auto result = value_or_fail(
        bench.options, vk::download<vk::TessellationResult>(bench.device, outputs.result, 1))[0];
    if (result.status != vk::TessellationStatus::complete)
        fail(bench.options, {ErrorCode::invalid_argument, std::string(what) + " was not drawn"});
}

/// Frames in turn, so that what else the machine does hits both.
void compare(const Bench& bench, const Surfaces& crowd, const Surfaces& one, uint32_t count, const char* model,
             Report& report) {
    const Outputs outputs = make_outputs(bench, {&crowd, &one});
    const auto crowd_frame = make_frame(bench, crowd, outputs), one_frame = make_frame(bench, one, outputs);
    run(*crowd_frame);
    check_drawn(bench, outputs, "the crowd");
    run(*one_frame);
    check_drawn(bench, outputs, "the one mesh");
    for (Frame* frame : {&*crowd_frame, &*one_frame}) {
        frame->totals.clear();
        for (std::vector<double>& pass : frame->passes) pass.clear();
    }
    // A CPU device takes seconds for a frame of a thousand meshes.
    const uint32_t least = bench.options.quick ? 1 : 2, most = bench.options.quick ? 1 : 9;
    const double begin = milliseconds_now();
    for (uint32_t i = 0; i < least || (i < most && milliseconds_now() - begin < 20'000); ++i)
        if (run(*crowd_frame) == 0 || run(*one_frame) == 0)
            fail(bench.options, {ErrorCode::vulkan_failure, "a frame failed"});
    const Timing crowd_time = timing_of(crowd_frame->totals), one_time = timing_of(one_frame->totals);
    Row crowd_row = row_of(count, model, "frame", "limn"), one_row = row_of(count, model, "frame", "limn_one_mesh");
    crowd_row.timing = crowd_time;
    one_row.timing = one_time;
    crowd_row.items = crowd.topology.face_count;
    one_row.items = one.topology.face_count;
    crowd_row.note = describe(*crowd_frame);
    one_row.note = describe(*one_frame);
    report.add(crowd_row);
    report.add(one_row);
    report.add_finding(format("%s of %u meshes: %.2f times the time per face of one mesh as large, medians", model, count,
                              crowd_time.median / one_time.median * one.topology.face_count / crowd.topology.face_count));
}

/// Many instances of one mesh, each with points of its own.
Surfaces merge_instances(const Bench& bench, const BenchModel& model, uint32_t count) {
    const auto patches = value_or_fail(bench.options, build_patch_table<float>(model.mesh, {}));
    const auto topology = value_or_fail(bench.options, build_tessellation_table(model.mesh, {}));
    const std::vector<const PatchTable*> patch_tables(count, &patches);
    const std::vector<const TessellationTable*> topologies(count, &topology);
    Surfaces out{value_or_fail(bench.options, merge_patch_tables<float>(patch_tables)).table,
                 value_or_fail(bench.options, merge_tessellation_tables(topologies)).table,
                 {}};
    for (uint32_t i = 0; i < count; ++i)
        out.positions.insert(out.positions.end(), model.positions.begin(), model.positions.end());
    return out;
}

/// As many faces, and as many around its tube as makes it no stranger than the small ones.
Surfaces build_as_large(const Bench& bench, const Surfaces& crowd, uint32_t count) {
    const auto across = static_cast<uint32_t>(18.5 * std::sqrt(count));
    const auto around = static_cast<uint32_t>(crowd.topology.face_count / (1.0 + 4.0 / 13) / across);
    return build_one(bench, make_random_torus(around, across, 1));
}

}  // namespace

/// Meshes of 200 to 1,000 faces.
void bench_crowd(const Session& session) {
    const Options& options = session.options;
    const auto evaluator = value_or_fail(options, vk::SurfaceEvaluator::create(session.machines.device()));
    const auto tessellator = value_or_fail(options, vk::Tessellator::create(session.machines.device()));
    const Bench bench{options, session.machines.device(), evaluator, tessellator};
    for (const uint32_t count : {100u, 1000u}) {
        if (options.quick && count != 100) continue;
        show_progress(options, "crowd of " + std::to_string(count));
        const Surfaces crowd = merge_crowd(bench, make_crowd(count), session.report);
        compare(bench, crowd, build_as_large(bench, crowd, count), count, "crowd", session.report);
    }
    show_progress(options, "instances");
    const Surfaces instances = merge_instances(bench, make_random_torus(22, 18, 1), 100);
    compare(bench, instances, build_as_large(bench, instances, 100), 100, "instances", session.report);
}

}  // namespace limn::bench
