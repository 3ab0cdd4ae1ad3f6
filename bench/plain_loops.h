// The honest baseline beside OpenSubdiv: what a good programmer writes in an afternoon, plain C++ over points
// of three floats, on all cores.
#pragma once

#include <memory>

#include "candidate.h"
#include "limn/grid_table.h"
#include "limn/stencil_table.h"
#include "patch_candidate.h"

namespace limn::bench {

/// Compressed sparse rows, one table after the other, each over the points that the one before makes. The
/// tables must outlive the candidate.
Candidate make_loop_stencil_candidate(std::span<const StencilTable> tables,
                                      const std::vector<float>& positions, double copy_rate);

/// Level-1 points by sparse rows, then a dense matrix of each class of GridTable over the ring of each
/// surface. The table must outlive the candidate. Errors: as build_grid_table.
Result<PatchCandidate> make_loop_grid_candidate(const PatchTable& table, const std::vector<float>& positions,
                                                uint32_t rate, PatchTask task, double copy_rate);

}  // namespace limn::bench
