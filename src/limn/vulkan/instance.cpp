#include "limn/vulkan/instance.h"

#include <cstring>
#include <mutex>
#include <utility>

namespace limn::vk {

/// What the validation layer said. Messages may come from any thread.
struct Instance::Messages {
    std::mutex mutex;
    uint32_t count = 0;
    std::string first;
};

namespace {

constexpr char kValidationLayer[] = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL receive_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                               VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    Instance::Messages& messages = *static_cast<Instance::Messages*>(user);
    const std::lock_guard lock(messages.mutex);
    if (messages.count++ == 0) messages.first = data->pMessage;
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(Instance::Messages* messages) {
    VkDebugUtilsMessengerCreateInfoEXT info = {};
    info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = receive_message;
    info.pUserData = messages;
    return info;
}

template <class Function>
Function load(PFN_vkGetInstanceProcAddr get_proc_addr, VkInstance instance, const char* name) {
    return reinterpret_cast<Function>(get_proc_addr(instance, name));
}

bool is_layer_installed(PFN_vkGetInstanceProcAddr get_proc_addr, const char* name) {
    const auto enumerate = load<PFN_vkEnumerateInstanceLayerProperties>(get_proc_addr, nullptr,
                                                                        "vkEnumerateInstanceLayerProperties");
    uint32_t count = 0;
    if (enumerate == nullptr || enumerate(&count, nullptr) != VK_SUCCESS) return false;
    std::vector<VkLayerProperties> layers(count);
    if (count != 0 && enumerate(&count, layers.data()) < VK_SUCCESS) return false;
    for (const VkLayerProperties& layer : layers)
        if (std::strcmp(layer.layerName, name) == 0) return true;
    return false;
}

Result<void> create_messenger(Instance& instance) {
    const auto create = load<PFN_vkCreateDebugUtilsMessengerEXT>(instance.get_proc_addr, instance.handle,
                                                                 "vkCreateDebugUtilsMessengerEXT");
    const VkDebugUtilsMessengerCreateInfoEXT info = messenger_info(instance.messages.get());
    const VkResult result = create(instance.handle, &info, nullptr, &instance.messenger);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateDebugUtilsMessengerEXT", result);
    return {};
}

}  // namespace

Instance::Instance() = default;
Instance::Instance(Instance&& other) noexcept
    : get_proc_addr(other.get_proc_addr),
      handle(std::exchange(other.handle, VK_NULL_HANDLE)),
      messenger(std::exchange(other.messenger, VK_NULL_HANDLE)),
      messages(std::move(other.messages)) {}
Instance& Instance::operator=(Instance&& other) noexcept {
    std::swap(get_proc_addr, other.get_proc_addr);
    std::swap(handle, other.handle);
    std::swap(messenger, other.messenger);
    std::swap(messages, other.messages);
    return *this;
}
Instance::~Instance() {
    if (messenger != VK_NULL_HANDLE)
        load<PFN_vkDestroyDebugUtilsMessengerEXT>(get_proc_addr, handle, "vkDestroyDebugUtilsMessengerEXT")(
            handle, messenger, nullptr);
    if (handle != VK_NULL_HANDLE)
        load<PFN_vkDestroyInstance>(get_proc_addr, handle, "vkDestroyInstance")(handle, nullptr);
}

uint32_t Instance::message_count() const {
    if (!messages) return 0;
    const std::lock_guard lock(messages->mutex);
    return messages->count;
}

std::string Instance::first_message() const {
    if (!messages) return {};
    const std::lock_guard lock(messages->mutex);
    return messages->first;
}

Result<Instance> create_instance(PFN_vkGetInstanceProcAddr get_proc_addr, std::span<const char* const> extensions,
                                 bool validation) {
    Instance out;
    out.get_proc_addr = get_proc_addr;
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .pNext = nullptr,
                                           .pApplicationName = "limn",
                                           .applicationVersion = 0,
                                           .pEngineName = "limn",
                                           .engineVersion = 0,
                                           .apiVersion = VK_API_VERSION_1_2};
    VkInstanceCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &application;
    std::vector<const char*> names(extensions.begin(), extensions.end());

    const VkValidationFeatureEnableEXT feature = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features = {};
    features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &feature;
    VkDebugUtilsMessengerCreateInfoEXT messenger = {};
    const char* const layer = kValidationLayer;
    if (validation) {
        if (!is_layer_installed(get_proc_addr, kValidationLayer))
            return Error{ErrorCode::unsupported, std::string("validation was asked for, but ") +
                                                     kValidationLayer + " is not installed"};
        out.messages = std::make_unique<Instance::Messages>();
        messenger = messenger_info(out.messages.get());
        messenger.pNext = &features;
        info.pNext = &messenger;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &layer;
        names.insert(names.end(), {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME});
    }
    info.enabledExtensionCount = static_cast<uint32_t>(names.size());
    info.ppEnabledExtensionNames = names.data();
    const VkResult result =
        load<PFN_vkCreateInstance>(get_proc_addr, nullptr, "vkCreateInstance")(&info, nullptr, &out.handle);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return Error{ErrorCode::no_device, "there is no Vulkan driver"};
    if (result != VK_SUCCESS) return vulkan_error("vkCreateInstance", result);
    if (validation)
        if (auto created = create_messenger(out); !created) return created.error();
    return out;
}

}  // namespace limn::vk
