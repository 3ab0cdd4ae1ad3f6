// One row at a time: a child or limit point over the points of its parent level. Not part of the public
// interface.
#pragma once

#include <vector>

#include "limn/row.h"
#include "limn/stencil_table.h"
#include "limn/topology.h"

namespace limn {

/// Tangent weights beside the entries of a limit row.
struct TangentWeights {
    double tangent1, tangent2;
};

/// Appends the row of vertex `child` of the level after `parent`.
void refinement_row(const Topology& parent, uint32_t child, Interpolation interpolation, Row& row);

/// Appends the limit position and, one for each entry, the tangents of vertex v of a full level whose faces
/// all have the scheme's own size.
void limit_row(const Topology& level, uint32_t v, Row& row, std::vector<TangentWeights>& tangents);

}  // namespace limn
