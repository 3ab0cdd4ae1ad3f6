// Surfaces are found and walked in parallel, in chunks that keep the rings they meet; few of them need a plan
// that is not known yet.
#include "limn/patch_table.h"

#include <algorithm>
#include <atomic>
#include <unordered_map>

#include "limn/candidates.h"
#include "limn/parallel.h"
#include "limn/plan_set.h"
#include "limn/refined_points.h"

namespace limn {
namespace {

/// The number, in `plans`, of the plan of each kind: chunk by chunk.
std::vector<std::vector<uint32_t>> find_plans(const Candidates& c, PlanSet& plans, const BuildPart& part) {
    std::unordered_map<PlanHash, uint32_t, PlanHashHash> found;
    const PlanHash options_hash = hash_signature(begin_plan_key(c.base.options, c.options));
    Neighborhood hood;
    auto find_regular = [&] {
        PlanRequest request = request_regular_plan(c.base.options, c.options.linear);
        const PlanKey key = request.key;
        return plans.find_or_request(key, [&] { return std::move(request); });
    };
    auto find_irregular = [&](const CandidateChunk::Kind& kind) {
        const PlanHash hash = {kind.hash[0] ^ options_hash[0], kind.hash[1] ^ options_hash[1]};
        if (const uint32_t known = plans.find(hash); known != kInvalidIndex) return known;
        const Candidate& first = c.list[kind.candidate];
        const Topology& t = c.level(first);
        walk_around({t}, first.face, {first.rotation, false}, hood);
        const PlanKey key = make_plan_key(t, hood, c.options);
        const uint32_t number =
            plans.find_or_request(key, [&] { return request_plan(t, hood, first.rotation, key); });
        plans.keep_hash(hash, number);
        return number;
    };
    std::vector<std::vector<uint32_t>> numbers(c.chunks.size());
    uint32_t regular = kInvalidIndex;
    auto number_kinds = [&](uint32_t i) {
        for (const CandidateChunk::Kind& kind : c.chunks[i].kinds) {
            if (kind.regular) {
                if (regular == kInvalidIndex) regular = find_regular();
                numbers[i].push_back(regular);
                continue;
            }
            const auto [at, is_new] = found.try_emplace(kind.hash, 0);
            if (is_new) at->second = find_irregular(kind);
            numbers[i].push_back(at->second);
        }
    };
    for_each_in_order(static_cast<uint32_t>(c.chunks.size()), part, number_kinds, 1);
    return numbers;
}

/// Copies the plans that surfaces need, in the order in which they need them.
template <class Real>
struct PlanCopy {
    BasicPatchTable<Real>& table;
    std::unordered_map<const BuiltPlan*, uint32_t> numbers = {};
    std::vector<const BuiltPlan*> order = {};

    uint32_t number(const BuiltPlan* plan) {
        const auto [at, is_new] = numbers.try_emplace(plan, static_cast<uint32_t>(order.size()));
        if (is_new) order.push_back(plan);
        return at->second;
    }
    Result<void> copy(const BuildPart& part) {
        uint64_t weights = 0, nodes = 0, points = 0;
        for (size_t i = 0; i < order.size(); ++i) {
            weights += order[i]->weights.size();
            nodes += order[i]->nodes.size();
            points += order[i]->points.size();
            for (const BuiltPlan* reference : order[i]->references) number(reference);
        }
        if (weights > kInvalidIndex || points > kInvalidIndex || order.size() >= shared::kMaxPlans)
            return Error{ErrorCode::too_large, "plans hold 2^32 weights or more"};
        table.plans.allocate(order.size());
        table.plan_identities.allocate(order.size());
        table.plan_weights.allocate(weights);
        table.plan_nodes.allocate(nodes);
        table.plan_points.allocate(points);
        uint32_t weight = 0, node = 0, point = 0;
        for (size_t i = 0; i < order.size(); ++i) {
            const BuiltPlan& plan = *order[i];
            table.plans[i] = {plan.ring_size, plan.row_count, weight, node, point, plan.has_corner_rows};
            table.plan_identities[i] = plan.identity;
            weight += static_cast<uint32_t>(plan.weights.size());
            node += static_cast<uint32_t>(plan.nodes.size());
            point += static_cast<uint32_t>(plan.points.size());
        }
        for_each_index(
            static_cast<uint32_t>(order.size()), part, [&](uint32_t i) { copy(*order[i], table.plans[i]); }, 4);
        return {};
    }
    void copy(const BuiltPlan& plan, const Plan& to) {
        std::transform(plan.weights.begin(), plan.weights.end(), table.plan_weights.begin() + to.first_weight,
                       [](double w) { return static_cast<Real>(w); });
        std::copy(plan.points.begin(), plan.points.end(), table.plan_points.begin() + to.first_point);
        uint32_t at = to.first_node;
        for (PlanNode node : plan.nodes) {
            if (node.kind() == PlanNodeKind::plan)
                node.word = shared::pack_node(static_cast<uint32_t>(PlanNodeKind::plan),
                                              numbers.at(plan.references[node.plan()]), node.rotation());
            table.plan_nodes[at++] = node;
        }
    }
};

/// Where the ring of each chunk's first candidate begins, and a final total.
std::vector<uint64_t> find_chunk_rings(const Candidates& c) {
    std::vector<uint64_t> offsets(1, 0);
    for (const CandidateChunk& chunk : c.chunks) offsets.push_back(offsets.back() + chunk.rings.size());
    return offsets;
}

/// body(candidate, its number, its ring as entries of its chunk's rings) for all of one chunk.
template <class Body>
void for_each_ring(const Candidates& c, size_t chunk, const Body& body) {
    size_t number = chunk * CandidateChunk::kSize, first = 0;
    for (const Candidate& at : c.of_chunk(chunk)) {
        body(at, number++, first);
        first += at.ring_size;
    }
}

/// Surfaces, and the plans that they need.
template <class Real>
Result<void> write_surfaces(const Candidates& c, const PlanSet& plans,
                            std::vector<std::vector<uint32_t>>& numbers,
                            const std::vector<uint64_t>& chunk_rings, BasicPatchTable<Real>& table,
                            const BuildPart& part) {
    PlanCopy<Real> copy{table};
    auto find_copies = [&](uint32_t chunk) {
        for (uint32_t& number : numbers[chunk]) number = copy.number(plans.plan(number));
    };
    for_each_in_order(static_cast<uint32_t>(numbers.size()), part.part(0, 0.3f), find_copies, 64);
    if (auto ok = copy.copy(part.part(0.3f, 0.6f)); !ok) return ok.error();
    table.surfaces.allocate(c.list.size());
    for_each_index(
        static_cast<uint32_t>(c.chunks.size()), part.part(0.6f, 1),
        [&](uint32_t chunk) {
            for_each_ring(c, chunk, [&](const Candidate& at, size_t number, size_t first) {
                table.surfaces[number] = {shared::pack_surface(numbers[chunk][at.kind], at.rotation),
                                          static_cast<uint32_t>(chunk_rings[chunk] + first)};
            });
        },
        4);
    return {};
}

/// The points that surfaces need, and which of them are theirs.
template <class Real>
Result<void> write_rings(const Candidates& c, const Refinement& source,
                         const std::vector<uint64_t>& chunk_rings, BasicPatchTable<Real>& table,
                         const BuildPart& part) {
    const auto chunk_count = static_cast<uint32_t>(c.chunks.size());
    std::vector<uint32_t> point_of_child(c.child_vertex_count, kInvalidIndex);
    auto for_each_chunk = [&](const BuildPart& p, const auto& body) { for_each_index(chunk_count, p, body, 4); };
    for_each_chunk(part.part(0, 0.1f), [&](uint32_t chunk) {
        for_each_ring(c, chunk, [&](const Candidate& at, size_t, size_t first) {
            if (at.refined == 0) return;
            for (size_t k = first; k < first + at.ring_size; ++k)
                std::atomic_ref(point_of_child[c.chunks[chunk].rings[k]]).store(0, std::memory_order_relaxed);
        });
    });
    const auto children = static_cast<uint64_t>(std::count(point_of_child.begin(), point_of_child.end(), 0u));
    if (chunk_rings.back() > kInvalidIndex || children + table.control_count + 64 > kInvalidIndex)
        return Error{ErrorCode::too_large, "rings of 2^32 points or more"};
    if (auto ok = build_refined_points<Real>(c.base, c.options.linear, source.control_indices, point_of_child,
                                             table, part.part(0.1f, 0.8f));
        !ok)
        return ok.error();
    Array<uint32_t> points;
    points.allocate(chunk_rings.back());
    for_each_chunk(part.part(0.8f, 0.9f), [&](uint32_t chunk) {
        const std::vector<uint32_t>& rings = c.chunks[chunk].rings;
        uint32_t* const to = points.data() + chunk_rings[chunk];
        for_each_ring(c, chunk, [&](const Candidate& at, size_t, size_t first) {
            for (size_t k = first; k < first + at.ring_size; ++k)
                to[k] = at.refined != 0                   ? point_of_child[rings[k]]
                        : !source.control_indices.empty() ? source.control_indices[rings[k]]
                                                          : rings[k];
        });
    });
    table.ring_points = pack_indices(std::move(points), table.point_count(), part.part(0.9f, 0.95f));
    return {};
}

constexpr float kTopologyEnd = 0.25f;  ///< of progress

template <class Real>
Result<BasicPatchTable<Real>> build(const Refinement& source, const PatchTableOptions& options,
                                    const PlanCache* shared) {
    if (options.plan_depth < 1 || options.plan_depth > 10)
        return Error{ErrorCode::invalid_argument,
                     "plan depth " + std::to_string(options.plan_depth) + " is not within 1 and 10"};
    if (options.isolation_level < 1 || options.isolation_level > 10)
        return Error{
            ErrorCode::invalid_argument,
            "isolation level " + std::to_string(options.isolation_level) + " is not within 1 and 10"};
    const Topology& base = source.levels[0];
    BasicPatchTable<Real> table;
    table.options = base.options;
    table.end_cap = options.end_cap;
    table.control_count = source.control_count;
    const bool linear =
        options.interpolation == Interpolation::varying || base.options.scheme == Scheme::bilinear;
    const uint32_t depth =
        options.end_cap == EndCap::exact ? options.plan_depth : options.isolation_level - 1;
    const BuildPart& part = options.control;
    Candidates candidates = find_candidates(base, {linear, options.end_cap, depth}, part.part(kTopologyEnd, 0.7f));
    if (auto ok = part.check(); !ok) return ok.error();
    const std::vector<uint64_t> chunk_rings = find_chunk_rings(candidates);
    table.ptex_surfaces = std::move(candidates.ptex_surfaces);

    const PlanCache own;
    PlanSet plans(candidates.options, (shared != nullptr ? *shared : own).impl());
    auto numbers = find_plans(candidates, plans, part.part(0.7f, 0.75f));
    if (auto ok = plans.build(part.part(0.75f, 0.8f)); !ok) return ok.error();
    candidates.child = {};  // most of the memory that there is
    if (auto ok = write_surfaces(candidates, plans, numbers, chunk_rings, table, part.part(0.8f, 0.85f)); !ok) return ok.error();
    if (auto ok = write_rings(candidates, source, chunk_rings, table, part.part(0.85f, 1)); !ok) return ok.error();
    if (auto ok = part.reach(1); !ok) return ok.error();
    return table;
}

bool has_semi_sharp_edges(const Topology& t) {
    return std::any_of(t.edge_sharpness.begin(), t.edge_sharpness.end(),
                       [](float s) { return s > 0 && !is_infinite(s); });
}

}  // namespace

template <class Real>
Result<BasicPatchTable<Real>> build_patch_table(const ControlMesh& mesh, const PatchTableOptions& options,
                                                const PlanCache* cache) {
    const auto refinement = build_refinement(
        mesh, {.level = 0, .full_last_level = true, .control = options.control.part(0, kTopologyEnd)});
    if (!refinement) return refinement.error();
    return build<Real>(*refinement, options, cache);
}

template <class Real>
Result<BasicPatchTable<Real>> build_face_varying_patch_table(const ControlMesh& mesh, uint32_t channel,
                                                             const PatchTableOptions& options,
                                                             const PlanCache* cache) {
    const auto refinement =
        build_face_varying_refinement(mesh, channel, {.level = 0, .full_last_level = true, .control = options.control.part(0, kTopologyEnd)});
    if (!refinement) return refinement.error();
    // Sharpness that is not finite stays as it is, on either side of a seam.
    if (!refinement->uncut.empty() && refinement->levels[0].options.scheme != Scheme::bilinear &&
        has_semi_sharp_edges(refinement->uncut[0]))
        return Error{ErrorCode::unsupported,
                     "patch tables of smooth face-varying channels with Chaikin creases"};
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
