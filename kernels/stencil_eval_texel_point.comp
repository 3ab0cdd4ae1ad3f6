// Stencil evaluation, as stencil_eval_texel.comp, for points that are texels of three or four components: one fetch each.
// One invocation per row of a run of rows of one size (limn/shared/stencil_eval_params.h).
// Reads: table (indices, weights, destination rows), source points.
// Writes: three or four components of one destination point; nothing between the points.
// Deterministic: each row sums its entries in the order the table was uploaded in.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/stencil_eval_params.h"

layout(binding = kStencilEvalTableBinding) uniform utextureBuffer table;
layout(binding = kStencilEvalSourceBinding) uniform textureBuffer source;
#define TABLE(i) texelFetch(table, int(i)).xy
#define SOURCE_POINT(i) texelFetch(source, int(i))
#include "limn/stencil_eval.glsl"
