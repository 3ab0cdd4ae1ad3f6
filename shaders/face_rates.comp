#version 450
// The rate of each ptex face, for colours: across its sides, from the rates that the tessellator gave to edges.
#extension GL_GOOGLE_include_directive : require
#include "limn/shared/tess_params.h"

layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Words {
    uint words[];  // of the tessellation table
};
layout(std430, set = 0, binding = 1) readonly buffer State {
    uint state[];  // of the tessellation
};
layout(std430, set = 0, binding = 2) writeonly buffer FaceRates {
    uint face_rates[];
};
layout(push_constant) uniform Push {
    uint faces, rows;  // where they begin in the table
    uint rates;        // and in the state
    uint face_count;
} push;

float side_rate(uint side) {
    if (side == kNoSide) return 0.0;
    const uint edge = words[push.rows + kTessRowWords * side_row(side)];
    if (edge == kNoRateEdge) return 0.0;
    return float(state[push.rates + edge]) / float(kRateOne) * ((side & kSideHalves) != 0u ? 2.0 : 1.0);
}

void main() {
    const uint face = gl_GlobalInvocationID.x;
    if (face >= push.face_count) return;
    const uint at = push.faces + kTessFaceWords * face;
    const float a = side_rate(words[at]), b = side_rate(words[at + 1u]), c = side_rate(words[at + 2u]);
    const bool triangle = words[at + 3u] == kNoSide;
    const float u = triangle ? max(a, max(b, c)) : max(a, c);
    const float v = triangle ? u : max(b, side_rate(words[at + 3u]));
    face_rates[face] = uint(u + 0.5) | uint(v + 0.5) << 16;
}
