// A crowd of different meshes, merged and evaluated in one set of dispatches, beside one mesh of as many
// faces of the same kind: what being many costs. A frame is level-1 points, a grid of points and normals on
// each face, and a tessellation.
#include <cmath>
#include <cstdio>
#include <memory>

#include "bench.h"
#include "limn/batch.h"
#include "limn/parallel.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "machines.h"
#include "models.h"
#include "timestamps.h"

namespace limn::bench {
namespace {

constexpr uint32_t kGridRate = 7, kTessellationRate = 8;
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
    const std::string name = "crowd/" + std::to_string(count) + "/";
    const auto faces = static_cast<double>(out.topology.face_count);
    report.add({.name = name + "build", .limn = built, .items = faces, .note = "all cores, a warm cache"});
    report.add({.name = name + "merge",
                .limn = merged,
                .items = faces,
                .bytes = static_cast<double>(bytes + out.patches.bytes() + out.topology.bytes()),
                .note = std::to_string(plans) + " plans become " + std::to_string(out.patches.plans.size())});
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
    f.tessellation->record_triangles(commands);
    end_pass();
    f.tessellation->record_vertices(commands);
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
void compare(const Bench& bench, const Surfaces& crowd, const Surfaces& one, const std::string& name,
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
    const double samples = static_cast<double>(crowd_frame->grid_table.sample_count());
    report.add(
        {.name = name + "frame", .limn = crowd_time, .items = samples, .note = describe(*crowd_frame)});
    report.add({.name = name + "one_mesh",
                .limn = one_time,
                .items = static_cast<double>(one_frame->grid_table.sample_count()),
                .note = describe(*one_frame)});
    char line[160];
    std::snprintf(line, sizeof line, "%sratio per face, of minima: %.3f", name.c_str(),
                  crowd_time.min / one_time.min * one.topology.face_count / crowd.topology.face_count);
    report.add_text(line);
}

}  // namespace

/// `count` meshes of 200 to 1,000 faces.
void bench_crowd(const Options& options, const Machines& machines, Report& report, uint32_t count) {
    const auto evaluator = value_or_fail(options, vk::SurfaceEvaluator::create(machines.device()));
    const auto tessellator = value_or_fail(options, vk::Tessellator::create(machines.device()));
    const Bench bench{options, machines.device(), evaluator, tessellator};
    const Surfaces crowd = merge_crowd(bench, make_crowd(count), report);
    // As many faces, and as many around its tube as makes it no stranger than the small ones.
    const auto across = static_cast<uint32_t>(18.5 * std::sqrt(count));
    const auto around = static_cast<uint32_t>(crowd.topology.face_count / (1.0 + 4.0 / 13) / across);
    const Surfaces one = build_one(bench, make_random_torus(around, across, 1));
    compare(bench, crowd, one, "crowd/" + std::to_string(count) + "/", report);
}

}  // namespace limn::bench

int main(int argc, char** argv) {
    using namespace limn;
    using namespace limn::bench;
    const Options options = parse_options(argc, argv, vk::kAutomaticDevice, vk::kCpuDevice);
    const Machines machines = open_machines(options);
    Report report(options, "crowd", machines.facts(), "faces");
    for (const uint32_t count : {100u, 1000u})
        if (!options.quick || count == 100) bench_crowd(options, machines, report, count);
    value_or_fail(options, report.finish());
    return 0;
}
