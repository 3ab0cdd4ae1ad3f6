// limn for C: meshes that are edited, and crowds that come and go, while their surfaces are drawn. What limn.h says of
// structs and errors holds here, too; limn/mesh_edit.h and limn/crowd.h say the rest, limn_vulkan_changes.h what
// devices do.
//
// These objects change: one thread at a time uses one of them, or what it hands out. An error leaves them as they were.
#ifndef LIMN_C_LIMN_CHANGES_H
#define LIMN_C_LIMN_CHANGES_H

#include "limn/c/limn.h"

#ifdef __cplusplus
extern "C" {
#endif

// Meshes that are edited

/// limn::EditableMesh: a mesh and its tables, which are after each edit what a build of the edited mesh makes.
typedef struct limn_editable_mesh limn_editable_mesh;

/// Flags of limn_editable_mesh_options.
enum { LIMN_EDITABLE_MESH_JOIN_CREASES = 1 };  ///< as LIMN_TESSELLATION_TABLE_JOIN_CREASES

typedef struct limn_editable_mesh_options {
    uint32_t struct_size;
    uint32_t flags;
    const limn_patch_table_options* patches;  ///< may be null
    const uint32_t* channels;                 ///< as limn_tessellation_table_options
    uint64_t channel_count;
} limn_editable_mesh_options;

/// Copies the mesh, and builds its tables. `options` may be null; `cache`, too, else it outlives the object.
limn_result limn_editable_mesh_create(const limn_control_mesh* mesh, const limn_editable_mesh_options* options,
                                      limn_plan_cache* cache, limn_editable_mesh** edited,
                                      limn_error* error) LIMN_C_NOEXCEPT;
void limn_editable_mesh_destroy(limn_editable_mesh* edited) LIMN_C_NOEXCEPT;

/// limn::MeshEdit: first faces change, then sharpness, then holes. Arrays are read during limn_editable_mesh_edit only;
/// null where their length is 0.
typedef struct limn_mesh_edit {
    uint32_t struct_size;
    uint32_t new_vertex_count;   ///< behind the others; vertices never go
    const uint32_t* faces;       ///< that change; the mesh's face count and what follows are new ones, ascending
    const uint32_t* face_sizes;  ///< one per face; 0 removes it, and those behind it move up
    uint64_t face_count;
    const uint32_t* face_vertices;  ///< the sum of face_sizes
    uint64_t face_vertex_count;
    const uint32_t* crease_vertices;  ///< pairs, each along an edge
    uint64_t crease_vertex_count;
    const float* crease_sharpness;  ///< one per pair; 0 smoothes the edge
    uint64_t crease_sharpness_count;
    const uint32_t* corner_vertices;
    const float* corner_sharpness;
    uint64_t corner_count;
    const uint32_t* holes;  ///< faces that become holes
    uint64_t hole_count;
    const uint32_t* filled_holes;  ///< faces that are none any more
    uint64_t filled_hole_count;
} limn_mesh_edit;

/// limn::EditWork: what an edit has made again.
typedef struct limn_edit_work {
    uint32_t struct_size;
    uint32_t face_count;    ///< that were walked around
    uint32_t tessellation;  ///< 0 or 1: 0 where the tessellation table is what it was
    uint32_t reserved;
} limn_edit_work;

/// Makes the changes. The error's element is the one of the edit's faces, creases, corners or holes. Fills as much of
/// `work` as its struct_size says; it may be null.
limn_result limn_editable_mesh_edit(limn_editable_mesh* edited, const limn_mesh_edit* edit, limn_edit_work* work,
                                    limn_error* error) LIMN_C_NOEXCEPT;

// The object's own, which change with it and are not to be destroyed. Null of null.
const limn_control_mesh* limn_editable_mesh_get_mesh(const limn_editable_mesh* edited) LIMN_C_NOEXCEPT;
const limn_patch_table* limn_editable_mesh_get_patches(const limn_editable_mesh* edited) LIMN_C_NOEXCEPT;
const limn_tessellation_table* limn_editable_mesh_get_tessellation(const limn_editable_mesh* edited) LIMN_C_NOEXCEPT;

/// Tables as they are now, which a device that has them is updated from after an edit.
limn_result limn_patch_table_create_copy(const limn_patch_table* from, limn_patch_table** table,
                                         limn_error* error) LIMN_C_NOEXCEPT;
limn_result limn_tessellation_table_create_copy(const limn_tessellation_table* from, limn_tessellation_table** table,
                                                limn_error* error) LIMN_C_NOEXCEPT;

// Crowds

/// limn::Crowd: tables of many instances of meshes, with room to spare for others.
typedef struct limn_crowd limn_crowd;

/// Flags of limn_crowd_options.
enum { LIMN_CROWD_NO_RESERVE = 1 };  ///< no room to spare

typedef struct limn_crowd_options {
    uint32_t struct_size;
    uint32_t flags;
    uint32_t max_rate;          ///< 2 to 128; 0: 64
    uint32_t points_per_pass;   ///< 0: 2^22
    uint64_t max_weight_bytes;  ///< 0: 2^28
    float reserve;              ///< room for more, as a share of what is there whenever all is laid out, to 4; 0: 0.25
    uint32_t reserved;          ///< 0
} limn_crowd_options;

/// An empty one. `options` may be null; they are checked by limn_crowd_add.
limn_result limn_crowd_create(const limn_crowd_options* options, limn_crowd** crowd, limn_error* error) LIMN_C_NOEXCEPT;
void limn_crowd_destroy(limn_crowd* crowd) LIMN_C_NOEXCEPT;

/// Tables of a mesh: they stay, unchanged, for as long as an instance has them.
typedef struct limn_crowd_mesh {
    const limn_patch_table* patches;
    const limn_tessellation_table* tessellation;
} limn_crowd_mesh;

/// One instance of each mesh, whose numbers are written to `instances`: the least that are free. All is laid out anew,
/// and limn_crowd_info::layout is another, where there is no room. The error's element is the mesh.
limn_result limn_crowd_add(limn_crowd* crowd, const limn_crowd_mesh* meshes, uint64_t mesh_count, uint32_t* instances,
                           limn_error* error) LIMN_C_NOEXCEPT;
/// LIMN_ERROR_INDEX_OUT_OF_RANGE where there is no such instance.
limn_result limn_crowd_remove(limn_crowd* crowd, uint32_t instance, limn_error* error) LIMN_C_NOEXCEPT;
/// Lays all out anew, with no more room than the reserve says.
limn_result limn_crowd_compact(limn_crowd* crowd, limn_error* error) LIMN_C_NOEXCEPT;

typedef struct limn_crowd_info {
    uint32_t struct_size;
    uint32_t instance_capacity;  ///< numbers of instances are below it
    uint32_t instance_count;
    uint32_t reserved;
    uint64_t layout;         ///< 0 before the first limn_crowd_add; one more whenever all is laid out anew
    uint64_t bytes;          ///< of all tables
    uint64_t changed_bytes;  ///< since the layout was made or changes were forgotten
} limn_crowd_info;

/// As limn_patch_table_get_info.
limn_result limn_crowd_get_info(const limn_crowd* crowd, limn_crowd_info* info, limn_error* error) LIMN_C_NOEXCEPT;

/// The numbers first, first + 1, ..., count of them.
typedef struct limn_range {
    uint32_t first;
    uint32_t count;
} limn_range;

/// Which numbers of the crowd's tables an instance has, until all is laid out anew.
typedef struct limn_crowd_instance {
    uint32_t struct_size;
    uint32_t reserved;
    limn_range control_points;
    limn_range ptex_faces;
    limn_range surfaces;
    limn_range mesh_edges;      ///< rate edges of the control mesh
    limn_range sub_face_edges;  ///< the other rate edges
    limn_range rows;
    limn_range corners;
} limn_crowd_instance;

/// As limn_patch_table_get_info. LIMN_ERROR_INDEX_OUT_OF_RANGE where there is no such instance.
limn_result limn_crowd_get_instance(const limn_crowd* crowd, uint32_t instance, limn_crowd_instance* info,
                                    limn_error* error) LIMN_C_NOEXCEPT;

// The crowd's own, until it changes; not to be destroyed. Null of null.
const limn_patch_table* limn_crowd_get_patches(const limn_crowd* crowd) LIMN_C_NOEXCEPT;
const limn_tessellation_table* limn_crowd_get_tessellation(const limn_crowd* crowd) LIMN_C_NOEXCEPT;

/// Once changes are on the device, or on all of them. Null does nothing.
void limn_crowd_forget_changes(limn_crowd* crowd) LIMN_C_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
