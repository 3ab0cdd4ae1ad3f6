// Places on the surface that benchmarks of patches evaluate, and the truth there.
#pragma once

#include <span>
#include <vector>

#include "bench.h"
#include "limn/evaluate.h"
#include "models.h"

namespace limn::bench {

/// The ptex faces outside holes.
std::vector<uint32_t> present_faces(std::span<const uint32_t> ptex_surfaces);

/// Places uniform over the ptex faces outside holes, in no order. u and v are floats.
template <class Real>
std::vector<PatchSample> random_samples(const BasicPatchTable<Real>& table, uint32_t count);

/// Those of grids of this rate, of ptex faces outside holes: in the order face, v, u. Of a triangle those in
/// it.
std::vector<PatchSample> grid_samples(const PatchTableDouble& table, uint32_t rate);

/// The limit surface in double, by evaluate_patches: per sample `value_count(derivatives)` x y z triples.
template <class Real>
std::vector<double> evaluate_samples(const BasicPatchTable<Real>& table, std::span<const PatchSample> samples,
                                     const std::vector<float>& positions, Derivatives derivatives);

/// Corners of the faces of a refined mesh, as places on the base faces, and the limits of those vertices.
struct RefinedCorners {
    std::vector<PatchSample> samples;
    std::vector<double> limits;  ///< x y z per sample
};
RefinedCorners refined_corners(const Options& options, const BenchModel& model, uint32_t level);

}  // namespace limn::bench
