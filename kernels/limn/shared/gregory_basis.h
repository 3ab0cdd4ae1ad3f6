// Basis functions of Gregory patches: Loop, Schaefer, Ni and Castano 2009, "Approximating Subdivision
// Surfaces with Gregory Patches for Hardware Tessellation".
//
// A Gregory patch is a Bezier patch (bicubic, or a quartic triangle) whose interior points are each a blend
// of two, one for either side of a corner. With (a, b) the coordinates that vanish at the corner, a growing
// towards the next corner:
//   f = (a f+ + b f-) / (a + b)
// Points, five a corner in the order P, e+, e-, f+, f-: corner k has points 5k .. 5k + 4; the midpoints of
// the three quartic sides, from corner k to the next, are points 15 + k.
//
// `true_derivatives`: of the rational patch. Otherwise OpenSubdiv's, which hold the blend constant while they
// differentiate. Second derivatives at a corner itself depend on the direction in which it is approached;
// those along a = b are given there.
#ifndef LIMN_SHARED_GREGORY_BASIS_H
#define LIMN_SHARED_GREGORY_BASIS_H
#include "limn/shared/jet.h"
LIMN_SHARED_BEGIN

/// a / (a + b) times a b, by a and b: the share of f+. All in terms of the shares p and q and of s = a + b,
/// so that nothing is divided by zero at the corner.
LIMN_FN Jet gregory_blend(real a, real b, bool true_derivatives) {
    real s = a + b;
    real p = s > 0.0 ? a / s : real(0.5);
    real q = s > 0.0 ? b / s : real(0.5);
    if (!true_derivatives) return make_jet(p * a * b, p * b, p * a, 0.0, p, 0.0);
    return make_jet(s * p * a * q, s * p * q * (p + 2.0 * q), s * p * p * p, 2.0 * q * q * q,
                    p * p * (p + 3.0 * q), -2.0 * p * p * p);
}

/// The share of f-: a and b swapped.
LIMN_FN Jet gregory_blend_swapped(real a, real b, bool true_derivatives) {
    Jet j = gregory_blend(b, a, true_derivatives);
    return make_jet(j.f, j.v, j.u, j.vv, j.uv, j.uu);
}

/// From the coordinates (v, 1 - u) of the next corner of the unit square to (u, v).
LIMN_FN Jet gregory_turn(Jet j) {
    return make_jet(j.f, -j.v, j.u, j.vv, -j.uv, j.uu);
}

/// From the coordinates (v, 1 - u - v) of the next corner of the triangle to (u, v).
LIMN_FN Jet gregory_turn_triangle(Jet j) {
    return make_jet(j.f, -j.v, j.u - j.v, j.vv, j.vv - j.uv, j.uu - 2.0 * j.uv + j.vv);
}

// The functions of points 5k .. 5k + 4, those of corner k.
LIMN_FN void gregory_corner(int k, real u, real v, bool true_derivatives, LIMN_OUT_ARRAY(Jet, basis, 5)) {
    real a = k == 0 ? u : k == 1 ? v : k == 2 ? 1.0 - u : 1.0 - v;
    real b = k == 0 ? v : k == 1 ? 1.0 - u : k == 2 ? 1.0 - v : u;
    real c = 1.0 - a, d = 1.0 - b;
    // Bernstein polynomials by a alone and by b alone: (1 - a)^3, 3 a (1 - a)^2 and (1 - a)^2.
    Jet a0 = make_jet(c * c * c, -3.0 * c * c, 0.0, 6.0 * c, 0.0, 0.0);
    Jet b0 = make_jet(d * d * d, 0.0, -3.0 * d * d, 0.0, 0.0, 6.0 * d);
    Jet a1 = make_jet(3.0 * a * c * c, 3.0 * c * (c - 2.0 * a), 0.0, 6.0 * (a - 2.0 * c), 0.0, 0.0);
    Jet b1 = make_jet(3.0 * b * d * d, 0.0, 3.0 * d * (d - 2.0 * b), 0.0, 0.0, 6.0 * (b - 2.0 * d));
    Jet a2 = make_jet(c * c, -2.0 * c, 0.0, 2.0, 0.0, 0.0);
    Jet b2 = make_jet(d * d, 0.0, -2.0 * d, 0.0, 0.0, 2.0);
    Jet rest = jet_scale(9.0, jet_mul(a2, b2));
    basis[0] = jet_mul(a0, b0);
    basis[1] = jet_mul(a1, b0);
    basis[2] = jet_mul(a0, b1);
    basis[3] = jet_mul(rest, gregory_blend(a, b, true_derivatives));
    basis[4] = jet_mul(rest, gregory_blend_swapped(a, b, true_derivatives));
    for (int i = 0; i < 5; ++i)
        for (int turn = 0; turn < k; ++turn) basis[i] = gregory_turn(basis[i]);
}

LIMN_FN void gregory_basis(real u, real v, bool true_derivatives, LIMN_OUT_ARRAY(Jet, basis, 20)) {
    for (int k = 0; k < 4; ++k) {
        Jet corner[5];
        gregory_corner(k, u, v, true_derivatives, corner);
        for (int i = 0; i < 5; ++i) basis[5 * k + i] = corner[i];
    }
}

// The functions of points 5k .. 5k + 4, and of point 15 + k.
LIMN_FN void gregory_triangle_corner(int k, real u, real v, bool true_derivatives, LIMN_OUT_ARRAY(Jet, basis, 6)) {
    real w = 1.0 - u - v;
    real a = k == 0 ? u : k == 1 ? v : w;
    real b = k == 0 ? v : k == 1 ? w : u;
    Jet ja = make_jet(a, 1.0, 0.0, 0.0, 0.0, 0.0), jb = make_jet(b, 0.0, 1.0, 0.0, 0.0, 0.0);
    Jet c = make_jet(1.0 - a - b, -1.0, -1.0, 0.0, 0.0, 0.0);
    Jet cc = jet_mul(c, c);
    Jet ccc = jet_mul(cc, c);
    basis[0] = jet_mul(cc, cc);
    basis[1] = jet_scale(4.0, jet_mul(ccc, ja));
    basis[2] = jet_scale(4.0, jet_mul(ccc, jb));
    basis[3] = jet_scale(12.0, jet_mul(cc, gregory_blend(a, b, true_derivatives)));
    basis[4] = jet_scale(12.0, jet_mul(cc, gregory_blend_swapped(a, b, true_derivatives)));
    basis[5] = jet_scale(6.0, jet_mul(cc, jet_mul(ja, ja)));
    for (int i = 0; i < 6; ++i)
        for (int turn = 0; turn < k; ++turn) basis[i] = gregory_turn_triangle(basis[i]);
}

LIMN_FN void gregory_triangle_basis(real u, real v, bool true_derivatives, LIMN_OUT_ARRAY(Jet, basis, 18)) {
    for (int k = 0; k < 3; ++k) {
        Jet corner[6];
        gregory_triangle_corner(k, u, v, true_derivatives, corner);
        for (int i = 0; i < 5; ++i) basis[5 * k + i] = corner[i];
        basis[15 + k] = corner[5];
    }
}

LIMN_SHARED_END
#endif
