// The body of the grid_eval kernels. Before it: PATCH_WORD(i), TILE_WORD(i), uints; WEIGHTS(i), a vec4; POINT(i), a
// float.
//
// CPU devices run eight invocations in the lanes of a vector. There, shared memory at constant offsets is read once for
// all lanes, as long as nothing diverges and no loop is left (hence all the unrolling), while each fetch from a buffer
// is a function call for each lane's sake, and both sides of a branch are run: so all that surfaces have in common goes
// through shared memory, and nothing is fetched late.

layout(local_size_x_id = 4) in;
layout(constant_id = kGridGroupsConstant) const uint kGroups = 4;
layout(constant_id = kGridNarrowConstant) const uint kNarrow = 0;
layout(constant_id = kGridValueCountConstant) const uint kValueCount = 3;
layout(constant_id = kGridLoadsConstant) const uint kLoads = 1;
layout(constant_id = kGridCornersConstant) const uint kCorners = kGridCornersFirst;
layout(constant_id = kGridSurfacesConstant) const uint kSurfaces = 4;

layout(std430, push_constant) uniform Push { GridEvalParams params; };
#include "limn/grid_points.glsl"
const uint kMaxGroups = 8;
const uint kRing = 4 * kGroups;
const uint kTileWords = kGridTileHeader + kGridTileSurfaceWords * kSurfaces;
shared vec4 ring[kSurfaces * kRing];
shared uint tile_words[kTileWords];

uint ring_index(uint i) {
    const uint word = PATCH_WORD(params.ring_base + (kNarrow != 0 ? i / 2 : i));
    return kNarrow != 0 ? narrow_index(word, i) : word;
}

// Ring points [first, first + kRing) of the tile's surfaces into shared memory; past the last they repeat it.
void load_rings(uint tile, uint surface_count, uint ring_size, uint first) {
    const uint count = kSurfaces * kRing;
    [[unroll]] for (uint round = 0; round < (count - 1) / gl_WorkGroupSize.x + 1; ++round) {
        const uint i = min(round * gl_WorkGroupSize.x + gl_LocalInvocationID.x, count - 1);
        const uint t = min(i / kRing, surface_count - 1), j = min(first + i % kRing, ring_size - 1);
        ring[i] = point_at(ring_index(TILE_WORD(tile + kGridTileHeader + kGridTileSurfaceWords * t) + j));
    }
}

vec4 ring_point(uint t, uint j) {
    return ring[t * kRing + j];
}

// The normal of the surface's four corners: what is left where tangents do not span a plane. Not yet of unit length.
vec3 corner_normal(uint t) {
    const uint a = kCorners == kGridCornersBicubic ? 5 : kCorners == kGridCornersBoxSpline ? 4 : 0;
    const uint b = kCorners == kGridCornersBicubic ? 6 : kCorners == kGridCornersBoxSpline ? 5 : 1;
    const uint c = kCorners == kGridCornersBicubic ? 10 : kCorners == kGridCornersBoxSpline ? 8 : 2;
    const uint d = kCorners == kGridCornersBicubic ? 9 : kCorners == kGridCornersBoxSpline ? 8 : kCorners;
    return cross(ring_point(t, c).xyz - ring_point(t, a).xyz, ring_point(t, d).xyz - ring_point(t, b).xyz);
}

// Values are relative to `origin`, the surface's first ring point, which matters where meshes lie far out.
struct Sums {
    vec4 values[3];
    vec4 origin;
    vec3 otherwise;
};

// Loads ring points [first, first + kRing) and adds what they weigh.
void add_ring(uint tile, uint surface_count, uint ring_size, uint first, uint weight,
              inout Sums sums[kSurfaces]) {
    load_rings(tile, surface_count, ring_size, first);
    barrier();
    vec4 weights[kMaxGroups * 3];
    [[unroll]] for (uint i = 0; i < kGroups * kValueCount; ++i) weights[i] = WEIGHTS(weight + i * params.sample_count);
    [[unroll]] for (uint t = 0; t < kSurfaces; ++t) {
        if (first == 0) sums[t].origin = ring_point(t, 0);
        if (kNormals && first == 0) sums[t].otherwise = scaled(corner_normal(t));
        [[unroll]] for (uint g = 0; g < kGroups; ++g)
            [[unroll]] for (uint c = 0; c < 4; ++c) {
                const vec4 point = ring_point(t, 4 * g + c) - sums[t].origin;
                [[unroll]] for (uint k = 0; k < kValueCount; ++k)
                    sums[t].values[k] += weights[g * kValueCount + k][c] * point;
            }
    }
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint tile_index = min(group / params.chunk_count, params.tile_count - 1);
    const uint invocation = group % params.chunk_count * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    const uint sample_index = min(invocation, params.sample_count - 1);
    const uint tile = params.tile_base + tile_index * kTileWords;
    const uint weight = TILE_WORD(tile) + sample_index, surface_count = TILE_WORD(tile + 1);
    const uint ring_size = TILE_WORD(tile + 2);
    [[unroll]] for (uint round = 0; round < (kTileWords - 1) / gl_WorkGroupSize.x + 1; ++round) {
        const uint i = min(round * gl_WorkGroupSize.x + gl_LocalInvocationID.x, kTileWords - 1);
        tile_words[i] = TILE_WORD(tile + i);
    }

    Sums sums[kSurfaces];
    [[unroll]] for (uint t = 0; t < kSurfaces; ++t) {
        for (uint k = 0; k < 3; ++k) sums[t].values[k] = vec4(0);
        sums[t].origin = vec4(0);
        sums[t].otherwise = vec3(0, 0, 1);
    }
    if (kLoads == 1) {
        add_ring(tile, surface_count, ring_size, 0, weight, sums);
    } else {
        for (uint load = 0; load < kLoads; ++load) {
            if (load != 0) barrier();
            // Part by part: long sums lose fewer bits.
            Sums part[kSurfaces];
            [[unroll]] for (uint t = 0; t < kSurfaces; ++t) {
                part[t] = sums[t];
                for (uint k = 0; k < 3; ++k) part[t].values[k] = vec4(0);
            }
            add_ring(tile, surface_count, ring_size, load * kRing,
                     weight + load * kGroups * kValueCount * params.sample_count, part);
            [[unroll]] for (uint t = 0; t < kSurfaces; ++t) {
                for (uint k = 0; k < 3; ++k) part[t].values[k] += sums[t].values[k];
                sums[t] = part[t];
            }
        }
    }
    const bool inside = group < params.tile_count * params.chunk_count && invocation < params.sample_count;
    [[unroll]] for (uint t = 0; t < kSurfaces; ++t) {
        const uint placement = tile_words[kGridTileHeader + kGridTileSurfaceWords * t + 2];
        const uint face = tile_words[kGridTileHeader + kGridTileSurfaceWords * t + 1];
        const uint word = TILE_WORD(placement + kGridPlacementHeader + sample_index), s = sample_of(face, word);
        if (!inside || t >= surface_count || s == kGridNoSample) continue;
        const float scale = unit_scale(max(abs(sums[t].values[1].xyz), abs(sums[t].values[2].xyz)));
        const vec4 origin = kOutput != kGridOutputRelative || word == 0 ? sums[t].origin : vec4(0);
        store_sample(s, placement, sums[t].values[0] + origin, sums[t].values[1], sums[t].values[2], sums[t].otherwise, scale);
    }
}
