// Grids over regular patches, for CPU devices: one invocation per surface, which goes through its samples row by row.
// A CPU device runs eight invocations in the lanes of a vector: the basis is arithmetic that all lanes share, each ring
// point is fetched once a surface, and a row of samples has the sums over v in common. Half the CPU time of
// grid_eval_texel, which multiplies by a dense matrix (bigguy, rates 8 and 16); on a GPU stores would be far apart and invocations few.
// Reads: records and placements (limn/shared/grid_eval_params.h), ring indices, points.
// Writes: as grid_eval; kRefined: control points of a finer level in place of points of the surface; kCopied: so many points
// of the ring in their place, as they are.
// Deterministic: each sample is written once, and sums in order.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/grid_eval_params.h"
#include "limn/shared/patch_basis.h"

layout(binding = kGridPatchesBinding) uniform utextureBuffer patches;
layout(binding = kGridTilesBinding) uniform utextureBuffer tiles;
layout(binding = kGridPointsBinding) uniform textureBuffer points;
#define PATCH_WORD(i) texelFetch(patches, int(i)).x
#define TILE_WORD(i) texelFetch(tiles, int(i)).x
#define POINT(i) texelFetch(points, int(i)).x
#define POINT_TEXEL(i) texelFetch(points, int(i)).xyz

layout(local_size_x = kGridRowsWorkgroupSize) in;
layout(constant_id = kGridNarrowConstant) const uint kNarrow = 0;
layout(constant_id = kGridCopiedConstant) const uint kCopied = 0;

layout(std430, push_constant) uniform Push { GridEvalParams params; };
#include "limn/grid_points.glsl"

vec4 load_point(uint i) {
    const uint word = PATCH_WORD(params.ring_base + (kNarrow != 0 ? i / 2 : i));
    return point_at(kNarrow != 0 ? narrow_index(word, i) : word);
}

// Weights of four points for value and derivative at t; kRefined: for the control point there, `step_size` from the next.
void basis_at(float t, float step_size, out float f[4], out float d[4]) {
    float dd[4];
    cubic_basis(t, f, d, dd);
    if (kRefined != 0) refined_cubic_basis(t, step_size, f);
}

void main() {
    const uint invocation = gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x + gl_GlobalInvocationID.x;
    const bool inside = invocation < params.tile_count;
    const uint record = params.tile_base + kGridRecordWords * min(invocation, params.tile_count - 1);
    const uint first_ring = TILE_WORD(record), face = TILE_WORD(record + 1), placement = TILE_WORD(record + 2);
    const float inverse = 1 / float(params.rate);
    const float x = float(int(TILE_WORD(placement + 4))) * inverse, y = float(int(TILE_WORD(placement + 5))) * inverse;
    const float steps = float(int(TILE_WORD(placement + 6))), step_size = steps * inverse;
    const uint columns = TILE_WORD(placement + 7), rows = TILE_WORD(placement + 8);

    vec4 ring[16];
    [[unroll]] for (uint k = 0; k < 16; ++k) ring[k] = load_point(first_ring + k);
    if (kCopied != 0) {
        [[unroll]] for (uint k = 0; k < 16; ++k) {
            precise vec4 value = ring[k] - ring[0];  // to the bit what the matrix of grid_eval gives
            value += ring[0];
            if (inside && k < kCopied) store_sample(sample_of(face, k), placement, value, vec4(0), vec4(0), vec3(0), 1);
        }
        return;
    }
    const vec4 origin = ring[0];
    vec3 size = vec3(0);
    [[unroll]] for (uint k = 0; k < 16; ++k) {
        ring[k] -= origin;
        size = max(size, abs(ring[k].xyz));
    }
    const float scale = unit_scale(size);
    const vec3 otherwise = scaled(cross(ring[10].xyz - ring[5].xyz, ring[9].xyz - ring[6].xyz));

    for (uint j = 0; j < rows; ++j) {
        float b[4], db[4];
        basis_at(y + float(j) * step_size, step_size, b, db);
        vec4 sums[4], slopes[4];  // over v, of each column of points
        [[unroll]] for (uint i = 0; i < 4; ++i) {
            sums[i] = b[0] * ring[i] + b[1] * ring[4 + i] + b[2] * ring[8 + i] + b[3] * ring[12 + i];
            slopes[i] = db[0] * ring[i] + db[1] * ring[4 + i] + db[2] * ring[8 + i] + db[3] * ring[12 + i];
        }
        for (uint i = 0; i < columns; ++i) {
            const uint s = sample_of(face, TILE_WORD(placement + kGridRowsHeader + j * columns + i));
            float a[4], da[4];
            basis_at(x + float(i) * step_size, step_size, a, da);
            const vec4 value = a[0] * sums[0] + a[1] * sums[1] + a[2] * sums[2] + a[3] * sums[3];
            const vec4 du = da[0] * sums[0] + da[1] * sums[1] + da[2] * sums[2] + da[3] * sums[3];
            const vec4 dv = a[0] * slopes[0] + a[1] * slopes[1] + a[2] * slopes[2] + a[3] * slopes[3];
            if (inside && s != kGridNoSample)
                store_sample(s, placement, value + origin, steps * du, steps * dv, otherwise, scale);
        }
    }
}
