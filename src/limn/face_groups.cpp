#include "limn/face_groups.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace limn {
namespace {

const Error kTooWide{ErrorCode::unsupported,
                     "too many faces meet around one face for a table over the control points: chain step tables"};

/// Composed rows grow with the square of a valence; past this many faces around one face they are not worth
/// having, and walks around faces would take that square of time, too.
bool is_walkable(const Topology& t, const BuildPart& part) {
    constexpr size_t kMaxFacesAround = 16384;
    bool walkable = true;
    for_each_in_order(t.face_count, part, [&](uint32_t f) {
        size_t faces = 0;
        for (const uint32_t v : t.vertices_of_face(f)) faces += t.corners_of_vertex(v).size();
        if (faces > kMaxFacesAround) walkable = false;
    });
    return walkable;
}

}  // namespace

Result<Job> make_job(const Refinement& refinement, const ComposeOptions& options) {
    Result<std::vector<LevelCounts>> counts = count_levels(refinement.levels[0], options.level);
    if (!counts) return counts.error();
    Job job{refinement, options, std::move(*counts), {}};
    const Topology& base = job.base();
    const BuildPart& part = options.control;
    if (!is_walkable(base, part) || (job.uncut() != nullptr && !is_walkable(*job.uncut(), part))) return kTooWide;
    for_each_in_order(base.face_size != 0 ? 1 : base.face_count, part, [&](uint32_t f) {
        const uint32_t n = base.size_of_face(f);
        if (job.blocks.count(n) == 0) job.blocks.emplace(n, build_block(base.options, n, options.level));
    });
    if (auto ok = part.check(); !ok) return ok.error();
    return job;
}

Result<Groups> group_faces(const Job& job, const BuildPart& part) {
    const Topology& base = job.base();
    Groups groups;
    groups.members.resize(base.face_count);
    std::atomic<size_t> largest_ring{0};
    for_each_block(base.face_count, part.part(0, 0.9f), 256, [&](uint32_t begin, uint32_t end) {
        Neighborhood hood;
        size_t largest = 0;
        for (uint32_t f = begin; f != end; ++f) {
            groups.members[f].face = f;
            groups.members[f].orientation = choose_orientation(job.walk(), f, hood, groups.members[f].hash);
            largest = std::max(largest, hood.ring.size());
        }
        for (size_t seen = largest_ring;
             seen < largest && !largest_ring.compare_exchange_weak(seen, largest);) {
        }
    });
    if (auto ok = part.check(); !ok) return ok.error();
    if (largest_ring > std::numeric_limits<uint16_t>::max()) return kTooWide;
    sort_items(groups.members, part.part(0.9f, 1), [](const Member& a, const Member& b) {
        return a.hash != b.hash ? a.hash < b.hash : a.face < b.face;
    });
    if (auto ok = part.check(); !ok) return ok.error();
    for (uint32_t i = 0; i < base.face_count; ++i)
        if (i == 0 || groups.members[i].hash != groups.members[i - 1].hash) groups.first.push_back(i);
    groups.first.push_back(base.face_count);
    return groups;
}

void write_member_program(const Job& job, const Member& member, Program& program) {
    const std::vector<uint32_t>& targets = job.block(member.face).corners(member.orientation);
    write_program(job.walk(), member.face, member.orientation, targets, job.options, program);
}

void find_member_ring(const Job& job, const Member& member, Neighborhood& hood) {
    walk_around(job.walk(), member.face, member.orientation, hood);
    const Array<uint32_t>& map = job.refinement.control_indices;
    if (!map.empty())
        for (uint32_t& point : hood.ring) point = map[point];
}

}  // namespace limn
