// Samples of a list and their records, for patch_eval and tree_eval. Before it: SAMPLE(i), a uint; params.list.

layout(local_size_x = kPatchWorkgroupSize) in;
layout(constant_id = kPatchWidthConstant) const uint kWidth = 3;
layout(constant_id = kPatchValueCountConstant) const uint kValueCount = 3;
layout(constant_id = kPatchTrianglesConstant) const uint kTriangles = 0;
layout(constant_id = kPatchPairedConstant) const uint kPaired = 0;

layout(std430, binding = kPatchResultsBinding) writeonly buffer Results { float results[]; };
layout(std430, binding = kPatchResultsBinding) writeonly buffer ResultPairs { vec2 result_pairs[]; };
layout(std430, binding = kPatchResultsBinding) writeonly buffer ResultWords { uint result_words[]; };
layout(std430, binding = kPatchStatusesBinding) writeonly buffer Statuses { uint statuses[]; };
layout(std430, binding = kPatchDeferredBinding) buffer Deferred { uint deferred[]; };

uint global_invocation() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kPatchWorkgroupSize + gl_LocalInvocationID.x;
}

struct ListedSample {
    uint face;
    float u, v;
};
ListedSample read_sample(uint s) {
    const uint at = params.list.first_sample + 3 * s;
    return ListedSample(SAMPLE(at), uintBitsToFloat(SAMPLE(at + 1)), uintBitsToFloat(SAMPLE(at + 2)));
}
bool is_in_range(ListedSample at) {
    // A float sum may exceed 1 on the third side of a triangle.
    return at.face < params.list.ptex_count && at.u >= 0 && at.u <= 1 && at.v >= 0 && at.v <= 1 &&
           (kTriangles == 0 || at.u + at.v <= 1.000001);
}

// Derivatives by the coordinates of a node -> by those of the ptex face.
void turn_derivatives(PatchLocation at, inout vec4 sums[6]) {
    const vec4 u = sums[1], v = sums[2], uu = sums[3], uv = sums[4], vv = sums[5];
    sums[1] = u * at.uu + v * at.vu;
    sums[2] = u * at.uv + v * at.vv;
    sums[3] = uu * (at.uu * at.uu) + uv * (2 * at.uu * at.vu) + vv * (at.vu * at.vu);
    sums[4] = uu * (at.uu * at.uv) + uv * (at.uu * at.vv + at.uv * at.vu) + vv * (at.vu * at.vv);
    sums[5] = uu * (at.uv * at.uv) + uv * (2 * at.uv * at.vv) + vv * (at.vv * at.vv);
}

void store_values(uint s, vec4 sums[6]) {
    const uint at = params.list.result_base + s * params.list.result_stride, count = kValueCount * kWidth;
    const uint paired = kPaired != 0 ? count / 2 * 2 : 0;
    for (uint i = 0; i < paired; i += 2)
        result_pairs[(at + i) / 2] = vec2(sums[i / kWidth][i % kWidth], sums[(i + 1) / kWidth][(i + 1) % kWidth]);
    for (uint i = paired; i < count; ++i) results[at + i] = sums[i / kWidth][i % kWidth];
}
void store_status(uint s, uint status) {
    if (params.list.status_base != kPatchNoStatus) statuses[params.list.status_base + s] = status;
}
