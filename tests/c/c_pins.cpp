// What the C interface is laid out as: it stays so.
#include "c/pins.h"
#include "limn/c/limn.h"

LIMN_PIN_STRUCT(limn_error, 256, LIMN_AT(code, 0), LIMN_AT(vk_result, 4), LIMN_AT(element, 8), LIMN_AT(message, 16))
LIMN_PIN_STRUCT(limn_face_varying_channel, 24, LIMN_AT(face_values, 0), LIMN_AT(face_value_count, 8),
                LIMN_AT(value_count, 16), LIMN_AT(interpolation, 20))
LIMN_PIN_STRUCT(limn_control_mesh_description, 176, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(scheme, 8),
                LIMN_AT(boundary, 12), LIMN_AT(creasing, 16), LIMN_AT(triangles, 20), LIMN_AT(vertex_count, 24),
                LIMN_AT(channel_count, 28), LIMN_AT(channels, 32), LIMN_AT(face_sizes, 40), LIMN_AT(face_count, 48),
                LIMN_AT(face_vertices, 56), LIMN_AT(face_vertex_count, 64), LIMN_AT(crease_sizes, 72),
                LIMN_AT(crease_size_count, 80), LIMN_AT(crease_vertices, 88), LIMN_AT(crease_vertex_count, 96),
                LIMN_AT(crease_sharpness, 104), LIMN_AT(crease_sharpness_count, 112), LIMN_AT(corner_vertices, 120),
                LIMN_AT(corner_sharpness, 128), LIMN_AT(corner_count, 136), LIMN_AT(holes, 144), LIMN_AT(hole_count, 152),
                LIMN_AT(positions, 160), LIMN_AT(position_value_count, 168))
LIMN_PIN_STRUCT(limn_job_system, 16, LIMN_AT(user, 0), LIMN_AT(submit, 8))
LIMN_PIN_STRUCT(limn_patch_table_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(interpolation, 4), LIMN_AT(plan_depth, 8),
                LIMN_AT(end_cap, 12), LIMN_AT(isolation_level, 16), LIMN_AT(reserved, 20), LIMN_AT(control, 24))
LIMN_PIN_STRUCT(limn_patch_table_info, 40, LIMN_AT(struct_size, 0), LIMN_AT(control_count, 4), LIMN_AT(first_refined, 8),
                LIMN_AT(point_count, 12), LIMN_AT(ptex_face_count, 16), LIMN_AT(surface_count, 20),
                LIMN_AT(plan_count, 24), LIMN_AT(scheme, 28), LIMN_AT(bytes, 32))
LIMN_PIN_STRUCT(limn_patch_sample, 24, LIMN_AT(face, 0), LIMN_AT(padding, 4), LIMN_AT(u, 8), LIMN_AT(v, 16))
LIMN_PIN_STRUCT(limn_patch_evaluation, 80, LIMN_AT(struct_size, 0), LIMN_AT(width, 4), LIMN_AT(derivatives, 8),
                LIMN_AT(flags, 12), LIMN_AT(samples, 16), LIMN_AT(sample_count, 24), LIMN_AT(points, 32),
                LIMN_AT(point_value_count, 40), LIMN_AT(results, 48), LIMN_AT(result_value_count, 56),
                LIMN_AT(statuses, 64), LIMN_AT(status_count, 72))
LIMN_PIN_STRUCT(limn_patch_trees_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(max_rate, 8),
                LIMN_AT(points_per_pass, 12), LIMN_AT(max_weight_bytes, 16), LIMN_AT(control, 24))
LIMN_PIN_STRUCT(limn_tessellation_table_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(channels, 8),
                LIMN_AT(channel_count, 16), LIMN_AT(control, 24))
LIMN_PIN_STRUCT(limn_tessellation_table_info, 40, LIMN_AT(struct_size, 0), LIMN_AT(face_count, 4),
                LIMN_AT(rate_edge_count, 8), LIMN_AT(mesh_edge_count, 12), LIMN_AT(row_count, 16),
                LIMN_AT(corner_count, 20), LIMN_AT(instance_count, 24), LIMN_AT(reserved, 28), LIMN_AT(bytes, 32))
LIMN_PIN_STRUCT(limn_grid_table_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(rate, 8),
                LIMN_AT(samples_per_pass, 12), LIMN_AT(max_weight_bytes, 16), LIMN_AT(control, 24))
LIMN_PIN_STRUCT(limn_stencil_table_options, 24, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(level, 8),
                LIMN_AT(interpolation, 12), LIMN_AT(control, 16))
LIMN_PIN_STRUCT(limn_refined_grid_table_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(level, 4),
                LIMN_AT(interpolation, 8), LIMN_AT(reserved, 12), LIMN_AT(max_weight_bytes, 16), LIMN_AT(control, 24))
LIMN_PIN_STRUCT(limn_tessellation_options, 112, LIMN_AT(struct_size, 0), LIMN_AT(mode, 4), LIMN_AT(spacing, 8),
                LIMN_AT(max_rate, 12), LIMN_AT(edge_rates, 16), LIMN_AT(edge_rate_count, 24), LIMN_AT(value, 32),
                LIMN_AT(scale, 36), LIMN_AT(matrix, 40), LIMN_AT(width, 104), LIMN_AT(height, 108))
LIMN_PIN_STRUCT(limn_tessellation_info, 48, LIMN_AT(struct_size, 0), LIMN_AT(vertex_count, 4),
                LIMN_AT(triangle_count, 8), LIMN_AT(reserved, 12), LIMN_AT(places, 16), LIMN_AT(position_sources, 24),
                LIMN_AT(indices, 32), LIMN_AT(triangle_faces, 40))
LIMN_PIN_STRUCT(limn_tessellation_evaluation, 80, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(points, 8),
                LIMN_AT(point_value_count, 16), LIMN_AT(positions, 24), LIMN_AT(position_value_count, 32),
                LIMN_AT(normals, 40), LIMN_AT(normal_value_count, 48), LIMN_AT(heights, 56),
                LIMN_AT(height_value_count, 64), LIMN_AT(height_step, 72))
LIMN_PIN_STRUCT(limn_baked_channel, 16, LIMN_AT(values, 0), LIMN_AT(value_count, 8))
LIMN_PIN_STRUCT(limn_bake_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(max_rate, 8),
                LIMN_AT(channel_count, 12), LIMN_AT(patches, 16), LIMN_AT(channels, 24))

static_assert(LIMN_ERROR_INVALID_ARGUMENT == 1 && LIMN_ERROR_VULKAN_FAILURE == 13 && LIMN_ERROR_UNSUPPORTED == 14 &&
              LIMN_ERROR_CANCELLED == 15);
static_assert(LIMN_PATCH_TREES_RELATIVE == 1 && LIMN_TESSELLATION_TABLE_JOIN_CREASES == 1 &&
              LIMN_GRID_TABLE_POINTS_ONLY == 1 && LIMN_STENCIL_TABLE_LIMIT == 1 && LIMN_STENCIL_TABLE_TANGENTS == 2);
static_assert(LIMN_BAKE_JOIN_CREASES == 1 && LIMN_BAKE_NO_TREES == 2 && LIMN_BAKED_FILE_TRUSTED == 1 &&
              LIMN_BAKED_FILE_READ == 2);
static_assert(LIMN_BOUNDARY_NONE == 2 && LIMN_FACE_VARYING_BOUNDARIES == 5 && LIMN_DERIVATIVES_SECOND == 2);
static_assert(LIMN_RATE_DISTANCE == 5 && LIMN_SPACING_FRACTIONAL == 2);
