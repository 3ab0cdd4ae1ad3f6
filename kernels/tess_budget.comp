// Begins a frame's result; and, where a budget binds, finds the largest scale of rates whose tessellation fits it.
// One invocation. kMode: 0 begins, with trials from 1/256 to 1; 1 narrows them to what lies between the largest that fitted
// and the next; 2 takes the largest that fitted; kTessRatesOnly begins without trials.
// Payload: 1, 2: capacities of vertices and triangles; 3: the status to begin with. Reads and writes: the result, trials.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

bool fits(uint trial) {
    const uint at = trials_at() + 4 * trial;
    const uint vertices = floatBitsToUint(params.payload[1]), triangles = floatBitsToUint(params.payload[2]);
    return state[at + 1] == 0 && state[at + 3] == 0 && vertices >= params.corner_count &&
           state[at] <= vertices - params.corner_count && state[at + 2] <= triangles;
}

void main() {
    if (global_invocation() != 0) return;
    const uint scales = trials_at() + 4 * kTessTrials, last = kTessTrials - 1;
    float low = 1.0 / 256.0, high = 1, steps = float(last);
    if (kMode == 0 || kMode == kTessRatesOnly) {
        state[kTessResultStatus] = floatBitsToUint(params.payload[3]);
        state[kTessResultVertices] = 0;
        state[kTessResultTriangles] = 0;
        state[kTessResultNotFinite] = 0;
        state[kTessResultScale] = floatBitsToUint(1.0);
        if (kMode == kTessRatesOnly) return;
    } else {
        uint best = 0;
        for (uint trial = 0; trial < kTessTrials; ++trial)
            if (fits(trial)) best = trial;
        low = uintBitsToFloat(state[scales + best]);
        high = uintBitsToFloat(state[scales + min(best + 1, last)]);
        steps = float(kTessTrials);
        state[kTessResultScale] = floatBitsToUint(low);
        if (kMode == 2) return;
    }
    for (uint trial = 0; trial < kTessTrials; ++trial) {
        // Written down, so that the scale taken is to the bit one that was tried.
        const float scale = trial == 0 ? low : kMode == 0 && trial == last ? 1.0 : low * pow(high / low, float(trial) / steps);
        state[scales + trial] = floatBitsToUint(scale);
        for (uint i = 0; i < 4; ++i) state[trials_at() + 4 * trial + i] = 0;
    }
}
