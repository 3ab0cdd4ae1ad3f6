// Moves control points, so that there is something to look at: a twist and a wave.
#pragma once

#include "limn/vulkan/buffer.h"
#include "viewer/camera.h"
#include "viewer/compute_pass.h"

namespace limn::viewer {

class Deformer {
  public:
    /// `device` outlives it. Errors: out_of_memory, vulkan_failure.
    static Result<Deformer> create(const vk::Device& device);

    /// Moves `rest`, 3 floats each, into `points`, which has STORAGE_BUFFER usage; when nothing that was
    /// recorded is pending. Errors: out_of_memory, vulkan_failure.
    Result<void> set_points(std::span<const float> rest, VkBuffer points);

    /// Seconds after the start; `bounds` are the surface's at rest. Before: earlier reads of the points done.
    /// After: they are visible to vk::kKernelReads.
    void record(VkCommandBuffer commands, const Bounds& bounds, float seconds, float amplitude) const;

  private:
    Deformer(const vk::Device& device, ComputePass pass) : device_(&device), pass_(std::move(pass)) {}

    const vk::Device* device_;
    ComputePass pass_;
    vk::Buffer rest_;
    uint32_t count_ = 0;
};

}  // namespace limn::viewer
