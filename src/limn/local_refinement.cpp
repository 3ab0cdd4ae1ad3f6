#include "limn/local_refinement.h"

#include <algorithm>

#include "limn/index_map.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Copies faces of one topology to another, with everything attached to them. Stars keep their order and lose
/// what lies outside.
struct Extraction {
    const Topology& from;
    const std::vector<uint32_t>& faces;
    Topology& to;
    std::vector<uint32_t>& vertices;  ///< receives the vertices of `from` that the new ones are
    std::vector<uint32_t> edges;      ///< likewise
    IndexMap local_vertex, local_edge, local_face;

    uint32_t local_corner(uint32_t c) const {
        const uint32_t f = from.face_of_corner(c), local = local_face.find(f);
        return local == IndexMap::kMissing ? local : to.face_begin(local) + c - from.face_begin(f);
    }
    static uint32_t number(IndexMap& map, uint32_t key, std::vector<uint32_t>& keys) {
        const uint32_t local = map.find_or_insert(key, static_cast<uint32_t>(keys.size()));
        if (local == keys.size()) keys.push_back(key);
        return local;
    }
};

void extract_corners(Extraction& x) {
    const Topology& from = x.from;
    Topology& to = x.to;
    to.options = from.options;
    to.face_size = from.face_size;
    to.face_count = static_cast<uint32_t>(x.faces.size());
    std::vector<uint32_t> offsets(1, 0);
    for (uint32_t i = 0; i < to.face_count; ++i) {
        x.local_face.find_or_insert(x.faces[i], i);
        offsets.push_back(offsets.back() + from.size_of_face(x.faces[i]));
    }
    if (to.face_size == 0) {
        to.face_offsets.allocate(offsets.size());
        std::copy(offsets.begin(), offsets.end(), to.face_offsets.begin());
        to.corner_faces.allocate(offsets.back());
        for (uint32_t i = 0; i < to.face_count; ++i)
            std::fill(to.corner_faces.begin() + offsets[i], to.corner_faces.begin() + offsets[i + 1], i);
    }
    to.face_vertices.allocate(offsets.back());
    to.face_edges.allocate(offsets.back());
    to.face_holes.assign(to.face_count, 0);
    uint32_t at = 0;
    for (const uint32_t f : x.faces) {
        const uint32_t end = from.face_begin(f) + from.size_of_face(f);
        for (uint32_t c = from.face_begin(f); c < end; ++c, ++at) {
            to.face_vertices[at] = Extraction::number(x.local_vertex, from.face_vertices[c], x.vertices);
            to.face_edges[at] = Extraction::number(x.local_edge, from.face_edges[c], x.edges);
        }
    }
}

void extract_edges(Extraction& x) {
    const Topology& from = x.from;
    Topology& to = x.to;
    const bool halves = !from.half_edge_sharpness.empty();
    to.edge_count = static_cast<uint32_t>(x.edges.size());
    to.edge_vertices.allocate(size_t{2} * to.edge_count);
    to.edge_corner_offsets.allocate(size_t{to.edge_count} + 1);
    to.edge_corners.allocate(to.corner_count());
    to.edge_sharpness.allocate(to.edge_count);
    if (halves) to.half_edge_sharpness.allocate(size_t{2} * to.edge_count);
    uint32_t at = 0;
    for (uint32_t i = 0; i < to.edge_count; ++i) {
        const uint32_t e = x.edges[i];
        to.edge_corner_offsets[i] = at;
        for (const uint32_t c : from.corners_of_edge(e))
            if (const uint32_t corner = x.local_corner(c); corner != IndexMap::kMissing)
                to.edge_corners[at++] = corner;
        to.edge_sharpness[i] = from.edge_sharpness[e];
        for (uint32_t end = 0; end < 2; ++end) {
            to.edge_vertices[2 * i + end] = x.local_vertex.find(from.edge_vertices[2 * e + end]);
            if (halves) to.half_edge_sharpness[2 * i + end] = from.half_edge_sharpness[2 * e + end];
        }
    }
    to.edge_corner_offsets.back() = at;
}

void extract_vertices(Extraction& x) {
    const Topology& from = x.from;
    Topology& to = x.to;
    to.vertex_count = static_cast<uint32_t>(x.vertices.size());
    to.vertex_corner_offsets.allocate(size_t{to.vertex_count} + 1);
    to.vertex_corners.allocate(to.corner_count());
    to.vertex_edge_offsets.allocate(size_t{to.vertex_count} + 1);
    to.vertex_edges.allocate(size_t{2} * to.edge_count);
    to.vertex_sharpness.allocate(to.vertex_count);
    to.vertex_rules.allocate(to.vertex_count);
    to.vertex_manifold.allocate(to.vertex_count);
    uint32_t corner_at = 0, edge_at = 0;
    std::vector<uint32_t> dependent;
    std::vector<float> seam_sharpness;
    for (uint32_t i = 0; i < to.vertex_count; ++i) {
        const uint32_t v = x.vertices[i];
        to.vertex_corner_offsets[i] = corner_at;
        to.vertex_edge_offsets[i] = edge_at;
        for (const uint32_t c : from.corners_of_vertex(v))
            if (const uint32_t corner = x.local_corner(c); corner != IndexMap::kMissing)
                to.vertex_corners[corner_at++] = corner;
        for (const uint32_t e : from.edges_of_vertex(v))
            if (const uint32_t edge = x.local_edge.find(e); edge != IndexMap::kMissing)
                to.vertex_edges[edge_at++] = edge;
        to.vertex_sharpness[i] = from.vertex_sharpness[v];
        to.vertex_rules[i] = from.vertex_rules[v];
        to.vertex_manifold[i] = from.vertex_manifold[v];
        const size_t pair = from.find_dependent(v);
        if (pair == Topology::kNotDependent) continue;
        const uint32_t leader = x.local_vertex.find(from.dependent_vertices[2 * pair + 1]);
        if (leader == IndexMap::kMissing) continue;
        dependent.insert(dependent.end(), {i, leader});
        seam_sharpness.push_back(from.dependent_seam_sharpness[pair]);
    }
    to.vertex_corner_offsets.back() = corner_at;
    to.vertex_edge_offsets.back() = edge_at;
    to.dependent_vertices.allocate(dependent.size());
    std::copy(dependent.begin(), dependent.end(), to.dependent_vertices.begin());
    to.dependent_seam_sharpness.allocate(seam_sharpness.size());
    std::copy(seam_sharpness.begin(), seam_sharpness.end(), to.dependent_seam_sharpness.begin());
}

}  // namespace

void extract_faces(const Topology& from, const std::vector<uint32_t>& faces, std::vector<uint32_t>& vertices,
                   Topology& to) {
    vertices.clear();
    Extraction x{from,
                 faces,
                 to,
                 vertices,
                 {},
                 IndexMap(from.vertex_count),
                 IndexMap(from.edge_count),
                 IndexMap(from.face_count)};
    extract_corners(x);
    extract_edges(x);
    extract_vertices(x);
}

Topology extract_faces(const Topology& from, const std::vector<uint32_t>& faces,
                       std::vector<uint32_t>& vertices) {
    Topology to;
    extract_faces(from, faces, vertices, to);
    return to;
}

namespace {

/// Appends to `faces` those around the flagged vertices (and around the vertices that lead them), each once.
void append_faces_around(const Topology& t, std::vector<uint8_t>& flags, std::vector<uint32_t>& faces) {
    for (size_t i = 0; i < t.dependent_vertices.size(); i += 2)
        if (flags[t.dependent_vertices[i]] != 0) flags[t.dependent_vertices[i + 1]] = 1;
    std::vector<uint8_t> taken(t.face_count, 0);
    for (const uint32_t f : faces) taken[f] = 1;
    for (uint32_t f = 0; f < t.face_count; ++f) {
        if (taken[f] != 0) continue;
        const auto vertices = t.vertices_of_face(f);
        if (std::any_of(vertices.begin(), vertices.end(), [&](uint32_t v) { return flags[v] != 0; }))
            faces.push_back(f);
    }
}

/// The first `centre_count` faces and, after them, all that touch them.
std::vector<uint32_t> faces_touching(const Topology& t, uint32_t centre_count) {
    std::vector<uint32_t> faces(centre_count);
    std::vector<uint8_t> flags(t.vertex_count, 0);
    for (uint32_t f = 0; f < centre_count; ++f) {
        faces[f] = f;
        for (const uint32_t v : t.vertices_of_face(f)) flags[v] = 1;
    }
    append_faces_around(t, flags, faces);
    return faces;
}

}  // namespace

std::vector<uint32_t> faces_touching_face(const Topology& t, uint32_t face) {
    std::vector<uint32_t> faces(1, face);
    std::vector<uint8_t> flags(t.vertex_count, 0);
    for (const uint32_t v : t.vertices_of_face(face)) flags[v] = 1;
    append_faces_around(t, flags, faces);
    return faces;
}

namespace {

/// The faces around some vertices of t; with `uncut`, whose corners are those of t, also the ones beyond
/// seams there.
std::vector<uint32_t> faces_around(const Topology& t, const Topology* uncut,
                                   const std::vector<uint32_t>& vertices) {
    std::vector<uint32_t> faces;
    std::vector<uint8_t> flags(t.vertex_count, 0);
    for (const uint32_t v : vertices) flags[v] = 1;
    append_faces_around(t, flags, faces);
    if (uncut == nullptr) return faces;
    std::vector<uint8_t> uncut_flags(uncut->vertex_count, 0);
    for (uint32_t c = 0; c < t.corner_count(); ++c)
        if (flags[t.face_vertices[c]] != 0) uncut_flags[uncut->face_vertices[c]] = 1;
    append_faces_around(*uncut, uncut_flags, faces);
    return faces;
}

/// Old numbers of vertices -> positions in `vertices`.
void renumber(const std::vector<uint32_t>& vertices, std::vector<uint32_t>& numbers) {
    IndexMap map;
    for (uint32_t i = 0; i < vertices.size(); ++i) map.find_or_insert(vertices[i], i);
    for (uint32_t& v : numbers) v = map.find(v);
}

/// How many children the first `centre_count` faces have.
uint32_t centre_children(const Topology& parent, uint32_t centre_count) {
    return parent.options.scheme == Scheme::loop
               ? 4 * centre_count
               : parent.face_begin(centre_count - 1) + parent.size_of_face(centre_count - 1);
}

}  // namespace

void refine_locally(const Topology& base, const std::vector<uint32_t>& faces,
                    const std::vector<uint32_t>& target_corners, const LocalRefinementOptions& options,
                    LocalRefinement& out) {
    const bool chaikin = options.uncut != nullptr;
    std::vector<uint32_t> vertices;
    out.levels.clear();
    out.children.assign(1, {});
    out.levels.push_back(extract_faces(base, faces, out.ring));
    Topology uncut;
    if (chaikin) uncut = extract_faces(*options.uncut, faces, vertices);
    uint32_t last = options.level;
    if (options.to_limit) {
        last = std::max(last, 1u);
        if (!base.options.opensubdiv_compatible) last = std::max(last, count_sharp_levels(out.levels[0]));
    }
    uint32_t centre_count = 1;
    for (uint32_t level = 0;; ++level) {
        if (level == options.level) {
            out.targets.clear();
            for (const uint32_t q : target_corners) out.targets.push_back(out.levels.back().face_vertices[q]);
        }
        if (level == last) return;
        const Topology& parent = out.levels.back();
        const bool full = level + 1 < last || options.to_limit;
        if (chaikin) copy_half_edge_sharpness(uncut, out.levels.back());
        Topology child = refine_once(parent, full);
        centre_count = centre_children(parent, centre_count);
        if (full) {
            if (chaikin) uncut = refine_once(uncut, true);
            const bool beyond = level >= options.level;
            const std::vector<uint32_t> kept =
                beyond ? faces_around(child, chaikin ? &uncut : nullptr, out.targets)
                       : faces_touching(chaikin ? uncut : child, centre_count);
            if (chaikin) uncut = extract_faces(uncut, kept, vertices);
            child = extract_faces(child, kept, vertices);
            if (beyond) renumber(vertices, out.targets);
            out.children.push_back(vertices);
        } else {
            out.children.emplace_back();
        }
        out.levels.push_back(std::move(child));
    }
}

namespace {

/// A refined face as the whole mesh numbers it: id, corners, the edges that begin there and which end of them
/// that is.
struct GlobalFace {
    uint32_t id;
    uint32_t vertices[4], edges[4], ends[4];
};

struct Side {
    uint32_t vertex, edge, end;
};

/// Child of a face at corner c (its number at the parent's level), between `side` there and `previous`;
/// `slot` is the corner of the child at the parent's vertex. Mirrors split_quad_faces.
GlobalFace quad_child(const LevelCounts& p, uint32_t parent, uint32_t c, uint32_t previous_c,
                      const Side& side, const Side& previous, uint32_t slot) {
    GlobalFace child;
    child.id = c;
    const uint32_t first_edge_vertex = p.vertices + p.faces;
    const uint32_t vertices[4] = {side.vertex, first_edge_vertex + side.edge, p.vertices + parent,
                                  first_edge_vertex + previous.edge};
    const uint32_t edges[4] = {p.corners + 2 * side.edge + side.end, c, previous_c,
                               p.corners + 2 * previous.edge + 1 - previous.end};
    const uint32_t ends[4] = {1, 1, 0, 0};
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t at = (slot + i) & 3;
        child.vertices[at] = vertices[i];
        child.edges[at] = edges[i];
        child.ends[at] = ends[i];
    }
    return child;
}

/// Mirrors split_triangle_faces; child 3 is the centre.
GlobalFace triangle_child(const LevelCounts& p, const GlobalFace& f, uint32_t j) {
    GlobalFace child;
    child.id = 4 * f.id + j;
    if (j == 3) {
        for (uint32_t k = 0; k < 3; ++k) {
            child.vertices[k] = p.vertices + f.edges[(k + 1) % 3];
            child.edges[k] = 3 * f.id + (k + 2) % 3;
            child.ends[k] = 1;
        }
        return child;
    }
    const uint32_t next = (j + 1) % 3, previous = (j + 2) % 3;
    child.vertices[j] = f.vertices[j];
    child.vertices[next] = p.vertices + f.edges[j];
    child.vertices[previous] = p.vertices + f.edges[previous];
    child.edges[j] = p.corners + 2 * f.edges[j] + f.ends[j];
    child.edges[next] = 3 * f.id + j;
    child.edges[previous] = p.corners + 2 * f.edges[previous] + 1 - f.ends[previous];
    child.ends[j] = 1;
    child.ends[next] = child.ends[previous] = 0;
    return child;
}

struct Descent {
    const std::vector<LevelCounts>& counts;
    uint32_t last;
    uint32_t* out;

    void visit_triangle(const GlobalFace& f, uint32_t level) {
        if (level == last) {
            out = std::copy_n(f.vertices, 3, out);
            return;
        }
        for (uint32_t j = 0; j < 4; ++j) visit_triangle(triangle_child(counts[level], f, j), level + 1);
    }
    void visit_quad(const GlobalFace& f, uint32_t level) {
        if (level == last) {
            out = std::copy_n(f.vertices, 4, out);
            return;
        }
        const LevelCounts& p = counts[level];
        if (level + 1 == last) return write_children(p, f);
        for (uint32_t j = 0; j < 4; ++j) {
            const uint32_t before = (j + 3) & 3;
            const Side side{f.vertices[j], f.edges[j], f.ends[j]};
            const Side previous{f.vertices[before], f.edges[before], f.ends[before]};
            visit_quad(quad_child(p, f.id, 4 * f.id + j, 4 * f.id + before, side, previous, j), level + 1);
        }
    }
    /// The last step needs no edges: the corners, edge points and face point of f in the order of its four
    /// children.
    void write_children(const LevelCounts& p, const GlobalFace& f) {
        const uint32_t* v = f.vertices;
        uint32_t e[4];
        for (uint32_t i = 0; i < 4; ++i) e[i] = p.vertices + p.faces + f.edges[i];
        const uint32_t centre = p.vertices + f.id;
        const uint32_t children[16] = {v[0],   e[0], centre, e[3], e[0], v[1],   e[1], centre,
                                       centre, e[1], v[2],   e[2], e[3], centre, e[2], v[3]};
        out = std::copy_n(children, 16, out);
    }
};

}  // namespace

void vertices_over_face(const Topology& base, const std::vector<LevelCounts>& counts, uint32_t level,
                        uint32_t f, std::vector<uint32_t>& vertices) {
    const uint32_t begin = base.face_begin(f), size = base.size_of_face(f);
    if (level == 0) {
        vertices.assign(base.face_vertices.begin() + begin, base.face_vertices.begin() + begin + size);
        return;
    }
    const bool triangles = base.options.scheme == Scheme::loop;
    size_t count = size;
    for (uint32_t l = 0; l < level; ++l) count *= 4;
    vertices.resize(count);
    Descent descent{counts, level, vertices.data()};
    auto side = [&](uint32_t c) {
        return Side{base.face_vertices[c], base.face_edges[c], base.end_at_corner(c)};
    };
    if (triangles) {
        GlobalFace face{f, {}, {}, {}};
        for (uint32_t j = 0; j < 3; ++j) {
            const Side s = side(begin + j);
            face.vertices[j] = s.vertex;
            face.edges[j] = s.edge;
            face.ends[j] = s.end;
        }
        descent.visit_triangle(face, 0);
        return;
    }
    for (uint32_t j = 0; j < size; ++j) {
        const uint32_t c = begin + j, previous = begin + (j == 0 ? size : j) - 1;
        descent.visit_quad(quad_child(counts[0], f, c, previous, side(c), side(previous), size == 4 ? j : 0),
                           1);
    }
}

}  // namespace limn
