#include "limn/face_numbers.h"

#include <cassert>

namespace limn {
namespace {

/// Slots are in this order: corners; edge by edge level 1, then both halves of levels 2, 3 ...; faces of levels 1, 2 ...
/// (not Loop); and what edges that begin at level m have at the levels l > m.
struct Slots {
    uint32_t n, level;
    bool triangles;

    uint32_t edge(uint32_t k, uint32_t l, uint32_t half) const {
        return n + k * (2 * level - 1) + (l == 1 ? 0 : 2 * l - 3 + half);
    }
    uint32_t faces(uint32_t l) const { return edge(n, 1, 0) + l - 1; }
    uint32_t inner(uint32_t m, uint32_t l) const {
        return edge(n, 1, 0) + (triangles ? 0 : level) + (l - 1) * (l - 2) / 2 + m - 1;
    }
    uint32_t count() const { return inner(1, level + 1); }
};

/// What an edge descends from: an edge of the polygon, or (from n on) all those that begin at level family - n + 1.
struct Descent {
    uint32_t family, offset;
};

struct VertexWord {
    uint32_t slot = 0;
    uint64_t offset = 0;
};

/// For each vertex of the polygon's last level.
std::vector<VertexWord> number_vertices(const Refinement& polygon, const Slots& slots) {
    const Topology& base = polygon.levels[0];
    std::vector<Descent> edges(base.edge_count);
    std::vector<VertexWord> words(base.vertex_count);
    for (uint32_t k = 0; k < slots.n; ++k) {
        edges[base.face_edges[k]] = {k, 0};
        words[base.face_vertices[k]] = {k, 0};
    }
    for (uint32_t l = 1; l <= slots.level; ++l) {
        const Topology& t = polygon.levels[l - 1];
        words.resize(polygon.levels[l].vertex_count);
        for (uint32_t f = 0; !slots.triangles && f < t.face_count; ++f) words[child_of_face(t, f)] = {slots.faces(l), f};
        std::vector<Descent> halves(t.corner_count() + size_t{2} * t.edge_count);
        for (uint32_t c = 0; c < t.corner_count(); ++c) halves[c] = {slots.n + l - 1, c};
        for (uint32_t e = 0; e < t.edge_count; ++e) {
            const auto [family, offset] = edges[e];
            const uint32_t half_size = l >= 2 ? 1u << (l - 2) : 1;
            words[child_of_edge(t, e)] =
                family < slots.n ? VertexWord{slots.edge(family, l, offset / half_size), offset % half_size}
                                 : VertexWord{slots.inner(family - slots.n + 1, l), offset};
            for (uint32_t half = 0; half < 2; ++half) halves[t.corner_count() + 2 * e + half] = {family, 2 * offset + half};
        }
        edges = std::move(halves);
    }
    return words;
}

}  // namespace

Result<FaceNumbers> number_face(const SchemeOptions& options, const Block& block, uint32_t n, uint32_t level) {
    const Slots slots{n, level, options.scheme == Scheme::loop};
    const Error too_large{ErrorCode::unsupported,
                          "a face of " + std::to_string(n) + " corners is too large for refinement face by face"};
    if (n > 200 || slots.count() > 1u << (32 - shared::kGridOffsetBits)) return too_large;
    const Refinement polygon = refine_polygon(options, n, level);
    const std::vector<VertexWord> words = number_vertices(polygon, slots);
    for (const VertexWord& w : words)
        if (w.offset >> shared::kGridOffsetBits != 0) return too_large;
    FaceNumbers out;
    out.slot_count = slots.count();
    for (const std::vector<uint32_t>& corners : block.turned) {
        std::vector<uint32_t>& turned = out.words.emplace_back();
        for (const uint32_t corner : corners) {
            const VertexWord& w = words[polygon.last().face_vertices[corner]];
            turned.push_back(w.slot << shared::kGridOffsetBits | static_cast<uint32_t>(w.offset));
        }
    }
    return out;
}

void write_face_slots(const Topology& base, const std::vector<LevelCounts>& counts, uint32_t level, uint32_t face,
                      std::span<uint32_t> slots) {
    const uint32_t begin = base.face_begin(face), n = base.size_of_face(face);
    const Slots at{n, level, base.options.scheme == Scheme::loop};
    const uint32_t sides = at.triangles ? 3 : 4;
    // The first child of an edge at the next level, and the child vertex of an edge.
    auto half_of = [&](uint32_t l, uint32_t e, uint32_t half) { return counts[l].corners + 2 * e + half; };
    auto vertex_of = [&](uint32_t l, uint32_t e) { return counts[l].vertices + (at.triangles ? 0 : counts[l].faces) + e; };
    for (uint32_t k = 0; k < n; ++k) {
        const uint32_t c = begin + k, v = base.face_vertices[c], e = base.face_edges[c];
        slots[k] = base.corners_of_vertex(v)[0] == c ? v : kInvalidIndex;
        const bool owned = base.corners_of_edge(e)[0] == c;
        slots[at.edge(k, 1, 0)] = owned ? vertex_of(0, e) : kInvalidIndex;
        assert(!owned || base.end_at_corner(c) == 0);  // edges run as in their first face, here as in the polygon
        for (uint32_t half = 0; half < 2; ++half) {
            uint32_t edge = half_of(0, e, half);
            for (uint32_t l = 2; l <= level; edge = half_of(l - 1, edge, 0), ++l)
                slots[at.edge(k, l, half)] = owned ? vertex_of(l - 1, edge) : kInvalidIndex;
        }
    }
    uint32_t first_face = face, first_corner = begin;  // of level l - 1
    for (uint32_t l = 1; l <= level; ++l) {
        if (!at.triangles) slots[at.faces(l)] = counts[l - 1].vertices + first_face;
        uint32_t edge = first_corner;  // of level l
        for (uint32_t born = l + 1; born <= level; edge = half_of(born - 1, edge, 0), ++born)
            slots[at.inner(l, born)] = vertex_of(born - 1, edge);
        first_face = l == 1 && !at.triangles ? begin : 4 * first_face;
        first_corner = sides * first_face;
    }
}

}  // namespace limn
