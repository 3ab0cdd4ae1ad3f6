// What drawing takes that does not depend on the size of the picture: passes, layouts, pipelines.
#pragma once

#include "limn/vulkan/hardware_tessellation.h"
#include "viewer/handles.h"

namespace limn::viewer {

inline constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_SRGB;
inline constexpr VkFormat kRawColorFormat = VK_FORMAT_R8G8B8A8_UNORM;  ///< the same bytes, not decoded
inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
inline constexpr VkFormat kSkyFormat = VK_FORMAT_D16_UNORM;
inline constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;  // every device has it

struct Pipelines {
    UniqueSetLayout set_layout;
    UniquePipelineLayout layout;
    /// Attachment 0 colour and 1 depth of several samples, 2 what is resolved, left as a colour attachment.
    UniqueRenderPass scene_pass;
    UniqueRenderPass shadow_pass, sky_pass;  ///< depth only, left readable for fragment stages
    UniquePipeline backdrop, ground, mesh, mesh_pulled, lines, hidden_lines;
    UniquePipeline shadow, sky;
};

/// The surface by limn's stages of hardware tessellation: set 0 and push constants are limn's, Pipelines::set_layout is
/// that of set 1.
struct HardwarePipelines {
    UniquePipelineLayout layout;
    UniquePipeline mesh, shadow, sky;
};
/// For surfaces of this scheme. Errors: out_of_memory, vulkan_failure.
Result<HardwarePipelines> create_hardware_pipelines(const vk::Device& device, const Pipelines& pipelines,
                                                    const vk::HardwareTessellator& tessellator, Scheme scheme);

/// Viewport and scissor are dynamic. Errors: out_of_memory, vulkan_failure.
Result<Pipelines> create_pipelines(const vk::Device& device);

}  // namespace limn::viewer
