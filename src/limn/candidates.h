// The surfaces of a patch table before they have plans. Not part of the public interface.
//
// They come in chunks of faces. But for the numbers of vertices, what a chunk holds depends on its faces and
// on those that touch them: where a mesh changes, few chunks are made again.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "limn/neighborhood.h"
#include "limn/plan.h"

namespace limn {

/// A face of the base level or of level 1 that becomes a surface.
struct Candidate {
    uint32_t face;  ///< counted from the first face of its chunk, or from that one's first child
    uint32_t rotation : 2, refined : 1, ring_size : 29;
    uint32_t kind;  ///< which of its chunk's kinds it is
};

/// What the plan of a candidate comes from.
enum class PlanSource : uint8_t {
    regular,       ///< it has a regular ring (write_regular_ring)
    patch,         ///< it is one patch (find_patch, or that of a BaseQuad)
    star,          ///< it is irregular at a corner (BaseQuad)
    neighborhood,  ///< walk_around
};

/// Candidates are walked in chunks, each by one thread.
struct CandidateChunk {
    static constexpr uint32_t kFaceCount = 128;  ///< or fewer
    /// Candidates whose plans differ, by the first of each.
    struct Kind {
        std::array<uint64_t, 2> hash;
        uint32_t candidate;
        PlanSource source;
    };
    std::vector<Candidate> list;  ///< in face order
    std::vector<Kind> kinds;
    std::vector<uint32_t> rings;          ///< vertices of the candidates' levels, one ring after the other
    std::vector<const BuiltPlan*> plans;  ///< of kinds, once they are known
    uint32_t ptex_count = 0;
    bool splits = false;  ///< has candidates of level 1 (not Doo-Sabin, which has no others)
};

/// What comes before a chunk.
struct ChunkPlace {
    uint32_t first_ptex = 0, first_surface = 0;
    uint64_t first_ring = 0;
};

struct Candidates {
    std::vector<uint32_t> first_faces;  ///< chunk k has the faces [first_faces[k], first_faces[k + 1])
    std::vector<std::shared_ptr<CandidateChunk>>
        chunks;                      ///< shared by states of a mesh that is edited; then constant
    std::vector<ChunkPlace> places;  ///< of chunks, and a final total

    uint32_t chunk_count() const { return static_cast<uint32_t>(chunks.size()); }
};

/// What candidates are found in.
struct CandidateSource {
    const Topology& base;
    PlanOptions options;
    std::vector<uint8_t> regular;  ///< find_regular_vertices, unless options.linear or Doo-Sabin
    bool has_stars = false;        ///< faces of level 1 may be BaseQuads

    CandidateSource(const Topology& t, const PlanOptions& o, const BuildPart& part = {});
};

/// Level 1, where it is needed, of a mesh, or of some faces and those that touch them.
struct Level1 {
    Topology part;  ///< those faces; without any where they are all
    Topology child;
    std::vector<uint8_t> regular;    ///< find_regular_vertices, unless linear
    std::vector<uint32_t> vertices;  ///< of the whole level, that the child's are; empty where all are
    uint32_t first_face = 0;         ///< of the whole level, that the child's first is
};

/// The first child of face f, which may be the face count.
inline uint32_t first_child_face(const Topology& base, uint32_t f) {
    return base.options.scheme == Scheme::loop ? 4 * f : base.face_begin(f);
}
/// Vertices of level 1: of Doo-Sabin the corners of the base level, with their numbers.
inline uint32_t level1_vertex_count(const Topology& base) {
    if (base.options.scheme == Scheme::doo_sabin) return base.corner_count();
    return base.vertex_count + (base.options.scheme == Scheme::loop ? 0 : base.face_count) + base.edge_count;
}

/// Lists the surfaces, splits the mesh where not all are told by it (`level1` receives that), and walks around each.
/// Not to be used where `part` is cancelled.
Candidates find_candidates(const CandidateSource& source, Level1& level1, const BuildPart& part);

/// Makes one chunk again, splitting nothing but its faces and those that touch them.
std::shared_ptr<CandidateChunk> find_chunk(const CandidateSource& source, uint32_t first_face,
                                           uint32_t end_face, Level1& level1);

/// Fills in places.
void place_chunks(Candidates& candidates);

/// body(candidate, its number in the chunk, where its ring begins in the chunk's) for all of one chunk.
template <class Body>
void for_each_ring(const CandidateChunk& chunk, const Body& body) {
    uint32_t first = 0;
    for (uint32_t i = 0; i < chunk.list.size(); ++i) {
        body(chunk.list[i], i, first);
        first += chunk.list[i].ring_size;
    }
}

}  // namespace limn
