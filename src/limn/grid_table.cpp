#include "limn/grid_table.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <unordered_map>

#include "limn/grid_passes.h"
#include "limn/parallel.h"
#include "limn/patch_evaluator.h"
#include "limn/topology.h"

namespace limn {
namespace {

constexpr uint32_t kWhole = 4;  ///< in place of a child: the surface is the whole ptex face

/// A sample of a surface: coordinates of the plan times rate, and which sample of the ptex face it is.
struct LatticeSample {
    int32_t x, y;
    uint32_t out;  ///< kInvalidIndex where another surface has it
    bool operator<(const LatticeSample& o) const { return y != o.y ? y < o.y : x < o.x; }
};

struct Lattices {
    const GridOptions& options;
    bool triangles;
    GridTable& out;
    /// Coordinates of each lattice's samples, and whether they are those of a child.
    std::vector<std::pair<std::vector<std::pair<int32_t, int32_t>>, bool>> lattices = {};
    struct Placed {
        uint32_t lattice, placement;
    };
    std::map<std::pair<uint32_t, uint32_t>, Placed> placed = {};
    std::vector<uint32_t> samples = {};

    int32_t rate() const { return static_cast<int32_t>(options.rate); }

    void rotate(int32_t& x, int32_t& y, uint32_t rotation) const {
        for (uint32_t k = 0; k < rotation; ++k) {
            const int32_t old_x = x;
            x = y;
            y = rate() - old_x - (triangles ? y : 0);
        }
    }
    /// Coordinates of sample (i, j) in a child; false where that child does not list it. What lies between
    /// children is listed so that those of one plan list the same places: between quads by the one that comes
    /// before, seen from the middle; the middle by all.
    bool enter(uint32_t child, int32_t i, int32_t j, int32_t& x, int32_t& y) const {
        const int32_t r = rate();
        x = child == kWhole ? i : 2 * i;
        y = child == kWhole ? j : 2 * j;
        if (child == kWhole) return true;
        if (triangles && child == 3) {  // the corners have its sides
            x = r - x;
            y = r - y;
            return x > 0 && y > 0 && x + y < r;
        }
        if (child == 1 || (!triangles && child == 2)) x -= r;
        if (child == 2 || child == 3) y -= r;
        if (triangles) return x >= 0 && y >= 0 && x + y <= r;
        int32_t own_x = x, own_y = y;
        rotate(own_x, own_y, child);
        return own_x >= 0 && own_y >= 0 && own_x <= r && (own_y < r || (own_x == r && own_y == r));
    }
    /// Which of the children that list sample (i, j) has it.
    bool owns(uint32_t child, int32_t i, int32_t j) const {
        const int32_t r = rate();
        if (child == kWhole || child == 3) return triangles || child == kWhole || 2 * i != r || 2 * j != r;
        if (!triangles) return child == 0 || 2 * i != r || 2 * j != r;
        int32_t x, y;
        for (uint32_t before = 0; before < child; ++before)
            if (enter(before, i, j, x, y)) return false;
        return true;
    }

    Placed place(uint32_t child, uint32_t rotation) {
        const auto [at, is_new] = placed.try_emplace({child, rotation});
        if (is_new) at->second = make(child, rotation);
        return at->second;
    }
    Placed make(uint32_t child, uint32_t rotation) {
        std::vector<LatticeSample> found;
        uint32_t out_index = 0;
        for (int32_t j = 0; j <= rate(); ++j) {
            for (int32_t i = 0; i <= (triangles ? rate() - j : rate()); ++i, ++out_index) {
                LatticeSample s{0, 0, out_index};
                if (!enter(child, i, j, s.x, s.y)) continue;
                if (!owns(child, i, j)) s.out = kInvalidIndex;
                rotate(s.x, s.y, rotation);
                found.push_back(s);
            }
        }
        std::sort(found.begin(), found.end());
        std::pair<std::vector<std::pair<int32_t, int32_t>>, bool> key{{}, child != kWhole};
        GridPlacement placement = turned(child, rotation);
        placement.first = static_cast<uint32_t>(samples.size());
        placement.count = static_cast<uint32_t>(found.size());
        for (const LatticeSample& s : found) {
            key.first.emplace_back(s.x, s.y);
            samples.push_back(s.out);
        }
        const auto at = std::find(lattices.begin(), lattices.end(), key);
        const auto lattice = static_cast<uint32_t>(at - lattices.begin());
        if (at == lattices.end()) lattices.push_back(std::move(key));
        out.placements.push_back(placement);
        if (!triangles) add_rows(child, found);
        return {lattice, static_cast<uint32_t>(out.placements.size() - 1)};
    }
    /// The smallest rectangle around the samples that the surface has.
    void add_rows(uint32_t child, const std::vector<LatticeSample>& found) {
        GridLattice rows{rate(), rate(), child == kWhole ? 1 : 2, 0, 0, static_cast<uint32_t>(samples.size())};
        int32_t end_x = 0, end_y = 0;
        for (const LatticeSample& s : found) {
            if (s.out == kInvalidIndex) continue;
            rows.x = std::min(rows.x, s.x);
            rows.y = std::min(rows.y, s.y);
            end_x = std::max(end_x, s.x + rows.step);
            end_y = std::max(end_y, s.y + rows.step);
        }
        rows.columns = static_cast<uint32_t>(std::max(0, (end_x - rows.x) / rows.step));
        rows.rows = static_cast<uint32_t>(std::max(0, (end_y - rows.y) / rows.step));
        samples.resize(samples.size() + size_t{rows.columns} * rows.rows, kInvalidIndex);
        for (const LatticeSample& s : found) {
            if (s.out == kInvalidIndex) continue;
            const auto i = static_cast<uint32_t>((s.x - rows.x) / rows.step), j = static_cast<uint32_t>((s.y - rows.y) / rows.step);
            samples[rows.first + j * rows.columns + i] = s.out;
        }
        out.lattices.push_back(rows);
    }
    GridPlacement turned(uint32_t child, uint32_t rotation) const {
        shared::PatchLocation at = shared::make_location(0, 0);
        if (triangles && child == 3) shared::move_location(at, 1, -1, 0, 1, 0, -1);
        shared::rotate_location(at, rotation, triangles);
        auto whole = [](double x) { return static_cast<int32_t>(x); };
        return {whole(at.uu), whole(at.uv), whole(at.vu), whole(at.vv), 0, 0};
    }
};

/// A plan and a lattice.
using ClassKey = std::pair<uint32_t, uint32_t>;

/// The points of a plan that is one patch are those of its ring, one by one.
template <class Real>
bool is_patch_over_ring(const BasicPatchTable<Real>& table, const Plan& plan) {
    const PlanNode& root = table.plan_nodes[plan.first_node];
    if (plan.row_count != plan.ring_size || plan.ring_size != shared::patch_point_count(static_cast<uint32_t>(root.kind())))
        return false;
    for (uint32_t k = 0; k < plan.ring_size; ++k) {
        const uint32_t row = table.plan_points[plan.first_point + root.first + k];
        if (table.plan_weights[plan.first_weight + row * shared::plan_row_stride(plan.ring_size) + k] != 1) return false;
    }
    return true;
}

template <class Real>
GridClass describe_class(const BasicPatchTable<Real>& table, uint32_t plan, size_t sample_count) {
    const uint32_t ring = table.plans[plan].ring_size;
    GridClass c{ring, ring_group_count(ring), static_cast<uint32_t>(sample_count), 0, shared::kGridCornersFirst};
    // Rings begin with the corners, except for those of patches.
    const PlanNodeKind root = table.plan_nodes[table.plans[plan].first_node].kind();
    const bool regular = is_patch_over_ring(table, table.plans[plan]);
    if (table.options.scheme == Scheme::loop) c.corners = shared::kGridCornersTriangle;
    if (regular && root == PlanNodeKind::bicubic) c.corners = shared::kGridCornersBicubic;
    if (regular && root == PlanNodeKind::box_spline) c.corners = shared::kGridCornersBoxSpline;
    return c;
}

/// The rows of a class: the surface over the unit vectors of the ring.
template <class Real>
void write_weights(const BasicPatchTable<Real>& table, const ClassKey& key, const Lattices& lattices,
                   const GridClass& c, GridTable& out, BuildSteps& steps) {
    const PatchEvaluator<Real> evaluator{table, lattices.triangles, c.ring_size};
    PatchScratch scratch;
    const auto& [coordinates, is_child] = lattices.lattices[key.second];
    for (uint32_t s = 0; s < c.sample_count && !steps.is_cancelled(); ++s) {
        scratch.ring.assign(size_t{c.ring_size} * c.ring_size, 0.0);
        for (size_t j = 0; j < c.ring_size; ++j) scratch.ring[j * c.ring_size + j] = 1;
        const auto [x, y] = coordinates[s];
        shared::PatchLocation at = shared::make_location(static_cast<double>(x) / lattices.rate(),
                                                         static_cast<double>(y) / lattices.rate());
        at.uu = at.vv = is_child ? 2 : 1;
        evaluator.evaluate(key.first, at, scratch);
        for (uint32_t k = 0; k < out.value_count; ++k) {
            const double* row = scratch.values.data() + size_t{k} * c.ring_size;
            for (uint32_t j = 0; j < 4 * c.group_count; ++j) {
                const size_t group =
                    c.first_weight + (size_t{j / 4} * out.value_count + k) * c.sample_count + s;
                out.weights[4 * group + j % 4] = j < c.ring_size ? static_cast<float>(row[j]) : 0.0f;
            }
        }
        steps.add(1);
    }
}

template <class Real>
std::vector<GridSurface> list_surfaces(const BasicPatchTable<Real>& table, Lattices& lattices,
                                       std::vector<ClassKey>& keys, const BuildPart& part) {
    std::vector<GridSurface> surfaces;
    surfaces.reserve(table.surfaces.size());  // one that grows keeps a cancellation waiting
    std::map<ClassKey, uint32_t> numbers;
    auto add = [&](uint32_t face, uint32_t surface_index, uint32_t child) {
        const Surface& surface = table.surfaces[surface_index];
        const Lattices::Placed placed = lattices.place(child, surface.rotation());
        const ClassKey key{surface.plan(), placed.lattice};
        if (lattices.lattices[placed.lattice].first.empty()) return;
        const auto [at, is_new] = numbers.try_emplace(key, static_cast<uint32_t>(keys.size()));
        if (is_new) keys.push_back(key);
        surfaces.push_back({surface.first_ring, face, placed.placement, at->second});
    };
    for_each_in_order(static_cast<uint32_t>(table.ptex_surfaces.size()), part, [&](uint32_t f) {
        const uint32_t word = table.ptex_surfaces[f];
        if (word == shared::kPtexHole) return;
        if ((word & shared::kPtexSplit) == 0) return add(f, word, kWhole);
        for (uint32_t child = 0; child < 4; ++child) add(f, (word & ~shared::kPtexSplit) + child, child);
    });
    return surfaces;
}

}  // namespace

template <class Real>
Result<GridTable> build_grid_table(const BasicPatchTable<Real>& table, const GridOptions& options) {
    if (options.rate < 1 || options.rate > 256)
        return Error{ErrorCode::invalid_argument,
                     "rate " + std::to_string(options.rate) + " is not within 1 and 256"};
    if (options.samples_per_pass == 0) return Error{ErrorCode::invalid_argument, "passes hold no samples"};
    const BuildPart& part = options.control;
    if (auto ok = part.start(); !ok) return ok.error();
    GridTable out;
    const bool triangles = table.options.scheme == Scheme::loop;
    out.rate = options.rate;
    out.value_count = options.derivatives ? 3 : 1;
    out.ptex_count = static_cast<uint32_t>(table.ptex_surfaces.size());
    out.samples_per_face =
        triangles ? (options.rate + 1) * (options.rate + 2) / 2 : (options.rate + 1) * (options.rate + 1);
    out.faces_per_pass = std::max(1u, options.samples_per_pass / out.samples_per_face);
    out.total_sample_count = uint64_t{out.ptex_count} * out.samples_per_face;
    Lattices lattices{options, triangles, out};
    std::vector<ClassKey> keys;
    std::vector<GridSurface> surfaces = list_surfaces(table, lattices, keys, part.part(0, 0.3f));
    sort_passes(surfaces, out.faces_per_pass, part.part(0.3f, 0.4f));
    uint64_t groups = 0, samples = 0;
    for (const ClassKey& key : keys) {
        out.classes.push_back(describe_class(table, key.first, lattices.lattices[key.second].first.size()));
        GridClass& c = out.classes.back();
        c.first_weight = static_cast<uint32_t>(groups);
        groups += uint64_t{c.group_count} * out.value_count * c.sample_count;
        samples += c.sample_count;
        if (groups * 16 > options.max_weight_bytes)
            return Error{ErrorCode::too_large,
                         "a grid of rate " + std::to_string(options.rate) + " needs more than " +
                             std::to_string(options.max_weight_bytes >> 20) + " MiB of weights"};
    }
    out.weights.allocate(groups * 4);
    BuildSteps steps(part.part(0.4f, 0.98f), samples);
    for_each_index(
        static_cast<uint32_t>(keys.size()),
        [&](uint32_t i) { write_weights(table, keys[i], lattices, out.classes[i], out, steps); }, 1);
    out.surfaces.allocate(surfaces.size());
    for_each_index(static_cast<uint32_t>(surfaces.size()), part.part(0.98f, 0.99f), [&](uint32_t i) { out.surfaces[i] = surfaces[i]; });
    out.placement_samples.allocate(lattices.samples.size());
    std::copy(lattices.samples.begin(), lattices.samples.end(), out.placement_samples.begin());
    if (auto ok = part.reach(1); !ok) return ok.error();
    return out;
}

void sort_passes(std::span<GridSurface> surfaces, uint32_t faces_per_pass, const BuildPart& part) {
    const BuildPart still = part.part(0, 0);  // passes are the steps
    std::vector<uint32_t> first;
    for_each_in_order(static_cast<uint32_t>(surfaces.size()), still, [&](uint32_t i) {
        if (i == 0 || surfaces[i].ptex_face / faces_per_pass != surfaces[i - 1].ptex_face / faces_per_pass)
            first.push_back(i);
    });
    const auto pass_count = static_cast<uint32_t>(first.size());
    first.push_back(static_cast<uint32_t>(surfaces.size()));
    auto sort = [&](uint32_t pass) {  // by counting: comparisons took most of the time that trees of a crowd did
        const uint32_t begin = first[pass], count = first[pass + 1] - begin;
        Array<GridSurface> unsorted;
        unsorted.allocate(count);
        std::vector<uint32_t> next(1);
        for_each_in_order(count, still, [&](uint32_t i) {
            const GridSurface& s = unsorted[i] = surfaces[begin + i];
            if (s.grid_class + 1 >= next.size()) next.resize(size_t{s.grid_class} + 2);
            ++next[s.grid_class + 1];
        });
        if (part.is_cancelled()) return;
        std::partial_sum(next.begin(), next.end(), next.begin());
        for_each_in_order(count, still, [&](uint32_t i) { surfaces[begin + next[unsorted[i].grid_class]++] = unsorted[i]; });
    };
    for_each_index(pass_count, part, sort, 1);
}

std::vector<PatchSample> list_grid_samples(Scheme scheme, uint32_t ptex_count, uint32_t rate) {
    std::vector<PatchSample> samples;
    for (uint32_t f = 0; f < ptex_count; ++f)
        for (uint32_t j = 0; j <= rate; ++j)
            for (uint32_t i = 0; i <= (scheme == Scheme::loop ? rate - j : rate); ++i)
                samples.push_back({f, static_cast<double>(i) / rate, static_cast<double>(j) / rate});
    return samples;
}

template Result<GridTable> build_grid_table<float>(const PatchTable&, const GridOptions&);
template Result<GridTable> build_grid_table<double>(const PatchTableDouble&, const GridOptions&);

}  // namespace limn
