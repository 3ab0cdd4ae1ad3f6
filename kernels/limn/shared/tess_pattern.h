// How a face is filled with triangles once its sides have rates: counts, positions in (u, v), and which vertices each
// triangle has. Host and kernels share it, so that they agree on every index.
//
// A side with n segments has points 0 .. n, counted along the face's boundary; quads have sides 0 .. 3, from (0,0)
// through (1,0), (1,1), (0,1), triangles 0 .. 2, from (0,0) through (1,0), (0,1). Inside a quad lies a grid of
// (columns - 1) x (rows - 1) points, as fine as the finer of opposite sides. Inside a triangle lies a triangular lattice
// as fine as its finest side or, with fractional spacing, concentric rings. Strips of triangles join the sides to what is
// inside; each of their triangles stands on one segment, of the side (outer) or of the inside (inner).
#ifndef LIMN_SHARED_TESS_PATTERN_H
#define LIMN_SHARED_TESS_PATTERN_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

// Spacings, in the order of TessellationSpacing.
const uint kSpacingInteger = 0;
const uint kSpacingPowerOfTwo = 1;
const uint kSpacingFractional = 2;

// Rates are fixed point. A side of two halves, each with a rate of its own, has twice that.
const uint kRateOne = 65536;
const uint kMaxSideRate = 128;

// a / b, rounded down, where a is less than 2^20: one division of floats, in place of one of integers for each invocation on
// llvmpipe, and of some twenty instructions on GPUs. The half keeps it apart from whole numbers by more than rounding.
LIMN_FN uint quotient(uint a, uint b) {
    return uint((real(a) + real(0.5)) / real(b));
}

// Segments at a rate. Fractional spacing has an even number of them: all equally long but for two, the newest, which
// grow with the rate from nothing (Moreton 2001, and fractional_even_spacing of hardware tessellation).
LIMN_FN uint segment_count(uint rate, bool fractional) {
    return fractional ? 2u * ((rate + 2u * kRateOne - 1u) / (2u * kRateOne)) : rate / kRateOne;
}

// Fractional spacing: of the `half` segments of half a side the first is the oldest; the others came in the order of the
// van der Corput sequence, so that i has the slot that is i with its bits reversed. Slots never change: what has been
// joined in their order stays joined while segments come and go, and nothing pops.
const uint kSlotBits = 6;

// How many of the `half` segments have a slot below this one.
LIMN_FN uint slots_below(uint half_count, uint slot) {
    uint below = 0u, left = half_count;
    if (slot >= 1u << kSlotBits) return half_count;
    for (uint bit = kSlotBits; bit-- > 0u;) {
        const uint lower = (left + 1u) / 2u;
        const bool upper = (slot >> bit & 1u) != 0u;
        below += upper ? lower : 0u;
        left = upper ? left / 2u : lower;
    }
    return below;
}
// The slot of segment i.
LIMN_FN uint slot_of_segment(uint half_count, uint i) {
    uint slot = 0u, left = half_count, rest = i;
    for (uint bit = kSlotBits; bit-- > 0u;) {
        const uint lower = (left + 1u) / 2u;
        const bool upper = rest >= lower;
        slot |= upper ? 1u << bit : 0u;
        rest -= upper ? lower : 0u;
        left = upper ? left / 2u : lower;
    }
    return slot;
}
// Which segment is the newest, that is number half_count - 1 of the sequence.
LIMN_FN uint newest_segment(uint half_count) {
    uint below = 0u, left = half_count, i = half_count - 1u;
    for (uint bit = 0u; bit < kSlotBits; ++bit) {
        const uint lower = (left + 1u) / 2u;
        const bool upper = (i & 1u) != 0u;
        below += upper ? lower : 0u;
        left = upper ? left / 2u : lower;
        i >>= 1u;
    }
    return below;
}

// Where point i of a side of this rate is, 0 .. 1.
LIMN_FN real point_on_side(uint rate, bool fractional, uint i) {
    const uint n = segment_count(rate, fractional);
    if (!fractional) return real(i) / real(n);
    const uint half_count = n / 2u, from_end = i <= half_count ? i : n - i;
    const real length = real(rate) / real(kRateOne);
    real at = real(from_end);
    if (from_end > newest_segment(half_count)) at += length / real(2) - real(half_count);  // short of a segment
    at = from_end == half_count ? real(0.5) : at / length;
    return i <= half_count ? at : real(1) - at;
}

// A face's pattern.
struct TessPattern {
    bool triangle;
    bool fractional;
    uint segments[4];  // of each side
    bool halves[4];    // the side is made of two
    uint columns;      // segments along u, or of the inside of a triangle
    uint rows;         // along v
    uint column_rate;
    uint row_rate;
};

LIMN_FN uint max_rate(uint a, uint b) {
    return a > b ? a : b;
}

// The pattern for rates of the sides, those of halves where there are two.
LIMN_FN TessPattern make_pattern(bool triangle, uint spacing, uint rate0, uint rate1, uint rate2, uint rate3, uint halves) {
    TessPattern p;
    p.triangle = triangle;
    p.fractional = spacing == kSpacingFractional;
    p.halves[0] = (halves & 1u) != 0u;
    p.halves[1] = (halves & 2u) != 0u;
    p.halves[2] = (halves & 4u) != 0u;
    p.halves[3] = (halves & 8u) != 0u;
    p.segments[0] = segment_count(rate0, p.fractional) << (p.halves[0] ? 1u : 0u);
    p.segments[1] = segment_count(rate1, p.fractional) << (p.halves[1] ? 1u : 0u);
    p.segments[2] = segment_count(rate2, p.fractional) << (p.halves[2] ? 1u : 0u);
    p.segments[3] = triangle ? 0u : segment_count(rate3, p.fractional) << (p.halves[3] ? 1u : 0u);
    const uint side0 = rate0 << (p.halves[0] ? 1u : 0u), side1 = rate1 << (p.halves[1] ? 1u : 0u);
    const uint side2 = rate2 << (p.halves[2] ? 1u : 0u), side3 = rate3 << (p.halves[3] ? 1u : 0u);
    p.column_rate = triangle ? max_rate(side0, max_rate(side1, side2)) : max_rate(side0, side2);
    p.row_rate = triangle ? p.column_rate : max_rate(side1, side3);
    p.columns = segment_count(p.column_rate, p.fractional);
    p.rows = triangle ? p.columns : segment_count(p.row_rate, p.fractional);
    return p;
}

LIMN_FN uint side_count(TessPattern p) {
    return p.triangle ? 3u : 4u;
}
LIMN_FN uint boundary_segments(TessPattern p) {
    return p.segments[0] + p.segments[1] + p.segments[2] + p.segments[3];
}

// Nothing is inside: the triangles join sides to each other.
LIMN_FN bool is_hollow(TessPattern p) {
    return p.triangle ? p.columns < 3u && !p.fractional : p.columns == 1u || p.rows == 1u;
}

LIMN_FN uint inner_vertex_count(TessPattern p) {
    if (is_hollow(p)) return 0u;
    if (!p.triangle) return (p.columns - 1u) * (p.rows - 1u);
    const uint half_count = p.columns / 2u;
    return p.fractional ? 3u * half_count * (half_count - 1u) + 1u : (p.columns - 1u) * (p.columns - 2u) / 2u;
}

// Segments of the inside along side k.
LIMN_FN uint inner_segments(TessPattern p, uint k) {
    if (p.triangle) return p.columns - (p.fractional ? 2u : 3u);
    return ((k & 1u) == 0u ? p.columns : p.rows) - 2u;
}

// Triangles that do not touch the sides' strips.
LIMN_FN uint inner_triangle_count(TessPattern p) {
    if (is_hollow(p)) return 0u;
    if (!p.triangle) return 2u * (p.columns - 2u) * (p.rows - 2u);
    const uint rings = p.columns / 2u - 1u;
    return p.fractional ? 6u * rings * rings : (p.columns - 3u) * (p.columns - 3u);
}

// Triangles of the strip along side k. Hollow quads have two strips on one pair of sides, whose triangles stand on those
// sides; a hollow triangle has one.
LIMN_FN uint strip_triangle_count(TessPattern p, uint k) {
    if (!is_hollow(p)) return p.segments[k] + inner_segments(p, k);
    if (p.triangle) return k == 0u ? boundary_segments(p) - 2u : 0u;
    const uint first = p.columns == 1u ? 1u : 0u;  // sides 1 and 3 face each other across one column
    return (k & 1u) == first ? p.segments[k] : 0u;
}

LIMN_FN uint triangle_count(TessPattern p) {
    if (p.triangle && is_hollow(p)) return boundary_segments(p) - 2u;
    if (is_hollow(p)) return p.columns == 1u ? p.segments[1] + p.segments[3] : p.segments[0] + p.segments[2];
    return inner_triangle_count(p) + boundary_segments(p) + 2u * (inner_segments(p, 0u) + inner_segments(p, 1u)) -
           (p.triangle ? inner_segments(p, 0u) : 0u);
}

// A vertex of a triangle: point i of side k, or one of the inside.
struct TessVertex {
    uint side;  // kInside
    uint i;
};
const uint kInside = 4;
LIMN_FN TessVertex make_tess_vertex(uint side, uint i) {
    TessVertex v;
    v.side = side;
    v.i = i;
    return v;
}

// Numbers of inner vertices: of grids row by row; of lattices, whose rows get shorter, too.
LIMN_FN uint grid_vertex(TessPattern p, uint column, uint row) {
    return (row - 1u) * (p.columns - 1u) + column - 1u;
}
LIMN_FN uint lattice_vertex(TessPattern p, uint i, uint j) {
    return (j - 1u) * (p.columns - 1u) - (j - 1u) * j / 2u + i - 1u;
}
// Rings are numbered from the centre: ring d has 6 d points, 2 d along each side.
LIMN_FN uint ring_vertex(uint d, uint k, uint i) {
    if (d == 0u) return 0u;
    const uint side = i == 2u * d ? (k + 1u) % 3u : k;
    return 3u * d * (d - 1u) + 1u + side * 2u * d + (i == 2u * d ? 0u : i);
}

// Point i of the inside along side k.
LIMN_FN TessVertex inner_vertex(TessPattern p, uint k, uint i) {
    uint number;
    if (p.triangle && p.fractional) {
        number = ring_vertex(p.columns / 2u - 1u, k, i);
    } else if (p.triangle) {
        const uint last = p.columns - 2u;
        number = k == 0u   ? lattice_vertex(p, 1u + i, 1u)
                 : k == 1u ? lattice_vertex(p, last - i, 1u + i)
                           : lattice_vertex(p, 1u, last - i);
    } else {
        number = k == 0u   ? grid_vertex(p, 1u + i, 1u)
                 : k == 1u ? grid_vertex(p, p.columns - 1u, 1u + i)
                 : k == 2u ? grid_vertex(p, p.columns - 1u - i, p.rows - 1u)
                           : grid_vertex(p, 1u, p.rows - 1u - i);
    }
    return make_tess_vertex(kInside, number);
}

// How a strip's two rows of segments are joined: in the order of their middles, or of their slots, each as a number
// 0 .. 255 along the strip. Where two are equal the outer one comes first in the first half, last in the second.

// How many of the other row's segments come before one of a row of `own` segments. Twice the middle of that one, times
// other / own and then one more where equal ones come before it, is `at`; `first` is the same for the other row's first.
LIMN_FN uint segments_before(uint at, uint first, uint own, uint most) {
    const uint count = at <= first ? 0u : quotient(at - first + 2u * own - 1u, 2u * own);
    return count < most ? count : most;
}

// Fractional: the place of segment i of a side of n, made of halves or not.
LIMN_FN uint segment_key(uint i, uint n) {
    return 2u * i < n ? 2u * slot_of_segment(n / 2u, i) : 255u - 2u * slot_of_segment(n / 2u, n - 1u - i);
}
LIMN_FN uint side_key(uint i, uint n, bool halves) {
    if (!halves) return segment_key(i, n);
    return 2u * i < n ? segment_key(i, n / 2u) / 2u : 255u - segment_key(n - 1u - i, n / 2u) / 2u;
}
LIMN_FN uint keys_below(uint key, uint n) {
    if (key <= 128u) return slots_below(n / 2u, (key + 1u) / 2u);
    return key > 255u ? n : n - slots_below(n / 2u, (255u - key) / 2u + 1u);
}
LIMN_FN uint side_keys_below(uint key, uint n, bool halves) {
    if (!halves) return keys_below(key, n);
    return key <= 128u ? keys_below(2u * key, n / 2u) : n - keys_below(2u * (256u - key), n / 2u);
}
// Of the inner row, which is a side of `inner` segments without `skip` of them at either end.
LIMN_FN uint inner_before_key(uint key, uint inner, uint skip) {
    const uint count = keys_below(key + (key >= 128u ? 1u : 0u), inner);
    if (count < skip) return 0u;
    return count - skip < inner - 2u * skip ? count - skip : inner - 2u * skip;
}

// Triangle `at` of the strip along side k: it stands on a segment of the side (outer) or of the inside, and its apex is a
// point of the other. Hollow quads are ladders between sides k and k + 2: apices are points of the side across. Not of hollow
// triangles.
struct StripTriangle {
    bool outer;
    uint segment;
    uint apex;
};
LIMN_FN StripTriangle strip_triangle_at(TessPattern p, uint k, uint at) {
    const bool ladder = !p.triangle && is_hollow(p), against = ladder && k >= 2u;
    const uint n = p.segments[k];
    StripTriangle t;
    t.outer = at < n;
    t.segment = t.outer ? at : at - n;
    if (p.fractional) {
        const uint inner = (p.triangle || (k & 1u) == 0u) ? p.columns : p.rows, key = segment_key(t.segment + 1u, inner);
        t.apex = t.outer ? inner_before_key(side_key(t.segment, n, p.halves[k]), inner, 1u)
                         : side_keys_below(key + (key < 128u ? 1u : 0u), n, p.halves[k]);
        return t;
    }
    // The middles of the inside's segments are at (2 j + offset) / (2 inner). Of ladders both rows are counted along side 0
    // or 1.
    const uint inner = ladder ? p.segments[(k + 2u) % 4u] : (p.triangle || (k & 1u) == 0u) ? p.columns : p.rows;
    const uint offset = ladder ? 1u : p.triangle ? 4u : 3u;
    const uint middle = 2u * (against ? n - 1u - at : t.segment) + (t.outer ? 1u : offset);
    const uint own = t.outer ? n : inner, other = t.outer ? inner : n;
    const bool after_equal = (middle > own) == (t.outer != against);
    t.apex = segments_before(middle * other + (after_equal ? 1u : 0u), t.outer ? offset * n : inner, own,
                             t.outer ? inner + 1u - offset : n);
    if (ladder && !against) t.apex = inner - t.apex;
    return t;
}

// Hollow triangles have one strip.
LIMN_FN void hollow_triangle(TessPattern p, uint at, LIMN_INOUT(TessVertex) a, LIMN_INOUT(TessVertex) b,
                             LIMN_INOUT(TessVertex) c) {
    // One or two segments a side: corners of divided sides are cut off, what is left is one triangle or two.
    const bool m0 = p.segments[0] == 2u, m1 = p.segments[1] == 2u, m2 = p.segments[2] == 2u;
    const TessVertex c0 = make_tess_vertex(0u, 0u), c1 = make_tess_vertex(1u, 0u), c2 = make_tess_vertex(2u, 0u);
    const TessVertex s0 = make_tess_vertex(0u, 1u), s1 = make_tess_vertex(1u, 1u), s2 = make_tess_vertex(2u, 1u);
    const uint divided = (m0 ? 1u : 0u) + (m1 ? 1u : 0u) + (m2 ? 1u : 0u);
    if (divided == 0u) {
        a = c0;
        b = c1;
        c = c2;
    } else if (divided == 1u) {  // from the middle to the corner across
        const TessVertex middle = m0 ? s0 : m1 ? s1 : s2, across = m0 ? c2 : m1 ? c0 : c1;
        const TessVertex before = m0 ? c0 : m1 ? c1 : c2, after = m0 ? c1 : m1 ? c2 : c0;
        a = middle;
        b = at == 0u ? across : after;
        c = at == 0u ? before : across;
    } else if (divided == 2u) {  // the corner between both middles, and a quad
        const TessVertex first = !m0 ? s1 : !m1 ? s2 : s0, second = !m0 ? s2 : !m1 ? s0 : s1;
        const TessVertex between = !m0 ? c2 : !m1 ? c0 : c1, next = !m0 ? c0 : !m1 ? c1 : c2;
        const TessVertex last = !m0 ? c1 : !m1 ? c2 : c0;
        a = first;
        b = at == 0u ? between : second;
        c = at == 0u ? second : next;
        if (at == 2u) {
            b = next;
            c = last;
        }
    } else {
        a = at == 0u ? c0 : at == 1u ? c1 : at == 2u ? c2 : s0;
        b = at == 0u ? s0 : at == 1u ? s1 : at == 2u ? s2 : s1;
        c = at == 0u ? s2 : at == 1u ? s0 : at == 2u ? s1 : s2;
    }
}

// Triangle `at` of the strip along side k, counter-clockwise.
LIMN_FN void strip_triangle(TessPattern p, uint k, uint at, LIMN_INOUT(TessVertex) a, LIMN_INOUT(TessVertex) b,
                            LIMN_INOUT(TessVertex) c) {
    if (p.triangle && is_hollow(p)) {
        hollow_triangle(p, at, a, b, c);
        return;
    }
    const StripTriangle t = strip_triangle_at(p, k, at);
    if (t.outer) {
        a = make_tess_vertex(k, t.segment);
        b = make_tess_vertex(k, t.segment + 1u);
        c = is_hollow(p) ? make_tess_vertex((k + 2u) % 4u, t.apex) : inner_vertex(p, k, t.apex);
    } else {
        a = inner_vertex(p, k, t.segment + 1u);
        b = inner_vertex(p, k, t.segment);
        c = make_tess_vertex(k, t.apex);
    }
}

// The largest integer whose square is at most x < 2^24.
LIMN_FN uint floor_sqrt(uint x) {
    uint root = 0u;
    for (uint bit = 1u << 11u; bit != 0u; bit >>= 1u)
        if ((root + bit) * (root + bit) <= x) root += bit;
    return root;
}

// Cell (column, row) of the inner grid, 1 .. columns - 2 and rows - 2: two triangles, cut by a diagonal towards the
// middle of the face, as four corners of which the first is where the cut begins: (0, 1, 2) and (0, 2, 3).
LIMN_FN void grid_cell(TessPattern p, uint column, uint row, LIMN_OUT_ARRAY(uint, corners, 4)) {
    const uint first = grid_vertex(p, column, row), above = first + p.columns - 1u;
    const bool right = 2u * column >= p.columns, upper = 2u * row >= p.rows;
    const bool turned = right != upper;
    corners[0] = turned ? first + 1u : first;
    corners[1] = turned ? above + 1u : first + 1u;
    corners[2] = turned ? above : above + 1u;
    corners[3] = turned ? first : above;
}

// Triangle `at` of those inside, counter-clockwise.
LIMN_FN void inner_triangle(TessPattern p, uint at, LIMN_INOUT(TessVertex) a, LIMN_INOUT(TessVertex) b,
                            LIMN_INOUT(TessVertex) c) {
    if (!p.triangle) {
        uint corners[4];
        const uint cell = at / 2u, row = quotient(cell, p.columns - 2u);
        grid_cell(p, 1u + cell - row * (p.columns - 2u), 1u + row, corners);
        a = make_tess_vertex(kInside, corners[0]);
        b = make_tess_vertex(kInside, corners[1u + (at & 1u)]);
        c = make_tess_vertex(kInside, corners[2u + (at & 1u)]);
    } else if (!p.fractional) {
        // Rows of 2 (size - j) - 1 triangles; what is left from row j on is a square number.
        const uint size = p.columns - 3u, left = size * size - at, root = floor_sqrt(left - 1u) + 1u;
        const uint j = size - root, x = at - (size * size - root * root), i = x / 2u;
        const bool down = (x & 1u) != 0u;
        a = make_tess_vertex(kInside, lattice_vertex(p, 1u + i + (down ? 1u : 0u), 1u + j));
        b = make_tess_vertex(kInside, lattice_vertex(p, 2u + i, 1u + j + (down ? 1u : 0u)));
        c = make_tess_vertex(kInside, lattice_vertex(p, 1u + i, 2u + j));
    } else {
        // From the centre: the strips between rings d and d - 1 have 3 (4 d - 2) triangles.
        const uint d = floor_sqrt(at / 6u) + 1u, x = at - 6u * (d - 1u) * (d - 1u);
        const uint k = quotient(x, 4u * d - 2u), i = x - k * (4u * d - 2u), skip = p.columns / 2u - d;
        if (i < 2u * d) {
            const uint apex = inner_before_key(segment_key(i + skip, p.columns), p.columns, skip + 1u);
            a = make_tess_vertex(kInside, ring_vertex(d, k, i));
            b = make_tess_vertex(kInside, ring_vertex(d, k, i + 1u));
            c = make_tess_vertex(kInside, ring_vertex(d - 1u, k, apex));
        } else {
            const uint j = i - 2u * d, key = segment_key(j + skip + 1u, p.columns);
            const uint apex = keys_below(key + (key < 128u ? 1u : 0u), p.columns) - skip;
            a = make_tess_vertex(kInside, ring_vertex(d - 1u, k, j + 1u));
            b = make_tess_vertex(kInside, ring_vertex(d - 1u, k, j));
            c = make_tess_vertex(kInside, ring_vertex(d, k, apex));
        }
    }
}

// Where point i of side k of the ring is that begins at point `ring` of a side; i from there on, too.
LIMN_FN void locate_ring_point(TessPattern p, uint ring, uint k, uint i, LIMN_INOUT(real) u, LIMN_INOUT(real) v) {
    const real third = real(1) / real(3), first = point_on_side(p.column_rate, p.fractional, ring);
    const real t = (point_on_side(p.column_rate, p.fractional, i) - first) / (real(1) - real(2) * first);
    // The ring's corners: `far` of the face's own corner, `near` of both others.
    const real near = real(2) * third * first, far = real(1) - real(2) * near;
    const real from = far + (near - far) * t, to = near + (far - near) * t;
    u = k == 0u ? to : k == 1u ? from : near;
    v = k == 0u ? near : k == 1u ? to : from;
}

// Where inner vertex `number` is.
LIMN_FN void locate_inner_vertex(TessPattern p, uint number, LIMN_INOUT(real) u, LIMN_INOUT(real) v) {
    if (!p.triangle) {
        const uint row = quotient(number, p.columns - 1u);
        u = point_on_side(p.column_rate, p.fractional, 1u + number - row * (p.columns - 1u));
        v = point_on_side(p.row_rate, p.fractional, 1u + row);
    } else if (!p.fractional) {
        // From row j on (size - j + 1) (size - j + 2) / 2 are left, a triangular number.
        const uint size = p.columns - 2u, left = size * (size + 1u) / 2u - number;
        const uint root = (floor_sqrt(8u * left - 7u) + 1u) / 2u;
        const uint j = 1u + size - root, i = 1u + root * (root + 1u) / 2u - left;
        u = real(i) / real(p.columns);
        v = real(j) / real(p.columns);
    } else {
        u = real(1) / real(3);
        v = u;
        if (number == 0u) return;
        const uint d = (floor_sqrt((number - 1u) / 3u * 4u + 1u) + 1u) / 2u;
        const uint x = number - 1u - 3u * d * (d - 1u), k = quotient(x, 2u * d), i = x - k * 2u * d;
        const uint skip = p.columns / 2u - d;
        locate_ring_point(p, skip, k, skip + i, u, v);
    }
}

// Where point t of side k is, t from 0 to 1.
LIMN_FN void locate_on_side(bool triangle, uint k, real t, LIMN_INOUT(real) u, LIMN_INOUT(real) v) {
    const real zero = real(0), one = real(1);
    if (triangle) {
        u = k == 0u ? t : k == 1u ? one - t : zero;
        v = k == 0u ? zero : k == 1u ? t : one - t;
    } else {
        u = k == 0u ? t : k == 1u ? one : k == 2u ? one - t : zero;
        v = k == 0u ? zero : k == 1u ? t : k == 2u ? one : one - t;
    }
}

LIMN_SHARED_END
#endif
