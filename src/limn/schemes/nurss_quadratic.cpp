// Quadratic non-uniform recursive subdivision surfaces, Sederberg, Zheng, Sewell and Sabin 1998: Doo-Sabin with a knot
// interval for each vertex and edge, non-uniform biquadratic B-splines on regular meshes. Stage::intervals: the
// interval that a corner's vertex has for the edge that begins at the corner. For the edge that ends there it is the
// one of the corner beyond that edge; at a boundary that of the boundary's next edge, or, at a vertex of one face, what
// the edge's other end has. Boundaries are non-uniform quadratic curves, as Doo-Sabin's. Faces that are no quads follow
// a reconstruction.
#include <cmath>
#include <numbers>
#include <vector>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

double toward_next(const Stage& p, uint32_t corner) {
    return p.intervals.empty() ? 1 : p.intervals[corner];
}
double toward_previous(const Stage& p, uint32_t corner) {
    const Topology& t = p.topology;
    const uint32_t before = t.previous_corner(corner), beyond = opposite_corner(t, before);
    if (beyond != kInvalidIndex) return toward_next(p, beyond);
    const auto around = t.corners_of_vertex(t.face_vertices[corner]);
    return toward_next(p, around.size() == 1 ? before : around[0]);
}

void corner_row(const Stage& p, uint32_t corner, Row& row) {
    const Topology& t = p.topology;
    const uint32_t first = t.face_begin(t.face_of_corner(corner)), m = t.size_of_face(t.face_of_corner(corner));
    auto weight = [&](uint32_t c) {
        return toward_previous(p, t.next_corner(c)) * toward_next(p, t.previous_corner(c));
    };
    double sum = 0;
    for (uint32_t c = first; c < first + m; ++c) sum += weight(c);
    const double own = sum == 0 ? 0 : toward_next(p, corner) * toward_previous(p, corner) / (4 * sum);
    add(row, t.face_vertices[corner], 0.5 - m * own);
    for (uint32_t c = first; c < first + m; ++c) {
        const double turn = 2 * std::numbers::pi * (c > corner ? c - corner : corner - c) / m;
        add(row, t.face_vertices[c], (sum == 0 ? 1.0 / m : weight(c) / sum) / 2 + own * (1 + 2 * std::cos(turn)));
    }
}

/// A curve's corner cut off.
void edge_end_row(const Stage& p, uint32_t end, Row& row) {
    const Topology& t = p.topology;
    const uint32_t begin = t.corners_of_edge(end / 2)[0];
    const double at_begin = toward_next(p, begin), at_end = toward_previous(p, t.next_corner(begin));
    const double own = end % 2 == 0 ? at_begin : at_end, sum = 2 * (at_begin + at_end);
    const double share = sum == 0 ? 0.25 : own / sum;
    add(row, t.edge_vertices[end], 1 - share);
    add(row, t.edge_vertices[end ^ 1], share);
}

/// Where a child vertex comes from: a corner, or what lies on the boundary beside it.
struct Place {
    enum Kind : uint8_t { inside, edge_after, edge_before, fixed } kind;  ///< the edge that begins or ends there
    uint32_t corner;
};

/// In the order of the split's points.
std::vector<Place> places_of(const Topology& t) {
    std::vector<Place> places;
    for (uint32_t c = 0; c < t.corner_count(); ++c) places.push_back({Place::inside, c});
    if (t.options.boundary == BoundaryInterpolation::none) return places;
    for (uint32_t e = 0; e < t.edge_count; ++e) {
        if (!is_boundary_edge(t, e)) continue;
        const uint32_t c = t.corners_of_edge(e)[0];
        places.push_back({Place::edge_after, c});
        places.push_back({Place::edge_before, t.next_corner(c)});
    }
    for (uint32_t v = 0; v < t.vertex_count; ++v)
        if (face_valence(t, v) != 0 && is_boundary_vertex(t, v) && is_fixed_corner(t, v))
            places.push_back({Place::fixed, t.corners_of_vertex(v)[0]});
    return places;
}

/// Whether the way from place a to place b goes on along the edge of the parent that begins at a's corner, or back
/// along it: else it is the other edge, which ends there.
bool follows_next_edge(const Topology& t, const Place& a, const Place& b) {
    if (t.face_vertices[a.corner] != t.face_vertices[b.corner]) return b.corner == t.next_corner(a.corner);
    if (a.kind != Place::inside && b.kind != Place::inside) return a.kind != Place::edge_before;  // along a boundary
    if (a.kind != b.kind) return (a.kind == Place::inside ? b : a).kind != Place::edge_after;     // across one
    return t.face_edges[a.corner] != t.face_edges[t.previous_corner(b.corner)];                   // across an edge
}

/// Vertices keep half of what they had along both edges, on their four sides.
void split_intervals(const Stage& p, Stage& child) {
    const Topology &t = p.topology, &u = child.topology;
    const std::vector<Place> places = places_of(t);
    child.intervals.allocate(u.corner_count());
    for (uint32_t c = 0; c < u.corner_count(); ++c) {
        const Place& from = places[u.face_vertices[c]];
        const Place& to = places[end_vertex(u, c)];
        child.intervals[c] =
            (follows_next_edge(t, from, to) ? toward_next(p, from.corner) : toward_previous(p, from.corner)) / 2;
    }
}

}  // namespace

std::span<const Pass> nurss_quadratic_passes() {
    static constexpr Pass passes[] = {
        {SplitKind::corners, {keep_vertex, nullptr, nullptr, corner_row, edge_end_row}, split_intervals}};
    return passes;
}

}  // namespace limn::schemes
