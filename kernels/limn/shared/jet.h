// A function of (u, v) at a point: its value, first and second derivatives.
#ifndef LIMN_SHARED_JET_H
#define LIMN_SHARED_JET_H
#include "limn/shared/interop.h"
LIMN_SHARED_BEGIN

struct Jet {
    real f, u, v, uu, uv, vv;
};

LIMN_FN Jet make_jet(real f, real u, real v, real uu, real uv, real vv) {
    Jet j;
    j.f = f;
    j.u = u;
    j.v = v;
    j.uu = uu;
    j.uv = uv;
    j.vv = vv;
    return j;
}
LIMN_FN Jet jet_add(Jet a, Jet b) {
    return make_jet(a.f + b.f, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv);
}
LIMN_FN Jet jet_scale(real s, Jet a) {
    return make_jet(s * a.f, s * a.u, s * a.v, s * a.uu, s * a.uv, s * a.vv);
}
LIMN_FN Jet jet_mul(Jet a, Jet b) {
    const real two = real(2);
    return make_jet(a.f * b.f, a.u * b.f + a.f * b.u, a.v * b.f + a.f * b.v,
                    a.uu * b.f + two * a.u * b.u + a.f * b.uu, a.uv * b.f + a.u * b.v + a.v * b.u + a.f * b.uv,
                    a.vv * b.f + two * a.v * b.v + a.f * b.vv);
}
// a / b
LIMN_FN Jet jet_div(Jet a, Jet b) {
    const real two = real(2), f = a.f / b.f;
    const real u = (a.u - f * b.u) / b.f, v = (a.v - f * b.v) / b.f;
    return make_jet(f, u, v, (a.uu - two * u * b.u - f * b.uu) / b.f, (a.uv - u * b.v - v * b.u - f * b.uv) / b.f,
                    (a.vv - two * v * b.v - f * b.vv) / b.f);
}

LIMN_SHARED_END
#endif
