// B-spline and NURBS surfaces as control meshes of subdivision surfaces, and back, exactly.
//
// A surface whose knots are evenly spaced is what its grid of control points is the control mesh of: of
// degree 3 Catmull and Clark's, of degree 2 Doo and Sabin's. Which surfaces can be given such knots without
// changing them, in each direction:
// - those whose intervals between begin() and end() are whole multiples of one length: knots are inserted
// until all are equal;
// - whatever their ends are: clamped, Bezier, or floating. Control points are those of the first and last
// polynomial,
//   continued beyond the ends (blossoms), and the outermost faces of the mesh are no part of the surface;
// - of lower degree than the mesh's, those of a single interval: the degree is raised. So are the parts of
// surfaces with
//   knots of full multiplicity (split_at_full_knots), which are Bezier patches: those of circles, cones,
//   spheres and tori.
// - closed ones, where the first and last polynomials continue each other: the mesh is closed, too.
// Which cannot: those with a knot inside that is there more than once (fewer derivatives are continuous there
// than of any subdivision surface, or none, and then there are parts), and those whose intervals have no
// common measure. Nor those of higher degree. Rational surfaces are no different: components are homogeneous,
// divided after evaluation.
#pragma once

#include "limn/control_mesh.h"
#include "limn/evaluate.h"
#include "limn/schemes/b_spline_surface.h"

namespace limn {

struct SplineMeshOptions {
    uint32_t degree = 3;            ///< 3: Catmull-Clark, 2: Doo-Sabin
    uint32_t max_intervals = 4096;  ///< in each direction, after knots have been inserted
    double tolerance = 1e-9;  ///< of intervals, relative; of points where it closes, relative to the largest
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
    /// Vertices from the surface's control points: for devices, too, where those move every frame (convert
    /// weights to float).
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
