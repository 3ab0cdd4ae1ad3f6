#include "limn/stencil_table.h"

#include <algorithm>
#include <string>
#include <vector>

#include "limn/compose.h"
#include "limn/row_table.h"
#include "limn/stencil_row.h"

namespace limn {
namespace {

template <class Real>
BasicStencilTable<Real> identity_table(const Refinement& refinement) {
    BasicStencilTable<Real> table;
    const uint32_t rows = refinement.levels[0].vertex_count;
    table.source_count = refinement.control_count;
    table.offsets.allocate(size_t{rows} + 1);
    table.indices.allocate(rows);
    table.weights.assign(rows, Real{1});
    for (uint32_t r = 0; r <= rows; ++r) table.offsets[r] = r;
    for (uint32_t r = 0; r < rows; ++r)
        table.indices[r] = refinement.control_indices.empty() ? r : refinement.control_indices[r];
    return table;
}

}  // namespace

Error too_many_entries(uint64_t entries) {
    return Error{ErrorCode::too_large,
                 "a stencil table of " + std::to_string(entries) + " entries, more than 2^32 - 1"};
}

Result<void> offsets_from_sizes(Array<uint32_t>& sizes) {
    uint64_t sum = 0;
    for (uint32_t& size : sizes) {
        const uint64_t next = sum + size;
        if (next > kMaxTableEntries) return too_many_entries(next);
        size = static_cast<uint32_t>(sum);
        sum = next;
    }
    return {};
}

template <class Real>
Result<BasicStencilTable<Real>> build_step_table(const Refinement& refinement, uint32_t level,
                                                 Interpolation interpolation, const BuildPart& control) {
    if (auto ok = control.start(); !ok) return ok.error();
    const bool available = level >= 1 && level <= refinement.level_count();
    if (!available || refinement.levels[level - 1].face_edges.empty())
        return Error{ErrorCode::invalid_argument,
                     "the step to level " + std::to_string(level) + " needs level - 1 with its edges"};
    const Topology& parent = refinement.levels[level - 1];
    const uint32_t rows = child_of_edge(parent, parent.edge_count);
    return build_table_of_rows<Real>(
        parent.vertex_count, rows, control,
        [&](uint32_t r, Row& row) { refinement_row(parent, r, interpolation, row); });
}

template <class Real>
Result<BasicStencilTable<Real>> build_stencil_table(const Refinement& refinement, uint32_t level,
                                                    Interpolation interpolation, const BuildPart& control) {
    if (level == 0) {
        if (auto ok = control.reach(1); !ok) return ok.error();
        return identity_table<Real>(refinement);
    }
    if (level == 1 && refinement.control_indices.empty())
        return build_step_table<Real>(refinement, level, interpolation, control);
    return compose<Real>(refinement, {level, interpolation, Target::refined, control});
}

template <class Real>
Result<BasicStencilTable<Real>> build_limit_table(const Refinement& refinement, uint32_t level,
                                                  bool tangents, const BuildPart& control) {
    const Target target = tangents ? Target::limit_with_tangents : Target::limit;
    return compose<Real>(refinement, {level, Interpolation::vertex, target, control});
}

template <class Real>
Result<BasicStencilTable<Real>> build_limit_step_table(const Refinement& refinement, bool tangents,
                                                       const BuildPart& control) {
    if (auto ok = control.start(); !ok) return ok.error();
    const Topology& last = refinement.last();
    const uint32_t size = last.options.scheme == Scheme::loop ? 3 : 4;
    if (last.face_edges.empty())
        return Error{ErrorCode::unsupported,
                     "limits of a level need a refinement built with full_last_level"};
    if (last.face_size != size && last.options.scheme != Scheme::bilinear)
        return Error{ErrorCode::unsupported, "limits of a level need faces of " + std::to_string(size) +
                                                 " vertices: refine at least once"};
    BasicStencilTable<Real> table;
    table.source_count = last.vertex_count;
    table.offsets.allocate(size_t{last.vertex_count} + 1);
    table.offsets.back() = 0;
    for_each_row(last.vertex_count, control.part(0, 0.5f), [&](uint32_t v, Row& row) {
        std::vector<TangentWeights> ignored;
        limit_row(last, v, row, ignored);
        merge_repeated(row);
        table.offsets[v] = static_cast<uint32_t>(row.size());
    });
    if (auto ok = control.check(); !ok) return ok.error();
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    const size_t entries = table.offsets.back();
    table.indices.allocate(entries);
    table.weights.allocate(entries);
    if (tangents) {
        table.tangent1_weights.allocate(entries);
        table.tangent2_weights.allocate(entries);
    }
    for_each_row(last.vertex_count, control.part(0.5f, 0.95f), [&](uint32_t v, Row& row) {
        std::vector<TangentWeights> weights;
        limit_row(last, v, row, weights);
        // Tangents go through the same merging as positions: one row for each, same indices.
        Row rows[3] = {row, row, row};
        for (size_t k = 0; k < row.size(); ++k) {
            rows[1][k].weight = weights[k].tangent1;
            rows[2][k].weight = weights[k].tangent2;
        }
        for (Row& r : rows) merge_repeated(r);
        const size_t at = table.offsets[v];
        for (size_t k = 0; k < rows[0].size(); ++k) {
            table.indices[at + k] = rows[0][k].index;
            table.weights[at + k] = static_cast<Real>(rows[0][k].weight);
            if (!tangents) continue;
            table.tangent1_weights[at + k] = static_cast<Real>(rows[1][k].weight);
            table.tangent2_weights[at + k] = static_cast<Real>(rows[2][k].weight);
        }
    });
    if (auto ok = control.reach(1); !ok) return ok.error();
    return table;
}

Array<uint32_t> build_base_faces(const Refinement& refinement, uint32_t level) {
    Array<uint32_t> faces;
    faces.allocate(refinement.levels[level].face_count);
    for_each_index(refinement.levels[level].face_count,
                   [&](uint32_t f) { faces[f] = base_face_of(refinement, level, f); });
    return faces;
}

template <class Real>
void apply_stencil_table(const BasicStencilTable<Real>& table, std::span<const Real> source,
                         std::span<Real> destination, uint32_t width) {
    assert(source.size() >= size_t{table.source_count} * width);
    assert(destination.size() >= size_t{table.row_count()} * width);
    for_each_index(table.row_count(), [&](uint32_t r) {
        Real* out = destination.data() + size_t{r} * width;
        std::fill(out, out + width, Real{0});
        for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k) {
            const Real* in = source.data() + size_t{table.indices[k]} * width;
            for (uint32_t i = 0; i < width; ++i) out[i] += table.weights[k] * in[i];
        }
    });
}

#define LIMN_INSTANTIATE(Real)                                                                             \
    template Result<BasicStencilTable<Real>> build_step_table(const Refinement&, uint32_t, Interpolation,  \
                                                              const BuildPart&);                           \
    template Result<BasicStencilTable<Real>> build_stencil_table(const Refinement&, uint32_t,              \
                                                                 Interpolation, const BuildPart&);         \
    template Result<BasicStencilTable<Real>> build_limit_table(const Refinement&, uint32_t, bool,          \
                                                               const BuildPart&);                          \
    template Result<BasicStencilTable<Real>> build_limit_step_table(const Refinement&, bool,               \
                                                                    const BuildPart&);                     \
    template void apply_stencil_table(const BasicStencilTable<Real>&, std::span<const Real>,               \
                                      std::span<Real>, uint32_t);
LIMN_INSTANTIATE(float)
LIMN_INSTANTIATE(double)
#undef LIMN_INSTANTIATE

}  // namespace limn
