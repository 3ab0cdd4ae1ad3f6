// The C interface: all schemes.
#include "limn/c/limn_schemes.h"

#include "limn/c/scheme_interop.h"
#include "limn/schemes/adaptive.h"
#include "limn/schemes/corner_values.h"
#include "limn/schemes/scheme_samples.h"

namespace limn::c {
namespace {

static_assert(LIMN_FACES_QUADS == static_cast<int>(FaceKind::quads) &&
              LIMN_FACES_TRIANGLES == static_cast<int>(FaceKind::triangles));
static_assert(LIMN_CORNER_VALUES_INTERVALS == static_cast<int>(CornerValues::intervals) &&
              LIMN_CORNER_VALUES_ANGLES == static_cast<int>(CornerValues::angles));

uint32_t flags_of(const SubdivisionScheme& s) {
    const std::pair<bool, uint32_t> flags[] = {{s.dual, LIMN_SUBDIVISION_SCHEME_DUAL},
                                               {s.interpolates, LIMN_SUBDIVISION_SCHEME_INTERPOLATES},
                                               {s.creases != CreaseRules::none, LIMN_SUBDIVISION_SCHEME_CREASES},
                                               {is_adaptive(s), LIMN_SUBDIVISION_SCHEME_ADAPTIVE},
                                               {has_coordinates(s), LIMN_SUBDIVISION_SCHEME_SAMPLES},
                                               {s.reconstructed, LIMN_SUBDIVISION_SCHEME_RECONSTRUCTED}};
    uint32_t all = 0;
    for (const auto& [is_set, flag] : flags)
        if (is_set) all |= flag;
    return all;
}

/// What all builds take: the options given and, where nothing is wrong with them, a scheme.
template <class Options>
struct Build {
    Options options;
    const SubdivisionScheme* scheme;
    std::span<const double> corner_values;
};
template <class Options>
Result<Build<Options>> read_build(const limn_control_mesh* mesh, const Options* given) {
    const auto options = read_struct(given);
    if (!options) return options.error();
    Reader reader;
    if (mesh == nullptr) reader.fail("mesh is null");
    if (options->scheme == nullptr) reader.fail("scheme is null");
    const auto values = reader.array(options->corner_values, options->corner_value_count, "corner_values");
    if (!reader.state) return reader.state.error();
    const SubdivisionScheme* scheme = find_subdivision_scheme(options->scheme);
    if (scheme == nullptr) return bad_argument("there is no such scheme");
    return Build<Options>{*options, scheme, values};
}

Result<limn_scheme_surface> create_surface(const limn_control_mesh* mesh, const limn_scheme_surface_options* given) {
    const auto build = read_build(mesh, given);
    if (!build) return build.error();
    auto surface = build_scheme_surface(mesh->value, *build->scheme,
                                        {.level = build->options.level, .control = control_of(build->options.control)},
                                        build->corner_values);
    if (!surface) return surface.error();
    return limn_scheme_surface{std::move(*surface), build->options.level, true, 0, {}};
}

Result<limn_scheme_surface> create_adaptive(const limn_control_mesh* mesh, const limn_adaptive_surface_options* given) {
    const auto build = read_build(mesh, given);
    if (!build) return build.error();
    const limn_adaptive_surface_options& o = build->options;
    Reader reader;
    const auto positions = reader.array(o.positions, o.position_value_count, "positions");
    if (o.reserved != 0) reader.fail("reserved is not 0");
    if (!reader.state) return reader.state.error();
    AdaptiveSurfaceOptions options{.tolerance = o.tolerance, .control = control_of(o.control)};
    if (o.max_level != 0) options.max_level = o.max_level;
    if (o.max_triangles != 0) options.max_triangles = o.max_triangles;
    auto adaptive =
        build_adaptive_surface<float>(mesh->value, *build->scheme, positions, options, build->corner_values);
    if (!adaptive) return adaptive.error();
    limn_scheme_surface out{
        {}, adaptive->level, adaptive->reached, adaptive->tolerance, std::move(adaptive->face_levels)};
    out.value = make_scheme_surface(std::move(*adaptive));
    return out;
}

Result<StencilTable> create_samples(const limn_control_mesh* mesh, const limn_scheme_surface_options* given,
                                    const limn_patch_sample* samples, uint64_t sample_count,
                                    limn_sample_status* statuses, uint64_t status_count) {
    const auto build = read_build(mesh, given);
    if (!build) return build.error();
    Reader reader;
    const auto places = reader.array(samples, sample_count, "samples");
    const auto valid = reader.array(statuses, status_count, sample_count, 1, "statuses");
    if (!reader.state) return reader.state.error();
    auto made = build_scheme_sample_table<float>(mesh->value, *build->scheme,
                                                 {reinterpret_cast<const PatchSample*>(places.data()), places.size()},
                                                 build->corner_values, control_of(build->options.control));
    if (!made) return made.error();
    std::transform(made->statuses.begin(), made->statuses.end(), valid.begin(),
                   [](SampleStatus s) { return static_cast<limn_sample_status>(s); });
    return std::move(made->table);
}

/// Writes one value for each face corner.
Result<void> write_corner_values(const Result<std::vector<double>>& made, double* values, uint64_t value_count) {
    if (!made) return made.error();
    Reader reader;
    const auto out = reader.array(values, value_count, made->size(), 1, "values");
    if (!reader.state) return reader.state;
    std::copy(made->begin(), made->end(), out.begin());
    return {};
}

Result<std::vector<double>> find_intervals(const limn_control_mesh* mesh, const uint32_t* edges,
                                           uint64_t edge_vertex_count, const float* intervals,
                                           uint64_t interval_count) {
    Reader reader;
    if (mesh == nullptr) reader.fail("mesh is null");
    const auto pairs = reader.array(edges, edge_vertex_count, "edges");
    const auto given = reader.array(intervals, interval_count, "intervals");
    if (!reader.state) return reader.state.error();
    return corner_intervals(mesh->value, pairs, given);
}

Result<std::vector<double>> find_angles(const limn_control_mesh* mesh, const float* positions, uint64_t count) {
    Reader reader;
    if (mesh == nullptr) reader.fail("mesh is null");
    const auto given = reader.array(positions, count, "positions");
    if (!reader.state) return reader.state.error();
    return corner_angles(mesh->value, given);
}

Result<void> apply(const limn_scheme_surface* surface, const float* points, uint64_t point_value_count,
                   float* positions, uint64_t position_value_count, float* normals, uint64_t normal_value_count) {
    if (surface == nullptr) return bad_argument("surface is null");
    const SchemeSurface& s = surface->value;
    Reader reader;
    const auto from = reader.array(points, point_value_count, s.control_count, 3, "points");
    const auto to = reader.array(positions, position_value_count, s.vertex_count, 3, "positions");
    if (normals != nullptr) reader.array(normals, normal_value_count, s.vertex_count, 3, "normals");
    if (!reader.state) return reader.state;
    const SchemeVertices made = apply_scheme_surface(s, from.first(size_t{3} * s.control_count));
    std::copy(made.positions.begin(), made.positions.end(), to.begin());
    if (normals != nullptr) std::copy(made.normals.begin(), made.normals.end(), normals);
    return {};
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

uint32_t limn_subdivision_scheme_get_count(void) noexcept {
    return static_cast<uint32_t>(limn::subdivision_schemes().size());
}
limn_result limn_subdivision_scheme_get_info(uint32_t index, limn_subdivision_scheme_info* info,
                                             limn_error* error) noexcept {
    const auto schemes = limn::subdivision_schemes();
    if (index >= schemes.size())
        return report({limn::ErrorCode::index_out_of_range, "there is no such scheme", index}, error);
    const limn::SubdivisionScheme& s = schemes[index];
    return write_struct({0, flags_of(s), static_cast<limn_face_kind>(s.faces),
                         static_cast<limn_corner_values>(s.corner_values), s.name, s.title, s.source},
                        info, error);
}

limn_result limn_control_mesh_get_corner_intervals(const limn_control_mesh* mesh, const uint32_t* edges,
                                                   uint64_t edge_vertex_count, const float* intervals,
                                                   uint64_t interval_count, double* values, uint64_t value_count,
                                                   limn_error* error) noexcept {
    return report(write_corner_values(find_intervals(mesh, edges, edge_vertex_count, intervals, interval_count), values,
                                      value_count),
                  error);
}
limn_result limn_control_mesh_get_corner_angles(const limn_control_mesh* mesh, const float* positions,
                                                uint64_t position_value_count, double* values, uint64_t value_count,
                                                limn_error* error) noexcept {
    return report(write_corner_values(find_angles(mesh, positions, position_value_count), values, value_count), error);
}

limn_result limn_scheme_surface_create(const limn_control_mesh* mesh, const limn_scheme_surface_options* options,
                                       limn_scheme_surface** surface, limn_error* error) noexcept {
    return create(surface, error, [&] { return create_surface(mesh, options); });
}
limn_result limn_scheme_surface_create_adaptive(const limn_control_mesh* mesh,
                                                const limn_adaptive_surface_options* options,
                                                limn_scheme_surface** surface, limn_error* error) noexcept {
    return create(surface, error, [&] { return create_adaptive(mesh, options); });
}
void limn_scheme_surface_destroy(limn_scheme_surface* surface) noexcept {
    delete surface;
}

limn_result limn_scheme_surface_get_info(const limn_scheme_surface* surface, limn_scheme_surface_info* info,
                                         limn_error* error) noexcept {
    if (surface == nullptr) return report(bad_argument("surface is null"), error);
    const limn::SchemeSurface& s = surface->value;
    return write_struct({0, s.control_count, s.vertex_count, static_cast<uint32_t>(s.face_offsets.size() - 1),
                         static_cast<uint32_t>(s.triangles.size() / 3), static_cast<uint32_t>(s.edges.size() / 2),
                         s.face_offsets.data(), s.face_vertices.data(), s.triangles.data(), s.edges.data(),
                         surface->level, surface->reached ? 1u : 0u, surface->tolerance, surface->face_levels.data()},
                        info, error);
}

limn_result limn_scheme_surface_apply(const limn_scheme_surface* surface, const float* points,
                                      uint64_t point_value_count, float* positions, uint64_t position_value_count,
                                      float* normals, uint64_t normal_value_count, limn_error* error) noexcept {
    return report(
        apply(surface, points, point_value_count, positions, position_value_count, normals, normal_value_count), error);
}

limn_result limn_stencil_table_create_scheme_samples(const limn_control_mesh* mesh,
                                                     const limn_scheme_surface_options* options,
                                                     const limn_patch_sample* samples, uint64_t sample_count,
                                                     limn_sample_status* statuses, uint64_t status_count,
                                                     limn_stencil_table** table, limn_error* error) noexcept {
    return create(table, error,
                  [&] { return create_samples(mesh, options, samples, sample_count, statuses, status_count); });
}
