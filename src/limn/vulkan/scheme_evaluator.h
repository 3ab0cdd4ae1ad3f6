// The surface of any scheme on the device, every frame: control points to refined points to limit positions and normals.
// No kernel knows the scheme: a chain of stencil tables (evaluator.h), and normals of tangents.
#pragma once

#include "limn/schemes/scheme_surface.h"
#include "limn/vulkan/evaluator.h"

namespace limn::vk {

/// A SchemeSurface in device memory. Immutable once uploaded; outlives the evaluations that use it.
struct DeviceSchemeSurface {
    uint32_t control_count = 0;
    uint32_t vertex_count = 0;
    uint32_t triangle_count = 0;
    std::vector<DeviceStencilTable> tables;  ///< a chain, the last with tangents: the limit
    Buffer triangles;                        ///< 3 * triangle_count vertex indices, uint32; INDEX_BUFFER usage, too

    /// Device memory.
    VkDeviceSize bytes() const;
};

struct SchemeSurfaceUpload {
    DeviceSchemeSurface table;
    std::vector<Buffer> staging;
};

/// As record_patch_table_upload (surface_tables.h). Owed where triangles are drawn: a barrier from kCopyWrites to
/// kDrawReads. Errors: too_large, out_of_memory, vulkan_failure.
Result<SchemeSurfaceUpload> record_scheme_surface_upload(const Device& device, VkCommandBuffer command_buffer,
                                                         const SchemeSurface& surface);
/// What an upload takes: all that it makes, byte for byte. Errors: too_large.
Result<MemoryNeed> upload_memory(const SchemeSurface& surface);

/// Submits, and waits. Errors: invalid_argument (the device has no queue), too_large, out_of_memory, vulkan_failure.
Result<DeviceSchemeSurface> upload_scheme_surface(const Device& device, const SchemeSurface& surface);

/// What a frame reads and writes.
struct SchemeEvaluationInfo {
    const DeviceSchemeSurface* surface = nullptr;
    PointBuffer points = {};     ///< control_count control points, 3 floats each; kSourceUsage
    PointBuffer positions = {};  ///< vertex_count vertices, 3 floats each; STORAGE_BUFFER usage
    PointBuffer normals = {};    ///< optional, vertex_count unit normals; may interleave with positions in one buffer
};

/// An evaluation with all that it needs bound, the points between its tables among it. What StencilEvaluation says holds
/// for it, too.
class SchemeEvaluation {
  public:
    SchemeEvaluation(SchemeEvaluation&&) noexcept;
    SchemeEvaluation& operator=(SchemeEvaluation&&) noexcept;
    ~SchemeEvaluation();
    /// With barriers between its own dispatches. Before: points visible to kKernelReads, earlier uses of positions and
    /// normals done. Owed after: a barrier from kKernelWrites. One command buffer after the other, with such a barrier:
    /// the points in between are this object's.
    void record(VkCommandBuffer command_buffer) const;
    uint32_t dispatch_count() const;
    /// Device memory that it holds: the points between tables, and tangents.
    VkDeviceSize bytes() const;

  private:
    friend class SchemeEvaluator;
    SchemeEvaluation();
    struct State;
    std::unique_ptr<State> state_;
};

/// The pipelines of a device. Must outlive its evaluations; may be used by several threads at once.
class SchemeEvaluator {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<SchemeEvaluator> create(const Device& device);
    SchemeEvaluator(SchemeEvaluator&&) noexcept;
    SchemeEvaluator& operator=(SchemeEvaluator&&) noexcept;
    ~SchemeEvaluator();

    /// Errors: as Evaluator::prepare.
    Result<SchemeEvaluation> prepare(const SchemeEvaluationInfo& info) const;

  private:
    SchemeEvaluator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::vk
