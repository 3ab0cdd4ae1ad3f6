// Honeycomb subdivision, the dual of sqrt(3): Zhang and Wang 2002; Claes, Beets and Van Reeth 2002. Faces
// turn by half a side inside themselves; a vertex of n edges becomes a face of 2 n sides. Boundaries shrink.
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

/// The point of the edge that begins at corner c, in c's face. A third for each is what keeps regular
/// hexagons regular.
void corner_row(const Stage& p, uint32_t c, Row& row) {
    const Topology& t = p.topology;
    add(row, t.face_vertices[c], 1.0 / 3);
    add(row, end_vertex(t, c), 1.0 / 3);
    add_centroid(t, t.face_of_corner(c), 1.0 / 3, row);
}

}  // namespace

std::span<const Pass> honeycomb_passes() {
    static constexpr Pass passes[] = {{SplitKind::hexagons, {nullptr, nullptr, nullptr, corner_row}}};
    return passes;
}

}  // namespace limn::schemes
