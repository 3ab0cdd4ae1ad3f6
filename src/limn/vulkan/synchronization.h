// What limn's commands do to memory, and the barriers that are owed around them: for the caller's VkDependencyInfo, or for
// record_barrier (buffer.h). Flags of Vulkan 1.2 have the same values in synchronization2, so there is one set of them.
//
// Frames in flight. Tables, evaluators and tessellators are immutable: all frames, threads and queues share one of each.
// What a frame writes is its own: for each frame in flight a buffer of points, outputs, and with them a StencilEvaluation
// (prepare_points) and a Tessellation or SurfaceEvaluation that bind these; a Tessellation also has memory of its own that
// its commands write. These are prepared once, recorded every frame, and need no barrier between frames. A frame begins
// when the fence or semaphore of the one before it with the same objects has been waited for.
//
// A queue for compute. Submit evaluation there, signal a semaphore, wait for it on the graphics queue. Where families
// differ, buffers go over with release_barrier and acquire_barrier: points where the graphics queue writes them, and
// vertices, indices and the command on their way back, if the next frame needs what is in them. Buffers that the next
// frame writes anew need no transfer back. limn's own memory is used on one queue family only: upload tables there.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

namespace limn::vk {

/// Pipeline stages and memory accesses in them; a VkPipelineStageFlags2 and a VkAccessFlags2 just as well.
struct StageAccess {
    VkPipelineStageFlags stages = 0;
    VkAccessFlags access = 0;
};
constexpr StageAccess operator|(StageAccess a, StageAccess b) {
    return {a.stages | b.stages, a.access | b.access};
}

/// Whatever evaluations and tessellations read of the caller's: points, samples, edge rates, heights, textures.
inline constexpr StageAccess kKernelReads = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT};
/// Whatever they write.
inline constexpr StageAccess kKernelWrites = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT};
/// The caller's uses: the command of a tessellation, its indices, its vertices as attributes; all three are kDrawReads.
inline constexpr StageAccess kIndirectReads = {VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT, VK_ACCESS_INDIRECT_COMMAND_READ_BIT};
inline constexpr StageAccess kIndexReads = {VK_PIPELINE_STAGE_VERTEX_INPUT_BIT, VK_ACCESS_INDEX_READ_BIT};
inline constexpr StageAccess kVertexReads = {VK_PIPELINE_STAGE_VERTEX_INPUT_BIT, VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT};
inline constexpr StageAccess kDrawReads = kIndirectReads | kIndexReads | kVertexReads;
/// Copies. record_*_upload copies from staging memory, and ends with a barrier from kCopyWrites to kKernelReads.
inline constexpr StageAccess kCopyReads = {VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT};
inline constexpr StageAccess kCopyWrites = {VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT};
inline constexpr StageAccess kHostReads = {VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT};
inline constexpr StageAccess kHostWrites = {VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_WRITE_BIT};

static_assert(VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT == VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT);
static_assert(VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT == VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT);
static_assert(VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT == VK_PIPELINE_STAGE_VERTEX_INPUT_BIT);
static_assert(VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT == VK_PIPELINE_STAGE_TRANSFER_BIT);
static_assert(VK_ACCESS_2_SHADER_WRITE_BIT == VK_ACCESS_SHADER_WRITE_BIT);

/// Commands that do `before` come before those that do `after`, and what was written is visible to them.
constexpr VkMemoryBarrier2 memory_barrier(StageAccess before, StageAccess after) {
    return {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr,      before.stages,
            before.access,                      after.stages, after.access};
}

/// From one queue family to another: a buffer of VK_SHARING_MODE_EXCLUSIVE keeps its contents only where the first
/// releases and the second acquires it, with a semaphore between the two submissions.
struct QueueTransfer {
    uint32_t from_family = 0;
    uint32_t to_family = 0;
};

/// Recorded on the first queue, behind what was done `before`.
constexpr VkBufferMemoryBarrier2 release_barrier(VkBuffer buffer, QueueTransfer transfer, StageAccess before) {
    return {VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2, nullptr, before.stages, before.access, 0, 0,
            transfer.from_family, transfer.to_family, buffer, 0, VK_WHOLE_SIZE};
}
/// Recorded on the second queue, ahead of what is done `after`. The wait for the semaphore has those stages, too.
constexpr VkBufferMemoryBarrier2 acquire_barrier(VkBuffer buffer, QueueTransfer transfer, StageAccess after) {
    return {VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2, nullptr, after.stages, 0, after.stages, after.access,
            transfer.from_family, transfer.to_family, buffer, 0, VK_WHOLE_SIZE};
}

}  // namespace limn::vk
