// What the grid kernels read of a point and write of a sample. Before it: TILE_WORD(i), params; POINT(i), a float, and, where
// points can be read so, POINT_TEXEL(i), a vec3.
#include "limn/shared/octahedral.h"

layout(constant_id = kGridOutputConstant) const uint kOutput = kGridOutputNormal;
layout(constant_id = kGridWidthConstant) const uint kWidth = 3;
layout(constant_id = kGridAdjacentConstant) const uint kAdjacent = 0;
layout(constant_id = kGridRefinedConstant) const uint kRefined = 0;
const bool kNormals = kOutput == kGridOutputNormal || kOutput == kGridOutputPackedNormal;

layout(constant_id = kGridPointTexelsConstant) const uint kPointTexels = 0;

layout(std430, binding = kGridValuesBinding) writeonly buffer Values { float values[]; };
layout(std430, binding = kGridValuesBinding) writeonly buffer ValuePairs { vec2 value_pairs[]; };
layout(std430, binding = kGridValuesBinding) writeonly buffer ValueGroups { uvec4 value_groups[]; };
layout(std430, binding = kGridSecondBinding) writeonly buffer Second { float second[]; };
layout(std430, binding = kGridSecondBinding) writeonly buffer SecondWords { uint second_words[]; };
layout(std430, binding = kGridThirdBinding) writeonly buffer Third { float third[]; };

vec4 point_at(uint index) {
    const uint at = params.point_base + index * params.point_stride;
#ifdef POINT_TEXEL
    if (kPointTexels != 0) return vec4(POINT_TEXEL(at), 0);
#endif
    return vec4(POINT(at), kWidth > 1 ? POINT(at + 1) : 0, kWidth > 2 ? POINT(at + 2) : 0, kWidth > 3 ? POINT(at + 3) : 0);
}

// Which sample of the pass a word of a placement is; kGridNoSample: none. `face`: the second word of a surface.
uint sample_of(uint face, uint word) {
    if (word == kGridNoSample) return kGridNoSample;
    if (kRefined == 0) return face * params.samples_per_face + word;
    const uint slot = TILE_WORD(face + (word >> kGridOffsetBits));
    return slot == kGridNoSample ? kGridNoSample : slot + (word & (1u << kGridOffsetBits) - 1u);
}

vec3 scaled(vec3 v) {
    const vec3 size = abs(v);
    const float largest = max(size.x, max(size.y, size.z));
    return largest > 0 ? v / largest : vec3(0, 0, 1);
}

// A normal, not yet of unit length, for tangents of about unit size.
vec3 normal_of(vec3 du, vec3 dv, vec3 otherwise) {
    const vec3 n = cross(du, dv);
    const float longest = max(dot(du, du), dot(dv, dv));
    // The squared sine of the angle between tangents, times their relative lengths: below this only rounding is left.
    return dot(n, n) > 1e-13 * longest * longest ? n : otherwise;
}

uint packed_normal(vec3 n) {
    float e[2];
    octahedral_of(n.x, n.y, n.z, e);
    return packSnorm2x16(vec2(e[0], e[1]));
}

// What brings tangents to about unit size, so that squares are finite.
float unit_scale(vec3 size) { return 1 / max(max(size.x, max(size.y, size.z)), 1e-30); }

// Sample s of the pass; its derivatives are turned as its placement says. `otherwise`: the normal where tangents span no
// plane, not zero. `scale` brings tangents to about unit size.
void store_sample(uint s, uint placement, vec4 value, vec4 plan_du, vec4 plan_dv, vec3 otherwise, float scale) {
    const uint value_at = params.value_base + s * params.value_stride;
    const uint second_at = params.second_base + s * params.second_stride;
    vec3 n;
    if (kNormals) n = normal_of(plan_du.xyz * scale, plan_dv.xyz * scale, otherwise);
    // Of unit length, by one division, the costliest operation here on a CPU device; packed it needs none.
    if (kOutput == kGridOutputNormal) n *= inversesqrt(dot(n, n));
    if (kAdjacent != 0 && kOutput == kGridOutputPackedNormal) {
        value_groups[value_at / 4] = uvec4(floatBitsToUint(value.xyz), packed_normal(n));
        return;
    }
    if (kAdjacent != 0) {
        value_pairs[value_at / 2] = value.xy;
        value_pairs[value_at / 2 + 1] = vec2(value.z, n.x);
        value_pairs[value_at / 2 + 2] = n.yz;
        return;
    }
    for (uint c = 0; c < kWidth; ++c) values[value_at + c] = value[c];
    if (kOutput == kGridOutputNormal) {
        for (uint c = 0; c < 3; ++c) second[second_at + c] = n[c];
    }
    if (kOutput == kGridOutputPackedNormal) second_words[second_at] = packed_normal(n);
    if (kOutput == kGridOutputDerivatives) {
        const float uu = float(int(TILE_WORD(placement))), uv = float(int(TILE_WORD(placement + 1)));
        const float vu = float(int(TILE_WORD(placement + 2))), vv = float(int(TILE_WORD(placement + 3)));
        const vec4 du = plan_du * uu + plan_dv * vu, dv = plan_du * uv + plan_dv * vv;
        const uint third_at = params.third_base + s * params.third_stride;
        for (uint c = 0; c < kWidth; ++c) second[second_at + c] = du[c];
        for (uint c = 0; c < kWidth; ++c) third[third_at + c] = dv[c];
    }
}
