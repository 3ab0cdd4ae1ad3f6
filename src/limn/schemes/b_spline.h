// B-splines of any knots, and NURBS as B-splines of homogeneous points: evaluation, and the same curve over
// other knots.
//
// Boehm 1980 (knot insertion); Cohen, Lyche and Riesenfeld 1980 (the Oslo algorithm); de Boor 1972
// (evaluation); Ramshaw 1989 (blossoms). Control points have any number of components: a rational curve's are
// (w x, w y, w z, w), evaluated as any others and then divided (divide_by_weight).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limn/stencil_table.h"

namespace limn {

inline constexpr uint32_t kMaxBSplineDegree = 15;

/// Knots of a B-spline. Control point i has to do with the parameters between knots[i] and knots[i + degree +
/// 1]; the curve is over [begin(), end()].
struct KnotVector {
    uint32_t degree = 3;        ///< 1 to kMaxBSplineDegree
    std::vector<double> knots;  ///< point_count() + degree + 1, none less than the one before it

    uint32_t point_count() const { return static_cast<uint32_t>(knots.size()) - degree - 1; }
    double begin() const { return knots[degree]; }
    double end() const { return knots[point_count()]; }
    bool operator==(const KnotVector&) const = default;
};

/// Errors: invalid_argument (degree, fewer than degree + 1 points, knots that descend, more than degree + 1
/// equal ones, begin() not less than end()), not_finite, too_large (2^31 knots or more). Element: the knot.
Result<void> check_knots(const KnotVector& knots);

/// Knots 1 apart, begin() at 0. Preconditions, here and below: degree and point_count > degree are as
/// check_knots wants.
KnotVector make_uniform_knots(uint32_t degree, uint32_t point_count);
/// Knots 1 apart from 0 on, but for degree + 1 equal ones at each end: the curve begins and ends at control
/// points.
KnotVector make_clamped_knots(uint32_t degree, uint32_t point_count);

/// Preconditions of all that follows, where it returns no Error: check_knots() succeeds, and parameters are
/// finite.

/// The value at u and `derivative_count` derivatives by u: component c of derivative k is out[k * width + c].
/// `points` holds point_count() * width numbers. At a knot the derivatives are those of what follows (at
/// end(), of what comes before); beyond begin() and end() the first and last polynomial go on.
void evaluate_b_spline(const KnotVector& knots, std::span<const double> points, uint32_t width, double u,
                       uint32_t derivative_count, std::span<double> out);

/// The span of u: the last knot not above it that has an interval behind it, at most the one before end().
/// The curve there depends on control points span - degree to span.
uint32_t find_span(const KnotVector& knots, double u);

/// As evaluate_b_spline, from the degree + 1 points of u's span alone.
void evaluate_b_spline_span(const KnotVector& knots, uint32_t span, std::span<const double> span_points,
                            uint32_t width, double u, uint32_t derivative_count, std::span<double> out);

/// A rational point from `width` - 1 numerators and a weight: from value, first and second derivative by u (3
/// * width numbers, as evaluate_b_spline gives them) those of the quotient (3 * (width - 1) numbers). The
/// weight must not be 0.
void divide_by_weight(std::span<const double> homogeneous, uint32_t width, std::span<double> out);

/// Row r is the point at parameters[r]; tangent1 and tangent2 are the first and second derivative by u there.
/// Errors: as check_knots; not_finite (a parameter); too_large (2^32 entries or more).
template <class Real>
Result<BasicStencilTable<Real>> build_b_spline_table(const KnotVector& knots,
                                                     std::span<const double> parameters);

/// With one more knot at u (begin() <= u <= end(), and fewer than degree + 1 knots are there); with one in
/// the middle of every interval between begin() and end().
KnotVector insert_knot(const KnotVector& knots, double u);
KnotVector insert_middle_knots(const KnotVector& knots);

/// Control points over other knots, from those over `knots`; the curve is the same one. Three ways to the
/// same table: Boehm's, to insert_knot(knots, u); the Oslo algorithm, to any number of knots more; and
/// blossoms, which may also raise the degree and change the knots before begin() and after end(). Errors: as
/// check_knots, of both; too_large (2^32 entries or more); invalid_argument: a knot u that insert_knot does
/// not take; other knots of a lower degree (Oslo: another), with another begin() or end(), or without all
/// knots that the curve has between its ends, as often as there and, for a degree that is higher by n, n
/// times more.
template <class Real>
Result<BasicStencilTable<Real>> build_boehm_table(const KnotVector& knots, double u);
template <class Real>
Result<BasicStencilTable<Real>> build_oslo_table(const KnotVector& knots, const KnotVector& refined);
template <class Real>
Result<BasicStencilTable<Real>> build_blossom_table(const KnotVector& knots, const KnotVector& other);

}  // namespace limn
