// Stencil evaluation: points as weighted sums of points.
// One invocation per row of a run of rows of one size (limn/shared/stencil_eval_params.h).
// Reads: table (indices, weights, destination rows), source points.
// Writes: up to four components of one destination point; nothing between the points.
// Deterministic: each row sums its entries in the order the table was uploaded in.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/shared/stencil_eval_params.h"

layout(std430, binding = kStencilEvalTableBinding) readonly buffer Table { uvec2 table[]; };
layout(std430, binding = kStencilEvalSourceBinding) readonly buffer Source { float source[]; };
#define TABLE(i) table[i]
#define SOURCE(i) source[i]
#include "limn/stencil_eval.glsl"
