// Tessellation by the graphics pipeline: instead of vertices and indices in memory, stages that evaluate the surface
// while it is drawn, at the rates that a Tessellation has computed. For devices with the feature tessellationShader.
//
// Into the caller's own pipeline go three stages of limn's. With them go: dynamic or other state as he likes, topology
// PATCH_LIST, patchControlPoints 1, no vertex input, the default tessellation domain origin (upper left); a pipeline
// layout whose descriptor set 0 is set_layout(), with kHardwarePushConstants. Sets from 1 on, and push constants behind
// limn's, are the caller's. To his fragment stage go
//     layout(location = 0) in vec3 position;        as control points are
//     layout(location = 1) in vec3 normal;          unit, as TessellationInfo::normals
//     layout(location = 2) in vec2 place;           (u, v) of the ptex face
//     layout(location = 3) flat in uint ptex_face;
// and front faces are those that vertices of a Tessellation would have: counter-clockwise seen from outside.
//
// A frame: record_points and record_rates of the Tessellation, a barrier from kKernelWrites to kHardwareReads,
// record_draw.
//
// Vertices lie where the compute kernels put them, whatever spacing. Faces that meet evaluate the same expression at
// the same place of the same ptex face with the same instructions: seams, creases and faces that are split on one side
// only included. Not promised, unlike with an index buffer:
// - that the surface is closed: it is, where the device's arithmetic gives the same bits for the same instructions, and
//   its tessellator places vertices in order. Every vertex on a side is evaluated by each of the faces beside it;
// - how faces are triangulated, above all between sides of different rates; with fractional spacing diagonals there may
//   change from frame to frame, though no vertex jumps;
// - more than 64 segments of an edge: higher rates are drawn as 64, on both sides of it.
// Displacement, tangents and channels are for compute kernels only.
#pragma once

#include "limn/shared/tess_hardware.h"
#include "limn/vulkan/tessellator.h"

namespace limn::vk {

/// SPIR-V, entry point "main", no specialization constants.
struct HardwareStages {
    std::span<const uint32_t> vertex, control, evaluation;
};

/// Reads of the stages, of what record_points and record_rates write.
inline constexpr StageAccess kHardwareReads = {
    VK_PIPELINE_STAGE_TESSELLATION_CONTROL_SHADER_BIT | VK_PIPELINE_STAGE_TESSELLATION_EVALUATION_SHADER_BIT,
    VK_ACCESS_SHADER_READ_BIT};

inline constexpr VkPushConstantRange kHardwarePushConstants = {
    VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT | VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT, 0,
    sizeof(shared::TessHardwareParams)};

/// A tessellation as the stages read it. To be recorded as often as wanted, with any clip matrices.
class HardwareTessellation {
  public:
    HardwareTessellation(HardwareTessellation&&) noexcept;
    HardwareTessellation& operator=(HardwareTessellation&&) noexcept;
    ~HardwareTessellation();

    /// Draws what is drawn of the surface: within a render pass, the caller's pipeline bound. Binds set 0 and pushes
    /// constants. `clip_from_points`: a 4 x 4 matrix, column after column.
    void record_draw(VkCommandBuffer command_buffer, VkPipelineLayout layout,
                     std::span<const float, 16> clip_from_points) const;

  private:
    friend class HardwareTessellator;
    HardwareTessellation();
    struct State;
    std::unique_ptr<State> state_;
};

struct HardwareTessellatorInfo {
    const Device* device = nullptr;  ///< outlives the tessellator
    /// The caller says that he has enabled the feature tessellationShader: a device does not tell.
    bool tessellation_shader_enabled = false;
};

/// What the tessellations of a device share. Must outlive them, and pipeline layouts made with set_layout().
class HardwareTessellator {
  public:
    /// Errors: unsupported (the feature is not enabled), out_of_memory, vulkan_failure.
    static Result<HardwareTessellator> create(const HardwareTessellatorInfo& info);
    HardwareTessellator(HardwareTessellator&&) noexcept;
    HardwareTessellator& operator=(HardwareTessellator&&) noexcept;
    ~HardwareTessellator();

    VkDescriptorSetLayout set_layout() const;
    /// Loop has stages of its own: its ptex faces are triangles.
    HardwareStages stages(Scheme scheme) const;

    /// `tessellation` outlives what is returned, and may be for rates alone (TessellationInfo). Errors: out_of_memory,
    /// vulkan_failure.
    Result<HardwareTessellation> prepare(const Tessellation& tessellation) const;

  private:
    HardwareTessellator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::vk
