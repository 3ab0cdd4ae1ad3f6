#include "viewer/handles.h"

namespace limn::viewer {
namespace {

/// Device-local where there is such a type.
uint32_t choose_memory_type(const vk::Device& device, uint32_t type_bits) {
    const VkPhysicalDeviceMemoryProperties& memory = device.memory_properties;
    uint32_t any = 0;
    for (uint32_t i = memory.memoryTypeCount; i-- > 0;) {
        if ((type_bits >> i & 1) == 0) continue;
        any = i;
        if (memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) return i;
    }
    return any;
}

}  // namespace

Result<UniqueImageView> create_image_view(const vk::Device& device, VkImage image, VkFormat format,
                                          VkImageAspectFlags aspect) {
    VkImageViewCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    info.image = image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = format;
    info.subresourceRange = {aspect, 0, 1, 0, 1};
    return create_unique<UniqueImageView>(device.handle, vkCreateImageView, info, "vkCreateImageView");
}

Result<GpuImage> create_image(const vk::Device& device, const GpuImageInfo& wanted) {
    GpuImage out;
    out.extent = wanted.extent;
    out.format = wanted.format;
    VkImageCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.flags = wanted.flags;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = wanted.format;
    info.extent = {wanted.extent.width, wanted.extent.height, 1};
    info.mipLevels = 1;
    info.arrayLayers = 1;
    info.samples = wanted.samples;
    info.usage = wanted.usage;
    auto image = create_unique<UniqueImage>(device.handle, vkCreateImage, info, "vkCreateImage");
    if (!image) return image.error();
    VkMemoryRequirements requirements;
    vkGetImageMemoryRequirements(device.handle, *image, &requirements);
    VkMemoryAllocateInfo allocate = {};
    allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate.allocationSize = requirements.size;
    allocate.memoryTypeIndex = choose_memory_type(device, requirements.memoryTypeBits);
    auto memory = create_unique<UniqueMemory>(device.handle, vkAllocateMemory, allocate, "vkAllocateMemory");
    if (!memory) return memory.error();
    if (const VkResult result = vkBindImageMemory(device.handle, *image, *memory, 0); result != VK_SUCCESS)
        return vk::vulkan_error("vkBindImageMemory", result);
    auto view = create_image_view(device, *image, wanted.format, wanted.aspect);
    if (!view) return view.error();
    out.memory = std::move(*memory);
    out.image = std::move(*image);
    out.view = std::move(*view);
    return out;
}

}  // namespace limn::viewer
