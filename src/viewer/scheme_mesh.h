// The surface of a model under any scheme as a RenderMesh: refined evenly on the device, from control points that may move.
#pragma once

#include <memory>
#include <span>

#include "limn/vulkan/scheme_evaluator.h"
#include "viewer/pass_timer.h"
#include "viewer/scene.h"

namespace limn::viewer {

/// Owns tables and buffers. Nothing recorded may be pending when it is destroyed.
class SchemeMesh {
  public:
    /// `positions`: 3 for each control point. `device` and `evaluator` outlive it. Errors: as upload_scheme_surface and
    /// SchemeEvaluator::prepare; too_large (more vertices or triangles than the device binds at once).
    static Result<SchemeMesh> create(const vk::Device& device, const vk::SchemeEvaluator& evaluator,
                                     const SchemeSurface& surface, std::span<const float> positions);
    SchemeMesh(SchemeMesh&&) noexcept;
    SchemeMesh& operator=(SchemeMesh&&) noexcept;
    ~SchemeMesh();

    /// Control points to vertices. Before: control points visible to kernels, earlier reads of the mesh done. After: the
    /// mesh is visible to kRenderReads. `timer` gets a mark.
    void record(VkCommandBuffer commands, PassTimer* timer = nullptr) const;
    /// record(), submitted and waited for, and the box of what it made. Errors: vulkan_failure, not_finite (a control
    /// point).
    Result<Bounds> evaluate() const;

    RenderMesh mesh() const;
    RenderLines control_lines() const;
    VkBuffer control_points() const;  ///< 3 floats each; STORAGE_BUFFER usage
    uint32_t vertex_count() const;
    uint32_t triangle_count() const;

  private:
    SchemeMesh();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::viewer
