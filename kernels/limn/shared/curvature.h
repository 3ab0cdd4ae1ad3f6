// Curvatures of a surface from its derivatives: the first and second fundamental forms, in a frame of the tangent plane.
#ifndef LIMN_SHARED_CURVATURE_H
#define LIMN_SHARED_CURVATURE_H
#include "limn/shared/jet.h"
LIMN_SHARED_BEGIN

struct SurfaceVector {
    real x, y, z;
};
LIMN_FN SurfaceVector make_vector(real x, real y, real z) {
    SurfaceVector v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
LIMN_FN real vector_dot(SurfaceVector a, SurfaceVector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
LIMN_FN SurfaceVector vector_cross(SurfaceVector a, SurfaceVector b) {
    return make_vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
// s a + t b
LIMN_FN SurfaceVector vector_sum(real s, SurfaceVector a, real t, SurfaceVector b) {
    return make_vector(s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z);
}
LIMN_FN real vector_length(SurfaceVector a) {
    // Of its largest component: squares of small ones would vanish.
    const real ax = a.x < real(0) ? -a.x : a.x, ay = a.y < real(0) ? -a.y : a.y, az = a.z < real(0) ? -a.z : a.z;
    const real largest = ax > ay ? (ax > az ? ax : az) : (ay > az ? ay : az);
    if (!(largest > real(0))) return real(0);
    const real x = a.x / largest, y = a.y / largest, z = a.z / largest;
    return largest * sqrt(x * x + y * y + z * z);
}

// As limn::Curvature (limn/curvature.h) explains.
struct PointCurvature {
    real gaussian, mean, first, second;
    SurfaceVector first_direction, second_direction;
};

// The sine of the angle between du and dv below which they span no plane.
const real kLeastSine = real(1e-6);

LIMN_FN PointCurvature curvature_of(SurfaceVector du, SurfaceVector dv, SurfaceVector duu, SurfaceVector duv,
                                    SurfaceVector dvv) {
    const real zero = real(0), one = real(1), two = real(2);
    const SurfaceVector none = make_vector(zero, zero, zero);
    PointCurvature at;
    at.gaussian = at.mean = at.first = at.second = zero;
    at.first_direction = at.second_direction = none;
    // du = a e1 and dv = b e1 + c e2, where e1, e2 and the normal are of length 1 and at right angles.
    const real a = vector_length(du), v = vector_length(dv);
    if (!(a > zero && v > zero)) return at;
    const SurfaceVector e1 = vector_sum(one / a, du, zero, none);
    const SurfaceVector across = vector_cross(e1, vector_sum(one / v, dv, zero, none));
    const real sine = vector_length(across);
    if (!(sine > kLeastSine)) return at;
    const SurfaceVector normal = vector_sum(one / sine, across, zero, none);
    const SurfaceVector e2 = vector_cross(normal, e1);
    const real b = vector_dot(dv, e1), c = sine * v, skew = b / a;
    // The second fundamental form in that frame, with the sign that makes spheres seen from outside positive.
    const real l = -vector_dot(normal, duu) / a, m = -vector_dot(normal, duv), n = -vector_dot(normal, dvv);
    const real s11 = l / a, s12 = (m / a - skew * l) / c;
    const real s22 = (n - two * skew * m + skew * skew * (l * a)) / c / c;
    const real mean = (s11 + s22) / two, half_difference = (s11 - s22) / two;
    const real radius = vector_length(make_vector(half_difference, s12, zero));
    at.mean = mean;
    at.gaussian = s11 * s22 - s12 * s12;
    at.first = mean + radius;
    at.second = mean - radius;
    // The eigenvector of mean + radius, by whichever row does not cancel; e1 at an umbilic.
    real x = half_difference >= zero ? radius + half_difference : s12;
    real y = half_difference >= zero ? s12 : radius - half_difference;
    const real length = vector_length(make_vector(x, y, zero));
    x = length > zero ? x / length : one;
    y = length > zero ? y / length : zero;
    at.first_direction = vector_sum(x, e1, y, e2);
    at.second_direction = vector_sum(-y, e1, x, e2);
    return at;
}

LIMN_SHARED_END
#endif
