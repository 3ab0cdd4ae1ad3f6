// What all tess_* kernels bind, and how they read it: through uniform texel buffers with LIMN_TEXEL, for CPU devices
// (point_buffers.h tells why).
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/patch_basis.h"
#include "limn/shared/patch_location.h"
#include "limn/shared/patch_tree_layout.h"
#include "limn/shared/tess_params.h"

layout(local_size_x = kTessWorkgroupSize) in;
layout(constant_id = kTessTrianglesConstant) const uint kTriangles = 0;
layout(constant_id = kTessSpacingConstant) const uint kSpacing = 0;
layout(constant_id = kTessModeConstant) const uint kMode = 0;
layout(constant_id = kTessOutputConstant) const uint kOutput = 0;

layout(std430, push_constant) uniform Push { TessParams params; };
layout(std430, binding = kTessStateBinding) buffer State { uint state[]; };

// SETTLED is a word of the state that an earlier dispatch has written: four times as fast, there, as one that this may write.
#ifdef LIMN_TEXEL
layout(binding = kTessWordsBinding) uniform utextureBuffer words;
layout(binding = kTessWordGroupsBinding) uniform utextureBuffer word_groups;
layout(binding = kTessLocalBinding) uniform textureBuffer local_points;
layout(binding = kTessSettledBinding) uniform utextureBuffer settled_words;
#ifndef LIMN_HEIGHT_TEXTURE
layout(binding = kTessSecondBinding) uniform textureBuffer second_floats;
#endif
#define WORD(i) texelFetch(words, int(i)).x
#define WORD_GROUP(i) texelFetch(word_groups, int(i))
#define LOCAL(i) texelFetch(local_points, int(i))
#define SETTLED(i) texelFetch(settled_words, int(i)).x
#define SECOND(i) texelFetch(second_floats, int(i)).x
#define SECOND_LOCAL(i) texelFetch(second_floats, int(i))
#else
layout(std430, binding = kTessWordsBinding) readonly buffer Words { uint words[]; };
layout(std430, binding = kTessWordGroupsBinding) readonly buffer WordGroups { uvec4 word_groups[]; };
layout(std430, binding = kTessLocalBinding) readonly buffer LocalPoints { vec4 local_points[]; };
#ifndef LIMN_HEIGHT_TEXTURE
layout(std430, binding = kTessSecondBinding) readonly buffer SecondFloats { float second_floats[]; };
layout(std430, binding = kTessSecondBinding) readonly buffer SecondPoints { vec4 second_points[]; };
#endif
#define WORD(i) words[i]
#define WORD_GROUP(i) word_groups[i]
#define LOCAL(i) local_points[i]
#define SETTLED(i) state[i]
#define SECOND(i) second_floats[i]
#define SECOND_LOCAL(i) second_points[i]
#endif
#ifdef LIMN_HEIGHT_TEXTURE
layout(binding = kTessSecondBinding) uniform sampler2D height_texture;
#undef SECOND_LOCAL
#define SECOND_LOCAL(i) vec4(0)
#endif

const bool kFractional = kSpacing == kSpacingFractional;

uint rates_at() { return tess_rates(params.rate_edge_count); }
uint drawn_at() { return tess_drawn(params.rate_edge_count); }
uint items_at() { return tess_items(params.rate_edge_count, params.face_count); }
uint blocks_at() { return tess_blocks(params.rate_edge_count, params.face_count, params.row_count); }
uint trials_at() { return tess_trials(params.rate_edge_count, params.face_count, params.row_count); }
uint item_count() { return tess_item_count(params.row_count, params.face_count); }
uint block_count() { return tess_block_count(params.row_count, params.face_count); }

uint global_invocation() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kTessWorkgroupSize + gl_LocalInvocationID.x;
}
// Where vertices and triangles of an item begin: a row, or row_count and a face, or item_count(), their end.
uint first_vertex(uint item) {
    return SETTLED(blocks_at() + 2 * (item / kTessBlockItems)) + SETTLED(items_at() + 2 * item);
}
uint first_triangle(uint item) {
    return SETTLED(blocks_at() + 2 * (item / kTessBlockItems) + 1) + SETTLED(items_at() + 2 * item + 1);
}
uint payload(uint i) { return floatBitsToUint(params.payload[i]); }
// Invocations share rows or faces, so many each.
uint lane_count() { return 1u << payload(kTessLanesPayload); }
uint shared_item() { return global_invocation() >> payload(kTessLanesPayload); }
uint lane_of_item() { return global_invocation() & (lane_count() - 1); }
bool is_empty() { return SETTLED(kTessResultStatus) >= kTessTooSmall; }

// Tables begin at multiples of four words.
uvec4 face_sides(uint face) { return WORD_GROUP(params.table.faces / 4 + kTessFaceWords / 4 * face); }
uvec4 face_corners(uint face) { return WORD_GROUP(params.table.faces / 4 + kTessFaceWords / 4 * face + 1); }
uvec4 row_words(uint row) { return WORD_GROUP(params.table.rows / 4 + kTessRowWords / 4 * row); }
uint row_edge(uint row) { return WORD(params.table.rows + kTessRowWords * row); }
uint edge_word(uint edge, uint i) { return WORD(params.table.rate_edges + kRateEdgeWords * edge + i); }
