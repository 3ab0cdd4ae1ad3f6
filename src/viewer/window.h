// A window, and the images that it shows.
#pragma once

#include <memory>

#include "viewer/graphics_device.h"
#include "viewer/handles.h"

struct GLFWwindow;

namespace limn::viewer {

/// A window on the display. One at a time.
class Window {
  public:
    /// Errors: no_device (no display, or none that Vulkan can draw to).
    static Result<Window> open(VkExtent2D size, const std::string& title);
    Window(Window&&) noexcept;
    ~Window();

    GLFWwindow* handle() const { return window_; }
    /// Lets it react to the user; false once it has been closed. Waits a little while it is minimised.
    bool poll() const;
    /// Pixels; 0x0 while it is minimised.
    VkExtent2D framebuffer_size() const;
    /// What GraphicsDevice::create takes to draw to it.
    GraphicsDeviceOptions device_options() const;

  private:
    Window() = default;
    GLFWwindow* window_ = nullptr;
};

/// The images of a window, as destinations of copies. One frame at a time.
class Swapchain {
  public:
    /// `device` and `window` outlive it. Errors: unsupported (the window takes no pictures of 8 bits a
    /// channel), vulkan_failure.
    static Result<Swapchain> create(const vk::Device& device, VkInstance instance, const Window& window);
    Swapchain(Swapchain&&) noexcept;
    ~Swapchain();

    /// After the window's size has changed, when nothing is pending.
    Result<void> resize(VkExtent2D size);

    /// The image to draw next; false when the window has changed: resize, then try again.
    Result<bool> acquire();
    /// Begins the commands of a frame: what was recorded before is gone.
    Result<VkCommandBuffer> begin() const;
    /// Fills the acquired image with `source`, in TRANSFER_SRC_OPTIMAL and `extent` pixels large.
    void record_copy(VkCommandBuffer commands, VkImage source, VkExtent2D extent) const;
    /// Ends and submits the commands, waits until the device is done, and shows the image; false as
    /// acquire().
    Result<bool> submit_and_present();

  private:
    Swapchain() = default;
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::viewer
