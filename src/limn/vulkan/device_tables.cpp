#include "limn/vulkan/device_tables.h"

#include <algorithm>

namespace limn::vk {

namespace {

VkDeviceSize table_bytes(const StencilRuns& planned) {
    return std::max<VkDeviceSize>(8, 8 * planned.pair_count);
}

}  // namespace

Result<MemoryNeed> upload_memory(const StencilTable& table) {
    const auto planned = plan_stencil_runs(table);
    if (!planned) return planned.error();
    return MemoryNeed{table_bytes(*planned), table_bytes(*planned), 1};
}

Result<StencilTableUpload> record_stencil_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                       const StencilTable& table) {
    auto planned = plan_stencil_runs(table);
    if (!planned) return planned.error();
    StencilTableUpload upload;
    upload.table.source_count = table.source_count;
    upload.table.row_count = table.row_count();
    upload.table.has_tangents = !table.tangent1_weights.empty();

    constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                          VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                          VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    const VkDeviceSize size_bytes = table_bytes(*planned);
    auto data = create_buffer(device, size_bytes, kUsage, MemoryUse::device);
    if (!data) return data.error();
    upload.table.data = std::move(*data);

    void* words = upload.table.data.mapped();
    if (words == nullptr) {
        auto staging = create_buffer(device, size_bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload);
        if (!staging) return staging.error();
        upload.staging = std::move(*staging);
        words = upload.staging.mapped();
        const VkBufferCopy region = {0, 0, size_bytes};
        device.functions.CmdCopyBuffer(command_buffer, upload.staging.handle, upload.table.data.handle, 1,
                                       &region);
        record_barrier(device, command_buffer, kCopyWrites, kKernelReads);
    }
    write_stencil_runs(table, *planned, static_cast<uint32_t*>(words));
    upload.table.runs = std::move(planned->runs);
    return upload;
}

Result<DeviceStencilTable> upload_stencil_table(const Device& device, const StencilTable& table) {
    auto commands = Commands::begin(device);
    if (!commands) return commands.error();
    auto upload = record_stencil_table_upload(device, *commands, table);
    if (!upload) return upload.error();
    if (upload->staging.handle != VK_NULL_HANDLE)
        if (auto submitted = commands->submit_and_wait(); !submitted) return submitted.error();
    return std::move(upload->table);
}

}  // namespace limn::vk
