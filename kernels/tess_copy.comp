// Seams: vertices that must have another's position get its bits.
// Corners: one invocation each; then rows, lane_count() invocations each. kMode: kTessCorners or kTessRows.
// Reads: tables, offsets, positions. Writes: positions of copies only. Deterministic.
// Payload: 0, 1: base and stride; 7: copies of this domain; 8: the first of them
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

layout(std430, binding = kTessOutBinding) buffer Out { float values[]; };

void copy_vertex(uint to, uint from) {
    const uint base = floatBitsToUint(params.payload[0]), stride = floatBitsToUint(params.payload[1]);
    for (uint c = 0; c < 3; ++c) values[base + to * stride + c] = values[base + from * stride + c];
}

void main() {
    const uint copy = shared_item();
    if (is_empty()) return;
    if (copy >= floatBitsToUint(params.payload[7])) return;
    const uint at = params.table.copies + 2 * (floatBitsToUint(params.payload[8]) + copy);
    if (kMode == kTessCorners) {
        copy_vertex(WORD(at), WORD(at + 1));
        return;
    }
    const uint to = WORD(at), to_begin = first_vertex(to), from_begin = first_vertex(WORD(at + 1));
    const uint count = first_vertex(to + 1) - to_begin;
    for (uint i = lane_of_item(); i < count; i += lane_count()) copy_vertex(to_begin + i, from_begin + i);
}
