#include "limn/schemes/star_patch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "limn/row_table.h"
#include "limn/schemes/scheme_pass.h"
#include "limn/schemes/star.h"

namespace limn {
namespace {

uint32_t fan_position(std::span<const uint32_t> corners, uint32_t corner) {
    return static_cast<uint32_t>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
}

void push_bits(std::vector<uint32_t>& key, double value) {
    const auto bits = std::bit_cast<uint64_t>(value);
    key.push_back(static_cast<uint32_t>(bits));
    key.push_back(static_cast<uint32_t>(bits >> 32));
}

double largest_interval(const Stage& stage, const StarWalk& walk) {
    double largest = 0;
    for (const uint32_t c : walk.face_corners) {
        const uint32_t f = stage.topology.face_of_corner(c), first = stage.topology.face_begin(f);
        for (uint32_t i = 0; i < stage.topology.size_of_face(f); ++i)
            largest = std::max(largest, stage.intervals[first + i]);
    }
    return largest > 0 ? largest : 1;
}

/// body(corner) for the corners of each walked face, from where it was entered.
template <class Body>
void for_each_walked_corner(const Topology& t, const StarWalk& walk, const Body& body) {
    for (uint32_t c : walk.face_corners)
        for (uint32_t i = t.size_of_face(t.face_of_corner(c)); i-- != 0; c = t.next_corner(c)) body(c);
}

/// Sharp edges between walked faces, from each side; other sharp edges are boundaries of the patch.
template <class Body>
void for_each_sharp_edge(const Topology& t, const StarWalk& walk, const Body& body) {
    auto is_inside = [&](uint32_t corner) {
        const auto vertices = t.vertices_of_face(t.face_of_corner(corner));
        return std::all_of(vertices.begin(), vertices.end(),
                           [&](uint32_t v) { return walk.label(v) != IndexMap::kMissing; });
    };
    for_each_walked_corner(t, walk, [&](uint32_t c) {
        const uint32_t e = t.face_edges[c];
        if (t.edge_sharpness[e] <= 0) return;
        const auto at = t.corners_of_edge(e);
        if (std::any_of(at.begin(), at.end(), [&](uint32_t other) { return other != c && is_inside(other); }))
            body(walk.label(t.face_vertices[c]), walk.label(end_vertex(t, c)), t.edge_sharpness[e]);
    });
}

template <class Body>
void for_each_sharp_vertex(const Topology& t, const StarWalk& walk, uint32_t rings, const Body& body) {
    const uint32_t inner = walk.ring_ends[rings - 1];
    for (uint32_t i = 0; i < inner; ++i)
        if (t.vertex_sharpness[walk.vertices[i]] > 0) body(i, t.vertex_sharpness[walk.vertices[i]]);
}

/// Steps count where a boundary is in reach.
uint32_t step_phase(const Stage& stage, const StarWalk& walk, uint32_t period) {
    if (period < 2) return 0;
    bool open = false;
    for_each_walked_corner(stage.topology, walk, [&](uint32_t c) {
        open = open || is_boundary_edge(stage.topology, stage.topology.face_edges[c]);
    });
    return open ? stage.step % period : 0;
}

ControlMesh mesh_of_walk(const Topology& t, uint32_t rings, const StarWalk& walk) {
    ControlMesh mesh;
    mesh.options = t.options;
    mesh.vertex_count = static_cast<uint32_t>(walk.vertices.size());
    mesh.face_offsets.push_back(0);
    for (uint32_t c : walk.face_corners) {
        for (uint32_t i = t.size_of_face(t.face_of_corner(c)); i-- != 0; c = t.next_corner(c))
            mesh.face_vertices.push_back(walk.label(t.face_vertices[c]));
        mesh.face_offsets.push_back(static_cast<uint32_t>(mesh.face_vertices.size()));
    }
    for_each_sharp_edge(t, walk, [&](uint32_t a, uint32_t b, float sharpness) {
        mesh.crease_edges.insert(mesh.crease_edges.end(), {a, b});
        mesh.crease_sharpness.push_back(sharpness);
    });
    for_each_sharp_vertex(t, walk, rings, [&](uint32_t v, float sharpness) {
        mesh.corner_vertices.push_back(v);
        mesh.corner_sharpness.push_back(sharpness);
    });
    return mesh;
}

/// rows over points -> rows over what those points are rows of.
std::vector<Row> compose_rows(std::vector<Row>&& rows, const std::vector<Row>& points, uint32_t source_count) {
    std::vector<double> sum(source_count, 0.0);
    std::vector<uint32_t> touched;
    for (Row& row : rows) {
        touched.clear();
        for (const RowEntry& entry : row)
            for (const RowEntry& source : points[entry.index]) {
                if (sum[source.index] == 0) touched.push_back(source.index);
                sum[source.index] += entry.weight * source.weight;
            }
        row.clear();
        for (const uint32_t i : touched) {
            if (sum[i] != 0) row.push_back({i, sum[i]});  // else: there already, or cancelled
            sum[i] = 0;
        }
    }
    return std::move(rows);
}

/// How many edges of v are infinitely sharp, boundaries among them; the first one's position.
struct SharpEdges {
    uint32_t count = 0, first = 0;
};
SharpEdges infinitely_sharp_edges(const Topology& t, uint32_t v) {
    SharpEdges sharp;
    const auto edges = t.edges_of_vertex(v);
    for (uint32_t i = 0; i < edges.size(); ++i)
        if (is_infinite(t.edge_sharpness[edges[i]]) && sharp.count++ == 0) sharp.first = i;
    return sharp;
}

/// Boundary vertices in order, counter-clockwise.
std::vector<uint32_t> boundary_loop(const Topology& t) {
    std::vector<uint32_t> next(t.vertex_count, kInvalidIndex), loop;
    uint32_t first = kInvalidIndex;
    for (uint32_t c = 0; c < t.corner_count(); ++c)
        if (is_boundary_edge(t, t.face_edges[c])) {
            next[t.face_vertices[c]] = end_vertex(t, c);
            first = std::min(first, t.face_vertices[c]);
        }
    for (uint32_t v = first; v != kInvalidIndex; v = std::exchange(next[v], kInvalidIndex)) loop.push_back(v);
    if (!loop.empty()) loop.pop_back();  // the first one again
    return loop;
}

}  // namespace

void StarWalk::add_face(const Topology& t, uint32_t corner) {
    face_corners.push_back(corner);
    uint32_t c = corner;
    for (uint32_t i = t.size_of_face(t.face_of_corner(c)); i-- != 0; c = t.next_corner(c)) {
        const auto next = static_cast<uint32_t>(vertices.size());
        if (labels_.find_or_insert(t.face_vertices[c], next) != next) continue;
        vertices.push_back(t.face_vertices[c]);
        entries_.push_back(c);
    }
}

void StarWalk::walk(const Topology& t, StarStart start, uint32_t rings) {
    labels_.clear();
    vertices.clear();
    entries_.clear();
    ring_ends.clear();
    face_corners.clear();
    const uint32_t index = start.element.index;
    if (start.element.is_face) {
        add_face(t, t.face_begin(index) + start.corner);
    } else {
        labels_.find_or_insert(index, 0);
        vertices.push_back(index);
        const auto corners = t.corners_of_vertex(index);
        entries_.push_back(corners.empty() ? kInvalidIndex : corners[start.corner]);
    }
    ring_ends.push_back(static_cast<uint32_t>(vertices.size()));
    for (uint32_t ring = 0, i = 0; ring < rings; ++ring) {
        for (; i < ring_ends[ring]; ++i) {
            const auto corners = t.corners_of_vertex(vertices[i]);
            const auto count = static_cast<uint32_t>(corners.size());
            const uint32_t from = fan_position(corners, entries_[i]);
            for (uint32_t k = 0; k < count; ++k) {
                const uint32_t c = corners[(from + k) % count], f = t.face_of_corner(c);
                if (start.element.is_face && f == index) continue;
                // New, unless a vertex before this one has brought it in.
                const auto of_face = t.vertices_of_face(f);
                if (std::none_of(of_face.begin(), of_face.end(), [&](uint32_t v) { return labels_.find(v) < i; }))
                    add_face(t, c);
            }
        }
        ring_ends.push_back(static_cast<uint32_t>(vertices.size()));
    }
}

bool StarWalk::is_pinched(const Topology& t, uint32_t v) const {
    const auto corners = t.corners_of_vertex(v);
    const auto count = static_cast<uint32_t>(corners.size());
    auto is_walked = [&](uint32_t i) {
        return walked_faces_.find(t.face_of_corner(corners[i % count])) != IndexMap::kMissing;
    };
    const bool boundary = is_boundary_vertex(t, v);
    uint32_t runs = boundary && is_walked(0) ? 1 : 0;
    for (uint32_t i = boundary ? 1 : 0; i < count; ++i) runs += is_walked(i) && !is_walked(i + count - 1);
    return runs > 1;
}

void StarWalk::walk_manifold(const Topology& t, StarStart start, uint32_t rings) {
    walk(t, start, rings);
    walked_faces_.clear();
    auto add_walked = [&](size_t from) {
        for (; from < face_corners.size(); ++from)
            walked_faces_.find_or_insert(t.face_of_corner(face_corners[from]), 0);
    };
    add_walked(0);
    for (uint32_t i = ring_ends[rings - 1]; i < vertices.size(); ++i) {
        if (t.vertex_manifold[vertices[i]] == 0 || !is_pinched(t, vertices[i])) continue;
        const size_t before = face_corners.size();
        for (const uint32_t c : t.corners_of_vertex(vertices[i]))
            if (walked_faces_.find(t.face_of_corner(c)) == IndexMap::kMissing) add_face(t, c);
        add_walked(before);
        i = ring_ends[rings - 1] - 1;  // others may be pinched now
    }
}

std::vector<uint32_t> patch_key(const Stage& stage, Element element, uint32_t period, uint32_t rings,
                                const StarWalk& walk) {
    const Topology& t = stage.topology;
    std::vector<uint32_t> key = {element.is_face, step_phase(stage, walk, period)};
    for (const uint32_t c : walk.face_corners) key.push_back(t.size_of_face(t.face_of_corner(c)));
    for_each_walked_corner(t, walk, [&](uint32_t c) { key.push_back(walk.label(t.face_vertices[c])); });
    for_each_sharp_edge(t, walk, [&](uint32_t a, uint32_t b, float sharpness) {
        key.insert(key.end(), {a, b, std::bit_cast<uint32_t>(sharpness)});
    });
    for_each_sharp_vertex(t, walk, rings, [&](uint32_t v, float sharpness) {
        key.insert(key.end(), {v, std::bit_cast<uint32_t>(sharpness)});
    });
    if (stage.intervals.empty()) return key;
    const double unit = largest_interval(stage, walk);
    for_each_walked_corner(t, walk, [&](uint32_t c) { push_bits(key, stage.intervals[c] / unit); });
    return key;
}

StarStart canonical_start(const Stage& stage, Element element, uint32_t period, uint32_t rings, StarWalk& walk) {
    const Topology& t = stage.topology;
    constexpr uint32_t kMaxTurns = 64;  // around poles equal neighbourhoods may get different keys
    StarStart best{element, 0};
    uint32_t turns = element.is_face ? t.size_of_face(element.index) : face_valence(t, element.index);
    if (!element.is_face && turns != 0) {
        const SharpEdges sharp = infinitely_sharp_edges(t, element.index);
        if (sharp.count >= 2) best.corner = sharp.first % turns;
        if (sharp.count >= 2 || is_boundary_vertex(t, element.index)) turns = 1;
    }
    if (turns > kMaxTurns) turns = 1;
    walk.walk_manifold(t, best, rings);
    if (turns < 2) return best;
    std::vector<uint32_t> least = patch_key(stage, element, period, rings, walk);
    for (uint32_t i = 1; i < turns; ++i) {
        walk.walk_manifold(t, {element, i}, rings);
        std::vector<uint32_t> key = patch_key(stage, element, period, rings, walk);
        if (key >= least) continue;
        least = std::move(key);
        best.corner = i;
    }
    walk.walk_manifold(t, best, rings);
    return best;
}

StarPatch make_patch(const Stage& stage, Element element, uint32_t period, uint32_t rings, const StarWalk& walk) {
    StarPatch patch;
    patch.element = {element.is_face, 0};
    patch.key = patch_key(stage, element, period, rings, walk);
    patch.ring_ends = walk.ring_ends;
    patch.ring_size = walk.ring_ends[element.is_face ? 0 : 1];
    patch.stage.step = step_phase(stage, walk, period);
    patch.stage.topology = build_topology(mesh_of_walk(stage.topology, rings, walk));
    show_all_faces(patch.stage.topology);
    if (stage.intervals.empty()) return patch;
    const double unit = largest_interval(stage, walk);
    for_each_walked_corner(stage.topology, walk,
                           [&](uint32_t c) { patch.stage.intervals.push_back(stage.intervals[c] / unit); });
    return patch;
}

StarPatch extract_patch(const Stage& stage, Element element, uint32_t period, uint32_t rings) {
    StarWalk walk;
    canonical_start(stage, element, period, rings, walk);
    return make_patch(stage, element, period, rings, walk);
}

StageStep refine_stage(Stage&& stage, const SubdivisionScheme& scheme, Element element) {
    StageStep step{std::move(stage), {}, element};
    const uint32_t source_count = step.child.topology.vertex_count;
    for (uint32_t i = 0; i < source_count; ++i) step.rows.push_back({{i, 1.0}});
    for (const Pass& pass : scheme.passes) {
        SplitMesh split = split_mesh(step.child, pass.split, true);
        std::vector<Row> rows(split.point_count());
        for (uint32_t i = 0; i < rows.size(); ++i) pass_row(step.child, pass, split, i, rows[i]);
        step.rows = compose_rows(std::move(rows), step.rows, source_count);
        if (step.element.index != kInvalidIndex) step.element = child_element(pass.split, split, step.element);
        step.child = advance_stage(std::move(step.child), pass, std::move(split), &pass == &scheme.passes.back());
    }
    return step;
}

PatchStep refine_patch(const StarPatch& patch, const SubdivisionScheme& scheme, uint32_t rings) {
    StageStep step = refine_stage(Stage(patch.stage), scheme, patch.element);
    PatchStep out;
    out.exists = step.element.index != kInvalidIndex;
    if (!out.exists) return out;
    StarWalk walk;
    canonical_start(step.child, step.element, scheme.period, rings, walk);
    out.child = make_patch(step.child, step.element, scheme.period, rings, walk);
    for (const uint32_t v : walk.vertices) out.rows.push_back(std::move(step.rows[v]));
    return out;
}

std::vector<double> planar_layout(const Topology& disk) {
    std::vector<double> at(size_t{2} * disk.vertex_count, 0.0), next;
    std::vector<uint8_t> fixed(disk.vertex_count, 0);
    const std::vector<uint32_t> loop = boundary_loop(disk);
    for (size_t i = 0; i < loop.size(); ++i) {
        const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(loop.size());
        fixed[loop[i]] = 1;
        at[2 * size_t{loop[i]}] = std::cos(turn);
        at[2 * size_t{loop[i]} + 1] = std::sin(turn);
    }
    constexpr int kSweeps = 400;  // all at once, so that symmetry is kept
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        next = at;
        for (uint32_t v = 0; v < disk.vertex_count; ++v) {
            const uint32_t n = edge_valence(disk, v);
            if (fixed[v] != 0 || n == 0) continue;
            for (size_t k = 0; k < 2; ++k) {
                double sum = 0;
                for (uint32_t i = 0; i < n; ++i) sum += at[2 * size_t{neighbor(disk, v, i)} + k];
                next[2 * size_t{v} + k] = sum / n;
            }
        }
        std::swap(at, next);
    }
    return at;
}

}  // namespace limn
