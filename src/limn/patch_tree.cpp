#include "limn/patch_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <tuple>
#include <utility>

#include "limn/grid_passes.h"
#include "limn/parallel.h"
#include "limn/patch_evaluator.h"
#include "limn/patch_tree_cache.h"
#include "limn/topology.h"

namespace limn {
namespace {

using Row = std::span<const double>;  ///< over the ring of the surface

Error too_many_weights(uint64_t max_bytes) {
    return {ErrorCode::too_large, "local points need more than " + std::to_string(max_bytes >> 20) + " MiB of weights"};
}

/// One plan's tree by itself: nodes, leaves and rows counted from 0.
struct Tree {
    std::vector<uint32_t> nodes;
    std::vector<uint16_t> leaf_points;
    size_t width = 0;             ///< of rows, which follow each other
    std::vector<double> weights;
    std::vector<uint8_t> is_tangent;  ///< of each row; once sorted those are the last
    uint32_t point_count = 0;

    uint32_t row_count() const { return static_cast<uint32_t>(is_tangent.size()); }
    Row row(size_t r) const { return Row(weights).subspan(r * width, width); }
    uint32_t add(Row row, bool tangent) {
        weights.insert(weights.end(), row.begin(), row.end());
        is_tangent.push_back(tangent);
        return row_count() - 1;
    }
};

uint64_t hash_row(Row row) {
    uint64_t hash = row.size();
    for (const double w : row) hash = (std::rotl(hash, 27) ^ std::bit_cast<uint64_t>(w)) * 0x9e3779b97f4a7c15;
    return hash ^ hash >> 32;
}

/// What all trees of a table may take together. Tables of meshes are far from it; one from elsewhere, whose plans refer
/// to each other as they like, could ask for any amount.
struct Budget {
    uint64_t most_work;  ///< multiplications
    uint64_t most_weights;
    const BuildPart& part;
    std::atomic<uint64_t> work = 0, weights = 0;

    Budget(const PatchTable& table, uint64_t max_bytes, const BuildPart& build)
        : most_weights(max_bytes / sizeof(float)), part(build) {
        // Trees of meshes take less than each weight of a plan once for each point of the ring.
        constexpr uint64_t kMargin = 16, kLeast = uint64_t{1} << 28;
        uint64_t ring = 0;
        for (const Plan& plan : table.plans) ring = std::max<uint64_t>(ring, plan.ring_size);
        most_work = kLeast + kMargin * table.plan_weights.size() * ring;
    }
    void spend() { work = most_work + 1; }
    bool is_spent() const { return work > most_work || weights > most_weights || part.is_cancelled(); }
    Result<void> check(uint64_t max_bytes) const {
        if (auto ok = part.check(); !ok) return ok;
        if (weights > most_weights) return too_many_weights(max_bytes);
        if (is_spent()) return Error{ErrorCode::too_large, "patch trees larger than those of any mesh: plans refer to too many plans"};
        return {};
    }
};

/// A plan on the way down: the rows of its ring, and which of its rows have become local points.
struct Visit {
    uint32_t plan;
    std::vector<double> ring;  ///< of the width of the tree's; empty: the surface's own
    std::vector<uint32_t> local;
};

struct Grower {
    static constexpr uint64_t kNodeWork = 64;  ///< what a node takes, in multiplications
    const PatchTable& table;
    double smallest;  ///< cells up to this size have one place, their irregular corner
    bool triangles;
    uint32_t ring_size;
    Tree& tree;
    Budget& budget;  ///< a tree that it does not suffice for stays unfinished
    /// Rows of points by their hash; kInvalidIndex where there is none.
    struct Point {
        uint64_t hash = 0;
        uint32_t row = kInvalidIndex;
    };
    std::vector<Point> points = {};
    std::vector<double> row = {};

    /// Valid until the next call.
    template <class Weight>
    Row row_of(const Visit& visit, const Weight* weights) {
        const uint32_t size = table.plans[visit.plan].ring_size;
        if (visit.ring.empty()) {
            row.assign(weights, weights + size);
            return row;
        }
        row.assign(ring_size, 0.0);
        uint64_t count = 1;
        for (uint32_t j = 0; j < size; ++j) {
            if (weights[j] == 0) continue;
            ++count;
            const auto weight = static_cast<double>(weights[j]);
            const double* const point = visit.ring.data() + size_t{j} * ring_size;
            for (uint32_t i = 0; i < ring_size; ++i) row[i] += weight * point[i];
        }
        budget.work += count * ring_size + size;
        return row;
    }
    Row plan_row(const Visit& visit, uint32_t r) {
        if (visit.local[r] != kInvalidIndex) return tree.row(visit.local[r]);
        const Plan& plan = table.plans[visit.plan];
        return row_of(visit, table.plan_weights.data() + plan.first_weight +
                                 size_t{r} * shared::plan_row_stride(plan.ring_size));
    }
    uint32_t local_of(Visit& visit, uint32_t r) {
        uint32_t& local = visit.local[r];
        if (local == kInvalidIndex) local = add_point(plan_row(visit, r));
        return local;
    }
    /// Plans have points in common where one ends and the next begins.
    uint32_t add_point(Row point) {
        if (2 * size_t{tree.row_count()} >= points.size()) grow_points();
        const uint64_t hash = hash_row(point);
        const size_t mask = points.size() - 1;
        size_t at = hash & mask;
        for (; points[at].row != kInvalidIndex; at = (at + 1) & mask)
            if (points[at].hash == hash && std::ranges::equal(tree.row(points[at].row), point)) return points[at].row;
        points[at] = {hash, add_row(point, false)};
        return points[at].row;
    }
    void grow_points() {
        const auto old = std::exchange(points, std::vector<Point>(std::max<size_t>(1024, 2 * points.size())));
        const size_t mask = points.size() - 1;
        for (const Point& point : old) {
            if (point.row == kInvalidIndex) continue;
            size_t at = point.hash & mask;
            while (points[at].row != kInvalidIndex) at = (at + 1) & mask;
            points[at] = point;
        }
    }
    uint32_t add_row(Row added, bool tangent) {
        budget.weights += ring_size;
        return tree.add(added, tangent);
    }
    Visit enter(uint32_t plan) const {
        budget.work += table.plans[plan].row_count;
        return {plan, {}, std::vector<uint32_t>(table.plans[plan].row_count, kInvalidIndex)};
    }

    void add_leaf(uint32_t slot, uint32_t kind, uint32_t rotation, const std::vector<uint32_t>& points) {
        const size_t leaf = tree.leaf_points.size() / shared::kLeafPoints;
        tree.nodes[slot] = shared::pack_tree_node(kind, rotation, static_cast<uint32_t>(leaf));
        for (uint32_t k = 0; k < shared::kLeafPoints; ++k)
            tree.leaf_points.push_back(static_cast<uint16_t>(k < points.size() ? points[k] : points[0]));
    }

    /// The plan's surface at its corner: the limit, and that plus either tangent, as if tangents were of the size of the
    /// surface, not of the cell.
    void add_corner(uint32_t slot, uint32_t rotation, const Visit& visit, double size) {
        const PatchEvaluator<float> evaluator{table, triangles, table.plans[visit.plan].ring_size};
        PatchScratch scratch;
        scratch.ring.assign(evaluator.width * evaluator.width, 0.0);
        for (size_t j = 0; j < evaluator.width; ++j) scratch.ring[j * evaluator.width + j] = 1;
        evaluator.evaluate(visit.plan, shared::make_location(0, 0), scratch);
        budget.work += evaluator.width * evaluator.width;
        std::vector<uint32_t> points;
        for (uint32_t k = 0; k < 3; ++k) {
            double* row = scratch.values.data() + k * evaluator.width;
            for (size_t j = 0; k != 0 && j < evaluator.width; ++j) row[j] = scratch.values[j] + row[j] / size;
            points.push_back(add_row(row_of(visit, row), k != 0));
        }
        add_leaf(slot, shared::kNodeCorner, rotation, points);
    }

    void add_patch(uint32_t slot, uint32_t rotation, const PlanNode& node, Visit& visit) {
        const auto kind = static_cast<uint32_t>(node.kind());
        const Plan& plan = table.plans[visit.plan];
        std::vector<uint32_t> points(shared::patch_point_count(kind));
        for (uint32_t k = 0; k < points.size(); ++k)
            points[k] = local_of(visit, table.plan_points[plan.first_point + node.first + k]);
        if (node.kind() == PlanNodeKind::bilinear)
            points = {points[0], points[1], points[0], points[0], points[3], points[2]};
        add_leaf(slot, kind, rotation, points);
    }

    /// Those of a mesh go down some forty calls; a table from elsewhere must not take the stack.
    static constexpr uint32_t kMostDepth = 512;
    uint32_t depth = 0;

    /// `node` of the plan visited, whose cell is size_u x size_v of the surface.
    void grow(uint32_t slot, uint32_t rotation, const PlanNode& node, Visit& visit, double size_u, double size_v) {
        if (depth == kMostDepth) budget.spend();
        if (budget.is_spent()) return;
        ++depth;
        grow_node(slot, rotation, node, visit, size_u, size_v);
        --depth;
    }
    void grow_node(uint32_t slot, uint32_t rotation, const PlanNode& node, Visit& visit, double size_u, double size_v) {
        const Plan& plan = table.plans[visit.plan];
        if (node.kind() == PlanNodeKind::plan) {
            Visit next = enter(node.plan());
            const uint32_t* rows = table.plan_points.data() + plan.first_point + node.first;
            for (uint32_t k = 0; k < table.plans[next.plan].ring_size && !budget.is_spent(); ++k) {
                const Row point = plan_row(visit, rows[k]);
                next.ring.insert(next.ring.end(), point.begin(), point.end());
            }
            if (budget.is_spent()) return;
            const PlanNode& root = table.plan_nodes[table.plans[next.plan].first_node];
            // Others are patches, and those along creases, which end by themselves.
            const bool is_irregular = root.kind() == PlanNodeKind::split || root.kind() == PlanNodeKind::plan;
            if (is_irregular && std::max(size_u, size_v) <= smallest)
                return add_corner(slot, node.rotation(), next, size_u);
            return grow(slot, node.rotation(), root, next, size_u, size_v);
        }
        if (node.kind() > PlanNodeKind::split_v) return add_patch(slot, rotation, node, visit);
        const uint32_t count = node.kind() == PlanNodeKind::split ? 4 : 2;
        const auto first = static_cast<uint32_t>(tree.nodes.size());
        tree.nodes[slot] = shared::pack_tree_node(static_cast<uint32_t>(node.kind()), rotation, first);
        tree.nodes.resize(first + count);
        budget.work += count * kNodeWork;
        if (node.kind() != PlanNodeKind::split_v) size_u /= 2;
        if (node.kind() != PlanNodeKind::split_u) size_v /= 2;
        // Down the chain of first children lies the plan's own corner, which ends the chain where it is small.
        const bool at_root = &node == &table.plan_nodes[plan.first_node];
        for (uint32_t c = 0; c < count; ++c) {
            const PlanNode* child = &table.plan_nodes[plan.first_node + node.first + c];
            const bool small = std::max(size_u, size_v) <= smallest;
            if (c == 0 && small && plan.has_corner_rows != 0 && (at_root || on_first_chain) &&
                child->kind() <= PlanNodeKind::split_v) {
                add_corner(first, 0, visit, size_u);
                continue;
            }
            const bool before = on_first_chain;
            on_first_chain = c == 0 && (at_root || before);
            grow(first + c, 0, *child, visit, size_u, size_v);
            on_first_chain = before;
        }
    }
    bool on_first_chain = false;
};

/// Puts tangents behind points.
void sort_rows(Tree& tree) {
    std::vector<uint16_t> place(tree.row_count());
    Tree sorted{.width = tree.width};
    sorted.weights.reserve(tree.weights.size());
    for (const bool tangents : {false, true}) {
        for (uint32_t r = 0; r < tree.row_count(); ++r)
            if ((tree.is_tangent[r] != 0) == tangents) place[r] = static_cast<uint16_t>(sorted.add(tree.row(r), tangents));
        if (!tangents) tree.point_count = sorted.row_count();
    }
    tree.weights.swap(sorted.weights);
    tree.is_tangent.swap(sorted.is_tangent);
    for (uint16_t& point : tree.leaf_points) point = place[point];
}

Tree grow_tree(const PatchTable& table, uint32_t plan, double smallest, bool relative, Budget& budget) {
    Tree tree;
    tree.nodes.resize(1);
    tree.width = table.plans[plan].ring_size;
    if (relative) tree.add(std::vector<double>(tree.width, 0.0), false);  // the origin, relative to itself
    Grower grower{table, smallest, table.options.scheme == Scheme::loop, table.plans[plan].ring_size, tree, budget};
    Visit visit = grower.enter(plan);
    grower.grow(0, 0, table.plan_nodes[table.plans[plan].first_node], visit, 1, 1);
    if (tree.row_count() <= 0xffff && !budget.is_spent()) sort_rows(tree);
    return tree;
}

using Trees = std::vector<std::shared_ptr<const Tree>>;

/// Rows are padded to a multiple of this: trees of nearly equal size then share a dispatch.
constexpr uint32_t kRowPadding = 16;
uint32_t padded_rows(const Tree& tree) {
    return (tree.row_count() + kRowPadding - 1) / kRowPadding * kRowPadding;
}

/// Nodes and leaves of all trees in a row: the root of each.
std::vector<uint32_t> join_trees(const Trees& trees, PatchTreeTable& out) {
    size_t node_count = 0, leaf_count = 0;
    for (const auto& tree : trees) {
        node_count += tree->nodes.size();
        leaf_count += tree->leaf_points.size() / shared::kLeafPoints;
    }
    std::vector<uint32_t> roots;
    if (node_count >= shared::kMaxTreeFirst || leaf_count >= shared::kMaxTreeFirst) return roots;
    out.nodes.allocate(node_count);
    out.leaf_points.allocate(leaf_count * shared::kLeafWords);
    uint32_t node_at = 0, leaf_at = 0;
    for (const auto& shared_tree : trees) {
        const Tree& tree = *shared_tree;
        roots.push_back(node_at);
        for (size_t n = 0; n < tree.nodes.size(); ++n) {
            const uint32_t word = tree.nodes[n], kind = shared::node_kind(word);
            const uint32_t base = kind <= shared::kNodeSplitV ? node_at : leaf_at;
            out.nodes[node_at + n] =
                shared::pack_tree_node(kind, shared::node_rotation(word), shared::tree_first(word) + base);
        }
        node_at += static_cast<uint32_t>(tree.nodes.size());
        for (size_t w = 0; w < tree.leaf_points.size() / 2; ++w)
            out.leaf_points[leaf_at * shared::kLeafWords + w] =
                tree.leaf_points[2 * w] | static_cast<uint32_t>(tree.leaf_points[2 * w + 1]) << 16;
        leaf_at += static_cast<uint32_t>(tree.leaf_points.size() / shared::kLeafPoints);
    }
    return roots;
}

/// The rows of tree t as a class of a grid: sample s is local point s of a surface.
void write_class(const Tree& tree, const GridClass& c, GridTable& grid) {
    for (uint32_t s = 0; s < c.sample_count; ++s) {
        for (uint32_t j = 0; j < 4 * c.group_count; ++j) {
            const size_t at = c.first_weight + size_t{j / 4} * c.sample_count + s;
            const bool filled = s < tree.row_count() && j < c.ring_size;
            grid.weights[4 * at + j % 4] = filled ? static_cast<float>(tree.row(s)[j]) : 0.0f;
        }
    }
}

Result<void> add_classes(const PatchTable& table, const Trees& trees, const std::vector<uint32_t>& plans,
                         uint64_t max_bytes, GridTable& grid, const BuildPart& part) {
    uint64_t groups = 0, samples = 0;
    for (size_t t = 0; t < trees.size(); ++t) {
        const uint32_t ring = table.plans[plans[t]].ring_size;
        GridClass c{ring, ring_group_count(ring), padded_rows(*trees[t]), static_cast<uint32_t>(groups),
                    shared::kGridCornersFirst};
        grid.classes.push_back(c);
        grid.placements.push_back({1, 0, 0, 1, static_cast<uint32_t>(samples), c.sample_count});
        groups += uint64_t{c.group_count} * c.sample_count;
        samples += c.sample_count;
        if (groups * 16 > max_bytes)
            return too_many_weights(max_bytes);
    }
    grid.weights.allocate(groups * 4);
    grid.placement_samples.allocate(samples);
    for (size_t t = 0; t < trees.size(); ++t) {
        uint32_t* sample = grid.placement_samples.data() + grid.placements[t].first;
        for (uint32_t s = 0; s < grid.classes[t].sample_count; ++s)
            sample[s] = s < trees[t]->row_count() ? s : kInvalidIndex;
    }
    for_each_index(
        static_cast<uint32_t>(trees.size()), part,
        [&](uint32_t t) { write_class(*trees[t], grid.classes[t], grid); }, 1);
    return {};
}

/// Gives each surface its local points; none of them crosses a pass.
Result<void> place_surfaces(const PatchTable& table, const Trees& trees,
                            const std::vector<uint32_t>& tree_of_plan, const std::vector<uint32_t>& roots,
                            PatchTreeTable& out, const BuildPart& part) {
    GridTable& grid = out.local_points;
    Array<GridSurface>& surfaces = grid.surfaces;
    surfaces.allocate(table.surfaces.size());
    out.surfaces.allocate(surfaces.size());
    uint64_t local = 0;
    auto place = [&](uint32_t i) {
        const Surface& s = table.surfaces[i];
        const uint32_t tree = tree_of_plan[s.plan()], count = trees[tree]->row_count();
        if (local / grid.faces_per_pass != (local + count - 1) / grid.faces_per_pass)
            local = (local / grid.faces_per_pass + 1) * grid.faces_per_pass;
        surfaces[i] = {s.first_ring, static_cast<uint32_t>(local), tree, tree};
        out.surfaces[i] = {shared::pack_surface(roots[tree], s.rotation()), static_cast<uint32_t>(local),
                           trees[tree]->point_count};
        local += count;
    };
    for_each_in_order(static_cast<uint32_t>(surfaces.size()), part.part(0, 0.5f), place);
    if (local > 0x7fffffff) return Error{ErrorCode::too_large, "2^31 local points or more"};
    grid.total_sample_count = local;
    if (auto ok = part.check(); !ok) return ok;
    sort_passes({surfaces.data(), surfaces.size()}, grid.faces_per_pass, part.part(0.5f, 1));
    return {};
}

/// What a tree depends on, beside what its plan is made from.
struct TreeKey {
    PlanIdentity plan;
    double smallest;
    bool relative;
    bool operator<(const TreeKey& other) const {
        return std::tie(plan, smallest, relative) < std::tie(other.plan, other.smallest, other.relative);
    }
};

uint64_t bytes_of(const Tree& tree) {
    uint64_t bytes = sizeof(Tree) + tree.nodes.size() * 4 + tree.leaf_points.size() * 2 + tree.is_tangent.size();
    return bytes + tree.weights.size() * sizeof(double);
}

}  // namespace

struct PatchTreeCache::Impl {
    std::mutex mutex;
    std::map<TreeKey, std::shared_ptr<const Tree>> trees;
    uint64_t bytes = 0;

    std::shared_ptr<const Tree> find(const TreeKey& key) {
        const std::lock_guard lock(mutex);
        const auto at = trees.find(key);
        return at == trees.end() ? nullptr : at->second;
    }
    void keep(const TreeKey& key, const std::shared_ptr<const Tree>& tree) {
        const std::lock_guard lock(mutex);
        if (trees.try_emplace(key, tree).second) bytes += bytes_of(*tree);
    }
};

PatchTreeCache::PatchTreeCache() : impl_(std::make_unique<Impl>()) {}
PatchTreeCache::~PatchTreeCache() = default;
PatchTreeCache::PatchTreeCache(PatchTreeCache&&) noexcept = default;
PatchTreeCache& PatchTreeCache::operator=(PatchTreeCache&&) noexcept = default;
uint32_t PatchTreeCache::size() const {
    const std::lock_guard lock(impl_->mutex);
    return static_cast<uint32_t>(impl_->trees.size());
}
uint64_t PatchTreeCache::bytes() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->bytes;
}

namespace {

/// `cache` may be null.
Result<PatchTreeTable> build(const PatchTable& table, const PatchTreeOptions& options, const PatchTreeCache* cache) {
    if (options.max_rate < 2 || options.max_rate > 128)
        return Error{ErrorCode::invalid_argument,
                     "a rate of " + std::to_string(options.max_rate) + " is not within 2 and 128"};
    if (options.points_per_pass < 65536)
        return Error{ErrorCode::invalid_argument, "passes hold 65,536 points or more"};
    if (table.end_cap != EndCap::exact)
        return Error{ErrorCode::unsupported, "tessellation of patch tables with Gregory end caps"};
    const BuildPart& part = options.control;
    if (auto ok = part.start(); !ok) return ok.error();
    std::vector<uint32_t> tree_of_plan(table.plans.size(), kInvalidIndex), plans;
    for (const Surface& s : table.surfaces) {
        if (tree_of_plan[s.plan()] != kInvalidIndex) continue;
        tree_of_plan[s.plan()] = static_cast<uint32_t>(plans.size());
        plans.push_back(s.plan());
    }
    Trees trees(plans.size());
    // Rates are measured at quarters of edges, whatever they may be.
    const double smallest = 1.0 / std::bit_ceil(std::max(options.max_rate, 8u));
    Budget budget(table, options.max_weight_bytes, part);
    const auto key_of = [&](uint32_t t) { return TreeKey{table.plan_identities[plans[t]], smallest, options.relative}; };
    for_each_index(
        static_cast<uint32_t>(plans.size()), part.part(0, 0.4f),
        [&](uint32_t t) {
            if (cache != nullptr) trees[t] = cache->impl().find(key_of(t));
            if (trees[t] != nullptr) return;
            trees[t] = std::make_shared<const Tree>(grow_tree(table, plans[t], smallest, options.relative, budget));
            if (cache != nullptr && !budget.is_spent()) cache->impl().keep(key_of(t), trees[t]);
        },
        1);
    if (auto ok = budget.check(options.max_weight_bytes); !ok) return ok.error();
    for (const auto& tree : trees)
        if (tree->row_count() > 0xffff)
            return Error{ErrorCode::unsupported, "tessellation of a surface with 2^16 local points or more"};

    PatchTreeTable out;
    out.options = table.options;
    out.max_rate = options.max_rate;
    out.relative = options.relative;
    out.tree_count = static_cast<uint32_t>(trees.size());
    const std::vector<uint32_t> roots = join_trees(trees, out);
    if (roots.size() != trees.size()) return Error{ErrorCode::too_large, "patch trees of 2^26 nodes or more"};
    GridTable& grid = out.local_points;
    grid.rate = 0;
    grid.value_count = 1;
    grid.relative = options.relative;
    grid.ptex_count = static_cast<uint32_t>(table.ptex_surfaces.size());
    grid.samples_per_face = 1;
    grid.faces_per_pass = options.points_per_pass;
    if (auto added = add_classes(table, trees, plans, options.max_weight_bytes, grid, part.part(0.4f, 0.5f));
        !added)
        return added.error();
    if (auto placed = place_surfaces(table, trees, tree_of_plan, roots, out, part.part(0.5f, 0.98f));
        !placed) return placed.error();
    out.ptex_surfaces = table.ptex_surfaces;
    if (auto ok = part.reach(1); !ok) return ok.error();
    return out;
}

}  // namespace

Result<PatchTreeTable> build_patch_trees(const PatchTable& table, const PatchTreeOptions& options) {
    return build(table, options, nullptr);
}

Result<PatchTreeTable> build_patch_trees(const PatchTable& table, const PatchTreeOptions& options,
                                         const PatchTreeCache& cache) {
    if (table.plan_identities.size() != table.plans.size())
        return Error{ErrorCode::invalid_argument, "the table does not have an identity for each plan"};
    return build(table, options, &cache);
}

}  // namespace limn
