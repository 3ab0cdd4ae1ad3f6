#include "limn/neighborhood.h"

#include <algorithm>
#include <bit>

namespace limn {

namespace {

uint32_t bits(float x) {
    return std::bit_cast<uint32_t>(x);
}

/// A cheap value per corner, so that walks of alike faces start alike: the corner where it is largest.
uint32_t choose_rotation(const Topology& t, uint32_t f) {
    const uint32_t begin = t.face_begin(f), size = t.size_of_face(f);
    uint32_t best = 0;
    uint64_t best_key = 0;
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t v = t.face_vertices[begin + i], e = t.face_edges[begin + i];
        const auto edges = t.edges_of_vertex(v);
        uint64_t sharp = 0;
        for (const uint32_t at : edges) sharp += t.edge_sharpness[at] > 0;
        const uint64_t key = uint64_t{bits(t.vertex_sharpness[v])} * 7 + bits(t.edge_sharpness[e]) +
                             (sharp << 32) + (uint64_t{edges.size()} << 40) +
                             (uint64_t{t.corners_of_vertex(v).size()} << 52);
        if (i != 0 && key <= best_key) continue;
        best = i;
        best_key = key;
    }
    return best;
}

/// The star, in `t`, of the vertex at `corner`: counter-clockwise from that corner where it is closed, else
/// as listed. Its vertices are told as those of `base`, whose corners are the same.
void read_star(const Topology& t, const Topology& base, uint32_t corner, bool with_starts,
               Neighborhood& out) {
    const uint32_t v = t.face_vertices[corner];
    const auto corners = t.corners_of_vertex(v);
    const auto edges = t.edges_of_vertex(v);
    const auto own =
        static_cast<uint32_t>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
    const bool closed = t.vertex_manifold[v] != 0 && corners.size() == edges.size();
    const uint32_t shift = closed ? own : 0;
    auto put = [&](uint32_t x) { out.signature.push_back(x); };
    put(static_cast<uint32_t>(corners.size()) << 1 | t.vertex_manifold[v]);
    put(static_cast<uint32_t>(edges.size()));
    put(with_starts ? own : own - shift);
    put(bits(t.vertex_sharpness[v]));
    for (size_t i = 0; i < corners.size(); ++i) {
        const uint32_t c = corners[(i + shift) % corners.size()], f = t.face_of_corner(c);
        const uint32_t begin = t.face_begin(f), size = t.size_of_face(f);
        const auto next_face = static_cast<uint32_t>(out.faces.size());
        if (out.face_map.find_or_insert(f, next_face) == next_face) out.faces.push_back(f);
        put(size);
        for (uint32_t k = 0, at = c; k < size; ++k, at = at + 1 == begin + size ? begin : at + 1)
            put(out.local(base.face_vertices[at]));
    }
    for (size_t i = 0; i < edges.size(); ++i) {
        const uint32_t e = edges[(i + shift) % edges.size()], c = t.corners_of_edge(e)[0];
        const uint32_t end = t.edge_vertices[2 * e] == v ? 0 : 1;
        const uint32_t other = t.face_vertices[c] == v ? t.next_corner(c) : c;
        put(out.local(base.face_vertices[other]));
        put(bits(t.edge_sharpness[e]));
        if (with_starts) put(t.face_of_corner(c) == out.faces[0]);
        if (t.half_edge_sharpness.empty()) continue;
        put(bits(t.half_edge_sharpness[2 * e + end]));
        put(bits(t.half_edge_sharpness[2 * e + 1 - end]));
    }
}

}  // namespace

void read_neighborhood(const Topology& t, const Topology* uncut, uint32_t f, bool with_starts,
                       Neighborhood& out) {
    out.ring.clear();
    out.faces.assign(1, f);
    out.signature.clear();
    out.map.clear();
    out.face_map.clear();
    out.face_map.find_or_insert(f, 0);
    out.rotation = choose_rotation(t, f);
    const uint32_t begin = t.face_begin(f), size = t.size_of_face(f);
    auto corner = [&](uint32_t i) { return begin + (out.rotation + i) % size; };
    for (uint32_t i = 0; i < size; ++i) out.local(t.face_vertices[corner(i)]);
    for (uint32_t i = 0; i < size; ++i) {
        read_star(t, t, corner(i), with_starts, out);
        if (uncut != nullptr) read_star(*uncut, t, corner(i), with_starts, out);
        const size_t pair = t.find_dependent(t.face_vertices[corner(i)]);
        if (pair == Topology::kNotDependent) continue;
        out.signature.push_back(bits(t.dependent_seam_sharpness[pair]));
        read_star(t, t, t.corners_of_vertex(t.dependent_vertices[2 * pair + 1])[0], with_starts, out);
    }
}

std::array<uint64_t, 2> hash_signature(const std::vector<uint32_t>& signature) {
    uint64_t a = 0x9e3779b97f4a7c15 + signature.size(), b = 0xd1b54a32d192ed03;
    for (const uint32_t x : signature) {
        a = std::rotl((a ^ x) * 0xff51afd7ed558ccd, 29);
        b = std::rotl(b + x, 31) * 0xc4ceb9fe1a85ec53 ^ b >> 33;
    }
    a ^= b >> 32;
    b ^= a >> 29;
    return {a * 0xff51afd7ed558ccd ^ a >> 32, b * 0xc4ceb9fe1a85ec53 ^ b >> 31};
}

}  // namespace limn
