// The body of the patch_eval kernels. Before it: WORD(i), SAMPLE(i), uints; WEIGHTS(i), a vec4; POINT(i), a float.

layout(std430, push_constant) uniform Push { PatchEvalParams params; };
layout(constant_id = kPatchNarrowConstant) const uint kNarrow = 0;
layout(constant_id = kPatchMaxRingConstant) const uint kMaxRing = 24;
layout(constant_id = kPatchEndCapConstant) const uint kEndCap = kEndCapExact;
layout(constant_id = kPatchDeferredConstant) const uint kDeferred = 0;
#include "limn/patch_sample.glsl"

// The ring of the plan that evaluation has got to: points of the surface or, behind references, deep_ring.
vec4 deep_ring[kMaxRing];
vec4 next_ring[kMaxRing];
bool is_deep = false;
uint surface_ring;
vec4 surface_origin;

struct PlanWords {
    uint ring_size, first_weight, first_node, first_point, has_corner_rows;
};
PlanWords read_plan(uint plan) {
    const uint at = params.table.plans + 6 * plan;
    return PlanWords(WORD(at), WORD(at + 2), WORD(at + 3), WORD(at + 4), WORD(at + 5));
}

vec4 surface_point(uint j) {
    const uint i = surface_ring + j, word = WORD(params.table.ring_points + (kNarrow != 0 ? i / 2 : i));
    const uint at = params.point_base + (kNarrow != 0 ? narrow_index(word, i) : word) * params.point_stride;
    return vec4(POINT(at), kWidth > 1 ? POINT(at + 1) : 0, kWidth > 2 ? POINT(at + 2) : 0,
                kWidth > 3 ? POINT(at + 3) : 0);
}

// Relative to the first point, which matters where meshes lie far out: what derivatives are made of are differences.
vec4 ring_point(uint j) {
    return is_deep ? deep_ring[j] : surface_point(j) - surface_origin;
}

uint row_group(PlanWords plan, uint row) {
    return (params.table.plan_weights + plan.first_weight + row * plan_row_stride(plan.ring_size)) / 4;
}
vec4 row_point(PlanWords plan, uint row) {
    const uint first = 4 * row_group(plan, row);
    vec4 sum = vec4(0);
    for (uint j = 0; j < plan.ring_size; ++j) sum += uintBitsToFloat(WORD(first + j)) * ring_point(j);
    return sum;
}

// The ring of the next plan, relative to its first point, which is at the plan's corner: what matters for derivatives
// near an extraordinary vertex are differences that shrink with every level, and would be lost beside the position.
vec4 refine_ring(PlanWords plan, uint first_row, uint next_size) {
    for (uint k = 0; k < next_size; ++k)
        next_ring[k] = row_point(plan, WORD(params.table.plan_points + plan.first_point + first_row + k));
    const vec4 origin = next_ring[0];
    for (uint k = 0; k < next_size; ++k) deep_ring[k] = next_ring[k] - origin;
    is_deep = true;
    return origin;
}

// Value, du, dv, duu, duv, dvv of a patch, by the coordinates of its node.
void sum_patch(PlanWords plan, uint kind, uint first_row, PatchLocation at, inout vec4 sums[6]) {
    Jet basis[kMaxPatchPoints];
    patch_basis(kind, kTriangles != 0, kEndCap, at.u, at.v, basis);
    const uint most = kEndCap == kEndCapExact ? 16 : kMaxPatchPoints;
    const uint count = patch_point_count(kind);
    uint groups[kMaxPatchPoints];
    for (uint k = 0; k < most; ++k)  // the functions past `count` are zero
        groups[k] = row_group(plan, WORD(params.table.plan_points + plan.first_point + first_row + min(k, count - 1)));
    for (uint j = 0; j < plan.ring_size; j += 4) {
        vec4 weights[6] = vec4[6](vec4(0), vec4(0), vec4(0), vec4(0), vec4(0), vec4(0));
        for (uint k = 0; k < most; ++k) {
            const vec4 row = WEIGHTS(groups[k] + j / 4);
            weights[0] += basis[k].f * row;
            if (kValueCount > 1) {
                weights[1] += basis[k].u * row;
                weights[2] += basis[k].v * row;
            }
            if (kValueCount > 3) {
                weights[3] += basis[k].uu * row;
                weights[4] += basis[k].uv * row;
                weights[5] += basis[k].vv * row;
            }
        }
        for (uint c = 0; c < 4; ++c) {
            const vec4 point = ring_point(min(j + c, plan.ring_size - 1));
            for (uint d = 0; d < kValueCount; ++d) sums[d] += weights[d][c] * point;
        }
    }
}

// Two tangents, turned as the face is; their lengths mean nothing, so the scale of `at` is left out.
void take_corner(PlanWords plan, inout PatchLocation at, inout vec4 sums[6]) {
    for (uint k = 0; k < min(kValueCount, 3); ++k) sums[k] = row_point(plan, kCornerLimitRow + k);
    const float scale = max(max(abs(at.uu), abs(at.uv)), max(abs(at.vu), abs(at.vv)));
    at.uu /= scale;
    at.uv /= scale;
    at.vu /= scale;
    at.vv /= scale;
}

// Moves to the leaf of the plan that `at` is in: which node.
uint find_node(PlanWords plan, inout PatchLocation at, inout uint depth) {
    uint node = 0, word = WORD(params.table.plan_nodes + 2 * plan.first_node);
    while (node_kind(word) <= kNodeSplitV) {
        const uint first = WORD(params.table.plan_nodes + 2 * (plan.first_node + node) + 1);
        if (node_kind(word) == kNodeSplit) {
            node = first + descend_location(at, kTriangles != 0);
            ++depth;
        } else {
            node = first + descend_location_half(at, node_kind(word) == kNodeSplitU);
        }
        word = WORD(params.table.plan_nodes + 2 * (plan.first_node + node));
    }
    return node;
}

struct Place {
    uint plan, node;
    PatchLocation at;
};

Place evaluate(uint plan_index, PatchLocation at, out vec4 sums[6]) {
    for (uint d = 0; d < 6; ++d) sums[d] = vec4(0);
    if (kValueCount != 0) surface_origin = surface_point(0);
    vec4 origin = surface_origin;
    uint depth = 0, node = 0;
    // Every second round descends; the bound only says that this ends.
    for (uint round = 0; round <= 2 * kPatchMostDepth + 32; ++round) {
        const PlanWords plan = read_plan(plan_index);
        node = 0;
        if (plan.has_corner_rows != 0 && ((at.u == 0 && at.v == 0) || depth >= kPatchMostDepth)) {
            if (kValueCount != 0) take_corner(plan, at, sums);
            break;
        }
        node = find_node(plan, at, depth);
        const uint word = WORD(params.table.plan_nodes + 2 * (plan.first_node + node));
        const uint first_row = WORD(params.table.plan_nodes + 2 * (plan.first_node + node) + 1);
        if (node_kind(word) != kNodePlan) {
            if (kValueCount != 0) sum_patch(plan, node_kind(word), first_row, at, sums);
            break;
        }
        rotate_location(at, node_rotation(word), kTriangles != 0);
        plan_index = node_plan(word);
        if (kValueCount != 0) origin += refine_ring(plan, first_row, read_plan(plan_index).ring_size);
    }
    const Place place = Place(plan_index, node, at);
    sums[0] += origin;
    turn_derivatives(at, sums);
    return place;
}

void main() {
    uint s = global_invocation();
    if (s >= (kDeferred != 0 ? deferred[kDeferredCount] : params.list.sample_count)) return;
    if (kDeferred != 0) s = deferred[kDeferredHeader + s];
    const ListedSample listed = read_sample(s);
    uint status = kSampleOutOfRange, surface = 0;
    if (is_in_range(listed)) {
        surface = WORD(params.table.ptex_surfaces + listed.face);
        status = surface == kPtexHole ? kSampleHole : kSampleValid;
    }
    vec4 sums[6] = vec4[6](vec4(0), vec4(0), vec4(0), vec4(0), vec4(0), vec4(0));
    uint words_of_place[5] = uint[5](0, 0, 0, 0, 0);
    if (status == kSampleValid) {
        PatchLocation at = make_location(listed.u, listed.v);
        if ((surface & kPtexSplit) != 0) surface = (surface & ~kPtexSplit) + descend_location(at, kTriangles != 0);
        const uint word = WORD(params.table.surfaces + 2 * surface);
        surface_ring = WORD(params.table.surfaces + 2 * surface + 1);
        rotate_location(at, surface_rotation(word), kTriangles != 0);
        const Place place = evaluate(surface_plan(word), at, sums);
        words_of_place = uint[5](surface, place.plan, place.node, floatBitsToUint(place.at.u), floatBitsToUint(place.at.v));
    }
    if (kValueCount == 0) {
        const uint at = params.list.result_base + s * params.list.result_stride;
        for (uint k = 0; k < 5; ++k) result_words[at + k] = words_of_place[k];
    }
    store_values(s, sums);
    store_status(s, status);
}
