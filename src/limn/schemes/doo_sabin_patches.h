// Doo-Sabin surfaces as patch tables know them: what they lie over, and their plans. Not part of the public
// interface.
//
// A point of level 1 is a corner of a face of the base level. Four faces of level 1 meet there: what its
// vertex, its face and the two edges between these have become, the latter quads. Centroids of faces are
// limit points at all levels: those four bound the surface of that corner, in the place that Catmull-Clark's
// has. It depends on nothing but the points of the four faces. Where those are quads it is one biquadratic
// patch; else steps of the scheme leave a quarter of it, next to the face that is none, as it was: a plan
// refers to itself.
#pragma once

#include "limn/candidates.h"
#include "limn/plan_set.h"

namespace limn {

/// The plan of surfaces between a face of `near` corners, which is at corner 0, and one of `far`; one of 4,
/// if only one is that, is the far one. Its ring: the surface's point; the other points of the near face
/// counter-clockwise; those of the far one; of each quad between, after the near face and after the far one,
/// the point opposite. In all near + far + 1. Taken from the cache or built; `depth` as PlanOptions::depth.
/// Thread-safe.
const BuiltPlan* find_doo_sabin_plan(uint32_t near, uint32_t far, uint32_t depth, PlanCache::Impl& cache);

/// The surfaces of a mesh, a corner of a face each, with their rings and plans. Errors: unsupported
/// (Error::element is a vertex: of a face that is drawn, on a boundary, with more than one fan of faces, or
/// with two faces; too many points in a ring), cancelled.
Result<Candidates> find_doo_sabin_candidates(const Topology& base, const PlanOptions& options,
                                             PlanCache::Impl& cache, const BuildPart& part);

}  // namespace limn
