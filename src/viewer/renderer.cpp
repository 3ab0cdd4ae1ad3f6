#include "viewer/renderer.h"

#include <algorithm>
#include <cstring>
#include <glm/gtc/type_ptr.hpp>

namespace limn::viewer {
namespace {

constexpr uint32_t kShadowSize = 2048;
constexpr uint32_t kSkyTileSize = 256;

Result<UniqueFramebuffer> create_framebuffer(VkDevice device, VkRenderPass pass,
                                             std::initializer_list<VkImageView> views, VkExtent2D extent) {
    VkFramebufferCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    info.renderPass = pass;
    info.attachmentCount = static_cast<uint32_t>(views.size());
    info.pAttachments = views.begin();
    info.width = extent.width;
    info.height = extent.height;
    info.layers = 1;
    return create_unique<UniqueFramebuffer>(device, vkCreateFramebuffer, info, "vkCreateFramebuffer");
}

bool filters_linearly(const vk::Device& device, VkFormat format) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device.physical_device, format, &properties);
    return (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT) != 0;
}

Result<UniqueSampler> create_sampler(const vk::Device& device, bool compare) {
    const bool linear =
        compare && filters_linearly(device, kDepthFormat) && filters_linearly(device, kSkyFormat);
    VkSamplerCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    info.magFilter = info.minFilter = linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
    info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER;
    info.borderColor = VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE;
    info.compareEnable = compare;
    info.compareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
    return create_unique<UniqueSampler>(device.handle, vkCreateSampler, info, "vkCreateSampler");
}

void begin_pass(VkCommandBuffer commands, VkRenderPass pass, VkFramebuffer frame, VkExtent2D extent,
                const VkClearValue (&clear)[2]) {
    VkRenderPassBeginInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    info.renderPass = pass;
    info.framebuffer = frame;
    info.renderArea.extent = extent;
    info.clearValueCount = 2;
    info.pClearValues = clear;
    vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
}

void set_viewport(VkCommandBuffer commands, VkRect2D area) {
    const VkViewport viewport = {static_cast<float>(area.offset.x),
                                 static_cast<float>(area.offset.y),
                                 static_cast<float>(area.extent.width),
                                 static_cast<float>(area.extent.height),
                                 0,
                                 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &area);
}

/// Modes and overlays that know triangles, not only vertices.
bool needs_triangles(const RenderSettings& settings) {
    return settings.wireframe || settings.color == ColorMode::kind || settings.color == ColorMode::level ||
           settings.color == ColorMode::rate;
}

/// What depth.vert does, as a matrix. `light`: 0 the key light, 1 + i sky direction i.
glm::mat4 clip_from_world(const shared::FrameParams& frame, uint32_t light) {
    glm::mat4 rows = glm::transpose(frame.shadow_from_world);
    if (light != 0)
        rows = glm::mat4(frame.sky_u[light - 1], frame.sky_v[light - 1], frame.sky_depth[light - 1],
                         glm::vec4(0, 0, 0, 1));
    rows[0] = 2.0f * rows[0] - rows[3];
    rows[1] = 2.0f * rows[1] - rows[3];
    return glm::transpose(rows);
}

void draw_hardware(VkCommandBuffer commands, const vk::HardwareTessellation& hardware, VkPipelineLayout layout,
                   const glm::mat4& clip_from_points) {
    hardware.record_draw(commands, layout, std::span<const float, 16>(glm::value_ptr(clip_from_points), 16));
}

}  // namespace

Result<Renderer> Renderer::create(const vk::Device& device) {
    Renderer out(device);
    auto pipelines = create_pipelines(device);
    if (!pipelines) return pipelines.error();
    out.pipelines_ = std::move(*pipelines);
    if (auto created = out.create_shadow_maps(); !created) return created.error();
    const struct {
        vk::Buffer& place;
        VkDeviceSize bytes;
        VkBufferUsageFlags usage;
        vk::MemoryUse use;
    } buffers[] = {
        {out.frame_params_, sizeof(shared::FrameParams), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
         vk::MemoryUse::upload},
        {out.pulled_, sizeof(VkDrawIndirectCommand),
         VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, vk::MemoryUse::device},
        {out.nothing_, 16, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, vk::MemoryUse::device},
    };
    for (const auto& [place, bytes, usage, use] : buffers) {
        auto buffer = vk::create_buffer(device, bytes, usage, use);
        if (!buffer) return buffer.error();
        place = std::move(*buffer);
    }
    if (auto created = out.create_set(); !created) return created.error();
    return out;
}

Result<void> Renderer::create_shadow_maps() {
    const uint32_t sky_size = kSkyTileSize * shared::kSkyTiles;
    const struct {
        GpuImage& image;
        UniqueFramebuffer& frame;
        VkRenderPass pass;
        VkFormat format;
        uint32_t size;
    } maps[] = {{shadow_, shadow_frame_, pipelines_.shadow_pass, kDepthFormat, kShadowSize},
                {sky_, sky_frame_, pipelines_.sky_pass, kSkyFormat, sky_size}};
    for (const auto& [image, frame, pass, format, size] : maps) {
        auto created = create_image(
            *device_, {.extent = {size, size},
                       .format = format,
                       .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                       .aspect = VK_IMAGE_ASPECT_DEPTH_BIT});
        if (!created) return created.error();
        image = std::move(*created);
        auto framebuffer = create_framebuffer(device_->handle, pass, {image.view}, image.extent);
        if (!framebuffer) return framebuffer.error();
        frame = std::move(*framebuffer);
    }
    auto compare = create_sampler(*device_, true), depth = create_sampler(*device_, false);
    if (!compare || !depth) return (compare ? depth : compare).error();
    compare_sampler_ = std::move(*compare);
    depth_sampler_ = std::move(*depth);
    return {};
}

Result<void> Renderer::create_set() {
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, shared::kBindingCount},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3}};
    VkDescriptorPoolCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.maxSets = 1;
    info.poolSizeCount = 3;
    info.pPoolSizes = sizes;
    auto pool = create_unique<UniqueDescriptorPool>(device_->handle, vkCreateDescriptorPool, info,
                                                    "vkCreateDescriptorPool");
    if (!pool) return pool.error();
    pool_ = std::move(*pool);
    const VkDescriptorSetLayout layout = pipelines_.set_layout;
    VkDescriptorSetAllocateInfo allocate = {};
    allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    allocate.descriptorPool = pool_;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &layout;
    if (const VkResult result = vkAllocateDescriptorSets(device_->handle, &allocate, &set_);
        result != VK_SUCCESS)
        return vk::vulkan_error("vkAllocateDescriptorSets", result);
    return {};
}

Result<void> Renderer::resize(VkExtent2D extent) {
    const VkPhysicalDeviceLimits& limits = device_->properties.limits;
    const uint32_t most =
        std::min({limits.maxImageDimension2D, limits.maxFramebufferWidth, limits.maxFramebufferHeight,
                  limits.maxViewportDimensions[0], limits.maxViewportDimensions[1]});
    if (extent.width == 0 || extent.height == 0)
        return Error{ErrorCode::invalid_argument, "a picture has at least one pixel"};
    if (std::max(extent.width, extent.height) > most)
        return Error{ErrorCode::unsupported, "a picture of " + std::to_string(extent.width) + "x" +
                                                 std::to_string(extent.height) + " is larger than " +
                                                 device_->name() + " draws: " + std::to_string(most) +
                                                 " pixels a side"};
    auto samples = create_image(*device_, {.extent = extent,
                                           .format = kColorFormat,
                                           .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                           .samples = kSamples});
    if (!samples) return samples.error();
    auto depth = create_image(*device_, {.extent = extent,
                                         .format = kDepthFormat,
                                         .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                                         .samples = kSamples,
                                         .aspect = VK_IMAGE_ASPECT_DEPTH_BIT});
    if (!depth) return depth.error();
    // Kept as bytes, so that user interfaces and copies to windows see sRGB; drawn to in linear light.
    auto color = create_image(*device_,
                              {.extent = extent,
                               .format = kRawColorFormat,
                               .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                               .flags = VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT});
    if (!color) return color.error();
    auto linear = create_image_view(*device_, color->image, kColorFormat, VK_IMAGE_ASPECT_COLOR_BIT);
    if (!linear) return linear.error();
    auto frame = create_framebuffer(device_->handle, pipelines_.scene_pass,
                                    {samples->view, depth->view, *linear}, extent);
    if (!frame) return frame.error();
    auto readback = vk::create_buffer(*device_, VkDeviceSize{4} * extent.width * extent.height,
                                      VK_BUFFER_USAGE_TRANSFER_DST_BIT, vk::MemoryUse::readback);
    if (!readback) return readback.error();
    scene_frame_ = std::move(*frame);
    linear_view_ = std::move(*linear);
    samples_ = std::move(*samples);
    depth_ = std::move(*depth);
    color_ = std::move(*color);
    readback_ = std::move(*readback);
    return {};
}

Result<void> Renderer::prepare_hardware(const vk::HardwareTessellator& tessellator, Scheme scheme) {
    auto created = create_hardware_pipelines(*device_, pipelines_, tessellator, scheme);
    if (!created) return created.error();
    hardware_ = std::move(*created);
    return {};
}

void Renderer::set_scene(const RenderMesh& mesh, const RenderLines& lines) {
    mesh_ = mesh;
    lines_ = lines;
    write_set();
}

void Renderer::write_set() const {
    const auto or_nothing = [&](VkBuffer buffer) {
        return VkDescriptorBufferInfo{buffer != VK_NULL_HANDLE ? buffer : nothing_.handle, 0, VK_WHOLE_SIZE};
    };
    const VkDescriptorBufferInfo buffers[shared::kBindShadow] = {{frame_params_.handle, 0, VK_WHOLE_SIZE},
                                                                 or_nothing(mesh_.vertices),
                                                                 or_nothing(mesh_.indices),
                                                                 or_nothing(mesh_.places),
                                                                 or_nothing(mesh_.triangle_faces),
                                                                 or_nothing(mesh_.face_rates),
                                                                 or_nothing(lines_.points),
                                                                 or_nothing(lines_.segments)};
    constexpr VkImageLayout kLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
    const VkDescriptorImageInfo images[] = {{compare_sampler_, shadow_.view, kLayout},
                                            {depth_sampler_, shadow_.view, kLayout},
                                            {compare_sampler_, sky_.view, kLayout}};
    VkWriteDescriptorSet writes[shared::kBindingCount] = {};
    for (uint32_t i = 0; i < shared::kBindingCount; ++i) {
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = set_;
        writes[i].dstBinding = i;
        writes[i].descriptorCount = 1;
        if (i < shared::kBindShadow) {
            writes[i].descriptorType = i == shared::kBindFrame ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                               : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
            writes[i].pBufferInfo = &buffers[i];
        } else {
            writes[i].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
            writes[i].pImageInfo = &images[i - shared::kBindShadow];
        }
    }
    vkUpdateDescriptorSets(device_->handle, shared::kBindingCount, writes, 0, nullptr);
}

void Renderer::push(VkCommandBuffer commands, uint32_t light, float opacity) const {
    const shared::PushParams params = {static_cast<uint32_t>(mesh_.vertices_offset / sizeof(float)),
                                       mesh_.vertex_stride_floats, light, opacity};
    vkCmdPushConstants(commands, pipelines_.layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                       0, sizeof params, &params);
}

/// As many vertices as the indexed command has indices.
void Renderer::record_pulled_command(VkCommandBuffer commands) const {
    const auto region = [&](size_t from, size_t to) {
        return VkBufferCopy{mesh_.indirect_offset + from, to, sizeof(uint32_t)};
    };
    using Indexed = VkDrawIndexedIndirectCommand;
    using Plain = VkDrawIndirectCommand;
    const VkBufferCopy regions[] = {region(offsetof(Indexed, indexCount), offsetof(Plain, vertexCount)),
                                    region(offsetof(Indexed, instanceCount), offsetof(Plain, instanceCount)),
                                    region(offsetof(Indexed, firstIndex), offsetof(Plain, firstVertex)),
                                    region(offsetof(Indexed, firstInstance), offsetof(Plain, firstInstance))};
    constexpr vk::StageAccess kCommand = {VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                                          VK_ACCESS_INDIRECT_COMMAND_READ_BIT};
    vk::record_barrier(*device_, commands, kCommand, vk::kCopyWrites);
    vkCmdCopyBuffer(commands, mesh_.indirect, pulled_.handle, 4, regions);
    vk::record_barrier(*device_, commands, vk::kCopyWrites, kCommand);
}

void Renderer::bind_set(VkCommandBuffer commands) const {
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.layout, 0, 1, &set_, 0,
                            nullptr);
}

void Renderer::record_depth(VkCommandBuffer commands, const shared::FrameParams& params, uint32_t light) const {
    if (mesh_.hardware != nullptr) {
        draw_hardware(commands, *mesh_.hardware, hardware_.layout, clip_from_world(params, light));
        return;
    }
    push(commands, light, 1);
    vkCmdDrawIndexedIndirect(commands, mesh_.indirect, mesh_.indirect_offset, 1, 0);
}

void Renderer::record_depths(VkCommandBuffer commands, const shared::FrameParams& params, PassTimer* timer) const {
    const bool hardware = mesh_.hardware != nullptr;
    const VkClearValue clear[2] = {{.depthStencil = {1, 0}}, {.depthStencil = {1, 0}}};
    begin_pass(commands, pipelines_.shadow_pass, shadow_frame_, shadow_.extent, clear);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, hardware ? hardware_.shadow : pipelines_.shadow);
    set_viewport(commands, {{0, 0}, shadow_.extent});
    record_depth(commands, params, 0);
    vkCmdEndRenderPass(commands);
    if (timer != nullptr) timer->record_mark(commands, "key shadow");

    begin_pass(commands, pipelines_.sky_pass, sky_frame_, sky_.extent, clear);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, hardware ? hardware_.sky : pipelines_.sky);
    for (uint32_t i = 0; i < params.options.z; ++i) {
        const VkOffset2D corner = {static_cast<int32_t>(i % shared::kSkyTiles * kSkyTileSize),
                                   static_cast<int32_t>(i / shared::kSkyTiles * kSkyTileSize)};
        set_viewport(commands, {corner, {kSkyTileSize, kSkyTileSize}});
        record_depth(commands, params, 1 + i);
    }
    vkCmdEndRenderPass(commands);
    if (timer != nullptr) timer->record_mark(commands, "sky shadows");
}

void Renderer::record_surface(VkCommandBuffer commands, const shared::FrameParams& params,
                              const RenderSettings& settings) const {
    if (mesh_.hardware != nullptr) {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, hardware_.mesh);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, hardware_.layout, 1, 1, &set_, 0, nullptr);
        draw_hardware(commands, *mesh_.hardware, hardware_.layout, params.clip_from_world);
        bind_set(commands);  // limn's own was in its place
        push(commands, 0, 1);
    } else if (needs_triangles(settings)) {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.mesh_pulled);
        vkCmdDrawIndirect(commands, pulled_.handle, 0, 1, 0);
    } else {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.mesh);
        vkCmdDrawIndexedIndirect(commands, mesh_.indirect, mesh_.indirect_offset, 1, 0);
    }
}

void Renderer::record_scene(VkCommandBuffer commands, const shared::FrameParams& params, const View& view) const {
    const RenderSettings& settings = view.settings;
    const VkClearValue clear[2] = {{}, {.depthStencil = {1, 0}}};
    begin_pass(commands, pipelines_.scene_pass, scene_frame_, color_.extent, clear);
    set_viewport(commands, {{0, 0}, color_.extent});
    push(commands, 0, 1);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.backdrop);
    vkCmdDraw(commands, 3, 1, 0, 0);
    record_surface(commands, params, settings);
    const bool above = view.camera.eye.y > view.bounds.low.y;
    if (settings.ground && above && settings.color != ColorMode::sides) {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.ground);
        vkCmdDraw(commands, 4, 1, 0, 0);
    }
    if (settings.lines && lines_.segment_count != 0) {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.hidden_lines);
        push(commands, 0, 0.16f);
        vkCmdDraw(commands, 6 * lines_.segment_count, 1, 0, 0);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.lines);
        push(commands, 0, 0.9f);
        vkCmdDraw(commands, 6 * lines_.segment_count, 1, 0, 0);
    }
    vkCmdEndRenderPass(commands);
}

void Renderer::record(VkCommandBuffer commands, const View& view, PassTimer* timer) {
    const shared::FrameParams params =
        build_frame_params(view.camera, view.bounds, view.settings, mesh_, color_.extent);
    std::memcpy(frame_params_.mapped(), &params, sizeof params);
    if (mesh_.hardware == nullptr) {
        if (needs_triangles(view.settings)) record_pulled_command(commands);
        vkCmdBindIndexBuffer(commands, mesh_.indices, 0, VK_INDEX_TYPE_UINT32);
    }
    bind_set(commands);
    if (!view.keep_shadows) record_depths(commands, params, timer);
    bind_set(commands);
    record_scene(commands, params, view);
    if (timer != nullptr) timer->record_mark(commands, "picture");
}

void Renderer::record_finish(VkCommandBuffer commands) const {
    VkImageMemoryBarrier barrier = {};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    barrier.srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = color_.image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

void Renderer::record_readback(VkCommandBuffer commands) const {
    VkBufferImageCopy region = {};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {color_.extent.width, color_.extent.height, 1};
    vkCmdCopyImageToBuffer(commands, color_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback_.handle, 1,
                           &region);
    vk::record_barrier(*device_, commands, vk::kCopyWrites, vk::kHostReads);
}

Picture Renderer::read_picture() const {
    Picture picture = {color_.extent.width, color_.extent.height, {}};
    const size_t pixels = size_t{picture.width} * picture.height;
    picture.rgb.resize(3 * pixels);
    const auto* from = static_cast<const uint8_t*>(readback_.mapped());
    for (size_t i = 0; i < pixels; ++i) std::memcpy(picture.rgb.data() + 3 * i, from + 4 * i, 3);
    return picture;
}

}  // namespace limn::viewer
