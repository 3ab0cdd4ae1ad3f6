// limn for C, on Vulkan: tables on the device that follow those of limn_changes.h, by copies of what differs, recorded
// into the caller's command buffer. What limn_vulkan.h says holds here, too; limn/vulkan/table_update.h and
// crowd_tables.h say the rest.
#ifndef LIMN_C_LIMN_VULKAN_CHANGES_H
#define LIMN_C_LIMN_VULKAN_CHANGES_H

#include "limn/c/limn_changes.h"
#include "limn/c/limn_vulkan.h"

#ifdef __cplusplus
extern "C" {
#endif

// Updates

/// What a recorded update reads, and buffers that it has put others in the place of: destroyed once the commands have
/// completed, and all that was recorded before with these tables.
///
/// The commands begin with a barrier from kernel reads to copies, and end with one from copies to kernel reads: what
/// was submitted to the same queue before reads the old state. Owed by the caller: the first where other stages read
/// tables, and after those again; a semaphore where frames on another queue do.
typedef struct limn_vk_table_update limn_vk_table_update;
void limn_vk_table_update_destroy(limn_vk_table_update* update) LIMN_C_NOEXCEPT;

typedef struct limn_vk_table_update_info {
    uint32_t struct_size;
    uint32_t prepare_again;  ///< 0 or 1: what was prepared with the tables is to be prepared again before it is
                             ///< recorded again
    uint64_t copied_bytes;
} limn_vk_table_update_info;

/// Fills as much of `info` as its struct_size says.
limn_result limn_vk_table_update_get_info(const limn_vk_table_update* update, limn_vk_table_update_info* info,
                                          limn_error* error) LIMN_C_NOEXCEPT;

// Tables that hold nothing yet: the first update is an upload with room to spare.
limn_result limn_vk_patch_table_create_empty(limn_vk_patch_table** table, limn_error* error) LIMN_C_NOEXCEPT;
limn_result limn_vk_grid_table_create_empty(limn_vk_grid_table** table, limn_error* error) LIMN_C_NOEXCEPT;
limn_result limn_vk_tessellation_table_create_empty(limn_vk_tessellation_table** table,
                                                    limn_error* error) LIMN_C_NOEXCEPT;

// Bring `table`, which holds `before` (null: it is an empty one), to `after`. A buffer that is too small gives way to
// one with room for `reserve` (0.25, say) times as much more of every array. What is recorded afterwards sees the new
// state; evaluations of the table are not recorded meanwhile.

limn_result limn_vk_patch_table_update(const limn_vk_context* context, VkCommandBuffer commands,
                                       limn_vk_patch_table* table, const limn_patch_table* before,
                                       const limn_patch_table* after, float reserve, limn_vk_table_update** update,
                                       limn_error* error) LIMN_C_NOEXCEPT;
limn_result limn_vk_grid_table_update(const limn_vk_context* context, VkCommandBuffer commands,
                                      limn_vk_grid_table* table, const limn_grid_table* before,
                                      const limn_grid_table* after, float reserve, limn_vk_table_update** update,
                                      limn_error* error) LIMN_C_NOEXCEPT;

/// A tessellation's tables on the host, as limn_vk_tessellation_table_create takes them.
typedef struct limn_vk_tessellation_sources {
    const limn_tessellation_table* tessellation;
    const limn_patch_trees* vertices;
    const limn_patch_trees* const* channels;
    uint64_t channel_count;
} limn_vk_tessellation_sources;

limn_result limn_vk_tessellation_table_update(const limn_vk_context* context, VkCommandBuffer commands,
                                              limn_vk_tessellation_table* table,
                                              const limn_vk_tessellation_sources* before,
                                              const limn_vk_tessellation_sources* after, float reserve,
                                              limn_vk_table_update** update, limn_error* error) LIMN_C_NOEXCEPT;

// Crowds

/// limn::vk::DeviceCrowd: empty before the first update.
typedef struct limn_vk_crowd limn_vk_crowd;
limn_result limn_vk_crowd_create(limn_vk_crowd** crowd, limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_crowd_destroy(limn_vk_crowd* crowd) LIMN_C_NOEXCEPT;

/// To the state of `from`: limn::vk::record_crowd_update. Then limn_crowd_forget_changes.
limn_result limn_vk_crowd_update(const limn_vk_context* context, VkCommandBuffer commands, limn_vk_crowd* crowd,
                                 const limn_crowd* from, limn_vk_table_update** update,
                                 limn_error* error) LIMN_C_NOEXCEPT;

// The crowd's own, to prepare what is evaluated and tessellated with; not to be destroyed. Null of null.
const limn_vk_patch_table* limn_vk_crowd_get_patches(const limn_vk_crowd* crowd) LIMN_C_NOEXCEPT;
const limn_vk_tessellation_table* limn_vk_crowd_get_tessellation(const limn_vk_crowd* crowd) LIMN_C_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
