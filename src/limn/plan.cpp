#include "limn/plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "limn/gregory.h"
#include "limn/local_refinement.h"
#include "limn/patch_points.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Dense rows over the plan's ring for the vertices of a topology.
struct VertexRows {
    size_t width;
    std::vector<double> values;

    double* row(uint32_t v) { return values.data() + v * width; }
    const double* row(uint32_t v) const { return values.data() + v * width; }
    void add(const Row& row, double* sum) const {
        for (const RowEntry& e : row) {
            const double* from = values.data() + e.index * width;
            for (size_t j = 0; j < width; ++j) sum[j] += e.weight * from[j];
        }
    }
};

/// The rows of the level after `parent`, made where they are asked for.
struct ChildRows {
    const Topology& parent;
    const VertexRows& parent_rows;
    VertexRows rows;
    std::vector<uint8_t> made;
    Row scratch;

    ChildRows(const Topology& t, const VertexRows& r, uint32_t count)
        : parent(t),
          parent_rows(r),
          rows{r.width, std::vector<double>(count * r.width, 0.0)},
          made(count, 0) {}
    const double* row(uint32_t v) {
        if (made[v] == 0) {
            made[v] = 1;
            scratch.clear();
            refinement_row(parent, v, Interpolation::vertex, scratch);
            parent_rows.add(scratch, rows.row(v));
        }
        return rows.row(v);
    }
};

struct PlanWriter {
    const PlanOptions& options;
    const KnownPlans& known;
    NewPlan& out;
    BuiltPlan& plan;
    std::unordered_multimap<uint64_t, uint32_t> rows_by_hash = {};

    size_t width() const { return plan.ring_size; }
    size_t stride() const { return shared::plan_row_stride(plan.ring_size); }

    uint32_t append_row(const double* row) {
        plan.weights.insert(plan.weights.end(), row, row + width());
        plan.weights.resize(++plan.row_count * stride(), 0.0);
        return plan.row_count - 1;
    }
    uint32_t write_row(double* row) {
        uint64_t hash = 0;
        for (size_t j = 0; j < width(); ++j) {
            row[j] += 0.0;  // no negative zeros
            hash = (hash ^ std::bit_cast<uint64_t>(row[j])) * 0x9e3779b97f4a7c15 ^ hash >> 29;
        }
        const auto [begin, end] = rows_by_hash.equal_range(hash);
        for (auto at = begin; at != end; ++at)
            if (std::memcmp(row, plan.weights.data() + at->second * stride(), width() * sizeof(double)) == 0)
                return at->second;
        const uint32_t number = append_row(row);
        rows_by_hash.emplace(hash, number);
        return number;
    }

    void write_corner_rows(const Topology& t, const VertexRows& rows);

    /// Rows of a patch's points, one after the other.
    using Net = std::vector<double>;

    template <class Rows>
    Net make_net(const PatchPoints& patch, Rows& rows) const {
        Net net(patch.count * width(), 0.0);
        for (uint32_t k = 0; k < patch.count; ++k)
            add_points(patch.points[k], rows, net.data() + k * width());
        return net;
    }
    template <class Rows>
    void add_points(const Row& row, Rows& rows, double* to) const {
        for (const RowEntry& e : row) {
            const double* from = rows.row(e.index);
            for (size_t j = 0; j < width(); ++j) to[j] += e.weight * from[j];
        }
    }
    void write_patch(uint32_t node, PlanNodeKind kind, Net& net) {
        plan.nodes[node] = {shared::pack_node(static_cast<uint32_t>(kind), 0, 0),
                            static_cast<uint32_t>(plan.points.size())};
        for (size_t at = 0; at < net.size(); at += width()) plan.points.push_back(write_row(net.data() + at));
    }
    uint32_t add_nodes(uint32_t count) {
        const auto first = static_cast<uint32_t>(plan.nodes.size());
        plan.nodes.resize(plan.nodes.size() + count);
        return first;
    }

    void write_crease(uint32_t node, const PatchPoints& patch, Net net);
    template <class Rows>
    void write_leaf(uint32_t node, const PatchPoints& patch, Rows& rows) {
        Net net = make_net(patch, rows);
        if (patch.crease_sharpness > 0) return write_crease(node, patch, std::move(net));
        write_patch(node, patch.kind, net);
    }
    template <class Rows>
    bool write_regular(uint32_t node, const Topology& t, uint32_t face, Rows& rows);
    template <class Rows>
    void write_gregory(uint32_t node, const Topology& t, uint32_t face, Rows& rows);
    void write_reference(uint32_t node, const Topology& t, uint32_t face, ChildRows& rows);
    void split(uint32_t node, const Topology& t, const VertexRows& rows, uint32_t depth);
    void write_root(const Topology& t, const VertexRows& rows);
};

/// The sector around the first corner of face 0: what lies beyond infinitely sharp edges does not matter to
/// the surface there. Its star begins at the same place in every mesh.
Topology cut_sector(const Topology& t, std::vector<uint32_t>& vertices) {
    Topology cut = extract_faces(t, faces_of_sector(t, t.face_begin(0)), vertices);
    const uint32_t v = cut.face_vertices[0];
    std::fill(cut.vertex_manifold.begin(), cut.vertex_manifold.end(), uint8_t{0});
    cut.vertex_manifold[v] = 1;
    std::sort(cut.vertex_corners.begin() + cut.vertex_corner_offsets[v],
              cut.vertex_corners.begin() + cut.vertex_corner_offsets[v + 1]);
    order_stars(cut);
    return cut;
}

/// Turns the tangents of a smooth vertex so that they go along its face's edges.
void align_tangents(const Topology& t, uint32_t v, uint32_t corner, std::vector<TangentWeights>& tangents) {
    const auto corners = t.corners_of_vertex(v);
    const size_t n = corners.size();
    if (t.vertex_rules[v] != VertexRule::smooth || n < 3) return;
    const auto at = static_cast<double>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
    const double theta = 2 * std::numbers::pi / static_cast<double>(n);
    for (TangentWeights& w : tangents) {
        const double x = w.tangent1, y = w.tangent2;
        w.tangent1 = std::cos(at * theta) * x + std::sin(at * theta) * y;
        w.tangent2 = std::cos((at + 1) * theta) * x + std::sin((at + 1) * theta) * y;
    }
}

void PlanWriter::write_corner_rows(const Topology& t, const VertexRows& rows) {
    std::vector<uint32_t> vertices;
    Topology star = cut_sector(t, vertices);
    // A crease that does not bound the sector on both sides is one of the whole star.
    const auto edges = star.edges_of_vertex(star.face_vertices[0]);
    const auto sharp =
        std::count_if(edges.begin(), edges.end(), [&](uint32_t e) { return star.edge_sharpness[e] > 0; });
    if (star.vertex_rules[star.face_vertices[0]] == VertexRule::crease && sharp != 2) {
        star = t;
        vertices.resize(t.vertex_count);
        std::iota(vertices.begin(), vertices.end(), 0u);
    }
    // OpenSubdiv's masks are not those of its rules: a table that used them would be torn at the vertex.
    star.options.opensubdiv_compatible = false;
    const uint32_t v = star.face_vertices[0];
    Row row;
    std::vector<TangentWeights> tangents;
    limit_row(star, v, row, tangents);
    align_tangents(star, v, 0, tangents);
    std::vector<double> sums[3];
    for (auto& sum : sums) sum.assign(width(), 0.0);
    for (size_t i = 0; i < row.size(); ++i) {
        const double* from = rows.row(vertices[row[i].index]);
        const double weights[3] = {row[i].weight, tangents[i].tangent1, tangents[i].tangent2};
        for (size_t k = 0; k < 3; ++k)
            for (size_t j = 0; j < width(); ++j) sums[k][j] += weights[k] * from[j];
    }
    // Told by their place, also where two rows are equal.
    for (const auto& sum : sums) append_row(sum.data());
    plan.has_corner_rows = true;
}

/// Lines 0 .. 3 run along the crease, which is line 1. Each step leaves one patch beyond the crease.
void PlanWriter::write_crease(uint32_t node, const PatchPoints& patch, Net net) {
    const bool across_v = patch.crease_edge % 2 == 0;
    const bool at_end = patch.crease_edge == 1 || patch.crease_edge == 2;
    auto entry = [&](size_t line, size_t along) {
        const size_t at = at_end ? 3 - line : line;
        return across_v ? 4 * at + along : 4 * along + at;
    };
    const PlanNodeKind kind = across_v ? PlanNodeKind::split_v : PlanNodeKind::split_u;
    float sharpness = patch.crease_sharpness;
    while (sharpness > 0) {
        const double sharp = std::min(sharpness, 1.0f);
        Net near = net, beyond = net;
        for (size_t along = 0; along < 4; ++along) {
            for (size_t j = 0; j < width(); ++j) {
                double p[4];
                for (size_t line = 0; line < 4; ++line) p[line] = net[entry(line, along) * width() + j];
                const double smooth = (p[0] + 6 * p[1] + p[2]) / 8;
                const double child[5] = {(p[0] + p[1]) / 2, sharp * p[1] + (1 - sharp) * smooth,
                                         (p[1] + p[2]) / 2, (p[1] + 6 * p[2] + p[3]) / 8, (p[2] + p[3]) / 2};
                for (size_t line = 0; line < 4; ++line) {
                    near[entry(line, along) * width() + j] = child[line];
                    beyond[entry(line, along) * width() + j] = child[line + 1];
                }
            }
        }
        const uint32_t first = add_nodes(2);
        plan.nodes[node] = {shared::pack_node(static_cast<uint32_t>(kind), 0, 0), first};
        write_patch(at_end ? first : first + 1, PlanNodeKind::bicubic, beyond);
        node = at_end ? first + 1 : first;
        net = std::move(near);
        sharpness = child_sharpness(sharpness);
    }
    write_patch(node, PlanNodeKind::bicubic, net);
}

void PlanWriter::write_reference(uint32_t node, const Topology& t, uint32_t face, ChildRows& rows) {
    Neighborhood hood;
    const uint32_t corner = choose_plan_corner(t, face);
    walk_around({t}, face, {corner, false}, hood);
    const auto first = static_cast<uint32_t>(plan.points.size());
    std::vector<double> row;
    for (const uint32_t v : hood.ring) {
        const double* from = rows.row(v);
        row.assign(from, from + width());
        plan.points.push_back(write_row(row.data()));
    }
    PlanReference reference{make_plan_key(t, hood, options), {}};
    size_t at = 0;
    while (at < out.references.size() && out.references[at].key != reference.key) ++at;
    plan.nodes[node] = {
        shared::pack_node(static_cast<uint32_t>(PlanNodeKind::plan), static_cast<uint32_t>(at), corner),
        first};
    if (at < out.references.size()) return;
    if (!known.contains(reference.key)) reference.request = request_plan(t, hood, corner, reference.key);
    out.references.push_back(std::move(reference));
}

template <class Rows>
bool PlanWriter::write_regular(uint32_t node, const Topology& t, uint32_t face, Rows& rows) {
    PatchPoints patch;
    if (!find_patch_points(t, face, options.linear, patch)) return false;
    // OpenSubdiv's evaluators know no single-crease patches.
    if (patch.crease_sharpness > 0 && options.end_cap != EndCap::exact) return false;
    write_leaf(node, patch, rows);
    return true;
}

/// Where there is no such patch, the face itself: its corners' limits and what is between them.
template <class Rows>
void PlanWriter::write_gregory(uint32_t node, const Topology& t, uint32_t face, Rows& rows) {
    GregoryPoints gregory;
    const bool triangles = t.options.scheme == Scheme::loop;
    PatchPoints patch;
    if (!find_gregory_points(t, face, gregory)) {
        find_patch_points(t, face, true, patch);
        return write_leaf(node, patch, rows);
    }
    Net net(gregory.count * width(), 0.0);
    for (uint32_t k = 0; k < gregory.count; ++k)
        add_points(gregory.points[k], rows, net.data() + k * width());
    write_patch(node, triangles ? PlanNodeKind::gregory_triangle : PlanNodeKind::gregory, net);
}

/// Face 0 of t, which is no patch.
void PlanWriter::split(uint32_t node, const Topology& t, const VertexRows& rows, uint32_t depth) {
    const Topology child = refine_once(t, true);
    ChildRows child_rows(t, rows, child.vertex_count);
    const uint32_t first = add_nodes(4);
    plan.nodes[node] = {shared::pack_node(static_cast<uint32_t>(PlanNodeKind::split), 0, 0), first};
    for (uint32_t j = 0; j < 4; ++j) {
        if (write_regular(first + j, child, j, child_rows)) continue;
        if (depth + 1 == options.depth) {
            if (options.end_cap == EndCap::exact)
                write_reference(first + j, child, j, child_rows);
            else
                write_gregory(first + j, child, j, child_rows);
        } else {
            std::vector<uint32_t> vertices;
            const Topology part = extract_faces(child, faces_touching_face(child, j), vertices);
            VertexRows part_rows{width(), {}};
            part_rows.values.reserve(vertices.size() * width());
            for (const uint32_t v : vertices) {
                const double* from = child_rows.row(v);
                part_rows.values.insert(part_rows.values.end(), from, from + width());
            }
            split(first + j, part, part_rows, depth + 1);
        }
    }
}

/// Whether rules around the vertices of face 0, which are all that its plan depends on, are still to change.
bool has_fading_rules(const Topology& t) {
    auto is_finite = [](float s) { return s > 0 && !is_infinite(s); };
    auto fades = [&](uint32_t v) {
        const auto edges = t.edges_of_vertex(v);
        return is_finite(t.vertex_sharpness[v]) || std::any_of(edges.begin(), edges.end(), [&](uint32_t e) {
                   return is_finite(t.edge_sharpness[e]);
               });
    };
    const auto vertices = t.vertices_of_face(0);
    return std::any_of(vertices.begin(), vertices.end(), [&](uint32_t v) {
        const size_t pair = t.find_dependent(v);
        return fades(v) || child_rule_of_vertex(t, v) != t.vertex_rules[v] ||
               (pair != Topology::kNotDependent &&
                (t.dependent_seam_sharpness[pair] > 0 || fades(t.dependent_vertices[2 * pair + 1])));
    });
}

void PlanWriter::write_root(const Topology& t, const VertexRows& rows) {
    const uint32_t root = add_nodes(1);
    if (write_regular(root, t, 0, rows)) return;
    if (options.end_cap != EndCap::exact && options.depth == 0) return write_gregory(root, t, 0, rows);
    if (options.end_cap == EndCap::exact && !has_fading_rules(t)) write_corner_rows(t, rows);
    split(root, t, rows, 0);
}

/// Turns face 0 so that its corner `rotation` comes first.
void rotate_first_face(Topology& t, uint32_t rotation) {
    const uint32_t size = t.size_of_face(0);
    std::rotate(t.face_vertices.begin(), t.face_vertices.begin() + rotation, t.face_vertices.begin() + size);
    std::rotate(t.face_edges.begin(), t.face_edges.begin() + rotation, t.face_edges.begin() + size);
    for (Array<uint32_t>* corners : {&t.edge_corners, &t.vertex_corners})
        for (uint32_t& c : *corners)
            if (c < size) c = (c + size - rotation) % size;
}

PlanKey begin_key(const SchemeOptions& o, const PlanOptions& options) {
    return {static_cast<uint32_t>(o.scheme),
            static_cast<uint32_t>(o.creasing),
            static_cast<uint32_t>(o.triangles),
            o.opensubdiv_compatible,
            options.linear,
            options.end_cap != EndCap::exact,
            options.depth};
}

/// Ring points are those of the patch.
void write_regular_plan(PlanNodeKind kind, BuiltPlan& plan) {
    const size_t stride = shared::plan_row_stride(plan.ring_size);
    plan.row_count = plan.ring_size;
    plan.nodes.push_back({shared::pack_node(static_cast<uint32_t>(kind), 0, 0), 0});
    plan.weights.assign(plan.row_count * stride, 0.0);
    for (uint32_t r = 0; r < plan.row_count; ++r) {
        plan.points.push_back(r);
        plan.weights[r * stride + r] = 1;
    }
}

}  // namespace

NewPlan build_plan(const PlanRequest& request, const PlanOptions& options, const KnownPlans& known) {
    NewPlan out;
    BuiltPlan& plan = *out.plan;
    plan.ring_size = request.ring_size;
    if (request.part.face_count == 0) {
        write_regular_plan(request.kind, plan);
        return out;
    }
    VertexRows rows{plan.ring_size, std::vector<double>(request.slots.size() * plan.ring_size, 0.0)};
    for (uint32_t v = 0; v < request.slots.size(); ++v) rows.row(v)[request.slots[v]] = 1;
    PlanWriter writer{options, known, out, plan};
    writer.write_root(request.part, rows);
    return out;
}

PlanRequest request_regular_plan(const SchemeOptions& options, bool linear) {
    const bool triangles = options.scheme == Scheme::loop;
    PlanRequest request;
    request.key =
        begin_key({.scheme = options.scheme}, {linear, EndCap::exact, 0});  // nothing but the scheme matters
    request.ring_size = linear ? (triangles ? 3 : 4) : (triangles ? 12 : 16);
    request.kind = linear ? (triangles ? PlanNodeKind::linear : PlanNodeKind::bilinear)
                          : (triangles ? PlanNodeKind::box_spline : PlanNodeKind::bicubic);
    return request;
}

PlanKey make_plan_key(const Topology& t, const Neighborhood& hood, const PlanOptions& options) {
    PlanKey key = begin_key(t.options, options);
    key.push_back(static_cast<uint32_t>(hood.ring.size()));
    key.insert(key.end(), hood.signature.begin(), hood.signature.end());
    return key;
}

PlanRequest request_plan(const Topology& t, const Neighborhood& hood, uint32_t corner, PlanKey key) {
    PlanRequest request;
    request.key = std::move(key);
    request.ring_size = static_cast<uint32_t>(hood.ring.size());
    std::vector<uint32_t> vertices;
    request.part = extract_faces(t, hood.faces, vertices);
    rotate_first_face(request.part, corner);
    for (const uint32_t v : vertices)
        request.slots.push_back(
            static_cast<uint32_t>(std::find(hood.ring.begin(), hood.ring.end(), v) - hood.ring.begin()));
    return request;
}

uint32_t choose_plan_corner(const Topology& t, uint32_t face) {
    const uint32_t begin = t.face_begin(face), size = t.size_of_face(face);
    uint32_t best = 0;
    size_t most = 0;
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t v = t.face_vertices[begin + i];
        const bool smooth = t.vertex_rules[v] == VertexRule::smooth;
        const size_t oddness = size_t{2} * !is_regular_corner(t, begin + i) + !smooth;
        const size_t key = (oddness << 32) + t.edges_of_vertex(v).size() + 1;
        if (key > most) {
            most = key;
            best = i;
        }
    }
    return best;
}

}  // namespace limn
