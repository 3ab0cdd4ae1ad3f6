// limn for C, on Vulkan: tables uploaded once per topology, evaluations and tessellations recorded into the caller's
// command buffers. What limn.h says of objects, structs and errors holds here, too; limn/vulkan/*.h say the rest.
//
// Objects outlive what is made from them: a context everything, tables and evaluators what is prepared with them. What the
// device may still be reading is not destroyed.
#ifndef LIMN_C_LIMN_VULKAN_H
#define LIMN_C_LIMN_VULKAN_H

#include <vulkan/vulkan_core.h>

#include "limn/c/limn.h"

#ifdef __cplusplus
extern "C" {
#endif

// Contexts

typedef struct limn_vk_context limn_vk_context;

typedef uint32_t limn_vk_memory_use;
enum {
    LIMN_VK_MEMORY_DEVICE = 0,   ///< kernels read and write it
    LIMN_VK_MEMORY_UPLOAD = 1,   ///< the host writes, the device reads; mapped and coherent
    LIMN_VK_MEMORY_READBACK = 2  ///< the device writes, the host reads; mapped and coherent
};

typedef struct limn_vk_memory_block {
    VkDeviceMemory memory;
    VkDeviceSize offset;
    void* mapped;  ///< what the host sees; of LIMN_VK_MEMORY_DEVICE may be null. Mapped memory is coherent
    void* user;    ///< the allocator's own
} limn_vk_memory_block;

/// Called from the thread that calls limn. Both functions or none.
typedef struct limn_vk_allocator {
    void* user;
    VkResult (*allocate)(void* user, const VkMemoryRequirements* requirements, limn_vk_memory_use use,
                         limn_vk_memory_block* block);
    void (*free)(void* user, const limn_vk_memory_block* block);
} limn_vk_allocator;

/// The caller's device, of Vulkan 1.2 or later; no feature or extension is needed. None of it is destroyed.
typedef struct limn_vk_borrowed_handles {
    uint32_t struct_size;
    uint32_t queue_family_index;  ///< of the command buffers that will be recorded into; supports compute
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    VkPipelineCache pipeline_cache;  ///< optional, as the rest
    limn_vk_allocator allocator;     ///< without its functions every buffer has memory of its own
    PFN_vkGetDeviceProcAddr get_device_proc_addr;  ///< null: what the instance gives
    const VkAllocationCallbacks* host_allocator;   ///< of every Vulkan object; outlives the context
} limn_vk_borrowed_handles;

limn_result limn_vk_context_borrow(const limn_vk_borrowed_handles* handles, limn_vk_context** context,
                                   limn_error* error) LIMN_C_NOEXCEPT;

typedef struct limn_vk_device_description {
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    VkPhysicalDeviceType type;
    uint32_t api_version;
    uint32_t driver_version;
    uint32_t usable;  ///< 0 or 1: Vulkan 1.2 and a compute queue
} limn_vk_device_description;

/// Writes the first `capacity` devices, as `limn devices` counts them, and to `count` how many there are. LIMN_ERROR_NO_DEVICE
/// where there is none, nor a Vulkan loader.
limn_result limn_vk_list_devices(limn_vk_device_description* devices, uint32_t capacity, uint32_t* count,
                                 limn_error* error) LIMN_C_NOEXCEPT;

typedef uint32_t limn_vk_device_choice;
enum {
    LIMN_VK_DEVICE_AUTOMATIC = 0,  ///< the first discrete GPU, else an integrated one, else any
    LIMN_VK_DEVICE_CPU = 1,
    LIMN_VK_DEVICE_INDEX = 2  ///< device_index, as `limn devices` counts
};

/// Flags of limn_vk_context_options.
enum { LIMN_VK_CONTEXT_VALIDATION = 1 };  ///< VK_LAYER_KHRONOS_validation with synchronization validation

typedef struct limn_vk_context_options {
    uint32_t struct_size;
    uint32_t flags;
    limn_vk_device_choice device;
    uint32_t device_index;
} limn_vk_context_options;

/// A headless instance and device of limn's own. `options` may be null.
limn_result limn_vk_context_create(const limn_vk_context_options* options, limn_vk_context** context,
                                   limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_context_destroy(limn_vk_context* context) LIMN_C_NOEXCEPT;

typedef struct limn_vk_context_info {
    uint32_t struct_size;
    uint32_t queue_family_index;
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    VkQueue queue;  ///< null of a borrowed device
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    uint32_t validation_message_count;  ///< errors and warnings so far; 0 without validation
    uint32_t reserved;
    char device_name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
} limn_vk_context_info;

/// Fills as much of `info` as its struct_size says.
limn_result limn_vk_context_get_info(const limn_vk_context* context, limn_vk_context_info* info,
                                     limn_error* error) LIMN_C_NOEXCEPT;

// Barriers: limn puts them between its own passes, and none around what it records.

typedef struct limn_vk_stage_access {
    VkPipelineStageFlags stages;
    VkAccessFlags access;
} limn_vk_stage_access;

#define LIMN_VK_KERNEL_STAGE VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT
#define LIMN_VK_KERNEL_READS VK_ACCESS_SHADER_READ_BIT
#define LIMN_VK_KERNEL_WRITES VK_ACCESS_SHADER_WRITE_BIT
/// Of vkCmdDrawIndexedIndirect, which reads a command, indices and vertices.
#define LIMN_VK_DRAW_STAGES (VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_VERTEX_INPUT_BIT)
#define LIMN_VK_DRAW_READS \
    (VK_ACCESS_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT)

/// What buffers that limn reads are created with, at least. Those that it only writes need STORAGE_BUFFER alone.
#define LIMN_VK_SOURCE_USAGE (VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT)

/// One global memory barrier. Does nothing where `context` or `commands` is null.
void limn_vk_record_barrier(const limn_vk_context* context, VkCommandBuffer commands, limn_vk_stage_access before,
                            limn_vk_stage_access after) LIMN_C_NOEXCEPT;

// Tables

/// Uploads recorded into one command buffer, and the staging memory that they are read from: destroyed once the commands
/// have completed, or will never be submitted. Barriers to kernel reads are recorded, too.
typedef struct limn_vk_upload limn_vk_upload;
limn_result limn_vk_upload_create(const limn_vk_context* context, VkCommandBuffer commands, limn_vk_upload** upload,
                                  limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_upload_destroy(limn_vk_upload* upload) LIMN_C_NOEXCEPT;

typedef struct limn_vk_patch_table limn_vk_patch_table;
typedef struct limn_vk_patch_trees limn_vk_patch_trees;
typedef struct limn_vk_tessellation_table limn_vk_tessellation_table;
typedef struct limn_vk_grid_table limn_vk_grid_table;
typedef struct limn_vk_stencil_table limn_vk_stencil_table;
typedef struct limn_vk_refined_grid limn_vk_refined_grid;

limn_result limn_vk_patch_table_create(limn_vk_upload* upload, const limn_patch_table* from, limn_vk_patch_table** table,
                                       limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_patch_table_destroy(limn_vk_patch_table* table) LIMN_C_NOEXCEPT;

/// For samples: trees with LIMN_PATCH_TREES_RELATIVE.
limn_result limn_vk_patch_trees_create(limn_vk_upload* upload, const limn_patch_trees* from, limn_vk_patch_trees** trees,
                                       limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_patch_trees_destroy(limn_vk_patch_trees* trees) LIMN_C_NOEXCEPT;
uint32_t limn_vk_patch_trees_get_local_count(const limn_vk_patch_trees* trees) LIMN_C_NOEXCEPT;  ///< 0 of null

/// `vertices`: trees of the surface; `channels`: of channel_count face-varying channels. All of one control mesh.
limn_result limn_vk_tessellation_table_create(limn_vk_upload* upload, const limn_tessellation_table* from,
                                              const limn_patch_trees* vertices, const limn_patch_trees* const* channels,
                                              uint64_t channel_count, limn_vk_tessellation_table** table,
                                              limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_tessellation_table_destroy(limn_vk_tessellation_table* table) LIMN_C_NOEXCEPT;

limn_result limn_vk_grid_table_create(limn_vk_upload* upload, const limn_grid_table* from, limn_vk_grid_table** table,
                                      limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_grid_table_destroy(limn_vk_grid_table* table) LIMN_C_NOEXCEPT;

limn_result limn_vk_stencil_table_create(limn_vk_upload* upload, const limn_stencil_table* from,
                                         limn_vk_stencil_table** table, limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_stencil_table_destroy(limn_vk_stencil_table* table) LIMN_C_NOEXCEPT;

limn_result limn_vk_refined_grid_create(limn_vk_upload* upload, const limn_refined_grid_table* from,
                                        limn_vk_refined_grid** grid, limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_refined_grid_destroy(limn_vk_refined_grid* grid) LIMN_C_NOEXCEPT;

// Evaluations

/// Component i of point p is the float, or word, at byte offset_bytes + 4 * (first + p * stride + i).
typedef struct limn_vk_points {
    VkBuffer buffer;
    VkDeviceSize offset_bytes;  ///< a multiple of 4
    uint64_t first;
    uint32_t stride;  ///< 0: points lie next to each other
    uint32_t reserved;  ///< 0
} limn_vk_points;

/// Pipelines that make points: stencils, level-1 points, grids, samples.
typedef struct limn_vk_evaluator limn_vk_evaluator;
limn_result limn_vk_evaluator_create(const limn_vk_context* context, limn_vk_evaluator** evaluator,
                                     limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_evaluator_destroy(limn_vk_evaluator* evaluator) LIMN_C_NOEXCEPT;

/// Prepared once, recorded as often as wanted: no submit, no wait, no allocation, no read-back, no barrier; outside a
/// render pass. Before: what it reads is visible to kernel reads, earlier uses of what it writes are done. Owed after: a
/// barrier from kernel writes. The compute pipeline, compute descriptor set 0 and push constants are disturbed.
typedef struct limn_vk_evaluation limn_vk_evaluation;
/// Does nothing where one of them is null.
void limn_vk_evaluation_record(const limn_vk_evaluation* evaluation, VkCommandBuffer commands) LIMN_C_NOEXCEPT;
void limn_vk_evaluation_destroy(limn_vk_evaluation* evaluation) LIMN_C_NOEXCEPT;

/// The level-1 points behind the control points: limn::vk::SurfacePointsInfo.
typedef struct limn_vk_points_info {
    uint32_t struct_size;
    uint32_t width;  ///< floats per point; 0: 3
    const limn_vk_patch_table* patches;
    limn_vk_points points;  ///< limn_patch_table_info::point_count of them; LIMN_VK_SOURCE_USAGE
} limn_vk_points_info;
limn_result limn_vk_evaluator_prepare_points(const limn_vk_evaluator* evaluator, const limn_vk_points_info* info,
                                             limn_vk_evaluation** evaluation, limn_error* error) LIMN_C_NOEXCEPT;

/// Rows of a stencil table: limn::vk::StencilEvaluationInfo.
typedef struct limn_vk_stencils_info {
    uint32_t struct_size;
    uint32_t width;  ///< floats per point; 0: 3
    const limn_vk_stencil_table* table;
    limn_vk_points source;       ///< LIMN_VK_SOURCE_USAGE
    limn_vk_points destination;  ///< a point for each row
    limn_vk_points tangent1;     ///< optional: a null buffer
    limn_vk_points tangent2;
    uint32_t first_row;
    uint32_t row_count;  ///< 0: to the last
} limn_vk_stencils_info;
limn_result limn_vk_evaluator_prepare_stencils(const limn_vk_evaluator* evaluator, const limn_vk_stencils_info* info,
                                               limn_vk_evaluation** evaluation, limn_error* error) LIMN_C_NOEXCEPT;

/// limn::vk::GridEvaluationInfo.
typedef struct limn_vk_grid_info {
    uint32_t struct_size;
    uint32_t width;  ///< 1 to 4; 0: 3
    const limn_vk_patch_table* patches;
    const limn_vk_grid_table* grid;
    limn_vk_points points;   ///< of limn_vk_points_info, evaluated before
    limn_vk_points values;   ///< limn_grid_table_get_sample_count points
    limn_vk_points normals;  ///< optional: a null buffer; width 3
    limn_vk_points du;       ///< optional: both or none, and no normals
    limn_vk_points dv;
    uint32_t packed_normals;  ///< not 0: normals are one word each, octahedral (limn/shared/octahedral.h)
    uint32_t reserved;        ///< 0
} limn_vk_grid_info;
limn_result limn_vk_evaluator_prepare_grid(const limn_vk_evaluator* evaluator, const limn_vk_grid_info* info,
                                           limn_vk_evaluation** evaluation, limn_error* error) LIMN_C_NOEXCEPT;

/// limn::vk::LocalPointsInfo: before samples with trees, and a barrier in between.
typedef struct limn_vk_local_points_info {
    uint32_t struct_size;
    uint32_t width;  ///< 1 to 4; 0: 3
    const limn_vk_patch_table* patches;
    const limn_vk_patch_trees* trees;
    limn_vk_points points;
    VkBuffer local_points;  ///< 16 bytes for each local point, and 16 at least; LIMN_VK_SOURCE_USAGE
} limn_vk_local_points_info;
limn_result limn_vk_evaluator_prepare_local_points(const limn_vk_evaluator* evaluator,
                                                   const limn_vk_local_points_info* info,
                                                   limn_vk_evaluation** evaluation, limn_error* error) LIMN_C_NOEXCEPT;

/// limn::vk::PatchEvaluationInfo.
typedef struct limn_vk_samples_info {
    uint32_t struct_size;
    uint32_t width;  ///< 1 to 4; 0: 3
    const limn_vk_patch_table* patches;
    limn_derivatives derivatives;
    uint32_t sample_count;
    limn_vk_points points;
    VkBuffer samples;  ///< 12 bytes each: ptex face (uint32), u, v (floats); LIMN_VK_SOURCE_USAGE
    VkDeviceSize samples_offset_bytes;
    limn_vk_points results;   ///< (1, 3 or 6) * width floats for each sample
    limn_vk_points statuses;  ///< optional: a word for each sample, next to each other
    const limn_vk_patch_trees* trees;  ///< optional, both or none
    VkBuffer local_points;
} limn_vk_samples_info;
limn_result limn_vk_evaluator_prepare_samples(const limn_vk_evaluator* evaluator, const limn_vk_samples_info* info,
                                              limn_vk_evaluation** evaluation, limn_error* error) LIMN_C_NOEXCEPT;

/// Where samples are: limn::vk::LocationInfo.
typedef struct limn_vk_locations_info {
    uint32_t struct_size;
    uint32_t sample_count;
    const limn_vk_patch_table* patches;
    VkBuffer samples;  ///< as limn_vk_samples_info
    VkDeviceSize samples_offset_bytes;
    limn_vk_points places;    ///< 5 words for each sample: surface, plan, node, u and v (floats)
    limn_vk_points statuses;  ///< as limn_vk_samples_info
} limn_vk_locations_info;
limn_result limn_vk_evaluator_prepare_locations(const limn_vk_evaluator* evaluator, const limn_vk_locations_info* info,
                                                limn_vk_evaluation** evaluation, limn_error* error) LIMN_C_NOEXCEPT;

/// limn::vk::RefinedGridInfo.
typedef struct limn_vk_refined_info {
    uint32_t struct_size;
    uint32_t width;  ///< 1 to 4; 0: 3
    const limn_vk_refined_grid* grid;
    limn_vk_points source;   ///< control points; LIMN_VK_SOURCE_USAGE
    limn_vk_points refined;  ///< limn_refined_grid_table_get_point_count points
} limn_vk_refined_info;
limn_result limn_vk_evaluator_prepare_refined(const limn_vk_evaluator* evaluator, const limn_vk_refined_info* info,
                                              limn_vk_evaluation** evaluation, limn_error* error) LIMN_C_NOEXCEPT;

/// Pipelines that make curvatures.
typedef struct limn_vk_curvature_evaluator limn_vk_curvature_evaluator;
limn_result limn_vk_curvature_evaluator_create(const limn_vk_context* context, limn_vk_curvature_evaluator** evaluator,
                                               limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_curvature_evaluator_destroy(limn_vk_curvature_evaluator* evaluator) LIMN_C_NOEXCEPT;

/// limn::vk::CurvatureInfo: behind samples of LIMN_DERIVATIVES_SECOND, a barrier in between.
typedef struct limn_vk_curvature_info {
    uint32_t struct_size;
    uint32_t width;  ///< 3 or, homogeneous, 4; 0: 3
    uint32_t sample_count;
    uint32_t reserved;          ///< 0
    limn_vk_points values;      ///< limn_vk_samples_info::results
    limn_vk_points curvatures;  ///< 10 floats for each sample, as limn_curvature
    limn_vk_points quotients;   ///< optional, of width 4: 18 floats for each sample, the values divided
} limn_vk_curvature_info;
limn_result limn_vk_curvature_evaluator_prepare(const limn_vk_curvature_evaluator* evaluator,
                                                const limn_vk_curvature_info* info, limn_vk_evaluation** evaluation,
                                                limn_error* error) LIMN_C_NOEXCEPT;

// Tessellation

/// Pipelines that make triangles.
typedef struct limn_vk_tessellator limn_vk_tessellator;
limn_result limn_vk_tessellator_create(const limn_vk_context* context, limn_vk_tessellator** tessellator,
                                       limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_tessellator_destroy(limn_vk_tessellator* tessellator) LIMN_C_NOEXCEPT;

/// Flags of limn_vk_instance.
enum {
    LIMN_VK_INSTANCE_HIDDEN = 1,
    LIMN_VK_INSTANCE_KEEP_OUTSIDE = 2,   ///< not culled by the frustum
    LIMN_VK_INSTANCE_KEEP_BACKFACES = 4  ///< not culled by what faces away
};

/// What a buffer of instances holds, 64 bytes each.
typedef struct limn_vk_instance {
    float object_to_world[12];  ///< three rows of four, as VkTransformMatrixKHR
    float value_scale;          ///< 1 leaves rates as they are
    uint32_t flags;
    uint32_t reserved[2];
} limn_vk_instance;

/// 32-bit words from offset_bytes on, a multiple of 4.
typedef struct limn_vk_words {
    VkBuffer buffer;
    VkDeviceSize offset_bytes;
} limn_vk_words;

typedef struct limn_vk_tessellated_channel {
    const limn_vk_patch_table* patches;
    uint32_t channel;  ///< of the trees that the tessellation table was created with
    uint32_t width;    ///< 1 to 4; 0: 2
    limn_vk_points points;
    limn_vk_points values;  ///< optional: a null buffer, for tangents alone
} limn_vk_tessellated_channel;

/// limn::vk::HeightTexture: optional, null.
typedef struct limn_vk_height_texture {
    VkImageView view;
    VkSampler sampler;
    VkImageLayout layout;  ///< 0: VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
    uint32_t channel;
    float scale;  ///< 0: 1
    float bias;
} limn_vk_height_texture;

/// Flags of limn_vk_tessellation_info.
enum {
    LIMN_VK_TESSELLATION_CULL_OUTSIDE = 1,
    LIMN_VK_TESSELLATION_CULL_BACKFACES = 2,
    LIMN_VK_TESSELLATION_CLOCKWISE = 4,         ///< triangles run against the faces of the control mesh
    LIMN_VK_TESSELLATION_KEEP_RATES = 8,        ///< draws nothing, rather than scale rates down, where buffers are too small
    LIMN_VK_TESSELLATION_CHANNEL_TANGENTS = 16,  ///< tangents follow tangent_channel, not u of the ptex face
    LIMN_VK_TESSELLATION_FIRST_INSTANCE_0 = 32   ///< in instance_commands; else the instance's number
};

/// limn::vk::TessellationInfo. What is optional has null buffers. Outputs have room for vertex_capacity points or
/// triangle_capacity triangles.
typedef struct limn_vk_tessellation_info {
    uint32_t struct_size;
    uint32_t flags;
    const limn_vk_patch_table* patches;
    const limn_vk_tessellation_table* table;
    limn_vk_points points;  ///< LIMN_VK_SOURCE_USAGE
    limn_rate_mode mode;
    limn_tessellation_spacing spacing;
    uint32_t vertex_capacity;
    uint32_t triangle_capacity;
    limn_vk_words edge_rates;  ///< of LIMN_RATE_PER_EDGE: a float for each rate edge; LIMN_VK_SOURCE_USAGE
    limn_vk_words instances;   ///< optional: limn_vk_instance; the offset is a multiple of minStorageBufferOffsetAlignment
    limn_vk_points positions;
    limn_vk_points normals;    ///< optional
    limn_vk_points places;     ///< optional, 4 words: ptex face, u and v (floats), kind of leaf | its level << 8
    limn_vk_points tangents;   ///< optional, 4 floats: tangent, sign of the bitangent
    const limn_vk_tessellated_channel* channels;
    uint32_t channel_count;
    uint32_t tangent_channel;  ///< of `channels`
    limn_vk_points previous_points;     ///< optional: those of the last frame
    limn_vk_points previous_positions;  ///< where vertices would have been then
    limn_vk_points heights;             ///< optional: the height along the normal, its derivatives by u and v
    limn_vk_height_texture height_texture;
    limn_vk_words indices;            ///< 3 for each triangle
    limn_vk_words triangle_faces;     ///< optional: the ptex face of each triangle
    limn_vk_words command;            ///< a VkDrawIndexedIndirectCommand
    limn_vk_words instance_commands;  ///< optional: one for each instance
    limn_vk_words result;             ///< optional: a limn_vk_tessellation_result
} limn_vk_tessellation_info;

typedef uint32_t limn_tessellation_status;
enum {
    LIMN_TESSELLATION_COMPLETE = 0,
    LIMN_TESSELLATION_SCALED = 1,       ///< rates were scaled down to fit the capacity
    LIMN_TESSELLATION_TOO_SMALL = 2,    ///< nothing is drawn: not even the least rates fit, or KEEP_RATES
    LIMN_TESSELLATION_NOT_FINITE = 3,   ///< nothing is drawn: a control point is no number
    LIMN_TESSELLATION_BAD_SETTINGS = 4  ///< nothing is drawn: recording returned an error
};

/// What the device writes to limn_vk_tessellation_info::result.
typedef struct limn_vk_tessellation_result {
    limn_tessellation_status status;
    uint32_t vertex_count;
    uint32_t triangle_count;
    float rate_scale;
} limn_vk_tessellation_result;

/// Executed by one queue at a time, since it has state of its own.
typedef struct limn_vk_tessellation limn_vk_tessellation;
limn_result limn_vk_tessellator_prepare(const limn_vk_tessellator* tessellator, const limn_vk_tessellation_info* info,
                                        limn_vk_tessellation** tessellation, limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_tessellation_destroy(limn_vk_tessellation* tessellation) LIMN_C_NOEXCEPT;
uint64_t limn_vk_tessellation_get_state_bytes(const limn_vk_tessellation* tessellation) LIMN_C_NOEXCEPT;  ///< 0 of null

/// limn::RateSettings; mode, spacing and culling are those of the info.
typedef struct limn_vk_rate_settings {
    uint32_t struct_size;
    float value;        ///< positive, but for LIMN_RATE_PER_EDGE
    uint32_t max_rate;  ///< 2 to 128; 0: 64. Not more than the trees'
    float bound;        ///< how far displacement may move the surface, for culling
    float matrix[16];   ///< column-major, to Vulkan's clip space; of modes that look through a camera, and of culling
    float width;        ///< of the viewport, in pixels
    float height;
} limn_vk_rate_settings;

/// Passes of a frame. Barriers between those of one call are included, and between calls, too, but for displacement.
enum {
    LIMN_VK_PASS_POINTS = 1,        ///< local points of patches
    LIMN_VK_PASS_RATES = 2,         ///< rates, the command and the result
    LIMN_VK_PASS_TRIANGLES = 4,
    LIMN_VK_PASS_VERTICES = 8,
    LIMN_VK_PASS_HEIGHTS = 16,      ///< from the texture, where there is one
    LIMN_VK_PASS_DISPLACEMENT = 32  ///< heights are visible to kernel reads by then, positions no longer in use
};

/// A frame, all of it; displacement only where there is a height texture: heights of the caller's are written behind it, and
/// then follows LIMN_VK_PASS_DISPLACEMENT. Before: points visible to kernel reads, earlier uses of outputs done. Owed after: a barrier from
/// kernel writes to what reads them, LIMN_VK_DRAW_STAGES for drawing. After an error the commands recorded draw nothing.
limn_result limn_vk_tessellation_record(const limn_vk_tessellation* tessellation, VkCommandBuffer commands,
                                        const limn_vk_rate_settings* settings, limn_error* error) LIMN_C_NOEXCEPT;
/// Only these passes, in the order of their numbers. `settings`: those that rates are or were recorded with; without
/// LIMN_VK_PASS_RATES they may be null, and low rates then gain less.
limn_result limn_vk_tessellation_record_passes(const limn_vk_tessellation* tessellation, VkCommandBuffer commands,
                                               uint32_t passes, const limn_vk_rate_settings* settings,
                                               limn_error* error) LIMN_C_NOEXCEPT;

// Hardware tessellation: stages for the caller's pipeline that draw at the rates of a limn_vk_tessellation
// (limn/vulkan/hardware_tessellation.h says what else goes into the pipeline, and what the fragment stage gets).

/// A frame: LIMN_VK_PASS_POINTS | LIMN_VK_PASS_RATES, a barrier from kernel writes to these, the draw.
#define LIMN_VK_HARDWARE_STAGES \
    (VK_PIPELINE_STAGE_TESSELLATION_CONTROL_SHADER_BIT | VK_PIPELINE_STAGE_TESSELLATION_EVALUATION_SHADER_BIT)
#define LIMN_VK_HARDWARE_READS VK_ACCESS_SHADER_READ_BIT

/// Flags of limn_vk_hardware_tessellator_create.
enum { LIMN_VK_TESSELLATION_SHADER_ENABLED = 1 };  ///< the caller has enabled the feature; without it is unsupported

typedef struct limn_vk_hardware_tessellator limn_vk_hardware_tessellator;
limn_result limn_vk_hardware_tessellator_create(const limn_vk_context* context, uint32_t flags,
                                                limn_vk_hardware_tessellator** tessellator,
                                                limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_hardware_tessellator_destroy(limn_vk_hardware_tessellator* tessellator) LIMN_C_NOEXCEPT;

/// SPIR-V; entry point "main".
typedef struct limn_vk_stage_code {
    const uint32_t* words;
    uint64_t word_count;
} limn_vk_stage_code;

/// Of the caller's pipeline and its layout. All of it is the tessellator's own.
typedef struct limn_vk_hardware_stages {
    uint32_t struct_size;
    uint32_t reserved;
    VkDescriptorSetLayout set_layout;  ///< descriptor set 0
    VkPushConstantRange push_constants;
    uint32_t reserved2;
    limn_vk_stage_code vertex;
    limn_vk_stage_code control;
    limn_vk_stage_code evaluation;
} limn_vk_hardware_stages;

/// Loop has stages of its own. Fills as much of `stages` as its struct_size says.
limn_result limn_vk_hardware_tessellator_get_stages(const limn_vk_hardware_tessellator* tessellator, limn_scheme scheme,
                                                    limn_vk_hardware_stages* stages, limn_error* error) LIMN_C_NOEXCEPT;

typedef struct limn_vk_hardware_tessellation limn_vk_hardware_tessellation;
/// `tessellation` may have no outputs but its rates.
limn_result limn_vk_hardware_tessellator_prepare(const limn_vk_hardware_tessellator* tessellator,
                                                 const limn_vk_tessellation* tessellation,
                                                 limn_vk_hardware_tessellation** prepared,
                                                 limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_hardware_tessellation_destroy(limn_vk_hardware_tessellation* prepared) LIMN_C_NOEXCEPT;
/// Within a render pass, the caller's pipeline bound. `clip_from_points`: 16 floats, column-major. Does nothing where one of
/// them is null.
void limn_vk_hardware_tessellation_record_draw(const limn_vk_hardware_tessellation* prepared, VkCommandBuffer commands,
                                               VkPipelineLayout layout, const float* clip_from_points) LIMN_C_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
