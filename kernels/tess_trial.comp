// Vertices and triangles that there would be at each of kTessTrials scales.
// One invocation per row and face.
// Reads: tables, targets, which faces are drawn, the scales. Adds to: sums of each trial, in integers, so that they are the
// same in any order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

float trial_scale;
uint rate_of(uint edge) {
    return round_rate(uintBitsToFloat(SETTLED(kTessTargets + edge)), trial_scale, kSpacing, params.max_rate,
                      edge_word(edge, 0), params.payload[0] != 0, trial_scale < 1 ? rate_dither(edge) : -1.0);
}
#include "limn/tess_counts.glsl"

shared uint sums[2 * kTessTrials];

void add_long(uint at, uint amount) {
    const uint before = atomicAdd(state[at], amount);
    if (before + amount < before) atomicAdd(state[at + 1], 1u);
}

void main() {
    if (gl_LocalInvocationID.x < 2 * kTessTrials) sums[gl_LocalInvocationID.x] = 0;
    barrier();
    const uint item = global_invocation();
    if (item < item_count()) {
        for (uint trial = 0; trial < kTessTrials; ++trial) {
            trial_scale = uintBitsToFloat(SETTLED(trials_at() + 4 * kTessTrials + trial));
            const uvec2 count = count_item(item);
            if (count.x != 0) atomicAdd(sums[2 * trial], count.x);
            if (count.y != 0) atomicAdd(sums[2 * trial + 1], count.y);
        }
    }
    barrier();
    if (gl_LocalInvocationID.x < 2 * kTessTrials && sums[gl_LocalInvocationID.x] != 0)
        add_long(trials_at() + 2 * gl_LocalInvocationID.x, sums[gl_LocalInvocationID.x]);
}
