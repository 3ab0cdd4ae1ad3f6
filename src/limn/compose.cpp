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
#include <map>
#include <vector>

#include "limn/local_refinement.h"
#include "limn/neighborhood.h"
#include "limn/parallel.h"
#include "limn/stencil_row.h"

namespace limn {
namespace {

/// Where on a face a refined vertex lies. Border vertices belong to the first face around the control vertex
/// or edge.
enum class Place : uint8_t { inside, edge, vertex };

/// The refined vertices over a face of n corners, each by a corner of the refined faces, counted from the
/// first over the face. `rotated[s]` are the same vertices where the walk starts at corner s.
struct Block {
    std::vector<Place> places;
    std::vector<uint32_t> sides;  ///< the face's edge or corner that a border vertex lies on
    std::vector<std::vector<uint32_t>> turned;

    const std::vector<uint32_t>& corners(Orientation o) const {
        return turned[o.rotation + (o.mirrored ? turned.size() / 2 : 0)];
    }
};

/// Corner offset q of a block as a walk of another orientation has it: digits of its path down the levels,
/// then its slot.
uint32_t turn_corner(Scheme scheme, uint32_t n, uint32_t level, uint32_t q, Orientation orientation) {
    if (level == 0) return orientation.corner(q, n);
    const uint32_t sides = scheme == Scheme::loop ? 3 : 4;
    // The children of an n-gon have orientations of their own, which mirroring turns around their first
    // corner.
    const bool polygon = scheme != Scheme::loop && n != 4;
    const Orientation inner = polygon ? Orientation{0, orientation.mirrored} : orientation;
    auto turn = [&](uint32_t digit) { return digit < sides ? inner.corner(digit, sides) : digit; };
    uint32_t out = turn(q % sides), scale = sides, path = q / sides;
    for (uint32_t i = polygon ? 1 : 0; i < level; ++i, path /= 4, scale *= 4) out += turn(path % 4) * scale;
    return polygon ? out + orientation.corner(path, n) * scale : out;
}

/// For each vertex of a refined polygon the side of the polygon that it lies on, or kInvalidIndex.
std::vector<uint32_t> sides_of_vertices(const Refinement& polygon) {
    const Topology& base = polygon.levels[0];
    std::vector<uint32_t> edges(base.edge_count), vertices(base.vertex_count, kInvalidIndex);
    for (uint32_t e = 0; e < base.edge_count; ++e) edges[e] = e;
    for (uint32_t l = 0; l + 1 < polygon.level_count(); ++l) {
        const Topology& t = polygon.levels[l];
        std::vector<uint32_t> child_edges(t.corner_count() + size_t{2} * t.edge_count, kInvalidIndex);
        vertices.resize(polygon.levels[l + 1].vertex_count, kInvalidIndex);
        for (uint32_t e = 0; e < t.edge_count; ++e) {
            vertices[child_of_edge(t, e)] = edges[e];
            child_edges[t.corner_count() + 2 * e] = child_edges[t.corner_count() + 2 * e + 1] = edges[e];
        }
        edges = std::move(child_edges);
    }
    return vertices;
}

Block build_block(const SchemeOptions& options, uint32_t n, uint32_t level) {
    std::vector<uint32_t> polygon(n);
    for (uint32_t i = 0; i < n; ++i) polygon[i] = i;
    ControlMeshDescription description;
    description.options = options;
    description.vertex_count = n;
    description.face_sizes = {&n, 1};
    description.face_vertices = polygon;
    const Result<ControlMesh> mesh = ControlMesh::create(description);
    const Result<Refinement> refinement = build_refinement(*mesh, {level, false});
    const Topology& last = refinement->last();
    const std::vector<uint32_t> sides = sides_of_vertices(*refinement);
    Block block;
    block.turned.resize(size_t{2} * n);
    std::vector<bool> seen(last.vertex_count);
    for (uint32_t q = 0; q < last.corner_count(); ++q) {
        const uint32_t v = last.face_vertices[q];
        if (seen[v]) continue;
        seen[v] = true;
        block.places.push_back(v < n                       ? Place::vertex
                               : sides[v] != kInvalidIndex ? Place::edge
                                                           : Place::inside);
        block.sides.push_back(v < n ? v : sides[v]);
        for (uint32_t s = 0; s < 2 * n; ++s)
            block.turned[s].push_back(turn_corner(options.scheme, n, level, q, {s % n, s >= n}));
    }
    return block;
}

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

/// The refinement over one face, written down: each step's rows over the points of the level before, for the
/// points that are needed. Entries hold positions among those. Points of level 0 are in the order of the
/// neighbourhood's ring. In limit tables the last step carries tangents.
struct Program {
    struct Step {
        std::vector<uint32_t> offsets;
        Row entries;
    };
    size_t ring_size = 0, target_count = 0;
    std::vector<Step> steps;                ///< in order of execution
    std::vector<TangentWeights> tangents;   ///< beside the entries of the last step
    std::vector<uint32_t> points, sources;  ///< scratch: vertices that a step makes, and needs
    LocalRefinement local;
};

/// Appends one step whose rows are those of program.points; leaves the vertices it needs in program.points.
template <class AppendRow>
void write_step(Program& program, std::vector<uint32_t>& positions, Program::Step& step,
                const AppendRow& append_row) {
    step.offsets.assign(1, 0);
    step.entries.clear();
    program.sources.clear();
    for (const uint32_t v : program.points) {
        const size_t first = step.entries.size();
        append_row(v, step.entries);
        for (size_t k = first; k < step.entries.size(); ++k) {
            uint32_t& position = positions[step.entries[k].index];
            if (position == kInvalidIndex) {
                position = static_cast<uint32_t>(program.sources.size());
                program.sources.push_back(step.entries[k].index);
            }
            step.entries[k].index = position;
        }
        step.offsets.push_back(static_cast<uint32_t>(step.entries.size()));
    }
    std::swap(program.points, program.sources);
}

/// Works back from the targets over a face to its ring.
void write_program(const Job& job, const Member& member, Neighborhood& hood, Program& program) {
    const bool limit = job.options.target != Target::refined;
    walk_around(job.walk(), member.face, member.orientation, hood);
    const LocalRefinementOptions options{job.options.level, limit, job.uncut()};
    refine_locally(job.base(), hood.faces, job.block(member.face).corners(member.orientation), options,
                   program.local);
    const std::vector<Topology>& levels = program.local.levels;
    const size_t step_count = levels.size() - 1 + (limit ? 1 : 0);
    program.steps.resize(step_count);
    program.tangents.clear();
    program.points = program.local.targets;
    program.target_count = program.points.size();
    program.ring_size = hood.ring.size();
    std::vector<uint32_t> positions;
    for (size_t step = step_count; step-- > 0;) {
        const Topology& parent = levels[step];
        positions.assign(parent.vertex_count, kInvalidIndex);
        if (step == 0)
            for (uint32_t v = 0; v < parent.vertex_count; ++v)
                positions[v] = hood.local(program.local.ring[v]);
        write_step(program, positions, program.steps[step], [&](uint32_t v, Row& row) {
            if (step + 1 == levels.size()) return limit_row(parent, v, row, program.tangents);
            const std::vector<uint32_t>& children = program.local.children[step + 1];
            const uint32_t child = children.empty() ? v : children[v];
            refinement_row(parent, child, job.options.interpolation, row);
        });
    }
}

/// Supports of the targets as bit sets over the ring: `words` words each.
struct Supports {
    uint32_t words = 0;
    std::vector<uint64_t> bits, previous;
};

void run_supports(const Program& program, Supports& s) {
    const size_t ring = program.ring_size;
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
    const size_t ring = program.ring_size;
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
};

/// Composed rows grow with the square of a valence; past this many faces around one face they are not worth
/// having.
bool fits_composition(const Topology& base) {
    constexpr size_t kMaxFacesAround = 16384, kMaxRing = 0xffff;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        size_t faces = 0, corners = 0;
        for (const uint32_t v : base.vertices_of_face(f)) faces += base.corners_of_vertex(v).size();
        if (faces > kMaxFacesAround) return false;
        if (base.face_size != 0) continue;
        for (const uint32_t v : base.vertices_of_face(f))
            for (const uint32_t c : base.corners_of_vertex(v))
                corners += base.size_of_face(base.face_of_corner(c));
        if (corners > kMaxRing) return false;
    }
    return true;
}

Groups group_faces(const Job& job) {
    const Topology& base = job.base();
    Groups groups;
    groups.members.resize(base.face_count);
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, base.face_count, 256), [&](const auto& range) {
        Neighborhood hood;
        for (uint32_t f = range.begin(); f != range.end(); ++f) {
            groups.members[f].face = f;
            groups.members[f].orientation = choose_orientation(job.walk(), f, hood, groups.members[f].hash);
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
            Neighborhood hood;
            Program program;
            Supports supports;
            write_program(job, members[0], hood, program);
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
            Neighborhood hood;
            Program program;
            Supports supports;
            Weights weights;
            write_program(job, members[0], hood, program);
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
    if (!fits_composition(base))
        return Error{ErrorCode::unsupported,
                     "a vertex has too many edges for a table over the control points: chain step tables"};
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t n = base.size_of_face(f);
        if (job.blocks.count(n) == 0) job.blocks.emplace(n, build_block(base.options, n, options.level));
        if (base.face_size != 0) break;
    }
    const Groups groups = group_faces(job);
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
