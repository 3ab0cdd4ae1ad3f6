// What the C interface on Vulkan is laid out as: it stays so.
#include <cstddef>

#include "limn/c/limn_vulkan.h"

#define LIMN_PIN(type, member, offset) static_assert(offsetof(type, member) == (offset))
static_assert(sizeof(limn_vk_memory_block) == 32 && sizeof(limn_vk_allocator) == 24 &&
              sizeof(limn_vk_stage_access) == 8);
static_assert(sizeof(limn_vk_borrowed_handles) == 72 && sizeof(limn_vk_context_options) == 16);
static_assert(sizeof(limn_vk_context_info) == 312 && sizeof(limn_vk_points) == 32 &&
              sizeof(limn_vk_words) == 16);
static_assert(sizeof(limn_vk_points_info) == 48 && sizeof(limn_vk_stencils_info) == 152);
static_assert(sizeof(limn_vk_grid_info) == 184 && sizeof(limn_vk_local_points_info) == 64);
static_assert(sizeof(limn_vk_samples_info) == 152 && sizeof(limn_vk_tessellated_channel) == 80);
static_assert(sizeof(limn_vk_height_texture) == 32 && sizeof(limn_vk_tessellation_info) == 456);
static_assert(sizeof(limn_vk_tessellation_result) == 16 && sizeof(limn_vk_instance) == 64);
static_assert(sizeof(limn_vk_rate_settings) == 88);
LIMN_PIN(limn_vk_memory_block, mapped, 16);
LIMN_PIN(limn_vk_memory_block, user, 24);
LIMN_PIN(limn_vk_allocator, free, 16);
LIMN_PIN(limn_vk_borrowed_handles, device, 24);
LIMN_PIN(limn_vk_borrowed_handles, allocator, 48);
LIMN_PIN(limn_vk_context_info, queue, 32);
LIMN_PIN(limn_vk_context_info, validation_message_count, 48);
LIMN_PIN(limn_vk_context_info, device_name, 56);
LIMN_PIN(limn_vk_points, first, 16);
LIMN_PIN(limn_vk_points, stride, 24);
LIMN_PIN(limn_vk_points_info, points, 16);
LIMN_PIN(limn_vk_stencils_info, destination, 48);
LIMN_PIN(limn_vk_stencils_info, first_row, 144);
LIMN_PIN(limn_vk_grid_info, values, 56);
LIMN_PIN(limn_vk_grid_info, dv, 152);
LIMN_PIN(limn_vk_local_points_info, local_points, 56);
LIMN_PIN(limn_vk_samples_info, points, 24);
LIMN_PIN(limn_vk_samples_info, results, 72);
LIMN_PIN(limn_vk_samples_info, trees, 136);
LIMN_PIN(limn_vk_tessellated_channel, points, 16);
LIMN_PIN(limn_vk_height_texture, layout, 16);
LIMN_PIN(limn_vk_height_texture, bias, 28);
LIMN_PIN(limn_vk_tessellation_info, points, 24);
LIMN_PIN(limn_vk_tessellation_info, vertex_capacity, 64);
LIMN_PIN(limn_vk_tessellation_info, edge_rates, 72);
LIMN_PIN(limn_vk_tessellation_info, positions, 104);
LIMN_PIN(limn_vk_tessellation_info, channels, 232);
LIMN_PIN(limn_vk_tessellation_info, previous_points, 248);
LIMN_PIN(limn_vk_tessellation_info, heights, 312);
LIMN_PIN(limn_vk_tessellation_info, height_texture, 344);
LIMN_PIN(limn_vk_tessellation_info, indices, 376);
LIMN_PIN(limn_vk_tessellation_info, result, 440);
LIMN_PIN(limn_vk_instance, value_scale, 48);
LIMN_PIN(limn_vk_tessellation_result, rate_scale, 12);
LIMN_PIN(limn_vk_rate_settings, matrix, 16);
LIMN_PIN(limn_vk_rate_settings, height, 84);
static_assert(LIMN_VK_DEVICE_INDEX == 2 && LIMN_RATE_DISTANCE == 5 && LIMN_SPACING_FRACTIONAL == 2);
static_assert(LIMN_VK_TESSELLATION_FIRST_INSTANCE_0 == 32 && LIMN_VK_PASS_DISPLACEMENT == 32);
