// The limit surface of a model as a RenderMesh: evaluated by limn on the device, from control points that may
// move.
#pragma once

#include <memory>
#include <span>

#include "limn/control_mesh.h"
#include "limn/topology.h"
#include "viewer/scene.h"

namespace limn::viewer {

struct SurfaceMeshOptions {
    uint32_t rate = 16;   ///< triangles along each side of a ptex face, 1 .. 64
    bool places = false;  ///< what colours by kind and level read
};

/// Owns tables and buffers. Must be idle when it is destroyed.
class SurfaceMesh {
  public:
    /// `device` outlives it. Errors: as build_patch_table, invalid_argument (rate), too_large (more than the
    /// device binds at once), out_of_memory, vulkan_failure.
    static Result<SurfaceMesh> create(const vk::Device& device, const ControlMesh& mesh,
                                      std::span<const float> positions, const SurfaceMeshOptions& options);
    SurfaceMesh(SurfaceMesh&&) noexcept;
    SurfaceMesh& operator=(SurfaceMesh&&) noexcept;
    ~SurfaceMesh();

    /// Control points to triangles. Before: control points visible to kernels, earlier reads of the mesh
    /// done. After: the mesh is visible to kRenderReads.
    void record(VkCommandBuffer commands) const;

    RenderMesh mesh() const;
    RenderLines control_lines() const;
    /// 3 floats each; STORAGE_BUFFER usage.
    VkBuffer control_points() const;
    uint32_t control_point_count() const;

    struct Counts {
        uint64_t vertices = 0, triangles = 0;
    };
    /// What the last record() made. Submits nothing where device memory is mapped; waits.
    Result<Counts> count() const;
    /// The box of what the last record() made. Errors: invalid_argument (there are no triangles, or positions
    /// that are not finite), vulkan_failure.
    Result<Bounds> measure() const;

  private:
    SurfaceMesh();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::viewer
