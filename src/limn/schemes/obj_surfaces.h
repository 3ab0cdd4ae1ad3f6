// B-spline, Bezier and NURBS surfaces in OBJ files: its free-form statements.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "limn/schemes/b_spline_surface.h"

namespace limn {

/// Reads the `surf` statements of an OBJ file; none where it has none.
/// - `v x y z [w]`: a control point and its weight (1).
/// - `cstype [rat] bspline|bezier`, `deg U V`: hold for the surfaces that follow. Surfaces after `rat` are of
/// width 4,
///   homogeneous; others of width 3, and weights are not looked at.
/// - `surf U0 U1 V0 V1 POINT...`, `parm u|v KNOT...`, `end`: control points in rows along u, by index as in
/// `f` (from 1, or back
///   from the last one so far; texture coordinates and normals behind a slash are not looked at). Knots of a
///   B-spline, all of them; or the parameters at which the patches of a Bezier surface meet, whose knots then
///   are there `degree` times.
/// Curves (`curv` and `curv2` to `end`) and other statements are passed over; `\` at the end of a line
/// continues it.
///
/// Errors: as read_file; parse_error; index_out_of_range; as check_surface; unsupported (other kinds of
/// surfaces; `trim`, `hole` and other statements that change a surface; U0 U1 V0 V1 that are a part of it
/// only). But for read_file's Error::element is the line, counted from 1, and Error::message one line,
/// `PATH:LINE: cause`.
Result<std::vector<BSplineSurface>> read_obj_surfaces(const std::string& path);

/// The same for text that is at hand; `name` stands for the path in messages.
Result<std::vector<BSplineSurface>> parse_obj_surfaces(std::string_view text, const std::string& name);

/// Writes surfaces of width 3, or of width 4 (homogeneous) as rational ones, with numbers that read back to
/// the same bits (of coordinates and weights of rational surfaces: divided, so that they round). Errors: as
/// check_surface; invalid_argument (another width, a weight of 0); cannot_open; out_of_memory.
Result<void> write_obj_surfaces(const std::string& path, std::span<const BSplineSurface> surfaces);

}  // namespace limn
