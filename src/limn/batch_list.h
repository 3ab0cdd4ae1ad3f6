// A crowd that changes: meshes and instances come and go; merged tables follow, and say where each instance is.
//
// Nothing that a mesh's tables hold is built again when another one comes or goes, and no plan's tree is grown twice; what
// is made again is the merged copy, in time that is linear in its size. Between changes tables stay as they are: merge on a
// thread of its own, upload beside the frames that are drawn, and change over when both are done. Tables that are changed in
// place are those of crowd.h.
#pragma once

#include "limn/batch.h"
#include "limn/patch_tree_cache.h"

namespace limn {

/// Tables of a mesh: the caller's. They stay where they are, unchanged, as long as the mesh is in the list.
struct BatchMesh {
    const PatchTable* patches = nullptr;
    const TessellationTable* topology = nullptr;
};

/// Where an instance is in merged tables.
struct BatchInstance {
    uint32_t id = 0;    ///< of add_instance
    uint32_t mesh = 0;  ///< of add_mesh
    PatchBatchMesh patches;
    TessellationBatchMesh topology;
};

/// What is uploaded and drawn. Element i of TessellationInfo::instances is instances[i].
struct MergedBatch {
    PatchTable patches;
    TessellationTable topology;
    PatchTreeTable trees;
    std::vector<BatchInstance> instances;
};

/// Meshes and instances, by numbers that are not given out again. One thread at a time.
class BatchList {
  public:
    uint32_t add_mesh(const BatchMesh& mesh);
    /// And all of its instances. Errors: index_out_of_range (no such mesh; the element is its number).
    Result<void> remove_mesh(uint32_t mesh);
    /// Errors: index_out_of_range (no such mesh, or no such instance; the element is its number).
    Result<uint32_t> add_instance(uint32_t mesh);
    Result<void> remove_instance(uint32_t instance);
    size_t mesh_count() const { return meshes_.size(); }
    size_t instance_count() const { return instances_.size(); }

    /// Instances in the order in which they were added: merge_patch_tables and merge_tessellation_tables of their meshes'
    /// tables, and build_patch_trees of the result. Meshes without instances are left out. Errors: of those.
    Result<MergedBatch> merge(const PatchTreeOptions& trees) const;

  private:
    struct Mesh {
        uint32_t id;
        BatchMesh tables;
    };
    struct Instance {
        uint32_t id, mesh;
    };
    std::vector<Mesh> meshes_;  ///< by number, as instances are
    std::vector<Instance> instances_;
    uint32_t next_mesh_ = 0, next_instance_ = 0;
    PatchTreeCache trees_;
};

}  // namespace limn
