#include "vulkan/engine.h"

#include <vulkan/vulkan.h>

#include <cstdlib>

namespace limn::vk::test {
namespace {

constexpr VkDeviceSize kBlockBytes = 16 << 20;

}  // namespace

Arena::Arena(const BorrowedHandles& handles, bool map_device_memory)
    : device_(handles.device), map_device_memory_(map_device_memory) {
    VkPhysicalDeviceMemoryProperties properties;
    vkGetPhysicalDeviceMemoryProperties(handles.physical_device, &properties);
    types_.resize(properties.memoryTypeCount);
    constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (uint32_t t = 0; t < types_.size(); ++t)
        if ((properties.memoryTypes[t].propertyFlags & kHost) == kHost) host_types_ |= 1u << t;
}

Arena::~Arena() {
    EXPECT_TRUE(live_.empty()) << live_.size() << " blocks have never been freed";
    for (const Block& block : types_)
        if (block.memory != VK_NULL_HANDLE) vkFreeMemory(device_, block.memory, nullptr);
}

/// First fit in the block of the first type that serves.
VkResult Arena::allocate(void* user, const VkMemoryRequirements& requirements, MemoryUse use, MemoryBlock* block) {
    Arena& arena = *static_cast<Arena*>(user);
    const std::lock_guard lock(arena.mutex_);
    ++arena.allocation_count_;
    if (arena.until_failure_ >= 0 && arena.until_failure_-- == 0) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const bool host = use != MemoryUse::device;
    uint32_t type = 0;
    while (type < arena.types_.size() &&
           ((requirements.memoryTypeBits >> type & 1) == 0 || (host && (arena.host_types_ >> type & 1) == 0)))
        ++type;
    if (type == arena.types_.size()) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    Block& from = arena.types_[type];
    if (from.memory == VK_NULL_HANDLE) {
        VkMemoryAllocateInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        info.allocationSize = kBlockBytes;
        info.memoryTypeIndex = type;
        if (vkAllocateMemory(arena.device_, &info, nullptr, &from.memory) != VK_SUCCESS)
            return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        void* mapped = nullptr;
        if ((arena.host_types_ >> type & 1) != 0 &&
            vkMapMemory(arena.device_, from.memory, 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS)
            return VK_ERROR_MEMORY_MAP_FAILED;
        from.mapped = static_cast<std::byte*>(mapped);
    }
    const VkDeviceSize step = requirements.alignment;
    VkDeviceSize offset = step;
    for (auto it = arena.live_.lower_bound({from.memory, 0}); it != arena.live_.end(); ++it) {
        if (it->first.first != from.memory || offset + requirements.size <= it->first.second) break;
        offset = (it->second.end + step - 1) / step * step;
    }
    if (offset + requirements.size > kBlockBytes) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const bool mapped = from.mapped != nullptr && (host || arena.map_device_memory_);
    *block = {from.memory, offset, mapped ? from.mapped + offset : nullptr, user};
    arena.live_[{from.memory, offset}] = {offset + requirements.size, use};
    arena.live_bytes_[static_cast<size_t>(use)] += requirements.size;
    ++arena.live_count_;
    return VK_SUCCESS;
}

void Arena::free(void* user, const MemoryBlock& block) {
    Arena& arena = *static_cast<Arena*>(user);
    const std::lock_guard lock(arena.mutex_);
    const auto it = arena.live_.find({block.memory, block.offset});
    ASSERT_NE(it, arena.live_.end()) << "freed twice, or never allocated";
    EXPECT_EQ(block.user, user);
    arena.live_bytes_[static_cast<size_t>(it->second.use)] -= it->second.end - block.offset;
    arena.live_.erase(it);
    --arena.live_count_;
}

std::atomic<int> Objects::live = 0, Objects::live_pipelines = 0, Objects::created = 0, Objects::until_failure = -1,
                 Objects::mapped_or_submitted = 0;
std::atomic<VkPipelineCache> Objects::pipeline_cache = VK_NULL_HANDLE;

namespace {

bool creation_fails() {
    ++Objects::created;
    return Objects::until_failure >= 0 && Objects::until_failure-- == 0;
}

/// vkCreate<name> and vkDestroy<name> of one kind of object.
template <class Info, class Handle, VkResult(VKAPI_PTR* kCreate)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*),
          void(VKAPI_PTR* kDestroy)(VkDevice, Handle, const VkAllocationCallbacks*)>
struct Counted {
    static VKAPI_ATTR VkResult VKAPI_CALL create(VkDevice device, const Info* info, const VkAllocationCallbacks* host,
                                                 Handle* out) {
        if (creation_fails()) return VK_ERROR_OUT_OF_HOST_MEMORY;
        const VkResult result = kCreate(device, info, host, out);
        if (result == VK_SUCCESS) ++Objects::live;
        return result;
    }
    static VKAPI_ATTR void VKAPI_CALL destroy(VkDevice device, Handle handle, const VkAllocationCallbacks* host) {
        if (handle != VK_NULL_HANDLE) --Objects::live;
        kDestroy(device, handle, host);
    }
};

VKAPI_ATTR VkResult VKAPI_CALL create_pipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                const VkComputePipelineCreateInfo* infos,
                                                const VkAllocationCallbacks* host, VkPipeline* out) {
    if (creation_fails()) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const VkResult result = vkCreateComputePipelines(device, cache, count, infos, host, out);
    Objects::pipeline_cache = cache;
    if (result == VK_SUCCESS) Objects::live_pipelines += static_cast<int>(count);
    return result;
}
VKAPI_ATTR void VKAPI_CALL destroy_pipeline(VkDevice device, VkPipeline handle, const VkAllocationCallbacks* host) {
    if (handle != VK_NULL_HANDLE) --Objects::live_pipelines;
    vkDestroyPipeline(device, handle, host);
}
VKAPI_ATTR VkResult VKAPI_CALL allocate_sets(VkDevice device, const VkDescriptorSetAllocateInfo* info,
                                             VkDescriptorSet* out) {
    return creation_fails() ? VK_ERROR_OUT_OF_POOL_MEMORY : vkAllocateDescriptorSets(device, info, out);
}
VKAPI_ATTR VkResult VKAPI_CALL bind_memory(VkDevice device, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize offset) {
    return creation_fails() ? VK_ERROR_OUT_OF_DEVICE_MEMORY : vkBindBufferMemory(device, buffer, memory, offset);
}
VKAPI_ATTR VkResult VKAPI_CALL map_memory(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size,
                                          VkMemoryMapFlags flags, void** out) {
    ++Objects::mapped_or_submitted;
    return vkMapMemory(device, memory, offset, size, flags, out);
}
VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo* infos, VkFence fence) {
    ++Objects::mapped_or_submitted;
    return vkQueueSubmit(queue, count, infos, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL wait_for_fences(VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all,
                                               uint64_t timeout) {
    ++Objects::mapped_or_submitted;
    return vkWaitForFences(device, count, fences, all, timeout);
}

}  // namespace

PFN_vkVoidFunction VKAPI_PTR get_counted_proc_addr(VkDevice device, const char* name) {
#define LIMN_COUNTED(Name)                                                                              \
    {"vkCreate" #Name, reinterpret_cast<PFN_vkVoidFunction>(                                            \
                           &Counted<Vk##Name##CreateInfo, Vk##Name, vkCreate##Name, vkDestroy##Name>::create)}, \
        {"vkDestroy" #Name, reinterpret_cast<PFN_vkVoidFunction>(                                       \
                                &Counted<Vk##Name##CreateInfo, Vk##Name, vkCreate##Name, vkDestroy##Name>::destroy)}
    static const std::map<std::string, PFN_vkVoidFunction> counted = {
        LIMN_COUNTED(Buffer),
        LIMN_COUNTED(BufferView),
        LIMN_COUNTED(ShaderModule),
        LIMN_COUNTED(PipelineLayout),
        LIMN_COUNTED(DescriptorSetLayout),
        LIMN_COUNTED(DescriptorPool),
        LIMN_COUNTED(CommandPool),
        LIMN_COUNTED(Fence),
        {"vkCreateComputePipelines", reinterpret_cast<PFN_vkVoidFunction>(create_pipelines)},
        {"vkDestroyPipeline", reinterpret_cast<PFN_vkVoidFunction>(destroy_pipeline)},
        {"vkAllocateDescriptorSets", reinterpret_cast<PFN_vkVoidFunction>(allocate_sets)},
        {"vkBindBufferMemory", reinterpret_cast<PFN_vkVoidFunction>(bind_memory)},
        {"vkMapMemory", reinterpret_cast<PFN_vkVoidFunction>(map_memory)},
        {"vkQueueSubmit", reinterpret_cast<PFN_vkVoidFunction>(submit)},
        {"vkWaitForFences", reinterpret_cast<PFN_vkVoidFunction>(wait_for_fences)},
        // What limn must not call: memory comes from the Arena.
        {"vkAllocateMemory", reinterpret_cast<PFN_vkVoidFunction>(
                                 +[](VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*,
                                     VkDeviceMemory*) -> VkResult {
                                     ADD_FAILURE() << "memory that is not the allocator's";
                                     return VK_ERROR_OUT_OF_DEVICE_MEMORY;
                                 })},
    };
#undef LIMN_COUNTED
    const auto it = counted.find(name);
    return it != counted.end() ? it->second : vkGetDeviceProcAddr(device, name);
}

Engine::Engine(const EngineOptions& options) {
    create_instance(options, false);
    if (handles.physical_device == VK_NULL_HANDLE) return;
    create_device(options.two_families);
    if (!options.two_families || families.size() == 2) return;
    // One family only: the layer makes two of it.
    vkDestroyDevice(handles.device, nullptr);
    destroy_instance();
    create_instance(options, true);
    if (handles.physical_device != VK_NULL_HANDLE) create_device(true);
}

Engine::~Engine() {
    if (handles.device != VK_NULL_HANDLE) vkDestroyDevice(handles.device, nullptr);
    destroy_instance();
}

VkBool32 Engine::receive(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    Engine& engine = *static_cast<Engine*>(user);
    const std::lock_guard lock(engine.mutex_);
    if (engine.message_count_++ == 0) engine.first_message_ = data->pMessage;
    return VK_FALSE;
}

void Engine::create_instance(const EngineOptions& options, bool with_layer) {
    std::vector<const char*> layers, extensions;
    VkDebugUtilsMessengerCreateInfoEXT messenger = {};
    messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = receive;
    messenger.pUserData = this;
    const VkValidationFeatureEnableEXT feature = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features = {};
    features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &feature;
    VkApplicationInfo application = {};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.apiVersion = VK_API_VERSION_1_3;  // for barriers of synchronization2; limn asks for 1.2
    VkInstanceCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &application;
    if (options.validation) {
        layers.push_back("VK_LAYER_KHRONOS_validation");
        extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
        info.pNext = &features;
    }
    if (with_layer) {
        setenv("VK_ADD_LAYER_PATH", LIMN_LAYER_DIR, 1);
        layers.push_back("VK_LAYER_LIMN_two_queues");  // below validation
    }
    info.enabledLayerCount = static_cast<uint32_t>(layers.size());
    info.ppEnabledLayerNames = layers.data();
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    ASSERT_EQ(vkCreateInstance(&info, nullptr, &handles.instance), VK_SUCCESS);
    handles.get_instance_proc_addr = vkGetInstanceProcAddr;
    if (options.validation) {
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(handles.instance, "vkCreateDebugUtilsMessengerEXT"));
        ASSERT_EQ(create(handles.instance, &messenger, nullptr, &messenger_), VK_SUCCESS);
    }
    uint32_t count = 1;
    ASSERT_GE(vkEnumeratePhysicalDevices(handles.instance, &count, &handles.physical_device), VK_SUCCESS);
    ASSERT_EQ(count, 1u);
}

void Engine::destroy_instance() {
    if (messenger_ != VK_NULL_HANDLE)
        reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(handles.instance, "vkDestroyDebugUtilsMessengerEXT"))(handles.instance, messenger_,
                                                                                        nullptr);
    if (handles.instance != VK_NULL_HANDLE) vkDestroyInstance(handles.instance, nullptr);
    messenger_ = VK_NULL_HANDLE;
    handles = {};
}

void Engine::create_device(bool two_families) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(handles.physical_device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> properties(count);
    vkGetPhysicalDeviceQueueFamilyProperties(handles.physical_device, &count, properties.data());
    families.clear();
    for (uint32_t f = 0; f < count && families.size() < (two_families ? 2u : 1u); ++f)
        if ((properties[f].queueFlags & VK_QUEUE_COMPUTE_BIT) != 0) families.push_back(f);
    const float priority = 1;
    std::vector<VkDeviceQueueCreateInfo> infos(families.size());
    for (size_t i = 0; i < families.size(); ++i) {
        infos[i].sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
        infos[i].queueFamilyIndex = families[i];
        infos[i].queueCount = 1;
        infos[i].pQueuePriorities = &priority;
    }
    VkPhysicalDeviceVulkan13Features features = {};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    features.synchronization2 = VK_TRUE;
    VkDeviceCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &features;
    info.queueCreateInfoCount = static_cast<uint32_t>(infos.size());
    info.pQueueCreateInfos = infos.data();
    ASSERT_EQ(vkCreateDevice(handles.physical_device, &info, nullptr, &handles.device), VK_SUCCESS);
    queues.resize(families.size());
    for (size_t i = 0; i < families.size(); ++i) vkGetDeviceQueue(handles.device, families[i], 0, &queues[i]);
    handles.queue_family_index = families.back();
    handles.queue = queues.back();
}

}  // namespace limn::vk::test
