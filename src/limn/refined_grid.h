// Uniform refinement without a row for each point: refined points are told face by face of the control mesh, and faces
// with equal neighbourhoods share one dense matrix from the ring of control points around them. Quads whose
// neighbourhood is regular need none: their points are those of a uniform bicubic spline.
#pragma once

#include "limn/grid_table.h"
#include "limn/refinement.h"

namespace limn {

/// Points of one level of uniform refinement, numbered as Refinement does. As a "grid": its only face has all of them,
/// sample s is vertex s of the level, and surfaces are faces of the control mesh, whose samples are numbered by slots. Ring
/// point j of a surface is ring_points[surface.first_ring + j], a control point.
struct RefinedGridTable {
    uint32_t level = 0;
    uint32_t source_count = 0;  ///< control points
    Array<uint32_t> ring_points;
    GridTable grid;

    uint32_t point_count() const { return static_cast<uint32_t>(grid.total_sample_count); }
    uint64_t bytes() const { return ring_points.bytes() + grid.bytes(); }
};

struct RefinedGridOptions {
    uint32_t level = 4;  ///< 1 .. 7
    Interpolation interpolation = Interpolation::vertex;
    uint64_t max_weight_bytes = uint64_t{256} << 20;  ///< as GridOptions
    BuildPart control = {};                           ///< as RefinementOptions::control
};

/// From level 0 of a refinement (build_refinement, or of a face-varying channel), which is all that is read: levels are
/// never refined as a whole. On all cores; the result does not depend on their number.
/// Errors: invalid_argument (level), too_large (more than 2^31 - 1 corners, 2^32 samples or ring points, or
/// max_weight_bytes: build a stencil table instead), unsupported (as build_stencil_table), cancelled.
Result<RefinedGridTable> build_refined_grid_table(const Refinement& refinement, const RefinedGridOptions& options);

}  // namespace limn
