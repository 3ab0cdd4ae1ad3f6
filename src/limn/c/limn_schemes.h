// limn for C: all schemes of `limn schemes`, refined, moved to their limit, as triangles. What limn.h says of objects,
// structs and errors holds here, too; limn/schemes/*.h say the rest, limn_vulkan_schemes.h what devices do.
#ifndef LIMN_C_LIMN_SCHEMES_H
#define LIMN_C_LIMN_SCHEMES_H

#include "limn/c/limn.h"

#ifdef __cplusplus
extern "C" {
#endif

// What there is

/// Which faces a scheme takes.
typedef uint32_t limn_face_kind;
enum { LIMN_FACES_POLYGONS = 0, LIMN_FACES_QUADS = 1, LIMN_FACES_TRIANGLES = 2 };

/// What a scheme takes for each corner: nothing, knot intervals of edges, or angles. Where none are given all are 1,
/// and all corners convex.
typedef uint32_t limn_corner_values;
enum { LIMN_CORNER_VALUES_NONE = 0, LIMN_CORNER_VALUES_INTERVALS = 1, LIMN_CORNER_VALUES_ANGLES = 2 };

/// Flags of limn_subdivision_scheme_info.
enum {
    LIMN_SUBDIVISION_SCHEME_DUAL = 1,           ///< vertices become faces
    LIMN_SUBDIVISION_SCHEME_INTERPOLATES = 2,   ///< control points stay where they are
    LIMN_SUBDIVISION_SCHEME_CREASES = 4,        ///< sharp edges and vertices hold; else they are ignored
    LIMN_SUBDIVISION_SCHEME_ADAPTIVE = 8,       ///< limn_scheme_surface_create_adaptive takes it
    LIMN_SUBDIVISION_SCHEME_SAMPLES = 16,       ///< limn_stencil_table_create_scheme_samples takes it
    LIMN_SUBDIVISION_SCHEME_RECONSTRUCTED = 32  ///< rules that could not be compared with the paper's own text
};

/// limn::SubdivisionScheme. Strings are the library's own.
typedef struct limn_subdivision_scheme_info {
    uint32_t struct_size;
    uint32_t flags;
    limn_face_kind faces;
    limn_corner_values corner_values;
    const char* name;  ///< what functions take
    const char* title;
    const char* source;  ///< papers
} limn_subdivision_scheme_info;

uint32_t limn_subdivision_scheme_get_count(void) LIMN_C_NOEXCEPT;
/// As limn_patch_table_get_info, of scheme `index` < limn_subdivision_scheme_get_count.
limn_result limn_subdivision_scheme_get_info(uint32_t index, limn_subdivision_scheme_info* info,
                                             limn_error* error) LIMN_C_NOEXCEPT;

/// limn::corner_intervals: one knot interval for each face corner, from those of edges (pairs of vertices; others have
/// 1).
limn_result limn_control_mesh_get_corner_intervals(const limn_control_mesh* mesh, const uint32_t* edges,
                                                   uint64_t edge_vertex_count, const float* intervals,
                                                   uint64_t interval_count, double* values, uint64_t value_count,
                                                   limn_error* error) LIMN_C_NOEXCEPT;
/// limn::corner_angles: the angle at each face corner, in radians. `positions`: 3 for each vertex.
limn_result limn_control_mesh_get_corner_angles(const limn_control_mesh* mesh, const float* positions,
                                                uint64_t position_value_count, double* values, uint64_t value_count,
                                                limn_error* error) LIMN_C_NOEXCEPT;

// Surfaces: a chain of stencil tables, and triangles

/// limn::SchemeSurface. In what follows the mesh's own scheme does not matter, its options hold where the scheme knows
/// them. LIMN_ERROR_UNSUPPORTED, LIMN_ERROR_NOT_A_TRIANGLE: a mesh that the scheme does not take.
typedef struct limn_scheme_surface limn_scheme_surface;

typedef struct limn_scheme_surface_options {
    uint32_t struct_size;
    uint32_t level;               ///< steps of the scheme; 0: the control mesh, moved to the limit
    const char* scheme;           ///< limn_subdivision_scheme_info::name
    const double* corner_values;  ///< optional: one for each face corner
    uint64_t corner_value_count;
    limn_build_control* control;
} limn_scheme_surface_options;

limn_result limn_scheme_surface_create(const limn_control_mesh* mesh, const limn_scheme_surface_options* options,
                                       limn_scheme_surface** surface, limn_error* error) LIMN_C_NOEXCEPT;

/// limn::AdaptiveSurfaceOptions.
typedef struct limn_adaptive_surface_options {
    uint32_t struct_size;
    uint32_t max_level;  ///< steps of the scheme; 0: 6
    const char* scheme;  ///< as limn_scheme_surface_options, and the next two
    const double* corner_values;
    uint64_t corner_value_count;
    const double* positions;  ///< 3 for each vertex: the pose for which the tolerance holds
    uint64_t position_value_count;
    double tolerance;        ///< by how much faces may miss the limit, in the units of positions
    uint32_t max_triangles;  ///< where the tolerance makes more, a larger one takes its place; 0: no limit
    uint32_t reserved;       ///< 0
    limn_build_control* control;
} limn_adaptive_surface_options;

/// Refined where the surface needs it: limn::build_adaptive_surface.
limn_result limn_scheme_surface_create_adaptive(const limn_control_mesh* mesh,
                                                const limn_adaptive_surface_options* options,
                                                limn_scheme_surface** surface, limn_error* error) LIMN_C_NOEXCEPT;
void limn_scheme_surface_destroy(limn_scheme_surface* surface) LIMN_C_NOEXCEPT;

/// Arrays are the surface's own.
typedef struct limn_scheme_surface_info {
    uint32_t struct_size;
    uint32_t control_count;
    uint32_t vertex_count;
    uint32_t face_count;
    uint32_t triangle_count;
    uint32_t edge_count;            ///< of the control mesh
    const uint32_t* face_offsets;   ///< face_count + 1
    const uint32_t* face_vertices;  ///< of face f entries face_offsets[f] and up, to face_offsets[f + 1]
    const uint32_t* triangles;      ///< 3 vertices each
    const uint32_t* edges;          ///< 2 control points each
    uint32_t level;                 ///< the deepest that faces are of
    uint32_t reached;               ///< 0 where max_level left faces that may miss by more than the tolerance; else 1
    double tolerance;               ///< the one that holds; 0 where the surface is not adaptive
    const uint8_t* face_levels;     ///< of adaptive surfaces, else null
} limn_scheme_surface_info;

/// As limn_patch_table_get_info.
limn_result limn_scheme_surface_get_info(const limn_scheme_surface* surface, limn_scheme_surface_info* info,
                                         limn_error* error) LIMN_C_NOEXCEPT;

/// Control points -> vertices on the limit, 3 floats each, in float. `normals` may be null; unit vectors, (0, 0, 1)
/// where there is no tangent plane.
limn_result limn_scheme_surface_apply(const limn_scheme_surface* surface, const float* points,
                                      uint64_t point_value_count, float* positions, uint64_t position_value_count,
                                      float* normals, uint64_t normal_value_count, limn_error* error) LIMN_C_NOEXCEPT;

// The limit at given places

/// The limit of any scheme that splits faces in four, at samples of any depth: row i is sample i over the control
/// points, with two tangents, tangent1 x tangent2 along the normal. The level of `options` is not used. `statuses`: one
/// for each sample; rows of those that are not valid are empty.
limn_result limn_stencil_table_create_scheme_samples(const limn_control_mesh* mesh,
                                                     const limn_scheme_surface_options* options,
                                                     const limn_patch_sample* samples, uint64_t sample_count,
                                                     limn_sample_status* statuses, uint64_t status_count,
                                                     limn_stencil_table** table, limn_error* error) LIMN_C_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
