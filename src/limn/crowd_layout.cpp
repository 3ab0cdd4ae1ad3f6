#include "limn/crowd_layout.h"

#include <algorithm>
#include <numeric>

#include "limn/refined_points.h"
#include "limn/topology.h"

namespace limn {
namespace {

using State = Crowd::State;
using PlanNumbers = std::vector<uint32_t>;

Error too_large(const char* what) {
    return Error{ErrorCode::too_large, std::string("a crowd holds too many ") + what};
}

template <class T>
void append(Array<T>& to, const T* begin, const T* end) {
    for (; begin != end; ++begin) to.push_back(*begin);
}

/// Words of an array of T: from element `first` on.
template <class T>
void mark(State& state, CrowdArray array, uint64_t first, uint64_t count) {
    constexpr uint64_t kWords = sizeof(T) / 4;
    state.own_changes[array].mark(first * kWords, count * kWords);
}

// Plans and their trees, which are only ever added to.

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
    if (weights * 4 > options.max_weight_bytes) return too_large("weights of local points");
    if (state.tree_nodes.size() + trees->nodes.size() >= shared::kMaxTreeFirst)
        return too_large("nodes of patch trees");
    for (uint32_t t = 0; t < first_surfaces.size(); ++t) {
        const uint32_t i = first_surfaces[t];
        if (!is_known(mesh.surfaces[i]))
            append_tree(state, *trees, t, roots[t], roots[t + 1], trees->surfaces[i].hull_count,
                        numbers[mesh.surfaces[i].plan()]);
    }
    return {};
}

/// What the mesh's plans are in the crowd, where they all are afterwards.
Result<PlanNumbers> append_plans(State& state, const PatchTable& mesh) {
    if (state.patches.plans.size() + mesh.plans.size() >= shared::kMaxPlans) return too_large("plans");
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

// Ranges.

std::array<uint64_t, kCrowdRangeCount> sizes_of(const State& state, const BatchMesh& mesh,
                                                const PlanNumbers& numbers) {
    const PatchTable& patches = *mesh.patches;
    const TessellationTable& topology = *mesh.topology;
    uint64_t indices = 0, locals = 0;
    for (const PointRun& run : patches.point_runs) indices += uint64_t{run.row_count} * run.entry_count;
    for (const Surface& s : patches.surfaces)
        locals += state.classes[state.class_of_plan[numbers[s.plan()]]].local_count;
    std::array<uint64_t, kCrowdRangeCount> out = {};
    out[kControlPoints] = patches.control_count;
    out[kRefinedPoints] = patches.refined_count;
    out[kPtexFaces] = patches.ptex_surfaces.size();
    out[kSurfaces] = patches.surfaces.size();
    out[kRingPoints] = ring_point_count(patches);
    out[kPointRuns] = patches.point_runs.size();
    out[kPointIndices] = indices;
    out[kPointWeights] = patches.point_weights.size();
    out[kRows] = topology.row_count;
    out[kCorners] = topology.corner_count;
    out[kRateEdges] = topology.rate_edge_count;
    out[kCornerCopies] = topology.corner_copies.size();
    out[kRowCopies] = topology.row_copies.size();
    out[kLocalPoints] = locals;
    return out;
}

Result<void> check_totals(const std::array<uint64_t, kCrowdRangeCount>& sizes) {
    constexpr uint64_t kMost = 0xffffffff;
    if (sizes[kControlPoints] + sizes[kRefinedPoints] + 64 > kMost) return too_large("points");
    if (std::max({sizes[kRingPoints], sizes[kPointIndices], sizes[kPointWeights]}) > kMost)
        return too_large("ring points");
    if (std::max(sizes[kSurfaces], sizes[kPtexFaces]) >= uint64_t{1} << 28) return too_large("surfaces");
    if (sizes[kRows] >= shared::kSideRowMask) return too_large("rows of vertices");
    if (std::max({sizes[kCorners], sizes[kRateEdges], sizes[kCornerCopies], sizes[kRowCopies]}) >=
        kInvalidIndex)
        return too_large("edges");
    if (sizes[kLocalPoints] > 0x7fffffff) return too_large("local points");
    return {};
}

bool take_ranges(State& state, State::Slot& slot, const std::array<uint64_t, kCrowdRangeCount>& sizes) {
    for (uint32_t k = 0; k < kCrowdRangeCount; ++k) {
        if (sizes[k] > state.capacity[k]) return false;
        const uint32_t first = state.free[k].take(static_cast<uint32_t>(sizes[k]));
        if (first == kInvalidIndex) return false;
        slot.first[k] = first;
        slot.count[k] = static_cast<uint32_t>(sizes[k]);
    }
    const TessellationTable& topology = *slot.mesh.topology;
    const auto range = [&](CrowdRange k) { return BatchRange{slot.first[k], slot.count[k]}; };
    const BatchRange mesh_edges = {slot.first[kRateEdges], topology.mesh_edge_count},
                     sub_edges = {slot.first[kRateEdges] + topology.mesh_edge_count,
                                  topology.rate_edge_count - topology.mesh_edge_count};
    slot.instance = {{range(kControlPoints), range(kPtexFaces), range(kSurfaces)},
                     {range(kPtexFaces), mesh_edges, sub_edges, range(kRows), range(kCorners)}};
    return true;
}

// What is in them.

void write_points(State& state, const State::Slot& slot) {
    const PatchTable& from = *slot.mesh.patches;
    PatchTable& to = state.patches;
    const uint32_t refined = to.first_refined + slot.first[kRefinedPoints],
                   control = slot.first[kControlPoints];
    uint32_t index = slot.first[kPointIndices];
    for (size_t r = 0; r < from.point_runs.size(); ++r) {
        PointRun run = from.point_runs[r];
        const uint32_t count = run.row_count * run.entry_count;
        for (uint32_t i = 0; i < count; ++i)
            to.point_indices.words[index + i] = from.point_indices[run.first_index + i] + control;
        run.first_point += refined - from.first_refined;
        run.first_index = index;
        run.first_weight += slot.first[kPointWeights];
        to.point_runs[slot.first[kPointRuns] + r] = run;
        index += count;
    }
    std::copy(from.point_weights.begin(), from.point_weights.end(),
              to.point_weights.begin() + slot.first[kPointWeights]);
    uint32_t* ring = to.ring_points.words.data() + slot.first[kRingPoints];
    for (size_t i = 0; i < slot.count[kRingPoints]; ++i) {
        const uint32_t point = from.ring_points[i];
        ring[i] = point < from.control_count ? point + control : point - from.first_refined + refined;
    }
    mark<uint32_t>(state, kRingArray, slot.first[kRingPoints], slot.count[kRingPoints]);
}

/// Surfaces with their local points, and their places in tiles. False: there is no room for those.
bool write_surfaces(State& state, State::Slot& slot, const PlanNumbers& numbers) {
    const PatchTable& from = *slot.mesh.patches;
    copy_surfaces(from, numbers.data(), slot.instance.patches, slot.first[kRingPoints], state.patches);
    const uint32_t first = slot.first[kSurfaces], pass_size = state.options.points_per_pass;
    uint32_t local = slot.first[kLocalPoints];
    const uint32_t pass = local / pass_size;
    for (uint32_t i = 0; i < from.surfaces.size(); ++i) {
        const Surface& s = state.patches.surfaces[first + i];
        const uint32_t number = state.class_of_plan[s.plan()];
        const State::TreeClass& c = state.classes[number];
        state.tree_surfaces[first + i] = {shared::pack_surface(c.root, s.rotation()), local, c.hull_count};
        if (!state.tiles.add(first + i, number, pass, s.first_ring, local % pass_size)) return false;
        ++slot.tiled_surfaces;
        local += c.local_count;
    }
    mark<Surface>(state, kSurfaceArray, first, from.surfaces.size());
    mark<TreeSurface>(state, kTreeSurfaceArray, first, from.surfaces.size());
    mark<uint32_t>(state, kPtexArray, slot.first[kPtexFaces], slot.count[kPtexFaces]);
    return true;
}

void mark_topology(State& state, const State::Slot& slot) {
    const auto mark_words = [&](CrowdArray array, CrowdRange range, uint64_t words) {
        state.own_changes[array].mark(slot.first[range] * words, slot.count[range] * words);
    };
    mark_words(kFaceArray, kPtexFaces, shared::kTessFaceWords);
    mark_words(kRowArray, kRows, shared::kTessRowWords);
    mark_words(kCornerArray, kCorners, shared::kTessCornerWords);
    mark_words(kRateEdgeArray, kRateEdges, shared::kRateEdgeWords);
    mark_words(kCornerCopyArray, kCornerCopies, 1);
    mark_words(kRowCopyArray, kRowCopies, 1);
}

bool write(State& state, State::Slot& slot, const PlanNumbers& numbers) {
    write_points(state, slot);
    copy_topology(*slot.mesh.topology, slot.instance.topology, slot.first[kCornerCopies],
                  slot.first[kRowCopies], state.topology);
    mark_topology(state, slot);
    return write_surfaces(state, slot, numbers) &&
           state.points.add(*slot.mesh.patches, slot.first[kControlPoints], slot.first[kRefinedPoints],
                            slot.point_items);
}

/// Elements [first, first + count) become those of nobody. Number 0 of rows, corners and rate edges is.
void make_inert(State& state, CrowdRange range, uint32_t first, uint32_t count) {
    PatchTable& patches = state.patches;
    TessellationTable& topology = state.topology;
    const auto fill = [&](Array<uint32_t>& words, std::initializer_list<uint32_t> element) {
        uint32_t* to = words.data() + first * element.size();
        for (uint32_t i = 0; i < count; ++i) to = std::copy(element.begin(), element.end(), to);
    };
    using namespace shared;
    switch (range) {
        case kPtexFaces:
            fill(patches.ptex_surfaces, {kPtexHole});
            fill(topology.faces, {kNoSide, kNoSide, kNoSide, kNoSide, 0, 0, 0, 0});
            mark<uint32_t>(state, kPtexArray, first, count);
            break;
        case kRows:
            fill(topology.rows, {0, kNoFace, 0, kNoFace});
            break;
        case kCorners:
            fill(topology.corners, {kNoFace, 0});
            break;
        case kRateEdges:
            fill(topology.rate_edges, {kNoRateEdge, kNoFace, kNoFace});
            break;
        case kCornerCopies:
            fill(topology.corner_copies, {0});
            break;
        case kRowCopies:
            fill(topology.row_copies, {0});
            break;
        case kPointRuns:
            std::fill_n(patches.point_runs.data() + first, count,
                        PointRun{patches.first_refined, 0, 0, 0, 0});
            break;
        default:
            break;
    }
}

/// All that an append may have outgrown.
bool has_room(const State& state) {
    for (uint32_t a = 0; a < kCrowdArrayCount; ++a) {
        const State::Words words = state.words(static_cast<CrowdArray>(a));
        if (words.count > words.capacity) return false;
    }
    return true;
}

// A layout.

void allocate(State& state) {
    PatchTable& patches = state.patches;
    TessellationTable& topology = state.topology;
    const auto& capacity = state.capacity;
    patches.control_count = capacity[kControlPoints];
    patches.refined_count = capacity[kRefinedPoints];
    patches.first_refined = first_refined_point(patches.control_count, patches.refined_count);
    patches.point_runs.allocate(capacity[kPointRuns]);
    patches.point_indices.words.assign(capacity[kPointIndices], 0);
    patches.point_weights.assign(capacity[kPointWeights], 0);
    patches.surfaces.assign(capacity[kSurfaces], {0, 0});
    patches.ring_points.words.assign(capacity[kRingPoints], 0);
    patches.ptex_surfaces.allocate(capacity[kPtexFaces]);
    state.tree_surfaces.assign(capacity[kSurfaces], {0, 0, 0});
    topology.face_count = capacity[kPtexFaces];
    topology.row_count = capacity[kRows];
    topology.corner_count = capacity[kCorners];
    topology.rate_edge_count = topology.mesh_edge_count = capacity[kRateEdges];
    topology.faces.allocate(size_t{topology.face_count} * shared::kTessFaceWords);
    topology.rows.allocate(size_t{topology.row_count} * shared::kTessRowWords);
    topology.corners.allocate(size_t{topology.corner_count} * shared::kTessCornerWords);
    topology.rate_edges.allocate(size_t{topology.rate_edge_count} * shared::kRateEdgeWords);
    topology.corner_copies.allocate(capacity[kCornerCopies]);
    topology.row_copies.allocate(capacity[kRowCopies]);
    for (uint32_t k = 0; k < kCrowdRangeCount; ++k)
        make_inert(state, static_cast<CrowdRange>(k), 0, capacity[k]);
    for (const CrowdRange range : {kRows, kCorners, kRateEdges}) state.free[range].take(1);
}

/// Of what has to fit, and of the largest mesh. Multiples of 4 keep arrays that devices have one behind the
/// other together.
Result<void> choose_capacity(State& state, const std::array<uint64_t, kCrowdRangeCount>& totals,
                             uint64_t most_locals) {
    const double share = 1.0 + static_cast<double>(state.options.reserve);
    std::array<uint64_t, kCrowdRangeCount> wanted = {};
    for (uint32_t k = 0; k < kCrowdRangeCount; ++k)
        wanted[k] = (static_cast<uint64_t>(share * static_cast<double>(totals[k])) + 67) / 4 * 4;
    wanted[kLocalPoints] += (wanted[kLocalPoints] / state.options.points_per_pass + 1) * most_locals;
    if (auto checked = check_totals(wanted); !checked) return checked;
    for (uint32_t k = 0; k < kCrowdRangeCount; ++k) {
        state.capacity[k] = static_cast<uint32_t>(wanted[k]);
        state.free[k] = SlotRanges(state.capacity[k], k == kLocalPoints ? state.options.points_per_pass : 0);
    }
    return {};
}

void expect(State& state, const State::Slot& slot, const PlanNumbers& numbers) {
    for (const Surface& s : slot.mesh.patches->surfaces)
        state.tiles.expect(state.class_of_plan[numbers[s.plan()]],
                           slot.first[kLocalPoints] / state.options.points_per_pass, 1);
    state.points.expect(*slot.mesh.patches);
}

void start_layout(const State& old, State& state) {
    state.options = old.options;
    state.trees = old.trees;
    state.layout = old.layout + 1;
    state.instance_count = old.instance_count;
    uint32_t live = 0;
    for (const State::Slot& slot : old.slots) {
        state.slots.push_back({slot.is_live, slot.mesh});
        if (!slot.is_live) continue;
        ++live;
        state.patches.options = slot.mesh.patches->options;
        state.topology.options = slot.mesh.topology->options;
    }
    const double share = 1.0 + static_cast<double>(old.options.reserve);
    const auto wanted = static_cast<size_t>(share * live) + 8;
    state.slots.resize(std::max(wanted, state.slots.size()));
    state.instance_capacity = static_cast<uint32_t>(state.slots.size());
}

/// What a device has room for of arrays that grow.
void reserve_arrays(State& state) {
    const double share = 1.0 + static_cast<double>(state.options.reserve);
    for (uint32_t a = 0; a < kCrowdArrayCount; ++a) {
        const auto array = static_cast<CrowdArray>(a);
        const bool grows = (array >= kPlanArray && array <= kPlanWeightArray) || array == kTreeNodeArray ||
                           array == kLeafArray || array == kWeightArray;
        const uint64_t count = state.words(array).count;
        state.array_capacity[a] =
            grows ? (static_cast<uint64_t>(share * static_cast<double>(count)) + 4099) / 4 * 4 : count;
    }
}

}  // namespace

State::Words State::words(CrowdArray array) const {
    const auto of = [&](const auto& elements) {
        return Words{elements.data(), elements.bytes() / 4, array_capacity[array]};
    };
    switch (array) {
        case kPtexArray:
            return of(patches.ptex_surfaces);
        case kSurfaceArray:
            return of(patches.surfaces);
        case kRingArray:
            return of(patches.ring_points.words);
        case kPlanArray:
            return of(patches.plans);
        case kPlanNodeArray:
            return of(patches.plan_nodes);
        case kPlanPointArray:
            return of(patches.plan_points);
        case kPlanWeightArray:
            return of(patches.plan_weights);
        case kTreeSurfaceArray:
            return of(tree_surfaces);
        case kTreeNodeArray:
            return of(tree_nodes);
        case kLeafArray:
            return of(leaf_points);
        case kFaceArray:
            return of(topology.faces);
        case kRowArray:
            return of(topology.rows);
        case kCornerArray:
            return of(topology.corners);
        case kRateEdgeArray:
            return of(topology.rate_edges);
        case kCornerCopyArray:
            return of(topology.corner_copies);
        case kRowCopyArray:
            return of(topology.row_copies);
        case kInstanceArray:
            return of(instance_words);
        case kWeightArray:
            return of(local_weights);
        case kTileArray:
            return of(tiles.words());
        default:
            return of(points.words());
    }
}

const WordChanges& State::changes(CrowdArray array) const {
    return array == kTileArray ? tiles.changes : array == kPointArray ? points.changes : own_changes[array];
}

uint32_t take_slot(State& state, const BatchMesh& mesh) {
    const auto at =
        std::find_if(state.slots.begin(), state.slots.end(), [](const State::Slot& s) { return !s.is_live; });
    const auto number = static_cast<uint32_t>(at - state.slots.begin());
    if (at == state.slots.end()) state.slots.emplace_back();
    state.slots[number].is_live = true;
    state.slots[number].mesh = mesh;
    return number;
}

Result<bool> place(State& state, uint32_t number) {
    if (number >= state.instance_capacity) return false;
    State::Slot& slot = state.slots[number];
    const auto numbers = append_plans(state, *slot.mesh.patches);
    if (!numbers) return numbers.error();
    return has_room(state) && take_ranges(state, slot, sizes_of(state, slot.mesh, *numbers)) &&
           write(state, slot, *numbers);
}

void take_away(State& state, uint32_t number) {
    State::Slot& slot = state.slots[number];
    for (uint32_t i = slot.tiled_surfaces; i-- != 0;) state.tiles.remove(slot.first[kSurfaces] + i);
    state.points.remove(slot.point_items);
    for (uint32_t k = 0; k < kCrowdRangeCount; ++k) {
        if (slot.count[k] == 0) continue;
        make_inert(state, static_cast<CrowdRange>(k), slot.first[k], slot.count[k]);
        state.free[k].give_back(slot.first[k], slot.count[k]);
    }
    mark_topology(state, slot);
    slot = {};
}

Result<std::unique_ptr<State>> lay_out_anew(State& old) {
    auto out = std::make_unique<State>();
    State& state = *out;
    start_layout(old, state);
    std::vector<PlanNumbers> numbers(state.slots.size());
    std::vector<std::array<uint64_t, kCrowdRangeCount>> sizes(state.slots.size());
    std::array<uint64_t, kCrowdRangeCount> totals = {};
    totals[kRows] = totals[kCorners] = totals[kRateEdges] = 1;  // nobody's
    uint64_t most_locals = 0;
    for (size_t i = 0; i < state.slots.size(); ++i) {
        if (!state.slots[i].is_live) continue;
        auto appended = append_plans(state, *state.slots[i].mesh.patches);
        if (!appended) return appended.error();
        numbers[i] = std::move(*appended);
        sizes[i] = sizes_of(state, state.slots[i].mesh, numbers[i]);
        most_locals = std::max(most_locals, sizes[i][kLocalPoints]);
        for (uint32_t k = 0; k < kCrowdRangeCount; ++k) totals[k] += sizes[i][k];
    }
    if (most_locals > state.options.points_per_pass)
        return Error{ErrorCode::unsupported, "a mesh of a crowd has more local points than a pass"};
    if (auto chosen = choose_capacity(state, totals, most_locals); !chosen) return chosen.error();
    allocate(state);
    for (size_t i = 0; i < state.slots.size(); ++i) {
        if (!state.slots[i].is_live) continue;
        [[maybe_unused]] const bool taken = take_ranges(state, state.slots[i], sizes[i]);
        assert(taken);
        expect(state, state.slots[i], numbers[i]);
    }
    if (!state.tiles.lay_out(state.options.reserve, state.capacity[kSurfaces]) ||
        !state.points.lay_out(state.options.reserve))
        return too_large("words of tiles or points");
    for (size_t i = 0; i < state.slots.size(); ++i)
        if (state.slots[i].is_live && !write(state, state.slots[i], numbers[i]))
            return too_large("level-1 points");
    list_crowd_instances(state);
    reserve_arrays(state);
    for (WordChanges& changes : state.own_changes) changes.ranges.clear();
    state.tiles.changes.ranges.clear();
    state.points.changes.ranges.clear();
    return out;
}

void list_crowd_instances(State& state) {
    const uint32_t count = state.instance_capacity;
    std::vector<std::pair<uint32_t, uint32_t>> order(count);
    for (uint32_t i = 0; i < count; ++i) {
        const State::Slot& slot = state.slots[i];
        order[i] = {slot.count[kPtexFaces] != 0 ? slot.first[kPtexFaces] : state.topology.face_count, i};
    }
    std::sort(order.begin(), order.end());
    TessellationTable& topology = state.topology;
    topology.instance_faces.allocate(size_t{count} + 1);
    topology.instance_numbers.allocate(count);
    for (uint32_t i = 0; i < count; ++i) {
        topology.instance_faces[i] = order[i].first;
        topology.instance_numbers[i] = order[i].second;
    }
    topology.instance_faces[count] = topology.face_count;
    Array<uint32_t> words = list_instances(topology);
    const size_t same =
        words.size() != state.instance_words.size()
            ? 0
            : static_cast<size_t>(
                  std::mismatch(words.begin(), words.end(), state.instance_words.begin()).first -
                  words.begin());
    state.own_changes[kInstanceArray].mark(same, words.size() - same);
    state.instance_words = std::move(words);
}

}  // namespace limn
