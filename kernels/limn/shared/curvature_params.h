// What the host and the curvature kernel agree on.
#ifndef LIMN_SHARED_CURVATURE_PARAMS_H
#define LIMN_SHARED_CURVATURE_PARAMS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

const uint kCurvatureWorkgroupSize = 64;  // invocations, one per sample

const uint kCurvatureValuesBinding = 0;      // read
const uint kCurvatureResultsBinding = 1;     // written, as the next
const uint kCurvatureQuotientsBinding = 2;  // the results once more where no quotients are asked for
const uint kCurvatureBindingCount = 3;

// Specialization constants.
const uint kCurvatureWidthConstant = 0;      // 3; 4: homogeneous
const uint kCurvatureQuotientsConstant = 1;  // 1: quotients are written, too

// Floats of a result: Gaussian and mean curvature, the two principal ones and their directions.
const uint kCurvatureFloats = 10;

// Push constants. Float k of the record of sample s is at base + s * stride + k.
struct CurvatureParams {
    uint sample_count;
    uint value_base;
    uint value_stride;
    uint result_base;
    uint result_stride;
    uint quotient_base;
    uint quotient_stride;
};
LIMN_LAYOUT(CurvatureParams, 28)

LIMN_SHARED_END
#endif
