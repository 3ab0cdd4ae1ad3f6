// limn::osd on a Vulkan device, as osd_interop_bench times it: OpenSubdiv's own tables.
#pragma once

#include "limn/vulkan/context.h"
#include "osd_patches.h"
#include "osd_stencils.h"

namespace limn::bench {

/// How a frame reaches the device.
enum class OsdFrame {
    recorded,  ///< once, into a command buffer that is submitted again
    submitted  ///< by every call, as OpenSubdiv's own evaluators
};

/// Points of three floats. The device must outlive the candidates. Errors: as limn::osd's.
Result<Candidate> make_limn_osd_candidate(const vk::Device& device, const std::shared_ptr<const OsdTable>& table,
                                          const std::vector<float>& positions, OsdFrame how, double copy_rate);
/// Stencils, then position, du and dv at each place.
Result<PatchCandidate> make_limn_osd_patch_candidate(const vk::Device& device,
                                                     const std::shared_ptr<const OsdPlaces>& places,
                                                     const std::vector<float>& positions, OsdFrame how,
                                                     double copy_rate);

}  // namespace limn::bench
