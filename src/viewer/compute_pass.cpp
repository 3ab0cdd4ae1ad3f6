#include "viewer/compute_pass.h"

#include <vector>

namespace limn::viewer {
namespace {

Result<UniqueSetLayout> create_set_layout(VkDevice device, uint32_t buffer_count) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < buffer_count; ++i)
        bindings.push_back({i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    VkDescriptorSetLayoutCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    info.bindingCount = buffer_count;
    info.pBindings = bindings.data();
    return create_unique<UniqueSetLayout>(device, vkCreateDescriptorSetLayout, info,
                                          "vkCreateDescriptorSetLayout");
}

Result<UniquePipelineLayout> create_layout(VkDevice device, VkDescriptorSetLayout set_layout,
                                           uint32_t push_bytes) {
    const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
    VkPipelineLayoutCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    info.setLayoutCount = 1;
    info.pSetLayouts = &set_layout;
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &range;
    return create_unique<UniquePipelineLayout>(device, vkCreatePipelineLayout, info,
                                               "vkCreatePipelineLayout");
}

Result<UniquePipeline> create_pipeline(const vk::Device& device, VkPipelineLayout layout,
                                       std::span<const uint32_t> code) {
    VkShaderModuleCreateInfo shader_info = {};
    shader_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    shader_info.codeSize = code.size_bytes();
    shader_info.pCode = code.data();
    const auto shader =
        create_unique<UniqueShader>(device.handle, vkCreateShaderModule, shader_info, "vkCreateShaderModule");
    if (!shader) return shader.error();
    VkComputePipelineCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = *shader;
    info.stage.pName = "main";
    info.layout = layout;
    VkPipeline pipeline = VK_NULL_HANDLE;
    if (const VkResult result =
            vkCreateComputePipelines(device.handle, device.pipeline_cache, 1, &info, nullptr, &pipeline);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkCreateComputePipelines", result);
    return UniquePipeline(device.handle, pipeline);
}

Result<UniqueDescriptorPool> create_pool(VkDevice device, uint32_t buffer_count) {
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, buffer_count};
    VkDescriptorPoolCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.maxSets = 1;
    info.poolSizeCount = 1;
    info.pPoolSizes = &size;
    return create_unique<UniqueDescriptorPool>(device, vkCreateDescriptorPool, info,
                                               "vkCreateDescriptorPool");
}

}  // namespace

Result<ComputePass> ComputePass::create(const vk::Device& device, std::span<const uint32_t> code,
                                        uint32_t buffer_count, uint32_t push_bytes) {
    ComputePass out;
    out.device_ = device.handle;
    auto set_layout = create_set_layout(device.handle, buffer_count);
    if (!set_layout) return set_layout.error();
    auto layout = create_layout(device.handle, *set_layout, push_bytes);
    if (!layout) return layout.error();
    auto pipeline = create_pipeline(device, *layout, code);
    if (!pipeline) return pipeline.error();
    auto pool = create_pool(device.handle, buffer_count);
    if (!pool) return pool.error();
    out.set_layout_ = std::move(*set_layout);
    out.layout_ = std::move(*layout);
    out.pipeline_ = std::move(*pipeline);
    out.pool_ = std::move(*pool);
    const VkDescriptorSetLayout set_layout_handle = out.set_layout_;
    VkDescriptorSetAllocateInfo allocate = {};
    allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    allocate.descriptorPool = out.pool_;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &set_layout_handle;
    if (const VkResult result = vkAllocateDescriptorSets(device.handle, &allocate, &out.set_);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkAllocateDescriptorSets", result);
    return out;
}

void ComputePass::set_buffers(std::span<const VkBuffer> buffers) const {
    std::vector<VkDescriptorBufferInfo> infos;
    for (const VkBuffer buffer : buffers) infos.push_back({buffer, 0, VK_WHOLE_SIZE});
    VkWriteDescriptorSet write = {};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set_;
    write.descriptorCount = static_cast<uint32_t>(infos.size());
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = infos.data();
    vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
}

void ComputePass::record_bytes(VkCommandBuffer commands, const void* push, uint32_t push_bytes,
                               uint32_t item_count) const {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0, nullptr);
    vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes, push);
    vkCmdDispatch(commands, (item_count + kGroupSize - 1) / kGroupSize, 1, 1);
}

}  // namespace limn::viewer
