// A crowd of different meshes in which one goes and another comes: tables changed in place and what of them
// changed copied to the device, beside tables merged and uploaded anew. Then a frame of both, after many
// changes. A frame is level-1 points and a tessellation.
#include <cstring>
#include <ctime>
#include <memory>

#include "limn/batch_list.h"
#include "limn/parallel.h"
#include "limn/vulkan/crowd_tables.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "session.h"
#include "timestamps.h"

namespace limn::bench {
namespace {

constexpr uint32_t kRate = 4;
constexpr PatchTreeOptions kTrees = {.max_rate = kRate};

struct Member {
    PatchTable patches;
    TessellationTable topology;
    std::vector<float> positions;
    BatchMesh tables() const { return {&patches, &topology}; }
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

/// As crowd_bench makes them.
std::vector<Member> make_members(const Options& options, uint32_t count) {
    std::vector<Member> members(count);
    const PlanCache cache;
    for_each_index(
        count,
        [&](uint32_t i) {
            const auto around = static_cast<uint32_t>(16 + 12 * noise(3 * i));
            const auto across = static_cast<uint32_t>(10 + 17 * noise(3 * i + 1));
            const BenchModel model = make_random_torus(around, across, i + 1);
            members[i] = {value_or_fail(options, build_patch_table<float>(model.mesh, {}, &cache)),
                          value_or_fail(options, build_tessellation_table(model.mesh, {})), model.positions};
        },
        1);
    return members;
}

/// Which member each instance is, and who waits outside.
struct Cast {
    std::vector<uint32_t> instances, members;  ///< who is there: numbers of both
    std::vector<uint32_t> waiting;
    uint64_t next_random = 1'000'000;

    uint32_t below(size_t count) {
        return static_cast<uint32_t>(noise(next_random++) * static_cast<double>(count));
    }
};

/// One goes, another comes.
void replace(const Options& options, const std::vector<Member>& members, Crowd& crowd, Cast& cast) {
    const uint32_t at = cast.below(cast.instances.size());
    uint32_t& comes = cast.waiting[cast.below(cast.waiting.size())];
    value_or_fail(options, crowd.remove(cast.instances[at]));
    cast.instances[at] = value_or_fail(options, crowd.add(members[comes].tables()));
    std::swap(cast.members[at], comes);
}

/// Points, and what a frame writes.
struct Frame {
    explicit Frame(const vk::Device& device) : timestamps(device, 2) {}
    vk::Buffer points, positions, normals, indices, command, commands_of_instances, result;
    std::optional<vk::StencilEvaluation> refined;
    std::optional<vk::Tessellation> tessellation;
    Timestamps timestamps;
    std::optional<vk::Commands> commands;
    std::vector<double> totals, processor;
};

std::unique_ptr<Frame> make_frame(const Bench& bench, const vk::DevicePatchTable& patches,
                                  const vk::DeviceTessellationTable& table, const TessellationTable& topology,
                                  const std::vector<float>& positions) {
    const Options& options = bench.options;
    auto frame = std::make_unique<Frame>(bench.device);
    Frame& f = *frame;
    const std::vector<uint32_t> rates(topology.rate_edge_count, kRate * shared::kRateOne);
    const TessellationCounts counts = count_tessellation(topology, rates, TessellationSpacing::integer);
    f.points = bench.create(uint64_t{12} * patches.point_count);
    value_or_fail(options, vk::upload_bytes(bench.device, f.points, 0, std::as_bytes(std::span(positions))));
    f.positions = bench.create(12 * counts.vertices);
    f.normals = bench.create(12 * counts.vertices);
    f.indices = bench.create(12 * counts.triangles);
    f.command = bench.create(20);
    f.commands_of_instances = bench.create(uint64_t{20} * table.instance_count);
    f.result = bench.create(sizeof(vk::TessellationResult));
    const vk::PointBuffer points = {.buffer = f.points.handle};
    f.refined.emplace(
        value_or_fail(options, bench.evaluator.prepare_points({.patches = &patches, .points = points})));
    f.tessellation.emplace(value_or_fail(
        options, bench.tessellator.prepare({.patches = &patches,
                                            .table = &table,
                                            .points = points,
                                            .vertex_capacity = static_cast<uint32_t>(counts.vertices),
                                            .triangle_capacity = static_cast<uint32_t>(counts.triangles),
                                            .fit_capacity = false,
                                            .positions = {f.positions.handle},
                                            .normals = {f.normals.handle},
                                            .indices = {f.indices.handle},
                                            .command = {f.command.handle},
                                            .instance_commands = {f.commands_of_instances.handle},
                                            .result = {f.result.handle}})));
    f.commands.emplace(value_or_fail(options, vk::Commands::begin(bench.device)));
    vk::Commands& commands = *f.commands;
    f.timestamps.record_begin(commands);
    f.refined->record(commands);
    vk::record_barrier(bench.device, commands, vk::kKernelWrites, vk::kKernelReads);
    value_or_fail(options, f.tessellation->record(commands, {.value = kRate, .max_rate = kRate}));
    f.timestamps.record_end(commands);
    return frame;
}

/// Times by the clock, and by what the processors did: of a CPU device that is all, and other programs
/// disturb it less.
void run(const Bench& bench, Frame& f) {
    const double begin = milliseconds_now();
    const std::clock_t processor = std::clock();
    value_or_fail(bench.options, f.commands->submit_and_wait());
    f.processor.push_back(1e3 * static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
    f.totals.push_back(milliseconds_now() - begin);
}

/// What was drawn, instance by instance.
struct Drawn {
    vk::TessellationResult result;
    std::vector<uint32_t> commands, indices;
    std::vector<float> positions;
};
Drawn read(const Bench& bench, const Frame& f, uint32_t instance_count) {
    Drawn out;
    const Options& options = bench.options;
    out.result = value_or_fail(options, vk::download<vk::TessellationResult>(bench.device, f.result, 1))[0];
    out.commands = value_or_fail(
        options, vk::download<uint32_t>(bench.device, f.commands_of_instances, 5 * size_t{instance_count}));
    out.indices = value_or_fail(
        options, vk::download<uint32_t>(bench.device, f.indices, 3 * size_t{out.result.triangle_count}));
    out.positions = value_or_fail(
        options, vk::download<float>(bench.device, f.positions, 3 * size_t{out.result.vertex_count}));
    return out;
}

/// Each instance has the same triangles in both, with positions of the same bits.
void check(const Bench& bench, const Drawn& a, const std::vector<uint32_t>& a_numbers, const Drawn& b) {
    const auto differ = [&](const char* what) {
        fail(bench.options, {ErrorCode::invalid_argument,
                             std::string("a changed crowd and a merged one differ in ") + what});
    };
    if (a.result.status != vk::TessellationStatus::complete ||
        b.result.status != vk::TessellationStatus::complete)
        differ("what was drawn");
    if (a.result.triangle_count != b.result.triangle_count) differ("triangles");
    for (size_t i = 0; i < a_numbers.size(); ++i) {
        const uint32_t* own = &a.commands[5 * size_t{a_numbers[i]}];
        const uint32_t* other = &b.commands[5 * i];
        if (own[0] != other[0]) differ("triangles of an instance");
        for (uint32_t k = 0; k < own[0]; ++k)
            if (std::memcmp(&a.positions[3 * size_t{a.indices[own[2] + k]}],
                            &b.positions[3 * size_t{b.indices[other[2] + k]}], 12) != 0)
                differ("positions");
    }
}

struct ChangeBench {
    const Bench& bench;
    Report& report;
    uint32_t count;  ///< of instances
    std::vector<Member> members = {};
    Crowd crowd{{.max_rate = kRate}};
    Cast cast = {};
    vk::DeviceCrowd tables = {};
    uint64_t faces = 0;

    Row row(const char* task, const char* evaluator, const Timing& timing, std::string note) const {
        return {.scenario = "crowd_change",
                .model = "crowd",
                .parameters = {{"meshes", count}},
                .task = task,
                .evaluator = evaluator,
                .timing = timing,
                .items = static_cast<double>(faces),
                .unit = "faces",
                .note = std::move(note)};
    }
    void build();
    uint64_t update();
    void measure_in_place();
    void measure_anew();
    void compare_frames(const char* task, const std::string& what);
    void change_many();
    void remove_half();
};

void ChangeBench::build() {
    members = make_members(bench.options, count + count / 5);
    std::vector<BatchMesh> first;
    for (uint32_t i = 0; i < members.size(); ++i) {
        if (i >= count) {
            cast.waiting.push_back(i);
            continue;
        }
        first.push_back(members[i].tables());
        cast.members.push_back(i);
        faces += members[i].topology.face_count;
    }
    const auto lay_out = [&] {
        Crowd fresh({.max_rate = kRate});
        cast.instances = value_or_fail(bench.options, fresh.add(first));
        crowd = std::move(fresh);
        return true;
    };
    const Timing built = measure(bench.options, lay_out);
    report.add(row("build", "limn", built, "all instances, " + megabytes(crowd.bytes())));
    update();
}

/// Bytes.
uint64_t ChangeBench::update() {
    vk::Commands commands = value_or_fail(bench.options, vk::Commands::begin(bench.device));
    const auto updated =
        value_or_fail(bench.options, vk::record_crowd_update(bench.device, commands, crowd, tables));
    value_or_fail(bench.options, commands.submit_and_wait());
    crowd.forget_changes();
    return updated.copied_bytes;
}

void ChangeBench::measure_in_place() {
    const uint64_t layout = crowd.layout();
    const auto change = [&] { return replace(bench.options, members, crowd, cast), true; };
    const Timing changed =
        measure(bench.options, change, [&] { update(); }, {.min = 20, .max = 500, .seconds = 2});
    uint64_t bytes = 0, updates = 0;
    const auto upload = [&] { return bytes += update(), ++updates, true; };
    const auto change_first = [&] { update(), change(); };
    const Timing uploaded =
        measure(bench.options, upload, change_first, {.min = 20, .max = 500, .seconds = 2});
    Row upload_row =
        row("upload", "limn", uploaded, megabytes(bytes / updates) + " of " + megabytes(tables.bytes()));
    upload_row.bytes = static_cast<double>(bytes) / static_cast<double>(updates);
    report.add(
        row("change", "limn", changed, std::to_string(crowd.layout() - layout) + " times laid out anew"));
    report.add(upload_row);
}

void ChangeBench::measure_anew() {
    BatchList list;
    for (const uint32_t member : cast.members)
        value_or_fail(bench.options, list.add_instance(list.add_mesh(members[member].tables())));
    uint32_t oldest = 0;
    MergedBatch merged;
    const auto merge = [&] { return merged = value_or_fail(bench.options, list.merge(kTrees)), true; };
    const auto change = [&] {
        merged = {};
        value_or_fail(bench.options, list.remove_instance(oldest));
        value_or_fail(bench.options, list.add_instance(oldest++ % count));
    };
    report.add(row("change", "limn_anew", measure(bench.options, merge, change), "merged anew, trees kept"));
    const auto upload = [&] {
        value_or_fail(bench.options, vk::upload_patch_table(bench.device, merged.patches));
        value_or_fail(bench.options,
                      vk::upload_tessellation_table(bench.device, merged.topology, merged.trees));
        return true;
    };
    const uint64_t bytes = merged.patches.bytes() + merged.topology.bytes() + merged.trees.bytes();
    report.add(row("upload", "limn_anew", measure(bench.options, upload), megabytes(bytes) + ", all of it"));
}

/// Of what is there now, in place and merged afresh: compared to the bit, then timed in turn.
void ChangeBench::compare_frames(const char* task, const std::string& what) {
    update();
    std::vector<const PatchTable*> patches;
    std::vector<const TessellationTable*> topologies;
    std::vector<float> positions(size_t{3} * crowd.patches().control_count), merged_positions;
    for (size_t i = 0; i < cast.instances.size(); ++i) {
        const Member& member = members[cast.members[i]];
        patches.push_back(&member.patches);
        topologies.push_back(&member.topology);
        merged_positions.insert(merged_positions.end(), member.positions.begin(), member.positions.end());
        std::copy(member.positions.begin(), member.positions.end(),
                  positions.data() + 3 * size_t{crowd.find(cast.instances[i])->patches.control_points.first});
    }
    const PatchTable merged = value_or_fail(bench.options, merge_patch_tables<float>(patches)).table;
    const TessellationTable topology =
        value_or_fail(bench.options, merge_tessellation_tables(topologies)).table;
    const PatchTreeTable trees = value_or_fail(bench.options, build_patch_trees(merged, kTrees));
    const auto device_patches = value_or_fail(bench.options, vk::upload_patch_table(bench.device, merged));
    const auto device_topology =
        value_or_fail(bench.options, vk::upload_tessellation_table(bench.device, topology, trees));
    const auto own = make_frame(bench, tables.patches, tables.topology, crowd.topology(), positions);
    const auto fresh = make_frame(bench, device_patches, device_topology, topology, merged_positions);
    run(bench, *own);
    run(bench, *fresh);
    check(bench, read(bench, *own, crowd.instance_capacity()), cast.instances,
          read(bench, *fresh, static_cast<uint32_t>(cast.instances.size())));
    for (Frame* frame : {&*own, &*fresh}) {
        frame->totals.clear();
        frame->processor.clear();
    }
    const double begin = milliseconds_now();
    for (uint32_t i = 0;
         i < (bench.options.quick ? 1u : 9u) && (i < 3 || milliseconds_now() - begin < 40'000); ++i) {
        run(bench, *own);
        run(bench, *fresh);
    }
    faces = topology.face_count;
    const Timing own_time = timing_of(own->totals), fresh_time = timing_of(fresh->totals);
    report.add(row(task, "limn", own_time,
                   what + ", " + std::to_string(crowd.topology().face_count) + " slots of faces"));
    report.add(row(task, "limn_anew", fresh_time, "the same instances, merged"));
    report.add_finding(
        format("a crowd of %u meshes, %s: %.3f times the frame of the same merged anew, %.3f by processor "
               "time, least",
               count, what.c_str(), own_time.min / fresh_time.min,
               timing_of(own->processor).min / timing_of(fresh->processor).min));
}

void ChangeBench::change_many() {
    const uint32_t changes = bench.options.quick ? 50 : 1000;
    for (uint32_t i = 0; i < changes; ++i) replace(bench.options, members, crowd, cast);
    compare_frames("frame", "after " + std::to_string(changes) + " changes in place");
}

/// What those cost that are gone.
void ChangeBench::remove_half() {
    for (uint32_t i = 0; i < count / 2; ++i) {
        const uint32_t at = cast.below(cast.instances.size());
        value_or_fail(bench.options, crowd.remove(cast.instances[at]));
        cast.instances.erase(cast.instances.begin() + at);
        cast.members.erase(cast.members.begin() + at);
    }
    compare_frames("frame_half", "half of which are gone");
    value_or_fail(bench.options, crowd.compact());
    compare_frames("frame_compact", "half of which are gone, compact");
}

}  // namespace

void bench_crowd_change(const Session& session) {
    const Options& options = session.options;
    const auto evaluator = value_or_fail(options, vk::SurfaceEvaluator::create(session.machines.device()));
    const auto tessellator = value_or_fail(options, vk::Tessellator::create(session.machines.device()));
    const Bench bench{options, session.machines.device(), evaluator, tessellator};
    for (const uint32_t count : {100u, 1000u}) {
        if (options.quick && count != 100) continue;
        show_progress(options, "crowd of " + std::to_string(count));
        ChangeBench change{.bench = bench, .report = session.report, .count = count};
        change.build();
        change.measure_in_place();
        change.measure_anew();
        change.change_many();
        if (count == 100) change.remove_half();
    }
}

}  // namespace limn::bench
