// A compute kernel: its shader, descriptor set layout and pipelines. Not part of the public interface.
#pragma once

#include <span>

#include "limn/vulkan/context.h"

namespace limn::vk {

struct KernelInfo {
    std::span<const uint32_t> spirv;
    std::span<const VkDescriptorType> bindings;  ///< descriptor set 0: types of bindings 0, 1, ...
    uint32_t push_constant_bytes = 0;
};

/// What all pipelines of a kernel share; move-only, destroyed with the device idle.
struct Kernel {
    const Device* device = nullptr;
    VkShaderModule shader = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;

    Kernel() = default;
    Kernel(Kernel&& other) noexcept;
    Kernel& operator=(Kernel&& other) noexcept;
    ~Kernel();
};

/// Errors: out_of_memory, vulkan_failure.
Result<Kernel> create_kernel(const Device& device, const KernelInfo& info);

/// The pipeline with specialization constant i set to constants[i]. The caller destroys it.
/// Errors: out_of_memory, vulkan_failure.
Result<VkPipeline> create_pipeline(const Kernel& kernel, std::span<const uint32_t> constants);

}  // namespace limn::vk
