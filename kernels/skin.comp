// Control points in a pose: rest points, moved by morph targets, then by joints (linear blend skinning).
// One invocation per point of an instance (limn/shared/skin_params.h). With LIMN_TEXEL all that is read is uniform texel
// buffers.
// Reads: the table, joint matrices, weights of morph targets. Writes: three components of a point; nothing between points.
// Deterministic: each point sums its morphs, and blends its matrices, in the table's order.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/skin_params.h"

layout(local_size_x = kSkinWorkgroupSize) in;

#ifdef LIMN_TEXEL
layout(binding = kSkinWordsBinding) uniform utextureBuffer words;
layout(binding = kSkinMatricesBinding) uniform textureBuffer matrix_rows;
layout(binding = kSkinWeightsBinding) uniform textureBuffer morph_weights;
#define WORD(i) texelFetch(words, int(i)).x
#define MATRIX_ROW(i) texelFetch(matrix_rows, int(i))
#define MORPH_WEIGHT(i) texelFetch(morph_weights, int(i)).x
#else
layout(std430, binding = kSkinWordsBinding) readonly buffer Words { uint words[]; };
layout(std430, binding = kSkinMatricesBinding) readonly buffer MatrixRows { vec4 matrix_rows[]; };
layout(std430, binding = kSkinWeightsBinding) readonly buffer MorphWeights { float morph_weights[]; };
#define WORD(i) words[i]
#define MATRIX_ROW(i) matrix_rows[i]
#define MORPH_WEIGHT(i) morph_weights[i]
#endif
#define FLOAT(i) uintBitsToFloat(WORD(i))
layout(std430, binding = kSkinPointsBinding) writeonly buffer Points { float points[]; };

layout(std430, push_constant) uniform Push { SkinParams params; };

SkinInstance load_instance(uint instance) {
    const uint at = params.table.instances + kSkinInstanceWords * instance;
    return SkinInstance(WORD(at), WORD(at + 1), WORD(at + 2), WORD(at + 3));
}

SkinMeshRange load_mesh(uint mesh) {
    const uint at = params.table.meshes + kSkinMeshWords * mesh;
    return SkinMeshRange(WORD(at), WORD(at + 1), WORD(at + 2), WORD(at + 3));
}

vec3 load_vector(uint at) {
    return vec3(FLOAT(at), FLOAT(at + 1), FLOAT(at + 2));
}

/// `point` is one of the table's.
vec3 morph_point(uint point, uint first_weight) {
    vec3 sum = load_vector(params.table.rest_points + 3 * point);
    const uint end = WORD(params.table.morph_offsets + point + 1);
    for (uint m = WORD(params.table.morph_offsets + point); m < end; ++m) {
        const uint at = params.table.morphs + kSkinMorphWords * m;
        sum += MORPH_WEIGHT(params.weight_base + first_weight + WORD(at)) * load_vector(at + 1);
    }
    return sum;
}

vec3 skin_point(vec3 point, uint first_influence, uint influence_count, uint first_joint) {
    vec4 rows[kSkinMatrixRows] = vec4[kSkinMatrixRows](vec4(0), vec4(0), vec4(0));
    for (uint k = 0; k < influence_count; ++k) {
        const uint at = params.table.influences + kSkinInfluenceWords * (first_influence + k);
        const uint first_row = params.matrix_base + kSkinMatrixRows * (first_joint + WORD(at));
        const float weight = FLOAT(at + 1);
        for (uint r = 0; r < kSkinMatrixRows; ++r) rows[r] += weight * MATRIX_ROW(first_row + r);
    }
    const vec4 p = vec4(point, 1);
    return vec3(dot(rows[0], p), dot(rows[1], p), dot(rows[2], p));
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (group >= params.group_count) return;
    const uint group_at = params.table.groups + kSkinGroupWords * group;
    const SkinInstance instance = load_instance(WORD(group_at));
    const SkinMeshRange mesh = load_mesh(instance.mesh);
    const uint p = WORD(group_at + 1) + gl_LocalInvocationID.x;
    if (p >= mesh.point_count) return;

    vec3 point = morph_point(mesh.first_point + p, instance.first_morph_weight);
    if (mesh.influence_count != 0)
        point = skin_point(point, mesh.first_influence + p * mesh.influence_count, mesh.influence_count, instance.first_joint);
    const uint at = params.point_base + (instance.first_point + p) * params.point_stride;
    for (uint i = 0; i < 3; ++i) points[at + i] = point[i];
}
