#include "viewer/pipelines.h"

#include <span>

#include "limn_shaders/backdrop_frag.h"
#include "limn_shaders/backdrop_vert.h"
#include "limn_shaders/depth_vert.h"
#include "limn_shaders/ground_frag.h"
#include "limn_shaders/ground_vert.h"
#include "limn_shaders/lines_frag.h"
#include "limn_shaders/lines_vert.h"
#include "limn_shaders/mesh_frag.h"
#include "limn_shaders/mesh_hardware_frag.h"
#include "limn_shaders/mesh_pulled_vert.h"
#include "limn_shaders/mesh_vert.h"
#include "viewer/frame.h"

namespace limn::viewer {
namespace {

Result<UniqueSetLayout> create_set_layout(VkDevice device) {
    VkDescriptorSetLayoutBinding bindings[shared::kBindingCount] = {};
    for (uint32_t i = 0; i < shared::kBindingCount; ++i) {
        bindings[i].binding = i;
        bindings[i].descriptorCount = 1;
        bindings[i].descriptorType = i == shared::kBindFrame    ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                     : i >= shared::kBindShadow ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                                                : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        bindings[i].stageFlags = i == shared::kBindFrame || i == shared::kBindFaceRates
                                     ? VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT
                                 : i >= shared::kBindShadow ? VK_SHADER_STAGE_FRAGMENT_BIT
                                                            : VK_SHADER_STAGE_VERTEX_BIT;
    }
    VkDescriptorSetLayoutCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    info.bindingCount = shared::kBindingCount;
    info.pBindings = bindings;
    return create_unique<UniqueSetLayout>(device, vkCreateDescriptorSetLayout, info,
                                          "vkCreateDescriptorSetLayout");
}

Result<UniquePipelineLayout> create_layout(VkDevice device, std::initializer_list<VkDescriptorSetLayout> set_layouts,
                                           const VkPushConstantRange& range) {
    VkPipelineLayoutCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    info.setLayoutCount = static_cast<uint32_t>(set_layouts.size());
    info.pSetLayouts = set_layouts.begin();
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &range;
    return create_unique<UniquePipelineLayout>(device, vkCreatePipelineLayout, info,
                                               "vkCreatePipelineLayout");
}

VkSubpassDependency dependency(uint32_t from, uint32_t to, vk::StageAccess before, vk::StageAccess after) {
    return {from, to, before.stages, after.stages, before.access, after.access, 0};
}

constexpr vk::StageAccess kDepthWrites = {
    VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
constexpr vk::StageAccess kFragmentReads = {VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT};

Result<UniqueRenderPass> create_depth_pass(VkDevice device, VkFormat format) {
    VkAttachmentDescription attachment = {};
    attachment.format = format;
    attachment.samples = VK_SAMPLE_COUNT_1_BIT;
    attachment.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    attachment.finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
    const VkAttachmentReference depth = {0, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.pDepthStencilAttachment = &depth;
    const VkSubpassDependency dependencies[] = {
        dependency(VK_SUBPASS_EXTERNAL, 0, kFragmentReads, kDepthWrites),
        dependency(0, VK_SUBPASS_EXTERNAL, kDepthWrites, kFragmentReads)};
    VkRenderPassCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
    info.attachmentCount = 1;
    info.pAttachments = &attachment;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = 2;
    info.pDependencies = dependencies;
    return create_unique<UniqueRenderPass>(device, vkCreateRenderPass, info, "vkCreateRenderPass");
}

Result<UniqueRenderPass> create_scene_pass(VkDevice device) {
    VkAttachmentDescription attachments[3] = {};
    for (VkAttachmentDescription& attachment : attachments) {
        attachment.format = kColorFormat;
        attachment.samples = kSamples;
        attachment.loadOp = attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
        attachment.storeOp = attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
        attachment.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    attachments[1].format = kDepthFormat;
    attachments[1].loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    attachments[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    attachments[2].samples = VK_SAMPLE_COUNT_1_BIT;
    attachments[2].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference depth = {1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference resolved = {2, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &color;
    subpass.pResolveAttachments = &resolved;
    subpass.pDepthStencilAttachment = &depth;
    const vk::StageAccess writes = {
        VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | kDepthWrites.stages,
        VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | kDepthWrites.access};
    vk::StageAccess before = writes;  // the last picture, and copies from it
    before.stages |= VK_PIPELINE_STAGE_TRANSFER_BIT;
    const VkSubpassDependency dependencies[] = {dependency(VK_SUBPASS_EXTERNAL, 0, before, writes),
                                                dependency(0, VK_SUBPASS_EXTERNAL, writes, writes)};
    VkRenderPassCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
    info.attachmentCount = 3;
    info.pAttachments = attachments;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = 2;
    info.pDependencies = dependencies;
    return create_unique<UniqueRenderPass>(device, vkCreateRenderPass, info, "vkCreateRenderPass");
}

Result<UniqueShader> create_shader(VkDevice device, std::span<const uint32_t> code) {
    VkShaderModuleCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = code.size_bytes();
    info.pCode = code.data();
    return create_unique<UniqueShader>(device, vkCreateShaderModule, info, "vkCreateShaderModule");
}

/// How pipelines differ. Without a fragment stage only depth is written, of one sample.
struct PipelineLook {
    std::span<const uint32_t> vertex, fragment;
    VkRenderPass pass = VK_NULL_HANDLE;
    bool strip = false;
    bool depth_write = true;
    VkCompareOp depth_compare = VK_COMPARE_OP_LESS_OR_EQUAL;
    bool blend = false;
    float slope_bias = 0;
    std::span<const uint32_t> control = {}, evaluation = {};  ///< of tessellation; both or none
};

Result<UniquePipeline> create_pipeline(const vk::Device& device, VkPipelineLayout layout,
                                       const PipelineLook& look) {
    const bool colors = !look.fragment.empty(), tessellates = !look.control.empty();
    UniqueShader shaders[4];
    VkPipelineShaderStageCreateInfo stages[4] = {};
    uint32_t stage_count = 0;
    for (const auto& [stage, code] : {std::pair{VK_SHADER_STAGE_VERTEX_BIT, look.vertex},
                                      std::pair{VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT, look.control},
                                      std::pair{VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT, look.evaluation},
                                      std::pair{VK_SHADER_STAGE_FRAGMENT_BIT, look.fragment}}) {
        if (code.empty()) continue;
        auto created = create_shader(device.handle, code);
        if (!created) return created.error();
        shaders[stage_count] = std::move(*created);
        VkPipelineShaderStageCreateInfo& info = stages[stage_count];
        info.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        info.stage = stage;
        info.module = shaders[stage_count++];
        info.pName = "main";
    }
    VkPipelineVertexInputStateCreateInfo input = {};
    input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    VkPipelineInputAssemblyStateCreateInfo assembly = {};
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = tessellates  ? VK_PRIMITIVE_TOPOLOGY_PATCH_LIST
                        : look.strip ? VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP
                                     : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineTessellationStateCreateInfo tessellation = {};
    tessellation.sType = VK_STRUCTURE_TYPE_PIPELINE_TESSELLATION_STATE_CREATE_INFO;
    tessellation.patchControlPoints = 1;
    VkPipelineViewportStateCreateInfo viewport = {};
    viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    viewport.viewportCount = viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster = {};
    raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.lineWidth = 1;
    raster.depthBiasEnable = look.slope_bias != 0;
    raster.depthBiasSlopeFactor = look.slope_bias;
    VkPipelineMultisampleStateCreateInfo multisample = {};
    multisample.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    multisample.rasterizationSamples = colors ? kSamples : VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth = {};
    depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    depth.depthTestEnable = VK_TRUE;
    depth.depthWriteEnable = look.depth_write;
    depth.depthCompareOp = look.depth_compare;
    VkPipelineColorBlendAttachmentState attachment = {};
    attachment.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                                VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    attachment.blendEnable = look.blend;
    attachment.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
    attachment.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    attachment.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    VkPipelineColorBlendStateCreateInfo blend = {};
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = colors ? 1 : 0;
    blend.pAttachments = &attachment;
    const VkDynamicState states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic = {};
    dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = states;

    VkGraphicsPipelineCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
    info.stageCount = stage_count;
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pTessellationState = tessellates ? &tessellation : nullptr;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &multisample;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = layout;
    info.renderPass = look.pass;
    VkPipeline pipeline = VK_NULL_HANDLE;
    const VkResult result =
        vkCreateGraphicsPipelines(device.handle, device.pipeline_cache, 1, &info, nullptr, &pipeline);
    if (result != VK_SUCCESS) return vk::vulkan_error("vkCreateGraphicsPipelines", result);
    return UniquePipeline(device.handle, pipeline);
}

/// Moves a result into place, or remembers the first error.
template <class T>
void keep(T& place, Result<T> result, Result<void>& status) {
    if (result)
        place = std::move(*result);
    else if (status)
        status = result.error();
}

}  // namespace

Result<Pipelines> create_pipelines(const vk::Device& device) {
    Pipelines out;
    Result<void> status;
    keep(out.set_layout, create_set_layout(device.handle), status);
    keep(out.scene_pass, create_scene_pass(device.handle), status);
    keep(out.shadow_pass, create_depth_pass(device.handle, kDepthFormat), status);
    keep(out.sky_pass, create_depth_pass(device.handle, kSkyFormat), status);
    if (!status) return status.error();
    const VkPushConstantRange range = {VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                       sizeof(shared::PushParams)};
    keep(out.layout, create_layout(device.handle, {out.set_layout}, range), status);
    if (!status) return status.error();

    const VkRenderPass scene = out.scene_pass;
    const struct {
        UniquePipeline& place;
        PipelineLook look;
    } pipelines[] = {
        {out.backdrop, {kBackdropVert, kBackdropFrag, scene, false, false, VK_COMPARE_OP_ALWAYS}},
        {out.ground, {kGroundVert, kGroundFrag, scene, true}},
        {out.mesh, {kMeshVert, kMeshFrag, scene}},
        {out.mesh_pulled, {kMeshPulledVert, kMeshFrag, scene}},
        {out.lines, {kLinesVert, kLinesFrag, scene, false, false, VK_COMPARE_OP_LESS_OR_EQUAL, true}},
        {out.hidden_lines, {kLinesVert, kLinesFrag, scene, false, false, VK_COMPARE_OP_GREATER, true}},
        {.place = out.shadow, .look = {.vertex = kDepthVert, .pass = out.shadow_pass, .slope_bias = 1.5f}},
        {.place = out.sky, .look = {.vertex = kDepthVert, .pass = out.sky_pass, .slope_bias = 1.5f}},
    };
    for (const auto& [place, look] : pipelines)
        keep(place, create_pipeline(device, out.layout, look), status);
    if (!status) return status.error();
    return out;
}

Result<HardwarePipelines> create_hardware_pipelines(const vk::Device& device, const Pipelines& pipelines,
                                                    const vk::HardwareTessellator& tessellator, Scheme scheme) {
    HardwarePipelines out;
    Result<void> status;
    keep(out.layout,
         create_layout(device.handle, {tessellator.set_layout(), pipelines.set_layout}, vk::kHardwarePushConstants),
         status);
    if (!status) return status.error();
    const vk::HardwareStages stages = tessellator.stages(scheme);
    PipelineLook look = {.vertex = stages.vertex, .control = stages.control, .evaluation = stages.evaluation};
    look.fragment = kMeshHardwareFrag;
    look.pass = pipelines.scene_pass;
    keep(out.mesh, create_pipeline(device, out.layout, look), status);
    look.fragment = {};
    look.slope_bias = 1.5f;
    look.pass = pipelines.shadow_pass;
    keep(out.shadow, create_pipeline(device, out.layout, look), status);
    look.pass = pipelines.sky_pass;
    keep(out.sky, create_pipeline(device, out.layout, look), status);
    if (!status) return status.error();
    return out;
}

}  // namespace limn::viewer
