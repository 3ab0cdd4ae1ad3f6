// Derivatives of what can only be had at places: by differences along two directions that stay within the face, exact for
// parabolas. Steps are a little longer than a segment of the highest rate, which leaves the cell around an irregular vertex,
// where patch trees hold the vertex alone.
#ifndef LIMN_SHARED_TESS_STEPS_H
#define LIMN_SHARED_TESS_STEPS_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

// The derivative along (u, v) is w0 * f(place) + w1 * f(place + t1 * (u, v)) + w2 * f(place + t2 * (u, v)).
struct TessStep {
    real u, v;
    real t1, t2;
    real w0, w1, w2;
};

LIMN_FN real step_size(uint max_rate) {
    return real(1.25) / real(max_rate);
}

LIMN_FN bool is_within_face(bool triangle, real u, real v) {
    const real one = real(1), little = real(1e-6);
    if (u < -little || v < -little) return false;
    return triangle ? u + v <= one + little : u <= one + little && v <= one + little;
}

// Which of the two directions, 0 or 1: of quads u and v, of triangles those from the nearest corner along its sides; the
// second lies counter-clockwise of the first.
LIMN_FN TessStep make_step(bool triangle, uint which, real u, real v, real size) {
    const real zero = real(0), one = real(1), two = real(2), w = one - u - v;
    TessStep s;
    s.u = which == 0u ? one : zero;
    s.v = which == 0u ? zero : one;
    if (triangle && u > v && u > w) {
        s.u = -one;
        s.v = which == 0u ? one : zero;
    } else if (triangle && v > w) {
        s.u = which == 0u ? zero : one;
        s.v = -one;
    }
    const bool forwards = is_within_face(triangle, u + size * s.u, v + size * s.v);
    const bool backwards = is_within_face(triangle, u - size * s.u, v - size * s.v);
    if (forwards && backwards) {
        s.t1 = -size;
        s.t2 = size;
        s.w0 = zero;
        s.w1 = -one / (two * size);
        s.w2 = one / (two * size);
    } else {
        const real turned = forwards ? one : -one;
        s.t1 = turned * size;
        s.t2 = two * s.t1;
        s.w0 = -real(3) / (two * s.t1);
        s.w1 = two / s.t1;
        s.w2 = -one / (two * s.t1);
    }
    return s;
}

LIMN_SHARED_END
#endif
