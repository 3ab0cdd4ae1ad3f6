// Surfaces are found and walked in parallel; plans are taken from the cache, or built, one after the other.
#include "limn/patch_table.h"

#include <algorithm>
#include <unordered_map>

#include "limn/parallel.h"
#include "limn/patch_points.h"
#include "limn/plan.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// A surface before it has a plan: a face of the base level or of level 1.
struct Candidate {
    uint32_t face, base_face, rotation, ring_size;
    bool refined;
    std::array<uint64_t, 2> hash;
};

struct Builder {
    const Topology& base;
    const Topology& child;  ///< level 1; empty where every face is regular
    PlanOptions options;
    std::vector<Candidate> candidates;

    const Topology& level(const Candidate& c) const { return c.refined ? child : base; }
    void walk(const Candidate& c, Neighborhood& hood) const {
        // Linear surfaces depend on their corners only.
        if (options.linear) {
            const Topology& t = level(c);
            hood.ring.clear();
            hood.map.clear();
            hood.signature.clear();
            hood.faces.assign(1, c.face);
            for (const uint32_t v : t.vertices_of_face(c.face)) hood.signature.push_back(hood.local(v));
            return;
        }
        walk_around({level(c)}, c.face, {c.rotation, false}, hood);
    }
};

std::vector<uint8_t> find_regular_faces(const Topology& base, bool linear) {
    std::vector<uint8_t> regular(base.face_count, 0);
    for_each_index(
        base.face_count,
        [&](uint32_t f) {
            PatchPoints patch;
            regular[f] = base.face_holes[f] == 0 && find_patch_points(base, f, linear, patch);
        },
        64);
    return regular;
}

/// Surfaces in face order, and the ptex faces that they cover.
Array<uint32_t> list_surfaces(const std::vector<uint8_t>& regular, Builder& b) {
    const Topology& base = b.base;
    const bool triangles = base.options.scheme == Scheme::loop;
    const uint32_t own_size = triangles ? 3 : 4;
    std::vector<uint32_t> ptex;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t size = base.size_of_face(f), ptex_count = size == own_size ? 1 : size;
        const auto next = static_cast<uint32_t>(b.candidates.size());
        if (base.face_holes[f] != 0) {
            ptex.insert(ptex.end(), ptex_count, kInvalidIndex);
        } else if (regular[f] != 0) {
            b.candidates.push_back({f, f, 0, 0, false, {}});
            ptex.push_back(next);
        } else {
            const uint32_t first = triangles ? 4 * f : base.face_begin(f), count = triangles ? 4 : size;
            for (uint32_t j = 0; j < count; ++j) b.candidates.push_back({first + j, f, 0, 0, true, {}});
            if (ptex_count == 1)
                ptex.push_back(next | kPtexSplit);
            else
                for (uint32_t j = 0; j < size; ++j) ptex.push_back(next + j);
        }
    }
    Array<uint32_t> out;
    out.allocate(ptex.size());
    std::copy(ptex.begin(), ptex.end(), out.begin());
    return out;
}

void hash_surfaces(Builder& b) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, b.candidates.size(), 64),
                      [&](const tbb::blocked_range<size_t>& r) {
                          Neighborhood hood;
                          for (size_t i = r.begin(); i != r.end(); ++i) {
                              Candidate& c = b.candidates[i];
                              if (!b.options.linear) c.rotation = choose_plan_corner(b.level(c), c.face);
                              b.walk(c, hood);
                              c.hash = hash_signature(hood.signature);
                              c.ring_size = static_cast<uint32_t>(hood.ring.size());
                          }
                      });
}

/// The cache's plan of each surface.
std::vector<uint32_t> find_plans(const Builder& b, PlanCache::Impl& cache) {
    struct Hash {
        size_t operator()(const std::array<uint64_t, 2>& h) const { return h[0]; }
    };
    std::unordered_map<std::array<uint64_t, 2>, uint32_t, Hash> found;
    std::vector<uint32_t> plans;
    Neighborhood hood;
    for (const Candidate& c : b.candidates) {
        const auto [at, is_new] = found.try_emplace(c.hash, 0);
        if (is_new) {
            b.walk(c, hood);
            at->second = find_or_build_plan(b.level(c), hood, c.rotation, b.options, cache);
        }
        plans.push_back(at->second);
    }
    return plans;
}

/// Copies the plans that surfaces need, in the order in which they need them.
template <class Real>
struct PlanCopy {
    const PlanCache::Impl& cache;
    BasicPatchTable<Real>& table;
    std::unordered_map<uint32_t, uint32_t> numbers;
    std::vector<uint32_t> order;

    uint32_t number(uint32_t id) {
        const auto [at, is_new] = numbers.try_emplace(id, static_cast<uint32_t>(order.size()));
        if (is_new) order.push_back(id);
        return at->second;
    }
    Result<void> copy() {
        uint64_t weights = 0, nodes = 0, points = 0;
        for (size_t i = 0; i < order.size(); ++i) {
            const BuiltPlan& plan = cache.plans[order[i]];
            weights += plan.weights.size();
            nodes += plan.nodes.size();
            points += plan.points.size();
            for (const PlanNode& node : plan.nodes)
                if (node.kind == PlanNodeKind::plan) number(node.plan);
        }
        if (weights > kInvalidIndex || points > kInvalidIndex)
            return Error{ErrorCode::too_large, "plans hold 2^32 weights or more"};
        table.plans.allocate(order.size());
        table.plan_weights.allocate(weights);
        table.plan_nodes.allocate(nodes);
        table.plan_points.allocate(points);
        uint32_t weight = 0, node_at = 0, point = 0;
        for (size_t i = 0; i < order.size(); ++i) {
            const BuiltPlan& plan = cache.plans[order[i]];
            table.plans[i] = {plan.ring_size, plan.row_count, weight, node_at, point};
            for (const double w : plan.weights) table.plan_weights[weight++] = static_cast<Real>(w);
            for (PlanNode node : plan.nodes) {
                if (node.kind == PlanNodeKind::plan) node.plan = numbers.at(node.plan);
                table.plan_nodes[node_at++] = node;
            }
            for (const uint32_t p : plan.points) table.plan_points[point++] = p;
        }
        return {};
    }
};

/// Numbers the level-1 vertices that rings hold, in their order, and writes their rows.
template <class Real>
Result<void> build_points(const Builder& b, const Refinement& source, std::vector<uint32_t>& point_of_child,
                          BasicPatchTable<Real>& table) {
    Array<uint32_t> offsets;
    std::vector<uint32_t> indices;
    std::vector<Real> weights;
    std::vector<uint32_t> sizes;
    Row row;
    const Interpolation rules = b.options.linear ? Interpolation::varying : Interpolation::vertex;
    for (uint32_t v = 0; v < point_of_child.size(); ++v) {
        if (point_of_child[v] == kInvalidIndex) continue;
        point_of_child[v] = table.control_count + static_cast<uint32_t>(sizes.size());
        row.clear();
        refinement_row(b.base, v, rules, row);
        const size_t begin = indices.size();
        for (const RowEntry& e : row) {
            const uint32_t index = source.control_indices.empty() ? e.index : source.control_indices[e.index];
            size_t at = begin;
            while (at < indices.size() && indices[at] != index) ++at;
            if (at == indices.size()) {
                indices.push_back(index);
                weights.push_back(0);
            }
            weights[at] += static_cast<Real>(e.weight);
        }
        sizes.push_back(static_cast<uint32_t>(indices.size() - begin));
    }
    if (indices.size() > kInvalidIndex) return Error{ErrorCode::too_large, "2^32 stencil entries or more"};
    BasicStencilTable<Real>& stencils = table.stencils;
    stencils.source_count = table.control_count;
    Array<uint32_t> counts;
    counts.allocate(sizes.size());
    std::copy(sizes.begin(), sizes.end(), counts.begin());
    stencils.offsets = offsets_from_counts(counts);
    stencils.indices.allocate(indices.size());
    stencils.weights.allocate(weights.size());
    std::copy(indices.begin(), indices.end(), stencils.indices.begin());
    std::copy(weights.begin(), weights.end(), stencils.weights.begin());
    return {};
}

template <class Real>
Result<BasicPatchTable<Real>> build(const Refinement& source, const PatchTableOptions& options,
                                    const PlanCache* shared) {
    if (options.plan_depth < 1 || options.plan_depth > 10)
        return Error{ErrorCode::invalid_argument,
                     "plan depth " + std::to_string(options.plan_depth) + " is not within 1 and 10"};
    const Topology& base = source.levels[0];
    BasicPatchTable<Real> table;
    table.options = base.options;
    table.control_count = source.control_count;
    const bool linear =
        options.interpolation == Interpolation::varying || base.options.scheme == Scheme::bilinear;
    const std::vector<uint8_t> regular = find_regular_faces(base, linear);
    Topology child;
    if (std::find(regular.begin(), regular.end(), 0) != regular.end()) child = refine_once(base, true);
    Builder b{base, child, {linear, options.plan_depth}, {}};
    table.ptex_surfaces = list_surfaces(regular, b);
    hash_surfaces(b);

    const PlanCache own;
    PlanCache::Impl& cache = (shared != nullptr ? *shared : own).impl();
    const std::lock_guard lock(cache.mutex);
    const std::vector<uint32_t> plans = find_plans(b, cache);
    PlanCopy<Real> copy{cache, table, {}, {}};
    table.surfaces.allocate(plans.size());
    uint64_t ring = 0;
    for (size_t i = 0; i < plans.size(); ++i) {
        const Candidate& c = b.candidates[i];
        table.surfaces[i] = {copy.number(plans[i]), static_cast<uint32_t>(ring), c.base_face, c.rotation};
        ring += c.ring_size;
        if (ring > kInvalidIndex) return Error{ErrorCode::too_large, "rings of 2^32 points or more"};
    }
    if (auto ok = copy.copy(); !ok) return ok.error();

    table.ring_points.allocate(ring);
    std::vector<uint32_t> point_of_child(child.vertex_count, kInvalidIndex);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, plans.size(), 64),
                      [&](const tbb::blocked_range<size_t>& r) {
                          Neighborhood hood;
                          for (size_t i = r.begin(); i != r.end(); ++i) {
                              b.walk(b.candidates[i], hood);
                              std::copy(hood.ring.begin(), hood.ring.end(),
                                        table.ring_points.begin() + table.surfaces[i].first_ring);
                          }
                      });
    auto each_ring_point = [&](auto&& body) {
        for (size_t i = 0; i < plans.size(); ++i)
            for (uint32_t j = 0; j < b.candidates[i].ring_size; ++j)
                body(b.candidates[i].refined, table.ring_points[table.surfaces[i].first_ring + j]);
    };
    each_ring_point([&](bool refined, uint32_t& v) {
        if (refined) point_of_child[v] = 0;
    });
    if (auto ok = build_points(b, source, point_of_child, table); !ok) return ok.error();
    each_ring_point([&](bool refined, uint32_t& v) {
        if (refined)
            v = point_of_child[v];
        else if (!source.control_indices.empty())
            v = source.control_indices[v];
    });
    return table;
}

}  // namespace

template <class Real>
Result<BasicPatchTable<Real>> build_patch_table(const ControlMesh& mesh, const PatchTableOptions& options,
                                                const PlanCache* cache) {
    const auto refinement = build_refinement(mesh, {.level = 0, .full_last_level = true});
    if (!refinement) return refinement.error();
    return build<Real>(*refinement, options, cache);
}

template <class Real>
Result<BasicPatchTable<Real>> build_face_varying_patch_table(const ControlMesh& mesh, uint32_t channel,
                                                             const PatchTableOptions& options,
                                                             const PlanCache* cache) {
    const auto refinement =
        build_face_varying_refinement(mesh, channel, {.level = 0, .full_last_level = true});
    if (!refinement) return refinement.error();
    if (!refinement->uncut.empty())
        return Error{ErrorCode::unsupported, "patch tables of face-varying channels with Chaikin creasing"};
    return build<Real>(*refinement, options, cache);
}

template Result<PatchTable> build_patch_table<float>(const ControlMesh&, const PatchTableOptions&,
                                                     const PlanCache*);
template Result<PatchTableDouble> build_patch_table<double>(const ControlMesh&, const PatchTableOptions&,
                                                            const PlanCache*);
template Result<PatchTable> build_face_varying_patch_table<float>(const ControlMesh&, uint32_t,
                                                                  const PatchTableOptions&, const PlanCache*);
template Result<PatchTableDouble> build_face_varying_patch_table<double>(const ControlMesh&, uint32_t,
                                                                         const PatchTableOptions&,
                                                                         const PlanCache*);

}  // namespace limn
