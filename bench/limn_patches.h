// limn's patches on a Vulkan device, as patch_eval_bench and grid_eval_bench time them.
#pragma once

#include <span>
#include <vector>

#include "bench.h"
#include "limn/evaluate.h"
#include "limn/vulkan/surface_evaluator.h"
#include "patch_candidate.h"

namespace limn::bench {

/// Both must outlive the candidates.
struct LimnDevice {
    const vk::Device& device;
    const vk::SurfaceEvaluator& evaluator;
    double copy_rate;  ///< bytes per second of a plain copy
};

/// Position, du and dv at each sample. A frame is one submission: level-1 points, then local points if there are trees,
/// then samples. `trees` is null or outlives the call.
Result<PatchCandidate> make_limn_patch_eval_candidate(const LimnDevice& limn, const PatchTable& table,
                                                      const PatchTreeTable* trees, std::span<const PatchSample> samples,
                                                      const std::vector<float>& positions);

/// The same by evaluate_patches: on all cores of the host, in double. `table` and `samples` must outlive the
/// candidate.
PatchCandidate make_limn_host_patch_eval_candidate(const PatchTable& table,
                                                   std::span<const PatchSample> samples,
                                                   const std::vector<float>& positions, double copy_rate);

/// Where normals go: behind each position, as three floats or packed into a word, or into a buffer of their own.
enum class GridLayout { interleaved, packed, separate };

/// Grids of this rate; values() in the order of grid_samples. Derivatives are interleaved.
Result<PatchCandidate> make_limn_grid_candidate(const LimnDevice& limn, const PatchTable& table,
                                                const std::vector<float>& positions, uint32_t rate,
                                                PatchTask task, GridLayout layout = GridLayout::interleaved);

/// What a frame of grids computes: values of samples, derivatives where the table has them, and level-1
/// points.
double grid_flops(const PatchTable& patches, const GridTable& grid);

}  // namespace limn::bench
