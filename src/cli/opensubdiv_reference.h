// OpenSubdiv in double precision, for `limn check`. No OpenSubdiv type appears here.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "limn/control_mesh.h"
#include "limn/evaluate.h"

namespace limn::cli {

struct ReferenceLimits {
    std::vector<double> positions, tangents1, tangents2;  ///< 3 per vertex
};

/// A control mesh refined uniformly by OpenSubdiv.
class OpenSubdivReference {
  public:
    static Result<OpenSubdivReference> create(const ControlMesh& mesh, uint32_t level);
    OpenSubdivReference(OpenSubdivReference&&) noexcept;
    OpenSubdivReference& operator=(OpenSubdivReference&&) noexcept;
    ~OpenSubdivReference();

    std::vector<uint32_t> face_vertices() const;  ///< of the last level
    /// The points of the last level from those of the control mesh, 3 each.
    std::vector<double> refine(std::span<const float> control_points) const;
    ReferenceLimits limits(std::span<const float> control_points) const;
    /// 1 for each vertex of the last level whose limit is that of the refinement. OpenSubdiv has another
    /// where sharpness has yet to fade, where a single infinitely sharp edge ends, and inside the surface at
    /// vertices of two faces.
    std::vector<uint8_t> vertices_with_true_limits() const;
    /// Bfr 3.5 reads past its arrays on other meshes.
    bool bfr_is_safe() const;
    /// 2 numbers per face corner of the last level, from 2 per value of the first channel.
    std::vector<double> refine_face_varying(std::span<const float> values) const;
    /// The same, moved to the limit.
    std::vector<double> face_varying_limits(std::span<const float> values) const;

  private:
    struct Data;
    explicit OpenSubdivReference(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

/// The limit surface at one place.
struct ReferencePlace {
    bool valid = false;
    bool regular = false;                           ///< in a spline patch; else in an end cap
    uint32_t depth = 0;                             ///< the patch spans 2^-depth of the ptex face's u and v
    double cap_size = 0;                            ///< of an end cap
    std::array<std::array<double, 3>, 6> values{};  ///< P, du, dv, duu, duv, dvv by the ptex face's u and v
};

/// OpenSubdiv's patches of some faces of a mesh: Gregory end caps, isolated to a level.
class OpenSubdivSurface {
  public:
    /// `faces`: those of the control mesh that are asked for.
    static Result<OpenSubdivSurface> create(const ControlMesh& mesh, uint32_t level,
                                            std::span<const uint32_t> faces);
    OpenSubdivSurface(OpenSubdivSurface&&) noexcept;
    OpenSubdivSurface& operator=(OpenSubdivSurface&&) noexcept;
    ~OpenSubdivSurface();

    std::vector<ReferencePlace> far_places(std::span<const float> control_points,
                                           std::span<const PatchSample> samples) const;
    /// Bfr's: positions and first derivatives only. Both of its levels are `level`.
    std::vector<ReferencePlace> bfr_places(std::span<const float> control_points, uint32_t level,
                                           std::span<const PatchSample> samples) const;

  private:
    struct Data;
    explicit OpenSubdivSurface(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

}  // namespace limn::cli
