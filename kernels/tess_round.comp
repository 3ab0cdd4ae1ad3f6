// Targets, times the scale that the result holds, to rates.
// One invocation per rate edge.
// Reads: tables, targets, the scale. Writes: rates. Deterministic.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

// Payload: 0: whether targets were measured along the edge itself.
void main() {
    const uint edge = global_invocation();
    if (edge >= params.rate_edge_count) return;
    const float scale = uintBitsToFloat(SETTLED(kTessResultScale));
    state[rates_at() + edge] =
        round_rate(uintBitsToFloat(SETTLED(kTessTargets + edge)), scale, kSpacing, params.max_rate, edge_word(edge, 0),
                   params.payload[0] != 0, scale < 1 ? rate_dither(edge) : -1.0);
}
