// What the host and the grid_eval kernels agree on.
//
// The grid buffer is an array of words. A tile is up to `surfaces` surfaces of one class (grid_table.h):
//   [0] first weight, in groups of four   [1] surfaces   [2] ring points
//   [3 + 3 t ..] of surface t: its first ring point, its ptex face counted from the first of the pass, its placement
// A placement is 4 words, the signed integers uu, uv, vu, vv, and then a word for each sample: which sample of its ptex
// face it is, or kGridNoSample.
// CPU devices take regular patches in another way (grid_rows_texel). There a record is a surface: [0] its first ring point,
// [1] its ptex face counted from the first of the pass, [2] its placement, which local points that are the ring's own do
// without. That is the four integers above, then x, y, step:
// sample i of row j is at ((x + i * step) / rate, (y + j * step) / rate) of the plan; then columns and rows, and a word for
// each sample, row after row.
#ifndef LIMN_SHARED_GRID_EVAL_PARAMS_H
#define LIMN_SHARED_GRID_EVAL_PARAMS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

const uint kGridPatchesBinding = 0;  // words of the patch table
const uint kGridTilesBinding = 1;    // words of the grid
const uint kGridWeightsBinding = 2;  // groups of four floats
const uint kGridPointsBinding = 3;
const uint kGridValuesBinding = 4;
const uint kGridSecondBinding = 5;  // normals, or du
const uint kGridThirdBinding = 6;   // dv
const uint kGridBindingCount = 7;

// Specialization constants.
const uint kGridGroupsConstant = 0;  // groups of four ring points that are loaded at once
const uint kGridOutputConstant = 1;
const uint kGridWidthConstant = 2;       // components, 1 to 4
const uint kGridNarrowConstant = 3;      // 1: ring points are 16-bit indices
const uint kGridInvocationsConstant = 4;  // of a workgroup
const uint kGridValueCountConstant = 5;   // of the weights: 1, or 3 with derivatives
const uint kGridLoadsConstant = 6;        // how often `groups` ring points are loaded

const uint kGridCornersConstant = 7;
const uint kGridSurfacesConstant = 8;  // of a tile
const uint kGridAdjacentConstant = 9;  // 1: value and normal are six floats at an even index; packed, four words at a multiple of four
const uint kGridRefinedConstant = 10;  // 1: a refined grid: samples are numbered by slots, and control points step / rate apart
const uint kGridPointTexelsConstant = 11;  // 1: points are texels of three floats, and point_base and point_stride count those
const uint kGridCopiedConstant = 12;  // so many points of each ring are samples as they are
// Which ring points are at the surface's corners.
const uint kGridCornersBicubic = 0;
const uint kGridCornersBoxSpline = 1;
const uint kGridCornersTriangle = 2;  // the first three
const uint kGridCornersFirst = 3;     // the first four

const uint kGridOutputValue = 0;
const uint kGridOutputNormal = 1;  // width 3
const uint kGridOutputDerivatives = 2;
const uint kGridOutputPackedNormal = 4;  // likewise, the normal one word (octahedral.h)
const uint kGridOutputRelative = 3;  // values, relative to the first ring point, but for sample 0, which is that point

const uint kGridTileHeader = 3;
const uint kGridTileSurfaceWords = 3;
const uint kGridMaxTileSurfaces = 8;
const uint kGridPlacementHeader = 4;
const uint kGridNoSample = 0xffffffffu;
const uint kGridRecordWords = 3;
const uint kGridRowsHeader = 9;
const uint kGridRowsWorkgroupSize = 16;

// Of refined grids (grid_table.h): a sample is slot << kGridOffsetBits | offset; a surface has where its slots begin in
// place of its ptex face.
const uint kGridOffsetBits = 20;

// Push constants. Component c of sample s of the pass is the float at base + s * stride + c of its buffer.
struct GridEvalParams {
    uint tile_base;
    uint tile_count;
    uint chunk_count;  // workgroups per tile
    uint sample_count;
    uint samples_per_face;
    uint ring_base;  // words
    uint point_base;
    uint point_stride;
    uint value_base;
    uint value_stride;
    uint second_base;
    uint second_stride;
    uint third_base;
    uint third_stride;
    uint rate;
};
LIMN_LAYOUT(GridEvalParams, 60)

LIMN_SHARED_END
#endif
