// Grids: samples of a fixed rate over surfaces, as weighted sums of their ring points (limn/shared/grid_eval_params.h).
// One workgroup per tile of surfaces that share their weights, or part of its samples; one invocation per sample.
// Reads: tiles and placements, ring indices of the patch table, weights, points.
// Writes: a value and, as specialised, a unit normal or two derivatives for each sample; nothing in between.
// Deterministic: each sample is written once, and sums its ring in order.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "limn/shared/grid_eval_params.h"
#include "limn/shared/patch_table_layout.h"

layout(std430, binding = kGridPatchesBinding) readonly buffer Patches { uint patches[]; };
layout(std430, binding = kGridTilesBinding) readonly buffer Tiles { uint tiles[]; };
layout(std430, binding = kGridWeightsBinding) readonly buffer Weights { vec4 weight_groups[]; };
layout(std430, binding = kGridPointsBinding) readonly buffer Points { float points[]; };
#define PATCH_WORD(i) patches[i]
#define TILE_WORD(i) tiles[i]
#define WEIGHTS(i) weight_groups[i]
#define POINT(i) points[i]
#include "limn/grid_eval.glsl"
