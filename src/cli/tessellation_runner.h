// Where commands tessellate: a Vulkan device, or limn's own code on the host.
#pragma once

#include "cli/model_tables.h"
#include "cli/surface_runner.h"
#include "limn/tessellate.h"
#include "limn/vulkan/tessellator.h"

namespace limn::cli {

struct TessellationRequest {
    RateSettings settings;
    /// Rates are scaled down by one number where there would be more; no more than 2^32 / 3.
    std::optional<uint32_t> max_triangles;
};

/// Per vertex: 3, 3 and 2 floats, the last empty without a channel. Every vertex is part of a triangle, and
/// every number is finite.
struct TriangleMesh {
    std::vector<float> positions, normals, texture_coordinates;
    std::vector<uint32_t> indices;  ///< 3 per triangle
    double rate_scale = 1;

    size_t vertex_count() const { return positions.size() / 3; }
    size_t triangle_count() const { return indices.size() / 3; }
};

class TessellationRunner {
  public:
    /// `device` outlives the runner.
    static Result<TessellationRunner> create(const RunDevice& device);
    const std::string& name() const { return device_->name(); }

    /// Counts before it allocates. The host gives the triangles that devices do, but for rates that roundings
    /// decide, and where max_triangles binds. Errors: as check_rate_settings;
    /// unsupported (culling on the host); not_finite (the surface); invalid_argument (max_triangles is too
    /// small); too_large (2^32 indices, 2^31 vertices, more than there is memory for); out_of_memory,
    /// vulkan_failure.
    Result<TriangleMesh> run(const BakedMesh& model, const TessellationRequest& request) const;

  private:
    Result<TriangleMesh> run_on_host(const BakedMesh& model, const TessellationRequest& request) const;
    Result<TriangleMesh> run_on_device(const BakedMesh& model,
                                       const TessellationRequest& request) const;

    const RunDevice* device_ = nullptr;
    std::optional<SurfaceRunner> surfaces_;
    std::optional<vk::Tessellator> tessellator_;
};

}  // namespace limn::cli
