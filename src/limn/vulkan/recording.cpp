#include "limn/vulkan/recording.h"

#include <algorithm>

namespace limn::vk {
namespace {

Result<VkDescriptorPool> create_pool(const Device& device, std::span<const BoundBuffer> buffers) {
    std::vector<VkDescriptorPoolSize> sizes;
    for (const VkDescriptorType type : {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
                                        VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER}) {
        const auto count =
            std::count_if(buffers.begin(), buffers.end(), [&](const BoundBuffer& b) { return b.type == type; });
        if (count != 0) sizes.push_back({type, static_cast<uint32_t>(count)});
    }
    VkDescriptorPoolCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.maxSets = 1;
    info.poolSizeCount = static_cast<uint32_t>(sizes.size());
    info.pPoolSizes = sizes.data();
    VkDescriptorPool pool = VK_NULL_HANDLE;
    const VkResult result = device.functions.CreateDescriptorPool(device.handle, &info, device.host_allocator, &pool);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateDescriptorPool", result);
    return pool;
}

Result<VkBufferView> create_view(const Device& device, const BoundBuffer& b) {
    VkBufferViewCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
    info.buffer = b.buffer;
    info.format = b.format;
    info.offset = b.offset_bytes;
    info.range = b.size_bytes;
    VkBufferView view = VK_NULL_HANDLE;
    const VkResult result = device.functions.CreateBufferView(device.handle, &info, device.host_allocator, &view);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateBufferView", result);
    return view;
}

Result<void> check_ranges(const VkPhysicalDeviceLimits& limits, std::span<const BoundBuffer> buffers) {
    for (const BoundBuffer& b : buffers) {
        const bool fours = b.format == VK_FORMAT_R32G32B32A32_SFLOAT || b.format == VK_FORMAT_R32G32B32A32_UINT;
        const uint64_t most = b.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                  ? limits.maxStorageBufferRange
                                  : uint64_t{limits.maxTexelBufferElements} * (fours ? 16 : 4);
        if (b.type != VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER && b.size_bytes > most)
            return Error{ErrorCode::unsupported, "an evaluation needs " + std::to_string(b.size_bytes) +
                                                     " bytes of one buffer at once, and the device binds " +
                                                     std::to_string(most)};
    }
    return {};
}

}  // namespace

Recording::~Recording() {
    if (device == nullptr) return;
    const Functions& functions = device->functions;
    for (const VkBufferView view : views) functions.DestroyBufferView(device->handle, view, device->host_allocator);
    for (const VkDescriptorPool pool : pools) functions.DestroyDescriptorPool(device->handle, pool, device->host_allocator);
}

Result<VkDescriptorSet> Recording::add_set(VkDescriptorSetLayout set_layout,
                                           std::span<const BoundBuffer> buffers) {
    if (auto fits = check_ranges(device->properties.limits, buffers); !fits) return fits.error();
    auto pool = create_pool(*device, buffers);
    if (!pool) return pool.error();
    pools.push_back(*pool);
    VkDescriptorSetAllocateInfo allocate = {};
    allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    allocate.descriptorPool = *pool;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &set_layout;
    VkDescriptorSet set = VK_NULL_HANDLE;
    const VkResult result = device->functions.AllocateDescriptorSets(device->handle, &allocate, &set);
    if (result != VK_SUCCESS) return vulkan_error("vkAllocateDescriptorSets", result);

    std::vector<VkWriteDescriptorSet> writes(buffers.size());
    std::vector<VkDescriptorBufferInfo> infos(buffers.size());
    std::vector<VkBufferView> bound_views(buffers.size(), VK_NULL_HANDLE);
    for (size_t i = 0; i < buffers.size(); ++i) {
        const BoundBuffer& b = buffers[i];
        infos[i] = {b.buffer, b.offset_bytes, b.size_bytes};
        if (b.type == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER) {
            auto view = create_view(*device, b);
            if (!view) return view.error();
            views.push_back(*view);
            bound_views[i] = *view;
        }
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = set;
        writes[i].dstBinding = static_cast<uint32_t>(i);
        writes[i].descriptorCount = 1;
        writes[i].descriptorType = b.type;
        writes[i].pBufferInfo = &infos[i];
        writes[i].pTexelBufferView = &bound_views[i];
        writes[i].pImageInfo = &b.image;
    }
    device->functions.UpdateDescriptorSets(device->handle, static_cast<uint32_t>(writes.size()),
                                           writes.data(), 0, nullptr);
    return set;
}

void Recording::record(VkCommandBuffer command_buffer, const Dispatch& dispatch, Bound& bound) const {
    if (dispatch.indirect == VK_NULL_HANDLE && dispatch.groups[0] == 0) return;
    if (dispatch.pipeline != bound.pipeline)
        device->functions.CmdBindPipeline(command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE, dispatch.pipeline);
    if (dispatch.set != bound.set)
        device->functions.CmdBindDescriptorSets(command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &dispatch.set,
                                                0, nullptr);
    bound = {dispatch.pipeline, dispatch.set};
    device->functions.CmdPushConstants(command_buffer, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, push_constant_bytes,
                                       dispatch.push_constants.data());
    if (dispatch.indirect != VK_NULL_HANDLE)
        device->functions.CmdDispatchIndirect(command_buffer, dispatch.indirect, dispatch.indirect_bytes);
    else
        device->functions.CmdDispatch(command_buffer, dispatch.groups[0], dispatch.groups[1], 1);
}

}  // namespace limn::vk
