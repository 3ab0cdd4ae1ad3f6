// Adaptive tessellation on the device: from control points to an indexed triangle mesh and the command that draws it,
// within one command buffer and without reading anything back. Faces share their vertices, so that the mesh is closed
// by its indices wherever the control mesh is.
#pragma once

#include "limn/tessellate.h"
#include "limn/vulkan/evaluator.h"
#include "limn/vulkan/tessellation_tables.h"

namespace limn::vk {

/// An element of TessellationInfo::instances, 64 bytes: limn/shared/tess_params.h. value_scale 1 leaves RateSettings::value
/// as it is; flags are kInstanceHidden, kInstanceKeepOutside and kInstanceKeepBackfaces.
using TessellationInstance = shared::TessInstance;

/// Values of a face-varying channel, `width` floats per vertex of the tessellation.
struct TessellatedChannel {
    uint32_t channel = 0;  ///< of DeviceTessellationTable::channels
    const DevicePatchTable* patches = nullptr;
    uint32_t width = 2;       ///< 1 to 4
    PointBuffer points = {};  ///< of the channel, patches->point_count; kSourceUsage
    PointBuffer values = {};  ///< optional: where there is none, the channel is for tangents alone
};

/// Heights from a texture: scale * texel + bias at the first two coordinates of a channel, from the first component of
/// mip level 0. The sampler says what lies between texels and beyond the edge. For a surface without wrinkles choose linear
/// filtering, and a texture no finer than the tessellation: steps of 1 / max_rate of a face.
struct HeightTexture {
    VkImageView view = VK_NULL_HANDLE;  ///< optional: null
    VkSampler sampler = VK_NULL_HANDLE;
    VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    uint32_t channel = 0;  ///< of DeviceTessellationTable::channels, and among TessellationInfo::channels
    float scale = 1, bias = 0;
};

/// What to make. Per-vertex outputs are PointBuffers with room for vertex_capacity points; any of them may share a
/// buffer with others, as long as they do not overlap. All but `points` need STORAGE_BUFFER usage. Optional ones have
/// null buffers. With none at all but `result`, and no capacities, rates alone are computed: what hardware tessellation
/// draws by (hardware_tessellation.h).
struct TessellationInfo {
    const DevicePatchTable* patches = nullptr;
    const DeviceTessellationTable* table = nullptr;
    PointBuffer points = {};  ///< patches->point_count points (SurfaceEvaluator::prepare_points); kSourceUsage
    RateMode mode = RateMode::uniform;
    TessellationSpacing spacing = TessellationSpacing::integer;
    bool cull_outside = false;    ///< as RateSettings
    bool cull_backfaces = false;
    WordBuffer edge_rates = {};  ///< of mode per_edge: a float for each rate edge; kSourceUsage
    /// Optional: a TessellationInstance for each of table->instance_count, as merge_tessellation_tables or a Crowd numbers them. Rates
    /// and culling then see the world that object_to_world leads to; the camera is the world's, `bound` stays the
    /// object's. What is written stays the object's, too. Read by record_rates, so that host or kernels may write it every
    /// frame; visible to kKernelReads. STORAGE_BUFFER usage; the offset is a multiple of minStorageBufferOffsetAlignment.
    WordBuffer instances = {};

    uint32_t vertex_capacity = 0;
    uint32_t triangle_capacity = 0;
    /// Where more would be needed, scale all rates down by the largest factor that fits. Nothing to rates alone.
    bool fit_capacity = true;

    PointBuffer positions = {};  ///< null, as indices and command are then: rates alone
    PointBuffer normals = {};  ///< optional: unit normals
    PointBuffer places = {};   ///< optional, 4 words: ptex face, u and v (floats), kind of leaf | its level << 8
    PointBuffer tangents = {};  ///< optional, 4 floats: unit tangent (not of the displaced surface), sign of the bitangent
    /// The channel, of `channels`, whose first coordinate tangents follow; none: they follow u of the ptex face.
    uint32_t tangent_channel = ~uint32_t{0};
    std::span<const TessellatedChannel> channels;
    PointBuffer previous_points = {};     ///< optional, as `points`: those of the last frame
    PointBuffer previous_positions = {};  ///< where the vertices would have been then

    /// Displacement along the normal, by three floats per vertex: the height, and its derivatives by u and v of the ptex
    /// face that the vertex's place is on. They come from a texture or, without one, from the caller: after
    /// record_vertices his own commands write them, from places, positions or channels as he likes, and then follows
    /// record_displacement. Shared vertices have one height and seams the first side's, so that nothing cracks.
    PointBuffer heights = {};  ///< optional; kSourceUsage. With a texture limn has a buffer of its own where this is null
    HeightTexture height_texture = {};

    WordBuffer indices = {};         ///< 3 * triangle_capacity words
    bool clockwise = false;          ///< triangles run against the faces of the control mesh, which are counter-clockwise
    WordBuffer triangle_faces = {};  ///< optional: triangle_capacity words, the ptex face of each triangle
    WordBuffer command = {};         ///< one VkDrawIndexedIndirectCommand
    /// Optional: a VkDrawIndexedIndirectCommand for each of table->instance_count, 20 bytes apart: that instance's triangles
    /// of `indices`, none where it is hidden or nothing is drawn. firstInstance is the instance's number, which takes the
    /// feature drawIndirectFirstInstance (drawCount > 1: multiDrawIndirect), or 0.
    WordBuffer instance_commands = {};
    bool number_instances = true;
    WordBuffer result = {};          ///< optional: a TessellationResult
};

enum class TessellationStatus : uint32_t {
    complete = shared::kTessComplete,
    scaled = shared::kTessScaled,         ///< rates were scaled down to fit the capacity
    too_small = shared::kTessTooSmall,    ///< nothing is drawn: not even the least rates fit, or fitting is off
    not_finite = shared::kTessNotFinite,  ///< nothing is drawn: a control point is no number
    bad_settings = shared::kTessBadSettings,  ///< nothing is drawn: record returned an error
};
struct TessellationResult {
    TessellationStatus status;
    uint32_t vertex_count;
    uint32_t triangle_count;
    float rate_scale;
};

/// What Tessellator::prepare makes memory for, in terms of what is there before any device memory is.
struct TessellationMemoryInfo {
    const TessellationTable* table = nullptr;
    const PatchTreeTable* vertices = nullptr;
    std::span<const PatchTreeTable* const> channels;  ///< one for each of TessellationInfo::channels
    uint32_t own_height_count = 0;  ///< vertex_capacity where there is a height texture and no heights; else 0
    bool previous_points = false;
    bool rates_only = false;
};
/// Tessellation::state_bytes, in as many buffers as that takes.
MemoryNeed tessellation_memory(const TessellationMemoryInfo& info);

/// A tessellation with all that it needs bound, and memory of its own for what lies between (state_bytes). To be
/// recorded as often as wanted, by several threads at once, too, but executed by one queue at a time. The tables and buffers must outlive it.
class Tessellation {
  public:
    Tessellation(Tessellation&&) noexcept;
    Tessellation& operator=(Tessellation&&) noexcept;
    ~Tessellation();

    /// A frame: all of the passes below. Mode, spacing and culling of the settings are those of the TessellationInfo.
    /// Before: points visible to kKernelReads, earlier uses of the outputs done. Owed after: a barrier from kKernelWrites
    /// to what reads them (kDrawReads, kCopyReads). With an error (check_rate_settings) the commands recorded draw nothing.
    Result<void> record(VkCommandBuffer command_buffer, const RateSettings& settings) const;

    /// The passes of a frame, in this order; barriers between them are included. Points and vertices alone (and what
    /// displaces them) keep the rates and indices that are there: for animation, and for refitting what refers to the mesh.
    /// What the others write is the same for any `largest_rate` that no rate exceeds; with a small one they take less time:
    /// pass largest_rate(settings) of the settings of record_rates.
    void record_points(VkCommandBuffer command_buffer) const;  ///< local points of patches
    Result<void> record_rates(VkCommandBuffer command_buffer,
                              const RateSettings& settings) const;  ///< rates, counts, the command and the result
    void record_triangles(VkCommandBuffer command_buffer, uint32_t largest_rate = shared::kMaxSideRate) const;
    void record_vertices(VkCommandBuffer command_buffer, uint32_t largest_rate = shared::kMaxSideRate) const;
    /// Heights from the texture, where there is one. Before: vertices.
    void record_heights(VkCommandBuffer command_buffer, uint32_t largest_rate = shared::kMaxSideRate) const;
    /// Positions and normals of the displaced surface. Before: heights visible to kKernelReads, positions no longer in
    /// use. `record` has both where there is a texture.
    void record_displacement(VkCommandBuffer command_buffer, uint32_t largest_rate = shared::kMaxSideRate) const;
    /// What no rate of these settings exceeds, be they scaled to fit or not.
    uint32_t largest_rate(const RateSettings& settings) const;

    VkDeviceSize state_bytes() const;
    /// Rates and which faces are drawn, as limn/shared/tess_params.h lays them out: for debugging and colours.
    VkBuffer state_buffer() const;

  private:
    friend class Tessellator;
    friend class HardwareTessellator;
    friend struct TessellationPreparation;
    Tessellation();
    struct State;
    std::unique_ptr<State> state_;
};

/// The pipelines of a device. Must outlive its tessellations; may be used by several threads at once.
class Tessellator {
  public:
    /// Errors: out_of_memory, vulkan_failure.
    static Result<Tessellator> create(const Device& device);
    Tessellator(Tessellator&&) noexcept;
    Tessellator& operator=(Tessellator&&) noexcept;
    ~Tessellator();

    /// Errors: invalid_argument (null, strides, offsets, channels), unsupported (more than the device can bind at once),
    /// out_of_memory, vulkan_failure.
    Result<Tessellation> prepare(const TessellationInfo& info) const;

  private:
    friend struct TessellationPreparation;
    Tessellator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::vk
