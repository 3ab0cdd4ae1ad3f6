// Refinement by any scheme: tables of rows, level after level, and the faces of the last level.
#pragma once

#include <vector>

#include "limn/control_mesh.h"
#include "limn/result.h"
#include "limn/schemes/subdivision_scheme.h"
#include "limn/stencil_table.h"

namespace limn {

struct SchemeRefinementOptions {
    uint32_t level = 1;            ///< steps of the scheme
    bool full_last_level = false;  ///< edges and stars of the last level, too
    BuildPart control = {};        ///< a BuildControl*, to cancel the build and to see its progress; may be null
};

template <class Real>
struct BasicSchemeRefinement {
    const SubdivisionScheme* scheme = nullptr;
    uint32_t control_count = 0;
    Array<uint32_t> control_edges;  ///< two control points for each edge of the control mesh
    /// One for each pass of each step, scheme->passes.size() * level in all: points of the stage after it from those of
    /// the stage before. A chain of these is what a device evaluates fastest.
    std::vector<BasicStencilTable<Real>> tables;
    Stage last;  ///< the mesh of the last level: vertex_count points

    const Topology& mesh() const { return last.topology; }
};
using SchemeRefinement = BasicSchemeRefinement<float>;
using SchemeRefinementDouble = BasicSchemeRefinement<double>;

/// Whether the mesh has the faces that `scheme` takes. Errors: not_a_triangle, unsupported (faces that are no quads
/// where it takes those alone). Error::element is the face.
Result<void> check_scheme_faces(const ControlMesh& mesh, const SubdivisionScheme& scheme);

/// Refines the mesh, whose options' boundary, creasing and triangles hold where the scheme knows them; options.scheme
/// does not matter. `intervals`: knot intervals for non-uniform schemes, one for each corner (Stage::intervals), or
/// none. Weights are computed in double. Errors: those of check_scheme_faces; unsupported where the scheme knows no
/// creases and the mesh is no oriented manifold without holes (Error::element is the edge, vertex or face);
/// invalid_argument (intervals that are not one for each corner, negative or no numbers), too_large when a level would
/// hold more than 2^31 - 1 corners, cancelled.
template <class Real>
Result<BasicSchemeRefinement<Real>> build_scheme_refinement(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                                            const SchemeRefinementOptions& options,
                                                            std::span<const double> intervals = {});

/// The stage that refinement starts from. Errors: as build_scheme_refinement.
Result<Stage> build_first_stage(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                std::span<const double> intervals = {}, const BuildPart& part = {});

/// One table for a chain of them: rows of tables[1] over the points of tables[0], and so on. At least one table.
/// Errors: too_large, cancelled.
template <class Real>
Result<BasicStencilTable<Real>> multiply_tables(std::span<const BasicStencilTable<Real>> tables,
                                                const BuildPart& control = {});

}  // namespace limn
