// OpenSubdiv's patches at samples, verified before they are measured.
//
// How far they are from the limit says nothing: end caps, and semi-sharp creases that go deeper than the isolation
// level, leave as much as the model makes of them. So its tables are held against limn's of the same patches, and its
// evaluators against what its own tables give in double.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "models.h"
#include "osd_patches.h"

namespace limn::bench {

struct OsdSamples {
    std::shared_ptr<const OsdPlaces> places;
    std::vector<double> values;  ///< of evaluate_osd_places

    std::vector<double> points() const;  ///< without derivatives
};

/// How far `values` are from those of limn's table with OpenSubdiv's end caps of the level, in double: 1 is all that
/// the rounding of its weights to float may make. Infinite where limn builds no such table.
double osd_difference(const BenchModel& model, uint32_t isolation_level, std::span<const PatchSample> samples,
                      const std::vector<double>& values);

/// False where osd_difference has nothing to say: with semi-sharp Chaikin creases, whose rules OpenSubdiv's adaptive
/// refinement applies to the edges that it happens to have; with vertices of two faces at which an infinitely sharp
/// edge ends, around which it has a point that is no neighbour; and with vertices that are not manifold, whose sheets
/// share points of its end caps, and where some corners come out as creases.
bool has_equal_patches(const ControlMesh& mesh);

/// Fails where there are none, or where they are not what they should be.
OsdSamples find_osd_samples(const Options& options, const BenchModel& model, uint32_t isolation_level,
                            std::span<const PatchSample> samples);

}  // namespace limn::bench
