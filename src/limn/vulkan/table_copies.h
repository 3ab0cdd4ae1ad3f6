// What has to be copied for a table to be up to date, and the buffers that are too small for it. Not part of
// the public interface.
#pragma once

#include <algorithm>
#include <cstddef>

#include "limn/batch.h"
#include "limn/vulkan/table_update.h"

namespace limn::vk {

/// First planned, which is all that it takes to say how much memory is needed; then recorded, with which the
/// old buffers of the targets go. Whatever is pointed to outlives the plan.
class TableCopies {
  public:
    /// A buffer by the number that it gets: one of new_bytes that takes the place of the one there is, or,
    /// with 0, that one.
    uint32_t add_target(VkDeviceSize new_bytes) {
        new_bytes_.push_back(new_bytes == 0 ? 0 : std::max<VkDeviceSize>(new_bytes, 16));
        return static_cast<uint32_t>(new_bytes_.size() - 1);
    }
    bool is_new(uint32_t target) const { return new_bytes_[target] != 0; }
    bool replaces_any() const {
        return std::any_of(new_bytes_.begin(), new_bytes_.end(),
                           [](VkDeviceSize bytes) { return bytes != 0; });
    }
    void add(uint32_t target, VkDeviceSize offset_bytes, std::span<const std::byte> bytes) {
        if (!bytes.empty()) pieces_.push_back({target, offset_bytes, bytes});
    }
    /// Of a target that holds `before` what differs from that in `after`; of a new one all of `after`.
    void add_differences(uint32_t target, VkDeviceSize offset_bytes, std::span<const std::byte> before,
                         std::span<const std::byte> after);

    MemoryNeed memory(const Device& device) const;
    /// `targets`: the buffers, in the order of their numbers. Errors: out_of_memory, vulkan_failure; all is
    /// then as it was.
    Result<void> record(const Device& device, VkCommandBuffer command_buffer,
                        std::span<Buffer* const> targets, TableUpdate& update);

  private:
    struct Piece {
        uint32_t target;
        VkDeviceSize offset_bytes;
        std::span<const std::byte> bytes;
    };
    bool is_staged(const Device& device, const Piece& piece) const;

    std::vector<VkDeviceSize> new_bytes_;
    std::vector<Piece> pieces_;
};

}  // namespace limn::vk
