// Rows over the control points are made face by face of the control mesh. All refined vertices over one face
// depend on the ring of control points around it, so its neighbourhood is refined on its own and the steps
// compose in small dense matrices, one column per ring point. Faces with equal neighbourhoods (most of a
// mesh) share the result, and each only writes its own indices. The whole mesh is never refined and nothing
// the size of the table is held beside it. The first pass finds row sizes (supports as bit sets), the second
// one writes rows.
#include "limn/compose.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <map>
#include <vector>

#include "limn/face_block.h"
#include "limn/face_program.h"
#include "limn/local_refinement.h"
#include "limn/neighborhood.h"
#include "limn/parallel.h"

namespace limn {
namespace {

/// A face as a member of a group of equal neighbourhoods.
struct Member {
    std::array<uint64_t, 2> hash;
    uint32_t face;
    Orientation orientation;
};

/// Everything that is the same for all groups.
struct Job {
    const Refinement& refinement;
    ComposeOptions options;
    std::vector<LevelCounts> counts;   ///< of levels 0 .. options.level
    std::map<uint32_t, Block> blocks;  ///< by face size

    const Topology& base() const { return refinement.levels[0]; }
    const Block& block(uint32_t f) const { return blocks.at(base().size_of_face(f)); }
    const Topology* uncut() const { return refinement.uncut.empty() ? nullptr : &refinement.uncut[0]; }
    WalkOptions walk() const { return {base(), uncut(), with_tangents()}; }
    bool with_tangents() const { return options.target == Target::limit_with_tangents; }
};

void write_member_program(const Job& job, const Member& member, Program& program) {
    const std::vector<uint32_t>& targets = job.block(member.face).corners(member.orientation);
    write_program(job.walk(), member.face, member.orientation, targets, job.options, program);
}

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

/// body(target, vertex) for the targets that face `member` owns. `vertices` is scratch.
template <class Body>
void for_each_owned(const Job& job, const Member& member, std::vector<uint32_t>& vertices, const Body& body) {
    const Topology& base = job.base();
    const uint32_t begin = base.face_begin(member.face), size = base.size_of_face(member.face);
    const Block& block = job.block(member.face);
    const std::vector<uint32_t>& corners = block.corners(member.orientation);
    vertices_over_face(base, job.counts, job.options.level, member.face, vertices);
    auto owns = [&](size_t i) {
        if (block.places[i] == Place::inside) return true;
        const Orientation& o = member.orientation;
        // Edge j joins corners j and j + 1 of the walk, whichever way that goes.
        const uint32_t side =
            block.places[i] == Place::edge && o.mirrored ? block.sides[i] + 1 : block.sides[i];
        const uint32_t c = begin + o.corner(side % size, size);
        const uint32_t first = block.places[i] == Place::edge
                                   ? base.corners_of_edge(base.face_edges[c])[0]
                                   : base.corners_of_vertex(base.face_vertices[c])[0];
        return base.face_of_corner(first) == member.face;
    };
    for (size_t i = 0; i < corners.size(); ++i)
        if (owns(i)) body(i, vertices[corners[i]]);
}

template <class Real>
void write_rows(const Job& job, const Member& member, const SharedRows<Real>& rows,
                BasicStencilTable<Real>& table, Neighborhood& hood, std::vector<uint32_t>& vertices) {
    walk_around(job.walk(), member.face, member.orientation, hood);
    const Array<uint32_t>& map = job.refinement.control_indices;
    if (!map.empty())
        for (uint32_t& point : hood.ring) point = map[point];
    const bool tangents = !table.tangent1_weights.empty();
    for_each_owned(job, member, vertices, [&](size_t target, uint32_t v) {
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

/// Faces ordered by neighbourhood, and where each group starts.
struct Groups {
    std::vector<Member> members;
    std::vector<uint32_t> first;  ///< one more than groups
    size_t largest_ring = 0;
};

/// Composed rows grow with the square of a valence; past this many faces around one face they are not worth
/// having, and walks around faces would take that square of time, too.
bool is_walkable(const Topology& t) {
    constexpr size_t kMaxFacesAround = 16384;
    for (uint32_t f = 0; f < t.face_count; ++f) {
        size_t faces = 0;
        for (const uint32_t v : t.vertices_of_face(f)) faces += t.corners_of_vertex(v).size();
        if (faces > kMaxFacesAround) return false;
    }
    return true;
}

Groups group_faces(const Job& job) {
    const Topology& base = job.base();
    Groups groups;
    groups.members.resize(base.face_count);
    std::atomic<size_t> largest_ring{0};
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, base.face_count, 256), [&](const auto& range) {
        Neighborhood hood;
        size_t largest = 0;
        for (uint32_t f = range.begin(); f != range.end(); ++f) {
            groups.members[f].face = f;
            groups.members[f].orientation = choose_orientation(job.walk(), f, hood, groups.members[f].hash);
            largest = std::max(largest, hood.ring.size());
        }
        for (size_t seen = largest_ring;
             seen < largest && !largest_ring.compare_exchange_weak(seen, largest);) {
        }
    });
    groups.largest_ring = largest_ring;
    tbb::parallel_sort(groups.members.begin(), groups.members.end(), [](const Member& a, const Member& b) {
        return a.hash != b.hash ? a.hash < b.hash : a.face < b.face;
    });
    for (uint32_t i = 0; i < base.face_count; ++i)
        if (i == 0 || groups.members[i].hash != groups.members[i - 1].hash) groups.first.push_back(i);
    groups.first.push_back(base.face_count);
    return groups;
}

/// body(number, members) for each group, groups in parallel.
template <class Body>
void for_each_group(const Groups& groups, const Body& body) {
    tbb::parallel_for(size_t{0}, groups.first.size() - 1, [&](size_t g) {
        const uint32_t first = groups.first[g], count = groups.first[g + 1] - first;
        body(g, std::span<const Member>(groups.members.data() + first, count));
    });
}

/// What writing the rows of one member takes, besides the shared rows.
struct MemberScratch {
    Neighborhood hood;
    std::vector<uint32_t> vertices;
};

/// body(member, scratch) for the members of one group, in parallel too: a group can be most of the mesh.
template <class Body>
void for_each_member(std::span<const Member> members, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, members.size(), 16), [&](const auto& range) {
        MemberScratch scratch;
        for (size_t i = range.begin(); i != range.end(); ++i) body(members[i], scratch);
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
void find_sizes(const Job& job, const Groups& groups, Array<uint32_t>& sizes, Cache<Real>& cache) {
    for_each_group(groups, [&](size_t group, std::span<const Member> members) {
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
        for_each_member(members, [&](const Member& member, MemberScratch& scratch) {
            for_each_owned(job, member, scratch.vertices,
                           [&](size_t target, uint32_t v) { sizes[v] = row_sizes[target]; });
        });
    });
}

template <class Real>
void write_table(const Job& job, const Groups& groups, BasicStencilTable<Real>& table, Cache<Real>& cache) {
    for_each_group(groups, [&](size_t group, std::span<const Member> members) {
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
        for_each_member(members, [&](const Member& member, MemberScratch& scratch) {
            write_rows(job, member, rows, table, scratch.hood, scratch.vertices);
        });
    });
}

/// Control points that no face uses keep their row: themselves.
template <class Body>
void for_each_loose_vertex(const Topology& base, const Body& body) {
    for (uint32_t v = 0; v < base.vertex_count; ++v)
        if (base.corners_of_vertex(v).empty()) body(v);
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
    Result<std::vector<LevelCounts>> counts = count_levels(refinement.levels[0], options.level);
    if (!counts) return counts.error();
    Job job{refinement, options, std::move(*counts), {}};
    const Topology& base = job.base();
    const Error too_wide{
        ErrorCode::unsupported,
        "too many faces meet around one face for a table over the control points: chain step tables"};
    if (!is_walkable(base) || (job.uncut() != nullptr && !is_walkable(*job.uncut()))) return too_wide;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t n = base.size_of_face(f);
        if (job.blocks.count(n) == 0) job.blocks.emplace(n, build_block(base.options, n, options.level));
        if (base.face_size != 0) break;
    }
    const Groups groups = group_faces(job);
    if (groups.largest_ring > std::numeric_limits<uint16_t>::max()) return too_wide;
    BasicStencilTable<Real> table;
    table.source_count = refinement.control_count;
    table.offsets.assign(size_t{job.counts.back().vertices} + 1, 0);
    Cache<Real> cache;
    cache.rows.resize(groups.first.size() - 1);
    cache.budget_bytes =
        int64_t{2 * sizeof(Real)} * job.counts.back().vertices;  // a tenth of the table or so
    find_sizes(job, groups, table.offsets, cache);
    for_each_loose_vertex(base, [&](uint32_t v) { table.offsets[v] = 1; });
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    const size_t entries = table.offsets.back();
    table.indices.allocate(entries);
    table.weights.allocate(entries);
    if (job.with_tangents()) {
        table.tangent1_weights.allocate(entries);
        table.tangent2_weights.allocate(entries);
    }
    write_table(job, groups, table, cache);
    for_each_loose_vertex(base, [&](uint32_t v) {
        const uint32_t at = table.offsets[v];
        table.indices[at] = refinement.control_indices.empty() ? v : refinement.control_indices[v];
        table.weights[at] = 1;
        if (table.tangent1_weights.empty()) return;
        table.tangent1_weights[at] = table.tangent2_weights[at] = 0;
    });
    return table;
}

template Result<BasicStencilTable<float>> compose(const Refinement&, const ComposeOptions&);
template Result<BasicStencilTable<double>> compose(const Refinement&, const ComposeOptions&);

}  // namespace limn
