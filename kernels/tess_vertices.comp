// Vertices of a tessellation: what each has at its place (tess_params.h, kTessOutput...).
// Corners: one invocation each. Rows and faces: lane_count() invocations each, which take turns.
// Reads: tables, offsets, rates, local points. Writes: each vertex once; of them those within the slice that is bound.
// Deterministic. kMode: the domain.
// Payload: 0, 1: base and stride of the output; 2, 3: of the second; 4, 5: vertices of the slice, first and end, 6: width;
// 7 to 10: TreeOffsets of the channel that tangents follow, or kNoFace
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"
#include "limn/patch_tree.glsl"

layout(std430, binding = kTessOutBinding) writeonly buffer Out { float first_out[]; };
layout(std430, binding = kTessOutBinding) writeonly buffer OutWords { uint first_out_words[]; };
layout(std430, binding = kTessOut2Binding) writeonly buffer Out2 { float second_out[]; };

// The direction in which the first texture coordinate grows, at right angles to the normal; w: whether the second one grows
// along cross(normal, tangent), 1, or against it, -1.
vec4 tangent_at(uint face, float u, float v, vec3 du, vec3 dv, vec3 normal) {
    vec3 along = du;
    float turned = 1;
    if (payload(7) != kNoFace) {
        const Leaf leaf = find_leaf(TreeOffsets(payload(7), payload(8), payload(9), payload(10)), face, u, v);
        vec4 points[16], value, s, t;
        load_second_leaf(leaf, points);
        evaluate_leaf(leaf, points, value, s, t);
        const float area = s.x * t.y - t.x * s.y;
        turned = area < 0 ? -1 : 1;
        if (area != 0) along = turned * (du * t.y - dv * s.y);
    }
    const float whole = dot(along, along);
    along -= dot(along, normal) * normal;
    const float square = dot(along, along);
    if (square > 1e-8 * whole) {
        along *= inversesqrt(square);
        return vec4(normalize(along - dot(along, normal) * normal), turned);
    }
    const vec3 other = abs(normal.x) < 0.5 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    return vec4(normalize(cross(normal, other)), turned);
}

void store_place(uint at, uint face, float u, float v) {
    const Leaf leaf = find_leaf(params.tree, face, u, v);
    first_out_words[at] = face;
    first_out[at + 1] = u;
    first_out[at + 2] = v;
    first_out_words[at + 3] = leaf.kind | leaf.level << 8;
}

void visit(uint vertex, uint face, float u, float v) {
    const uint at = payload(0) + (vertex - payload(4)) * payload(1);
    if (kOutput == kTessOutputPlace) {
        store_place(at, face, u, v);
        return;
    }
    vec4 value, du, dv;
    // Where tangents span no plane (collapsed edges, cusps), the normal is that of a place further inside.
    for (uint attempt = 0; attempt < 2; ++attempt) {
        const float middle = kTriangles != 0 ? 1.0 / 3.0 : 0.5, inwards = float(attempt) * 0.25;
        const Leaf leaf = find_leaf(params.tree, face, mix(u, middle, inwards), mix(v, middle, inwards));
        vec4 points[16], here;
        load_leaf(leaf, points);
        evaluate_leaf(leaf, points, here, du, dv);
        if (attempt == 0) value = here;
        if (kOutput == kTessOutputValue || spans_plane(du.xyz, dv.xyz)) break;
    }
    if (kOutput == kTessOutputValue) {
        const uint width = payload(6);
        first_out[at] = value.x;
        if (width > 1) first_out[at + 1] = value.y;
        if (width > 2) first_out[at + 2] = value.z;
        if (width > 3) first_out[at + 3] = value.w;
        return;
    }
    const vec3 normal = unit_normal(du.xyz, dv.xyz);
    if (kOutput == kTessOutputTangent) {
        const vec4 tangent = tangent_at(face, u, v, du.xyz, dv.xyz, normal);
        first_out[at] = tangent.x;
        first_out[at + 1] = tangent.y;
        first_out[at + 2] = tangent.z;
        first_out[at + 3] = tangent.w;
        return;
    }
    first_out[at] = value.x;
    first_out[at + 1] = value.y;
    first_out[at + 2] = value.z;
    const uint second_at = payload(2) + (vertex - payload(4)) * payload(3);
    second_out[second_at] = normal.x;
    second_out[second_at + 1] = normal.y;
    second_out[second_at + 2] = normal.z;
}

#include "limn/tess_walk.glsl"
