// Grids, as grid_eval.comp, with all that is read as uniform texel buffers: for CPU devices.
// One workgroup per tile of surfaces that share their weights, or part of its samples; one invocation per sample.
// Reads: tiles and placements, ring indices of the patch table, weights, points.
// Writes: a value and, as specialised, a unit normal or two derivatives for each sample; nothing in between.
// Deterministic: each sample is written once, and sums its ring in order.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/grid_eval_params.h"
#include "limn/shared/patch_table_layout.h"

layout(binding = kGridPatchesBinding) uniform utextureBuffer patches;
layout(binding = kGridTilesBinding) uniform utextureBuffer tiles;
layout(binding = kGridWeightsBinding) uniform textureBuffer weight_groups;
layout(binding = kGridPointsBinding) uniform textureBuffer points;
#define PATCH_WORD(i) texelFetch(patches, int(i)).x
#define TILE_WORD(i) texelFetch(tiles, int(i)).x
#define WEIGHTS(i) texelFetch(weight_groups, int(i))
#define POINT(i) texelFetch(points, int(i)).x
#define POINT_TEXEL(i) texelFetch(points, int(i)).xyz
#include "limn/grid_eval.glsl"
