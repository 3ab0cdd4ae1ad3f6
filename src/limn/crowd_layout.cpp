#include "limn/crowd_layout.h"

#include <algorithm>
#include <numeric>

#include "limn/refined_points.h"
#include "limn/topology.h"

namespace limn {
namespace {

using State = Crowd::State;

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
    if (sizes[kControlPoints] + sizes[kRefinedPoints] + 64 > kMost) return crowd_too_large("points");
    if (std::max({sizes[kRingPoints], sizes[kPointIndices], sizes[kPointWeights]}) > kMost)
        return crowd_too_large("ring points");
    if (std::max(sizes[kSurfaces], sizes[kPtexFaces]) >= uint64_t{1} << 28)
        return crowd_too_large("surfaces");
    if (sizes[kRows] >= shared::kSideRowMask) return crowd_too_large("rows of vertices");
    if (std::max({sizes[kCorners] * shared::kTessCornerWords, sizes[kRateEdges] * shared::kRateEdgeWords,
                  sizes[kCornerCopies], sizes[kRowCopies]}) > kMost)
        return crowd_too_large("edges");
    if (sizes[kLocalPoints] > 0x7fffffff) return crowd_too_large("local points");
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

/// All that an append may have outgrown.
bool has_room(const State& state) {
    for (uint32_t a = 0; a < kCrowdArrayCount; ++a) {
        const State::Words words = state.words(static_cast<CrowdArray>(a));
        if (words.count > words.capacity) return false;
    }
    return true;
}

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
    erase(state, slot);
    for (uint32_t k = 0; k < kCrowdRangeCount; ++k) state.free[k].give_back(slot.first[k], slot.count[k]);
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
        return crowd_too_large("words of tiles or points");
    for (size_t i = 0; i < state.slots.size(); ++i)
        if (state.slots[i].is_live && !write(state, state.slots[i], numbers[i]))
            return crowd_too_large("level-1 points");
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
