// OpenSubdiv's limit surface in double precision, as an oracle: adaptive patches of Far and surfaces of Bfr.
// No OpenSubdiv type appears here.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "limn/evaluate.h"
#include "shapes/shapes.h"

namespace limn::test {

// The surface at one place as OpenSubdiv has it. Derivatives are with respect to u and v of the ptex face.
struct OsdPlace {
    bool valid = false;    // false in holes and where there is no such ptex face
    bool regular = false;  // the patch is a spline or linear; else an end cap
    uint32_t depth = 0;    // the patch spans 2^-depth of the ptex face's u and v
    double cap_size = 0;   // of an end cap: the largest distance between two of its corners
    bool turned = false;   // a triangle turned by 180 degrees: OpenSubdiv negates second derivatives there
    std::array<std::array<double, 3>, 6> values{};  // P, du, dv, duu, duv, dvv
};

class OsdPatchOracle {
  public:
    // Null when OpenSubdiv refuses the mesh, see OsdOracle::create. Far's patches are isolated to `level`,
    // with patches along infinitely sharp edges, true corners, and Gregory end caps.
    static std::unique_ptr<OsdPatchOracle> create(const TestMesh& mesh, uint32_t level, std::string* error);
    ~OsdPatchOracle();

    uint32_t ptex_face_count() const;
    std::vector<OsdPlace> far_places(std::span<const double> control_points,
                                     std::span<const PatchSample> samples) const;
    // Bfr with both of its approximation levels set to `level`. Second derivatives, depth and cap_size are
    // not given; `regular` says that the whole face is.
    std::vector<OsdPlace> bfr_places(std::span<const double> control_points, uint32_t level,
                                     std::span<const PatchSample> samples) const;

  private:
    struct Data;
    explicit OsdPatchOracle(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

}  // namespace limn::test
