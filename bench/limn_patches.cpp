#include "limn_patches.h"

namespace limn::bench {

Result<PatchCandidate> make_limn_patch_eval_candidate(const vk::Device&, const PatchTable&,
                                                      std::span<const PatchSample>, const std::vector<float>&,
                                                      double) {
    return Error{ErrorCode::unsupported, "not on a device yet"};
}

Result<PatchCandidate> make_limn_grid_candidate(const vk::Device&, const PatchTable&,
                                                const std::vector<float>&, double) {
    return Error{ErrorCode::unsupported, "not on a device yet"};
}

}  // namespace limn::bench
