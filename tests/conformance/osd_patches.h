// OpenSubdiv's patches in double precision. No OpenSubdiv type appears here.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shapes/shapes.h"

namespace limn::test {

using Vector3 = std::array<double, 3>;

struct GregoryPatch {
    uint32_t ptex_face = 0;
    uint32_t depth = 0;  // levels of refinement, those that make quads of other faces included
    std::array<std::array<double, 2>, 4> corners;  // in the coordinates of the ptex face
    std::vector<Vector3> points;                   // 20, Loop 18
};

// Adaptive refinement to `isolation_level`, infinitely sharp patches on, Gregory basis end caps.
class OsdPatches {
  public:
    // Null when OpenSubdiv refuses the mesh.
    static std::unique_ptr<OsdPatches> create(const TestMesh& mesh, uint32_t isolation_level,
                                              std::string* error);
    ~OsdPatches();

    const std::vector<GregoryPatch>& gregory_patches() const { return patches_; }
    // Value, du, dv, duu, duv, dvv of a Gregory patch, by the coordinates of the ptex face.
    std::array<Vector3, 6> evaluate(size_t patch, double u, double v) const;

  private:
    struct Data;
    OsdPatches();
    std::unique_ptr<Data> data_;
    std::vector<GregoryPatch> patches_;
};

}  // namespace limn::test
