#include "limn/evaluate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "limn/parallel.h"
#include "limn/topology.h"

namespace limn {
namespace {

/// A value and its derivatives by u and v.
struct Jet {
    double f = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
};
Jet operator+(const Jet& a, const Jet& b) {
    return {a.f + b.f, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
}
Jet operator*(double s, const Jet& a) {
    return {s * a.f, s * a.u, s * a.v, s * a.uu, s * a.uv, s * a.vv};
}
Jet operator*(const Jet& a, const Jet& b) {
    return {a.f * b.f,
            a.u * b.f + a.f * b.u,
            a.v * b.f + a.f * b.v,
            a.uu * b.f + 2 * a.u * b.u + a.f * b.uu,
            a.uv * b.f + a.u * b.v + a.v * b.u + a.f * b.uv,
            a.vv * b.f + 2 * a.v * b.v + a.f * b.vv};
}

using Basis = std::array<Jet, 16>;

/// Uniform cubic B-spline: values, first and second derivatives of the four functions at t.
void cubic(double t, double (&f)[4], double (&d)[4], double (&dd)[4]) {
    const double s = 1 - t;
    f[0] = s * s * s / 6;
    f[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
    f[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
    f[3] = t * t * t / 6;
    d[0] = -s * s / 2;
    d[1] = (3 * t * t - 4 * t) / 2;
    d[2] = (4 * s - 3 * s * s) / 2;
    d[3] = t * t / 2;
    dd[0] = s;
    dd[1] = 3 * t - 2;
    dd[2] = 3 * s - 2;
    dd[3] = t;
}

void bicubic_basis(double u, double v, Basis& basis) {
    double a[4], da[4], dda[4], b[4], db[4], ddb[4];
    cubic(u, a, da, dda);
    cubic(v, b, db, ddb);
    for (size_t j = 0; j < 4; ++j)
        for (size_t i = 0; i < 4; ++i)
            basis[4 * j + i] = {a[i] * b[j],   da[i] * b[j],  a[i] * db[j],
                                dda[i] * b[j], da[i] * db[j], a[i] * ddb[j]};
}

/// Quartic box spline (Stam 1998) over the lattice points of rows v = -1, 0, 1, 2.
void box_spline_basis(double u, double v, Basis& basis) {
    const Jet x[3] = {{1 - u - v, -1, -1, 0, 0, 0}, {u, 1, 0, 0, 0, 0}, {v, 0, 1, 0, 0, 0}};
    // Around corner k: itself, the point across the edge to the next corner, and the two that lie beyond.
    constexpr size_t own[3] = {4, 5, 8}, across[3] = {1, 9, 7}, beyond_next[3] = {0, 6, 10},
                     beyond_previous[3] = {3, 2, 11};
    for (size_t k = 0; k < 3; ++k) {
        const Jet &a = x[k], &b = x[(k + 1) % 3], &c = x[(k + 2) % 3];
        const Jet aa = a * a, bb = b * b, cc = c * c, aaa = aa * a, bbb = bb * b, ccc = cc * c;
        const Jet bc = b * c;
        basis[own[k]] = (1.0 / 12) * (6 * (aa * aa) + 24 * (aaa * (b + c)) + aa * (24 * (bb + cc) + 60 * bc) +
                                      a * (8 * (bbb + ccc) + 36 * (bc * (b + c))) + bb * bb + cc * cc +
                                      6 * (bc * (bb + cc)) + 12 * (bc * bc));
        basis[across[k]] = (1.0 / 12) * (aa * aa + bb * bb + 2 * (c * (aaa + bbb)) + 6 * (a * b * (aa + bb)) +
                                         6 * (a * bc * (a + b)) + 12 * (aa * bb));
        basis[beyond_next[k]] = (1.0 / 12) * (aa * aa + 2 * (aaa * b));
        basis[beyond_previous[k]] = (1.0 / 12) * (aa * aa + 2 * (aaa * c));
    }
}

void bilinear_basis(double u, double v, Basis& basis) {
    basis[0] = {(1 - u) * (1 - v), v - 1, u - 1, 0, 1, 0};
    basis[1] = {u * (1 - v), 1 - v, -u, 0, -1, 0};
    basis[2] = {u * v, v, u, 0, 1, 0};
    basis[3] = {(1 - u) * v, -v, 1 - u, 0, -1, 0};
}

void linear_basis(double u, double v, Basis& basis) {
    basis[0] = {1 - u - v, -1, -1, 0, 0, 0};
    basis[1] = {u, 1, 0, 0, 0, 0};
    basis[2] = {v, 0, 1, 0, 0, 0};
}

/// Where a sample is: coordinates within the node reached, and how they depend on those of the ptex face.
struct Location {
    double u, v;
    double uu = 1, uv = 0, vu = 0, vv = 1;  ///< d(node's u)/d(face's u), d(u)/d(v), d(v)/d(u), d(v)/d(v)

    /// u <- u0 + a u + b v, v <- v0 + c u + d v.
    void map(double u0, double a, double b, double v0, double c, double d) {
        const Location o = *this;
        u = u0 + a * o.u + b * o.v;
        v = v0 + c * o.u + d * o.v;
        uu = a * o.uu + b * o.vu;
        uv = a * o.uv + b * o.vv;
        vu = c * o.uu + d * o.vu;
        vv = c * o.uv + d * o.vv;
    }
};

struct Evaluator {
    const PatchTableDouble& table;
    bool triangles;
    uint32_t width;

    /// Which of four children the location is in; moves there.
    uint32_t descend(Location& at) const {
        if (triangles) {
            if (at.u > 0.5) return at.map(-1, 2, 0, 0, 0, 2), 1;
            if (at.v > 0.5) return at.map(0, 2, 0, -1, 0, 2), 2;
            if (at.u + at.v > 0.5) return at.map(1, -2, 0, 1, 0, -2), 3;
            return at.map(0, 2, 0, 0, 0, 2), 0;
        }
        const bool right = at.u > 0.5, upper = at.v > 0.5;
        at.map(right ? -1 : 0, 2, 0, upper ? -1 : 0, 0, 2);
        return upper ? (right ? 2 : 3) : (right ? 1 : 0);
    }

    void rotate(Location& at, uint32_t rotation) const {
        for (uint32_t i = 0; i < rotation; ++i) {
            if (triangles)
                at.map(0, 0, 1, 1, -1, -1);
            else
                at.map(0, 0, 1, 1, -1, 0);
        }
    }

    /// Where the next descent would be lost in rounding: the limits of the corners, joined linearly.
    static constexpr uint32_t kMostDepth = 36;

    void evaluate(uint32_t plan_index, Location at, std::vector<double>& ring, std::vector<double>& scratch,
                  double* result, Derivatives derivatives) const {
        uint32_t depth = 0;
        for (;;) {
            const Plan& plan = table.plans[plan_index];
            const PlanNode* nodes = table.plan_nodes.data() + plan.first_node;
            const uint32_t* points = table.plan_points.data() + plan.first_point;
            uint32_t n = 0;
            if (depth >= kMostDepth && nodes[0].kind == PlanNodeKind::split) {
                constexpr uint32_t corners[4] = {0, 1, 2, 3};
                return combine(plan, PlanNodeKind::bilinear, corners, at, ring, result, derivatives);
            }
            while (nodes[n].kind <= PlanNodeKind::split_v) {
                const PlanNode& node = nodes[n];
                if (node.kind == PlanNodeKind::split) {
                    n = node.first + descend(at);
                    ++depth;
                } else if (node.kind == PlanNodeKind::split_u) {
                    const bool upper = at.u > 0.5;
                    at.map(upper ? -1 : 0, 2, 0, 0, 0, 1);
                    n = node.first + upper;
                } else {
                    const bool upper = at.v > 0.5;
                    at.map(0, 1, 0, upper ? -1 : 0, 0, 2);
                    n = node.first + upper;
                }
            }
            if (nodes[n].kind != PlanNodeKind::plan)
                return combine(plan, nodes[n].kind, points + nodes[n].first, at, ring, result, derivatives);
            rotate(at, nodes[n].rotation);
            plan_index = nodes[n].plan;
            const uint32_t next_size = table.plans[plan_index].ring_size;
            scratch.assign(size_t{next_size} * width, 0.0);
            for (uint32_t k = 0; k < next_size; ++k)
                add_row(plan, points[nodes[n].first + k], ring, scratch.data() + size_t{k} * width);
            ring.swap(scratch);
        }
    }

    void add_row(const Plan& plan, uint32_t row, const std::vector<double>& ring, double* out) const {
        const double* weights = table.plan_weights.data() + plan.first_weight + size_t{row} * plan.ring_size;
        for (uint32_t j = 0; j < plan.ring_size; ++j)
            for (uint32_t i = 0; i < width; ++i) out[i] += weights[j] * ring[size_t{j} * width + i];
    }

    void combine(const Plan& plan, PlanNodeKind kind, const uint32_t* rows, const Location& at,
                 const std::vector<double>& ring, double* result, Derivatives derivatives) const {
        Basis basis;
        uint32_t count = 16;
        if (kind == PlanNodeKind::bicubic) {
            bicubic_basis(at.u, at.v, basis);
        } else if (kind == PlanNodeKind::box_spline) {
            box_spline_basis(at.u, at.v, basis);
            count = 12;
        } else if (triangles) {
            linear_basis(at.u, at.v, basis);
            count = 3;
        } else {
            bilinear_basis(at.u, at.v, basis);
            count = 4;
        }
        std::vector<double> point(width);
        for (uint32_t k = 0; k < count; ++k) {
            std::fill(point.begin(), point.end(), 0.0);
            add_row(plan, rows[k], ring, point.data());
            const Jet& b = basis[k];
            const double du = b.u * at.uu + b.v * at.vu, dv = b.u * at.uv + b.v * at.vv;
            const double factors[6] = {
                b.f,
                du,
                dv,
                b.uu * at.uu * at.uu + 2 * b.uv * at.uu * at.vu + b.vv * at.vu * at.vu,
                b.uu * at.uu * at.uv + b.uv * (at.uu * at.vv + at.uv * at.vu) + b.vv * at.vu * at.vv,
                b.uu * at.uv * at.uv + 2 * b.uv * at.uv * at.vv + b.vv * at.vv * at.vv};
            for (uint32_t d = 0; d < value_count(derivatives); ++d)
                for (uint32_t i = 0; i < width; ++i) result[d * width + i] += factors[d] * point[i];
        }
    }

    SampleStatus sample(const PatchSample& s, std::span<const double> points, std::vector<double>& ring,
                        std::vector<double>& scratch, double* result, Derivatives derivatives) const {
        if (s.face >= table.ptex_surfaces.size() || !(s.u >= 0 && s.u <= 1 && s.v >= 0 && s.v <= 1) ||
            (triangles && s.u + s.v > 1 + 1e-12))
            return SampleStatus::out_of_range;
        uint32_t surface_index = table.ptex_surfaces[s.face];
        if (surface_index == kInvalidIndex) return SampleStatus::hole;
        Location at{s.u, s.v};
        if ((surface_index & kPtexSplit) != 0) surface_index = (surface_index & ~kPtexSplit) + descend(at);
        const Surface& surface = table.surfaces[surface_index];
        rotate(at, surface.rotation);
        const uint32_t ring_size = table.plans[surface.plan].ring_size;
        ring.resize(size_t{ring_size} * width);
        for (uint32_t j = 0; j < ring_size; ++j)
            std::copy_n(points.data() + size_t{table.ring_points[surface.first_ring + j]} * width, width,
                        ring.data() + size_t{j} * width);
        evaluate(surface.plan, at, ring, scratch, result, derivatives);
        return SampleStatus::valid;
    }
};

}  // namespace

void build_patch_points(const PatchTableDouble& table, std::span<const double> control_points, uint32_t width,
                        std::span<double> points) {
    const size_t control = size_t{table.control_count} * width;
    assert(control_points.size() >= control && points.size() >= size_t{table.point_count()} * width);
    std::copy_n(control_points.begin(), control, points.begin());
    if (table.stencils.row_count() != 0)
        apply_stencil_table<double>(table.stencils, control_points, points.subspan(control), width);
}

void evaluate_patches(const PatchTableDouble& table, std::span<const PatchSample> samples,
                      std::span<const double> points, uint32_t width, Derivatives derivatives,
                      std::span<double> results, std::span<SampleStatus> statuses) {
    const size_t stride = size_t{value_count(derivatives)} * width;
    assert(points.size() >= size_t{table.point_count()} * width);
    assert(results.size() >= samples.size() * stride && statuses.size() >= samples.size());
    const Evaluator evaluator{table, table.options.scheme == Scheme::loop, width};
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, samples.size(), 256), [&](const tbb::blocked_range<size_t>& r) {
            std::vector<double> ring, scratch;
            for (size_t s = r.begin(); s != r.end(); ++s) {
                double* result = results.data() + s * stride;
                std::fill_n(result, stride, 0.0);
                statuses[s] = evaluator.sample(samples[s], points, ring, scratch, result, derivatives);
            }
        });
}

}  // namespace limn
