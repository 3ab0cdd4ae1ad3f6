// Chunks of faces, and blocks of level-1 points, that an edit touches are made again; the others are shared
// with the state before. Then everything is numbered anew in passes over arrays, and written where it has
// moved.
#include "limn/mesh_edit.h"

#include <algorithm>
#include <atomic>

#include "limn/edited_topology.h"
#include "limn/parallel.h"
#include "limn/patch_table_parts.h"
#include "limn/refinement.h"

namespace limn {

struct EditableMesh::State {
    EditableMeshOptions options;
    PlanCache own_cache;
    PlanCache::Impl* cache = nullptr;
    EditedTopology topology;
    PatchTableParts<float> parts;
    std::vector<uint32_t> uses;  ///< of each vertex of level 1 by rings
    PatchTable patches;
    TessellationTable tessellation;
};

namespace {

/// Control points are the vertices.
const Array<uint32_t> kNoIndices;

/// What the tables are to be made of: chunks and blocks that are to be made again are null.
struct Update {
    PatchTableParts<float> parts;
    std::vector<uint32_t> uses;
};

/// `count` modulo 2^32, for each point of a chunk's rings.
void add_uses(const CandidateChunk& chunk, uint32_t count, std::vector<uint32_t>& uses) {
    for_each_ring(chunk, [&](const Candidate& at, uint32_t, uint32_t first) {
        if (at.refined == 0) return;
        for (size_t i = first; i < first + at.ring_size; ++i) uses[chunk.rings[i]] += count;
    });
}

/// Vertices around which rules have changed: with Chaikin creasing, sharpness next to a vertex depends on all
/// edges around it.
std::vector<uint32_t> changed_vertices(const Topology& base, const TouchedPlaces& touched) {
    std::vector<uint32_t> out = touched.vertices;
    if (!base.half_edge_sharpness.empty())
        for (const uint32_t v : touched.vertices)
            for (const uint32_t e : base.edges_of_vertex(v)) out.push_back(base.other_vertex(e, v));
    return out;
}

uint32_t chunk_of_face(const Candidates& c, uint32_t f) {
    return static_cast<uint32_t>(std::upper_bound(c.first_faces.begin(), c.first_faces.end(), f) -
                                 c.first_faces.begin()) -
           1;
}

/// Drops the parts that depend on faces, or on vertices, that have changed.
struct Dropping {
    const Topology& base;
    PatchTableParts<float>& parts;

    void drop_around(uint32_t v) {
        parts.points.blocks[vertex_block(v)] = nullptr;
        for (const uint32_t c : base.corners_of_vertex(v)) drop_face(base.face_of_corner(c));
    }
    void drop_face(uint32_t f) { drop_chunk(chunk_of_face(parts.candidates, f)); }
    /// And the blocks of its faces and edges.
    void drop_chunk(uint32_t k) {
        const uint32_t chunks = parts.candidates.chunk_count(), first = vertex_block_count(base);
        parts.candidates.chunks[k] = nullptr;
        for (uint32_t b = first + k; b < parts.points.block_count(); b += chunks)
            parts.points.blocks[b] = nullptr;
    }
    void drop_touched(const TouchedPlaces& touched) {
        for (const uint32_t v : changed_vertices(base, touched)) drop_around(v);
        for (const uint32_t f : touched.faces) drop_face(f);
    }
};

/// Where sharpness and holes alone have changed.
Update keep_parts(const EditableMesh::State& s, const TouchedPlaces& touched) {
    Update out;
    out.parts.candidates.first_faces = s.parts.candidates.first_faces;
    out.parts.candidates.chunks = s.parts.candidates.chunks;
    out.parts.points.first_children = s.parts.points.first_children;
    out.parts.points.blocks = s.parts.points.blocks;
    out.uses = s.uses;
    Dropping{s.topology.base, out.parts}.drop_touched(touched);
    for (uint32_t k = 0; k < out.parts.candidates.chunk_count(); ++k)
        if (out.parts.candidates.chunks[k] == nullptr) add_uses(*s.parts.candidates.chunks[k], ~0u, out.uses);
    return out;
}

/// Chunks of the faces that stay, in their order; new faces follow, in the last one and in others.
std::vector<uint32_t> keep_chunks(const Candidates& c, const FaceChange& change) {
    std::vector<uint32_t> out(1, 0);
    for (uint32_t k = 0; k < c.chunk_count(); ++k) {
        const auto begin = change.faces.begin();
        const auto gone = std::count(begin + c.first_faces[k], begin + c.first_faces[k + 1], kInvalidIndex);
        out.push_back(out.back() + c.first_faces[k + 1] - c.first_faces[k] - static_cast<uint32_t>(gone));
    }
    const uint32_t face_count = change.to.base.face_count;
    out.back() = std::min(face_count, std::max(out.back(), out[out.size() - 2] + CandidateChunk::kFaceCount));
    while (out.back() < face_count)
        out.push_back(std::min(face_count, out.back() + CandidateChunk::kFaceCount));
    return out;
}

/// Blocks by what they are of: vertices, then chunks' faces (not Loop), then chunks' edges.
void keep_blocks(const EditableMesh::State& s, const Topology& base, PatchTableParts<float>& to) {
    to.points.first_children = find_child_blocks(base, to.candidates.first_faces);
    to.points.blocks.resize(to.points.first_children.size() - 1);
    const auto copy = [&](uint32_t first, uint32_t count, uint32_t to_first) {
        std::copy_n(s.parts.points.blocks.begin() + first, count, to.points.blocks.begin() + to_first);
    };
    const uint32_t chunks = s.parts.candidates.chunk_count(), to_chunks = to.candidates.chunk_count();
    uint32_t from_first = vertex_block_count(s.topology.base), to_first = vertex_block_count(base);
    copy(0, from_first, 0);
    for (; from_first < s.parts.points.block_count(); from_first += chunks, to_first += to_chunks)
        copy(from_first, chunks, to_first);
}

/// What the vertices of level 1 become that belong to faces which stay as they are; else kInvalidIndex.
std::vector<uint32_t> find_new_children(const Topology& from, const FaceChange& change) {
    const Topology& to = change.to.base;
    std::vector<uint32_t> out(level1_vertex_count(from), kInvalidIndex);
    for (uint32_t v = 0; v < from.vertex_count; ++v) out[v] = v;
    for_each_index(from.face_count, [&](uint32_t f) {
        if (change.changed[f] != 0) return;
        const uint32_t now = change.faces[f], begin = from.face_begin(f), to_begin = to.face_begin(now);
        if (from.options.scheme != Scheme::loop) out[child_of_face(from, f)] = child_of_face(to, now);
        for (uint32_t k = 0; k < from.size_of_face(f); ++k)
            std::atomic_ref(out[child_of_edge(from, from.face_edges[begin + k])])
                .store(child_of_edge(to, to.face_edges[to_begin + k]), std::memory_order_relaxed);
    });
    return out;
}

std::shared_ptr<CandidateChunk> renumber(const CandidateChunk& chunk, const std::vector<uint32_t>& children) {
    auto out = std::make_shared<CandidateChunk>(chunk);
    for_each_ring(*out, [&](const Candidate& at, uint32_t, uint32_t first) {
        if (at.refined == 0) return;
        for (size_t i = first; i < first + at.ring_size; ++i) out->rings[i] = children[out->rings[i]];
    });
    return out;
}

/// Where faces have changed.
Update renumber_parts(const EditableMesh::State& s, const FaceChange& change) {
    const Topology &from = s.topology.base, &base = change.to.base;
    const Candidates& c = s.parts.candidates;
    Update out;
    out.parts.candidates.first_faces = keep_chunks(c, change);
    out.parts.candidates.chunks = c.chunks;
    out.parts.candidates.chunks.resize(out.parts.candidates.first_faces.size() - 1);
    keep_blocks(s, base, out.parts);
    Dropping dropping{base, out.parts};
    dropping.drop_touched(change.touched);
    for (uint32_t f = 0; f < from.face_count; ++f)
        if (change.changed[f] != 0) dropping.drop_chunk(chunk_of_face(c, f));

    std::vector<uint32_t> uses = s.uses;
    for (uint32_t k = 0; k < c.chunk_count(); ++k)
        if (out.parts.candidates.chunks[k] == nullptr) add_uses(*c.chunks[k], ~0u, uses);
    const std::vector<uint32_t> children = find_new_children(from, change);
    out.uses.assign(level1_vertex_count(base), 0);
    for (size_t child = 0; child < uses.size(); ++child)
        if (uses[child] != 0) out.uses[children[child]] = uses[child];
    for_each_index(
        out.parts.candidates.chunk_count(),
        [&](uint32_t k) {
            auto& chunk = out.parts.candidates.chunks[k];
            if (chunk != nullptr && chunk->splits) chunk = renumber(*chunk, children);
        },
        1);
    return out;
}

/// The last steps, once chunks are there: all that can fail comes before any table changes. `level1_of`: as
/// of find_plans.
Result<void> finish(EditableMesh::State& s, const EditedTopology& topology, const CandidateSource& source,
                    const std::function<const Level1&(uint32_t)>& level1_of, Update& update,
                    bool tessellation, const BuildPart& part) {
    if (auto ok = find_plans(source, level1_of, *s.cache, update.parts.candidates, part.part(0, 0.2f)); !ok)
        return ok;
    place_chunks(update.parts.candidates);
    update.parts.points.control_count = topology.base.vertex_count;
    if (auto ok = place_parts(source, kNoIndices, update.uses, update.parts, part.part(0.2f, 0.5f)); !ok)
        return ok;
    if (tessellation) {
        const TessellationTableOptions options{s.options.split_creases, s.options.channels,
                                               part.part(0.5f, 0.8f)};
        auto table = build_tessellation_table(topology.mesh, topology.base, options);
        if (!table) return table.error();
        s.tessellation = std::move(*table);
    }
    write_patch_table(source, kNoIndices, update.parts, &s.parts, s.patches, part.part(0.8f, 1));
    s.parts = std::move(update.parts);
    s.uses = std::move(update.uses);
    return {};
}

/// Makes the chunks that an update lacks, and finishes.
Result<EditWork> make_missing(EditableMesh::State& s, const EditedTopology& topology, Update& update,
                              bool tessellation) {
    const CandidateSource source(topology.base, plan_options(topology.base.options, s.options.patches));
    Candidates& c = update.parts.candidates;
    std::vector<uint32_t> missing;
    EditWork work{0, tessellation};
    for (uint32_t k = 0; k < c.chunk_count(); ++k) {
        if (c.chunks[k] != nullptr) continue;
        missing.push_back(k);
        work.face_count += c.first_faces[k + 1] - c.first_faces[k];
    }
    std::vector<Level1> level1(missing.size());
    const auto make = [&](uint32_t i) {
        const uint32_t k = missing[i];
        c.chunks[k] = find_chunk(source, c.first_faces[k], c.first_faces[k + 1], level1[i]);
    };
    for_each_index(static_cast<uint32_t>(missing.size()), make, 1);
    for (const uint32_t k : missing) add_uses(*c.chunks[k], 1, update.uses);
    const auto level1_of = [&](uint32_t k) -> const Level1& {
        return level1[static_cast<size_t>(std::lower_bound(missing.begin(), missing.end(), k) -
                                          missing.begin())];
    };
    if (auto ok = finish(s, topology, source, level1_of, update, tessellation, {}); !ok) return ok.error();
    return work;
}

/// Everything anew.
Result<EditWork> build(EditableMesh::State& s, const EditedTopology& topology, const BuildPart& part) {
    const Topology& base = topology.base;
    const CandidateSource source(base, plan_options(base.options, s.options.patches), part.part(0, 0.1f));
    Level1 level1;
    Update update;
    update.parts.candidates = find_candidates(source, level1, part.part(0.1f, 0.5f));
    if (auto ok = part.check(); !ok) return ok.error();
    update.parts.points.first_children = find_child_blocks(base, update.parts.candidates.first_faces);
    update.parts.points.blocks.resize(update.parts.points.first_children.size() - 1);
    update.uses.assign(level1_vertex_count(base), 0);
    for (const auto& chunk : update.parts.candidates.chunks) add_uses(*chunk, 1, update.uses);
    const auto level1_of = [&](uint32_t) -> const Level1& { return level1; };
    if (auto ok = finish(s, topology, source, level1_of, update, true, part.part(0.5f, 1)); !ok)
        return ok.error();
    return EditWork{base.face_count, true};
}

Result<EditWork> edit_sharpness(EditableMesh::State& s, const MeshEdit& edit) {
    if (auto ok = check_sharpness(s.topology, edit); !ok) return ok.error();
    SharpnessLists before(s.topology.mesh);
    TouchedPlaces touched;
    change_sharpness(edit, s.topology, touched);
    Update update = keep_parts(s, touched);
    auto work = make_missing(s, s.topology, update, touched.tessellation);
    if (!work) restore_sharpness(std::move(before), touched, s.topology);
    return work;
}

Result<EditWork> make_changed(EditableMesh::State& s, const FaceChange& change) {
    // What walks and rows list is not the same where faces differ in size.
    if (change.to.base.face_size != s.topology.base.face_size) return build(s, change.to, {});
    Update update = renumber_parts(s, change);
    return make_missing(s, change.to, update, true);
}

Result<EditWork> edit_faces(EditableMesh::State& s, const MeshEdit& edit) {
    auto change = change_faces(s.topology, edit);
    if (!change) return change.error();
    if (auto ok = check_sharpness(change->to, edit); !ok) return ok.error();
    change_sharpness(edit, change->to, change->touched);
    auto work = make_changed(s, *change);
    if (work) s.topology = std::move(change->to);
    return work;
}

}  // namespace

Result<EditableMesh> EditableMesh::create(ControlMesh mesh, const EditableMeshOptions& options,
                                          const PlanCache* cache) {
    const BuildPart part = options.patches.control;
    if (auto ok = check_options(options.patches); !ok) return ok.error();
    if (mesh.options.scheme == Scheme::doo_sabin)
        return Error{ErrorCode::unsupported, "editing Doo-Sabin meshes: build their tables anew"};
    if (auto ok = part.start(); !ok) return ok.error();
    auto state = std::make_unique<State>();
    state->options = options;
    state->options.patches.control = {};
    state->cache = &(cache != nullptr ? *cache : state->own_cache).impl();
    state->topology = make_edited_topology(std::move(mesh), part.part(0, 0.2f));
    if (auto ok = part.check(); !ok) return ok.error();
    if (auto built = build(*state, state->topology, part.part(0.2f, 1)); !built) return built.error();
    if (auto ok = part.reach(1); !ok) return ok.error();
    return EditableMesh(std::move(state));
}

Result<EditWork> EditableMesh::edit(const MeshEdit& edit) {
    const bool has_faces = !edit.faces.empty() || !edit.face_sizes.empty() || !edit.face_vertices.empty();
    return has_faces || edit.new_vertex_count != 0 ? edit_faces(*state_, edit)
                                                   : edit_sharpness(*state_, edit);
}

EditableMesh::EditableMesh(std::unique_ptr<State> state) : state_(std::move(state)) {}
EditableMesh::EditableMesh(EditableMesh&&) noexcept = default;
EditableMesh& EditableMesh::operator=(EditableMesh&&) noexcept = default;
EditableMesh::~EditableMesh() = default;

const ControlMesh& EditableMesh::mesh() const {
    return state_->topology.mesh;
}
const Topology& EditableMesh::topology() const {
    return state_->topology.base;
}
const PatchTable& EditableMesh::patches() const {
    return state_->patches;
}
const TessellationTable& EditableMesh::tessellation() const {
    return state_->tessellation;
}

}  // namespace limn
