// Patch and grid tables in device memory: uploaded once per topology, read by every evaluation.
#pragma once

#include "limn/grid_table.h"
#include "limn/patch_table.h"
#include "limn/patch_tree.h"
#include "limn/refined_grid.h"
#include "limn/shared/patch_eval_params.h"
#include "limn/vulkan/device_tables.h"

namespace limn::vk {

/// A patch table as kernels read it: limn/shared/patch_eval_params.h. Immutable once uploaded, but for updates
/// (table_update.h); outlives the evaluations that use it.
struct DevicePatchTable {
    Scheme scheme = Scheme::catmull_clark;
    EndCap end_cap = EndCap::exact;
    uint32_t control_count = 0;
    uint32_t first_refined = 0;  ///< the first of the level-1 points
    uint32_t point_count = 0;    ///< up to the last of them
    uint32_t ptex_count = 0;
    bool narrow_rings = false;
    uint32_t max_ring_size = 0;
    shared::PatchTableOffsets offsets = {};
    Buffer words;
    DeviceStencilTable points;  ///< makes the level-1 points; no rows where there are none

    /// Device memory.
    VkDeviceSize bytes() const { return words.size_bytes + points.bytes(); }
};

/// The classes of one dispatch of a grid: those with equal group and sample counts and corners. With by_rows all that are
/// regular patches or, with a sample_count, whose samples are their rings' points, and tiles are records of single surfaces.
struct GridBatch {
    uint32_t group_count;  ///< as GridClass
    uint32_t sample_count;
    uint32_t corners;
    uint32_t pass;
    uint32_t tile_surfaces;  ///< that a tile has room for
    uint32_t tile_base;      ///< words
    uint32_t tile_count;
    bool by_rows = false;

    bool operator==(const GridBatch&) const = default;
};

/// A grid table as kernels read it: limn/shared/grid_eval_params.h. It samples one DevicePatchTable.
struct DeviceGridTable {
    uint32_t rate = 0;
    uint32_t value_count = 0;
    uint32_t ptex_count = 0;
    uint32_t samples_per_face = 0;
    uint32_t faces_per_pass = 0;
    bool relative = false;
    bool changes = false;  ///< tile_count of batches does, as in crowds: evaluations look when they are recorded
    std::vector<GridBatch> batches;
    uint64_t total_sample_count = 0;
    Buffer words;
    Buffer weights;

    uint64_t sample_count() const { return total_sample_count; }
    VkDeviceSize bytes() const { return words.size_bytes + weights.size_bytes; }
};

/// A refined grid as kernels read it.
struct DeviceRefinedGrid {
    uint32_t source_count = 0;
    DeviceGridTable grid;
    Buffer rings;

    uint32_t point_count() const { return static_cast<uint32_t>(grid.sample_count()); }
    VkDeviceSize bytes() const { return grid.bytes() + rings.size_bytes; }
};

/// A patch tree table: where its words are, and what makes its local points.
struct DevicePatchTrees {
    shared::TreeOffsets offsets = {};
    uint32_t local_count = 0;
    DeviceGridTable local_points;
    Buffer words;  ///< none in a tessellation table, whose own words hold them

    VkDeviceSize bytes() const { return words.size_bytes + local_points.bytes(); }
};

/// A table whose upload has been recorded, and the staging memory it is read from: keep that until the
/// commands have completed (it is empty where the device shares memory with the host).
struct PatchTableUpload {
    DevicePatchTable table;
    std::vector<Buffer> staging;
};
struct GridTableUpload {
    DeviceGridTable table;
    std::vector<Buffer> staging;
};
struct PatchTreesUpload {
    DevicePatchTrees table;
    std::vector<Buffer> staging;
};

struct RefinedGridUpload {
    DeviceRefinedGrid table;
    std::vector<Buffer> staging;
};

/// Record the upload into the caller's command buffer, barrier to kernel reads included.
/// Errors: out_of_memory, too_large (2^32 words), vulkan_failure.
Result<PatchTableUpload> record_patch_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                   const PatchTable& table);
Result<GridTableUpload> record_grid_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                 const GridTable& table);
Result<RefinedGridUpload> record_refined_grid_upload(const Device& device, VkCommandBuffer command_buffer,
                                                     const RefinedGridTable& table);
Result<PatchTreesUpload> record_patch_trees_upload(const Device& device, VkCommandBuffer command_buffer,
                                                   const PatchTreeTable& table);

/// What an upload takes: all that it makes, byte for byte. Tables are laid out for that, which takes part of the time of
/// an upload. Errors: too_large.
Result<MemoryNeed> upload_memory(const PatchTable& table);
Result<MemoryNeed> upload_memory(const Device& device, const GridTable& table);
Result<MemoryNeed> upload_memory(const Device& device, const RefinedGridTable& table);
Result<MemoryNeed> upload_memory(const Device& device, const PatchTreeTable& table);

/// The same, submitted to Device::queue and waited for.
Result<DevicePatchTable> upload_patch_table(const Device& device, const PatchTable& table);
Result<DeviceGridTable> upload_grid_table(const Device& device, const GridTable& table);
Result<DeviceRefinedGrid> upload_refined_grid_table(const Device& device, const RefinedGridTable& table);
Result<DevicePatchTrees> upload_patch_trees(const Device& device, const PatchTreeTable& table);

}  // namespace limn::vk
