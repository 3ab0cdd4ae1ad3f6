#include "limn/candidates.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <numeric>

#include "limn/local_refinement.h"
#include "limn/parallel.h"
#include "limn/patch_points.h"
#include "limn/refinement.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Whether all vertices of a face of the scheme's own size are regular.
bool is_regular_face(const Topology& t, uint32_t face, bool linear, const std::vector<uint8_t>& regular) {
    if (t.size_of_face(face) != (t.options.scheme == Scheme::loop ? 3 : 4)) return false;
    const auto vertices = t.vertices_of_face(face);
    return linear ||
           std::all_of(vertices.begin(), vertices.end(), [&](uint32_t v) { return regular[v] != 0; });
}

/// Whether a face of the base level is a surface as it is.
bool is_whole_face(const CandidateSource& source, uint32_t f) {
    if (is_regular_face(source.base, f, source.options.linear, source.regular)) return true;
    PatchPoints patch;
    return find_patch_points(source.base, f, source.options.linear, patch) &&
           (patch.crease_sharpness == 0 || source.options.end_cap == EndCap::exact);
}

/// The surfaces of faces [first, end), in face order.
void list_surfaces(const CandidateSource& source, uint32_t first, uint32_t end, CandidateChunk& out) {
    const Topology& base = source.base;
    const bool triangles = base.options.scheme == Scheme::loop;
    const uint32_t first_child = first_child_face(base, first);
    for (uint32_t f = first; f < end; ++f) {
        const uint32_t size = base.size_of_face(f);
        out.ptex_count += size == (triangles ? 3 : 4) ? 1 : size;
        if (base.face_holes[f] != 0) continue;
        if (is_whole_face(source, f)) {
            out.list.push_back({f - first, 0, 0, 0, 0});
            continue;
        }
        out.splits = true;
        for (uint32_t j = 0; j < (triangles ? 4 : size); ++j)
            out.list.push_back({first_child_face(base, f) - first_child + j, 0, 1, 0, 0});
    }
}

/// Makes corner 1 of the patch corner 0.
void rotate_bicubic_ring(uint32_t (&ring)[16]) {
    uint32_t old[16];
    std::copy_n(ring, 16, old);
    for (uint32_t v = 0; v < 4; ++v)
        for (uint32_t u = 0; u < 4; ++u) ring[4 * v + u] = old[4 * u + (3 - v)];
}

/// Which of the children of its face a quad of level 1 is, where they keep the face's orientation: else 0.
uint32_t place_in_parent(const Topology& base, uint32_t child) {
    const uint32_t parent = base.face_of_corner(child);
    return base.size_of_face(parent) == 4 ? child - base.face_begin(parent) : 0;
}

/// Walks around the candidates of one chunk.
class ChunkWalk {
  public:
    void walk(const CandidateSource& source, uint32_t first_face, const Level1& level1, CandidateChunk& out) {
        source_ = &source;
        level1_ = &level1;
        out_ = &out;
        slots_.assign(2 * out.list.size() + 1, kInvalidIndex);
        out.rings.reserve(out.list.size() * 18);
        const uint32_t first_child = first_child_face(source.base, first_face) - level1.first_face;
        for (uint32_t i = 0; i < out.list.size(); ++i) {
            const size_t ring = out.rings.size();
            Candidate& at = out.list[i];
            const Level level = at.refined != 0 ? Level{level1.child, level1.regular, first_child + at.face}
                                                : Level{source.base, source.regular, first_face + at.face};
            if (is_regular_face(level.t, level.face, source.options.linear, level.regular))
                add_regular(level, at, i);
            else
                add_irregular(level, at, i);
            at.ring_size = static_cast<uint32_t>(out.rings.size() - ring) & 0x1fffffff;
            if (at.refined != 0 && !level1.vertices.empty())
                for (size_t k = ring; k < out.rings.size(); ++k) out.rings[k] = level1.vertices[out.rings[k]];
        }
    }

  private:
    /// A candidate's face, in its level.
    struct Level {
        const Topology& t;
        const std::vector<uint8_t>& regular;
        uint32_t face;
    };
    bool is_linear() const { return source_->options.linear; }

    void add_regular(const Level& level, Candidate& at, uint32_t i) {
        uint32_t ring[16];
        const uint32_t size = write_regular_ring(level.t, level.face, is_linear(), ring);
        // Each quad child from the corner of its parent: grids then sample all four alike.
        if (at.refined != 0 && level.t.face_size == 4 && size == 16)
            at.rotation =
                place_in_parent(level1_->part.face_count != 0 ? level1_->part : source_->base, level.face) &
                3;
        for (uint32_t k = 0; k < at.rotation; ++k) rotate_bicubic_ring(ring);
        out_->rings.insert(out_->rings.end(), ring, ring + size);
        at.kind = find_kind({0, 0}, i, true);
    }
    void add_irregular(const Level& level, Candidate& at, uint32_t i) {
        const Topology& t = level.t;
        at.rotation = choose_plan_corner(t, level.face, is_linear() ? nullptr : &level.regular) & 3;
        std::array<uint64_t, 2> hash;
        if (is_linear() || !walk_around_fans(t, level.face, at.rotation, level.regular, hood_, hash)) {
            WalkOptions options{t};
            options.list_faces = false;
            walk_around(options, level.face, {at.rotation, false}, hood_);
            hash = hash_signature(hood_.signature);
        }
        out_->rings.insert(out_->rings.end(), hood_.ring.begin(), hood_.ring.end());
        at.kind = find_kind(hash, i, false);
    }
    uint32_t find_kind(const std::array<uint64_t, 2>& hash, uint32_t i, bool regular) {
        size_t at = hash[0] % slots_.size();
        for (; slots_[at] != kInvalidIndex; at = (at + 1) % slots_.size()) {
            const CandidateChunk::Kind& kind = out_->kinds[slots_[at]];
            if (kind.hash == hash && kind.regular == regular) return slots_[at];
        }
        slots_[at] = static_cast<uint32_t>(out_->kinds.size());
        out_->kinds.push_back({hash, i, regular});
        return slots_[at];
    }

    const CandidateSource* source_ = nullptr;
    const Level1* level1_ = nullptr;
    CandidateChunk* out_ = nullptr;
    Neighborhood hood_;
    std::vector<uint32_t> slots_;  ///< kinds by hash, kInvalidIndex where free
};

/// Faces [first, end), and after them all that touch them.
std::vector<uint32_t> faces_touching(const Topology& t, uint32_t first, uint32_t end) {
    std::vector<uint32_t> faces(end - first);
    std::iota(faces.begin(), faces.end(), first);
    for (uint32_t c = t.face_begin(first); c < t.face_begin(end); ++c)
        for (const uint32_t beside : t.corners_of_vertex(t.face_vertices[c]))
            if (const uint32_t f = t.face_of_corner(beside); f < first || f >= end) faces.push_back(f);
    std::sort(faces.begin() + (end - first), faces.end());
    faces.erase(std::unique(faces.begin() + (end - first), faces.end()), faces.end());
    return faces;
}

/// Turns the numbers of `level1.vertices`, those of the part's vertices, into those of its child's.
void number_children(const Topology& base, const std::vector<uint32_t>& faces, Level1& level1) {
    const Topology& part = level1.part;
    std::vector<uint32_t>& numbers = level1.vertices;
    numbers.resize(level1.child.vertex_count);
    for (uint32_t i = 0; i < faces.size(); ++i) {
        if (base.options.scheme != Scheme::loop)
            numbers[child_of_face(part, i)] = child_of_face(base, faces[i]);
        for (uint32_t k = 0; k < part.size_of_face(i); ++k)
            numbers[child_of_edge(part, part.face_edges[part.face_begin(i) + k])] =
                child_of_edge(base, base.face_edges[base.face_begin(faces[i]) + k]);
    }
}

Level1 refine_around(const CandidateSource& source, uint32_t first, uint32_t end) {
    Level1 out;
    const std::vector<uint32_t> faces = faces_touching(source.base, first, end);
    extract_faces(source.base, faces, out.vertices, out.part);
    refine_once(out.part, true, out.child);
    number_children(source.base, faces, out);
    if (!source.options.linear) out.regular = find_regular_vertices(out.child);
    out.first_face = first_child_face(source.base, first);
    return out;
}

}  // namespace

CandidateSource::CandidateSource(const Topology& t, const PlanOptions& o, const BuildPart& part)
    : base(t), options(o) {
    if (!o.linear && t.options.scheme != Scheme::doo_sabin) regular = find_regular_vertices(t, part);
}

Candidates find_candidates(const CandidateSource& source, Level1& level1, const BuildPart& part) {
    const Topology& base = source.base;
    Candidates out;
    for (uint32_t f = 0; f < base.face_count; f += CandidateChunk::kFaceCount) out.first_faces.push_back(f);
    out.chunks.resize(out.first_faces.size());
    out.first_faces.push_back(base.face_count);
    const auto for_each_chunk = [&](const BuildPart& p, const auto& body) {
        for_each_index(
            out.chunk_count(), p, [&](uint32_t k) { body(k, *out.chunks[k]); }, 1);
    };
    for (auto& chunk : out.chunks) chunk = std::make_shared<CandidateChunk>();
    for_each_chunk(part.part(0, 0.2f), [&](uint32_t k, CandidateChunk& chunk) {
        list_surfaces(source, out.first_faces[k], out.first_faces[k + 1], chunk);
    });
    if (std::any_of(out.chunks.begin(), out.chunks.end(), [](const auto& chunk) { return chunk->splits; })) {
        refine_once(base, true, level1.child, part.part(0.2f, 0.4f));
        if (!source.options.linear)
            level1.regular = find_regular_vertices(level1.child, part.part(0.4f, 0.5f));
    }
    tbb::enumerable_thread_specific<ChunkWalk> walks;
    for_each_chunk(part.part(0.5f, 1), [&](uint32_t k, CandidateChunk& chunk) {
        walks.local().walk(source, out.first_faces[k], level1, chunk);
    });
    return out;
}

std::shared_ptr<CandidateChunk> find_chunk(const CandidateSource& source, uint32_t first_face,
                                           uint32_t end_face, Level1& level1) {
    auto out = std::make_shared<CandidateChunk>();
    list_surfaces(source, first_face, end_face, *out);
    if (out->splits) level1 = refine_around(source, first_face, end_face);
    ChunkWalk().walk(source, first_face, level1, *out);
    return out;
}

void place_chunks(Candidates& candidates) {
    candidates.places.assign(1, {});
    candidates.places.reserve(candidates.chunks.size() + 1);
    for (const auto& chunk : candidates.chunks) {
        ChunkPlace place = candidates.places.back();
        place.first_ptex += chunk->ptex_count;
        place.first_surface += static_cast<uint32_t>(chunk->list.size());
        place.first_ring += chunk->rings.size();
        candidates.places.push_back(place);
    }
}

}  // namespace limn
