#include "viewer/deformer.h"

#include "limn_shaders/deform_comp.h"

namespace limn::viewer {
namespace {

/// As deform.comp has it.
struct DeformParams {
    float sphere[4];
    uint32_t count;
    float time;
    float amplitude;
};

}  // namespace

Result<Deformer> Deformer::create(const vk::Device& device) {
    auto pass = ComputePass::create(device, kDeformComp, 2, sizeof(DeformParams));
    if (!pass) return pass.error();
    return Deformer(device, std::move(*pass));
}

Result<void> Deformer::set_points(std::span<const float> rest, VkBuffer points) {
    auto buffer = vk::create_point_buffer(*device_, rest);
    if (!buffer) return buffer.error();
    rest_ = std::move(*buffer);
    count_ = static_cast<uint32_t>(rest.size() / 3);
    pass_.set_buffers(std::array{rest_.handle, points});
    return {};
}

void Deformer::record(VkCommandBuffer commands, const Bounds& bounds, float seconds, float amplitude) const {
    const glm::vec3 centre = bounds.centre();
    const DeformParams params = {{centre.x, centre.y, centre.z, bounds.radius()}, count_, seconds, amplitude};
    pass_.record(commands, params, count_);
    vk::record_barrier(*device_, commands, vk::kKernelWrites, vk::kKernelReads);
}

}  // namespace limn::viewer
