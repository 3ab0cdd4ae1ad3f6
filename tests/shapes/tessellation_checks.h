// What every tessellation must be, whoever made it.
#pragma once

#include <random>
#include <string>

#include "limn/tessellate.h"
#include "shapes/shapes.h"

namespace limn::test {

// A rate of 1 (fractional: 2) to `most` for each rate edge; 3 or more where two of the mesh's edges have the same
// vertices, or one edge both its ends at one, so that segments can still be told apart.
std::vector<uint32_t> random_rates(const ControlMesh& mesh, const TessellationTable& table,
                                   TessellationSpacing spacing, uint32_t most, std::mt19937& random);

// Empty, or what is wrong: with copies counted as what they copy, an edge must be used by one triangle for each
// face that the control mesh has there, in that face's direction, and all other edges by two triangles of
// opposite direction. Also: indices in range, counts by the closed form, triangles neither degenerate nor
// inverted where their face lies flat, every vertex used, and the Euler characteristic of the control mesh.
std::string find_tessellation_fault(const ControlMesh& mesh, const TessellationTable& table,
                                    std::span<const uint32_t> rates, TessellationSpacing spacing,
                                    const Tessellation& tessellation);

// The largest difference between a channel's value at a triangle's corner and that of the triangle's own face
// there, for corners of faces.
double largest_channel_fault(const PatchTable& channel, const TessellationTable& table,
                             std::span<const uint32_t> rates, const Tessellation& tessellation,
                             std::span<const double> points, std::span<const double> values);

}  // namespace limn::test
