// limn refine: a model, uniformly refined, as OBJ, PLY or glTF.
#include <algorithm>

#include "cli/gltf.h"
#include "cli/point_runner.h"
#include "cli/scheme_model.h"
#include "limn/ply.h"
#include "limn/refinement.h"

namespace limn::cli {
namespace {

struct Options {
    std::string model, output;
    uint32_t level = 1;
    bool limit = false;
    SurfaceOptions surface;
    DeviceOption device;
};

/// Everything that is written, held where MeshOutput can refer to it.
struct RefinedMesh {
    Topology topology;  ///< faces and holes of the last level, nothing else
    std::vector<float> positions, normals, texture_coordinates;
    std::vector<uint32_t> face_texture_coordinates, face_sizes;
};

bool ends_with(const std::string& text, const char* ending) {
    const std::string tail(ending);
    return text.size() >= tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
}

Result<std::vector<StencilTable>> build_chain(const Refinement& refinement) {
    std::vector<StencilTable> tables;
    for (uint32_t level = 1; level < refinement.level_count(); ++level) {
        Result<StencilTable> table = build_step_table<float>(refinement, level);
        if (!table) return table.error();
        tables.push_back(std::move(*table));
    }
    return tables;
}

/// Takes the faces of a level that is not needed any more.
void keep_faces(Topology& last, Topology& out) {
    out.options = last.options;
    out.vertex_count = last.vertex_count;
    out.face_count = last.face_count;
    out.face_size = last.face_size;
    out.face_offsets = std::move(last.face_offsets);
    out.face_vertices = std::move(last.face_vertices);
    out.face_holes = std::move(last.face_holes);
}
void keep_faces(Array<uint32_t>&& offsets, Array<uint32_t>&& vertices, Topology& out) {
    out.face_count = static_cast<uint32_t>(offsets.size() - 1);
    out.face_offsets = std::move(offsets);
    out.face_vertices = std::move(vertices);
}

/// Limits from the last points of a chain where those are past all semi-sharp features, else from the control
/// points.
Result<LimitPoints> evaluate_limits(const Options& options, const LoadedModel& loaded,
                                    const PointRunner& runner, Refinement& refinement, Topology& faces) {
    const bool chained = options.level >= std::max(1u, count_sharp_levels(refinement.levels[0]));
    if (!chained) {
        Result<StencilTable> table = build_limit_table<float>(refinement, options.level, true);
        if (!table) return table.error();
        keep_faces(refinement.levels.back(), faces);
        refinement = {};
        return runner.run_limits(*table, loaded.model.positions);
    }
    Result<std::vector<StencilTable>> tables = build_chain(refinement);
    if (!tables) return tables.error();
    Result<std::vector<float>> points = runner.run(*tables, loaded.model.positions, 3);
    if (!points) return points.error();
    tables->clear();
    Result<StencilTable> table = build_limit_step_table<float>(refinement, true);
    if (!table) return table.error();
    keep_faces(refinement.levels.back(), faces);
    refinement = {};
    return runner.run_limits(*table, *points);
}

Result<void> refine_positions(const Options& options, const LoadedModel& loaded, const PointRunner& runner,
                              Progress& progress, RefinedMesh& out) {
    progress.show("refining " + plural(loaded.mesh.face_count(), "face"));
    Result<Refinement> refinement = build_refinement(loaded.mesh, {options.level, options.limit});
    if (!refinement) return refinement.error();
    progress.show("evaluating stencils on " + runner.name());
    if (options.limit) {
        Result<LimitPoints> limits = evaluate_limits(options, loaded, runner, *refinement, out.topology);
        if (!limits) return limits.error();
        out.normals = normals_of(limits->tangents1, limits->tangents2);
        out.positions = std::move(limits->positions);
    } else {
        Result<std::vector<StencilTable>> tables = build_chain(*refinement);
        if (!tables) return tables.error();
        Result<std::vector<float>> points = runner.run(*tables, loaded.model.positions, 3);
        if (!points) return points.error();
        out.positions = std::move(*points);
        keep_faces(refinement->levels.back(), out.topology);
    }
    return {};
}

Result<void> refine_texture_coordinates(const Options& options, const LoadedModel& loaded,
                                        const PointRunner& runner, Progress& progress, RefinedMesh& out) {
    if (loaded.mesh.channels.empty()) return {};
    progress.show("refining texture coordinates");
    Result<Refinement> refinement = build_face_varying_refinement(loaded.mesh, 0, {options.level, false});
    if (!refinement) return refinement.error();
    Result<StencilTable> table = options.limit ? build_limit_table<float>(*refinement, options.level)
                                               : build_stencil_table<float>(*refinement, options.level);
    if (!table) return table.error();
    Result<std::vector<float>> values = runner.run({&*table, 1}, loaded.model.texture_coordinates, 2);
    if (!values) return values.error();
    out.texture_coordinates = std::move(*values);
    const Topology& last = refinement->last();
    out.face_texture_coordinates.assign(last.face_vertices.begin(), last.face_vertices.end());
    return {};
}

/// The same by a scheme without patches.
Result<void> refine_by_scheme(const Options& options, const LoadedModel& loaded, const SubdivisionScheme& scheme,
                              const RunDevice& device, const PointRunner& runner, Progress& progress,
                              RefinedMesh& out) {
    note_left_out(options.model, loaded, scheme, progress);
    if (options.limit) {
        auto surface = build_model_surface(options.model, loaded, scheme, options.level, progress);
        if (!surface) return surface.error();
        progress.show("evaluating stencils on " + runner.name());
        auto vertices = run_scheme_surface(device, *surface, loaded.model.positions);
        if (!vertices) return vertices.error();
        out.positions = std::move(vertices->positions);
        out.normals = std::move(vertices->normals);
        keep_faces(std::move(surface->face_offsets), std::move(surface->face_vertices), out.topology);
    } else {
        const auto corners = corner_values_of(loaded, scheme);
        if (!corners) return corners.error();
        auto refinement = build_scheme_refinement<float>(loaded.mesh, scheme, {options.level}, *corners);
        if (!refinement) return refinement.error();
        auto points = runner.run(refinement->tables, loaded.model.positions, 3);
        if (!points) return points.error();
        out.positions = std::move(*points);
        keep_faces(refinement->last.topology, out.topology);
    }
    auto texture = refine_texture(loaded, scheme, options.level);
    if (!texture) return texture.error();
    out.texture_coordinates = std::move(texture->values);
    out.face_texture_coordinates = std::move(texture->face_values);
    return {};
}

Result<void> refine_with_patches(const Options& options, const LoadedModel& loaded, const PointRunner& runner,
                                 Progress& progress, RefinedMesh& out) {
    if (auto done = refine_positions(options, loaded, runner, progress, out); !done) return done;
    return refine_texture_coordinates(options, loaded, runner, progress, out);
}

Result<void> write_mesh(const Options& options, RefinedMesh& mesh) {
    MeshOutput output;
    output.positions = mesh.positions;
    output.normals = mesh.normals;
    output.texture_coordinates = mesh.texture_coordinates;
    output.face_texture_coordinates = mesh.face_texture_coordinates;
    output.face_size = mesh.topology.face_size;
    if (output.face_size == 0) {
        for (uint32_t f = 0; f < mesh.topology.face_count; ++f)
            mesh.face_sizes.push_back(mesh.topology.size_of_face(f));
        output.face_sizes = mesh.face_sizes;
    }
    output.face_vertices = mesh.topology.face_vertices;
    output.face_skip = mesh.topology.face_holes;
    if (ends_with(options.output, ".glb")) return write_glb(options.output, output);
    return ends_with(options.output, ".ply") ? write_ply(options.output, output)
                                             : write_obj(options.output, output);
}

int run(const Options& options) {
    Progress progress;
    progress.show("reading " + options.model);
    const Result<LoadedModel> loaded = load_model(options.model, options.surface);
    if (!loaded) return fail(loaded.error());
    const Result<RunDevice> device = RunDevice::create(options.device);
    if (!device) return fail(device.error());
    const Result<PointRunner> runner = PointRunner::create(*device);
    if (!runner) return fail(runner.error());
    RefinedMesh mesh;
    const SubdivisionScheme* scheme = scheme_without_refinement(options.surface);
    const auto refined = scheme != nullptr
                             ? refine_by_scheme(options, *loaded, *scheme, *device, *runner, progress, mesh)
                             : refine_with_patches(options, *loaded, *runner, progress, mesh);
    if (!refined) return fail(refined.error());
    if (auto silent = device->check_validation(); !silent) return fail(silent.error());
    progress.show("writing " + options.output);
    if (auto done = write_mesh(options, mesh); !done) return fail(done.error());
    return 0;
}

}  // namespace

void add_refine(CLI::App& program, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("refine", "Refine a model uniformly and write it as OBJ, PLY or glTF");
    command->add_option("MODEL", options->model, "OBJ file")->required();
    command
        ->add_option("--level", options->level,
                     "Refinement level, 0 to 10: every level has four times the faces (of schemes that halve edges)")
        ->check(CLI::Range(0u, kMaxRefinementLevel))
        ->capture_default_str();
    command->add_flag("--limit", options->limit, "Move the vertices to the limit surface, with its normals");
    command
        ->add_option("-o,--output", options->output, "File to write: .obj, .ply (binary) or .glb (triangles)")
        ->required()
        ->check([](const std::string& path) {
            for (const char* ending : {".obj", ".ply", ".glb"})
                if (ends_with(path, ending)) return std::string();
            return "'" + path + "' is none of .obj, .ply and .glb";
        });
    add_surface_options(*command, options->surface, SchemesTaken::all);
    add_device_option(*command, options->device);
    command->callback([options, &status] { status = run(*options); });
}

}  // namespace limn::cli
