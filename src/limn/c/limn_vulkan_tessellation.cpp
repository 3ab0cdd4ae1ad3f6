// The C interface on Vulkan: tessellation.
#include "limn/c/vulkan_interop.h"

struct limn_vk_tessellator {
    limn::vk::Tessellator value;
    const limn::vk::Device& device;
};

namespace limn::c {
namespace {

static_assert(sizeof(limn_vk_instance) == sizeof(vk::TessellationInstance) &&
              offsetof(limn_vk_instance, value_scale) == offsetof(vk::TessellationInstance, value_scale) &&
              offsetof(limn_vk_instance, flags) == offsetof(vk::TessellationInstance, flags));
static_assert(LIMN_VK_INSTANCE_HIDDEN == shared::kInstanceHidden &&
              LIMN_VK_INSTANCE_KEEP_OUTSIDE == shared::kInstanceKeepOutside &&
              LIMN_VK_INSTANCE_KEEP_BACKFACES == shared::kInstanceKeepBackfaces);
static_assert(sizeof(limn_vk_tessellation_result) == sizeof(vk::TessellationResult));
static_assert(LIMN_TESSELLATION_COMPLETE == shared::kTessComplete &&
              LIMN_TESSELLATION_SCALED == shared::kTessScaled &&
              LIMN_TESSELLATION_TOO_SMALL == shared::kTessTooSmall &&
              LIMN_TESSELLATION_NOT_FINITE == shared::kTessNotFinite &&
              LIMN_TESSELLATION_BAD_SETTINGS == shared::kTessBadSettings);

constexpr uint32_t kAllFlags = 2 * LIMN_VK_TESSELLATION_FIRST_INSTANCE_0 - 1;
constexpr vk::StageAccess kKernels = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                      VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT};
constexpr uint32_t kAllPasses = 2 * LIMN_VK_PASS_DISPLACEMENT - 1;

vk::WordBuffer read_words(const limn_vk_words& words) {
    return {words.buffer, words.offset_bytes};
}

vk::HeightTexture read_texture(const limn_vk_height_texture& texture) {
    const auto layout = texture.layout != 0 ? texture.layout : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    return {texture.view, texture.sampler, layout, texture.channel, texture.scale != 0 ? texture.scale : 1,
            texture.bias};
}

std::vector<vk::TessellatedChannel> read_channels(Reader& reader, const limn_vk_tessellation_info& info) {
    std::vector<vk::TessellatedChannel> channels;
    for (const limn_vk_tessellated_channel& c : reader.array(info.channels, info.channel_count, "channels")) {
        const uint32_t width = c.width != 0 ? c.width : 2;
        channels.push_back({.channel = c.channel,
                            .patches = value_of(c.patches),
                            .width = width,
                            .points = read_points(reader, c.points, width),
                            .values = read_points(reader, c.values, width)});
    }
    return channels;
}

/// All but channels.
vk::TessellationInfo read_info(Reader& reader, const limn_vk_tessellation_info& i) {
    reader.flags(i.flags, kAllFlags);
    const auto has = [&](uint32_t flag) { return (i.flags & flag) != 0; };
    vk::TessellationInfo out;
    out.patches = value_of(i.patches);
    out.table = value_of(i.table);
    out.points = read_points(reader, i.points, 3);
    out.mode = reader.choice(i.mode, kRateModes, "rate mode");
    out.spacing = reader.choice(i.spacing, kSpacings, "spacing");
    out.cull_outside = has(LIMN_VK_TESSELLATION_CULL_OUTSIDE);
    out.cull_backfaces = has(LIMN_VK_TESSELLATION_CULL_BACKFACES);
    out.edge_rates = read_words(i.edge_rates);
    out.instances = read_words(i.instances);
    out.vertex_capacity = i.vertex_capacity;
    out.triangle_capacity = i.triangle_capacity;
    out.fit_capacity = !has(LIMN_VK_TESSELLATION_KEEP_RATES);
    out.positions = read_points(reader, i.positions, 3);
    out.normals = read_points(reader, i.normals, 3);
    out.places = read_points(reader, i.places, 4);
    out.tangents = read_points(reader, i.tangents, 4);
    if (has(LIMN_VK_TESSELLATION_CHANNEL_TANGENTS)) out.tangent_channel = i.tangent_channel;
    out.previous_points = read_points(reader, i.previous_points, 3);
    out.previous_positions = read_points(reader, i.previous_positions, 3);
    out.heights = read_points(reader, i.heights, 3);
    out.height_texture = read_texture(i.height_texture);
    out.indices = read_words(i.indices);
    out.clockwise = has(LIMN_VK_TESSELLATION_CLOCKWISE);
    out.triangle_faces = read_words(i.triangle_faces);
    out.command = read_words(i.command);
    out.instance_commands = read_words(i.instance_commands);
    out.number_instances = !has(LIMN_VK_TESSELLATION_FIRST_INSTANCE_0);
    out.result = read_words(i.result);
    return out;
}

Result<limn_vk_tessellation> prepare(const limn_vk_tessellator* tessellator,
                                     const limn_vk_tessellation_info* given) {
    if (tessellator == nullptr) return bad_argument("tessellator is null");
    const auto read = read_struct(given);
    if (!read) return read.error();
    Reader reader;
    const std::vector<vk::TessellatedChannel> channels = read_channels(reader, *read);
    vk::TessellationInfo info = read_info(reader, *read);
    if (!reader.state) return reader.state.error();
    info.channels = channels;
    auto prepared = tessellator->value.prepare(info);
    if (!prepared) return prepared.error();
    return limn_vk_tessellation{std::move(*prepared), info.mode, info.spacing, tessellator->device};
}

Result<RateSettings> read_settings(const limn_vk_tessellation& tessellation,
                                   const limn_vk_rate_settings* given) {
    const auto read = read_struct(given);
    if (!read) return read.error();
    RateSettings out{.mode = tessellation.mode, .value = read->value, .spacing = tessellation.spacing};
    if (read->max_rate != 0) out.max_rate = read->max_rate;
    std::copy(std::begin(read->matrix), std::end(read->matrix), out.camera.matrix);
    out.camera.width = read->width;
    out.camera.height = read->height;
    out.bound = read->bound;
    return out;
}

/// Settings that cannot be read, too, draw nothing: rather than what an earlier frame left behind.
Result<void> record_rates(const limn_vk_tessellation& tessellation, VkCommandBuffer commands,
                          const limn_vk_rate_settings* given) {
    const auto settings = read_settings(tessellation, given);
    const auto recorded =
        tessellation.value.record_rates(commands, settings ? *settings : RateSettings{.max_rate = 0});
    return settings ? recorded : settings.error();
}

Result<void> record_passes(const limn_vk_tessellation& tessellation, VkCommandBuffer commands,
                           uint32_t passes, const limn_vk_rate_settings* given) {
    const vk::Tessellation& t = tessellation.value;
    const auto settings = read_settings(tessellation, given);
    const uint32_t largest = settings ? t.largest_rate(*settings) : shared::kMaxSideRate;
    Result<void> recorded;
    if ((passes & LIMN_VK_PASS_POINTS) != 0) t.record_points(commands);
    if ((passes & LIMN_VK_PASS_RATES) != 0) recorded = record_rates(tessellation, commands, given);
    if ((passes & LIMN_VK_PASS_TRIANGLES) != 0) t.record_triangles(commands, largest);
    if ((passes & LIMN_VK_PASS_VERTICES) != 0) t.record_vertices(commands, largest);
    if ((passes & LIMN_VK_PASS_HEIGHTS) != 0) t.record_heights(commands, largest);
    if ((passes & LIMN_VK_PASS_DISPLACEMENT) != 0) {
        vk::record_barrier(tessellation.device, commands, kKernels, kKernels);
        t.record_displacement(commands, largest);
    }
    return recorded;
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_vk_tessellator_create(const limn_vk_context* context, limn_vk_tessellator** tessellator,
                                       limn_error* error) noexcept {
    if (tessellator == nullptr) return report(bad_argument("tessellator is null"), error);
    *tessellator = nullptr;
    if (context == nullptr) return report(bad_argument("context is null"), error);
    const limn::vk::Device& device = context->value->device();
    auto created = limn::vk::Tessellator::create(device);
    if (!created) return report(created.error(), error);
    *tessellator = new (std::nothrow) limn_vk_tessellator{std::move(*created), device};
    return *tessellator != nullptr ? LIMN_SUCCESS : report(out_of_memory(), error);
}
void limn_vk_tessellator_destroy(limn_vk_tessellator* tessellator) noexcept {
    delete tessellator;
}

limn_result limn_vk_tessellator_prepare(const limn_vk_tessellator* tessellator,
                                        const limn_vk_tessellation_info* info,
                                        limn_vk_tessellation** tessellation, limn_error* error) noexcept {
    if (tessellation == nullptr) return report(bad_argument("tessellation is null"), error);
    *tessellation = nullptr;
    auto prepared = prepare(tessellator, info);
    if (!prepared) return report(prepared.error(), error);
    *tessellation = new (std::nothrow) limn_vk_tessellation(std::move(*prepared));
    return *tessellation != nullptr ? LIMN_SUCCESS : report(out_of_memory(), error);
}
void limn_vk_tessellation_destroy(limn_vk_tessellation* tessellation) noexcept {
    delete tessellation;
}
uint64_t limn_vk_tessellation_get_state_bytes(const limn_vk_tessellation* tessellation) noexcept {
    return tessellation != nullptr ? tessellation->value.state_bytes() : 0;
}

limn_result limn_vk_tessellation_record(const limn_vk_tessellation* tessellation, VkCommandBuffer commands,
                                        const limn_vk_rate_settings* settings, limn_error* error) noexcept {
    if (tessellation == nullptr || commands == VK_NULL_HANDLE)
        return report(bad_argument("tessellation or commands is null"), error);
    const auto read = read_settings(*tessellation, settings);
    const auto recorded =
        tessellation->value.record(commands, read ? *read : limn::RateSettings{.max_rate = 0});
    if (!read) return report(read.error(), error);
    return recorded ? LIMN_SUCCESS : report(recorded.error(), error);
}
limn_result limn_vk_tessellation_record_passes(const limn_vk_tessellation* tessellation,
                                               VkCommandBuffer commands, uint32_t passes,
                                               const limn_vk_rate_settings* settings,
                                               limn_error* error) noexcept {
    if (tessellation == nullptr || commands == VK_NULL_HANDLE)
        return report(bad_argument("tessellation or commands is null"), error);
    if (passes == 0 || passes > kAllPasses) return report(bad_argument("there is no such pass"), error);
    const auto recorded = record_passes(*tessellation, commands, passes, settings);
    return recorded ? LIMN_SUCCESS : report(recorded.error(), error);
}
