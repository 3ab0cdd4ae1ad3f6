#include "limn/vulkan/pipeline.h"

#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace limn::vk {

struct Kernel::Pipelines {
    std::mutex mutex;
    std::map<std::vector<uint32_t>, VkPipeline> by_constants;
};

Kernel::Kernel() = default;
Kernel::Kernel(Kernel&& other) noexcept {
    *this = std::move(other);
}

Kernel& Kernel::operator=(Kernel&& other) noexcept {
    std::swap(device, other.device);
    std::swap(shader, other.shader);
    std::swap(set_layout, other.set_layout);
    std::swap(layout, other.layout);
    std::swap(pipelines, other.pipelines);
    return *this;
}

Kernel::~Kernel() {
    if (device == nullptr) return;
    const Functions& functions = device->functions;
    if (pipelines)
        for (const auto& [constants, pipeline] : pipelines->by_constants)
            functions.DestroyPipeline(device->handle, pipeline, device->host_allocator);
    if (layout != VK_NULL_HANDLE) functions.DestroyPipelineLayout(device->handle, layout, device->host_allocator);
    if (set_layout != VK_NULL_HANDLE)
        functions.DestroyDescriptorSetLayout(device->handle, set_layout, device->host_allocator);
    if (shader != VK_NULL_HANDLE) functions.DestroyShaderModule(device->handle, shader, device->host_allocator);
}

Result<Kernel> create_kernel(const Device& device, const KernelInfo& info) {
    const Functions& functions = device.functions;
    Kernel kernel;
    kernel.device = &device;
    kernel.pipelines = std::make_unique<Kernel::Pipelines>();

    VkShaderModuleCreateInfo shader = {};
    shader.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    shader.codeSize = info.spirv.size_bytes();
    shader.pCode = info.spirv.data();
    VkResult result = functions.CreateShaderModule(device.handle, &shader, device.host_allocator, &kernel.shader);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateShaderModule", result);

    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const VkDescriptorType type : info.bindings)
        bindings.push_back({.binding = static_cast<uint32_t>(bindings.size()),
                            .descriptorType = type,
                            .descriptorCount = 1,
                            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
                            .pImmutableSamplers = nullptr});
    VkDescriptorSetLayoutCreateInfo set_layout = {};
    set_layout.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    set_layout.bindingCount = static_cast<uint32_t>(bindings.size());
    set_layout.pBindings = bindings.data();
    result = functions.CreateDescriptorSetLayout(device.handle, &set_layout, device.host_allocator, &kernel.set_layout);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateDescriptorSetLayout", result);

    const VkPushConstantRange push_constants = {VK_SHADER_STAGE_COMPUTE_BIT, 0, info.push_constant_bytes};
    VkPipelineLayoutCreateInfo layout = {};
    layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &kernel.set_layout;
    layout.pushConstantRangeCount = info.push_constant_bytes != 0 ? 1 : 0;
    layout.pPushConstantRanges = &push_constants;
    result = functions.CreatePipelineLayout(device.handle, &layout, device.host_allocator, &kernel.layout);
    if (result != VK_SUCCESS) return vulkan_error("vkCreatePipelineLayout", result);
    return kernel;
}

namespace {

Result<VkPipeline> create_pipeline(const Kernel& kernel, std::span<const uint32_t> constants) {
    std::vector<VkSpecializationMapEntry> entries;
    for (uint32_t i = 0; i < constants.size(); ++i)
        entries.push_back({.constantID = i, .offset = i * 4, .size = 4});
    const VkSpecializationInfo specialization = {.mapEntryCount = static_cast<uint32_t>(entries.size()),
                                                 .pMapEntries = entries.data(),
                                                 .dataSize = constants.size_bytes(),
                                                 .pData = constants.data()};
    VkComputePipelineCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = kernel.shader;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &specialization;
    info.layout = kernel.layout;
    VkPipeline pipeline = VK_NULL_HANDLE;
    const Device& device = *kernel.device;
    const VkResult result = device.functions.CreateComputePipelines(device.handle, device.pipeline_cache, 1,
                                                                    &info, device.host_allocator, &pipeline);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateComputePipelines", result);
    return pipeline;
}

}  // namespace

Result<VkPipeline> Kernel::pipeline(std::span<const uint32_t> constants) const {
    const std::lock_guard lock(pipelines->mutex);
    VkPipeline& pipeline = pipelines->by_constants[{constants.begin(), constants.end()}];
    if (pipeline == VK_NULL_HANDLE) {
        auto created = create_pipeline(*this, constants);
        if (!created) return created.error();
        pipeline = *created;
    }
    return pipeline;
}

}  // namespace limn::vk
