// OpenSubdiv's patches as its evaluators evaluate them: a patch type, the two words of a PatchParam, and
// coordinates of the ptex face give the weight of each control vertex, for the value and its derivatives.
#ifndef LIMN_SHARED_OSD_PATCH_H
#define LIMN_SHARED_OSD_PATCH_H
#include "limn/shared/patch_basis.h"
LIMN_SHARED_BEGIN

// Patch types, as Far::PatchDescriptor numbers them. Others evaluate to zero.
const uint kOsdQuads = 3;
const uint kOsdTriangles = 4;
const uint kOsdLoop = 5;
const uint kOsdRegular = 6;
const uint kOsdGregoryBasis = 9;
const uint kOsdGregoryTriangle = 10;

LIMN_FN bool osd_is_type(uint types, uint type, uint wanted) {
    return (types >> wanted & 1u) != 0u && type == wanted;
}

// The second word of a PatchParam; the first has the ptex face and transitions, which do not matter here.
LIMN_FN uint osd_param_depth(uint word) {
    return word & 15u;
}
LIMN_FN uint osd_param_non_quad(uint word) {
    return word >> 4 & 1u;
}
LIMN_FN bool osd_param_regular(uint word) {
    return (word >> 5 & 1u) != 0u;
}
LIMN_FN uint osd_param_boundary(uint word) {
    return word >> 7 & 31u;
}
LIMN_FN uint osd_param_v(uint word) {
    return word >> 12 & 1023u;
}
LIMN_FN uint osd_param_u(uint word) {
    return word >> 22;
}

// Cubic functions across a patch, whose points beyond a boundary are p = 2 q - r, with q on the boundary and
// r within.
LIMN_FN void osd_fold_cubic(bool low, bool high, LIMN_INOUT_ARRAY(real, f, 4)) {
    if (low) {
        f[1] += real(2) * f[0];
        f[2] -= f[0];
        f[0] = real(0);
    }
    if (high) {
        f[2] += real(2) * f[3];
        f[1] -= f[3];
        f[3] = real(0);
    }
}

// Function i at t, for a patch that ends at a boundary where t is 0 (low) or 1 (high): values, first and
// second derivatives.
LIMN_FN void osd_cubic_basis(real t, bool low, bool high, LIMN_OUT_ARRAY(real, f, 4),
                             LIMN_OUT_ARRAY(real, d, 4), LIMN_OUT_ARRAY(real, dd, 4)) {
    cubic_basis(t, f, d, dd);
    osd_fold_cubic(low, high, f);
    osd_fold_cubic(low, high, d);
    osd_fold_cubic(low, high, dd);
}

// The functions of a bicubic patch, point 4 j + i from u[i] and v[j]. Boundary bits are edges, from the one
// where v is 0 on.
struct OsdBicubic {
    real u[4], du[4], duu[4], v[4], dv[4], dvv[4];
};
LIMN_FN OsdBicubic osd_bicubic(uint boundary, real u, real v) {
    OsdBicubic b;
    osd_cubic_basis(u, (boundary & 8u) != 0u, (boundary & 2u) != 0u, b.u, b.du, b.duu);
    osd_cubic_basis(v, (boundary & 1u) != 0u, (boundary & 4u) != 0u, b.v, b.dv, b.dvv);
    return b;
}
LIMN_FN Jet osd_bicubic_jet(OsdBicubic b, int i, int j) {
    return make_jet(b.u[i] * b.v[j], b.du[i] * b.v[j], b.u[i] * b.dv[j], b.duu[i] * b.v[j], b.du[i] * b.dv[j],
                    b.u[i] * b.dvv[j]);
}

LIMN_FN void osd_fold(LIMN_INOUT_ARRAY(Jet, basis, 20), int from, int to, real factor) {
    basis[to] = jet_add(basis[to], jet_scale(factor, basis[from]));
}

// A point beyond a boundary is q + r - s of the triangles next to it, folded into these.
LIMN_FN void osd_fold_point(LIMN_INOUT_ARRAY(Jet, basis, 20), int p, int q, int r, int s) {
    osd_fold(basis, p, q, real(1));
    osd_fold(basis, p, r, real(1));
    osd_fold(basis, p, s, real(-1));
    basis[p] = jet_scale(real(0), basis[p]);
}
// One whose r and s are others where two boundaries meet (`meet`). By factors, not by choosing the index: an index that is
// not known when a kernel is compiled takes a ladder over all 20 functions, and lavapipe minutes to compile them.
LIMN_FN void osd_fold_end(LIMN_INOUT_ARRAY(Jet, basis, 20), bool meet, int p, int q, int r, int s, int meeting_r,
                          int meeting_s) {
    const real two = real(meet ? 1 : 0), one = real(1) - two;
    osd_fold(basis, p, q, real(1));
    osd_fold(basis, p, r, one);
    osd_fold(basis, p, meeting_r, two);
    osd_fold(basis, p, s, -one);
    osd_fold(basis, p, meeting_s, -two);
    basis[p] = jet_scale(real(0), basis[p]);
}

// The lower three bits of the mask are edges (the upper two bits are 0), vertices (1), or edges each with the
// vertex opposite to it (2).
LIMN_FN void osd_fold_box_spline(uint boundary, LIMN_INOUT_ARRAY(Jet, basis, 20)) {
    // As in box_spline_basis.
    const int own[3] = {4, 5, 8}, across[3] = {1, 9, 7}, beyond_next[3] = {0, 6, 10},
              beyond_previous[3] = {3, 2, 11};
    const uint bits = boundary & 7u, kind = boundary >> 3;
    const uint edges = kind == 1u ? 0u : bits;
    const uint vertices = kind == 1u ? bits : kind == 2u ? (bits & 1u) << 2 | bits >> 1 : 0u;
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3, last = (k + 2) % 3;
        const int a = own[k], b = own[next], c = own[last];
        if ((edges >> k & 1u) != 0u) {
            osd_fold_end(basis, (edges >> last & 1u) != 0u, beyond_next[k], a, beyond_previous[k], across[last], a, c);
            osd_fold_point(basis, across[k], a, b, c);
            osd_fold_end(basis, (edges >> next & 1u) != 0u, beyond_previous[next], b, beyond_next[next], across[next], b, c);
        }
        if ((vertices >> k & 1u) != 0u) {
            osd_fold_point(basis, beyond_next[k], a, across[k], b);
            osd_fold_point(basis, beyond_previous[k], a, across[last], c);
        }
    }
}

// At a corner itself OpenSubdiv gives all of the blend to one of f+ and f- (quads: f-, triangles: f+), where
// Gregory's functions have halves.
LIMN_FN void osd_gregory_corner(int k, real u, real v, LIMN_OUT_ARRAY(Jet, basis, 5)) {
    gregory_corner(k, u, v, false, basis);
    const real distance = (k == 1 || k == 2 ? real(1) - u : u) + (k >= 2 ? real(1) - v : v);
    if (distance > real(0)) return;
    basis[3] = jet_scale(real(0), basis[3]);
    basis[4] = jet_scale(real(2), basis[4]);
}
LIMN_FN void osd_gregory_triangle_corner(int k, real u, real v, LIMN_OUT_ARRAY(Jet, basis, 6)) {
    gregory_triangle_corner(k, u, v, false, basis);
    if ((k == 0 ? u + v : k == 1 ? real(1) - u : real(1) - v) > real(0)) return;
    basis[3] = jet_scale(real(2), basis[3]);
    basis[4] = jet_scale(real(0), basis[4]);
}

LIMN_FN void osd_box_spline_basis(uint boundary, real u, real v, LIMN_OUT_ARRAY(Jet, basis, 20)) {
    box_spline_basis(u, v, basis);
    osd_fold_box_spline(boundary, basis);
}

LIMN_FN bool osd_is_triangle(uint type) {
    return type == kOsdTriangles || type == kOsdLoop || type == kOsdGregoryTriangle;
}

// Where (s, t) of the ptex face is in a patch, and what derivatives there are multiplied by to be those of
// the face, by OpenSubdiv's rule: 2^depth and 4^depth, also where the root is no quad; turned triangles have
// all of them negated, second ones, too.
struct OsdPlace {
    real u, v;
    real first, second;
};
LIMN_FN OsdPlace osd_place(bool triangle, uint param, real s, real t) {
    const uint depth = osd_param_depth(param);
    const bool turned = triangle && osd_param_u(param) + osd_param_v(param) >= 1u << depth;
    const real cells = real(1u << (depth - osd_param_non_quad(param)));
    const real u0 = real(osd_param_u(param)), v0 = real(osd_param_v(param)), sign = real(turned ? -1 : 1);
    OsdPlace place;
    place.u = turned ? cells - u0 - s * cells : s * cells - u0;
    place.v = turned ? cells - v0 - t * cells : t * cells - v0;
    place.first = sign * real(1u << depth);
    place.second = sign * place.first * place.first;
    return place;
}

LIMN_SHARED_END
#endif
