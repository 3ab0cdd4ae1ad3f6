// The C interface on Vulkan: tables that follow those on the host.
#include "limn/c/limn_vulkan_changes.h"

#include "limn/c/change_interop.h"
#include "limn/c/vulkan_interop.h"
#include "limn/vulkan/crowd_tables.h"

struct limn_vk_table_update {
    limn::vk::TableUpdate value;
};
struct limn_vk_crowd {
    limn::vk::DeviceCrowd value;
};

namespace limn::c {
namespace {

template <class Object>
limn_result create_empty(Object** out, limn_error* error) {
    return create(out, error, [] { return Result<decltype(Object::value)>(decltype(Object::value)()); });
}

/// `record(device)` records the update of `table`, which is not null then.
template <class Record>
limn_result update_table(const limn_vk_context* context, VkCommandBuffer commands, const void* table, const void* after,
                         float reserve, limn_vk_table_update** update, limn_error* error, const Record& record) {
    return create(update, error, [&]() -> Result<vk::TableUpdate> {
        Reader reader;
        if (context == nullptr || commands == VK_NULL_HANDLE) reader.fail("context or commands is null");
        if (table == nullptr || after == nullptr) reader.fail("a table is null");
        if (!(reserve >= 0 && reserve <= 4)) reader.fail("the reserve is not within 0 and 4");
        if (!reader.state) return reader.state.error();
        return record(context->value->device());
    });
}

/// The sources' tables; `trees` are what it refers to.
Result<vk::TessellationTables> read_sources(const limn_vk_tessellation_sources& given,
                                            std::vector<const PatchTreeTable*>& trees) {
    Reader reader;
    if (given.tessellation == nullptr || given.vertices == nullptr) reader.fail("a tessellation lacks a table");
    for (const limn_patch_trees* channel : reader.array(given.channels, given.channel_count, "channels")) {
        if (channel == nullptr) reader.fail("the trees of a channel are null");
        trees.push_back(value_of(channel));
    }
    if (!reader.state) return reader.state.error();
    return vk::TessellationTables{&given.tessellation->value, &given.vertices->value, trees};
}

/// What an empty tessellation table holds: as many channels as `after` has.
struct EmptySources {
    TessellationTable tessellation;
    PatchTreeTable trees;
    std::vector<const PatchTreeTable*> channels;
    explicit EmptySources(uint64_t channel_count) : channels(channel_count, &trees) {}
    vk::TessellationTables tables() const { return {&tessellation, &trees, channels}; }
};

}  // namespace
}  // namespace limn::c

using namespace limn;
using namespace limn::c;

void limn_vk_table_update_destroy(limn_vk_table_update* update) noexcept {
    delete update;
}
limn_result limn_vk_table_update_get_info(const limn_vk_table_update* update, limn_vk_table_update_info* info,
                                          limn_error* error) noexcept {
    if (update == nullptr) return report(bad_argument("update is null"), error);
    return write_struct({0, update->value.prepare_again ? 1u : 0u, update->value.copied_bytes}, info, error);
}

limn_result limn_vk_patch_table_create_empty(limn_vk_patch_table** table, limn_error* error) noexcept {
    return create_empty(table, error);
}
limn_result limn_vk_grid_table_create_empty(limn_vk_grid_table** table, limn_error* error) noexcept {
    return create_empty(table, error);
}
limn_result limn_vk_tessellation_table_create_empty(limn_vk_tessellation_table** table, limn_error* error) noexcept {
    return create_empty(table, error);
}

limn_result limn_vk_patch_table_update(const limn_vk_context* context, VkCommandBuffer commands,
                                       limn_vk_patch_table* table, const limn_patch_table* before,
                                       const limn_patch_table* after, float reserve, limn_vk_table_update** update,
                                       limn_error* error) noexcept {
    return update_table(context, commands, table, after, reserve, update, error, [&](const vk::Device& device) {
        return vk::record_patch_table_update(device, commands, table->value,
                                             before != nullptr ? before->value : PatchTable(), after->value, reserve);
    });
}
limn_result limn_vk_grid_table_update(const limn_vk_context* context, VkCommandBuffer commands,
                                      limn_vk_grid_table* table, const limn_grid_table* before,
                                      const limn_grid_table* after, float reserve, limn_vk_table_update** update,
                                      limn_error* error) noexcept {
    return update_table(context, commands, table, after, reserve, update, error, [&](const vk::Device& device) {
        return vk::record_grid_table_update(device, commands, table->value,
                                            before != nullptr ? before->value : GridTable(), after->value, reserve);
    });
}

limn_result limn_vk_tessellation_table_update(const limn_vk_context* context, VkCommandBuffer commands,
                                              limn_vk_tessellation_table* table,
                                              const limn_vk_tessellation_sources* before,
                                              const limn_vk_tessellation_sources* after, float reserve,
                                              limn_vk_table_update** update, limn_error* error) noexcept {
    return update_table(context, commands, table, after, reserve, update, error,
                        [&](const vk::Device& device) -> Result<vk::TableUpdate> {
                            std::vector<const PatchTreeTable*> trees_before, trees_after;
                            const auto to = read_sources(*after, trees_after);
                            if (!to) return to.error();
                            const EmptySources none(trees_after.size());
                            const auto from = before != nullptr ? read_sources(*before, trees_before) : none.tables();
                            if (!from) return from.error();
                            return vk::record_tessellation_table_update(device, commands, table->value, *from, *to,
                                                                        reserve);
                        });
}

limn_result limn_vk_crowd_create(limn_vk_crowd** crowd, limn_error* error) noexcept {
    return create_empty(crowd, error);
}
void limn_vk_crowd_destroy(limn_vk_crowd* crowd) noexcept {
    delete crowd;
}
limn_result limn_vk_crowd_update(const limn_vk_context* context, VkCommandBuffer commands, limn_vk_crowd* crowd,
                                 const limn_crowd* from, limn_vk_table_update** update, limn_error* error) noexcept {
    return update_table(context, commands, crowd, from, 0, update, error, [&](const vk::Device& device) {
        return vk::record_crowd_update(device, commands, from->value, crowd->value);
    });
}
const limn_vk_patch_table* limn_vk_crowd_get_patches(const limn_vk_crowd* crowd) noexcept {
    return crowd != nullptr ? as_object<limn_vk_patch_table>(&crowd->value.patches) : nullptr;
}
const limn_vk_tessellation_table* limn_vk_crowd_get_tessellation(const limn_vk_crowd* crowd) noexcept {
    return crowd != nullptr ? as_object<limn_vk_tessellation_table>(&crowd->value.topology) : nullptr;
}
