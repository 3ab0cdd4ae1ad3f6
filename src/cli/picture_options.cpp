#include "cli/picture_options.h"

#include <algorithm>
#include <charconv>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <string>

namespace limn::cli {
namespace {

constexpr const char* kColors[] = {"clay",    "kind",  "level",    "curvature", "rate",
                                   "normals", "sides", "gaussian", "principal"};

glm::vec3 linear_from_srgb(const glm::vec3& c) {
    return glm::mix(glm::pow((c + 0.055f) / 1.055f, glm::vec3(2.4f)), c / 12.92f,
                    glm::lessThan(c, glm::vec3(0.04045f)));
}

/// studio, dark, white or #rrggbb.
std::optional<viewer::Background> parse_background(const std::string& text) {
    if (text == "studio") return viewer::Background{};
    if (text == "dark") return viewer::Background{glm::vec3(0.085f, 0.09f, 0.10f), glm::vec3(0.012f)};
    if (text == "white") return viewer::Background{glm::vec3(1), glm::vec3(1)};
    uint32_t rgb = 0;
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, rgb, 16);
    if (error != std::errc() || end != text.data() + 7) return std::nullopt;
    const glm::vec3 color(rgb >> 16, rgb >> 8 & 255, rgb & 255);
    return viewer::Background{linear_from_srgb(color / 255.0f), linear_from_srgb(color / 255.0f)};
}

void add_rate_options(CLI::App& command, LookOptions& options) {
    const char* group = "Triangles (one of these; else --pixel-error 0.05)";
    const auto positive = [](const std::string& text) {
        float value = 0;
        return CLI::detail::lexical_cast(text, value) && value > 0 && value <= 1e30f
                   ? std::string()
                   : "'" + text + "' is not a number above 0";
    };
    const auto add = [&](const char* name, std::optional<float>& value, const char* help) {
        return command.add_option(name, value, help)->group(group)->check(positive);
    };
    CLI::Option* choices[] = {
        add("--rate", options.rate, "So many along each side of a face, 1 to 64")->check(CLI::Range(1, 64)),
        add("--pixel-error", options.pixel_error, "As few as miss the surface by at most so many pixels"),
        add("--edge-pixels", options.edge_pixels, "Edges of about so many pixels"),
        add("--chord-error", options.chord_error, "As few as miss the surface by at most this length")};
    for (CLI::Option* one : choices)
        for (CLI::Option* other : choices)
            if (one != other) one->excludes(other);
}

}  // namespace

std::vector<std::string> color_names() {
    return {std::begin(kColors), std::end(kColors)};
}

void add_look_options(CLI::App& command, LookOptions& options) {
    const char* group = "Look";
    command
        .add_option("--camera", options.camera,
                    "AZIMUTH,ELEVATION[,DISTANCE[,FOV]]: degrees around the model and above it, radii of the "
                    "model away (default: so that it fits), vertical field of view")
        ->check([](const std::string& text) {
            const auto view = viewer::parse_camera(text);
            return view ? std::string() : view.error().message;
        })
        ->capture_default_str()
        ->group(group);
    command
        .add_option(
            "--color", options.color,
            "Clay, or the patch's kind, its level, the mean curvature (blue is concave, red convex), the "
            "Gaussian one (blue are saddles), the larger principal one, the tessellation rate, normals; "
            "sides: "
            "where a closed surface has a crack, magenta shows")
        ->transform(
            CLI::Transformer(std::map<std::string, std::string>{{"mean", "curvature"}}).description(""))
        ->check(CLI::IsMember(color_names()))
        ->capture_default_str()
        ->group(group);
    add_rate_options(command, options);
    command.add_flag("--wireframe", options.wireframe, "Draw the edges of triangles")->group(group);
    command.add_flag("--control-mesh", options.control_mesh, "Draw the control mesh")->group(group);
    command.add_option("--background", options.background, "studio, dark, white or #rrggbb")
        ->check([](const std::string& text) {
            return parse_background(text)
                       ? std::string()
                       : "a background is studio, dark, white or #rrggbb, not '" + text + "'";
        })
        ->capture_default_str()
        ->group(group);
    command.add_flag("--no-ground", options.no_ground, "No ground, and no shadows on it")->group(group);
}

viewer::CameraView camera_view(const LookOptions& options) {
    return *viewer::parse_camera(options.camera);
}

viewer::RenderSettings settings_of(const LookOptions& options, const viewer::CameraView& camera) {
    viewer::RenderSettings settings;
    const auto color = std::find(std::begin(kColors), std::end(kColors), options.color);
    settings.color = static_cast<viewer::ColorMode>(color - std::begin(kColors));
    settings.wireframe = options.wireframe;
    settings.lines = options.control_mesh;
    settings.ground = !options.no_ground;
    settings.background = *parse_background(options.background);
    settings.key_azimuth = camera.azimuth - 42;  // over the photographer's shoulder
    return settings;
}

RateSettings rate_settings_of(const LookOptions& options) {
    RateSettings settings;
    const struct {
        std::optional<float> value;
        RateMode mode;
    } choices[] = {{options.rate, RateMode::uniform},
                   {options.edge_pixels, RateMode::screen_length},
                   {options.chord_error, RateMode::chord_error},
                   {options.pixel_error, RateMode::pixel_error}};
    settings.mode = RateMode::pixel_error;
    // Curvature is that of single triangles.
    const bool curvature =
        options.color == "curvature" || options.color == "gaussian" || options.color == "principal";
    settings.value = curvature ? 0.5f * kPixelError : kPixelError;
    for (const auto& choice : choices)
        if (choice.value) settings.mode = choice.mode, settings.value = *choice.value;
    return settings;
}

void add_graphics_device_option(CLI::App& command, DeviceOption& option) {
    add_device_option(command, option);
    command.get_option("--device")
        ->description(
            "Vulkan device: a number from 'limn devices'; 'cpu' for the first one that is a CPU; 'auto' for "
            "the "
            "first discrete GPU, else what there is");
}

uint32_t graphics_device_index(const DeviceOption& option) {
    if (option.device == "auto") return vk::kAutomaticDevice;
    if (option.device == "cpu") return vk::kCpuDevice;
    return static_cast<uint32_t>(std::stoul(option.device));
}

}  // namespace limn::cli
