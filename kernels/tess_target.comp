// Rates that edges should have, before they are rounded (limn/shared/tess_rate.h).
// One invocation per rate edge.
// Reads: tables, local points, of mode per_edge the caller's rates, instances. Writes: targets; kTessNotFinite where points are not.
// Deterministic: each target is written once; the flag is the same whoever sets it.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"
#include "limn/patch_tree.glsl"
#include "limn/tess_instance.glsl"

const uint kRowX = 0, kRowY = 4, kRowW = 8, kViewport = 12, kValue = 14, kGiven = 15, kInstances = 16;

TessPoint edge_sample(uint edge, uint i) {
    float t, u, v;
    const uint row = row_of_rate_sample(edge_word(edge, 0), i, t);
    const uvec4 words = row_words(row);
    locate_on_row(words[2], t, u, v);
    const vec3 p = tree_point(params.tree, words[1], u, v);
    return TessPoint(p.x, p.y, p.z);
}

void main() {
    const uint edge = global_invocation();
    if (edge >= params.rate_edge_count) return;
    float target = 0;
    if (edge_word(edge, 0) != kNoRateEdge) {
        RateCamera camera;
        for (uint j = 0; j < 4; ++j) {
            camera.row_x[j] = params.payload[kRowX + j];
            camera.row_y[j] = params.payload[kRowY + j];
            camera.row_w[j] = params.payload[kRowW + j];
        }
        camera.width = params.payload[kViewport];
        camera.height = params.payload[kViewport + 1];
        // Where the rate does not depend on the surface, the middle is looked at to see whether it is a number.
        const bool looks = kMode != kRateUniform && kMode != kRatePerEdge;
        const bool placed = payload(kInstances) != kNoFace;
        const uint instance =
            placed ? instance_of(payload(kInstances), row_words(side_row(edge_word(edge, 0)))[1]) : 0;
        float scale = 1;
        if (placed) {
            scale = instances[instance].value_scale;
            if ((instances[instance].flags & kInstanceHidden) != 0) {
                state[kTessTargets + edge] = floatBitsToUint(0.0);
                return;
            }
        }
        TessPoint p[kRateSamples];
        if (looks) {
            for (uint i = 0; i < kRateSamples; ++i) {
                p[i] = edge_sample(edge, i);
                if (!placed) continue;
                const vec3 world = to_world(instance, vec3(p[i].x, p[i].y, p[i].z));
                p[i] = TessPoint(world.x, world.y, world.z);
            }
        } else {
            const TessPoint middle = edge_sample(edge, 2);
            p = TessPoint[kRateSamples](middle, middle, middle, middle, middle);
        }
        const float given =
            kMode == kRatePerEdge ? scale * SECOND(floatBitsToUint(params.payload[kGiven]) + edge) : 0.0;
        target = edge_target(kMode, scale * params.payload[kValue], given, params.max_rate, camera, p[0], p[1], p[2], p[3], p[4]);
        for (uint i = 0; i < kRateSamples; ++i)
            if (!is_finite_point(p[i])) state[kTessResultNotFinite] = 1;
    }
    state[kTessTargets + edge] = floatBitsToUint(target);
}
