// The body of the stencil_eval kernels. Before it: TABLE(i), a uvec2, and SOURCE(i), a float, or SOURCE_POINT(i), a vec4
// of all components of a point.

layout(local_size_x = kStencilEvalWorkgroupSize) in;
layout(constant_id = kStencilEvalKindConstant) const uint kKind = kStencilRunOwn;
layout(constant_id = kStencilEvalEntriesConstant) const uint kEntries = 0;
layout(constant_id = kStencilEvalWidthConstant) const uint kWidth = 3;
layout(constant_id = kStencilEvalConsecutiveConstant) const uint kConsecutive = 0;

layout(std430, push_constant) uniform Push { StencilEvalParams params; };
layout(std430, binding = kStencilEvalDestinationBinding) writeonly buffer Destination { float destination[]; };

void accumulate(inout float point[kStencilEvalMaxWidth], uint index, float weight) {
    const uint at = params.source_base + index * params.source_stride;
#ifdef SOURCE_POINT
    const vec4 value = SOURCE_POINT(at);
    for (uint c = 0; c < kWidth; ++c) point[c] += weight * value[c];
#else
    for (uint c = 0; c < kWidth; ++c) point[c] += weight * SOURCE(at + c);
#endif
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint invocation = group * kStencilEvalWorkgroupSize + gl_LocalInvocationID.x;
    // Invocations past the end repeat the last item and do not store: until then control flow is uniform, and loads
    // from push constants stay scalar on CPU devices.
    const uint item = params.first_item + min(invocation, params.item_count - 1);

    uint row = params.first_row + item;
    uint first = item, pitch = params.pitch, pair_count = params.pair_count;
    if (kKind == kStencilRunLong) {
        const uvec2 head = TABLE(params.row_base + 2 * item);
        row = head.x;
        first = head.y;
        pitch = 1;
        pair_count = TABLE(params.row_base + 2 * item + 1).x;
    } else if (kConsecutive == 0) {
        const uvec2 rows = TABLE(params.row_base + item / 2);
        row = item % 2 == 0 ? rows.x : rows.y;
    }

    float point[kStencilEvalMaxWidth] = float[](0, 0, 0, 0);
    const uint index_at = params.index_base + first, weight_at = params.weight_base + first;
    if (kKind == kStencilRunShared) {
        for (uint k = 0; k < kEntries; k += 2) {
            const uvec2 index = TABLE(index_at + k / 2 * pitch);
            accumulate(point, index.x, params.weights[k]);
            if (k + 1 < kEntries) accumulate(point, index.y, params.weights[k + 1]);
        }
    } else {
        const uint end = kEntries != 0 ? (kEntries + 1) / 2 : pair_count;
        for (uint g = 0; g < end; ++g) {
            const uvec2 index = TABLE(index_at + g * pitch);
            const vec2 weight = uintBitsToFloat(TABLE(weight_at + g * pitch));
            accumulate(point, index.x, weight.x);
            accumulate(point, index.y, weight.y);
        }
    }

    // All parameters are read before the branch: behind it, CPU devices gather them lane by lane.
    const uint at = params.destination_base + row * params.destination_stride;
    const uint row_begin = params.row_begin, row_end = params.row_end;
    if (all(bvec3(invocation < params.item_count, row >= row_begin, row < row_end)))
        for (uint c = 0; c < kWidth; ++c) destination[at + c] = point[c];
}
