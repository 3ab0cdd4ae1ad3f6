// One step parent -> child for both splits. Everything about a child follows from its parent by index
// arithmetic, so each array is filled in one parallel pass over parent faces, edges or vertices.
#include "limn/refinement.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "limn/local_refinement.h"
#include "limn/parallel.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Children are numbered: vertices [of vertices | of faces (quads only) | of edges], edges [within faces | 2
/// e + end of edge e], faces in corner order (a triangle's centre child comes last).
struct Split {
    const Topology& parent;
    Topology& child;

    bool triangles() const { return parent.options.scheme == Scheme::loop; }
    uint32_t face_vertex(uint32_t f) const { return child_of_face(parent, f); }
    uint32_t edge_vertex(uint32_t e) const { return child_of_edge(parent, e); }
    uint32_t half_edge(uint32_t e, uint32_t end) const { return parent.corner_count() + 2 * e + end; }
    /// Which end of its edge the corner is: the edge that begins (or, for the previous corner's, ends) there.
    uint32_t end_at_start(uint32_t c) const { return parent.end_at_corner(c); }
    uint32_t end_at_finish(uint32_t c) const { return 1 - end_at_start(c); }

    // Quads: the child face at corner c is face c; its corner at the parent's vertex is slot(c).
    uint32_t slot(uint32_t c) const {
        const uint32_t f = parent.face_of_corner(c);
        return parent.size_of_face(f) == 4 ? c - parent.face_begin(f) : 0;
    }
    uint32_t quad_corner(uint32_t c, uint32_t turn) const { return 4 * c + ((slot(c) + turn) & 3); }

    // Triangles: child j of face f; its corner k.
    static uint32_t triangle_corner(uint32_t f, uint32_t j, uint32_t k) { return 3 * (4 * f + j) + k % 3; }
};

void allocate_common(const Split& s, bool full) {
    const Topology& p = s.parent;
    Topology& t = s.child;
    const uint32_t corners = p.corner_count();
    const bool triangles = s.triangles();
    t.options = p.options;
    t.face_size = triangles ? 3 : 4;
    t.vertex_count = p.vertex_count + (triangles ? 0 : p.face_count) + p.edge_count;
    t.face_count = triangles ? 4 * p.face_count : corners;
    t.edge_count = corners + 2 * p.edge_count;
    const size_t child_corners = size_t{t.face_size} * t.face_count;
    t.face_vertices.allocate(child_corners);
    t.face_holes.allocate(t.face_count);
    t.vertex_rules.allocate(t.vertex_count);
    if (!full) return;
    t.face_edges.allocate(child_corners);
    t.edge_vertices.allocate(size_t{2} * t.edge_count);
    t.edge_corner_offsets.allocate(size_t{t.edge_count} + 1);
    t.edge_corners.allocate(child_corners);
    t.vertex_corner_offsets.allocate(size_t{t.vertex_count} + 1);
    t.vertex_corners.allocate(child_corners);
    t.vertex_edge_offsets.allocate(size_t{t.vertex_count} + 1);
    t.vertex_edges.allocate(size_t{2} * t.edge_count);
    t.edge_corner_offsets.back() = t.vertex_corner_offsets.back() = static_cast<uint32_t>(child_corners);
    t.vertex_edge_offsets.back() = 2 * t.edge_count;
    t.edge_sharpness.allocate(t.edge_count);
    t.vertex_sharpness.allocate(t.vertex_count);
    t.vertex_manifold.allocate(t.vertex_count);
}

void split_quad_faces(const Split& s, bool full, const BuildPart& part) {
    const Topology& p = s.parent;
    Topology& t = s.child;
    for_each_index(p.face_count, part, [&](uint32_t f) {
        const uint32_t begin = p.face_begin(f), size = p.size_of_face(f);
        for (uint32_t j = 0; j < size; ++j) {
            const uint32_t c = begin + j, previous = begin + (j == 0 ? size : j) - 1;
            const uint32_t q0 = s.quad_corner(c, 0), q1 = s.quad_corner(c, 1), q2 = s.quad_corner(c, 2),
                           q3 = s.quad_corner(c, 3);
            const uint32_t e = p.face_edges[c], e_previous = p.face_edges[previous];
            t.face_vertices[q0] = p.face_vertices[c];
            t.face_vertices[q1] = s.edge_vertex(e);
            t.face_vertices[q2] = s.face_vertex(f);
            t.face_vertices[q3] = s.edge_vertex(e_previous);
            t.face_holes[c] = p.face_holes[f];
            if (!full) continue;
            t.face_edges[q0] = s.half_edge(e, s.end_at_start(c));
            t.face_edges[q1] = c;
            t.face_edges[q2] = previous;
            t.face_edges[q3] = s.half_edge(e_previous, s.end_at_finish(previous));
            // Edge c of the child lies between the children of corner c and of the next one.
            const uint32_t next = j + 1 == size ? begin : c + 1;
            t.edge_vertices[2 * c] = s.face_vertex(f);
            t.edge_vertices[2 * c + 1] = s.edge_vertex(e);
            t.edge_corner_offsets[c] = 2 * c;
            t.edge_corners[2 * c] = q1;
            t.edge_corners[2 * c + 1] = s.quad_corner(next, 2);
            t.edge_sharpness[c] = 0;
            // Around the centre: child j lies between edges j - 1 and j.
            t.vertex_corners[p.corner_count() + c] = q2;
            t.vertex_edges[2 * p.edge_count + c] = previous;
        }
        const uint32_t v = s.face_vertex(f);
        t.vertex_rules[v] = VertexRule::smooth;
        if (!full) return;
        t.vertex_corner_offsets[v] = p.corner_count() + begin;
        t.vertex_edge_offsets[v] = 2 * p.edge_count + begin;
        t.vertex_sharpness[v] = 0;
        t.vertex_manifold[v] = 1;
    });
}

void split_triangle_faces(const Split& s, bool full, const BuildPart& part) {
    const Topology& p = s.parent;
    Topology& t = s.child;
    for_each_index(p.face_count, part, [&](uint32_t f) {
        for (uint32_t j = 0; j < 3; ++j) {
            const uint32_t c = 3 * f + j, previous = 3 * f + (j + 2) % 3;
            const uint32_t e = p.face_edges[c], e_previous = p.face_edges[previous];
            const uint32_t at = Split::triangle_corner(f, j, j), next = Split::triangle_corner(f, j, j + 1),
                           last = Split::triangle_corner(f, j, j + 2);
            const uint32_t centre = Split::triangle_corner(f, 3, j);
            t.face_vertices[at] = p.face_vertices[c];
            t.face_vertices[next] = s.edge_vertex(e);
            t.face_vertices[last] = s.edge_vertex(e_previous);
            t.face_vertices[centre] = s.edge_vertex(p.face_edges[3 * f + (j + 1) % 3]);
            t.face_holes[4 * f + j] = p.face_holes[f];
            if (!full) continue;
            t.face_edges[at] = s.half_edge(e, s.end_at_start(c));
            t.face_edges[next] = c;
            t.face_edges[last] = s.half_edge(e_previous, s.end_at_finish(previous));
            t.face_edges[Split::triangle_corner(f, 3, j + 1)] = c;
            // Edge c cuts off corner c, against the centre.
            t.edge_vertices[2 * c] = s.edge_vertex(e);
            t.edge_vertices[2 * c + 1] = s.edge_vertex(e_previous);
            t.edge_corner_offsets[c] = 2 * c;
            t.edge_corners[2 * c] = next;
            t.edge_corners[2 * c + 1] = Split::triangle_corner(f, 3, j + 1);
            t.edge_sharpness[c] = 0;
        }
        t.face_holes[4 * f + 3] = p.face_holes[f];
    });
}

/// The ring around an edge's child vertex, counter-clockwise: from the half edge at the end of its first
/// corner.
void star_of_edge_vertex(const Split& s, uint32_t e, uint32_t* corners, uint32_t* edges) {
    const Topology& p = s.parent;
    const auto at = p.corners_of_edge(e);
    *edges++ = s.half_edge(e, s.end_at_finish(at[0]));
    for (size_t i = 0; i < at.size(); ++i) {
        if (i == 1) *edges++ = s.half_edge(e, s.end_at_start(at[0]));
        const uint32_t c = at[i], next = p.next_corner(c);
        if (s.triangles()) {
            const uint32_t f = c / 3, j = c % 3;
            *corners++ = Split::triangle_corner(f, (j + 1) % 3, j);
            *corners++ = Split::triangle_corner(f, 3, j + 2);
            *corners++ = Split::triangle_corner(f, j, j + 1);
            *edges++ = next;
            *edges++ = c;
        } else {
            *corners++ = s.quad_corner(next, 3);
            *corners++ = s.quad_corner(c, 1);
            *edges++ = c;
        }
    }
    if (at.size() == 1) *edges++ = s.half_edge(e, s.end_at_start(at[0]));
}

void split_edge_topology(const Split& s, uint32_t e) {
    const Topology& p = s.parent;
    Topology& t = s.child;
    const auto at = p.corners_of_edge(e);
    const auto count = static_cast<uint32_t>(at.size());
    const uint32_t first = p.edge_corner_offsets[e], corners = p.corner_count(), v = s.edge_vertex(e);
    const uint32_t a = p.edge_vertices[2 * e], b = p.edge_vertices[2 * e + 1];
    for (uint32_t end = 0; end < 2; ++end) {
        const uint32_t half = s.half_edge(e, end);
        t.edge_vertices[2 * half] = v;
        t.edge_vertices[2 * half + 1] = end == 0 ? a : b;
        t.edge_corner_offsets[half] = 2 * corners + 2 * first + end * count;
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t c = at[i];
            const bool at_start = s.end_at_start(c) == end;
            uint32_t corner = 0;
            if (s.triangles())
                corner = Split::triangle_corner(c / 3, at_start ? c % 3 : (c + 1) % 3, c % 3);
            else
                corner = at_start ? s.quad_corner(c, 0) : s.quad_corner(p.next_corner(c), 3);
            t.edge_corners[t.edge_corner_offsets[half] + i] = corner;
        }
    }
    if (s.triangles()) {
        t.vertex_corner_offsets[v] = corners + 3 * first;
        t.vertex_edge_offsets[v] = 2 * p.edge_count + 2 * e + 2 * first;
    } else {
        t.vertex_corner_offsets[v] = 2 * corners + 2 * first;
        t.vertex_edge_offsets[v] = 2 * p.edge_count + corners + 2 * e + first;
    }
    star_of_edge_vertex(s, e, t.vertex_corners.data() + t.vertex_corner_offsets[v],
                        t.vertex_edges.data() + t.vertex_edge_offsets[v]);
    t.vertex_sharpness[v] = 0;
    const bool opposite = count < 2 || p.face_vertices[at[0]] != p.face_vertices[at[1]];
    t.vertex_manifold[v] = count <= 2 && opposite && a != b;
}

void split_edges(const Split& s, bool full, const BuildPart& part) {
    const Topology& p = s.parent;
    Topology& t = s.child;
    for_each_index(p.edge_count, part, [&](uint32_t e) {
        t.vertex_rules[s.edge_vertex(e)] = child_rule_of_edge(p, e);
        if (!full) return;
        for (uint32_t end = 0; end < 2; ++end)
            t.edge_sharpness[s.half_edge(e, end)] = p.child_sharpness_of_edge(e, end);
        split_edge_topology(s, e);
    });
}

/// Calls body(edge, end) for each edge around v; a degenerate edge comes twice, end after end.
template <class Body>
void for_each_edge_end(const Topology& t, uint32_t v, const Body& body) {
    uint32_t previous = kInvalidIndex;
    for (const uint32_t e : t.edges_of_vertex(v)) {
        body(e, e == previous || t.edge_vertices[2 * e] != v ? 1u : 0u);
        previous = e;
    }
}

void split_vertices(const Split& s, bool full, const BuildPart& part) {
    const Topology& p = s.parent;
    Topology& t = s.child;
    for_each_index(p.vertex_count, part, [&](uint32_t v) {
        const float sharpness = child_sharpness(p.vertex_sharpness[v]);
        t.vertex_rules[v] = child_rule_of_vertex(p, v);
        if (!full) return;
        t.vertex_sharpness[v] = sharpness;
        t.vertex_manifold[v] = p.vertex_manifold[v];
        t.vertex_corner_offsets[v] = p.vertex_corner_offsets[v];
        t.vertex_edge_offsets[v] = p.vertex_edge_offsets[v];
        uint32_t at = p.vertex_corner_offsets[v];
        for (const uint32_t c : p.corners_of_vertex(v))
            t.vertex_corners[at++] =
                s.triangles() ? Split::triangle_corner(c / 3, c % 3, c % 3) : s.quad_corner(c, 0);
        at = p.vertex_edge_offsets[v];
        for_each_edge_end(p, v,
                          [&](uint32_t e, uint32_t end) { t.vertex_edges[at++] = s.half_edge(e, end); });
    });
    t.dependent_vertices = p.dependent_vertices;
    t.dependent_seam_sharpness = p.dependent_seam_sharpness;
    for (float& sharpness : t.dependent_seam_sharpness) sharpness = child_sharpness(sharpness);
}

}  // namespace

VertexRule child_rule_of_vertex(const Topology& p, uint32_t v) {
    uint32_t sharp = 0;
    for_each_edge_end(p, v,
                      [&](uint32_t e, uint32_t end) { sharp += p.child_sharpness_of_edge(e, end) > 0; });
    const size_t pair = p.find_dependent(v);
    if (pair == Topology::kNotDependent) return vertex_rule(child_sharpness(p.vertex_sharpness[v]), sharp);
    const uint32_t leader = p.dependent_vertices[2 * pair + 1];
    const VertexRule rule = child_rule_of_vertex(p, leader);
    const bool released = p.vertex_rules[leader] == VertexRule::corner && rule != VertexRule::corner;
    return released && p.dependent_seam_sharpness[pair] > 0 ? VertexRule::corner : rule;
}

VertexRule child_rule_of_edge(const Topology& p, uint32_t e) {
    if (p.edge_sharpness[e] <= 0) return VertexRule::smooth;
    return vertex_rule(0, (p.child_sharpness_of_edge(e, 0) > 0) + (p.child_sharpness_of_edge(e, 1) > 0));
}

void refine_once(const Topology& parent, bool full, Topology& child, const BuildPart& part) {
    const Split split{parent, child};
    allocate_common(split, full);
    if (split.triangles())
        split_triangle_faces(split, full, part.part(0, 0.4f));
    else
        split_quad_faces(split, full, part.part(0, 0.4f));
    split_edges(split, full, part.part(0.4f, 0.7f));
    split_vertices(split, full, part.part(0.7f, 0.9f));
    if (full) build_half_edge_sharpness(child, part.part(0.9f, 1));
}

Topology refine_once(const Topology& parent, bool full, const BuildPart& part) {
    Topology child;
    refine_once(parent, full, child, part);
    return child;
}

void copy_half_edge_sharpness(const Topology& uncut, Topology& channel, const BuildPart& part) {
    for_each_in_order(uncut.corner_count(), part, [&](uint32_t c) {
        const uint32_t from = uncut.face_edges[c], to = channel.face_edges[c];
        const uint32_t from_end = uncut.end_at_corner(c), to_end = channel.end_at_corner(c);
        if (is_infinite(channel.edge_sharpness[to])) return;
        channel.half_edge_sharpness[2 * to + to_end] = uncut.half_edge_sharpness[2 * from + from_end];
        channel.half_edge_sharpness[2 * to + 1 - to_end] = uncut.half_edge_sharpness[2 * from + 1 - from_end];
    });
    if (part.is_cancelled()) return;
    for (size_t i = 0; i < channel.dependent_seam_sharpness.size(); ++i) {
        const uint32_t v =
            uncut.face_vertices[channel.corners_of_vertex(channel.dependent_vertices[2 * i])[0]];
        float& largest = channel.dependent_seam_sharpness[i] = 0;
        for (const uint32_t e : uncut.edges_of_vertex(v)) {
            const uint32_t c = uncut.corners_of_edge(e)[0];
            const float sharpness = uncut.child_sharpness_of_edge(e, uncut.edge_vertices[2 * e] == v ? 0 : 1);
            if (is_infinite(channel.edge_sharpness[channel.face_edges[c]]) && !is_infinite(sharpness))
                largest = std::max(largest, sharpness);
        }
    }
}

uint32_t count_sharp_levels(const Topology& level) {
    float largest = 0;
    auto look_at = [&](float s) { largest = is_infinite(s) ? largest : std::max(largest, s); };
    for (const float s : level.edge_sharpness) look_at(s);
    for (const float s : level.vertex_sharpness) look_at(s);
    // A value that has stopped following another stays a corner for one level more.
    const auto& seams = level.dependent_seam_sharpness;
    const bool outlasted = std::any_of(seams.begin(), seams.end(), [](float s) { return s > 0; });
    return static_cast<uint32_t>(std::ceil(largest)) + outlasted;
}

Result<std::vector<LevelCounts>> count_levels(const Topology& base, uint32_t level) {
    constexpr uint64_t kMaxCorners = 0x7fffffff;
    if (level > kMaxRefinementLevel)
        return Error{ErrorCode::invalid_argument, "refinement level " + std::to_string(level) + " is above " +
                                                      std::to_string(kMaxRefinementLevel)};
    std::vector<LevelCounts> counts{
        {base.vertex_count, base.edge_count, base.face_count, base.corner_count()}};
    const bool triangles = base.options.scheme == Scheme::loop;
    for (uint32_t l = 1; l <= level; ++l) {
        const LevelCounts& p = counts.back();
        if (uint64_t{4} * p.corners > kMaxCorners)
            return Error{ErrorCode::too_large, "level " + std::to_string(l) + " of this mesh has " +
                                                   std::to_string(uint64_t{4} * p.corners) +
                                                   " face corners, more than 2^31 - 1"};
        counts.push_back({p.vertices + (triangles ? 0 : p.faces) + p.edges, p.corners + 2 * p.edges,
                          triangles ? 4 * p.faces : p.corners, 4 * p.corners});
    }
    return counts;
}

namespace {

/// What part of the work is done with a level: each has four times the faces of the one before.
float share_of_level(uint32_t level, const RefinementOptions& options) {
    return std::ldexp(1.0f, 2 * (static_cast<int>(level) - static_cast<int>(options.level)));
}

Result<void> refine_levels(const RefinementOptions& options, Refinement& refinement) {
    if (refinement.levels[0].options.scheme == Scheme::doo_sabin)
        return Error{ErrorCode::unsupported,
                     "Doo-Sabin meshes and smooth channels of them are not refined with vertices that stay"};
    if (auto counts = count_levels(refinement.levels[0], options.level); !counts) return counts.error();
    refinement.levels.reserve(options.level + 1);
    Topology uncut;
    for (uint32_t level = 1; level <= options.level; ++level) {
        const BuildPart part =
            options.control.part(share_of_level(level - 1, options), share_of_level(level, options));
        if (!refinement.uncut.empty()) {
            const Topology& before = level == 1 ? refinement.uncut[0] : uncut;
            copy_half_edge_sharpness(before, refinement.levels.back(), part.part(0, 0.1f));
            uncut = refine_once(before, true, part.part(0.1f, 0.5f));
        }
        refinement.levels.push_back(
            refine_once(refinement.last(), level < options.level || options.full_last_level, part.part(0.5f, 1)));
        if (auto ok = part.check(); !ok) return ok;
    }
    return options.control.reach(1);
}

}  // namespace

Result<Refinement> build_refinement(const ControlMesh& mesh, const RefinementOptions& options) {
    if (auto ok = options.control.start(); !ok) return ok.error();
    Refinement refinement;
    refinement.control_count = mesh.vertex_count;
    refinement.levels.push_back(build_topology(mesh, options.control.part(0, share_of_level(0, options))));
    if (auto ok = options.control.check(); !ok) return ok.error();
    if (auto ok = refine_levels(options, refinement); !ok) return ok.error();
    return refinement;
}

Result<Refinement> build_face_varying_refinement(const ControlMesh& mesh, uint32_t channel,
                                                 const RefinementOptions& options) {
    if (channel >= mesh.channels.size())
        return Error{
            ErrorCode::index_out_of_range,
            "face-varying channel " + std::to_string(channel) + " of " + std::to_string(mesh.channels.size()),
            channel};
    if (auto ok = options.control.start(); !ok) return ok.error();
    const BuildPart part = options.control.part(0, share_of_level(0, options));
    Refinement refinement;
    refinement.control_count = mesh.channels[channel].value_count;
    Topology uncut = build_topology(mesh, part.part(0, 0.5f));
    if (auto ok = part.check(); !ok) return ok.error();
    refinement.levels.push_back(
        build_face_varying_topology(mesh, uncut, channel, refinement.control_indices, part.part(0.5f, 0.9f)));
    if (auto ok = part.check(); !ok) return ok.error();
    if (!refinement.levels[0].half_edge_sharpness.empty()) {
        copy_half_edge_sharpness(uncut, refinement.levels[0], part.part(0.9f, 1));
        refinement.uncut.push_back(std::move(uncut));
    }
    if (auto ok = refine_levels(options, refinement); !ok) return ok.error();
    return refinement;
}

}  // namespace limn
