#include "cli/scheme_model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "limn/baked_file.h"
#include "limn/file.h"
#include "limn/schemes/corner_values.h"
#include "limn/topology.h"
#include "limn/vulkan/buffer.h"

namespace limn::cli {
namespace {

bool splits_in_four(const SubdivisionScheme& scheme) {
    return std::all_of(scheme.passes.begin(), scheme.passes.end(), [](const Pass& pass) {
        return pass.split == SplitKind::quads || pass.split == SplitKind::triangles || pass.split == SplitKind::none;
    });
}

/// A face that is drawn has a boundary edge.
bool ends_at_boundary(const std::string& path, const SurfaceOptions& options) {
    if (is_baked_file(path)) return false;
    const Result<LoadedModel> loaded = load_model(path, options);
    if (!loaded) return false;
    const Topology t = build_topology(loaded->mesh);
    for (uint32_t c = 0; c < t.corner_count(); ++c)
        if (t.corners_of_edge(t.face_edges[c]).size() == 1 && t.face_holes[t.face_of_corner(c)] == 0) return true;
    return false;
}

/// The scheme that is asked for, unless it is one of these.
const SubdivisionScheme* scheme_unless(const std::vector<std::string>& names, const SurfaceOptions& options) {
    const bool found = std::find(names.begin(), names.end(), options.scheme) != names.end();
    return found ? nullptr : find_subdivision_scheme(options.scheme);
}

}  // namespace

const SubdivisionScheme* scheme_without_patches(const SurfaceOptions& options) {
    return scheme_unless(scheme_names(), options);
}

const SubdivisionScheme* scheme_drawn_evenly(const std::string& path, const SurfaceOptions& options) {
    if (options.scheme == "doo-sabin" && ends_at_boundary(path, options)) return find_subdivision_scheme("doo-sabin");
    return scheme_without_patches(options);
}

const SubdivisionScheme* scheme_without_refinement(const SurfaceOptions& options) {
    return scheme_unless(opensubdiv_scheme_names(), options);
}

void note_creases_left_out(const std::string& path, const LoadedModel& model, const SubdivisionScheme& scheme,
                           Progress& progress) {
    const bool creases = !model.mesh.crease_edges.empty() || !model.mesh.corner_vertices.empty();
    if (creases && scheme.creases == CreaseRules::none) {
        progress.clear();
        std::fprintf(stderr, "limn: %s: note: %s has no creases: those of the model are left out\n",
                     printable(path).c_str(), scheme.title);
    }
}

void note_left_out(const std::string& path, const LoadedModel& model, const SubdivisionScheme& scheme,
                   Progress& progress) {
    note_creases_left_out(path, model, scheme, progress);
    if (!model.mesh.channels.empty() && !splits_in_four(scheme)) {
        progress.clear();
        std::fprintf(stderr, "limn: %s: note: %s goes without texture coordinates\n", printable(path).c_str(),
                     scheme.title);
    }
}

Result<uint32_t> steps_within_reason(const LoadedModel& model, const SubdivisionScheme& scheme, double rate) {
    const double growth = segments_per_step(scheme) * segments_per_step(scheme);
    double triangles = 2.0 * static_cast<double>(model.mesh.face_vertices.size());
    const uint32_t wanted = steps_for_rate(scheme, rate);
    uint32_t steps = 0;
    while (steps < wanted && triangles * growth <= static_cast<double>(kMostSchemeTriangles)) {
        triangles *= growth;
        ++steps;
    }
    if (steps < wanted)
        return Error{ErrorCode::too_large, "a rate of " + std::to_string(static_cast<int>(rate)) + " takes " +
                                               std::to_string(wanted) + " steps and more than " +
                                               std::to_string(kMostSchemeTriangles) + " triangles"};
    return steps;
}

Result<std::vector<double>> corner_values_of(const LoadedModel& model, const SubdivisionScheme& scheme) {
    if (scheme.corner_values == CornerValues::angles) return corner_angles(model.mesh, model.model.positions);
    if (scheme.corner_values == CornerValues::intervals && !model.model.intervals.empty())
        return corner_intervals(model.mesh, model.model.interval_edges, model.model.intervals);
    return std::vector<double>();
}

Result<SchemeSurface> build_model_surface(const std::string& path, const LoadedModel& model,
                                          const SubdivisionScheme& scheme, uint32_t level, Progress& progress) {
    progress.show("refining " + plural(model.mesh.face_count(), "face"));
    const auto corners = corner_values_of(model, scheme);
    auto surface = corners ? build_scheme_surface(model.mesh, scheme, {level}, *corners)
                           : Result<SchemeSurface>(corners.error());
    if (surface) return surface;
    Error error = surface.error();
    error.message = printable(path) + ": " + error.message;
    return error;
}

Result<SchemeVertices> run_scheme_surface(const RunDevice& device, const SchemeSurface& surface,
                                          std::span<const float> points) {
    if (device.is_host()) return apply_scheme_surface(surface, points);
    const vk::Device& vulkan = *device.vulkan();
    auto evaluator = vk::SchemeEvaluator::create(vulkan);
    if (!evaluator) return evaluator.error();
    auto uploaded = vk::upload_scheme_surface(vulkan, surface);
    if (!uploaded) return uploaded.error();
    auto control = vk::create_point_buffer(vulkan, points);
    if (!control) return control.error();
    vk::Buffer outputs[2];
    for (vk::Buffer& output : outputs) {
        auto buffer =
            vk::create_buffer(vulkan, uint64_t{12} * surface.vertex_count, vk::kPointUsage, vk::MemoryUse::device);
        if (!buffer) return buffer.error();
        output = std::move(*buffer);
    }
    auto evaluation = evaluator->prepare({.surface = &*uploaded,
                                          .points = {.buffer = control->handle},
                                          .positions = {.buffer = outputs[0].handle},
                                          .normals = {.buffer = outputs[1].handle}});
    if (!evaluation) return evaluation.error();
    auto commands = vk::Commands::begin(vulkan);
    if (!commands) return commands.error();
    evaluation->record(*commands);
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    SchemeVertices out;
    std::vector<float>* results[] = {&out.positions, &out.normals};
    for (size_t i = 0; i < 2; ++i) {
        auto values = vk::download<float>(vulkan, outputs[i], size_t{3} * surface.vertex_count);
        if (!values) return values.error();
        *results[i] = std::move(*values);
    }
    return out;
}

Result<RefinedTexture> refine_texture(const LoadedModel& model, const SubdivisionScheme& scheme, uint32_t level) {
    RefinedTexture out;
    if (model.mesh.channels.empty() || !splits_in_four(scheme)) return out;
    ControlMesh mesh = model.mesh;
    mesh.options.scheme = scheme.faces == FaceKind::triangles ? Scheme::loop : Scheme::bilinear;
    mesh.channels[0].interpolation = FaceVaryingInterpolation::all;
    auto refinement = build_face_varying_refinement(mesh, 0, {level, false});
    if (!refinement) return refinement.error();
    auto table = build_stencil_table<float>(*refinement, level);
    if (!table) return table.error();
    out.values.resize(size_t{2} * table->row_count());
    apply_stencil_table<float>(*table, model.model.texture_coordinates, out.values, 2);
    const Topology& last = refinement->last();
    out.face_values.assign(last.face_vertices.begin(), last.face_vertices.end());
    return out;
}

}  // namespace limn::cli
