// Tessellation of the limit surface, from control points to vertices with normals, triangles and the draw
// command, in one command buffer: how long each pass takes, at uniform rates and at an error. The peer, at
// uniform rates, is OpenSubdiv's Bfr on all cores of the host, whose faces share no vertices.
#include <cmath>
#include <memory>

#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "osd_bfr.h"
#include "session.h"
#include "timestamps.h"

namespace limn::bench {
namespace {

using vk::Buffer;

constexpr uint32_t kRates[] = {2, 4, 8, 16, 32};
constexpr uint32_t kMaxTriangles = 11'000'000;  // of one frame here: what 32-bit floats of 128 MiB hold
constexpr const char* kPasses[] = {"points", "rates", "triangles", "vertices"};

struct Setup {
    const Options& options;
    const Machines& machines;
    const vk::SurfaceEvaluator& surfaces;
    const vk::Tessellator& tessellator;
    const BenchModel& model;
    Report& report;
    PatchTable patches;
    TessellationTable table;
    std::vector<double> points;
};

/// One tessellation, ready to run. Members are destroyed in reverse: commands before what they refer to.
struct Frame {
    explicit Frame(const vk::Device& device) : timestamps(device, 6) {}
    vk::DevicePatchTable patches;
    vk::DeviceTessellationTable table;
    Buffer points, vertices, indices, command, result;
    std::optional<vk::StencilEvaluation> refined;
    std::optional<vk::Tessellation> tessellation;
    Timestamps timestamps;
    std::optional<vk::Commands> commands;
};

Buffer create(const Setup& s, uint64_t bytes) {
    return value_or_fail(
        s.options, vk::create_buffer(s.machines.device(), bytes, vk::kPointUsage, vk::MemoryUse::device));
}

std::unique_ptr<Frame> make_frame(const Setup& s, const RateSettings& settings,
                                  const Tessellation& expected) {
    const vk::Device& device = s.machines.device();
    auto frame = std::make_unique<Frame>(device);
    Frame& f = *frame;
    const auto trees =
        value_or_fail(s.options, build_patch_trees(s.patches, {.max_rate = settings.max_rate}));
    f.patches = value_or_fail(s.options, vk::upload_patch_table(device, s.patches));
    f.table = value_or_fail(s.options, vk::upload_tessellation_table(device, s.table, trees));
    f.points = create(s, uint64_t{12} * s.patches.point_count());
    value_or_fail(s.options,
                  vk::upload_bytes(device, f.points, 0, std::as_bytes(std::span(s.model.positions))));
    // The device rounds a few rates of an error otherwise than the host.
    const auto vertex_capacity = static_cast<uint32_t>(expected.vertex_count() * 1.01 + 1000);
    const auto triangle_capacity =
        static_cast<uint32_t>(static_cast<double>(expected.triangle_faces.size()) * 1.01 + 1000);
    f.vertices = create(s, uint64_t{24} * vertex_capacity);
    f.indices = create(s, uint64_t{12} * triangle_capacity);
    f.command = create(s, 20);
    f.result = create(s, sizeof(vk::TessellationResult));
    f.refined.emplace(value_or_fail(
        s.options,
        s.surfaces.prepare_points({.patches = &f.patches, .points = {.buffer = f.points.handle}})));
    f.tessellation.emplace(
        value_or_fail(s.options, s.tessellator.prepare({.patches = &f.patches,
                                                        .table = &f.table,
                                                        .points = {.buffer = f.points.handle},
                                                        .mode = settings.mode,
                                                        .spacing = settings.spacing,
                                                        .vertex_capacity = vertex_capacity,
                                                        .triangle_capacity = triangle_capacity,
                                                        .fit_capacity = false,
                                                        .positions = {f.vertices.handle, 0, 0, 6},
                                                        .normals = {f.vertices.handle, 0, 3, 6},
                                                        .indices = {f.indices.handle},
                                                        .command = {f.command.handle},
                                                        .result = {f.result.handle}})));
    f.commands.emplace(value_or_fail(s.options, vk::Commands::begin(device)));
    vk::Commands& commands = *f.commands;
    const uint32_t largest = f.tessellation->largest_rate(settings);
    f.timestamps.record_begin(commands);
    f.refined->record(commands);
    vk::record_barrier(device, commands, vk::kKernelWrites, vk::kKernelReads);
    f.tessellation->record_points(commands);
    f.timestamps.record(commands, 1);
    value_or_fail(s.options, f.tessellation->record_rates(commands, settings));
    f.timestamps.record(commands, 2);
    f.tessellation->record_triangles(commands, largest);
    // Passes need no barrier here; this one keeps their times apart.
    vk::record_barrier(device, commands, vk::kKernelWrites, vk::kKernelReads);
    f.timestamps.record(commands, 3);
    f.tessellation->record_vertices(commands, largest);
    vk::record_barrier(device, commands, vk::kKernelWrites, vk::kCopyReads);
    f.timestamps.record(commands, 4);
    f.timestamps.record_end(commands);
    return frame;
}

/// Indices to the bit, vertices within rounding; where rates were rounded by the device, counts to a
/// hundredth.
std::string find_fault(const Setup& s, const Frame& f, const Tessellation& expected, bool exact) {
    const vk::Device& device = s.machines.device();
    const auto result =
        value_or_fail(s.options, vk::download<vk::TessellationResult>(device, f.result, 1))[0];
    if (result.status != vk::TessellationStatus::complete) return "the device drew nothing";
    if (!exact) {
        const double ratio =
            static_cast<double>(result.triangle_count) / static_cast<double>(expected.triangle_faces.size());
        return std::abs(ratio - 1) < 0.01 ? "" : "the device has another number of triangles";
    }
    if (result.vertex_count != expected.vertex_count()) return "the device has another number of vertices";
    const auto indices =
        value_or_fail(s.options, vk::download<uint32_t>(device, f.indices, expected.indices.size()));
    if (indices != expected.indices) return "an index differs";
    const auto vertices =
        value_or_fail(s.options, vk::download<float>(device, f.vertices, 6 * expected.places.size()));
    std::vector<double> positions(3 * expected.places.size());
    evaluate_tessellation(s.patches, expected, s.points, positions, {});
    const double tolerance = tolerance_for(s.model.positions).in_float;
    for (size_t i = 0; i < expected.places.size(); ++i)
        for (size_t k = 0; k < 3; ++k)
            if (!(std::abs(vertices[6 * i + k] - positions[3 * i + k]) <= tolerance))
                return "a position is off";
    return "";
}

/// The peer, at a uniform rate.
void bench_bfr(const Setup& s, Row row, uint32_t rate) {
    const auto bfr = BfrTessellation::create(OsdMesh(s.model.mesh), rate);
    if (bfr == nullptr) return;
    row.evaluator = "osd_bfr";
    row.side = Side::peer;
    row.timing = measure(s.options, [&] {
        bfr->run(s.model.positions);
        return true;
    });
    row.items = static_cast<double>(bfr->indices.size() / 3);
    row.note = "no vertices shared by faces";
    s.report.add(row);
}

void bench_settings(const Setup& s, const char* parameter, double value, const RateSettings& settings) {
    const auto rates = value_or_fail(s.options, compute_rates(s.patches, s.table, settings, s.points));
    const auto expected = value_or_fail(s.options, tessellate(s.table, rates, settings.spacing));
    const auto triangles = static_cast<double>(expected.triangle_faces.size());
    Row row{.scenario = "tessellate",
            .model = s.model.name,
            .faces = s.model.mesh.face_count(),
            .parameters = {{parameter, value}},
            .evaluator = "limn",
            .items = triangles,
            .unit = "triangles"};
    if (triangles > kMaxTriangles) {
        row.note = "left out: more than a buffer here holds";
        s.report.add(row);
        return;
    }
    const auto frame = make_frame(s, settings, expected);
    const Frame& f = *frame;
    value_or_fail(s.options, frame->commands->submit_and_wait());
    if (const std::string fault = find_fault(s, f, expected, settings.mode == RateMode::uniform);
        !fault.empty())
        fail(s.options, {ErrorCode::invalid_argument, row_name(row) + ": " + fault});
    std::vector<double> passes[4], totals;
    row.timing = measure(s.options, [&] {
        if (!frame->commands->submit_and_wait()) return false;
        if (!f.timestamps.available()) return true;
        totals.push_back(f.timestamps.milliseconds());
        for (uint32_t p = 0; p < 4; ++p) passes[p].push_back(f.timestamps.milliseconds(p, p + 1));
        return true;
    });
    if (f.timestamps.available()) row.device = timing_of(totals);
    row.bytes = 24.0 * expected.vertex_count() + 12 * triangles + 12.0 * s.patches.point_count();
    row.copy_rate = s.machines.copy.device;
    row.note = std::to_string(expected.places.size()) + " vertices";
    for (uint32_t p = 0; p < 4 && f.timestamps.available(); ++p)
        row.note += format(", %s %.2f ms", kPasses[p], timing_of(passes[p]).median);
    s.report.add(row);
    if (settings.mode == RateMode::uniform) {
        const Row peer{.scenario = row.scenario,
                       .model = row.model,
                       .faces = row.faces,
                       .parameters = row.parameters,
                       .unit = row.unit};
        bench_bfr(s, peer, static_cast<uint32_t>(settings.value));
    }
}

void bench_model(const Session& session, const vk::SurfaceEvaluator& surfaces,
                 const vk::Tessellator& tessellator, const BenchModel& model) {
    const Options& options = session.options;
    show_progress(options, "tessellate " + model.name);
    Setup s{options,
            session.machines,
            surfaces,
            tessellator,
            model,
            session.report,
            value_or_fail(options, build_patch_table<float>(model.mesh, {})),
            value_or_fail(options, build_tessellation_table(model.mesh, {})),
            {}};
    s.points.resize(size_t{3} * s.patches.point_count());
    build_patch_points<float>(s.patches, std::vector<double>(model.positions.begin(), model.positions.end()),
                              3, s.points);
    for (const uint32_t rate : kRates)
        bench_settings(s, "rate", rate, {.value = static_cast<float>(rate), .max_rate = rate});
    const double size = tolerance_for(model.positions).size;
    for (const double chord : {1e-4, 1e-5})
        bench_settings(s, "chord", chord,
                       {.mode = RateMode::chord_error, .value = static_cast<float>(chord * size)});
}

}  // namespace

void bench_tessellate(const Session& session) {
    const vk::Device& device = session.machines.device();
    const auto surfaces = value_or_fail(session.options, vk::SurfaceEvaluator::create(device));
    const auto tessellator = value_or_fail(session.options, vk::Tessellator::create(device));
    for (const BenchModel& model : session.models) bench_model(session, surfaces, tessellator, model);
}

}  // namespace limn::bench
