// Kobbelt 1996, "Interpolatory subdivision on open quadrilateral nets with arbitrary topology", omega = 1:
// the four-point scheme along both directions of a grid of quads. An irregular vertex has a virtual point
// behind it, chosen so that the two directions agree on its faces. Where they do not agree elsewhere, the one
// without virtual points counts, or the mean of both: a reconstruction. Boundaries are four-point curves.
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

constexpr double kOuter = 1.0 / 16, kInner = 0.5 + kOuter;

bool has_virtual_points(const Topology& t, uint32_t v) {
    return !is_boundary_vertex(t, v) && face_valence(t, v) != 4;
}

/// The virtual point behind irregular vertex v as seen along its edge i.
void add_virtual_point(const Topology& t, uint32_t v, uint32_t i, double weight, Row& row) {
    const uint32_t n = face_valence(t, v);
    const double g = kOuter / kInner;
    auto edge = [&](uint32_t j) { return neighbor(t, v, (i + n + j) % n); };
    auto diagonal = [&](uint32_t j) {
        return end_vertex(t, t.next_corner(t.corners_of_vertex(v)[(i + 2 * n + j) % n]));
    };
    for (uint32_t j = 0; j < n; ++j) {
        add(row, edge(j), weight * 4 / n);
        add(row, diagonal(j), -weight * 4 * g / n);
    }
    for (const uint32_t j : {n - 1, 0u, 1u}) add(row, edge(j), -weight);
    for (const uint32_t j : {2 * n - 2, n - 1, 0u, 1u}) add(row, diagonal(j), weight * g);
}

/// What lies straight behind end a of edge e, whose other end is b. Where the line ends: 2 a - b.
void add_point_behind(const Topology& t, uint32_t e, uint32_t a, double weight, Row& row) {
    const uint32_t i = edge_position(t, a, e), n = edge_valence(t, a);
    if (has_virtual_points(t, a)) return add_virtual_point(t, a, i, weight, row);
    if (!is_boundary_vertex(t, a)) return add(row, neighbor(t, a, (i + 2) % 4), weight);
    if (is_boundary_edge(t, e) && !is_fixed_corner(t, a)) return add(row, neighbor(t, a, n - 1 - i), weight);
    add(row, a, 2 * weight);
    add(row, t.other_vertex(e, a), -weight);
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    for (uint32_t end = 0; end < 2; ++end) {
        const uint32_t v = t.edge_vertices[2 * e + end];
        add(row, v, kInner);
        add_point_behind(t, e, v, -kOuter, row);
    }
}

/// Four edges across a strip of quads, corner c's face in the middle and c's edge one of the inner two. The
/// strip may end at one of these: kInvalidIndex.
struct Strip {
    uint32_t edges[4];
};
Strip strip_across(const Topology& t, uint32_t c) {
    auto opposite = [&](uint32_t corner) { return t.next_corner(t.next_corner(corner)); };
    auto edge_beyond = [&](uint32_t corner) {
        const uint32_t other = opposite_corner(t, corner);
        return other == kInvalidIndex ? kInvalidIndex : t.face_edges[opposite(other)];
    };
    const uint32_t d = opposite(c);
    return {{edge_beyond(c), t.face_edges[c], t.face_edges[d], edge_beyond(d)}};
}

bool has_virtual_points(const Topology& t, const Strip& strip) {
    for (const uint32_t e : strip.edges)
        for (uint32_t end = 0; e != kInvalidIndex && end < 2; ++end)
            if (has_virtual_points(t, t.edge_vertices[2 * e + end])) return true;
    return false;
}

/// The four-point rule on the strip's edge points.
void add_strip(const Stage& p, const Strip& strip, double weight, Row& row) {
    auto edge_point = [&](uint32_t i, double share) {
        add_scaled(row, weight * share, [&] { edge_row(p, strip.edges[i], row); });
    };
    for (const uint32_t outer : {0u, 3u}) {
        const uint32_t inner = outer == 0 ? 1 : 2;
        edge_point(inner, kInner);
        if (strip.edges[outer] != kInvalidIndex) {
            edge_point(outer, -kOuter);
        } else {
            edge_point(inner, -2 * kOuter);
            edge_point(3 - inner, kOuter);
        }
    }
}

void face_row(const Stage& p, uint32_t f, Row& row) {
    const Topology& t = p.topology;
    const uint32_t first = t.face_begin(f);
    const Strip strips[] = {strip_across(t, first), strip_across(t, first + 1)};
    const bool is_virtual[] = {has_virtual_points(t, strips[0]), has_virtual_points(t, strips[1])};
    for (uint32_t i = 0; i < 2; ++i) {
        const double weight = is_virtual[0] == is_virtual[1] ? 0.5 : is_virtual[i] ? 0 : 1;
        if (weight != 0) add_strip(p, strips[i], weight, row);
    }
}

}  // namespace

std::span<const Pass> kobbelt_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {keep_vertex, face_row, edge_row}}};
    return passes;
}

}  // namespace limn::schemes
