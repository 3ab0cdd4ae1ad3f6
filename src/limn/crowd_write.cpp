#include "limn/crowd_layout.h"

#include <algorithm>

namespace limn {
namespace {

using State = Crowd::State;

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

}  // namespace

bool write(State& state, State::Slot& slot, const PlanNumbers& numbers) {
    write_points(state, slot);
    copy_topology(*slot.mesh.topology, slot.instance.topology, slot.first[kCornerCopies],
                  slot.first[kRowCopies], state.topology);
    mark_topology(state, slot);
    return write_surfaces(state, slot, numbers) &&
           state.points.add(*slot.mesh.patches, slot.first[kControlPoints], slot.first[kRefinedPoints],
                            slot.point_items);
}

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

void erase(State& state, State::Slot& slot) {
    for (uint32_t i = slot.tiled_surfaces; i-- != 0;) state.tiles.remove(slot.first[kSurfaces] + i);
    slot.tiled_surfaces = 0;
    state.points.remove(slot.point_items);
    for (uint32_t k = 0; k < kCrowdRangeCount; ++k)
        make_inert(state, static_cast<CrowdRange>(k), slot.first[k], slot.count[k]);
    mark_topology(state, slot);
}

}  // namespace limn
