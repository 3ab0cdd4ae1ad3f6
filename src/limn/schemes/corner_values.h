// Numbers for each corner of a mesh that some schemes take (Stage::intervals): knot intervals and angles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limn/control_mesh.h"
#include "limn/result.h"

namespace limn {

/// Knot intervals of nurss and nurss-quadratic from those of edges: values[i] is the interval of the edge of vertices
/// edges[2 * i] and edges[2 * i + 1] as seen from the first and, unless another entry says otherwise, from the second,
/// too (to nurss that is all the same: give one). Of entries for the same edge and end the last one counts. Edges
/// without an entry have 1. Returns one for each corner, of the edge that begins there, as seen from there. Errors:
/// invalid_argument (lengths that do not agree, a value that is negative, infinite or NaN), missing_edge (vertices that
/// no edge joins). Error::element is the entry.
Result<std::vector<double>> corner_intervals(const ControlMesh& mesh, std::span<const uint32_t> edges,
                                             std::span<const float> values);

/// Angles of catmark-blz and loop-blz: the angle in radians, 0 to pi, between both edges of a face at each of its
/// corners; 0 where one has no length. `positions`: 3 per vertex. Errors: invalid_argument (too few positions).
Result<std::vector<double>> corner_angles(const ControlMesh& mesh, std::span<const float> positions);

}  // namespace limn
