// Limit points and tangents of any scheme: left eigenvectors of its own subdivision matrices, no tables made by hand.
#pragma once

#include "limn/schemes/scheme_refinement.h"

namespace limn {

/// The limit positions of the vertices of the last level and, when asked for, two tangents each, from the points of
/// that level: row r is vertex r, source_count is the vertex count. A device evaluates it behind refined.tables.
/// `refined` was built with full_last_level, from a mesh and with boundary rules of any kind.
///
/// A vertex goes to the limit of what becomes of it step after step: of a primal scheme the vertex itself; of a dual
/// one the face that it turns into. Where boundary vertices turn into faces (dual schemes, repeated averaging) their
/// limits lie off the boundary. A vertex that turns into nothing (boundaries that shrink) takes the limit of the middle
/// one of its faces.
///
/// Exact for all sharpness and near irregular vertices, too: neighbourhoods are refined until they repeat, then the
/// eigenvectors hold (build_limit_table's limits, not build_limit_step_table's, where sharpness is finite).
///
/// tangent1 x tangent2 points along the normal (faces are counter-clockwise seen from outside); lengths carry no
/// meaning. At boundaries and infinitely sharp creases tangent1 runs along them, tangents are those of one side; at
/// corners they run along two of its sharp edges. Where a scheme has no tangent plane (bilinear and linear
/// interpolation; valences at which the scheme is not C1) they are two edges of a face, after refinement.
///
/// Weights are computed in double, in parallel; the result does not depend on the number of cores. Rows sum to one,
/// tangents to zero, within 1e-12. `control` is a BuildControl*, to cancel the build and to see its progress; may be
/// null. Errors: invalid_argument (no full last level), unsupported (more than some 300 faces around one vertex, or
/// knot intervals that never repeat; Error::element is the vertex), too_large past 2^32 - 1 entries, cancelled.
template <class Real>
Result<BasicStencilTable<Real>> build_scheme_limit_table(const BasicSchemeRefinement<Real>& refined, bool tangents,
                                                         const BuildPart& control = {});

}  // namespace limn
