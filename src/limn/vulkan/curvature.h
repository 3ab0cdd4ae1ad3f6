// Curvatures at samples on the device, behind SurfaceEvaluator::prepare_samples: second derivatives; a
// barrier from kKernelWrites to kKernelReads; curvatures. And the division that rational surfaces need, whose
// points are homogeneous.
#pragma once

#include "limn/curvature.h"
#include "limn/vulkan/evaluator.h"

namespace limn::vk {

/// As evaluate_curvature (limn/curvature.h), in float. A record of all buffers for each sample, from their
/// first point on.
struct CurvatureInfo {
    uint32_t sample_count = 0;
    uint32_t width = 3;  ///< of values: 3; 4: homogeneous, a weight last
    /// Six values a sample, as PatchEvaluationInfo::results of Derivatives::second; the stride is at least 6
    /// * width. Of this and the others: STORAGE_BUFFER usage, and none overlaps another.
    PointBuffer values = {};
    /// gaussian, mean, first, second, first_direction, second_direction, as in Curvature; the stride is at
    /// least shared::kCurvatureFloats (10).
    PointBuffer curvatures = {};
    /// Optional (null buffer), of width 4: the six values of three components after division; the stride is
    /// at least 18.
    PointBuffer quotients = {};
};

/// An evaluation with all that it needs bound: record it as often as wanted. What StencilEvaluation says
/// holds for it, too.
class CurvatureEvaluation {
  public:
    CurvatureEvaluation(CurvatureEvaluation&&) noexcept;
    CurvatureEvaluation& operator=(CurvatureEvaluation&&) noexcept;
    ~CurvatureEvaluation();
    /// Before: values visible to kKernelReads, earlier uses of the others done. Owed after: a barrier from
    /// kKernelWrites.
    void record(VkCommandBuffer command_buffer) const;

  private:
    friend class CurvatureEvaluator;
    CurvatureEvaluation();
    struct State;
    std::unique_ptr<State> state_;
};

/// The curvature pipelines of a device. Must outlive its evaluations; may be used by several threads at once.
class CurvatureEvaluator {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<CurvatureEvaluator> create(const Device& device);
    CurvatureEvaluator(CurvatureEvaluator&&) noexcept;
    CurvatureEvaluator& operator=(CurvatureEvaluator&&) noexcept;
    ~CurvatureEvaluator();

    /// Errors: invalid_argument (null, width, strides, offsets; quotients of width 3), out_of_memory,
    /// vulkan_failure.
    Result<CurvatureEvaluation> prepare(const CurvatureInfo& info) const;

  private:
    CurvatureEvaluator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::vk
