// Rows over the control points are made face by face of the control mesh. All refined vertices over one face depend on
// the ring of control points around it, so the steps compose in small dense matrices, one column per ring point; faces
// with equal neighbourhoods (most of a mesh) share the result, and each only writes its own indices. Nothing the size
// of the table is held beside it. The first pass finds row sizes (supports as bit sets), the second one writes rows.
#include "limn/compose.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <vector>

#include "limn/neighborhood.h"
#include "limn/parallel.h"
#include "limn/stencil_row.h"

namespace limn {
namespace {

/// Corners of the refined faces over a face of n corners, as offsets from the first of them: one for every distinct
/// vertex. `rotated[s]` are the same vertices where the walk starts at corner s.
struct Block {
    uint32_t corner_count = 0;  ///< refined corners over the face
    std::vector<std::vector<uint32_t>> rotated;
};

/// Corner offset q of a block, turned by s corners: digits of its path down the levels, then its slot.
uint32_t rotate_corner(Scheme scheme, uint32_t n, uint32_t level, uint32_t q, uint32_t s) {
    const uint32_t sides = scheme == Scheme::loop ? 3 : 4;
    auto turn = [&](uint32_t digit, uint32_t modulus) { return digit < modulus ? (digit + s) % modulus : digit; };
    uint32_t block = sides;
    for (uint32_t i = 1; i < level; ++i) block *= 4;
    if (scheme != Scheme::loop && n != 4) return turn(q / block, n) * block + q % block;
    uint32_t out = turn(q % sides, sides), scale = sides;
    for (uint32_t path = q / sides, i = 0; i < level; ++i, path /= 4, scale *= 4) out += turn(path % 4, sides) * scale;
    return out;
}

Block build_block(const SchemeOptions& options, uint32_t n, uint32_t level) {
    Block block;
    ControlMeshDescription description;
    std::vector<uint32_t> vertices(n);
    for (uint32_t i = 0; i < n; ++i) vertices[i] = i;
    description.options = options;
    description.vertex_count = n;
    description.face_sizes = {&n, 1};
    description.face_vertices = vertices;
    const Result<ControlMesh> mesh = ControlMesh::create(description);
    const Result<Refinement> refinement = build_refinement(*mesh, {level, false});
    const Topology& last = refinement->last();
    block.corner_count = last.corner_count();
    std::vector<bool> seen(last.vertex_count);
    std::vector<uint32_t> corners;
    for (uint32_t q = 0; q < block.corner_count; ++q) {
        if (seen[last.face_vertices[q]]) continue;
        seen[last.face_vertices[q]] = true;
        corners.push_back(q);
    }
    block.rotated.resize(n);
    for (uint32_t s = 0; s < n; ++s)
        for (const uint32_t q : corners)
            block.rotated[s].push_back(level == 0 ? (q + s) % n : rotate_corner(options.scheme, n, level, q, s));
    return block;
}

/// A face as a member of a group of equal neighbourhoods.
struct Member {
    std::array<uint64_t, 2> hash;
    uint32_t face, rotation;
};

/// Everything that is the same for all groups.
struct Job {
    const Refinement& refinement;
    ComposeOptions options;
    std::map<uint32_t, Block> blocks;  ///< by face size

    const Topology& base() const { return refinement.levels[0]; }
    const Topology& level() const { return refinement.levels[options.level]; }
    const Block& block(uint32_t f) const { return blocks.at(base().size_of_face(f)); }
    uint32_t first_corner(uint32_t f) const {
        if (options.level == 0) return base().face_begin(f);
        const bool triangles = base().options.scheme == Scheme::loop;
        uint32_t face = triangles ? 4 * f : base().face_begin(f);
        for (uint32_t i = 1; i < options.level; ++i) face *= 4;
        return face * level().face_size;
    }
};

/// The face that writes the row of vertex v of a level: the first one around the base vertex, edge or face it is on.
uint32_t owner(const Refinement& refinement, uint32_t level, uint32_t v) {
    while (level > 0) {
        const Topology& parent = refinement.levels[level - 1];
        const uint32_t first_edge_child = child_of_edge(parent, 0);
        --level;
        if (v < parent.vertex_count) continue;
        uint32_t f = 0;
        if (v < first_edge_child) {
            f = v - parent.vertex_count;
        } else {
            const uint32_t e = v - first_edge_child;
            f = parent.face_of_corner(parent.edge_corners[parent.edge_corner_offsets[e]]);
        }
        return base_face_of(refinement, level, f);
    }
    const Topology& base = refinement.levels[0];
    return base.face_of_corner(base.vertex_corners[base.vertex_corner_offsets[v]]);
}

/// The refinement over one face, written down: which points of each level are needed, and each one's row over the
/// needed points of the level before. The last step makes the targets; its rows carry tangents for limit tables.
struct Program {
    struct Step {
        std::vector<uint32_t> offsets;
        std::vector<uint32_t> locals;  ///< positions among the needed points of the level before
        std::vector<RowEntry> entries;
    };
    std::vector<Step> steps;                    ///< in order of execution
    std::vector<std::vector<uint32_t>> needed;  ///< vertices per level, 0 .. ; needed[0] is the ring
    std::vector<IndexMap> maps;
    Row row;
};

void write_step(const std::vector<uint32_t>& points, std::vector<uint32_t>& needed, IndexMap& map, Row& row,
                Program::Step& step, const auto& row_of) {
    step.offsets.assign(1, 0);
    step.locals.clear();
    step.entries.clear();
    for (const uint32_t v : points) {
        row.clear();
        row_of(v, row);
        for (const RowEntry& entry : row) {
            const uint32_t local = map.find_or_insert(entry.index, static_cast<uint32_t>(needed.size()));
            if (local == needed.size()) needed.push_back(entry.index);
            step.locals.push_back(local);
            step.entries.push_back(entry);
        }
        step.offsets.push_back(static_cast<uint32_t>(step.locals.size()));
    }
}

/// Works back from the targets over face `member` to its ring, whose order is that of the walk.
void write_program(const Job& job, const Member& member, Neighborhood& hood, Program& program) {
    const Refinement& refinement = job.refinement;
    const uint32_t level = job.options.level;
    const bool limit = job.options.target != Target::refined;
    const uint32_t step_count = level + (limit ? 1 : 0);
    program.steps.resize(step_count);
    program.needed.resize(step_count);
    program.maps.resize(step_count);
    read_neighborhood(job.base(), member.face, hood);
    for (uint32_t l = 0; l < step_count; ++l) {
        program.needed[l].clear();
        program.maps[l].clear();
    }
    for (const uint32_t v : hood.ring) {
        program.maps[0].find_or_insert(v, static_cast<uint32_t>(program.needed[0].size()));
        program.needed[0].push_back(v);
    }
    std::vector<uint32_t> targets;
    const uint32_t first = job.first_corner(member.face);
    for (const uint32_t q : job.block(member.face).rotated[member.rotation])
        targets.push_back(job.level().face_vertices[first + q]);
    for (uint32_t step = step_count; step-- > 0;) {
        const std::vector<uint32_t>& points = step + 1 == step_count ? targets : program.needed[step + 1];
        const bool is_limit = limit && step == level;
        const Topology& parent = refinement.levels[step];
        write_step(points, program.needed[step], program.maps[step], program.row, program.steps[step],
                   [&](uint32_t v, Row& row) {
                       if (is_limit) limit_row(parent, v, row);
                       else
                           refinement_row(parent, v, refinement.levels[step + 1].vertex_rules[v],
                                          job.options.interpolation, row);
                   });
    }
}

/// Supports of the targets as bit sets over the ring: `words` words each.
struct Supports {
    uint32_t words = 0;
    std::vector<uint64_t> bits, previous;
};

void run_supports(const Program& program, Supports& s) {
    const size_t ring = program.needed[0].size();
    s.words = static_cast<uint32_t>((ring + 63) / 64);
    const size_t words = s.words;
    s.bits.assign(ring * words, 0);
    for (size_t i = 0; i < ring; ++i) s.bits[i * words + i / 64] |= uint64_t{1} << (i % 64);
    for (const Program::Step& step : program.steps) {
        std::swap(s.bits, s.previous);
        const size_t rows = step.offsets.size() - 1;
        s.bits.assign(rows * words, 0);
        for (size_t r = 0; r < rows; ++r)
            for (uint32_t k = step.offsets[r]; k < step.offsets[r + 1]; ++k)
                for (size_t w = 0; w < words; ++w) s.bits[r * words + w] |= s.previous[step.locals[k] * words + w];
    }
}

uint32_t support_size(const Supports& s, size_t row) {
    uint32_t size = 0;
    for (size_t w = 0; w < s.words; ++w) size += static_cast<uint32_t>(std::popcount(s.bits[row * s.words + w]));
    return size;
}

/// Dense weights of the targets over the ring, `stride` columns a row.
struct Weights {
    size_t stride = 0;
    std::vector<double> rows, previous, tangent1, tangent2;
};

// No fused multiply-add (the build forbids contraction), so wider vectors give the same bits.
#if defined(__x86_64__) && defined(__GNUC__)
#define LIMN_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define LIMN_VECTOR_CLONES
#endif

LIMN_VECTOR_CLONES void add_scaled(double* out, const double* in, double weight, size_t count) {
    for (size_t i = 0; i < count; ++i) out[i] += weight * in[i];
}

void multiply(const Program::Step& step, double RowEntry::*member, const std::vector<double>& in, size_t stride,
              std::vector<double>& out) {
    const size_t rows = step.offsets.size() - 1;
    out.assign(rows * stride, 0.0);
    for (size_t r = 0; r < rows; ++r)
        for (uint32_t k = step.offsets[r]; k < step.offsets[r + 1]; ++k)
            add_scaled(out.data() + r * stride, in.data() + step.locals[k] * stride, step.entries[k].*member, stride);
}

void run_weights(const Program& program, bool tangents, Weights& w) {
    const size_t ring = program.needed[0].size();
    w.stride = (ring + 7) / 8 * 8;
    w.rows.assign(ring * w.stride, 0.0);
    for (size_t i = 0; i < ring; ++i) w.rows[i * w.stride + i] = 1;
    for (size_t s = 0; s < program.steps.size(); ++s) {
        std::swap(w.rows, w.previous);
        multiply(program.steps[s], &RowEntry::weight, w.previous, w.stride, w.rows);
        if (!tangents || s + 1 != program.steps.size()) continue;
        multiply(program.steps[s], &RowEntry::tangent1, w.previous, w.stride, w.tangent1);
        multiply(program.steps[s], &RowEntry::tangent2, w.previous, w.stride, w.tangent2);
    }
}

/// body(target, vertex) for the targets that face `member` owns.
template <class Body>
void for_each_owned(const Job& job, const Member& member, const Body& body) {
    const std::vector<uint32_t>& corners = job.block(member.face).rotated[member.rotation];
    const uint32_t first = job.first_corner(member.face);
    for (size_t i = 0; i < corners.size(); ++i) {
        const uint32_t v = job.level().face_vertices[first + corners[i]];
        if (owner(job.refinement, job.options.level, v) == member.face) body(i, v);
    }
}

/// Ring positions in ascending order of the control points that they are for this member.
struct SortedRing {
    std::vector<std::pair<uint32_t, uint32_t>> points;  ///< (control point, ring position)
};

void sort_ring(const Job& job, const Neighborhood& hood, SortedRing& sorted) {
    const Array<uint32_t>& map = job.refinement.control_indices;
    sorted.points.clear();
    for (uint32_t i = 0; i < hood.ring.size(); ++i)
        sorted.points.emplace_back(map.empty() ? hood.ring[i] : map[hood.ring[i]], i);
    std::sort(sorted.points.begin(), sorted.points.end());
}

template <class Real>
void write_rows(const Job& job, const Member& member, const Supports& supports, const Weights& w,
                BasicStencilTable<Real>& table, Neighborhood& hood, SortedRing& sorted) {
    read_neighborhood(job.base(), member.face, hood);
    sort_ring(job, hood, sorted);
    const bool tangents = !table.tangent1_weights.empty();
    for_each_owned(job, member, [&](size_t target, uint32_t v) {
        const uint64_t* bits = supports.bits.data() + target * supports.words;
        const double* weights = w.rows.data() + target * w.stride;
        uint32_t at = table.offsets[v];
        for (const auto& [point, i] : sorted.points) {
            if ((bits[i / 64] >> (i % 64) & 1) == 0) continue;
            table.indices[at] = point;
            table.weights[at] = static_cast<Real>(weights[i]);
            if (tangents) {
                table.tangent1_weights[at] = static_cast<Real>(w.tangent1[target * w.stride + i]);
                table.tangent2_weights[at] = static_cast<Real>(w.tangent2[target * w.stride + i]);
            }
            ++at;
        }
    });
}

/// Faces ordered by neighbourhood, and where each group starts.
struct Groups {
    std::vector<Member> members;
    std::vector<uint32_t> first;  ///< one more than groups
};

Groups group_faces(const Topology& base) {
    Groups groups;
    groups.members.resize(base.face_count);
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, base.face_count, 256), [&](const auto& range) {
        Neighborhood hood;
        for (uint32_t f = range.begin(); f != range.end(); ++f) {
            read_neighborhood(base, f, hood);
            groups.members[f] = {hash_signature(hood.signature), f, hood.rotation};
        }
    });
    tbb::parallel_sort(groups.members.begin(), groups.members.end(), [](const Member& a, const Member& b) {
        return a.hash != b.hash ? a.hash < b.hash : a.face < b.face;
    });
    for (uint32_t i = 0; i < base.face_count; ++i)
        if (i == 0 || groups.members[i].hash != groups.members[i - 1].hash) groups.first.push_back(i);
    groups.first.push_back(base.face_count);
    return groups;
}

/// body(members of one group), groups in parallel.
template <class Body>
void for_each_group(const Groups& groups, const Body& body) {
    tbb::parallel_for(size_t{0}, groups.first.size() - 1, [&](size_t g) {
        body(std::span<const Member>(groups.members.data() + groups.first[g], groups.first[g + 1] - groups.first[g]));
    });
}

/// body(member) for the members of one group, in parallel too: a group can be most of the mesh.
template <class Body>
void for_each_member(std::span<const Member> members, const Body& body) {
    if (members.size() < 32) {
        for (const Member& member : members) body(member);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<size_t>(0, members.size(), 16), [&](const auto& range) {
        for (size_t i = range.begin(); i != range.end(); ++i) body(members[i]);
    });
}

void find_sizes(const Job& job, const Groups& groups, Array<uint32_t>& sizes) {
    for_each_group(groups, [&](std::span<const Member> members) {
        Neighborhood hood;
        Program program;
        Supports supports;
        write_program(job, members[0], hood, program);
        run_supports(program, supports);
        for_each_member(members, [&](const Member& member) {
            for_each_owned(job, member, [&](size_t target, uint32_t v) { sizes[v] = support_size(supports, target); });
        });
    });
}

template <class Real>
void write_table(const Job& job, const Groups& groups, BasicStencilTable<Real>& table) {
    for_each_group(groups, [&](std::span<const Member> members) {
        Neighborhood hood;
        Program program;
        Supports supports;
        Weights weights;
        write_program(job, members[0], hood, program);
        run_supports(program, supports);
        run_weights(program, !table.tangent1_weights.empty(), weights);
        for_each_member(members, [&](const Member& member) {
            Neighborhood member_hood;
            SortedRing sorted;
            write_rows(job, member, supports, weights, table, member_hood, sorted);
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
    Job job{refinement, options, {}};
    const Topology& base = job.base();
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t n = base.size_of_face(f);
        if (job.blocks.count(n) == 0) job.blocks.emplace(n, build_block(base.options, n, options.level));
        if (base.face_size != 0) break;
    }
    const Groups groups = group_faces(base);
    BasicStencilTable<Real> table;
    table.source_count = refinement.control_count;
    table.offsets.assign(size_t{job.level().vertex_count} + 1, 0);
    find_sizes(job, groups, table.offsets);
    for_each_loose_vertex(base, [&](uint32_t v) { table.offsets[v] = 1; });
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    const size_t entries = table.offsets.back();
    table.indices.allocate(entries);
    table.weights.allocate(entries);
    if (options.target == Target::limit_with_tangents) {
        table.tangent1_weights.allocate(entries);
        table.tangent2_weights.allocate(entries);
    }
    write_table(job, groups, table);
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
