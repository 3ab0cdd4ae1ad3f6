// One row at a time: a child or limit point over the points of its parent level. Not part of the public
// interface.
#pragma once

#include <vector>

#include "limn/stencil_table.h"
#include "limn/topology.h"

namespace limn {

/// An index may occur more than once in a row; its weights then add up. Around alike vertices rows list their
/// entries in the same order.
struct RowEntry {
    uint32_t index;
    double weight;
};
using Row = std::vector<RowEntry>;

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
