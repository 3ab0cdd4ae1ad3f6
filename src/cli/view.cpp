// limn view: a window on a model.
#include "cli/program.h"

#ifdef LIMN_HAVE_WINDOW
#include <algorithm>

#include "cli/model_tables.h"
#include "cli/picture_options.h"
#include "cli/scheme_pictures.h"
#include "limn/file.h"
#include "viewer/view.h"
#endif

namespace limn::cli {
namespace {

#ifdef LIMN_HAVE_WINDOW

struct Options {
    std::string model, screenshot;
    std::string size = "1280x800";
    uint32_t frames = 0;
    bool animate = false;
    LookOptions look;
    SurfaceOptions surface;
    DeviceOption device;
};

/// A baked file has one scheme, whichever is asked for.
Result<viewer::ViewModel> load_view_model(const Options& options, const std::string& scheme) {
    SurfaceOptions surface = options.surface;
    surface.scheme = scheme;
    if (const SubdivisionScheme* even = scheme_drawn_evenly(options.model, surface)) {
        Result<LoadedModel> loaded = load_model(options.model, surface);
        if (!loaded) return loaded.error();
        auto corners = corner_values_of(*loaded, *even);
        if (!corners) return corners.error();
        return viewer::ViewModel{nullptr, std::move(loaded->mesh), std::move(loaded->model.positions), even,
                                 std::move(*corners)};
    }
    Progress progress;
    Result<ModelTables> loaded = ModelTables::load(options.model, surface, "none", {}, progress);
    if (!loaded) return loaded.error();
    const auto tables = std::make_shared<const ModelTables>(std::move(*loaded));
    return viewer::ViewModel{std::shared_ptr<const BakedMesh>(tables, &tables->mesh())};
}

int run(const Options& options) {
    if (scheme_drawn_evenly(options.model, options.surface) != nullptr)
        if (const std::string wrong = check_even_look(options.look, false); !wrong.empty()) {
            std::fprintf(stderr, "limn: %s\n", wrong.c_str());
            return kBadUsage;
        }
    viewer::ViewOptions view;
    view.title = printable(options.model.substr(options.model.rfind('/') + 1));
    const PictureSize size = *parse_size(options.size);
    view.size = {size.width, size.height};
    view.device_index = graphics_device_index(options.device);
    view.validation = options.device.validation;
    view.camera = camera_view(options.look);
    view.settings = settings_of(options.look, view.camera);
    view.rates = rate_settings_of(options.look);
    view.animate = options.animate;
    view.colors = color_names();
    view.load = [&options](const std::string& scheme) { return load_view_model(options, scheme); };
    if (!options.screenshot.empty()) view.frame_count = std::max(options.frames, 1u);
    // A model that cannot be read needs no window to say so.
    const auto first = view.load(options.surface.scheme);
    if (!first) return fail(first.error());
    if (first->tables != nullptr)
        if (auto limited = limit_rates(*first->tables, view.rates); !limited)
            return fail({limited.error().code, printable(options.model) + ": " + limited.error().message});
    view.schemes = all_scheme_names();
    if (is_baked_file(options.model))  // which has one
        view.schemes = {view.schemes[static_cast<size_t>(first->tables->patches.options.scheme)]};
    const auto scheme = std::find(view.schemes.begin(), view.schemes.end(), options.surface.scheme);
    view.scheme = scheme == view.schemes.end() ? 0 : static_cast<int>(scheme - view.schemes.begin());
    std::optional<FileWriter> file;
    if (!options.screenshot.empty()) {
        auto created = FileWriter::create(options.screenshot);
        if (!created) return fail(created.error());
        file.emplace(std::move(*created));
    }
    const auto picture = viewer::view(view);
    if (!picture) return fail(picture.error());
    if (options.screenshot.empty()) return 0;
    if (!*picture)
        return fail({ErrorCode::cannot_open, "the window was closed before its picture was taken"});
    if (auto done = viewer::write_png(std::move(*file), **picture); !done) return fail(done.error());
    return 0;
}

#endif

}  // namespace

void add_view(CLI::App& program, int& status) {
    CLI::App* command = program.add_subcommand("view", "Show the limit surface in a window");
#ifdef LIMN_HAVE_WINDOW
    auto options = std::make_shared<Options>();
    command->add_option("MODEL", options->model, "OBJ file, or one of limn bake")->required();
    add_size_option(*command, options->size);
    command->add_flag("--animate", options->animate, "Move the control points");
    auto* screenshot = command->add_option("--screenshot", options->screenshot,
                                           "Write what the window shows into this PNG file, then end");
    command
        ->add_option("--frames", options->frames, "Frames to show before that, a sixtieth of a second apart")
        ->check(CLI::Range(1u, 100000u))
        ->needs(screenshot);
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
        status = fail({ErrorCode::no_device,
                       "view: this build has no window: libpng, GLM, GLFW or Dear ImGui "
                       "was missing"});
    });
#endif
}

}  // namespace limn::cli
