// What a tessellation's topology is made of, whatever its rates: edges that have rates, rows of vertices along
// them, corners, faces between them. Faces share what lies between them, so that no arithmetic can open a crack.
#pragma once

#include <span>

#include "limn/control_mesh.h"
#include "limn/patch_table.h"
#include "limn/shared/tess_layout.h"
#include "limn/topology.h"

namespace limn {

/// Faces are ptex faces: quads or, of Loop, triangles. Every edge of the control mesh has one rate, its
/// segments from end to end; beside a face that is split into quads at its middle both halves have half of it,
/// and edges from its sides to its middle have rates of their own.
///
/// Rows are the vertices within an edge, or within half of one. Faces on both sides of an edge share its row,
/// but for edges where the surface has a crease or a channel a seam: there each side has a row of its own, a
/// copy with the positions of the first. Corners are alike. Vertices of a tessellation are the corners, then
/// row after row, then what lies within faces, face after face.
struct TessellationTable {
    SchemeOptions options;
    uint32_t face_count = 0;       ///< ptex faces, holes among them
    uint32_t rate_edge_count = 0;  ///< edges of the control mesh, as Topology numbers them, then sub-face edges
    uint32_t mesh_edge_count = 0;  ///< the former
    uint32_t row_count = 0;
    uint32_t corner_count = 0;
    // limn/shared/tess_layout.h says how these are packed.
    Array<uint32_t> faces;        ///< kTessFaceWords each
    Array<uint32_t> rows;         ///< kTessRowWords each
    Array<uint32_t> corners;      ///< kTessCornerWords each
    Array<uint32_t> rate_edges;   ///< kRateEdgeWords each
    Array<uint32_t> corner_copies;  ///< pairs: a corner, and the one whose position it has; ascending
    Array<uint32_t> row_copies;     ///< pairs of rows, likewise
    /// Of a merged table (batch.h): the first ptex face of each instance, and the end of the last. Else empty: one.
    Array<uint32_t> instance_faces;
    /// Of a crowd (crowd.h): which instance each of those is, since faces and instances keep their numbers. Else empty: in order.
    Array<uint32_t> instance_numbers;

    uint32_t instance_count() const {
        return instance_faces.empty() ? 1 : static_cast<uint32_t>(instance_faces.size() - 1);
    }

    uint32_t corner_copy_count() const { return static_cast<uint32_t>(corner_copies.size() / 2); }
    uint32_t row_copy_count() const { return static_cast<uint32_t>(row_copies.size() / 2); }
    uint64_t bytes() const {
        return faces.bytes() + rows.bytes() + corners.bytes() + rate_edges.bytes() + corner_copies.bytes() +
               row_copies.bytes() + instance_faces.bytes() + instance_numbers.bytes();
    }
};

struct TessellationTableOptions {
    /// A vertex on an infinitely sharp crease, or at a corner, for each face or fan of faces with a normal of its
    /// own there. Otherwise its normal is that of one of them.
    bool split_creases = true;
    /// Face-varying channels whose seams split vertices.
    std::span<const uint32_t> channels = {};
    BuildPart control = {};  ///< as RefinementOptions::control
};

/// Errors: index_out_of_range (a channel), too_large (2^28 ptex faces or more), cancelled.
Result<TessellationTable> build_tessellation_table(const ControlMesh& mesh,
                                                   const TessellationTableOptions& options);
/// The same where build_topology(mesh) is at hand.
Result<TessellationTable> build_tessellation_table(const ControlMesh& mesh, const Topology& base,
                                                   const TessellationTableOptions& options);

/// Instances as kernels read them: their count, the first face of each and the end of the last, and the number of each.
Array<uint32_t> list_instances(const TessellationTable& table);

}  // namespace limn
