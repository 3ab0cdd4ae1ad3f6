// Writes the tree and the rows of one plan. Not part of the public interface.
#pragma once

#include "limn/plan_scratch.h"
#include "limn/shared/patch_table_layout.h"

namespace limn {

struct PlanWriter {
    const SchemeOptions& scheme;
    const PlanOptions& options;
    const KnownPlans& known;
    NewPlan& out;
    BuiltPlan& plan;
    PlanScratch& scratch;

    size_t width() const { return plan.ring_size; }
    PlanRows& rows() const { return scratch.rows; }

    void write_corner_rows(const Topology& t, const VertexRows& rows);
    /// Around the first vertex of face 0, which `vertices` tells the rows of.
    void write_limit_rows(const Topology& star, const std::vector<uint32_t>& vertices, const VertexRows& rows);

    template <class Point>
    void add_point(const Point& point, LazyRows& from, double* to) const {
        for (const RowEntry& e : point) {
            const double* row = from.row(e.index);
            for (size_t j = 0; j < width(); ++j) to[j] += e.weight * row[j];
        }
    }
    /// The number of the row of a sum of vertices.
    template <class Point>
    uint32_t write_point(const Point& point, LazyRows& from) const {
        if (point.size() == 1 && point.begin()->weight == 1) return from.write(point.begin()->index, rows());
        scratch.row.assign(width(), 0.0);
        add_point(point, from, scratch.row.data());
        return rows().write(scratch.row.data());
    }
    void begin_node(uint32_t node, PlanNodeKind kind) {
        plan.nodes[node] = {shared::pack_node(static_cast<uint32_t>(kind), 0, 0),
                            static_cast<uint32_t>(plan.points.size())};
    }
    uint32_t add_nodes(uint32_t count) {
        const auto first = static_cast<uint32_t>(plan.nodes.size());
        plan.nodes.resize(plan.nodes.size() + count);
        return first;
    }

    void write_crease(uint32_t node, const PatchPoints& patch, LazyRows& from);
    void write_leaf(uint32_t node, const PatchPoints& patch, LazyRows& from) {
        if (patch.crease_sharpness > 0) return write_crease(node, patch, from);
        begin_node(node, patch.kind);
        for (uint32_t k = 0; k < patch.count; ++k) plan.points.push_back(write_point(patch.points[k], from));
    }
    void write_quad_patch(uint32_t node, const QuadNet& net, const QuadPattern& pattern, LazyRows& from) {
        // Patches along a crease are alike all over a mesh, and take many rows: one plan serves them.
        if (pattern.crease_sharpness > 0) return write_patch_reference(node, net, pattern, from);
        if (pattern.sharp_edges != 0) return write_leaf(node, make_quad_patch(net, pattern), from);
        begin_node(node, PlanNodeKind::bicubic);
        for (const uint32_t v : net) plan.points.push_back(from.write(v, rows()));
    }
    bool write_regular(uint32_t node, const Topology& t, uint32_t face, LazyRows& from);
    void write_gregory(uint32_t node, const Topology& t, uint32_t face, LazyRows& from);
    /// A node that goes on with another plan.
    template <class MakeRequest>
    void write_plan_node(uint32_t node, uint32_t rotation, const PlanKey& key, const std::vector<uint32_t>& ring,
                         LazyRows& from, const MakeRequest& make_request) {
        const auto first = static_cast<uint32_t>(plan.points.size());
        for (const uint32_t v : ring) plan.points.push_back(from.write(v, rows()));
        size_t at = 0;
        while (at < out.references.size() && out.references[at].key != key) ++at;
        plan.nodes[node] = {
            shared::pack_node(static_cast<uint32_t>(PlanNodeKind::plan), static_cast<uint32_t>(at), rotation), first};
        if (at < out.references.size()) return;
        out.references.push_back({key, {}});
        if (!known.contains(key)) out.references.back().request = make_request();
    }
    void write_reference(uint32_t node, const Topology& t, uint32_t face, LazyRows& from);
    void write_patch_reference(uint32_t node, const QuadNet& net, const QuadPattern& pattern, LazyRows& from);
    void write_star_reference(uint32_t node, uint32_t rotation, const QuadStar& star, const std::vector<uint32_t>& ring,
                              LazyRows& from);
    void split(uint32_t node, const Topology& t, const VertexRows& rows, uint32_t depth);
    void write_root(const Topology& t, const VertexRows& rows);
    void write_star_root(const QuadStar& star, const VertexRows& rows);
    void write_patch_root(const PatchPoints& patch, const VertexRows& rows) {
        scratch.root.begin(rows, plan.ring_size);
        write_leaf(add_nodes(1), patch, scratch.root);
    }
};

}  // namespace limn
