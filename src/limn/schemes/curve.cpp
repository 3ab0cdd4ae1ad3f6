#include "limn/schemes/curve.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "limn/schemes/sparse_rows.h"

namespace limn {
namespace {

/// Child c of one step is sum over i of weights[c - arity * i - first] * P[i]. It lies at c / arity, in
/// numbers of parents; of dual rules at c / 2 + 1/4.
struct Mask {
    int64_t arity, first;
    std::vector<double> weights;
    bool dual = false;
    int64_t last() const { return first + static_cast<int64_t>(weights.size()) - 1; }
};

Mask lane_riesenfeld_mask(uint32_t degree) {
    std::vector<double> weights = {1, 1};  // doubled, then averaged
    for (uint32_t k = 0; k < degree; ++k) {
        weights.push_back(0);
        for (size_t i = weights.size() - 1; i > 0; --i) weights[i] += weights[i - 1];
        for (double& weight : weights) weight /= 2;
    }
    return {2, -int64_t{degree / 2 + 1}, std::move(weights), degree % 2 == 0};
}

Mask mask_of(const CurveScheme& scheme) {
    switch (scheme.rule) {
        case CurveRule::four_point: {
            const double w = scheme.tension, h = 0.5 + w;
            return {2, -3, {-w, 0, h, 1, h, 0, -w}};
        }
        case CurveRule::ternary_cubic:
            return {3,
                    -4,
                    {1 / 27., 4 / 27., 10 / 27., 16 / 27., 19 / 27., 16 / 27., 10 / 27., 4 / 27., 1 / 27.}};
        case CurveRule::ternary_four_point: {
            const double a = 60 / 81., b = 30 / 81., c = -5 / 81., d = -4 / 81.;
            return {3, -5, {d, c, 0, b, a, 1, a, b, 0, c, d}};
        }
        default:
            return lane_riesenfeld_mask(scheme.degree);
    }
}

/// A polygon of one level. With end points (of dual rules) indices leave those out: they are half a step
/// beyond indices 0 and inner_count() - 1.
struct Polygon {
    CurveEnds ends;
    bool dual;
    int64_t count;

    bool has_end_points() const { return dual && ends == CurveEnds::interpolated; }
    int64_t inner_count() const { return has_end_points() ? count - 2 : count; }

    /// Adds what point i, which may lie beyond the ends, weighs.
    void add(int64_t i, double weight, double tangent1, double tangent2, SparseRow& row) const {
        if (ends == CurveEnds::closed) i = (i % count + count) % count;
        const int64_t n = inner_count(), shift = has_end_points() ? 1 : 0;
        while (i < 0 || i >= n) {
            const int64_t end = i < 0 ? 0 : count - 1;
            row.add(static_cast<uint32_t>(end), 2 * weight, 2 * tangent1, 2 * tangent2);
            i = (i < 0 ? 0 : 2 * (n - 1)) - i + (dual ? (i < 0 ? -1 : 1) : 0);
            weight = -weight;
            tangent1 = -tangent1;
            tangent2 = -tangent2;
        }
        row.add(static_cast<uint32_t>(i + shift), weight, tangent1, tangent2);
    }
};

/// The children that a polygon has, numbered as Mask does.
struct Children {
    int64_t first, count;
};
Children children_of(const Mask& mask, const Polygon& polygon) {
    const int64_t n = polygon.inner_count();
    if (polygon.ends == CurveEnds::closed) return {0, mask.arity * n};
    if (polygon.ends == CurveEnds::free) {
        const int64_t first = mask.last() - mask.arity + 1;
        return {first, mask.arity * n + mask.first - first};
    }
    return mask.dual ? Children{-1, 2 * n} : Children{0, mask.arity * (n - 1) + 1};
}

Polygon polygon_of(const CurveScheme& scheme, const Mask& mask, int64_t count) {
    return {scheme.ends, mask.dual, count};
}

int64_t refined_count(const Mask& mask, const Polygon& polygon) {
    return children_of(mask, polygon).count + (polygon.has_end_points() ? 2 : 0);
}

StencilTableDouble build_step(const Mask& mask, const Polygon& polygon) {
    StencilTableDouble table = make_empty_table(static_cast<uint32_t>(polygon.count));
    const Children children = children_of(mask, polygon);
    SparseRow row;
    const auto append_end = [&](int64_t end) {
        row.entries.clear();
        row.add(static_cast<uint32_t>(end), 1);
        append_row(table, row, false);
    };
    if (polygon.has_end_points()) append_end(0);
    for (int64_t c = children.first; c < children.first + children.count; ++c) {
        row.entries.clear();
        // The first parent that is not too far to the left: ceil((c - last) / arity).
        const int64_t distance = c - mask.last();
        int64_t i = distance >= 0 ? (distance + mask.arity - 1) / mask.arity : -(-distance / mask.arity);
        for (; c - mask.arity * i >= mask.first; ++i) {
            const double weight = mask.weights[static_cast<size_t>(c - mask.arity * i - mask.first)];
            if (weight != 0) polygon.add(i, weight, 0, 0, row);
        }
        append_row(table, row, false);
    }
    if (polygon.has_end_points()) append_end(polygon.count - 1);
    return table;
}

/// The uniform B-spline of knots 1 apart around 0, or a derivative of it; where it jumps, the mean of both
/// sides.
double b_spline(uint32_t degree, uint32_t derivative, double x) {
    if (derivative > degree) return 0;
    if (degree == 0) return std::abs(x) < 0.5 ? 1 : std::abs(x) > 0.5 ? 0 : 0.5;
    if (derivative > 0)
        return b_spline(degree - 1, derivative - 1, x + 0.5) - b_spline(degree - 1, derivative - 1, x - 0.5);
    const double half = (degree + 1) / 2.0;
    return ((half + x) * b_spline(degree - 1, 0, x + 0.5) + (half - x) * b_spline(degree - 1, 0, x - 0.5)) /
           degree;
}

bool is_b_spline(const CurveScheme& scheme) {
    return scheme.rule == CurveRule::lane_riesenfeld || scheme.rule == CurveRule::ternary_cubic;
}
uint32_t degree_of(const CurveScheme& scheme) {
    return scheme.rule == CurveRule::ternary_cubic ? 3 : scheme.degree;
}
/// Of degree 1 tangents are the mean of both sides.
uint32_t limit_reach(const CurveScheme& scheme) {
    return is_b_spline(scheme) ? std::max(degree_of(scheme) / 2, 1u) : 2;
}

struct LimitWeights {
    double value, first, second;
};

/// What point `offset` steps from a place weighs there. Rules of four points: by the left eigenvector of half
/// (a third).
LimitWeights limit_weights(const CurveScheme& scheme, double offset) {
    if (is_b_spline(scheme)) {
        const uint32_t degree = degree_of(scheme);
        return {b_spline(degree, 0, -offset), b_spline(degree, 1, -offset), b_spline(degree, 2, -offset)};
    }
    const double w = scheme.rule == CurveRule::four_point ? scheme.tension : 1.0 / 16;
    const double near = 1 / (2 - 8 * w), far = -2 * w * near, distance = std::abs(offset);
    const double tangent = distance == 1 ? near : distance == 2 ? far : 0;
    return {distance == 0 ? 1.0 : 0.0, offset < 0 ? -tangent : tangent, 0};
}

/// The limit rows of a level whose points are `spacing` apart.
StencilTableDouble build_limits(const CurveScheme& scheme, const Polygon& polygon, double spacing) {
    StencilTableDouble table = make_empty_table(static_cast<uint32_t>(polygon.count));
    const int64_t reach = limit_reach(scheme), margin = polygon.ends == CurveEnds::free ? reach : 0;
    // Weights around points, and around ends between points (offsets less a half).
    std::vector<LimitWeights> around, at_end;
    for (int64_t k = -reach; k <= reach; ++k) around.push_back(limit_weights(scheme, static_cast<double>(k)));
    for (int64_t k = -reach; k <= reach + 1; ++k)
        at_end.push_back(limit_weights(scheme, static_cast<double>(k) - 0.5));
    SparseRow row;
    const auto append = [&](int64_t first, const std::vector<LimitWeights>& weights) {
        row.entries.clear();
        for (size_t k = 0; k < weights.size(); ++k) {
            const LimitWeights& w = weights[k];
            if (w.value == 0 && w.first == 0 && w.second == 0) continue;
            polygon.add(first + static_cast<int64_t>(k), w.value, w.first / spacing,
                        w.second / (spacing * spacing), row);
        }
        append_row(table, row, true);
    };
    if (polygon.has_end_points()) append(-1 - reach, at_end);
    for (int64_t i = margin; i < polygon.inner_count() - margin; ++i) append(i - reach, around);
    if (polygon.has_end_points()) append(polygon.inner_count() - 1 - reach, at_end);
    return table;
}

Result<void> check(const CurveScheme& scheme, uint32_t level) {
    if (scheme.rule == CurveRule::lane_riesenfeld && (scheme.degree < 1 || scheme.degree > kMaxCurveDegree))
        return Error{ErrorCode::invalid_argument,
                     "curves are of degree 1 to " + std::to_string(kMaxCurveDegree)};
    if (level > kMaxCurveLevel)
        return Error{ErrorCode::invalid_argument,
                     "curves have " + std::to_string(kMaxCurveLevel) + " levels at most"};
    if (scheme.rule == CurveRule::four_point && !(scheme.tension >= 0 && scheme.tension <= kMaxCurveTension))
        return Error{ErrorCode::invalid_argument, "the tension of a curve is not within 0 and 3/16"};
    return {};
}

/// The polygons of levels 0 to `level`.
Result<std::vector<Polygon>> list_polygons(const CurveScheme& scheme, uint32_t control_count,
                                           uint32_t level) {
    if (auto checked = check(scheme, level); !checked) return checked.error();
    const Mask mask = mask_of(scheme);
    std::vector<Polygon> polygons = {polygon_of(scheme, mask, control_count)};
    const int64_t least = scheme.ends == CurveEnds::interpolated ? (mask.dual ? 3 : 2) : 1;
    for (uint32_t l = 0;; ++l) {
        if (polygons.back().count < least)
            return Error{ErrorCode::invalid_argument, std::to_string(control_count) +
                                                          " points are too few for a curve of "
                                                          "this rule and these ends at level " +
                                                          std::to_string(l)};
        if (polygons.back().count >= int64_t{1} << 31)
            return Error{ErrorCode::too_large,
                         "a curve of 2^31 points or more at level " + std::to_string(l)};
        if (l == level) return polygons;
        polygons.push_back(polygon_of(scheme, mask, refined_count(mask, polygons.back())));
    }
}

Result<StencilTableDouble> build(const CurveScheme& scheme, uint32_t control_count, uint32_t level,
                                 bool limits) {
    const auto polygons = list_polygons(scheme, control_count, level);
    if (!polygons) return polygons.error();
    const Mask mask = mask_of(scheme);
    const double spacing = std::pow(static_cast<double>(mask.arity), -static_cast<double>(level));
    // A point of any level depends on no more control points than fit below a basis function.
    const uint64_t most = mask.weights.size() + 2;
    if (limits && polygons->back().count <= 2 * int64_t{count_curve_margin(scheme)})
        return Error{ErrorCode::invalid_argument,
                     "a curve of so few points has no limits where its ends are free"};
    if (static_cast<uint64_t>(polygons->back().count) * most >= uint64_t{1} << 32)
        return Error{ErrorCode::too_large, "a curve table of 2^32 entries or more"};
    StencilTableDouble table;
    for (uint32_t l = 0; l < level; ++l) {
        StencilTableDouble step = build_step(mask, (*polygons)[l]);
        table = l == 0 ? std::move(step) : multiply_tables(step, table);
    }
    if (limits) {
        StencilTableDouble rows = build_limits(scheme, polygons->back(), spacing);
        return level == 0 ? std::move(rows) : multiply_tables(rows, table);
    }
    if (level > 0) return table;
    table = make_empty_table(control_count);
    for (uint32_t i = 0; i < control_count; ++i) append_row(table, {{{i, 1, 0, 0}}}, false);
    return table;
}

}  // namespace

Result<uint32_t> count_curve_points(const CurveScheme& scheme, uint32_t control_count, uint32_t level) {
    const auto polygons = list_polygons(scheme, control_count, level);
    if (!polygons) return polygons.error();
    return static_cast<uint32_t>(polygons->back().count);
}

double curve_parameter(const CurveScheme& scheme, uint32_t control_count, uint32_t level, uint32_t index) {
    const Mask mask = mask_of(scheme);
    const Polygon control = polygon_of(scheme, mask, control_count);
    const bool ends = control.has_end_points();
    if (ends && index == 0) return 0;
    if (ends && index + 1 == *count_curve_points(scheme, control_count, level)) return control_count - 2.0;
    const auto first = static_cast<double>(children_of(mask, control).first);
    double at = index - (ends ? 1.0 : 0.0);
    for (uint32_t l = 0; l < level; ++l)
        at = (at + first) / static_cast<double>(mask.arity) + (mask.dual ? 0.25 : 0);
    return at + (ends ? 0.5 : 0);
}

uint32_t count_curve_margin(const CurveScheme& scheme) {
    return scheme.ends == CurveEnds::free ? limit_reach(scheme) : 0;
}

template <class Real>
Result<BasicStencilTable<Real>> build_curve_table(const CurveScheme& scheme, uint32_t control_count,
                                                  uint32_t level) {
    auto table = build(scheme, control_count, level, false);
    if (!table) return table.error();
    return convert_table<Real>(std::move(*table));
}

template <class Real>
Result<BasicStencilTable<Real>> build_curve_limit_table(const CurveScheme& scheme, uint32_t control_count,
                                                        uint32_t level) {
    auto table = build(scheme, control_count, level, true);
    if (!table) return table.error();
    return convert_table<Real>(std::move(*table));
}

template Result<StencilTable> build_curve_table<float>(const CurveScheme&, uint32_t, uint32_t);
template Result<StencilTableDouble> build_curve_table<double>(const CurveScheme&, uint32_t, uint32_t);
template Result<StencilTable> build_curve_limit_table<float>(const CurveScheme&, uint32_t, uint32_t);
template Result<StencilTableDouble> build_curve_limit_table<double>(const CurveScheme&, uint32_t, uint32_t);

}  // namespace limn
