// What the host and the osd_patch_eval kernel agree on: tables as OpenSubdiv lays them out, as words.
//   arrays   Osd::PatchArray, 6 words: types of regular and of other patches, patch_count, first_index,
//   stride, first_patch indices  control vertex k of patch p is word first_index + stride * (p - first_patch)
//   + k params   Osd::PatchParam, 3 words coords   Osd::PatchCoord, 5 words: array, patch, unused, and as
//   floats s and t in the ptex face
#ifndef LIMN_SHARED_OSD_PATCH_EVAL_PARAMS_H
#define LIMN_SHARED_OSD_PATCH_EVAL_PARAMS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

const uint kOsdPatchWorkgroupSize = 64;  // invocations, one per coordinate

const uint kOsdArraysBinding = 0;
const uint kOsdIndicesBinding = 1;
const uint kOsdParamsBinding = 2;
const uint kOsdCoordsBinding = 3;
const uint kOsdSourceBinding = 4;
const uint kOsdOutputBinding = 5;  // and the two after it
const uint kOsdOutputCount = 3;    // of a dispatch: value, du, dv, or duu, duv, dvv
const uint kOsdBindingCount = 8;

// Specialization constants.
const uint kOsdWidthConstant = 0;    // components, 1 to 4; more take several dispatches
const uint kOsdSecondConstant = 1;   // 1: second derivatives
const uint kOsdOutputsConstant = 2;  // bit i: output i is wanted
const uint kOsdTypesConstant = 3;    // bit t: patches of type t occur

const uint kOsdArrayWords = 6;
const uint kOsdParamWords = 3;
const uint kOsdCoordWords = 5;

// Push constants. Bases are in words, into the bound ranges: component c of point p is base + p * stride + c.
struct OsdPatchEvalParams {
    uint coord_count;
    uint coord_base;
    uint array_count;
    uint source_base;
    uint source_stride;
    uint output_base[kOsdOutputCount];
    uint output_stride[kOsdOutputCount];
};
LIMN_LAYOUT(OsdPatchEvalParams, 44)

LIMN_SHARED_END
#endif
