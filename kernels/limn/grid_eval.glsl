// The body of the grid_eval kernels. Before it: PATCH_WORD(i), TILE_WORD(i), uints; WEIGHTS(i), a vec4; POINT(i), a
// float.

layout(local_size_x_id = 4) in;
layout(constant_id = kGridGroupsConstant) const uint kGroups = 4;
layout(constant_id = kGridOutputConstant) const uint kOutput = kGridOutputNormal;
layout(constant_id = kGridWidthConstant) const uint kWidth = 3;
layout(constant_id = kGridNarrowConstant) const uint kNarrow = 0;
layout(constant_id = kGridValueCountConstant) const uint kValueCount = 3;

layout(std430, push_constant) uniform Push { GridEvalParams params; };
layout(std430, binding = kGridValuesBinding) writeonly buffer Values { float values[]; };
layout(std430, binding = kGridSecondBinding) writeonly buffer Second { float second[]; };
layout(std430, binding = kGridThirdBinding) writeonly buffer Third { float third[]; };

const uint kRing = 4 * kGroups;
const uint kMaxGroups = 8;
shared float ring[kGridTileSurfaces * kRing * kWidth];

uint ring_index(uint i) {
    const uint word = PATCH_WORD(params.ring_base + (kNarrow != 0 ? i / 2 : i));
    return kNarrow != 0 ? narrow_index(word, i) : word;
}

// Ring points [first, first + kRing) of the tile's surfaces into shared memory; past the last they repeat it.
void load_rings(uint tile, uint surface_count, uint ring_size, uint first) {
    for (uint i = gl_LocalInvocationID.x; i < kGridTileSurfaces * kRing; i += gl_WorkGroupSize.x) {
        const uint t = min(i / kRing, surface_count - 1), j = min(first + i % kRing, ring_size - 1);
        const uint at = params.point_base + ring_index(TILE_WORD(tile + 4 + 3 * t) + j) * params.point_stride;
        for (uint c = 0; c < kWidth; ++c) ring[i * kWidth + c] = POINT(at + c);
    }
}

vec4 ring_point(uint t, uint j) {
    const uint at = (t * kRing + j) * kWidth;
    return vec4(ring[at], kWidth > 1 ? ring[at + 1] : 0, kWidth > 2 ? ring[at + 2] : 0, kWidth > 3 ? ring[at + 3] : 0);
}

// A unit vector for any tangents: where they do not span a plane, the normal of the surface's four corners.
vec3 normal_of(vec3 du, vec3 dv, uint tile, uint t) {
    vec3 largest = max(abs(du), abs(dv));
    float scale = max(largest.x, max(largest.y, largest.z));
    vec3 n = scale > 0 ? cross(du / scale, dv / scale) : vec3(0);
    // Squared sine of the angle between tangents, times their relative lengths: below this only rounding is left.
    if (!(dot(n, n) > 1e-13)) {
        const uint slots = TILE_WORD(tile + 3), first_ring = TILE_WORD(tile + 4 + 3 * t);
        vec3 corner[4];
        for (uint k = 0; k < 4; ++k) {
            const uint index = ring_index(first_ring + (slots >> 8 * k & 255));
            const uint at = params.point_base + index * params.point_stride;
            corner[k] = vec3(POINT(at), POINT(at + 1), POINT(at + 2));
        }
        n = cross(corner[2] - corner[0], corner[3] - corner[1]);
        largest = abs(n);
        scale = max(largest.x, max(largest.y, largest.z));
        n = scale > 0 ? n / scale : vec3(0, 0, 1);
    }
    return normalize(n);
}

void store(uint t, uint tile, uint sample_index, vec4 sums[3]) {
    const uint at = tile + 4 + 3 * t;
    const uint placement = TILE_WORD(at + 2);
    const uint out_sample = TILE_WORD(placement + kGridPlacementHeader + sample_index);
    if (out_sample == kGridNoSample) return;
    const uint s = TILE_WORD(at + 1) * params.samples_per_face + out_sample;
    const uint value_at = params.value_base + s * params.value_stride;
    for (uint c = 0; c < kWidth; ++c) values[value_at + c] = sums[0][c];
    if (kOutput == kGridOutputNormal) {
        const vec3 n = normal_of(sums[1].xyz, sums[2].xyz, tile, t);
        const uint second_at = params.second_base + s * params.second_stride;
        for (uint c = 0; c < 3; ++c) second[second_at + c] = n[c];
    }
    if (kOutput == kGridOutputDerivatives) {
        const float uu = float(int(TILE_WORD(placement))), uv = float(int(TILE_WORD(placement + 1)));
        const float vu = float(int(TILE_WORD(placement + 2))), vv = float(int(TILE_WORD(placement + 3)));
        const vec4 du = sums[1] * uu + sums[2] * vu, dv = sums[1] * uv + sums[2] * vv;
        const uint second_at = params.second_base + s * params.second_stride;
        const uint third_at = params.third_base + s * params.third_stride;
        for (uint c = 0; c < kWidth; ++c) second[second_at + c] = du[c];
        for (uint c = 0; c < kWidth; ++c) third[third_at + c] = dv[c];
    }
}

void main() {
    // Nothing here diverges before results are stored: shared memory is then read once for all lanes on CPU devices.
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint tile_index = min(group / params.chunk_count, params.tile_count - 1);
    const uint invocation = group % params.chunk_count * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    const uint sample_index = min(invocation, params.sample_count - 1);
    const uint tile = params.tile_base + tile_index * kGridTileWords;
    const uint weight = TILE_WORD(tile) + sample_index, surface_count = TILE_WORD(tile + 1);
    const uint ring_size = TILE_WORD(tile + 2);

    vec4 sums[kGridTileSurfaces][3];
    for (uint t = 0; t < kGridTileSurfaces; ++t)
        for (uint k = 0; k < kValueCount; ++k) sums[t][k] = vec4(0);
    for (uint load = 0; load < params.load_count; ++load) {
        if (load != 0) barrier();
        load_rings(tile, surface_count, ring_size, load * kRing);
        barrier();
        vec4 weights[kMaxGroups * 3];
        const uint first = weight + load * kGroups * kValueCount * params.sample_count;
        [[unroll]] for (uint i = 0; i < kGroups * kValueCount; ++i) weights[i] = WEIGHTS(first + i * params.sample_count);
        [[unroll]] for (uint t = 0; t < kGridTileSurfaces; ++t)
            [[unroll]] for (uint g = 0; g < kGroups; ++g)
                [[unroll]] for (uint c = 0; c < 4; ++c) {
                    const vec4 point = ring_point(t, 4 * g + c);
                    [[unroll]] for (uint k = 0; k < kValueCount; ++k)
                        sums[t][k] += weights[g * kValueCount + k][c] * point;
                }
    }
    const bool inside = group < params.tile_count * params.chunk_count && invocation < params.sample_count;
    [[unroll]] for (uint t = 0; t < kGridTileSurfaces; ++t)
        if (inside && t < surface_count) store(t, tile, sample_index, sums[t]);
}
