#include "limn/vulkan/context.h"

#include <dlfcn.h>

#include <cstring>
#include <optional>

#include "limn/vulkan/instance.h"

namespace limn::vk {
namespace {

/// The Vulkan loader, never unloaded; null when there is none.
PFN_vkGetInstanceProcAddr load_loader() {
    static const PFN_vkGetInstanceProcAddr loader = [] {
        for (const char* name : {"libvulkan.so.1", "libvulkan.so", "libvulkan.1.dylib"}) {
            if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL))
                return reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
        }
        return PFN_vkGetInstanceProcAddr{nullptr};
    }();
    return loader;
}

Error no_loader() {
    return {ErrorCode::no_device, "the Vulkan loader (libvulkan.so.1) is not installed"};
}

/// False when one of them is missing.
bool load_instance_functions(Functions& functions, VkInstance instance) {
    bool complete = true;
#define LIMN_VK_LOAD(name)                                                                                \
    functions.name = reinterpret_cast<PFN_vk##name>(functions.GetInstanceProcAddr(instance, "vk" #name)); \
    complete = complete && functions.name != nullptr;
    LIMN_VK_INSTANCE_FUNCTIONS(LIMN_VK_LOAD)
#undef LIMN_VK_LOAD
    return complete;
}

bool load_device_functions(Functions& functions, VkDevice device) {
    bool complete = true;
#define LIMN_VK_LOAD(name)                                                                            \
    functions.name = reinterpret_cast<PFN_vk##name>(functions.GetDeviceProcAddr(device, "vk" #name)); \
    complete = complete && functions.name != nullptr;
    LIMN_VK_DEVICE_FUNCTIONS(LIMN_VK_LOAD)
#undef LIMN_VK_LOAD
    return complete;
}

std::optional<uint32_t> find_compute_queue_family(const Functions& functions,
                                                  VkPhysicalDevice physical_device) {
    uint32_t count = 0;
    functions.GetPhysicalDeviceQueueFamilyProperties(physical_device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    functions.GetPhysicalDeviceQueueFamilyProperties(physical_device, &count, families.data());
    for (uint32_t i = 0; i < count; ++i)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) return i;
    return std::nullopt;
}

Result<std::vector<VkPhysicalDevice>> enumerate_physical_devices(const Functions& functions,
                                                                 VkInstance instance) {
    uint32_t count = 0;
    VkResult result = functions.EnumeratePhysicalDevices(instance, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    if (result == VK_SUCCESS && count != 0)
        result = functions.EnumeratePhysicalDevices(instance, &count, devices.data());
    if (result != VK_SUCCESS && result != VK_ERROR_INITIALIZATION_FAILED)
        return vulkan_error("vkEnumeratePhysicalDevices", result);
    if (count == 0) return Error{ErrorCode::no_device, "there is no Vulkan device"};
    return devices;
}

DeviceInfo describe(const Functions& functions, VkPhysicalDevice physical_device, uint32_t index) {
    VkPhysicalDeviceProperties properties;
    functions.GetPhysicalDeviceProperties(physical_device, &properties);
    return {.index = index,
            .name = properties.deviceName,
            .type = properties.deviceType,
            .api_version = properties.apiVersion,
            .driver_version = properties.driverVersion,
            .usable = properties.apiVersion >= VK_API_VERSION_1_2 &&
                      find_compute_queue_family(functions, physical_device).has_value()};
}

Result<std::vector<DeviceInfo>> describe_all(const Functions& functions, VkInstance instance) {
    const auto physical_devices = enumerate_physical_devices(functions, instance);
    if (!physical_devices) return physical_devices.error();
    std::vector<DeviceInfo> infos;
    for (const VkPhysicalDevice physical_device : *physical_devices)
        infos.push_back(describe(functions, physical_device, static_cast<uint32_t>(infos.size())));
    return infos;
}

/// The index of the device that options ask for.
Result<uint32_t> select_device(const std::vector<DeviceInfo>& devices, uint32_t wanted) {
    constexpr VkPhysicalDeviceType kPreference[] = {
        VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
        VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU, VK_PHYSICAL_DEVICE_TYPE_CPU, VK_PHYSICAL_DEVICE_TYPE_OTHER};
    for (const VkPhysicalDeviceType type : kPreference) {
        if (wanted != kAutomaticDevice && (wanted != kCpuDevice || type != VK_PHYSICAL_DEVICE_TYPE_CPU))
            continue;
        for (const DeviceInfo& device : devices)
            if (device.usable && device.type == type) return device.index;
    }
    if (wanted == kAutomaticDevice)
        return Error{ErrorCode::no_device, "no device supports Vulkan 1.2 and compute"};
    if (wanted == kCpuDevice) return Error{ErrorCode::no_device, "there is no Vulkan device of type CPU"};
    if (wanted >= devices.size())
        return Error{ErrorCode::no_device, "there is no Vulkan device " + std::to_string(wanted) + ", only " +
                                               std::to_string(devices.size())};
    if (!devices[wanted].usable)
        return Error{ErrorCode::no_device, devices[wanted].name + " does not support Vulkan 1.2 and compute"};
    return wanted;
}

Result<void> create_device(Device& device) {
    const float priority = 1;
    VkDeviceQueueCreateInfo queue = {};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = device.queue_family_index;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    const VkResult result =
        device.functions.CreateDevice(device.physical_device, &info, nullptr, &device.handle);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateDevice", result);
    return {};
}

/// Completes a Device whose handles and instance functions are there.
Result<void> complete_device(Device& device) {
    if (!load_device_functions(device.functions, device.handle))
        return Error{ErrorCode::vulkan_failure, "the device lacks a function of Vulkan 1.2"};
    device.functions.GetPhysicalDeviceProperties(device.physical_device, &device.properties);
    device.functions.GetPhysicalDeviceMemoryProperties(device.physical_device, &device.memory_properties);
    if (device.properties.apiVersion < VK_API_VERSION_1_2)
        return Error{ErrorCode::unsupported, std::string(device.name()) + " does not support Vulkan 1.2"};
    return {};
}

}  // namespace

Error vulkan_error(const char* call, VkResult result) {
    const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return {memory ? ErrorCode::out_of_memory : ErrorCode::vulkan_failure,
            std::string(call) + " failed with VkResult " + std::to_string(result), kNoElement, result};
}

/// What create() made, destroyed in reverse.
struct Context::Owned {
    Instance instance;
    const Device* device = nullptr;

    ~Owned() {
        if (device->handle != VK_NULL_HANDLE && device->functions.DestroyDevice != nullptr)
            device->functions.DestroyDevice(device->handle, nullptr);
    }
};

Context::Context() : device_(std::make_unique<Device>()) {}
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&& other) noexcept {
    owned_.reset();  // before the device that it refers to
    device_ = std::move(other.device_);
    owned_ = std::move(other.owned_);
    return *this;
}
Context::~Context() = default;  // owned_ goes first

Result<std::vector<DeviceInfo>> list_devices() {
    Functions functions;
    functions.GetInstanceProcAddr = load_loader();
    if (functions.GetInstanceProcAddr == nullptr) return no_loader();
    const auto instance = create_instance(functions.GetInstanceProcAddr, {}, false);
    if (!instance) return instance.error();
    load_instance_functions(functions, instance->handle);
    return describe_all(functions, instance->handle);
}

Result<Context> Context::create(const ContextOptions& options) {
    Context context;
    Device& device = *context.device_;
    device.functions.GetInstanceProcAddr = load_loader();
    if (device.functions.GetInstanceProcAddr == nullptr) return no_loader();
    auto instance = create_instance(device.functions.GetInstanceProcAddr, {}, options.validation);
    if (!instance) return instance.error();
    device.instance = instance->handle;
    load_instance_functions(device.functions, device.instance);
    context.owned_ = std::make_unique<Owned>();
    context.owned_->instance = std::move(*instance);
    context.owned_->device = &device;

    const auto infos = describe_all(device.functions, device.instance);
    if (!infos) return infos.error();
    const auto index = select_device(*infos, options.device_index);
    if (!index) return index.error();
    const auto physical_devices = enumerate_physical_devices(device.functions, device.instance);
    if (!physical_devices) return physical_devices.error();
    device.physical_device = (*physical_devices)[*index];
    device.queue_family_index = *find_compute_queue_family(device.functions, device.physical_device);
    if (auto created = create_device(device); !created) return created.error();
    // Without its functions a device cannot even be destroyed, so this one leaks when they are missing.
    if (auto completed = complete_device(device); !completed) return completed.error();
    device.functions.GetDeviceQueue(device.handle, device.queue_family_index, 0, &device.queue);
    return context;
}

Result<Context> Context::borrow(const BorrowedHandles& handles) {
    if (handles.instance == VK_NULL_HANDLE || handles.physical_device == VK_NULL_HANDLE ||
        handles.device == VK_NULL_HANDLE || handles.get_instance_proc_addr == nullptr)
        return Error{ErrorCode::invalid_argument,
                     "instance, physical_device, device and get_instance_proc_addr must not be null"};
    if ((handles.allocator.allocate == nullptr) != (handles.allocator.free == nullptr))
        return Error{ErrorCode::invalid_argument, "an allocator needs both of its functions"};
    Context context;
    Device& device = *context.device_;
    device.functions.GetInstanceProcAddr = handles.get_instance_proc_addr;
    device.instance = handles.instance;
    device.physical_device = handles.physical_device;
    device.handle = handles.device;
    device.queue = handles.queue;
    device.queue_family_index = handles.queue_family_index;
    device.pipeline_cache = handles.pipeline_cache;
    device.allocator = handles.allocator;
    device.host_allocator = handles.host_allocator;
    if (!load_instance_functions(device.functions, device.instance))
        return Error{ErrorCode::vulkan_failure, "the instance lacks a function of Vulkan 1.2"};
    if (handles.get_device_proc_addr != nullptr) device.functions.GetDeviceProcAddr = handles.get_device_proc_addr;
    if (auto completed = complete_device(device); !completed) return completed.error();
    return context;
}

uint32_t Context::validation_message_count() const {
    return owned_ ? owned_->instance.message_count() : 0;
}

std::string Context::first_validation_message() const {
    return owned_ ? owned_->instance.first_message() : std::string();
}

}  // namespace limn::vk
