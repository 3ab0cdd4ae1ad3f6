#include "limn/schemes/b_spline.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "limn/schemes/sparse_rows.h"
#include "limn/shared/jet.h"

namespace limn {
namespace {

/// Folds degree + 1 points, those of a span, to the blossom at arguments[0 .. degree), which is then points[0
/// .. width). span_knots[0] and [1] are the ends of the span; degree - 1 more knots are used at either side.
void fold(const double* span_knots, uint32_t degree, const double* arguments, double* points,
          uint32_t width) {
    for (uint32_t level = 0; level < degree; ++level) {
        const uint32_t left = degree - level;
        for (uint32_t i = 0; i < left; ++i) {
            const double from = span_knots[static_cast<int64_t>(i) - left + 1], to = span_knots[i + 1];
            const double share = (arguments[level] - from) / (to - from);
            double* p = points + size_t{i} * width;
            for (uint32_t c = 0; c < width; ++c) p[c] += share * (p[width + c] - p[c]);
        }
    }
}

/// Makes degree + 1 points of a span the degree points of the derivative's.
void differentiate(const double* span_knots, uint32_t degree, double* points, uint32_t width) {
    for (uint32_t i = 0; i < degree; ++i) {
        const double length = span_knots[i + 1] - span_knots[static_cast<int64_t>(i) - degree + 1];
        double* p = points + size_t{i} * width;
        for (uint32_t c = 0; c < width; ++c) p[c] = degree * (p[width + c] - p[c]) / length;
    }
}

/// Points that have components 1 at their own number: what folds to weights.
std::vector<double> unit_points(uint32_t degree) {
    const size_t n = degree + 1;
    std::vector<double> points(n * n, 0.0);
    for (size_t i = 0; i < n; ++i) points[i * n + i] = 1;
    return points;
}

/// The most equal knots at u.
uint32_t multiplicity(const KnotVector& k, double u) {
    const auto [first, last] = std::equal_range(k.knots.begin(), k.knots.end(), u);
    return static_cast<uint32_t>(last - first);
}

Error knot_error(const std::string& cause, uint64_t element = kNoElement) {
    return {ErrorCode::invalid_argument, cause, element};
}

Result<void> check_entries(uint64_t rows, uint64_t entries_each) {
    if (rows > (uint64_t{1} << 32) / entries_each)
        return Error{ErrorCode::too_large, "a table of 2^32 entries or more"};
    return {};
}

/// Whether `other` has, between the ends, what knots of the curve need to raise its degree to the other's.
Result<void> check_contains(const KnotVector& k, const KnotVector& other) {
    if (other.degree < k.degree) return knot_error("the degree of a curve cannot be reduced");
    if (other.begin() != k.begin() || other.end() != k.end())
        return knot_error("curves over knots of different ends");
    for (uint32_t i = k.degree + 1; i < k.point_count(); ++i)
        if (k.knots[i] > k.begin() && k.knots[i] < k.end() &&
            multiplicity(other, k.knots[i]) < multiplicity(k, k.knots[i]) + other.degree - k.degree)
            return knot_error("a knot of the curve is not often enough among the other knots", i);
    return {};
}

Result<void> check_both(const KnotVector& k, const KnotVector& other) {
    for (const KnotVector* knots : {&k, &other})
        if (auto checked = check_knots(*knots); !checked) return checked;
    if (auto checked = check_contains(k, other); !checked) return checked;
    return check_entries(other.point_count(), k.degree + 1);
}

/// The weights of the points of a span for the blossom of the curve, taken to be of degree arguments.size(),
/// there: the mean over all choices of as many arguments as the curve is of degree.
std::vector<double> blossom_weights(const KnotVector& k, uint32_t span, std::span<const double> arguments) {
    const std::vector<double> units = unit_points(k.degree);
    std::vector<double> weights(k.degree + 1, 0.0), chosen;
    uint32_t choices = 0;
    for (uint32_t set = 0; set < uint32_t{1} << arguments.size(); ++set) {
        if (static_cast<uint32_t>(std::popcount(set)) != k.degree) continue;
        chosen.clear();
        for (size_t i = 0; i < arguments.size(); ++i)
            if ((set >> i & 1) != 0) chosen.push_back(arguments[i]);
        std::vector<double> points = units;
        fold(k.knots.data() + span, k.degree, chosen.data(), points.data(), k.degree + 1);
        for (uint32_t i = 0; i <= k.degree; ++i) weights[i] += points[i];
        ++choices;
    }
    for (double& weight : weights) weight /= choices;
    return weights;
}

}  // namespace

Result<void> check_knots(const KnotVector& k) {
    if (k.degree < 1 || k.degree > kMaxBSplineDegree)
        return knot_error("B-splines are of degree 1 to " + std::to_string(kMaxBSplineDegree));
    if (k.knots.size() < 2 * size_t{k.degree} + 2)
        return knot_error("a B-spline of fewer than degree + 1 points");
    if (k.knots.size() >= size_t{1} << 31) return Error{ErrorCode::too_large, "2^31 knots or more"};
    for (size_t i = 0; i < k.knots.size(); ++i) {
        if (!std::isfinite(k.knots[i]))
            return Error{ErrorCode::not_finite, "knot " + std::to_string(i) + " is not finite", i};
        if (i > 0 && k.knots[i] < k.knots[i - 1])
            return knot_error("knot " + std::to_string(i) + " is less than the one before", i);
        if (i > k.degree && k.knots[i] == k.knots[i - k.degree - 1])
            return knot_error("knot " + std::to_string(i) + " is there more than degree + 1 times", i);
    }
    if (!(k.begin() < k.end())) return knot_error("the knots leave a B-spline no length");
    return {};
}

KnotVector make_uniform_knots(uint32_t degree, uint32_t point_count) {
    KnotVector out{degree, {}};
    for (uint32_t i = 0; i <= point_count + degree; ++i)
        out.knots.push_back(static_cast<double>(i) - degree);
    return out;
}

KnotVector make_clamped_knots(uint32_t degree, uint32_t point_count) {
    KnotVector out = make_uniform_knots(degree, point_count);
    for (double& knot : out.knots) knot = std::clamp(knot, 0.0, static_cast<double>(point_count - degree));
    return out;
}

uint32_t find_span(const KnotVector& k, double u) {
    const auto first = k.knots.begin() + k.degree, last = k.knots.begin() + k.point_count();
    // What ends the span: the first knot above u, or where there is none, the first at end().
    const auto above = u < *last ? std::upper_bound(first + 1, last, std::max(u, *first))
                                 : std::lower_bound(first + 1, last, *last);
    return static_cast<uint32_t>(above - k.knots.begin()) - 1;
}

void evaluate_b_spline(const KnotVector& k, std::span<const double> points, uint32_t width, double u,
                       uint32_t derivative_count, std::span<double> out) {
    assert(points.size() >= size_t{k.point_count()} * width &&
           out.size() >= (size_t{derivative_count} + 1) * width);
    const uint32_t span = find_span(k, u);
    evaluate_b_spline_span(k, span, points.subspan(size_t{span - k.degree} * width), width, u,
                           derivative_count, out);
}

void evaluate_b_spline_span(const KnotVector& k, uint32_t span, std::span<const double> span_points,
                            uint32_t width, double u, uint32_t derivative_count, std::span<double> out) {
    assert(span_points.size() >= (size_t{k.degree} + 1) * width &&
           out.size() >= (size_t{derivative_count} + 1) * width);
    const double* span_knots = k.knots.data() + span;
    std::vector<double> left(span_points.begin(),
                             span_points.begin() + static_cast<int64_t>((size_t{k.degree} + 1) * width)),
        work;
    const std::vector<double> arguments(k.degree, u);
    for (uint32_t d = 0; d <= derivative_count; ++d) {
        double* to = out.data() + size_t{d} * width;
        if (d > k.degree) {
            std::fill_n(to, width, 0.0);
            continue;
        }
        if (d > 0) differentiate(span_knots, k.degree - d + 1, left.data(), width);
        work = left;
        fold(span_knots, k.degree - d, arguments.data(), work.data(), width);
        std::copy_n(work.begin(), width, to);
    }
}

void divide_by_weight(std::span<const double> h, uint32_t width, std::span<double> out) {
    assert(h.size() >= size_t{3} * width && out.size() >= size_t{3} * (width - 1));
    const auto jet = [&](uint32_t c) {
        return shared::make_jet(h[c], h[width + c], 0, h[2 * width + c], 0, 0);
    };
    const shared::Jet weight = jet(width - 1);
    for (uint32_t c = 0; c + 1 < width; ++c) {
        const shared::Jet quotient = shared::jet_div(jet(c), weight);
        out[c] = quotient.f;
        out[width - 1 + c] = quotient.u;
        out[2 * (width - 1) + c] = quotient.uu;
    }
}

template <class Real>
Result<BasicStencilTable<Real>> build_b_spline_table(const KnotVector& k,
                                                     std::span<const double> parameters) {
    if (auto checked = check_knots(k); !checked) return checked.error();
    if (auto checked = check_entries(parameters.size(), k.degree + 1); !checked) return checked.error();
    StencilTableDouble table = make_empty_table(k.point_count());
    const uint32_t n = k.degree + 1;
    const std::vector<double> units = unit_points(k.degree);
    std::vector<double> weights(3 * size_t{n});
    SparseRow row;
    for (size_t r = 0; r < parameters.size(); ++r) {
        if (!std::isfinite(parameters[r]))
            return Error{ErrorCode::not_finite, "parameter " + std::to_string(r) + " is not finite", r};
        const uint32_t span = find_span(k, parameters[r]);
        evaluate_b_spline_span(k, span, units, n, parameters[r], 2, weights);
        row.entries.clear();
        for (uint32_t i = 0; i < n; ++i)
            row.add(span - k.degree + i, weights[i], weights[n + i], weights[2 * n + i]);
        append_row(table, row, true);
    }
    return convert_table<Real>(std::move(table));
}

KnotVector insert_knot(const KnotVector& k, double u) {
    KnotVector out = k;
    out.knots.insert(std::upper_bound(out.knots.begin(), out.knots.end(), u), u);
    return out;
}

KnotVector insert_middle_knots(const KnotVector& k) {
    KnotVector out{k.degree, {}};
    for (size_t i = 0; i < k.knots.size(); ++i) {
        out.knots.push_back(k.knots[i]);
        const bool inside = i >= k.degree && i < k.point_count();
        if (inside && k.knots[i] < k.knots[i + 1])
            out.knots.push_back(k.knots[i] + (k.knots[i + 1] - k.knots[i]) / 2);
    }
    return out;
}

template <class Real>
Result<BasicStencilTable<Real>> build_boehm_table(const KnotVector& k, double u) {
    if (auto checked = check_knots(k); !checked) return checked.error();
    if (!(u >= k.begin() && u <= k.end()) || multiplicity(k, u) > k.degree)
        return knot_error("a knot cannot be inserted beyond the ends, nor more than degree + 1 times");
    if (auto checked = check_entries(k.point_count() + uint64_t{1}, 2); !checked) return checked.error();
    StencilTableDouble table = make_empty_table(k.point_count());
    const auto j =
        static_cast<uint32_t>(std::upper_bound(k.knots.begin(), k.knots.end(), u) - k.knots.begin()) - 1;
    SparseRow row;
    for (uint32_t i = 0; i <= k.point_count(); ++i) {
        row.entries.clear();
        // Beyond these it is 0 and 1: of points before the knot, and behind it.
        const double length = i + k.degree > j && i <= j ? k.knots[i + k.degree] - k.knots[i] : 0;
        const double share = length > 0 ? (u - k.knots[i]) / length : i + k.degree <= j ? 1 : 0;
        if (share != 1) row.add(i - 1, 1 - share);
        if (share != 0) row.add(i, share);
        append_row(table, row, false);
    }
    return convert_table<Real>(std::move(table));
}

template <class Real>
Result<BasicStencilTable<Real>> build_oslo_table(const KnotVector& k, const KnotVector& refined) {
    if (auto checked = check_both(k, refined); !checked) return checked.error();
    if (k.degree != refined.degree) return knot_error("the Oslo algorithm does not change degrees");
    const uint32_t p = k.degree;
    const std::vector<double>&t = k.knots, &s = refined.knots;
    StencilTableDouble table = make_empty_table(k.point_count());
    std::vector<double> alpha(p + 2);
    SparseRow row;
    for (uint32_t i = 0; i < refined.point_count(); ++i) {
        // alpha[p + j - span] is that of point j. Only points span - p to span matter.
        const uint32_t span = find_span(k, s[i]);
        std::fill(alpha.begin(), alpha.end(), 0.0);
        alpha[p] = 1;
        for (uint32_t level = 1; level <= p; ++level) {
            for (uint32_t a = p - level; a <= p; ++a) {
                const uint32_t j = span + a - p;
                const double own = t[j + level] - t[j], next = t[j + level + 1] - t[j + 1];
                alpha[a] = (own > 0 ? (s[i + level] - t[j]) / own * alpha[a] : 0) +
                           (next > 0 ? (t[j + level + 1] - s[i + level]) / next * alpha[a + 1] : 0);
            }
        }
        row.entries.clear();
        for (uint32_t a = 0; a <= p; ++a)
            if (alpha[a] != 0) row.add(span + a - p, alpha[a]);
        append_row(table, row, false);
    }
    return convert_table<Real>(std::move(table));
}

template <class Real>
Result<BasicStencilTable<Real>> build_blossom_table(const KnotVector& k, const KnotVector& other) {
    if (auto checked = check_both(k, other); !checked) return checked.error();
    StencilTableDouble table = make_empty_table(k.point_count());
    SparseRow row;
    for (uint32_t i = 0; i < other.point_count(); ++i) {
        // Any span below the basis function will do: they have the same blossom at the knots inside it.
        const double first = std::max(other.knots[i], k.begin()),
                     last = std::min(other.knots[i + other.degree + 1], k.end());
        const uint32_t span = find_span(k, first + (last - first) / 2);
        const auto weights = blossom_weights(k, span, std::span(other.knots).subspan(i + 1, other.degree));
        row.entries.clear();
        for (uint32_t a = 0; a <= k.degree; ++a)
            if (weights[a] != 0) row.add(span + a - k.degree, weights[a]);
        append_row(table, row, false);
    }
    return convert_table<Real>(std::move(table));
}

#define LIMN_INSTANTIATE(Real)                                                                             \
    template Result<BasicStencilTable<Real>> build_b_spline_table<Real>(const KnotVector&,                 \
                                                                        std::span<const double>);          \
    template Result<BasicStencilTable<Real>> build_boehm_table<Real>(const KnotVector&, double);           \
    template Result<BasicStencilTable<Real>> build_oslo_table<Real>(const KnotVector&, const KnotVector&); \
    template Result<BasicStencilTable<Real>> build_blossom_table<Real>(const KnotVector&, const KnotVector&);
LIMN_INSTANTIATE(float)
LIMN_INSTANTIATE(double)
#undef LIMN_INSTANTIATE

}  // namespace limn
