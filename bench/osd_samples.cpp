#include "osd_samples.h"

#include <algorithm>
#include <cmath>

#include "limn/topology.h"
#include "patch_samples.h"

namespace limn::bench {

std::vector<double> OsdSamples::points() const {
    std::vector<double> points;
    points.reserve(values.size() / 3);
    for (size_t i = 0; i < values.size(); ++i)
        if (i % 9 < 3) points.push_back(values[i]);
    return points;
}

double osd_difference(const BenchModel& model, uint32_t isolation_level, std::span<const PatchSample> samples,
                      const std::vector<double>& values) {
    ControlMesh mesh = model.mesh;
    mesh.options.opensubdiv_compatible = true;
    const auto table =
        build_patch_table<double>(mesh, {.end_cap = EndCap::gregory_opensubdiv, .isolation_level = isolation_level});
    if (!table) return INFINITY;
    const auto same = evaluate_samples(*table, samples, model.positions, Derivatives::first);
    if (same.size() != values.size()) return INFINITY;
    // Derivatives are told at the scale of the smallest patch, which may be of a face that was split before.
    const double of_points = tolerance_for(model.positions).in_float;
    const double of_derivatives = std::ldexp(of_points, static_cast<int>(isolation_level) + 1);
    double worst = 0;
    for (size_t i = 0; i < values.size(); ++i) {
        const double difference = std::abs(values[i] - same[i]) / (i % 9 < 3 ? of_points : of_derivatives);
        worst = std::isfinite(difference) ? std::max(worst, difference) : INFINITY;
    }
    return worst;
}

bool has_equal_patches(const ControlMesh& mesh) {
    const auto is_semi_sharp = [](float s) { return s > 0 && !is_infinite(s); };
    if (mesh.options.creasing == CreasingMethod::chaikin && std::ranges::any_of(mesh.crease_sharpness, is_semi_sharp))
        return false;
    const Topology topology = build_topology(mesh);
    for (uint32_t v = 0; v < topology.vertex_count; ++v) {
        if (topology.vertex_manifold[v] == 0) return false;
        const auto edges = topology.edges_of_vertex(v);
        if (edges.size() == 2 && topology.corners_of_vertex(v).size() == 2 &&
            is_infinite(topology.edge_sharpness[edges[0]]) != is_infinite(topology.edge_sharpness[edges[1]]))
            return false;
    }
    return true;
}

OsdSamples find_osd_samples(const Options& options, const BenchModel& model, uint32_t isolation_level,
                            std::span<const PatchSample> samples) {
    const auto places = find_osd_places(model.mesh, isolation_level, samples);
    if (places == nullptr)
        fail(options,
             {ErrorCode::unsupported, model.name + ": OpenSubdiv refuses this mesh, or has no patch at some place"});
    OsdSamples found{places, evaluate_osd_places(*places, model.positions)};
    if (!has_equal_patches(model.mesh)) return found;
    const double difference = osd_difference(model, isolation_level, samples, found.values);
    if (!(difference <= 1))
        fail(options,
             {ErrorCode::unsupported,
              model.name + format(": OpenSubdiv's patches of level %u are %.3g times as far from limn's with the "
                                  "same end caps as rounding allows",
                                  isolation_level, difference)});
    return found;
}

}  // namespace limn::bench
