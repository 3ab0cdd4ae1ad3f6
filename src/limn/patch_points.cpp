#include "limn/patch_points.h"

#include <algorithm>
#include <cassert>

#include "limn/parallel.h"

namespace limn {
namespace {

constexpr int kNone = -1;

/// Corners of v's other faces, one step on around v: across the edge that ends, or begins, at corner c.
int corner_across(const Topology& t, uint32_t c, uint32_t edge_corner) {
    const uint32_t e = t.face_edges[edge_corner];
    const auto corners = t.corners_of_edge(e);
    if (corners.size() != 2 || is_infinite(t.edge_sharpness[e])) return kNone;
    const uint32_t other = corners[0] == edge_corner ? corners[1] : corners[0];
    const uint32_t v = t.face_vertices[c];
    if (t.face_vertices[other] == v) return static_cast<int>(other);
    return static_cast<int>(t.next_corner(other));
}
int corner_after(const Topology& t, uint32_t c) {
    return corner_across(t, c, t.previous_corner(c));
}
int corner_before(const Topology& t, uint32_t c) {
    return corner_across(t, c, c);
}

enum class CornerKind : uint8_t { irregular, smooth, crease, corner };

struct Corner {
    CornerKind kind = CornerKind::irregular;
    bool sharp_next = false, sharp_previous = false;  ///< the face's edges from and to here
    float crease = 0;                                 ///< of a semi-sharp crease that passes straight through
};

uint32_t sector_size(const Topology& t, uint32_t c, uint32_t most) {
    uint32_t size = 1;
    for (int at = corner_after(t, c); at != kNone && at != static_cast<int>(c) && size <= most; ++size)
        at = corner_after(t, static_cast<uint32_t>(at));
    for (int at = corner_before(t, c); at != kNone && at != static_cast<int>(c) && size <= most; ++size)
        at = corner_before(t, static_cast<uint32_t>(at));
    return size;
}

/// Begins and ends at the same edge, where faces meet that are no single fan.
bool is_folded_sector(const Topology& t, uint32_t c) {
    uint32_t first = c, last = c;
    const auto most = static_cast<uint32_t>(t.corners_of_vertex(t.face_vertices[c]).size());
    for (uint32_t i = 0; i < most; ++i) {
        const int before = corner_before(t, first), after = corner_after(t, last);
        if (before != kNone) first = static_cast<uint32_t>(before);
        if (after != kNone) last = static_cast<uint32_t>(after);
    }
    return t.face_edges[first] == t.face_edges[t.previous_corner(last)];
}

bool own_size_around(const Topology& t, uint32_t v, uint32_t size) {
    if (t.face_size != 0) return t.face_size == size;
    for (const uint32_t c : t.corners_of_vertex(v))
        if (t.size_of_face(t.face_of_corner(c)) != size) return false;
    return true;
}

Corner classify(const Topology& t, uint32_t c) {
    Corner corner;
    const bool triangles = t.options.scheme == Scheme::loop;
    const uint32_t v = t.face_vertices[c];
    const auto edges = t.edges_of_vertex(v);
    const size_t valence = triangles ? 6 : 4;
    if (!own_size_around(t, v, triangles ? 3 : 4) || t.find_dependent(v) != Topology::kNotDependent)
        return corner;
    uint32_t infinite = 0, finite = 0;
    for (const uint32_t e : edges) {
        infinite += is_infinite(t.edge_sharpness[e]);
        finite += t.edge_sharpness[e] > 0 && !is_infinite(t.edge_sharpness[e]);
    }
    corner.sharp_next = is_infinite(t.edge_sharpness[t.face_edges[c]]);
    corner.sharp_previous = is_infinite(t.edge_sharpness[t.face_edges[t.previous_corner(c)]]);
    const bool closed = t.vertex_manifold[v] != 0 && edges.size() == t.corners_of_vertex(v).size();
    const VertexRule rule = t.vertex_rules[v];
    if (rule == VertexRule::smooth && finite + infinite == 0 && closed && edges.size() == valence) {
        corner.kind = CornerKind::smooth;
    } else if (rule == VertexRule::crease && finite == 0 && infinite == 2) {
        if (sector_size(t, c, 3) == valence / 2 && !is_folded_sector(t, c)) corner.kind = CornerKind::crease;
    } else if (rule == VertexRule::corner && finite == 0 &&
               (is_infinite(t.vertex_sharpness[v]) || infinite > 2)) {
        if (corner.sharp_next && corner.sharp_previous) corner.kind = CornerKind::corner;
    } else if (rule == VertexRule::crease && !triangles && finite == 2 && infinite == 0 && closed &&
               edges.size() == 4) {
        const float a = t.edge_sharpness[edges[0]], b = t.edge_sharpness[edges[1]];
        const bool straight = a == t.edge_sharpness[edges[2]] && b == t.edge_sharpness[edges[3]];
        if (straight) {
            corner.kind = CornerKind::smooth;
            corner.crease = a > 0 ? a : b;
        }
    }
    return corner;
}

void add(PatchPoint& to, const PatchPoint& from, double weight) {
    for (const RowEntry& e : from) {
        uint32_t i = 0;
        while (i < to.count && to.entries[i].index != e.index) ++i;
        if (i == to.count) {
            assert(i < PatchPoint::kMaxEntries);
            to.entries[to.count++] = {e.index, 0};
        }
        to.entries[i].weight += weight * e.weight;
    }
}
PatchPoint vertex(uint32_t v) {
    PatchPoint point;
    point.entries[0] = {v, 1};
    point.count = 1;
    return point;
}
PatchPoint twice_less(const PatchPoint& a, const PatchPoint& b) {
    PatchPoint point;
    add(point, a, 2);
    add(point, b, -1);
    return point;
}
/// a + b - c.
PatchPoint parallelogram(const PatchPoint& a, const PatchPoint& b, const PatchPoint& c) {
    PatchPoint point;
    add(point, a, 1);
    add(point, b, 1);
    add(point, c, -1);
    return point;
}
PatchPoint vertex_at(const Topology& t, uint32_t corner, uint32_t steps) {
    for (; steps != 0; --steps) corner = t.next_corner(corner);
    return vertex(t.face_vertices[corner]);
}

uint32_t other_corner(const Topology& t, uint32_t c) {
    const auto corners = t.corners_of_edge(t.face_edges[c]);
    return corners[0] == c ? corners[1] : corners[0];
}

/// Where the corners of a quad stand in its 4 by 4 net, u being columns, and the way out across the edge that begins there.
constexpr int kNetCorner[4] = {5, 6, 10, 9}, kNetAway[4] = {-4, 1, 4, -1};

PatchPoint& net_point(PatchPoints& patch, int i) {
    return patch.points[static_cast<size_t>(i)];
}

/// Fills in what lies beyond sharp edges of a net, from the points within.
void extrapolate_net(uint32_t sharp_edges, PatchPoints& patch) {
    if (sharp_edges == 0) return;
    const auto point = [&](int i) -> PatchPoint& { return net_point(patch, i); };
    const auto is_sharp = [&](uint32_t k) { return (sharp_edges >> (k & 3) & 1) != 0; };
    for (uint32_t k = 0; k < 4; ++k) {
        if (!is_sharp(k)) continue;
        const int a = kNetCorner[k], b = kNetCorner[(k + 1) & 3], d = kNetAway[k];
        point(a + d) = twice_less(point(a), point(a - d));
        point(b + d) = twice_less(point(b), point(b - d));
    }
    for (uint32_t k = 0; k < 4; ++k) {
        const int a = kNetCorner[k], d = kNetAway[k], e = kNetAway[(k + 3) & 3];
        if (is_sharp(k))
            point(a + d + e) = twice_less(point(a + e), point(a + e - d));
        else if (is_sharp(k + 3))
            point(a + d + e) = twice_less(point(a + d), point(a + d - e));
    }
}

/// The net around a quad.
void fill_quad(const Topology& t, uint32_t face, const Corner (&corners)[4], PatchPoints& out) {
    const uint32_t begin = t.face_begin(face);
    uint32_t sharp_edges = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const int a = kNetCorner[k], b = kNetCorner[(k + 1) & 3], d = kNetAway[k];
        net_point(out, a) = vertex(t.face_vertices[begin + k]);
        sharp_edges |= uint32_t{corners[k].sharp_next} << k;
        if (!corners[k].sharp_next) {
            const uint32_t c = other_corner(t, begin + k);
            net_point(out, a + d) = vertex_at(t, c, 2);
            net_point(out, b + d) = vertex_at(t, c, 3);
        }
        if (corners[k].sharp_next || corners[k].sharp_previous) continue;
        const int beside = corner_before(t, begin + k);
        const int opposite = corner_before(t, static_cast<uint32_t>(beside));
        net_point(out, a + d + kNetAway[(k + 3) & 3]) = vertex_at(t, static_cast<uint32_t>(opposite), 2);
    }
    out.sharp_edges = sharp_edges;
    extrapolate_net(sharp_edges, out);
}

/// Where the 12 points stand: rows of 3, 4, 3, 2 from v = -1, each from the smallest u.
int lattice_index(int u, int v) {
    constexpr int first[4] = {0, 3, 7, 10}, least[4] = {0, -1, -1, -1};
    return first[v + 1] + u - least[v + 1];
}

void fill_triangle(const Topology& t, uint32_t face, const Corner (&corners)[4], PatchPoints& out) {
    constexpr int du[6] = {1, 0, -1, -1, 0, 1}, dv[6] = {0, 1, 1, 0, -1, -1};
    constexpr int u[3] = {0, 1, 0}, v[3] = {0, 0, 1};
    const uint32_t begin = t.face_begin(face);
    auto point = [&](uint32_t k, uint32_t turn) -> PatchPoint& {
        const uint32_t d = (2 * k + turn) % 6;
        return out.points[static_cast<size_t>(lattice_index(u[k] + du[d], v[k] + dv[d]))];
    };
    auto own = [&](uint32_t k) -> PatchPoint& {
        return out.points[static_cast<size_t>(lattice_index(u[k], v[k]))];
    };
    for (uint32_t k = 0; k < 3; ++k) own(k) = vertex(t.face_vertices[begin + k]);
    for (uint32_t k = 0; k < 3; ++k)
        point(k, 5) = corners[k].sharp_next ? parallelogram(own(k), own((k + 1) % 3), own((k + 2) % 3))
                                            : vertex_at(t, other_corner(t, begin + k), 2);
    for (uint32_t k = 0; k < 3; ++k) {
        const PatchPoint &p = own(k), &n0 = point(k, 0), &n1 = point(k, 1), &n2 = point(k, 2),
                         &n5 = point(k, 5);
        PatchPoint &n3 = point(k, 3), &n4 = point(k, 4);
        const int after = corner_after(t, begin + k), before = corner_before(t, begin + k);
        if (corners[k].kind == CornerKind::corner) {
            n3 = twice_less(p, n0);
            n4 = twice_less(p, n1);
            continue;
        }
        // One face further on each side, where it belongs to this side of a crease.
        const int after2 = after == kNone ? kNone : corner_after(t, static_cast<uint32_t>(after));
        const int before2 = before == kNone ? kNone : corner_before(t, static_cast<uint32_t>(before));
        const bool real3 = after2 != kNone, real4 = before2 != kNone;
        if (real3) n3 = vertex_at(t, static_cast<uint32_t>(after2), 2);
        if (real4) n4 = vertex_at(t, static_cast<uint32_t>(before2), 1);
        if (real3 && !real4) n4 = parallelogram(p, n3, n2);
        if (real4 && !real3) n3 = parallelogram(p, n4, n5);
        if (!real3 && !real4) {
            n3 = parallelogram(p, n2, n1);
            n4 = parallelogram(p, n5, n0);
        }
    }
}

/// Smooth, closed, of this valence.
bool is_plain_vertex(const Topology& t, uint32_t v, size_t valence) {
    const uint32_t first = t.vertex_edge_offsets[v];
    if (t.vertex_rules[v] != VertexRule::smooth || t.vertex_manifold[v] == 0) return false;
    if (t.vertex_edge_offsets[v + 1] - first != valence || t.corners_of_vertex(v).size() != valence)
        return false;
    return own_size_around(t, v, valence == 6 ? 3 : 4) && t.find_dependent(v) == Topology::kNotDependent;
}

}  // namespace

PatchPoints make_quad_patch(const QuadNet& net, const QuadPattern& pattern) {
    PatchPoints patch;
    patch.count = 16;
    patch.crease_sharpness = pattern.crease_sharpness;
    patch.crease_edge = pattern.crease_edge;
    patch.sharp_edges = pattern.sharp_edges;
    for (uint32_t k = 0; k < 16; ++k) patch.points[k] = vertex(net[k]);
    extrapolate_net(pattern.sharp_edges, patch);
    return patch;
}

QuadPattern read_quad_patch(const PatchPoints& patch, QuadNet& net) {
    const QuadPattern pattern{patch.sharp_edges, patch.crease_sharpness, patch.crease_edge};
    for (uint32_t k = 0; k < 16; ++k)
        net[k] = pattern.is_outside(k) ? kInvalidIndex : patch.points[k].entries[0].index;
    return pattern;
}

uint32_t turn_quad_patch(QuadNet& net, QuadPattern& pattern) {
    const uint32_t sharp = pattern.sharp_edges | uint32_t{pattern.crease_sharpness > 0} << pattern.crease_edge;
    uint32_t turn = 0;
    while (turn < 4 && !((sharp >> turn & 1) != 0 && (sharp >> ((turn + 3) & 3) & 1) == 0)) ++turn;
    turn &= 3;
    if (turn == 0) return 0;
    const QuadNet old = net;
    for (uint32_t v = 0; v < 4; ++v)
        for (uint32_t u = 0; u < 4; ++u) {
            const uint32_t from[4] = {4 * v + u, 4 * u + (3 - v), 4 * (3 - v) + (3 - u), 4 * (3 - u) + v};
            net[4 * v + u] = old[from[turn]];
        }
    pattern.sharp_edges = (pattern.sharp_edges >> turn | pattern.sharp_edges << (4 - turn)) & 15;
    if (pattern.crease_sharpness > 0) pattern.crease_edge = (pattern.crease_edge + 4 - turn) & 3;
    return turn;
}

bool is_regular_corner(const Topology& t, uint32_t c) {
    return classify(t, c).kind != CornerKind::irregular;
}

std::vector<uint8_t> find_regular_vertices(const Topology& t, const BuildPart& part) {
    std::vector<uint8_t> regular(t.vertex_count);
    const size_t valence = t.options.scheme == Scheme::loop ? 6 : 4;
    for_each_index(t.vertex_count, part, [&](uint32_t v) { regular[v] = is_plain_vertex(t, v, valence); });
    return regular;
}

uint32_t write_regular_ring(const Topology& t, uint32_t face, bool linear, uint32_t (&ring)[16]) {
    const bool triangles = t.options.scheme == Scheme::loop;
    const uint32_t size = triangles ? 3 : 4, begin = t.face_begin(face);
    if (linear) {
        std::copy_n(t.face_vertices.begin() + begin, size, ring);
        return size;
    }
    // Corner k stands at `at`; the walk around it leads from one of the face's edges to the other.
    constexpr uint32_t quad_at[4] = {5, 6, 10, 9},
                       quad_away[4][3] = {{4, 0, 1}, {2, 3, 7}, {11, 15, 14}, {13, 12, 8}};
    constexpr uint32_t triangle_at[3] = {4, 5, 8},
                       triangle_away[3][4] = {{7, 3, 0, 1}, {1, 2, 6, 9}, {9, 11, 10, 7}};
    for (uint32_t k = 0; k < size; ++k) {
        ring[triangles ? triangle_at[k] : quad_at[k]] = t.face_vertices[begin + k];
        const auto star = t.corners_of_vertex(t.face_vertices[begin + k]);
        const auto own = static_cast<size_t>(std::find(star.begin(), star.end(), begin + k) - star.begin());
        if (triangles) {
            // The last vertices of the faces that follow around the corner.
            for (uint32_t i = 0; i < 4; ++i)
                ring[triangle_away[k][i]] = t.face_vertices[t.previous_corner(star[(own + 1 + i) % 6])];
        } else {
            const uint32_t c = star[(own + 2) & 3];  // of the face across the corner
            const uint32_t first = t.face_begin(t.face_of_corner(c));
            for (uint32_t i = 0; i < 3; ++i)
                ring[quad_away[k][i]] = t.face_vertices[first + ((c - first + 1 + i) & 3)];
        }
    }
    return triangles ? 12 : 16;
}

std::vector<uint32_t> faces_of_sector(const Topology& t, uint32_t c) {
    std::vector<uint32_t> faces(1, t.face_of_corner(c));
    const size_t most = t.corners_of_vertex(t.face_vertices[c]).size();
    const auto start = static_cast<int>(c);
    int at = corner_after(t, c);
    for (; at != kNone && at != start && faces.size() < most; at = corner_after(t, static_cast<uint32_t>(at)))
        faces.push_back(t.face_of_corner(static_cast<uint32_t>(at)));
    if (at == start) return faces;
    for (at = corner_before(t, c); at != kNone && faces.size() < most;
         at = corner_before(t, static_cast<uint32_t>(at)))
        faces.push_back(t.face_of_corner(static_cast<uint32_t>(at)));
    return faces;
}

bool find_patch_points(const Topology& t, uint32_t face, bool linear, PatchPoints& out) {
    const uint32_t size = t.options.scheme == Scheme::loop ? 3 : 4, begin = t.face_begin(face);
    if (t.size_of_face(face) != size) return false;
    out.crease_sharpness = 0;
    out.crease_edge = 0;
    out.sharp_edges = 0;
    if (linear) {
        out.kind = size == 3 ? PlanNodeKind::linear : PlanNodeKind::bilinear;
        out.count = size;
        for (uint32_t k = 0; k < size; ++k) out.points[k] = vertex(t.face_vertices[begin + k]);
        return true;
    }
    Corner corners[4];
    for (uint32_t k = 0; k < size; ++k) {
        corners[k] = classify(t, begin + k);
        if (corners[k].kind == CornerKind::irregular) return false;
    }
    for (uint32_t k = 0; k < size; ++k) {
        const float sharpness = t.edge_sharpness[t.face_edges[begin + k]];
        const float here = corners[k].crease;
        if (sharpness > 0 && !is_infinite(sharpness)) {
            if (out.crease_sharpness > 0) return false;
            if (here != sharpness || corners[(k + 1) & 3].crease != sharpness) return false;
            out.crease_sharpness = sharpness;
            out.crease_edge = k;
        }
    }
    for (uint32_t k = 0; k < size; ++k) {
        const bool on_crease =
            out.crease_sharpness > 0 && (k == out.crease_edge || k == ((out.crease_edge + 1) & 3));
        if (on_crease != (corners[k].crease > 0)) return false;
        if (out.crease_sharpness > 0 && (corners[k].sharp_next || corners[k].sharp_previous)) return false;
    }
    out.kind = size == 3 ? PlanNodeKind::box_spline : PlanNodeKind::bicubic;
    out.count = size == 3 ? 12 : 16;
    if (size == 3)
        fill_triangle(t, face, corners, out);
    else
        fill_quad(t, face, corners, out);
    return true;
}

}  // namespace limn
