// The allocator of docs/integrating.md, compiled.
#include "vk_mem_alloc.h"

#include <limn/vulkan/context.h>

namespace {

// [docs]
VkResult allocate(void* user, const VkMemoryRequirements& requirements, limn::vk::MemoryUse use,
                  limn::vk::MemoryBlock* block) {
    VmaAllocationCreateInfo wanted = {};
    if (use == limn::vk::MemoryUse::device) {
        wanted.preferredFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    } else {
        wanted.flags = VMA_ALLOCATION_CREATE_MAPPED_BIT;
        wanted.requiredFlags = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        if (use == limn::vk::MemoryUse::readback) wanted.preferredFlags = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    }
    VmaAllocation allocation = nullptr;
    VmaAllocationInfo info = {};
    const VkResult result =
        vmaAllocateMemory(static_cast<VmaAllocator>(user), &requirements, &wanted, &allocation, &info);
    if (result == VK_SUCCESS) *block = {info.deviceMemory, info.offset, info.pMappedData, allocation};
    return result;
}

void release(void* user, const limn::vk::MemoryBlock& block) {
    vmaFreeMemory(static_cast<VmaAllocator>(user), static_cast<VmaAllocation>(block.user));
}

limn::vk::Allocator make_allocator(VmaAllocator allocator) {
    return {.user = allocator, .allocate = allocate, .free = release};
}
// [/docs]

}  // namespace

limn::vk::Allocator docs_allocator(VmaAllocator allocator);
limn::vk::Allocator docs_allocator(VmaAllocator allocator) {
    return make_allocator(allocator);
}
