// What the C interface is laid out as: it stays so.
#include "c/pins.h"
#include "limn/c/limn_changes.h"
#include "limn/c/limn_schemes.h"

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
LIMN_PIN_STRUCT(limn_curvature, 80, LIMN_AT(gaussian, 0), LIMN_AT(mean, 8), LIMN_AT(first, 16), LIMN_AT(second, 24),
                LIMN_AT(first_direction, 32), LIMN_AT(second_direction, 56))
LIMN_PIN_STRUCT(limn_editable_mesh_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(patches, 8),
                LIMN_AT(channels, 16), LIMN_AT(channel_count, 24))
LIMN_PIN_STRUCT(limn_mesh_edit, 136, LIMN_AT(struct_size, 0), LIMN_AT(new_vertex_count, 4), LIMN_AT(faces, 8),
                LIMN_AT(face_sizes, 16), LIMN_AT(face_count, 24), LIMN_AT(face_vertices, 32),
                LIMN_AT(face_vertex_count, 40), LIMN_AT(crease_vertices, 48), LIMN_AT(crease_vertex_count, 56),
                LIMN_AT(crease_sharpness, 64), LIMN_AT(crease_sharpness_count, 72), LIMN_AT(corner_vertices, 80),
                LIMN_AT(corner_sharpness, 88), LIMN_AT(corner_count, 96), LIMN_AT(holes, 104), LIMN_AT(hole_count, 112),
                LIMN_AT(filled_holes, 120), LIMN_AT(filled_hole_count, 128))
LIMN_PIN_STRUCT(limn_edit_work, 16, LIMN_AT(struct_size, 0), LIMN_AT(face_count, 4), LIMN_AT(tessellation, 8),
                LIMN_AT(reserved, 12))
LIMN_PIN_STRUCT(limn_crowd_options, 32, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(max_rate, 8),
                LIMN_AT(points_per_pass, 12), LIMN_AT(max_weight_bytes, 16), LIMN_AT(reserve, 24),
                LIMN_AT(reserved, 28))
LIMN_PIN_STRUCT(limn_crowd_mesh, 16, LIMN_AT(patches, 0), LIMN_AT(tessellation, 8))
LIMN_PIN_STRUCT(limn_crowd_info, 40, LIMN_AT(struct_size, 0), LIMN_AT(instance_capacity, 4), LIMN_AT(instance_count, 8),
                LIMN_AT(reserved, 12), LIMN_AT(layout, 16), LIMN_AT(bytes, 24), LIMN_AT(changed_bytes, 32))
LIMN_PIN_STRUCT(limn_range, 8, LIMN_AT(first, 0), LIMN_AT(count, 4))
LIMN_PIN_STRUCT(limn_crowd_instance, 64, LIMN_AT(struct_size, 0), LIMN_AT(reserved, 4), LIMN_AT(control_points, 8),
                LIMN_AT(ptex_faces, 16), LIMN_AT(surfaces, 24), LIMN_AT(mesh_edges, 32), LIMN_AT(sub_face_edges, 40),
                LIMN_AT(rows, 48), LIMN_AT(corners, 56))
LIMN_PIN_STRUCT(limn_subdivision_scheme_info, 40, LIMN_AT(struct_size, 0), LIMN_AT(flags, 4), LIMN_AT(faces, 8),
                LIMN_AT(corner_values, 12), LIMN_AT(name, 16), LIMN_AT(title, 24), LIMN_AT(source, 32))
LIMN_PIN_STRUCT(limn_scheme_surface_options, 40, LIMN_AT(struct_size, 0), LIMN_AT(level, 4), LIMN_AT(scheme, 8),
                LIMN_AT(corner_values, 16), LIMN_AT(corner_value_count, 24), LIMN_AT(control, 32))
LIMN_PIN_STRUCT(limn_adaptive_surface_options, 72, LIMN_AT(struct_size, 0), LIMN_AT(max_level, 4), LIMN_AT(scheme, 8),
                LIMN_AT(corner_values, 16), LIMN_AT(corner_value_count, 24), LIMN_AT(positions, 32),
                LIMN_AT(position_value_count, 40), LIMN_AT(tolerance, 48), LIMN_AT(max_triangles, 56),
                LIMN_AT(reserved, 60), LIMN_AT(control, 64))
LIMN_PIN_STRUCT(limn_scheme_surface_info, 80, LIMN_AT(struct_size, 0), LIMN_AT(control_count, 4),
                LIMN_AT(vertex_count, 8), LIMN_AT(face_count, 12), LIMN_AT(triangle_count, 16), LIMN_AT(edge_count, 20),
                LIMN_AT(face_offsets, 24), LIMN_AT(face_vertices, 32), LIMN_AT(triangles, 40), LIMN_AT(edges, 48),
                LIMN_AT(level, 56), LIMN_AT(reached, 60), LIMN_AT(tolerance, 64), LIMN_AT(face_levels, 72))

static_assert(LIMN_STENCIL_TANGENT2 == 2 && LIMN_EDITABLE_MESH_JOIN_CREASES == 1 && LIMN_CROWD_NO_RESERVE == 1);
static_assert(LIMN_FACES_TRIANGLES == 2 && LIMN_CORNER_VALUES_ANGLES == 2 && LIMN_SUBDIVISION_SCHEME_DUAL == 1 &&
              LIMN_SUBDIVISION_SCHEME_RECONSTRUCTED == 32);
