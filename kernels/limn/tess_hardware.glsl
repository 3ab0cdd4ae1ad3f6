// What the stages of hardware tessellation bind, and how they read it: through uniform texel buffers with LIMN_TEXEL,
// for CPU devices (point_buffers.h tells why). LIMN_TRIANGLES: ptex faces are triangles, of Loop.
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "limn/shared/patch_basis.h"
#include "limn/shared/patch_location.h"
#include "limn/shared/patch_tree_layout.h"
#include "limn/shared/tess_hardware.h"

#ifdef LIMN_TRIANGLES
const uint kTriangles = 1;
#else
const uint kTriangles = 0;
#endif
const uint kSides = kTriangles != 0 ? 3 : 4;

layout(std430, push_constant) uniform Push { TessHardwareParams params; };

#ifdef LIMN_TEXEL
layout(set = 0, binding = kHardwareWordsBinding) uniform utextureBuffer words;
layout(set = 0, binding = kHardwareWordGroupsBinding) uniform utextureBuffer word_groups;
layout(set = 0, binding = kHardwareLocalBinding) uniform textureBuffer local_points;
layout(set = 0, binding = kHardwareStateBinding) uniform utextureBuffer state;
#define WORD(i) texelFetch(words, int(i)).x
#define WORD_GROUP(i) texelFetch(word_groups, int(i))
#define LOCAL(i) texelFetch(local_points, int(i))
#define SETTLED(i) texelFetch(state, int(i)).x
#else
layout(std430, set = 0, binding = kHardwareWordsBinding) readonly buffer Words { uint words[]; };
layout(std430, set = 0, binding = kHardwareWordGroupsBinding) readonly buffer WordGroups { uvec4 word_groups[]; };
layout(std430, set = 0, binding = kHardwareLocalBinding) readonly buffer LocalPoints { vec4 local_points[]; };
layout(std430, set = 0, binding = kHardwareStateBinding) readonly buffer State { uint state[]; };
#define WORD(i) words[i]
#define WORD_GROUP(i) word_groups[i]
#define LOCAL(i) local_points[i]
#define SETTLED(i) state[i]
#endif
#define SECOND_LOCAL(i) LOCAL(i)

uint face_word(uint face, uint i) { return WORD(params.table.faces + kTessFaceWords * face + i); }
uint row_word(uint row, uint i) { return WORD(params.table.rows + kTessRowWords * row + i); }

// What the control stage tells the evaluation stage of each side: the side, its row's rate, the row and the middle
// corner that it has its positions from; and of corners, their own and those that they have their positions from.
#define PATCH_LAYOUT(direction)                                  \
    layout(location = 0) patch direction uvec4 patch_sides[4];   \
    layout(location = 4) patch direction uvec4 patch_corners;    \
    layout(location = 5) patch direction uvec4 corner_positions; \
    layout(location = 6) patch direction uvec4 patch_middles;    \
    layout(location = 7) patch direction uint patch_face;

TessPattern pattern_of(uint side0, uint side1, uint side2, uint side3, uvec4 rates) {
    return make_face_pattern(kTriangles != 0, params.spacing, side0, side1, side2, side3, rates.x, rates.y, rates.z, rates.w);
}
