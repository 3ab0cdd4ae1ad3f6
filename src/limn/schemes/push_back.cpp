// Push-back: an approximating scheme made to interpolate by moving each step's points back by what vertices
// have moved. Maillot and Stam 2001; Lin, Luo, You and Li 2008 (which of its readings they mean is not
// certain: this one is step by step). On regular meshes Loop becomes the ten-point butterfly scheme with w =
// -1/32, cubic curves the four-point scheme. Semi-sharp creases are not defined in the literature.
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

/// What vertex v has moved, the other way.
void add_push_back(const Stage& p, uint32_t v, double weight, Row& row) {
    add(row, v, weight);
    add_scaled(row, -weight, [&] { refined_vertex(p, v, row); });
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    refined_edge(p, e, row);
    for (uint32_t end = 0; end < 2; ++end) add_push_back(p, p.topology.edge_vertices[2 * e + end], 0.5, row);
}

void face_row(const Stage& p, uint32_t f, Row& row) {
    face_centroid(p, f, row);
    const auto vertices = p.topology.vertices_of_face(f);
    for (const uint32_t v : vertices) add_push_back(p, v, 1 / static_cast<double>(vertices.size()), row);
}

}  // namespace

std::span<const Pass> push_back_catmull_clark_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {keep_vertex, face_row, edge_row}}};
    return passes;
}
std::span<const Pass> push_back_loop_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {keep_vertex, nullptr, edge_row}}};
    return passes;
}

}  // namespace limn::schemes
