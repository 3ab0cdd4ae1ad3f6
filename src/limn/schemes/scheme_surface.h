// The surface of any scheme as triangles: refined, moved to the limit, with normals. Tables are built once; a frame is a
// chain of them (apply_scheme_surface here, limn/vulkan/scheme_evaluator.h on a device).
#pragma once

#include "limn/schemes/scheme_refinement.h"

namespace limn {

struct SchemeSurfaceOptions {
    uint32_t level = 4;      ///< steps of the scheme
    BuildPart control = {};  ///< a BuildControl*, to cancel the build and to see its progress; may be null
};

struct SchemeSurface {
    uint32_t control_count = 0;
    uint32_t vertex_count = 0;         ///< rows of `limit`
    std::vector<StencilTable> tables;  ///< a chain: refined points from control points; may be empty
    StencilTable limit;                ///< positions and tangents of vertices from the points of the last table
    Array<uint32_t> face_offsets;      ///< faces of the last level, corner by corner: face_count + 1
    Array<uint32_t> face_vertices;     ///< face_offsets.back() entries, each < vertex_count
    Array<uint32_t> triangles;         ///< three vertices each: faces as fans around their first corner
    Array<uint32_t> edges;             ///< two control points for each edge of the control mesh
};

/// Errors: as build_scheme_refinement and build_scheme_limit_table.
Result<SchemeSurface> build_scheme_surface(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                           const SchemeSurfaceOptions& options,
                                           std::span<const double> intervals = {});

/// The steps after which an edge of the control mesh has `rate` segments at least: each step multiplies them by 2, sqrt(2)
/// or sqrt(3), whichever the scheme is.
uint32_t steps_for_rate(const SubdivisionScheme& scheme, double rate);

/// By how much one step multiplies the segments of an edge.
double segments_per_step(const SubdivisionScheme& scheme);

/// The table with one of its tangents' weights in place of its own; it refers to both arguments' arrays.
StencilTable with_weights(const StencilTable& table, const Array<float>& weights);

/// Unit normals along tangent1 x tangent2, 3 floats each; (0, 0, 1) where they span no plane.
std::vector<float> normals_of(std::span<const float> tangents1, std::span<const float> tangents2);

struct SchemeVertices {
    std::vector<float> positions;  ///< 3 * vertex_count
    std::vector<float> normals;    ///< 3 * vertex_count, unit; (0, 0, 1) where there is no tangent plane
};
/// On the CPU, in float. `points`: 3 * control_count.
SchemeVertices apply_scheme_surface(const SchemeSurface& surface, std::span<const float> points);

}  // namespace limn
