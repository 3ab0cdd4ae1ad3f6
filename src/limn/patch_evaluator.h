// One place of one plan's surface, over ring points of any width. Not part of the public interface.
#pragma once

#include <algorithm>
#include <vector>

#include "limn/patch_table.h"
#include "limn/shared/patch_basis.h"
#include "limn/shared/patch_location.h"

namespace limn {

/// Used again to save allocations.
struct PatchScratch {
    std::vector<double> ring;    ///< in: ring points, width each; used up
    std::vector<double> values;  ///< out: value, du, dv, duu, duv, dvv, width each
    std::vector<double> next, origin, point;
};

template <class Real>
struct PatchEvaluator {
    const BasicPatchTable<Real>& table;
    bool triangles;
    size_t width;

    /// Where 2^-depth of a surface no longer matters in double.
    static constexpr uint32_t kMostDepth = 40;

    /// Where evaluation ends: a leaf, or the root where the plan's corner itself is asked for.
    struct Leaf {
        uint32_t plan, node;
        shared::PatchLocation at;
        bool is_corner;
    };

    /// `at`: coordinates of the plan. Calls body(plan, rows, next plan) at each reference on the way.
    template <class Body>
    Leaf find_leaf(uint32_t plan_index, shared::PatchLocation at, const Body& body) const {
        for (uint32_t depth = 0;;) {
            const Plan& plan = table.plans[plan_index];
            const PlanNode* nodes = table.plan_nodes.data() + plan.first_node;
            if (plan.has_corner_rows != 0 && ((at.u == 0 && at.v == 0) || depth >= kMostDepth))
                return {plan_index, 0, at, true};
            uint32_t n = 0;
            while (nodes[n].kind() <= PlanNodeKind::split_v) {
                if (nodes[n].kind() == PlanNodeKind::split) {
                    n = nodes[n].first + shared::descend_location(at, triangles);
                    ++depth;
                } else {
                    const bool along_u = nodes[n].kind() == PlanNodeKind::split_u;
                    n = nodes[n].first + shared::descend_location_half(at, along_u);
                }
            }
            if (nodes[n].kind() != PlanNodeKind::plan) return {plan_index, n, at, false};
            shared::rotate_location(at, nodes[n].rotation(), triangles);
            plan_index = nodes[n].plan();
            body(plan, table.plan_points.data() + plan.first_point + nodes[n].first, table.plans[plan_index]);
        }
    }

    /// Derivatives are by the coordinates that `at` came from.
    void evaluate(uint32_t plan_index, shared::PatchLocation at, PatchScratch& s) const {
        s.values.assign(6 * width, 0.0);
        s.origin.assign(width, 0.0);
        const Leaf leaf =
            find_leaf(plan_index, at, [&](const Plan& plan, const uint32_t* rows, const Plan& next) {
                refine_ring(plan, rows, next.ring_size, s);
            });
        const Plan& plan = table.plans[leaf.plan];
        if (leaf.is_corner) return take_corner(plan, leaf.at, s);
        const PlanNode& node = table.plan_nodes[plan.first_node + leaf.node];
        take_patch(plan, node.kind(), table.plan_points.data() + plan.first_point + node.first, leaf.at, s);
    }

  private:
    void add_row(const Plan& plan, uint32_t row, const std::vector<double>& ring, double* out) const {
        const Real* weights = table.plan_weights.data() + plan.first_weight +
                              size_t{row} * shared::plan_row_stride(plan.ring_size);
        for (uint32_t j = 0; j < plan.ring_size; ++j) {
            const auto weight = static_cast<double>(weights[j]);
            if (weight == 0) continue;
            for (size_t i = 0; i < width; ++i) out[i] += weight * ring[j * width + i];
        }
    }

    /// The ring of the next plan, relative to its first point, which is at the plan's corner: what matters
    /// for derivatives near an extraordinary vertex are differences that shrink with every level, and would
    /// be lost beside the position.
    void refine_ring(const Plan& plan, const uint32_t* rows, uint32_t next_size, PatchScratch& s) const {
        s.next.assign(next_size * width, 0.0);
        for (uint32_t k = 0; k < next_size; ++k) add_row(plan, rows[k], s.ring, s.next.data() + k * width);
        s.ring.swap(s.next);
        for (size_t i = 0; i < width; ++i) s.origin[i] += s.ring[i];
        for (size_t j = next_size; j-- > 0;)
            for (size_t i = 0; i < width; ++i) s.ring[j * width + i] -= s.ring[i];
    }

    void take_corner(const Plan& plan, const shared::PatchLocation& at, PatchScratch& s) const {
        std::copy(s.origin.begin(), s.origin.end(), s.values.begin());
        add_row(plan, shared::kCornerLimitRow, s.ring, s.values.data());
        s.point.assign(2 * width, 0.0);
        for (uint32_t k = 0; k < 2; ++k)
            add_row(plan, shared::kCornerTangentRow + k, s.ring, s.point.data() + k * width);
        // Turned as the face is; their lengths mean nothing, so the scale of `at` is left out.
        const double scale = std::max({std::abs(at.uu), std::abs(at.uv), std::abs(at.vu), std::abs(at.vv)});
        for (size_t i = 0; i < width; ++i) {
            const double t0 = s.point[i], t1 = s.point[width + i];
            s.values[width + i] = (t0 * at.uu + t1 * at.vu) / scale;
            s.values[2 * width + i] = (t0 * at.uv + t1 * at.vv) / scale;
        }
    }

    void take_patch(const Plan& plan, PlanNodeKind kind, const uint32_t* rows,
                    const shared::PatchLocation& at, PatchScratch& s) const {
        shared::Jet basis[shared::kMaxPatchPoints];
        const auto node_kind = static_cast<uint32_t>(kind);
        shared::patch_basis(node_kind, triangles, static_cast<uint32_t>(table.end_cap), at.u, at.v, basis);
        for (uint32_t k = 0; k < shared::patch_point_count(node_kind); ++k) {
            s.point.assign(width, 0.0);
            add_row(plan, rows[k], s.ring, s.point.data());
            const shared::Jet b = shared::jet_of_face(basis[k], at);
            const double factors[6] = {b.f, b.u, b.v, b.uu, b.uv, b.vv};
            for (size_t d = 0; d < 6; ++d)
                for (size_t i = 0; i < width; ++i) s.values[d * width + i] += factors[d] * s.point[i];
        }
        for (size_t i = 0; i < width; ++i) s.values[i] += s.origin[i];
    }
};

}  // namespace limn
