// Dispatches with all that they need bound, ready to be recorded. Not part of the public interface.
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "limn/vulkan/pipeline.h"

namespace limn::vk {

/// What a binding of a descriptor set refers to. `format` is of a texel buffer; `image` stands in for a buffer where the
/// type is that of a combined image sampler.
struct BoundBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0;
    VkDeviceSize size_bytes = 0;
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkDescriptorImageInfo image = {};
};

struct Recording {
    struct Dispatch {
        VkPipeline pipeline;
        VkDescriptorSet set;
        uint32_t groups[2];
        std::array<uint32_t, 32> push_constants;
        VkBuffer indirect = VK_NULL_HANDLE;  ///< has the groups, in place of `groups`
        VkDeviceSize indirect_bytes = 0;     ///< where in it
    };
    const Device* device = nullptr;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    uint32_t push_constant_bytes = 0;
    std::vector<VkDescriptorPool> pools;
    std::vector<VkBufferView> views;
    std::vector<Dispatch> dispatches;

    Recording() = default;
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;
    ~Recording();

    /// Errors: unsupported (more of a buffer than the device binds at once), out_of_memory, vulkan_failure.
    Result<VkDescriptorSet> add_set(VkDescriptorSetLayout set_layout, std::span<const BoundBuffer> buffers);

    /// `group_count` workgroups, in two dimensions where one does not hold them.
    template <class Params>
    void add_dispatch(VkPipeline pipeline, VkDescriptorSet set, uint64_t group_count, const Params& params) {
        dispatches.push_back(make_dispatch(pipeline, set, group_count, params));
    }
    template <class Params>
    Dispatch make_dispatch(VkPipeline pipeline, VkDescriptorSet set, uint64_t group_count,
                           const Params& params) const {
        static_assert(sizeof(Params) <= sizeof(Dispatch::push_constants));
        Dispatch dispatch = {pipeline, set, {}, {}};
        set_groups(dispatch, group_count);
        std::memcpy(dispatch.push_constants.data(), &params, sizeof(Params));
        return dispatch;
    }

    /// Without workgroups a dispatch is not recorded.
    void set_groups(Dispatch& dispatch, uint64_t group_count) const {
        const uint64_t most = device->properties.limits.maxComputeWorkGroupCount[0];
        dispatch.groups[1] = group_count == 0 ? 0 : static_cast<uint32_t>((group_count - 1) / most + 1);
        dispatch.groups[0] = group_count == 0 ? 0 : static_cast<uint32_t>((group_count - 1) / dispatch.groups[1] + 1);
    }

    void record(VkCommandBuffer command_buffer) const { record(command_buffer, dispatches); }
    void record(VkCommandBuffer command_buffer, std::span<const Dispatch> some) const {
        Bound bound;
        for (const Dispatch& dispatch : some) record(command_buffer, dispatch, bound);
    }
    /// What is bound between dispatches that are recorded one by one.
    struct Bound {
        VkPipeline pipeline = VK_NULL_HANDLE;
        VkDescriptorSet set = VK_NULL_HANDLE;
    };
    void record(VkCommandBuffer command_buffer, const Dispatch& dispatch, Bound& bound) const;
};

}  // namespace limn::vk
