// What the tessellator reads, in device memory: uploaded once per topology.
#pragma once

#include <span>

#include "limn/shared/tess_params.h"
#include "limn/tessellation_table.h"
#include "limn/vulkan/surface_tables.h"

namespace limn::vk {

/// Tessellation table and patch trees as kernels read them: limn/shared/tess_params.h. Immutable once uploaded, but for
/// updates (table_update.h); outlives the tessellations that use it.
struct DeviceTessellationTable {
    Scheme scheme = Scheme::catmull_clark;
    uint32_t face_count = 0;
    uint32_t row_count = 0;
    uint32_t corner_count = 0;
    uint32_t rate_edge_count = 0;
    uint32_t corner_copy_count = 0;
    uint32_t row_copy_count = 0;
    uint32_t instance_count = 1;
    uint32_t max_rate = 0;  ///< the least of the patch trees'
    shared::TessOffsets offsets = {};
    uint32_t instances_offset = 0;  ///< in words: list_instances
    DevicePatchTrees vertices;
    std::vector<DevicePatchTrees> channels;
    Buffer words;

    VkDeviceSize bytes() const {
        VkDeviceSize sum = words.size_bytes + vertices.bytes();
        for (const DevicePatchTrees& channel : channels) sum += channel.bytes();
        return sum;
    }
};

struct TessellationTableUpload {
    DeviceTessellationTable table;
    std::vector<Buffer> staging;
};

/// Patch trees of vertices and of face-varying channels; all of one control mesh. As the other tables' uploads.
/// Errors: and invalid_argument where tables are not of the same mesh, or trees were not made (max_rate 0).
Result<TessellationTableUpload> record_tessellation_table_upload(
    const Device& device, VkCommandBuffer command_buffer, const TessellationTable& table,
    const PatchTreeTable& vertices, std::span<const PatchTreeTable* const> channels = {});
/// What the upload takes, as for the other tables.
Result<MemoryNeed> upload_memory(const Device& device, const TessellationTable& table, const PatchTreeTable& vertices,
                                 std::span<const PatchTreeTable* const> channels = {});
Result<DeviceTessellationTable> upload_tessellation_table(const Device& device, const TessellationTable& table,
                                                          const PatchTreeTable& vertices,
                                                          std::span<const PatchTreeTable* const> channels = {});

}  // namespace limn::vk
