// Buffers, barriers, and the copies between host and device that programs and tests need.
#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "limn/vulkan/context.h"
#include "limn/vulkan/synchronization.h"

namespace limn::vk {

/// What buffers of points that limn reads (sources) must have been created with, at least. Buffers it only
/// writes need VK_BUFFER_USAGE_STORAGE_BUFFER_BIT alone.
inline constexpr VkBufferUsageFlags kSourceUsage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
/// kSourceUsage and copies in both directions.
inline constexpr VkBufferUsageFlags kPointUsage =
    kSourceUsage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

/// A buffer and its memory, freed on destruction: the device must be done with it by then.
struct Buffer {
    VkBuffer handle = VK_NULL_HANDLE;
    MemoryBlock memory;
    VkDeviceSize size_bytes = 0;
    const Device* device = nullptr;

    Buffer() = default;
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer();
    void* mapped() const { return memory.mapped; }
};

/// What buffers take, known before any is made. An allocator is asked for each by itself, and for as much as the device
/// rounds its size up to: count on buffer_count times its alignment more.
struct MemoryNeed {
    uint64_t device_bytes = 0;   ///< of MemoryUse::device, for as long as the object lives
    uint64_t staging_bytes = 0;  ///< of MemoryUse::upload until the upload is done; none where device memory is mapped
    uint32_t buffer_count = 0;   ///< of the device; staging has as many

    MemoryNeed& operator+=(const MemoryNeed& other) {
        device_bytes += other.device_bytes;
        staging_bytes += other.staging_bytes;
        buffer_count += other.buffer_count;
        return *this;
    }
};

/// Errors: out_of_memory, vulkan_failure. A size of 0 gives a buffer of 4 bytes.
Result<Buffer> create_buffer(const Device& device, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
                             MemoryUse use);

/// One global memory barrier from `before` to `after`.
void record_barrier(const Device& device, VkCommandBuffer command_buffer, StageAccess before,
                    StageAccess after);

/// A command buffer for one submission that is waited for: for programs and tests, not for frames.
class Commands {
  public:
    /// Begins recording. Errors: invalid_argument (the device has no queue), vulkan_failure.
    static Result<Commands> begin(const Device& device);
    Commands(Commands&& other) noexcept;
    Commands& operator=(Commands&&) = delete;
    ~Commands();
    VkCommandBuffer handle() const { return command_buffer_; }
    operator VkCommandBuffer() const { return command_buffer_; }
    /// Ends recording, submits, waits. May be called again: the commands then run again.
    Result<void> submit_and_wait();

  private:
    Commands() = default;
    const Device* device_ = nullptr;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer command_buffer_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    bool recording_ = true;
};

/// Copies host bytes into buffer[offset_bytes ..] and waits; the buffer has TRANSFER_DST usage. The device
/// must not be using that range. Submits unless the buffer is mapped.
Result<void> upload_bytes(const Device& device, const Buffer& buffer, VkDeviceSize offset_bytes,
                          std::span<const std::byte> bytes);
/// The reverse; the buffer has TRANSFER_SRC usage. Device writes must have completed (their fence waited
/// for), or have been submitted to Device::queue before; a barrier is not needed.
Result<void> download_bytes(const Device& device, const Buffer& buffer, VkDeviceSize offset_bytes,
                            std::span<std::byte> bytes);

/// A device buffer with kPointUsage that holds `values`.
Result<Buffer> create_point_buffer(const Device& device, std::span<const float> values);

/// `count` values from buffer[offset_bytes ..].
template <class T>
Result<std::vector<T>> download(const Device& device, const Buffer& buffer, size_t count,
                                VkDeviceSize offset_bytes = 0) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(count);
    if (auto copied = download_bytes(device, buffer, offset_bytes, std::as_writable_bytes(std::span(values)));
        !copied)
        return copied.error();
    return values;
}

}  // namespace limn::vk
