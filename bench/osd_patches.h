// OpenSubdiv's patch tables, and its evaluators at places of the surface.
#pragma once

#include <opensubdiv/far/patchTable.h>
#include <opensubdiv/osd/types.h>

#include <memory>
#include <span>
#include <vector>

#include "bench.h"
#include "limn/evaluate.h"
#include "osd.h"
#include "osd_gl.h"
#include "osd_stencils.h"
#include "patch_candidate.h"

namespace limn::bench {

/// Everything that OpenSubdiv's evaluators take: feature-adaptive patches, Gregory at their ends, and
/// stencils over the control points for refined points and those of the ends.
struct OsdPatches {
    OsdRefiner refiner;  ///< kept, so that freeing it is no part of what building takes
    std::unique_ptr<const OpenSubdiv::Far::PatchTable> patches;
    std::unique_ptr<const OpenSubdiv::Far::StencilTable> stencils;
    uint32_t control_count = 0;

    uint64_t patch_count() const { return static_cast<uint64_t>(patches->GetNumPatchesTotal()); }
    uint64_t stencil_count() const { return stencils->GetSizes().size(); }
    uint64_t point_count() const { return control_count + stencil_count(); }
    /// As uploaded: sizes, offsets, indices and weights; vertices of patches and their parameters.
    uint64_t stencil_bytes() const { return 8 * stencil_count() + 8 * stencils->GetWeights().size(); }
    uint64_t patch_bytes() const {
        return 4 * patches->GetPatchControlVerticesTable().size() + 12 * patch_count();
    }
    uint64_t bytes() const { return stencil_bytes() + patch_bytes(); }
};

/// From the mesh as OpenSubdiv takes it. Patches are those that its evaluators can evaluate: infinitely sharp
/// ones, but none with a semi-sharp crease. Null when it refuses the mesh.
std::unique_ptr<const OsdPatches> build_osd_patches(const OsdMesh& mesh, uint32_t isolation_level);

/// What its evaluators evaluate.
struct OsdPlaces {
    std::unique_ptr<const OsdPatches> patches;
    std::vector<OpenSubdiv::Osd::PatchCoord> places;
};

/// Patches of this level, and where samples are on them. Null when it refuses the mesh, or has no patch at a sample.
std::shared_ptr<const OsdPlaces> find_osd_places(const ControlMesh& mesh, uint32_t isolation_level,
                                                 std::span<const PatchSample> samples);

/// Position, du and dv at each place, x y z each, computed in double from its tables' weights in float.
std::vector<double> evaluate_osd_places(const OsdPlaces& places, const std::vector<float>& positions);

/// A frame is stencils, then position and, but for PatchTask::points, du and dv at each place. `width`: 3, or
/// 4 with padding.
PatchCandidate make_osd_patch_candidate(OsdEvaluator evaluator, PatchTask task,
                                        const std::shared_ptr<const OsdPlaces>& places,
                                        const std::vector<float>& positions, uint32_t width,
                                        double copy_rate);

/// Name and counts; `what`: cpu, omp or gl.
PatchCandidate describe_osd_patch_candidate(const std::string& what, PatchTask task, const OsdPlaces& places,
                                            uint32_t width);

#if defined(LIMN_HAVE_OPENSUBDIV_GL)
/// The context must outlive the candidate. Errors: unsupported (a kernel that does not compile; more places
/// than one dispatch of OpenSubdiv's can have).
Result<PatchCandidate> make_osd_gl_patch_candidate(const GlContext& context, PatchTask task,
                                                   const std::shared_ptr<const OsdPlaces>& places,
                                                   const std::vector<float>& positions, uint32_t width,
                                                   double copy_rate);
#else
inline Result<PatchCandidate> make_osd_gl_patch_candidate(const GlContext&, PatchTask,
                                                          const std::shared_ptr<const OsdPlaces>&,
                                                          const std::vector<float>&, uint32_t, double) {
    return GlContext::create().error();
}
#endif

}  // namespace limn::bench
