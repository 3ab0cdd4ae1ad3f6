// Unit normals of pairs of tangents; (0, 0, 1) where they span no plane.
// One invocation per vertex. With LIMN_TEXEL tangents are uniform texel buffers.
// Reads: two tangents. Writes: three components of a normal; nothing between normals.
// Deterministic.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/normals_params.h"

layout(local_size_x = kNormalsWorkgroupSize) in;

#ifdef LIMN_TEXEL
layout(binding = kNormalsTangent1Binding) uniform textureBuffer tangents1;
layout(binding = kNormalsTangent2Binding) uniform textureBuffer tangents2;
#define TANGENT1(i) texelFetch(tangents1, int(i)).x
#define TANGENT2(i) texelFetch(tangents2, int(i)).x
#else
layout(std430, binding = kNormalsTangent1Binding) readonly buffer Tangents1 { float tangents1[]; };
layout(std430, binding = kNormalsTangent2Binding) readonly buffer Tangents2 { float tangents2[]; };
#define TANGENT1(i) tangents1[i]
#define TANGENT2(i) tangents2[i]
#endif
layout(std430, binding = kNormalsBinding) writeonly buffer Normals { float normals[]; };

layout(std430, push_constant) uniform Push { NormalsParams params; };

/// Of length one, or null: tangents shrink with the level, so that their squares may vanish.
vec3 unit(vec3 v) {
    const float size = max(abs(v.x), max(abs(v.y), abs(v.z)));
    return size > 0 ? normalize(v / size) : vec3(0);
}

void main() {
    const uint v = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kNormalsWorkgroupSize + gl_LocalInvocationID.x;
    if (v >= params.vertex_count) return;
    const uint t1 = params.tangent1_base + 3 * v, t2 = params.tangent2_base + 3 * v;
    const vec3 a = unit(vec3(TANGENT1(t1), TANGENT1(t1 + 1), TANGENT1(t1 + 2)));
    const vec3 b = unit(vec3(TANGENT2(t2), TANGENT2(t2 + 1), TANGENT2(t2 + 2)));
    const vec3 n = unit(cross(a, b));
    const vec3 normal = n == vec3(0) ? vec3(0, 0, 1) : n;
    const uint at = params.normal_base + v * params.normal_stride;
    for (uint i = 0; i < 3; ++i) normals[at + i] = normal[i];
}
