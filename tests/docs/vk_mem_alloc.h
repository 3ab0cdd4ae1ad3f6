// The declarations of the Vulkan Memory Allocator that docs/integrating.md uses: Debian 12 has no package of it.
#pragma once

#include <vulkan/vulkan_core.h>

using VmaAllocator = struct VmaAllocator_T*;
using VmaAllocation = struct VmaAllocation_T*;
enum { VMA_ALLOCATION_CREATE_MAPPED_BIT = 4 };
struct VmaAllocationCreateInfo {
    uint32_t flags;
    int usage;
    VkMemoryPropertyFlags requiredFlags, preferredFlags;
};
struct VmaAllocationInfo {
    uint32_t memoryType;
    VkDeviceMemory deviceMemory;
    VkDeviceSize offset, size;
    void* pMappedData;
};
VkResult vmaAllocateMemory(VmaAllocator, const VkMemoryRequirements*, const VmaAllocationCreateInfo*, VmaAllocation*,
                           VmaAllocationInfo*);
void vmaFreeMemory(VmaAllocator, VmaAllocation);
