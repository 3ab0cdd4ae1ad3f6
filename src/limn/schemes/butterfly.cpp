// Zorin, Schroeder and Sweldens 1996, modified Butterfly: interpolates the vertices of triangle meshes.
// Boundaries are four-point curves. Near them there are two rules: boundary vertices count as regular and
// missing points are reflections, or the weights of Zorin, who treats boundary vertices by their number of
// triangles, too.
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

constexpr double kPi = std::numbers::pi;

/// The rule of an interior end of any valence, but 6, for its edge to neighbour i.
void add_interior_end(const Topology& t, uint32_t v, uint32_t i, double weight, Row& row) {
    const uint32_t n = edge_valence(t, v);
    auto ring_weight = [n](uint32_t j) {
        if (n == 3) return j == 0 ? 5.0 / 12 : -1.0 / 12;
        if (n == 4) return j == 0 ? 3.0 / 8 : j == 2 ? -1.0 / 8 : 0.0;
        const double turn = 2 * kPi * j / n;
        return (0.25 + std::cos(turn) + std::cos(2 * turn) / 2) / n;
    };
    add(row, v, weight * 0.75);
    for (uint32_t j = 0; j < n; ++j) add(row, neighbor(t, v, (i + j) % n), weight * ring_weight(j));
}

/// The same for a boundary vertex with k triangles, but 3 (Zorin's table).
void add_boundary_end(const Topology& t, uint32_t v, uint32_t i, double weight, Row& row) {
    const uint32_t k = face_valence(t, v);
    const double theta = kPi / k, at = i * theta;
    const double first = std::cos(at) / 4 - (k == 2 ? 0
                                                    : std::sin(2 * theta) * std::sin(2 * at) /
                                                          (4 * k * (std::cos(theta) - std::cos(2 * theta))));
    add(row, v, weight * (1 - std::sin(theta) * std::sin(at) / (k * (1 - std::cos(theta)))));
    add(row, neighbor(t, v, 0), weight * first);
    add(row, neighbor(t, v, k), -weight * first);
    for (uint32_t j = 1; j < k; ++j) {
        const double angle = j * theta;
        add(row, neighbor(t, v, j),
            weight * (std::sin(at) * std::sin(angle) + std::sin(2 * at) * std::sin(2 * angle) / 2) / k);
    }
}

/// Zorin's weights for an edge between regular ends, one of them or both on the boundary. An ear is a
/// triangle at two boundary edges.
void add_regular_at_boundary(const Topology& t, uint32_t e, Row& row) {
    const uint32_t a = t.edge_vertices[2 * e], b = t.edge_vertices[2 * e + 1];
    const auto at = t.corners_of_edge(e);
    auto is_open = [&](uint32_t c) { return is_boundary_edge(t, t.face_edges[c]); };
    if (is_boundary_vertex(t, a) && is_boundary_vertex(t, b)) {
        add(row, a, 0.5);
        add(row, b, 0.5);
        for (const uint32_t c : at) {
            const uint32_t inner = opposite_corner(t, c);
            if (!is_open(t.next_corner(c)) || !is_open(t.previous_corner(c))) continue;
            add(row, apex_vertex(t, inner), 0.25);
            add_apex_across(t, t.next_corner(inner), -0.125, row);
            add_apex_across(t, t.previous_corner(inner), -0.125, row);
        }
        return;
    }
    // The boundary end has four edges, and this is its second or third: one wing is missing.
    const uint32_t boundary = is_boundary_vertex(t, a) ? a : b, inside = boundary == a ? b : a;
    for (const uint32_t c : at) {
        const bool outwards = t.face_vertices[c] == boundary;
        const uint32_t near =
            outwards ? t.previous_corner(c) : t.next_corner(c);  // the edge at the boundary end
        const uint32_t far = outwards ? t.next_corner(c) : t.previous_corner(c);
        if (is_open(near)) {
            add(row, apex_vertex(t, c), 1.0 / 16);
            add_apex_across(t, far, -1.0 / 16, row);
        } else {
            add(row, apex_vertex(t, c), 3.0 / 16);
            add_apex_across(t, near, -1.0 / 16, row);
            add_apex_across(t, far, -1.0 / 8, row);
        }
    }
    add(row, boundary, 3.0 / 8);
    add(row, inside, 5.0 / 8);
}

using AddEnd = void (*)(const Topology& t, uint32_t v, uint32_t i, double weight, Row& row);

/// The mean of the rules of the irregular ends of edge e; false where there are none. `boundary_end` null:
/// boundary vertices are regular.
bool add_irregular_ends(const Topology& t, uint32_t e, AddEnd boundary_end, Row& row) {
    AddEnd rules[2];
    for (uint32_t end = 0; end < 2; ++end) {
        const uint32_t v = t.edge_vertices[2 * e + end];
        if (is_boundary_vertex(t, v))
            rules[end] = face_valence(t, v) == 3 ? nullptr : boundary_end;
        else
            rules[end] = edge_valence(t, v) == 6 ? nullptr : add_interior_end;
    }
    const double weight = rules[0] != nullptr && rules[1] != nullptr ? 0.5 : 1;
    for (uint32_t end = 0; end < 2; ++end) {
        const uint32_t v = t.edge_vertices[2 * e + end];
        if (rules[end] != nullptr) rules[end](t, v, edge_position(t, v, e), weight, row);
    }
    return rules[0] != nullptr || rules[1] != nullptr;
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    if (is_boundary_edge(t, e)) return four_point_boundary_edge(p, e, row);
    if (add_irregular_ends(t, e, nullptr, row)) return;
    eight_point_edge(p, e, row);
}

void zorin_edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    if (is_boundary_edge(t, e)) return four_point_boundary_edge(p, e, row);
    if (add_irregular_ends(t, e, add_boundary_end, row)) return;
    if (is_boundary_vertex(t, t.edge_vertices[2 * e]) || is_boundary_vertex(t, t.edge_vertices[2 * e + 1]))
        return add_regular_at_boundary(t, e, row);
    eight_point_edge(p, e, row);
}

}  // namespace

void eight_point_edge(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    for (const uint32_t c : t.corners_of_edge(e)) {
        add(row, t.face_vertices[c], 1.0 / 2);
        add(row, apex_vertex(t, c), 1.0 / 8);
        add_apex_across(t, t.next_corner(c), -1.0 / 16, row);
        add_apex_across(t, t.previous_corner(c), -1.0 / 16, row);
    }
}

std::span<const Pass> butterfly_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {keep_vertex, nullptr, edge_row}}};
    return passes;
}
std::span<const Pass> butterfly_zorin_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {keep_vertex, nullptr, zorin_edge_row}}};
    return passes;
}

}  // namespace limn::schemes
