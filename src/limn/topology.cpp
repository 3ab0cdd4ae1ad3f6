#include "limn/topology.h"

#include <algorithm>
#include <vector>

#include "limn/parallel.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// For each corner, the corner at which its edge appears first; edges[c] == c where an edge is new. Corners
/// of one vertex pair join the pair's first edge, unless that edge's latest face is their own: then they
/// start another one. `non_manifold` marks first corners of edges that join more than two faces, faces of
/// opposite winding, or nothing.
void find_first_corners(const Topology& t, Array<uint32_t>& first, Array<uint8_t>& non_manifold,
                        const BuildPart& part) {
    const uint32_t corners = t.corner_count();
    auto low = [&](uint32_t c) { return std::min(t.face_vertices[c], t.face_vertices[t.next_corner(c)]); };
    auto high = [&](uint32_t c) { return std::max(t.face_vertices[c], t.face_vertices[t.next_corner(c)]); };
    first.allocate(corners);
    non_manifold.assign(corners, 0);
    Array<uint32_t> offsets, members;
    group_by(corners, t.vertex_count, low, offsets, members, part.part(0, 0.5f));
    for_each_index(t.vertex_count, part.part(0.5f, 1), [&](uint32_t v) {
        uint32_t* begin = members.data() + offsets[v];
        uint32_t* end = members.data() + offsets[v + 1];
        std::sort(begin, end, [&](uint32_t a, uint32_t b) {
            const uint32_t ha = high(a), hb = high(b);
            return ha != hb ? ha < hb : a < b;
        });
        for (uint32_t* run = begin; run != end;) {
            const uint32_t head = *run, other = high(head);
            uint32_t face_count = 1, last_face = t.face_of_corner(head);
            first[head] = head;
            if (other == v) non_manifold[head] = 1;
            for (++run; run != end && high(*run) == other; ++run) {
                const uint32_t c = *run, face = t.face_of_corner(c);
                if (other == v) {  // degenerate edges are never shared
                    first[c] = c;
                    non_manifold[c] = 1;
                } else if (face == last_face) {
                    first[c] = c;
                    non_manifold[head] = non_manifold[c] = 1;
                } else {
                    first[c] = head;
                    if (face_count > 1 || t.face_vertices[c] == t.face_vertices[head]) non_manifold[head] = 1;
                    ++face_count;
                    last_face = face;
                }
            }
        }
    });
}

/// Walks counter-clockwise around v and reorders its corners and edges. False, leaving them as they are, when
/// its faces do not form one fan.
bool order_star(Topology& t, uint32_t v, std::vector<uint32_t>& corners, std::vector<uint32_t>& edges) {
    const auto old_corners = t.corners_of_vertex(v);
    const auto old_edges = t.edges_of_vertex(v);
    const size_t corner_count = old_corners.size(), edge_count = old_edges.size();
    if (corner_count == 0 || edge_count < 2 || edge_count > corner_count + 1) return false;
    uint32_t corner = old_corners[0];
    if (edge_count != corner_count) {
        corner = kInvalidIndex;
        for (const uint32_t e : old_edges) {
            const auto at = t.corners_of_edge(e);
            if (at.size() == 1 && t.face_vertices[at[0]] == v) corner = at[0];
            if (corner != kInvalidIndex) break;
        }
        if (corner == kInvalidIndex) return false;
    }
    corners.assign(1, corner);
    edges.assign(1, t.face_edges[corner]);
    while (edges.size() < edge_count) {
        const uint32_t next = t.face_edges[t.previous_corner(corner)];
        if (next == edges.back() || next == edges.front()) return false;
        edges.push_back(next);
        if (corners.size() == corner_count) continue;
        const auto at = t.corners_of_edge(next);
        if (at.size() != 2) return false;
        corner = t.face_vertices[at[0]] == v ? at[0] : at[1];
        corners.push_back(corner);
    }
    if (corners.size() != corner_count) return false;
    std::copy(corners.begin(), corners.end(), t.vertex_corners.begin() + t.vertex_corner_offsets[v]);
    std::copy(edges.begin(), edges.end(), t.vertex_edges.begin() + t.vertex_edge_offsets[v]);
    return true;
}

void hide_boundary_faces(Topology& t, const BuildPart& part) {
    for_each_in_order(t.vertex_count, part, [&](uint32_t v) {
        if (!hides_faces(t, v, [&](uint32_t e) { return t.edge_sharpness[e]; })) return;
        for (const uint32_t c : t.corners_of_vertex(v)) t.face_holes[t.face_of_corner(c)] = 1;
    });
}

}  // namespace

uint32_t find_edge(const Topology& t, uint32_t a, uint32_t b) {
    if (t.edges_of_vertex(b).size() < t.edges_of_vertex(a).size()) std::swap(a, b);
    for (const uint32_t e : t.edges_of_vertex(a)) {
        const uint32_t p = t.edge_vertices[2 * e], q = t.edge_vertices[2 * e + 1];
        if ((p == a && q == b) || (p == b && q == a)) return e;
    }
    return kInvalidIndex;
}

void sharpen_vertex(Topology& t, uint32_t v, const Array<uint8_t>& non_manifold_edges) {
    uint32_t sharp = 0, boundary = 0, non_manifold = 0;
    const auto edges = t.edges_of_vertex(v);
    for (const uint32_t e : edges) {
        sharp += t.edge_sharpness[e] > 0;
        boundary += t.corners_of_edge(e).size() < 2;
        non_manifold += non_manifold_edges[e];
    }
    const size_t faces = t.corners_of_vertex(v).size();
    const bool single_face = faces == 1 && edges.size() == 2;
    const bool corner = single_face && t.options.boundary == BoundaryInterpolation::edge_and_corner;
    // A crease where several sheets meet along two opposite edges stays a crease.
    const bool sheets = non_manifold == 2 && boundary == 0 && faces > edges.size();
    if (corner || (t.vertex_manifold[v] == 0 && !sheets)) t.vertex_sharpness[v] = kInfiniteSharpness;
    t.vertex_rules[v] = vertex_rule(t.vertex_sharpness[v], sharp);
}

void assign_sharpness(const ControlMesh& mesh, Topology& t, const Array<uint8_t>& non_manifold_edges,
                      const BuildPart& part) {
    t.edge_sharpness.assign(t.edge_count, 0.0f);
    t.vertex_sharpness.assign(t.vertex_count, 0.0f);
    t.vertex_rules.allocate(t.vertex_count);
    t.face_holes.assign(t.face_count, 0);
    const bool knows_sharpness = t.options.scheme != Scheme::doo_sabin;
    const auto creases = knows_sharpness ? static_cast<uint32_t>(mesh.crease_sharpness.size()) : 0;
    for_each_in_order(creases, part.part(0, 0.3f), [&](uint32_t i) {
        const uint32_t e = find_edge(t, mesh.crease_edges[2 * size_t{i}], mesh.crease_edges[2 * size_t{i} + 1]);
        if (e != kInvalidIndex) t.edge_sharpness[e] = clamp_sharpness(mesh.crease_sharpness[i]);
    });
    for (size_t i = 0; knows_sharpness && i < mesh.corner_vertices.size(); ++i)
        t.vertex_sharpness[mesh.corner_vertices[i]] = clamp_sharpness(mesh.corner_sharpness[i]);
    for (const uint32_t f : mesh.holes) t.face_holes[f] = 1;
    if (hides_boundary_faces(t.options)) hide_boundary_faces(t, part.part(0.3f, 0.4f));
    for_each_index(t.edge_count, part.part(0.4f, 0.6f), [&](uint32_t e) {
        if (is_always_infinite(t, e, non_manifold_edges)) t.edge_sharpness[e] = kInfiniteSharpness;
    });
    for_each_index(t.vertex_count, part.part(0.6f, 0.9f),
                   [&](uint32_t v) { sharpen_vertex(t, v, non_manifold_edges); }, 256);
    build_half_edge_sharpness(t, part.part(0.95f, 1));
}

namespace {

/// Edges and stars of whatever faces there are.
void build_any_incidence(Topology& t, Array<uint8_t>& non_manifold_edges, const BuildPart& part) {
    Array<uint32_t> first;
    Array<uint8_t> non_manifold_corners;
    find_first_corners(t, first, non_manifold_corners, part.part(0, 0.45f));
    build_incidence(t, first, part.part(0.45f, 0.8f));
    t.vertex_manifold.assign(t.vertex_count, 1);
    non_manifold_edges.assign(t.edge_count, 0);
    for_each_in_order(t.corner_count(), part.part(0.8f, 0.85f), [&](uint32_t c) {
        if (non_manifold_corners[c] == 0) return;
        non_manifold_edges[t.face_edges[c]] = 1;
        t.vertex_manifold[t.face_vertices[c]] = t.vertex_manifold[t.face_vertices[t.next_corner(c)]] = 0;
    });
    order_stars(t, part.part(0.85f, 1));
}

}  // namespace

void build_incidence(Topology& t, const Array<uint32_t>& first, const BuildPart& part) {
    const uint32_t corners = t.corner_count();
    t.face_edges.allocate(corners);
    uint32_t edges = 0;
    for_each_in_order(corners, part.part(0, 0.1f), [&](uint32_t c) {
        t.face_edges[c] = first[c] == c ? edges++ : t.face_edges[first[c]];
    });
    t.edge_count = edges;
    t.edge_vertices.allocate(size_t{2} * edges);
    for_each_index(corners, part.part(0.1f, 0.2f), [&](uint32_t c) {
        if (first[c] != c) return;
        const uint32_t e = t.face_edges[c];
        t.edge_vertices[2 * e] = t.face_vertices[c];
        t.edge_vertices[2 * e + 1] = t.face_vertices[t.next_corner(c)];
    });
    group_by(
        corners, edges, [&](uint32_t c) { return t.face_edges[c]; }, t.edge_corner_offsets, t.edge_corners,
        part.part(0.2f, 0.4f));
    group_by(
        corners, t.vertex_count, [&](uint32_t c) { return t.face_vertices[c]; }, t.vertex_corner_offsets,
        t.vertex_corners, part.part(0.4f, 0.6f));
    group_by(
        2 * edges, t.vertex_count, [&](uint32_t i) { return t.edge_vertices[i]; }, t.vertex_edge_offsets,
        t.vertex_edges, part.part(0.6f, 0.9f));
    for_each_index(2 * edges, part.part(0.9f, 1), [&](uint32_t i) { t.vertex_edges[i] /= 2; });
}

void order_stars(Topology& t, const BuildPart& part) {
    for_each_block(t.vertex_count, part, 1024, [&](uint32_t begin, uint32_t end) {
        std::vector<uint32_t> corners, edges;
        for (uint32_t v = begin; v != end; ++v)
            if (t.vertex_manifold[v] != 0 && !order_star(t, v, corners, edges)) t.vertex_manifold[v] = 0;
    });
}

void build_half_edge_sharpness(Topology& t, const BuildPart& part) {
    if (t.options.creasing != CreasingMethod::chaikin) return;
    Array<SemiSharpEdges> around;
    around.allocate(t.vertex_count);
    for_each_index(t.vertex_count, part.part(0, 0.5f),
                   [&](uint32_t v) { around[v] = semi_sharp_edges_around(t, v); });
    t.half_edge_sharpness.allocate(size_t{2} * t.edge_count);
    for_each_index(2 * t.edge_count, part.part(0.5f, 1), [&](uint32_t i) {
        t.half_edge_sharpness[i] =
            child_edge_sharpness(t.options.creasing, t.edge_sharpness[i / 2], around[t.edge_vertices[i]]);
    });
}

void index_faces(Topology& t, const BuildPart& part) {
    bool uniform = true;
    const uint32_t size = t.face_count != 0 ? t.face_offsets[1] : 0;
    for (uint32_t f = 0; uniform && f < t.face_count; ++f)
        uniform = t.face_offsets[f + 1] - t.face_offsets[f] == size;
    if (uniform && (size == 3 || size == 4)) {
        t.face_size = size;
        t.face_offsets = {};
        return;
    }
    t.corner_faces.allocate(t.corner_count());
    for_each_index(t.face_count, part, [&](uint32_t f) {
        std::fill(t.corner_faces.begin() + t.face_offsets[f], t.corner_faces.begin() + t.face_offsets[f + 1],
                  f);
    });
}

namespace {

/// Edges and stars of its faces.
void connect_faces(Topology& t, Array<uint8_t>& non_manifold_edges, const BuildPart& part) {
    if (!build_manifold_incidence(t, part.part(0, 0.95f)))
        return build_any_incidence(t, non_manifold_edges, part);
    t.vertex_manifold.allocate(t.vertex_count);
    for_each_index(t.vertex_count, part.part(0.95f, 1),
                   [&](uint32_t v) { t.vertex_manifold[v] = !t.corners_of_vertex(v).empty(); });
    non_manifold_edges.assign(t.edge_count, 0);
}

}  // namespace

Topology build_connectivity(const ControlMesh& mesh, Array<uint8_t>& non_manifold_edges, const BuildPart& part) {
    Topology t;
    t.options = mesh.options;
    t.vertex_count = mesh.vertex_count;
    t.face_count = mesh.face_count();
    t.face_offsets.allocate(mesh.face_offsets.size());
    std::copy(mesh.face_offsets.begin(), mesh.face_offsets.end(), t.face_offsets.begin());
    t.face_vertices.allocate(mesh.face_vertices.size());
    std::copy(mesh.face_vertices.begin(), mesh.face_vertices.end(), t.face_vertices.begin());
    index_faces(t, part.part(0, 0.05f));
    connect_faces(t, non_manifold_edges, part.part(0.05f, 1));
    return t;
}

void complete_topology(const ControlMesh& tags, Topology& t, const BuildPart& part) {
    Array<uint8_t> non_manifold_edges;
    connect_faces(t, non_manifold_edges, part.part(0, 0.85f));
    assign_sharpness(tags, t, non_manifold_edges, part.part(0.85f, 1));
}

Topology build_topology(const ControlMesh& mesh, const BuildPart& part) {
    Array<uint8_t> non_manifold_edges;
    Topology t = build_connectivity(mesh, non_manifold_edges, part.part(0, 0.85f));
    assign_sharpness(mesh, t, non_manifold_edges, part.part(0.85f, 1));
    return t;
}

}  // namespace limn
