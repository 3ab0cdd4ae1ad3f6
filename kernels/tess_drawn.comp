// Which faces are drawn: none with an edge of rate 0, and none that culling leaves out.
// One invocation per ptex face.
// Reads: tables, targets, instances, local points where something is culled. Writes: the flag of each face. Deterministic.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"
#include "limn/patch_tree.glsl"
#include "limn/tess_instance.glsl"

const uint kRowX = 0, kRowY = 4, kRowW = 8, kEye = 12, kBound = 16, kInstances = 17;

uint instance = 0;
bool is_placed() { return payload(kInstances) != kNoFace; }

float side_distance(uint row, float sign_of, vec3 p, out float slope) {
    vec4 plane = vec4(params.payload[kRowW], params.payload[kRowW + 1], params.payload[kRowW + 2],
                            params.payload[kRowW + 3]) +
                       sign_of * vec4(params.payload[row], params.payload[row + 1], params.payload[row + 2],
                                      params.payload[row + 3]);
    if (is_placed()) plane = plane_to_object(instance, plane);
    slope = length(plane.xyz);
    return dot(plane.xyz, p) + plane.w;
}

// All hull points, and what displacement may add, on the wrong side of one plane of the frustum.
bool is_outside(uint face) {
    const uint word = WORD(params.tree.ptex_surfaces + face);
    const uint first = word & ~kPtexSplit, count = (word & kPtexSplit) != 0 ? 4 : 1;
    uint outside = 15;
    for (uint s = first; s < first + count; ++s) {
        const uint at = params.tree.surfaces + 3 * s, local = WORD(at + 1), hull = WORD(at + 2);
        for (uint i = 0; i < hull && outside != 0; ++i) {
            const vec3 p = LOCAL(local + i).xyz;
            for (uint plane = 0; plane < 4; ++plane) {
                float slope;
                const float d = side_distance(plane < 2 ? kRowX : kRowY, (plane & 1) == 0 ? 1.0 : -1.0, p, slope);
                if (!(d < -slope * params.payload[kBound])) outside &= ~(1u << plane);
            }
        }
    }
    return outside != 0;
}

// Nine normals of the face, and twice the angle that they spread over, lie on the far side. No bound, but what is left out
// by mistake would have to bend by more than that between samples.
bool is_turned_away(uint face) {
    vec4 eye = vec4(params.payload[kEye], params.payload[kEye + 1], params.payload[kEye + 2],
                          params.payload[kEye + 3]);
    if (is_placed()) eye = eye_to_object(instance, eye);
    vec3 normals[9], positions[9], axis = vec3(0), middle = vec3(0);
    for (uint i = 0; i < 9; ++i) {
        float u = float(i % 3) * 0.5, v = float(i / 3) * 0.5;
        if (kTriangles != 0 && u + v > 1) {
            u = (1 - u) * 0.5;  // once more inside
            v = (1 - v) * 0.5;
        }
        const Leaf leaf = find_leaf(params.tree, face, u, v);
        vec4 points[16], value, du, dv;
        load_leaf(leaf, points);
        evaluate_leaf(leaf, points, value, du, dv);
        normals[i] = unit_normal(du.xyz, dv.xyz);
        positions[i] = value.xyz;
        axis += normals[i];
        middle += value.xyz / 9.0;
    }
    if (!(length(axis) > 0)) return false;
    axis = normalize(axis);
    float least = 1, radius = 0;
    for (uint i = 0; i < 9; ++i) {
        least = min(least, dot(axis, normals[i]));
        radius = max(radius, distance(middle, positions[i]));
    }
    const vec3 view = eye.xyz - eye.w * middle;  // towards the eye
    const float far = length(view), reach = eye.w * (2 * radius + params.payload[kBound]);
    if (!(far > reach)) return false;
    const float spread = 2 * acos(clamp(least, -1.0, 1.0)) + 0.1 + asin(min(reach / far, 1.0));
    return spread < 1.57 && dot(axis, view) < -sin(spread) * far;
}

void main() {
    const uint face = global_invocation();
    if (face >= params.face_count) return;
    bool drawn = true;
    uint flags = 0;
    if (is_placed()) {
        instance = instance_of(payload(kInstances), face);
        flags = instances[instance].flags;
        drawn = (flags & kInstanceHidden) == 0;
    }
    const uvec4 sides = face_sides(face);
    [[unroll]] for (uint k = 0; k < (kTriangles != 0 ? 3 : 4); ++k) {
        const uint side = sides[k];
        const float target = uintBitsToFloat(SETTLED(kTessTargets + row_edge(side_row(side == kNoSide ? 0 : side))));
        drawn = drawn && side != kNoSide && is_finite_number(target) && target > 0;
    }
    if (drawn && (kMode & kTessCullOutside) != 0 && (flags & kInstanceKeepOutside) == 0) drawn = !is_outside(face);
    if (drawn && (kMode & kTessCullBackfaces) != 0 && (flags & kInstanceKeepBackfaces) == 0) drawn = !is_turned_away(face);
    state[drawn_at() + face] = drawn ? 1 : 0;
}
