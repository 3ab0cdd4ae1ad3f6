// The level-1 points of patch tables. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/patch_table.h"
#include "limn/topology.h"

namespace limn {

/// 16 bits each where `bound` is 2^16 at most; indices are below it.
IndexList pack_indices(Array<uint32_t>&& indices, uint32_t bound);

/// Numbers the vertices of level 1 for which point_of_child is not kInvalidIndex, those with rows of equal
/// weights one after the other, and writes what they are made of: point_runs, point_indices, point_weights,
/// first_refined and refined_count. `linear`: by varying rules. `control_indices`: as of Refinement. Error:
/// too_large past 2^32 indices.
template <class Real>
Result<void> build_refined_points(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                                  std::vector<uint32_t>& point_of_child, BasicPatchTable<Real>& table);

}  // namespace limn
