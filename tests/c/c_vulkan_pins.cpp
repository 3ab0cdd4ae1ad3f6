// What the C interface on Vulkan is laid out as: it stays so.
#include "c/pins.h"
#include "limn/c/limn_vulkan_changes.h"
#include "limn/c/limn_vulkan_schemes.h"

LIMN_PIN_STRUCT(limn_vk_memory_block, 32, LIMN_AT(memory, 0), LIMN_AT(offset, 8), LIMN_AT(mapped, 16), LIMN_AT(user, 24))
LIMN_PIN_STRUCT(limn_vk_allocator, 24, LIMN_AT(user, 0), LIMN_AT(allocate, 8), LIMN_AT(free, 16))
LIMN_PIN_STRUCT(limn_vk_borrowed_handles, 88, LIMN_AT(struct_size, 0), LIMN_AT(queue_family_index, 4),
                LIMN_AT(instance, 8), LIMN_AT(physical_device, 16), LIMN_AT(device, 24),
                LIMN_AT(get_instance_proc_addr, 32), LIMN_AT(pipeline_cache, 40), LIMN_AT(allocator, 48),
                LIMN_AT(get_device_proc_addr, 72), LIMN_AT(host_allocator, 80))
LIMN_PIN_STRUCT(limn_vk_device_description, 272, LIMN_AT(name, 0), LIMN_AT(type, 256), LIMN_AT(api_version, 260),
                LIMN_AT(driver_version, 264), LIMN_AT(usable, 268))
LIMN_PIN_STRUCT(limn_vk_context_options, 16, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(device, 8),
                LIMN_AT(device_index, 12))
LIMN_PIN_STRUCT(limn_vk_context_info, 312, LIMN_AT(struct_size, 0), LIMN_AT(queue_family_index, 4), LIMN_AT(instance, 8),
                LIMN_AT(physical_device, 16), LIMN_AT(device, 24), LIMN_AT(queue, 32),
                LIMN_AT(get_instance_proc_addr, 40), LIMN_AT(validation_message_count, 48), LIMN_AT(reserved, 52),
                LIMN_AT(device_name, 56))
LIMN_PIN_STRUCT(limn_vk_stage_access, 8, LIMN_AT(stages, 0), LIMN_AT(access, 4))
LIMN_PIN_STRUCT(limn_vk_points, 32, LIMN_AT(buffer, 0), LIMN_AT(offset_bytes, 8), LIMN_AT(first, 16), LIMN_AT(stride, 24),
                LIMN_AT(reserved, 28))
LIMN_PIN_STRUCT(limn_vk_points_info, 48, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(patches, 8),
                LIMN_AT(points, 16))
LIMN_PIN_STRUCT(limn_vk_stencils_info, 152, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(table, 8),
                LIMN_AT(source, 16), LIMN_AT(destination, 48), LIMN_AT(tangent1, 80), LIMN_AT(tangent2, 112),
                LIMN_AT(first_row, 144), LIMN_AT(row_count, 148))
LIMN_PIN_STRUCT(limn_vk_grid_info, 192, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(patches, 8),
                LIMN_AT(grid, 16), LIMN_AT(points, 24), LIMN_AT(values, 56), LIMN_AT(normals, 88), LIMN_AT(du, 120),
                LIMN_AT(dv, 152), LIMN_AT(packed_normals, 184), LIMN_AT(reserved, 188))
LIMN_PIN_STRUCT(limn_vk_local_points_info, 64, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(patches, 8),
                LIMN_AT(trees, 16), LIMN_AT(points, 24), LIMN_AT(local_points, 56))
LIMN_PIN_STRUCT(limn_vk_samples_info, 152, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(patches, 8),
                LIMN_AT(derivatives, 16), LIMN_AT(sample_count, 20), LIMN_AT(points, 24), LIMN_AT(samples, 56),
                LIMN_AT(samples_offset_bytes, 64), LIMN_AT(results, 72), LIMN_AT(statuses, 104), LIMN_AT(trees, 136),
                LIMN_AT(local_points, 144))
LIMN_PIN_STRUCT(limn_vk_locations_info, 96, LIMN_AT(struct_size, 0), LIMN_AT(sample_count, 4), LIMN_AT(patches, 8),
                LIMN_AT(samples, 16), LIMN_AT(samples_offset_bytes, 24), LIMN_AT(places, 32), LIMN_AT(statuses, 64))
LIMN_PIN_STRUCT(limn_vk_refined_info, 80, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(grid, 8),
                LIMN_AT(source, 16), LIMN_AT(refined, 48))
LIMN_PIN_STRUCT(limn_vk_instance, 64, LIMN_AT(object_to_world, 0), LIMN_AT(value_scale, 48), LIMN_AT(flags, 52),
                LIMN_AT(reserved, 56))
LIMN_PIN_STRUCT(limn_vk_words, 16, LIMN_AT(buffer, 0), LIMN_AT(offset_bytes, 8))
LIMN_PIN_STRUCT(limn_vk_tessellated_channel, 80, LIMN_AT(patches, 0), LIMN_AT(channel, 8), LIMN_AT(width, 12),
                LIMN_AT(points, 16), LIMN_AT(values, 48))
LIMN_PIN_STRUCT(limn_vk_height_texture, 32, LIMN_AT(view, 0), LIMN_AT(sampler, 8), LIMN_AT(layout, 16),
                LIMN_AT(channel, 20), LIMN_AT(scale, 24), LIMN_AT(bias, 28))
LIMN_PIN_STRUCT(limn_vk_tessellation_info, 456, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(patches, 8),
                LIMN_AT(table, 16), LIMN_AT(points, 24), LIMN_AT(mode, 56), LIMN_AT(spacing, 60),
                LIMN_AT(vertex_capacity, 64), LIMN_AT(triangle_capacity, 68), LIMN_AT(edge_rates, 72),
                LIMN_AT(instances, 88), LIMN_AT(positions, 104), LIMN_AT(normals, 136), LIMN_AT(places, 168),
                LIMN_AT(tangents, 200), LIMN_AT(channels, 232), LIMN_AT(channel_count, 240),
                LIMN_AT(tangent_channel, 244), LIMN_AT(previous_points, 248), LIMN_AT(previous_positions, 280),
                LIMN_AT(heights, 312), LIMN_AT(height_texture, 344), LIMN_AT(indices, 376), LIMN_AT(triangle_faces, 392),
                LIMN_AT(command, 408), LIMN_AT(instance_commands, 424), LIMN_AT(result, 440))
LIMN_PIN_STRUCT(limn_vk_tessellation_result, 16, LIMN_AT(status, 0), LIMN_AT(vertex_count, 4),
                LIMN_AT(triangle_count, 8), LIMN_AT(rate_scale, 12))
LIMN_PIN_STRUCT(limn_vk_rate_settings, 88, LIMN_AT(struct_size, 0), LIMN_AT(value, 4), LIMN_AT(max_rate, 8),
                LIMN_AT(bound, 12), LIMN_AT(matrix, 16), LIMN_AT(width, 80), LIMN_AT(height, 84))
LIMN_PIN_STRUCT(limn_vk_stage_code, 16, LIMN_AT(words, 0), LIMN_AT(word_count, 8))
LIMN_PIN_STRUCT(limn_vk_hardware_stages, 80, LIMN_AT(struct_size, 0), LIMN_AT(reserved, 4), LIMN_AT(set_layout, 8),
                LIMN_AT(push_constants, 16), LIMN_AT(reserved2, 28), LIMN_AT(vertex, 32), LIMN_AT(control, 48),
                LIMN_AT(evaluation, 64))

static_assert(LIMN_VK_DEVICE_INDEX == 2 && LIMN_VK_TESSELLATION_FIRST_INSTANCE_0 == 32 &&
              LIMN_VK_PASS_DISPLACEMENT == 32 && LIMN_VK_TESSELLATION_SHADER_ENABLED == 1);
LIMN_PIN_STRUCT(limn_vk_curvature_info, 112, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(sample_count, 8),
                LIMN_AT(reserved, 12), LIMN_AT(values, 16), LIMN_AT(curvatures, 48), LIMN_AT(quotients, 80))
LIMN_PIN_STRUCT(limn_vk_table_update_info, 16, LIMN_AT(struct_size, 0), LIMN_AT(prepare_again, 4),
                LIMN_AT(copied_bytes, 8))
LIMN_PIN_STRUCT(limn_vk_tessellation_sources, 32, LIMN_AT(tessellation, 0), LIMN_AT(vertices, 8), LIMN_AT(channels, 16),
                LIMN_AT(channel_count, 24))
LIMN_PIN_STRUCT(limn_vk_scheme_surface_info, 112, LIMN_AT(struct_size, 0), LIMN_AT(reserved, 4), LIMN_AT(surface, 8),
                LIMN_AT(points, 16), LIMN_AT(positions, 48), LIMN_AT(normals, 80))
