// Adaptive subdivision for schemes without patches: triangles and quads where the surface needs them, closed
// where faces of unlike levels meet, all vertices on the limit surface.
//
// The mesh is refined evenly, on the CPU, as deep as some face needs it; faces that are flat enough are then
// kept as they are. So a build costs what uniform refinement to that level does, while a frame evaluates one
// row for each vertex that is kept and nothing else. Limits do not depend on the level at which they are
// taken: each vertex has one row, from the level in which it appears, and all faces beside it share it.
#pragma once

#include "limn/schemes/scheme_surface.h"

namespace limn {

struct AdaptiveSurfaceOptions {
    /// By how much, in the units of the positions, a face may miss the limit positions of the points that
    /// would split it: edge points miss edges, face points the face as a fan of triangles. 0 and up.
    double tolerance = 0;
    uint32_t max_level = 6;  ///< steps of the scheme
    /// Where `tolerance` makes more, the least tolerance that does not takes its place.
    uint32_t max_triangles = kInvalidIndex / 3;
    BuildPart control = {};  ///< a BuildControl*, to cancel the build and to see its progress; may be null
};

template <class Real>
struct BasicAdaptiveSurface {
    uint32_t control_count = 0;
    /// Positions and two tangents of each vertex from the control points, as build_scheme_limit_table's.
    /// Indices ascend in each row.
    BasicStencilTable<Real> limit;
    /// The number that each vertex has in the uniform refinement (SchemeRefinement): ascending.
    Array<uint32_t> uniform_vertices;
    Array<uint32_t> face_offsets;   ///< face_count + 1
    Array<uint32_t> face_vertices;  ///< face_offsets.back() entries, each < limit.row_count()
    Array<uint8_t> face_levels;  ///< the level that each face is of, or has been cut from to meet finer ones
    Array<uint32_t> triangles;   ///< three vertices each: faces as fans around their first corner
    Array<uint32_t> edges;       ///< two control points for each edge of the control mesh
    uint32_t level = 0;          ///< the deepest level that faces are of
    double tolerance = 0;        ///< the one that holds: options.tolerance, or what max_triangles made of it
    bool reached = false;        ///< false where max_level left faces that nobody knows to be flat enough
};
using AdaptiveSurface = BasicAdaptiveSurface<float>;
using AdaptiveSurfaceDouble = BasicAdaptiveSurface<double>;

/// Whether a scheme can be refined adaptively: those that split faces in four, sqrt(3) and sqrt(2). Not those
/// whose vertices turn into faces (dual schemes and repeated averaging).
bool is_adaptive(const SubdivisionScheme& scheme);

/// `positions`: 3 * mesh.vertex_count, the pose for which the tolerance holds; other poses keep the mesh
/// closed. A face is split where it, or anything that would come of it, misses by more than the tolerance.
/// Each edge of the result has the same faces beside it, two or one, as what it descends from: nothing hangs.
/// Splits in four differ by one level at most across an edge. Quads that meet finer ones are cut into quads
/// where two midpoints hang on them, in a Y or side by side, and into triangles around their face point else;
/// triangles are bisected. Around face points (sqrt3, sqrt2) triangles fill what is split on one side of an
/// edge alone. Holes are left out.
///
/// Errors: unsupported (is_adaptive), invalid_argument (positions that are not three for each vertex, a
/// tolerance that is negative or no number), too_large (max_triangles is less than the control mesh has; more
/// than 2^31 - 1 face corners in some level), those of build_scheme_refinement and build_scheme_limit_table.
template <class Real>
Result<BasicAdaptiveSurface<Real>> build_adaptive_surface(const ControlMesh& mesh,
                                                          const SubdivisionScheme& scheme,
                                                          std::span<const double> positions,
                                                          const AdaptiveSurfaceOptions& options,
                                                          std::span<const double> intervals = {});

/// As what apply_scheme_surface and the device's SchemeEvaluator take: no chain, limits straight from control
/// points.
SchemeSurface make_scheme_surface(AdaptiveSurface&& surface);

}  // namespace limn
