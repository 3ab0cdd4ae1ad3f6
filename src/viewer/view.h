// limn view: a window on a model.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "limn/baked_mesh.h"
#include "limn/control_mesh.h"
#include "limn/schemes/subdivision_scheme.h"
#include "viewer/picture.h"
#include "viewer/scene.h"
#include "viewer/surface_mesh.h"

namespace limn::viewer {

/// A model under a scheme: with tables, or to be refined evenly.
struct ViewModel {
    std::shared_ptr<const BakedMesh> tables;  ///< of a scheme with patches; the rest is empty then
    ControlMesh mesh;
    std::vector<float> positions;  ///< 3 per vertex
    const SubdivisionScheme* scheme = nullptr;
    std::vector<double> corner_values;  ///< as build_scheme_surface takes them
};

struct ViewOptions {
    std::string title;
    VkExtent2D size = {1280, 800};
    uint32_t device_index = vk::kAutomaticDevice;
    bool validation = false;
    CameraView camera;
    RenderSettings settings;
    RateSettings rates;  ///< mode, uniform or of those that are measured, and value
    bool animate = false;
    std::vector<std::string> schemes, colors;  ///< to choose among; colours in the order of ColorMode
    int scheme = 0;                            ///< to start with
    /// The model under a scheme of `schemes`.
    std::function<Result<ViewModel>(const std::string& scheme)> load;
    /// Not 0: show so many frames, a sixtieth of a second apart, then return the last one as the window shows
    /// it.
    uint32_t frame_count = 0;
};

/// Returns when the window is closed, or after the frames asked for; a picture then. Errors: those of `load`
/// at the start, no_device (no display; no device that shows pictures), out_of_memory, vulkan_failure.
Result<std::optional<Picture>> view(const ViewOptions& options);

}  // namespace limn::viewer
