// Where each block of items begins, the totals, and what follows from them: the result and the draw command.
// One workgroup; an invocation per run of blocks.
// Reads: sums of blocks, capacities. Writes: where blocks begin, the result, VkDrawIndexedIndirectCommand. Deterministic.
// Payload: 1, 2: capacities of vertices and triangles; 4: the command, 5: the caller's result, in words of their buffers,
// or kNoFace; 6, 7: workgroups of kTessScaleItems. kMode: kTessRatesOnly: the result alone; kTessTry.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

layout(std430, binding = kTessOutBinding) writeonly buffer Command { uint command[]; };
layout(std430, binding = kTessOut2Binding) writeonly buffer Result { uint result[]; };

shared uvec2 runs[kTessWorkgroupSize];

// Stops at the largest number: what does not fit 32 bits does not fit any buffer either.
uvec2 add(uvec2 a, uvec2 b) { return a + min(b, ~a); }

uvec2 block_sum(uint block) { return uvec2(SETTLED(blocks_at() + 2 * block), SETTLED(blocks_at() + 2 * block + 1)); }

void write_groups(uint at, bool any, uint x, uint y) {
    state[at] = any ? x : 0;
    state[at + 1] = any ? y : 0;
    state[at + 2] = any ? 1 : 0;
}

void finish(uvec2 total) {
    uint status = state[kTessResultStatus];
    const float scale = uintBitsToFloat(state[kTessResultScale]);
    const uint vertices = floatBitsToUint(params.payload[1]), triangles = floatBitsToUint(params.payload[2]);
    if (status == kTessComplete && state[kTessResultNotFinite] != 0) status = kTessNotFinite;
    const bool too_small = status == kTessComplete && (total.x > vertices || total.y > triangles);
    if (kMode == kTessTry) {
        write_groups(kTessScaleItems, too_small, payload(6), payload(7));
        write_groups(kTessScaleOnce, too_small, 1, 1);
        if (too_small) return;
    }
    if (too_small) status = kTessTooSmall;
    if (status == kTessComplete && scale < 1) status = kTessScaled;
    state[kTessNeededVertices] = total.x;
    state[kTessNeededTriangles] = total.y;
    if (status >= kTessTooSmall) total = uvec2(0);
    state[kTessResultStatus] = status;
    state[kTessResultVertices] = total.x;
    state[kTessResultTriangles] = total.y;
    const uint at = floatBitsToUint(params.payload[4]), copy = floatBitsToUint(params.payload[5]);
    if (at != kNoFace) {
        command[at] = 3 * total.y;
        command[at + 1] = 1;
        command[at + 2] = 0;
        command[at + 3] = 0;
        command[at + 4] = 0;
    }
    if (copy != kNoFace) {
        result[copy] = status;
        result[copy + 1] = total.x;
        result[copy + 2] = total.y;
        result[copy + 3] = floatBitsToUint(scale);
    }
}

void main() {
    if (kMode == kTessRatesOnly) {
        if (global_invocation() == 0) finish(uvec2(0));
        return;
    }
    const uint lane = gl_LocalInvocationID.x, blocks = block_count();
    const uint each = (blocks + kTessWorkgroupSize - 1) / kTessWorkgroupSize;
    const uint first = min(lane * each, blocks), end = min(first + each, blocks);
    uvec2 sum = uvec2(0);
    for (uint b = first; b < end; ++b) sum = add(sum, block_sum(b));
    runs[lane] = sum;
    barrier();
    uvec2 at = uvec2(params.corner_count, 0);
    for (uint i = 0; i < lane; ++i) at = add(at, runs[i]);
    if (lane == kTessWorkgroupSize - 1 && gl_WorkGroupID.x == 0) finish(add(at, sum));
    for (uint b = first; b < end; ++b) {
        const uvec2 count = block_sum(b);
        state[blocks_at() + 2 * b] = at.x;
        state[blocks_at() + 2 * b + 1] = at.y;
        at = add(at, count);
    }
}
