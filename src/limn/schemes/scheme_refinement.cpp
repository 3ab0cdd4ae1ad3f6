#include "limn/schemes/scheme_refinement.h"

#include <cmath>
#include <string>

#include "limn/row_table.h"
#include "limn/schemes/scheme_pass.h"
#include "limn/schemes/star.h"

namespace limn {
namespace {

constexpr uint64_t kMaxCorners = 0x7fffffff;

bool splits(const SubdivisionScheme& scheme, SplitKind kind) {
    for (const Pass& pass : scheme.passes)
        if (pass.split == kind) return true;
    return false;
}

std::string named(const char* what, uint64_t index) {
    return std::string(what) + " " + std::to_string(index);
}

Error refuse(ErrorCode code, const SubdivisionScheme& scheme, const std::string& cause, uint64_t element) {
    return Error{code, std::string(scheme.title) + " " + cause, element};
}

/// Everything but Catmull-Clark, Loop and bilinear rows, which have rules for it, takes manifolds.
Result<void> check_manifold(const Topology& t, const SubdivisionScheme& scheme) {
    for (uint32_t e = 0; e < t.edge_count; ++e) {
        const auto at = t.corners_of_edge(e);
        const bool turned = at.size() == 2 && t.face_vertices[at[0]] == t.face_vertices[at[1]];
        if (at.size() <= 2 && !turned) continue;
        return refuse(ErrorCode::unsupported, scheme,
                      std::string(turned ? "takes faces of one winding" : "takes no edges of three faces") +
                          ": the edge of vertices " + std::to_string(t.edge_vertices[2 * e]) + " and " +
                          std::to_string(t.edge_vertices[2 * e + 1]),
                      e);
    }
    for (uint32_t v = 0; v < t.vertex_count; ++v)
        if (t.vertex_manifold[v] == 0 && face_valence(t, v) != 0)
            return refuse(ErrorCode::unsupported, scheme,
                          "takes vertices with one fan of faces: " + named("vertex", v) + " has more", v);
    return {};
}

Result<void> check_intervals(const ControlMesh& mesh, std::span<const double> intervals) {
    if (intervals.empty()) return {};
    if (intervals.size() != mesh.face_vertices.size())
        return Error{ErrorCode::invalid_argument, "knot intervals are not one for each face corner"};
    for (size_t c = 0; c < intervals.size(); ++c)
        if (!(intervals[c] >= 0) || !std::isfinite(intervals[c]))
            return Error{ErrorCode::invalid_argument,
                         named("the knot interval of corner", c) + " is negative or no number", c};
    return {};
}

}  // namespace

void pass_row(const Stage& parent, const Pass& pass, const SplitMesh& split, uint32_t i, Row& row) {
    size_t block = 0;
    while (i >= split.blocks[block].first + split.blocks[block].count) ++block;
    const PointBlock& points = split.blocks[block];
    pass.rows[static_cast<size_t>(points.origin)](parent, points.parent(i - points.first), row);
}

template <class Real>
Result<BasicStencilTable<Real>> build_pass_table(const Stage& parent, const Pass& pass, const SplitMesh& split,
                                                 const BuildPart& part) {
    return build_table_of_rows<Real>(parent.topology.vertex_count, split.point_count(), part,
                                     [&](uint32_t r, Row& row) { pass_row(parent, pass, split, r, row); });
}

Stage advance_stage(Stage&& parent, const Pass& pass, SplitMesh&& split, bool step_is_done) {
    Stage child;
    child.step = parent.step + step_is_done;
    child.topology = pass.split == SplitKind::none ? std::move(parent.topology) : std::move(split.child);
    if (pass.intervals != nullptr && !parent.intervals.empty() && !child.topology.face_edges.empty())
        pass.intervals(parent, child);
    else if (pass.split == SplitKind::none)
        child.intervals = std::move(parent.intervals);
    return child;
}

Result<void> check_scheme_faces(const ControlMesh& mesh, const SubdivisionScheme& scheme) {
    const uint32_t size = scheme.faces == FaceKind::triangles ? 3 : scheme.faces == FaceKind::quads ? 4 : 0;
    for (uint32_t f = 0; size != 0 && f < mesh.face_count(); ++f) {
        const uint32_t corners = mesh.face_offsets[f + 1] - mesh.face_offsets[f];
        if (corners != size)
            return refuse(size == 3 ? ErrorCode::not_a_triangle : ErrorCode::unsupported, scheme,
                          std::string("takes ") + (size == 3 ? "triangles" : "quads") + " only: " + named("face", f) +
                              " has " + std::to_string(corners) + " vertices",
                          f);
    }
    return {};
}

Result<Stage> build_first_stage(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                std::span<const double> intervals, const BuildPart& part) {
    if (auto ok = check_scheme_faces(mesh, scheme); !ok) return ok.error();
    if (auto ok = check_intervals(mesh, intervals); !ok) return ok.error();
    ControlMesh own = mesh;
    own.options.scheme = splits(scheme, SplitKind::triangles) ? Scheme::loop : Scheme::catmull_clark;
    own.channels.clear();
    if (scheme.creases == CreaseRules::none) {
        own.crease_edges.clear();
        own.crease_sharpness.clear();
        own.corner_vertices.clear();
        own.corner_sharpness.clear();
    }
    Stage stage;
    stage.topology = build_topology(own, part);
    if (auto ok = part.check(); !ok) return ok.error();
    if (scheme.creases == CreaseRules::none) {
        if (!own.holes.empty())
            return refuse(ErrorCode::unsupported, scheme, "knows no holes: " + named("face", own.holes[0]),
                          own.holes[0]);
        if (auto ok = check_manifold(stage.topology, scheme); !ok) return ok.error();
        show_all_faces(stage.topology);
    }
    stage.intervals.allocate(intervals.size());
    std::copy(intervals.begin(), intervals.end(), stage.intervals.begin());
    return stage;
}

template <class Real>
Result<BasicSchemeRefinement<Real>> build_scheme_refinement(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                                            const SchemeRefinementOptions& options,
                                                            std::span<const double> intervals) {
    if (auto ok = options.control.start(); !ok) return ok.error();
    BasicSchemeRefinement<Real> out;
    out.scheme = &scheme;
    out.control_count = mesh.vertex_count;
    auto first = build_first_stage(mesh, scheme, intervals, options.control.part(0, 0.05f));
    if (!first) return first.error();
    out.control_edges = first->topology.edge_vertices;
    out.last = std::move(*first);
    const size_t pass_count = scheme.passes.size(), count = pass_count * options.level;
    for (size_t i = 0; i < count; ++i) {
        const Pass& pass = scheme.passes[i % pass_count];
        const auto from = static_cast<float>(i) / static_cast<float>(count),
                   to = static_cast<float>(i + 1) / static_cast<float>(count);
        const BuildPart part = options.control.part(0.05f, 1).part(from, to);
        if (uint64_t{4} * out.mesh().corner_count() > kMaxCorners)
            return Error{ErrorCode::too_large,
                         named("step", i / pass_count + 1) + " would have more than 2^31 - 1 face corners"};
        const bool full = i + 1 < count || options.full_last_level;
        SplitMesh split = split_mesh(out.last, pass.split, full, part.part(0, 0.5f));
        if (auto ok = part.check(); !ok) return ok.error();
        auto table = build_pass_table<Real>(out.last, pass, split, part.part(0.5f, 1));
        if (!table) return table.error();
        out.tables.push_back(std::move(*table));
        out.last = advance_stage(std::move(out.last), pass, std::move(split), (i + 1) % pass_count == 0);
    }
    if (auto ok = options.control.reach(1); !ok) return ok.error();
    return out;
}

template <class Real>
Result<BasicStencilTable<Real>> multiply_tables(std::span<const BasicStencilTable<Real>> tables,
                                                const BuildPart& control) {
    BasicStencilTable<Real> product = tables[0];
    for (size_t i = 1; i < tables.size(); ++i) {
        const BasicStencilTable<Real>& next = tables[i];
        auto table = build_table_of_rows<Real>(
            product.source_count, next.row_count(),
            control.part(static_cast<float>(i - 1) / static_cast<float>(tables.size() - 1),
                         static_cast<float>(i) / static_cast<float>(tables.size() - 1)),
            [&](uint32_t r, Row& row) {
                for (uint32_t k = next.offsets[r]; k < next.offsets[r + 1]; ++k) {
                    const uint32_t point = next.indices[k];
                    for (uint32_t j = product.offsets[point]; j < product.offsets[point + 1]; ++j)
                        row.push_back({product.indices[j],
                                       static_cast<double>(next.weights[k]) * static_cast<double>(product.weights[j])});
                }
            });
        if (!table) return table.error();
        product = std::move(*table);
    }
    return product;
}

#define LIMN_INSTANTIATE(Real)                                                                                  \
    template Result<BasicStencilTable<Real>> build_pass_table(const Stage&, const Pass&, const SplitMesh&,      \
                                                              const BuildPart&);                                \
    template Result<BasicSchemeRefinement<Real>> build_scheme_refinement(                                       \
        const ControlMesh&, const SubdivisionScheme&, const SchemeRefinementOptions&, std::span<const double>); \
    template Result<BasicStencilTable<Real>> multiply_tables(std::span<const BasicStencilTable<Real>>,          \
                                                             const BuildPart&);
LIMN_INSTANTIATE(float)
LIMN_INSTANTIATE(double)
#undef LIMN_INSTANTIATE

}  // namespace limn
