// Vertices and triangles of each row and face: how many of its block come before it, and how many the block has.
// One invocation per row and face, and one behind them; a workgroup is a block. Each adds up what all before it counted: on
// llvmpipe reads of shared memory that are the same for all invocations cost next to nothing (33,000 items: 1.0 ms of CPU
// time in all, a scan in steps by itself 2.9).
// Reads: tables, rates, which faces are drawn. Writes: sums within blocks, and of blocks. Deterministic: sums are of integers.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

uint rate_of(uint edge) { return SETTLED(rates_at() + edge); }
#include "limn/tess_counts.glsl"

shared uvec2 counts[kTessBlockItems];

void main() {
    const uint item = global_invocation(), lane = gl_LocalInvocationID.x, block = item / kTessBlockItems;
    const uvec2 count = item < item_count() ? count_item(item) : uvec2(0);
    counts[lane] = count;
    barrier();
    uvec2 before = uvec2(0);
    [[unroll]] for (uint i = 0; i < kTessBlockItems; ++i) before += mix(uvec2(0), counts[i], bvec2(i < lane));
    if (item <= item_count()) {
        state[items_at() + 2 * item] = before.x;
        state[items_at() + 2 * item + 1] = before.y;
    }
    if (lane == kTessBlockItems - 1 && block < block_count()) {
        state[blocks_at() + 2 * block] = before.x + count.x;
        state[blocks_at() + 2 * block + 1] = before.y + count.y;
    }
}
