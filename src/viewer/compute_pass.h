// One compute kernel of the viewer's own: storage buffers, push constants, a dispatch.
#pragma once

#include <span>

#include "viewer/handles.h"

namespace limn::viewer {

class ComputePass {
  public:
    static constexpr uint32_t kGroupSize = 64;  ///< of all these kernels

    /// Bindings 0 .. buffer_count - 1 of set 0 are storage buffers. Errors: out_of_memory, vulkan_failure.
    static Result<ComputePass> create(const vk::Device& device, std::span<const uint32_t> code,
                                      uint32_t buffer_count, uint32_t push_bytes);

    /// One for each binding; while nothing that was recorded is pending.
    void set_buffers(std::span<const VkBuffer> buffers) const;

    /// An invocation for each item, and what fills up the last group. No barrier.
    template <class Push>
    void record(VkCommandBuffer commands, const Push& push, uint32_t item_count) const {
        record_bytes(commands, &push, sizeof push, item_count);
    }

  private:
    void record_bytes(VkCommandBuffer commands, const void* push, uint32_t push_bytes,
                      uint32_t item_count) const;

    VkDevice device_ = VK_NULL_HANDLE;
    UniqueSetLayout set_layout_;
    UniquePipelineLayout layout_;
    UniquePipeline pipeline_;
    UniqueDescriptorPool pool_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace limn::viewer
