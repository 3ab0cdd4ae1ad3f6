// limn render: a picture of the limit surface.
#include "cli/program.h"

#ifdef LIMN_HAVE_PICTURES
#include <cmath>

#include "cli/model_tables.h"
#include "cli/picture_options.h"
#include "cli/scheme_pictures.h"
#include "limn/file.h"
#include "viewer/graphics_device.h"
#include "viewer/renderer.h"
#include "viewer/surface_mesh.h"
#endif

namespace limn::cli {
namespace {

#ifdef LIMN_HAVE_PICTURES

struct Options {
    std::string model, output;
    std::string size = "1280x960";
    LookOptions look;
    SurfaceOptions surface;
    DeviceOption device;
    bool times = false;
    bool hardware = false;  ///< hardware tessellation
};

/// What is drawn, and from where.
struct Scene {
    std::unique_ptr<viewer::SurfaceKernels> kernels;  ///< outlive the surface, and do not move
    viewer::SurfaceMesh surface;
    viewer::Renderer::View view;
    vk::TessellationResult triangles;
};

viewer::Bounds bounds_of(std::span<const float> positions) {
    viewer::Bounds bounds = {glm::vec3(HUGE_VALF), glm::vec3(-HUGE_VALF)};
    for (size_t i = 0; i + 2 < positions.size(); i += 3) {
        const glm::vec3 position(positions[i], positions[i + 1], positions[i + 2]);
        bounds.low = glm::min(bounds.low, position);
        bounds.high = glm::max(bounds.high, position);
    }
    return bounds;
}

/// Makes the triangles that the options ask for: first for a camera that sees the control mesh, then, with
/// the surface measured, for the one that the picture is taken with.
Result<Scene> build_scene(const Options& options, const viewer::GraphicsDevice& graphics, VkExtent2D extent,
                          const ModelTables& model) {
    const vk::Device& device = graphics.device();
    RateSettings rates = rate_settings_of(options.look);
    if (auto limited = limit_rates(model.mesh(), rates); !limited)
        return Error{limited.error().code, printable(options.model) + ": " + limited.error().message};
    auto kernels = viewer::SurfaceKernels::create(device, options.hardware && graphics.has_tessellation_shader());
    if (!kernels) return kernels.error();
    auto shared_kernels = std::make_unique<viewer::SurfaceKernels>(std::move(*kernels));
    const viewer::CameraView camera = camera_view(options.look);
    const viewer::RenderSettings settings = settings_of(options.look, camera);
    auto surface = viewer::SurfaceMesh::create(device, *shared_kernels, model.mesh(),
                                               {.mode = rates.mode, .places = needs_places(settings.color)});
    if (!surface) return surface.error();
    const float aspect = static_cast<float>(extent.width) / static_cast<float>(extent.height);
    const viewer::Bounds around = bounds_of(model.positions());
    rates.camera = viewer::rate_camera(viewer::Camera::frame(around, camera, aspect), extent.width, extent.height);
    if (const auto done = surface->tessellate(rates); !done) return done.error();
    const auto bounds = surface->measure();
    if (!bounds) return bounds.error();
    const viewer::Renderer::View view = {viewer::Camera::frame(*bounds, camera, aspect), *bounds, settings};
    rates.camera = viewer::rate_camera(view.camera, extent.width, extent.height);
    if (options.hardware)
        if (auto prepared = surface->prepare({.mode = rates.mode, .hardware = true}); !prepared)
            return prepared.error();
    const auto triangles = surface->tessellate(rates);
    if (!triangles) return triangles.error();
    return Scene{std::move(shared_kernels), std::move(*surface), view, *triangles};
}

void print_times(const Scene& scene, viewer::PassTimer& timer) {
    if (scene.surface.options().hardware)
        std::printf("%s by hardware tessellation", plural(scene.surface.face_count(), "ptex face").c_str());
    else
        std::printf("%s, %s", plural(scene.triangles.triangle_count, "triangle").c_str(),
                    scene.triangles.vertex_count == 1
                        ? "1 vertex"
                        : (std::to_string(scene.triangles.vertex_count) + " vertices").c_str());
    std::printf("\n");
    for (const auto& pass : timer.read()) std::printf("%-12s %8.2f ms\n", pass.name, pass.milliseconds);
}

Result<viewer::Picture> draw(const Options& options, const viewer::GraphicsDevice& graphics,
                             viewer::Renderer& renderer, const ModelTables& model, Progress& progress) {
    const vk::Device& device = graphics.device();
    progress.show("tessellating " + plural(model.mesh().face_count, "face"));
    auto scene = build_scene(options, graphics, renderer.extent(), model);
    if (!scene) return scene.error();
    if (options.hardware)
        if (auto prepared = renderer.prepare_hardware(*scene->kernels->hardware, scene->surface.scheme()); !prepared)
            return prepared.error();
    if (scene->triangles.status != vk::TessellationStatus::complete) {
        progress.clear();
        std::fprintf(stderr, "limn: note: %s holds at most %s at once: rates are scaled by %.3g\n",
                     device.name(), plural(scene->surface.options().triangle_capacity, "triangle").c_str(),
                     static_cast<double>(scene->triangles.rate_scale));
    }
    progress.show(std::string("drawing on ") + device.name());
    viewer::PassTimer timer(device);
    auto picture = draw_scene(device, renderer, scene->surface.mesh(), scene->surface.control_lines(), scene->view, timer);
    if (picture && options.times) print_times(*scene, timer);
    return picture;
}

/// By a scheme without patches.
Result<viewer::Picture> draw_evenly(const Options& options, const SubdivisionScheme& scheme,
                                    const viewer::GraphicsDevice& graphics, viewer::Renderer& renderer,
                                    Progress& progress) {
    const Result<LoadedModel> loaded = load_model(options.model, options.surface);
    if (!loaded) return loaded.error();
    note_left_out(options.model, *loaded, scheme, progress);
    viewer::PassTimer timer(graphics.device());
    auto evaluator = vk::SchemeEvaluator::create(graphics.device());
    if (!evaluator) return evaluator.error();
    auto drawn = draw_scheme({options.model, *loaded, scheme, options.look.rate.value_or(kEvenRate), options.look},
                             graphics.device(), *evaluator, renderer, timer, progress);
    if (!drawn) return drawn.error();
    if (options.times) {
        std::printf("%s, %s\n", plural(drawn->triangle_count, "triangle").c_str(),
                    (std::to_string(drawn->vertex_count) + " vertices").c_str());
        for (const auto& pass : timer.read()) std::printf("%-12s %8.2f ms\n", pass.name, pass.milliseconds);
    }
    return std::move(drawn->picture);
}

// What there is to see of triangles and patches is not known to the stages.
bool is_drawn_by_hardware(const LookOptions& look) {
    return !look.wireframe && look.color != "kind" && look.color != "level";
}

int run(const Options& options) {
    if (options.hardware && !is_drawn_by_hardware(options.look)) {
        std::fprintf(stderr, "limn: --hardware-tessellation draws no wireframe and no colours by kind or level\n");
        return kBadUsage;
    }
    const SubdivisionScheme* scheme = scheme_drawn_evenly(options.model, options.surface);
    if (scheme != nullptr)
        if (const std::string wrong = check_even_look(options.look, options.hardware); !wrong.empty()) {
            std::fprintf(stderr, "limn: %s\n", wrong.c_str());
            return kBadUsage;
        }
    Progress progress;
    std::optional<ModelTables> model;
    if (scheme == nullptr) {
        Result<ModelTables> tables = ModelTables::load(options.model, options.surface, "none", {}, progress);
        if (!tables) return fail(tables.error());
        model.emplace(std::move(*tables));
    } else if (const Result<LoadedModel> readable = load_model(options.model, options.surface); !readable) {
        return fail(readable.error());
    }
    const auto graphics = viewer::GraphicsDevice::create(
        {.device_index = graphics_device_index(options.device), .validation = options.device.validation});
    if (!graphics) return fail(graphics.error());
    auto file = FileWriter::create(options.output);  // sooner than the work for it
    if (!file) return fail(file.error());
    Result<viewer::Picture> picture = viewer::Picture{};
    {
        auto renderer = viewer::Renderer::create(graphics->device());
        if (!renderer) return fail(renderer.error());
        const PictureSize size = *parse_size(options.size);
        if (auto sized = renderer->resize({size.width, size.height}); !sized) {
            fail(sized.error());
            return sized.error().code == ErrorCode::unsupported ? kBadUsage : kBadInput;
        }
        picture = scheme == nullptr ? draw(options, *graphics, *renderer, *model, progress)
                                    : draw_evenly(options, *scheme, *graphics, *renderer, progress);
    }
    if (!picture) return fail(picture.error());
    if (auto silent = graphics->check_validation(); !silent) return fail(silent.error());
    progress.show("writing " + options.output);
    if (auto done = viewer::write_png(std::move(*file), *picture); !done) return fail(done.error());
    return 0;
}

#endif

}  // namespace

void add_render(CLI::App& program, int& status) {
    CLI::App* command = program.add_subcommand("render", "Draw the limit surface into a PNG file");
#ifdef LIMN_HAVE_PICTURES
    auto options = std::make_shared<Options>();
    command->add_option("MODEL", options->model, "OBJ file, or one of limn bake")->required();
    command->add_option("-o,--output", options->output, "PNG file to write")->required();
    add_size_option(*command, options->size);
    command->add_flag("--times", options->times, "Print what each pass takes on the device");
    command->add_flag("--hardware-tessellation", options->hardware,
                      "Draw with the device's tessellation stages: nothing is kept of vertices and triangles");
    add_look_options(*command, options->look);
    add_surface_options(*command, options->surface, SchemesTaken::all);
    add_graphics_device_option(*command, options->device);
    command->callback([options, command, &status] {
        check_baked_usage(*command, options->model);
        status = run(*options);
    });
#else
    command->allow_extras();
    command->callback([&status] {
        status =
            fail({ErrorCode::no_device, "render: this build has no pictures: libpng or GLM was missing"});
    });
#endif
}

}  // namespace limn::cli
