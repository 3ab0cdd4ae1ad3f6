// Subdivision curves: refined points, limit points and derivatives of control polygons, as stencil tables.
//
// Chaikin 1974; Lane and Riesenfeld 1980; Dyn, Gregory and Levin 1987 (four points); the ternary rules are
// those of the boundaries of Kobbelt's (2000) and of Labsik and Greiner's (2000) root-3 surfaces.
#pragma once

#include <cstdint>

#include "limn/stencil_table.h"

namespace limn {

enum class CurveRule : uint8_t {
    lane_riesenfeld,     ///< uniform B-spline of CurveScheme::degree: 2 is Chaikin's rule, 3 the cubic one
    four_point,          ///< through its control points; CurveScheme::tension
    ternary_cubic,       ///< the cubic B-spline, three points for one
    ternary_four_point,  ///< through its control points, three for one
};

/// What becomes of the two ends of a polygon.
enum class CurveEnds : uint8_t {
    closed,  ///< there are none: the last point is followed by the first
    /// The curve goes from the first point to the last. What rules need beyond an end is the polygon's
    /// reflection at it, P[-k] = 2 P[0] - P[k]. With even degrees, whose points lie between knots, the two
    /// ends lie on knots, half a step beyond their neighbours: of degree 2 it is the B-spline of double knots
    /// there, its tangents towards those.
    interpolated,
    /// Points beyond the ends are left out, and with them what depends on them: each refinement, and the
    /// curve, is shorter. A polygon of doubled end points gives Chaikin's curve that begins and ends at them,
    /// straight at first.
    free,
};

inline constexpr uint32_t kMaxCurveDegree = 15;
inline constexpr double kMaxCurveTension = 3.0 / 16;
inline constexpr uint32_t kMaxCurveLevel = 30;

struct CurveScheme {
    CurveRule rule = CurveRule::lane_riesenfeld;
    CurveEnds ends = CurveEnds::closed;
    uint32_t degree = 3;  ///< of lane_riesenfeld, 1 to kMaxCurveDegree: degree - 1 continuous derivatives
    /// Of four_point, 0 (the polygon itself) to kMaxCurveTension. Tangents are continuous between 0 and
    /// (sqrt(5) - 1) / 8 = 0.1545 at least; 1/16 reproduces cubic polynomials.
    double tension = 1.0 / 16;
};

/// How many points `control_count` points are at `level`, 0 or more.
/// Errors: invalid_argument (degree, tension, level; fewer points than the ends leave any of), too_large
/// (2^31 or more points).
Result<uint32_t> count_curve_points(const CurveScheme& scheme, uint32_t control_count, uint32_t level);

/// The parameter of point `index` of `level`, in which control points are 1 apart and control point 0 is at 0
/// (with interpolated ends of even degrees the second is at 1/2, the last at control_count - 2). Limits and
/// derivatives of points are those there. Precondition: count_curve_points(scheme, control_count, level)
/// succeeds and is above index.
double curve_parameter(const CurveScheme& scheme, uint32_t control_count, uint32_t level, uint32_t index);

/// The points of `level` from the control points: row r is point r. Points may have any number of components.
/// Errors: as count_curve_points, and too_large for 2^32 entries or more.
template <class Real>
Result<BasicStencilTable<Real>> build_curve_table(const CurveScheme& scheme, uint32_t control_count,
                                                  uint32_t level);

/// Where the points of `level` end up, from the control points. tangent1 is the first derivative of the curve
/// by curve_parameter, tangent2 the second, the mean of both sides where it jumps; the latter is zero of the
/// rules of four points, which have none. With free ends row r is point r + count_curve_margin(scheme), and
/// as many points are left out at the other end. Errors: as build_curve_table.
template <class Real>
Result<BasicStencilTable<Real>> build_curve_limit_table(const CurveScheme& scheme, uint32_t control_count,
                                                        uint32_t level);

/// Points at each free end that have no row in a limit table; 0 with other ends.
uint32_t count_curve_margin(const CurveScheme& scheme);

}  // namespace limn
