#include "limn/plan.h"

#include <algorithm>

#include "limn/local_refinement.h"
#include "limn/patch_points.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Dense rows over the plan's ring, one per vertex of a topology.
using Rows = std::vector<double>;

struct PlanWriter {
    const PlanOptions& options;
    PlanCache::Impl& cache;
    BuiltPlan& plan;
    std::map<std::vector<double>, uint32_t> known;  ///< rows already written

    size_t width() const { return plan.ring_size; }

    uint32_t write_row(const std::vector<double>& row) {
        const auto [at, is_new] = known.try_emplace(row, plan.row_count);
        if (is_new) {
            plan.weights.insert(plan.weights.end(), row.begin(), row.end());
            ++plan.row_count;
        }
        return at->second;
    }

    std::vector<double> combine(const Row& row, const Rows& rows) const {
        std::vector<double> sum(width(), 0.0);
        for (const RowEntry& e : row)
            for (size_t j = 0; j < width(); ++j) sum[j] += e.weight * rows[e.index * width() + j];
        return sum;
    }

    void write_limits(const Topology& t, const Rows& rows) {
        Row row;
        std::vector<TangentWeights> tangents;
        const auto vertices = t.vertices_of_face(0);
        for (const uint32_t v : vertices) {
            row.clear();
            tangents.clear();
            limit_row(t, v, row, tangents);
            const std::vector<double> limit = combine(row, rows);
            // Not write_row: limits are told by their place, also where two are equal.
            plan.weights.insert(plan.weights.end(), limit.begin(), limit.end());
            ++plan.row_count;
        }
    }

    using Net = std::vector<std::vector<double>>;

    void write_patch(uint32_t node, PlanNodeKind kind, const Net& net) {
        plan.nodes[node] = {kind, static_cast<uint32_t>(plan.points.size()), 0, 0};
        for (const auto& row : net) plan.points.push_back(write_row(row));
    }

    uint32_t add_nodes(uint32_t count) {
        const auto first = static_cast<uint32_t>(plan.nodes.size());
        plan.nodes.resize(plan.nodes.size() + count);
        return first;
    }

    /// Lines 0 .. 3 run along the crease, which is line 1. Each step leaves one patch beyond the crease.
    void write_crease(uint32_t node, const PatchPoints& patch, Net net) {
        const bool across_v = patch.crease_edge % 2 == 0;
        const bool at_end = patch.crease_edge == 1 || patch.crease_edge == 2;
        auto entry = [&](size_t line, size_t along) {
            const size_t at = at_end ? 3 - line : line;
            return across_v ? 4 * at + along : 4 * along + at;
        };
        float sharpness = patch.crease_sharpness;
        while (sharpness > 0) {
            const double sharp = std::min(sharpness, 1.0f);
            Net near = net, beyond = net;
            for (size_t along = 0; along < 4; ++along) {
                for (size_t j = 0; j < width(); ++j) {
                    double p[4];
                    for (size_t line = 0; line < 4; ++line) p[line] = net[entry(line, along)][j];
                    const double smooth = (p[0] + 6 * p[1] + p[2]) / 8;
                    const double child[5] = {(p[0] + p[1]) / 2, sharp * p[1] + (1 - sharp) * smooth,
                                             (p[1] + p[2]) / 2, (p[1] + 6 * p[2] + p[3]) / 8,
                                             (p[2] + p[3]) / 2};
                    for (size_t line = 0; line < 4; ++line) {
                        near[entry(line, along)][j] = child[line];
                        beyond[entry(line, along)][j] = child[line + 1];
                    }
                }
            }
            const uint32_t first = add_nodes(2);
            plan.nodes[node] = {across_v ? PlanNodeKind::split_v : PlanNodeKind::split_u, first, 0, 0};
            write_patch(at_end ? first : first + 1, PlanNodeKind::bicubic, beyond);
            node = at_end ? first + 1 : first;
            net = std::move(near);
            sharpness = child_sharpness(sharpness);
        }
        write_patch(node, PlanNodeKind::bicubic, net);
    }

    void write_reference(uint32_t node, const Topology& t, const Rows& rows) {
        Neighborhood hood;
        const uint32_t corner = choose_plan_corner(t, 0);
        walk_around({t}, 0, {corner, false}, hood);
        const auto first = static_cast<uint32_t>(plan.points.size());
        for (const uint32_t v : hood.ring) plan.points.push_back(write_row(combine({{v, 1}}, rows)));
        const uint32_t id = find_or_build_plan(t, hood, corner, options, cache);
        plan.nodes[node] = {PlanNodeKind::plan, first, id, corner};
    }

    /// The surface over face 0 of t, whose vertices are `rows`.
    void expand(uint32_t node, const Topology& t, const Rows& rows, uint32_t depth) {
        PatchPoints patch;
        if (find_patch_points(t, 0, options.linear, patch)) {
            Net net;
            for (uint32_t k = 0; k < patch.count; ++k) net.push_back(combine(patch.points[k], rows));
            if (patch.crease_sharpness > 0) return write_crease(node, patch, std::move(net));
            return write_patch(node, patch.kind, net);
        }
        if (depth == options.depth) return write_reference(node, t, rows);
        if (depth == 0) write_limits(t, rows);
        const Topology child = refine_once(t, true);
        const uint32_t first = add_nodes(4);
        plan.nodes[node] = {PlanNodeKind::split, first, 0, 0};
        for (uint32_t j = 0; j < 4; ++j) {
            std::vector<uint32_t> vertices;
            const Topology part = extract_faces(child, faces_touching_face(child, j), vertices);
            Rows part_rows;
            Row row;
            for (const uint32_t v : vertices) {
                row.clear();
                refinement_row(t, v, Interpolation::vertex, row);
                const std::vector<double> sum = combine(row, rows);
                part_rows.insert(part_rows.end(), sum.begin(), sum.end());
            }
            expand(first + j, part, part_rows, depth + 1);
        }
    }
};

/// Turns face 0 so that its corner `rotation` comes first.
void rotate_first_face(Topology& t, uint32_t rotation) {
    const uint32_t size = t.size_of_face(0);
    std::rotate(t.face_vertices.begin(), t.face_vertices.begin() + rotation, t.face_vertices.begin() + size);
    std::rotate(t.face_edges.begin(), t.face_edges.begin() + rotation, t.face_edges.begin() + size);
    for (Array<uint32_t>* corners : {&t.edge_corners, &t.vertex_corners})
        for (uint32_t& c : *corners)
            if (c < size) c = (c + size - rotation) % size;
}

std::vector<uint32_t> plan_key(const Topology& t, const Neighborhood& hood, const PlanOptions& options) {
    const SchemeOptions& o = t.options;
    std::vector<uint32_t> key{static_cast<uint32_t>(o.scheme),
                              static_cast<uint32_t>(o.creasing),
                              static_cast<uint32_t>(o.triangles),
                              o.opensubdiv_compatible,
                              options.linear,
                              options.depth,
                              static_cast<uint32_t>(hood.ring.size())};
    key.insert(key.end(), hood.signature.begin(), hood.signature.end());
    return key;
}

}  // namespace

uint32_t choose_plan_corner(const Topology& t, uint32_t face) {
    const uint32_t begin = t.face_begin(face), size = t.size_of_face(face);
    const size_t regular = t.options.scheme == Scheme::loop ? 6 : 4;
    uint32_t best = 0;
    size_t most = 0;
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t v = t.face_vertices[begin + i];
        const size_t valence = t.edges_of_vertex(v).size();
        const size_t oddness = size_t{2} * (t.vertex_rules[v] != VertexRule::smooth) + (valence != regular);
        const size_t key = (oddness << 32) + valence + 1;
        if (key > most) {
            most = key;
            best = i;
        }
    }
    return best;
}

uint32_t find_or_build_plan(const Topology& t, const Neighborhood& hood, uint32_t rotation,
                            const PlanOptions& options, PlanCache::Impl& cache) {
    const auto id = static_cast<uint32_t>(cache.plans.size());
    const auto [at, is_new] = cache.ids.try_emplace(plan_key(t, hood, options), id);
    if (!is_new) return at->second;
    // Taken before it is built: plans refer to themselves.
    BuiltPlan& plan = cache.plans.emplace_back();
    plan.ring_size = static_cast<uint32_t>(hood.ring.size());
    std::vector<uint32_t> vertices;
    Topology part = extract_faces(t, hood.faces, vertices);
    rotate_first_face(part, rotation);
    Rows rows(vertices.size() * plan.ring_size, 0.0);
    for (size_t i = 0; i < vertices.size(); ++i) {
        const auto slot = std::find(hood.ring.begin(), hood.ring.end(), vertices[i]) - hood.ring.begin();
        rows[i * plan.ring_size + static_cast<size_t>(slot)] = 1;
    }
    PlanWriter writer{options, cache, plan, {}};
    writer.expand(writer.add_nodes(1), part, rows, 0);
    return id;
}

PlanCache::PlanCache() : impl_(std::make_unique<Impl>()) {}
PlanCache::~PlanCache() = default;
PlanCache::PlanCache(PlanCache&&) noexcept = default;
PlanCache& PlanCache::operator=(PlanCache&&) noexcept = default;

uint32_t PlanCache::size() const {
    const std::lock_guard lock(impl_->mutex);
    return static_cast<uint32_t>(impl_->plans.size());
}

uint64_t PlanCache::bytes() const {
    const std::lock_guard lock(impl_->mutex);
    uint64_t sum = 0;
    for (const auto& [key, id] : impl_->ids) sum += key.size() * sizeof(uint32_t);
    for (const BuiltPlan& plan : impl_->plans)
        sum += plan.weights.size() * sizeof(double) + plan.nodes.size() * sizeof(PlanNode) +
               plan.points.size() * sizeof(uint32_t);
    return sum;
}

}  // namespace limn
