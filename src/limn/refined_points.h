// The level-1 points of patch tables. Not part of the public interface.
#pragma once

#include <algorithm>
#include <bit>
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
    /// Afterwards: points from first_point on, run after run, and their indices likewise. The number of those is
    /// below 2^32.
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

/// Numbers the vertices of level 1 for which point_of_child is not kInvalidIndex, those with rows of equal
/// weights one after the other, and writes what they are made of: point_runs, point_indices, point_weights,
/// first_refined and refined_count. `linear`: by varying rules. `control_indices`: as of Refinement. Error:
/// too_large past 2^32 indices. Not to be used where `part` is cancelled.
template <class Real>
Result<void> build_refined_points(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                                  std::vector<uint32_t>& point_of_child, BasicPatchTable<Real>& table,
                                  const BuildPart& part);

}  // namespace limn
