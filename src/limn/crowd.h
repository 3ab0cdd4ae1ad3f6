// A crowd that changes in place: instances of meshes come and go, and nothing of the others moves.
//
// Tables are those of batch.h, with room to spare. Each instance has ranges of points, faces, surfaces, rows
// and so on, which stay its own until it goes; then others get them. Plans are there once, however many have
// them. What no instance has is inert: holes without a surface, edges of rate 0, vertices that no triangle
// refers to. So a change writes what the instance needs, and `changes` of the words are all that a device has
// to be sent (limn/vulkan/crowd_tables.h).
#pragma once

#include <memory>

#include "limn/batch_list.h"

namespace limn {

struct CrowdOptions {
    uint32_t max_rate = 64;  ///< as PatchTreeOptions, as the next two
    uint64_t max_weight_bytes = uint64_t{256} << 20;
    uint32_t points_per_pass = uint32_t{1} << 22;  ///< also the most local points that one mesh may have
    /// Room for more of everything, as a share of what is there whenever all is laid out, 0 .. 4.
    float reserve = 0.25f;
};

/// Which numbers of the crowd's tables an instance has.
struct CrowdInstance {
    PatchBatchMesh patches;
    TessellationBatchMesh topology;
};

/// One thread at a time; reading does not hinder reading.
class Crowd {
  public:
    explicit Crowd(const CrowdOptions& options = {});
    Crowd(Crowd&&) noexcept;
    Crowd& operator=(Crowd&&) noexcept;
    ~Crowd();

    /// One instance of each mesh: their numbers, in that order, the least that are free. Time is linear in
    /// what these meshes hold or, where there is no room for them, in the whole crowd: then all is laid out
    /// anew, layout() is another number, and ranges of all instances are others. The meshes' tables stay
    /// where they are, unchanged, for as long as an instance has them. With an error the crowd is as before.
    /// Errors: invalid_argument (options that differ from the crowd's, an identity missing for a plan,
    /// options of the crowd itself; the element is the mesh), unsupported (end caps other than exact,
    /// points_per_pass), too_large (as merge_patch_tables, merge_tessellation_tables and build_patch_trees).
    Result<std::vector<uint32_t>> add(std::span<const BatchMesh> meshes);
    Result<uint32_t> add(const BatchMesh& mesh);
    /// Errors: index_out_of_range (no such instance; the element is its number).
    Result<void> remove(uint32_t instance);
    /// Lays all out anew, with no more room than the reserve says: where many have gone that nobody replaces.
    /// What they had makes no local points, vertices and triangles any more, but is looked at: on CPU devices
    /// at a quarter of its former price. Errors: as add.
    Result<void> compact();

    /// Numbers of instances are below it: elements of TessellationInfo::instances. Grows only when all is
    /// laid out anew.
    uint32_t instance_capacity() const;
    uint32_t instance_count() const;
    /// Null where there is no such instance.
    const CrowdInstance* find(uint32_t instance) const;
    /// 0 before the first add; from then on one more whenever all is laid out anew.
    uint64_t layout() const;

    /// Tables as others are, holes included: for evaluate.h, tessellate.h, build_grid_table. Surfaces that no
    /// ptex face refers to are not to be read. Without instances nothing may be evaluated.
    const PatchTable& patches() const;
    const TessellationTable& topology() const;
    /// Of all tables, together with what devices make local and level-1 points of.
    uint64_t bytes() const;

    /// Bytes of device tables that have changed since the layout was made or changes were forgotten.
    uint64_t changed_bytes() const;
    /// Once changes are on the device, or on all of them.
    void forget_changes();

    struct State;
    const State& state() const { return *state_; }

  private:
    std::unique_ptr<State> state_;
};

}  // namespace limn
