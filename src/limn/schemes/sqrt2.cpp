// A quad for each edge. Velho and Zorin 2001, 4-8 subdivision, which on its blocks of two triangles is the
// sqrt(2) scheme of Li, Ma and Bao 2004; balanced weights for irregular vertices; and an interpolatory scheme
// (quincunx). Boundaries are cut each second step, at the third side of half blocks: cubic B-splines;
// four-point curves of the interpolatory scheme.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

/// The corner at which the face's boundary edge begins, where this step cuts boundaries; else kInvalidIndex.
uint32_t cut_corner(const Stage& p, uint32_t f) {
    return p.step % 2 == 1 ? boundary_corner(p.topology, f) : kInvalidIndex;
}

void face_row(const Stage& p, uint32_t f, Row& row) {
    const uint32_t cut = cut_corner(p, f);
    if (cut != kInvalidIndex) return edge_midpoint(p, p.topology.face_edges[cut], row);
    face_centroid(p, f, row);
}

/// `ring_weight(n)` is the sum of the weights of an interior vertex's n neighbours.
template <class RingWeight>
void add_vertex(const Stage& p, uint32_t v, const RingWeight& ring_weight, Row& row) {
    const Topology& t = p.topology;
    const uint32_t n = edge_valence(t, v);
    if (n == 0) return add(row, v, 1);
    if (is_boundary_vertex(t, v)) return p.step % 2 == 1 ? cubic_boundary_vertex(p, v, row) : add(row, v, 1);
    const double sum = ring_weight(n);
    add(row, v, 1 - sum);
    for (uint32_t i = 0; i < n; ++i) add(row, neighbor(t, v, i), sum / n);
}

void vertex_row(const Stage& p, uint32_t v, Row& row) {
    add_vertex(
        p, v, [](uint32_t) { return 0.5; }, row);
}

/// The subdominant eigenvalue of the scheme at valence n, which no vertex weight changes: power iteration on
/// the points of frequency 1 around the vertex, by symmetry one of each kind. Those are its neighbours, the
/// opposite corners of its faces, the points two edges away and (g, its mirror image being conjugate) a
/// knight's move away. A step turns the star by half a sector.
double subdominant_eigenvalue(uint32_t n) {
    const double c = std::cos(std::numbers::pi / n), s = std::sin(std::numbers::pi / n);
    double edge = 1, face = 1.4, far = 2, g_real = 2.1, g_imaginary = -0.5, lambda = 0;
    for (uint32_t i = 0; i < 80; ++i) {
        const double next_edge = (2 * c * edge + face) / 4;
        const double next_face = edge / 2 + (2 * c * face + far) / 8;
        const double next_far = face / 2 + (2 * c * edge + 2 * g_real) / 8;
        const double next_real = (edge + far + c * (face + g_real) - s * g_imaginary) / 4;
        const double next_imaginary = -(s * (face + g_real) + c * g_imaginary) / 4;
        lambda = next_edge / edge;
        edge = 1;
        face = next_face / next_edge;
        far = next_far / next_edge;
        g_real = next_real / next_edge;
        g_imaginary = next_imaginary / next_edge;
    }
    return lambda;
}

/// The weight at which the second eigenvalue of frequency 0 is the square of the subdominant one, so that
/// curvature is bounded: from the rows of the same points, the vertex itself being 1. No weight does that at
/// valence 3.
double balanced_ring_weight(uint32_t n) {
    if (n <= 4) return 0.5;
    const double lambda = subdominant_eigenvalue(n), mu = lambda * lambda;
    // mu edge = (1 + 2 edge + face) / 4 and so on; edge, face, far and g, unknown, are eliminated from the
    // last up: mu far = face / 2 + (edge + g) / 4, mu g = (edge + far + face + g) / 4, mu face = (4 edge + 1
    // + 2 face + far) / 8.
    const double g = 1 / (4 * mu - 1);  // of (edge + far + face)
    const double far_scale = mu - g / 4;
    const double far_face = (0.5 + g / 4) / far_scale, far_edge = (1 + g) / 4 / far_scale;
    const double face_scale = 8 * mu - 2 - far_face;
    const double face_edge = (4 + far_edge) / face_scale, face_one = 1 / face_scale;
    const double edge = (1 + face_one) / (4 * mu - 2 - face_edge);
    return (1 - mu) / (1 - edge);  // mu = 1 - weight + weight * edge
}

void balanced_vertex_row(const Stage& p, uint32_t v, Row& row) {
    add_vertex(p, v, balanced_ring_weight, row);
}

bool is_regular(const Topology& t, uint32_t v) {
    return is_boundary_vertex(t, v) || edge_valence(t, v) == 4;
}

/// Both vertices across the edge that begins at corner c. At a boundary this side's are mirrored in the ends
/// of the edge; a half block is a block whose missing vertex mirrors the one opposite.
void add_pair_across(const Topology& t, uint32_t c, double weight, Row& row) {
    const uint32_t beyond = opposite_corner(t, c);
    const uint32_t a = t.face_vertices[c], b = end_vertex(t, c);
    if (beyond == kInvalidIndex) {
        add(row, a, 2 * weight);
        add(row, b, 2 * weight);
        add(row, t.face_vertices[t.previous_corner(c)], -weight);
        return add(row, end_vertex(t, t.next_corner(c)), -weight);
    }
    const uint32_t next = t.next_corner(beyond), previous = t.previous_corner(beyond);
    if (t.size_of_face(t.face_of_corner(beyond)) == 4) {
        add(row, end_vertex(t, next), weight);
        return add(row, t.face_vertices[previous], weight);
    }
    const bool cut_follows = is_boundary_edge(t, t.face_edges[next]);
    add(row, t.face_vertices[previous], 2 * weight);
    add(row, cut_follows ? a : b, weight);
    add(row, cut_follows ? b : a, -weight);  // the end off the boundary
}

/// The rule of an irregular vertex for the face between its neighbours i and i + 1.
void add_irregular_corner(const Topology& t, uint32_t v, uint32_t i, double weight, Row& row) {
    const uint32_t n = edge_valence(t, v);
    add(row, v, weight / 2);
    for (uint32_t j = 0; j < n; ++j) {
        const double turn = (2.0 * j - 1) * std::numbers::pi / n;
        const double ring =
            (0.5 + std::numbers::sqrt2 * std::cos(turn) + (n >= 5 ? std::cos(2 * turn) : 0)) / n;
        add(row, neighbor(t, v, (i + j) % n), weight * ring);
    }
}

void interpolatory_face_row(const Stage& p, uint32_t f, Row& row) {
    const Topology& t = p.topology;
    const uint32_t cut = cut_corner(p, f), first = t.face_begin(f), n = t.size_of_face(f);
    if (cut != kInvalidIndex) return four_point_boundary_edge(p, t.face_edges[cut], row);
    uint32_t irregular = 0;
    for (uint32_t c = first; c < first + n; ++c) irregular += !is_regular(t, t.face_vertices[c]);
    for (uint32_t c = first; c < first + n; ++c) {
        const uint32_t v = t.face_vertices[c];
        if (irregular == 0) {
            add(row, v, 10.0 / 32);
            add_pair_across(t, c, -1.0 / 32, row);
        } else if (!is_regular(t, v)) {
            add_irregular_corner(t, v, edge_position(t, v, t.face_edges[c]), 1.0 / irregular, row);
        }
    }
}

}  // namespace

std::span<const Pass> four_eight_passes() {
    static constexpr Pass passes[] = {{SplitKind::sqrt2, {vertex_row, face_row}}};
    return passes;
}
std::span<const Pass> sqrt2_balanced_passes() {
    static constexpr Pass passes[] = {{SplitKind::sqrt2, {balanced_vertex_row, face_row}}};
    return passes;
}
std::span<const Pass> sqrt2_interpolatory_passes() {
    static constexpr Pass passes[] = {{SplitKind::sqrt2, {keep_vertex, interpolatory_face_row}}};
    return passes;
}

}  // namespace limn::schemes
