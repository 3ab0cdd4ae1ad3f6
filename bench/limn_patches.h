// limn's patches on a Vulkan device, as patch_eval_bench and grid_eval_bench time them.
#pragma once

#include <span>
#include <vector>

#include "bench.h"
#include "limn/evaluate.h"
#include "limn/vulkan/context.h"
#include "patch_candidate.h"

namespace limn::bench {

/// Position, du and dv at each sample. A frame is one submission: level-1 points, then samples. `device` must
/// outlive the candidate; `table` and `samples` need not. Errors: unsupported.
Result<PatchCandidate> make_limn_patch_eval_candidate(const vk::Device& device, const PatchTable& table,
                                                      std::span<const PatchSample> samples,
                                                      const std::vector<float>& positions, double copy_rate);

/// Position and normal at kGridSize x kGridSize places per ptex face; values() in the order of grid_samples.
Result<PatchCandidate> make_limn_grid_candidate(const vk::Device& device, const PatchTable& table,
                                                const std::vector<float>& positions, double copy_rate);

}  // namespace limn::bench
