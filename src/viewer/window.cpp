#define GLFW_INCLUDE_VULKAN
#include "viewer/window.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <optional>

namespace limn::viewer {
namespace {

/// What GLFW says last: one line.
std::string& last_words() {
    static std::string words;
    return words;
}

void listen(int, const char* words) {
    last_words() = words;
}

bool can_present(VkInstance instance, VkPhysicalDevice device, uint32_t queue_family_index) {
    return glfwGetPhysicalDevicePresentationSupport(instance, device, queue_family_index) == GLFW_TRUE;
}

/// Eight bits a channel, stored as they are.
std::optional<VkSurfaceFormatKHR> choose_format(VkPhysicalDevice device, VkSurfaceKHR surface) {
    uint32_t count = 0;
    vkGetPhysicalDeviceSurfaceFormatsKHR(device, surface, &count, nullptr);
    std::vector<VkSurfaceFormatKHR> formats(count);
    vkGetPhysicalDeviceSurfaceFormatsKHR(device, surface, &count, formats.data());
    for (const VkSurfaceFormatKHR& format : formats)
        if ((format.format == VK_FORMAT_B8G8R8A8_UNORM || format.format == VK_FORMAT_R8G8B8A8_UNORM) &&
            format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
            return format;
    return std::nullopt;
}

VkImageMemoryBarrier layout_change(VkImage image, VkImageLayout from, VkImageLayout to, VkAccessFlags before,
                                   VkAccessFlags after) {
    VkImageMemoryBarrier barrier = {};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    barrier.srcAccessMask = before;
    barrier.dstAccessMask = after;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    return barrier;
}

}  // namespace

Result<Window> Window::open(VkExtent2D size, const std::string& title) {
    glfwSetErrorCallback(listen);
    if (glfwInit() != GLFW_TRUE)
        return Error{ErrorCode::no_device, "there is no display to open a window on: " + last_words()};
    Window out;
    if (glfwVulkanSupported() != GLFW_TRUE) {
        glfwTerminate();
        return Error{ErrorCode::no_device, "no Vulkan driver here can show pictures in a window"};
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    out.window_ = glfwCreateWindow(static_cast<int>(size.width), static_cast<int>(size.height), title.c_str(),
                                   nullptr, nullptr);
    if (out.window_ == nullptr) {
        glfwTerminate();
        return Error{ErrorCode::no_device, "cannot open a window: " + last_words()};
    }
    return out;
}

Window::Window(Window&& other) noexcept : window_(std::exchange(other.window_, nullptr)) {}

Window::~Window() {
    if (window_ == nullptr) return;
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool Window::poll() const {
    const VkExtent2D size = framebuffer_size();
    if (size.width == 0 || size.height == 0)
        glfwWaitEventsTimeout(0.1);
    else
        glfwPollEvents();
    return glfwWindowShouldClose(window_) == GLFW_FALSE;
}

VkExtent2D Window::framebuffer_size() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

GraphicsDeviceOptions Window::device_options() const {
    GraphicsDeviceOptions options;
    uint32_t count = 0;
    const char** extensions = glfwGetRequiredInstanceExtensions(&count);
    options.instance_extensions.assign(extensions, extensions + count);
    options.can_present = can_present;
    return options;
}

struct Swapchain::State {
    const vk::Device* device = nullptr;
    VkInstance instance = VK_NULL_HANDLE;
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    VkSurfaceFormatKHR format = {};
    VkExtent2D extent = {};
    UniqueSwapchain swapchain;
    std::vector<VkImage> images;
    std::vector<UniqueSemaphore> drawn;  ///< one an image: presenting it waits
    UniqueSemaphore acquired;
    UniqueFence done;
    UniqueCommandPool pool;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    uint32_t image_index = 0;

    Result<void> create_commands();

    ~State() {
        if (device == nullptr) return;
        vkDeviceWaitIdle(device->handle);
        swapchain = {};
        if (surface != VK_NULL_HANDLE) vkDestroySurfaceKHR(instance, surface, nullptr);
    }
};

Result<void> Swapchain::State::create_commands() {
    VkSemaphoreCreateInfo semaphore_info = {};
    semaphore_info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
    auto semaphore = create_unique<UniqueSemaphore>(device->handle, vkCreateSemaphore, semaphore_info,
                                                    "vkCreateSemaphore");
    VkFenceCreateInfo fence_info = {};
    fence_info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    auto fence = create_unique<UniqueFence>(device->handle, vkCreateFence, fence_info, "vkCreateFence");
    VkCommandPoolCreateInfo pool_info = {};
    pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool_info.queueFamilyIndex = device->queue_family_index;
    auto made = create_unique<UniqueCommandPool>(device->handle, vkCreateCommandPool, pool_info,
                                                 "vkCreateCommandPool");
    if (!semaphore) return semaphore.error();
    if (!fence) return fence.error();
    if (!made) return made.error();
    acquired = std::move(*semaphore);
    done = std::move(*fence);
    pool = std::move(*made);
    VkCommandBufferAllocateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    info.commandPool = pool;
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = 1;
    if (const VkResult result = vkAllocateCommandBuffers(device->handle, &info, &commands);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkAllocateCommandBuffers", result);
    return {};
}

Swapchain::Swapchain(Swapchain&&) noexcept = default;
Swapchain::~Swapchain() = default;

Result<Swapchain> Swapchain::create(const vk::Device& device, VkInstance instance, const Window& window) {
    Swapchain out;
    out.state_ = std::make_unique<State>();
    State& state = *out.state_;
    state.device = &device;
    state.instance = instance;
    if (const VkResult result = glfwCreateWindowSurface(instance, window.handle(), nullptr, &state.surface);
        result != VK_SUCCESS)
        return vk::vulkan_error("glfwCreateWindowSurface", result);
    VkBool32 supported = VK_FALSE;
    vkGetPhysicalDeviceSurfaceSupportKHR(device.physical_device, device.queue_family_index, state.surface,
                                         &supported);
    const auto format = choose_format(device.physical_device, state.surface);
    if (supported != VK_TRUE || !format)
        return Error{ErrorCode::unsupported, "the window takes no pictures of 8 bits a channel"};
    state.format = *format;
    if (auto made = state.create_commands(); !made) return made.error();
    if (auto made = out.resize(window.framebuffer_size()); !made) return made.error();
    return out;
}

Result<void> Swapchain::resize(VkExtent2D size) {
    State& state = *state_;
    const vk::Device& device = *state.device;
    vkDeviceWaitIdle(device.handle);
    VkSurfaceCapabilitiesKHR can = {};
    if (const VkResult result =
            vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical_device, state.surface, &can);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkGetPhysicalDeviceSurfaceCapabilitiesKHR", result);
    state.extent = {std::clamp(size.width, can.minImageExtent.width, can.maxImageExtent.width),
                    std::clamp(size.height, can.minImageExtent.height, can.maxImageExtent.height)};
    VkSwapchainCreateInfoKHR info = {};
    info.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR;
    info.surface = state.surface;
    info.minImageCount = can.minImageCount + 1;
    if (can.maxImageCount != 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
    info.imageFormat = state.format.format;
    info.imageColorSpace = state.format.colorSpace;
    info.imageExtent = state.extent;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.preTransform = can.currentTransform;
    info.compositeAlpha = (can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
    info.clipped = VK_TRUE;
    info.oldSwapchain = state.swapchain;
    auto swapchain =
        create_unique<UniqueSwapchain>(device.handle, vkCreateSwapchainKHR, info, "vkCreateSwapchainKHR");
    if (!swapchain) return swapchain.error();
    state.swapchain = std::move(*swapchain);
    uint32_t count = 0;
    vkGetSwapchainImagesKHR(device.handle, state.swapchain, &count, nullptr);
    state.images.resize(count);
    vkGetSwapchainImagesKHR(device.handle, state.swapchain, &count, state.images.data());
    state.drawn.clear();
    VkSemaphoreCreateInfo semaphore_info = {};
    semaphore_info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
    for (uint32_t i = 0; i < count; ++i) {
        auto semaphore = create_unique<UniqueSemaphore>(device.handle, vkCreateSemaphore, semaphore_info,
                                                        "vkCreateSemaphore");
        if (!semaphore) return semaphore.error();
        state.drawn.push_back(std::move(*semaphore));
    }
    return {};
}

Result<bool> Swapchain::acquire() {
    State& state = *state_;
    const VkResult result = vkAcquireNextImageKHR(state.device->handle, state.swapchain, ~uint64_t{0},
                                                  state.acquired, VK_NULL_HANDLE, &state.image_index);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return false;
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR)
        return vk::vulkan_error("vkAcquireNextImageKHR", result);
    return true;
}

Result<VkCommandBuffer> Swapchain::begin() const {
    vkResetCommandPool(state_->device->handle, state_->pool, 0);
    VkCommandBufferBeginInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    if (const VkResult result = vkBeginCommandBuffer(state_->commands, &info); result != VK_SUCCESS)
        return vk::vulkan_error("vkBeginCommandBuffer", result);
    return state_->commands;
}

void Swapchain::record_copy(VkCommandBuffer commands, VkImage source, VkExtent2D extent) const {
    const State& state = *state_;
    const VkImage image = state.images[state.image_index];
    const auto before = layout_change(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                      0, VK_ACCESS_TRANSFER_WRITE_BIT);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &before);
    const auto corner = [](VkExtent2D size) {
        return VkOffset3D{static_cast<int32_t>(size.width), static_cast<int32_t>(size.height), 1};
    };
    VkImageBlit region = {};
    region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.srcOffsets[1] = corner(extent);
    region.dstOffsets[1] = corner(state.extent);
    vkCmdBlitImage(commands, source, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_NEAREST);
    const auto after = layout_change(image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                     VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_ACCESS_TRANSFER_WRITE_BIT, 0);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &after);
}

Result<bool> Swapchain::submit_and_present() {
    State& state = *state_;
    VkResult result = vkEndCommandBuffer(state.commands);
    if (result != VK_SUCCESS) return vk::vulkan_error("vkEndCommandBuffer", result);
    const VkDevice device = state.device->handle;
    const VkSemaphore acquired = state.acquired, drawn = state.drawn[state.image_index];
    const VkFence done = state.done;
    const VkSwapchainKHR swapchain = state.swapchain;
    const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    VkSubmitInfo submit = {};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.waitSemaphoreCount = submit.commandBufferCount = submit.signalSemaphoreCount = 1;
    submit.pWaitSemaphores = &acquired;
    submit.pWaitDstStageMask = &stage;
    submit.pCommandBuffers = &state.commands;
    submit.pSignalSemaphores = &drawn;
    result = vkQueueSubmit(state.device->queue, 1, &submit, done);
    if (result != VK_SUCCESS) return vk::vulkan_error("vkQueueSubmit", result);
    result = vkWaitForFences(device, 1, &done, VK_TRUE, ~uint64_t{0});
    if (result != VK_SUCCESS) return vk::vulkan_error("vkWaitForFences", result);
    vkResetFences(device, 1, &done);
    VkPresentInfoKHR present = {};
    present.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR;
    present.waitSemaphoreCount = present.swapchainCount = 1;
    present.pWaitSemaphores = &drawn;
    present.pSwapchains = &swapchain;
    present.pImageIndices = &state.image_index;
    result = vkQueuePresentKHR(state.device->queue, &present);
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) return false;
    if (result != VK_SUCCESS) return vk::vulkan_error("vkQueuePresentKHR", result);
    return true;
}

}  // namespace limn::viewer
