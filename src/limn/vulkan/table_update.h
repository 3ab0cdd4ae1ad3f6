// Tables on the device that follow those on the host: only what differs is copied, in your command buffer.
#pragma once

#include "limn/vulkan/tessellation_tables.h"

namespace limn::vk {

/// A recorded update of tables, which stay where they are.
///
/// Barriers. The commands begin with one from kKernelReads to kCopyWrites, so that what was submitted to the
/// same queue before reads the old state, and end with one from kCopyWrites to kKernelReads. Owed by the
/// caller: the first where other stages read tables (hardware tessellation: its stages), and after those
/// again; a semaphore where frames on another queue do.
struct TableUpdate {
    std::vector<Buffer> staging;   ///< read by the commands: keep it until they have completed
    std::vector<Buffer> replaced;  ///< that were too small: retire them in the last frame that was recorded
                                   ///< before (retirement.h)
    VkDeviceSize copied_bytes = 0;
    /// Evaluations and tessellations of these tables are to be prepared again before they are recorded again:
    /// buffers, or what is dispatched, are others. Else they stay as they are; but record them anew, since
    /// how much is dispatched may differ.
    bool prepare_again = false;
};

/// A tessellation's tables on the host.
struct TessellationTables {
    const TessellationTable* topology = nullptr;
    const PatchTreeTable* vertices = nullptr;
    std::span<const PatchTreeTable* const> channels = {};
};

/// Bring `table`, which holds `before` (or is an empty one, and so is `before`), to `after`: words of both
/// are compared, and those copied that differ. What has been edited in place, or has grown at its end, is
/// little. A buffer that is too small gives way to one with room for `reserve` times as much more of every
/// array; an update of an empty table is an upload with room to spare. Results are those of a fresh upload.
/// Comparing takes about as long as laying words out for an upload does. Errors: invalid_argument (of
/// tessellations: tables of different meshes, other channels than before), too_large, out_of_memory,
/// vulkan_failure; the table is then as it was.
Result<TableUpdate> record_patch_table_update(const Device& device, VkCommandBuffer command_buffer,
                                              DevicePatchTable& table, const PatchTable& before,
                                              const PatchTable& after, float reserve = 0.25f);
Result<TableUpdate> record_grid_table_update(const Device& device, VkCommandBuffer command_buffer,
                                             DeviceGridTable& table, const GridTable& before,
                                             const GridTable& after, float reserve = 0.25f);
Result<TableUpdate> record_tessellation_table_update(const Device& device, VkCommandBuffer command_buffer,
                                                     DeviceTessellationTable& table,
                                                     const TessellationTables& before,
                                                     const TessellationTables& after, float reserve = 0.25f);

/// What they take: of new buffers device memory, and staging. Errors: as those.
Result<MemoryNeed> update_memory(const Device& device, const DevicePatchTable& table,
                                 const PatchTable& before, const PatchTable& after, float reserve = 0.25f);
Result<MemoryNeed> update_memory(const Device& device, const DeviceGridTable& table, const GridTable& before,
                                 const GridTable& after, float reserve = 0.25f);
Result<MemoryNeed> update_memory(const Device& device, const DeviceTessellationTable& table,
                                 const TessellationTables& before, const TessellationTables& after,
                                 float reserve = 0.25f);

}  // namespace limn::vk
