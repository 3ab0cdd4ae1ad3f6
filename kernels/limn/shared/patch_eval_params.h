// What the host and the patch_eval and tree_eval kernels agree on.
//
// A patch table on the device is one array of words: the arrays of patch_table.h, each beginning at a multiple of four.
// A sample is three words, the ptex face and, as floats, u and v.
#ifndef LIMN_SHARED_PATCH_EVAL_PARAMS_H
#define LIMN_SHARED_PATCH_EVAL_PARAMS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

const uint kPatchWorkgroupSize = 64;  // invocations, one per sample

const uint kPatchWordsBinding = 0;
const uint kPatchWeightsBinding = 1;  // the same buffer, as groups of four floats
const uint kPatchPointsBinding = 2;
const uint kPatchSamplesBinding = 3;
const uint kPatchResultsBinding = 4;
const uint kPatchStatusesBinding = 5;
const uint kPatchDeferredBinding = 6;  // samples that tree_eval leaves to patch_eval
const uint kPatchBindingCount = 7;

// Specialization constants.
const uint kPatchWidthConstant = 0;        // components, 1 to 4
const uint kPatchValueCountConstant = 1;   // 1, 3 or 6: value, du, dv, duu, duv, dvv; 0: places
const uint kPatchNarrowConstant = 2;       // 1: ring points are 16-bit indices
const uint kPatchTrianglesConstant = 3;    // 1: Loop
const uint kPatchMaxRingConstant = 4;      // the largest ring of any plan
const uint kPatchEndCapConstant = 5;
const uint kPatchDeferredConstant = 6;  // 1: only what has been deferred
const uint kPatchPairedConstant = 7;    // 1: records begin at even words of the results

// Statuses, in the order of SampleStatus.
const uint kSampleValid = 0;
const uint kSampleHole = 1;
const uint kSampleOutOfRange = 2;

// Where 2^-depth of a surface no longer matters.
const uint kPatchMostDepth = 40;

// Where the arrays begin, in words.
struct PatchTableOffsets {
    uint ptex_surfaces;
    uint surfaces;
    uint ring_points;
    uint plans;
    uint plan_nodes;
    uint plan_points;
    uint plan_weights;
};
LIMN_LAYOUT(PatchTableOffsets, 28)

// What samples are deferred: their number, and a grid of workgroups for it, then the samples.
const uint kDeferredCount = 0;
const uint kDeferredGroups = 1;
const uint kDeferredHeader = 4;

// Where samples are, and where what becomes of them goes.
struct SampleParams {
    uint ptex_count;
    uint sample_count;
    uint first_sample;  // words
    uint result_base;  // component c of value d of sample s is result_base + s * result_stride + d * width + c
    uint result_stride;
    uint status_base;  // words; kPatchNoStatus: none are written
};
LIMN_LAYOUT(SampleParams, 24)
const uint kPatchNoStatus = 0xffffffffu;

// Push constants.
struct PatchEvalParams {
    SampleParams list;
    PatchTableOffsets table;
    uint point_base;
    uint point_stride;
};
LIMN_LAYOUT(PatchEvalParams, 60)

LIMN_SHARED_END
#endif
