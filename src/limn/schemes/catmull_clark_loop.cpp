// Catmull and Clark 1978, Loop 1987 and linear interpolation, with the creases of DeRose, Kass and Truong
// 1998: the rows that limn has for them (scheme.h, stencil_row.h).
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"
#include "limn/stencil_row.h"

namespace limn::schemes {

void refined_vertex(const Stage& p, uint32_t v, Row& row) {
    refinement_row(p.topology, child_of_vertex(v), Interpolation::vertex, row);
}
void refined_edge(const Stage& p, uint32_t e, Row& row) {
    refinement_row(p.topology, child_of_edge(p.topology, e), Interpolation::vertex, row);
}
void keep_vertex(const Stage&, uint32_t v, Row& row) {
    add(row, v, 1);
}
void face_centroid(const Stage& p, uint32_t f, Row& row) {
    add_centroid(p.topology, f, 1, row);
}
void edge_midpoint(const Stage& p, uint32_t e, Row& row) {
    add(row, p.topology.edge_vertices[2 * e], 0.5);
    add(row, p.topology.edge_vertices[2 * e + 1], 0.5);
}

std::span<const Pass> catmull_clark_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {refined_vertex, face_centroid, refined_edge}}};
    return passes;
}
std::span<const Pass> loop_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {refined_vertex, nullptr, refined_edge}}};
    return passes;
}
std::span<const Pass> bilinear_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {keep_vertex, face_centroid, edge_midpoint}}};
    return passes;
}
std::span<const Pass> linear_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {keep_vertex, nullptr, edge_midpoint}}};
    return passes;
}

}  // namespace limn::schemes
