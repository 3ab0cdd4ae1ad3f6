// Follows everything that the tables of a baked mesh say, as evaluation and kernels do: a table that was let in by
// mistake is read or written outside of here, which sanitizers tell.
#pragma once

#include <cstdlib>

#include "limn/baked_mesh.h"
#include "limn/evaluate.h"
#include "limn/tessellate.h"

namespace limn::test {

/// For reads that matter because they take place.
inline void must(bool holds) {
    if (!holds) std::abort();
}

inline std::vector<double> follow_patches(const PatchTable& t, std::span<const float> values, uint32_t width) {
    std::vector<double> control(size_t{t.control_count} * width, 0.5), points(size_t{t.point_count()} * width, 0.0);
    std::copy(values.begin(), values.end(), control.begin());
    build_patch_points(t, control, width, points);
    std::vector<PatchSample> samples;
    const auto faces = static_cast<uint32_t>(std::min<size_t>(t.ptex_surfaces.size(), 200));
    for (uint32_t f = 0; f < faces; ++f)
        for (const auto& [u, v] : {std::pair(0.0, 0.0), std::pair(1.0, 0.0), std::pair(0.0, 1.0), std::pair(0.5, 0.5),
                                   std::pair(0.001, 1e-6), std::pair(0.34, 0.61), std::pair(1e-14, 0.0)})
            samples.push_back({f, u, v});
    std::vector<double> results(samples.size() * 6 * width);
    std::vector<SampleStatus> statuses(samples.size());
    evaluate_patches<float>(t, samples, points, width, Derivatives::second, results, statuses);
    must(build_point_table(t).row_count() == t.refined_count);
    return points;
}

inline void follow_tessellation(const PatchTable& patches, const TessellationTable& t, std::span<const double> points) {
    using Spacing = TessellationSpacing;
    for (const Spacing spacing : {Spacing::integer, Spacing::power_of_two, Spacing::fractional}) {
        std::vector<float> edge_rates(t.rate_edge_count);
        for (size_t e = 0; e < edge_rates.size(); ++e) edge_rates[e] = static_cast<float>(e * 7 % 6);  // 0: left out
        for (const RateMode mode : {RateMode::uniform, RateMode::per_edge}) {
            RateSettings settings;
            settings.mode = mode;
            settings.value = 3;
            settings.spacing = spacing;
            const auto rates = compute_rates(patches, t, settings, points, mode == RateMode::per_edge ? std::span<const float>(edge_rates) : std::span<const float>());
            must(rates.has_value());
            const auto tessellation = tessellate(t, *rates, spacing);
            if (!tessellation) continue;
            for (const uint32_t i : tessellation->indices) must(i < tessellation->vertex_count());
            std::vector<double> positions(size_t{tessellation->vertex_count()} * 3), normals(positions.size());
            evaluate_tessellation(patches, *tessellation, points, positions, normals);
        }
    }
}

/// As grid_eval does, but for the sums.
inline void follow_grid(const GridTable& t, uint64_t ring_count) {
    for (const GridSurface& s : t.surfaces) {
        const GridClass& c = t.classes[s.grid_class];
        const GridPlacement& placement = t.placements[s.placement];
        must(s.first_ring + uint64_t{c.ring_size} <= ring_count);
        must(4 * (c.first_weight + uint64_t{c.group_count} * t.value_count * c.sample_count) <= t.weights.size());
        for (uint32_t i = 0; i < c.sample_count; ++i) {
            must(placement.first + uint64_t{i} < t.placement_samples.size());
            const uint32_t sample = t.placement_samples[placement.first + size_t{i}];
            if (sample == kInvalidIndex) continue;
            uint64_t out = uint64_t{s.ptex_face} * t.samples_per_face + sample;
            if (!t.slots.empty()) {
                const uint64_t slot = s.ptex_face + uint64_t{sample >> shared::kGridOffsetBits};
                must(slot < t.slots.size());
                if (t.slots[slot] == kInvalidIndex) continue;
                out = t.slots[slot] + uint64_t{sample & ((1u << shared::kGridOffsetBits) - 1)};
            }
            must(out < t.sample_count());
        }
    }
}

/// As find_leaf of the kernels does, in all directions.
inline void follow_tree(const PatchTreeTable& t, const TreeSurface& s, uint32_t n, uint32_t depth) {
    must(n < t.nodes.size() && depth < 64);
    const uint32_t kind = shared::node_kind(t.nodes[n]), first = shared::tree_first(t.nodes[n]);
    if (kind <= shared::kNodeSplitV) {
        for (uint32_t c = 0; c < (kind == shared::kNodeSplit ? 4u : 2u); ++c) follow_tree(t, s, first + c, depth + 1);
        return;
    }
    must((size_t{first} + 1) * shared::kLeafWords <= t.leaf_points.size());
    for (uint32_t k = 0; k < shared::kLeafPoints; ++k)
        must(s.first_local + uint64_t{shared::narrow_index(t.leaf_points[size_t{first} * shared::kLeafWords + k / 2], k)} <
             t.local_points.total_sample_count);
}

inline void follow_trees(const PatchTreeTable& t, const TessellationTable& tessellation, uint64_t ring_count) {
    for (const TreeSurface& s : t.surfaces) follow_tree(t, s, shared::surface_plan(s.word), 0);
    follow_grid(t.local_points, ring_count);
    for (uint32_t f = 0; f < tessellation.face_count; ++f) {
        if (tessellation.faces[size_t{f} * shared::kTessFaceWords] == shared::kNoSide) continue;
        const uint32_t word = t.ptex_surfaces[f];
        must((word & shared::kPtexSplit) != 0 ? (word & ~shared::kPtexSplit) + uint64_t{3} < t.surfaces.size()
                                              : word < t.surfaces.size());
    }
}

inline uint64_t ring_count_of(const PatchTable& t) {
    return t.ring_points.words.size() * (t.ring_points.narrow ? 2 : 1);
}

inline void follow_baked(const BakedMesh& mesh) {
    const std::vector<double> points = follow_patches(mesh.patches, {mesh.positions.data(), mesh.positions.size()}, 3);
    follow_tessellation(mesh.patches, mesh.tessellation, points);
    follow_trees(mesh.trees, mesh.tessellation, ring_count_of(mesh.patches));
    for (const uint32_t v : mesh.edges) must(v < mesh.patches.control_count);
    for (const BakedChannel& c : mesh.channels) {
        follow_patches(c.patches, {c.values.data(), c.values.size()}, c.width);
        follow_trees(c.trees, mesh.tessellation, ring_count_of(c.patches));
    }
    for (const GridTable& grid : mesh.grids) follow_grid(grid, ring_count_of(mesh.patches));
    for (const RefinedGridTable& refined : mesh.refined) {
        follow_grid(refined.grid, refined.ring_points.size());
        for (const uint32_t p : refined.ring_points) must(p < refined.source_count);
    }
    for (const BakedStencils& s : mesh.stencils) {
        if (s.table.source_count > 1u << 24) continue;
        const std::vector<float> source(s.table.source_count, 1.0f);
        std::vector<float> destination(s.table.row_count());
        apply_stencil_table<float>(s.table, source, destination, 1);
    }
}

}  // namespace limn::test
