// Biermann, Levin and Zorin 2000, "Piecewise smooth subdivision surfaces with normal control": Catmull-Clark and Loop
// with rules beside boundaries and infinitely sharp creases that make the surface smooth up to them whatever the number
// of faces, and corners that are convex or concave. Stage::intervals: the angle of each face corner in radians, of
// which a corner vertex adds those of the faces between two creases; without them that sum is a right angle. Above pi
// it is concave: the points around are drawn half way into the tangent plane (their flatness, whose value is a
// reconstruction). Prescribed normals are left out. While creases are semi-sharp they follow DeRose, Kass and Truong.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

constexpr double kFlatness = 0.5;  ///< brings every other eigenvalue below the two of the tangent plane, 1/2

/// The faces around a vertex between two edges that stay sharp, counter-clockwise.
struct Sector {
    uint32_t first_edge, faces;  ///< a position among the vertex's edges; how many faces
    double angle;                ///< theta: of one of the faces in the tangent plane
    bool concave;                ///< of a corner
};

bool stays_sharp(const Topology& t, uint32_t e) {
    return is_infinite(t.edge_sharpness[e]);
}

/// Of a corner's sector. Concave ones keep away from pi and 2 pi, where two creases span no plane.
double corner_angle(const Stage& p, uint32_t v, uint32_t first, uint32_t faces) {
    constexpr double pi = std::numbers::pi;
    if (p.intervals.empty()) return pi / 2;
    const auto corners = p.topology.corners_of_vertex(v);
    double sum = 0;
    for (uint32_t i = 0; i < faces; ++i) sum += p.intervals[corners[(first + i) % corners.size()]];
    return sum > pi ? std::clamp(sum, 1.05 * pi, 1.95 * pi) : sum;
}

/// The sector around v that has corner i of its faces; none where fewer than two edges stay sharp.
std::optional<Sector> find_sector(const Stage& p, uint32_t v, uint32_t i) {
    const Topology& t = p.topology;
    const auto edges = t.edges_of_vertex(v);
    const auto n = static_cast<uint32_t>(edges.size());
    uint32_t sharp = 0;
    for (const uint32_t e : edges) sharp += stays_sharp(t, e);
    if (sharp < 2 || t.vertex_manifold[v] == 0) return {};
    uint32_t before = 0, faces = 1;
    while (!stays_sharp(t, edges[(i + n - before) % n])) ++before;
    while (!stays_sharp(t, edges[(i + faces) % n])) ++faces;
    faces += before;
    const uint32_t first = (i + n - before) % n;
    const bool corner = sharp > 2 || is_infinite(t.vertex_sharpness[v]);
    const double angle = corner ? corner_angle(p, v, first, faces) : std::numbers::pi;
    return Sector{first, faces, angle / faces, angle > std::numbers::pi};
}

/// Appends weight times the tangent plane's point in direction `at` of a concave corner's sector: how far the ray of
/// edge `at` reaches along both creases, whose points lie half way.
void add_plane_point(const Topology& t, uint32_t v, const Sector& sector, uint32_t at, double weight, Row& row) {
    const uint32_t n = edge_valence(t, v);
    const double whole = std::sin(sector.faces * sector.angle);
    const double first = std::sin((sector.faces - at) * sector.angle) / whole / 2;
    const double last = std::sin(at * sector.angle) / whole / 2;
    add(row, v, -weight * (first + last));
    add(row, neighbor(t, v, sector.first_edge), weight * first);
    add(row, neighbor(t, v, (sector.first_edge + sector.faces) % n), weight * last);
}

/// Of a smooth edge: its end at a crease or corner, with the sector; none where both ends are or none is.
struct SharpEnd {
    uint32_t vertex, position;
    Sector sector;
};
std::optional<SharpEnd> find_sharp_end(const Stage& p, uint32_t e) {
    const Topology& t = p.topology;
    std::optional<SharpEnd> found;
    for (uint32_t end = 0; end < 2; ++end) {
        const uint32_t v = t.edge_vertices[2 * e + end], i = edge_position(t, v, e);
        if (i == edge_valence(t, v)) return {};
        const auto sector = find_sector(p, v, i);
        if (sector && found) return {};
        if (sector) found = SharpEnd{v, i, *sector};
    }
    return found;
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    const auto end = t.edge_sharpness[e] > 0 ? std::nullopt : find_sharp_end(p, e);
    if (!end) return refined_edge(p, e, row);
    const uint32_t v = end->vertex;
    const Sector& sector = end->sector;
    const double gamma = (t.options.scheme == Scheme::loop ? 0.5 : 0.375) - std::cos(sector.angle) / 4;
    const double shape = sector.concave ? 1 - kFlatness : 1;
    add_scaled(row, shape, [&] {
        refined_edge(p, e, row);
        add(row, v, 0.375 - gamma);
        add(row, t.other_vertex(e, v), gamma - 0.375);
    });
    if (!sector.concave) return;
    const uint32_t n = edge_valence(t, v);
    add(row, v, kFlatness);
    add_plane_point(t, v, sector, (end->position + n - sector.first_edge) % n, kFlatness, row);
}

/// Faces of one concave corner: their points lie where a step's parallelogram of edge points has them.
void face_row(const Stage& p, uint32_t f, Row& row) {
    const Topology& t = p.topology;
    uint32_t concave = 0, vertex = 0, at = 0;
    Sector sector = {};
    for (uint32_t c = t.face_begin(f); c < t.face_begin(f) + t.size_of_face(f); ++c) {
        const uint32_t v = t.face_vertices[c], i = edge_position(t, v, t.face_edges[c]);
        const auto found = find_sector(p, v, i);
        if (!found || !found->concave) continue;
        ++concave;
        vertex = v;
        sector = *found;
        at = (i + edge_valence(t, v) - sector.first_edge) % edge_valence(t, v);
    }
    if (concave != 1) return face_centroid(p, f, row);
    add_centroid(t, f, 1 - kFlatness, row);
    add(row, vertex, kFlatness);
    add_plane_point(t, vertex, sector, at, kFlatness, row);
    add_plane_point(t, vertex, sector, at + 1, kFlatness, row);
}

/// Vertices keep the angles of their corners.
void keep_angles(const Stage& p, Stage& child) {
    const Topology &t = p.topology, &u = child.topology;
    child.intervals.assign(u.corner_count(), 0);
    for (uint32_t v = 0; v < t.vertex_count; ++v) {
        const auto before = t.corners_of_vertex(v), after = u.corners_of_vertex(v);
        for (size_t i = 0; i < before.size(); ++i) child.intervals[after[i]] = p.intervals[before[i]];
    }
}

}  // namespace

std::span<const Pass> catmull_clark_blz_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {refined_vertex, face_row, edge_row}, keep_angles}};
    return passes;
}
std::span<const Pass> loop_blz_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {refined_vertex, nullptr, edge_row}, keep_angles}};
    return passes;
}

}  // namespace limn::schemes
