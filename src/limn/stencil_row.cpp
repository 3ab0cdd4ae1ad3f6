#include "limn/stencil_row.h"

#include "limn/topology_build.h"

namespace limn {
namespace {

void add(Row& row, uint32_t index, double weight) {
    if (weight != 0) row.push_back({index, weight});
}

void add_centroid(const Topology& p, uint32_t f, double weight, Row& row) {
    const auto vertices = p.vertices_of_face(f);
    for (const uint32_t v : vertices) add(row, v, weight / static_cast<double>(vertices.size()));
}

uint32_t quad_vertex(const Topology& p, uint32_t corner, uint32_t turn) {
    return p.face_vertices[(corner & ~3u) | ((corner + turn) & 3u)];
}

uint32_t triangle_vertex(const Topology& p, uint32_t corner, uint32_t turn) {
    const uint32_t at = corner % 3;
    return p.face_vertices[corner - at + (at + turn) % 3];
}

/// Appends so many entries.
RowEntry* extend(Row& row, size_t count) {
    row.resize(row.size() + count);
    return row.data() + row.size() - count;
}

/// The smooth edge point, faces by faces; its ends also take `crease` / 2 each.
void add_edge_point(const Topology& p, uint32_t e, double smooth, Row& row) {
    const uint32_t a = p.edge_vertices[2 * e], b = p.edge_vertices[2 * e + 1];
    const auto at = p.corners_of_edge(e);
    const double crease = (1 - smooth) / 2;
    if (p.options.scheme == Scheme::loop) {
        RowEntry* to = extend(row, 2 + at.size());
        for (const uint32_t v : {a, b}) *to++ = {v, crease + smooth * 0.375};
        for (const uint32_t c : at) *to++ = {triangle_vertex(p, c, 2), smooth * 0.125};
    } else if (p.face_size == 4) {
        RowEntry* to = extend(row, 2 + 2 * at.size());
        for (const uint32_t v : {a, b}) *to++ = {v, crease + smooth * 0.375};
        for (const uint32_t c : at)
            for (const uint32_t turn : {2u, 3u}) *to++ = {quad_vertex(p, c, turn), smooth / 16};
    } else {
        const uint32_t f0 = p.face_of_corner(at[0]), f1 = p.face_of_corner(at[1]);
        const double face = edge_face_weight(p.options.triangles, p.size_of_face(f0), p.size_of_face(f1));
        add(row, a, crease + smooth * (0.5 - face));
        add(row, b, crease + smooth * (0.5 - face));
        add_centroid(p, f0, smooth * face, row);
        add_centroid(p, f1, smooth * face, row);
    }
}

void edge_row(const Topology& p, uint32_t e, bool linear, Row& row) {
    const double smooth =
        linear ? 0 : edge_smooth_share(p.options, p.edge_sharpness[e], child_rule_of_edge(p, e));
    if (smooth != 0 && p.corners_of_edge(e).size() == 2) return add_edge_point(p, e, smooth, row);
    add(row, p.edge_vertices[2 * e], 0.5);
    add(row, p.edge_vertices[2 * e + 1], 0.5);
}

void add_smooth_vertex(const Topology& p, uint32_t v, double share, Row& row) {
    const auto corners = p.corners_of_vertex(v);
    const auto valence = static_cast<uint32_t>(corners.size());
    const VertexMask mask = smooth_vertex_mask(p.options.scheme, valence);
    if (p.options.scheme == Scheme::loop) {
        RowEntry* to = extend(row, 1 + corners.size());
        *to++ = {v, share * mask.vertex};
        for (const uint32_t c : corners) *to++ = {triangle_vertex(p, c, 1), share * mask.edge};
    } else if (p.face_size == 4) {
        RowEntry* to = extend(row, 1 + 2 * corners.size());
        *to++ = {v, share * (mask.vertex + valence * mask.face / 4)};
        for (const uint32_t c : corners) {
            *to++ = {quad_vertex(p, c, 1), share * (mask.edge + mask.face / 2)};
            *to++ = {quad_vertex(p, c, 2), share * mask.face / 4};
        }
    } else {
        add(row, v, share * mask.vertex);
        for (const uint32_t e : p.edges_of_vertex(v)) add(row, p.other_vertex(e, v), share * mask.edge);
        for (const uint32_t c : corners) add_centroid(p, p.face_of_corner(c), share * mask.face, row);
    }
}

/// Calls body(edge, end at v) around v; a degenerate edge comes twice.
template <class Body>
void for_each_edge(const Topology& p, uint32_t v, const Body& body) {
    for (const uint32_t e : p.edges_of_vertex(v)) body(e, p.edge_vertices[2 * e] == v ? 0u : 1u);
}

/// The crease through the first and last sharp edge, as sharpness is in the parent or will be in the child.
void add_crease_vertex(const Topology& p, uint32_t v, bool in_child, double share, Row& row) {
    uint32_t first = kInvalidIndex, last = kInvalidIndex;
    for_each_edge(p, v, [&](uint32_t e, uint32_t end) {
        if ((in_child ? p.child_sharpness_of_edge(e, end) : p.edge_sharpness[e]) <= 0) return;
        if (first == kInvalidIndex) first = e;
        last = e;
    });
    add(row, v, share * 0.75);
    add(row, p.other_vertex(first, v), share * 0.125);
    add(row, p.other_vertex(last, v), share * 0.125);
}

void add_vertex_of_rule(const Topology& p, uint32_t v, VertexRule rule, bool in_child, double share,
                        Row& row) {
    if (share == 0) return;
    if (rule == VertexRule::corner)
        add(row, v, share);
    else if (rule == VertexRule::crease)
        add_crease_vertex(p, v, in_child, share, row);
    else
        add_smooth_vertex(p, v, share, row);
}

double parent_share(const Topology& p, uint32_t v) {
    const uint32_t leader = p.leading_vertex(v);
    std::vector<float> parent, child;
    for_each_edge(p, leader, [&](uint32_t e, uint32_t end) {
        parent.push_back(p.edge_sharpness[e]);
        child.push_back(p.child_sharpness_of_edge(e, end));
    });
    const float sharpness = p.vertex_sharpness[leader];
    return vertex_parent_share(sharpness, child_sharpness(sharpness), parent, child);
}

void vertex_row(const Topology& p, uint32_t v, bool linear, Row& row) {
    if (linear) return add(row, v, 1);
    const VertexRule rule = p.vertex_rules[v];
    if (rule == VertexRule::smooth || rule == VertexRule::dart) return add_smooth_vertex(p, v, 1, row);
    const VertexRule child_rule = child_rule_of_vertex(p, v);
    if (rule == child_rule) return add_vertex_of_rule(p, v, rule, false, 1, row);
    const double share = parent_share(p, v);
    add_vertex_of_rule(p, v, rule, false, share, row);
    add_vertex_of_rule(p, v, child_rule, true, 1 - share, row);
}

/// Around a vertex whose faces form no single fan: position by rule, tangents along the sides of its first
/// face.
void non_manifold_limit_row(const Topology& t, uint32_t v, Row& row, std::vector<TangentWeights>& tangents) {
    auto append = [&](uint32_t index, double weight, double tangent1, double tangent2) {
        row.push_back({index, weight});
        tangents.push_back({tangent1, tangent2});
    };
    const uint32_t c = t.corners_of_vertex(v)[0];
    const bool crease = t.vertex_rules[v] == VertexRule::crease && t.options.scheme != Scheme::bilinear;
    append(v, crease ? 2.0 / 3 : 1.0, -1, -1);
    append(t.face_vertices[t.next_corner(c)], 0, 1, 0);
    append(t.face_vertices[t.previous_corner(c)], 0, 0, 1);
    if (!crease) return;
    for (const uint32_t e : t.edges_of_vertex(v))
        if (t.edge_sharpness[e] > 0) append(t.other_vertex(e, v), 1.0 / 6, 0, 0);
}

LimitStar limit_star(const Topology& t, uint32_t v) {
    LimitStar star;
    const auto edges = t.edges_of_vertex(v);
    star.rule = t.vertex_rules[v];
    star.edge_count = static_cast<uint32_t>(edges.size());
    star.face_count = static_cast<uint32_t>(t.corners_of_vertex(v).size());
    for (uint32_t i = 0; i < star.edge_count; ++i) {
        if (t.edge_sharpness[edges[i]] <= 0) continue;
        if (star.sharp_edge_count < 2) star.sharp_edges[star.sharp_edge_count] = i;
        ++star.sharp_edge_count;
        star.infinite_dart = star.rule == VertexRule::dart && is_infinite(t.edge_sharpness[edges[i]]);
    }
    return star;
}

}  // namespace

void refinement_row(const Topology& p, uint32_t child, Interpolation interpolation, Row& row) {
    const bool linear = interpolation == Interpolation::varying || p.options.scheme == Scheme::bilinear;
    const uint32_t first_edge_child = child_of_edge(p, 0);
    if (child < p.vertex_count)
        vertex_row(p, child, linear, row);
    else if (child < first_edge_child)
        add_centroid(p, child - p.vertex_count, 1, row);
    else
        edge_row(p, child - first_edge_child, linear, row);
}

void limit_row(const Topology& t, uint32_t v, Row& row, std::vector<TangentWeights>& tangents) {
    auto append = [&](uint32_t index, double weight, double tangent1, double tangent2) {
        if (weight == 0 && tangent1 == 0 && tangent2 == 0) return;
        row.push_back({index, weight});
        tangents.push_back({tangent1, tangent2});
    };
    const auto corners = t.corners_of_vertex(v);
    const auto edges = t.edges_of_vertex(v);
    if (corners.empty()) return append(v, 1, 0, 0);
    if (t.vertex_manifold[v] == 0) return non_manifold_limit_row(t, v, row, tangents);
    const LimitStar star = limit_star(t, v);
    const size_t edge_count = edges.size(), face_count = corners.size();
    std::vector<double> storage(3 * (edge_count + face_count), 0.0);
    auto mask_at = [&](size_t i) {
        double* begin = storage.data() + i * (edge_count + face_count);
        return LimitMask{0, {begin, edge_count}, {begin + edge_count, face_count}};
    };
    LimitMask position = mask_at(0), tangent1 = mask_at(1), tangent2 = mask_at(2);
    limit_position_mask(t.options, star, position);
    limit_tangent_masks(t.options, star, tangent1, tangent2);
    append(v, position.vertex, tangent1.vertex, tangent2.vertex);
    for (size_t i = 0; i < edge_count; ++i)
        append(t.other_vertex(edges[i], v), position.edge[i], tangent1.edge[i], tangent2.edge[i]);
    if (t.face_size != 4) return;
    for (size_t i = 0; i < face_count; ++i)
        append(quad_vertex(t, corners[i], 2), position.face[i], tangent1.face[i], tangent2.face[i]);
}

}  // namespace limn
