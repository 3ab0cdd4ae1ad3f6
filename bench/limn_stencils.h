// limn on a Vulkan device, as stencil_eval_bench times it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench.h"
#include "candidate.h"
#include "limn/stencil_table.h"
#include "limn/vulkan/surface_evaluator.h"

namespace limn::bench {

/// "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3".
std::string device_description(const vk::Device& device);

/// Bytes per second that vkCmdCopyBuffer reads and writes.
Result<double> measure_device_copy(const Options& options, const vk::Device& device);

/// Tables one after the other, each over the points that the one before makes: one composed table, or a chain
/// of steps. Recorded once; a frame is one submission. `width`: 3, or 4 with padding. `device` and
/// `evaluator` must outlive the candidate.
Result<Candidate> make_limn_candidate(const vk::Device& device, const vk::Evaluator& evaluator,
                                      std::span<const StencilTable> tables,
                                      const std::vector<float>& positions, uint32_t width);

/// The same points from a refined grid.
Result<Candidate> make_limn_refined_grid_candidate(const vk::Device& device, const vk::SurfaceEvaluator& evaluator,
                                                   const RefinedGridTable& table, const std::vector<float>& positions,
                                                   uint32_t width);

}  // namespace limn::bench
