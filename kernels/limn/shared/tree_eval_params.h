// What the host and the tree_eval kernels agree on, beside patch_eval_params.h: they bind the words of patch trees in place
// of the patch table's, once more as groups of four words in place of weights, and local points in place of points.
#ifndef LIMN_SHARED_TREE_EVAL_PARAMS_H
#define LIMN_SHARED_TREE_EVAL_PARAMS_H
#include "limn/shared/patch_eval_params.h"
#include "limn/shared/patch_tree_layout.h"
LIMN_SHARED_BEGIN

// Push constants.
struct TreeEvalParams {
    SampleParams list;
    TreeOffsets tree;
};
LIMN_LAYOUT(TreeEvalParams, 40)

LIMN_SHARED_END
#endif
