// limn render: a picture of the limit surface.
#include "cli/program.h"

#ifdef LIMN_HAVE_PICTURES
#include "cli/picture_options.h"
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
};

/// Evaluates, measures, draws, reads back.
Result<viewer::Picture> draw(const Options& options, const vk::Device& device, viewer::Renderer& renderer,
                             const LoadedModel& loaded, Progress& progress) {
    progress.show("building tables of " + plural(loaded.mesh.face_count(), "face"));
    auto surface =
        viewer::SurfaceMesh::create(device, loaded.mesh, loaded.model.positions, mesh_options(options.look));
    if (!surface) return surface.error();
    viewer::PassTimer timer(device);
    auto evaluate = vk::Commands::begin(device);
    if (!evaluate) return evaluate.error();
    surface->record(*evaluate);
    if (auto done = evaluate->submit_and_wait(); !done) return done.error();
    const auto bounds = surface->measure();
    if (!bounds) return bounds.error();
    progress.show(std::string("drawing on ") + device.name());
    renderer.set_scene(surface->mesh(), surface->control_lines());
    auto commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    timer.record_begin(*commands);
    const VkExtent2D extent = renderer.extent();
    const float aspect = static_cast<float>(extent.width) / static_cast<float>(extent.height);
    const viewer::CameraView camera = camera_view(options.look);
    renderer.record(
        *commands,
        {viewer::Camera::frame(*bounds, camera, aspect), *bounds, settings_of(options.look, camera)}, &timer);
    renderer.record_finish(*commands);
    renderer.record_readback(*commands);
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    if (options.times)
        for (const auto& pass : timer.read()) std::printf("%-12s %8.2f ms\n", pass.name, pass.milliseconds);
    return renderer.read_picture();
}

int run(const Options& options) {
    Progress progress;
    progress.show("reading " + options.model);
    const Result<LoadedModel> loaded = load_model(options.model, options.surface);
    if (!loaded) return fail(loaded.error());
    const auto graphics = viewer::GraphicsDevice::create(
        {.device_index = graphics_device_index(options.device), .validation = options.device.validation});
    if (!graphics) return fail(graphics.error());
    Result<viewer::Picture> picture = viewer::Picture{};
    {
        auto renderer = viewer::Renderer::create(graphics->device());
        if (!renderer) return fail(renderer.error());
        if (auto sized = renderer->resize(*parse_size(options.size)); !sized) {
            fail(sized.error());
            return sized.error().code == ErrorCode::unsupported ? kBadUsage : kBadInput;
        }
        picture = draw(options, graphics->device(), *renderer, *loaded, progress);
    }
    if (!picture) return fail(picture.error());
    if (auto silent = graphics->check_validation(); !silent) return fail(silent.error());
    progress.show("writing " + options.output);
    if (auto done = viewer::write_png(options.output, *picture); !done) return fail(done.error());
    return 0;
}

#endif

}  // namespace

void add_render(CLI::App& program, int& status) {
    CLI::App* command = program.add_subcommand("render", "Draw the limit surface into a PNG file");
#ifdef LIMN_HAVE_PICTURES
    auto options = std::make_shared<Options>();
    command->add_option("MODEL", options->model, "OBJ file")->required();
    command->add_option("-o,--output", options->output, "PNG file to write")->required();
    add_size_option(*command, options->size);
    command->add_flag("--times", options->times, "Print what each pass takes on the device");
    add_look_options(*command, options->look);
    add_surface_options(*command, options->surface);
    add_graphics_device_option(*command, options->device);
    command->callback([options, &status] { status = run(*options); });
#else
    command->allow_extras();
    command->callback([&status] {
        status =
            fail({ErrorCode::no_device, "render: this build has no pictures: libpng or GLM was missing"});
    });
#endif
}

}  // namespace limn::cli
