#include "viewer/graphics_device.h"

#include <vulkan/vulkan.h>

#include <cstring>

#include "limn/vulkan/instance.h"

namespace limn::viewer {
namespace {

Result<vk::Instance> create_instance(const GraphicsDeviceOptions& options) {
    auto instance = vk::create_instance(vkGetInstanceProcAddr, options.instance_extensions, options.validation);
    if (!instance && instance.error().vk_result == VK_ERROR_EXTENSION_NOT_PRESENT)
        return Error{ErrorCode::no_device, "no Vulkan driver here can show pictures in a window"};
    return instance;
}

bool has_extension(VkPhysicalDevice device, const char* name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    for (const VkExtensionProperties& extension : extensions)
        if (std::strcmp(extension.extensionName, name) == 0) return true;
    return false;
}

/// A device among all of them, in the order of `limn devices`.
struct Candidate {
    VkPhysicalDevice handle = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties = {};
    bool has_tessellation_shader = false;
    std::optional<uint32_t> queue_family;  ///< none: not usable
};

Candidate inspect(const GraphicsDeviceOptions& options, VkInstance instance, VkPhysicalDevice handle) {
    Candidate candidate;
    candidate.handle = handle;
    vkGetPhysicalDeviceProperties(handle, &candidate.properties);
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(handle, &features);
    candidate.has_tessellation_shader = features.tessellationShader != VK_FALSE;
    if (candidate.properties.apiVersion < VK_API_VERSION_1_2) return candidate;
    if (options.can_present != nullptr && !has_extension(handle, VK_KHR_SWAPCHAIN_EXTENSION_NAME))
        return candidate;
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(handle, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(handle, &count, families.data());
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t i = 0; i < count && !candidate.queue_family; ++i)
        if ((families[i].queueFlags & kNeeded) == kNeeded &&
            (options.can_present == nullptr || options.can_present(instance, handle, i)))
            candidate.queue_family = i;
    return candidate;
}

Result<std::vector<Candidate>> inspect_all(const GraphicsDeviceOptions& options, VkInstance instance) {
    uint32_t count = 0;
    VkResult result = vkEnumeratePhysicalDevices(instance, &count, nullptr);
    std::vector<VkPhysicalDevice> handles(count);
    if (result == VK_SUCCESS && count != 0)
        result = vkEnumeratePhysicalDevices(instance, &count, handles.data());
    if (result != VK_SUCCESS && result != VK_ERROR_INITIALIZATION_FAILED)
        return vk::vulkan_error("vkEnumeratePhysicalDevices", result);
    if (count == 0) return Error{ErrorCode::no_device, "there is no Vulkan device"};
    std::vector<Candidate> candidates;
    for (const VkPhysicalDevice handle : handles) candidates.push_back(inspect(options, instance, handle));
    return candidates;
}

Result<Candidate> select(const std::vector<Candidate>& candidates, const GraphicsDeviceOptions& options) {
    const uint32_t wanted = options.device_index;
    const std::string needs =
        options.can_present ? "Vulkan 1.2, graphics and windows" : "Vulkan 1.2 and graphics";
    constexpr VkPhysicalDeviceType kPreference[] = {
        VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
        VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU, VK_PHYSICAL_DEVICE_TYPE_CPU, VK_PHYSICAL_DEVICE_TYPE_OTHER};
    for (const VkPhysicalDeviceType type : kPreference) {
        if (wanted != vk::kAutomaticDevice &&
            (wanted != vk::kCpuDevice || type != VK_PHYSICAL_DEVICE_TYPE_CPU))
            continue;
        for (const Candidate& candidate : candidates)
            if (candidate.queue_family && candidate.properties.deviceType == type) return candidate;
    }
    if (wanted == vk::kAutomaticDevice)
        return Error{ErrorCode::no_device, "no Vulkan device supports " + needs};
    if (wanted == vk::kCpuDevice)
        return Error{ErrorCode::no_device, "no Vulkan device of type CPU supports " + needs};
    if (wanted >= candidates.size())
        return Error{ErrorCode::no_device, "there is no Vulkan device " + std::to_string(wanted) + ", only " +
                                               std::to_string(candidates.size())};
    if (!candidates[wanted].queue_family)
        return Error{ErrorCode::no_device,
                     std::string(candidates[wanted].properties.deviceName) + " does not support " + needs};
    return candidates[wanted];
}

Result<VkDevice> create_device(const Candidate& candidate, bool swapchain) {
    const float priority = 1;
    VkDeviceQueueCreateInfo queue = {};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = *candidate.queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    const char* const extension = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    VkPhysicalDeviceFeatures features = {};
    features.tessellationShader = candidate.has_tessellation_shader;
    VkDeviceCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.pEnabledFeatures = &features;
    info.enabledExtensionCount = swapchain ? 1 : 0;
    info.ppEnabledExtensionNames = &extension;
    VkDevice device = VK_NULL_HANDLE;
    if (const VkResult result = vkCreateDevice(candidate.handle, &info, nullptr, &device);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkCreateDevice", result);
    return device;
}

}  // namespace

struct GraphicsDevice::Owned {
    vk::Instance instance;
    VkDevice device = VK_NULL_HANDLE;

    ~Owned() {
        if (device != VK_NULL_HANDLE) vkDestroyDevice(device, nullptr);
    }
};

GraphicsDevice::GraphicsDevice() : owned_(std::make_unique<Owned>()) {}
GraphicsDevice::GraphicsDevice(GraphicsDevice&&) noexcept = default;
GraphicsDevice::~GraphicsDevice() = default;

Result<GraphicsDevice> GraphicsDevice::create(const GraphicsDeviceOptions& options) {
    GraphicsDevice out;
    Owned& owned = *out.owned_;
    auto instance = create_instance(options);
    if (!instance) return instance.error();
    owned.instance = std::move(*instance);
    const auto candidates = inspect_all(options, owned.instance.handle);
    if (!candidates) return candidates.error();
    const auto chosen = select(*candidates, options);
    if (!chosen) return chosen.error();
    const auto device = create_device(*chosen, options.can_present != nullptr);
    if (!device) return device.error();
    owned.device = *device;
    out.has_tessellation_shader_ = chosen->has_tessellation_shader;
    vk::BorrowedHandles handles;
    handles.instance = owned.instance.handle;
    handles.physical_device = chosen->handle;
    handles.device = owned.device;
    handles.queue_family_index = *chosen->queue_family;
    handles.get_instance_proc_addr = vkGetInstanceProcAddr;
    vkGetDeviceQueue(owned.device, *chosen->queue_family, 0, &handles.queue);
    Result<vk::Context> context = vk::Context::borrow(handles);
    if (!context) return context.error();
    out.context_.emplace(std::move(*context));
    return out;
}

uint32_t GraphicsDevice::validation_message_count() const {
    return owned_->instance.message_count();
}

std::string GraphicsDevice::first_validation_message() const {
    return owned_->instance.first_message();
}

Result<void> GraphicsDevice::check_validation() const {
    const uint32_t count = validation_message_count();
    if (count == 0) return {};
    return Error{ErrorCode::vulkan_failure, std::to_string(count) + " validation message" +
                                                (count == 1 ? "" : "s") +
                                                ", the first: " + first_validation_message()};
}

}  // namespace limn::viewer
