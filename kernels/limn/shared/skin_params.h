// What the host and the skin kernels agree on.
//
// A skin table is one array of words: groups, instances, meshes, rest points (three floats each), influences, where the
// morphs of each point begin (and, last, where all end) and morphs. A workgroup has a group: up to kSkinWorkgroupSize
// points of one instance, so that all that differs from instance to instance and from mesh to mesh is uniform in it.
#ifndef LIMN_SHARED_SKIN_PARAMS_H
#define LIMN_SHARED_SKIN_PARAMS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

const uint kSkinWorkgroupSize = 64;  // invocations, one per point

const uint kSkinWordsBinding = 0;     // the table
const uint kSkinMatricesBinding = 1;  // rows of four floats
const uint kSkinWeightsBinding = 2;   // of morph targets
const uint kSkinPointsBinding = 3;    // written
const uint kSkinBindingCount = 4;

const uint kSkinMatrixRows = 3;

// Up to kSkinWorkgroupSize points of an instance, from point `first` of its mesh on.
struct SkinGroup {
    uint instance;
    uint first;
};
LIMN_LAYOUT(SkinGroup, 8)
const uint kSkinGroupWords = 2;

// A mesh in a place of its own, in a pose of its own.
struct SkinInstance {
    uint mesh;
    uint first_point;         // of those written; the mesh's points follow each other from there on
    uint first_joint;         // its joint j is matrix first_joint + j
    uint first_morph_weight;  // the weight of its target t is number first_morph_weight + t
};
LIMN_LAYOUT(SkinInstance, 16)
const uint kSkinInstanceWords = 4;

// Where a mesh's points are in the table: influence k of its point p is number first_influence + p * influence_count + k.
struct SkinMeshRange {
    uint first_point;
    uint point_count;
    uint first_influence;
    uint influence_count;  // of each point
};
LIMN_LAYOUT(SkinMeshRange, 16)
const uint kSkinMeshWords = 4;

struct SkinInfluence {
    uint joint;  // of the mesh
    float weight;
};
LIMN_LAYOUT(SkinInfluence, 8)
const uint kSkinInfluenceWords = 2;

// How a morph target, of weight 1, moves a point.
struct SkinMorph {
    uint target;  // of the mesh
    float delta[3];
};
LIMN_LAYOUT(SkinMorph, 16)
const uint kSkinMorphWords = 4;

// Where the arrays of a table begin, in words.
struct SkinOffsets {
    uint groups;
    uint instances;
    uint meshes;
    uint rest_points;
    uint influences;
    uint morph_offsets;
    uint morphs;
};
LIMN_LAYOUT(SkinOffsets, 28)

// Push constants.
struct SkinParams {
    SkinOffsets table;
    uint group_count;
    uint matrix_base;   // rows, into what is bound
    uint weight_base;   // floats
    uint point_base;    // component c of point p is float point_base + p * point_stride + c
    uint point_stride;  // floats
};
LIMN_LAYOUT(SkinParams, 48)

LIMN_SHARED_END
#endif
