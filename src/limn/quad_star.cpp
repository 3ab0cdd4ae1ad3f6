#include "limn/quad_star.h"

#include <algorithm>
#include <bit>

#include "limn/refinement.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

bool is_finite(float sharpness) {
    return sharpness > 0 && !is_infinite(sharpness);
}

}  // namespace

bool QuadStar::has_finite_sharpness() const {
    return is_finite(corner_sharpness) || std::any_of(sharpness.begin(), sharpness.end(), is_finite);
}

void QuadStar::append_to(std::vector<uint32_t>& key) const {
    key.push_back(face_count << 1 | is_closed());
    key.push_back(own);
    key.push_back(opposite);
    key.push_back(std::bit_cast<uint32_t>(corner_sharpness));
    for (const float s : sharpness) key.push_back(std::bit_cast<uint32_t>(s));
}

StarRing::StarRing(const QuadStar& star)
    : edge_count(star.edge_count()),
      has_far_next(star.is_closed() || star.own > 0),
      has_far_previous(star.is_closed() || star.own + 1 < star.face_count) {
    uint32_t next = 1 + edge_count + star.face_count;
    beyond_next = next++;
    side_next = next++;
    beyond_previous = next++;
    side_previous = star.opposite == 3 ? side_next : next++;
    far_next = has_far_next ? next++ : kInvalidIndex;
    far_previous = has_far_previous ? next++ : kInvalidIndex;
    rest = next;
    size = rest + (star.opposite == 3 ? 0 : 2 * star.opposite - 7);
}

void cut_to_sector(QuadStar& star, std::vector<uint32_t>& ring) {
    const auto infinite = std::count_if(star.sharpness.begin(), star.sharpness.end(), is_infinite);
    if (infinite < 2 || star.has_finite_sharpness()) return;
    if (infinite > 2) star.corner_sharpness = kInfiniteSharpness;
    const auto is_bound = [&](uint32_t edge) { return is_infinite(star.sharpness[edge]); };
    // How many faces belong to the sector before the own one, and after.
    const uint32_t edges = star.edge_count();
    uint32_t before = 0, after = 0;
    while (!is_bound(star.edge_after(star.own, edges - before))) ++before;
    while (!is_bound(star.edge_after(star.own, 1 + after))) ++after;
    const uint32_t face_count = before + 1 + after;
    if (!star.is_closed() && face_count == star.face_count) return;

    const StarRing from(star);
    QuadStar cut{std::vector<float>(face_count + 1, 0.0f), star.corner_sharpness, face_count, before, star.opposite};
    cut.sharpness.front() = cut.sharpness.back() = kInfiniteSharpness;
    std::vector<uint32_t> kept(1, ring[0]);
    const uint32_t first = star.edge_after(star.own, edges - before);
    for (uint32_t i = 0; i <= face_count; ++i) kept.push_back(ring[from.edge(star.edge_after(first, i))]);
    const uint32_t first_face = star.face_after(star.own, star.face_count - before);
    for (uint32_t i = 0; i < face_count; ++i) kept.push_back(ring[from.face(star.face_after(first_face, i))]);
    kept.insert(kept.end(), {ring[from.beyond_next], ring[from.side_next], ring[from.beyond_previous]});
    if (star.opposite != 3) kept.push_back(ring[from.side_previous]);
    if (before > 0) kept.push_back(ring[from.far_next]);
    if (after > 0) kept.push_back(ring[from.far_previous]);
    kept.insert(kept.end(), ring.begin() + from.rest, ring.end());
    star = std::move(cut);
    ring = std::move(kept);
}

QuadStar child_star(const QuadStar& star) {
    QuadStar child = star;
    for (float& s : child.sharpness) s = child_sharpness(s);
    child.corner_sharpness = child_sharpness(star.corner_sharpness);
    child.opposite = 4;
    return child;
}

std::optional<QuadPattern> find_pattern(const QuadStar& star) {
    if (star.opposite != 4 || is_finite(star.corner_sharpness)) return {};
    const std::vector<float>& s = star.sharpness;
    const bool is_corner = star.corner_sharpness > 0;
    if (!star.is_closed()) {
        if (star.has_finite_sharpness() || star.face_count != (is_corner ? 1 : 2)) return {};
        return QuadPattern{is_corner ? 9u : star.own == 0 ? 1u : 8u, 0, 0};
    }
    // A crease that passes straight through.
    if (s.size() != 4 || is_corner || s[0] != s[2] || s[1] != s[3] || (s[0] > 0 && s[1] > 0)) return {};
    const float crease = std::max(s[0], s[1]);
    if (is_infinite(crease)) return {};
    return QuadPattern{0, crease, s[1] > 0 ? 3u : 0u};
}

QuadNet star_net(const QuadStar& star, const QuadPattern& pattern, const std::vector<uint32_t>& ring) {
    const StarRing at(star);
    const uint32_t next = at.edge(star.own), previous = at.edge(star.edge_after(star.own, 1));
    QuadNet net;
    net.fill(kInvalidIndex);
    const auto set = [&](uint32_t v, uint32_t u, uint32_t point) { net[4 * v + u] = ring[point]; };
    const auto set_row = [&](uint32_t v, uint32_t a, uint32_t b, uint32_t c) {
        set(v, 1, a);
        set(v, 2, b);
        set(v, 3, c);
    };
    set_row(1, StarRing::corner(), next, at.beyond_next);
    set_row(2, previous, at.face(star.own), at.side_next);
    set_row(3, at.beyond_previous, at.side_previous, at.rest);
    const bool bottom = (pattern.sharp_edges & 1) == 0, left = (pattern.sharp_edges & 8) == 0;
    const uint32_t edges = star.edge_count(), faces = star.face_count;
    if (bottom)
        set_row(0, at.edge(star.edge_after(star.own, edges - 1)), at.face(star.face_after(star.own, faces - 1)),
                at.far_next);
    if (left) {
        set(1, 0, at.edge(star.edge_after(star.own, 2)));
        set(2, 0, at.face(star.face_after(star.own, 1)));
        set(3, 0, at.far_previous);
    }
    if (bottom && left) set(0, 0, at.face(star.face_after(star.own, 2)));
    return net;
}

bool has_quad_stars(const Topology& base) {
    return base.options.scheme == Scheme::catmull_clark && base.half_edge_sharpness.empty() &&
           base.dependent_vertices.empty();
}

namespace {

bool has_duplicates(const std::vector<uint32_t>& ring) {
    // Mostly no two have the same bits.
    std::array<uint64_t, 64> seen{};
    bool may_have = false;
    for (const uint32_t v : ring) {
        const uint32_t hash = v * 2654435769u >> 20;
        may_have |= (seen[hash / 64] >> hash % 64 & 1) != 0;
        seen[hash / 64] |= uint64_t{1} << hash % 64;
    }
    if (!may_have) return false;
    std::vector<uint32_t> sorted = ring;
    std::sort(sorted.begin(), sorted.end());
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

/// What lies around a corner of the base level.
struct CornerView {
    const Topology& base;
    uint32_t corner, face, begin, size;
    std::span<const uint32_t> corners, edges;  ///< around its vertex
    uint32_t own = 0;                          ///< which of `corners` it is

    CornerView(const Topology& t, uint32_t c)
        : base(t),
          corner(c),
          face(face_at(t, c)),
          begin(t.face_begin(face)),
          size(t.size_of_face(face)),
          corners(t.corners_of_vertex(t.face_vertices[c])),
          edges(t.edges_of_vertex(t.face_vertices[c])) {
        while (corners[own] != c) ++own;
    }
    /// The corner some steps on in the face.
    uint32_t after(uint32_t steps) const {
        const uint32_t at = corner - begin + steps;
        return begin + (at < size ? at : at - size);
    }
    uint32_t vertex_after(uint32_t steps) const { return base.face_vertices[after(steps)]; }
    uint32_t edge_child(uint32_t e) const { return child_of_edge(base, e); }
    uint32_t edge_child_after(uint32_t steps) const { return edge_child(base.face_edges[after(steps)]); }
    uint32_t face_child(uint32_t c) const { return child_of_face(base, face_at(base, c)); }
    /// Of the faces some steps around the vertex: the edges that do not touch it, next to its first edge there and to
    /// its last.
    uint32_t first_far_edge(uint32_t steps) const { return base.face_edges[next_in_face(base, around(steps))]; }
    uint32_t last_far_edge(uint32_t steps) const {
        return base.face_edges[previous_in_face(base, previous_in_face(base, around(steps)))];
    }
    uint32_t around(uint32_t steps) const {
        const size_t at = own + steps;
        return corners[at < corners.size() ? at : at - corners.size()];
    }
    uint32_t edge_around(uint32_t steps) const {
        const size_t at = own + steps;
        return edges[at < edges.size() ? at : at - edges.size()];
    }
};

bool is_smooth(const QuadStar& star) {
    return star.is_closed() && star.corner_sharpness == 0 &&
           std::all_of(star.sharpness.begin(), star.sharpness.end(), [](float s) { return s == 0; });
}

/// The star of the base vertex, as it is at level 1, and what lies around it.
void read_star(const CornerView& at, BaseQuad& out) {
    const Topology& t = at.base;
    const auto edges = static_cast<uint32_t>(at.edges.size()), faces = static_cast<uint32_t>(at.corners.size());
    const bool closed = edges == faces;
    const uint32_t n = at.size, first = closed ? at.own : 0;
    QuadStar& star = out.star;
    star.face_count = faces;
    star.own = closed ? 0 : at.own;
    star.opposite = n;
    star.corner_sharpness = child_sharpness(t.vertex_sharpness[t.face_vertices[at.corner]]);
    star.sharpness.resize(edges);
    const StarRing ring(star);
    out.ring.resize(ring.size);
    uint32_t* to = out.ring.data();
    *to++ = t.face_vertices[at.corner];
    for (uint32_t i = 0, k = first; i < edges; ++i, k = k + 1 == edges ? 0 : k + 1) {
        star.sharpness[i] = child_sharpness(t.edge_sharpness[at.edges[k]]);
        *to++ = at.edge_child(at.edges[k]);
    }
    for (uint32_t i = 0, k = first; i < faces; ++i, k = k + 1 == faces ? 0 : k + 1)
        *to++ = at.face_child(at.corners[k]);
    *to++ = at.vertex_after(1);
    *to++ = at.edge_child_after(1);
    *to++ = at.vertex_after(n - 1);
    if (n != 3) *to++ = at.edge_child_after(n - 2);
    if (ring.has_far_next) *to++ = at.edge_child(at.last_far_edge(faces - 1));
    if (ring.has_far_previous) *to++ = at.edge_child(at.first_far_edge(1));
    for (uint32_t k = 2; k + 1 < n; ++k) {
        *to++ = at.vertex_after(k);
        if (k + 2 < n) *to++ = at.edge_child_after(k);
    }
}

/// The same quad seen from the middle of its face, where nothing else is irregular.
void read_from_middle(const CornerView& at, BaseQuad& out) {
    const Topology& t = at.base;
    const uint32_t n = at.size;
    const std::vector<uint32_t> old = out.ring;
    const StarRing ring(out.star);
    out.star = {std::vector<float>(n, 0.0f), 0, n, 0, 4};
    out.corner = 2;
    out.ring.assign(1, child_of_face(t, at.face));
    for (uint32_t k = n - 1; k < 2 * n - 1; ++k) out.ring.push_back(at.edge_child_after(k % n));
    for (uint32_t k = 0; k < n; ++k) out.ring.push_back(at.vertex_after(k));
    for (const uint32_t point :
         {ring.face(1), ring.edge(2), ring.face(3), ring.edge(3), ring.far_previous, ring.far_next, ring.face(2)})
        out.ring.push_back(old[point]);
}

/// A quad whose vertices are all regular.
QuadNet regular_net(const CornerView& at) {
    const auto edge = [&](uint32_t steps) { return at.edge_child(at.edge_around(steps)); };
    const auto face = [&](uint32_t steps) { return at.face_child(at.around(steps)); };
    return {face(2),
            edge(3),
            face(3),
            at.edge_child(at.last_far_edge(3)),
            edge(2),
            at.vertex_after(0),
            edge(0),
            at.vertex_after(1),
            face(1),
            edge(1),
            face(0),
            at.edge_child_after(1),
            at.edge_child(at.first_far_edge(1)),
            at.vertex_after(3),
            at.edge_child_after(2),
            at.vertex_after(2)};
}

}  // namespace

bool find_base_quad(const Topology& base, uint32_t corner, BaseQuad& out) {
    const uint32_t v = base.face_vertices[corner];
    if (base.vertex_manifold[v] == 0) return false;
    const CornerView at(base, corner);
    out.corner = 0;
    const bool closed = at.edges.size() == at.corners.size();
    if (at.size == 4 && closed && at.edges.size() == 4 && base.vertex_rules[v] == VertexRule::smooth) {
        out.pattern = QuadPattern{};
        out.net = regular_net(at);
        return true;
    }
    if (closed && at.edges.size() < 3) return false;
    read_star(at, out);
    if (has_duplicates(out.ring)) return false;
    if (at.size != 4 && out.star.face_count == 4 && is_smooth(out.star))
        read_from_middle(at, out);
    else
        cut_to_sector(out.star, out.ring);
    out.pattern = find_pattern(out.star);
    if (out.pattern) out.net = star_net(out.star, *out.pattern, out.ring);
    return true;
}

}  // namespace limn
