// A Vulkan instance of limn's own, with validation where it is asked for. Not part of the public interface.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "limn/vulkan/context.h"

namespace limn::vk {

/// Owned: destroyed with what validation had to say. What was made of it has to be gone by then.
struct Instance {
    struct Messages;
    PFN_vkGetInstanceProcAddr get_proc_addr = nullptr;
    VkInstance handle = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    std::unique_ptr<Messages> messages;  ///< null without validation

    Instance();
    Instance(Instance&&) noexcept;
    Instance& operator=(Instance&&) noexcept;
    ~Instance();

    /// Errors and warnings of validation so far, and the text of the first.
    uint32_t message_count() const;
    std::string first_message() const;
};

/// For Vulkan 1.2. Errors: no_device (no driver), unsupported (validation is not installed), vulkan_failure (vk_result
/// tells where an extension is missing).
Result<Instance> create_instance(PFN_vkGetInstanceProcAddr get_proc_addr, std::span<const char* const> extensions,
                                 bool validation);

}  // namespace limn::vk
