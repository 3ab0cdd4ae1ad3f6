#include "limn/patch_table_parts.h"

#include <algorithm>
#include <atomic>
#include <unordered_map>

#include "limn/parallel.h"

namespace limn {

Result<void> check_options(const PatchTableOptions& options) {
    if (options.plan_depth < 1 || options.plan_depth > 10)
        return Error{ErrorCode::invalid_argument,
                     "plan depth " + std::to_string(options.plan_depth) + " is not within 1 and 10"};
    if (options.isolation_level < 1 || options.isolation_level > 10)
        return Error{
            ErrorCode::invalid_argument,
            "isolation level " + std::to_string(options.isolation_level) + " is not within 1 and 10"};
    return {};
}

PlanOptions plan_options(const SchemeOptions& scheme, const PatchTableOptions& options) {
    const bool linear = options.interpolation == Interpolation::varying || scheme.scheme == Scheme::bilinear;
    return {linear, options.end_cap,
            options.end_cap == EndCap::exact ? options.plan_depth : options.isolation_level - 1};
}

namespace {

/// Numbers, in a PlanSet, of the plans of kinds.
class PlanFinder {
  public:
    PlanFinder(const CandidateSource& source, PlanSet& plans) : source_(source), plans_(plans), salts_{} {
        const SchemeOptions& scheme = source.base.options;
        const auto salt = [&](PlanSource of) -> PlanHash& { return salts_[static_cast<size_t>(of)]; };
        salt(PlanSource::patch) = hash_signature(make_patch_key(scheme, {}));
        salt(PlanSource::star) = hash_signature(make_star_key(scheme, source.options, {}));
        salt(PlanSource::neighborhood) = hash_signature(begin_plan_key(scheme, source.options));
    }

    uint32_t find(const CandidateChunk& chunk, const CandidateChunk::Kind& kind, uint32_t first_face,
                  const Level1& level1) {
        if (kind.source == PlanSource::regular) {
            if (regular_ == kInvalidIndex) regular_ = find_regular();
            return regular_;
        }
        const auto source = static_cast<size_t>(kind.source);
        const auto [at, is_new] = found_[source].try_emplace(kind.hash, 0);
        if (is_new) at->second = find_irregular(chunk.list[kind.candidate], kind, first_face, level1);
        return at->second;
    }

  private:
    uint32_t find_regular() {
        local_ = make_regular_patch(source_.base.options, source_.options.linear);
        return find_patch_plan();
    }
    /// Where a hash is known, nothing is looked at again.
    uint32_t find_irregular(const Candidate& first, const CandidateChunk::Kind& kind, uint32_t first_face,
                            const Level1& level1) {
        const PlanHash& salt = salts_[static_cast<size_t>(kind.source)];
        const PlanHash hash = {kind.hash[0] ^ salt[0], kind.hash[1] ^ salt[1]};
        if (const uint32_t known = plans_.find(hash); known != kInvalidIndex) return known;
        const uint32_t child = first_child_face(source_.base, first_face) + first.face;
        const bool is_quad =
            first.refined != 0 && source_.has_stars && find_base_quad(source_.base, child, quad_);
        const uint32_t number =
            is_quad ? find_quad()
                    : find_face(first.refined != 0 ? level1.child : source_.base,
                                first.refined != 0 ? child - level1.first_face : first_face + first.face, kind.source,
                                first.rotation);
        plans_.keep_hash(hash, number);
        return number;
    }
    uint32_t find_quad() {
        if (quad_.pattern) {
            make_local(quad_.net, *quad_.pattern, local_);
            return find_patch_plan();
        }
        const PlanKey key = make_star_key(source_.base.options, source_.options, quad_.star);
        return plans_.find_or_request(key, [&] { return request_star_plan(quad_.star); });
    }
    uint32_t find_face(const Topology& t, uint32_t face, PlanSource source, uint32_t rotation) {
        if (source == PlanSource::patch) {
            PatchPoints patch;
            find_patch(t, face, source_.options, patch);
            make_local(patch, local_);
            return find_patch_plan();
        }
        walk_around({t}, face, {rotation, false}, hood_);
        const PlanKey key = make_plan_key(t, hood_, source_.options);
        return plans_.find_or_request(key, [&] { return request_plan(t, hood_, rotation); });
    }
    uint32_t find_patch_plan() {
        const PlanKey key = make_patch_key(source_.base.options, local_);
        return plans_.find_or_request(key, [&] { return request_patch_plan(local_); });
    }

    const CandidateSource& source_;
    PlanSet& plans_;
    // By PlanSource; what is the same for all hashes of such plans.
    std::array<PlanHash, 4> salts_;
    std::array<std::unordered_map<PlanHash, uint32_t, PlanHashHash>, 4> found_;
    uint32_t regular_ = kInvalidIndex;
    Neighborhood hood_;
    LocalPatch local_;
    BaseQuad quad_;
};

}  // namespace

Result<void> find_plans(const CandidateSource& source,
                        const std::function<const Level1&(uint32_t)>& level1_of, PlanCache::Impl& cache,
                        Candidates& candidates, const BuildPart& part) {
    PlanSet plans(source.base.options, source.options, cache);
    PlanFinder finder(source, plans);
    std::vector<std::pair<CandidateChunk*, std::vector<uint32_t>>> found;
    auto find_in_chunk = [&](uint32_t k) {
        CandidateChunk& chunk = *candidates.chunks[k];
        if (chunk.plans.size() == chunk.kinds.size()) return;
        found.emplace_back(&chunk, std::vector<uint32_t>());
        for (const CandidateChunk::Kind& kind : chunk.kinds)
            found.back().second.push_back(finder.find(chunk, kind, candidates.first_faces[k], level1_of(k)));
    };
    for_each_in_order(candidates.chunk_count(), part.part(0, 0.5f), find_in_chunk, 1);
    if (auto ok = plans.build(part.part(0.5f, 1)); !ok) return ok;
    for (const auto& [chunk, numbers] : found)
        for (const uint32_t number : numbers) chunk->plans.push_back(plans.plan(number));
    return {};
}

std::vector<uint32_t> find_used_children(const Topology& base, const Candidates& candidates,
                                         const BuildPart& part) {
    std::vector<uint32_t> uses(level1_vertex_count(base), 0);
    uint32_t* const to = uses.data();
    for_each_index(
        candidates.chunk_count(), part,
        [&](uint32_t k) {
            const uint32_t* const rings = candidates.chunks[k]->rings.data();
            for_each_ring(*candidates.chunks[k], [&](const Candidate& at, uint32_t, uint32_t first) {
                if (at.refined == 0) return;
                for (uint32_t i = first; i < first + at.ring_size; ++i)
                    std::atomic_ref(to[rings[i]]).store(1, std::memory_order_relaxed);
            });
        },
        2);
    return uses;
}

namespace {

/// The plans that surfaces need, in the order in which they need them, and then those that plans need.
template <class Real>
Result<void> order_plans(PatchTableParts<Real>& parts) {
    std::unordered_map<const BuiltPlan*, uint32_t> numbers;
    parts.plans.clear();
    parts.plan_numbers.clear();
    auto number = [&](const BuiltPlan* plan) {
        const auto [at, is_new] = numbers.try_emplace(plan, static_cast<uint32_t>(parts.plans.size()));
        if (is_new) parts.plans.push_back(plan);
        return at->second;
    };
    for (const auto& chunk : parts.candidates.chunks)
        for (const BuiltPlan* plan : chunk->plans) parts.plan_numbers.push_back(number(plan));
    uint64_t weights = 0, points = 0;
    for (size_t i = 0; i < parts.plans.size(); ++i) {
        weights += parts.plans[i]->weights.size();
        points += parts.plans[i]->points.size();
        for (const BuiltPlan* reference : parts.plans[i]->references) number(reference);
    }
    if (weights > kInvalidIndex || points > kInvalidIndex || parts.plans.size() >= shared::kMaxPlans)
        return Error{ErrorCode::too_large, "plans hold 2^32 weights or more"};
    return {};
}

template <class Real>
void write_plan(const BuiltPlan& plan, const std::unordered_map<const BuiltPlan*, uint32_t>& numbers,
                const Plan& to, BasicPatchTable<Real>& table) {
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

template <class Real>
void write_plans(const std::vector<const BuiltPlan*>& plans, BasicPatchTable<Real>& table,
                 const BuildPart& part) {
    table.plans.allocate(plans.size());
    table.plan_identities.allocate(plans.size());
    std::unordered_map<const BuiltPlan*, uint32_t> numbers;
    uint32_t weight = 0, node = 0, point = 0;
    for (uint32_t i = 0; i < plans.size(); ++i) {
        const BuiltPlan& plan = *plans[i];
        numbers.emplace(&plan, i);
        table.plans[i] = {plan.ring_size, plan.row_count, weight, node, point, plan.has_corner_rows};
        table.plan_identities[i] = plan.identity;
        weight += static_cast<uint32_t>(plan.weights.size());
        node += static_cast<uint32_t>(plan.nodes.size());
        point += static_cast<uint32_t>(plan.points.size());
    }
    table.plan_weights.allocate(weight);
    table.plan_nodes.allocate(node);
    table.plan_points.allocate(point);
    for_each_index(
        static_cast<uint32_t>(plans.size()), part,
        [&](uint32_t i) { write_plan(*plans[i], numbers, table.plans[i], table); }, 4);
}

/// Of one chunk: a word for each ptex face (shared/patch_table_layout.h).
void write_ptex_surfaces(const CandidateSource& source, const CandidateChunk& chunk, uint32_t first_face,
                         uint32_t end_face, uint32_t surface, uint32_t* ptex) {
    const Topology& base = source.base;
    const bool triangles = base.options.scheme == Scheme::loop;
    const Candidate* at = chunk.list.data();
    for (uint32_t f = first_face; f < end_face; ++f) {
        const uint32_t size = base.size_of_face(f), ptex_count = size == (triangles ? 3 : 4) ? 1 : size;
        if (base.face_holes[f] != 0) {
            ptex = std::fill_n(ptex, ptex_count, shared::kPtexHole);
            continue;
        }
        const bool is_split = at->refined != 0;
        const uint32_t count = !is_split ? 1 : triangles ? 4 : size;
        for (uint32_t j = 0; j < ptex_count; ++j)
            *ptex++ = (surface + j) | (is_split && ptex_count == 1 ? shared::kPtexSplit : 0);
        at += count;
        surface += count;
    }
}

/// Surfaces, and the ptex faces that they cover.
template <class Real>
void write_surfaces(const CandidateSource& source, const PatchTableParts<Real>& parts,
                    BasicPatchTable<Real>& table, const BuildPart& part) {
    const Candidates& c = parts.candidates;
    std::vector<uint32_t> first_kinds(1, 0);
    for (const auto& chunk : c.chunks)
        first_kinds.push_back(first_kinds.back() + static_cast<uint32_t>(chunk->kinds.size()));
    table.surfaces.reuse(c.places.back().first_surface);
    table.ptex_surfaces.reuse(c.places.back().first_ptex);
    for_each_index(
        c.chunk_count(), part,
        [&](uint32_t k) {
            const CandidateChunk& chunk = *c.chunks[k];
            const ChunkPlace& place = c.places[k];
            write_ptex_surfaces(source, chunk, c.first_faces[k], c.first_faces[k + 1], place.first_surface,
                                table.ptex_surfaces.data() + place.first_ptex);
            for_each_ring(chunk, [&](const Candidate& at, uint32_t i, uint32_t first) {
                table.surfaces[place.first_surface + i] = {
                    shared::pack_surface(parts.plan_numbers[first_kinds[k] + at.kind], at.rotation),
                    static_cast<uint32_t>(place.first_ring) + first};
            });
        },
        2);
}

template <class Real>
void write_rings(const Array<uint32_t>& control_indices, const PatchTableParts<Real>& parts,
                 const PatchTableParts<Real>* before, BasicPatchTable<Real>& table, const BuildPart& part) {
    const Candidates& c = parts.candidates;
    const std::vector<uint32_t>& point_of_child = parts.points.point_of_child;
    bool kept =
        before != nullptr && !table.ring_points.narrow && before->points.point_of_child == point_of_child;
    Array<uint32_t> points = take_indices(table.ring_points, c.places.back().first_ring, kept);
    const auto is_kept = [&](uint32_t k) {
        const Candidates& old = before->candidates;
        return k < old.chunk_count() && c.chunks[k] == old.chunks[k] &&
               c.places[k].first_ring == old.places[k].first_ring;
    };
    for_each_index(
        c.chunk_count(), part.part(0, 0.9f),
        [&](uint32_t k) {
            if (kept && is_kept(k)) return;
            const std::vector<uint32_t>& rings = c.chunks[k]->rings;
            uint32_t* const to = points.data() + c.places[k].first_ring;
            for_each_ring(*c.chunks[k], [&](const Candidate& at, uint32_t, uint32_t first) {
                const uint32_t end = first + at.ring_size;
                if (at.refined != 0)
                    for (uint32_t i = first; i < end; ++i) to[i] = point_of_child[rings[i]];
                else if (!control_indices.empty())
                    for (uint32_t i = first; i < end; ++i) to[i] = control_indices[rings[i]];
                else
                    std::copy(rings.begin() + first, rings.begin() + end, to + first);
            });
        },
        2);
    table.ring_points = pack_indices(std::move(points), table.point_count(), part.part(0.9f, 1));
}

}  // namespace

template <class Real>
Result<void> place_parts(const CandidateSource& source, const Array<uint32_t>& control_indices,
                         const std::vector<uint32_t>& uses, PatchTableParts<Real>& parts,
                         const BuildPart& part) {
    const auto children = uses.size() - static_cast<uint64_t>(std::count(uses.begin(), uses.end(), 0u));
    if (parts.candidates.places.back().first_ring > kInvalidIndex ||
        children + parts.points.control_count + 64 > kInvalidIndex)
        return Error{ErrorCode::too_large, "rings of 2^32 points or more"};
    make_point_rows(source.base, source.options.linear, control_indices, uses, parts.points,
                    part.part(0, 0.8f));
    if (auto ok = part.check(); !ok) return ok;
    if (auto ok = place_points(parts.points, part.part(0.8f, 0.9f)); !ok) return ok;
    return order_plans(parts);
}

template <class Real>
void write_patch_table(const CandidateSource& source, const Array<uint32_t>& control_indices,
                       PatchTableParts<Real>& parts, const PatchTableParts<Real>* before,
                       BasicPatchTable<Real>& table, const BuildPart& part) {
    table.options = source.base.options;
    table.end_cap = source.options.end_cap;
    table.control_count = parts.points.control_count;
    if (before == nullptr || before->plans != parts.plans)
        write_plans(parts.plans, table, part.part(0, 0.2f));
    write_surfaces(source, parts, table, part.part(0.2f, 0.3f));
    write_points(parts.points, before != nullptr ? &before->points : nullptr, table, part.part(0.3f, 0.6f));
    if (!part.is_cancelled()) write_rings(control_indices, parts, before, table, part.part(0.6f, 1));
}

template Result<void> place_parts<float>(const CandidateSource&, const Array<uint32_t>&,
                                         const std::vector<uint32_t>&, PatchTableParts<float>&,
                                         const BuildPart&);
template Result<void> place_parts<double>(const CandidateSource&, const Array<uint32_t>&,
                                          const std::vector<uint32_t>&, PatchTableParts<double>&,
                                          const BuildPart&);
template void write_patch_table<float>(const CandidateSource&, const Array<uint32_t>&,
                                       PatchTableParts<float>&, const PatchTableParts<float>*, PatchTable&,
                                       const BuildPart&);
template void write_patch_table<double>(const CandidateSource&, const Array<uint32_t>&,
                                        PatchTableParts<double>&, const PatchTableParts<double>*,
                                        PatchTableDouble&, const BuildPart&);

}  // namespace limn
