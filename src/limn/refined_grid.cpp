#include "limn/refined_grid.h"

#include <algorithm>
#include <cmath>

#include "limn/face_groups.h"
#include "limn/face_numbers.h"
#include "limn/shared/patch_basis.h"

namespace limn {
namespace {

constexpr uint32_t kRegularRing = 16;

/// Where on a quad the target at a corner of the refined faces lies: digits are the children on its path, the last
/// first, and its own corner.
std::array<uint32_t, 2> lattice_position(uint32_t corner, uint32_t level) {
    constexpr uint32_t kX[] = {0, 1, 1, 0}, kY[] = {0, 0, 1, 1};
    uint32_t x = kX[corner % 4], y = kY[corner % 4];
    uint32_t path = corner / 4;
    for (uint32_t i = 0; i < level; ++i, path /= 4) {
        x += kX[path % 4] << i;
        y += kY[path % 4] << i;
    }
    return {x, y};
}

/// What control points of a uniform cubic spline weigh for those of its refinement: of each of 2^level + 1 places four.
std::vector<std::array<double, 4>> refined_basis(uint32_t level) {
    const double step = 1.0 / (1u << level);
    std::vector<std::array<double, 4>> weights((size_t{1} << level) + 1);
    for (size_t i = 0; i < weights.size(); ++i) {
        double f[4];
        shared::refined_cubic_basis(static_cast<double>(i) * step, step, f);
        std::copy_n(f, 4, weights[i].begin());
    }
    return weights;
}

/// The lattice of quads, and where each target is on it.
struct QuadLattice {
    uint32_t side = 0;  ///< targets along a side
    std::vector<std::array<uint32_t, 2>> positions;
    std::vector<std::array<double, 4>> basis;

    QuadLattice(const Block& block, uint32_t level) : side((1u << level) + 1), basis(refined_basis(level)) {
        for (const uint32_t corner : block.corners({})) positions.push_back(lattice_position(corner, level));
    }
};

/// Finds the place in rows of four for each ring point of a regular neighbourhood. False where the weights are not
/// those of a bicubic spline.
bool match_bicubic(const QuadLattice& lattice, const Weights& weights, std::array<uint32_t, kRegularRing>& ring_of_place) {
    std::array<bool, kRegularRing> taken = {};
    for (uint32_t j = 0; j < kRegularRing; ++j) {
        uint32_t place = 0;
        auto differs = [&] {
            for (size_t t = 0; t < lattice.positions.size(); ++t) {
                const auto [x, y] = lattice.positions[t];
                const double weight = lattice.basis[x][place % 4] * lattice.basis[y][place / 4];
                if (std::abs(weights.rows[t * weights.stride + j] - weight) > 1e-12) return true;
            }
            return false;
        };
        while (place < kRegularRing && (taken[place] || differs())) ++place;
        if (place == kRegularRing) return false;
        taken[place] = true;
        ring_of_place[place] = j;
    }
    return true;
}

/// Faces of one size: how their points are numbered, and where the placements of their orientations begin.
struct FaceSize {
    FaceNumbers numbers;
    uint32_t first_placement = 0;
};

/// One group of faces: what its surfaces have in common, and where its part of each array begins.
struct GroupPlan {
    uint32_t ring_size = 0, target_count = 0;
    uint64_t first_ring = 0, first_slot = 0;
};

struct Builder {
    const Job& job;
    const Groups& groups;
    std::optional<QuadLattice> lattice;  ///< none where no face is a quad of Catmull-Clark
    RefinedGridTable& out;
    std::map<uint32_t, FaceSize> sizes = {};
    std::vector<GroupPlan> plans = {};

    uint32_t group_size(size_t g) const { return groups.first[g + 1] - groups.first[g]; }
    bool has_lattice(uint32_t n) const { return lattice && n == 4; }
    /// Samples of quads are in rows of their lattice.
    size_t sample_of(uint32_t n, size_t target) const {
        if (!has_lattice(n)) return target;
        return size_t{lattice->positions[target][1]} * lattice->side + lattice->positions[target][0];
    }
    Result<void> place_faces();
    Result<void> plan_groups(uint64_t max_weight_bytes, const BuildPart& part);
    void write_group(size_t g, std::span<const Member> members, BuildSteps& steps);
    void write_member(size_t g, uint32_t surface, const std::array<uint32_t, kRegularRing>* ring_of_place, const Member& member,
                      Neighborhood& hood);
    void add_loose_vertices();
};

/// Placements of all sizes and orientations, and one more for vertices without faces.
Result<void> Builder::place_faces() {
    std::vector<uint32_t> samples;
    auto add = [&](uint32_t n, std::span<const uint32_t> words) {
        const auto first = static_cast<uint32_t>(samples.size()), count = static_cast<uint32_t>(words.size());
        out.grid.placements.push_back({1, 0, 0, 1, first, count});
        out.grid.lattices.push_back(has_lattice(n) ? GridLattice{0, 0, 1, lattice->side, lattice->side, first} : GridLattice{});
        samples.resize(samples.size() + count);
        for (size_t t = 0; t < count; ++t) samples[first + sample_of(n, t)] = words[t];
    };
    for (const auto& [n, block] : job.blocks) {
        auto numbers = number_face(job.base().options, block, n, out.level);
        if (!numbers) return numbers.error();
        const auto first = static_cast<uint32_t>(out.grid.placements.size());
        for (const std::vector<uint32_t>& words : numbers->words) add(n, words);
        sizes.emplace(n, FaceSize{std::move(*numbers), first});
    }
    const uint32_t only = 0;
    add(0, {&only, 1});
    out.grid.placement_samples.allocate(samples.size());
    std::copy(samples.begin(), samples.end(), out.grid.placement_samples.begin());
    return {};
}

/// Sizes of all arrays. What belongs to vertices without faces comes last.
Result<void> Builder::plan_groups(uint64_t max_weight_bytes, const BuildPart& part) {
    plans.resize(groups.first.size() - 1);
    auto plan_group = [&](uint32_t g) {
        const Member& member = groups.members[groups.first[g]];
        Neighborhood hood;
        walk_around(job.walk(), member.face, member.orientation, hood);
        plans[g].ring_size = static_cast<uint32_t>(hood.ring.size());
        plans[g].target_count = static_cast<uint32_t>(job.block(member.face).places.size());
    };
    for_each_index(static_cast<uint32_t>(plans.size()), part, plan_group, 16);
    if (auto ok = part.check(); !ok) return ok;
    uint64_t rings = 0, slots = 0, weights = 0, loose = 0;
    for (size_t g = 0; g < plans.size(); ++g) {
        GroupPlan& plan = plans[g];
        plan.first_ring = rings;
        plan.first_slot = slots;
        const uint32_t ring_groups = ring_group_count(plan.ring_size);
        out.grid.classes.push_back({plan.ring_size, ring_groups, plan.target_count,
                                    static_cast<uint32_t>(weights), shared::kGridCornersFirst});
        const uint32_t n = job.base().size_of_face(groups.members[groups.first[g]].face);
        rings += uint64_t{plan.ring_size} * group_size(g);
        slots += uint64_t{sizes.at(n).numbers.slot_count} * group_size(g);
        weights += uint64_t{ring_groups} * plan.target_count;
        if (weights * 16 > max_weight_bytes)
            return Error{ErrorCode::too_large, "refinement to level " + std::to_string(out.level) + " face by face needs more than " +
                                                   std::to_string(max_weight_bytes >> 20) + " MiB of weights"};
    }
    for_each_loose_vertex(job.base(), [&](uint32_t) { ++loose; });
    if (rings + loose > 0xffffffffu || slots + loose > 0xffffffffu)
        return Error{ErrorCode::too_large, "refinement face by face refers to 2^32 points or more"};
    out.ring_points.allocate(rings + loose);
    out.grid.slots.allocate(slots + loose);
    out.grid.surfaces.allocate(job.base().face_count + loose);
    out.grid.weights.allocate(4 * (weights + (loose != 0 ? 1 : 0)));
    for_each_index(static_cast<uint32_t>(out.grid.weights.size() / 4), part.part(1, 1), [&](uint32_t i) {
        std::fill_n(out.grid.weights.data() + size_t{4} * i, 4, 0.0f);
    });
    return part.check();
}

void Builder::write_member(size_t g, uint32_t surface, const std::array<uint32_t, kRegularRing>* ring_of_place,
                           const Member& member, Neighborhood& hood) {
    const GroupPlan& plan = plans[g];
    const uint32_t n = job.base().size_of_face(member.face), index = surface - groups.first[g];
    const FaceSize& size = sizes.at(n);
    const auto first_ring = static_cast<uint32_t>(plan.first_ring + uint64_t{index} * plan.ring_size);
    const auto first_slot = static_cast<uint32_t>(plan.first_slot + uint64_t{index} * size.numbers.slot_count);
    find_member_ring(job, member, hood);
    for (uint32_t j = 0; j < plan.ring_size; ++j)
        out.ring_points[first_ring + j] = hood.ring[ring_of_place != nullptr ? (*ring_of_place)[j] : j];
    write_face_slots(job.base(), job.counts, out.level, member.face,
                     {out.grid.slots.data() + first_slot, size.numbers.slot_count});
    const Orientation& o = member.orientation;
    out.grid.surfaces[surface] = {first_ring, first_slot, size.first_placement + o.rotation + (o.mirrored ? n : 0),
                                  static_cast<uint32_t>(g)};
}

void Builder::write_group(size_t g, std::span<const Member> members, BuildSteps& steps) {
    const GroupPlan& plan = plans[g];
    GridClass& c = out.grid.classes[g];
    const uint32_t n = job.base().size_of_face(members[0].face);
    std::array<uint32_t, kRegularRing> ring_of_place = {};
    {
        Program program;
        Weights weights;
        write_member_program(job, members[0], program);
        run_weights(program, weights);
        if (has_lattice(n) && plan.ring_size == kRegularRing && match_bicubic(*lattice, weights, ring_of_place))
            c.corners = shared::kGridCornersBicubic;
        const bool regular = c.corners == shared::kGridCornersBicubic;
        for (uint32_t t = 0; t < plan.target_count; ++t)
            for (uint32_t j = 0; j < plan.ring_size; ++j)
                out.grid.weights[4 * (c.first_weight + uint64_t{j / 4} * plan.target_count + sample_of(n, t)) + j % 4] =
                    static_cast<float>(weights.rows[t * weights.stride + (regular ? ring_of_place[j] : j)]);
    }
    const auto* places = c.corners == shared::kGridCornersBicubic ? &ring_of_place : nullptr;
    for_each_member(members, steps, [&](const Member& member, MemberScratch& scratch) {
        write_member(g, groups.first[g] + static_cast<uint32_t>(&member - members.data()), places, member, scratch.hood);
    });
}

/// Control points that no face uses are points of every level.
void Builder::add_loose_vertices() {
    uint32_t surface = job.base().face_count;
    const auto loose = static_cast<uint32_t>(out.grid.surfaces.size()) - surface;
    if (loose == 0) return;
    auto ring = static_cast<uint32_t>(out.ring_points.size()) - loose, slot = static_cast<uint32_t>(out.grid.slots.size()) - loose;
    const size_t weight = out.grid.weights.size() / 4 - 1;
    out.grid.weights[4 * weight] = 1;
    const auto number = static_cast<uint32_t>(out.grid.classes.size());
    out.grid.classes.push_back({1, 1, 1, static_cast<uint32_t>(weight), shared::kGridCornersFirst});
    const Array<uint32_t>& map = job.refinement.control_indices;
    for_each_loose_vertex(job.base(), [&](uint32_t v) {
        out.ring_points[ring] = map.empty() ? v : map[v];
        out.grid.slots[slot] = v;
        out.grid.surfaces[surface] = {ring, slot, static_cast<uint32_t>(out.grid.placements.size() - 1), number};
        ++surface, ++ring, ++slot;
    });
}

}  // namespace

Result<RefinedGridTable> build_refined_grid_table(const Refinement& refinement, const RefinedGridOptions& options) {
    if (options.level < 1 || options.level > 7)
        return Error{ErrorCode::invalid_argument, "level " + std::to_string(options.level) + " is not within 1 and 7"};
    const BuildPart& part = options.control;
    if (auto ok = part.start(); !ok) return ok.error();
    const Result<Job> job = make_job(refinement, {options.level, options.interpolation, Target::refined, part.part(0, 0.05f)});
    if (!job) return job.error();
    const Result<Groups> groups = group_faces(*job, part.part(0.05f, 0.3f));
    if (!groups) return groups.error();
    RefinedGridTable out;
    out.level = options.level;
    out.source_count = refinement.control_count;
    out.grid.rate = 1u << options.level;
    out.grid.value_count = 1;
    out.grid.ptex_count = out.grid.faces_per_pass = 1;
    out.grid.samples_per_face = job->counts.back().vertices;
    out.grid.total_sample_count = out.grid.samples_per_face;
    Builder builder{*job, *groups, {}, out};
    if (job->base().options.scheme == Scheme::catmull_clark && job->blocks.count(4) != 0)
        builder.lattice.emplace(job->blocks.at(4), options.level);
    if (auto placed = builder.place_faces(); !placed) return placed.error();
    if (auto planned = builder.plan_groups(options.max_weight_bytes, part.part(0.3f, 0.4f)); !planned) return planned.error();
    for_each_group(*groups, part.part(0.4f, 0.98f), [&](size_t g, std::span<const Member> members, BuildSteps& steps) {
        builder.write_group(g, members, steps);
    });
    builder.add_loose_vertices();
    if (auto ok = part.reach(1); !ok) return ok.error();
    return out;
}

}  // namespace limn
