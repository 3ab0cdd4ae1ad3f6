// A compute kernel: its shader, descriptor set layout and pipelines. Not part of the public interface.
#pragma once

#include <memory>
#include <span>

#include "limn/vulkan/context.h"

namespace limn::vk {

struct KernelInfo {
    std::span<const uint32_t> spirv;
    std::span<const VkDescriptorType> bindings;  ///< descriptor set 0: types of bindings 0, 1, ...
    uint32_t push_constant_bytes = 0;
};

/// A shader and its pipelines, one for each set of specialization constants that was asked for; move-only, destroyed with
/// the device idle.
struct Kernel {
    struct Pipelines;
    const Device* device = nullptr;
    VkShaderModule shader = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::unique_ptr<Pipelines> pipelines;

    Kernel();
    Kernel(Kernel&& other) noexcept;
    Kernel& operator=(Kernel&& other) noexcept;
    ~Kernel();

    /// With specialization constant i set to constants[i]; made at the first call, from any thread.
    /// Errors: out_of_memory, vulkan_failure.
    Result<VkPipeline> pipeline(std::span<const uint32_t> constants) const;
};

/// Errors: out_of_memory, vulkan_failure.
Result<Kernel> create_kernel(const Device& device, const KernelInfo& info);

}  // namespace limn::vk
