// Rates of edges. A rate is a function of the edge alone, so that both its faces have the same.
#ifndef LIMN_SHARED_TESS_RATE_H
#define LIMN_SHARED_TESS_RATE_H
#include "limn/shared/tess_layout.h"
LIMN_SHARED_BEGIN

// In the order of RateMode.
const uint kRateUniform = 0;
const uint kRatePerEdge = 1;
const uint kRateScreenLength = 2;
const uint kRatePixelError = 3;
const uint kRateChordError = 4;
const uint kRateDistance = 5;

// The mode looks at the edge itself: sub-face edges, too, then get what they need. Else they get half of what whole edges
// do.
LIMN_FN bool measures_edges(uint mode) {
    return mode == kRateScreenLength || mode == kRatePixelError || mode == kRateChordError;
}

struct TessPoint {
    real x, y, z;
};
// What the modes that look through a camera need of it: rows of the matrix from points to clip space.
struct RateCamera {
    real row_x[4];
    real row_y[4];
    real row_w[4];
    real width;  // of the viewport, pixels
    real height;
};

LIMN_FN real dot_row(real a, real b, real c, real d, TessPoint p) {
    return a * p.x + b * p.y + c * p.z + d;
}
LIMN_FN real length_of(real x, real y, real z) {
    return sqrt(x * x + y * y + z * z);
}
LIMN_FN real greater_of(real a, real b) {
    return a > b ? a : b;
}
LIMN_FN bool is_finite_point(TessPoint p) {
    return is_finite_number(p.x) && is_finite_number(p.y) && is_finite_number(p.z);
}

// The largest second difference of the samples: at n segments the chord is off by at most about 2 / n^2 of it (an eighth
// of the second derivative, which is 16 times the difference of samples a quarter apart).
LIMN_FN real bend_of(TessPoint p0, TessPoint p1, TessPoint p2, TessPoint p3, TessPoint p4) {
    const real two = real(2);
    const real a = length_of(p0.x - two * p1.x + p2.x, p0.y - two * p1.y + p2.y, p0.z - two * p1.z + p2.z);
    const real b = length_of(p1.x - two * p2.x + p3.x, p1.y - two * p2.y + p3.y, p1.z - two * p2.z + p3.z);
    const real c = length_of(p2.x - two * p3.x + p4.x, p2.y - two * p3.y + p4.y, p2.z - two * p3.z + p4.z);
    return greater_of(a, greater_of(b, c));
}

// Segments that an edge needs, in modes that look at it. `value`: the mode's: pixels, pixels, a length, or the distance at
// which the rate is 1.
LIMN_FN real measure_edge(uint mode, real value, RateCamera camera, TessPoint p0, TessPoint p1, TessPoint p2, TessPoint p3,
                          TessPoint p4) {
    const real zero = real(0), half_of = real(0.5), two = real(2);
    if (mode == kRateChordError) return sqrt(two * bend_of(p0, p1, p2, p3, p4) / value);

    real x[5], y[5], w[5];
    real farthest = zero, nearest = zero;
    for (int i = 0; i < 5; ++i) {
        TessPoint p = p0;
        if (i == 1) p = p1;
        if (i == 2) p = p2;
        if (i == 3) p = p3;
        if (i == 4) p = p4;
        w[i] = dot_row(camera.row_w[0], camera.row_w[1], camera.row_w[2], camera.row_w[3], p);
        x[i] = dot_row(camera.row_x[0], camera.row_x[1], camera.row_x[2], camera.row_x[3], p);
        y[i] = dot_row(camera.row_y[0], camera.row_y[1], camera.row_y[2], camera.row_y[3], p);
        farthest = i == 0 ? w[i] : greater_of(farthest, w[i]);
        nearest = i == 0 ? w[i] : -greater_of(-nearest, -w[i]);
    }
    if (!(farthest > zero)) return real(1);  // behind the camera
    // What reaches behind the camera is as if it ended close before it.
    nearest = greater_of(nearest, farthest * real(0.001));
    if (mode == kRateDistance) return value / nearest;
    // Pixels per unit of length at w = 1, for the larger of both directions.
    const real scale_x = length_of(camera.row_x[0], camera.row_x[1], camera.row_x[2]) * camera.width * half_of;
    const real scale_y = length_of(camera.row_y[0], camera.row_y[1], camera.row_y[2]) * camera.height * half_of;
    if (mode == kRatePixelError)
        return sqrt(two * bend_of(p0, p1, p2, p3, p4) * greater_of(scale_x, scale_y) / (nearest * value));
    real pixels = zero;
    for (int i = 0; i < 5; ++i) {
        w[i] = greater_of(w[i], nearest);
        x[i] = x[i] / w[i] * camera.width * half_of;
        y[i] = y[i] / w[i] * camera.height * half_of;
        if (i > 0) pixels += length_of(x[i] - x[i - 1], y[i] - y[i - 1], zero);
    }
    return pixels / value;
}

// Segments that an edge should have, not yet rounded and at most `most`; 0 where a sample is no number, or the rate given is
// none. What is measured is never 0: a flat edge has one segment, too. `value` in uniform mode and `given` in mode per_edge
// are rates.
LIMN_FN real edge_target(uint mode, real value, real given, uint most, RateCamera camera, TessPoint p0, TessPoint p1,
                         TessPoint p2, TessPoint p3, TessPoint p4) {
    const real zero = real(0), largest = real(most), least = real(0.001);
    if (!(is_finite_point(p0) && is_finite_point(p1) && is_finite_point(p2) && is_finite_point(p3) && is_finite_point(p4)))
        return zero;
    real target = mode == kRateUniform ? value : given;
    if (mode == kRateUniform || mode == kRatePerEdge) {
        if (!is_finite_number(target) || target <= zero) return zero;
    } else {
        target = measure_edge(mode, value, camera, p0, p1, p2, p3, p4);
        if (!is_finite_number(target)) target = largest;  // an error so small that its share of the edge overflows
        target = greater_of(target, least);
    }
    return target < largest ? target : largest;
}

// Rounding thresholds of edges, spread evenly over 0 .. 1 by the golden ratio: where a budget scales all rates by one
// number, the sum follows it closely although each rate is a whole number.
LIMN_FN real rate_dither(uint edge) {
    return real((edge * 2654435769u) >> 8u) / real(16777216);
}

// The rate of a rate edge in fixed point, of each half where it has two; 0: faces beside it are not drawn. `dither` < 0:
// to the nearest.
LIMN_FN uint round_rate(real target, real scale, uint spacing, uint most_segments, uint flags, bool measured, real dither) {
    if (!is_finite_number(target) || target <= real(0)) return 0u;
    const bool halves = (flags & kRateEdgeHalves) != 0u, sub_face = (flags & kRateEdgeSubFace) != 0u;
    const uint least = spacing == kSpacingFractional ? 2u : 1u;
    const uint most = halves || sub_face ? (most_segments / 2u > least ? most_segments / 2u : least) : most_segments;
    real rate = target * scale;
    if (halves || (sub_face && !measured)) rate = rate / real(2);
    // Fractional rates stay what they are, moved apart by up to a segment as the scale leaves 1: no rate jumps.
    if (spacing == kSpacingFractional && dither >= real(0)) {
        const real apart = real(8) * (real(1) - scale);
        rate += (real(2) * dither - real(1)) * (apart < real(1) ? apart : real(1));
    }
    if (!(rate > real(least))) return least * kRateOne;
    if (rate >= real(most)) return most * kRateOne;
    if (spacing == kSpacingFractional) return uint(rate * real(kRateOne));
    if (spacing == kSpacingInteger) {
        const uint rounded = uint(rate + (dither < real(0) ? real(0.5) : dither));
        return (rounded < most ? rounded : most) * kRateOne;
    }
    // Up where rate / power is at least 2^(1 - threshold), for which 2 - threshold stands; to the nearest: sqrt(2).
    uint power = 1u;
    while (power * 2u <= most && rate >= real(power * 2u)) power *= 2u;
    const real limit = dither < real(0) ? real(1.41421356) : real(2) - dither;
    if (rate >= real(power) * limit && power * 2u <= most) power *= 2u;
    return power * kRateOne;
}

LIMN_SHARED_END
#endif
