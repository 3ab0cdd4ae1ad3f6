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

/// The points of OpenSubdiv 3.5's default end cap, whatever the scheme's options. Boundaries and infinitely
/// sharp edges bound the part of the surface that a corner sees; a vertex where just one such edge ends
/// counts as smooth unless finite sharpness is left there, too; else finite sharpness is ignored, so refine
/// until none is left. False, and `out` is undefined, where the scheme is bilinear, where a face at one of
/// the corners has not the scheme's own size (quad; Loop: triangle), and where a corner is a face-varying
/// value that follows another. `t` has full topology. Rows list an index once and may hold zero weights.
bool find_gregory_points(const Topology& t, uint32_t face, GregoryPoints& out);

}  // namespace limn
