#include "viewer/deformer.h"

#include "limn_shaders/deform_comp.h"

namespace limn::viewer {
namespace {

struct DeformParams {
    float sphere[4];
    uint32_t count;
    float time;
    float amplitude;
};

constexpr uint32_t kGroupSize = 64;

}  // namespace

Result<Deformer> Deformer::create(const vk::Device& device) {
    Deformer out(device);
    VkDescriptorSetLayoutBinding bindings[2] = {};
    for (uint32_t i = 0; i < 2; ++i)
        bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
    VkDescriptorSetLayoutCreateInfo set_info = {};
    set_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    set_info.bindingCount = 2;
    set_info.pBindings = bindings;
    auto set_layout = create_unique<UniqueSetLayout>(device.handle, vkCreateDescriptorSetLayout, set_info,
                                                     "vkCreateDescriptorSetLayout");
    if (!set_layout) return set_layout.error();
    out.set_layout_ = std::move(*set_layout);
    if (auto created = out.create_pipeline(); !created) return created.error();

    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2};
    VkDescriptorPoolCreateInfo pool_info = {};
    pool_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    pool_info.maxSets = 1;
    pool_info.poolSizeCount = 1;
    pool_info.pPoolSizes = &size;
    auto pool = create_unique<UniqueDescriptorPool>(device.handle, vkCreateDescriptorPool, pool_info,
                                                    "vkCreateDescriptorPool");
    if (!pool) return pool.error();
    out.pool_ = std::move(*pool);
    const VkDescriptorSetLayout layout = out.set_layout_;
    VkDescriptorSetAllocateInfo allocate = {};
    allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    allocate.descriptorPool = out.pool_;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &layout;
    if (const VkResult result = vkAllocateDescriptorSets(device.handle, &allocate, &out.set_);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkAllocateDescriptorSets", result);
    return out;
}

Result<void> Deformer::create_pipeline() {
    const VkDescriptorSetLayout set_layout = set_layout_;
    const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(DeformParams)};
    VkPipelineLayoutCreateInfo layout_info = {};
    layout_info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    layout_info.setLayoutCount = 1;
    layout_info.pSetLayouts = &set_layout;
    layout_info.pushConstantRangeCount = 1;
    layout_info.pPushConstantRanges = &range;
    auto layout = create_unique<UniquePipelineLayout>(device_->handle, vkCreatePipelineLayout, layout_info,
                                                      "vkCreatePipelineLayout");
    if (!layout) return layout.error();
    layout_ = std::move(*layout);
    VkShaderModuleCreateInfo shader_info = {};
    shader_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    shader_info.codeSize = sizeof kDeformComp;
    shader_info.pCode = kDeformComp;
    auto shader = create_unique<UniqueShader>(device_->handle, vkCreateShaderModule, shader_info,
                                              "vkCreateShaderModule");
    if (!shader) return shader.error();
    VkComputePipelineCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = *shader;
    info.stage.pName = "main";
    info.layout = layout_;
    VkPipeline pipeline = VK_NULL_HANDLE;
    if (const VkResult result =
            vkCreateComputePipelines(device_->handle, device_->pipeline_cache, 1, &info, nullptr, &pipeline);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkCreateComputePipelines", result);
    pipeline_ = UniquePipeline(device_->handle, pipeline);
    return {};
}

Result<void> Deformer::set_points(std::span<const float> rest, VkBuffer points) {
    auto buffer = vk::create_point_buffer(*device_, rest);
    if (!buffer) return buffer.error();
    rest_ = std::move(*buffer);
    count_ = static_cast<uint32_t>(rest.size() / 3);
    const VkDescriptorBufferInfo infos[] = {{rest_.handle, 0, VK_WHOLE_SIZE}, {points, 0, VK_WHOLE_SIZE}};
    VkWriteDescriptorSet write = {};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set_;
    write.descriptorCount = 2;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = infos;
    vkUpdateDescriptorSets(device_->handle, 1, &write, 0, nullptr);
    return {};
}

void Deformer::record(VkCommandBuffer commands, const Bounds& bounds, float seconds, float amplitude) const {
    const glm::vec3 centre = bounds.centre();
    const DeformParams params = {{centre.x, centre.y, centre.z, bounds.radius()}, count_, seconds, amplitude};
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0, nullptr);
    vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof params, &params);
    vkCmdDispatch(commands, (count_ + kGroupSize - 1) / kGroupSize, 1, 1);
    vk::record_barrier(*device_, commands, vk::kKernelWrites, vk::kKernelReads);
}

}  // namespace limn::viewer
