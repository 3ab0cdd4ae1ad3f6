// Rows over the control points are made face by face of the control mesh. All refined vertices over one face
// depend on the ring of control points around it, so the steps compose in small dense matrices, one column
// per ring point; faces with equal neighbourhoods (most of a mesh) share the result, and each only writes its
// own indices. Nothing the size of the table is held beside it. The first pass finds row sizes (supports as
// bit sets), the second one writes rows.
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
/// vertex, those inside the face first. `rotated[s]` are the same vertices where the walk starts at corner s.
struct Block {
    size_t inside_count = 0;
    std::vector<std::vector<uint32_t>> rotated;
};

/// Corner offset q of a block, turned by s corners: digits of its path down the levels, then its slot.
uint32_t rotate_corner(Scheme scheme, uint32_t n, uint32_t level, uint32_t q, uint32_t s) {
    const uint32_t sides = scheme == Scheme::loop ? 3 : 4;
    auto turn = [&](uint32_t digit, uint32_t modulus) {
        return digit < modulus ? (digit + s) % modulus : digit;
    };
    uint32_t block = sides;
    for (uint32_t i = 1; i < level; ++i) block *= 4;
    if (scheme != Scheme::loop && n != 4) return turn(q / block, n) * block + q % block;
    uint32_t out = turn(q % sides, sides), scale = sides;
    for (uint32_t path = q / sides, i = 0; i < level; ++i, path /= 4, scale *= 4)
        out += turn(path % 4, sides) * scale;
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
    std::vector<uint32_t> first_corner(last.vertex_count, kInvalidIndex);
    for (uint32_t q = last.corner_count(); q-- > 0;) first_corner[last.face_vertices[q]] = q;
    std::vector<uint32_t> corners, border;
    for (uint32_t v = 0; v < last.vertex_count; ++v)
        (last.vertex_rules[v] == VertexRule::smooth ? corners : border).push_back(first_corner[v]);
    block.inside_count = corners.size();
    corners.insert(corners.end(), border.begin(), border.end());
    block.rotated.resize(n);
    for (uint32_t s = 0; s < n; ++s)
        for (const uint32_t q : corners)
            block.rotated[s].push_back(level == 0 ? (q + s) % n
                                                  : rotate_corner(options.scheme, n, level, q, s));
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

/// The face that writes the row of vertex v of a level: the first one around the base vertex, edge or face it
/// is on.
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
/// needed points of the level before (entries hold positions among those). The last step makes the targets; in limit
/// tables it carries tangents.
struct Program {
    struct Step {
        std::vector<uint32_t> offsets;
        Row entries;
    };
    std::vector<Step> steps;                    ///< in order of execution
    std::vector<TangentWeights> tangents;       ///< beside the entries of the last step
    std::vector<std::vector<uint32_t>> needed;  ///< vertices per level, 0 .. ; needed[0] is the ring
    std::vector<IndexMap> maps;
    std::vector<uint32_t> targets;
};

template <class AppendRow>
void write_step(const std::vector<uint32_t>& points, std::vector<uint32_t>& needed, IndexMap& map,
                Program::Step& step, const AppendRow& append_row) {
    step.offsets.assign(1, 0);
    step.entries.clear();
    for (const uint32_t v : points) {
        const size_t first = step.entries.size();
        append_row(v, step.entries);
        for (size_t k = first; k < step.entries.size(); ++k) {
            const uint32_t index = step.entries[k].index;
            step.entries[k].index = map.find_or_insert(index, static_cast<uint32_t>(needed.size()));
            if (step.entries[k].index == needed.size()) needed.push_back(index);
        }
        step.offsets.push_back(static_cast<uint32_t>(step.entries.size()));
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
    program.targets.clear();
    program.tangents.clear();
    const uint32_t first = job.first_corner(member.face);
    for (const uint32_t q : job.block(member.face).rotated[member.rotation])
        program.targets.push_back(job.level().face_vertices[first + q]);
    for (uint32_t step = step_count; step-- > 0;) {
        const std::vector<uint32_t>& points = step + 1 == step_count ? program.targets : program.needed[step + 1];
        const Topology& parent = refinement.levels[step];
        auto append_row = [&](uint32_t v, Row& row) {
            if (limit && step == level) limit_row(parent, v, row, program.tangents);
            else
                refinement_row(parent, v, refinement.levels[step + 1].vertex_rules[v], job.options.interpolation, row);
        };
        write_step(points, program.needed[step], program.maps[step], program.steps[step], append_row);
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
            for (uint32_t k = step.offsets[r]; k < step.offsets[r + 1]; ++k) {
                const uint64_t* from = s.previous.data() + step.entries[k].index * words;
                for (size_t w = 0; w < words; ++w) s.bits[r * words + w] |= from[w];
            }
    }
}

uint32_t support_size(const Supports& s, size_t row) {
    uint32_t size = 0;
    for (size_t w = 0; w < s.words; ++w)
        size += static_cast<uint32_t>(std::popcount(s.bits[row * s.words + w]));
    return size;
}

/// Dense weights of the targets over the ring, `stride` columns a row.
struct Weights {
    size_t stride = 0;
    std::vector<double> rows, previous, tangent1, tangent2;
};

// No fused multiply-add (the build forbids contraction), so wider vectors give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define LIMN_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define LIMN_VECTOR_CLONES
#endif

/// out row r = sum over its entries of weight * in row; `weights` are `weight_stride` doubles apart.
LIMN_VECTOR_CLONES void multiply(const Program::Step& step, const double* weights, size_t weight_stride,
                                 const double* in, size_t stride, double* out) {
    const size_t rows = step.offsets.size() - 1;
    for (size_t r = 0; r < rows; ++r) {
        double* sum = out + r * stride;
        for (uint32_t k = step.offsets[r]; k < step.offsets[r + 1]; ++k) {
            const double weight = weights[k * weight_stride];
            const double* row = in + step.entries[k].index * stride;
            for (size_t i = 0; i < stride; ++i) sum[i] += weight * row[i];
        }
    }
}

void run_weights(const Program& program, Weights& w) {
    const size_t ring = program.needed[0].size();
    const size_t stride = w.stride = (ring + 7) / 8 * 8;
    w.rows.assign(ring * stride, 0.0);
    for (size_t i = 0; i < ring; ++i) w.rows[i * stride + i] = 1;
    for (const Program::Step& step : program.steps) {
        std::swap(w.rows, w.previous);
        const size_t size = (step.offsets.size() - 1) * stride;
        w.rows.assign(size, 0.0);
        multiply(step, &step.entries[0].weight, sizeof(RowEntry) / sizeof(double), w.previous.data(), stride,
                 w.rows.data());
        if (&step != &program.steps.back() || program.tangents.empty()) continue;
        w.tangent1.assign(size, 0.0);
        w.tangent2.assign(size, 0.0);
        multiply(step, &program.tangents[0].tangent1, 2, w.previous.data(), stride, w.tangent1.data());
        multiply(step, &program.tangents[0].tangent2, 2, w.previous.data(), stride, w.tangent2.data());
    }
}

/// Rows of the targets over ring positions, zeros left out: what all members of a group copy.
template <class Real>
struct SharedRows {
    std::vector<uint32_t> offsets, positions;
    std::vector<Real> weights, tangent1, tangent2;
};

template <class Real>
void share_rows(const Supports& s, const Weights& w, SharedRows<Real>& out) {
    const size_t rows = w.stride == 0 ? 0 : w.rows.size() / w.stride;
    out.offsets.assign(1, 0);
    for (size_t r = 0; r < rows; ++r) {
        for (uint32_t word = 0; word < s.words; ++word)
            for (uint64_t bits = s.bits[r * s.words + word]; bits != 0; bits &= bits - 1) {
                const uint32_t i = word * 64 + static_cast<uint32_t>(std::countr_zero(bits));
                out.positions.push_back(i);
                out.weights.push_back(static_cast<Real>(w.rows[r * w.stride + i]));
                if (w.tangent1.empty()) continue;
                out.tangent1.push_back(static_cast<Real>(w.tangent1[r * w.stride + i]));
                out.tangent2.push_back(static_cast<Real>(w.tangent2[r * w.stride + i]));
            }
        out.offsets.push_back(static_cast<uint32_t>(out.positions.size()));
    }
}

/// body(target, vertex) for the targets that face `member` owns.
template <class Body>
void for_each_owned(const Job& job, const Member& member, const Body& body) {
    const Block& block = job.block(member.face);
    const std::vector<uint32_t>& corners = block.rotated[member.rotation];
    const uint32_t* vertices = job.level().face_vertices.data() + job.first_corner(member.face);
    for (size_t i = 0; i < corners.size(); ++i) {
        const uint32_t v = vertices[corners[i]];
        if (i < block.inside_count || owner(job.refinement, job.options.level, v) == member.face) body(i, v);
    }
}

template <class Real>
void write_rows(const Job& job, const Member& member, const SharedRows<Real>& rows, BasicStencilTable<Real>& table,
                Neighborhood& hood) {
    read_neighborhood(job.base(), member.face, hood);
    const Array<uint32_t>& map = job.refinement.control_indices;
    if (!map.empty())
        for (uint32_t& point : hood.ring) point = map[point];
    const bool tangents = !table.tangent1_weights.empty();
    for_each_owned(job, member, [&](size_t target, uint32_t v) {
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
        body(std::span<const Member>(groups.members.data() + groups.first[g],
                                     groups.first[g + 1] - groups.first[g]));
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
        std::vector<uint32_t> row_sizes;
        for (size_t i = 0; i < program.targets.size(); ++i) row_sizes.push_back(support_size(supports, i));
        for_each_member(members, [&](const Member& member) {
            for_each_owned(job, member, [&](size_t target, uint32_t v) { sizes[v] = row_sizes[target]; });
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
        SharedRows<Real> rows;
        write_program(job, members[0], hood, program);
        run_supports(program, supports);
        run_weights(program, weights);
        share_rows(supports, weights, rows);
        for_each_member(members, [&](const Member& member) {
            Neighborhood member_hood;
            write_rows(job, member, rows, table, member_hood);
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
