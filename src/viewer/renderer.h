// Draws a surface: into an image of its own, from where it is copied to a window or to the host.
#pragma once

#include "viewer/frame.h"
#include "viewer/pass_timer.h"
#include "viewer/picture.h"
#include "viewer/pipelines.h"

namespace limn::viewer {

/// One picture at a time: what is recorded here must have completed before anything else is called. A frame:
/// record(); whatever else draws into the image; record_finish(); copies.
class Renderer {
  public:
    /// Errors: out_of_memory, vulkan_failure. `device` can draw, and outlives the renderer.
    static Result<Renderer> create(const vk::Device& device);

    /// Makes an image of this size; before the first record(). Errors: invalid_argument (no pixels),
    /// unsupported (more than the device's largest picture), out_of_memory, vulkan_failure.
    Result<void> resize(VkExtent2D extent);
    VkExtent2D extent() const { return color_.extent; }

    /// Before a scene with hardware tessellation, of a surface of this scheme; the tessellator outlives the renderer.
    /// Errors: out_of_memory, vulkan_failure.
    Result<void> prepare_hardware(const vk::HardwareTessellator& tessellator, Scheme scheme);
    /// What record() draws from now on; before the first one.
    void set_scene(const RenderMesh& mesh, const RenderLines& lines);

    struct View {
        Camera camera;
        Bounds bounds;  ///< of the surface: shadows reach that far, the ground lies below it
        RenderSettings settings;
        bool keep_shadows = false;  ///< those of the last record(): surface, bounds and lights are the same
    };
    /// Before: the scene visible to kRenderReads. After: the image is in COLOR_ATTACHMENT_OPTIMAL, visible to
    /// further colour attachment writes. `timer` may be null.
    void record(VkCommandBuffer commands, const View& view, PassTimer* timer);
    /// After all drawing: the image becomes a source of copies.
    void record_finish(VkCommandBuffer commands) const;

    VkImage image() const { return color_.image; }
    VkImageView view() const { return color_.view; }  ///< kRawColorFormat

    /// Copies the finished image for read_picture(), which may be called once the commands have completed.
    void record_readback(VkCommandBuffer commands) const;
    Picture read_picture() const;

  private:
    explicit Renderer(const vk::Device& device) : device_(&device) {}
    Result<void> create_shadow_maps();
    Result<void> create_set();
    void write_set() const;
    void record_pulled_command(VkCommandBuffer commands) const;
    void record_depths(VkCommandBuffer commands, const shared::FrameParams& params, PassTimer* timer) const;
    void record_depth(VkCommandBuffer commands, const shared::FrameParams& params, uint32_t light) const;
    void record_scene(VkCommandBuffer commands, const shared::FrameParams& params, const View& view) const;
    void record_surface(VkCommandBuffer commands, const shared::FrameParams& params,
                        const RenderSettings& settings) const;
    void bind_set(VkCommandBuffer commands) const;
    void push(VkCommandBuffer commands, uint32_t light, float opacity) const;

    const vk::Device* device_;
    Pipelines pipelines_;
    HardwarePipelines hardware_;
    UniqueDescriptorPool pool_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    UniqueSampler compare_sampler_, depth_sampler_;
    GpuImage shadow_, sky_;
    UniqueFramebuffer shadow_frame_, sky_frame_;
    GpuImage samples_, depth_, color_;
    UniqueImageView linear_view_;  ///< of color_
    UniqueFramebuffer scene_frame_;
    vk::Buffer frame_params_;  ///< mapped
    vk::Buffer pulled_;        ///< the VkDrawIndirectCommand of mesh_pulled
    vk::Buffer nothing_;       ///< stands for optional buffers that are not there
    vk::Buffer readback_;
    RenderMesh mesh_;
    RenderLines lines_;
};

}  // namespace limn::viewer
