// limn tessellate: the limit surface as triangles, as many as are asked for where they are needed.
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "cli/gltf.h"
#include "cli/scheme_model.h"
#include "cli/tessellation_runner.h"
#include "limn/file.h"
#include "limn/ply.h"
#include "limn/schemes/adaptive.h"
#include "viewer/camera.h"

namespace limn::cli {
namespace {

constexpr const char* kEndings[] = {".obj", ".ply", ".glb"};
constexpr float kDefaultRate = 8;
constexpr uint32_t kDefaultMaxRate = 64;  // more where --rate asks for it
constexpr float kLeast = 1e-6f, kMost = 1e6f;
constexpr float kLeastLength = 1e-30f, kMostLength = 1e30f;  // models come in any unit

/// An option that says what decides rates. One at most is given.
struct ModeOption {
    const char* name;
    RateMode mode;
    float low, high;
    const char* description;
};
constexpr ModeOption kModes[] = {
    {"--rate", RateMode::uniform, 1, shared::kMaxSideRate,
     "Segments of every edge of the control mesh (default 8)"},
    {"--pixel-error", RateMode::pixel_error, kLeast, kMost, "By how many pixels edges may miss the surface"},
    {"--edge-pixels", RateMode::screen_length, kLeast, kMost,
     "How many pixels long the triangles' edges are"},
    {"--chord-error", RateMode::chord_error, kLeastLength, kMostLength,
     "By what length, in the model's units, edges may miss the surface"},
    {"--distance", RateMode::distance, kLeastLength, kMostLength,
     "The distance from the camera at which the rate is 1; it is 2 at half of that, and so on"}};

struct Options {
    std::string model, output;
    std::array<std::optional<float>, std::size(kModes)> values;
    std::string spacing = "integer", camera = "30,20", size = "1280x960", uv = "auto";
    std::optional<std::string> cull;
    std::optional<uint32_t> max_rate, max_triangles;
    SurfaceOptions surface;
    DeviceOption device;
};

bool ends_with(const std::string& text, std::string_view ending) {
    return text.size() >= ending.size() &&
           text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

/// All of `text` as a number of this type; nothing where it is none.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
    Number number = {};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

struct Culling {
    bool outside = false, backfaces = false;
};
std::optional<Culling> parse_culling(const std::string& text) {
    Culling culling;
    for (size_t at = 0, end = 0; end != text.size(); at = end + 1) {
        end = std::min(text.find(',', at), text.size());
        const std::string_view word = std::string_view(text).substr(at, end - at);
        if (word != "outside" && word != "backfaces") return std::nullopt;
        (word == "outside" ? culling.outside : culling.backfaces) = true;
        if (end + 1 == text.size()) return std::nullopt;  // a comma with nothing behind it
    }
    if (text.empty()) return std::nullopt;
    return culling;
}

TessellationSpacing spacing_of(const std::string& name) {
    if (name == "pow2") return TessellationSpacing::power_of_two;
    return name == "fractional" ? TessellationSpacing::fractional : TessellationSpacing::integer;
}

/// Looks at the box of the control points.
Camera camera_of(const Options& options, std::span<const float> positions) {
    viewer::Bounds bounds;
    for (size_t i = 0; i + 2 < positions.size(); i += 3) {
        const glm::vec3 point(positions[i], positions[i + 1], positions[i + 2]);
        bounds.low = i == 0 ? point : glm::min(bounds.low, point);
        bounds.high = i == 0 ? point : glm::max(bounds.high, point);
    }
    const PictureSize size = *parse_size(options.size);
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    return viewer::rate_camera(viewer::Camera::frame(bounds, *viewer::parse_camera(options.camera), aspect), size.width,
                               size.height);
}

uint32_t max_rate_of(const Options& options) {
    const auto uniform = static_cast<uint32_t>(std::ceil(options.values[0].value_or(1)));
    return options.max_rate.value_or(std::max(kDefaultMaxRate, uniform));
}

RateSettings settings_of(const Options& options, std::span<const float> positions) {
    RateSettings settings;
    for (size_t i = 0; i < std::size(kModes); ++i) {
        if (!options.values[i]) continue;
        settings.mode = kModes[i].mode;
        settings.value = *options.values[i];
    }
    settings.spacing = spacing_of(options.spacing);
    settings.max_rate = max_rate_of(options);
    settings.camera = camera_of(options, positions);
    if (options.cull) {
        const Culling culling = *parse_culling(*options.cull);
        settings.cull_outside = culling.outside;
        settings.cull_backfaces = culling.backfaces;
    }
    return settings;
}

const std::optional<float>& chord_error(const Options& options) {
    return options.values[3];
}

/// Schemes without patches. Throws as CLI11 does.
void check_scheme_usage(const Options& options, const SubdivisionScheme& scheme) {
    const bool adaptive = chord_error(options).has_value();
    for (size_t i = 1; i < std::size(kModes); ++i)
        if (options.values[i] && kModes[i].mode != RateMode::chord_error)
            throw CLI::ValidationError(kModes[i].name, "takes a scheme with patches; others go by --rate or --chord-error");
    if (adaptive && !is_adaptive(scheme))
        throw CLI::ValidationError("--chord-error", std::string(scheme.title) + " goes by --rate alone: its vertices turn into faces");
    if (options.cull || options.spacing != "integer" || (!adaptive && (options.max_triangles || options.max_rate)))
        throw CLI::ValidationError("--scheme", "has no patches: it goes by --rate alone, or by --chord-error, --max-rate and --max-triangles");
}

/// What cannot be told from one option alone. Throws as CLI11 does.
void check_usage(const Options& options) {
    const std::optional<float>& rate = options.values[0];
    if (rate && options.max_rate && *rate > static_cast<float>(*options.max_rate))
        throw CLI::ValidationError("--rate", "is larger than --max-rate");
    if (const SubdivisionScheme* scheme = scheme_drawn_evenly(options.model, options.surface))
        check_scheme_usage(options, *scheme);
    if (options.cull && options.device.device == "cpu")
        throw CLI::ValidationError("--cull", "needs a Vulkan device: --device cpu does not cull");
}

Result<void> write_mesh(const std::string& path, const TriangleMesh& mesh) {
    MeshOutput output;
    output.positions = mesh.positions;
    output.normals = mesh.normals;
    output.texture_coordinates = mesh.texture_coordinates;
    output.face_size = 3;
    output.face_vertices = mesh.indices;
    if (ends_with(path, ".glb")) return write_glb(path, output);
    return ends_with(path, ".ply") ? write_ply(path, output) : write_obj(path, output);
}

/// Errors that are about the model name it.
Result<TriangleMesh> make_mesh(const Options& options, const ModelTables& model, const RunDevice& device,
                               Progress& progress) {
    const auto name_model = [&](const Error& error) {
        Error named = error;
        named.message = printable(options.model) + ": " + error.message;
        return named;
    };
    TessellationRequest request = {settings_of(options, model.positions()), options.max_triangles};
    if (auto limited = limit_rates(model.mesh(), request.settings); !limited) return name_model(limited.error());
    const Result<TessellationRunner> runner = TessellationRunner::create(device);
    if (!runner) return runner.error();
    progress.show("tessellating on " + runner->name());
    Result<TriangleMesh> mesh = runner->run(model.mesh(), request);
    if (!mesh) return name_model(mesh.error());
    return mesh;
}

/// Steps for --max-rate, as far as memory goes.
uint32_t max_steps(const Options& options, const LoadedModel& model, const SubdivisionScheme& scheme) {
    uint32_t steps = steps_for_rate(scheme, static_cast<double>(max_rate_of(options)));
    while (steps > 0 && !steps_within_reason(model, scheme, std::pow(segments_per_step(scheme), steps))) --steps;
    return steps;
}

/// As fine as --chord-error needs it, or --max-triangles allows: `rate_scale` says by how much, rates being what they
/// would be by the root of the error.
Result<SchemeSurface> build_adaptive_model(const Options& options, const LoadedModel& model,
                                           const SubdivisionScheme& scheme, double& rate_scale,
                                           Progress& progress) {
    progress.show("refining " + plural(model.mesh.face_count(), "face"));
    const std::vector<double> positions(model.model.positions.begin(), model.model.positions.end());
    AdaptiveSurfaceOptions adaptive;
    adaptive.tolerance = static_cast<double>(*chord_error(options));
    adaptive.max_level = max_steps(options, model, scheme);
    if (options.max_triangles) adaptive.max_triangles = *options.max_triangles;
    auto surface = build_adaptive_surface<float>(model.mesh, scheme, positions, adaptive);
    if (!surface) return surface.error();
    if (!surface->reached && surface->tolerance == adaptive.tolerance) {
        progress.clear();
        std::fprintf(stderr, "limn: %s: note: some faces may miss by more after %u steps (--max-rate)\n",
                     printable(options.model).c_str(), adaptive.max_level);
    }
    rate_scale = std::sqrt(adaptive.tolerance / surface->tolerance);
    return make_scheme_surface(std::move(*surface));
}

/// By a scheme without patches: evenly, or as fine as --chord-error needs it.
Result<TriangleMesh> make_scheme_mesh(const Options& options, const SubdivisionScheme& scheme, const RunDevice& device,
                                      Progress& progress) {
    progress.show("reading " + options.model);
    const Result<LoadedModel> loaded = load_model(options.model, options.surface);
    if (!loaded) return loaded.error();
    const auto name_model = [&](Error error) {
        error.message = printable(options.model) + ": " + error.message;
        return error;
    };
    TriangleMesh mesh;
    const auto build = [&]() -> Result<SchemeSurface> {
        if (chord_error(options)) return build_adaptive_model(options, *loaded, scheme, mesh.rate_scale, progress);
        const auto level =
            steps_within_reason(*loaded, scheme, static_cast<double>(options.values[0].value_or(kDefaultRate)));
        if (!level) return level.error();
        progress.show("refining " + plural(loaded->mesh.face_count(), "face"));
        return build_scheme_surface(loaded->mesh, scheme, {*level});
    };
    const Result<SchemeSurface> surface = build();
    if (!surface) return name_model(surface.error());
    note_left_out(options.model, *loaded, scheme, progress);
    progress.show("evaluating stencils on " + device.name());
    auto vertices = run_scheme_surface(device, *surface, loaded->model.positions);
    if (!vertices) return name_model(vertices.error());
    mesh.positions = std::move(vertices->positions);
    mesh.normals = std::move(vertices->normals);
    mesh.indices.assign(surface->triangles.begin(), surface->triangles.end());
    return mesh;
}

/// By tables with patches, from an OBJ file or a baked one.
Result<TriangleMesh> make_adaptive_mesh(const Options& options, const RunDevice& device, Progress& progress) {
    BakeOptions bake;
    bake.max_rate = options.device.device == "cpu" ? 0 : max_rate_of(options);  // the host needs no trees
    const Result<ModelTables> model = ModelTables::load(options.model, options.surface, options.uv, bake, progress);
    if (!model) return model.error();
    return make_mesh(options, *model, device, progress);
}

Result<void> tessellate_model(const Options& options, Progress& progress) {
    const Result<RunDevice> device = RunDevice::create(options.device);
    if (!device) return device.error();
    const SubdivisionScheme* scheme = scheme_drawn_evenly(options.model, options.surface);
    const Result<TriangleMesh> mesh = scheme != nullptr ? make_scheme_mesh(options, *scheme, *device, progress)
                                                        : make_adaptive_mesh(options, *device, progress);
    if (!mesh) return mesh.error();
    if (auto silent = device->check_validation(); !silent) return silent;
    progress.show("writing " + options.output);
    if (auto done = write_mesh(options.output, *mesh); !done) return done;
    progress.clear();
    std::printf("%s: %s, %zu vertices, by %s", printable(options.output).c_str(),
                plural(mesh->triangle_count(), "triangle").c_str(), mesh->vertex_count(),
                device->name().c_str());
    if (options.max_triangles) std::printf(", rates scaled by %.4g", mesh->rate_scale);
    std::printf("\n");
    return {};
}

int run(const Options& options) {
    Progress progress;
    const Result<void> done = tessellate_model(options, progress);
    progress.clear();
    return done ? 0 : fail(done.error());
}

void add_rate_options(CLI::App& command, Options& options) {
    CLI::Option_group* modes = command.add_option_group("Rates", "What decides how finely edges are divided");
    modes->require_option(0, 1);
    for (size_t i = 0; i < std::size(kModes); ++i) {
        const ModeOption& mode = kModes[i];
        modes->add_option(mode.name, options.values[i], mode.description)
            ->check([&mode](const std::string& text) {
                const auto value = parse_number<float>(text);
                if (value && *value >= mode.low && *value <= mode.high) return std::string();
                char message[96];
                std::snprintf(message, sizeof message, "is a number from %g to %g, not '", mode.low,
                              mode.high);
                return message + text + "'";
            });
    }
    command
        .add_option(
            "--spacing", options.spacing,
            "integer; pow2: rates are powers of two; fractional: rates are real numbers, of 2 or more")
        ->check(CLI::IsMember(std::vector<std::string>{"integer", "pow2", "fractional"}))
        ->capture_default_str();
    command
        .add_option("--max-rate", options.max_rate,
                    "The largest rate, 2 to 128; half of that on each side of the quads that other faces are "
                    "split into (default 64, or what --rate takes)")
        ->check(CLI::Range(2u, shared::kMaxSideRate));
    command
        .add_option("--max-triangles", options.max_triangles,
                    "Scale all rates down by one number, the largest that makes no more triangles than this")
        ->check(CLI::Range(1u, kInvalidIndex / 3));
}

void add_camera_options(CLI::App& command, Options& options) {
    command
        .add_option(
            "--camera", options.camera,
            "AZIMUTH,ELEVATION[,DISTANCE[,FOV]]: degrees around the middle of the control points; radii "
            "of their box, by default so that all is in view; degrees from top to bottom")
        ->check([](const std::string& text) {
            const auto view = viewer::parse_camera(text);
            return view ? std::string() : view.error().message;
        })
        ->capture_default_str();
    add_size_option(command, options.size);
    command
        .add_option(
            "--cull", options.cull,
            "Leave out surfaces that the camera does not see: outside, backfaces, or outside,backfaces")
        ->check([](const std::string& text) {
            return parse_culling(text) ? std::string()
                                       : "takes outside, backfaces or both, not '" + text + "'";
        });
}

}  // namespace

void add_tessellate(CLI::App& program, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("tessellate", "Tessellate the limit surface and write it as OBJ, PLY or glTF");
    command->add_option("MODEL", options->model, "OBJ file, or one of limn bake")->required();
    command->add_option("-o,--output", options->output, "File to write: .obj, .ply (binary) or .glb")
        ->required()
        ->check([](const std::string& path) {
            for (const char* ending : kEndings)
                if (ends_with(path, ending)) return std::string();
            return "'" + path + "' is none of .obj, .ply and .glb";
        });
    add_rate_options(*command, *options);
    add_camera_options(*command, *options);
    add_uv_option(*command, options->uv);
    add_surface_options(*command, options->surface, SchemesTaken::all);
    add_device_option(*command, options->device);
    command->footer(
        "A rate belongs to an edge and both faces beside it, so triangles meet without gaps. Vertices are\n"
        "shared, but for those on creases, which have a normal for each side, and those on seams of texture\n"
        "coordinates: copies have positions of the same bits.\n"
        "Pixels are those of --camera and --size.");
    command->callback([options, command, &status] {
        check_usage(*options);
        check_baked_usage(*command, options->model, {"--uv"});
        status = run(*options);
    });
}

}  // namespace limn::cli
