// What the host and the normals kernel agree on.
#ifndef LIMN_SHARED_NORMALS_PARAMS_H
#define LIMN_SHARED_NORMALS_PARAMS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

const uint kNormalsWorkgroupSize = 64;  // invocations, one per vertex

const uint kNormalsTangent1Binding = 0;  // three floats a vertex
const uint kNormalsTangent2Binding = 1;
const uint kNormalsBinding = 2;  // written
const uint kNormalsBindingCount = 3;

// Push constants.
struct NormalsParams {
    uint vertex_count;
    uint tangent1_base;  // floats, into what is bound
    uint tangent2_base;
    uint normal_base;  // component c of vertex v is float normal_base + v * normal_stride + c
    uint normal_stride;
};
LIMN_LAYOUT(NormalsParams, 20)

LIMN_SHARED_END
#endif
