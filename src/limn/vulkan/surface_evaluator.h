// The limit surface on the device: level-1 points, grids of a fixed rate, and lists of samples.
//
// A frame: the caller writes control points; prepare_points makes the level-1 points behind them; a barrier;
// then grids and samples, in any order. With patch trees samples are several times faster: then local points come before
// samples, and another barrier.
#pragma once

#include "limn/evaluate.h"
#include "limn/vulkan/evaluator.h"
#include "limn/vulkan/surface_tables.h"

namespace limn::vk {

/// patches->point_count points: the caller's control points and, behind them, room for those of level 1.
struct SurfacePointsInfo {
    const DevicePatchTable* patches = nullptr;
    uint32_t width = 3;                ///< floats per point, 1 or more
    PointBuffer points = {};           ///< kSourceUsage
    bool storage_only_source = false;  ///< as StencilEvaluationInfo
};

/// Sample s (GridTable says which place that is) of a destination is its point s. What belongs to holes is
/// left alone. Where tangents do not span a plane a normal is that of the surface's corners; it is a unit
/// vector in any case.
struct GridEvaluationInfo {
    const DevicePatchTable* patches = nullptr;
    const DeviceGridTable* grid = nullptr;
    uint32_t width = 3;        ///< 1 to 4
    PointBuffer points = {};   ///< patches->point_count points; kSourceUsage
    PointBuffer values = {};   ///< grid->sample_count() points; STORAGE_BUFFER usage, as the next three
    PointBuffer normals = {};  ///< optional (null buffer): width 3, and a grid with derivatives
    /// Normals are one word each, octahedral (limn/shared/octahedral.h): VK_FORMAT_R16G16_SNORM, off by 0.004 degrees at
    /// most. Behind their positions, 16 bytes a sample where six floats take 24, both are written at once.
    bool packed_normals = false;
    PointBuffer du = {};       ///< optional: both or none, and no normals
    PointBuffer dv = {};
};

/// Points of one level of uniform refinement: table->point_count() of them, in the order of Refinement's vertices.
struct RefinedGridInfo {
    const DeviceRefinedGrid* table = nullptr;
    uint32_t width = 3;        ///< 1 to 4
    PointBuffer source = {};   ///< table->source_count control points; kSourceUsage
    PointBuffer refined = {};  ///< STORAGE_BUFFER usage; overlaps not the source
};

/// A list of samples in a buffer of the caller's: sample s is the words at offset_bytes + 12 * s: the ptex
/// face as uint32, u and v as floats.
struct SampleBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;  ///< kSourceUsage
    VkDeviceSize offset_bytes = 0;     ///< a multiple of 4
    uint32_t count = 0;
};

/// Local points of patch trees, from points: once a frame, for all samples that are evaluated with those trees.
struct LocalPointsInfo {
    const DevicePatchTable* patches = nullptr;
    const DevicePatchTrees* trees = nullptr;  ///< of the same patch table, with PatchTreeOptions::relative
    uint32_t width = 3;                       ///< 1 to 4
    PointBuffer points = {};                  ///< patches->point_count points; kSourceUsage
    VkBuffer local_points = VK_NULL_HANDLE;   ///< 16 bytes for each of trees->local_count, and 16 at least; kSourceUsage
};

/// Value k (evaluate.h: value, du, dv, duu, duv, dvv), component i of sample s is float k * width + i of
/// point s of `results`; as evaluate_patches, in float. One record for each sample: zeros where the status is
/// not valid.
struct PatchEvaluationInfo {
    const DevicePatchTable* patches = nullptr;
    Derivatives derivatives = Derivatives::first;
    uint32_t width = 3;       ///< 1 to 4
    PointBuffer points = {};  ///< patches->point_count points; kSourceUsage
    SampleBuffer samples = {};
    PointBuffer results = {};   ///< the stride is at least value_count(derivatives) * width
    PointBuffer statuses = {};  ///< optional: SampleStatus as uint32 for each sample; only stride 1
    /// Optional, and only together: samples then take 16 local points each in place of a ring and a plan's rows of weights.
    /// Only samples closer to an irregular vertex than trees go are evaluated as without; results are as exact. The
    /// evaluation then has 4 bytes of device memory for each sample, so that its records must not run at the same time.
    const DevicePatchTrees* trees = nullptr;  ///< as LocalPointsInfo
    VkBuffer local_points = VK_NULL_HANDLE;   ///< as LocalPointsInfo
};

/// What prepare_samples with trees makes memory for; all other evaluations make none.
MemoryNeed sample_memory(const Device& device, uint32_t sample_count, uint32_t result_stride);

/// Where samples are, as locate_patches, in float: five words for each, at point s of `places`: surface,
/// plan, node, and u and v as floats; zeros where the status is not valid.
struct LocationInfo {
    const DevicePatchTable* patches = nullptr;
    SampleBuffer samples = {};
    PointBuffer places = {};    ///< the stride is at least 5
    PointBuffer statuses = {};  ///< as PatchEvaluationInfo
};

/// An evaluation with all that it needs bound: record it as often as wanted. What StencilEvaluation says
/// holds for it, too.
class SurfaceEvaluation {
  public:
    SurfaceEvaluation(SurfaceEvaluation&&) noexcept;
    SurfaceEvaluation& operator=(SurfaceEvaluation&&) noexcept;
    ~SurfaceEvaluation();
    /// Before: points and samples visible to kKernelReads, earlier uses of destinations done. Owed after: a
    /// barrier from kKernelWrites.
    void record(VkCommandBuffer command_buffer) const;
    uint32_t dispatch_count() const;

  private:
    friend class SurfaceEvaluator;
    SurfaceEvaluation();
    struct State;
    std::unique_ptr<State> state_;
};

/// The pipelines of a device. Must outlive its evaluations; may be used by several threads at once.
class SurfaceEvaluator {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<SurfaceEvaluator> create(const Device& device);
    SurfaceEvaluator(SurfaceEvaluator&&) noexcept;
    SurfaceEvaluator& operator=(SurfaceEvaluator&&) noexcept;
    ~SurfaceEvaluator();

    /// Errors, of all: invalid_argument (null, width, strides, offsets), unsupported (more than the
    /// device can bind at once: of a grid's destination, one pass), out_of_memory, vulkan_failure.
    Result<StencilEvaluation> prepare_points(const SurfacePointsInfo& info) const;
    Result<SurfaceEvaluation> prepare_grid(const GridEvaluationInfo& info) const;
    Result<SurfaceEvaluation> prepare_refined(const RefinedGridInfo& info) const;
    Result<SurfaceEvaluation> prepare_local_points(const LocalPointsInfo& info) const;
    Result<SurfaceEvaluation> prepare_samples(const PatchEvaluationInfo& info) const;
    Result<SurfaceEvaluation> prepare_locations(const LocationInfo& info) const;

  private:
    SurfaceEvaluator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::vk
