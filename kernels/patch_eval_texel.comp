// The limit surface at any place, as patch_eval.comp, with all that is read as uniform texel buffers: for CPU devices.
// One invocation per sample (limn/shared/patch_eval_params.h).
// Reads: the patch table, points, samples.
// Writes: a record of values for each sample, zeros where it is not on the surface, and its status.
// Deterministic: each sample sums its ring in order.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/patch_basis.h"
#include "limn/shared/patch_eval_params.h"
#include "limn/shared/patch_location.h"

layout(binding = kPatchWordsBinding) uniform utextureBuffer words;
layout(binding = kPatchWeightsBinding) uniform textureBuffer weight_groups;
layout(binding = kPatchPointsBinding) uniform textureBuffer points;
layout(binding = kPatchSamplesBinding) uniform utextureBuffer samples;
#define WORD(i) texelFetch(words, int(i)).x
#define WEIGHTS(i) texelFetch(weight_groups, int(i))
#define POINT(i) texelFetch(points, int(i)).x
#define SAMPLE(i) texelFetch(samples, int(i)).x
#include "limn/patch_eval.glsl"
