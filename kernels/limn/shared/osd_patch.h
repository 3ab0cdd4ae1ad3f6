// OpenSubdiv's patches as its evaluators evaluate them: a patch type, the two words of a PatchParam, and coordinates of
// the ptex face give the weight of each control vertex, for the value and its derivatives.
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

LIMN_FN uint osd_point_count(uint type) {
    if (type == kOsdGregoryBasis) return 20u;
    if (type == kOsdGregoryTriangle) return 18u;
    if (type == kOsdRegular) return 16u;
    if (type == kOsdLoop) return 12u;
    return type == kOsdQuads ? 4u : type == kOsdTriangles ? 3u : 0u;
}
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

// Adds `factor` times function `from` to function `to`.
LIMN_FN void osd_fold(LIMN_INOUT_ARRAY(Jet, basis, 20), int from, int to, real factor) {
    basis[to] = jet_add(basis[to], jet_scale(factor, basis[from]));
}

// Points beyond a boundary are p = 2 q - r with q on the boundary and r within, in every row across it.
LIMN_FN void osd_fold_bicubic(uint boundary, LIMN_INOUT_ARRAY(Jet, basis, 20)) {
    for (int edge = 0; edge < 4; ++edge) {
        if ((boundary >> edge & 1u) == 0u) continue;
        const int first = edge == 1 ? 3 : edge == 2 ? 12 : 0;
        const int inwards = edge == 0 ? 4 : edge == 1 ? -1 : edge == 2 ? -4 : 1;
        const int along = edge == 0 || edge == 2 ? 1 : 4;
        for (int i = 0; i < 4; ++i) {
            const int p = first + i * along;
            osd_fold(basis, p, p + inwards, real(2));
            osd_fold(basis, p, p + 2 * inwards, real(-1));
            basis[p] = jet_scale(real(0), basis[p]);
        }
    }
}

// A point beyond a boundary is q + r - s of the triangles next to it, folded into these.
LIMN_FN void osd_fold_point(LIMN_INOUT_ARRAY(Jet, basis, 20), int p, int q, int r, int s) {
    osd_fold(basis, p, q, real(1));
    osd_fold(basis, p, r, real(1));
    osd_fold(basis, p, s, real(-1));
    basis[p] = jet_scale(real(0), basis[p]);
}

// The lower three bits of the mask are edges (the upper two bits are 0), vertices (1), or edges each with the vertex
// opposite to it (2).
LIMN_FN void osd_fold_box_spline(uint boundary, LIMN_INOUT_ARRAY(Jet, basis, 20)) {
    // As in box_spline_basis.
    const int own[3] = {4, 5, 8}, across[3] = {1, 9, 7}, beyond_next[3] = {0, 6, 10}, beyond_previous[3] = {3, 2, 11};
    const uint bits = boundary & 7u, kind = boundary >> 3;
    const uint edges = kind == 1u ? 0u : bits;
    const uint vertices = kind == 1u ? bits : kind == 2u ? (bits & 1u) << 2 | bits >> 1 : 0u;
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3, last = (k + 2) % 3;
        const int a = own[k], b = own[next], c = own[last];
        if ((edges >> k & 1u) != 0u) {
            const bool last_too = (edges >> last & 1u) != 0u, next_too = (edges >> next & 1u) != 0u;
            osd_fold_point(basis, beyond_next[k], a, last_too ? a : beyond_previous[k], last_too ? c : across[last]);
            osd_fold_point(basis, across[k], a, b, c);
            osd_fold_point(basis, beyond_previous[next], b, next_too ? b : beyond_next[next],
                           next_too ? c : across[next]);
        }
        if ((vertices >> k & 1u) != 0u) {
            osd_fold_point(basis, beyond_next[k], a, across[k], b);
            osd_fold_point(basis, beyond_previous[k], a, across[last], c);
        }
    }
}

LIMN_FN real osd_corner_distance(int k, real u, real v) {
    return (k == 1 || k == 2 ? real(1) - u : u) + (k >= 2 ? real(1) - v : v);
}

// At a corner itself OpenSubdiv gives all of the blend to one of f+ and f- (quads: f-, triangles: f+), where gregory_basis
// gives halves.
LIMN_FN void osd_settle_corner(real distance, int all, int none, LIMN_INOUT_ARRAY(Jet, basis, 20)) {
    if (distance > real(0)) return;
    basis[all] = jet_scale(real(2), basis[all]);
    basis[none] = jet_scale(real(0), basis[none]);
}

// The functions of a patch of `type` at (s, t) of its ptex face, with derivatives by OpenSubdiv's rule: times 2^depth and
// 4^depth, also where the root is no quad; turned triangles have all derivatives negated, second ones too.
// `types` has the bit 1 << type of every type that may occur: kernels have it as a constant, and leave out the others.
LIMN_FN void osd_patch_basis(uint types, uint type, uint param, real s, real t, LIMN_OUT_ARRAY(Jet, basis, 20)) {
    for (int k = 0; k < 20; ++k) basis[k] = make_jet(real(0), real(0), real(0), real(0), real(0), real(0));
    const uint depth = osd_param_depth(param);
    const bool triangle = type == kOsdTriangles || type == kOsdLoop || type == kOsdGregoryTriangle;
    const bool turned = triangle && osd_param_u(param) + osd_param_v(param) >= 1u << depth;
    const real cells = real(1u << (depth - osd_param_non_quad(param)));
    const real u0 = real(osd_param_u(param)), v0 = real(osd_param_v(param));
    const real u = turned ? cells - u0 - s * cells : s * cells - u0;
    const real v = turned ? cells - v0 - t * cells : t * cells - v0;
    if (osd_is_type(types, type, kOsdRegular)) {
        bicubic_basis(u, v, basis);
        osd_fold_bicubic(osd_param_boundary(param), basis);
    } else if (osd_is_type(types, type, kOsdLoop)) {
        box_spline_basis(u, v, basis);
        osd_fold_box_spline(osd_param_boundary(param), basis);
    } else if (osd_is_type(types, type, kOsdGregoryBasis)) {
        gregory_basis(u, v, false, basis);
        for (int k = 0; k < 4; ++k)
            osd_settle_corner(osd_corner_distance(k, u, v), 5 * k + 4, 5 * k + 3, basis);
    } else if (osd_is_type(types, type, kOsdGregoryTriangle)) {
        Jet gregory[18];
        gregory_triangle_basis(u, v, false, gregory);
        for (int k = 0; k < 18; ++k) basis[k] = gregory[k];
        for (int k = 0; k < 3; ++k)
            osd_settle_corner(k == 0 ? u + v : k == 1 ? real(1) - u : real(1) - v, 5 * k + 3, 5 * k + 4, basis);
    } else if (osd_is_type(types, type, kOsdQuads) || osd_is_type(types, type, kOsdTriangles)) {
        linear_basis(u, v, triangle, basis);
    }
    const real sign = real(turned ? -1 : 1), d = sign * real(1u << depth), dd = sign * d * d;
    for (int k = 0; k < 20; ++k) {
        const Jet j = basis[k];
        basis[k] = make_jet(j.f, d * j.u, d * j.v, dd * j.uu, dd * j.uv, dd * j.vv);
    }
}

LIMN_SHARED_END
#endif
