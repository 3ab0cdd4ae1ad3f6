// From a file to the first frame: an OBJ file that is parsed, tables built and uploaded, beside a baked one that is
// mapped, checked and uploaded. Pipelines are there before; files are in the page cache.
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "limn/baked_file.h"
#include "limn/file.h"
#include "limn/obj.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "session.h"

namespace limn::bench {
namespace {

constexpr uint32_t kRates[] = {1, 4};

struct Setup {
    const Session& session;
    const vk::SurfaceEvaluator& surfaces;
    const vk::Tessellator& tessellator;
    uint32_t rate;
    vk::TessellationResult expected = {};
    std::vector<uint32_t> vertices = {};  ///< bits of the first frame that was made

    const Options& options() const { return session.options; }
    const vk::Device& device() const { return session.machines.device(); }
};

/// The files of a model, gone with the object.
struct ModelFiles {
    std::string folder, obj, baked;

    ModelFiles(const Options& options, const BenchModel& model);
    ModelFiles(const ModelFiles&) = delete;
    ModelFiles& operator=(const ModelFiles&) = delete;
    ~ModelFiles() {
        std::error_code ignored;
        std::filesystem::remove_all(folder, ignored);
    }
};

/// Faces, and what is sharp.
Result<void> write_model(const std::string& path, const BenchModel& model) {
    auto file = FileWriter::create(path);
    if (!file) return file.error();
    const ControlMesh& mesh = model.mesh;
    for (size_t i = 0; i < model.positions.size(); i += 3) {
        const float* p = &model.positions[i];
        file->append(format("v %.9g %.9g %.9g\n", double{p[0]}, double{p[1]}, double{p[2]}));
    }
    for (uint32_t f = 0; f < mesh.face_count(); ++f) {
        file->append("f");
        for (uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            file->append(format(" %u", mesh.face_vertices[c] + 1));
        file->append("\n");
    }
    for (size_t e = 0; e < mesh.crease_sharpness.size(); ++e)
        file->append(format("t crease 2/1/0 %u %u %.9g\n", mesh.crease_edges[2 * e], mesh.crease_edges[2 * e + 1],
                            double{mesh.crease_sharpness[e]}));
    for (size_t v = 0; v < mesh.corner_vertices.size(); ++v)
        file->append(format("t corner 1/1/0 %u %.9g\n", mesh.corner_vertices[v], double{mesh.corner_sharpness[v]}));
    for (const uint32_t f : mesh.holes) file->append(format("t hole 1/0/0 %u\n", f));
    return file->commit();
}

Result<BakedMesh> build(Model& model, const SchemeOptions& options) {
    return bake_mesh(describe(model, options), {});
}

ModelFiles::ModelFiles(const Options& options, const BenchModel& model) {
    std::string name = (std::filesystem::temp_directory_path() / "limn_load_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) fail(options, {ErrorCode::cannot_open, name + ": cannot create a folder"});
    folder = name;
    obj = folder + "/model.obj";
    baked = folder + "/model.limn";
    value_or_fail(options, write_model(obj, model));
    Model read = value_or_fail(options, read_obj(obj));
    value_or_fail(options, write_baked_file(baked, value_or_fail(options, build(read, model.mesh.options))));
}

/// What is on the device, and what a frame writes.
struct Frame {
    vk::DevicePatchTable patches;
    vk::DeviceTessellationTable table;
    vk::Buffer points, vertices, indices, command, result;
};

void upload(const Setup& s, const BakedMesh& mesh, Frame& f) {
    const auto create = [&](uint64_t words) {
        return value_or_fail(s.options(), vk::create_buffer(s.device(), 4 * words, vk::kPointUsage, vk::MemoryUse::device));
    };
    f.patches = value_or_fail(s.options(), vk::upload_patch_table(s.device(), mesh.patches));
    f.table = value_or_fail(s.options(), vk::upload_tessellation_table(s.device(), mesh.tessellation, mesh.trees));
    f.points = create(uint64_t{3} * f.patches.point_count);
    const std::span<const float> positions(mesh.positions.data(), mesh.positions.size());
    value_or_fail(s.options(), vk::upload_bytes(s.device(), f.points, 0, std::as_bytes(positions)));
    const std::vector<uint32_t> rates(mesh.tessellation.rate_edge_count, s.rate * shared::kRateOne);
    const TessellationCounts most = count_tessellation(mesh.tessellation, rates, TessellationSpacing::integer);
    f.vertices = create(6 * most.vertices);
    f.indices = create(3 * most.triangles);
    f.command = create(5);
    f.result = create(sizeof(vk::TessellationResult) / 4);
}

void draw(const Setup& s, Frame& f) {
    const auto points = value_or_fail(
        s.options(), s.surfaces.prepare_points({.patches = &f.patches, .points = {.buffer = f.points.handle}}));
    const auto tessellation = value_or_fail(
        s.options(),
        s.tessellator.prepare({.patches = &f.patches,
                               .table = &f.table,
                               .points = {.buffer = f.points.handle},
                               .vertex_capacity = static_cast<uint32_t>(f.vertices.size_bytes / 24),
                               .triangle_capacity = static_cast<uint32_t>(f.indices.size_bytes / 12),
                               .positions = {.buffer = f.vertices.handle, .stride = 6},
                               .normals = {.buffer = f.vertices.handle, .first = 3, .stride = 6},
                               .indices = {f.indices.handle},
                               .command = {f.command.handle},
                               .result = {f.result.handle}}));
    auto commands = value_or_fail(s.options(), vk::Commands::begin(s.device()));
    points.record(commands);
    vk::record_barrier(s.device(), commands, vk::kKernelWrites, vk::kKernelReads);
    value_or_fail(s.options(), tessellation.record(commands, {.value = static_cast<float>(s.rate)}));
    value_or_fail(s.options(), commands.submit_and_wait());
}

/// The first frame that is verified is what the others must be, to the bit.
void verify(Setup& s, const Row& row, Frame& f) {
    const auto result = value_or_fail(s.options(), vk::download<vk::TessellationResult>(s.device(), f.result, 1))[0];
    auto vertices = value_or_fail(s.options(), vk::download<uint32_t>(s.device(), f.vertices, size_t{6} * result.vertex_count));
    const bool complete = result.status == vk::TessellationStatus::complete && result.triangle_count != 0;
    if (complete && s.vertices.empty()) s.vertices = vertices, s.expected = result;
    if (!complete || vertices != s.vertices || result.triangle_count != s.expected.triangle_count)
        fail(s.options(), {ErrorCode::unsupported, row_name(row) + ": another frame than that of the model"});
}

/// Runs `steps` one after the other, the last two of them upload and frame; a row with the time of all and a note on
/// each.
struct Step {
    const char* name;
    std::function<void()> run;
};
void bench_steps(Setup& s, Row row, const std::vector<Step>& steps, Frame& frame) {
    std::vector<std::vector<double>> times(steps.size());
    const auto run_all = [&] {
        for (size_t i = 0; i < steps.size(); ++i) {
            const double before = milliseconds_now();
            steps[i].run();
            times[i].push_back(milliseconds_now() - before);
        }
        return true;
    };
    run_all();
    verify(s, row, frame);
    for (auto& list : times) list.clear();
    row.timing = measure(s.options(), run_all, [&] { frame = {}; });
    for (size_t i = 0; i < steps.size(); ++i)
        row.note += format("%s%s %.2f ms", i == 0 ? "" : ", ", steps[i].name, timing_of(times[i]).median);
    row.note += format("; %.2f MB on the device", static_cast<double>(frame.patches.bytes() + frame.table.bytes()) / 1e6);
    s.session.report.add(row);
}

void bench_model(const Session& session, const vk::SurfaceEvaluator& surfaces, const vk::Tessellator& tessellator,
                 const BenchModel& model, uint32_t rate) {
    show_progress(session.options, "load " + model.name + " rate " + std::to_string(rate));
    Setup s{session, surfaces, tessellator, rate};
    const ModelFiles files(s.options(), model);
    Row row{.scenario = "load",
            .model = model.name,
            .faces = model.mesh.face_count(),
            .parameters = {{"rate", rate}},
            .items = static_cast<double>(model.mesh.face_count()),
            .unit = "faces"};
    Frame frame;
    std::optional<Model> parsed;
    std::optional<BakedMesh> built;
    row.evaluator = "limn_obj";
    bench_steps(s, row,
                {{"parse", [&] { parsed = value_or_fail(s.options(), read_obj(files.obj)); }},
                 {"build", [&] { built = value_or_fail(s.options(), build(*parsed, model.mesh.options)); }},
                 {"upload", [&] { upload(s, *built, frame); }},
                 {"first frame", [&] { draw(s, frame); }}},
                frame);
    std::optional<BakedFile> file;
    for (const bool checked : {true, false}) {
        row.evaluator = checked ? "limn_baked" : "limn_baked_trusted";
        const BakedLoadOptions load = {.check_sums = checked, .check_contents = checked};
        bench_steps(s, row,
                    {{"open", [&] { file.emplace(value_or_fail(s.options(), BakedFile::open(files.baked, load))); }},
                     {"upload", [&] { upload(s, file->mesh(), frame); }},
                     {"first frame", [&] { draw(s, frame); }}},
                    frame);
    }
}

}  // namespace

void bench_load(const Session& session) {
    const auto surfaces = value_or_fail(session.options, vk::SurfaceEvaluator::create(session.machines.device()));
    const auto tessellator = value_or_fail(session.options, vk::Tessellator::create(session.machines.device()));
    const BenchModel plane = make_quads("plane", session.options.quick ? 20 : 105);
    for (const uint32_t rate : kRates) {
        for (const BenchModel& model : session.models) bench_model(session, surfaces, tessellator, model, rate);
        bench_model(session, surfaces, tessellator, plane, rate);
    }
}

}  // namespace limn::bench
