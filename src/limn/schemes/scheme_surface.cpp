#include "limn/schemes/scheme_surface.h"

#include <algorithm>
#include <cmath>

#include "limn/parallel.h"
#include "limn/schemes/scheme_limit.h"

namespace limn {
namespace {

Array<uint32_t> triangulate(const Topology& mesh) {
    Array<uint32_t> triangles;
    const size_t fans = size_t{mesh.corner_count()} - size_t{2} * mesh.face_count;
    triangles.allocate(3 * fans);
    size_t at = 0;
    for (uint32_t f = 0; f < mesh.face_count; ++f) {
        const auto vertices = mesh.vertices_of_face(f);
        for (size_t i = 2; i < vertices.size(); ++i)
            for (const uint32_t v : {vertices[0], vertices[i - 1], vertices[i]}) triangles[at++] = v;
    }
    return triangles;
}

Array<uint32_t> offsets_of_faces(const Topology& mesh) {
    Array<uint32_t> offsets;
    offsets.allocate(size_t{mesh.face_count} + 1);
    for (uint32_t f = 0; f < mesh.face_count; ++f) offsets[f] = mesh.face_begin(f);
    offsets.back() = mesh.corner_count();
    return offsets;
}

/// As kernels/normals.comp has it.
void unit(double v[3]) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; ++k) v[k] = length > 0 ? v[k] / length : 0;
}

}  // namespace

double segments_per_step(const SubdivisionScheme& scheme) {
    double factor = 1;
    for (const Pass& pass : scheme.passes) switch (pass.split) {
            case SplitKind::quads:
            case SplitKind::triangles:
            case SplitKind::corners: factor *= 2; break;
            case SplitKind::sqrt3:
            case SplitKind::hexagons: factor *= std::sqrt(3.0); break;
            case SplitKind::sqrt2:
            case SplitKind::midpoints: factor *= std::sqrt(2.0); break;
            case SplitKind::none:
            case SplitKind::dual: break;
        }
    return factor;
}

uint32_t steps_for_rate(const SubdivisionScheme& scheme, double rate) {
    if (rate <= 1) return 0;
    return static_cast<uint32_t>(std::ceil(std::log(rate) / std::log(segments_per_step(scheme)) - 1e-9));
}

Result<SchemeSurface> build_scheme_surface(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                           const SchemeSurfaceOptions& options, std::span<const double> intervals) {
    auto refinement =
        build_scheme_refinement<float>(mesh, scheme, {options.level, true, options.control.part(0, 0.7f)}, intervals);
    if (!refinement) return refinement.error();
    auto limit = build_scheme_limit_table(*refinement, true, options.control.part(0.7f, 1));
    if (!limit) return limit.error();
    SchemeSurface out;
    out.control_count = mesh.vertex_count;
    out.vertex_count = limit->row_count();
    out.tables = std::move(refinement->tables);
    out.limit = std::move(*limit);
    out.face_offsets = offsets_of_faces(refinement->mesh());
    out.triangles = triangulate(refinement->mesh());
    out.face_vertices = std::move(refinement->last.topology.face_vertices);
    out.edges = std::move(refinement->control_edges);
    return out;
}

StencilTable with_weights(const StencilTable& table, const Array<float>& weights) {
    StencilTable out;
    out.source_count = table.source_count;
    out.offsets = Array<uint32_t>::borrow(table.offsets.data(), table.offsets.size());
    out.indices = Array<uint32_t>::borrow(table.indices.data(), table.indices.size());
    out.weights = Array<float>::borrow(weights.data(), weights.size());
    return out;
}

std::vector<float> normals_of(std::span<const float> tangents1, std::span<const float> tangents2) {
    std::vector<float> normals(tangents1.size());
    for_each_index(static_cast<uint32_t>(normals.size() / 3), [&](uint32_t v) {
        double a[3], b[3];
        for (size_t k = 0; k < 3; ++k) {
            a[k] = tangents1[3 * size_t{v} + k];
            b[k] = tangents2[3 * size_t{v} + k];
        }
        unit(a);
        unit(b);
        double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        unit(n);
        if (n[0] == 0 && n[1] == 0 && n[2] == 0) n[2] = 1;
        for (size_t k = 0; k < 3; ++k) normals[3 * size_t{v} + k] = static_cast<float>(n[k]);
    });
    return normals;
}

SchemeVertices apply_scheme_surface(const SchemeSurface& surface, std::span<const float> points) {
    std::vector<float> refined(points.begin(), points.end());
    for (const StencilTable& table : surface.tables) {
        std::vector<float> next(size_t{3} * table.row_count());
        apply_stencil_table<float>(table, refined, next, 3);
        refined = std::move(next);
    }
    SchemeVertices out;
    const size_t count = size_t{3} * surface.vertex_count;
    out.positions.resize(count);
    std::vector<float> tangents1(count), tangents2(count);
    apply_stencil_table<float>(surface.limit, refined, out.positions, 3);
    apply_stencil_table<float>(with_weights(surface.limit, surface.limit.tangent1_weights), refined, tangents1, 3);
    apply_stencil_table<float>(with_weights(surface.limit, surface.limit.tangent2_weights), refined, tangents2, 3);
    out.normals = normals_of(tangents1, tangents2);
    return out;
}

}  // namespace limn
