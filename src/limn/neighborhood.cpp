#include "limn/neighborhood.h"

#include <algorithm>
#include <bit>
#include <span>

namespace limn {

namespace {

uint32_t bits(float x) {
    return std::bit_cast<uint32_t>(x);
}

/// A cheap value per corner, so that walks of alike faces start alike: the corner where it is largest.
uint32_t choose_rotation(const Topology& t, uint32_t f, bool mirrored) {
    const uint32_t begin = t.face_begin(f), size = t.size_of_face(f);
    uint32_t best = 0;
    uint64_t best_key = 0;
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t v = t.face_vertices[begin + i];
        const uint32_t e = t.face_edges[begin + (mirrored ? (i + size - 1) % size : i)];
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

/// Positions in a star in the order of a walk: counter-clockwise from the face's own corner where the star is
/// closed, else as listed; mirrored, the other way round.
struct StarOrder {
    uint32_t own, corners, edges;
    bool closed, mirrored;

    uint32_t own_position() const { return closed ? 0 : mirrored ? corners - 1 - own : own; }
    uint32_t corner(uint32_t i) const {
        if (!closed) return mirrored ? corners - 1 - i : i;
        return (mirrored ? own + corners - i : own + i) % corners;
    }
    uint32_t edge(uint32_t i) const {
        if (!closed) return mirrored ? edges - 1 - i : i;
        return (mirrored ? own + 1 + edges - i : own + i) % edges;
    }
};

/// The star, in `t`, of the vertex at `corner`. Its vertices are told as those of `base`, whose corners are
/// the same.
void read_star(const Topology& t, const WalkOptions& options, uint32_t corner, bool mirrored,
               Neighborhood& out) {
    const Topology& base = options.base;
    const uint32_t v = t.face_vertices[corner];
    const auto corners = t.corners_of_vertex(v);
    const auto edges = t.edges_of_vertex(v);
    const StarOrder order{
        static_cast<uint32_t>(std::find(corners.begin(), corners.end(), corner) - corners.begin()),
        static_cast<uint32_t>(corners.size()), static_cast<uint32_t>(edges.size()),
        t.vertex_manifold[v] != 0 && corners.size() == edges.size(), mirrored};
    auto put = [&](uint32_t x) { out.signature.push_back(x); };
    // In refined levels a face-varying value's rule can outlast the sharpness that made it.
    put(order.corners << 3 | static_cast<uint32_t>(t.vertex_rules[v]) << 1 | t.vertex_manifold[v]);
    put(order.edges);
    put(options.with_tangents ? order.own : order.own_position());
    put(bits(t.vertex_sharpness[v]));
    // The edges, which follow below, tell all vertices of a fan of triangles, and of quads all but one each.
    const bool fan = t.vertex_manifold[v] != 0 && t.face_size != 0;
    for (uint32_t i = 0; i < order.corners; ++i) {
        const uint32_t c = corners[order.corner(i)], f = t.face_of_corner(c);
        if (options.list_faces) {
            const auto next_face = static_cast<uint32_t>(out.faces.size());
            if (out.face_map.find_or_insert(f, next_face) == next_face) out.faces.push_back(f);
        }
        if (fan) {
            if (t.face_size == 4) put(out.local(base.face_vertices[(c & ~3u) | ((c + 2) & 3)]));
            continue;
        }
        const uint32_t begin = t.face_begin(f), last = begin + t.size_of_face(f) - 1;
        put(last + 1 - begin);
        for (uint32_t k = begin, at = c; k <= last; ++k) {
            put(out.local(base.face_vertices[at]));
            if (mirrored)
                at = at == begin ? last : at - 1;
            else
                at = at == last ? begin : at + 1;
        }
    }
    for (uint32_t i = 0; i < order.edges; ++i) {
        const uint32_t e = edges[order.edge(i)], c = t.corners_of_edge(e)[0];
        const uint32_t end = t.edge_vertices[2 * e] == v ? 0 : 1;
        const uint32_t other = t.face_vertices[c] == v ? t.next_corner(c) : c;
        put(out.local(base.face_vertices[other]));
        put(bits(t.edge_sharpness[e]));
        if (options.with_tangents) put(t.face_of_corner(c) == out.faces[0]);
        if (t.half_edge_sharpness.empty()) continue;
        put(bits(t.half_edge_sharpness[2 * e + end]));
        put(bits(t.half_edge_sharpness[2 * e + 1 - end]));
    }
}

}  // namespace

void walk_around(const WalkOptions& options, uint32_t f, Orientation orientation, Neighborhood& out) {
    const Topology& t = options.base;
    const bool mirrored = orientation.mirrored;
    out.ring.clear();
    out.faces.assign(1, f);
    out.signature.clear();
    out.map.clear();
    out.face_map.clear();
    out.face_map.find_or_insert(f, 0);
    const uint32_t begin = t.face_begin(f), size = t.size_of_face(f);
    for (uint32_t i = 0; i < size; ++i) out.local(t.face_vertices[begin + orientation.corner(i, size)]);
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t c = begin + orientation.corner(i, size);
        read_star(t, options, c, mirrored, out);
        if (options.uncut != nullptr) read_star(*options.uncut, options, c, mirrored, out);
        const size_t pair = t.find_dependent(t.face_vertices[c]);
        if (pair == Topology::kNotDependent) continue;
        const auto corners = t.corners_of_vertex(t.dependent_vertices[2 * pair + 1]);
        out.signature.push_back(bits(t.dependent_seam_sharpness[pair]));
        read_star(t, options, mirrored ? corners.back() : corners.front(), mirrored, out);
    }
}

namespace {

/// Hashes what a walk around fans meets, word by word; places in the ring go four to a word.
struct FanHash {
    uint64_t a = 0x9e3779b97f4a7c15, b = 0xd1b54a32d192ed03, places = 0;
    uint32_t place_count = 0;

    void put(uint64_t x) {
        a = std::rotl((a ^ x) * 0xff51afd7ed558ccd, 29);
        b = std::rotl(b + x, 31) * 0xc4ceb9fe1a85ec53 ^ b >> 33;
    }
    void put_place(uint32_t place) {
        places = places << 16 | place;
        if ((++place_count & 3) == 0) put(places);
    }
    void end_places() {
        if ((place_count & 3) != 0) put(places);
        places = place_count = 0;
    }
    std::array<uint64_t, 2> result() const {
        const uint64_t x = a ^ b >> 32, y = b ^ x >> 29;
        return {x * 0xff51afd7ed558ccd ^ x >> 32, y * 0xc4ceb9fe1a85ec53 ^ y >> 31};
    }
};

/// What read_star lists of a fan of quads, or triangles, and in its order. `places` are those of the face's
/// vertices, from the star's own on.
void read_fan(const Topology& t, uint32_t corner, const uint32_t (&places)[4], bool regular,
              Neighborhood& out, FanHash& hash) {
    const uint32_t v = t.face_vertices[corner];
    const auto corners = t.corners_of_vertex(v);
    const auto edges = t.edges_of_vertex(v);
    const auto own = static_cast<size_t>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
    // A closed star begins with the face itself.
    const bool closed = corners.size() == edges.size();
    const size_t first = closed ? own : 0;
    auto for_each_of = [&](std::span<const uint32_t> star, size_t skipped, const auto& body) {
        for (size_t i = skipped; i < star.size(); ++i)
            body(star[first + i < star.size() ? first + i : first + i - star.size()]);
    };
    if (t.face_size == 4) {
        if (closed) hash.put_place(places[2]);
        for_each_of(corners, closed ? 1 : 0, [&](uint32_t c) {
            hash.put_place(out.local(t.face_vertices[(c & ~3u) | ((c + 2) & 3)]));
        });
    }
    if (closed) {
        hash.put_place(places[1]);
        hash.put_place(places[t.face_size - 1]);
    }
    for_each_of(edges, closed ? 2 : 0, [&](uint32_t e) { hash.put_place(out.local(t.other_vertex(e, v))); });
    hash.end_places();
    if (regular) return hash.put(0);
    hash.put(1 | uint64_t{static_cast<uint32_t>(t.vertex_rules[v])} << 1 | uint64_t{closed ? 0 : own} << 8 |
             uint64_t{corners.size()} << 24 | uint64_t{edges.size()} << 40);
    hash.put(bits(t.vertex_sharpness[v]));
    for_each_of(edges, 0, [&](uint32_t e) { hash.put(bits(t.edge_sharpness[e])); });
}

}  // namespace

bool walk_around_fans(const Topology& t, uint32_t f, uint32_t rotation, const std::vector<uint8_t>& regular,
                      Neighborhood& out, std::array<uint64_t, 2>& hash) {
    constexpr size_t kMaxEdges = 0x1000;  // places and positions take 16 bits
    if (t.face_size == 0 || !t.half_edge_sharpness.empty() || !t.dependent_vertices.empty()) return false;
    const auto vertices = t.vertices_of_face(f);
    for (const uint32_t v : vertices)
        if (t.vertex_manifold[v] == 0 || t.edges_of_vertex(v).size() > kMaxEdges) return false;
    out.ring.clear();
    out.map.clear();
    const auto size = static_cast<uint32_t>(vertices.size());
    FanHash sum;
    uint32_t own[4];
    for (uint32_t i = 0; i < size; ++i) sum.put_place(own[i] = out.local(vertices[(rotation + i) % size]));
    sum.end_places();
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t k = (rotation + i) % size;
        const uint32_t places[4] = {own[i], own[(i + 1) % size], own[(i + 2) % size], own[(i + 3) % size]};
        read_fan(t, t.face_begin(f) + k, places, regular[vertices[k]] != 0, out, sum);
    }
    hash = sum.result();
    return true;
}

Orientation choose_orientation(const WalkOptions& options, uint32_t f, Neighborhood& scratch,
                               std::array<uint64_t, 2>& hash) {
    const Topology& t = options.base;
    const Orientation straight{choose_rotation(t, f, false), false};
    walk_around(options, f, straight, scratch);
    hash = hash_signature(scratch.signature);
    const auto vertices = t.vertices_of_face(f);
    // Stars that are no fan have no other way round.
    const bool manifold =
        std::all_of(vertices.begin(), vertices.end(), [&](uint32_t v) { return t.vertex_manifold[v] != 0; });
    if (options.with_tangents || !manifold) return straight;
    const Orientation mirrored{choose_rotation(t, f, true), true};
    walk_around(options, f, mirrored, scratch);
    const std::array<uint64_t, 2> other = hash_signature(scratch.signature);
    if (hash <= other) return straight;
    hash = other;
    return mirrored;
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
