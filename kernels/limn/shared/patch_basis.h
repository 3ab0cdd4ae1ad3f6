// The basis functions of patches, with first and second derivatives.
#ifndef LIMN_SHARED_PATCH_BASIS_H
#define LIMN_SHARED_PATCH_BASIS_H
#include "limn/shared/gregory_basis.h"
#include "limn/shared/jet.h"
#include "limn/shared/patch_table_layout.h"
LIMN_SHARED_BEGIN

const uint kMaxPatchPoints = 20;

// Uniform cubic B-spline at t: values, first and second derivatives of the four functions.
LIMN_FN void cubic_basis(real t, LIMN_OUT_ARRAY(real, f, 4), LIMN_OUT_ARRAY(real, d, 4), LIMN_OUT_ARRAY(real, dd, 4)) {
    const real one = real(1), two = real(2), three = real(3), four = real(4), six = real(6);
    const real s = one - t;
    f[0] = s * s * s / six;
    f[1] = (four - six * t * t + three * t * t * t) / six;
    f[2] = (four - six * s * s + three * s * s * s) / six;
    f[3] = t * t * t / six;
    d[0] = -s * s / two;
    d[1] = (three * t * t - four * t) / two;
    d[2] = (four * s - three * s * s) / two;
    d[3] = t * t / two;
    dd[0] = s;
    dd[1] = three * t - two;
    dd[2] = three * s - two;
    dd[3] = t;
}

// What four control points of a uniform cubic spline f, with knots 1 apart, weigh for the control point at t of the same
// spline with knots h apart: that is f - h^2 f'' / 6.
LIMN_FN void refined_cubic_basis(real t, real h, LIMN_OUT_ARRAY(real, f, 4)) {
    real d[4], dd[4];
    cubic_basis(t, f, d, dd);
    for (int k = 0; k < 4; ++k) f[k] -= h * h / real(6) * dd[k];
}

LIMN_FN void bicubic_basis(real u, real v, LIMN_OUT_ARRAY(Jet, basis, 20)) {
    real a[4], da[4], dda[4], b[4], db[4], ddb[4];
    cubic_basis(u, a, da, dda);
    cubic_basis(v, b, db, ddb);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            basis[4 * j + i] =
                make_jet(a[i] * b[j], da[i] * b[j], a[i] * db[j], dda[i] * b[j], da[i] * db[j], a[i] * ddb[j]);
}

// Quartic box spline (Stam 1998) over 12 lattice points, in rows of 3, 4, 3, 2 at v = -1, 0, 1, 2, each from the
// smallest u on; the triangle's corners are points 4, 5 and 8.
LIMN_FN void box_spline_basis(real u, real v, LIMN_OUT_ARRAY(Jet, basis, 20)) {
    // Around corner k: itself, the point across the edge to the next corner, and the two that lie beyond.
    const int own[3] = {4, 5, 8}, across[3] = {1, 9, 7}, beyond_next[3] = {0, 6, 10}, beyond_previous[3] = {3, 2, 11};
    const real zero = real(0), one = real(1), twelfth = one / real(12);
    Jet x[3];
    x[0] = make_jet(one - u - v, -one, -one, zero, zero, zero);
    x[1] = make_jet(u, one, zero, zero, zero, zero);
    x[2] = make_jet(v, zero, one, zero, zero, zero);
    for (int k = 0; k < 3; ++k) {
        const Jet a = x[k], b = x[(k + 1) % 3], c = x[(k + 2) % 3];
        const Jet aa = jet_mul(a, a), bb = jet_mul(b, b), cc = jet_mul(c, c), bc = jet_mul(b, c);
        const Jet aaa = jet_mul(aa, a), bbb = jet_mul(bb, b), ccc = jet_mul(cc, c);
        const Jet aaaa = jet_mul(aa, aa), bbbb = jet_mul(bb, bb), cccc = jet_mul(cc, cc);
        // 6 a^4 + 24 a^3 (b + c) + a^2 (24 (b^2 + c^2) + 60 bc) + a (8 (b^3 + c^3) + 36 bc (b + c))
        //   + b^4 + c^4 + 6 bc (b^2 + c^2) + 12 b^2 c^2
        const Jet sum = jet_add(b, c), squares = jet_add(bb, cc);
        Jet at = jet_add(jet_scale(real(6), aaaa), jet_scale(real(24), jet_mul(aaa, sum)));
        at = jet_add(at, jet_mul(aa, jet_add(jet_scale(real(24), squares), jet_scale(real(60), bc))));
        at = jet_add(at, jet_mul(a, jet_add(jet_scale(real(8), jet_add(bbb, ccc)),
                                            jet_scale(real(36), jet_mul(bc, sum)))));
        at = jet_add(at, jet_add(jet_add(bbbb, cccc), jet_scale(real(6), jet_mul(bc, squares))));
        at = jet_add(at, jet_scale(real(12), jet_mul(bc, bc)));
        basis[own[k]] = jet_scale(twelfth, at);
        // a^4 + b^4 + 2 c (a^3 + b^3) + 6 ab (a^2 + b^2) + 6 abc (a + b) + 12 a^2 b^2
        const Jet ab = jet_mul(a, b);
        at = jet_add(jet_add(aaaa, bbbb), jet_scale(real(2), jet_mul(c, jet_add(aaa, bbb))));
        at = jet_add(at, jet_scale(real(6), jet_mul(ab, jet_add(aa, bb))));
        at = jet_add(at, jet_scale(real(6), jet_mul(jet_mul(ab, c), jet_add(a, b))));
        at = jet_add(at, jet_scale(real(12), jet_mul(ab, ab)));
        basis[across[k]] = jet_scale(twelfth, at);
        // a^4 + 2 a^3 b, a^4 + 2 a^3 c
        basis[beyond_next[k]] = jet_scale(twelfth, jet_add(aaaa, jet_scale(real(2), jet_mul(aaa, b))));
        basis[beyond_previous[k]] = jet_scale(twelfth, jet_add(aaaa, jet_scale(real(2), jet_mul(aaa, c))));
    }
}

// Corners in order, four or three.
LIMN_FN void linear_basis(real u, real v, bool triangle, LIMN_OUT_ARRAY(Jet, basis, 20)) {
    const real zero = real(0), one = real(1);
    if (triangle) {
        basis[0] = make_jet(one - u - v, -one, -one, zero, zero, zero);
        basis[1] = make_jet(u, one, zero, zero, zero, zero);
        basis[2] = make_jet(v, zero, one, zero, zero, zero);
    } else {
        basis[0] = make_jet((one - u) * (one - v), v - one, u - one, zero, one, zero);
        basis[1] = make_jet(u * (one - v), one - v, -u, zero, -one, zero);
        basis[2] = make_jet(u * v, v, u, zero, one, zero);
        basis[3] = make_jet((one - u) * v, -v, one - u, zero, -one, zero);
    }
}

LIMN_FN uint patch_point_count(uint kind) {
    if (kind == kNodeGregory) return 20u;
    if (kind == kNodeGregoryTriangle) return 18u;
    return kind == kNodeBicubic ? 16u : kind == kNodeBoxSpline ? 12u : kind == kNodeLinear ? 3u : 4u;
}

// The functions of a node of this kind, patch_point_count(kind) of them; the others are zero. Of `triangles` or quads:
// kernels have that, and `end_cap`, as a constant, and leave out what cannot be.
LIMN_FN void patch_basis(uint kind, bool triangles, uint end_cap, real u, real v, LIMN_OUT_ARRAY(Jet, basis, 20)) {
    for (int k = 0; k < 20; ++k) basis[k] = make_jet(real(0), real(0), real(0), real(0), real(0), real(0));
    if (triangles) {
        if (kind == kNodeBoxSpline) {
            box_spline_basis(u, v, basis);
        } else if (end_cap != kEndCapExact && kind == kNodeGregoryTriangle) {
            Jet gregory[18];
            gregory_triangle_basis(u, v, end_cap == kEndCapGregory, gregory);
            for (int k = 0; k < 18; ++k) basis[k] = gregory[k];
        } else {
            linear_basis(u, v, true, basis);
        }
    } else if (kind == kNodeBicubic) {
        bicubic_basis(u, v, basis);
    } else if (end_cap != kEndCapExact && kind == kNodeGregory) {
        gregory_basis(u, v, end_cap == kEndCapGregory, basis);
    } else {
        linear_basis(u, v, false, basis);
    }
}

LIMN_SHARED_END
#endif
