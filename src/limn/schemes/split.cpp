#include "limn/schemes/split.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "limn/parallel.h"
#include "limn/schemes/star.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Points and faces of a child in the making.
class ChildFaces {
  public:
    explicit ChildFaces(SplitMesh& split) : split_(split) {}

    /// `parents` empty: one point for each of `count` elements. The number of the first point.
    uint32_t add_points(Origin origin, uint32_t count, const std::vector<uint32_t>& parents = {}) {
        PointBlock block{origin, points_, count, {}};
        block.parents.allocate(parents.size());
        std::copy(parents.begin(), parents.end(), block.parents.begin());
        split_.blocks.push_back(std::move(block));
        points_ += count;
        return points_ - count;
    }
    void reserve(size_t faces, size_t corners) {
        offsets_.reserve(faces + 1);
        vertices_.reserve(corners);
    }
    uint32_t begin_face() const { return static_cast<uint32_t>(offsets_.size()) - 1; }
    void add_corner(uint32_t vertex) { vertices_.push_back(vertex); }
    void end_face() { offsets_.push_back(static_cast<uint32_t>(vertices_.size())); }
    void add_face(std::initializer_list<uint32_t> vertices) {
        for (const uint32_t v : vertices) add_corner(v);
        end_face();
    }
    void finish(const Topology& parent, bool full, const BuildPart& part) {
        split_.child =
            topology_of_faces(parent.options, points_, std::move(offsets_), std::move(vertices_), full, part);
        if (full && !part.is_cancelled()) keep_fixed_corners(parent);
    }

  private:
    /// Corners are vertices with one face in the control mesh, whatever meets there later.
    void keep_fixed_corners(const Topology& parent) {
        for (const PointBlock& block : split_.blocks)
            for (uint32_t i = 0; block.origin == Origin::vertex && i < block.count; ++i)
                if (is_fixed_corner(parent, block.parent(i)))
                    split_.child.vertex_rules[block.first + i] = VertexRule::corner;
    }

    SplitMesh& split_;
    uint32_t points_ = 0;
    std::vector<uint32_t> offsets_ = {0}, vertices_;
};

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

/// Faces of the corner split around vertices: their corners and, on a boundary that is kept, edge ends and fixed
/// corners.
void add_vertex_face(const Topology& p, uint32_t v, const BoundaryPoints* boundary, uint32_t fixed, ChildFaces& child) {
    const auto edges = p.edges_of_vertex(v);
    if (boundary != nullptr) child.add_corner(boundary->point(edges.front(), v));
    for (const uint32_t c : p.corners_of_vertex(v)) child.add_corner(c);
    if (boundary != nullptr) child.add_corner(boundary->point(edges.back(), v));
    if (fixed != kInvalidIndex) child.add_corner(fixed);
    child.end_face();
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
    child.reserve(size_t{p.face_count} + p.edge_count + p.vertex_count, size_t{4} * p.corner_count());
    for (uint32_t f = 0; f < p.face_count; ++f) {
        for (uint32_t c = p.face_begin(f); c < p.face_begin(f) + p.size_of_face(f); ++c) child.add_corner(c);
        child.end_face();
    }
    for (uint32_t e = 0; e < p.edge_count; ++e) {
        const auto at = p.corners_of_edge(e);
        if (at.size() == 2)
            child.add_face({p.next_corner(at[0]), at[0], p.next_corner(at[1]), at[1]});
        else if (!shrinks)
            child.add_face({p.next_corner(at[0]), at[0], boundary.point(e, p.face_vertices[at[0]]),
                            boundary.point(e, end_vertex(p, at[0]))});
    }
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    for (uint32_t v = 0; v < p.vertex_count; ++v) {
        const bool inside = !is_boundary_vertex(p, v);
        if (face_valence(p, v) == 0 || (shrinks && !inside)) continue;
        out.face_of_vertex[v] = child.begin_face();
        add_vertex_face(p, v, inside ? nullptr : &boundary, fixed_point[v], child);
    }
    child.finish(p, full, part);
}

void split_midpoints(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    ChildFaces child(out);
    child.add_points(Origin::edge, p.edge_count);
    child.reserve(size_t{p.face_count} + p.vertex_count, size_t{2} * p.corner_count());
    for (uint32_t f = 0; f < p.face_count; ++f) {
        for (const uint32_t e : p.edges_of_face(f)) child.add_corner(e);
        child.end_face();
    }
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    for (uint32_t v = 0; v < p.vertex_count; ++v) {
        if (face_valence(p, v) < 3 || is_boundary_vertex(p, v)) continue;
        out.face_of_vertex[v] = child.begin_face();
        for (const uint32_t e : p.edges_of_vertex(v)) child.add_corner(e);
        child.end_face();
    }
    child.finish(p, full, part);
}

/// Kobbelt 2000. Each second step boundary edges are cut in three; their triangles have no face point then, but a
/// triangle between the two new points and their third vertex.
void split_sqrt3(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    const bool trisect = parent.step % 2 == 1;
    BoundaryPoints boundary(p);
    std::vector<uint32_t> faces, face_point(p.face_count, kInvalidIndex);
    for (uint32_t f = 0; f < p.face_count; ++f)
        if (!trisect || boundary_corner(p, f) == kInvalidIndex) faces.push_back(f);
    ChildFaces child(out);
    child.add_points(Origin::vertex, p.vertex_count);
    uint32_t next = child.add_points(Origin::face, static_cast<uint32_t>(faces.size()), faces);
    for (const uint32_t f : faces) face_point[f] = next++;
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
    child.reserve(size_t{3} * p.face_count, size_t{9} * p.face_count);
    for (uint32_t e = 0; e < p.edge_count; ++e) {
        const auto at = p.corners_of_edge(e);
        const uint32_t a = p.face_vertices[at[0]], b = end_vertex(p, at[0]);
        if (at.size() == 2) {
            child.add_face({a, point(at[1]), point(at[0])});
            child.add_face({b, point(at[0]), point(at[1])});
        } else if (trisect) {
            child.add_face({boundary.point(e, a), boundary.point(e, b), p.face_vertices[p.previous_corner(at[0])]});
        } else {
            child.add_face({a, b, point(at[0])});
        }
    }
    child.finish(p, full, part);
}

/// Velho and Zorin 2001 (their blocks), Li, Ma and Bao 2004. Boundary edges make half blocks, triangles, whose point of
/// the next step is the edge's midpoint.
void split_sqrt2(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    const bool halves = parent.step % 2 == 1;
    ChildFaces child(out);
    child.add_points(Origin::vertex, p.vertex_count);
    const uint32_t first = child.add_points(Origin::face, p.face_count);
    child.reserve(p.edge_count, size_t{4} * p.edge_count);
    for (uint32_t e = 0; e < p.edge_count; ++e) {
        const auto at = p.corners_of_edge(e);
        const uint32_t a = p.face_vertices[at[0]], b = end_vertex(p, at[0]);
        const uint32_t left = first + p.face_of_corner(at[0]);
        if (at.size() == 2)
            child.add_face({a, first + p.face_of_corner(at[1]), b, left});
        else if (!halves)
            child.add_face({a, b, left});
    }
    child.finish(p, full, part);
}

/// The dual of sqrt3: p(edge, face) for both faces of an edge. Boundary vertices get no face.
void split_hexagons(const Stage& parent, bool full, SplitMesh& out, const BuildPart& part) {
    const Topology& p = parent.topology;
    ChildFaces child(out);
    child.add_points(Origin::corner, p.corner_count());
    child.reserve(size_t{p.face_count} + p.vertex_count, size_t{3} * p.corner_count());
    for (uint32_t f = 0; f < p.face_count; ++f) {
        for (uint32_t c = p.face_begin(f); c < p.face_begin(f) + p.size_of_face(f); ++c) child.add_corner(c);
        child.end_face();
    }
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    for (uint32_t v = 0; v < p.vertex_count; ++v) {
        if (face_valence(p, v) < 2 || is_boundary_vertex(p, v)) continue;
        out.face_of_vertex[v] = child.begin_face();
        for (const uint32_t c : p.corners_of_vertex(v)) {
            child.add_corner(c);
            child.add_corner(p.previous_corner(c));
        }
        child.end_face();
    }
    child.finish(p, full, part);
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
    child.reserve(p.vertex_count, p.corner_count() + edges.size() * 2);
    out.face_of_vertex.assign(p.vertex_count, kInvalidIndex);
    for (uint32_t v = 0; v < p.vertex_count; ++v) {
        const bool boundary = is_boundary_vertex(p, v);
        const auto around = p.edges_of_vertex(v);
        if (face_valence(p, v) < (boundary ? 1u : 3u)) continue;
        out.face_of_vertex[v] = child.begin_face();
        if (boundary) child.add_corner(edge_point[around.front()]);
        for (const uint32_t c : p.corners_of_vertex(v)) child.add_corner(p.face_of_corner(c));
        if (boundary) child.add_corner(edge_point[around.back()]);
        child.end_face();
    }
    child.finish(p, full, part);
}

}  // namespace

void show_all_faces(Topology& t) {
    std::fill(t.face_holes.begin(), t.face_holes.end(), uint8_t{0});
}

Topology topology_of_faces(const SchemeOptions& options, uint32_t vertex_count, std::vector<uint32_t> face_offsets,
                           std::vector<uint32_t> face_vertices, bool full, const BuildPart& part) {
    ControlMesh mesh;
    mesh.options = options;
    mesh.vertex_count = vertex_count;
    mesh.face_offsets = std::move(face_offsets);
    mesh.face_vertices = std::move(face_vertices);
    Topology t;
    if (full) {
        t = build_topology(mesh, part);
        if (!part.is_cancelled()) show_all_faces(t);
        return t;
    }
    t.options = options;
    t.vertex_count = vertex_count;
    t.face_count = mesh.face_count();
    t.face_offsets.allocate(mesh.face_offsets.size());
    std::copy(mesh.face_offsets.begin(), mesh.face_offsets.end(), t.face_offsets.begin());
    t.face_vertices.allocate(mesh.face_vertices.size());
    std::copy(mesh.face_vertices.begin(), mesh.face_vertices.end(), t.face_vertices.begin());
    t.face_holes.assign(t.face_count, 0);
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
