// The level-1 points of patch tables. Not part of the public interface.
#pragma once

#include <algorithm>
#include <bit>
#include <memory>
#include <numeric>
#include <span>
#include <unordered_map>
#include <vector>

#include "limn/patch_table.h"
#include "limn/topology.h"

namespace limn {

/// 16 bits each where `bound` is 2^16 at most; indices are below it.
IndexList pack_indices(Array<uint32_t>&& indices, uint32_t bound, const BuildPart& part);

/// Entries of a row by descending weights: then its sum does not depend on which other rows a device table holds
/// (limn/vulkan/stencil_runs.h).
template <class Real>
std::vector<uint32_t> order_by_weight(std::span<const Real> weights) {
    std::vector<uint32_t> order(weights.size());
    std::iota(order.begin(), order.end(), 0);
    const auto bits = [&](uint32_t k) { return std::bit_cast<uint32_t>(static_cast<float>(weights[k])); };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return bits(a) > bits(b); });
    return order;
}

/// Runs in the making (PointRun): rows of equal weights have one, whose weights are there once.
template <class Real>
class PointRuns {
  public:
    /// Adds rows of these weights: the number of their run, in the order in which runs were met.
    uint32_t add(const Real* weights, uint32_t entry_count, uint32_t row_count);
    uint32_t add(uint64_t hash, std::span<const Real> weights,
                 uint32_t row_count);  ///< their hash being known
    /// Afterwards: points from first_point on, run after run, and their indices likewise. The number of those
    /// is below 2^32.
    void place(uint32_t first_point);
    const std::vector<PointRun>& runs() const { return runs_; }
    void write(BasicPatchTable<Real>& table) const;  ///< point_runs and point_weights

  private:
    std::vector<PointRun> runs_;
    std::vector<Real> weights_;
    std::unordered_multimap<uint64_t, uint32_t> runs_by_hash_;
};

/// Where level-1 points begin, behind control points.
inline uint32_t first_refined_point(uint32_t control_count, uint32_t refined_count) {
    return refined_count == 0 ? control_count : (control_count + 63) & ~63u;
}

/// Rows of the vertices of level 1, of those that surfaces need in a block of consecutive ones. What it holds
/// depends on their parents' surroundings alone: where a mesh changes, few blocks are made again.
template <class Real>
struct PointBlock {
    struct Pattern {
        uint64_t hash;
        uint32_t entry_count, first_weight;  ///< in the weights of the block
        uint32_t row_count = 0;
    };
    std::vector<uint32_t> children;  ///< of the rows, counted from the block's first; ascending
    std::vector<uint32_t> pattern_of_row, indices;
    std::vector<Pattern> patterns;
    std::vector<Real> weights;
};

/// The level-1 points of a table.
template <class Real>
struct RefinedPoints {
    /// Where the first row of a block's pattern has come to be.
    struct PatternPlace {
        uint32_t first_point, first_index;
        bool operator==(const PatternPlace&) const = default;
    };
    std::vector<uint32_t>
        first_children;  ///< block b has the vertices [first_children[b], first_children[b + 1])
    std::vector<std::shared_ptr<const PointBlock<Real>>> blocks;  ///< null where to be made
    std::vector<std::vector<PatternPlace>> places;                ///< of blocks' patterns
    std::vector<uint32_t> point_of_child;                         ///< kInvalidIndex where there is none
    uint32_t control_count = 0, first_refined = 0, refined_count = 0;
    uint64_t index_count = 0;
    PointRuns<Real> runs;

    uint32_t block_count() const { return static_cast<uint32_t>(blocks.size()); }
    uint32_t point_count() const { return first_refined + refined_count; }
};

/// Where blocks begin, and the vertex count of level 1: blocks of the children of vertices; then, for each of
/// the chunks of faces that `first_faces` tells apart, of its faces (not Loop); then of the edges that appear
/// in it first. Of Doo-Sabin: blocks of the chunks' corners.
std::vector<uint32_t> find_child_blocks(const Topology& base, const std::vector<uint32_t>& first_faces);
/// The block of a vertex's child, and how many such blocks there are.
uint32_t vertex_block(uint32_t v);
uint32_t vertex_block_count(const Topology& base);

/// Makes the blocks of `points`, whose first_children are known, but for those that are there and have rows
/// of the same children: those that `uses` is not zero of. `linear`: by varying rules. `control_indices`: as
/// of Refinement.
template <class Real>
void make_point_rows(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                     const std::vector<uint32_t>& uses, RefinedPoints<Real>& points, const BuildPart& part);

/// Numbers points, those with rows of equal weights one after the other: places, runs and counts.
/// control_count is known. Error: too_large past 2^32 indices.
template <class Real>
Result<void> place_points(RefinedPoints<Real>& points, const BuildPart& part);

/// Writes point_runs, point_indices, point_weights, first_refined and refined_count, and point_of_child.
/// `before`, if not null: the points that the table has; indices that are the same are not written again.
template <class Real>
void write_points(RefinedPoints<Real>& points, const RefinedPoints<Real>* before,
                  BasicPatchTable<Real>& table, const BuildPart& part);

/// The words of a list, to be written again and packed: `kept` says whether they are still what they were.
Array<uint32_t> take_indices(IndexList& list, size_t size, bool& kept);

}  // namespace limn
