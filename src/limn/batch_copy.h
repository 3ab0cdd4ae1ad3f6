// A mesh's tables copied into larger ones, its numbers moved. Not part of the public interface.
#pragma once

#include "limn/batch.h"

namespace limn {

struct PlanIdentityHash {
    size_t operator()(const PlanIdentity& identity) const { return identity[0]; }
};

/// The number past the last of plan p's nodes, points or weights, which `first` is the first of.
template <class Real>
uint32_t end_of(const BasicPatchTable<Real>& table, uint32_t p, uint32_t Plan::*first, size_t size) {
    return p + 1 < table.plans.size() ? table.plans[p + 1].*first : static_cast<uint32_t>(size);
}

/// Node as it is where plan p is plan plan_numbers[p].
inline PlanNode moved_node(PlanNode node, const uint32_t* plan_numbers) {
    if (node.kind() == PlanNodeKind::plan)
        node.word = shared::pack_node(shared::kNodePlan, plan_numbers[node.plan()], node.rotation());
    return node;
}

/// Ring points of all surfaces together.
template <class Real>
uint64_t ring_point_count(const BasicPatchTable<Real>& table) {
    uint64_t count = 0;
    for (const Surface& s : table.surfaces) count += table.plans[s.plan()].ring_size;
    return count;
}

/// Surfaces and ptex faces, to the ranges `at`; rings begin at first_ring of `to`.
template <class Real>
void copy_surfaces(const BasicPatchTable<Real>& from, const uint32_t* plan_numbers, const PatchBatchMesh& at,
                   uint32_t first_ring, BasicPatchTable<Real>& to) {
    for (size_t i = 0; i < from.surfaces.size(); ++i) {
        const Surface& s = from.surfaces[i];
        to.surfaces[at.surfaces.first + i] = {shared::pack_surface(plan_numbers[s.plan()], s.rotation()),
                                              s.first_ring + first_ring};
    }
    for (size_t f = 0; f < from.ptex_surfaces.size(); ++f) {
        const uint32_t word = from.ptex_surfaces[f];
        to.ptex_surfaces[at.ptex_faces.first + f] =
            word == shared::kPtexHole ? word : word + at.surfaces.first;
    }
}

/// All of a mesh but its instances. Copies begin at words first_corner_copy and first_row_copy of theirs.
void copy_topology(const TessellationTable& from, const TessellationBatchMesh& at, uint32_t first_corner_copy,
                   uint32_t first_row_copy, TessellationTable& to);

}  // namespace limn
