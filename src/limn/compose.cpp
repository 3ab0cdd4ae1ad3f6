// Rows over the control points are made face by face of the control mesh. All refined vertices over one face
// depend on the ring of control points around it, so its neighbourhood is refined on its own and the steps
// compose in small dense matrices, one column per ring point. Faces with equal neighbourhoods (most of a
// mesh) share the result, and each only writes its own indices. The whole mesh is never refined and nothing
// the size of the table is held beside it. The first pass finds row sizes (supports as bit sets), the second
// one writes rows.
#include "limn/compose.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <vector>

#include "limn/face_groups.h"
#include "limn/parallel.h"

namespace limn {
namespace {

/// Rows of the targets over ring positions, zeros left out: what all members of a group copy.
template <class Real>
struct SharedRows {
    std::vector<uint32_t> offsets;
    std::vector<uint16_t> positions;  ///< compose refuses larger rings
    std::vector<Real> weights, tangent1, tangent2;

    bool empty() const { return offsets.empty(); }
};

template <class Real>
void share_rows(const Supports& s, const Weights& w, SharedRows<Real>& out) {
    const size_t rows = w.rows.size() / w.stride;
    const bool tangents = !w.tangent1.empty();
    out.offsets.assign(1, 0);
    for (size_t r = 0; r < rows; ++r) out.offsets.push_back(out.offsets.back() + support_size(s, r));
    const size_t entries = out.offsets.back();
    out.positions.resize(entries);
    out.weights.resize(entries);
    if (tangents) out.tangent1.resize(entries);
    if (tangents) out.tangent2.resize(entries);
    size_t at = 0;
    for (size_t r = 0; r < rows; ++r)
        for (uint32_t word = 0; word < s.words; ++word)
            for (uint64_t bits = s.bits[r * s.words + word]; bits != 0; bits &= bits - 1, ++at) {
                const uint32_t i = word * 64 + static_cast<uint32_t>(std::countr_zero(bits));
                out.positions[at] = static_cast<uint16_t>(i);
                out.weights[at] = static_cast<Real>(w.rows[r * w.stride + i]);
                if (!tangents) continue;
                out.tangent1[at] = static_cast<Real>(w.tangent1[r * w.stride + i]);
                out.tangent2[at] = static_cast<Real>(w.tangent2[r * w.stride + i]);
            }
}

template <class Real>
void write_rows(const Job& job, const Member& member, const SharedRows<Real>& rows,
                BasicStencilTable<Real>& table, Neighborhood& hood, std::vector<uint32_t>& vertices) {
    find_member_ring(job, member, hood);
    const bool tangents = !table.tangent1_weights.empty();
    for_each_target(job, member, vertices, [&](size_t target, uint32_t v, bool owned) {
        if (!owned) return;
        const uint32_t first = rows.offsets[target], count = rows.offsets[target + 1] - first;
        const size_t at = table.offsets[v];
        for (uint32_t k = 0; k < count; ++k) {
            table.indices[at + k] = hood.ring[rows.positions[first + k]];
            table.weights[at + k] = rows.weights[first + k];
        }
        if (!tangents) return;
        std::copy_n(rows.tangent1.data() + first, count, table.tangent1_weights.data() + at);
        std::copy_n(rows.tangent2.data() + first, count, table.tangent2_weights.data() + at);
    });
}

/// Rows that the first pass has worked out already, as far as memory allows: kept for the second one.
template <class Real>
struct Cache {
    std::vector<SharedRows<Real>> rows;  ///< one per group, empty where it has to be worked out again
    std::atomic<int64_t> budget_bytes{0};

    bool take(size_t entries, bool tangents) {
        const auto bytes =
            static_cast<int64_t>(entries * (sizeof(uint16_t) + sizeof(Real) * (tangents ? 3 : 1)));
        if (budget_bytes.fetch_sub(bytes) >= bytes) return true;
        budget_bytes.fetch_add(bytes);
        return false;
    }
};

template <class Real>
void find_sizes(const Job& job, const Groups& groups, Array<uint32_t>& sizes, Cache<Real>& cache,
                const BuildPart& part) {
    for_each_group(groups, part, [&](size_t group, std::span<const Member> members, BuildSteps& steps) {
        std::vector<uint32_t> row_sizes;
        {
            Program program;
            Supports supports;
            write_member_program(job, members[0], program);
            run_supports(program, supports);
            size_t entries = 0;
            for (size_t i = 0; i < program.target_count; ++i) {
                row_sizes.push_back(support_size(supports, i));
                entries += row_sizes.back();
            }
            if (cache.take(entries, job.with_tangents())) {
                Weights weights;
                run_weights(program, weights);
                share_rows(supports, weights, cache.rows[group]);
            }
        }
        for_each_member(members, steps, [&](const Member& member, MemberScratch& scratch) {
            for_each_target(job, member, scratch.vertices, [&](size_t target, uint32_t v, bool owned) {
                if (owned) sizes[v] = row_sizes[target];
            });
        });
    });
}

template <class Real>
void write_table(const Job& job, const Groups& groups, BasicStencilTable<Real>& table, Cache<Real>& cache,
                 const BuildPart& part) {
    for_each_group(groups, part, [&](size_t group, std::span<const Member> members, BuildSteps& steps) {
        SharedRows<Real> rows = std::move(cache.rows[group]);
        if (rows.empty()) {
            Program program;
            Supports supports;
            Weights weights;
            write_member_program(job, members[0], program);
            run_supports(program, supports);
            run_weights(program, weights);
            share_rows(supports, weights, rows);
        }
        for_each_member(members, steps, [&](const Member& member, MemberScratch& scratch) {
            write_rows(job, member, rows, table, scratch.hood, scratch.vertices);
        });
    });
}

}  // namespace

uint32_t base_face_of(const Refinement& refinement, uint32_t level, uint32_t f) {
    if (level == 0) return f;
    const Topology& base = refinement.levels[0];
    for (uint32_t i = 1; i < level; ++i) f /= 4;
    return base.options.scheme == Scheme::loop ? f / 4 : base.face_of_corner(f);
}

template <class Real>
Result<BasicStencilTable<Real>> compose(const Refinement& refinement, const ComposeOptions& options) {
    const BuildPart& part = options.control;
    if (auto ok = part.start(); !ok) return ok.error();
    ComposeOptions job_options = options;
    job_options.control = part.part(0, 0.05f);
    const Result<Job> made = make_job(refinement, job_options);
    if (!made) return made.error();
    const Job& job = *made;
    const Topology& base = job.base();
    const Result<Groups> grouped = group_faces(job, part.part(0.05f, 0.3f));
    if (!grouped) return grouped.error();
    const Groups& groups = *grouped;
    BasicStencilTable<Real> table;
    table.source_count = refinement.control_count;
    table.offsets.assign(size_t{job.counts.back().vertices} + 1, 0);
    Cache<Real> cache;
    cache.rows.resize(groups.first.size() - 1);
    cache.budget_bytes =
        int64_t{2 * sizeof(Real)} * job.counts.back().vertices;  // a tenth of the table or so
    find_sizes(job, groups, table.offsets, cache, part.part(0.3f, 0.6f));
    if (auto ok = part.check(); !ok) return ok.error();
    for_each_loose_vertex(base, [&](uint32_t v) { table.offsets[v] = 1; });
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    const size_t entries = table.offsets.back();
    table.indices.allocate(entries);
    table.weights.allocate(entries);
    if (job.with_tangents()) {
        table.tangent1_weights.allocate(entries);
        table.tangent2_weights.allocate(entries);
    }
    write_table(job, groups, table, cache, part.part(0.6f, 0.98f));
    for_each_loose_vertex(base, [&](uint32_t v) {
        const uint32_t at = table.offsets[v];
        table.indices[at] = refinement.control_indices.empty() ? v : refinement.control_indices[v];
        table.weights[at] = 1;
        if (table.tangent1_weights.empty()) return;
        table.tangent1_weights[at] = table.tangent2_weights[at] = 0;
    });
    if (auto ok = part.reach(1); !ok) return ok.error();
    return table;
}

template Result<BasicStencilTable<float>> compose(const Refinement&, const ComposeOptions&);
template Result<BasicStencilTable<double>> compose(const Refinement&, const ComposeOptions&);

}  // namespace limn
