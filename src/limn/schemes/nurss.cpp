// Non-uniform recursive subdivision surfaces, Sederberg, Zheng, Sewell and Sabin 1998: Catmull-Clark with a knot
// interval for each edge, non-uniform bicubic B-splines on regular meshes. Stage::intervals: the interval of the edge
// that begins at a corner, one value seen from both sides: where the two faces of an edge have different ones, their
// mean counts (a reconstruction, as are boundaries: they are non-uniform cubic curves, behind which intervals repeat).
// An interval of zero across a line of edges makes a crease of it.
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

double interval(const Stage& p, uint32_t e) {
    if (p.intervals.empty()) return 1;
    double sum = 0;
    const auto corners = p.topology.corners_of_edge(e);
    for (const uint32_t c : corners) sum += p.intervals[c];
    return sum / static_cast<double>(corners.size());
}

/// The interval of v's edge `turn` edges counter-clockwise from its edge i. Inside.
double turned_interval(const Stage& p, uint32_t v, uint32_t i, int turn) {
    const auto edges = p.topology.edges_of_vertex(v);
    const auto n = static_cast<int>(edges.size());
    return interval(p, edges[static_cast<size_t>((static_cast<int>(i) + turn + 2 * n) % n)]);
}

/// Twice the interval behind vertex v as seen along its edge e.
double twice_behind(const Stage& p, uint32_t v, uint32_t e) {
    const Topology& t = p.topology;
    const auto edges = t.edges_of_vertex(v);
    const uint32_t i = edge_position(t, v, e);
    if (!is_boundary_vertex(t, v)) return turned_interval(p, v, i, 2) + turned_interval(p, v, i, -2);
    if (is_boundary_edge(t, e) && !is_fixed_corner(t, v)) return 2 * interval(p, edges[i == 0 ? edges.size() - 1 : 0]);
    return 2 * interval(p, e);
}
double reach(const Stage& p, uint32_t v, uint32_t e) {
    return interval(p, e) + twice_behind(p, v, e);
}

void face_row(const Stage& p, uint32_t f, Row& row) {
    const Topology& t = p.topology;
    auto weight = [&](uint32_t c) {
        return reach(p, end_vertex(t, c), t.face_edges[c]) *
               reach(p, t.face_vertices[t.previous_corner(c)], t.face_edges[t.previous_corner(c)]);
    };
    double sum = 0;
    for (uint32_t c = t.face_begin(f); c < t.face_begin(f) + t.size_of_face(f); ++c) sum += weight(c);
    if (sum == 0) return face_centroid(p, f, row);
    for (uint32_t c = t.face_begin(f); c < t.face_begin(f) + t.size_of_face(f); ++c)
        add(row, t.face_vertices[c], weight(c) / sum);
}

/// M, the edge's point as if it were a curve's.
void curve_row(const Stage& p, uint32_t e, Row& row) {
    const uint32_t a = p.topology.edge_vertices[2 * e], b = p.topology.edge_vertices[2 * e + 1];
    const double at_a = reach(p, a, e), at_b = reach(p, b, e);
    if (at_a + at_b == 0) return edge_midpoint(p, e, row);
    add(row, a, at_b / (at_a + at_b));
    add(row, b, at_a / (at_a + at_b));
}

/// The intervals beside both ends of corner c's edge, in its face.
double beside(const Stage& p, uint32_t c) {
    const Topology& t = p.topology;
    return interval(p, t.face_edges[t.previous_corner(c)]) + interval(p, t.face_edges[t.next_corner(c)]);
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    if (is_boundary_edge(t, e)) return curve_row(p, e, row);
    const uint32_t left = t.corners_of_edge(e)[0], right = t.corners_of_edge(e)[1];
    const double sum = 2 * (beside(p, left) + beside(p, right));
    const double left_share = sum == 0 ? 0 : beside(p, right) / sum, right_share = sum == 0 ? 0 : beside(p, left) / sum;
    add_scaled(row, 1 - left_share - right_share, [&] { curve_row(p, e, row); });
    add_scaled(row, left_share, [&] { face_row(p, t.face_of_corner(left), row); });
    add_scaled(row, right_share, [&] { face_row(p, t.face_of_corner(right), row); });
}

/// The cubic curve's vertex point: boundaries.
void boundary_vertex_row(const Stage& p, uint32_t v, Row& row) {
    const auto edges = p.topology.edges_of_vertex(v);
    const uint32_t next = edges.front(), previous = edges.back();
    const double after = interval(p, next), before = interval(p, previous), sum = 2 * (before + after);
    if (sum == 0 || is_fixed_corner(p.topology, v)) return add(row, v, 1);
    add(row, v, 0.5);
    add_scaled(row, after / sum, [&] { curve_row(p, previous, row); });
    add_scaled(row, before / sum, [&] { curve_row(p, next, row); });
}

void vertex_row(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    const uint32_t n = face_valence(t, v);
    if (n == 0) return add(row, v, 1);
    if (is_boundary_vertex(t, v)) return boundary_vertex_row(p, v, row);
    auto edge_weight = [&](uint32_t i) {
        return (turned_interval(p, v, i, 1) + turned_interval(p, v, i, -1)) *
               (turned_interval(p, v, i, 2) + turned_interval(p, v, i, -2)) / 2;
    };
    auto face_weight = [&](uint32_t i) {  // between edges i and i + 1
        return turned_interval(p, v, i, 2) * turned_interval(p, v, i, -1);
    };
    double sum = 0;
    for (uint32_t i = 0; i < n; ++i) sum += edge_weight(i) + face_weight(i);
    if (sum == 0) return add(row, v, 1);
    add(row, v, (n - 3.0) / n);
    for (uint32_t i = 0; i < n; ++i) {
        add_scaled(row, 3 * edge_weight(i) / (n * sum), [&] { curve_row(p, t.edges_of_vertex(v)[i], row); });
        add_scaled(row, 3 * face_weight(i) / (n * sum),
                   [&] { face_row(p, t.face_of_corner(t.corners_of_vertex(v)[i]), row); });
    }
}

/// Halves of edges have half of the interval, edges to face points half of the mean of the two edges along them.
void split_intervals(const Stage& p, Stage& child) {
    const Topology &t = p.topology, &u = child.topology;
    child.intervals.allocate(u.corner_count());
    for (uint32_t c = 0; c < t.corner_count(); ++c) {  // the child face of a corner: vertex, edge, face, edge point
        const uint32_t before = t.previous_corner(c), after = t.next_corner(c);
        auto half = [&](uint32_t corner) { return interval(p, t.face_edges[corner]) / 2; };
        const double values[] = {half(c), (half(before) + half(after)) / 2,
                                 (half(c) + half(t.previous_corner(before))) / 2, half(before)};
        uint32_t first = 0;
        while (u.face_vertices[4 * c + first] != t.face_vertices[c]) ++first;
        for (uint32_t i = 0; i < 4; ++i) child.intervals[4 * c + (first + i) % 4] = values[i];
    }
}

}  // namespace

std::span<const Pass> nurss_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {vertex_row, face_row, edge_row}, split_intervals}};
    return passes;
}

}  // namespace limn::schemes
