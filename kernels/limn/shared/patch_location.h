// Where a sample is while evaluation descends: coordinates within the node reached, and how they depend on those of
// the ptex face.
#ifndef LIMN_SHARED_PATCH_LOCATION_H
#define LIMN_SHARED_PATCH_LOCATION_H
#include "limn/shared/jet.h"
LIMN_SHARED_BEGIN

struct PatchLocation {
    real u, v;
    real uu, uv, vu, vv;  // d(node's u)/d(face's u), d(u)/d(v), d(v)/d(u), d(v)/d(v)
};

LIMN_FN PatchLocation make_location(real u, real v) {
    PatchLocation at;
    at.u = u;
    at.v = v;
    at.uu = real(1);
    at.uv = real(0);
    at.vu = real(0);
    at.vv = real(1);
    return at;
}

// u <- u0 + a u + b v, v <- v0 + c u + d v.
LIMN_FN void move_location(LIMN_INOUT(PatchLocation) at, real u0, real a, real b, real v0, real c, real d) {
    const PatchLocation o = at;
    at.u = u0 + a * o.u + b * o.v;
    at.v = v0 + c * o.u + d * o.v;
    at.uu = a * o.uu + b * o.vu;
    at.uv = a * o.uv + b * o.vv;
    at.vu = c * o.uu + d * o.vu;
    at.vv = c * o.uv + d * o.vv;
}

// Moves into one of four children, numbered as PlanNodeKind::split says: which. What lies between two belongs to the
// one nearer to the origin.
LIMN_FN uint descend_location(LIMN_INOUT(PatchLocation) at, bool triangles) {
    const real middle = real(0.5), zero = real(0), one = real(1), two = real(2);
    if (triangles) {
        if (at.u > middle) {
            move_location(at, -one, two, zero, zero, zero, two);
            return 1u;
        }
        if (at.v > middle) {
            move_location(at, zero, two, zero, -one, zero, two);
            return 2u;
        }
        if (at.u + at.v > middle) {
            move_location(at, one, -two, zero, one, zero, -two);
            return 3u;
        }
        move_location(at, zero, two, zero, zero, zero, two);
        return 0u;
    }
    const bool right = at.u > middle, upper = at.v > middle;
    move_location(at, right ? -one : zero, two, zero, upper ? -one : zero, zero, two);
    return upper ? (right ? 2u : 3u) : (right ? 1u : 0u);
}

// The half of a split_u or split_v node.
LIMN_FN uint descend_location_half(LIMN_INOUT(PatchLocation) at, bool along_u) {
    const real middle = real(0.5), zero = real(0), one = real(1), two = real(2);
    const bool upper = (along_u ? at.u : at.v) > middle;
    const real offset = upper ? -one : zero;
    move_location(at, along_u ? offset : zero, along_u ? two : one, zero, along_u ? zero : offset, zero,
                  along_u ? one : two);
    return upper ? 1u : 0u;
}

// Makes corner `rotation` the origin.
LIMN_FN void rotate_location(LIMN_INOUT(PatchLocation) at, uint rotation, bool triangles) {
    const real zero = real(0), one = real(1);
    for (uint i = 0u; i < rotation; ++i) move_location(at, zero, zero, one, one, -one, triangles ? -one : zero);
}

// Derivatives by the node's coordinates -> by those of the ptex face.
LIMN_FN Jet jet_of_face(Jet j, PatchLocation at) {
    return make_jet(j.f, j.u * at.uu + j.v * at.vu, j.u * at.uv + j.v * at.vv,
                    j.uu * at.uu * at.uu + real(2) * j.uv * at.uu * at.vu + j.vv * at.vu * at.vu,
                    j.uu * at.uu * at.uv + j.uv * (at.uu * at.vv + at.uv * at.vu) + j.vv * at.vu * at.vv,
                    j.uu * at.uv * at.uv + real(2) * j.uv * at.uv * at.vv + j.vv * at.vv * at.vv);
}

LIMN_SHARED_END
#endif
