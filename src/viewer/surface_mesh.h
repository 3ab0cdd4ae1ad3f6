// The limit surface of a model as a RenderMesh: tessellated by limn on the device, from control points that
// may move.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "limn/baked_mesh.h"
#include "limn/control_mesh.h"
#include "limn/vulkan/hardware_tessellation.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "viewer/pass_timer.h"
#include "viewer/scene.h"

namespace limn::viewer {

/// Pipelines that all surfaces of a device share; compiled once, as they are needed. Outlives them.
struct SurfaceKernels {
    vk::SurfaceEvaluator evaluator;
    vk::Tessellator tessellator;
    std::optional<vk::HardwareTessellator> hardware;  ///< where the device has tessellation stages

    /// `device` outlives them. Errors: out_of_memory, vulkan_failure.
    static Result<SurfaceKernels> create(const vk::Device& device, bool has_tessellation_shader = false);
};

struct SurfaceMeshOptions {
    RateMode mode = RateMode::uniform;  ///< per_edge: by edge_rates
    TessellationSpacing spacing = TessellationSpacing::integer;
    /// Rates alone, which hardware tessellation draws by: there are no vertices then, and nothing to measure. Takes
    /// SurfaceKernels::hardware.
    bool hardware = false;
    VkBuffer edge_rates = VK_NULL_HANDLE;   ///< as vk::TessellationInfo has them
    bool places = false;                    ///< what colours by kind and level read
    uint32_t triangle_capacity = 1u << 20;  ///< at most max_triangle_capacity()

    bool operator==(const SurfaceMeshOptions&) const = default;
};

/// Owns tables and buffers. Nothing recorded may be pending when it is changed or destroyed.
class SurfaceMesh {
  public:
    /// Of tables that are there: built, or in a baked file. `device` and `kernels` outlive it. Errors: out_of_memory,
    /// vulkan_failure.
    static Result<SurfaceMesh> create(const vk::Device& device, const SurfaceKernels& kernels, const BakedMesh& tables,
                                      const SurfaceMeshOptions& options);
    /// The same of a mesh, whose tables it builds. Errors: those of the builders, too.
    static Result<SurfaceMesh> create(const vk::Device& device, const SurfaceKernels& kernels,
                                      const ControlMesh& mesh, std::span<const float> positions,
                                      const SurfaceMeshOptions& options);
    SurfaceMesh(SurfaceMesh&&) noexcept;
    SurfaceMesh& operator=(SurfaceMesh&&) noexcept;
    ~SurfaceMesh();

    /// Other rates, outputs, or room for more triangles: the buffers of mesh() are others then. Errors:
    /// out_of_memory, vulkan_failure, unsupported.
    Result<void> prepare(const SurfaceMeshOptions& options);
    const SurfaceMeshOptions& options() const;
    uint32_t max_triangle_capacity() const;  ///< what the device binds at once

    /// Control points to triangles, by settings whose mode is that of options(). Before: control points
    /// visible to kernels, earlier reads of the mesh done. After: the mesh is visible to kRenderReads.
    /// Errors: as vk::Tessellation::record. `timer` gets a mark a pass.
    Result<void> record(VkCommandBuffer commands, const RateSettings& settings,
                        PassTimer* timer = nullptr) const;
    /// The same triangles for control points that have moved.
    void record_vertices(VkCommandBuffer commands, PassTimer* timer = nullptr) const;

    RenderMesh mesh() const;
    Scheme scheme() const;
    uint32_t face_count() const;  ///< ptex faces
    VkDeviceSize tessellation_bytes() const;  ///< what is held beside tables and control points
    RenderLines control_lines() const;
    /// 3 floats each; STORAGE_BUFFER usage.
    VkBuffer control_points() const;

    /// What became of the last record(), once it has completed. Errors: vulkan_failure.
    Result<vk::TessellationResult> result() const;
    /// Records, waits and, where there is not enough room, makes more of it and tries again, as far as the
    /// device allows. Errors: those of prepare, record and result, not_finite (control points).
    Result<vk::TessellationResult> tessellate(const RateSettings& settings);
    /// The box of what the last record() made. Errors: invalid_argument (there are no triangles), vulkan_failure.
    Result<Bounds> measure() const;

  private:
    SurfaceMesh();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::viewer
