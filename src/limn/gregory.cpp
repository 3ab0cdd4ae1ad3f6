// Loop, Schaefer, Ni and Castano 2009, "Approximating Subdivision Surfaces with Gregory Patches for Hardware
// Tessellation", with OpenSubdiv's choices where they differ: edge points of Catmull-Clark that take a
// quarter of an edge vertex's weight for its face vertices, the cross tangents of boundaries, and box spline
// points beside regular edges of triangles.
#include "limn/gregory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace limn {
namespace {

using std::numbers::pi;

constexpr uint32_t kNone = kInvalidIndex;

/// What a corner sees of its vertex's star: faces counter-clockwise, as their corners at the vertex. Around
/// closed sectors from the corner itself; else from an infinitely sharp edge or boundary to the next.
struct Sector {
    std::vector<uint32_t> corners;
    uint32_t own = 0;     ///< which of them is the face's
    bool closed = false;  ///< edge i joins faces i - 1 and i; an open sector has one edge more than faces
    bool sharp = false;   ///< the vertex stays where it is
    bool regular = false;

    uint32_t face_count() const { return static_cast<uint32_t>(corners.size()); }
    double angle() const { return (closed ? 2 : 1) * pi / face_count(); }
    bool next_is_bound() const { return !closed && own == 0; }
    bool previous_is_bound() const { return !closed && own + 1 == face_count(); }
};

/// The corner, at the same vertex, of the face across the edge that begins at `edge_corner`.
uint32_t corner_across(const Topology& t, uint32_t c, uint32_t edge_corner, bool through_sharp) {
    const uint32_t e = t.face_edges[edge_corner];
    const auto corners = t.corners_of_edge(e);
    if (corners.size() != 2 || (!through_sharp && is_infinite(t.edge_sharpness[e]))) return kNone;
    const uint32_t other = corners[0] == edge_corner ? corners[1] : corners[0];
    return t.face_vertices[other] == t.face_vertices[c] ? other : t.next_corner(other);
}

Sector find_sector(const Topology& t, uint32_t corner) {
    const uint32_t v = t.face_vertices[corner];
    uint32_t infinite = 0;
    for (const uint32_t e : t.edges_of_vertex(v)) infinite += is_infinite(t.edge_sharpness[e]);
    const VertexRule rule = t.vertex_rules[v];
    Sector sector;
    // Finite sharpness counts only in that an edge that ends at it is no dart: it then bounds the sector at
    // both ends. Where several sheets meet along a crease, each has its own, whatever else ends there.
    const bool dart = infinite == 1 && rule == VertexRule::dart;
    const bool crease = infinite == 2 || t.vertex_manifold[v] == 0;
    sector.sharp = is_infinite(t.vertex_sharpness[v]) || (infinite != 0 && !dart && !crease);
    const size_t most = t.corners_of_vertex(v).size();
    uint32_t first = corner;
    for (size_t i = 0; i < most; ++i) {
        const uint32_t before = corner_across(t, first, first, dart);
        sector.closed = before == corner;
        if (before == kNone || sector.closed) break;
        first = before;
    }
    if (sector.closed) first = corner;
    uint32_t at = first;
    do {
        if (at == corner) sector.own = sector.face_count();
        sector.corners.push_back(at);
        at = corner_across(t, at, t.previous_corner(at), dart);
    } while (at != kNone && at != first && sector.corners.size() < most);
    const uint32_t regular = t.options.scheme == Scheme::loop ? 6 : 4;
    sector.regular = !sector.sharp && sector.face_count() == (sector.closed ? regular : regular / 2);
    return sector;
}

void add(Row& to, uint32_t index, double weight) {
    for (RowEntry& e : to) {
        if (e.index != index) continue;
        e.weight += weight;
        return;
    }
    to.push_back({index, weight});
}
void add(Row& to, const Row& from, double weight) {
    for (const RowEntry& e : from) add(to, e.index, weight * e.weight);
}

struct PointFinder {
    const Topology& t;
    uint32_t begin, size;  ///< the face's first corner and corner count
    std::array<Sector, 4> sectors;
    std::array<Row, 4> position;
    /// Of the cubic side curves. The quartic sides of triangles are raised from them.
    std::array<Row, 4> edge_plus, edge_minus;

    bool triangles() const { return size == 3; }
    uint32_t next(uint32_t k) const { return k + 1 == size ? 0 : k + 1; }
    uint32_t previous(uint32_t k) const { return (k == 0 ? size : k) - 1; }
    uint32_t vertex(uint32_t k) const { return t.face_vertices[begin + k]; }

    uint32_t edge_vertex(const Sector& s, uint32_t i) const {
        if (!s.closed && i == s.face_count()) return t.face_vertices[t.previous_corner(s.corners[i - 1])];
        return t.face_vertices[t.next_corner(s.corners[i % s.face_count()])];
    }
    /// The vertex opposite in quad i.
    uint32_t face_vertex(const Sector& s, uint32_t i) const {
        const uint32_t c = s.corners[i % s.face_count()];
        return t.face_vertices[t.next_corner(t.next_corner(c))];
    }

    Row find_position(uint32_t k) const {
        const Sector& s = sectors[k];
        const uint32_t n = s.face_count();
        if (s.sharp) return {{vertex(k), 1}};
        Row row;
        if (!s.closed) {
            add(row, vertex(k), 2.0 / 3);
            add(row, edge_vertex(s, 0), 1.0 / 6);
            add(row, edge_vertex(s, n), 1.0 / 6);
            return row;
        }
        std::vector<double> edges(n), faces(n);
        LimitMask mask{0, edges, faces};
        SchemeOptions options = t.options;
        options.opensubdiv_compatible = false;  // also between two faces: the smooth mask
        limit_position_mask(options, {VertexRule::smooth, n, n}, mask);
        add(row, vertex(k), mask.vertex);
        for (uint32_t i = 0; i < n; ++i) {
            add(row, edge_vertex(s, i), edges[i]);
            if (!triangles()) add(row, face_vertex(s, i), faces[i]);
        }
        return row;
    }

    /// What edge point i of a closed smooth sector adds to the position.
    void add_smooth_tangent(const Sector& s, uint32_t i, Row& row) const {
        const uint32_t n = s.face_count();
        const double valence = n, c = std::cos(s.angle());
        const double lambda = (5 + c + std::sqrt((c + 9) * (c + 1))) / 16;
        const double face = 1 / (2 * lambda * valence * (valence + 5));
        const double edge = triangles() ? (1.5 + c) / (3 * valence) : 4 * (1 + c) * face;
        for (uint32_t j = 0; j < n; ++j) {
            const double along = std::cos((j + n - i) % n * s.angle());
            add(row, edge_vertex(s, j), edge * along);
            if (triangles()) continue;
            const double after = std::cos((j + 1 + n - i) % n * s.angle());
            add(row, face_vertex(s, j), face * (along + after));
        }
    }

    /// Across a boundary, scaled to be the edge point's part that sin(angle) weighs.
    void add_cross_tangent(const Sector& s, uint32_t v, double weight, Row& row) const {
        const uint32_t k = s.face_count();
        const double theta = pi / k, c = std::cos(theta), sine = std::sin(theta);
        double bound = 0, own = 0, edge = 0, face = 0;
        if (!triangles()) {
            face = weight / (3 * (3 * k + c));
            edge = 4 * face;
            own = -4 * sine * face;
            bound = -(1 + c) * (1 + 2 * c) / sine * face;
        } else if (k == 3) {
            edge = weight * 2 / 9;
            own = -sine * edge;
            bound = own / 2;
        } else if (k == 2) {
            edge = weight / 8;
            own = -edge;
        } else {
            edge = weight / 4 * (1 - c);
            bound = -weight / 8 * sine;
        }
        add(row, v, own);
        add(row, edge_vertex(s, 0), bound);
        add(row, edge_vertex(s, k), bound);
        for (uint32_t j = 0; j < k; ++j) {
            if (j != 0) add(row, edge_vertex(s, j), edge * std::sin(j * theta));
            if (!triangles())
                add(row, face_vertex(s, j), face * (std::sin(j * theta) + std::sin((j + 1) * theta)));
        }
    }

    /// Along edge i of the sector of corner k.
    Row find_edge_point(uint32_t k, uint32_t i) const {
        const Sector& s = sectors[k];
        const uint32_t n = s.face_count();
        Row row;
        if (s.sharp || (!s.closed && (i == 0 || i == n))) {
            add(row, vertex(k), 2.0 / 3);
            add(row, edge_vertex(s, i), 1.0 / 3);
            return row;
        }
        row = position[k];
        if (s.closed) {
            add_smooth_tangent(s, i, row);
            return row;
        }
        add(row, edge_vertex(s, 0), std::cos(i * s.angle()) / 6);
        add(row, edge_vertex(s, n), -std::cos(i * s.angle()) / 6);
        add_cross_tangent(s, vertex(k), std::sin(i * s.angle()), row);
        return row;
    }

    /// The vertex across the side from corner k to the next of a regular triangle; its reflection where that
    /// side is a boundary.
    Row flank(uint32_t k, bool bound) const {
        if (bound) return {{vertex(k), 1}, {vertex(next(k)), 1}, {vertex(previous(k)), -1}};
        const auto corners = t.corners_of_edge(t.face_edges[begin + k]);
        const uint32_t other = corners[0] == begin + k ? corners[1] : corners[0];
        return {{t.face_vertices[t.previous_corner(other)], 1}};
    }

    /// Both interior points of corner k of a bicubic or box spline patch.
    Row regular_face_point(uint32_t k) const {
        Row row;
        const uint32_t n = next(k), p = previous(k);
        if (triangles()) {
            add(row, vertex(k), 10.0 / 24);
            add(row, vertex(n), 6.0 / 24);
            add(row, vertex(p), 6.0 / 24);
            add(row, flank(k, sectors[k].next_is_bound()), 1.0 / 24);
            add(row, flank(p, sectors[k].previous_is_bound()), 1.0 / 24);
        } else {
            add(row, vertex(k), 4.0 / 9);
            add(row, vertex(n), 2.0 / 9);
            add(row, vertex(p), 2.0 / 9);
            add(row, vertex(next(n)), 1.0 / 9);
        }
        return row;
    }

    /// f+ (`plus`) or f- of corner k, beside a side that does not bound the corner's sector.
    Row face_point(uint32_t k, bool plus) const {
        const Sector& s = sectors[k];
        const uint32_t other = plus ? next(k) : previous(k), n = s.face_count();
        if (s.regular && sectors[other].regular) return regular_face_point(k);
        const double c0 = std::cos(s.angle()), c1 = std::cos(sectors[other].angle());
        const double d = triangles() ? 4 : 3;
        Row row;
        add(row, position[k], c1 / d);
        add(row, plus ? edge_plus[k] : edge_minus[k], (d - 2 * c0 - c1) / d);
        add(row, plus ? edge_minus[other] : edge_plus[other], 2 * c0 / d);
        // Across the side, from the edge vertex beyond it to the one within the face.
        const uint32_t inside = plus ? s.own + 1 : s.own;
        const uint32_t beyond = plus ? (s.own == 0 ? n : s.own) - 1 : s.own + 2;
        const double weight = triangles() ? 7.0 / 72 : 1.0 / 9;
        add(row, edge_vertex(s, inside), weight);
        add(row, edge_vertex(s, beyond), -weight);
        if (triangles()) return row;
        add(row, face_vertex(s, s.own), weight / 2);
        add(row, face_vertex(s, plus ? s.own + n - 1 : s.own + 1), -weight / 2);
        return row;
    }

    /// Of the quartic side from corner k to the next. Where one end is a dart of the crease that bounds the
    /// other's sector, their cubics differ and none is the box spline's.
    Row side_midpoint(uint32_t k) const {
        Row row;
        const uint32_t n = next(k);
        const bool bound = sectors[k].next_is_bound() || sectors[n].previous_is_bound();
        if (sectors[k].regular && sectors[n].regular && !bound) {
            add(row, vertex(k), 1.0 / 3);
            add(row, vertex(n), 1.0 / 3);
            add(row, vertex(previous(k)), 1.0 / 6);
            add(row, flank(k, false), 1.0 / 6);
        } else {
            add(row, edge_plus[k], 0.5);
            add(row, edge_minus[n], 0.5);
        }
        return row;
    }

    void raise(uint32_t k, Row& row) const {
        for (RowEntry& e : row) e.weight *= 0.75;
        add(row, position[k], 0.25);
    }

    void find(GregoryPoints& out) {
        for (uint32_t k = 0; k < size; ++k) {
            sectors[k] = find_sector(t, begin + k);
            position[k] = find_position(k);
            const Sector& s = sectors[k];
            edge_plus[k] = find_edge_point(k, s.own);
            edge_minus[k] = find_edge_point(k, s.closed ? (s.own + 1) % s.face_count() : s.own + 1);
        }
        out.count = triangles() ? 18 : 20;
        for (uint32_t k = 0; k < size; ++k) {
            Row* points = &out.points[5 * k];
            points[0] = position[k];
            points[1] = edge_plus[k];
            points[2] = edge_minus[k];
            // Where one side is a boundary, only the other has a face beyond to join smoothly.
            const bool next_bound = sectors[k].next_is_bound(),
                       previous_bound = sectors[k].previous_is_bound();
            if (next_bound && previous_bound) {
                points[3] = points[4] = regular_face_point(k);
            } else {
                points[3] = face_point(k, !next_bound);
                points[4] = face_point(k, previous_bound);
            }
            if (!triangles()) continue;
            raise(k, points[1]);
            raise(k, points[2]);
            out.points[15 + k] = side_midpoint(k);
        }
    }
};

bool own_size_around(const Topology& t, uint32_t v, uint32_t size) {
    if (t.face_size != 0) return t.face_size == size;
    const auto corners = t.corners_of_vertex(v);
    return std::all_of(corners.begin(), corners.end(),
                       [&](uint32_t c) { return t.size_of_face(t.face_of_corner(c)) == size; });
}

}  // namespace

bool find_gregory_points(const Topology& t, uint32_t face, GregoryPoints& out) {
    if (t.options.scheme == Scheme::bilinear) return false;
    const uint32_t size = t.options.scheme == Scheme::loop ? 3 : 4, begin = t.face_begin(face);
    if (t.size_of_face(face) != size) return false;
    for (const uint32_t v : t.vertices_of_face(face))
        if (!own_size_around(t, v, size) || t.find_dependent(v) != Topology::kNotDependent) return false;
    PointFinder{t, begin, size, {}, {}, {}, {}}.find(out);
    return true;
}

}  // namespace limn
