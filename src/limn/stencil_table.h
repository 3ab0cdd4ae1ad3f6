// Stencil tables: every refined or limit point as a weighted sum of other points.
#pragma once

#include <cstdint>

#include "limn/array.h"
#include "limn/refinement.h"
#include "limn/result.h"

namespace limn {

/// Which rules make the weights.
enum class Interpolation : uint8_t {
    vertex,   ///< the scheme's own rules: positions, and channels of face-varying data on their own topology
    varying,  ///< linear within each face
};

/// Compressed sparse rows. Row r is sum over k in [offsets[r], offsets[r + 1]) of weights[k] *
/// source[indices[k]]. Indices within a row are unique. Rows around alike vertices list their entries in the
/// same order, so that equal rows have equal weights, entry by entry. The weights of a row sum to one (of a
/// tangent row to zero). Real is float (what devices take) or double (what weights are computed in).
template <class Real>
struct BasicStencilTable {
    uint32_t source_count = 0;     ///< points that rows refer to
    Array<uint32_t> offsets;       ///< row_count() + 1 entries
    Array<uint32_t> indices;       ///< offsets.back() entries, each < source_count
    Array<Real> weights;           ///< offsets.back() entries
    Array<Real> tangent1_weights;  ///< limit tables with tangents: offsets.back() entries, else empty
    Array<Real> tangent2_weights;

    uint32_t row_count() const { return offsets.empty() ? 0 : static_cast<uint32_t>(offsets.size() - 1); }
    uint64_t bytes() const {
        return offsets.bytes() + indices.bytes() + weights.bytes() + tangent1_weights.bytes() +
               tangent2_weights.bytes();
    }
};
using StencilTable = BasicStencilTable<float>;
using StencilTableDouble = BasicStencilTable<double>;

/// One step: the points of `level` (1 .. refinement.level_count()) from those of `level - 1`, which must have
/// its edges (the last level has them when built with full_last_level). Row r is vertex r of the level;
/// source_count is the vertex count of level - 1. `control`, here and below, is a BuildControl*, to cancel the
/// build and to see its progress; may be null. Errors: invalid_argument (level), too_large, cancelled.
template <class Real>
Result<BasicStencilTable<Real>> build_step_table(const Refinement& refinement, uint32_t level,
                                                 Interpolation interpolation = Interpolation::vertex,
                                                 const BuildPart& control = {});

/// The points of `level` (0 .. kMaxRefinementLevel) from the control points, straight from the base level:
/// `refinement` need not go that deep. Row r is vertex r of the level; source_count is
/// refinement.control_count. Weights are computed in double. Built on all cores; the result does not depend
/// on their number. Beside the table and the base level, about a tenth of the table is held while it is
/// built. Errors: invalid_argument (level); too_large when a level would hold more than 2^31 - 1 face corners
/// or the table 2^32 entries or more; unsupported when more than 16,384 faces meet around one face (rows grow
/// with the square of that: chain step tables there); cancelled.
template <class Real>
Result<BasicStencilTable<Real>> build_stencil_table(const Refinement& refinement, uint32_t level,
                                                    Interpolation interpolation = Interpolation::vertex,
                                                    const BuildPart& control = {});

/// The limit positions of the vertices of `level` and, when asked for, two tangents each, from the control
/// points; else as build_stencil_table. Exact at every level: where semi-sharp features reach deeper, so does
/// the computation (not so with opensubdiv_compatible, whose limits are right at levels >= ceil(the largest
/// finite sharpness) only). tangent1 x tangent2 points along the normal (faces are counter-clockwise seen
/// from outside); their lengths carry no meaning. At a crease the tangents are those of one side, tangent1
/// along the crease; at a corner they are the ends of the first sector between sharp edges.
template <class Real>
Result<BasicStencilTable<Real>> build_limit_table(const Refinement& refinement, uint32_t level,
                                                  bool tangents = false, const BuildPart& control = {});

/// The limit positions and tangents of the vertices of the last level from the points of that level: the last
/// link of a chain of step tables, far smaller than one table over the control points. Row r is vertex r. The
/// same values as build_limit_table's where the level is at least count_sharp_levels(base); before that the
/// rules of the level hold. Errors: unsupported when the last level was not built with full_last_level or has
/// faces of other sizes than the scheme's own (refine at least once); too_large; cancelled.
template <class Real>
Result<BasicStencilTable<Real>> build_limit_step_table(const Refinement& refinement, bool tangents = false,
                                                       const BuildPart& control = {});

/// The base face that each face of the level descends from: face_count entries. What face-uniform data needs.
Array<uint32_t> build_base_faces(const Refinement& refinement, uint32_t level);

/// Applies a table on the CPU in the precision of its weights, sums in row order: destination[r * width + i].
/// `source` holds source_count * width values, `destination` row_count() * width.
template <class Real>
void apply_stencil_table(const BasicStencilTable<Real>& table, std::span<const Real> source,
                         std::span<Real> destination, uint32_t width);

}  // namespace limn
