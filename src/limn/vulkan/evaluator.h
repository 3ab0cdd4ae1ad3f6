// Points from points: stencil tables evaluated on the device.
#pragma once

#include "limn/vulkan/device_tables.h"

namespace limn::vk {

/// Points in a buffer of the caller's. Component i of point p is the float at byte
/// offset_bytes + 4 * (first + p * stride + i).
struct PointBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0;  ///< a multiple of 4; no other alignment is asked for
    uint64_t first = 0;             ///< floats
    uint32_t stride = 3;            ///< floats from one point to the next
};

/// 32-bit words in a buffer of the caller's, from offset_bytes on, a multiple of 4.
struct WordBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0;
};

/// What to evaluate. For each row r in [first_row, first_row + row_count) and component i < width:
/// destination[r][i] = sum over k of weight[k] * source[index[k]][i], and tangents likewise. The order of
/// each sum is fixed when the table is uploaded: results are the same bits at every run. Nothing else is
/// written: floats between the points of a destination keep their values.
struct StencilEvaluationInfo {
    const DeviceStencilTable* table = nullptr;
    uint32_t width = 3;       ///< floats per point, 1 or more; strides are at least that
    PointBuffer source = {};  ///< table->source_count points; the buffer has kSourceUsage
    PointBuffer destination =
        {};                     ///< row_count points used; STORAGE_BUFFER usage; overlaps no other one here
    PointBuffer tangent1 = {};  ///< optional (null buffer): for tables with tangents
    PointBuffer tangent2 = {};
    uint32_t first_row = 0;
    uint32_t row_count = ~uint32_t{0};  ///< clamped to the rows there are
    /// A float that may be read follows each source point of three floats, whatever it is. Where such points begin at
    /// multiples of 16 bytes, CPU devices then fetch each at once.
    bool padded_source = false;
    /// The source lacks VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT. GPUs do not mind; CPU devices are half
    /// as fast.
    bool storage_only_source = false;
};

/// An evaluation with all that it needs bound: record it as often as wanted, into any command buffers.
/// Destroy it when none of them is pending.
class StencilEvaluation {
  public:
    StencilEvaluation(StencilEvaluation&&) noexcept;
    StencilEvaluation& operator=(StencilEvaluation&&) noexcept;
    ~StencilEvaluation();

    /// Binds and dispatches: no submit, no wait, no allocation, no read-back, no barrier; outside a render
    /// pass. It disturbs the compute pipeline, compute descriptor set 0 and the push constants of the command
    /// buffer. Before: source points visible to kKernelReads, earlier uses of the destination done (a barrier
    /// to kKernelWrites). Owed after: a barrier from kKernelWrites to whatever reads the points. Several
    /// evaluations that do not depend on each other need no barrier in between. Threads may record at once, each into a
    /// command buffer of its own.
    void record(VkCommandBuffer command_buffer) const;

    uint32_t dispatch_count() const;

  private:
    friend class Evaluator;
    StencilEvaluation();
    struct State;
    std::unique_ptr<State> state_;
};

/// The stencil_eval pipelines of a device. Immutable; must outlive its evaluations.
class Evaluator {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<Evaluator> create(const Device& device);
    Evaluator(Evaluator&&) noexcept;
    Evaluator& operator=(Evaluator&&) noexcept;
    ~Evaluator();

    /// Makes the descriptor sets of an evaluation. May be called from several threads at once.
    /// Errors: invalid_argument (width, strides, a tangent asked for that the table does not have),
    /// unsupported (rows that lie together refer to sources further apart than the device can bind at once),
    /// out_of_memory, vulkan_failure.
    Result<StencilEvaluation> prepare(const StencilEvaluationInfo& info) const;

  private:
    Evaluator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::vk
