// The limit of schemes without patches at given places: dyadic parameters of any depth, by limit stencils.
#pragma once

#include <span>
#include <vector>

#include "limn/evaluate.h"
#include "limn/schemes/scheme_refinement.h"

namespace limn {

/// Coordinates are rounded to multiples of 2^-kMaxSampleDepth; floats in [0, 1] of that many bits are exact.
inline constexpr uint32_t kMaxSampleDepth = 24;

template <class Real>
struct SchemeSampleTable {
    /// Row i is sample i over the control points: its limit position and two tangents, whose cross product points along
    /// the normal; their lengths carry no meaning. Empty where the sample is not valid.
    BasicStencilTable<Real> table;
    std::vector<SampleStatus> statuses;  ///< one per sample
};

/// Whether faces are split in four, so that places on them have coordinates.
bool has_coordinates(const SubdivisionScheme& scheme);

/// Ptex faces and their coordinates are those of patch tables: a face of the scheme's own size (quads; triangles for
/// schemes of those) is one, any other face one for each corner, in face order; the unit square, or u + v <= 1.
/// As deep as each sample asks for: only what lies around it is refined. In parallel; thread-safe. Errors: as
/// build_scheme_refinement and build_scheme_limit_table; unsupported (no has_coordinates).
template <class Real>
Result<SchemeSampleTable<Real>> build_scheme_sample_table(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                                    std::span<const PatchSample> samples,
                                                    std::span<const double> intervals = {}, const BuildPart& control = {});

}  // namespace limn
