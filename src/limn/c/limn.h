// limn for C, and for every language that calls C: control meshes, their tables, and the surface evaluated on the CPU.
//
// Objects are opaque and, but for those of limn_changes.h, immutable: any number of threads may use them at once.
// Tables do not refer to what they were made from. Destroying null does nothing. Nothing is thrown, printed, or kept in
// globals; where host memory is exhausted the program ends.
//
// Functions that can fail return LIMN_SUCCESS or an error's code, of which they say more in `error` where that is not
// null. After an error nothing else has been written, but for null in place of what would have been created.
//
// Structs that begin with struct_size may grow: set it to the size of the struct, and all that is not used to zero,
// which is the default of every member. So programs work with later libraries, and with earlier ones as long as what
// those do not know is zero. Other structs and all values stay as they are.
#ifndef LIMN_C_LIMN_H
#define LIMN_C_LIMN_H

#include <stdint.h>

#ifdef __cplusplus
#define LIMN_C_NOEXCEPT noexcept
extern "C" {
#else
#define LIMN_C_NOEXCEPT
#endif

/// What went wrong: 0, or limn::ErrorCode + 1.
typedef int32_t limn_result;
enum {
    LIMN_SUCCESS = 0,
    LIMN_ERROR_INVALID_ARGUMENT = 1,  ///< null, a length too small, an option outside its range, a struct_size
    LIMN_ERROR_INDEX_OUT_OF_RANGE = 2,
    LIMN_ERROR_FACE_TOO_SMALL = 3,
    LIMN_ERROR_INVALID_SHARPNESS = 4,
    LIMN_ERROR_MISSING_EDGE = 5,
    LIMN_ERROR_NOT_A_TRIANGLE = 6,
    LIMN_ERROR_NOT_FINITE = 7,
    LIMN_ERROR_TOO_LARGE = 8,
    LIMN_ERROR_OUT_OF_MEMORY = 9,
    LIMN_ERROR_CANNOT_OPEN = 10,
    LIMN_ERROR_PARSE_ERROR = 11,
    LIMN_ERROR_NO_DEVICE = 12,
    LIMN_ERROR_VULKAN_FAILURE = 13,
    LIMN_ERROR_UNSUPPORTED = 14,  ///< and what a struct asks for that this library does not know
    LIMN_ERROR_CANCELLED = 15     ///< by a limn_build_control
};

#define LIMN_NO_ELEMENT UINT64_MAX
#define LIMN_MESSAGE_BYTES 240

typedef struct limn_error {
    limn_result code;
    int32_t vk_result;  ///< a VkResult; 0 unless the error came from Vulkan
    uint64_t element;   ///< the face, vertex, crease ... that the message names, or LIMN_NO_ELEMENT
    char message[LIMN_MESSAGE_BYTES];  ///< ends with 0; cut off where it is longer
} limn_error;

typedef uint32_t limn_scheme;
enum { LIMN_SCHEME_CATMULL_CLARK = 0, LIMN_SCHEME_LOOP = 1, LIMN_SCHEME_BILINEAR = 2, LIMN_SCHEME_DOO_SABIN = 3 };

typedef uint32_t limn_boundary_interpolation;
enum { LIMN_BOUNDARY_EDGE_ONLY = 0, LIMN_BOUNDARY_EDGE_AND_CORNER = 1, LIMN_BOUNDARY_NONE = 2 };

typedef uint32_t limn_creasing_method;
enum { LIMN_CREASING_UNIFORM = 0, LIMN_CREASING_CHAIKIN = 1 };

typedef uint32_t limn_triangle_subdivision;
enum { LIMN_TRIANGLES_CATMARK = 0, LIMN_TRIANGLES_SMOOTH = 1 };

typedef uint32_t limn_face_varying_interpolation;
enum {
    LIMN_FACE_VARYING_ALL = 0,
    LIMN_FACE_VARYING_NONE = 1,
    LIMN_FACE_VARYING_CORNERS_ONLY = 2,
    LIMN_FACE_VARYING_CORNERS_PLUS1 = 3,
    LIMN_FACE_VARYING_CORNERS_PLUS2 = 4,
    LIMN_FACE_VARYING_BOUNDARIES = 5
};

typedef uint32_t limn_interpolation;
enum { LIMN_INTERPOLATION_VERTEX = 0, LIMN_INTERPOLATION_VARYING = 1 };

typedef uint32_t limn_end_cap;
enum { LIMN_END_CAP_EXACT = 0, LIMN_END_CAP_GREGORY = 1, LIMN_END_CAP_GREGORY_OPENSUBDIV = 2 };

typedef uint32_t limn_derivatives;
enum { LIMN_DERIVATIVES_NONE = 0, LIMN_DERIVATIVES_FIRST = 1, LIMN_DERIVATIVES_SECOND = 2 };

typedef uint8_t limn_sample_status;
enum { LIMN_SAMPLE_VALID = 0, LIMN_SAMPLE_HOLE = 1, LIMN_SAMPLE_OUT_OF_RANGE = 2 };

// Control meshes

typedef struct limn_control_mesh limn_control_mesh;

typedef struct limn_face_varying_channel {
    const uint32_t* face_values;  ///< one value index per face corner, each < value_count
    uint64_t face_value_count;
    uint32_t value_count;
    limn_face_varying_interpolation interpolation;
} limn_face_varying_channel;

/// Flags of limn_control_mesh_description.
enum {
    LIMN_CONTROL_MESH_LEFT_HANDED = 1,           ///< faces are clockwise
    LIMN_CONTROL_MESH_OPENSUBDIV_COMPATIBLE = 2  ///< OpenSubdiv's results where they depart from the limit of its rules
};

/// limn::ControlMeshDescription. Arrays are read during limn_control_mesh_create only; null where their length is 0.
typedef struct limn_control_mesh_description {
    uint32_t struct_size;
    uint32_t flags;
    limn_scheme scheme;
    limn_boundary_interpolation boundary;
    limn_creasing_method creasing;
    limn_triangle_subdivision triangles;
    uint32_t vertex_count;
    uint32_t channel_count;
    const limn_face_varying_channel* channels;
    const uint32_t* face_sizes;  ///< vertices of each face, 3 or more
    uint64_t face_count;
    const uint32_t* face_vertices;  ///< faces one after the other
    uint64_t face_vertex_count;     ///< the sum of face_sizes
    const uint32_t* crease_sizes;   ///< vertices of each chain; without any every chain is a pair
    uint64_t crease_size_count;
    const uint32_t* crease_vertices;
    uint64_t crease_vertex_count;
    const float* crease_sharpness;  ///< one per chain; 10 is infinite
    uint64_t crease_sharpness_count;
    const uint32_t* corner_vertices;
    const float* corner_sharpness;
    uint64_t corner_count;
    const uint32_t* holes;
    uint64_t hole_count;
    const float* positions;  ///< optional: checked to be finite, not kept
    uint64_t position_value_count;
} limn_control_mesh_description;

limn_result limn_control_mesh_create(const limn_control_mesh_description* description, limn_control_mesh** mesh,
                                     limn_error* error) LIMN_C_NOEXCEPT;
void limn_control_mesh_destroy(limn_control_mesh* mesh) LIMN_C_NOEXCEPT;

// Builds

/// limn::BuildControl: to stop a build and to watch it from other threads. It outlives the builds that it is given to.
typedef struct limn_build_control limn_build_control;
limn_result limn_build_control_create(limn_build_control** control, limn_error* error) LIMN_C_NOEXCEPT;
void limn_build_control_destroy(limn_build_control* control) LIMN_C_NOEXCEPT;
/// The build returns LIMN_ERROR_CANCELLED, as do those that follow until limn_build_control_reset. Null does nothing.
void limn_build_control_cancel(limn_build_control* control) LIMN_C_NOEXCEPT;
void limn_build_control_reset(limn_build_control* control) LIMN_C_NOEXCEPT;
/// From 0 to 1, which a build that succeeds ends with; 0 of null.
float limn_build_control_get_progress(const limn_build_control* control) LIMN_C_NOEXCEPT;

/// limn::AsyncBuild: a build that goes on beside its caller. One thread owns it; any may cancel and watch it.
typedef struct limn_async_build limn_async_build;

/// Builds what it likes with `control` in its options, and returns how that went: what the last function it called did,
/// say, which has written the error, too.
typedef limn_result (*limn_build_function)(void* user, limn_build_control* control, limn_error* error);

/// The caller's threads: `submit` gets a job and has job(data) called once, on any thread, now or later.
typedef struct limn_job_system {
    void* user;
    void (*submit)(void* user, void (*job)(void* data), void* data);
} limn_job_system;

/// `jobs` null: on a thread of its own. What `build` refers to outlives the object. LIMN_ERROR_OUT_OF_MEMORY where the
/// system has no thread left.
limn_result limn_async_build_start(limn_build_function build, void* user, const limn_job_system* jobs,
                                   limn_async_build** started, limn_error* error) LIMN_C_NOEXCEPT;
void limn_async_build_cancel(limn_async_build* build) LIMN_C_NOEXCEPT;                      ///< null does nothing
float limn_async_build_get_progress(const limn_async_build* build) LIMN_C_NOEXCEPT;         ///< 0 of null
uint32_t limn_async_build_is_ready(const limn_async_build* build) LIMN_C_NOEXCEPT;          ///< 0 or 1; 0 of null
/// Waits where it is not ready, and returns what `build` did: LIMN_ERROR_CANCELLED where it was cancelled before it began.
limn_result limn_async_build_wait(limn_async_build* build, limn_error* error) LIMN_C_NOEXCEPT;
/// Cancels, and waits until the build has stopped.
void limn_async_build_destroy(limn_async_build* build) LIMN_C_NOEXCEPT;

// The limit surface

typedef struct limn_plan_cache limn_plan_cache;
typedef struct limn_patch_table limn_patch_table;

/// Plans already built, for any number of meshes and threads. It is the one object here that changes.
limn_result limn_plan_cache_create(limn_plan_cache** cache, limn_error* error) LIMN_C_NOEXCEPT;
void limn_plan_cache_destroy(limn_plan_cache* cache) LIMN_C_NOEXCEPT;

typedef struct limn_patch_table_options {
    uint32_t struct_size;
    limn_interpolation interpolation;
    uint32_t plan_depth;  ///< 1 to 10; 0: 3
    limn_end_cap end_cap;
    uint32_t isolation_level;  ///< of Gregory end caps, 1 to 10; 0: 10
    uint32_t reserved;         ///< 0
    limn_build_control* control;  ///< may be null
} limn_patch_table_options;

/// The limit surface of vertex or varying data. `options` and `cache` may be null.
limn_result limn_patch_table_create(const limn_control_mesh* mesh, const limn_patch_table_options* options,
                                    limn_plan_cache* cache, limn_patch_table** table, limn_error* error) LIMN_C_NOEXCEPT;
/// Of one face-varying channel, in the channel's values.
limn_result limn_patch_table_create_channel(const limn_control_mesh* mesh, uint32_t channel,
                                            const limn_patch_table_options* options, limn_plan_cache* cache,
                                            limn_patch_table** table, limn_error* error) LIMN_C_NOEXCEPT;
void limn_patch_table_destroy(limn_patch_table* table) LIMN_C_NOEXCEPT;

/// Points are the control points and, from first_refined on, those of level 1 that surfaces need.
typedef struct limn_patch_table_info {
    uint32_t struct_size;
    uint32_t control_count;
    uint32_t first_refined;
    uint32_t point_count;
    uint32_t ptex_face_count;
    uint32_t surface_count;
    uint32_t plan_count;
    limn_scheme scheme;
    uint64_t bytes;
} limn_patch_table_info;

/// Fills as much of `info` as its struct_size says.
limn_result limn_patch_table_get_info(const limn_patch_table* table, limn_patch_table_info* info, limn_error* error) LIMN_C_NOEXCEPT;

/// Control points -> control points and level-1 points: control_count * width values -> point_count * width.
limn_result limn_patch_table_build_points(const limn_patch_table* table, const double* control_values,
                                          uint64_t control_value_count, uint32_t width, double* values,
                                          uint64_t value_count, limn_error* error) LIMN_C_NOEXCEPT;

/// limn::PatchSample.
typedef struct limn_patch_sample {
    uint32_t face;  ///< ptex face
    uint32_t padding;
    double u, v;
} limn_patch_sample;

typedef struct limn_patch_evaluation {
    uint32_t struct_size;
    uint32_t width;  ///< values per point; 0: 3
    limn_derivatives derivatives;
    uint32_t flags;  ///< 0
    const limn_patch_sample* samples;
    uint64_t sample_count;
    const double* points;  ///< limn_patch_table_build_points
    uint64_t point_value_count;
    double* results;  ///< as limn::evaluate_patches: sample_count * (1, 3 or 6) * width
    uint64_t result_value_count;
    limn_sample_status* statuses;  ///< one per sample
    uint64_t status_count;
} limn_patch_evaluation;

limn_result limn_patch_table_evaluate(const limn_patch_table* table, const limn_patch_evaluation* evaluation,
                                      limn_error* error) LIMN_C_NOEXCEPT;

/// limn::Curvature.
typedef struct limn_curvature {
    double gaussian;
    double mean;
    double first;  ///< the principal curvatures, first >= second
    double second;
    double first_direction[3];
    double second_direction[3];
} limn_curvature;

/// The curvature at each sample from its results of LIMN_DERIVATIVES_SECOND; width 3 or, homogeneous, 4:
/// limn::evaluate_curvature.
limn_result limn_evaluate_curvature(const double* results, uint64_t result_value_count, uint32_t width,
                                    limn_curvature* curvatures, uint64_t curvature_count,
                                    limn_error* error) LIMN_C_NOEXCEPT;

/// The tables of many meshes as one: limn::merge_patch_tables. Control points follow each other in their order.
limn_result limn_patch_table_create_merged(const limn_patch_table* const* tables, uint64_t table_count,
                                           limn_patch_table** table, limn_error* error) LIMN_C_NOEXCEPT;

// What devices take beside patch tables

typedef struct limn_patch_trees limn_patch_trees;

/// Flags of limn_patch_trees_options.
enum { LIMN_PATCH_TREES_RELATIVE = 1 };  ///< for samples; not for tessellation

typedef struct limn_patch_trees_options {
    uint32_t struct_size;
    uint32_t flags;
    uint32_t max_rate;          ///< 2 to 128; 0: 64
    uint32_t points_per_pass;   ///< 0: 2^22
    uint64_t max_weight_bytes;  ///< 0: 2^28
    limn_build_control* control;
} limn_patch_trees_options;

/// `options` may be null.
limn_result limn_patch_trees_create(const limn_patch_table* table, const limn_patch_trees_options* options,
                                    limn_patch_trees** trees, limn_error* error) LIMN_C_NOEXCEPT;
void limn_patch_trees_destroy(limn_patch_trees* trees) LIMN_C_NOEXCEPT;

typedef struct limn_tessellation_table limn_tessellation_table;

/// Flags of limn_tessellation_table_options.
enum { LIMN_TESSELLATION_TABLE_JOIN_CREASES = 1 };  ///< one vertex, and one normal, along infinitely sharp creases

typedef struct limn_tessellation_table_options {
    uint32_t struct_size;
    uint32_t flags;
    const uint32_t* channels;  ///< face-varying channels whose seams split vertices
    uint64_t channel_count;
    limn_build_control* control;
} limn_tessellation_table_options;

/// `options` may be null.
limn_result limn_tessellation_table_create(const limn_control_mesh* mesh, const limn_tessellation_table_options* options,
                                           limn_tessellation_table** table, limn_error* error) LIMN_C_NOEXCEPT;
/// In the order of limn_patch_table_create_merged; each table is an instance.
limn_result limn_tessellation_table_create_merged(const limn_tessellation_table* const* tables, uint64_t table_count,
                                                  limn_tessellation_table** table, limn_error* error) LIMN_C_NOEXCEPT;
void limn_tessellation_table_destroy(limn_tessellation_table* table) LIMN_C_NOEXCEPT;

typedef struct limn_tessellation_table_info {
    uint32_t struct_size;
    uint32_t face_count;       ///< ptex faces
    uint32_t rate_edge_count;  ///< edges of the control mesh, then sub-face edges
    uint32_t mesh_edge_count;  ///< the former
    uint32_t row_count;
    uint32_t corner_count;
    uint32_t instance_count;
    uint32_t reserved;
    uint64_t bytes;
} limn_tessellation_table_info;

/// As limn_patch_table_get_info.
limn_result limn_tessellation_table_get_info(const limn_tessellation_table* table, limn_tessellation_table_info* info,
                                             limn_error* error) LIMN_C_NOEXCEPT;

typedef struct limn_grid_table limn_grid_table;

/// Flags of limn_grid_table_options.
enum { LIMN_GRID_TABLE_POINTS_ONLY = 1 };  ///< no weights of derivatives: no normals, du or dv

typedef struct limn_grid_table_options {
    uint32_t struct_size;
    uint32_t flags;
    uint32_t rate;              ///< intervals along each side of a ptex face, 1 to 256; 0: 8
    uint32_t samples_per_pass;  ///< 0: 2^22
    uint64_t max_weight_bytes;  ///< 0: 2^28
    limn_build_control* control;
} limn_grid_table_options;

/// limn::build_grid_table. `options` may be null.
limn_result limn_grid_table_create(const limn_patch_table* table, const limn_grid_table_options* options,
                                   limn_grid_table** grid, limn_error* error) LIMN_C_NOEXCEPT;
void limn_grid_table_destroy(limn_grid_table* grid) LIMN_C_NOEXCEPT;
/// ptex faces * samples of a face, which GridTable numbers; 0 of null.
uint64_t limn_grid_table_get_sample_count(const limn_grid_table* grid) LIMN_C_NOEXCEPT;

typedef struct limn_stencil_table limn_stencil_table;

/// Flags of limn_stencil_table_options.
enum {
    LIMN_STENCIL_TABLE_LIMIT = 1,    ///< limits of the level's vertices
    LIMN_STENCIL_TABLE_TANGENTS = 2  ///< and two tangents each
};

typedef struct limn_stencil_table_options {
    uint32_t struct_size;
    uint32_t flags;
    uint32_t level;  ///< of uniform refinement, 0 to 10
    limn_interpolation interpolation;
    limn_build_control* control;
} limn_stencil_table_options;

/// Rows over the control points for each vertex of a level: limn::build_stencil_table, build_limit_table.
limn_result limn_stencil_table_create(const limn_control_mesh* mesh, const limn_stencil_table_options* options,
                                      limn_stencil_table** table, limn_error* error) LIMN_C_NOEXCEPT;
void limn_stencil_table_destroy(limn_stencil_table* table) LIMN_C_NOEXCEPT;
uint32_t limn_stencil_table_get_row_count(const limn_stencil_table* table) LIMN_C_NOEXCEPT;  ///< 0 of null

typedef uint32_t limn_stencil_weights;
enum { LIMN_STENCIL_POINTS = 0, LIMN_STENCIL_TANGENT1 = 1, LIMN_STENCIL_TANGENT2 = 2 };

/// On the CPU, in float: width values for each row, from as many for each point that rows are over. Tangents only of
/// tables that have some.
limn_result limn_stencil_table_apply(const limn_stencil_table* table, limn_stencil_weights weights, const float* source,
                                     uint64_t source_value_count, uint32_t width, float* values, uint64_t value_count,
                                     limn_error* error) LIMN_C_NOEXCEPT;

typedef struct limn_refined_grid_table limn_refined_grid_table;

typedef struct limn_refined_grid_table_options {
    uint32_t struct_size;
    uint32_t level;  ///< of uniform refinement, 1 to 7; 0: 4
    limn_interpolation interpolation;
    uint32_t reserved;          ///< 0
    uint64_t max_weight_bytes;  ///< 0: 2^28
    limn_build_control* control;
} limn_refined_grid_table_options;

/// The points of a level without a row for each: limn::build_refined_grid_table. `options` may be null.
limn_result limn_refined_grid_table_create(const limn_control_mesh* mesh, const limn_refined_grid_table_options* options,
                                           limn_refined_grid_table** table, limn_error* error) LIMN_C_NOEXCEPT;
/// Of one face-varying channel, from the channel's values.
limn_result limn_refined_grid_table_create_channel(const limn_control_mesh* mesh, uint32_t channel,
                                                   const limn_refined_grid_table_options* options,
                                                   limn_refined_grid_table** table, limn_error* error) LIMN_C_NOEXCEPT;
void limn_refined_grid_table_destroy(limn_refined_grid_table* table) LIMN_C_NOEXCEPT;
uint32_t limn_refined_grid_table_get_point_count(const limn_refined_grid_table* table) LIMN_C_NOEXCEPT;  ///< 0 of null

// Tessellation on the CPU (limn/tessellate.h)

/// What the value beside it is.
typedef uint32_t limn_rate_mode;
enum {
    LIMN_RATE_UNIFORM = 0,        ///< the rate of all edges
    LIMN_RATE_PER_EDGE = 1,       ///< not used: the caller gives a rate for each rate edge
    LIMN_RATE_SCREEN_LENGTH = 2,  ///< how long a segment should be on screen, in pixels
    LIMN_RATE_PIXEL_ERROR = 3,    ///< by how many pixels a chord may miss the surface
    LIMN_RATE_CHORD_ERROR = 4,    ///< by what length a chord may miss the surface
    LIMN_RATE_DISTANCE = 5        ///< the distance (clip w) at which the rate is 1
};

typedef uint32_t limn_tessellation_spacing;
enum { LIMN_SPACING_INTEGER = 0, LIMN_SPACING_POWER_OF_TWO = 1, LIMN_SPACING_FRACTIONAL = 2 };

typedef struct limn_tessellation_options {
    uint32_t struct_size;
    limn_rate_mode mode;
    limn_tessellation_spacing spacing;
    uint32_t max_rate;        ///< 2 to 128; 0: 64
    const float* edge_rates;  ///< of LIMN_RATE_PER_EDGE: limn_tessellation_table_info::rate_edge_count of them
    uint64_t edge_rate_count;
    float value;       ///< 0: 8
    float scale;       ///< rates are multiplied by it before they are rounded; 0: 1
    float matrix[16];  ///< column-major, to Vulkan's clip space; of modes that look through a camera
    float width;       ///< of the viewport, in pixels
    float height;
} limn_tessellation_options;

/// Vertices, as places of the surface, and triangles.
typedef struct limn_tessellation limn_tessellation;

/// Of tables of one mesh. `points`: limn_patch_table_build_points, width 3. `options` may be null.
limn_result limn_tessellation_create(const limn_patch_table* patches, const limn_tessellation_table* table,
                                     const double* points, uint64_t point_value_count,
                                     const limn_tessellation_options* options, limn_tessellation** tessellation,
                                     limn_error* error) LIMN_C_NOEXCEPT;
void limn_tessellation_destroy(limn_tessellation* tessellation) LIMN_C_NOEXCEPT;

/// Arrays are the tessellation's own.
typedef struct limn_tessellation_info {
    uint32_t struct_size;
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t reserved;
    const limn_patch_sample* places;   ///< of each vertex
    const uint32_t* position_sources;  ///< of each vertex: whose position it has
    const uint32_t* indices;           ///< 3 for each triangle
    const uint32_t* triangle_faces;    ///< the ptex face of each triangle
} limn_tessellation_info;

/// As limn_patch_table_get_info.
limn_result limn_tessellation_get_info(const limn_tessellation* tessellation, limn_tessellation_info* info,
                                       limn_error* error) LIMN_C_NOEXCEPT;

typedef struct limn_tessellation_evaluation {
    uint32_t struct_size;
    uint32_t flags;        ///< 0
    const double* points;  ///< of limn_tessellation_create, or those of another frame
    uint64_t point_value_count;
    double* positions;  ///< 3 for each vertex
    uint64_t position_value_count;
    double* normals;  ///< optional: 3 for each vertex, unit vectors
    uint64_t normal_value_count;
    /// Optional: 3 for each vertex, the height along the normal and its derivatives by u and v of the ptex face; normals
    /// are there then.
    const double* heights;
    uint64_t height_value_count;
    double height_step;  ///< limn::displace_tessellation; 0: that of devices for rates up to 64
} limn_tessellation_evaluation;

limn_result limn_tessellation_evaluate(const limn_tessellation* tessellation, const limn_patch_table* patches,
                                       const limn_tessellation_evaluation* evaluation, limn_error* error) LIMN_C_NOEXCEPT;
/// Values of a face-varying channel, width for each vertex. `points`: of the channel's table, as wide.
limn_result limn_tessellation_evaluate_channel(const limn_tessellation* tessellation, const limn_patch_table* channel,
                                               const double* points, uint64_t point_value_count, uint32_t width,
                                               double* values, uint64_t value_count, limn_error* error) LIMN_C_NOEXCEPT;

// Baked files: all of it made ahead of time, mapped and pointed into (limn/baked_file.h).

typedef struct limn_baked_channel {
    const float* values;  ///< value_count * width floats, width 1 to 4
    uint64_t value_count;
} limn_baked_channel;

/// Flags of limn_bake_options.
enum {
    LIMN_BAKE_JOIN_CREASES = 1,  ///< as LIMN_TESSELLATION_TABLE_JOIN_CREASES
    LIMN_BAKE_NO_TREES = 2       ///< for the CPU alone: devices tessellate by trees
};

typedef struct limn_bake_options {
    uint32_t struct_size;
    uint32_t flags;
    uint32_t max_rate;                        ///< as limn_patch_trees_options; 0: 64
    uint32_t channel_count;                   ///< that are baked, of the mesh's first ones
    const limn_patch_table_options* patches;  ///< may be null
    const limn_baked_channel* channels;
} limn_bake_options;

/// Builds patches, trees and tessellation tables, and writes them with the description's positions; `path` should end in
/// .limn. `options` may be null.
limn_result limn_baked_file_write(const char* path, const limn_control_mesh_description* description,
                                  const limn_bake_options* options, limn_error* error) LIMN_C_NOEXCEPT;

typedef struct limn_baked_file limn_baked_file;

/// Flags of limn_baked_file_open and limn_baked_file_load_or_bake.
enum {
    LIMN_BAKED_FILE_TRUSTED = 1,  ///< not checked: one that was damaged or made to do harm then does
    LIMN_BAKED_FILE_READ = 2      ///< read into memory rather than mapped
};

limn_result limn_baked_file_open(const char* path, uint32_t flags, limn_baked_file** file,
                                 limn_error* error) LIMN_C_NOEXCEPT;
/// The file of these in a folder of such files, baked and written first where it is not there: limn::load_or_bake.
/// `options` may be null.
limn_result limn_baked_file_load_or_bake(const char* folder, const limn_control_mesh_description* description,
                                         const limn_bake_options* options, uint32_t flags, limn_baked_file** file,
                                         limn_error* error) LIMN_C_NOEXCEPT;
void limn_baked_file_destroy(limn_baked_file* file) LIMN_C_NOEXCEPT;

// What a file holds: as long as the file is open, and not to be destroyed. Null of null, and past the last channel.
const limn_patch_table* limn_baked_file_get_patches(const limn_baked_file* file) LIMN_C_NOEXCEPT;
const limn_patch_trees* limn_baked_file_get_trees(const limn_baked_file* file) LIMN_C_NOEXCEPT;
const limn_tessellation_table* limn_baked_file_get_tessellation(const limn_baked_file* file) LIMN_C_NOEXCEPT;
const limn_patch_table* limn_baked_file_get_channel_patches(const limn_baked_file* file,
                                                            uint32_t channel) LIMN_C_NOEXCEPT;
const limn_patch_trees* limn_baked_file_get_channel_trees(const limn_baked_file* file,
                                                          uint32_t channel) LIMN_C_NOEXCEPT;
/// 3 for each control point. `value_count` may be null.
const float* limn_baked_file_get_positions(const limn_baked_file* file, uint64_t* value_count) LIMN_C_NOEXCEPT;
const float* limn_baked_file_get_channel_values(const limn_baked_file* file, uint32_t channel,
                                                uint64_t* value_count) LIMN_C_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
