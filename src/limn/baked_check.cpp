#include "limn/baked_check.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <atomic>
#include <bit>

#include "limn/refined_points.h"
#include "limn/shared/patch_basis.h"

namespace limn {
namespace {

/// Functions below return what is wrong, or null.
using Cause = const char*;

constexpr size_t kGrain = size_t{1} << 14;
constexpr uint32_t kMostDepth = 62;  // of trees; kernels go no further down than 64 nodes

/// is_good(i) for all i, on all cores.
template <class IsGood>
bool all_of(size_t count, const IsGood& is_good) {
    std::atomic<bool> good = true;
    const auto check = [&](size_t begin, size_t end) {
        bool part = true;
        for (size_t i = begin; i != end; ++i) part &= is_good(i);
        if (!part) good = false;
    };
    if (count <= kGrain)
        check(0, count);
    else
        tbb::parallel_for(tbb::blocked_range<size_t>(0, count, kGrain),
                          [&](const tbb::blocked_range<size_t>& r) { check(r.begin(), r.end()); });
    return good;
}

bool all_below(const Array<uint32_t>& numbers, uint64_t bound) {
    const uint32_t* data = numbers.data();
    return all_of(numbers.size(), [=](size_t i) { return data[i] < bound; });
}
bool all_below(const IndexList& list, uint64_t bound) {
    const uint32_t* words = list.words.data();
    if (!list.narrow) return all_below(list.words, bound);
    return all_of(list.words.size(), [=](size_t i) { return (words[i] & 0xffff) < bound && words[i] >> 16 < bound; });
}
bool all_finite(const Array<float>& numbers) {
    constexpr uint32_t kExponent = 0x7f800000;
    const float* data = numbers.data();
    return all_of(numbers.size(), [=](size_t i) { return (std::bit_cast<uint32_t>(data[i]) & kExponent) != kExponent; });
}
uint64_t count_of(const IndexList& list) {
    return list.words.size() * (list.narrow ? 2 : 1);
}
bool lies_within(uint64_t first, uint64_t count, uint64_t size) {
    return first <= size && count <= size - first;
}

/// The children of a node that splits.
uint32_t child_count(uint32_t kind) {
    return kind == shared::kNodeSplit ? 4 : kind <= shared::kNodeSplitV ? 2 : 0;
}

/// Nodes as trees: children behind their parents, each with one, not too deep. depths[n]: of node n, and splits_above[n]:
/// how many kNodeSplit are above it. `root_of` tells nodes that no other has as a child.
struct Forest {
    std::vector<uint8_t> depths, splits_above, is_child;

    template <class FirstOf>
    Cause walk(std::span<const uint32_t> kinds, const FirstOf& first_of) {
        depths.assign(kinds.size(), 0);
        splits_above.assign(kinds.size(), 0);
        is_child.assign(kinds.size(), 0);
        for (uint32_t n = 0; n < kinds.size(); ++n) {
            const uint32_t children = child_count(kinds[n]);
            if (children == 0) continue;
            const uint32_t first = first_of(n);
            if (first <= n || !lies_within(first, children, kinds.size())) return "a node's children are not behind it";
            if (depths[n] >= kMostDepth) return "a tree is too deep";
            for (uint32_t c = first; c < first + children; ++c) {
                if (is_child[c] != 0) return "a node is in two trees";
                is_child[c] = 1;
                depths[c] = static_cast<uint8_t>(depths[n] + 1);
                splits_above[c] = static_cast<uint8_t>(splits_above[n] + (kinds[n] == shared::kNodeSplit ? 1 : 0));
            }
        }
        return nullptr;
    }
};

/// Surfaces of ptex faces. Holes are those of the tessellation table: see check_same_faces.
Cause check_ptex(const Array<uint32_t>& ptex_surfaces, size_t surface_count) {
    const bool good = all_of(ptex_surfaces.size(), [&](size_t i) {
        const uint32_t word = ptex_surfaces[i];
        if (word == shared::kPtexHole) return true;
        return (word & shared::kPtexSplit) != 0 ? lies_within(word & ~shared::kPtexSplit, 4, surface_count)
                                                : word < surface_count;
    });
    return good ? nullptr : "a ptex face has no such surface";
}

Cause check_points(const PatchTable& t) {
    if (t.first_refined != first_refined_point(t.control_count, t.refined_count) || t.first_refined < t.control_count ||
        uint64_t{t.first_refined} + t.refined_count >= kInvalidIndex)
        return "points of level 1 are not behind control points";
    uint64_t points = 0, indices = 0;
    for (const PointRun& run : t.point_runs) {
        if (run.first_point != t.first_refined + points || run.first_index != indices || run.entry_count == 0 ||
            !lies_within(run.first_weight, run.entry_count, t.point_weights.size()))
            return "a run of points is out of place";
        points += run.row_count;
        indices += uint64_t{run.row_count} * run.entry_count;
        if (points > t.refined_count || indices > count_of(t.point_indices)) return "runs make more points than there are";
    }
    if (points != t.refined_count) return "runs make fewer points than there are";
    if (!all_below(t.point_indices, t.control_count)) return "a point refers to no control point";
    return all_finite(t.point_weights) ? nullptr : "a point's weight is no number";
}

/// Nodes and points of a plan end where those of the next begin.
struct PlanRange {
    uint64_t first, end;
};
PlanRange nodes_of(const PatchTable& t, size_t p) {
    return {t.plans[p].first_node, p + 1 < t.plans.size() ? t.plans[p + 1].first_node : t.plan_nodes.size()};
}
PlanRange points_of(const PatchTable& t, size_t p) {
    return {t.plans[p].first_point, p + 1 < t.plans.size() ? t.plans[p + 1].first_point : t.plan_points.size()};
}

bool fits_scheme(uint32_t kind, const PatchTable& t) {
    const bool triangles = t.options.scheme == Scheme::loop;
    if (kind <= shared::kNodeSplitV || kind == shared::kNodePlan) return true;
    if (kind == shared::kNodeGregory || kind == shared::kNodeGregoryTriangle)
        return t.end_cap != EndCap::exact && triangles == (kind == shared::kNodeGregoryTriangle);
    return triangles ? kind == shared::kNodeBoxSpline || kind == shared::kNodeLinear
                     : kind == shared::kNodeBicubic || kind == shared::kNodeBilinear;
}

/// One plan; what it refers to goes to `references`.
Cause check_plan(const PatchTable& t, size_t p, Forest& forest, std::vector<uint32_t>& kinds,
                 std::vector<uint32_t>& references) {
    const Plan& plan = t.plans[p];
    const PlanRange nodes = nodes_of(t, p), points = points_of(t, p);
    if (nodes.first >= nodes.end || nodes.end > t.plan_nodes.size() || points.first > points.end ||
        points.end > t.plan_points.size())
        return "a plan's nodes or points are out of order";
    if (plan.ring_size == 0 || plan.ring_size > kMaxRingSize || plan.first_weight % 4 != 0 ||
        !lies_within(plan.first_weight, uint64_t{plan.row_count} * shared::plan_row_stride(plan.ring_size),
                     t.plan_weights.size()))
        return "a plan's weights do not lie within plan_weights";
    if (plan.has_corner_rows > 1 || (plan.has_corner_rows == 1 && plan.row_count < 3)) return "a plan has no corner rows";
    for (uint64_t i = points.first; i < points.end; ++i)
        if (t.plan_points[i] >= plan.row_count) return "a plan's point has no row";
    const PlanNode* node = t.plan_nodes.data() + nodes.first;
    kinds.clear();
    for (uint64_t n = 0; n < nodes.end - nodes.first; ++n) kinds.push_back(shared::node_kind(node[n].word));
    if (const Cause cause = forest.walk(kinds, [&](uint32_t n) { return node[n].first; })) return cause;
    for (size_t n = 0; n < kinds.size(); ++n) {
        if (kinds[n] > shared::kNodeGregoryTriangle || !fits_scheme(kinds[n], t)) return "a node of a plan is of no kind";
        if (kinds[n] <= shared::kNodeSplitV) continue;
        uint64_t count = shared::patch_point_count(kinds[n]);
        if (kinds[n] == shared::kNodePlan) {
            // Evaluation counts splits to know when to stop.
            if (node[n].plan() >= t.plans.size() || forest.splits_above[n] == 0) return "a node refers to no plan";
            count = t.plans[node[n].plan()].ring_size;
            references.push_back(node[n].plan());
        }
        if (!lies_within(node[n].first, count, points.end - points.first)) return "a node has no such points";
    }
    return nullptr;
}

/// Evaluation goes from plan to plan until it meets corner rows deep down: plans without them must not go round in
/// circles.
bool ends(const PatchTable& t, const std::vector<std::vector<uint32_t>>& references) {
    std::vector<uint32_t> open(t.plans.size(), 0), done;  // plans by how many go to them
    const auto counts = [&](size_t p) { return t.plans[p].has_corner_rows == 0; };
    size_t left = 0;
    for (size_t p = 0; p < open.size(); ++p) {
        if (!counts(p)) continue;
        ++left;
        for (const uint32_t to : references[p]) open[to] += counts(to);
    }
    for (uint32_t p = 0; p < open.size(); ++p)
        if (counts(p) && open[p] == 0) done.push_back(p);
    for (; !done.empty(); --left) {
        const uint32_t p = done.back();
        done.pop_back();
        for (const uint32_t to : references[p])
            if (counts(to) && --open[to] == 0) done.push_back(to);
    }
    return left == 0;
}

Cause check_plans(const PatchTable& t) {
    if (t.plans.size() > shared::kMaxPlans) return "there are too many plans";
    if (!t.plan_identities.empty() && t.plan_identities.size() != t.plans.size()) return "plans have no identities";
    if (!t.plans.empty() && (t.plans[0].first_node != 0 || t.plans[0].first_point != 0)) return "plans do not begin at 0";
    Forest forest;
    std::vector<uint32_t> kinds;
    std::vector<std::vector<uint32_t>> references(t.plans.size());
    for (size_t p = 0; p < t.plans.size(); ++p)
        if (const Cause cause = check_plan(t, p, forest, kinds, references[p])) return cause;
    if (!ends(t, references)) return "plans refer to each other without end";
    return all_finite(t.plan_weights) ? nullptr : "a plan's weight is no number";
}

Cause check_patches(const PatchTable& t) {
    if (const Cause cause = check_points(t)) return cause;
    if (const Cause cause = check_plans(t)) return cause;
    if (t.surfaces.size() >= shared::kPtexSplit) return "there are too many surfaces";
    const uint64_t rings = count_of(t.ring_points);
    const uint32_t rotations = t.options.scheme == Scheme::loop ? 3 : 4;
    const bool good = all_of(t.surfaces.size(), [&](size_t i) {
        const Surface& s = t.surfaces[i];
        return s.plan() < t.plans.size() && s.rotation() < rotations &&
               lies_within(s.first_ring, t.plans[s.plan()].ring_size, rings);
    });
    if (!good) return "a surface has no such plan, or its ring does not lie within ring_points";
    if (!all_below(t.ring_points, t.point_count())) return "a ring refers to no point";
    return check_ptex(t.ptex_surfaces, t.surfaces.size());
}

// Grids.

/// The largest sample of a placement or lattice in each of its slots; without slots all are in one.
using SlotSizes = std::vector<std::pair<uint32_t, uint32_t>>;

void add_samples(const uint32_t* samples, uint64_t count, bool slots, SlotSizes& sizes) {
    for (uint64_t i = 0; i < count; ++i) {
        if (samples[i] == kInvalidIndex) continue;
        const uint32_t slot = slots ? samples[i] >> shared::kGridOffsetBits : 0;
        const uint32_t offset = slots ? samples[i] & ((1u << shared::kGridOffsetBits) - 1) : samples[i];
        const auto at = std::find_if(sizes.begin(), sizes.end(), [&](const auto& s) { return s.first == slot; });
        if (at == sizes.end())
            sizes.emplace_back(slot, offset);
        else
            at->second = std::max(at->second, offset);
    }
}

Cause check_classes(const GridTable& t) {
    for (const GridClass& c : t.classes) {
        const uint32_t corners_end = c.corners == shared::kGridCornersBicubic ? 16 : c.corners == shared::kGridCornersBoxSpline ? 12 : 1;
        if (c.ring_size == 0 || c.ring_size > (1u << 24) || c.group_count != ring_group_count(c.ring_size) ||
            c.corners > shared::kGridCornersFirst || c.ring_size < corners_end || c.sample_count == 0)
            return "a class has no such ring";
        const uint64_t row = uint64_t{c.group_count} * t.value_count;
        if (row > kInvalidIndex || !lies_within(c.first_weight, row * c.sample_count, t.weights.size() / 4))
            return "a class's weights do not lie within weights";
    }
    return all_finite(t.weights) ? nullptr : "a weight is no number";
}

Cause check_placements(const GridTable& t, std::vector<SlotSizes>& sizes) {
    if (!t.lattices.empty() && t.lattices.size() != t.placements.size()) return "placements have no lattices";
    sizes.resize(t.placements.size());
    uint64_t placed = 0;  // each sample belongs to one
    for (size_t p = 0; p < t.placements.size(); ++p) {
        const GridPlacement& placement = t.placements[p];
        if (!lies_within(placement.first, placement.count, t.placement_samples.size())) return "a placement has no samples";
        placed += placement.count;
        uint64_t lattice_count = 0;
        if (!t.lattices.empty()) {
            const GridLattice& lattice = t.lattices[p];
            lattice_count = uint64_t{lattice.columns} * lattice.rows;
            if (!lies_within(lattice.first, lattice_count, t.placement_samples.size())) return "a lattice has no samples";
            placed += lattice_count;
        }
        if (placed > 2 * t.placement_samples.size()) return "placements have samples in common";
        add_samples(t.placement_samples.data() + placement.first, placement.count, !t.slots.empty(), sizes[p]);
        if (lattice_count != 0)
            add_samples(t.placement_samples.data() + t.lattices[p].first, lattice_count, !t.slots.empty(), sizes[p]);
        if (sizes[p].size() > 4096) return "a placement has too many slots";
    }
    return nullptr;
}

/// `rings`: ring points that surfaces may have.
Cause check_grid(const GridTable& t, uint64_t rings) {
    if ((t.value_count != 1 && t.value_count != 3) || t.samples_per_face == 0 || t.faces_per_pass == 0)
        return "its sizes are none";
    const uint64_t grid_size = uint64_t{t.ptex_count} * t.samples_per_face;
    const bool local = t.rate == 0;  // local points: as if each were a face
    if (local ? t.samples_per_face != 1 || !t.slots.empty() : grid_size != t.total_sample_count)
        return "its faces do not have as many samples as it";
    if (const Cause cause = check_classes(t)) return cause;
    std::vector<SlotSizes> sizes;
    if (const Cause cause = check_placements(t, sizes)) return cause;
    const bool good = all_of(t.surfaces.size(), [&](size_t i) {
        const GridSurface& s = t.surfaces[i];
        if (s.grid_class >= t.classes.size() || s.placement >= t.placements.size()) return false;
        const GridClass& c = t.classes[s.grid_class];
        if (!lies_within(s.first_ring, c.ring_size, rings) || t.placements[s.placement].count != c.sample_count) return false;
        for (const auto& [slot, largest] : sizes[s.placement]) {
            uint64_t sample = largest, end = t.samples_per_face;
            if (!t.slots.empty()) {
                if (uint64_t{s.ptex_face} + slot >= t.slots.size()) return false;
                const uint32_t first = t.slots[s.ptex_face + slot];
                if (first == kInvalidIndex) continue;
                sample += first;
                end = t.total_sample_count;
            } else if (local) {
                sample += s.ptex_face;
                end = std::min<uint64_t>(t.total_sample_count, (s.ptex_face / t.faces_per_pass + uint64_t{1}) * t.faces_per_pass);
            } else if (s.ptex_face >= t.ptex_count) {
                return false;
            }
            if (sample >= end) return false;
        }
        return true;
    });
    return good ? nullptr : "a surface has no such class, ring or samples";
}

// Patch trees.

/// Baked without trees.
bool has_no_trees(const PatchTreeTable& t) {
    return t.max_rate == 0 && t.tree_count == 0 && t.bytes() == 0 && t.local_points.total_sample_count == 0;
}

Cause check_trees(const PatchTreeTable& t, uint64_t rings) {
    if (has_no_trees(t)) return nullptr;
    if (t.max_rate < 2) return "its rate is too small";
    if (const Cause cause = check_grid(t.local_points, rings)) return cause;
    if (t.local_points.rate != 0) return "its local points are a grid";
    const bool triangles = t.options.scheme == Scheme::loop;
    std::vector<uint32_t> kinds(t.nodes.size()), largest(t.nodes.size(), 0);
    for (size_t n = 0; n < kinds.size(); ++n) kinds[n] = shared::node_kind(t.nodes[n]);
    Forest forest;
    if (const Cause cause = forest.walk(kinds, [&](uint32_t n) { return shared::tree_first(t.nodes[n]); })) return cause;
    for (size_t n = kinds.size(); n-- > 0;) {  // the largest local point of each tree, from leaves to roots
        const uint32_t first = shared::tree_first(t.nodes[n]), children = child_count(kinds[n]);
        if (children != 0) {
            largest[n] = *std::max_element(largest.begin() + first, largest.begin() + first + children);
            continue;
        }
        const bool known = kinds[n] == shared::kNodeCorner ||
                           (triangles ? kinds[n] == shared::kNodeBoxSpline || kinds[n] == shared::kNodeLinear
                                      : kinds[n] == shared::kNodeBicubic || kinds[n] == shared::kNodeBilinear);
        if (!known) return "a node of a tree is of no kind";
        if (!lies_within(uint64_t{first} * shared::kLeafWords, shared::kLeafWords, t.leaf_points.size()))
            return "a leaf has no points";
        for (uint32_t w = 0; w < shared::kLeafWords; ++w) {
            const uint32_t word = t.leaf_points[size_t{first} * shared::kLeafWords + w];
            largest[n] = std::max({largest[n], word & 0xffff, word >> 16});
        }
    }
    const uint64_t local_count = t.local_points.total_sample_count;
    const bool good = all_of(t.surfaces.size(), [&](size_t i) {
        const TreeSurface& s = t.surfaces[i];
        const uint32_t root = shared::surface_plan(s.word);
        return root < kinds.size() && forest.is_child[root] == 0 && uint64_t{s.first_local} + largest[root] < local_count &&
               lies_within(s.first_local, s.hull_count, local_count);
    });
    if (!good) return "a surface has no such tree or local points";
    return check_ptex(t.ptex_surfaces, t.surfaces.size());
}

// Tessellation.

struct TessellationCheck {
    const TessellationTable& t;
    uint32_t side_count = t.options.scheme == Scheme::loop ? 3 : 4;

    const uint32_t* face(size_t f) const { return t.faces.data() + f * shared::kTessFaceWords; }
    const uint32_t* row(size_t r) const { return t.rows.data() + r * shared::kTessRowWords; }
    const uint32_t* edge(size_t e) const { return t.rate_edges.data() + e * shared::kRateEdgeWords; }
    bool is_drawn(uint32_t f) const { return f < t.face_count && face(f)[0] != shared::kNoSide; }

    bool good_sizes() const {
        return t.faces.size() == uint64_t{t.face_count} * shared::kTessFaceWords &&
               t.rows.size() == uint64_t{t.row_count} * shared::kTessRowWords &&
               t.corners.size() == uint64_t{t.corner_count} * shared::kTessCornerWords &&
               t.rate_edges.size() == uint64_t{t.rate_edge_count} * shared::kRateEdgeWords &&
               t.mesh_edge_count <= t.rate_edge_count && t.corner_copies.size() % 2 == 0 && t.row_copies.size() % 2 == 0 &&
               t.face_count < 1u << 28 && t.row_count <= shared::kSideRowMask;
    }
    static bool good_place(uint32_t u, uint32_t v) { return u <= 2 && v <= 2; }
    bool good_corner(size_t c) const {
        const uint32_t* words = t.corners.data() + c * shared::kTessCornerWords;
        return is_drawn(words[0]) && good_place(words[1] & 3, words[1] >> 2);
    }
    bool good_row(size_t r) const {
        const uint32_t* w = row(r);
        if (w[0] >= t.rate_edge_count || edge(w[0])[0] == shared::kNoRateEdge || !is_drawn(w[1])) return false;
        return w[2] < 256 && good_place(w[2] & 3, w[2] >> 2 & 3) && good_place(w[2] >> 4 & 3, w[2] >> 6);
    }
    /// Its rows, and the faces beside it: where those are not drawn the rows have no vertices.
    bool good_edge(size_t e) const {
        const uint32_t* w = edge(e);
        if (w[0] == shared::kNoRateEdge) return true;
        const bool halves = (w[0] & shared::kRateEdgeHalves) != 0;
        const uint64_t first = shared::side_row(w[0]);
        if (!lies_within(first, halves ? 2 : 1, t.row_count) || row(first)[0] != e || (halves && row(first + 1)[0] != e))
            return false;
        return (w[1] < t.face_count || w[1] == shared::kManyFaces) && (w[2] < t.face_count || w[2] == shared::kNoFace);
    }
    bool good_face(size_t f) const {
        const uint32_t* sides = face(f);
        if (sides[0] == shared::kNoSide) return true;
        if (side_count == 3 && sides[3] != shared::kNoSide) return false;
        for (uint32_t k = 0; k < side_count; ++k) {
            const uint64_t r = shared::side_row(sides[k]);
            const bool halves = (sides[k] & shared::kSideHalves) != 0;
            if (!lies_within(r, halves ? 2 : 1, t.row_count) || sides[4 + k] >= t.corner_count) return false;
            const uint32_t e = row(r)[0];
            if (e >= t.rate_edge_count) return false;
            const uint32_t* beside = edge(e);
            if (beside[1] != shared::kManyFaces && beside[1] != f && beside[2] != f) return false;
            if (halves && ((beside[0] & shared::kRateEdgeHalves) == 0 || row(r + 1)[0] != e || row(r)[3] >= t.corner_count))
                return false;
        }
        return true;
    }
    bool good_row_copy(size_t i) const {
        const uint32_t a = t.row_copies[2 * i], b = t.row_copies[2 * i + 1];
        return a < t.row_count && b < t.row_count && row(a)[0] == row(b)[0];
    }
    bool good_instances() const {
        const Array<uint32_t>& first = t.instance_faces;
        if (first.empty()) return true;
        return first[0] == 0 && first[first.size() - 1] == t.face_count &&
               all_of(first.size() - 1, [&](size_t i) { return first[i] <= first[i + 1]; });
    }
};

Cause check_tessellation(const TessellationTable& t) {
    const TessellationCheck check{t};
    if (!check.good_sizes()) return "arrays are not of the sizes that its counts ask for";
    if (!all_of(t.corner_count, [&](size_t c) { return check.good_corner(c); })) return "a corner is at no place";
    if (!all_of(t.row_count, [&](size_t r) { return check.good_row(r); })) return "a row has no edge or place";
    if (!all_of(t.rate_edge_count, [&](size_t e) { return check.good_edge(e); })) return "an edge has no rows or faces";
    if (!all_of(t.face_count, [&](size_t f) { return check.good_face(f); })) return "a face has no such sides or corners";
    if (!all_below(t.corner_copies, t.corner_count)) return "a corner is a copy of none";
    if (!all_of(t.row_copy_count(), [&](size_t i) { return check.good_row_copy(i); })) return "a row is a copy of none";
    return check.good_instances() ? nullptr : "its instances are not all of its faces, in order";
}

/// What is drawn has a surface in the other table.
bool has_faces(const Array<uint32_t>& ptex_surfaces, const TessellationTable& t) {
    if (ptex_surfaces.size() != t.face_count) return false;
    return all_of(t.face_count, [&](size_t f) {
        return t.faces[f * shared::kTessFaceWords] == shared::kNoSide || ptex_surfaces[f] != shared::kPtexHole;
    });
}

Cause check_stencils(const StencilTable& t) {
    const uint64_t entries = t.indices.size();
    if (t.offsets.size() > kInvalidIndex) return "there are too many rows";
    if (t.offsets.empty() ? entries != 0 : t.offsets[0] != 0 || t.offsets.back() != entries) return "rows do not fill it";
    if (!all_of(t.row_count(), [&](size_t r) { return t.offsets[r] <= t.offsets[r + 1]; })) return "rows are not in order";
    const bool tangents = !t.tangent1_weights.empty();
    if (t.weights.size() != entries || t.tangent1_weights.size() != (tangents ? entries : 0) ||
        t.tangent2_weights.size() != t.tangent1_weights.size())
        return "there are not as many weights as indices";
    if (!all_below(t.indices, t.source_count)) return "a row refers to no point";
    const bool finite = all_finite(t.weights) && all_finite(t.tangent1_weights) && all_finite(t.tangent2_weights);
    return finite ? nullptr : "a weight is no number";
}

/// A patch table with its trees, values of `width` floats, and the tessellation.
Cause check_surface(const BakedMesh& mesh, const PatchTable& patches, const PatchTreeTable& trees,
                    const Array<float>& values, uint32_t width) {
    const TessellationTable& t = mesh.tessellation;
    const auto triangles = [](const SchemeOptions& o) { return o.scheme == Scheme::loop; };  // linear channels are bilinear
    const bool fit = has_no_trees(trees) || (triangles(trees.options) == triangles(t.options) && has_faces(trees.ptex_surfaces, t) &&
                                             trees.surfaces.size() == patches.surfaces.size());
    if (!fit || triangles(patches.options) != triangles(t.options) || !has_faces(patches.ptex_surfaces, t))
        return "patch table, trees and tessellation are not of one mesh";
    if (values.size() != uint64_t{width} * patches.control_count) return "there are not as many values as control points";
    return all_finite(values) ? nullptr : "a control point is no number";
}

}  // namespace

Result<void> check_baked_mesh(const BakedMesh& mesh) {
    Cause cause = nullptr;
    const char* where = nullptr;
    const auto check = [&](const char* table, const auto& body) {
        if (cause != nullptr) return;
        cause = body();
        where = table;
    };
    const auto rings = [](const PatchTable& patches) { return count_of(patches.ring_points); };
    check("tessellation table", [&] { return check_tessellation(mesh.tessellation); });
    check("patch table", [&] { return check_patches(mesh.patches); });
    check("patch trees", [&] { return check_trees(mesh.trees, rings(mesh.patches)); });
    check("positions", [&] {
        return check_surface(mesh, mesh.patches, mesh.trees, mesh.positions, mesh.positions.empty() ? 0 : 3);
    });
    check("edges", [&] {
        const bool good = mesh.edges.size() % 2 == 0 && all_below(mesh.edges, mesh.patches.control_count);
        return good ? nullptr : "an edge has no vertices";
    });
    for (const BakedChannel& c : mesh.channels) {
        check("patch table of a channel", [&] { return check_patches(c.patches); });
        check("patch trees of a channel", [&] { return check_trees(c.trees, rings(c.patches)); });
        check("values of a channel", [&] {
            return c.width == 0 ? "they have no width" : check_surface(mesh, c.patches, c.trees, c.values, c.width);
        });
    }
    for (const GridTable& grid : mesh.grids)
        check("grid", [&] {
            if (grid.rate == 0 || grid.rate > 256 || grid.ptex_count != mesh.patches.ptex_surfaces.size() || !grid.slots.empty())
                return "it is none of this mesh";
            return check_grid(grid, rings(mesh.patches));
        });
    for (const RefinedGridTable& refined : mesh.refined) {
        check("refined grid", [&] {
            return refined.level == 0 || refined.grid.ptex_count != 1 ? "it has no level"
                                                                      : check_grid(refined.grid, refined.ring_points.size());
        });
        check("refined grid", [&] {
            return all_below(refined.ring_points, refined.source_count) ? nullptr : "a ring refers to no point";
        });
    }
    for (const BakedStencils& s : mesh.stencils) check("stencils", [&] { return check_stencils(s.table); });
    if (cause == nullptr) return {};
    return Error{ErrorCode::parse_error, "is damaged: " + std::string(where) + ": " + cause};
}

}  // namespace limn
