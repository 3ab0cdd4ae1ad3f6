// Repeated averaging: Zorin and Schroeder 2001, "A unified framework for primal/dual quadrilateral subdivision
// schemes". Faces are split into quads linearly, then the mesh is replaced by its dual of face centroids degree - 1
// times: bidegree B-splines on regular meshes. Boundaries are averaged like curves (Lane and Riesenfeld 1980), from
// their own points alone.
#include <array>
#include <cassert>

#include "limn/schemes/schemes.h"

namespace limn::schemes {

std::span<const Pass> averaging_passes(uint32_t degree) {
    static constexpr Pass split = {SplitKind::quads, {keep_vertex, face_centroid, edge_midpoint}};
    static constexpr Pass dual = {SplitKind::dual, {nullptr, face_centroid, edge_midpoint}};
    static constexpr std::array<Pass, 9> passes = {split, dual, dual, dual, dual, dual, dual, dual, dual};
    assert(degree >= 2 && degree <= passes.size());
    return {passes.data(), degree};
}

}  // namespace limn::schemes
