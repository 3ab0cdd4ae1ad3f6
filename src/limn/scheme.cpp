#include "limn/scheme.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {

float child_edge_sharpness(CreasingMethod creasing, float sharpness, const SemiSharpEdges& around) {
    if (creasing == CreasingMethod::uniform || sharpness <= 0 || is_infinite(sharpness) || around.count < 2)
        return child_sharpness(sharpness);
    const float others = (around.sum - sharpness) / static_cast<float>(around.count - 1);
    return std::max(0.0f, 0.75f * sharpness + 0.25f * others - 1.0f);
}

double edge_smooth_share(const SchemeOptions& options, float sharpness, VertexRule child_rule) {
    if (sharpness <= 0) return 1;
    if (child_rule == VertexRule::crease) return 0;
    // Only Chaikin creasing gets here with sharpness above 1: one child edge vanished, the other did not.
    const double share = 1.0 - static_cast<double>(sharpness);
    return options.opensubdiv_compatible ? share : std::max(0.0, share);
}

double vertex_parent_share(float parent_vertex, float child_vertex, std::span<const float> parent,
                           std::span<const float> child) {
    double sum = 0;
    uint32_t count = 0;
    if (parent_vertex > 0 && child_vertex <= 0) {
        sum += static_cast<double>(parent_vertex);
        ++count;
    }
    for (size_t i = 0; i < parent.size(); ++i) {
        if (parent[i] <= 0 || child[i] > 0) continue;
        sum += static_cast<double>(parent[i]);
        ++count;
    }
    return count == 0 ? 0 : std::min(1.0, sum / count);
}

double edge_face_weight(TriangleSubdivision triangles, uint32_t n0, uint32_t n1) {
    if (triangles == TriangleSubdivision::catmark || (n0 != 3 && n1 != 3)) return 0.25;
    return 0.5 * ((n0 == 3 ? 0.47 : 0.25) + (n1 == 3 ? 0.47 : 0.25));
}

VertexMask smooth_vertex_mask(Scheme scheme, uint32_t valence) {
    const double n = valence;
    if (scheme == Scheme::catmull_clark) return {(n - 2) / n, 1 / (n * n), 1 / (n * n)};
    if (valence == 6) return {0.625, 0.0625, 0};
    const double center = 0.375 + 0.25 * std::cos(2 * std::numbers::pi / n);
    const double beta = (0.625 - center * center) / n;
    return {1 - n * beta, beta, 0};
}

}  // namespace limn
