// What the host and the tess_* kernels agree on.
//
// Tables are one array of words (tessellation_table.h and patch_tree.h say what they hold). What a frame's topology is
// computed to be, is another, the state, whose sections follow from the counts.
#ifndef LIMN_SHARED_TESS_PARAMS_H
#define LIMN_SHARED_TESS_PARAMS_H
#include "limn/shared/patch_tree_layout.h"
#include "limn/shared/tess_rate.h"
LIMN_SHARED_BEGIN

const uint kTessWorkgroupSize = 64;  // also what a block of the scan is made of
const uint kTessBlockItems = 64;

const uint kTessWordsBinding = 0;       // tables
const uint kTessWordGroupsBinding = 1;  // the same buffer, as groups of four words
const uint kTessLocalBinding = 2;       // local points, groups of four floats
const uint kTessSecondBinding = 3;      // those of a channel, or rates of the caller's
const uint kTessStateBinding = 4;
const uint kTessOutBinding = 5;
const uint kTessOut2Binding = 6;
const uint kTessSettledBinding = 7;  // the state once more, for texel buffers
const uint kTessBindingCount = 8;

// Specialization constants.
const uint kTessTrianglesConstant = 0;  // 1: Loop
const uint kTessSpacingConstant = 1;
const uint kTessModeConstant = 2;    // what a kernel has variants of: rate mode, culling, domain
const uint kTessOutputConstant = 3;  // what vertices get

// Domains of vertices.
const uint kTessCorners = 0;
const uint kTessRows = 1;
const uint kTessFaces = 2;

// Outputs of tess_vertices.
const uint kTessOutputValue = 0;    // payload: width; one to four components
const uint kTessOutputNormal = 1;   // position, and a unit normal
const uint kTessOutputPlace = 2;    // ptex face, u, v, and the leaf: its kind and, shifted by 8, its level
const uint kTessOutputTangent = 3;  // x y z, and the sign of the bitangent

// Outputs of tess_triangles, bits.
const uint kTessFacesOfTriangles = 1;
const uint kTessClockwise = 2;

// Culling, bits.
const uint kTessCullOutside = 1;
const uint kTessCullBackfaces = 2;

// Where the tables' arrays begin, in words, but for those of patch trees, of vertices or a channel.
struct TessOffsets {
    uint faces;
    uint rows;
    uint corners;
    uint rate_edges;
    uint copies;  // of corners, then of rows
};
LIMN_LAYOUT(TessOffsets, 20)

// What an instance of the tables is drawn with: an element of the caller's buffer (TessellationInfo::instances).
struct TessInstance {
    float object_to_world[12];  // three rows of four, as VkTransformMatrixKHR
    float value_scale;          // times RateSettings::value or, of mode per_edge, times the rates given
    uint flags;                 // kInstance...
    uint reserved[2];           // not read
};
LIMN_LAYOUT(TessInstance, 64)
const uint kInstanceWords = 16;
const uint kInstanceHidden = 1;         // no triangles, no vertices but corners, which no triangle refers to
const uint kInstanceKeepOutside = 2;    // not culled by the frustum
const uint kInstanceKeepBackfaces = 4;  // not culled by what faces away

// Push constants: what all kernels take, and a payload of each one's own. Where invocations share rows or faces, its last
// element is how many do: 2 to that power.
const uint kTessLanesPayload = 17;
struct TessParams {
    TreeOffsets tree;
    TessOffsets table;
    uint face_count;
    uint row_count;
    uint corner_count;
    uint rate_edge_count;
    uint max_rate;
    float payload[18];
};
LIMN_LAYOUT(TessParams, 128)

// A mode of tess_budget and tess_scan: there are no vertices and triangles, and the state ends where those begin.
const uint kTessRatesOnly = 3;
// A mode of tess_scan: where the capacity does not hold all, it finishes nothing, but has rates scaled: it writes how many
// workgroups the dispatches get that do so.
const uint kTessTry = 4;

// The state, in words: the result, then for each rate edge a target (float) and a rate, for each face whether it is
// drawn; for each item, that is each row, then each face, and then their end, how many vertices and triangles come before it
// in its block; and where those of blocks begin.
const uint kTessResultWords = 16;
const uint kTessTargets = kTessResultWords;
LIMN_FN uint tess_rates(uint rate_edge_count) {
    return kTessTargets + rate_edge_count;
}
LIMN_FN uint tess_drawn(uint rate_edge_count) {
    return kTessTargets + 2u * rate_edge_count;
}
LIMN_FN uint tess_items(uint rate_edge_count, uint face_count) {
    return tess_drawn(rate_edge_count) + face_count;
}
LIMN_FN uint tess_item_count(uint row_count, uint face_count) {
    return row_count + face_count;
}
LIMN_FN uint tess_blocks(uint rate_edge_count, uint face_count, uint row_count) {
    return tess_items(rate_edge_count, face_count) + 2u * (tess_item_count(row_count, face_count) + 1u);
}
LIMN_FN uint tess_block_count(uint row_count, uint face_count) {
    return tess_item_count(row_count, face_count) / kTessBlockItems + 1u;
}
// Vertices and triangles, low and high words, at each of the scales that are tried; then those scales.
const uint kTessTrials = 32;
LIMN_FN uint tess_trials(uint rate_edge_count, uint face_count, uint row_count) {
    return tess_blocks(rate_edge_count, face_count, row_count) + 2u * tess_block_count(row_count, face_count);
}
LIMN_FN uint tess_state_words(uint rate_edge_count, uint face_count, uint row_count) {
    return tess_trials(rate_edge_count, face_count, row_count) + 5u * kTessTrials;
}

// A draw command: VkDrawIndexedIndirectCommand.
const uint kTessCommandWords = 5;

// The result: what a caller may read back.
const uint kTessResultStatus = 0;
const uint kTessResultVertices = 1;
const uint kTessResultTriangles = 2;
const uint kTessResultScale = 3;      // float
const uint kTessResultNotFinite = 4;
const uint kTessNeededVertices = 5;   // whatever the capacity
const uint kTessNeededTriangles = 6;
const uint kTessScaleItems = 8;  // VkDispatchIndirectCommand of what goes through items or edges; all zeros: all fits
const uint kTessScaleOnce = 11;  // of what is one workgroup

// In the order of TessellationStatus.
const uint kTessComplete = 0;
const uint kTessScaled = 1;
const uint kTessTooSmall = 2;
const uint kTessNotFinite = 3;
const uint kTessBadSettings = 4;

LIMN_SHARED_END
#endif
