#include "limn/c/limn.h"

#include <vector>

#include "limn/c/interop.h"
#include "limn/curvature.h"
#include "limn/evaluate.h"

namespace limn::c {

limn_result report(const Error& error, limn_error* out) {
    const auto code = static_cast<limn_result>(error.code) + 1;
    if (out == nullptr) return code;
    *out = {code, error.vk_result, error.element, {}};
    error.message.copy(out->message, LIMN_MESSAGE_BYTES - 1);
    return code;
}

namespace {

static_assert(static_cast<limn_result>(ErrorCode::cancelled) + 1 == LIMN_ERROR_CANCELLED);
static_assert(sizeof(limn_patch_sample) == sizeof(PatchSample) &&
              alignof(limn_patch_sample) == alignof(PatchSample) &&
              offsetof(limn_patch_sample, u) == offsetof(PatchSample, u) &&
              offsetof(limn_patch_sample, v) == offsetof(PatchSample, v));
static_assert(sizeof(limn_sample_status) == sizeof(SampleStatus));
static_assert(sizeof(limn_curvature) == sizeof(Curvature) &&
              offsetof(limn_curvature, mean) == offsetof(Curvature, mean) &&
              offsetof(limn_curvature, first) == offsetof(Curvature, first) &&
              offsetof(limn_curvature, second) == offsetof(Curvature, second) &&
              offsetof(limn_curvature, first_direction) == offsetof(Curvature, first_direction) &&
              offsetof(limn_curvature, second_direction) == offsetof(Curvature, second_direction));

constexpr Scheme kSchemes[] = {Scheme::catmull_clark, Scheme::loop, Scheme::bilinear, Scheme::doo_sabin};
constexpr BoundaryInterpolation kBoundaries[] = {
    BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner, BoundaryInterpolation::none};
constexpr CreasingMethod kCreasings[] = {CreasingMethod::uniform, CreasingMethod::chaikin};
constexpr TriangleSubdivision kTriangles[] = {TriangleSubdivision::catmark, TriangleSubdivision::smooth};
constexpr FaceVaryingInterpolation kFaceVarying[] = {
    FaceVaryingInterpolation::all,           FaceVaryingInterpolation::none,
    FaceVaryingInterpolation::corners_only,  FaceVaryingInterpolation::corners_plus1,
    FaceVaryingInterpolation::corners_plus2, FaceVaryingInterpolation::boundaries};
constexpr Interpolation kInterpolations[] = {Interpolation::vertex, Interpolation::varying};
constexpr EndCap kEndCaps[] = {EndCap::exact, EndCap::gregory, EndCap::gregory_opensubdiv};
constexpr Derivatives kDerivatives[] = {Derivatives::none, Derivatives::first, Derivatives::second};

SchemeOptions read_scheme(Reader& reader, const limn_control_mesh_description& d) {
    reader.flags(d.flags, LIMN_CONTROL_MESH_LEFT_HANDED | LIMN_CONTROL_MESH_OPENSUBDIV_COMPATIBLE);
    return {.scheme = reader.choice(d.scheme, kSchemes, "scheme"),
            .boundary = reader.choice(d.boundary, kBoundaries, "boundary interpolation"),
            .creasing = reader.choice(d.creasing, kCreasings, "creasing method"),
            .triangles = reader.choice(d.triangles, kTriangles, "triangle subdivision"),
            .opensubdiv_compatible = (d.flags & LIMN_CONTROL_MESH_OPENSUBDIV_COMPATIBLE) != 0};
}

std::vector<FaceVaryingDescription> read_channels(Reader& reader, const limn_control_mesh_description& d) {
    std::vector<FaceVaryingDescription> channels;
    for (const limn_face_varying_channel& channel : reader.array(d.channels, d.channel_count, "channels"))
        channels.push_back(
            {channel.value_count, reader.array(channel.face_values, channel.face_value_count, "face_values"),
             reader.choice(channel.interpolation, kFaceVarying, "face-varying interpolation")});
    return channels;
}

}  // namespace

Result<void> read_description(const limn_control_mesh_description* given, ControlMeshDescription& out,
                              std::vector<FaceVaryingDescription>& channels) {
    const auto d = read_struct(given);
    if (!d) return d.error();
    Reader reader;
    channels = read_channels(reader, *d);
    out.options = read_scheme(reader, *d);
    out.vertex_count = d->vertex_count;
    out.face_sizes = reader.array(d->face_sizes, d->face_count, "face_sizes");
    out.face_vertices = reader.array(d->face_vertices, d->face_vertex_count, "face_vertices");
    out.crease_sizes = reader.array(d->crease_sizes, d->crease_size_count, "crease_sizes");
    out.crease_vertices = reader.array(d->crease_vertices, d->crease_vertex_count, "crease_vertices");
    out.crease_sharpness = reader.array(d->crease_sharpness, d->crease_sharpness_count, "crease_sharpness");
    out.corner_vertices = reader.array(d->corner_vertices, d->corner_count, "corner_vertices");
    out.corner_sharpness = reader.array(d->corner_sharpness, d->corner_count, "corner_sharpness");
    out.holes = reader.array(d->holes, d->hole_count, "holes");
    out.channels = channels;
    out.positions = reader.array(d->positions, d->position_value_count, "positions");
    out.left_handed = (d->flags & LIMN_CONTROL_MESH_LEFT_HANDED) != 0;
    return reader.state;
}

Result<PatchTableOptions> read_patch_table_options(const limn_patch_table_options* given) {
    PatchTableOptions out;
    if (given == nullptr) return out;
    const auto options = read_struct(given);
    if (!options) return options.error();
    Reader reader;
    out.interpolation = reader.choice(options->interpolation, kInterpolations, "interpolation");
    out.end_cap = reader.choice(options->end_cap, kEndCaps, "end cap");
    if (options->reserved != 0) reader.fail("reserved is not 0");
    out.control = control_of(options->control);
    if (options->plan_depth != 0) out.plan_depth = options->plan_depth;
    if (options->isolation_level != 0) out.isolation_level = options->isolation_level;
    if (!reader.state) return reader.state.error();
    return out;
}

namespace {

Result<ControlMesh> create_mesh(const limn_control_mesh_description* given) {
    ControlMeshDescription description;
    std::vector<FaceVaryingDescription> channels;
    if (auto read = read_description(given, description, channels); !read) return read.error();
    return ControlMesh::create(description);
}

/// `build(mesh, options, cache)` makes the table.
template <class Build>
limn_result create_patch_table(const limn_control_mesh* mesh, const limn_patch_table_options* options,
                               const limn_plan_cache* cache, limn_patch_table** table, limn_error* error,
                               const Build& build) {
    if (table == nullptr) return report(bad_argument("table is null"), error);
    *table = nullptr;
    if (mesh == nullptr) return report(bad_argument("mesh is null"), error);
    const auto read = read_patch_table_options(options);
    if (!read) return report(read.error(), error);
    return give(build(mesh->value, *read, cache != nullptr ? &cache->value : nullptr), table, error);
}

Result<void> evaluate_curvatures(const double* given, uint64_t value_count, uint32_t width, limn_curvature* out,
                                 uint64_t count) {
    Reader reader;
    if (width != 3 && width != 4) reader.fail("width is neither 3 nor 4");
    const auto curvatures = reader.array(out, count, "curvatures");
    const auto values = reader.array(given, value_count, count, 6 * std::max(width, 3u), "results");
    if (!reader.state) return reader.state;
    evaluate_curvature(values.first(6 * width * curvatures.size()), width,
                       {reinterpret_cast<Curvature*>(curvatures.data()), curvatures.size()});
    return {};
}

Result<void> evaluate(const PatchTable& table, const limn_patch_evaluation* given) {
    const auto e = read_struct(given);
    if (!e) return e.error();
    Reader reader;
    reader.flags(e->flags, 0);
    const uint32_t width = e->width != 0 ? e->width : 3;
    const Derivatives derivatives = reader.choice(e->derivatives, kDerivatives, "number of derivatives");
    const auto samples = reader.array(e->samples, e->sample_count, "samples");
    const auto points = reader.array(e->points, e->point_value_count, table.point_count(), width, "points");
    // Rows of all values of one component, as many as fit.
    const uint64_t rows = e->result_value_count / width / value_count(derivatives);
    const auto results = reader.array(e->results, e->result_value_count, "results");
    const auto statuses = reader.array(e->statuses, e->status_count, e->sample_count, 1, "statuses");
    if (rows < e->sample_count) reader.fail("results is too short");
    if (!reader.state) return reader.state;
    evaluate_patches(table, {reinterpret_cast<const PatchSample*>(samples.data()), samples.size()}, points,
                     width, derivatives, results,
                     {reinterpret_cast<SampleStatus*>(statuses.data()), statuses.size()});
    return {};
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_control_mesh_create(const limn_control_mesh_description* description,
                                     limn_control_mesh** mesh, limn_error* error) noexcept {
    if (mesh == nullptr) return report(bad_argument("mesh is null"), error);
    *mesh = nullptr;
    return give(create_mesh(description), mesh, error);
}
void limn_control_mesh_destroy(limn_control_mesh* mesh) noexcept {
    delete mesh;
}

limn_result limn_build_control_create(limn_build_control** control, limn_error* error) noexcept {
    if (control == nullptr) return report(bad_argument("control is null"), error);
    *control = new (std::nothrow) limn_build_control;
    return *control != nullptr ? LIMN_SUCCESS : report(out_of_memory(), error);
}
void limn_build_control_destroy(limn_build_control* control) noexcept {
    delete control;
}
void limn_build_control_cancel(limn_build_control* control) noexcept {
    if (control != nullptr) control->value.cancel();
}
void limn_build_control_reset(limn_build_control* control) noexcept {
    if (control != nullptr) control->value.reset();
}
float limn_build_control_get_progress(const limn_build_control* control) noexcept {
    return control != nullptr ? control->value.progress() : 0;
}

limn_result limn_plan_cache_create(limn_plan_cache** cache, limn_error* error) noexcept {
    if (cache == nullptr) return report(bad_argument("cache is null"), error);
    *cache = nullptr;
    return give(limn::Result<limn::PlanCache>(limn::PlanCache()), cache, error);
}
void limn_plan_cache_destroy(limn_plan_cache* cache) noexcept {
    delete cache;
}

limn_result limn_patch_table_create(const limn_control_mesh* mesh, const limn_patch_table_options* options,
                                    limn_plan_cache* cache, limn_patch_table** table,
                                    limn_error* error) noexcept {
    return create_patch_table(mesh, options, cache, table, error, limn::build_patch_table<float>);
}
limn_result limn_patch_table_create_channel(const limn_control_mesh* mesh, uint32_t channel,
                                            const limn_patch_table_options* options, limn_plan_cache* cache,
                                            limn_patch_table** table, limn_error* error) noexcept {
    return create_patch_table(mesh, options, cache, table, error,
                              [&](const auto& m, const auto& o, const auto* plans) {
                                  return limn::build_face_varying_patch_table<float>(m, channel, o, plans);
                              });
}
void limn_patch_table_destroy(limn_patch_table* table) noexcept {
    delete table;
}

limn_result limn_patch_table_get_info(const limn_patch_table* table, limn_patch_table_info* info,
                                      limn_error* error) noexcept {
    if (table == nullptr) return report(bad_argument("table is null"), error);
    const limn::PatchTable& t = table->value;
    const limn_patch_table_info known = {0,
                                         t.control_count,
                                         t.first_refined,
                                         t.point_count(),
                                         static_cast<uint32_t>(t.ptex_surfaces.size()),
                                         static_cast<uint32_t>(t.surfaces.size()),
                                         static_cast<uint32_t>(t.plans.size()),
                                         static_cast<limn_scheme>(t.options.scheme),
                                         t.bytes()};
    return write_struct(known, info, error);
}

limn_result limn_patch_table_build_points(const limn_patch_table* table, const double* control_values,
                                          uint64_t control_value_count, uint32_t width, double* values,
                                          uint64_t value_count, limn_error* error) noexcept {
    if (table == nullptr || width == 0) return report(bad_argument("table is null, or width is 0"), error);
    Reader reader;
    const auto from = reader.array(control_values, control_value_count, table->value.control_count, width,
                                   "control_values");
    const auto to = reader.array(values, value_count, table->value.point_count(), width, "values");
    if (!reader.state) return report(reader.state.error(), error);
    limn::build_patch_points(table->value, from, width, to);
    return LIMN_SUCCESS;
}

limn_result limn_patch_table_evaluate(const limn_patch_table* table, const limn_patch_evaluation* evaluation,
                                      limn_error* error) noexcept {
    if (table == nullptr) return report(bad_argument("table is null"), error);
    const auto done = evaluate(table->value, evaluation);
    return done ? LIMN_SUCCESS : report(done.error(), error);
}
limn_result limn_evaluate_curvature(const double* results, uint64_t result_value_count, uint32_t width,
                                    limn_curvature* curvatures, uint64_t curvature_count, limn_error* error) noexcept {
    return report(evaluate_curvatures(results, result_value_count, width, curvatures, curvature_count), error);
}
