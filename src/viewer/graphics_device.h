// A Vulkan device that draws, lent to limn: what an engine has before it calls limn.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "limn/vulkan/context.h"

namespace limn::viewer {

struct GraphicsDeviceOptions {
    uint32_t device_index = vk::kAutomaticDevice;  ///< as vk::ContextOptions
    bool validation = false;                       ///< as vk::ContextOptions
    std::vector<const char*> instance_extensions;  ///< that a window needs
    /// Null without a window. Else: can this queue family of the device show pictures? The device then has
    /// VK_KHR_swapchain.
    bool (*can_present)(VkInstance, VkPhysicalDevice, uint32_t queue_family_index) = nullptr;
};

/// Owns instance and device; outlives all that is made from them. Moving it does not move the device.
class GraphicsDevice {
  public:
    /// Errors: no_device (no loader, no driver, no such device, none that draws), unsupported (validation
    /// asked for and the layer is not installed), vulkan_failure.
    static Result<GraphicsDevice> create(const GraphicsDeviceOptions& options);
    GraphicsDevice(GraphicsDevice&&) noexcept;
    ~GraphicsDevice();

    /// With a queue that draws, computes and copies.
    const vk::Device& device() const { return context_->device(); }
    /// The feature tessellationShader is there, and enabled.
    bool has_tessellation_shader() const { return has_tessellation_shader_; }

    /// Validation errors and warnings so far. 0 and "" without validation.
    uint32_t validation_message_count() const;
    std::string first_validation_message() const;
    /// An error when there was any.
    Result<void> check_validation() const;

  private:
    struct Owned;
    GraphicsDevice();
    std::unique_ptr<Owned> owned_;
    std::optional<vk::Context> context_;  ///< borrows from owned_
    bool has_tessellation_shader_ = false;
};

}  // namespace limn::viewer
