// Options that limn render and limn view share, and what becomes of them.
#pragma once

#include "cli/program.h"
#include "viewer/scene.h"
#include "viewer/surface_mesh.h"

namespace limn::cli {

/// How pictures look. CLI11 has checked the texts.
struct LookOptions {
    std::string camera = "30,20";
    std::string color = "clay";
    std::string background = "studio";
    std::optional<float> rate, pixel_error, edge_pixels, chord_error;  ///< one at most
    bool wireframe = false, control_mesh = false, no_ground = false;
};
void add_look_options(CLI::App& command, LookOptions& options);
viewer::CameraView camera_view(const LookOptions& options);
viewer::RenderSettings settings_of(const LookOptions& options, const viewer::CameraView& camera);
/// Mode and value; a pixel error of kPixelError where nothing is said.
RateSettings rate_settings_of(const LookOptions& options);
inline constexpr float kPixelError = 0.05f;

/// As add_device_option, but 'cpu' is a Vulkan device of type CPU: drawing takes one.
void add_graphics_device_option(CLI::App& command, DeviceOption& option);
uint32_t graphics_device_index(const DeviceOption& option);

/// Names of ColorMode, in its order.
std::vector<std::string> color_names();

}  // namespace limn::cli
