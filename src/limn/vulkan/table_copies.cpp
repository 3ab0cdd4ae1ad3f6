#include "limn/vulkan/table_copies.h"

#include <algorithm>
#include <cstring>

namespace limn::vk {

void TableCopies::add_differences(uint32_t target, VkDeviceSize offset_bytes,
                                  std::span<const std::byte> before, std::span<const std::byte> after) {
    if (is_new(target)) return add(target, offset_bytes, after);
    // Blocks that differ; what lies between two of them is copied along where it is short.
    constexpr size_t kBlock = 64, kGap = 256;
    const size_t common = std::min(before.size(), after.size());
    size_t begin = 0, end = 0;  // of what is not added yet
    const auto extend = [&](size_t from, size_t to) {
        if (end == begin || from > end + kGap) {
            add(target, offset_bytes + begin, after.subspan(begin, end - begin));
            begin = from;
        }
        end = to;
    };
    for (size_t at = 0; at < common; at += kBlock) {
        const size_t size = std::min(kBlock, common - at);
        if (std::memcmp(before.data() + at, after.data() + at, size) != 0) extend(at, at + size);
    }
    if (after.size() > common) extend(common, after.size());
    add(target, offset_bytes + begin, after.subspan(begin, end - begin));
}

/// Nobody reads a new buffer yet, so that the host may write it where it can. One that frames in flight read
/// must not change but in the order of commands.
bool TableCopies::is_staged(const Device& device, const Piece& piece) const {
    return !is_new(piece.target) || !device.has_host_memory();
}

MemoryNeed TableCopies::memory(const Device& device) const {
    MemoryNeed need;
    for (const VkDeviceSize bytes : new_bytes_)
        if (bytes != 0) need += {bytes, 0, 1};
    for (const Piece& piece : pieces_)
        if (is_staged(device, piece)) need.staging_bytes += piece.bytes.size();
    return need;
}

Result<void> TableCopies::record(const Device& device, VkCommandBuffer command_buffer,
                                 std::span<Buffer* const> targets, TableUpdate& update) {
    std::vector<Buffer> made(targets.size());
    for (size_t t = 0; t < targets.size(); ++t) {
        if (new_bytes_[t] == 0) continue;
        auto buffer = create_buffer(device, new_bytes_[t], kPointUsage, MemoryUse::device);
        if (!buffer) return buffer.error();
        made[t] = std::move(*buffer);
    }
    const auto is_written_by_host = [&](const Piece& piece) {
        return made[piece.target].mapped() != nullptr;
    };
    VkDeviceSize staged = 0;
    for (const Piece& piece : pieces_) staged += is_written_by_host(piece) ? 0 : piece.bytes.size();
    Buffer staging;
    if (staged != 0) {
        auto created = create_buffer(device, staged, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload);
        if (!created) return created.error();
        staging = std::move(*created);
    }
    std::vector<std::vector<VkBufferCopy>> regions(targets.size());
    VkDeviceSize at = 0;
    for (const Piece& piece : pieces_) {
        const size_t size = piece.bytes.size();
        update.copied_bytes += size;
        if (is_written_by_host(piece)) {
            std::memcpy(static_cast<std::byte*>(made[piece.target].mapped()) + piece.offset_bytes,
                        piece.bytes.data(), size);
            continue;
        }
        std::memcpy(static_cast<std::byte*>(staging.mapped()) + at, piece.bytes.data(), size);
        regions[piece.target].push_back({at, piece.offset_bytes, size});
        at += size;
    }
    if (staged != 0) record_barrier(device, command_buffer, kKernelReads, kCopyWrites);
    for (size_t t = 0; t < targets.size(); ++t) {
        if (new_bytes_[t] != 0) {
            std::swap(*targets[t], made[t]);
            if (made[t].handle != VK_NULL_HANDLE) update.replaced.push_back(std::move(made[t]));
        }
        if (!regions[t].empty())
            device.functions.CmdCopyBuffer(command_buffer, staging.handle, targets[t]->handle,
                                           static_cast<uint32_t>(regions[t].size()), regions[t].data());
    }
    if (staged != 0) {
        record_barrier(device, command_buffer, kCopyWrites, kKernelReads);
        update.staging.push_back(std::move(staging));
    }
    return {};
}

}  // namespace limn::vk
