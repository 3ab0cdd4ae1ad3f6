// The user interface over the picture: Dear ImGui.
#pragma once

#include <span>

#include "viewer/pass_timer.h"
#include "viewer/scene.h"
#include "viewer/window.h"

namespace limn::viewer {

/// How rates are made, in the order of the panel's list.
enum class RateChoice : int { uniform, pixel_error, edge_length, chord_error };

/// What the user has chosen. Schemes and colours are indices of the lists that view() was given.
struct PanelState {
    int scheme = 0;
    RateChoice rate_choice = RateChoice::pixel_error;
    float rate_values[4] = {8, 0.1f, 8, 1e-3f};  ///< of each choice; chord errors relative to the radius
    bool frozen = false;                         ///< rates stay, vertices move
    int color = 0;
    int sky_directions = 64;
    bool animate = false;
    float amplitude = 1;
    RenderSettings settings;
    bool frame_all = false;  ///< asked for in this frame
};

/// What the panel tells.
struct PanelFacts {
    const char* model = "";
    const char* device = "";
    uint64_t vertices = 0, triangles = 0;
    double frame_milliseconds = 0;  ///< from picture to picture
    std::span<const PassTimer::Pass> passes;
    const std::string* message = nullptr;  ///< why the last choice did not work; empty when it did
};

/// Dear ImGui on a window and a device. One at a time.
class Panel {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<Panel> create(const vk::Device& device, const Window& window);
    Panel(Panel&&) noexcept;
    ~Panel();

    /// Lays out a frame. After the window's events have been polled.
    void build(PanelState& state, const PanelFacts& facts, std::span<const std::string> schemes,
               std::span<const std::string> colors);
    /// The mouse, where the panel does not want it: what to do to the camera.
    struct Drag {
        float orbit[2] = {}, pan[2] = {};  ///< pixels
        float zoom = 0;                    ///< steps of the wheel
    };
    Drag drag() const;

    /// Draws over `view`, a colour attachment of kRawColorFormat: from COLOR_ATTACHMENT_OPTIMAL to the same.
    /// Errors: out_of_memory, vulkan_failure.
    Result<void> record(VkCommandBuffer commands, VkImageView view, VkExtent2D extent);

  private:
    struct State;
    explicit Panel(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace limn::viewer
