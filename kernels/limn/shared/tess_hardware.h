// What the host and the stages of hardware tessellation (tess_hardware.*) agree on.
#ifndef LIMN_SHARED_TESS_HARDWARE_H
#define LIMN_SHARED_TESS_HARDWARE_H
#include "limn/shared/tess_params.h"
LIMN_SHARED_BEGIN

const uint kHardwareWordsBinding = 0;       // tables
const uint kHardwareWordGroupsBinding = 1;  // the same buffer, as groups of four words
const uint kHardwareLocalBinding = 2;       // local points, groups of four floats
const uint kHardwareStateBinding = 3;       // rates, and which faces are drawn
const uint kHardwareBindingCount = 4;

// What every device's tessellator can do (maxTessellationGenerationLevel is at least that): segments of a side.
const uint kHardwareMaxRate = 64;

// A function of the edge alone, as rates are: of two halves each has half.
LIMN_FN uint limit_hardware_rate(uint rate, bool halves) {
    const uint most = (halves ? kHardwareMaxRate / 2u : kHardwareMaxRate) * kRateOne;
    return rate < most ? rate : most;
}

// Push constants. Beside them 12 bytes are left of those that every device has.
struct TessHardwareParams {
    float clip_from_points[16];  // column after column
    TreeOffsets tree;
    TessOffsets table;
    uint rate_edge_count;
    uint corner_copy_count;
    uint row_copy_count;
    uint spacing;
};
LIMN_LAYOUT(TessHardwareParams, 116)

LIMN_SHARED_END
#endif
