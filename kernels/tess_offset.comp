// Where the vertices and triangles of each row and face begin.
// One invocation per row and face; a workgroup is a block.
// Reads: counts, where the block begins. Writes: offsets in place of counts. Deterministic.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

shared uvec2 sums[2][kTessWorkgroupSize];

void main() {
    const uint item = global_invocation(), lane = gl_LocalInvocationID.x, block = item / kTessBlockItems;
    const bool inside = item < item_count();
    const uint at = items_at() + 2 * min(item, item_count() - 1);
    const uvec2 count = inside ? uvec2(state[at], state[at + 1]) : uvec2(0);
    sums[0][lane] = count;
    barrier();
    uint now = 0;
    for (uint step = 1; step < kTessWorkgroupSize; step *= 2) {
        sums[1 - now][lane] = sums[now][lane] + (lane >= step ? sums[now][lane - step] : uvec2(0));
        now = 1 - now;
        barrier();
    }
    if (!inside) return;
    state[at] = state[blocks_at() + 2 * block] + sums[now][lane].x - count.x;
    state[at + 1] = state[blocks_at() + 2 * block + 1] + sums[now][lane].y - count.y;
}
