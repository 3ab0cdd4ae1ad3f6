// A draw command for each instance: its triangles follow each other, as its faces do.
// One invocation per instance.
// Reads: tables, offsets. Writes: VkDrawIndexedIndirectCommand each. Deterministic.
// Payload: 0: where commands begin, in words; 1: where instances are in the tables; 2: times its number is firstInstance
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

layout(std430, binding = kTessOutBinding) writeonly buffer Commands { uint commands[]; };

void main() {
    const uint range = global_invocation(), ranges = payload(1), count = WORD(ranges);
    if (range >= count) return;
    uint first = 0, end = 0;
    if (!is_empty()) {
        first = first_triangle(params.row_count + WORD(ranges + 1 + range));
        end = first_triangle(params.row_count + WORD(ranges + 2 + range));
    }
    const uint instance = WORD(ranges + 2 + count + range), at = payload(0) + kTessCommandWords * instance;
    commands[at] = 3 * (end - first);
    commands[at + 1] = 1;
    commands[at + 2] = 3 * first;
    commands[at + 3] = 0;
    commands[at + 4] = instance * payload(2);
}
