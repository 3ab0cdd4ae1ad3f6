// Tensor-product B-spline surfaces, and NURBS as those of homogeneous points.
#pragma once

#include "limn/schemes/b_spline.h"

namespace limn {

/// A B-spline of B-splines. Component c of control point (i, j), i < u.point_count(), j < v.point_count(), is
/// points[(j * u.point_count() + i) * width + c].
struct BSplineSurface {
    KnotVector u, v;
    uint32_t width = 3;  ///< components; of a rational surface 4: x, y and z times the weight, and the weight
    std::vector<double> points;
};

/// Errors: as check_knots; invalid_argument (a width of 0, another number of points); not_finite. Element:
/// the knot, or the number of `points`. What follows takes surfaces that pass.
Result<void> check_surface(const BSplineSurface& surface);

/// The value, du, dv, duu, duv and dvv at (u, v): component c of value k is out[k * width + c].
void evaluate_b_spline_surface(const BSplineSurface& surface, double u, double v, std::span<double> out);

/// As divide_by_weight, of the six values that evaluate_b_spline_surface and evaluate_patches give.
void divide_surface_by_weight(std::span<const double> homogeneous, uint32_t width, std::span<double> out);

/// The parts of a surface between knots that are there `degree` times or more, where it is creased or torn:
/// parts next to each other along u follow each other. Each is a surface without such knots inside, over its
/// share of the parameters.
std::vector<BSplineSurface> split_at_full_knots(const BSplineSurface& surface);

/// A table for the control points of a surface from one for each direction. Row k + l * u.row_count() is row
/// k along u of rows l along v; sources are numbered as BSplineSurface does. Tangents are not looked at.
/// Errors: too_large.
Result<StencilTableDouble> multiply_directions(const StencilTableDouble& u, const StencilTableDouble& v);

}  // namespace limn
