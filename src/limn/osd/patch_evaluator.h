// OpenSubdiv's patches evaluated on the device: prepared once, recorded as often as wanted.
#pragma once

#include <span>

#include "limn/osd/far_tables.h"
#include "limn/vulkan/evaluator.h"

namespace limn::osd {

/// What to evaluate. For each coordinate c < coord_count and component i < width, outputs[d] gets
///   sum over k of weight_d[k] * source[index[k]][i]
/// at point c: the value (d = 0), du, dv, duu, duv, dvv, with OpenSubdiv's weights (its derivatives of
/// Gregory patches, and its signs in turned triangles, included). Coordinates that name no patch get zeros.
/// Nothing else is written.
struct PatchEvaluationInfo {
    const DevicePatches* patches = nullptr;
    uint32_t width = 3;                ///< floats per point, 1 or more; strides are at least that
    vk::PointBuffer source = {};       ///< patches->source_count points
    VkBuffer coords = VK_NULL_HANDLE;  ///< coord_count Osd::PatchCoord, from byte 0; usage as of the source
    uint32_t coord_count = 0;
    vk::PointBuffer outputs[6] = {};  ///< those of a null buffer are left out
    /// Source and coords lack VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT. GPUs do not mind; CPU devices are
    /// slower.
    bool storage_only = false;
};

/// As vk::StencilEvaluation: destroy it when no command buffer that it was recorded into is pending.
class PatchEvaluation {
  public:
    PatchEvaluation(PatchEvaluation&&) noexcept;
    PatchEvaluation& operator=(PatchEvaluation&&) noexcept;
    ~PatchEvaluation();

    /// Binds and dispatches, and owes the barriers that vk::StencilEvaluation::record owes.
    void record(VkCommandBuffer command_buffer) const;

  private:
    friend class PatchEvaluator;
    PatchEvaluation();
    struct State;
    std::unique_ptr<State> state_;
};

/// The osd_patch_eval pipelines of a device. Immutable; must outlive its evaluations.
class PatchEvaluator {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<PatchEvaluator> create(const vk::Device& device);
    PatchEvaluator(PatchEvaluator&&) noexcept;
    PatchEvaluator& operator=(PatchEvaluator&&) noexcept;
    ~PatchEvaluator();

    /// May be called from several threads at once. Errors: invalid_argument (no patches, width, strides, null
    /// buffers), unsupported (a table or source larger than the device binds at once), out_of_memory,
    /// vulkan_failure.
    Result<PatchEvaluation> prepare(const PatchEvaluationInfo& info) const;

  private:
    PatchEvaluator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::osd
