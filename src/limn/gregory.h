// The Gregory patch that stands in for the surface over an irregular face. Not part of the public interface.
#pragma once

#include <array>
#include <cstdint>

#include "limn/stencil_row.h"
#include "limn/topology.h"

namespace limn {

/// Points as weighted sums of vertices, in the order that shared/gregory_basis.h tells: five a corner, P, e+,
/// e-, f+, f-; triangles then have the midpoints of their sides.
struct GregoryPoints {
    uint32_t count = 0;  ///< 20, Loop 18
    std::array<Row, 20> points;
};

/// The points of OpenSubdiv 3.5's default end cap. Boundaries and infinitely sharp edges bound the part of
/// the surface that a corner sees; an infinitely sharp dart counts as smooth, and so does what is left of
/// finite sharpness. False, and `out` is undefined, where the scheme is bilinear, or a face at one of the
/// corners has not the scheme's own size (quad; Loop: triangle), or a corner is a face-varying value that
/// follows another.
bool find_gregory_points(const Topology& t, uint32_t face, GregoryPoints& out);

}  // namespace limn
