// How tables get into device memory. Not part of the public interface.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include "limn/vulkan/surface_tables.h"

namespace limn::vk {

inline VkDeviceSize table_bytes(VkDeviceSize content_bytes) {
    return std::max<VkDeviceSize>(content_bytes, 16);
}
inline MemoryNeed table_memory(VkDeviceSize content_bytes) {
    return {table_bytes(content_bytes), table_bytes(content_bytes), 1};
}

/// A device buffer, and where the host writes its contents: through `staging` where it is not mapped. The copy, with a
/// barrier to kernel reads, is recorded.
inline Result<std::pair<Buffer, void*>> create_table_buffer(const Device& device, VkCommandBuffer command_buffer,
                                                            VkDeviceSize size_bytes, std::vector<Buffer>& staging,
                                                            VkBufferUsageFlags usage = kSourceUsage) {
    size_bytes = table_bytes(size_bytes);
    auto buffer = create_buffer(device, size_bytes, usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::device);
    if (!buffer) return buffer.error();
    void* words = buffer->mapped();
    if (words == nullptr) {
        auto upload = create_buffer(device, size_bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload);
        if (!upload) return upload.error();
        words = upload->mapped();
        const VkBufferCopy region = {0, 0, size_bytes};
        device.functions.CmdCopyBuffer(command_buffer, upload->handle, buffer->handle, 1, &region);
        record_barrier(device, command_buffer, kCopyWrites, kKernelReads);
        staging.push_back(std::move(*upload));
    }
    return std::pair(std::move(*buffer), words);
}

/// An array of a table, and the word that it will begin at.
struct TableSection {
    const void* data;
    size_t bytes;
    uint32_t* offset;
};
template <class Array>
TableSection section_of(const Array& array, uint32_t& offset) {
    return {array.data(), array.bytes(), &offset};
}

/// Sets offsets, each to a multiple of four words. Returns how many words there are. Errors: too_large.
inline Result<uint64_t> place_sections(std::span<const TableSection> sections) {
    uint64_t words = 0;
    for (const TableSection& s : sections) {
        *s.offset = static_cast<uint32_t>(words);
        words += (s.bytes + 15) / 16 * 4;
    }
    if (words > 0xffffffffu) return Error{ErrorCode::too_large, "a table of 2^32 words or more"};
    return words;
}
inline Result<MemoryNeed> sections_memory(std::span<const TableSection> sections) {
    const auto words = place_sections(sections);
    if (!words) return words.error();
    return table_memory(*words * 4);
}

/// One buffer for all sections. Errors: too_large, and as create_buffer.
inline Result<Buffer> record_sections_upload(const Device& device, VkCommandBuffer command_buffer,
                                             std::span<const TableSection> sections, std::vector<Buffer>& staging) {
    const auto words = place_sections(sections);
    if (!words) return words.error();
    auto buffer = create_table_buffer(device, command_buffer, *words * 4, staging);
    if (!buffer) return buffer.error();
    for (const TableSection& s : sections)
        if (s.bytes != 0) std::memcpy(static_cast<uint32_t*>(buffer->second) + *s.offset, s.data, s.bytes);
    return std::move(buffer->first);
}

inline void add_tree_sections(const PatchTreeTable& trees, shared::TreeOffsets& offsets,
                              std::vector<TableSection>& sections) {
    sections.push_back(section_of(trees.ptex_surfaces, offsets.ptex_surfaces));
    sections.push_back(section_of(trees.surfaces, offsets.surfaces));
    sections.push_back(section_of(trees.nodes, offsets.nodes));
    sections.push_back(section_of(trees.leaf_points, offsets.leaf_points));
}

std::array<TableSection, 7> patch_sections(const PatchTable& table, shared::PatchTableOffsets& offsets);

/// A grid's words, tiles of each pass: those that one dispatch can take follow each other.
struct GridWords {
    std::vector<uint32_t> words;
    std::vector<GridBatch> batches;
};
GridWords lay_out(const GridTable& table, bool cpu_device);

/// All that does not depend on how words are laid out.
void describe(const PatchTable& table, DevicePatchTable& out);
void describe(const GridTable& table, DeviceGridTable& out);

/// What makes local points; the trees' words are left to the caller.
inline Result<DevicePatchTrees> record_local_points_upload(const Device& device, VkCommandBuffer command_buffer,
                                                           const PatchTreeTable& trees, std::vector<Buffer>& staging) {
    DevicePatchTrees out;
    out.local_count = trees.local_count();
    auto grid = record_grid_table_upload(device, command_buffer, trees.local_points);
    if (!grid) return grid.error();
    out.local_points = std::move(grid->table);
    for (Buffer& buffer : grid->staging) staging.push_back(std::move(buffer));
    return out;
}

/// Records, submits where there is something to copy, and waits.
template <class Record>
auto upload_and_wait(const Device& device, const Record& record) -> Result<decltype(record(VkCommandBuffer{})->table)> {
    auto commands = Commands::begin(device);
    if (!commands) return commands.error();
    auto upload = record(commands->handle());
    if (!upload) return upload.error();
    const bool copies = std::any_of(upload->staging.begin(), upload->staging.end(),
                                    [](const Buffer& b) { return b.handle != VK_NULL_HANDLE; });
    if (copies)
        if (auto submitted = commands->submit_and_wait(); !submitted) return submitted.error();
    return std::move(upload->table);
}

}  // namespace limn::vk
