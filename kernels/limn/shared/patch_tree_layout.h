// How the words of patch trees are packed; patch_tree.h says what they mean.
#ifndef LIMN_SHARED_PATCH_TREE_LAYOUT_H
#define LIMN_SHARED_PATCH_TREE_LAYOUT_H
#include "limn/shared/patch_table_layout.h"
LIMN_SHARED_BEGIN

// Beside the kinds of plans' nodes: the limit at an irregular vertex, and that moved by either of two tangents there.
const uint kNodeCorner = 10;

// Nodes: the kind, how often to turn before (rotate_location), and the first child or the leaf.
const uint kMaxTreeFirst = 1u << 26;
LIMN_FN uint pack_tree_node(uint kind, uint rotation, uint first) {
    return kind | rotation << 4 | first << 6;
}
LIMN_FN uint tree_first(uint word) {
    return word >> 6;
}

// A leaf is 16 local points, two of 16 bits in a word, counted from the surface's first. Those of leaves that have fewer
// are followed by the first again. Bilinear leaves are at 0, 1, 4 and 5, as if the 16 were a grid.
const uint kLeafPoints = 16;
const uint kLeafWords = 8;

// Where the arrays of patch_tree.h begin, in words.
struct TreeOffsets {
    uint ptex_surfaces;
    uint surfaces;
    uint nodes;
    uint leaf_points;
};
LIMN_LAYOUT(TreeOffsets, 16)

LIMN_SHARED_END
#endif
