#include "limn/evaluate.h"

#include <algorithm>

#include "limn/parallel.h"
#include "limn/patch_evaluator.h"

namespace limn {
namespace {

/// The surface of a sample, and the coordinates of its plan.
template <class Real>
SampleStatus find_surface(const PatchEvaluator<Real>& evaluator, const PatchSample& s,
                          uint32_t& surface_index, shared::PatchLocation& at) {
    const BasicPatchTable<Real>& table = evaluator.table;
    if (s.face >= table.ptex_surfaces.size() || !(s.u >= 0 && s.u <= 1 && s.v >= 0 && s.v <= 1) ||
        (evaluator.triangles && s.u + s.v > 1 + 1e-12))
        return SampleStatus::out_of_range;
    surface_index = table.ptex_surfaces[s.face];
    if (surface_index == shared::kPtexHole) return SampleStatus::hole;
    at = shared::make_location(s.u, s.v);
    if ((surface_index & shared::kPtexSplit) != 0)
        surface_index =
            (surface_index & ~shared::kPtexSplit) + shared::descend_location(at, evaluator.triangles);
    shared::rotate_location(at, table.surfaces[surface_index].rotation(), evaluator.triangles);
    return SampleStatus::valid;
}

template <class Real>
SampleStatus evaluate_sample(const PatchEvaluator<Real>& evaluator, const PatchSample& s,
                             std::span<const double> points, PatchScratch& scratch) {
    const BasicPatchTable<Real>& table = evaluator.table;
    uint32_t surface_index = 0;
    shared::PatchLocation at = {};
    const SampleStatus status = find_surface(evaluator, s, surface_index, at);
    if (status != SampleStatus::valid) return status;
    const Surface& surface = table.surfaces[surface_index];
    const uint32_t ring_size = table.plans[surface.plan()].ring_size;
    const size_t width = evaluator.width;
    scratch.ring.resize(ring_size * width);
    for (uint32_t j = 0; j < ring_size; ++j)
        std::copy_n(points.data() + table.ring_points[surface.first_ring + j] * width, width,
                    scratch.ring.data() + j * width);
    evaluator.evaluate(surface.plan(), at, scratch);
    return SampleStatus::valid;
}

}  // namespace

template <class Real>
void build_patch_points(const BasicPatchTable<Real>& table, std::span<const double> control_points,
                        uint32_t width, std::span<double> points) {
    const size_t control = size_t{table.control_count} * width;
    assert(control_points.size() >= control && points.size() >= size_t{table.point_count()} * width);
    std::copy_n(control_points.begin(), control, points.begin());
    for (const PointRun& run : table.point_runs) {
        for_each_index(run.row_count, [&](uint32_t i) {
            double* point = points.data() + size_t{run.first_point + i} * width;
            std::fill_n(point, width, 0.0);
            for (uint32_t k = 0; k < run.entry_count; ++k) {
                const uint32_t index = table.point_indices[run.first_index + size_t{i} * run.entry_count + k];
                const auto weight = static_cast<double>(table.point_weights[run.first_weight + k]);
                for (uint32_t c = 0; c < width; ++c)
                    point[c] += weight * control_points[size_t{index} * width + c];
            }
        });
    }
}

template <class Real>
void evaluate_patches(const BasicPatchTable<Real>& table, std::span<const PatchSample> samples,
                      std::span<const double> points, uint32_t width, Derivatives derivatives,
                      std::span<double> results, std::span<SampleStatus> statuses) {
    const size_t stride = size_t{value_count(derivatives)} * width;
    assert(points.size() >= size_t{table.point_count()} * width);
    assert(results.size() >= samples.size() * stride && statuses.size() >= samples.size());
    const PatchEvaluator<Real> evaluator{table, table.options.scheme == Scheme::loop, width};
    tbb::parallel_for(tbb::blocked_range<size_t>(0, samples.size(), 256),
                      [&](const tbb::blocked_range<size_t>& r) {
                          PatchScratch scratch;
                          for (size_t s = r.begin(); s != r.end(); ++s) {
                              double* result = results.data() + s * stride;
                              statuses[s] = evaluate_sample(evaluator, samples[s], points, scratch);
                              if (statuses[s] == SampleStatus::valid)
                                  std::copy_n(scratch.values.begin(), stride, result);
                              else
                                  std::fill_n(result, stride, 0.0);
                          }
                      });
}

template <class Real>
void locate_patches(const BasicPatchTable<Real>& table, std::span<const PatchSample> samples,
                    std::span<SurfacePlace> places, std::span<SampleStatus> statuses) {
    assert(places.size() >= samples.size() && statuses.size() >= samples.size());
    const PatchEvaluator<Real> evaluator{table, table.options.scheme == Scheme::loop, 0};
    for (size_t s = 0; s < samples.size(); ++s) {
        uint32_t surface = 0;
        shared::PatchLocation at = {};
        places[s] = {};
        statuses[s] = find_surface(evaluator, samples[s], surface, at);
        if (statuses[s] != SampleStatus::valid) continue;
        const auto leaf = evaluator.find_leaf(table.surfaces[surface].plan(), at,
                                              [](const Plan&, const uint32_t*, const Plan&) {});
        places[s] = {surface, leaf.plan, leaf.node, leaf.at.u, leaf.at.v};
    }
}

template void locate_patches<float>(const PatchTable&, std::span<const PatchSample>, std::span<SurfacePlace>,
                                    std::span<SampleStatus>);
template void locate_patches<double>(const PatchTableDouble&, std::span<const PatchSample>,
                                     std::span<SurfacePlace>, std::span<SampleStatus>);
template void build_patch_points<float>(const PatchTable&, std::span<const double>, uint32_t,
                                        std::span<double>);
template void build_patch_points<double>(const PatchTableDouble&, std::span<const double>, uint32_t,
                                         std::span<double>);
template void evaluate_patches<float>(const PatchTable&, std::span<const PatchSample>,
                                      std::span<const double>, uint32_t, Derivatives, std::span<double>,
                                      std::span<SampleStatus>);
template void evaluate_patches<double>(const PatchTableDouble&, std::span<const PatchSample>,
                                       std::span<const double>, uint32_t, Derivatives, std::span<double>,
                                       std::span<SampleStatus>);

}  // namespace limn
