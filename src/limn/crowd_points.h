// What level-1 points are made of (limn/shared/stencil_eval_params.h), for meshes that come and go. Not part
// of the public interface.
//
// Rows of about as many entries, a pool, are one dispatch: items of one size, each with its row. Items that
// stand for no row have one that is none; they cost a few loads. Entries of a row are in the order that
// build_point_table gives them.
#pragma once

#include "limn/patch_table.h"
#include "limn/slot_ranges.h"
#include "limn/word_changes.h"

namespace limn {

/// Pairs of words, as StencilRun (limn/vulkan/stencil_runs.h) has them: item i's are at index_offset and
/// weight_offset, and its row at row_offset. Of long rows pairs of an item lie together, else those of
/// neighbours.
struct PointPool {
    uint32_t pair_count;  ///< of each item
    uint32_t item_count;
    bool is_long;
    uint64_t begin, index_offset, weight_offset, row_offset, end;
};

/// Items of a pool that belong to a mesh.
struct PointItems {
    uint32_t pool, first, count;
};

class CrowdPoints {
  public:
    void expect(const PatchTable& mesh);
    /// Makes room for what is expected, and a `reserve` of it. False: a mesh has more rows than a dispatch
    /// takes, or 2^32 words.
    bool lay_out(float reserve);

    /// Rows of a mesh, whose control points begin at first_control; row r of the device table is level-1
    /// point r, of which the mesh's begin at first_row. False: there is no room. What was added so far is in
    /// `items` all the same.
    bool add(const PatchTable& mesh, uint32_t first_control, uint32_t first_row,
             std::vector<PointItems>& items);
    void remove(std::vector<PointItems>& items);

    const Array<uint32_t>& words() const { return words_; }
    const std::vector<PointPool>& pools() const { return pools_; }
    WordChanges changes;

  private:
    bool add_pool(uint32_t pair_count, uint64_t item_count);
    bool take(uint32_t pair_count, uint32_t count, PointItems& out);
    void write_run(const PatchTable& mesh, const PointRun& run, uint32_t first_control, uint32_t first_row,
                   const PointItems& items);
    void mark(const PointItems& items);

    Array<uint32_t> words_;
    uint64_t pair_end_ = 0;
    std::vector<PointPool> pools_;
    std::vector<SlotRanges> free_;           ///< of each pool
    std::map<uint32_t, uint64_t> expected_;  ///< rows of each size
};

}  // namespace limn
