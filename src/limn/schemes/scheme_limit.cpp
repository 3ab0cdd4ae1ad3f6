#include "limn/schemes/scheme_limit.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>

#include "limn/compose.h"
#include "limn/parallel.h"
#include "limn/schemes/star.h"
#include "limn/schemes/star_limit.h"

namespace limn {
namespace {

/// What a regular neighbourhood is made of.
struct RegularKind {
    uint32_t valence, face_size;
};
RegularKind regular_kind(const SubdivisionScheme& scheme) {
    for (const Pass& pass : scheme.passes)
        if (pass.split == SplitKind::hexagons) return {3, 6};
    return scheme.faces == FaceKind::triangles ? RegularKind{6, 3} : RegularKind{4, 4};
}

bool is_regular(const Topology& t, RegularKind kind, uint32_t v) {
    if (is_boundary_vertex(t, v) || face_valence(t, v) != kind.valence || t.vertex_manifold[v] == 0) return false;
    if (t.vertex_sharpness[v] > 0) return false;
    for (const uint32_t e : t.edges_of_vertex(v))
        if (t.edge_sharpness[e] > 0) return false;
    for (const uint32_t c : t.corners_of_vertex(v))
        if (t.size_of_face(t.face_of_corner(c)) != kind.face_size) return false;
    return true;
}

/// One where all is regular as far as `rings` reach.
Array<uint8_t> find_regular(const Stage& stage, RegularKind kind, uint32_t rings, const BuildPart& part) {
    const Topology& t = stage.topology;
    Array<uint8_t> regular, next;
    regular.assign(t.vertex_count, 0);
    if (!stage.intervals.empty()) return regular;
    next.allocate(t.vertex_count);
    for_each_index(t.vertex_count, part, [&](uint32_t v) { regular[v] = is_regular(t, kind, v); });
    for (uint32_t ring = 1; ring < rings; ++ring) {
        for_each_index(t.vertex_count, part, [&](uint32_t v) {
            uint8_t all = regular[v];
            for (uint32_t i = 0; all != 0 && i < face_valence(t, v); ++i)
                for (const uint32_t w : t.vertices_of_face(t.face_of_corner(t.corners_of_vertex(v)[i])))
                    all &= regular[w];
            next[v] = all;
        });
        std::swap(regular, next);
    }
    return regular;
}

/// Where a vertex's row comes from.
struct RowSource {
    const StarMask* mask = nullptr;
    StarStart start;
};

/// A vertex that turns into nothing is represented by the middle one of its faces.
Element middle_face(const Topology& t, uint32_t v) {
    return {true, t.face_of_corner(t.corners_of_vertex(v)[face_valence(t, v) / 2])};
}

class LimitRows {
  public:
    LimitRows(const Stage& stage, const SubdivisionScheme& scheme, StarLimits& limits)
        : stage_(stage), scheme_(scheme), limits_(limits) {}

    /// Errors: those of StarLimits::make; Error::element is the vertex.
    Result<RowSource> find(uint32_t v, StarWalk& walk) {
        const Topology& t = stage_.topology;
        auto source = find_element({false, v}, walk);
        if (source && !source->mask->exists && face_valence(t, v) != 0) source = find_element(middle_face(t, v), walk);
        if (source) return source;
        Error error = source.error();
        return Error{error.code, "vertex " + std::to_string(v) + " " + error.message, v};
    }

    /// All regular vertices have this one's mask, whichever corner they begin at.
    void set_regular(const RowSource& source) {
        regular_ = source.mask;
        StarWalk walk;
        walk.walk(stage_.topology, source.start, regular_->rings);
        regular_size_ = walk.vertices.size();
    }
    bool has_regular() const { return regular_ != nullptr; }
    /// Nothing where the mesh is so small that it meets itself.
    RowSource find_regular(uint32_t v, StarWalk& walk) const {
        const RowSource source{regular_, {{false, v}, 0}};
        walk.walk(stage_.topology, source.start, regular_->rings);
        return walk.vertices.size() == regular_size_ ? source : RowSource{};
    }

  private:
    Result<RowSource> find_element(Element element, StarWalk& walk) {
        const StarStart start = canonical_start(stage_, element, scheme_.period, patch_rings(scheme_), walk);
        const auto key = patch_key(stage_, element, scheme_.period, patch_rings(scheme_), walk);
        if (const StarMask* mask = limits_.find(key)) return RowSource{mask, start};
        auto mask = limits_.make(make_patch(stage_, element, scheme_.period, patch_rings(scheme_), walk));
        if (!mask) return mask.error();
        return RowSource{*mask, start};
    }

    const Stage& stage_;
    const SubdivisionScheme& scheme_;
    StarLimits& limits_;
    const StarMask* regular_ = nullptr;
    size_t regular_size_ = 0;
};

/// The first error of a parallel loop, by vertex.
class FirstError {
  public:
    void add(Error error) {
        const std::lock_guard lock(mutex_);
        if (!error_ || error.element < error_->element) error_ = std::move(error);
    }
    const std::optional<Error>& error() const { return error_; }

  private:
    std::mutex mutex_;
    std::optional<Error> error_;
};

/// body(vertex, walk) in parallel, each thread with a walk of its own.
template <class Body>
void for_each_vertex(uint32_t count, const BuildPart& part, const Body& body) {
    for_each_block(count, part, 512, [&](uint32_t begin, uint32_t end) {
        StarWalk walk;
        for (uint32_t v = begin; v != end; ++v) body(v, walk);
    });
}

Result<Array<RowSource>> find_sources(const Stage& stage, const SubdivisionScheme& scheme, LimitRows& rows,
                                      const BuildPart& part) {
    const uint32_t count = stage.topology.vertex_count;
    Array<RowSource> sources;
    sources.assign(count, {});
    const Array<uint8_t> regular = find_regular(stage, regular_kind(scheme), patch_rings(scheme), part.part(0, 0.2f));
    if (auto ok = part.check(); !ok) return ok.error();
    FirstError errors;
    const auto* first = std::find(regular.begin(), regular.end(), uint8_t{1});
    if (first != regular.end()) {
        StarWalk walk;
        auto source = rows.find(static_cast<uint32_t>(first - regular.begin()), walk);
        if (!source) return source.error();
        rows.set_regular(*source);
    }
    for_each_vertex(count, part.part(0.2f, 1), [&](uint32_t v, StarWalk& walk) {
        if (regular[v] != 0) sources[v] = rows.find_regular(v, walk);
        if (sources[v].mask != nullptr) return;
        auto source = rows.find(v, walk);
        if (source)
            sources[v] = *source;
        else
            errors.add(source.error());
    });
    if (auto ok = part.check(); !ok) return ok.error();
    if (errors.error()) return *errors.error();
    return sources;
}

template <class Real>
void fill_row(const RowSource& source, const StarWalk& walk, uint32_t at, BasicStencilTable<Real>& table) {
    const StarMask& mask = *source.mask;
    for (size_t i = 0; i < mask.labels.size(); ++i, ++at) {
        table.indices[at] = walk.vertices[mask.labels[i]];
        table.weights[at] = static_cast<Real>(mask.position[i]);
        if (table.tangent1_weights.empty()) continue;
        table.tangent1_weights[at] = static_cast<Real>(mask.tangent1[i]);
        table.tangent2_weights[at] = static_cast<Real>(mask.tangent2[i]);
    }
}

}  // namespace

template <class Real>
Result<BasicStencilTable<Real>> build_scheme_limit_table(const BasicSchemeRefinement<Real>& refined, bool tangents,
                                                         StarLimits& limits, const BuildPart& control) {
    if (auto ok = control.start(); !ok) return ok.error();
    const Stage& stage = refined.last;
    const uint32_t count = stage.topology.vertex_count;
    if (stage.topology.face_edges.empty() && stage.topology.face_count != 0)
        return Error{ErrorCode::invalid_argument, "limits need a refinement with full_last_level"};
    LimitRows rows(stage, *refined.scheme, limits);
    const auto sources = find_sources(stage, *refined.scheme, rows, control.part(0, 0.7f));
    if (!sources) return sources.error();
    BasicStencilTable<Real> table;
    table.source_count = count;
    table.offsets.allocate(size_t{count} + 1);
    table.offsets.back() = 0;
    for (uint32_t v = 0; v < count; ++v) table.offsets[v] = static_cast<uint32_t>((*sources)[v].mask->labels.size());
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    table.indices.allocate(table.offsets.back());
    table.weights.allocate(table.offsets.back());
    if (tangents) {
        table.tangent1_weights.allocate(table.offsets.back());
        table.tangent2_weights.allocate(table.offsets.back());
    }
    for_each_vertex(count, control.part(0.7f, 1), [&](uint32_t v, StarWalk& walk) {
        const RowSource& source = (*sources)[v];
        walk.walk(stage.topology, source.start, source.mask->rings);
        fill_row(source, walk, table.offsets[v], table);
    });
    if (auto ok = control.reach(1); !ok) return ok.error();
    return table;
}

template <class Real>
Result<BasicStencilTable<Real>> build_scheme_limit_table(const BasicSchemeRefinement<Real>& refined, bool tangents,
                                                         const BuildPart& control) {
    StarLimits limits(*refined.scheme, patch_rings(*refined.scheme));
    return build_scheme_limit_table(refined, tangents, limits, control);
}

#define LIMN_INSTANTIATE(Real)                                                                                     \
    template Result<BasicStencilTable<Real>> build_scheme_limit_table(const BasicSchemeRefinement<Real>&, bool,    \
                                                                      const BuildPart&);                           \
    template Result<BasicStencilTable<Real>> build_scheme_limit_table(const BasicSchemeRefinement<Real>&, bool,    \
                                                                      StarLimits&, const BuildPart&);
LIMN_INSTANTIATE(float)
LIMN_INSTANTIATE(double)
#undef LIMN_INSTANTIATE

}  // namespace limn
