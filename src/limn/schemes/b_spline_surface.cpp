#include "limn/schemes/b_spline_surface.h"

#include <algorithm>
#include <cmath>

#include "limn/schemes/sparse_rows.h"
#include "limn/shared/jet.h"

namespace limn {
namespace {

/// Spans of control points and knots between knots that are there `degree` times or more.
struct KnotRange {
    uint32_t first_point, point_count;
};
std::vector<KnotRange> list_parts(const KnotVector& k) {
    std::vector<KnotRange> parts;
    uint32_t first = k.degree;  // the knot at which a part begins, the last of those equal to it
    while (k.knots[first + 1] == k.knots[first]) ++first;
    for (uint32_t i = first + 1; i <= k.point_count(); ++i) {
        const bool last = k.knots[i] == k.end();
        const bool full = i + k.degree < k.knots.size() && k.knots[i + k.degree - 1] == k.knots[i];
        if (!last && !full) continue;
        parts.push_back({first - k.degree, i - first + k.degree});
        if (last) break;
        first = i;
        while (k.knots[first + 1] == k.knots[first]) ++first;
        i = first;
    }
    return parts;
}

KnotVector part_of(const KnotVector& k, const KnotRange& part) {
    const auto first = k.knots.begin() + part.first_point;
    return {k.degree, {first, first + part.point_count + k.degree + 1}};
}

}  // namespace

Result<void> check_surface(const BSplineSurface& s) {
    for (const KnotVector* knots : {&s.u, &s.v})
        if (auto checked = check_knots(*knots); !checked) return checked;
    const uint64_t count = uint64_t{s.u.point_count()} * s.v.point_count();
    if (s.width == 0 || s.points.size() % s.width != 0 || s.points.size() / s.width != count)
        return Error{ErrorCode::invalid_argument, "a surface of these knots has " + std::to_string(count) +
                                                      " control points of one component or more"};
    for (size_t i = 0; i < s.points.size(); ++i)
        if (!std::isfinite(s.points[i]))
            return Error{ErrorCode::not_finite,
                         "control point " + std::to_string(i / s.width) + " is not finite", i};
    return {};
}

void evaluate_b_spline_surface(const BSplineSurface& s, double u, double v, std::span<double> out) {
    const size_t width = s.width, columns = s.u.degree + 1;
    assert(out.size() >= 6 * width);
    const uint32_t u_span = find_span(s.u, u), v_span = find_span(s.v, v);
    std::vector<double> net;
    for (size_t j = v_span - s.v.degree; j <= v_span; ++j) {
        const auto row =
            s.points.begin() + static_cast<int64_t>((j * s.u.point_count() + u_span - s.u.degree) * width);
        net.insert(net.end(), row, row + static_cast<int64_t>(columns * width));
    }
    // Along v first: three rows of points, of the value and two derivatives by v.
    std::vector<double> by_v(3 * columns * width), values(3 * width);
    evaluate_b_spline_span(s.v, v_span, net, static_cast<uint32_t>(columns * width), v, 2, by_v);
    constexpr int kPlace[3][3] = {{0, 2, 5}, {1, 4, -1}, {3, -1, -1}};  // of derivative [by u][by v]
    for (size_t dv = 0; dv < 3; ++dv) {
        const std::span row = std::span(by_v).subspan(dv * columns * width, columns * width);
        evaluate_b_spline_span(s.u, u_span, row, s.width, u, 2, values);
        for (size_t du = 0; du < 3; ++du)
            if (kPlace[du][dv] >= 0)
                std::copy_n(values.data() + du * width, width,
                            out.data() + static_cast<size_t>(kPlace[du][dv]) * width);
    }
}

void divide_surface_by_weight(std::span<const double> h, uint32_t width, std::span<double> out) {
    assert(h.size() >= size_t{6} * width && out.size() >= size_t{6} * (width - 1));
    const auto jet = [&](size_t c) {
        const size_t w = width;
        return shared::make_jet(h[c], h[w + c], h[2 * w + c], h[3 * w + c], h[4 * w + c], h[5 * w + c]);
    };
    const shared::Jet weight = jet(width - 1);
    for (size_t c = 0; c + 1 < width; ++c) {
        const shared::Jet q = shared::jet_div(jet(c), weight);
        const double values[6] = {q.f, q.u, q.v, q.uu, q.uv, q.vv};
        for (size_t k = 0; k < 6; ++k) out[k * (width - 1) + c] = values[k];
    }
}

std::vector<BSplineSurface> split_at_full_knots(const BSplineSurface& s) {
    std::vector<BSplineSurface> parts;
    for (const KnotRange& v : list_parts(s.v)) {
        for (const KnotRange& u : list_parts(s.u)) {
            BSplineSurface part{part_of(s.u, u), part_of(s.v, v), s.width, {}};
            for (uint32_t j = 0; j < v.point_count; ++j) {
                const size_t first =
                    (size_t{v.first_point + j} * s.u.point_count() + u.first_point) * s.width;
                const auto from = s.points.begin() + static_cast<int64_t>(first);
                part.points.insert(part.points.end(), from,
                                   from + static_cast<int64_t>(u.point_count * size_t{s.width}));
            }
            parts.push_back(std::move(part));
        }
    }
    return parts;
}

Result<StencilTableDouble> multiply_directions(const StencilTableDouble& u, const StencilTableDouble& v) {
    const uint64_t rows = uint64_t{u.row_count()} * v.row_count(),
                   sources = uint64_t{u.source_count} * v.source_count;
    const uint64_t entries = uint64_t{u.indices.size()} * v.indices.size();  // each below 2^32
    if (rows >= uint64_t{1} << 31 || sources >= uint64_t{1} << 31 || entries >= uint64_t{1} << 32)
        return Error{ErrorCode::too_large, "a table of 2^31 points or 2^32 entries or more"};
    StencilTableDouble table = make_empty_table(static_cast<uint32_t>(sources));
    SparseRow row;
    for (uint32_t l = 0; l < v.row_count(); ++l) {
        for (uint32_t k = 0; k < u.row_count(); ++k) {
            row.entries.clear();
            for (uint32_t b = v.offsets[l]; b < v.offsets[l + 1]; ++b)
                for (uint32_t a = u.offsets[k]; a < u.offsets[k + 1]; ++a)
                    row.entries.push_back(
                        {v.indices[b] * u.source_count + u.indices[a], v.weights[b] * u.weights[a], 0, 0});
            append_row(table, row, false);
        }
    }
    return table;
}

}  // namespace limn
