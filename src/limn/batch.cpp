#include "limn/batch.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>

#include "limn/batch_copy.h"
#include "limn/parallel.h"
#include "limn/refined_points.h"

namespace limn {
namespace {

/// Hands out numbers one range after the other.
struct Numbers {
    uint64_t count = 0;
    BatchRange take(uint64_t size) {
        return {static_cast<uint32_t>(std::exchange(count, count + size)), static_cast<uint32_t>(size)};
    }
};

Error disagreement(size_t table, const char* what) {
    return Error{ErrorCode::invalid_argument,
                 "table " + std::to_string(table) + " of a batch has other " + what + " than table 0", table};
}

Error too_many(const char* what) {
    return Error{ErrorCode::too_large, std::string("a batch holds too many ") + what};
}

/// Entries [begin, begin + count) of a list, mapped, from entry `at` of another on. Of a narrow destination,
/// whose words were zero, two entries share a word: for one thread.
template <class Map>
void copy_indices(const IndexList& from, size_t begin, size_t count, IndexList& to, size_t at,
                  const Map& map) {
    if (to.narrow) {
        for (size_t i = 0; i < count; ++i)
            to.words[(at + i) / 2] |= map(from[begin + i]) << (16 * ((at + i) & 1));
        return;
    }
    uint32_t* out = to.words.data() + at;
    for (size_t i = 0; i < count; ++i) out[i] = map(from[begin + i]);
}

/// For `count` indices below `bound`.
IndexList make_list(uint64_t count, uint64_t bound) {
    IndexList list;
    list.narrow = bound <= 0x10000;
    if (list.narrow)
        list.words.assign((count + 1) / 2, 0);
    else
        list.words.allocate(count);
    return list;
}

template <class Real>
struct PatchMerger {
    /// What a mesh's numbers become, beside PatchBatchMesh.
    struct Mesh {
        size_t first_plan, first_run;  ///< in plan_numbers and run_places
        uint32_t first_ring, ring_count;
    };
    struct PlanSource {
        uint32_t mesh, plan;
    };
    struct RunPlace {
        uint32_t run, first_row;
    };

    std::span<const BasicPatchTable<Real>* const> tables;
    BasicPatchBatch<Real> out = {};
    std::vector<Mesh> meshes = {};
    std::vector<uint32_t> plan_numbers = {};  ///< of each mesh's plans
    std::vector<PlanSource> plans = {};       ///< where each plan is first met
    std::vector<RunPlace> run_places = {};    ///< of each mesh's runs: the merged run, and their rows in that
    PointRuns<Real> runs = {};

    Result<void> check() const;
    Result<void> number();
    void number_plans(const BasicPatchTable<Real>& table,
                      std::unordered_map<PlanIdentity, uint32_t, PlanIdentityHash>& known);
    void number_runs(const BasicPatchTable<Real>& table);
    Result<void> copy_plans();
    void copy_plan(uint32_t number);
    void copy_mesh(uint32_t m);
};

template <class Real>
Result<void> PatchMerger<Real>::check() const {
    for (size_t m = 0; m < tables.size(); ++m) {
        if (tables[m]->options != tables[0]->options) return disagreement(m, "scheme options");
        if (tables[m]->end_cap != tables[0]->end_cap) return disagreement(m, "end caps");
        if (tables[m]->plan_identities.size() != tables[m]->plans.size())
            return Error{ErrorCode::invalid_argument,
                         "table " + std::to_string(m) + " of a batch does not have an identity for each plan",
                         m};
    }
    return {};
}

template <class Real>
Result<void> PatchMerger<Real>::number() {
    Numbers control, ptex, surfaces, refined, rings, indices;
    std::unordered_map<PlanIdentity, uint32_t, PlanIdentityHash> known;
    for (const BasicPatchTable<Real>* table : tables) {
        out.meshes.push_back({control.take(table->control_count), ptex.take(table->ptex_surfaces.size()),
                              surfaces.take(table->surfaces.size())});
        uint64_t index_count = 0;
        for (const PointRun& run : table->point_runs)
            index_count += uint64_t{run.row_count} * run.entry_count;
        const BatchRange ring = rings.take(ring_point_count(*table));
        indices.take(index_count);
        refined.take(table->refined_count);
        meshes.push_back({plan_numbers.size(), run_places.size(), ring.first, ring.count});
        number_plans(*table, known);
        number_runs(*table);
    }
    constexpr uint64_t kMost = 0xffffffff;
    if (control.count + refined.count + 64 > kMost) return too_many("points");
    if (rings.count > kMost || indices.count > kMost) return too_many("ring points");
    if (surfaces.count >= shared::kPtexSplit || ptex.count >= shared::kPtexSplit) return too_many("surfaces");
    if (plans.size() >= shared::kMaxPlans) return too_many("plans");
    BasicPatchTable<Real>& to = out.table;
    to.control_count = static_cast<uint32_t>(control.count);
    to.refined_count = static_cast<uint32_t>(refined.count);
    to.first_refined = first_refined_point(to.control_count, to.refined_count);
    runs.place(to.first_refined);
    runs.write(to);
    to.point_indices = make_list(indices.count, to.control_count);
    to.ring_points = make_list(rings.count, to.point_count());
    to.surfaces.allocate(surfaces.count);
    to.ptex_surfaces.allocate(ptex.count);
    return {};
}

template <class Real>
void PatchMerger<Real>::number_plans(const BasicPatchTable<Real>& table,
                                     std::unordered_map<PlanIdentity, uint32_t, PlanIdentityHash>& known) {
    const auto mesh = static_cast<uint32_t>(meshes.size() - 1);
    for (uint32_t p = 0; p < table.plans.size(); ++p) {
        const auto [at, is_new] =
            known.try_emplace(table.plan_identities[p], static_cast<uint32_t>(plans.size()));
        if (is_new) plans.push_back({mesh, p});
        plan_numbers.push_back(at->second);
        [[maybe_unused]] const PlanSource& source = plans[at->second];
        assert(tables[source.mesh]->plans[source.plan].row_count == table.plans[p].row_count);
    }
}

template <class Real>
void PatchMerger<Real>::number_runs(const BasicPatchTable<Real>& table) {
    for (const PointRun& run : table.point_runs) {
        const uint32_t number =
            runs.add(table.point_weights.data() + run.first_weight, run.entry_count, run.row_count);
        run_places.push_back({number, runs.runs()[number].row_count - run.row_count});
    }
}

template <class Real>
Result<void> PatchMerger<Real>::copy_plans() {
    Numbers weights, nodes, points;
    BasicPatchTable<Real>& to = out.table;
    to.plans.allocate(plans.size());
    to.plan_identities.allocate(plans.size());
    for (uint32_t i = 0; i < plans.size(); ++i) {
        const uint32_t p = plans[i].plan;
        const BasicPatchTable<Real>& from = *tables[plans[i].mesh];
        Plan plan = from.plans[p];
        const auto place = [&](uint32_t Plan::*first, size_t size, Numbers& numbers) {
            plan.*first = numbers.take(end_of(from, p, first, size) - plan.*first).first;
        };
        place(&Plan::first_weight, from.plan_weights.size(), weights);
        place(&Plan::first_node, from.plan_nodes.size(), nodes);
        place(&Plan::first_point, from.plan_points.size(), points);
        to.plans[i] = plan;
        to.plan_identities[i] = from.plan_identities[p];
    }
    if (std::max({weights.count, nodes.count, points.count}) > 0xffffffff)
        return too_many("weights of plans");
    to.plan_weights.allocate(weights.count);
    to.plan_nodes.allocate(nodes.count);
    to.plan_points.allocate(points.count);
    for_each_index(
        static_cast<uint32_t>(plans.size()), [&](uint32_t i) { copy_plan(i); }, 16);
    return {};
}

template <class Real>
void PatchMerger<Real>::copy_plan(uint32_t number) {
    const uint32_t mesh = plans[number].mesh, p = plans[number].plan;
    const BasicPatchTable<Real>& from = *tables[mesh];
    const Plan& plan = from.plans[p];
    const Plan& copy = out.table.plans[number];
    const auto copy_array = [&](const auto& source, auto& destination, uint32_t Plan::*first) {
        std::copy(source.begin() + plan.*first, source.begin() + end_of(from, p, first, source.size()),
                  destination.begin() + copy.*first);
    };
    copy_array(from.plan_weights, out.table.plan_weights, &Plan::first_weight);
    copy_array(from.plan_points, out.table.plan_points, &Plan::first_point);
    const uint32_t* numbers = plan_numbers.data() + meshes[mesh].first_plan;
    const uint32_t end = end_of(from, p, &Plan::first_node, from.plan_nodes.size());
    for (uint32_t n = plan.first_node; n < end; ++n) {
        out.table.plan_nodes[copy.first_node + (n - plan.first_node)] = moved_node(from.plan_nodes[n], numbers);
    }
}

template <class Real>
void PatchMerger<Real>::copy_mesh(uint32_t m) {
    const BasicPatchTable<Real>& from = *tables[m];
    BasicPatchTable<Real>& to = out.table;
    const Mesh& mesh = meshes[m];
    const PatchBatchMesh& ranges = out.meshes[m];
    std::vector<uint32_t> points(from.point_count());  // what each of the mesh's points becomes
    std::iota(points.begin(), points.begin() + from.control_count, ranges.control_points.first);
    for (size_t r = 0; r < from.point_runs.size(); ++r) {
        const PointRun& run = from.point_runs[r];
        const RunPlace& place = run_places[mesh.first_run + r];
        const PointRun& merged = to.point_runs[place.run];
        const auto first = points.begin() + run.first_point;
        std::iota(first, first + run.row_count, merged.first_point + place.first_row);
        copy_indices(from.point_indices, run.first_index, size_t{run.row_count} * run.entry_count,
                     to.point_indices, merged.first_index + size_t{place.first_row} * run.entry_count,
                     [&](uint32_t point) { return point + ranges.control_points.first; });
    }
    copy_indices(from.ring_points, 0, mesh.ring_count, to.ring_points, mesh.first_ring,
                 [&](uint32_t point) { return points[point]; });
    copy_surfaces(from, plan_numbers.data() + mesh.first_plan, ranges, mesh.first_ring, to);
}

struct TessellationMerger {
    std::span<const TessellationTable* const> tables;
    TessellationBatch out = {};
    std::vector<BatchRange> corner_copies = {}, row_copies = {};  ///< words

    Result<void> number();
    void number_instances();
};

void TessellationMerger::number_instances() {
    uint64_t count = 0;
    for (const TessellationTable* table : tables) count += table->instance_count();
    out.table.instance_faces.allocate(count + 1);
    uint32_t* first = out.table.instance_faces.data();
    for (size_t m = 0; m < tables.size(); ++m)
        for (uint32_t i = 0; i < tables[m]->instance_count(); ++i)
            *first++ = out.meshes[m].ptex_faces.first +
                       (tables[m]->instance_faces.empty() ? 0 : tables[m]->instance_faces[i]);
    *first = out.table.face_count;
}

Result<void> TessellationMerger::number() {
    Numbers faces, mesh_edges, sub_edges, rows, corners, corner_words, row_words;
    for (size_t m = 0; m < tables.size(); ++m) {
        const TessellationTable& t = *tables[m];
        if (t.options != tables[0]->options) return disagreement(m, "scheme options");
        out.meshes.push_back({faces.take(t.face_count), mesh_edges.take(t.mesh_edge_count),
                              sub_edges.take(t.rate_edge_count - t.mesh_edge_count), rows.take(t.row_count),
                              corners.take(t.corner_count)});
        corner_copies.push_back(corner_words.take(t.corner_copies.size()));
        row_copies.push_back(row_words.take(t.row_copies.size()));
    }
    const uint64_t edges = mesh_edges.count + sub_edges.count;
    if (faces.count >= 1u << 28) return too_many("ptex faces");
    if (rows.count >= shared::kSideRowMask) return too_many("rows of vertices");
    if (edges >= kInvalidIndex || corners.count >= kInvalidIndex) return too_many("edges");
    for (TessellationBatchMesh& mesh : out.meshes)
        mesh.sub_face_edges.first += static_cast<uint32_t>(mesh_edges.count);
    TessellationTable& to = out.table;
    to.face_count = static_cast<uint32_t>(faces.count);
    to.mesh_edge_count = static_cast<uint32_t>(mesh_edges.count);
    to.rate_edge_count = static_cast<uint32_t>(edges);
    to.row_count = static_cast<uint32_t>(rows.count);
    to.corner_count = static_cast<uint32_t>(corners.count);
    to.faces.allocate(faces.count * shared::kTessFaceWords);
    to.rows.allocate(rows.count * shared::kTessRowWords);
    to.corners.allocate(corners.count * shared::kTessCornerWords);
    to.rate_edges.allocate(edges * shared::kRateEdgeWords);
    to.corner_copies.allocate(corner_words.count);
    to.row_copies.allocate(row_words.count);
    return {};
}

}  // namespace

template <class Real>
Result<BasicPatchBatch<Real>> merge_patch_tables(std::span<const BasicPatchTable<Real>* const> tables) {
    PatchMerger<Real> merger{tables};
    if (tables.empty()) return std::move(merger.out);
    if (auto checked = merger.check(); !checked) return checked.error();
    merger.out.table.options = tables[0]->options;
    merger.out.table.end_cap = tables[0]->end_cap;
    if (auto numbered = merger.number(); !numbered) return numbered.error();
    if (auto copied = merger.copy_plans(); !copied) return copied.error();
    const auto count = static_cast<uint32_t>(tables.size());
    const bool narrow = merger.out.table.point_indices.narrow || merger.out.table.ring_points.narrow;
    for_each_index(
        count, [&](uint32_t m) { merger.copy_mesh(m); }, narrow ? count : 1);
    return std::move(merger.out);
}

Result<TessellationBatch> merge_tessellation_tables(std::span<const TessellationTable* const> tables) {
    TessellationMerger merger{tables};
    if (auto numbered = merger.number(); !numbered) return numbered.error();
    if (!tables.empty()) merger.out.table.options = tables[0]->options;
    merger.number_instances();
    for_each_index(
        static_cast<uint32_t>(tables.size()),
        [&](uint32_t m) {
            copy_topology(*tables[m], merger.out.meshes[m], merger.corner_copies[m].first, merger.row_copies[m].first,
                          merger.out.table);
        },
        1);
    return std::move(merger.out);
}

template Result<PatchBatch> merge_patch_tables<float>(std::span<const PatchTable* const>);
template Result<PatchBatchDouble> merge_patch_tables<double>(std::span<const PatchTableDouble* const>);

}  // namespace limn
