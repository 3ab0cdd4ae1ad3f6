// Faces of a mesh grouped by what surrounds them: faces with equal neighbourhoods, or mirrored ones, have the same
// refined points up to the control points that they refer to. Not part of the public interface.
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "limn/face_block.h"
#include "limn/face_program.h"
#include "limn/parallel.h"

namespace limn {

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

/// Errors: too_large (count_levels), unsupported where rows would grow too long, cancelled.
Result<Job> make_job(const Refinement& refinement, const ComposeOptions& options);

/// Faces ordered by neighbourhood, and where each group starts.
struct Groups {
    std::vector<Member> members;
    std::vector<uint32_t> first;  ///< one more than groups
};

/// Errors: unsupported (rings of 2^16 points or more), cancelled.
Result<Groups> group_faces(const Job& job, const BuildPart& part);

/// The program of the targets over a group's face.
void write_member_program(const Job& job, const Member& member, Program& program);

/// The ring of a member as control points.
void find_member_ring(const Job& job, const Member& member, Neighborhood& hood);

/// body(target, vertex) for the targets over `member`, and whether its face owns that vertex. `vertices` is scratch.
template <class Body>
void for_each_target(const Job& job, const Member& member, std::vector<uint32_t>& vertices, const Body& body) {
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
    for (size_t i = 0; i < corners.size(); ++i) body(i, vertices[corners[i]], owns(i));
}

/// body(number, members, steps) for each group, groups in parallel; the steps are members.
template <class Body>
void for_each_group(const Groups& groups, const BuildPart& part, const Body& body) {
    BuildSteps steps(part, groups.members.size());
    for_each_index(
        static_cast<uint32_t>(groups.first.size() - 1),
        [&](uint32_t g) {
            if (steps.is_cancelled()) return;
            const uint32_t first = groups.first[g], count = groups.first[g + 1] - first;
            body(g, std::span<const Member>(groups.members.data() + first, count), steps);
        },
        1);
}

/// What writing the rows of one member takes, besides the shared rows.
struct MemberScratch {
    Neighborhood hood;
    std::vector<uint32_t> vertices;
};

/// body(member, scratch) for the members of one group, in parallel too: a group can be most of the mesh.
template <class Body>
void for_each_member(std::span<const Member> members, BuildSteps& steps, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, members.size(), 16), [&](const auto& range) {
        MemberScratch scratch;
        for (size_t i = range.begin(); i != range.end() && !steps.is_cancelled(); ++i)
            body(members[i], scratch);
        steps.add(range.size());
    });
}

/// Control points that no face uses keep their row: themselves.
template <class Body>
void for_each_loose_vertex(const Topology& base, const Body& body) {
    for (uint32_t v = 0; v < base.vertex_count; ++v)
        if (base.corners_of_vertex(v).empty()) body(v);
}

}  // namespace limn
