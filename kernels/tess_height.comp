// Heights of vertices from a texture, at the texture coordinates that a face-varying channel gives them.
// Invocations as tess_vertices.
// Reads: tables, offsets, rates, local points of the channel, the texture. Writes: of each vertex the height and how it
// changes with u and v of its ptex face. Deterministic. kMode: the domain.
// Payload: 0, 1: base and stride of the output; 4, 5: vertices of the slice; 6, 7: heights are 6 * texel + 7
#version 450
#extension GL_GOOGLE_include_directive : require
#define LIMN_HEIGHT_TEXTURE
#include "limn/tess_bindings.glsl"
#include "limn/patch_tree.glsl"
#include "limn/shared/tess_steps.h"

layout(std430, binding = kTessOutBinding) writeonly buffer Out { float first_out[]; };

float height_at(uint face, float u, float v) {
    const Leaf leaf = find_leaf(params.tree, face, u, v);
    vec4 points[16], value, du, dv;
    load_leaf(leaf, points);
    evaluate_leaf(leaf, points, value, du, dv);
    return textureLod(height_texture, value.xy, 0).x * params.payload[6] + params.payload[7];
}

void visit(uint vertex, uint face, float u, float v) {
    TessStep steps[2];
    steps[0] = make_step(kTriangles != 0, 0, u, v, step_size(params.max_rate));
    steps[1] = make_step(kTriangles != 0, 1, u, v, step_size(params.max_rate));
    float height = 0, along[2] = float[2](0, 0);
    for (uint i = 0; i < 5; ++i) {
        const TessStep s = steps[i < 3 ? 0 : 1];
        const float t = i == 0 ? 0 : (i & 1) == 1 ? s.t1 : s.t2;
        const float here = height_at(face, u + t * s.u, v + t * s.v);
        if (i == 0)
            height = here;
        else
            along[i < 3 ? 0 : 1] += ((i & 1) == 1 ? s.w1 : s.w2) * (here - height);
    }
    // From the two directions, which span one or minus one, to u and v.
    const float area = steps[0].u * steps[1].v - steps[0].v * steps[1].u;
    const uint at = payload(0) + (vertex - payload(4)) * payload(1);
    first_out[at] = height;
    first_out[at + 1] = (along[0] * steps[1].v - along[1] * steps[0].v) / area;
    first_out[at + 2] = (along[1] * steps[0].u - along[0] * steps[1].u) / area;
}

#include "limn/tess_walk.glsl"
