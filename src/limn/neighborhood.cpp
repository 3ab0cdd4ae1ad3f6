#include "limn/neighborhood.h"

#include <algorithm>
#include <bit>

namespace limn {

void IndexMap::clear() {
    count_ = 0;
    if (++stamp_ != 0) return;
    std::fill(stamps_.begin(), stamps_.end(), 0u);
    stamp_ = 1;
}

uint32_t IndexMap::find_or_insert(uint32_t key, uint32_t next) {
    if (2 * (count_ + 1) > keys_.size()) grow();
    const auto mask = static_cast<uint32_t>(keys_.size() - 1);
    for (uint32_t i = (key * 2654435769u) >> 7 & mask;; i = (i + 1) & mask) {
        if (stamps_[i] == stamp_) {
            if (keys_[i] == key) return values_[i];
            continue;
        }
        stamps_[i] = stamp_;
        keys_[i] = key;
        values_[i] = next;
        ++count_;
        return next;
    }
}

void IndexMap::grow() {
    IndexMap larger;
    const size_t size = std::max<size_t>(256, 2 * keys_.size());
    larger.keys_.resize(size);
    larger.values_.resize(size);
    larger.stamps_.assign(size, 0);
    larger.stamp_ = 1;
    for (size_t i = 0; i < keys_.size(); ++i)
        if (stamps_[i] == stamp_) larger.find_or_insert(keys_[i], values_[i]);
    *this = std::move(larger);
}

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

/// The star of the face's vertex at `corner`: counter-clockwise from that corner where it is closed, else as
/// listed.
void read_star(const Topology& t, uint32_t corner, Neighborhood& out) {
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
    put(own - shift);
    put(bits(t.vertex_sharpness[v]));
    for (size_t i = 0; i < corners.size(); ++i) {
        const uint32_t c = corners[(i + shift) % corners.size()], f = t.face_of_corner(c);
        const uint32_t begin = t.face_begin(f), size = t.size_of_face(f);
        put(size);
        for (uint32_t k = 0, at = c; k < size; ++k, at = at + 1 == begin + size ? begin : at + 1)
            put(out.local(t.face_vertices[at]));
    }
    for (size_t i = 0; i < edges.size(); ++i) {
        const uint32_t e = edges[(i + shift) % edges.size()];
        const uint32_t end = t.edge_vertices[2 * e] == v ? 0 : 1;
        put(out.local(t.other_vertex(e, v)));
        put(bits(t.edge_sharpness[e]));
        if (t.half_edge_sharpness.empty()) continue;
        put(bits(t.half_edge_sharpness[2 * e + end]));
        put(bits(t.half_edge_sharpness[2 * e + 1 - end]));
    }
}

}  // namespace

void read_neighborhood(const Topology& t, uint32_t f, Neighborhood& out) {
    out.ring.clear();
    out.signature.clear();
    out.map.clear();
    out.rotation = choose_rotation(t, f);
    const uint32_t begin = t.face_begin(f), size = t.size_of_face(f);
    auto corner = [&](uint32_t i) { return begin + (out.rotation + i) % size; };
    for (uint32_t i = 0; i < size; ++i) out.local(t.face_vertices[corner(i)]);
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t v = t.face_vertices[corner(i)];
        read_star(t, corner(i), out);
        // Rules that follow a vertex elsewhere are not on the walk: such faces share with none.
        if (t.leading_vertex(v) != v) out.signature.push_back(~f);
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
