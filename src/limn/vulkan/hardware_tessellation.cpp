#include "limn/vulkan/hardware_tessellation.h"

#include <algorithm>

#include "limn/vulkan/tessellation_state.h"
#include "limn_kernels/tess_hardware_tesc.h"
#include "limn_kernels/tess_hardware_tesc_texel.h"
#include "limn_kernels/tess_hardware_tesc_triangles.h"
#include "limn_kernels/tess_hardware_tesc_triangles_texel.h"
#include "limn_kernels/tess_hardware_tese.h"
#include "limn_kernels/tess_hardware_tese_texel.h"
#include "limn_kernels/tess_hardware_tese_triangles.h"
#include "limn_kernels/tess_hardware_tese_triangles_texel.h"
#include "limn_kernels/tess_hardware_vert.h"

namespace limn::vk {

// llvmpipe numbers the vertices of a draw with 16 bits (Mesa 22.3): beyond, faces get those of others.
constexpr uint32_t kFacesPerDrawOnCpu = 65536 / ((shared::kHardwareMaxRate + 1) * (shared::kHardwareMaxRate + 1));

struct HardwareTessellation::State {
    Recording sets;
    VkDescriptorSet set = VK_NULL_HANDLE;
    uint32_t face_count = 0, faces_per_draw = 0;
    shared::TessHardwareParams params = {};
};

struct HardwareTessellator::State {
    const Device* device = nullptr;
    bool texel = false;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;

    ~State() {
        if (set_layout != VK_NULL_HANDLE)
            device->functions.DestroyDescriptorSetLayout(device->handle, set_layout, device->host_allocator);
    }
    VkDescriptorType type() const {
        return texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    }
};

HardwareTessellation::HardwareTessellation() : state_(std::make_unique<State>()) {}
HardwareTessellation::HardwareTessellation(HardwareTessellation&&) noexcept = default;
HardwareTessellation& HardwareTessellation::operator=(HardwareTessellation&&) noexcept = default;
HardwareTessellation::~HardwareTessellation() = default;

void HardwareTessellation::record_draw(VkCommandBuffer command_buffer, VkPipelineLayout layout,
                                       std::span<const float, 16> clip_from_points) const {
    const State& s = *state_;
    const Functions& functions = s.sets.device->functions;
    shared::TessHardwareParams params = s.params;
    std::copy(clip_from_points.begin(), clip_from_points.end(), params.clip_from_points);
    functions.CmdBindDescriptorSets(command_buffer, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &s.set, 0, nullptr);
    functions.CmdPushConstants(command_buffer, layout, kHardwarePushConstants.stageFlags, 0, sizeof params, &params);
    for (uint32_t first = 0; first < s.face_count; first += s.faces_per_draw)
        functions.CmdDraw(command_buffer, std::min(s.faces_per_draw, s.face_count - first), 1, first, 0);
}

HardwareTessellator::HardwareTessellator() : state_(std::make_unique<State>()) {}
HardwareTessellator::HardwareTessellator(HardwareTessellator&&) noexcept = default;
HardwareTessellator& HardwareTessellator::operator=(HardwareTessellator&&) noexcept = default;
HardwareTessellator::~HardwareTessellator() = default;

Result<HardwareTessellator> HardwareTessellator::create(const HardwareTessellatorInfo& info) {
    if (!info.tessellation_shader_enabled)
        return Error{ErrorCode::unsupported,
                     std::string("hardware tessellation takes the feature tessellationShader, which is not enabled on ") +
                         info.device->name()};
    HardwareTessellator tessellator;
    State& state = *tessellator.state_;
    state.device = info.device;
    state.texel = reads_texels(*info.device);
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (uint32_t b = 0; b < shared::kHardwareBindingCount; ++b)
        bindings.push_back({.binding = b,
                            .descriptorType = state.type(),
                            .descriptorCount = 1,
                            .stageFlags = kHardwarePushConstants.stageFlags,
                            .pImmutableSamplers = nullptr});
    VkDescriptorSetLayoutCreateInfo layout = {};
    layout.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    layout.bindingCount = shared::kHardwareBindingCount;
    layout.pBindings = bindings.data();
    const VkResult result = info.device->functions.CreateDescriptorSetLayout(info.device->handle, &layout, info.device->host_allocator,
                                                                             &state.set_layout);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateDescriptorSetLayout", result);
    return tessellator;
}

VkDescriptorSetLayout HardwareTessellator::set_layout() const {
    return state_->set_layout;
}

HardwareStages HardwareTessellator::stages(Scheme scheme) const {
    if (scheme == Scheme::loop)
        return state_->texel
                   ? HardwareStages{kTessHardwareVert, kTessHardwareTescTrianglesTexel, kTessHardwareTeseTrianglesTexel}
                   : HardwareStages{kTessHardwareVert, kTessHardwareTescTriangles, kTessHardwareTeseTriangles};
    return state_->texel ? HardwareStages{kTessHardwareVert, kTessHardwareTescTexel, kTessHardwareTeseTexel}
                         : HardwareStages{kTessHardwareVert, kTessHardwareTesc, kTessHardwareTese};
}

Result<HardwareTessellation> HardwareTessellator::prepare(const Tessellation& tessellation) const {
    const Tessellation::State& from = *tessellation.state_;
    const DeviceTessellationTable& table = *from.table;
    HardwareTessellation out;
    HardwareTessellation::State& state = *out.state_;
    state.sets.device = state_->device;
    state.face_count = table.face_count;
    state.faces_per_draw = state_->texel ? kFacesPerDrawOnCpu : table.face_count;
    state.params.tree = table.vertices.offsets;
    state.params.table = table.offsets;
    state.params.rate_edge_count = table.rate_edge_count;
    state.params.corner_copy_count = table.corner_copy_count;
    state.params.row_copy_count = table.row_copy_count;
    state.params.spacing = static_cast<uint32_t>(from.spacing);
    const auto bound = [&](const Buffer& buffer, VkFormat format) {
        return BoundBuffer{buffer.handle, 0, buffer.size_bytes, state_->type(), format};
    };
    const BoundBuffer buffers[shared::kHardwareBindingCount] = {bound(table.words, VK_FORMAT_R32_UINT),
                                                                bound(table.words, VK_FORMAT_R32G32B32A32_UINT),
                                                                bound(from.local[0], VK_FORMAT_R32G32B32A32_SFLOAT),
                                                                bound(from.words, VK_FORMAT_R32_UINT)};
    auto set = state.sets.add_set(state_->set_layout, buffers);
    if (!set) return set.error();
    state.set = *set;
    return out;
}

}  // namespace limn::vk
