// The limit surface at any place: positions and derivatives at a list of (ptex face, u, v), from local points of patch trees.
// One invocation per sample (limn/shared/tree_eval_params.h). With LIMN_TEXEL all that is read is uniform texel buffers.
// Reads: patch trees, local points, samples.
// Writes: a record of values for each sample, zeros where it is not on the surface, and its status; samples that trees end
// before are listed for patch_eval instead.
// Deterministic, but for the order of that list: each sample sums its points in order.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/patch_basis.h"
#include "limn/shared/patch_location.h"
#include "limn/shared/tree_eval_params.h"

#ifdef LIMN_TEXEL
layout(binding = kPatchWordsBinding) uniform utextureBuffer words;
layout(binding = kPatchWeightsBinding) uniform utextureBuffer word_groups;
layout(binding = kPatchPointsBinding) uniform textureBuffer local_points;
layout(binding = kPatchSamplesBinding) uniform utextureBuffer samples;
#define WORD(i) texelFetch(words, int(i)).x
#define WORD_GROUP(i) texelFetch(word_groups, int(i))
#define LOCAL(i) texelFetch(local_points, int(i))
#define SAMPLE(i) texelFetch(samples, int(i)).x
#else
layout(std430, binding = kPatchWordsBinding) readonly buffer Words { uint words[]; };
layout(std430, binding = kPatchWeightsBinding) readonly buffer WordGroups { uvec4 word_groups[]; };
layout(std430, binding = kPatchPointsBinding) readonly buffer LocalPoints { vec4 local_points[]; };
layout(std430, binding = kPatchSamplesBinding) readonly buffer Samples { uint samples[]; };
#define WORD(i) words[i]
#define WORD_GROUP(i) word_groups[i]
#define LOCAL(i) local_points[i]
#define SAMPLE(i) samples[i]
#endif
#define SECOND_LOCAL(i) LOCAL(i)

layout(std430, push_constant) uniform Push { TreeEvalParams params; };
#include "limn/patch_sample.glsl"
#include "limn/patch_tree.glsl"

// For another dispatch, in whatever order: samples do not depend on each other.
void defer(uint s) {
    const uint i = atomicAdd(deferred[kDeferredCount], 1);
    deferred[kDeferredHeader + i] = s;
    if (i % kPatchWorkgroupSize == 0) atomicAdd(deferred[kDeferredGroups], 1);
}

void main() {
    const uint s = global_invocation();
    if (s >= params.list.sample_count) return;
    const ListedSample listed = read_sample(s);
    uint status = kSampleOutOfRange;
    if (is_in_range(listed))
        status = WORD(params.tree.ptex_surfaces + listed.face) == kPtexHole ? kSampleHole : kSampleValid;
    vec4 sums[6] = vec4[6](vec4(0), vec4(0), vec4(0), vec4(0), vec4(0), vec4(0));
    if (status == kSampleValid) {
        const Leaf leaf = find_leaf(params.tree, listed.face, listed.u, listed.v);
        if (leaf.kind == kNodeCorner) {
            defer(s);
            return;
        }
        vec4 points[16];
        load_leaf(leaf, points);
        sum_leaf(leaf, points, sums);
        turn_derivatives(leaf.at, sums);
        // The first local point of a surface is what its others, and so these, are relative to.
        sums[0] += points[0] + LOCAL(leaf.first_local);
    }
    store_values(s, sums);
    store_status(s, status);
}
