// Edges and stars of oriented manifolds, which nearly all meshes are and all children of splits: everything
// about an edge is known at its ends, whose fans are walked once, on all cores. Gives what build_incidence
// and order_stars give.
#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "limn/topology_build.h"

namespace limn {
namespace {

/// Vertices of more faces are left to the general way, which does not compare all pairs.
constexpr size_t kMostFaces = 4096;

/// The faces around one vertex: the vertices that follow and precede it in each.
struct Fan {
    std::vector<uint32_t> next, previous, corners;

    /// Whether no two edges go to the same vertex.
    bool is_simple() const {
        for (auto edge = next.begin(); edge != next.end(); ++edge)
            if (std::find(next.begin(), edge, *edge) != edge) return false;
        return true;
    }
    /// Where the fan begins: at its boundary, or anywhere.
    size_t find_first() const {
        const auto first = std::find_if(next.begin(), next.end(), [this](uint32_t v) {
            return std::find(previous.begin(), previous.end(), v) == previous.end();
        });
        return first == next.end() ? 0 : static_cast<size_t>(first - next.begin());
    }
    /// The corner at which the edge to this vertex begins, or next.size().
    size_t find_next(uint32_t vertex) const {
        return static_cast<size_t>(std::find(next.begin(), next.end(), vertex) - next.begin());
    }
};

/// Sorts the corners of a vertex counter-clockwise and finds, for each, the corner at which its edge begins
/// in the face beyond (in `twin`; kInvalidIndex at a boundary). False where they are not one fan.
bool order_fan(const Topology& t, std::span<uint32_t> corners, Fan& fan, Array<uint32_t>& twin) {
    const size_t count = corners.size();
    if (count > kMostFaces) return false;
    fan.next.resize(count);
    fan.previous.resize(count);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t c = corners[i], v = t.face_vertices[c];
        const uint32_t next = fan.next[i] = t.face_vertices[next_in_face(t, c)];
        const uint32_t previous = fan.previous[i] = t.face_vertices[previous_in_face(t, c)];
        if (next == v || previous == v || next == previous) return false;
    }
    if (!fan.is_simple()) return false;
    fan.corners.assign(corners.begin(), corners.end());
    size_t at = fan.find_first();
    for (size_t i = 0; i < count; ++i) {
        const uint32_t corner = corners[i] = fan.corners[at];
        const uint32_t vertex = fan.previous[at];
        fan.next[at] = kInvalidIndex;  // not to be found again
        if (i + 1 == count) break;
        at = fan.find_next(vertex);
        if (at == count || face_at(t, fan.corners[at]) == face_at(t, corner)) return false;
        twin[fan.corners[at]] = previous_in_face(t, corner);
    }
    // The last face closes the fan, or ends at another boundary edge.
    const uint32_t last = previous_in_face(t, corners[count - 1]);
    const bool closed = t.face_vertices[last] == t.face_vertices[next_in_face(t, corners[0])];
    if (closed && count == 1) return false;
    twin[corners[0]] = closed ? last : kInvalidIndex;
    return true;
}

/// Orders all fans. False where one is none.
bool order_fans(Topology& t, Array<uint32_t>& twin, const BuildPart& part) {
    std::atomic<bool> fits = true;
    for_each_block(t.vertex_count, part, 256, [&](uint32_t begin, uint32_t end) {
        Fan fan;
        for (uint32_t v = begin; v != end && fits.load(std::memory_order_relaxed); ++v) {
            const uint32_t first = t.vertex_corner_offsets[v], count = t.vertex_corner_offsets[v + 1] - first;
            if (count != 0 && !order_fan(t, {t.vertex_corners.data() + first, count}, fan, twin))
                fits = false;
        }
    });
    return fits;
}

bool begins_edge(uint32_t corner, uint32_t twin) {
    return twin == kInvalidIndex || corner < twin;
}

/// Numbers edges by the corners where they appear first.
void number_edges(Topology& t, const Array<uint32_t>& twin, const BuildPart& part) {
    constexpr uint32_t kBlock = 2048;
    struct Count {
        uint32_t edges = 0, corners = 0;  // before a block
    };
    const uint32_t corners = t.corner_count();
    std::vector<Count> counts(corners / kBlock + 2);
    for_each_block(corners, part.part(0, 0.3f), kBlock, [&](uint32_t begin, uint32_t end) {
        Count& count = counts[begin / kBlock + 1];
        for (uint32_t c = begin; c != end; ++c) {
            if (!begins_edge(c, twin[c])) continue;
            ++count.edges;
            count.corners += twin[c] == kInvalidIndex ? 1 : 2;
        }
    });
    if (part.is_cancelled()) return;
    for (size_t i = 1; i < counts.size(); ++i) {
        counts[i].edges += counts[i - 1].edges;
        counts[i].corners += counts[i - 1].corners;
    }
    t.edge_count = counts.back().edges;
    t.face_edges.allocate(corners);
    t.edge_vertices.allocate(size_t{2} * t.edge_count);
    t.edge_corners.allocate(corners);
    t.edge_corner_offsets.allocate(size_t{t.edge_count} + 1);
    t.edge_corner_offsets.back() = corners;
    for_each_block(corners, part.part(0.3f, 1), kBlock, [&](uint32_t begin, uint32_t end) {
        auto [edge, at] = counts[begin / kBlock];
        for (uint32_t c = begin; c != end; ++c) {
            if (!begins_edge(c, twin[c])) continue;
            t.edge_vertices[2 * size_t{edge}] = t.face_vertices[c];
            t.edge_vertices[2 * size_t{edge} + 1] = t.face_vertices[next_in_face(t, c)];
            t.edge_corner_offsets[edge] = at;
            t.edge_corners[at++] = c;
            t.face_edges[c] = edge;
            if (twin[c] != kInvalidIndex) t.edge_corners[at++] = twin[c];
            if (twin[c] != kInvalidIndex) t.face_edges[twin[c]] = edge;
            ++edge;
        }
    });
}

/// Edges around vertices, from their corners: one more where a fan is open.
void list_vertex_edges(Topology& t, const Array<uint32_t>& twin, const BuildPart& part) {
    t.vertex_edge_offsets.allocate(size_t{t.vertex_count} + 1);
    uint32_t open = 0;
    for_each_in_order(t.vertex_count, part.part(0, 0.3f), [&](uint32_t v) {
        t.vertex_edge_offsets[v] = t.vertex_corner_offsets[v] + open;
        const auto corners = t.corners_of_vertex(v);
        open += !corners.empty() && twin[corners[0]] == kInvalidIndex;
    });
    if (part.is_cancelled()) return;
    t.vertex_edge_offsets.back() = t.corner_count() + open;
    t.vertex_edges.allocate(t.vertex_edge_offsets.back());
    for_each_index(t.vertex_count, part.part(0.3f, 1), [&](uint32_t v) {
        uint32_t at = t.vertex_edge_offsets[v];
        const auto corners = t.corners_of_vertex(v);
        for (const uint32_t c : corners) t.vertex_edges[at++] = t.face_edges[c];
        if (at != t.vertex_edge_offsets[v + 1])
            t.vertex_edges[at] = t.face_edges[previous_in_face(t, corners.back())];
    });
}

}  // namespace

bool build_manifold_incidence(Topology& t, const BuildPart& part) {
    group_by(
        t.corner_count(), t.vertex_count, [&](uint32_t c) { return t.face_vertices[c]; },
        t.vertex_corner_offsets, t.vertex_corners, part.part(0, 0.2f));
    Array<uint32_t> twin;
    twin.allocate(t.corner_count());
    if (!order_fans(t, twin, part.part(0.2f, 0.6f))) return false;
    number_edges(t, twin, part.part(0.6f, 0.8f));
    list_vertex_edges(t, twin, part.part(0.8f, 1));
    return true;
}

}  // namespace limn
