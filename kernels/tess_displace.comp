// Displacement: vertices move along their normals by a height each, and get the normals of the displaced surface.
// Invocations as tess_vertices.
// Reads: tables, offsets, rates, local points, heights. Writes: each position and, with kTessOutputNormal, normal once.
// Deterministic. kMode: the domain.
// Payload: 0 to 5 as tess_vertices; 6: base, 7: stride of heights, in floats: the height, and how it changes with u and v
// of the vertex's ptex face
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"
#include "limn/patch_tree.glsl"
#include "limn/shared/tess_steps.h"

layout(std430, binding = kTessOutBinding) writeonly buffer Out { float first_out[]; };
layout(std430, binding = kTessOut2Binding) writeonly buffer Out2 { float second_out[]; };

void visit(uint vertex, uint face, float u, float v) {
    const uint height_at = payload(6) + vertex * payload(7);
    const vec3 height = vec3(SECOND(height_at), SECOND(height_at + 1), SECOND(height_at + 2));
    TessStep steps[2];
    steps[0] = make_step(kTriangles != 0, 0, u, v, step_size(params.max_rate));
    steps[1] = make_step(kTriangles != 0, 1, u, v, step_size(params.max_rate));
    vec3 position, along[2] = vec3[2](vec3(0), vec3(0)), undisplaced = vec3(0, 0, 1);
    for (uint i = 0; i < 5; ++i) {
        // The place itself, then two along each direction.
        const TessStep s = steps[i < 3 ? 0 : 1];
        const float t = i == 0 ? 0 : (i & 1) == 1 ? s.t1 : s.t2;
        const Leaf leaf = find_leaf(params.tree, face, u + t * s.u, v + t * s.v);
        vec4 points[16], value, du, dv;
        load_leaf(leaf, points);
        evaluate_leaf(leaf, points, value, du, dv);
        const vec3 normal = unit_normal(du.xyz, dv.xyz);
        const vec3 moved = value.xyz + normal * (height.x + t * (s.u * height.y + s.v * height.z));
        if (i == 0) {
            position = moved;
            undisplaced = normal;
        } else {
            along[i < 3 ? 0 : 1] += ((i & 1) == 1 ? s.w1 : s.w2) * (moved - position);  // weights sum to zero
        }
    }
    const uint at = payload(0) + (vertex - payload(4)) * payload(1);
    first_out[at] = position.x;
    first_out[at + 1] = position.y;
    first_out[at + 2] = position.z;
    if (kOutput != kTessOutputNormal) return;
    const vec3 normal = spans_plane(along[0], along[1]) ? unit_normal(along[0], along[1]) : undisplaced;
    const uint second_at = payload(2) + (vertex - payload(4)) * payload(3);
    second_out[second_at] = normal.x;
    second_out[second_at + 1] = normal.y;
    second_out[second_at + 2] = normal.z;
}

#include "limn/tess_walk.glsl"
