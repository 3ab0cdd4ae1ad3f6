// How the words of a patch table are packed; patch_table.h says what they mean.
#ifndef LIMN_SHARED_PATCH_TABLE_LAYOUT_H
#define LIMN_SHARED_PATCH_TABLE_LAYOUT_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

// Kinds of nodes, in the order of PlanNodeKind.
const uint kNodeSplit = 0;
const uint kNodeSplitU = 1;
const uint kNodeSplitV = 2;
const uint kNodeBicubic = 3;
const uint kNodeBoxSpline = 4;
const uint kNodeBilinear = 5;
const uint kNodeLinear = 6;
const uint kNodePlan = 7;
const uint kNodeGregory = 8;
const uint kNodeGregoryTriangle = 9;

// End caps, in the order of EndCap.
const uint kEndCapExact = 0;
const uint kEndCapGregory = 1;
const uint kEndCapGregoryOpenSubdiv = 2;

// ptex_surfaces: a surface, the first of four (kPtexSplit), or no surface at all.
const uint kPtexSplit = 0x80000000u;
const uint kPtexHole = 0xffffffffu;

// Surfaces: the plan and how it is turned.
LIMN_FN uint pack_surface(uint plan, uint rotation) {
    return plan | rotation << 30;
}
LIMN_FN uint surface_plan(uint word) {
    return word & 0x3fffffffu;
}
LIMN_FN uint surface_rotation(uint word) {
    return word >> 30;
}

// Nodes: kind, and for kNodePlan the other plan and how it is turned.
LIMN_FN uint pack_node(uint kind, uint plan, uint rotation) {
    return kind | rotation << 4 | plan << 6;
}
LIMN_FN uint node_kind(uint word) {
    return word & 15u;
}
LIMN_FN uint node_rotation(uint word) {
    return word >> 4 & 3u;
}
LIMN_FN uint node_plan(uint word) {
    return word >> 6;
}
const uint kMaxPlans = 1u << 26;

// Lists of indices hold two of 16 bits in a word, the first in the lower half, where all fit.
LIMN_FN uint narrow_index(uint word, uint i) {
    return word >> (16u * (i & 1u)) & 0xffffu;
}

// Rows of plans begin at multiples of four floats.
LIMN_FN uint plan_row_stride(uint ring_size) {
    return (ring_size + 3u) & ~3u;
}

// Rows that a plan with a corner row begins with: the limit of its corner 0 and two tangents there.
const uint kCornerLimitRow = 0;
const uint kCornerTangentRow = 1;

LIMN_SHARED_END
#endif
