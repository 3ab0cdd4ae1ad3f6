// Surfaces are found and walked in parallel, in chunks that keep the rings they meet; few of them need a plan
// that is not known yet.
#include "limn/patch_table.h"

#include <algorithm>
#include <unordered_map>

#include "limn/parallel.h"
#include "limn/patch_points.h"
#include "limn/plan_set.h"
#include "limn/refined_points.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// A surface before it has a plan: a face of the base level or of level 1.
struct Candidate {
    uint32_t face;
    uint32_t rotation : 2, refined : 1, regular : 1, ring_size : 28;
    uint32_t chunk_ring;  ///< where its ring begins in its chunk's
    uint32_t plan;
    std::array<uint64_t, 2> hash;
};

constexpr size_t kChunk = 256;

struct Builder {
    const Topology& base;
    const Topology& child;  ///< level 1; empty where every face is regular
    PlanOptions options;
    std::vector<Candidate> candidates;
    std::vector<std::vector<uint32_t>> chunk_rings;  ///< vertices of the candidate's level

    const Topology& level(const Candidate& c) const { return c.refined != 0 ? child : base; }
    void walk(const Candidate& c, bool list_faces, Neighborhood& hood) const {
        WalkOptions options{level(c)};
        options.list_faces = list_faces;
        walk_around(options, c.face, {c.rotation, false}, hood);
    }
    /// Which of the children of its face a quad is, where they keep the face's orientation: else 0.
    uint32_t place_in_parent(const Candidate& c) const {
        const uint32_t parent = base.face_of_corner(c.face);
        return base.size_of_face(parent) == 4 ? c.face - base.face_begin(parent) : 0;
    }
    /// body(candidate, its ring) in order of candidates.
    template <class Body>
    void for_each_ring(const Body& body) {
        for (size_t i = 0; i < candidates.size(); ++i) {
            Candidate& c = candidates[i];
            body(c, std::span(chunk_rings[i / kChunk].data() + c.chunk_ring, c.ring_size));
        }
    }
};

std::vector<uint8_t> find_regular_faces(const Topology& base, bool linear, EndCap end_cap) {
    std::vector<uint8_t> regular(base.face_count, 0);
    for_each_index(
        base.face_count,
        [&](uint32_t f) {
            uint32_t ring[16], count;
            PatchPoints patch;
            regular[f] =
                base.face_holes[f] == 0 && (find_regular_ring(base, f, linear, ring, count) ||
                                            (find_patch_points(base, f, linear, patch) &&
                                             (patch.crease_sharpness == 0 || end_cap == EndCap::exact)));
        },
        64);
    return regular;
}

/// Surfaces in face order, and the ptex faces that they cover.
Array<uint32_t> list_surfaces(const std::vector<uint8_t>& regular, Builder& b) {
    const Topology& base = b.base;
    const bool triangles = base.options.scheme == Scheme::loop;
    const uint32_t own_size = triangles ? 3 : 4;
    std::vector<uint32_t> ptex;
    auto add = [&](uint32_t face, bool refined) {
        b.candidates.push_back({face, 0, refined, 0, 0, 0, 0, {}});
    };
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t size = base.size_of_face(f), ptex_count = size == own_size ? 1 : size;
        const auto next = static_cast<uint32_t>(b.candidates.size());
        if (base.face_holes[f] != 0) {
            ptex.insert(ptex.end(), ptex_count, shared::kPtexHole);
        } else if (regular[f] != 0) {
            add(f, false);
            ptex.push_back(next);
        } else {
            const uint32_t first = triangles ? 4 * f : base.face_begin(f), count = triangles ? 4 : size;
            for (uint32_t j = 0; j < count; ++j) add(first + j, true);
            if (ptex_count == 1)
                ptex.push_back(next | shared::kPtexSplit);
            else
                for (uint32_t j = 0; j < size; ++j) ptex.push_back(next + j);
        }
    }
    Array<uint32_t> out;
    out.allocate(ptex.size());
    std::copy(ptex.begin(), ptex.end(), out.begin());
    return out;
}

/// Makes corner 1 of the patch corner 0.
void rotate_bicubic_ring(uint32_t (&ring)[16]) {
    uint32_t old[16];
    std::copy_n(ring, 16, old);
    for (uint32_t v = 0; v < 4; ++v)
        for (uint32_t u = 0; u < 4; ++u) ring[4 * v + u] = old[4 * u + (3 - v)];
}

/// Rings of all candidates, and hashes of what their plans depend on.
void walk_surfaces(Builder& b) {
    const size_t count = b.candidates.size(), chunks = (count + kChunk - 1) / kChunk;
    b.chunk_rings.resize(chunks);
    for_each_index(
        static_cast<uint32_t>(chunks),
        [&](uint32_t chunk) {
            Neighborhood hood;
            std::vector<uint32_t>& rings = b.chunk_rings[chunk];
            rings.reserve(kChunk * 18);
            for (size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
                Candidate& c = b.candidates[i];
                c.chunk_ring = static_cast<uint32_t>(rings.size());
                uint32_t ring[16], ring_size;
                if (find_regular_ring(b.level(c), c.face, b.options.linear, ring, ring_size)) {
                    c.regular = 1;
                    // Each quad child from the corner of its parent: grids then sample all four alike.
                    c.rotation = c.refined != 0 && b.child.face_size == 4 && ring_size == 16
                                     ? b.place_in_parent(c) & 3
                                     : 0;
                    for (uint32_t k = 0; k < c.rotation; ++k) rotate_bicubic_ring(ring);
                    rings.insert(rings.end(), ring, ring + ring_size);
                } else {
                    c.rotation = choose_plan_corner(b.level(c), c.face) & 3;
                    b.walk(c, false, hood);
                    c.hash = hash_signature(hood.signature);
                    ring_size = static_cast<uint32_t>(hood.ring.size());
                    rings.insert(rings.end(), hood.ring.begin(), hood.ring.end());
                }
                c.ring_size = ring_size & 0xfffffff;
            }
        },
        1);
}

/// The number of each candidate's plan in `plans`.
void find_plans(Builder& b, PlanSet& plans) {
    struct Hash {
        size_t operator()(const std::array<uint64_t, 2>& h) const { return h[0]; }
    };
    std::unordered_map<std::array<uint64_t, 2>, uint32_t, Hash> found;
    Neighborhood hood;
    uint32_t regular = kInvalidIndex;
    for (Candidate& c : b.candidates) {
        if (c.regular != 0) {
            if (regular == kInvalidIndex) {
                PlanRequest request = request_regular_plan(b.base.options, b.options.linear);
                const PlanKey key = request.key;
                regular = plans.find_or_request(key, [&] { return std::move(request); });
            }
            c.plan = regular;
            continue;
        }
        const auto [at, is_new] = found.try_emplace(c.hash, 0);
        if (is_new) {
            b.walk(c, true, hood);
            const PlanKey key = make_plan_key(b.level(c), hood, b.options);
            at->second =
                plans.find_or_request(key, [&] { return request_plan(b.level(c), hood, c.rotation, key); });
        }
        c.plan = at->second;
    }
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
    Result<void> copy() {
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
        uint32_t weight = 0, node_at = 0, point = 0;
        for (size_t i = 0; i < order.size(); ++i) {
            const BuiltPlan& plan = *order[i];
            table.plans[i] = {plan.ring_size, plan.row_count, weight, node_at, point, plan.has_corner_rows};
            table.plan_identities[i] = plan.identity;
            for (const double w : plan.weights) table.plan_weights[weight++] = static_cast<Real>(w);
            for (const PlanNode& node : plan.nodes) {
                PlanNode copied = node;
                if (node.kind() == PlanNodeKind::plan)
                    copied.word =
                        shared::pack_node(static_cast<uint32_t>(PlanNodeKind::plan),
                                          numbers.at(plan.references[node.plan()]), node.rotation());
                table.plan_nodes[node_at++] = copied;
            }
            for (const uint32_t p : plan.points) table.plan_points[point++] = p;
        }
        return {};
    }
};

template <class Real>
Result<void> write_rings(Builder& b, const Refinement& source, BasicPatchTable<Real>& table) {
    uint64_t ring_count = 0, children = 0;
    std::vector<uint32_t> point_of_child(b.child.vertex_count, kInvalidIndex);
    b.for_each_ring([&](const Candidate& c, std::span<const uint32_t> ring) {
        ring_count += ring.size();
        if (c.refined == 0) return;
        for (const uint32_t v : ring) {
            children += point_of_child[v] != 0;
            point_of_child[v] = 0;
        }
    });
    if (ring_count > kInvalidIndex || children + table.control_count + 64 > kInvalidIndex)
        return Error{ErrorCode::too_large, "rings of 2^32 points or more"};
    build_refined_points<Real>(b.base, b.options.linear, source.control_indices, point_of_child, table);
    std::vector<uint32_t> points;
    points.reserve(ring_count);
    b.for_each_ring([&](const Candidate& c, std::span<const uint32_t> ring) {
        for (const uint32_t v : ring)
            points.push_back(c.refined != 0                    ? point_of_child[v]
                             : !source.control_indices.empty() ? source.control_indices[v]
                                                               : v);
    });
    table.ring_points = pack_indices(points, table.point_count());
    return {};
}

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
    const std::vector<uint8_t> regular = find_regular_faces(base, linear, options.end_cap);
    Topology child;
    if (std::find(regular.begin(), regular.end(), 0) != regular.end()) child = refine_once(base, true);
    const uint32_t depth =
        options.end_cap == EndCap::exact ? options.plan_depth : options.isolation_level - 1;
    Builder b{base, child, {linear, options.end_cap, depth}, {}, {}};
    table.ptex_surfaces = list_surfaces(regular, b);
    walk_surfaces(b);

    const PlanCache own;
    PlanSet plans(b.options, (shared != nullptr ? *shared : own).impl());
    find_plans(b, plans);
    if (auto ok = plans.build(); !ok) return ok.error();
    PlanCopy<Real> copy{table};
    table.surfaces.allocate(b.candidates.size());
    uint32_t ring = 0;
    for (size_t i = 0; i < b.candidates.size(); ++i) {
        const Candidate& c = b.candidates[i];
        table.surfaces[i] = {shared::pack_surface(copy.number(plans.plan(c.plan)), c.rotation), ring};
        ring += c.ring_size;
    }
    if (auto ok = copy.copy(); !ok) return ok.error();
    if (auto ok = write_rings(b, source, table); !ok) return ok.error();
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
    const auto refinement = build_refinement(mesh, {.level = 0, .full_last_level = true});
    if (!refinement) return refinement.error();
    return build<Real>(*refinement, options, cache);
}

template <class Real>
Result<BasicPatchTable<Real>> build_face_varying_patch_table(const ControlMesh& mesh, uint32_t channel,
                                                             const PatchTableOptions& options,
                                                             const PlanCache* cache) {
    const auto refinement =
        build_face_varying_refinement(mesh, channel, {.level = 0, .full_last_level = true});
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
