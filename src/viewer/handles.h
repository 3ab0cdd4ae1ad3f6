// Vulkan objects that destroy themselves, and images with their memory.
#pragma once

#include <vulkan/vulkan.h>

#include <utility>

#include "limn/vulkan/context.h"

namespace limn::viewer {

/// An object of a device, destroyed with vkDestroy...; the device must be done with it by then.
template <class T, auto destroy>
class Unique {
  public:
    Unique() = default;
    Unique(VkDevice device, T handle) : device_(device), handle_(handle) {}
    Unique(Unique&& other) noexcept
        : device_(other.device_), handle_(std::exchange(other.handle_, T{VK_NULL_HANDLE})) {}
    Unique& operator=(Unique&& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Unique() {
        if (handle_ != VK_NULL_HANDLE) destroy(device_, handle_, nullptr);
    }
    operator T() const { return handle_; }

  private:
    VkDevice device_ = VK_NULL_HANDLE;
    T handle_ = VK_NULL_HANDLE;
};

using UniqueImage = Unique<VkImage, vkDestroyImage>;
using UniqueImageView = Unique<VkImageView, vkDestroyImageView>;
using UniqueMemory = Unique<VkDeviceMemory, vkFreeMemory>;
using UniqueSampler = Unique<VkSampler, vkDestroySampler>;
using UniqueRenderPass = Unique<VkRenderPass, vkDestroyRenderPass>;
using UniqueFramebuffer = Unique<VkFramebuffer, vkDestroyFramebuffer>;
using UniquePipeline = Unique<VkPipeline, vkDestroyPipeline>;
using UniquePipelineLayout = Unique<VkPipelineLayout, vkDestroyPipelineLayout>;
using UniqueSetLayout = Unique<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using UniqueDescriptorPool = Unique<VkDescriptorPool, vkDestroyDescriptorPool>;
using UniqueShader = Unique<VkShaderModule, vkDestroyShaderModule>;
using UniqueQueryPool = Unique<VkQueryPool, vkDestroyQueryPool>;
using UniqueCommandPool = Unique<VkCommandPool, vkDestroyCommandPool>;
using UniqueFence = Unique<VkFence, vkDestroyFence>;
using UniqueSemaphore = Unique<VkSemaphore, vkDestroySemaphore>;
using UniqueSwapchain = Unique<VkSwapchainKHR, vkDestroySwapchainKHR>;

/// `create` is vkCreate...: Errors: out_of_memory, vulkan_failure.
template <class U, class T, class Info>
Result<U> create_unique(VkDevice device,
                        VkResult (*create)(VkDevice, const Info*, const VkAllocationCallbacks*, T*),
                        const Info& info, const char* what) {
    T handle = VK_NULL_HANDLE;
    if (const VkResult result = create(device, &info, nullptr, &handle); result != VK_SUCCESS)
        return vk::vulkan_error(what, result);
    return U(device, handle);
}

/// A two-dimensional image of one level, its memory, and a view of all of it. Destroyed in reverse.
struct GpuImage {
    UniqueMemory memory;
    UniqueImage image;
    UniqueImageView view;
    VkExtent2D extent = {};
    VkFormat format = VK_FORMAT_UNDEFINED;
};

struct GpuImageInfo {
    VkExtent2D extent = {};
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkImageUsageFlags usage = 0;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
    VkImageCreateFlags flags = 0;
};

/// Errors: out_of_memory, vulkan_failure.
Result<GpuImage> create_image(const vk::Device& device, const GpuImageInfo& info);
Result<UniqueImageView> create_image_view(const vk::Device& device, VkImage image, VkFormat format,
                                          VkImageAspectFlags aspect);

}  // namespace limn::viewer
