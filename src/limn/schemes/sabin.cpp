// Sabin 1991, "Cubic recursive division with bounded curvature", as restated by Levin 2000: Catmull-Clark
// with weights by valence, so that curvature at irregular vertices is bounded and need not vanish. Boundaries
// are Catmull-Clark's, their vertices weigh as regular ones. Semi-sharp creases are not defined in the
// literature.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

struct Weights {
    double vertex;  ///< in the points of faces and edges
    double face;    ///< gamma: what is taken from the faces in the vertex's own point
};
Weights weights_of_valence(uint32_t n) {
    const double k = std::cos(std::numbers::pi / n);
    // The root > 1 of x^3 + (4 k^2 - 3) x - 2 k, by Newton's method from above: convex there.
    double x = 2;
    for (int i = 0; i < 8; ++i) x -= (x * x * x + (4 * k * k - 3) * x - 2 * k) / (3 * x * x + 4 * k * k - 3);
    return {x * x + 2 * k * x - 3, (k * x + 2 * k * k - 1) / (x * x * (k * x + 1))};
}

double vertex_weight(const Topology& t, uint32_t v) {
    return is_boundary_vertex(t, v) || face_valence(t, v) == 4 ? 1 : weights_of_valence(face_valence(t, v)).vertex;
}

void face_row(const Stage& p, uint32_t f, Row& row) {
    const Topology& t = p.topology;
    double sum = 0;
    for (const uint32_t v : t.vertices_of_face(f)) sum += vertex_weight(t, v);
    for (const uint32_t v : t.vertices_of_face(f)) add(row, v, vertex_weight(t, v) / sum);
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    if (is_boundary_edge(t, e)) return edge_midpoint(p, e, row);
    const uint32_t a = t.edge_vertices[2 * e], b = t.edge_vertices[2 * e + 1];
    const double sum = vertex_weight(t, a) + vertex_weight(t, b) + 2;
    add(row, a, vertex_weight(t, a) / sum);
    add(row, b, vertex_weight(t, b) / sum);
    for (const uint32_t c : t.corners_of_edge(e))
        add_scaled(row, 1 / sum, [&] { face_row(p, t.face_of_corner(c), row); });
}

void vertex_row(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    const uint32_t n = face_valence(t, v);
    if (n == 0 || is_boundary_vertex(t, v)) return refined_vertex(p, v, row);
    const double gamma = weights_of_valence(n).face;
    add(row, v, gamma);
    for (const uint32_t e : t.edges_of_vertex(v)) add_scaled(row, 1.0 / n, [&] { edge_row(p, e, row); });
    for (const uint32_t c : t.corners_of_vertex(v))
        add_scaled(row, -gamma / n, [&] { face_row(p, t.face_of_corner(c), row); });
}

}  // namespace

std::span<const Pass> sabin_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {vertex_row, face_row, edge_row}}};
    return passes;
}

}  // namespace limn::schemes
