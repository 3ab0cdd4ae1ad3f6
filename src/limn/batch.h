// A crowd: tables of many meshes, built one by one, merged into tables that one set of dispatches evaluates.
//
// Nothing is built again: merging copies what tables hold and moves the numbers in it. The results are tables
// like any other. Plans, and rows of equal weights that make points, are stored once however many meshes have
// them, so that what is made of a merged table (build_grid_table, build_patch_trees, uploads) has as many
// classes, and dispatches, as one mesh of all these faces would have.
#pragma once

#include <span>
#include <vector>

#include "limn/patch_table.h"
#include "limn/tessellation_table.h"

namespace limn {

/// The numbers [first, first + count) of a merged table, which are 0 .. count - 1 in the mesh's own.
struct BatchRange {
    uint32_t first = 0;
    uint32_t count = 0;
};

/// Where a mesh is in a merged patch table. Its level-1 points are not here: those of all meshes lie behind
/// all control points, sorted by what they weigh. They are made by the same sums of the same control points.
struct PatchBatchMesh {
    BatchRange control_points;
    BatchRange ptex_faces;
    BatchRange surfaces;
};

template <class Real>
struct BasicPatchBatch {
    BasicPatchTable<Real> table;
    std::vector<PatchBatchMesh> meshes;  ///< in the order of the tables that were merged
};
using PatchBatch = BasicPatchBatch<float>;
using PatchBatchDouble = BasicPatchBatch<double>;

/// Control points of all meshes, one after the other, then from first_refined on their level-1 points; ptex
/// faces and surfaces one mesh after the other. A table may be there more than once; without any the merged
/// table is empty. Evaluation gives what each mesh alone gives: on the CPU to the bit where tables were built
/// with one PlanCache, else plans are those of the first table that has them. Time is linear in what tables
/// hold, on all cores; the result does not depend on their number. Tables of vertex data, varying data and
/// channels can be merged, too. Errors: invalid_argument (options, end caps or the number of plan_identities
/// do not agree; the element is the table); too_large (2^32 points, ring points or entries, 2^31 surfaces or
/// ptex faces, 2^26 plans).
template <class Real>
Result<BasicPatchBatch<Real>> merge_patch_tables(std::span<const BasicPatchTable<Real>* const> tables);

/// Where a mesh is in a merged tessellation table. Its rate edges are two ranges: those of its control mesh
/// lie with those of all meshes, before all sub-face edges.
struct TessellationBatchMesh {
    BatchRange ptex_faces;
    BatchRange mesh_edges;
    BatchRange sub_face_edges;  ///< the mesh's own from mesh_edges.count on
    BatchRange rows;
    BatchRange corners;
};

struct TessellationBatch {
    TessellationTable table;
    std::vector<TessellationBatchMesh> meshes;  ///< in the order of the tables that were merged
};

/// In the same order as merge_patch_tables: ptex faces have the same numbers. Triangles of a tessellation
/// come mesh after mesh; vertices do not: corners of all meshes are followed by the rows of all, and these by
/// what lies within faces. Errors: invalid_argument (options that do not agree, as above); too_large (2^28
/// ptex faces or more, 2^30 rows, 2^32 corners or edges). Each table is an instance of the merged one
/// (TessellationTable::instance_faces); of one that was merged before, each of its instances is.
Result<TessellationBatch> merge_tessellation_tables(std::span<const TessellationTable* const> tables);

}  // namespace limn
