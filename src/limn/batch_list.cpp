#include "limn/batch_list.h"

#include <algorithm>
#include <string>

namespace limn {
namespace {

/// The element of that number in a list by number, or its end.
template <class List>
auto find_by_id(List& list, uint32_t id) {
    const auto at =
        std::lower_bound(list.begin(), list.end(), id, [](const auto& element, uint32_t i) { return element.id < i; });
    return at != list.end() && at->id == id ? at : list.end();
}

Error no_such(const char* kind, uint32_t id) {
    return {ErrorCode::index_out_of_range, std::string("there is no ") + kind + " " + std::to_string(id), id};
}

}  // namespace

uint32_t BatchList::add_mesh(const BatchMesh& mesh) {
    assert(mesh.patches != nullptr && mesh.topology != nullptr);
    meshes_.push_back({next_mesh_, mesh});
    return next_mesh_++;
}

Result<void> BatchList::remove_mesh(uint32_t mesh) {
    const auto at = find_by_id(meshes_, mesh);
    if (at == meshes_.end()) return no_such("mesh", mesh);
    meshes_.erase(at);
    std::erase_if(instances_, [&](const Instance& instance) { return instance.mesh == mesh; });
    return {};
}

Result<uint32_t> BatchList::add_instance(uint32_t mesh) {
    if (find_by_id(meshes_, mesh) == meshes_.end()) return no_such("mesh", mesh);
    instances_.push_back({next_instance_, mesh});
    return next_instance_++;
}

Result<void> BatchList::remove_instance(uint32_t instance) {
    const auto at = find_by_id(instances_, instance);
    if (at == instances_.end()) return no_such("instance", instance);
    instances_.erase(at);
    return {};
}

Result<MergedBatch> BatchList::merge(const PatchTreeOptions& options) const {
    std::vector<const PatchTable*> patches;
    std::vector<const TessellationTable*> topologies;
    for (const Instance& instance : instances_) {
        const BatchMesh& mesh = find_by_id(meshes_, instance.mesh)->tables;
        patches.push_back(mesh.patches);
        topologies.push_back(mesh.topology);
    }
    auto merged_patches = merge_patch_tables<float>(patches);
    if (!merged_patches) return merged_patches.error();
    auto merged_topology = merge_tessellation_tables(topologies);
    if (!merged_topology) return merged_topology.error();
    auto trees = build_patch_trees(merged_patches->table, options, trees_);
    if (!trees) return trees.error();
    MergedBatch out = {std::move(merged_patches->table), std::move(merged_topology->table), std::move(*trees), {}};
    for (size_t i = 0; i < instances_.size(); ++i)
        out.instances.push_back(
            {instances_[i].id, instances_[i].mesh, merged_patches->meshes[i], merged_topology->meshes[i]});
    return out;
}

}  // namespace limn
