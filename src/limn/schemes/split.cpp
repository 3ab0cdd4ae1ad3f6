#include "limn/schemes/split.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "limn/schemes/child_faces.h"
#include "limn/schemes/star.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Numbers of the points of boundary edge ends, two for each boundary edge.
class BoundaryPoints {
  public:
    explicit BoundaryPoints(const Topology& t) : t_(t) {
        rank_.assign(t.edge_count, kInvalidIndex);
        for (uint32_t e = 0; e < t.edge_count; ++e) {
            if (!is_boundary_edge(t, e)) continue;
            rank_[e] = static_cast<uint32_t>(ends_.size() / 2);
            ends_.push_back(2 * e);
            ends_.push_back(2 * e + 1);
        }
    }
    const std::vector<uint32_t>& ends() const { return ends_; }
    void set_first(uint32_t first) { first_ = first; }
    /// The point near vertex v of boundary edge e.
    uint32_t point(uint32_t e, uint32_t v) const {
        return first_ + 2 * rank_[e] + (t_.edge_vertices[2 * e] == v ? 0 : 1);
    }

  private:
    const Topology& t_;
    std::vector<uint32_t> rank_, ends_;
    uint32_t first_ = 0;
};

std::vector<uint32_t> boundary_edges(const Topology& t) {
    std::vector<uint32_t> edges;
    for (uint32_t e = 0; e < t.edge_count; ++e)
        if (is_boundary_edge(t, e)) edges.push_back(e);
    return edges;
}

void split_primal(const Stage& parent, SplitKind kind, bool full, SplitMesh& out, const BuildPart& part) {
    // The steps of Catmull-Clark and Loop: fast, and with sharpness.
    const Topology& p = parent.topology;
    assert((p.options.scheme == Scheme::loop) == (kind == SplitKind::triangles));
    refine_once(p, full, out.child, part);
    ChildFaces child(out);
    child.add_points(Origin::vertex, p.vertex_count);
    if (kind == SplitKind::quads) child.add_points(Origin::face, p.face_count);
    child.add_points(Origin::edge, p.edge_count);
}

void add_corners_of_face(const Topology& p, uint32_t f, FaceWriter& out) {
    for (uint32_t c = p.face_begin(f); c < p.face_begin(f) + p.size_of_face(f); ++c) out.add_corner(c);
    out.end_face();
}

/// Faces of the corner split around vertices: their corners and, on a boundary that is kept, edge ends and fixed
/// corners.
void add_vertex_face(const Topology& p, uint32_t v, const BoundaryPoints* boundary, uint32_t fixed, FaceWriter& out) {
    const auto edges = p.edges_of_vertex(v);
    if (boundary != nullptr) out.add_corner(boundary->point(edges.front(), v));
    for (const uint32_t c : p.corners_of_vertex(v)) out.add_corner(c);
    if (boundary != nullptr) out.add_corner(boundary->point(edges.back(), v));
    if (fixed != kInvalidIndex) out.add_corner(fixed);
    out.end_face();
}

/// Doo and Sabin 1978. Boundaries: none shrinks; else each edge keeps two points, the boundary is cut like a
/// curve (vertex doubling, Nasri 1987); fixed corners stay points of their own.
void split_corners(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    const bool shrinks = p.options.boundary == BoundaryInterpolation::none;
    std::vector<uint32_t> fixed, fixed_point(p.vertex_count, kInvalidIndex);
    for (uint32_t v = 0; !shrinks && v < p.vertex_count; ++v)
        if (face_valence(p, v) != 0 && is_boundary_vertex(p, v) && is_fixed_corner(p, v)) fixed.push_back(v);
    // Corner points come first: a face's new vertices are its corners' numbers.
    ChildFaces child(out);
    child.add_points(Origin::corner, p.corner_count());
    BoundaryPoints boundary(p);
    if (!shrinks) {
        boundary.set_first(
            child.add_points(Origin::edge_end, static_cast<uint32_t>(boundary.ends().size()), boundary.ends()));
        uint32_t next = child.add_points(Origin::vertex, static_cast<uint32_t>(fixed.size()), fixed);
        for (const uint32_t v : fixed) fixed_point[v] = next++;
    }
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    auto add_edge_face = [&](uint32_t e, FaceWriter& faces) {
        const auto at = p.corners_of_edge(e);
        if (at.size() == 2)
            faces.add_face({p.next_corner(at[0]), at[0], p.next_corner(at[1]), at[1]});
        else if (!shrinks)
            faces.add_face({p.next_corner(at[0]), at[0], boundary.point(e, p.face_vertices[at[0]]),
                            boundary.point(e, end_vertex(p, at[0]))});
    };
    auto add_face_at = [&](uint32_t v, FaceWriter& faces) {
        const bool inside = !is_boundary_vertex(p, v);
        if (face_valence(p, v) == 0 || (shrinks && !inside)) return;
        out.face_of_vertex[v] = faces.begin_face();
        add_vertex_face(p, v, inside ? nullptr : &boundary, fixed_point[v], faces);
    };
    child.build(p, p.face_count + p.edge_count + p.vertex_count, full, part, [&](uint32_t i, FaceWriter& faces) {
        if (i < p.face_count) return add_corners_of_face(p, i, faces);
        i -= p.face_count;
        return i < p.edge_count ? add_edge_face(i, faces) : add_face_at(i - p.edge_count, faces);
    });
}

void split_midpoints(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    ChildFaces child(out);
    child.add_points(Origin::edge, p.edge_count);
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    child.build(p, p.face_count + p.vertex_count, full, part, [&](uint32_t i, FaceWriter& faces) {
        const bool is_face = i < p.face_count;
        const uint32_t v = i - p.face_count;
        if (!is_face && (face_valence(p, v) < 3 || is_boundary_vertex(p, v))) return;
        if (!is_face) out.face_of_vertex[v] = faces.begin_face();
        for (const uint32_t e : is_face ? p.edges_of_face(i) : p.edges_of_vertex(v)) faces.add_corner(e);
        faces.end_face();
    });
}

/// Kobbelt 2000. Each second step boundary edges are cut in three; their triangles have no face point then, but a
/// triangle between the two new points and their third vertex.
void split_sqrt3(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    const bool trisect = parent.step % 2 == 1;
    BoundaryPoints boundary(p);
    std::vector<uint32_t> split_faces, face_point(p.face_count, kInvalidIndex);
    for (uint32_t f = 0; f < p.face_count; ++f)
        if (!trisect || boundary_corner(p, f) == kInvalidIndex) split_faces.push_back(f);
    ChildFaces child(out);
    child.add_points(Origin::vertex, p.vertex_count);
    const auto count = static_cast<uint32_t>(split_faces.size());
    uint32_t next = count == p.face_count ? child.add_points(Origin::face, count)
                                          : child.add_points(Origin::face, count, split_faces);
    for (const uint32_t f : split_faces) face_point[f] = next++;
    if (trisect)
        boundary.set_first(
            child.add_points(Origin::edge_end, static_cast<uint32_t>(boundary.ends().size()), boundary.ends()));
    // What stands for the face point of corner c's face where its edge is turned.
    auto point = [&](uint32_t c) {
        const uint32_t f = p.face_of_corner(c);
        if (face_point[f] != kInvalidIndex) return face_point[f];
        const uint32_t cut = boundary_corner(p, f), e = p.face_edges[cut];
        return boundary.point(e, c == p.next_corner(cut) ? end_vertex(p, cut) : p.face_vertices[cut]);
    };
    child.build(p, p.edge_count, full, part, [&](uint32_t e, FaceWriter& faces) {
        const auto at = p.corners_of_edge(e);
        const uint32_t a = p.face_vertices[at[0]], b = end_vertex(p, at[0]);
        if (at.size() == 2) {
            faces.add_face({a, point(at[1]), point(at[0])});
            faces.add_face({b, point(at[0]), point(at[1])});
        } else if (trisect) {
            faces.add_face({boundary.point(e, a), boundary.point(e, b), apex_vertex(p, at[0])});
        } else {
            faces.add_face({a, b, point(at[0])});
        }
    });
}

/// Velho and Zorin 2001 (their blocks), Li, Ma and Bao 2004. Boundary edges make half blocks, triangles, whose point of
/// the next step is the edge's midpoint.
void split_sqrt2(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    const bool halves = parent.step % 2 == 1;
    ChildFaces child(out);
    child.add_points(Origin::vertex, p.vertex_count);
    const uint32_t first = child.add_points(Origin::face, p.face_count);
    child.build(p, p.edge_count, full, part, [&](uint32_t e, FaceWriter& faces) {
        const auto at = p.corners_of_edge(e);
        const uint32_t a = p.face_vertices[at[0]], b = end_vertex(p, at[0]);
        const uint32_t left = first + p.face_of_corner(at[0]);
        if (at.size() == 2)
            faces.add_face({a, first + p.face_of_corner(at[1]), b, left});
        else if (!halves)
            faces.add_face({a, b, left});
    });
}

/// The dual of sqrt3: p(edge, face) for both faces of an edge. Boundary vertices get no face.
void split_hexagons(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    ChildFaces child(out);
    child.add_points(Origin::corner, p.corner_count());
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    child.build(p, p.face_count + p.vertex_count, full, part, [&](uint32_t i, FaceWriter& faces) {
        if (i < p.face_count) return add_corners_of_face(p, i, faces);
        const uint32_t v = i - p.face_count;
        if (face_valence(p, v) < 2 || is_boundary_vertex(p, v)) return;
        out.face_of_vertex[v] = faces.begin_face();
        for (const uint32_t c : p.corners_of_vertex(v)) {
            faces.add_corner(c);
            faces.add_corner(p.previous_corner(c));
        }
        faces.end_face();
    });
}

/// Boundary edges become vertices, too, so that boundaries are averaged like curves.
void split_dual(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    const std::vector<uint32_t> edges = boundary_edges(p);
    std::vector<uint32_t> edge_point(p.edge_count, kInvalidIndex);
    ChildFaces child(out);
    child.add_points(Origin::face, p.face_count);
    uint32_t next = child.add_points(Origin::edge, static_cast<uint32_t>(edges.size()), edges);
    for (const uint32_t e : edges) edge_point[e] = next++;
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    child.build(p, p.vertex_count, full, part, [&](uint32_t v, FaceWriter& faces) {
        const bool boundary = is_boundary_vertex(p, v);
        const auto around = p.edges_of_vertex(v);
        if (face_valence(p, v) < (boundary ? 1u : 3u)) return;
        out.face_of_vertex[v] = faces.begin_face();
        if (boundary) faces.add_corner(edge_point[around.front()]);
        for (const uint32_t c : p.corners_of_vertex(v)) faces.add_corner(p.face_of_corner(c));
        if (boundary) faces.add_corner(edge_point[around.back()]);
        faces.end_face();
    });
}

}  // namespace

void show_all_faces(Topology& t) {
    std::fill(t.face_holes.begin(), t.face_holes.end(), uint8_t{0});
}

Topology topology_of_faces(const SchemeOptions& options, uint32_t vertex_count, Array<uint32_t> face_offsets,
                           Array<uint32_t> face_vertices, bool full, const BuildPart& part) {
    Topology t;
    t.options = options;
    t.vertex_count = vertex_count;
    t.face_count = static_cast<uint32_t>(face_offsets.size()) - 1;
    t.face_offsets = std::move(face_offsets);
    t.face_vertices = std::move(face_vertices);
    index_faces(t, part.part(0, 0.1f));
    if (full)
        complete_topology({}, t, part.part(0.1f, 1));
    else
        t.face_holes.allocate(t.face_count);
    if (!part.is_cancelled()) show_all_faces(t);
    return t;
}

SplitMesh split_mesh(const Stage& parent, SplitKind kind, bool full, const BuildPart& part) {
    SplitMesh out;
    switch (kind) {
        case SplitKind::none:
            ChildFaces(out).add_points(Origin::vertex, parent.topology.vertex_count);
            break;
        case SplitKind::quads:
        case SplitKind::triangles:
            split_primal(parent, kind, full, out, part);
            break;
        case SplitKind::corners:
            split_corners(parent, full, out, part);
            break;
        case SplitKind::midpoints:
            split_midpoints(parent, full, out, part);
            break;
        case SplitKind::sqrt3:
            split_sqrt3(parent, full, out, part);
            break;
        case SplitKind::sqrt2:
            split_sqrt2(parent, full, out, part);
            break;
        case SplitKind::hexagons:
            split_hexagons(parent, full, out, part);
            break;
        case SplitKind::dual:
            split_dual(parent, full, out, part);
            break;
    }
    return out;
}

Element child_element(SplitKind kind, const SplitMesh& split, Element element) {
    if (kind == SplitKind::none) return element;
    if (!split.face_of_vertex.empty()) {
        if (!element.is_face) return {true, split.face_of_vertex[element.index]};
        return kind == SplitKind::dual ? Element{false, element.index} : element;
    }
    if (!element.is_face) return element;
    if (kind == SplitKind::triangles) return {true, 4 * element.index + 3};
    const PointBlock& faces = split.blocks[1];
    for (uint32_t i = 0; i < faces.count; ++i)
        if (faces.parent(i) == element.index) return {false, faces.first + i};
    return {false, kInvalidIndex};
}

}  // namespace limn
