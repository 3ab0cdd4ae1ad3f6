#include "limn/schemes/adaptive_faces.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "limn/schemes/star.h"

namespace limn {
namespace {

bool splits_in_four(SplitKind kind) {
    return kind == SplitKind::quads || kind == SplitKind::triangles;
}

const PointBlock* find_block(const SplitMesh& split, Origin origin) {
    for (const PointBlock& block : split.blocks)
        if (block.origin == origin) return &block;
    return nullptr;
}

void note_face_points(const SplitMesh& split, AdaptiveLevel& level) {
    const Topology& t = level.stage.topology;
    level.corner_points.assign(t.corner_count(), kInvalidIndex);
    const PointBlock& points = *find_block(split, Origin::face);
    for (uint32_t i = 0; i < points.count; ++i) {
        const uint32_t f = points.parent(i), begin = t.face_begin(f);
        std::fill_n(level.corner_points.begin() + begin, t.size_of_face(f), points.first + i);
    }
    const PointBlock* ends = find_block(split, Origin::edge_end);
    for (uint32_t i = 0; ends != nullptr && i < ends->count; ++i) {
        // The edge from this end to the third vertex lies beside this point.
        const uint32_t e = ends->parent(i) / 2, v = t.edge_vertices[ends->parent(i)];
        const uint32_t cut = t.corners_of_edge(e)[0];
        const uint32_t beside = t.face_vertices[cut] == v ? t.previous_corner(cut) : t.next_corner(cut);
        level.corner_points[beside] = ends->first + i;
    }
}

/// In the order of split.cpp.
void note_parents(const SplitMesh& split, SplitKind kind, AdaptiveLevel& level) {
    const Topology& t = level.stage.topology;
    Array<uint32_t>& parents = level.child_parents;
    parents.allocate(split.child.face_count);
    if (splits_in_four(kind)) {
        for (uint32_t c = 0; c < parents.size(); ++c)
            parents[c] = kind == SplitKind::triangles ? c / 4 : t.face_of_corner(c);
        return;
    }
    const bool cuts_boundary = level.stage.step % 2 == 1;
    uint32_t child = 0;
    for (uint32_t e = 0; e < t.edge_count; ++e) {
        const bool inside = !is_boundary_edge(t, e);
        uint32_t count = kind == SplitKind::sqrt3 && inside ? 2 : 1;
        if (kind == SplitKind::sqrt2 && !inside && cuts_boundary) count = 0;
        for (; count != 0; --count) parents[child++] = e;
    }
}

/// Splits the faces of `parent` that it takes for face f of the level after it to be there and to be split.
void split_parents(AdaptiveLevel& parent, const Topology& t, SplitKind kind, uint32_t f) {
    const Topology& before = parent.stage.topology;
    if (!splits_in_four(kind)) {
        for (const uint32_t c : before.corners_of_edge(parent.child_parents[f]))
            parent.split[before.face_of_corner(c)] = 1;
        return;
    }
    for (const uint32_t e : t.edges_of_face(f))
        for (const uint32_t c : t.corners_of_edge(e))
            parent.split[parent.child_parents[t.face_of_corner(c)]] = 1;
}

class FaceCollector {
  public:
    FaceCollector(std::span<const AdaptiveLevel> levels, SplitKind kind) : levels_(levels), kind_(kind) {}

    AdaptiveFaces collect() {
        for (level_ = 0; level_ < levels_.size(); ++level_) {
            const Topology& t = topology();
            for (uint32_t f = 0; f < t.face_count; ++f)
                if (is_there(f) && level().split[f] == 0 && t.face_holes[f] == 0) add_leaf(f);
            for (uint32_t e = 0; !splits_in_four(kind_) && e < t.edge_count; ++e) add_half(e);
        }
        return std::move(out_);
    }

  private:
    const AdaptiveLevel& level() const { return levels_[level_]; }
    const Topology& topology() const { return level().stage.topology; }

    bool is_there(uint32_t f) const {
        if (level_ == 0) return true;
        const AdaptiveLevel& before = levels_[level_ - 1];
        const uint32_t parent = before.child_parents[f];
        if (splits_in_four(kind_)) return before.split[parent] != 0;
        const Topology& t = before.stage.topology;
        const auto at = t.corners_of_edge(parent);
        return std::all_of(at.begin(), at.end(),
                           [&](uint32_t c) { return before.split[t.face_of_corner(c)] != 0; });
    }
    /// Whether a midpoint hangs on an edge of a face that stays.
    bool is_cut(uint32_t e) const {
        const auto at = topology().corners_of_edge(e);
        return std::any_of(at.begin(), at.end(),
                           [&](uint32_t c) { return level().split[topology().face_of_corner(c)] != 0; });
    }

    template <class Vertices>
    void add_face(const Vertices& vertices) {
        out_.sizes.push_back(static_cast<uint32_t>(vertices.size()));
        out_.vertices.insert(out_.vertices.end(), vertices.begin(), vertices.end());
        out_.levels.push_back(static_cast<uint8_t>(level_));
    }
    void add(std::initializer_list<uint32_t> vertices) { add_face(vertices); }

    /// Where one of two faces of an edge is split: the triangle between the edge and the point of that face.
    void add_half(uint32_t e) {
        const Topology& t = topology();
        const auto at = t.corners_of_edge(e);
        if (at.size() != 2) return;
        const bool first = level().split[t.face_of_corner(at[0])] != 0;
        if (first == (level().split[t.face_of_corner(at[1])] != 0)) return;
        const uint32_t c = first ? at[0] : at[1];
        add({t.face_vertices[c], end_vertex(t, c), level().corner_points[c]});
    }

    void add_leaf(uint32_t f) {
        const Topology& t = topology();
        ring_.clear();
        size_t cuts = 0;
        for (uint32_t c = t.face_begin(f); splits_in_four(kind_) && c < t.face_begin(f) + t.size_of_face(f);
             ++c) {
            ring_.push_back({t.face_vertices[c], is_cut(t.face_edges[c])
                                                     ? level().first_edge_point + t.face_edges[c]
                                                     : kInvalidIndex});
            cuts += ring_.back().midpoint != kInvalidIndex;
        }
        if (cuts == 0) return add_face(t.vertices_of_face(f));
        if (kind_ == SplitKind::triangles) return add_cut_triangle(cuts);
        if (ring_.size() == 4 && cuts == 2) return add_cut_quad(level().corner_points[t.face_begin(f)]);
        add_fan(level().corner_points[t.face_begin(f)]);
    }

    /// Corner i of the face in hand, going round.
    struct Corner {
        uint32_t vertex, midpoint;  ///< `midpoint` hangs on the edge that begins here; or kInvalidIndex
        bool is_cut() const { return midpoint != kInvalidIndex; }
    };
    const Corner& corner(size_t i) const { return ring_[i % ring_.size()]; }
    size_t find_corner(bool cut) const {
        size_t i = 0;
        while (ring_[i].is_cut() != cut) ++i;
        return i;
    }

    /// Cut towards one, two or three midpoints.
    void add_cut_triangle(size_t cuts) {
        const size_t i = cuts == 1 ? find_corner(true) : cuts == 2 ? find_corner(false) : 0;
        const Corner a = corner(i), b = corner(i + 1), c = corner(i + 2);
        if (cuts == 1) {
            add({a.vertex, a.midpoint, c.vertex});
            add({a.midpoint, b.vertex, c.vertex});
        } else if (cuts == 2) {
            add({b.midpoint, c.vertex, c.midpoint});
            add({a.vertex, b.vertex, b.midpoint});
            add({a.vertex, b.midpoint, c.midpoint});
        } else {
            add({a.vertex, a.midpoint, c.midpoint});
            add({b.vertex, b.midpoint, a.midpoint});
            add({c.vertex, c.midpoint, b.midpoint});
            add({a.midpoint, b.midpoint, c.midpoint});
        }
    }

    /// Kobbelt 1996: two opposite midpoints make two quads; two next to each other make a Y of three.
    void add_cut_quad(uint32_t middle) {
        size_t i = find_corner(true);
        if (i == 0 && ring_[3].is_cut()) i = 3;  // the first of the two, where they are next to each other
        const Corner a = corner(i), b = corner(i + 1), c = corner(i + 2), d = corner(i + 3);
        if (c.is_cut()) {
            add({a.vertex, a.midpoint, c.midpoint, d.vertex});
            add({a.midpoint, b.vertex, c.vertex, c.midpoint});
        } else {
            add({middle, a.midpoint, b.vertex, b.midpoint});
            add({middle, b.midpoint, c.vertex, d.vertex});
            add({middle, d.vertex, a.vertex, a.midpoint});
        }
    }

    /// No quads fill this: triangles around the face point.
    void add_fan(uint32_t middle) {
        for (size_t i = 0; i < ring_.size(); ++i) {
            const uint32_t from = corner(i).vertex, to = corner(i + 1).vertex, cut = corner(i).midpoint;
            if (corner(i).is_cut()) add({middle, from, cut});
            add({middle, corner(i).is_cut() ? cut : from, to});
        }
    }

    std::span<const AdaptiveLevel> levels_;
    SplitKind kind_;
    size_t level_ = 0;
    std::vector<Corner> ring_;
    AdaptiveFaces out_;
};

}  // namespace

void note_split(const SplitMesh& split, SplitKind kind, AdaptiveLevel& level) {
    if (kind != SplitKind::triangles) note_face_points(split, level);
    if (splits_in_four(kind)) level.first_edge_point = find_block(split, Origin::edge)->first;
    note_parents(split, kind, level);
}

void choose_split_faces(std::span<AdaptiveLevel> levels, SplitKind kind, double tolerance) {
    for (AdaptiveLevel& level : levels) {
        level.split.assign(level.stage.topology.face_count, 0);
        for (size_t f = 0; f < level.errors.size(); ++f) level.split[f] = level.errors[f] > tolerance;
    }
    for (size_t l = levels.size(); l-- > 1;)
        for (uint32_t f = 0; f < levels[l].split.size(); ++f)
            if (levels[l].split[f] != 0) split_parents(levels[l - 1], levels[l].stage.topology, kind, f);
}

AdaptiveFaces collect_faces(std::span<const AdaptiveLevel> levels, SplitKind kind) {
    return FaceCollector(levels, kind).collect();
}

}  // namespace limn
