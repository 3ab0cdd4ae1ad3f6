// Face-varying channels as topologies of their own, cut along their seams. The six interpolations are those
// of OpenSubdiv 3.6: they only decide which cut vertices are corners.
#include <algorithm>
#include <vector>

#include "limn/parallel.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Numbers the distinct (vertex, value) pairs and rewrites faces to them. Returns pair ranges per base
/// vertex.
Array<uint32_t> number_pairs(const ControlMesh::Channel& channel, const Topology& base, Topology& t,
                             Array<uint32_t>& control_values, const BuildPart& part) {
    Array<uint32_t> first_pair;
    first_pair.allocate(size_t{base.vertex_count} + 1);
    std::vector<uint32_t> values;
    values.reserve(base.vertex_count);
    for_each_in_order(base.vertex_count, part, [&](uint32_t v) {
        const size_t first = values.size();
        first_pair[v] = static_cast<uint32_t>(first);
        for (const uint32_t c : base.corners_of_vertex(v)) {
            const uint32_t value = channel.face_values[c];
            // Runs of one value are the rule; a linear look back is only for vertices of several values.
            auto at = values.size() > first && values.back() == value
                          ? values.end() - 1
                          : std::find(values.begin() + static_cast<ptrdiff_t>(first), values.end(), value);
            if (at == values.end()) at = values.insert(values.end(), value);
            t.face_vertices[c] = static_cast<uint32_t>(at - values.begin());
        }
    });
    first_pair.back() = t.vertex_count = static_cast<uint32_t>(values.size());
    control_values.allocate(values.size());
    std::copy(values.begin(), values.end(), control_values.begin());
    return first_pair;
}

/// An edge is cut where its faces disagree on the value at either end.
bool is_cut(const Topology& base, const Topology& t, uint32_t e) {
    const auto at = base.corners_of_edge(e);
    for (size_t i = 1; i < at.size(); ++i) {
        const bool same = base.face_vertices[at[0]] == base.face_vertices[at[i]];
        const uint32_t a = t.face_vertices[at[0]], b = t.face_vertices[base.next_corner(at[0])];
        const uint32_t p = t.face_vertices[at[i]], q = t.face_vertices[base.next_corner(at[i])];
        if (same ? a != p || b != q : a != q || b != p) return true;
    }
    return false;
}

/// What a channel's interpolation asks for, spelled out.
struct Rules {
    explicit Rules(const ControlMesh& mesh, FaceVaryingInterpolation i)
        : linear_boundaries(i == FaceVaryingInterpolation::boundaries || i == FaceVaryingInterpolation::all),
          sharp_corners(i != FaceVaryingInterpolation::none),
          sharp_junctions(i == FaceVaryingInterpolation::corners_plus1 ||
                          i == FaceVaryingInterpolation::corners_plus2),
          sharp_both(i == FaceVaryingInterpolation::corners_plus2),
          sharp_darts(sharp_both || linear_boundaries),
          sharpens_mesh_corners(sharp_corners &&
                                mesh.options.boundary != BoundaryInterpolation::edge_and_corner) {}
    bool linear_boundaries;      ///< every vertex of a boundary or seam is a corner
    bool sharp_corners;          ///< a value of a single face is a corner
    bool sharp_junctions;        ///< vertices of three or more values are; of two, one follows the other
    bool sharp_both;             ///< a corner on one side of a seam makes the other side one
    bool sharp_darts;            ///< where a seam ends
    bool sharpens_mesh_corners;  ///< corners of the mesh itself, smooth as vertices
};

/// The channel's topology around one base vertex, with what decides its rules.
struct CutVertex {
    const Topology& base;
    Topology& t;
    const Array<uint8_t>& cut;  ///< per base edge
    uint32_t v, first, count;   ///< base vertex; its pairs

    void make_corners() const {
        for (uint32_t i = 0; i < count; ++i) t.vertex_sharpness[first + i] = kInfiniteSharpness;
    }
    /// Not one fan of faces, or divided by an infinitely sharp edge.
    bool disjoint(uint32_t pair) const {
        if (t.vertex_manifold[pair] == 0) return true;
        const auto edges = t.edges_of_vertex(pair);
        return std::any_of(edges.begin(), edges.end(), [&](uint32_t e) {
            return t.corners_of_edge(e).size() > 1 && is_infinite(t.edge_sharpness[e]);
        });
    }
    bool semi_sharp(uint32_t pair) const {
        const auto edges = t.edges_of_vertex(pair);
        return std::any_of(edges.begin(), edges.end(), [&](uint32_t e) {
            return t.edge_sharpness[e] > 0 && !is_infinite(t.edge_sharpness[e]);
        });
    }
};

/// Sharpens the pairs of one vertex; returns the pair that follows the other, or kInvalidIndex.
uint32_t sharpen_pairs(const Rules& rules, const CutVertex& c) {
    const Topology& base = c.base;
    const auto edges = base.edges_of_vertex(c.v);
    const bool cut = std::any_of(edges.begin(), edges.end(), [&](uint32_t e) { return c.cut[e] != 0; });
    const bool boundary = std::any_of(edges.begin(), edges.end(),
                                      [&](uint32_t e) { return base.corners_of_edge(e).size() < 2; });
    const bool mesh_corner = base.corners_of_vertex(c.v).size() == 1 && rules.sharpens_mesh_corners;
    // Values of sheets that share nothing but the vertex differ although no edge is cut.
    if (!cut && c.count == 1 && !(boundary && (rules.linear_boundaries || mesh_corner))) return kInvalidIndex;

    if (rules.linear_boundaries || is_infinite(base.vertex_sharpness[c.v]) ||
        base.vertex_manifold[c.v] == 0 || (rules.sharp_junctions && c.count > 2) ||
        (rules.sharp_darts && c.count == 1 && !boundary)) {
        c.make_corners();
        return kInvalidIndex;
    }
    const bool pair = rules.sharp_junctions && c.count == 2;
    auto single = [&](uint32_t i) { return c.t.corners_of_vertex(i).size() == 1; };
    if (pair && (c.disjoint(c.first) || c.disjoint(c.first + 1) ||
                 (rules.sharp_both && (single(c.first) || single(c.first + 1))))) {
        c.make_corners();
        return kInvalidIndex;
    }
    for (uint32_t i = c.first; i < c.first + c.count; ++i)
        if (c.disjoint(i) || (rules.sharp_corners && single(i))) c.t.vertex_sharpness[i] = kInfiniteSharpness;
    if (!pair || base.vertex_sharpness[c.v] > 0) return kInvalidIndex;
    const bool semi0 = c.semi_sharp(c.first), semi1 = c.semi_sharp(c.first + 1);
    if (semi0 == semi1) return kInvalidIndex;
    const uint32_t follower = semi0 ? c.first + 1 : c.first;
    return is_infinite(c.t.vertex_sharpness[follower]) ? kInvalidIndex : follower;
}

/// Of the children; with Chaikin creasing copy_half_edge_sharpness has the last word.
float largest_seam_sharpness(const Topology& base, const Array<uint8_t>& cut, uint32_t v) {
    float largest = 0;
    for (const uint32_t e : base.edges_of_vertex(v))
        if (cut[e] != 0 && !is_infinite(base.edge_sharpness[e]))
            largest = std::max(largest, child_sharpness(base.edge_sharpness[e]));
    return largest;
}

void assign_rules(Topology& t, const BuildPart& part) {
    for_each_index(t.vertex_count, part, [&](uint32_t v) {
        uint32_t sharp = 0;
        for (const uint32_t e : t.edges_of_vertex(v)) sharp += t.edge_sharpness[e] > 0;
        t.vertex_rules[v] = vertex_rule(t.vertex_sharpness[v], sharp);
    });
    for (size_t i = 0; i < t.dependent_vertices.size(); i += 2)
        t.vertex_rules[t.dependent_vertices[i]] = t.vertex_rules[t.dependent_vertices[i + 1]];
}

/// Linear everywhere: bilinear rules where faces split to quads; all control edges sharp where they split to
/// triangles.
void make_linear(Topology& t) {
    if (t.options.scheme != Scheme::loop) t.options.scheme = Scheme::bilinear;
    std::fill(t.edge_sharpness.begin(), t.edge_sharpness.end(), kInfiniteSharpness);
    std::fill(t.vertex_sharpness.begin(), t.vertex_sharpness.end(), kInfiniteSharpness);
}

}  // namespace

Topology build_face_varying_topology(const ControlMesh& mesh, const Topology& base, uint32_t channel,
                                     Array<uint32_t>& control_values, const BuildPart& part) {
    Topology t;
    t.options = base.options;
    t.face_count = base.face_count;
    t.face_size = base.face_size;
    t.face_offsets = base.face_offsets;
    t.corner_faces = base.corner_faces;
    t.face_vertices.allocate(base.corner_count());
    const Array<uint32_t> first_pair = number_pairs(mesh.channels[channel], base, t, control_values, part.part(0, 0.1f));

    Array<uint8_t> cut;
    cut.allocate(base.edge_count);
    for_each_index(base.edge_count, part.part(0.1f, 0.2f), [&](uint32_t e) { cut[e] = is_cut(base, t, e); });
    Array<uint32_t> first;
    first.allocate(base.corner_count());
    for_each_index(base.corner_count(), part.part(0.2f, 0.3f), [&](uint32_t c) {
        const uint32_t e = base.face_edges[c];
        first[c] = cut[e] != 0 ? c : base.corners_of_edge(e)[0];
    });
    build_incidence(t, first, part.part(0.3f, 0.6f));
    t.vertex_manifold.allocate(t.vertex_count);
    t.vertex_sharpness.allocate(t.vertex_count);
    for_each_index(base.vertex_count, part.part(0.6f, 0.65f), [&](uint32_t v) {
        for (uint32_t i = first_pair[v]; i < first_pair[v + 1]; ++i) {
            t.vertex_manifold[i] = base.vertex_manifold[v];
            t.vertex_sharpness[i] = base.vertex_sharpness[v];
        }
    });
    order_stars(t, part.part(0.65f, 0.75f));
    t.edge_sharpness.allocate(t.edge_count);
    for_each_index(base.corner_count(), part.part(0.75f, 0.8f), [&](uint32_t c) {
        if (first[c] != c) return;
        const uint32_t e = base.face_edges[c];
        t.edge_sharpness[t.face_edges[c]] = cut[e] != 0 ? kInfiniteSharpness : base.edge_sharpness[e];
    });
    const FaceVaryingInterpolation interpolation = mesh.channels[channel].interpolation;
    const Rules rules(mesh, interpolation);
    std::vector<uint32_t> dependent;
    std::vector<float> seam_sharpness;
    for_each_in_order(base.vertex_count, part.part(0.8f, 0.9f), [&](uint32_t v) {
        const uint32_t count = first_pair[v + 1] - first_pair[v];
        if (count == 0) return;
        const uint32_t follower = sharpen_pairs(rules, {base, t, cut, v, first_pair[v], count});
        if (follower == kInvalidIndex) return;
        dependent.push_back(follower);
        dependent.push_back(2 * first_pair[v] + 1 - follower);
        seam_sharpness.push_back(largest_seam_sharpness(base, cut, v));
    });
    t.dependent_vertices.allocate(dependent.size());
    std::copy(dependent.begin(), dependent.end(), t.dependent_vertices.begin());
    t.dependent_seam_sharpness.allocate(seam_sharpness.size());
    std::copy(seam_sharpness.begin(), seam_sharpness.end(), t.dependent_seam_sharpness.begin());
    if (interpolation == FaceVaryingInterpolation::all) make_linear(t);
    t.vertex_rules.allocate(t.vertex_count);
    assign_rules(t, part.part(0.9f, 0.95f));
    t.face_holes = base.face_holes;
    build_half_edge_sharpness(t, part.part(0.95f, 1));
    return t;
}

}  // namespace limn
