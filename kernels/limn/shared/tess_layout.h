// How the words of tessellation tables are packed; tessellation_table.h says what they mean.
#ifndef LIMN_SHARED_TESS_LAYOUT_H
#define LIMN_SHARED_TESS_LAYOUT_H
#include "limn/shared/tess_pattern.h"
LIMN_SHARED_BEGIN

// Sides of faces: a row, or the first of two that make it up (kSideHalves), along it or against it (kSideReversed).
const uint kSideReversed = 0x80000000u;
const uint kSideHalves = 0x40000000u;
const uint kSideRowMask = 0x3fffffffu;
const uint kNoSide = 0xffffffffu;  // of holes; of triangles the fourth
LIMN_FN uint side_row(uint side) {
    return side & kSideRowMask;
}

// A face is 8 words: its sides, and the vertices at its corners.
const uint kTessFaceWords = 8;

// A row is 4 words: the rate edge, the ptex face and place that it is evaluated at, and the corner vertex between this
// row and the next where both make up one side.
const uint kTessRowWords = 4;
// Places are counted in halves of the ptex face: u and v of the beginning, then of the end, 2 bits each.
LIMN_FN uint pack_row_place(uint u0, uint v0, uint u1, uint v1) {
    return u0 | v0 << 2 | u1 << 4 | v1 << 6;
}
LIMN_FN void locate_on_row(uint place, real t, LIMN_INOUT(real) u, LIMN_INOUT(real) v) {
    const real u0 = real(place & 3u) / real(2), v0 = real(place >> 2 & 3u) / real(2);
    const real u1 = real(place >> 4 & 3u) / real(2), v1 = real(place >> 6 & 3u) / real(2);
    u = u0 + (u1 - u0) * t;  // exact at t = 1: all four are 0, 1/2 or 1
    v = v0 + (v1 - v0) * t;
}

// A corner is 2 words: the ptex face (kNoFace: nobody's, in crowds), and u and v in halves.
const uint kTessCornerWords = 2;

// A rate edge is 3 words: its first row and flags, and the faces beside it (kInvalidFace: none or, first, more than two).
const uint kRateEdgeWords = 3;
const uint kRateEdgeHalves = 0x80000000u;   // two rows, with half the edge's rate each
const uint kRateEdgeSubFace = 0x40000000u;  // from the middle of an edge to the middle of a face: one row
const uint kNoRateEdge = 0xffffffffu;       // beside no face of the surface
const uint kNoFace = 0xffffffffu;
const uint kManyFaces = 0xfffffffeu;

// Copies: pairs of a vertex, or a row's vertices, and what its position is that of.
const uint kTessCopyWords = 2;

// Where point `i` of a side of n segments is: in which row, and which of its points that is, 0 .. that row's segments;
// the row's segments where the side is no pair are n.
LIMN_FN uint point_of_row(uint side, uint n, uint i, LIMN_INOUT(uint) row) {
    const uint at = (side & kSideReversed) != 0u ? n - i : i;
    const bool second = (side & kSideHalves) != 0u && 2u * at > n;
    row = side_row(side) + (second ? 1u : 0u);
    return second ? at - n / 2u : at;
}

// The pattern of a face with these sides, whose rows have these rates; the fourth of each counts for quads only.
LIMN_FN TessPattern make_face_pattern(bool triangle, uint spacing, uint side0, uint side1, uint side2, uint side3, uint rate0,
                                      uint rate1, uint rate2, uint rate3) {
    const uint halves = (side0 / kSideHalves & 1u) | (side1 / kSideHalves & 1u) << 1u | (side2 / kSideHalves & 1u) << 2u |
                        (triangle ? 0u : (side3 / kSideHalves & 1u) << 3u);
    return make_pattern(triangle, spacing, rate0, rate1, rate2, rate3, halves);
}

// Edges are measured at this many places, evenly spaced from end to end: of which row, and where along it.
const uint kRateSamples = 5;
LIMN_FN uint row_of_rate_sample(uint edge_word, uint i, LIMN_INOUT(real) t) {
    const bool halves = (edge_word & kRateEdgeHalves) != 0u, second = halves && i > 2u;
    t = halves ? real(second ? i - 2u : i) / real(2) : real(i) / real(4);
    return side_row(edge_word) + (second ? 1u : 0u);
}

LIMN_SHARED_END
#endif
