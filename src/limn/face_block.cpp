#include "limn/face_block.h"

#include <algorithm>

namespace limn {
namespace {

/// Corner offset q of a block as a walk of another orientation has it: digits of its path down the levels,
/// then its slot.
uint32_t turn_corner(Scheme scheme, uint32_t n, uint32_t level, uint32_t q, Orientation orientation) {
    if (level == 0) return orientation.corner(q, n);
    const uint32_t sides = scheme == Scheme::loop ? 3 : 4;
    // The children of an n-gon have orientations of their own, which mirroring turns around their first
    // corner.
    const bool polygon = scheme != Scheme::loop && n != 4;
    const Orientation inner = polygon ? Orientation{0, orientation.mirrored} : orientation;
    auto turn = [&](uint32_t digit) { return digit < sides ? inner.corner(digit, sides) : digit; };
    uint32_t out = turn(q % sides), scale = sides, path = q / sides;
    for (uint32_t i = polygon ? 1 : 0; i < level; ++i, path /= 4, scale *= 4) out += turn(path % 4) * scale;
    return polygon ? out + orientation.corner(path, n) * scale : out;
}

/// For each vertex of a refined polygon the side of the polygon that it lies on, or kInvalidIndex.
std::vector<uint32_t> sides_of_vertices(const Refinement& polygon) {
    const Topology& base = polygon.levels[0];
    std::vector<uint32_t> edges(base.edge_count), vertices(base.vertex_count, kInvalidIndex);
    for (uint32_t e = 0; e < base.edge_count; ++e) edges[e] = e;
    for (uint32_t l = 0; l + 1 < polygon.level_count(); ++l) {
        const Topology& t = polygon.levels[l];
        std::vector<uint32_t> child_edges(t.corner_count() + size_t{2} * t.edge_count, kInvalidIndex);
        vertices.resize(polygon.levels[l + 1].vertex_count, kInvalidIndex);
        for (uint32_t e = 0; e < t.edge_count; ++e) {
            vertices[child_of_edge(t, e)] = edges[e];
            child_edges[t.corner_count() + 2 * e] = child_edges[t.corner_count() + 2 * e + 1] = edges[e];
        }
        edges = std::move(child_edges);
    }
    return vertices;
}

}  // namespace

Refinement refine_polygon(const SchemeOptions& options, uint32_t n, uint32_t level) {
    std::vector<uint32_t> polygon(n);
    for (uint32_t i = 0; i < n; ++i) polygon[i] = i;
    ControlMeshDescription description;
    description.options = options;
    description.vertex_count = n;
    description.face_sizes = {&n, 1};
    description.face_vertices = polygon;
    const Result<ControlMesh> mesh = ControlMesh::create(description);
    return std::move(*build_refinement(*mesh, {level, false}));
}

Block build_block(const SchemeOptions& options, uint32_t n, uint32_t level) {
    const Refinement refinement = refine_polygon(options, n, level);
    const Topology& last = refinement.last();
    const std::vector<uint32_t> sides = sides_of_vertices(refinement);
    Block block;
    block.turned.resize(size_t{2} * n);
    std::vector<bool> seen(last.vertex_count);
    for (uint32_t q = 0; q < last.corner_count(); ++q) {
        const uint32_t v = last.face_vertices[q];
        if (seen[v]) continue;
        seen[v] = true;
        block.places.push_back(v < n                       ? Place::vertex
                               : sides[v] != kInvalidIndex ? Place::edge
                                                           : Place::inside);
        block.sides.push_back(v < n ? v : sides[v]);
        for (uint32_t s = 0; s < 2 * n; ++s)
            block.turned[s].push_back(turn_corner(options.scheme, n, level, q, {s % n, s >= n}));
    }
    return block;
}

}  // namespace limn
