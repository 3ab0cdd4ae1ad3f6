// T-NURCCs, Sederberg, Zheng, Bakenov and Nasri 2003: control meshes with T-junctions, turned into ones without, which
// scheme nurss refines. Editing of T-meshes and their local refinement are left out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limn/control_mesh.h"
#include "limn/result.h"
#include "limn/stencil_table.h"

namespace limn {

/// A mesh of quads that has the surface of a T-mesh.
struct ConvertedTMesh {
    ControlMesh mesh;               ///< first the vertices of the T-mesh, then new ones
    std::vector<double> intervals;  ///< for nurss: one for each corner
    /// Its points over those of the T-mesh, with weights: where `rational`, rows do not sum to one. Then apply them to
    /// points (x, y, z, 1), refine all four, and divide by the fourth; else three are enough.
    StencilTableDouble points;
    bool rational = false;
};

/// Faces are rectangles of their knot space: exactly four corners of each are its own, at all others `straight` (one
/// for each corner) is not 0, and a side goes on: a T-junction. `intervals`: the knot interval of the edge that begins
/// at a corner, positive; those of both faces of an edge are one (their mean counts), and opposite sides of a face are
/// equally long. A T-junction's edge is carried on through the faces until it meets a vertex or a boundary.
///
/// Exact where the mesh is regular: a control point that such an edge comes near must have no irregular vertex and no
/// boundary within the support of its blending function. A point is left as it is where all of the mesh within two
/// rings of it is: around irregular vertices and along boundaries. Errors: invalid_argument (lengths of arrays; an
/// interval that is not positive; a face that is no rectangle: Error::element is the corner or face), unsupported (no
/// oriented manifold; an edge carried on too near to an irregular vertex or a boundary: Error::element is the vertex),
/// too_large (edges carried on that never meet), those of ControlMesh::create.
Result<ConvertedTMesh> convert_t_mesh(const ControlMesh& mesh, std::span<const uint8_t> straight,
                                      std::span<const double> intervals);

}  // namespace limn
