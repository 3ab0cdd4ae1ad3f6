#include "limn/schemes/doo_sabin_patches.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "limn/parallel.h"
#include "limn/plan_rows.h"
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn {
namespace {

using PlanRow = std::vector<double>;  ///< over a plan's ring
using Ring = std::vector<PlanRow>;    ///< rows of the points of a ring, this level's or a finer one's

/// Places in a ring of the points of the four faces at the surface's corners, in the order of those; each
/// counter-clockwise from the surface's point on.
struct RingFaces {
    std::array<std::vector<uint32_t>, 4> points;

    RingFaces(uint32_t near, uint32_t far) {
        for (uint32_t i = 0; i < near; ++i) points[0].push_back(i);
        points[1] = {0, near - 1, near + far - 1, near};
        points[2] = {0};
        for (uint32_t i = near; i < near + far - 1; ++i) points[2].push_back(i);
        points[3] = {0, near + far - 2, near + far, 1};
    }
};

/// A biquadratic patch over points in rows of 3, as a bicubic one: the cubic control points of a quadratic
/// polynomial.
constexpr double kElevation[4][3] = {{11.0 / 6, -7.0 / 6, 2.0 / 6},
                                     {2.0 / 6, 5.0 / 6, -1.0 / 6},
                                     {-1.0 / 6, 5.0 / 6, 2.0 / 6},
                                     {2.0 / 6, -7.0 / 6, 11.0 / 6}};

class PlanWriter {
  public:
    PlanWriter(BuiltPlan& plan, uint32_t depth) : plan_(plan), depth_(depth) { rows_.begin(plan); }

    void write(uint32_t near, uint32_t far) {
        Ring ring(plan_.ring_size, PlanRow(plan_.ring_size, 0.0));
        for (uint32_t i = 0; i < plan_.ring_size; ++i) ring[i][i] = 1;
        if (near != 4 && far == 4) write_corner_rows(near);
        plan_.nodes.resize(1);
        if (near == 4)
            write_patch(0, {ring[2], ring[3], ring[7], ring[1], ring[0], ring[4], ring[8], ring[6], ring[5]});
        else
            split(0, near, far, ring, 1);
        rows_.end();
    }

  private:
    /// The centroid of the near face, and tangents towards the middles of the surface's edges there.
    void write_corner_rows(uint32_t n) {
        PlanRow limit(plan_.ring_size, 0.0), tangents[2] = {limit, limit};
        const double half = std::numbers::pi / n;
        for (uint32_t j = 0; j < n; ++j) {
            limit[j] = 1.0 / n;
            tangents[0][j] = std::cos((2 * j + 1) * half);
            tangents[1][j] = std::cos((2.0 * j - 1) * half);
        }
        for (const PlanRow& row : {limit, tangents[0], tangents[1]}) rows_.append(row.data());
        plan_.has_corner_rows = true;
    }

    void begin_node(uint32_t node, PlanNodeKind kind, uint32_t reference, uint32_t rotation) {
        plan_.nodes[node] = {shared::pack_node(static_cast<uint32_t>(kind), reference, rotation),
                             static_cast<uint32_t>(plan_.points.size())};
    }
    void write_patch(uint32_t node, const std::array<PlanRow, 9>& points) {
        begin_node(node, PlanNodeKind::bicubic, 0, 0);
        for (const auto& v : kElevation)
            for (const auto& u : kElevation) {
                PlanRow row(plan_.ring_size, 0.0);
                for (uint32_t k = 0; k < 9; ++k)
                    for (uint32_t j = 0; j < row.size(); ++j) row[j] += v[k / 3] * u[k % 3] * points[k][j];
                plan_.points.push_back(rows_.write(row.data()));
            }
    }
    void write_reference(uint32_t node, uint32_t reference, uint32_t rotation, Ring& ring) {
        begin_node(node, PlanNodeKind::plan, reference, rotation);
        for (PlanRow& row : ring) plan_.points.push_back(rows_.write(row.data()));
    }

    /// The point that corner i of face k becomes.
    PlanRow refined_point(const RingFaces& faces, const Ring& ring, uint32_t k, uint32_t i) const {
        const std::vector<uint32_t>& face = faces.points[k];
        const auto n = static_cast<uint32_t>(face.size());
        PlanRow row(plan_.ring_size, 0.0);
        for (uint32_t j = 0; j < n; ++j) {
            const double weight = schemes::doo_sabin_weight(n, j);
            const PlanRow& from = ring[face[(i + j) % n]];
            for (uint32_t s = 0; s < row.size(); ++s) row[s] += weight * from[s];
        }
        return row;
    }
    /// The ring of the quarter at face k, which is the near face of it.
    Ring refined_ring(const RingFaces& faces, const Ring& ring, uint32_t k) const {
        Ring out;
        for (uint32_t i = 0; i < faces.points[k].size(); ++i) out.push_back(refined_point(faces, ring, k, i));
        for (uint32_t i = 1; i < 4; ++i) out.push_back(refined_point(faces, ring, (k + i) % 4, 0));
        out.push_back(refined_point(faces, ring, (k + 1) % 4, 1));
        out.push_back(refined_point(faces, ring, (k + 3) % 4, 3));
        return out;
    }
    /// The patch of the quarter at face k, where that is a quad.
    std::array<PlanRow, 9> refined_patch(const RingFaces& faces, const Ring& ring, uint32_t k) const {
        struct Corner {
            uint32_t face, corner;
        };
        const auto near_last = static_cast<uint32_t>(faces.points[0].size()) - 1,
                   far_last = static_cast<uint32_t>(faces.points[2].size()) - 1;
        // The first and the last are those of quads only.
        const Corner grid[4][4] = {{{0, 2}, {0, near_last}, {1, 1}, {1, 2}},
                                   {{0, 1}, {0, 0}, {1, 0}, {1, 3}},
                                   {{3, 3}, {3, 0}, {2, 0}, {2, 1}},
                                   {{3, 2}, {3, 1}, {2, far_last}, {2, 2}}};
        const uint32_t u0 = k == 1 || k == 2, v0 = k >= 2;
        std::array<PlanRow, 9> out;
        for (uint32_t i = 0; i < 9; ++i) {
            const Corner& at = grid[v0 + i / 3][u0 + i % 3];
            out[i] = refined_point(faces, ring, at.face, at.corner);
        }
        return out;
    }
    /// `level`: of the quarters.
    void split(uint32_t node, uint32_t near, uint32_t far, const Ring& ring, uint32_t level) {
        const RingFaces faces(near, far);
        const auto first = static_cast<uint32_t>(plan_.nodes.size());
        plan_.nodes.resize(first + 4);
        plan_.nodes[node] = {shared::pack_node(static_cast<uint32_t>(PlanNodeKind::split), 0, 0), first};
        for (uint32_t k = 0; k < 4; ++k) {
            if (faces.points[k].size() == 4) {
                write_patch(first + k, refined_patch(faces, ring, k));
                continue;
            }
            Ring next = refined_ring(faces, ring, k);
            if (far == 4 && level < depth_)
                split(first + k, near, 4, next, level + 1);
            else
                write_reference(first + k, k / 2, k, next);
        }
    }

    BuiltPlan& plan_;
    uint32_t depth_;
    PlanRows rows_;
};

/// The mutex is held.
const BuiltPlan* find_or_build(uint32_t near, uint32_t far, uint32_t depth, PlanCache::Impl& cache) {
    PlanKey key = begin_plan_key({.scheme = Scheme::doo_sabin}, {false, EndCap::exact, depth});
    key.insert(key.end(), {near, far});
    if (const auto at = cache.plans.find(key); at != cache.plans.end()) return at->second.get();
    auto built = std::make_unique<BuiltPlan>();
    built->identity = hash_signature(key);
    built->ring_size = near + far + 1;
    PlanWriter(*built, depth).write(near, far);
    BuiltPlan* const plan = cache.keep(key, std::move(built)).first;
    if (far != 4)
        plan->references = {find_or_build(near, 4, depth, cache), find_or_build(far, 4, depth, cache)};
    else if (near != 4)
        plan->references = {plan};
    return plan;
}

Error refuse(uint32_t vertex, const std::string& cause) {
    return Error{ErrorCode::unsupported,
                 "Doo-Sabin patches take " + cause + ": vertex " + std::to_string(vertex), vertex};
}

/// Around faces that are drawn; what the others are like does not matter.
Result<void> check_vertices(const Topology& t) {
    for (uint32_t c = 0; c < t.corner_count(); ++c) {
        const uint32_t f = t.face_of_corner(c), v = t.face_vertices[c];
        if (t.face_holes[f] != 0) continue;
        if (t.vertex_manifold[v] == 0) return refuse(v, "vertices with one fan of faces, wound one way");
        if (is_boundary_vertex(t, v))
            return refuse(v, "no boundaries (boundary interpolation none leaves out the faces there)");
        if (face_valence(t, v) < 3) return refuse(v, "vertices of three faces or more");
        if (uint64_t{t.size_of_face(f)} + face_valence(t, v) >= kMaxRingSize)
            return refuse(v, "faces and vertices that have less than " + std::to_string(kMaxRingSize) +
                                 " corners together");
    }
    return {};
}

/// Lists the surfaces of some faces.
class ChunkWriter {
  public:
    ChunkWriter(const Topology& base, uint32_t first_face, CandidateChunk& out)
        : t_(base), first_corner_(base.face_begin(first_face)), out_(out) {}

    void add_face(uint32_t f) {
        const uint32_t size = t_.size_of_face(f), begin = t_.face_begin(f);
        out_.ptex_count += size == 4 ? 1 : size;
        for (uint32_t j = 0; t_.face_holes[f] == 0 && j < size; ++j) add_corner(begin + j, size == 4 ? j : 0);
    }

  private:
    /// `place`: of the vertex among the corners of the surface, as its ptex face has them.
    void add_corner(uint32_t c, uint32_t place) {
        around_vertex_.assign(1, c);
        for (uint32_t at = next_around(c); at != c; at = next_around(at)) around_vertex_.push_back(at);
        around_face_.assign(1, c);
        for (uint32_t at = t_.next_corner(c); at != c; at = t_.next_corner(at)) around_face_.push_back(at);
        uint32_t opposite[2] = {opposite_corner(t_, c), t_.next_corner(next_around(c))};
        const bool turned = around_vertex_.size() == 4 && around_face_.size() != 4;
        if (turned) {
            std::swap(around_vertex_, around_face_);
            std::swap(opposite[0], opposite[1]);
        }
        std::vector<uint32_t>& rings = out_.rings;
        rings.insert(rings.end(), around_vertex_.begin(), around_vertex_.end());
        rings.insert(rings.end(), around_face_.begin() + 1, around_face_.end());
        rings.insert(rings.end(), {opposite[0], opposite[1]});
        const auto near = static_cast<uint32_t>(around_vertex_.size()),
                   far = static_cast<uint32_t>(around_face_.size());
        const uint32_t kind = find_kind(near, far, static_cast<uint32_t>(out_.list.size()));
        out_.list.push_back(
            {c - first_corner_, (turned ? 2 : place) & 3, 1, (near + far + 1) & 0x1fffffff, kind});
    }
    /// The corner at the same vertex, counter-clockwise.
    uint32_t next_around(uint32_t c) const { return opposite_corner(t_, t_.previous_corner(c)); }

    /// Here the hash says it all: the sizes of both faces.
    uint32_t find_kind(uint32_t near, uint32_t far, uint32_t candidate) {
        const std::array<uint64_t, 2> sizes = {near, far};
        uint32_t at = 0;
        while (at < out_.kinds.size() && out_.kinds[at].hash != sizes) ++at;
        if (at == out_.kinds.size()) out_.kinds.push_back({sizes, candidate, PlanSource::neighborhood});
        return at;
    }

    const Topology& t_;
    const uint32_t first_corner_;
    CandidateChunk& out_;
    std::vector<uint32_t> around_vertex_, around_face_;
};

}  // namespace

const BuiltPlan* find_doo_sabin_plan(uint32_t near, uint32_t far, uint32_t depth, PlanCache::Impl& cache) {
    const std::lock_guard lock(cache.mutex);
    return find_or_build(near, far, depth, cache);
}

Result<Candidates> find_doo_sabin_candidates(const Topology& base, const PlanOptions& options,
                                             PlanCache::Impl& cache, const BuildPart& part) {
    if (auto ok = check_vertices(base); !ok) return ok.error();
    Candidates out;
    for (uint32_t f = 0; f < base.face_count; f += CandidateChunk::kFaceCount) out.first_faces.push_back(f);
    out.chunks.resize(out.first_faces.size());
    out.first_faces.push_back(base.face_count);
    for_each_index(
        out.chunk_count(), part.part(0, 0.8f),
        [&](uint32_t k) {
            out.chunks[k] = std::make_shared<CandidateChunk>();
            ChunkWriter writer(base, out.first_faces[k], *out.chunks[k]);
            for (uint32_t f = out.first_faces[k]; f < out.first_faces[k + 1]; ++f) writer.add_face(f);
        },
        1);
    for (const auto& chunk : out.chunks) {
        if (auto ok = part.check(); !ok) return ok.error();
        for (const CandidateChunk::Kind& kind : chunk->kinds)
            chunk->plans.push_back(find_doo_sabin_plan(static_cast<uint32_t>(kind.hash[0]),
                                                       static_cast<uint32_t>(kind.hash[1]), options.depth,
                                                       cache));
    }
    return out;
}

}  // namespace limn
