// Control points in a pose, on the device: morph targets and linear blend skinning of one mesh, or of all instances of a
// crowd in one dispatch. A frame: the caller writes joint matrices and weights; Skinning; a barrier from kKernelWrites to
// kKernelReads; SurfaceEvaluator::prepare_points; and on as in surface_evaluator.h and tessellator.h.
#pragma once

#include "limn/skinning.h"
#include "limn/vulkan/evaluator.h"

namespace limn::vk {

/// A skin table as kernels read it: limn/shared/skin_params.h. Immutable once uploaded; outlives the evaluations that use
/// it.
struct DeviceSkinTable {
    uint32_t point_count = 0;  ///< as SkinTable, and the next two
    uint32_t joint_count = 0;
    uint32_t morph_weight_count = 0;
    uint32_t group_count = 0;
    shared::SkinOffsets offsets = {};
    Buffer words;

    /// Device memory.
    VkDeviceSize bytes() const { return words.size_bytes; }
};

/// The staging buffers must live until the command buffer has run.
struct SkinTableUpload {
    DeviceSkinTable table;
    std::vector<Buffer> staging;
};

/// Records the copy and a barrier to kernel reads. Errors: too_large (2^32 words), out_of_memory, vulkan_failure.
Result<SkinTableUpload> record_skin_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                 const SkinTable& table);
/// Submits, and waits. Errors: as above; invalid_argument (the device has no queue).
Result<DeviceSkinTable> upload_skin_table(const Device& device, const SkinTable& table);

/// As skin_points (limn/skinning.h), in float. Matrices and weights are read when commands run, so that host or kernels may
/// write them every frame: with several frames in flight, an evaluation for each of their buffers or offsets.
struct SkinningInfo {
    const DeviceSkinTable* table = nullptr;
    /// table->joint_count matrices, 48 bytes each; kSourceUsage; the offset is a multiple of 16. Null where there are none.
    WordBuffer joint_matrices = {};
    WordBuffer morph_weights = {};  ///< table->morph_weight_count floats; kSourceUsage. Null where there are none
    /// table->point_count points; STORAGE_BUFFER usage. The buffer that prepare_points has, for one. What is no instance's
    /// keeps its value, and so do floats between points.
    PointBuffer points = {};
};

/// An evaluation with all that it needs bound: record it as often as wanted. What StencilEvaluation says holds for it, too.
class Skinning {
  public:
    Skinning(Skinning&&) noexcept;
    Skinning& operator=(Skinning&&) noexcept;
    ~Skinning();
    /// Before: matrices and weights visible to kKernelReads, earlier uses of points done. Owed after: a barrier from
    /// kKernelWrites.
    void record(VkCommandBuffer command_buffer) const;

  private:
    friend class Skinner;
    Skinning();
    struct State;
    std::unique_ptr<State> state_;
};

/// The skin pipeline of a device. Must outlive its evaluations; may be used by several threads at once.
class Skinner {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<Skinner> create(const Device& device);
    Skinner(Skinner&&) noexcept;
    Skinner& operator=(Skinner&&) noexcept;
    ~Skinner();

    /// Errors: invalid_argument (null, stride, offsets), unsupported (more than the device can bind at once),
    /// out_of_memory, vulkan_failure.
    Result<Skinning> prepare(const SkinningInfo& info) const;

  private:
    Skinner();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::vk
