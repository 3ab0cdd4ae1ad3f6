#include "limn/vulkan/buffer.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

namespace limn::vk {
namespace {

/// The first memory type among `type_bits` that has all of `flags`.
std::optional<uint32_t> find_memory_type(const Device& device, uint32_t type_bits,
                                         VkMemoryPropertyFlags flags) {
    for (uint32_t i = 0; i < device.memory_properties.memoryTypeCount; ++i)
        if ((type_bits >> i & 1) != 0 &&
            (device.memory_properties.memoryTypes[i].propertyFlags & flags) == flags)
            return i;
    return std::nullopt;
}

std::optional<uint32_t> choose_memory_type(const Device& device, uint32_t type_bits, MemoryUse use) {
    constexpr VkMemoryPropertyFlags kHost =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if (use == MemoryUse::device) {
        if (device.has_host_memory())
            if (auto type = find_memory_type(device, type_bits, kHost | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT))
                return type;
        if (auto type = find_memory_type(device, type_bits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)) return type;
        return find_memory_type(device, type_bits, 0);
    }
    if (use == MemoryUse::readback)
        if (auto type = find_memory_type(device, type_bits, kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT))
            return type;
    return find_memory_type(device, type_bits, kHost);
}

VkResult allocate_by_default(const Device& device, const VkMemoryRequirements& requirements, MemoryUse use,
                             MemoryBlock* block) {
    const auto type = choose_memory_type(device, requirements.memoryTypeBits, use);
    if (!type) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    VkMemoryAllocateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    info.allocationSize = requirements.size;
    info.memoryTypeIndex = *type;
    VkResult result = device.functions.AllocateMemory(device.handle, &info, device.host_allocator, &block->memory);
    if (result != VK_SUCCESS) return result;
    constexpr VkMemoryPropertyFlags kHost =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const bool host = (device.memory_properties.memoryTypes[*type].propertyFlags & kHost) == kHost;
    if (use != MemoryUse::device || (host && device.has_host_memory()))
        result =
            device.functions.MapMemory(device.handle, block->memory, 0, VK_WHOLE_SIZE, 0, &block->mapped);
    if (result != VK_SUCCESS) device.functions.FreeMemory(device.handle, block->memory, device.host_allocator);
    return result;
}

}  // namespace

Buffer::Buffer(Buffer&& other) noexcept
    : handle(std::exchange(other.handle, VkBuffer{VK_NULL_HANDLE})),
      memory(std::exchange(other.memory, MemoryBlock{})),
      size_bytes(std::exchange(other.size_bytes, 0)),
      device(other.device) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(handle, other.handle);
    std::swap(memory, other.memory);
    std::swap(size_bytes, other.size_bytes);
    std::swap(device, other.device);
    return *this;
}

Buffer::~Buffer() {
    if (device == nullptr) return;
    if (handle != VK_NULL_HANDLE) device->functions.DestroyBuffer(device->handle, handle, device->host_allocator);
    if (memory.memory == VK_NULL_HANDLE) return;
    if (device->allocator.free != nullptr)
        device->allocator.free(device->allocator.user, memory);
    else
        device->functions.FreeMemory(device->handle, memory.memory, device->host_allocator);
}

Result<Buffer> create_buffer(const Device& device, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
                             MemoryUse use) {
    Buffer buffer;
    buffer.device = &device;
    buffer.size_bytes = std::max<VkDeviceSize>(size_bytes, 4);
    VkBufferCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = buffer.size_bytes;
    info.usage = usage;
    const Functions& functions = device.functions;
    VkResult result = functions.CreateBuffer(device.handle, &info, device.host_allocator, &buffer.handle);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateBuffer", result);
    VkMemoryRequirements requirements;
    functions.GetBufferMemoryRequirements(device.handle, buffer.handle, &requirements);
    MemoryBlock block;
    result = device.allocator.allocate != nullptr
                 ? device.allocator.allocate(device.allocator.user, requirements, use, &block)
                 : allocate_by_default(device, requirements, use, &block);
    if (result != VK_SUCCESS)
        return Error{ErrorCode::out_of_memory,
                     "no device memory for a buffer of " + std::to_string(buffer.size_bytes) + " bytes",
                     kNoElement, result};
    buffer.memory = block;
    assert(use == MemoryUse::device || block.mapped != nullptr);
    result = functions.BindBufferMemory(device.handle, buffer.handle, block.memory, block.offset);
    if (result != VK_SUCCESS) return vulkan_error("vkBindBufferMemory", result);
    return buffer;
}

void record_barrier(const Device& device, VkCommandBuffer command_buffer, StageAccess before,
                    StageAccess after) {
    VkMemoryBarrier barrier = {};
    barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
    barrier.srcAccessMask = before.access;
    barrier.dstAccessMask = after.access;
    device.functions.CmdPipelineBarrier(command_buffer, before.stages, after.stages, 0, 1, &barrier, 0,
                                        nullptr, 0, nullptr);
}

Result<Commands> Commands::begin(const Device& device) {
    if (device.queue == VK_NULL_HANDLE)
        return Error{ErrorCode::invalid_argument, "the device was borrowed without a queue to submit to"};
    Commands commands;
    commands.device_ = &device;
    const Functions& functions = device.functions;
    VkCommandPoolCreateInfo pool = {};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.queueFamilyIndex = device.queue_family_index;
    VkResult result = functions.CreateCommandPool(device.handle, &pool, device.host_allocator, &commands.pool_);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateCommandPool", result);
    VkCommandBufferAllocateInfo allocate = {};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = commands.pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    result = functions.AllocateCommandBuffers(device.handle, &allocate, &commands.command_buffer_);
    if (result != VK_SUCCESS) return vulkan_error("vkAllocateCommandBuffers", result);
    VkFenceCreateInfo fence = {};
    fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    result = functions.CreateFence(device.handle, &fence, device.host_allocator, &commands.fence_);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateFence", result);
    VkCommandBufferBeginInfo begin = {};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    result = functions.BeginCommandBuffer(commands.command_buffer_, &begin);
    if (result != VK_SUCCESS) return vulkan_error("vkBeginCommandBuffer", result);
    return commands;
}

Commands::Commands(Commands&& other) noexcept
    : device_(other.device_),
      pool_(std::exchange(other.pool_, VkCommandPool{VK_NULL_HANDLE})),
      command_buffer_(other.command_buffer_),
      fence_(std::exchange(other.fence_, VkFence{VK_NULL_HANDLE})),
      recording_(other.recording_) {}

Commands::~Commands() {
    if (fence_ != VK_NULL_HANDLE) device_->functions.DestroyFence(device_->handle, fence_, device_->host_allocator);
    if (pool_ != VK_NULL_HANDLE) device_->functions.DestroyCommandPool(device_->handle, pool_, device_->host_allocator);
}

Result<void> Commands::submit_and_wait() {
    const Functions& functions = device_->functions;
    VkResult result = recording_ ? functions.EndCommandBuffer(command_buffer_)
                                 : functions.ResetFences(device_->handle, 1, &fence_);
    if (result != VK_SUCCESS)
        return vulkan_error(recording_ ? "vkEndCommandBuffer" : "vkResetFences", result);
    recording_ = false;
    VkSubmitInfo submit = {};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &command_buffer_;
    result = functions.QueueSubmit(device_->queue, 1, &submit, fence_);
    if (result != VK_SUCCESS) return vulkan_error("vkQueueSubmit", result);
    result = functions.WaitForFences(device_->handle, 1, &fence_, VK_TRUE, ~uint64_t{0});
    if (result != VK_SUCCESS) return vulkan_error("vkWaitForFences", result);
    return {};
}

namespace {

constexpr StageAccess kAnyWrites = {VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_WRITE_BIT};
constexpr StageAccess kAnyUse = {VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                                 VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};

Result<void> copy_and_wait(const Device& device, VkBuffer from, VkBuffer to, const VkBufferCopy& region) {
    auto commands = Commands::begin(device);
    if (!commands) return commands.error();
    record_barrier(device, *commands, kAnyWrites, kCopyReads);
    device.functions.CmdCopyBuffer(*commands, from, to, 1, &region);
    record_barrier(device, *commands, kCopyWrites, kAnyUse);
    record_barrier(device, *commands, kCopyWrites, kHostReads);
    return commands->submit_and_wait();
}

/// Makes earlier device writes visible to the host.
Result<void> wait_for_writes(const Device& device) {
    auto commands = Commands::begin(device);
    if (!commands) return commands.error();
    record_barrier(device, *commands, kAnyWrites, kHostReads);
    return commands->submit_and_wait();
}

}  // namespace

Result<void> upload_bytes(const Device& device, const Buffer& buffer, VkDeviceSize offset_bytes,
                          std::span<const std::byte> bytes) {
    assert(offset_bytes + bytes.size() <= buffer.size_bytes);
    if (bytes.empty()) return {};
    if (buffer.mapped() != nullptr) {
        std::memcpy(static_cast<std::byte*>(buffer.mapped()) + offset_bytes, bytes.data(), bytes.size());
        return {};
    }
    auto staging = create_buffer(device, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload);
    if (!staging) return staging.error();
    std::memcpy(staging->mapped(), bytes.data(), bytes.size());
    return copy_and_wait(device, staging->handle, buffer.handle, {0, offset_bytes, bytes.size()});
}

Result<void> download_bytes(const Device& device, const Buffer& buffer, VkDeviceSize offset_bytes,
                            std::span<std::byte> bytes) {
    assert(offset_bytes + bytes.size() <= buffer.size_bytes);
    if (bytes.empty()) return {};
    if (buffer.mapped() != nullptr) {
        if (auto waited = wait_for_writes(device); !waited) return waited;
        std::memcpy(bytes.data(), static_cast<const std::byte*>(buffer.mapped()) + offset_bytes,
                    bytes.size());
        return {};
    }
    auto staging = create_buffer(device, bytes.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback);
    if (!staging) return staging.error();
    const VkBufferCopy region = {offset_bytes, 0, bytes.size()};
    if (auto copied = copy_and_wait(device, buffer.handle, staging->handle, region); !copied) return copied;
    std::memcpy(bytes.data(), staging->mapped(), bytes.size());
    return {};
}

Result<Buffer> create_point_buffer(const Device& device, std::span<const float> values) {
    auto buffer = create_buffer(device, values.size_bytes(), kPointUsage, MemoryUse::device);
    if (!buffer) return buffer;
    if (auto copied = upload_bytes(device, *buffer, 0, std::as_bytes(values)); !copied) return copied.error();
    return buffer;
}

}  // namespace limn::vk
