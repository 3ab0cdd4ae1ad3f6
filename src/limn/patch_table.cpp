// Surfaces are found and walked in parallel, in chunks that keep the rings they meet; few of them need a plan
// that is not known yet.
#include "limn/patch_table.h"

#include <algorithm>

#include "limn/patch_table_parts.h"
#include "limn/refinement.h"
#include "limn/schemes/doo_sabin_patches.h"

namespace limn {
namespace {

constexpr float kTopologyEnd = 0.25f;  ///< of progress

/// Surfaces with plans.
Result<Candidates> find_surfaces(const CandidateSource& source, PlanCache::Impl& cache, const BuildPart& part) {
    if (source.base.options.scheme == Scheme::doo_sabin)
        return find_doo_sabin_candidates(source.base, source.options, cache, part);
    Level1 level1;  // most of the memory that there is
    Candidates out = find_candidates(source, level1, part.part(0, 0.8f));
    if (auto ok = part.check(); !ok) return ok.error();
    const auto level1_of = [&](uint32_t) -> const Level1& { return level1; };
    if (auto ok = find_plans(source, level1_of, cache, out, part.part(0.8f, 1)); !ok) return ok.error();
    return out;
}

template <class Real>
Result<BasicPatchTable<Real>> build(const Refinement& from, const PatchTableOptions& options,
                                    const PlanCache* shared) {
    if (auto ok = check_options(options); !ok) return ok.error();
    const Topology& base = from.levels[0];
    if (base.options.scheme == Scheme::doo_sabin && options.end_cap != EndCap::exact)
        return Error{ErrorCode::unsupported, "Gregory end caps of Doo-Sabin patch tables"};
    const BuildPart& part = options.control;
    const PlanCache own;
    PlanCache::Impl& cache = (shared != nullptr ? *shared : own).impl();
    PatchTableParts<Real> parts;
    const CandidateSource source(base, plan_options(base.options, options), part.part(kTopologyEnd, 0.3f));
    auto surfaces = find_surfaces(source, cache, part.part(0.3f, 0.8f));
    if (!surfaces) return surfaces.error();
    parts.candidates = std::move(*surfaces);
    place_chunks(parts.candidates);
    parts.points.control_count = from.control_count;
    parts.points.first_children = find_child_blocks(base, parts.candidates.first_faces);
    parts.points.blocks.resize(parts.points.first_children.size() - 1);
    const auto uses = find_used_children(base, parts.candidates, part.part(0.8f, 0.82f));
    if (auto ok = place_parts(source, from.control_indices, uses, parts, part.part(0.82f, 0.9f)); !ok)
        return ok.error();
    BasicPatchTable<Real> table;
    write_patch_table<Real>(source, from.control_indices, parts, nullptr, table, part.part(0.9f, 1));
    if (auto ok = part.reach(1); !ok) return ok.error();
    return table;
}

bool has_semi_sharp_edges(const Topology& t) {
    return std::any_of(t.edge_sharpness.begin(), t.edge_sharpness.end(),
                       [](float s) { return s > 0 && !is_infinite(s); });
}

}  // namespace

template <class Real>
Result<BasicPatchTable<Real>> build_patch_table(const ControlMesh& mesh, const PatchTableOptions& options,
                                                const PlanCache* cache) {
    if (auto ok = options.control.start(); !ok) return ok.error();
    Refinement refinement;
    refinement.control_count = mesh.vertex_count;
    refinement.levels.push_back(build_topology(mesh, options.control.part(0, kTopologyEnd)));
    if (auto ok = options.control.check(); !ok) return ok.error();
    // Varying data are linear within ptex faces, whatever the scheme.
    SchemeOptions& scheme = refinement.levels[0].options;
    if (scheme.scheme == Scheme::doo_sabin && options.interpolation == Interpolation::varying)
        scheme.scheme = Scheme::bilinear;
    return build<Real>(refinement, options, cache);
}

template <class Real>
Result<BasicPatchTable<Real>> build_face_varying_patch_table(const ControlMesh& mesh, uint32_t channel,
                                                             const PatchTableOptions& options,
                                                             const PlanCache* cache) {
    const auto refinement = build_face_varying_refinement(
        mesh, channel,
        {.level = 0, .full_last_level = true, .control = options.control.part(0, kTopologyEnd)});
    if (!refinement) return refinement.error();
    // Sharpness that is not finite stays as it is, on either side of a seam.
    if (!refinement->uncut.empty() && refinement->levels[0].options.scheme != Scheme::bilinear &&
        has_semi_sharp_edges(refinement->uncut[0]))
        return Error{ErrorCode::unsupported,
                     "patch tables of smooth face-varying channels with Chaikin creases"};
    return build<Real>(*refinement, options, cache);
}

template Result<PatchTable> build_patch_table<float>(const ControlMesh&, const PatchTableOptions&,
                                                     const PlanCache*);
template Result<PatchTableDouble> build_patch_table<double>(const ControlMesh&, const PatchTableOptions&,
                                                            const PlanCache*);
template Result<PatchTable> build_face_varying_patch_table<float>(const ControlMesh&, uint32_t,
                                                                  const PatchTableOptions&, const PlanCache*);
template Result<PatchTableDouble> build_face_varying_patch_table<double>(const ControlMesh&, uint32_t,
                                                                         const PatchTableOptions&,
                                                                         const PlanCache*);

}  // namespace limn
