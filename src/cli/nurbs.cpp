// limn nurbs: surfaces as control meshes, and control meshes of rows as surfaces.
#include <charconv>
#include <cstdio>

#include "cli/program.h"
#include "limn/file.h"
#include "limn/schemes/obj_surfaces.h"
#include "limn/schemes/spline_mesh.h"

namespace limn::cli {
namespace {

struct Options {
    std::string input, output;
    SurfaceOptions surface;
};

Error named(const std::string& path, const Error& error) {
    return {error.code, printable(path) + ": " + error.message, error.element};
}

/// A rational surface whose weights are all the same is none; others are no control mesh of points.
Result<BSplineSurface> without_weights(const BSplineSurface& surface) {
    if (surface.width == 3) return surface;
    BSplineSurface out{surface.u, surface.v, 3, {}};
    const double weight = surface.points[3];
    for (size_t i = 0; i < surface.points.size(); i += 4) {
        if (surface.points[i + 3] != weight || weight == 0)
            return Error{ErrorCode::unsupported,
                         "its weights differ, and control meshes in OBJ files have none"};
        for (size_t c = 0; c < 3; ++c) out.points.push_back(surface.points[i + c] / weight);
    }
    return out;
}

struct MeshParts {
    std::vector<double> points;
    std::vector<uint32_t> face_vertices;  // four each
};

Result<void> add_part(const BSplineSurface& part, MeshParts& parts) {
    const auto plain = without_weights(part);
    if (!plain) return plain.error();
    const auto mesh = build_spline_mesh(*plain);
    if (!mesh) return mesh.error();
    const size_t first = parts.points.size();
    for (const uint32_t v : mesh->face_vertices)
        parts.face_vertices.push_back(static_cast<uint32_t>(first / 3) + v);
    parts.points.resize(first + size_t{mesh->vertices.row_count()} * 3);
    apply_stencil_table<double>(mesh->vertices, plain->points, std::span(parts.points).subspan(first), 3);
    return {};
}

template <class Number>
void write_numbers(FileWriter& file, std::string_view keyword, std::span<const Number> values,
                   uint32_t first) {
    char* to = file.room(400);
    to = std::copy(keyword.begin(), keyword.end(), to);
    for (const Number value : values) {
        *to++ = ' ';
        to = std::to_chars(to, to + 40, value + static_cast<Number>(first)).ptr;
    }
    *to++ = '\n';
    file.advance(to);
}

/// Faces along boundaries belong to no surface, which a tag says.
Result<void> write_mesh(const std::string& path, const MeshParts& parts) {
    auto file = FileWriter::create(path);
    if (!file) return file.error();
    for (size_t i = 0; i < parts.points.size(); i += 3)
        write_numbers<double>(*file, "v", std::span(parts.points).subspan(i, 3), 0);
    for (size_t i = 0; i < parts.face_vertices.size(); i += 4)
        write_numbers<uint32_t>(*file, "f", std::span(parts.face_vertices).subspan(i, 4), 1);
    file->append("t interpolateboundary 1/0/0 0\n");
    return file->commit();
}

Result<void> convert_surfaces(const Options& options, std::span<const BSplineSurface> surfaces) {
    MeshParts parts;
    size_t count = 0;
    for (size_t i = 0; i < surfaces.size(); ++i)
        for (const BSplineSurface& part : split_at_full_knots(surfaces[i])) {
            if (auto added = add_part(part, parts); !added)
                return Error{added.error().code, printable(options.input) + ": surface " +
                                                     std::to_string(i + 1) + ": " + added.error().message};
            ++count;
        }
    if (auto written = write_mesh(options.output, parts); !written) return written;
    std::printf("%s: %s in %s, %s\n", printable(options.output).c_str(),
                plural(surfaces.size(), "surface").c_str(), plural(count, "part").c_str(),
                plural(parts.face_vertices.size() / 4, "face").c_str());
    return {};
}

Result<void> convert_mesh(const Options& options) {
    const Result<LoadedModel> loaded = load_model(options.input, options.surface);
    if (!loaded) return loaded.error();
    const std::vector<double> points(loaded->model.positions.begin(), loaded->model.positions.end());
    const auto surface = build_b_spline_surface(loaded->mesh, points, 3);
    if (!surface) return named(options.input, surface.error());
    if (auto written = write_obj_surfaces(options.output, {&*surface, 1}); !written)
        return named(options.output, written.error());
    std::printf("%s: a surface of %u by %u control points\n", printable(options.output).c_str(),
                surface->u.point_count(), surface->v.point_count());
    return {};
}

int run(const Options& options) {
    const auto surfaces = read_obj_surfaces(options.input);
    if (!surfaces) return fail(surfaces.error());
    const Result<void> done =
        surfaces->empty() ? convert_mesh(options) : convert_surfaces(options, *surfaces);
    return done ? 0 : fail(done.error());
}

}  // namespace

void add_nurbs(CLI::App& program, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("nurbs", "B-spline surfaces as control meshes, and back, exactly");
    command
        ->add_option("IN", options->input,
                     "OBJ file with surfaces (cstype bspline or bezier), or with a mesh of quads in rows")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "OBJ file to write: the control mesh of the surfaces, or the mesh's surface")
        ->required();
    add_surface_options(*command, options->surface);
    command->footer(
        "Exact are surfaces of degree 3 whose knots inside are simple, at distances with a common measure, "
        "whatever their "
        "ends; of lower degree those of single patches; and all of which those are parts, between knots of "
        "full multiplicity. "
        "Rational ones are converted by the library only (limn/schemes/spline_mesh.h).");
    command->callback([options, &status] { status = run(*options); });
}

}  // namespace limn::cli
