#include "limn/candidates.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
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

/// Makes corner 1 of the patch corner 0.
void rotate_bicubic_ring(uint32_t (&ring)[16]) {
    uint32_t old[16];
    std::copy_n(ring, 16, old);
    for (uint32_t v = 0; v < 4; ++v)
        for (uint32_t u = 0; u < 4; ++u) ring[4 * v + u] = old[4 * u + (3 - v)];
}

/// Walks around the candidates of one chunk.
class ChunkWalk {
  public:
    /// Of faces [first_face, end_face). False, and to be done again, where that takes level 1 and `level1` is null.
    bool walk(const CandidateSource& source, uint32_t first_face, uint32_t end_face, const Level1* level1,
              CandidateChunk& out) {
        const Topology& base = source.base;
        source_ = &source;
        level1_ = level1;
        out_ = &out;
        out = {};
        first_child_ = first_child_face(base, first_face);
        const uint32_t corners = first_child_face(base, end_face) - first_child_;
        slots_.assign(std::bit_ceil(2 * size_t{corners} + 2), kInvalidIndex);
        out.list.reserve(corners);
        out.rings.reserve(size_t{16} * corners);
        const uint32_t own_size = base.options.scheme == Scheme::loop ? 3 : 4;
        for (uint32_t f = first_face; f < end_face; ++f) {
            const uint32_t size = base.size_of_face(f);
            out.ptex_count += size == own_size ? 1 : size;
            if (base.face_holes[f] != 0 || add_whole(f, f - first_face)) continue;
            out.splits = true;
            const uint32_t child = first_child_face(base, f) - first_child_;
            for (uint32_t j = 0; j < (own_size == 3 ? 4 : size); ++j)
                if (!add_child(child + j, size == 4 ? j : 0)) return false;
        }
        return true;
    }

  private:
    bool is_linear() const { return source_->options.linear; }

    /// A face of the base level that is a surface as it is: its number, from the chunk's first.
    bool add_whole(uint32_t f, uint32_t number) {
        const Topology& base = source_->base;
        if (is_regular_face(base, f, is_linear(), source_->regular)) {
            add_regular(base, f, {number, 0, 0, 0, 0}, 0);
        } else {
            if (!find_patch(base, f, source_->options, patch_)) return false;
            make_local(patch_, local_);
            add_local({number, 0, 0, 0, 0}, 0);
        }
        return true;
    }
    /// A face of level 1. `slot`: the corner that it has in common with its parent.
    bool add_child(uint32_t number, uint32_t slot) {
        const Candidate at{number, 0, 1, 0, 0};
        if (source_->has_stars && find_base_quad(source_->base, first_child_ + number, quad_)) {
            add_quad(at, slot + quad_.corner);
            return true;
        }
        if (level1_ == nullptr) return false;
        const Topology& t = level1_->child;
        const uint32_t face = first_child_ - level1_->first_face + number;
        const size_t ring = out_->rings.size();
        if (is_regular_face(t, face, is_linear(), level1_->regular)) {
            add_regular(t, face, at, slot);
        } else if (find_patch(t, face, source_->options, patch_)) {
            make_local(patch_, local_);
            add_local(at, 0);
        } else {
            add_irregular(t, face, at);
        }
        if (!level1_->vertices.empty())
            for (size_t k = ring; k < out_->rings.size(); ++k) out_->rings[k] = level1_->vertices[out_->rings[k]];
        return true;
    }

    void add_quad(const Candidate& at, uint32_t corner) {
        if (!quad_.pattern) {
            key_.clear();
            quad_.star.append_to(key_);
            return add_candidate(at, corner, quad_.ring, hash_signature(key_), PlanSource::star);
        }
        if (quad_.pattern->is_regular()) return add_candidate(at, corner, quad_.net, {0, 0}, PlanSource::regular);
        make_local(quad_.net, *quad_.pattern, local_);
        add_local(at, corner);
    }
    void add_local(const Candidate& at, uint32_t corner) {
        add_candidate(at, corner + local_.rotation, local_.ring, hash_signature(local_.signature), PlanSource::patch);
    }
    void add_regular(const Topology& t, uint32_t face, const Candidate& at, uint32_t slot) {
        uint32_t ring[16];
        const uint32_t size = write_regular_ring(t, face, is_linear(), ring);
        // Each quad child from the corner of its parent: grids then sample all four alike.
        const uint32_t rotation = size == 16 ? slot : 0;
        for (uint32_t k = 0; k < rotation; ++k) rotate_bicubic_ring(ring);
        add_candidate(at, rotation, std::span(ring, size), {0, 0}, PlanSource::regular);
    }
    void add_irregular(const Topology& t, uint32_t face, const Candidate& at) {
        const uint32_t rotation = choose_plan_corner(t, face, is_linear() ? nullptr : &level1_->regular);
        std::array<uint64_t, 2> hash;
        if (is_linear() || !walk_around_fans(t, face, rotation, level1_->regular, hood_, hash)) {
            WalkOptions options{t};
            options.list_faces = false;
            walk_around(options, face, {rotation, false}, hood_);
            hash = hash_signature(hood_.signature);
        }
        add_candidate(at, rotation, hood_.ring, hash, PlanSource::neighborhood);
    }

    template <class Ring>
    void add_candidate(Candidate at, uint32_t rotation, const Ring& ring, const std::array<uint64_t, 2>& hash,
                       PlanSource plan) {
        at.rotation = rotation & 3;
        at.ring_size = static_cast<uint32_t>(ring.size()) & 0x1fffffff;
        at.kind = find_kind(hash, plan);
        out_->list.push_back(at);
        out_->rings.insert(out_->rings.end(), ring.begin(), ring.end());
    }
    /// Of the next candidate.
    uint32_t find_kind(const std::array<uint64_t, 2>& hash, PlanSource plan) {
        const size_t mask = slots_.size() - 1;
        size_t at = (hash[0] + static_cast<size_t>(plan)) & mask;
        for (; slots_[at] != kInvalidIndex; at = (at + 1) & mask) {
            const CandidateChunk::Kind& kind = out_->kinds[slots_[at]];
            if (kind.hash == hash && kind.source == plan) return slots_[at];
        }
        slots_[at] = static_cast<uint32_t>(out_->kinds.size());
        out_->kinds.push_back({hash, static_cast<uint32_t>(out_->list.size()), plan});
        return slots_[at];
    }

    const CandidateSource* source_ = nullptr;
    const Level1* level1_ = nullptr;
    CandidateChunk* out_ = nullptr;
    uint32_t first_child_ = 0;
    Neighborhood hood_;
    PatchPoints patch_;
    LocalPatch local_;
    BaseQuad quad_;
    PlanKey key_;
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
    : base(t), options(o), has_stars(has_quad_stars(t) && !o.linear && o.end_cap == EndCap::exact) {
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
    std::vector<uint8_t> is_left(out.chunks.size(), 0);
    tbb::enumerable_thread_specific<ChunkWalk> walks;
    for_each_chunk(part.part(0, 0.5f), [&](uint32_t k, CandidateChunk& chunk) {
        is_left[k] = !walks.local().walk(source, out.first_faces[k], out.first_faces[k + 1], nullptr, chunk);
    });
    if (std::all_of(is_left.begin(), is_left.end(), [](uint8_t left) { return left == 0; })) return out;
    refine_once(base, true, level1.child, part.part(0.5f, 0.7f));
    if (!source.options.linear) level1.regular = find_regular_vertices(level1.child, part.part(0.7f, 0.8f));
    for_each_chunk(part.part(0.8f, 1), [&](uint32_t k, CandidateChunk& chunk) {
        if (is_left[k] != 0)
            walks.local().walk(source, out.first_faces[k], out.first_faces[k + 1], &level1, chunk);
    });
    return out;
}

std::shared_ptr<CandidateChunk> find_chunk(const CandidateSource& source, uint32_t first_face,
                                           uint32_t end_face, Level1& level1) {
    auto out = std::make_shared<CandidateChunk>();
    ChunkWalk walk;
    if (walk.walk(source, first_face, end_face, nullptr, *out)) return out;
    level1 = refine_around(source, first_face, end_face);
    walk.walk(source, first_face, end_face, &level1, *out);
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
