// OpenSubdiv's patches: primvars and their derivatives at a list of patch coordinates, by OpenSubdiv's own tables.
// One invocation per coordinate (limn/shared/osd_patch_eval_params.h). With LIMN_TEXEL all that is read is uniform texel
// buffers.
// Reads: patch arrays, control vertex indices, patch params, patch coordinates, source points.
// Writes: up to four components of up to three points; zeros where a coordinate names no patch.
// Deterministic: each point sums its control vertices in order.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/osd_patch.h"
#include "limn/shared/osd_patch_eval_params.h"

#ifdef LIMN_TEXEL
layout(binding = kOsdArraysBinding) uniform utextureBuffer arrays;
layout(binding = kOsdIndicesBinding) uniform utextureBuffer indices;
layout(binding = kOsdParamsBinding) uniform utextureBuffer patch_params;
layout(binding = kOsdCoordsBinding) uniform utextureBuffer coords;
layout(binding = kOsdSourceBinding) uniform textureBuffer source;
#define FETCH(buffer_name, i) texelFetch(buffer_name, int(i)).x
#else
layout(std430, binding = kOsdArraysBinding) readonly buffer Arrays { uint arrays[]; };
layout(std430, binding = kOsdIndicesBinding) readonly buffer Indices { uint indices[]; };
layout(std430, binding = kOsdParamsBinding) readonly buffer PatchParams { uint patch_params[]; };
layout(std430, binding = kOsdCoordsBinding) readonly buffer Coords { uint coords[]; };
layout(std430, binding = kOsdSourceBinding) readonly buffer Source { float source[]; };
#define FETCH(buffer_name, i) buffer_name[i]
#endif
layout(std430, binding = kOsdOutputBinding) writeonly buffer Output0 { float output0[]; };
layout(std430, binding = kOsdOutputBinding + 1) writeonly buffer Output1 { float output1[]; };
layout(std430, binding = kOsdOutputBinding + 2) writeonly buffer Output2 { float output2[]; };

layout(std430, push_constant) uniform Push { OsdPatchEvalParams params; };
layout(local_size_x = kOsdPatchWorkgroupSize) in;
layout(constant_id = kOsdWidthConstant) const uint kWidth = 3;
layout(constant_id = kOsdSecondConstant) const uint kSecond = 0;
layout(constant_id = kOsdOutputsConstant) const uint kOutputs = 7;
layout(constant_id = kOsdTypesConstant) const uint kTypes = 0xffffffffu;

vec4 source_point(uint vertex) {
    const uint at = params.source_base + vertex * params.source_stride;
    return vec4(FETCH(source, at), kWidth > 1 ? FETCH(source, at + 1) : 0, kWidth > 2 ? FETCH(source, at + 2) : 0,
                kWidth > 3 ? FETCH(source, at + 3) : 0);
}

vec4 sums[kOsdOutputCount] = vec4[kOsdOutputCount](vec4(0), vec4(0), vec4(0));

void add_point(uint index, Jet weight) {
    const vec4 point = source_point(FETCH(indices, index));
    sums[0] += (kSecond != 0 ? weight.uu : weight.f) * point;
    sums[1] += (kSecond != 0 ? weight.uv : weight.u) * point;
    sums[2] += (kSecond != 0 ? weight.vv : weight.v) * point;
}

// The functions of up to six points at a time, `group` after group: what a whole patch has is more than registers hold.
uint group_basis(uint type, uint group, uint boundary, float u, float v, out Jet basis[6]) {
    if (osd_is_type(kTypes, type, kOsdRegular)) {
        const OsdBicubic bicubic = osd_bicubic(boundary, u, v);
        for (int i = 0; i < 4; ++i) basis[i] = osd_bicubic_jet(bicubic, i, int(group));
        return 4;
    }
    if (osd_is_type(kTypes, type, kOsdGregoryBasis)) {
        Jet corner[5];
        osd_gregory_corner(int(group), u, v, corner);
        for (int i = 0; i < 5; ++i) basis[i] = corner[i];
        return 5;
    }
    if (osd_is_type(kTypes, type, kOsdGregoryTriangle)) {
        osd_gregory_triangle_corner(int(group), u, v, basis);
        return 6;
    }
    if (osd_is_type(kTypes, type, kOsdLoop)) {
        Jet box[20];
        osd_box_spline_basis(boundary, u, v, box);
        for (int i = 0; i < 6; ++i) {
            if (group == 0)
                basis[i] = box[i];
            else
                basis[i] = box[6 + i];
        }
        return 6;
    }
    if (osd_is_type(kTypes, type, kOsdQuads) || osd_is_type(kTypes, type, kOsdTriangles)) {
        Jet corners[20];
        linear_basis(u, v, type == kOsdTriangles, corners);
        for (int i = 0; i < 4; ++i) basis[i] = corners[i];
        return type == kOsdTriangles ? 3 : 4;
    }
    return 0;
}

void sum_points(uint type, uint boundary, uint first, float u, float v) {
    const bool corners = type == kOsdGregoryTriangle;  // whose sixth points come after all others
    const uint groups = type == kOsdRegular || type == kOsdGregoryBasis ? 4 : corners ? 3 : type == kOsdLoop ? 2 : 1;
    uint next = first;
    [[dont_unroll]] for (uint group = 0; group < groups; ++group) {
        Jet basis[6];
        const uint count = group_basis(type, group, boundary, u, v, basis);
        [[dont_unroll]] for (uint i = 0; i < count; ++i)
            add_point(corners && i == 5 ? first + 15 + group : next + i, basis[i]);
        next += corners ? 5 : count;
    }
}

void sum_patch(uint array, uint patch_index, float s, float t) {
    const uint at = array * kOsdArrayWords;
    const uint in_array = patch_index - FETCH(arrays, at + 5);
    if (in_array >= FETCH(arrays, at + 2)) return;
    const uint param = FETCH(patch_params, patch_index * kOsdParamWords + 1);
    const uint type = osd_param_regular(param) ? FETCH(arrays, at) : FETCH(arrays, at + 1);
    const OsdPlace place = osd_place(osd_is_triangle(type), param, s, t);
    sum_points(type, osd_param_boundary(param), FETCH(arrays, at + 3) + in_array * FETCH(arrays, at + 4), place.u, place.v);
    if (kSecond != 0) sums[0] *= place.second;
    sums[1] *= kSecond != 0 ? place.second : place.first;
    sums[2] *= kSecond != 0 ? place.second : place.first;
}

void main() {
    const uint c = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kOsdPatchWorkgroupSize +
                   gl_LocalInvocationID.x;
    if (c >= params.coord_count) return;
    const uint at = params.coord_base + c * kOsdCoordWords, array = FETCH(coords, at);
    if (array < params.array_count)
        sum_patch(array, FETCH(coords, at + 1), uintBitsToFloat(FETCH(coords, at + 3)),
                  uintBitsToFloat(FETCH(coords, at + 4)));
    for (uint i = 0; i < kWidth; ++i) {
        if ((kOutputs & 1) != 0) output0[params.output_base[0] + c * params.output_stride[0] + i] = sums[0][i];
        if ((kOutputs & 2) != 0) output1[params.output_base[1] + c * params.output_stride[1] + i] = sums[1][i];
        if ((kOutputs & 4) != 0) output2[params.output_base[2] + c * params.output_stride[2] + i] = sums[2][i];
    }
}
