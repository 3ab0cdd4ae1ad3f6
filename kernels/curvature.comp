// Curvatures at samples, from the six values that patch_eval and tree_eval give; of homogeneous values after division.
// One invocation per sample (limn/shared/curvature_params.h).
// Reads: values and derivatives. Writes: curvatures, and quotients where they are asked for; nothing between records.
// Deterministic: each sample is on its own.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/shared/curvature.h"
#include "limn/shared/curvature_params.h"

layout(local_size_x = kCurvatureWorkgroupSize) in;
layout(constant_id = kCurvatureWidthConstant) const uint kWidth = 3;
layout(constant_id = kCurvatureQuotientsConstant) const uint kQuotients = 0;

layout(std430, binding = kCurvatureValuesBinding) readonly buffer Values { float values[]; };
layout(std430, binding = kCurvatureResultsBinding) writeonly buffer Results { float results[]; };
layout(std430, binding = kCurvatureQuotientsBinding) writeonly buffer Quotients { float quotients[]; };
layout(std430, push_constant) uniform Push { CurvatureParams params; };

Jet load_jet(uint at) {
    return make_jet(values[at], values[at + kWidth], values[at + 2 * kWidth], values[at + 3 * kWidth], values[at + 4 * kWidth],
                    values[at + 5 * kWidth]);
}

void store_vector(uint at, SurfaceVector v) {
    results[at] = v.x;
    results[at + 1] = v.y;
    results[at + 2] = v.z;
}

void store_quotient(uint at, Jet q) {
    quotients[at] = q.f;
    quotients[at + 3] = q.u;
    quotients[at + 6] = q.v;
    quotients[at + 9] = q.uu;
    quotients[at + 12] = q.uv;
    quotients[at + 15] = q.vv;
}

void main() {
    const uint sample_index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kCurvatureWorkgroupSize + gl_LocalInvocationID.x;
    if (sample_index >= params.sample_count) return;
    const uint at = params.value_base + sample_index * params.value_stride;
    Jet x = load_jet(at), y = load_jet(at + 1), z = load_jet(at + 2);
    if (kWidth == 4) {
        const Jet w = load_jet(at + 3), none = make_jet(0, 0, 0, 0, 0, 0);
        x = w.f != 0 ? jet_div(x, w) : none;
        y = w.f != 0 ? jet_div(y, w) : none;
        z = w.f != 0 ? jet_div(z, w) : none;
    }
    if (kQuotients != 0) {
        const uint to = params.quotient_base + sample_index * params.quotient_stride;
        store_quotient(to, x);
        store_quotient(to + 1, y);
        store_quotient(to + 2, z);
    }
    const PointCurvature curvature =
        curvature_of(make_vector(x.u, y.u, z.u), make_vector(x.v, y.v, z.v), make_vector(x.uu, y.uu, z.uu),
                     make_vector(x.uv, y.uv, z.uv), make_vector(x.vv, y.vv, z.vv));
    const uint to = params.result_base + sample_index * params.result_stride;
    results[to] = curvature.gaussian;
    results[to + 1] = curvature.mean;
    results[to + 2] = curvature.first;
    results[to + 3] = curvature.second;
    store_vector(to + 4, curvature.first_direction);
    store_vector(to + 7, curvature.second_direction);
}
