// The limit surface at any place: positions and derivatives at a list of (ptex face, u, v).
// One invocation per sample (limn/shared/patch_eval_params.h).
// Reads: the patch table, points, samples.
// Writes: a record of values for each sample, zeros where it is not on the surface, and its status.
// Deterministic: each sample sums its ring in order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/shared/patch_basis.h"
#include "limn/shared/patch_eval_params.h"
#include "limn/shared/patch_location.h"

layout(std430, binding = kPatchWordsBinding) readonly buffer Words { uint words[]; };
layout(std430, binding = kPatchWeightsBinding) readonly buffer Weights { vec4 weight_groups[]; };
layout(std430, binding = kPatchPointsBinding) readonly buffer Points { float points[]; };
layout(std430, binding = kPatchSamplesBinding) readonly buffer Samples { uint samples[]; };
#define WORD(i) words[i]
#define WEIGHTS(i) weight_groups[i]
#define POINT(i) points[i]
#define SAMPLE(i) samples[i]
#include "limn/patch_eval.glsl"
