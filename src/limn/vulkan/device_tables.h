// Tables in device memory: uploaded once per topology, read by every evaluation.
#pragma once

#include "limn/stencil_table.h"
#include "limn/vulkan/buffer.h"
#include "limn/vulkan/stencil_runs.h"

namespace limn::vk {

/// A stencil table as the stencil_eval kernels read it (evaluator.h). Immutable once uploaded, but for
/// updates (table_update.h), may be shared by any number of evaluations, and must outlive them.
struct DeviceStencilTable {
    uint32_t source_count = 0;
    uint32_t row_count = 0;
    bool has_tangents = false;
    Buffer data;                   ///< pairs of words, laid out as limn/shared/stencil_eval_params.h says
    std::vector<StencilRun> runs;  ///< one dispatch each, four components at a time

    /// Device memory.
    VkDeviceSize bytes() const { return data.size_bytes; }
};

/// A table whose upload has been recorded, and the staging memory it is read from: keep that until the
/// commands have completed (it is empty where the device shares memory with the host).
struct StencilTableUpload {
    DeviceStencilTable table;
    Buffer staging;
};

/// Records the upload into the caller's command buffer, barrier to kernel reads included: evaluations may be
/// recorded right after it. Errors: out_of_memory, too_large, vulkan_failure.
Result<StencilTableUpload> record_stencil_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                       const StencilTable& table);

/// What the upload takes. Errors: too_large.
Result<MemoryNeed> upload_memory(const StencilTable& table);

/// The same, submitted to Device::queue and waited for.
Result<DeviceStencilTable> upload_stencil_table(const Device& device, const StencilTable& table);

}  // namespace limn::vk
