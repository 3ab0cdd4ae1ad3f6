#include "limn/crowd_layout.h"

#include <algorithm>

#include "limn/topology.h"

namespace limn {
namespace {

using State = Crowd::State;

template <class T>
void append(Array<T>& to, const T* begin, const T* end) {
    for (; begin != end; ++begin) to.push_back(*begin);
}

void append_plan(State& state, const PatchTable& mesh, uint32_t p, const PlanNumbers& numbers) {
    PatchTable& to = state.patches;
    Plan plan = mesh.plans[p];
    const auto copy = [&](const auto& from, auto& array, uint32_t Plan::*first, CrowdArray number) {
        const uint32_t at = mesh.plans[p].*first, end = end_of(mesh, p, first, from.size());
        plan.*first = static_cast<uint32_t>(array.size());
        append(array, from.data() + at, from.data() + end);
        mark<std::remove_cvref_t<decltype(from[0])>>(state, number, plan.*first, end - at);
    };
    copy(mesh.plan_nodes, to.plan_nodes, &Plan::first_node, kPlanNodeArray);
    copy(mesh.plan_points, to.plan_points, &Plan::first_point, kPlanPointArray);
    copy(mesh.plan_weights, to.plan_weights, &Plan::first_weight, kPlanWeightArray);
    for (size_t n = plan.first_node; n < to.plan_nodes.size(); ++n)
        to.plan_nodes[n] = moved_node(to.plan_nodes[n], numbers.data());
    mark<Plan>(state, kPlanArray, to.plans.size(), 1);
    to.plans.push_back(plan);
    to.plan_identities.push_back(mesh.plan_identities[p]);
    state.class_of_plan.push_back(kInvalidIndex);
}

/// Tree t of a mesh, whose nodes are [begin, end), as the class of a plan.
void append_tree(State& state, const PatchTreeTable& trees, uint32_t t, uint32_t begin, uint32_t end,
                 uint32_t hull_count, uint32_t plan) {
    const auto is_leaf = [](uint32_t node) { return shared::node_kind(node) > shared::kNodeSplitV; };
    const auto node_base = static_cast<uint32_t>(state.tree_nodes.size()),
               leaf_base = static_cast<uint32_t>(state.leaf_points.size() / shared::kLeafWords);
    uint32_t first_leaf = kInvalidIndex, leaf_count = 0;
    for (uint32_t n = begin; n < end; ++n) {
        if (!is_leaf(trees.nodes[n])) continue;
        first_leaf = std::min(first_leaf, shared::tree_first(trees.nodes[n]));
        ++leaf_count;
    }
    for (uint32_t n = begin; n < end; ++n) {
        const uint32_t word = trees.nodes[n], first = shared::tree_first(word);
        state.tree_nodes.push_back(shared::pack_tree_node(
            shared::node_kind(word), shared::node_rotation(word),
            is_leaf(word) ? first - first_leaf + leaf_base : first - begin + node_base));
    }
    mark<uint32_t>(state, kTreeNodeArray, node_base, end - begin);
    const uint32_t* leaves = trees.leaf_points.data() + size_t{first_leaf} * shared::kLeafWords;
    append(state.leaf_points, leaves, leaves + size_t{leaf_count} * shared::kLeafWords);
    mark<uint32_t>(state, kLeafArray, size_t{leaf_base} * shared::kLeafWords,
                   size_t{leaf_count} * shared::kLeafWords);

    GridClass grid = trees.local_points.classes[t];
    const float* weights = trees.local_points.weights.data() + size_t{4} * grid.first_weight;
    const size_t weight_count = size_t{4} * grid.group_count * grid.sample_count;
    grid.first_weight = static_cast<uint32_t>(state.local_weights.size() / 4);
    append(state.local_weights, weights, weights + weight_count);
    mark<float>(state, kWeightArray, size_t{4} * grid.first_weight, weight_count);
    const GridPlacement& placement = trees.local_points.placements[t];
    const uint32_t* samples = trees.local_points.placement_samples.data() + placement.first;
    const auto padding = static_cast<uint32_t>(std::count(samples, samples + placement.count, kInvalidIndex));
    state.class_of_plan[plan] = state.tiles.add_class(grid, placement.count - padding);
    state.classes.push_back({grid, placement.count - padding, node_base, hull_count});
}

/// Trees of those of the mesh's plans that surfaces have and that are not there yet.
Result<void> append_trees(State& state, const PatchTable& mesh, const PlanNumbers& numbers) {
    const auto is_known = [&](const Surface& s) {
        return state.class_of_plan[numbers[s.plan()]] != kInvalidIndex;
    };
    if (std::all_of(mesh.surfaces.begin(), mesh.surfaces.end(), is_known)) return {};
    const CrowdOptions& options = state.options;
    const auto trees = build_patch_trees(
        mesh, {options.max_rate, options.max_weight_bytes, options.points_per_pass}, *state.trees);
    if (!trees) return trees.error();
    // They are in the order in which surfaces first have their plans.
    std::vector<uint32_t> first_surfaces, roots;
    std::vector<bool> is_met(mesh.plans.size());
    for (uint32_t i = 0; i < mesh.surfaces.size(); ++i) {
        if (is_met[mesh.surfaces[i].plan()]) continue;
        is_met[mesh.surfaces[i].plan()] = true;
        first_surfaces.push_back(i);
        roots.push_back(shared::surface_plan(trees->surfaces[i].word));
    }
    roots.push_back(static_cast<uint32_t>(trees->nodes.size()));
    uint64_t weights = state.local_weights.size();
    for (uint32_t t = 0; t < first_surfaces.size(); ++t)
        if (const GridClass& c = trees->local_points.classes[t]; !is_known(mesh.surfaces[first_surfaces[t]]))
            weights += uint64_t{4} * c.group_count * c.sample_count;
    if (weights * 4 > options.max_weight_bytes || weights > kInvalidIndex)
        return crowd_too_large("weights of local points");
    if (state.tree_nodes.size() + trees->nodes.size() >= shared::kMaxTreeFirst)
        return crowd_too_large("nodes of patch trees");
    for (uint32_t t = 0; t < first_surfaces.size(); ++t) {
        const uint32_t i = first_surfaces[t];
        if (!is_known(mesh.surfaces[i]))
            append_tree(state, *trees, t, roots[t], roots[t + 1], trees->surfaces[i].hull_count,
                        numbers[mesh.surfaces[i].plan()]);
    }
    return {};
}

}  // namespace

Result<PlanNumbers> append_plans(State& state, const PatchTable& mesh) {
    if (state.patches.plans.size() + mesh.plans.size() >= shared::kMaxPlans) return crowd_too_large("plans");
    PlanNumbers numbers;
    std::vector<uint32_t> added;
    auto next = static_cast<uint32_t>(state.patches.plans.size());
    for (uint32_t p = 0; p < mesh.plans.size(); ++p) {
        const auto [at, is_new] = state.plan_numbers.try_emplace(mesh.plan_identities[p], next);
        if (is_new) added.push_back(p);
        next += is_new;
        numbers.push_back(at->second);
    }
    for (const uint32_t p : added) append_plan(state, mesh, p, numbers);
    if (auto appended = append_trees(state, mesh, numbers); !appended) return appended.error();
    return numbers;
}

}  // namespace limn
