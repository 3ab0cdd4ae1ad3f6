// B-spline and NURBS surfaces as control meshes of subdivision surfaces, and back, exactly.
//
// A surface whose knots are evenly spaced is what its grid of control points is the control mesh of: of
// degree 3 Catmull and Clark's, of degree 2 Doo and Sabin's. Such knots can be given, in each direction, to
// surfaces
// - whose intervals between begin() and end() are whole multiples of one length, with simple knots between:
//   knots are inserted until all intervals are equal;
// - whatever their ends are, clamped, Bezier or floating: control points are those of the first and the last
//   polynomial, continued beyond the ends (blossoms), and the outermost faces are no part of the surface;
// - of lower degree than the mesh's, where there is one interval only: the degree is raised;
// - that are closed, the last polynomial being continued by the first: the mesh is closed, too.
//
// Surfaces with knots of full multiplicity come in parts (split_at_full_knots), which are Bezier patches
// where all knots are such: circles, cones, spheres and tori. What cannot be converted: intervals without a
// common measure; knots that are there more than once and yet not fully, as fewer derivatives are continuous
// there than of the subdivision surface; higher degrees. Rational surfaces are no different: components are
// homogeneous, divided after evaluation.
#pragma once

#include "limn/control_mesh.h"
#include "limn/evaluate.h"
#include "limn/schemes/b_spline_surface.h"

namespace limn {

struct SplineMeshOptions {
    uint32_t degree = 3;            ///< 3: Catmull-Clark, 2: Doo-Sabin
    uint32_t max_intervals = 4096;  ///< in each direction, after knots have been inserted
    double tolerance = 1e-12;  ///< of intervals, relative; of points where it closes, relative to the largest
};

/// A control mesh of quads in rows: vertex (i, j) is i + j * u_count, face (i, j), i < u_face_count(), is
/// i + j * u_face_count(), and its vertices are (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1), modulo the
/// counts where it is closed. ptex faces are faces.
struct SplineMesh {
    uint32_t degree = 3;
    uint32_t u_count = 0, v_count = 0;  ///< vertices
    bool u_closed = false, v_closed = false;
    std::vector<uint32_t> face_sizes;  ///< all 4
    std::vector<uint32_t> face_vertices;
    /// Vertices from the surface's control points: for devices (round_weights), too, where those move every
    /// frame.
    StencilTableDouble vertices;
    KnotVector u, v;  ///< of the same surface, evenly spaced

    uint32_t u_face_count() const { return u_count - (u_closed ? 0 : 1); }
    uint32_t v_face_count() const { return v_count - (v_closed ? 0 : 1); }
    /// The spans are those of this mesh, which must outlive it. Of degree 3: Catmull-Clark with
    /// BoundaryInterpolation::none.
    ControlMeshDescription description() const;
};

/// Errors: as check_surface and multiply_directions; invalid_argument (options); unsupported (what cannot be
/// converted, see above; more than max_intervals).
Result<SplineMesh> build_spline_mesh(const BSplineSurface& surface, const SplineMeshOptions& options = {});

/// The same rows with weights as devices take them.
StencilTable round_weights(const StencilTableDouble& table);

/// Where the surface's parameters (u, v) are on a mesh of degree 3: at a sample of evaluate_patches and of
/// devices. Derivatives there are by units of a face: those of the surface times the distance of knots, in u
/// and v each.
PatchSample locate_on_spline_mesh(const SplineMesh& mesh, double u, double v);

/// The bicubic surface that Catmull-Clark subdivision gives a control mesh of quads in rows, numbered as
/// SplineMesh or in any other way: knots 1 apart, the surface over all faces that are part of it. `points`
/// holds `width` numbers for each vertex. Exact with BoundaryInterpolation::none; with edge_and_corner, where
/// control points beyond the boundary are made (P[-1] = 2 P[0] - P[1]); with edge_only of a mesh without
/// corners, open in one direction at most. u goes along the first edge of the first face that is at a corner
/// or, where there is none, a boundary. Errors: unsupported (another scheme; faces that are no quads in rows;
/// creases, corners, holes; edge_only with corners, whose surface is none of this kind); invalid_argument
/// (the length of points).
Result<BSplineSurface> build_b_spline_surface(const ControlMesh& mesh, std::span<const double> points,
                                              uint32_t width);

}  // namespace limn
