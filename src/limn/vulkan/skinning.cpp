#include "limn/vulkan/skinning.h"

#include <algorithm>

#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/recording.h"
#include "limn/vulkan/table_upload.h"
#include "limn_kernels/skin.h"
#include "limn_kernels/skin_texel.h"

namespace limn::vk {
namespace {

using shared::SkinParams;

Array<shared::SkinGroup> list_groups(const SkinTable& table) {
    Array<shared::SkinGroup> groups;
    for (uint32_t i = 0; i < table.instances.size(); ++i) {
        const uint32_t point_count = table.meshes[table.instances[i].mesh].point_count;
        for (uint64_t first = 0; first < point_count; first += shared::kSkinWorkgroupSize)
            groups.push_back({i, static_cast<uint32_t>(first)});
    }
    return groups;
}

Result<void> check(const WordBuffer& words, uint32_t count, uint32_t alignment, const char* missing,
                   const char* misaligned) {
    if (count == 0) return {};
    if (words.buffer == VK_NULL_HANDLE) return bad_argument(missing);
    if (words.offset_bytes % alignment != 0) return bad_argument(misaligned);
    return {};
}

Result<void> check(const SkinningInfo& info) {
    if (info.table == nullptr) return bad_argument("there is no skin table to evaluate");
    if (auto checked = check(info.joint_matrices, info.table->joint_count, 16, "the buffer of joint matrices is null",
                             "offset_bytes of joint matrices is not a multiple of 16");
        !checked)
        return checked;
    if (auto checked = check(info.morph_weights, info.table->morph_weight_count, 4, "the buffer of morph weights is null",
                             "offset_bytes of morph weights is not a multiple of 4");
        !checked)
        return checked;
    return check_points(info.points, 3);
}

}  // namespace

Result<SkinTableUpload> record_skin_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                 const SkinTable& table) {
    SkinTableUpload upload;
    DeviceSkinTable& out = upload.table;
    const Array<shared::SkinGroup> groups = list_groups(table);
    out.point_count = table.point_count;
    out.joint_count = table.joint_count;
    out.morph_weight_count = table.morph_weight_count;
    out.group_count = static_cast<uint32_t>(groups.size());
    const TableSection sections[] = {section_of(groups, out.offsets.groups),
                                     section_of(table.instances, out.offsets.instances),
                                     section_of(table.meshes, out.offsets.meshes),
                                     section_of(table.rest_points, out.offsets.rest_points),
                                     section_of(table.influences, out.offsets.influences),
                                     section_of(table.morph_offsets, out.offsets.morph_offsets),
                                     section_of(table.morphs, out.offsets.morphs)};
    auto words = record_sections_upload(device, command_buffer, sections, upload.staging);
    if (!words) return words.error();
    out.words = std::move(*words);
    return upload;
}

Result<DeviceSkinTable> upload_skin_table(const Device& device, const SkinTable& table) {
    return upload_and_wait(device,
                           [&](VkCommandBuffer commands) { return record_skin_table_upload(device, commands, table); });
}

struct Skinning::State {
    Recording recording;
};
Skinning::Skinning() : state_(std::make_unique<State>()) {}
Skinning::Skinning(Skinning&&) noexcept = default;
Skinning& Skinning::operator=(Skinning&&) noexcept = default;
Skinning::~Skinning() = default;
void Skinning::record(VkCommandBuffer command_buffer) const {
    state_->recording.record(command_buffer);
}

struct Skinner::State {
    const Device* device = nullptr;
    Kernel kernel;
    bool texel = false;

    /// `words` 32-bit words of a buffer that is read or, where those are none, a few of the table's; `base` is where they
    /// begin in what is bound.
    BoundBuffer read(const DeviceSkinTable& table, WordBuffer from, uint64_t words, VkFormat format, uint32_t& base) const {
        if (words == 0) {
            from = {table.words.handle};
            words = 4;
        }
        const VkPhysicalDeviceLimits& limits = device->properties.limits;
        const uint64_t alignment = std::max<uint64_t>(
            16, texel ? limits.minTexelBufferOffsetAlignment : limits.minStorageBufferOffsetAlignment);
        const uint64_t begin = from.offset_bytes - from.offset_bytes % alignment;
        base = static_cast<uint32_t>((from.offset_bytes - begin) / 4);
        return {from.buffer, begin, from.offset_bytes + 4 * words - begin,
                texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, format};
    }
};
Skinner::Skinner() : state_(std::make_unique<State>()) {}
Skinner::Skinner(Skinner&&) noexcept = default;
Skinner& Skinner::operator=(Skinner&&) noexcept = default;
Skinner::~Skinner() = default;

Result<Skinner> Skinner::create(const Device& device) {
    Skinner skinner;
    State& state = *skinner.state_;
    state.device = &device;
    state.texel = reads_texels(device);
    std::vector<VkDescriptorType> bindings(shared::kSkinBindingCount, state.texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                                                                  : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
    bindings[shared::kSkinPointsBinding] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    const std::span<const uint32_t> spirv = state.texel ? std::span<const uint32_t>(kSkinTexel) : kSkin;
    auto kernel = create_kernel(device, {spirv, bindings, sizeof(SkinParams)});
    if (!kernel) return kernel.error();
    state.kernel = std::move(*kernel);
    return skinner;
}

Result<Skinning> Skinner::prepare(const SkinningInfo& info) const {
    if (auto checked = check(info); !checked) return checked.error();
    const Device& device = *state_->device;
    const DeviceSkinTable& table = *info.table;
    Skinning skinning;
    Recording& recording = skinning.state_->recording;
    recording.device = &device;
    recording.layout = state_->kernel.layout;
    recording.push_constant_bytes = sizeof(SkinParams);
    if (table.group_count == 0) return skinning;

    SkinParams params = {};
    params.table = table.offsets;
    params.group_count = table.group_count;
    uint32_t matrix_word = 0, table_word = 0;
    const uint64_t point_begin = byte_of(info.points, 0, 0);
    const uint64_t bound_begin =
        point_begin - point_begin % std::max<uint64_t>(4, device.properties.limits.minStorageBufferOffsetAlignment);
    const BoundBuffer bound[shared::kSkinBindingCount] = {
        state_->read(table, {table.words.handle}, table.words.size_bytes / 4, VK_FORMAT_R32_UINT, table_word),
        state_->read(table, info.joint_matrices, uint64_t{12} * table.joint_count, VK_FORMAT_R32G32B32A32_SFLOAT,
                     matrix_word),
        state_->read(table, info.morph_weights, table.morph_weight_count, VK_FORMAT_R32_SFLOAT, params.weight_base),
        {info.points.buffer, bound_begin, byte_of(info.points, table.point_count - 1, 3) - bound_begin,
         VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_FORMAT_UNDEFINED}};
    params.matrix_base = matrix_word / 4;
    params.point_base = static_cast<uint32_t>((point_begin - bound_begin) / 4);
    params.point_stride = info.points.stride;
    auto set = recording.add_set(state_->kernel.set_layout, bound);
    if (!set) return set.error();
    auto pipeline = state_->kernel.pipeline({});
    if (!pipeline) return pipeline.error();
    recording.add_dispatch(*pipeline, *set, table.group_count, params);
    return skinning;
}

}  // namespace limn::vk
