// OpenSubdiv in double precision, for `limn check`. No OpenSubdiv type appears here.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "limn/control_mesh.h"

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
    /// 2 numbers per face corner of the last level, from 2 per value of the first channel.
    std::vector<double> refine_face_varying(std::span<const float> values) const;

  private:
    struct Data;
    explicit OpenSubdivReference(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

}  // namespace limn::cli
