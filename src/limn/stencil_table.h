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
/// source[indices[k]]. Indices within a row are unique and ascending; the weights of a row sum to one (of a
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

/// One step: the points of `level` (1 .. refinement.level_count() - 1) from those of `level - 1`. Row r is
/// vertex r of the level; source_count is the vertex count of level - 1.
template <class Real>
Result<BasicStencilTable<Real>> build_step_table(const Refinement& refinement, uint32_t level,
                                                 Interpolation interpolation = Interpolation::vertex);

/// The points of `level` (0 .. level_count() - 1) from the control points. Row r is vertex r of the level;
/// source_count is refinement.control_count.
/// Weights are computed in double. Built on all cores; the result does not depend on their number. Peak
/// memory is the table plus a few percent. Errors: too_large when the table would hold 2^32 entries or more.
template <class Real>
Result<BasicStencilTable<Real>> build_stencil_table(const Refinement& refinement, uint32_t level,
                                                    Interpolation interpolation = Interpolation::vertex);

/// The limit positions of the vertices of the last level and, when asked for, two tangents each, from the
/// control points. Needs Refinement built with full_last_level. Row r is vertex r. Tangents: tangent1 points
/// along the first edge of the vertex, tangent1 x tangent2 along the normal (faces are counter-clockwise seen
/// from outside). Their lengths carry no meaning. At a crease the tangents are those of the side
/// counter-clockwise from its first sharp edge. Exact where the level is at least ceil(the largest finite
/// sharpness). Errors: unsupported when the last level has faces of other sizes than the scheme's own (refine
/// once; a vertex keeps its index, so the first rows of the next level's table are the limits of this one's
/// vertices) or was not built with full_last_level; too_large.
template <class Real>
Result<BasicStencilTable<Real>> build_limit_table(const Refinement& refinement, bool tangents = false);

/// The base face that each face of the level descends from: face_count entries. What face-uniform data needs.
Array<uint32_t> build_base_faces(const Refinement& refinement, uint32_t level);

/// Applies a table on the CPU in the precision of its weights, sums in row order: destination[r * width + i].
/// `source` holds source_count * width values, `destination` row_count() * width.
template <class Real>
void apply_stencil_table(const BasicStencilTable<Real>& table, std::span<const Real> source,
                         std::span<Real> destination, uint32_t width);

}  // namespace limn
