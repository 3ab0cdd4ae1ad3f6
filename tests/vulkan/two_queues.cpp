// A Vulkan layer for tests, to stand below validation: a device of one queue family shows a second one, for compute and
// transfers, with a queue of its own over the same queue of the driver. Validation then sees two families, and what must
// be said when buffers go from one to the other; the driver sees none of it. For one device at a time.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <mutex>
#include <string_view>
#include <vector>

namespace {

constexpr uint32_t kFamily = 1;  ///< the one that is not there

/// A dispatchable handle: the loader's table comes first.
struct Queue {
    void* dispatch;
    VkQueue real;
};

// clang-format off
#define DEVICE_FUNCTIONS(X) \
    X(GetDeviceQueue) X(QueueSubmit) X(QueueSubmit2) X(QueueWaitIdle) X(DeviceWaitIdle) X(CreateCommandPool) X(CreateBuffer) \
    X(CmdPipelineBarrier) X(CmdPipelineBarrier2) X(DestroyDevice)
// clang-format on

struct {
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    PFN_vkGetDeviceProcAddr get_device_proc_addr;
    VkInstance instance;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties get_queue_families;
#define DECLARE(name) PFN_vk##name name;
    DEVICE_FUNCTIONS(DECLARE)
#undef DECLARE
} next;
std::mutex queue_mutex;  // two queues above are one below
Queue queues[2];

/// The loader's structure that leads to the next layer; it is ours to step on.
template <class Link>
Link* find_link(const void* chain, VkStructureType type) {
    auto* link = static_cast<const Link*>(chain);
    while (link != nullptr && !(link->sType == type && link->function == VK_LAYER_LINK_INFO))
        link = static_cast<const Link*>(link->pNext);
    return const_cast<Link*>(link);
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* host,
                                               VkInstance* instance) {
    auto* link = find_link<VkLayerInstanceCreateInfo>(
        info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
    next.get_instance_proc_addr = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const auto create =
        reinterpret_cast<PFN_vkCreateInstance>(next.get_instance_proc_addr(nullptr, "vkCreateInstance"));
    const VkResult result = create(info, host, instance);
    if (result != VK_SUCCESS) return result;
    next.instance = *instance;
    // Now: once the instance is there, the loader answers with the whole chain.
    next.get_queue_families = reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
        next.get_instance_proc_addr(*instance, "vkGetPhysicalDeviceQueueFamilyProperties"));
    return result;
}

void get_families(VkPhysicalDevice device, std::vector<VkQueueFamilyProperties>& families) {
    uint32_t count = 1;  // of others nothing is shown
    families.resize(1);
    next.get_queue_families(device, &count, families.data());
    families.push_back(families[0]);
    families[kFamily].queueFlags = VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;
    families[kFamily].queueCount = 1;
}

VKAPI_ATTR void VKAPI_CALL get_queue_families(VkPhysicalDevice device, uint32_t* count, VkQueueFamilyProperties* out) {
    std::vector<VkQueueFamilyProperties> families;
    get_families(device, families);
    if (out != nullptr) std::copy_n(families.begin(), std::min(*count, 2u), out);
    *count = out != nullptr ? std::min(*count, 2u) : 2;
}

VKAPI_ATTR void VKAPI_CALL get_queue_families2(VkPhysicalDevice device, uint32_t* count, VkQueueFamilyProperties2* out) {
    std::vector<VkQueueFamilyProperties> families;
    get_families(device, families);
    for (uint32_t f = 0; out != nullptr && f < std::min(*count, 2u); ++f) out[f].queueFamilyProperties = families[f];
    *count = out != nullptr ? std::min(*count, 2u) : 2;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical_device, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* host, VkDevice* device) {
    auto* link = find_link<VkLayerDeviceCreateInfo>(
        info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
    next.get_device_proc_addr = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(
        link->u.pLayerInfo->pfnNextGetInstanceProcAddr(next.instance, "vkCreateDevice"));
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    VkDeviceQueueCreateInfo queue = info->pQueueCreateInfos[0];
    queue.queueFamilyIndex = 0;
    queue.queueCount = 1;
    VkDeviceCreateInfo one_family = *info;
    one_family.queueCreateInfoCount = 1;
    one_family.pQueueCreateInfos = &queue;
    const VkResult result = create(physical_device, &one_family, host, device);
    if (result != VK_SUCCESS) return result;
#define LOAD(name) next.name = reinterpret_cast<PFN_vk##name>(next.get_device_proc_addr(*device, "vk" #name));
    DEVICE_FUNCTIONS(LOAD)
#undef LOAD
    for (Queue& q : queues) {
        next.GetDeviceQueue(*device, 0, 0, &q.real);
        q.dispatch = *reinterpret_cast<void**>(*device);
    }
    return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* host) {
    if (device != VK_NULL_HANDLE) next.DestroyDevice(device, host);
}

VKAPI_ATTR void VKAPI_CALL get_queue(VkDevice, uint32_t family, uint32_t, VkQueue* queue) {
    *queue = reinterpret_cast<VkQueue>(&queues[family]);
}

VkQueue real(VkQueue queue) {
    return reinterpret_cast<Queue*>(queue)->real;
}

VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo* infos, VkFence fence) {
    const std::lock_guard lock(queue_mutex);
    return next.QueueSubmit(real(queue), count, infos, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL submit2(VkQueue queue, uint32_t count, const VkSubmitInfo2* infos, VkFence fence) {
    const std::lock_guard lock(queue_mutex);
    return next.QueueSubmit2(real(queue), count, infos, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL wait_idle(VkQueue queue) {
    const std::lock_guard lock(queue_mutex);
    return next.QueueWaitIdle(real(queue));
}
VKAPI_ATTR VkResult VKAPI_CALL device_wait_idle(VkDevice device) {
    const std::lock_guard lock(queue_mutex);
    return next.DeviceWaitIdle(device);
}

VKAPI_ATTR VkResult VKAPI_CALL create_pool(VkDevice device, const VkCommandPoolCreateInfo* info,
                                           const VkAllocationCallbacks* host, VkCommandPool* pool) {
    VkCommandPoolCreateInfo of_first = *info;
    of_first.queueFamilyIndex = 0;
    return next.CreateCommandPool(device, &of_first, host, pool);
}

VKAPI_ATTR VkResult VKAPI_CALL create_buffer(VkDevice device, const VkBufferCreateInfo* info,
                                             const VkAllocationCallbacks* host, VkBuffer* buffer) {
    VkBufferCreateInfo exclusive = *info;
    exclusive.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    exclusive.queueFamilyIndexCount = 0;
    return next.CreateBuffer(device, &exclusive, host, buffer);
}

/// Barriers without transfers.
template <class Barrier>
std::vector<Barrier> within_family(const Barrier* barriers, uint32_t count) {
    std::vector<Barrier> out(barriers, barriers + count);
    for (Barrier& b : out) b.srcQueueFamilyIndex = b.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    return out;
}

VKAPI_ATTR void VKAPI_CALL barrier(VkCommandBuffer commands, VkPipelineStageFlags before, VkPipelineStageFlags after,
                                   VkDependencyFlags flags, uint32_t memory_count, const VkMemoryBarrier* memory,
                                   uint32_t buffer_count, const VkBufferMemoryBarrier* buffers, uint32_t image_count,
                                   const VkImageMemoryBarrier* images) {
    next.CmdPipelineBarrier(commands, before, after, flags, memory_count, memory, buffer_count,
                            within_family(buffers, buffer_count).data(), image_count,
                            within_family(images, image_count).data());
}
VKAPI_ATTR void VKAPI_CALL barrier2(VkCommandBuffer commands, const VkDependencyInfo* info) {
    const auto buffers = within_family(info->pBufferMemoryBarriers, info->bufferMemoryBarrierCount);
    const auto images = within_family(info->pImageMemoryBarriers, info->imageMemoryBarrierCount);
    VkDependencyInfo within = *info;
    within.pBufferMemoryBarriers = buffers.data();
    within.pImageMemoryBarriers = images.data();
    next.CmdPipelineBarrier2(commands, &within);
}

struct Entry {
    std::string_view name;
    PFN_vkVoidFunction function;
};
template <class Function>
Entry entry(std::string_view name, Function* function) {
    return {name, reinterpret_cast<PFN_vkVoidFunction>(function)};
}

PFN_vkVoidFunction find_own(std::string_view name);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device, const char* name) {
    const PFN_vkVoidFunction own = find_own(name);
    return own != nullptr ? own : next.get_device_proc_addr(device, name);
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_proc_addr(VkInstance instance, const char* name) {
    const PFN_vkVoidFunction own = find_own(name);
    return own != nullptr ? own : next.get_instance_proc_addr(instance, name);
}

PFN_vkVoidFunction find_own(std::string_view name) {
    static const Entry entries[] = {
        entry("vkGetInstanceProcAddr", get_instance_proc_addr),
        entry("vkGetDeviceProcAddr", get_device_proc_addr),
        entry("vkCreateInstance", create_instance),
        entry("vkCreateDevice", create_device),
        entry("vkDestroyDevice", destroy_device),
        entry("vkGetPhysicalDeviceQueueFamilyProperties", get_queue_families),
        entry("vkGetPhysicalDeviceQueueFamilyProperties2", get_queue_families2),
        entry("vkGetPhysicalDeviceQueueFamilyProperties2KHR", get_queue_families2),
        entry("vkGetDeviceQueue", get_queue),
        entry("vkQueueSubmit", submit),
        entry("vkQueueSubmit2", submit2),
        entry("vkQueueWaitIdle", wait_idle),
        entry("vkDeviceWaitIdle", device_wait_idle),
        entry("vkCreateCommandPool", create_pool),
        entry("vkCreateBuffer", create_buffer),
        entry("vkCmdPipelineBarrier", barrier),
        entry("vkCmdPipelineBarrier2", barrier2),
    };
    for (const Entry& e : entries)
        if (e.name == name) return e.function;
    return nullptr;
}

}  // namespace

extern "C" VK_LAYER_EXPORT VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
    version->loaderLayerInterfaceVersion = std::min(version->loaderLayerInterfaceVersion, 2u);
    version->pfnGetInstanceProcAddr = get_instance_proc_addr;
    version->pfnGetDeviceProcAddr = get_device_proc_addr;
    version->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
