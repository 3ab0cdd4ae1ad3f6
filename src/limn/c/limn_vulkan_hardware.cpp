// The C interface on Vulkan: hardware tessellation.
#include "limn/c/vulkan_interop.h"
#include "limn/vulkan/hardware_tessellation.h"

struct limn_vk_hardware_tessellator {
    limn::vk::HardwareTessellator value;
};
struct limn_vk_hardware_tessellation {
    limn::vk::HardwareTessellation value;
};

namespace limn::c {
namespace {

static_assert(LIMN_VK_HARDWARE_STAGES == vk::kHardwareReads.stages && LIMN_VK_HARDWARE_READS == vk::kHardwareReads.access);

limn_vk_stage_code code_of(std::span<const uint32_t> words) {
    return {words.data(), words.size()};
}

Result<vk::HardwareTessellator> create_tessellator(const limn_vk_context* context, uint32_t flags) {
    Reader reader;
    if (context == nullptr) reader.fail("context is null");
    reader.flags(flags, LIMN_VK_TESSELLATION_SHADER_ENABLED);
    if (!reader.state) return reader.state.error();
    return vk::HardwareTessellator::create(
        {&context->value->device(), (flags & LIMN_VK_TESSELLATION_SHADER_ENABLED) != 0});
}

Result<vk::HardwareTessellation> prepare(const limn_vk_hardware_tessellator* tessellator,
                                         const limn_vk_tessellation* tessellation) {
    if (tessellator == nullptr || tessellation == nullptr) return bad_argument("tessellator or tessellation is null");
    return tessellator->value.prepare(tessellation->value);
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_vk_hardware_tessellator_create(const limn_vk_context* context, uint32_t flags,
                                                limn_vk_hardware_tessellator** tessellator, limn_error* error) noexcept {
    return create(tessellator, error, [&] { return create_tessellator(context, flags); });
}
void limn_vk_hardware_tessellator_destroy(limn_vk_hardware_tessellator* tessellator) noexcept {
    delete tessellator;
}
limn_result limn_vk_hardware_tessellator_get_stages(const limn_vk_hardware_tessellator* tessellator, limn_scheme scheme,
                                                    limn_vk_hardware_stages* stages, limn_error* error) noexcept {
    if (tessellator == nullptr) return report(bad_argument("tessellator is null"), error);
    if (scheme > LIMN_SCHEME_DOO_SABIN) return report(bad_argument("there is no such scheme"), error);
    const auto code = tessellator->value.stages(static_cast<limn::Scheme>(scheme));
    const limn_vk_hardware_stages known = {0,
                                           0,
                                           tessellator->value.set_layout(),
                                           limn::vk::kHardwarePushConstants,
                                           0,
                                           code_of(code.vertex),
                                           code_of(code.control),
                                           code_of(code.evaluation)};
    return write_struct(known, stages, error);
}

limn_result limn_vk_hardware_tessellator_prepare(const limn_vk_hardware_tessellator* tessellator,
                                                 const limn_vk_tessellation* tessellation,
                                                 limn_vk_hardware_tessellation** prepared, limn_error* error) noexcept {
    return create(prepared, error, [&] { return prepare(tessellator, tessellation); });
}
void limn_vk_hardware_tessellation_destroy(limn_vk_hardware_tessellation* prepared) noexcept {
    delete prepared;
}
void limn_vk_hardware_tessellation_record_draw(const limn_vk_hardware_tessellation* prepared, VkCommandBuffer commands,
                                               VkPipelineLayout layout, const float* clip_from_points) noexcept {
    if (prepared == nullptr || commands == VK_NULL_HANDLE || layout == VK_NULL_HANDLE || clip_from_points == nullptr) return;
    prepared->value.record_draw(commands, layout, std::span<const float, 16>(clip_from_points, 16));
}
