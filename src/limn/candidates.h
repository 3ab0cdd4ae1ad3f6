// The surfaces of a patch table before they have plans. Not part of the public interface.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "limn/neighborhood.h"
#include "limn/plan.h"

namespace limn {

/// A face of the base level or of level 1 that becomes a surface.
struct Candidate {
    uint32_t face;
    uint32_t rotation : 2, refined : 1, ring_size : 29;
    uint32_t kind;  ///< which of its chunk's kinds it is
};

/// Candidates are walked in chunks, each by one thread.
struct CandidateChunk {
    static constexpr size_t kSize = 256;
    /// Candidates whose plans differ, by the first of each.
    struct Kind {
        std::array<uint64_t, 2> hash;
        uint32_t candidate;
        bool regular;  ///< has a regular ring (write_regular_ring)
    };
    std::vector<Kind> kinds;
    std::vector<uint32_t> rings;  ///< vertices of the candidates' levels, one ring after the other
};

struct Candidates {
    const Topology& base;
    PlanOptions options;
    Topology child;  ///< level 1; empty where every face is regular; walks alone need it
    uint32_t child_vertex_count = 0;
    std::vector<uint8_t> regular_base, regular_child;  ///< find_regular_vertices, unless options.linear
    std::vector<Candidate> list;                       ///< in face order
    std::vector<CandidateChunk> chunks;
    Array<uint32_t> ptex_surfaces;  ///< as BasicPatchTable has them

    const Topology& level(const Candidate& c) const { return c.refined != 0 ? child : base; }
    const std::vector<uint8_t>& regular_vertices(const Candidate& c) const {
        return c.refined != 0 ? regular_child : regular_base;
    }
    std::span<const Candidate> of_chunk(size_t chunk) const {
        const size_t begin = chunk * CandidateChunk::kSize;
        return std::span(list).subspan(begin, std::min(CandidateChunk::kSize, list.size() - begin));
    }
};

/// Lists the surfaces, splits the mesh where they need it, and walks around each. Not to be used where
/// `part` is cancelled.
Candidates find_candidates(const Topology& base, const PlanOptions& options, const BuildPart& part);

}  // namespace limn
