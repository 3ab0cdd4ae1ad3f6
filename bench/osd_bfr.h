// OpenSubdiv's Bfr, the peer of tessellation: limit surfaces of faces, evaluated and tessellated on the host.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "osd.h"

namespace limn::bench {

/// Each face by itself, at one rate: Bfr::Surface and Bfr::Tessellation, made once; on all cores.
class BfrTessellation {
  public:
    /// Null where OpenSubdiv refuses the mesh.
    static std::unique_ptr<BfrTessellation> create(const OsdMesh& mesh, uint32_t rate);
    ~BfrTessellation();

    /// A frame: positions and normals of all vertices, and all triangles.
    void run(const std::vector<float>& positions);

    std::vector<float> vertices;  ///< x y z nx ny nz; faces do not share any
    std::vector<int> indices;     ///< 3 per triangle

  private:
    struct Faces;
    BfrTessellation();
    std::unique_ptr<Faces> faces_;
};

}  // namespace limn::bench
