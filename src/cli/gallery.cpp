// limn gallery: one control mesh under every scheme, in one picture.
#include "cli/program.h"

#ifdef LIMN_HAVE_WINDOW
#include <algorithm>
#include <cmath>

#include "cli/scheme_pictures.h"
#include "limn/file.h"
#include "viewer/caption.h"
#include "viewer/graphics_device.h"
#endif

namespace limn::cli {
namespace {

#ifdef LIMN_HAVE_WINDOW

struct Options {
    std::string model, output;
    std::string size = "300x300";  ///< of a tile
    std::vector<std::string> schemes;
    uint32_t columns = 0;
    LookOptions look;
    SurfaceOptions surface;
    DeviceOption device;
};

constexpr float kGalleryRate = 16;
constexpr int kMargin = 6;

/// A tile in the making: a scheme, the model as it takes it, and what that says below its name.
struct Tile {
    const SubdivisionScheme* scheme = nullptr;
    const LoadedModel* model = nullptr;
    std::string title, note;
    bool control_mesh = false;
};

/// The model for each kind of faces that schemes take.
struct Models {
    LoadedModel as_is, triangles, quads;
};

Result<Models> load_models(const Options& options) {
    SurfaceOptions surface = options.surface;
    surface.scheme = "catmark";
    auto as_is = load_model(options.model, surface);
    if (!as_is) return as_is.error();
    surface.triangulate = true;
    auto triangles = load_model(options.model, surface);
    if (!triangles) return triangles.error();
    surface.triangulate = false;
    surface.quads = true;
    auto quads = load_model(options.model, surface);
    if (!quads) return quads.error();
    return Models{std::move(*as_is), std::move(*triangles), std::move(*quads)};
}

Tile tile_of(const SubdivisionScheme& scheme, const Models& models) {
    Tile tile = {&scheme, &models.as_is, scheme.title, ""};
    if (check_scheme_faces(models.as_is.mesh, scheme)) return tile;
    const bool triangles = scheme.faces == FaceKind::triangles;
    tile.model = triangles ? &models.triangles : &models.quads;
    tile.note = triangles ? "of its triangles" : "of its quads";
    return tile;
}

std::vector<Tile> list_tiles(const Options& options, const Models& models) {
    std::vector<Tile> tiles = {{find_subdivision_scheme("bilinear"), &models.as_is, "control mesh", "", true}};
    for (const SubdivisionScheme& scheme : subdivision_schemes()) {
        const auto& wanted = options.schemes;
        const bool chosen = wanted.empty() || std::find(wanted.begin(), wanted.end(), scheme.name) != wanted.end();
        // Linear interpolation is what the control mesh looks like.
        if (chosen && (scheme.rings > 1 || !wanted.empty())) tiles.push_back(tile_of(scheme, models));
    }
    return tiles;
}

void paste(viewer::Picture& sheet, const viewer::Picture& tile, uint32_t x, uint32_t y) {
    for (uint32_t row = 0; row < tile.height; ++row)
        std::copy_n(tile.at(0, row), size_t{3} * tile.width,
                    sheet.rgb.data() + 3 * (size_t{y + row} * sheet.width + x));
}

/// Lines that are no wider than `width` pixels, broken at spaces.
std::vector<std::string> break_lines(const viewer::Captions& captions, const std::string& text, int width) {
    std::vector<std::string> lines = {""};
    for (size_t at = 0, end = 0; at < text.size(); at = end + 1) {
        end = std::min(text.find(' ', at), text.size());
        const std::string word = text.substr(at, end - at);
        const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
        if (lines.back().empty() || captions.width(longer) <= width)
            lines.back() = longer;
        else
            lines.push_back(word);
    }
    return lines;
}

/// Name and note in the upper left corner of a tile.
void write_caption(const viewer::Captions& captions, const Tile& tile, viewer::Picture& picture) {
    const int width = static_cast<int>(picture.width) - 2 * kMargin;
    int top = kMargin;
    const auto write = [&](const std::string& text, std::array<uint8_t, 3> color) {
        for (const std::string& line : break_lines(captions, text, width)) {
            captions.draw(picture, kMargin, top, line, color);
            top += captions.height();
        }
    };
    write(tile.title, {20, 20, 24});
    write(tile.note, {90, 90, 96});
}

uint32_t column_count(const Options& options, size_t tiles) {
    if (options.columns != 0) return options.columns;
    return static_cast<uint32_t>(std::ceil(std::sqrt(1.2 * static_cast<double>(tiles))));
}

Result<viewer::Picture> draw_gallery(const Options& options, const Models& models,
                                     const viewer::GraphicsDevice& graphics, viewer::Renderer& renderer,
                                     Progress& progress) {
    const std::vector<Tile> tiles = list_tiles(options, models);
    const PictureSize size = *parse_size(options.size);
    const uint32_t columns = column_count(options, tiles.size());
    const auto rows = (static_cast<uint32_t>(tiles.size()) + columns - 1) / columns;
    viewer::Picture sheet = {columns * size.width, rows * size.height, {}};
    sheet.rgb.assign(size_t{3} * sheet.width * sheet.height, 255);
    auto evaluator = vk::SchemeEvaluator::create(graphics.device());
    if (!evaluator) return evaluator.error();
    const viewer::Captions captions(13);
    std::optional<viewer::Bounds> bounds;  // of the control mesh: all tiles have one scale
    for (uint32_t i = 0; i < tiles.size(); ++i) {
        const Tile& tile = tiles[i];
        LookOptions look = options.look;
        look.control_mesh = look.control_mesh || tile.control_mesh;
        viewer::PassTimer timer(graphics.device());
        auto drawn = draw_scheme({options.model, *tile.model, *tile.scheme, tile.control_mesh ? 1 : look.rate.value_or(kGalleryRate),
                                  look, bounds ? &*bounds : nullptr},
                                 graphics.device(), *evaluator, renderer, timer, progress);
        if (!drawn) return drawn.error();
        if (!bounds) bounds = drawn->bounds;
        write_caption(captions, tile, drawn->picture);
        paste(sheet, drawn->picture, i % columns * size.width, i / columns * size.height);
    }
    return sheet;
}

int run(const Options& options) {
    if (const std::string wrong = check_even_look(options.look, false); !wrong.empty()) {
        std::fprintf(stderr, "limn: %s\n", wrong.c_str());
        return kBadUsage;
    }
    Progress progress;
    const auto models = load_models(options);
    if (!models) return fail(models.error());
    const auto graphics = viewer::GraphicsDevice::create(
        {.device_index = graphics_device_index(options.device), .validation = options.device.validation});
    if (!graphics) return fail(graphics.error());
    auto file = FileWriter::create(options.output);
    if (!file) return fail(file.error());
    Result<viewer::Picture> picture = viewer::Picture{};
    {
        auto renderer = viewer::Renderer::create(graphics->device());
        if (!renderer) return fail(renderer.error());
        const PictureSize size = *parse_size(options.size);
        if (auto sized = renderer->resize({size.width, size.height}); !sized) return fail(sized.error());
        picture = draw_gallery(options, *models, *graphics, *renderer, progress);
    }
    progress.clear();
    if (!picture) return fail(picture.error());
    if (auto silent = graphics->check_validation(); !silent) return fail(silent.error());
    if (auto done = viewer::write_png(std::move(*file), *picture); !done) return fail(done.error());
    return 0;
}

#endif

}  // namespace

void add_gallery(CLI::App& program, int& status) {
    CLI::App* command =
        program.add_subcommand("gallery", "Draw one control mesh under every scheme into one PNG file");
#ifdef LIMN_HAVE_WINDOW
    auto options = std::make_shared<Options>();
    command->add_option("MODEL", options->model, "OBJ file")->required();
    command->add_option("-o,--output", options->output, "PNG file to write")->required();
    add_size_option(*command, options->size);
    command->get_option("--size")->description("Pixels of each picture, WIDTHxHEIGHT");
    command->add_option("--schemes", options->schemes, "Some of the schemes alone: names with commas between")
        ->delimiter(',')
        ->check(CLI::IsMember(all_scheme_names()));
    command->add_option("--columns", options->columns, "Pictures side by side")->check(CLI::Range(1u, 64u));
    add_look_options(*command, options->look);
    add_surface_options(*command, options->surface, SchemesTaken::all);
    for (const char* name : {"--scheme", "--triangulate", "--quads"}) command->remove_option(command->get_option(name));
    add_graphics_device_option(*command, options->device);
    command->footer("A scheme that takes triangles or quads alone has the model cut into triangles, or split into quads.");
    command->callback([options, &status] { status = run(*options); });
#else
    command->allow_extras();
    command->callback([&status] {
        status = fail({ErrorCode::no_device, "gallery: this build has no window toolkit, whose font it takes"});
    });
#endif
}

}  // namespace limn::cli
