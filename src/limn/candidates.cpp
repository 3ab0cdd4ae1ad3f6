#include "limn/candidates.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "limn/parallel.h"
#include "limn/patch_points.h"
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

/// Faces of the base level that are surfaces as they are.
std::vector<uint8_t> find_whole_faces(const Candidates& c, const BuildPart& part) {
    const Topology& base = c.base;
    std::vector<uint8_t> whole(base.face_count);
    for_each_index(
        base.face_count, part,
        [&](uint32_t f) {
            auto is_patch = [&] {
                PatchPoints patch;
                return find_patch_points(base, f, c.options.linear, patch) &&
                       (patch.crease_sharpness == 0 || c.options.end_cap == EndCap::exact);
            };
            whole[f] = base.face_holes[f] == 0 &&
                       (is_regular_face(base, f, c.options.linear, c.regular_base) || is_patch());
        },
        64);
    return whole;
}

/// Surfaces in face order, and the ptex faces that they cover.
void list_surfaces(const std::vector<uint8_t>& whole, Candidates& out, const BuildPart& part) {
    const Topology& base = out.base;
    const bool triangles = base.options.scheme == Scheme::loop;
    const uint32_t own_size = triangles ? 3 : 4;
    uint64_t ptex_total = 0, total = 0;
    for_each_in_order(base.face_count, part.part(0, 0.3f), [&](uint32_t f) {
        const uint32_t size = base.size_of_face(f);
        ptex_total += size == own_size ? 1 : size;
        if (base.face_holes[f] == 0) total += whole[f] != 0 ? 1 : triangles ? 4 : size;
    });
    out.list.reserve(total);
    out.ptex_surfaces.allocate(ptex_total);
    uint32_t* ptex = out.ptex_surfaces.begin();
    for_each_in_order(base.face_count, part.part(0.3f, 1), [&](uint32_t f) {
        const uint32_t size = base.size_of_face(f), ptex_count = size == own_size ? 1 : size;
        const auto next = static_cast<uint32_t>(out.list.size());
        if (base.face_holes[f] != 0) {
            ptex = std::fill_n(ptex, ptex_count, shared::kPtexHole);
        } else if (whole[f] != 0) {
            out.list.push_back({f, 0, 0, 0, 0});
            *ptex++ = next;
        } else {
            const uint32_t first = triangles ? 4 * f : base.face_begin(f), count = triangles ? 4 : size;
            for (uint32_t j = 0; j < count; ++j) out.list.push_back({first + j, 0, 1, 0, 0});
            if (ptex_count == 1)
                *ptex++ = next | shared::kPtexSplit;
            else
                for (uint32_t j = 0; j < size; ++j) *ptex++ = next + j;
        }
    });
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
    void walk(Candidates& c, size_t chunk) {
        out_ = &c.chunks[chunk];
        first_ = static_cast<uint32_t>(chunk * CandidateChunk::kSize);
        out_->rings.reserve(CandidateChunk::kSize * 18);
        slots_.fill(kInvalidIndex);
        const size_t end = std::min(c.list.size(), first_ + CandidateChunk::kSize);
        for (uint32_t i = first_; i < end; ++i) {
            const size_t ring = out_->rings.size();
            Candidate& at = c.list[i];
            if (is_regular_face(c.level(at), at.face, c.options.linear, c.regular_vertices(at)))
                add_regular(c, at, i);
            else
                add_irregular(c, at, i);
            at.ring_size = static_cast<uint32_t>(out_->rings.size() - ring) & 0x1fffffff;
        }
    }

  private:
    void add_regular(const Candidates& c, Candidate& at, uint32_t i) {
        uint32_t ring[16];
        const uint32_t size = write_regular_ring(c.level(at), at.face, c.options.linear, ring);
        // Each quad child from the corner of its parent: grids then sample all four alike.
        if (at.refined != 0 && c.child.face_size == 4 && size == 16)
            at.rotation = place_in_parent(c.base, at.face) & 3;
        for (uint32_t k = 0; k < at.rotation; ++k) rotate_bicubic_ring(ring);
        out_->rings.insert(out_->rings.end(), ring, ring + size);
        at.kind = find_kind({0, 0}, i, true);
    }
    void add_irregular(const Candidates& c, Candidate& at, uint32_t i) {
        const Topology& t = c.level(at);
        const std::vector<uint8_t>& regular = c.regular_vertices(at);
        at.rotation = choose_plan_corner(t, at.face, c.options.linear ? nullptr : &regular) & 3;
        std::array<uint64_t, 2> hash;
        if (c.options.linear || !walk_around_fans(t, at.face, at.rotation, regular, hood_, hash)) {
            WalkOptions options{t};
            options.list_faces = false;
            walk_around(options, at.face, {at.rotation, false}, hood_);
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

    CandidateChunk* out_ = nullptr;
    uint32_t first_ = 0;
    Neighborhood hood_;
    std::array<uint32_t, 2 * CandidateChunk::kSize> slots_;  ///< kinds by hash, kInvalidIndex where free
};

}  // namespace

Candidates find_candidates(const Topology& base, const PlanOptions& options, const BuildPart& part) {
    Candidates out{base, options, {}, 0, {}, {}, {}, {}, {}};
    if (!options.linear) out.regular_base = find_regular_vertices(base, part.part(0, 0.02f));
    const std::vector<uint8_t> whole = find_whole_faces(out, part.part(0.02f, 0.2f));
    if (std::find(whole.begin(), whole.end(), 0) != whole.end()) {
        refine_once(base, true, out.child, part.part(0.2f, 0.4f));
        out.child_vertex_count = out.child.vertex_count;
        if (!options.linear) out.regular_child = find_regular_vertices(out.child, part.part(0.4f, 0.45f));
    }
    list_surfaces(whole, out, part.part(0.45f, 0.5f));
    out.chunks.resize((out.list.size() + CandidateChunk::kSize - 1) / CandidateChunk::kSize);
    tbb::enumerable_thread_specific<ChunkWalk> walks;
    for_each_index(
        static_cast<uint32_t>(out.chunks.size()), part.part(0.5f, 1),
        [&](uint32_t chunk) { walks.local().walk(out, chunk); }, 1);
    return out;
}

}  // namespace limn
