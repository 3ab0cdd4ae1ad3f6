// Vertices and triangles of each row and face, and their sums over blocks.
// One invocation per row and face; a workgroup is a block.
// Reads: tables, rates, which faces are drawn. Writes: counts and sums. Deterministic: sums are of integers.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

uint rate_of(uint edge) { return SETTLED(rates_at() + edge); }
#include "limn/tess_counts.glsl"

shared uint sums[2];

void main() {
    if (gl_LocalInvocationID.x < 2) sums[gl_LocalInvocationID.x] = 0;
    barrier();
    const uint item = global_invocation();
    if (item < item_count()) {
        const uvec2 count = count_item(item);
        state[items_at() + 2 * item] = count.x;
        state[items_at() + 2 * item + 1] = count.y;
        atomicAdd(sums[0], count.x);
        atomicAdd(sums[1], count.y);
    }
    barrier();
    const uint block = item / kTessBlockItems;
    if (gl_LocalInvocationID.x < 2 && block < tess_block_count(params.row_count, params.face_count))
        state[blocks_at() + 2 * block + gl_LocalInvocationID.x] = sums[gl_LocalInvocationID.x];
}
