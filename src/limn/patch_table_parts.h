// What patch tables are put together from, in steps that builds and edits share. Not part of the public
// interface.
#pragma once

#include <functional>

#include "limn/candidates.h"
#include "limn/plan_set.h"
#include "limn/refined_points.h"

namespace limn {

template <class Real>
struct PatchTableParts {
    Candidates candidates;
    RefinedPoints<Real> points;
    std::vector<const BuiltPlan*>
        plans;  ///< in the order in which surfaces, and then those plans themselves, need them
    std::vector<uint32_t> plan_numbers;  ///< of chunks' kinds, chunk after chunk
};

/// Errors: invalid_argument (plan_depth, isolation_level).
Result<void> check_options(const PatchTableOptions& options);
/// What such options ask of the plans of a base of this scheme.
PlanOptions plan_options(const SchemeOptions& scheme, const PatchTableOptions& options);

/// Finds the plans of chunks that have none yet, or builds them. `level1_of(k)`: level 1 around such a chunk.
/// Errors: as PlanSet.
Result<void> find_plans(const CandidateSource& source,
                        const std::function<const Level1&(uint32_t)>& level1_of, PlanCache::Impl& cache,
                        Candidates& candidates, const BuildPart& part);

/// Nothing but 0 and 1: whether surfaces need each vertex of level 1.
std::vector<uint32_t> find_used_children(const Topology& base, const Candidates& candidates,
                                         const BuildPart& part);

/// Once plans are known, all that can fail is done here: places and numbers of everything. `uses` and
/// `control_indices` as make_point_rows; points.control_count and first_children are known. Errors:
/// too_large, cancelled.
template <class Real>
Result<void> place_parts(const CandidateSource& source, const Array<uint32_t>& control_indices,
                         const std::vector<uint32_t>& uses, PatchTableParts<Real>& parts,
                         const BuildPart& part);

/// Writes the table. `before`, if not null: what it has been written from; parts shared with that are not
/// written again where they stay in place.
template <class Real>
void write_patch_table(const CandidateSource& source, const Array<uint32_t>& control_indices,
                       PatchTableParts<Real>& parts, const PatchTableParts<Real>* before,
                       BasicPatchTable<Real>& table, const BuildPart& part);

}  // namespace limn
