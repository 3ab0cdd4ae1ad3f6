// What the host and the stencil_eval kernels agree on.
//
// A device table is an array of pairs of 32-bit words, cut into runs of rows of about the same size. Run items (rows)
// are transposed, so that neighbouring invocations read neighbouring pairs: entries 2g and 2g + 1 of item i are
//   indices  pair[index_base + g * pitch + i]
//   weights  pair[weight_base + g * pitch + i], as floats; absent when the run's rows share their weights
//   row      word i % 2 of pair[row_base + i / 2]; absent when rows are consecutive
// Long rows are stored one after the other instead. Item i has two pairs at row_base + 2 * i: (row, begin) and
// (pair count, unused); its pair g is at index_base + begin + g and weight_base + begin + g.
#ifndef LIMN_SHARED_STENCIL_EVAL_PARAMS_H
#define LIMN_SHARED_STENCIL_EVAL_PARAMS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

const uint kStencilEvalWorkgroupSize = 64;  // invocations, one per row

const uint kStencilEvalTableBinding = 0;
const uint kStencilEvalSourceBinding = 1;
const uint kStencilEvalDestinationBinding = 2;

// Specialization constants: the kind of run, its entries per row (0: params.pair_count pairs), components per point,
// whether rows are consecutive (1) or listed (0).
const uint kStencilEvalKindConstant = 0;
const uint kStencilEvalEntriesConstant = 1;
const uint kStencilEvalWidthConstant = 2;
const uint kStencilEvalConsecutiveConstant = 3;
const uint kStencilEvalMaxWidth = 4;  // wider points take several dispatches

const uint kStencilRunShared = 0;  // all rows of the run have the weights in params.weights
const uint kStencilRunOwn = 1;     // each row has its own
const uint kStencilRunLong = 2;    // each row has its own weights and its own size

const uint kStencilEvalMaxSharedWeights = 16;

// Push constants. Bases may be negative modulo 2^32: sums come out right.
struct StencilEvalParams {
    uint index_base;   // pairs, into the bound range of the table
    uint weight_base;  // pairs
    uint row_base;     // pairs; of no meaning where rows are consecutive
    uint pitch;        // pairs between one pair of entries of an item and its next
    uint pair_count;   // pairs of entries per item
    uint first_item;   // of the run
    uint item_count;   // of this dispatch
    uint first_row;    // row of item 0, when rows are consecutive
    uint row_begin;    // rows outside [row_begin, row_end) are left alone
    uint row_end;
    uint source_base;         // component c of source point p is source[source_base + p * source_stride + c]; where
    uint source_stride;       // texels hold whole points, component c of source[source_base + p * source_stride]
    uint destination_base;    // component c of row r is destination[destination_base + r * destination_stride + c]
    uint destination_stride;  // floats
    float weights[kStencilEvalMaxSharedWeights];
};
LIMN_LAYOUT(StencilEvalParams, 120)

LIMN_SHARED_END
#endif
