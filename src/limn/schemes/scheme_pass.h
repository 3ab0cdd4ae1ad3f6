// One pass of a scheme over a stage. Not part of the public interface.
#pragma once

#include "limn/schemes/split.h"
#include "limn/stencil_table.h"

namespace limn {

/// Appends the row of point i of a split.
void pass_row(const Stage& parent, const Pass& pass, const SplitMesh& split, uint32_t i, Row& row);

/// The rows of all points of a split. Errors: too_large, cancelled.
template <class Real>
Result<BasicStencilTable<Real>> build_pass_table(const Stage& parent, const Pass& pass, const SplitMesh& split,
                                                 const BuildPart& part);

/// The stage after a pass; `step_is_done` with its last. Moves the topology on where the pass splits nothing.
Stage advance_stage(Stage&& parent, const Pass& pass, SplitMesh&& split, bool step_is_done);

}  // namespace limn
