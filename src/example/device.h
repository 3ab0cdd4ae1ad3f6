// Boring Vulkan: an instance, a device, images, a render pass and a pipeline. Nothing here knows limn.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>

/// An example may end where something fails; an engine would pass the error on.
[[noreturn]] inline void fail(const char* what) {
    std::fprintf(stderr, "example: %s\n", what);
    std::exit(1);
}
inline void check(VkResult result, const char* call) {
    if (result != VK_SUCCESS) fail(call);
}

/// Messages of the validation layers so far, counted by the device's messenger.
struct ValidationLog {
    uint32_t count = 0;
};

struct Gpu {
    VkInstance instance = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queue_family = 0;
};

/// The first device with Vulkan 1.2 and a queue for graphics and compute; no feature is enabled. With `log`:
/// the validation layer with synchronization validation, which must outlive the instance.
Gpu create_gpu(ValidationLog* log);
void destroy_gpu(Gpu& gpu);

struct Image {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
};

/// What one frame draws into: four samples a pixel, resolved into `resolved`.
struct Target {
    Image color, depth, resolved;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
};

inline constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_SRGB, kDepthFormat = VK_FORMAT_D16_UNORM;

/// Clears, draws, resolves, and leaves the picture for vkCmdCopyImageToBuffer.
VkRenderPass create_render_pass(VkDevice device);
Target create_target(const Gpu& gpu, VkRenderPass pass, VkExtent2D size);
void destroy_target(VkDevice device, Target& target);

/// What surface.vert takes.
struct View {
    float clip_from_world[16];
    float eye[4];
};
/// Draws triangles of vertices of six floats, a position and a normal, as surface.vert and surface.frag say.
VkPipelineLayout create_layout(VkDevice device);
VkPipeline create_pipeline(VkDevice device, VkPipelineLayout layout, VkRenderPass pass, VkExtent2D size);
