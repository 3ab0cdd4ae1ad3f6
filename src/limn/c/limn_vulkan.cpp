// The C interface on Vulkan: contexts, barriers, tables.
#include "limn/c/vulkan_interop.h"

namespace limn::c {
namespace {

static_assert(LIMN_VK_MEMORY_DEVICE == static_cast<int>(vk::MemoryUse::device) &&
              LIMN_VK_MEMORY_UPLOAD == static_cast<int>(vk::MemoryUse::upload) &&
              LIMN_VK_MEMORY_READBACK == static_cast<int>(vk::MemoryUse::readback));
static_assert(LIMN_VK_SOURCE_USAGE == vk::kSourceUsage);

VkResult allocate(void* user, const VkMemoryRequirements& requirements, vk::MemoryUse use,
                  vk::MemoryBlock* block) {
    const auto& allocator = *static_cast<const limn_vk_allocator*>(user);
    limn_vk_memory_block made = {};
    const VkResult result =
        allocator.allocate(allocator.user, &requirements, static_cast<limn_vk_memory_use>(use), &made);
    *block = {made.memory, made.offset, made.mapped, made.user};
    return result;
}

void release(void* user, const vk::MemoryBlock& block) {
    const auto& allocator = *static_cast<const limn_vk_allocator*>(user);
    const limn_vk_memory_block made = {block.memory, block.offset, block.mapped, block.user};
    allocator.free(allocator.user, &made);
}

/// `make(context)` makes what it holds.
template <class Make>
limn_result create_context(limn_vk_context** out, limn_error* error, const Make& make) {
    if (out == nullptr) return report(bad_argument("context is null"), error);
    *out = nullptr;
    std::unique_ptr<limn_vk_context> context(new (std::nothrow) limn_vk_context{});
    if (context == nullptr) return report(out_of_memory(), error);
    Result<vk::Context> made = make(*context);
    if (!made) return report(made.error(), error);
    context->value = std::move(*made);
    *out = context.release();
    return LIMN_SUCCESS;
}

Result<vk::Context> borrow(const limn_vk_borrowed_handles* given, limn_vk_allocator& kept) {
    const auto handles = read_struct(given);
    if (!handles) return handles.error();
    kept = handles->allocator;
    if ((kept.allocate == nullptr) != (kept.free == nullptr))
        return bad_argument("an allocator needs both of its functions");
    vk::BorrowedHandles out{.instance = handles->instance,
                            .physical_device = handles->physical_device,
                            .device = handles->device,
                            .queue_family_index = handles->queue_family_index,
                            .get_instance_proc_addr = handles->get_instance_proc_addr,
                            .get_device_proc_addr = handles->get_device_proc_addr,
                            .pipeline_cache = handles->pipeline_cache,
                            .host_allocator = handles->host_allocator};
    if (kept.allocate != nullptr) out.allocator = {&kept, allocate, release};
    return vk::Context::borrow(out);
}

Result<vk::Context> create_headless(const limn_vk_context_options* given) {
    constexpr uint32_t kIndex = 0;  // device_index takes its place
    constexpr uint32_t kDevices[] = {vk::kAutomaticDevice, vk::kCpuDevice, kIndex};
    if (given == nullptr) return vk::Context::create();
    const auto options = read_struct(given);
    if (!options) return options.error();
    Reader reader;
    reader.flags(options->flags, LIMN_VK_CONTEXT_VALIDATION);
    uint32_t device = reader.choice(options->device, kDevices, "choice of a device");
    if (options->device == LIMN_VK_DEVICE_INDEX) device = options->device_index;
    if (!reader.state) return reader.state.error();
    return vk::Context::create(
        {.device_index = device, .validation = (options->flags & LIMN_VK_CONTEXT_VALIDATION) != 0});
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_vk_list_devices(limn_vk_device_description* devices, uint32_t capacity, uint32_t* count,
                                 limn_error* error) noexcept {
    Reader reader;
    const auto room = reader.array(devices, capacity, "devices");
    if (count == nullptr) reader.fail("count is null");
    if (!reader.state) return report(reader.state.error(), error);
    const auto list = limn::vk::list_devices();
    if (!list) return report(list.error(), error);
    for (size_t i = 0; i < std::min(room.size(), list->size()); ++i) {
        const limn::vk::DeviceInfo& info = (*list)[i];
        room[i] = {{}, info.type, info.api_version, info.driver_version, info.usable ? 1u : 0u};
        info.name.copy(room[i].name, sizeof(room[i].name) - 1);
    }
    *count = static_cast<uint32_t>(list->size());
    return LIMN_SUCCESS;
}

limn_result limn_vk_context_borrow(const limn_vk_borrowed_handles* handles, limn_vk_context** context,
                                   limn_error* error) noexcept {
    return create_context(context, error,
                          [&](limn_vk_context& made) { return borrow(handles, made.allocator); });
}
limn_result limn_vk_context_create(const limn_vk_context_options* options, limn_vk_context** context,
                                   limn_error* error) noexcept {
    return create_context(context, error, [&](limn_vk_context&) { return create_headless(options); });
}
void limn_vk_context_destroy(limn_vk_context* context) noexcept {
    delete context;
}

limn_result limn_vk_context_get_info(const limn_vk_context* context, limn_vk_context_info* info,
                                     limn_error* error) noexcept {
    if (context == nullptr) return report(bad_argument("context is null"), error);
    const limn::vk::Device& device = context->value->device();
    limn_vk_context_info known = {0,
                                  device.queue_family_index,
                                  device.instance,
                                  device.physical_device,
                                  device.handle,
                                  device.queue,
                                  device.functions.GetInstanceProcAddr,
                                  context->value->validation_message_count(),
                                  0,
                                  {}};
    static_assert(sizeof(known.device_name) == sizeof(device.properties.deviceName));
    std::memcpy(known.device_name, device.properties.deviceName, sizeof(known.device_name));
    return write_struct(known, info, error);
}

void limn_vk_record_barrier(const limn_vk_context* context, VkCommandBuffer commands,
                            limn_vk_stage_access before, limn_vk_stage_access after) noexcept {
    if (context == nullptr || commands == VK_NULL_HANDLE) return;
    limn::vk::record_barrier(context->value->device(), commands, {before.stages, before.access},
                             {after.stages, after.access});
}

limn_result limn_vk_upload_create(const limn_vk_context* context, VkCommandBuffer commands,
                                  limn_vk_upload** upload, limn_error* error) noexcept {
    if (upload == nullptr) return report(bad_argument("upload is null"), error);
    *upload = nullptr;
    if (context == nullptr || commands == VK_NULL_HANDLE)
        return report(bad_argument("context or commands is null"), error);
    *upload = new (std::nothrow) limn_vk_upload{context->value->device(), commands, {}};
    return *upload != nullptr ? LIMN_SUCCESS : report(out_of_memory(), error);
}
void limn_vk_upload_destroy(limn_vk_upload* upload) noexcept {
    delete upload;
}

limn_result limn_vk_patch_table_create(limn_vk_upload* upload, const limn_patch_table* from,
                                       limn_vk_patch_table** table, limn_error* error) noexcept {
    return upload_table(upload, from, table, error, limn::vk::record_patch_table_upload);
}
void limn_vk_patch_table_destroy(limn_vk_patch_table* table) noexcept {
    delete table;
}

limn_result limn_vk_patch_trees_create(limn_vk_upload* upload, const limn_patch_trees* from,
                                       limn_vk_patch_trees** trees, limn_error* error) noexcept {
    return upload_table(upload, from, trees, error, limn::vk::record_patch_trees_upload);
}
void limn_vk_patch_trees_destroy(limn_vk_patch_trees* trees) noexcept {
    delete trees;
}
uint32_t limn_vk_patch_trees_get_local_count(const limn_vk_patch_trees* trees) noexcept {
    return trees != nullptr ? trees->value.local_count : 0;
}

limn_result limn_vk_tessellation_table_create(limn_vk_upload* upload, const limn_tessellation_table* from,
                                              const limn_patch_trees* vertices,
                                              const limn_patch_trees* const* channels, uint64_t channel_count,
                                              limn_vk_tessellation_table** table,
                                              limn_error* error) noexcept {
    using namespace limn;
    return upload_table(
        upload, from, table, error,
        [&](const vk::Device& device, VkCommandBuffer commands,
            const TessellationTable& tessellation) -> Result<vk::TessellationTableUpload> {
            Reader reader;
            std::vector<const PatchTreeTable*> trees;
            for (const limn_patch_trees* channel : reader.array(channels, channel_count, "channels")) {
                if (channel == nullptr) return bad_argument("the trees of a channel are null");
                trees.push_back(&channel->value);
            }
            if (vertices == nullptr) reader.fail("vertices is null");
            if (!reader.state) return reader.state.error();
            return vk::record_tessellation_table_upload(device, commands, tessellation, vertices->value,
                                                        trees);
        });
}
void limn_vk_tessellation_table_destroy(limn_vk_tessellation_table* table) noexcept {
    delete table;
}

limn_result limn_vk_grid_table_create(limn_vk_upload* upload, const limn_grid_table* from,
                                      limn_vk_grid_table** table, limn_error* error) noexcept {
    return upload_table(upload, from, table, error, limn::vk::record_grid_table_upload);
}
void limn_vk_grid_table_destroy(limn_vk_grid_table* table) noexcept {
    delete table;
}

limn_result limn_vk_stencil_table_create(limn_vk_upload* upload, const limn_stencil_table* from,
                                         limn_vk_stencil_table** table, limn_error* error) noexcept {
    return upload_table(upload, from, table, error, limn::vk::record_stencil_table_upload);
}
void limn_vk_stencil_table_destroy(limn_vk_stencil_table* table) noexcept {
    delete table;
}

limn_result limn_vk_refined_grid_create(limn_vk_upload* upload, const limn_refined_grid_table* from,
                                        limn_vk_refined_grid** grid, limn_error* error) noexcept {
    return upload_table(upload, from, grid, error, limn::vk::record_refined_grid_upload);
}
void limn_vk_refined_grid_destroy(limn_vk_refined_grid* grid) noexcept {
    delete grid;
}
