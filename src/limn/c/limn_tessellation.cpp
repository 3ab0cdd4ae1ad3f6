// The C interface: tessellation on the CPU.
#include "limn/tessellate.h"

#include <optional>

#include "limn/c/interop.h"
#include "limn/shared/tess_steps.h"

struct limn_tessellation {
    limn::Tessellation value;
    uint32_t face_count;  ///< ptex faces
};

namespace limn::c {
namespace {

RateSettings read_settings(Reader& reader, const limn_tessellation_options& o) {
    RateSettings out;
    out.mode = reader.choice(o.mode, kRateModes, "rate mode");
    out.spacing = reader.choice(o.spacing, kSpacings, "spacing");
    if (o.value != 0) out.value = o.value;
    if (o.max_rate != 0) out.max_rate = o.max_rate;
    std::copy(std::begin(o.matrix), std::end(o.matrix), out.camera.matrix);
    out.camera.width = o.width;
    out.camera.height = o.height;
    return out;
}

/// What belongs to a tessellation has as many faces.
void check_faces(Reader& reader, const limn_patch_table* patches, size_t face_count) {
    if (patches == nullptr) return reader.fail("a patch table is null");
    if (patches->value.ptex_surfaces.size() != face_count) reader.fail("a patch table is of another mesh");
}

Result<limn_tessellation> create_tessellation(const limn_patch_table* patches, const limn_tessellation_table* table,
                                              const double* points, uint64_t point_value_count,
                                              const limn_tessellation_options* given) {
    const auto options = given != nullptr ? read_struct(given) : Result<limn_tessellation_options>(limn_tessellation_options{});
    if (!options) return options.error();
    Reader reader;
    if (table == nullptr) return bad_argument("table is null");
    const TessellationTable& topology = table->value;
    check_faces(reader, patches, topology.face_count);
    if (!reader.state) return reader.state.error();
    const RateSettings settings = read_settings(reader, *options);
    const auto at = reader.array(points, point_value_count, patches->value.point_count(), 3, "points");
    const bool per_edge = settings.mode == RateMode::per_edge;
    const auto edge_rates = per_edge ? reader.array(options->edge_rates, options->edge_rate_count, topology.rate_edge_count, 1, "edge_rates")
                                     : std::span<const float>();
    if (!reader.state) return reader.state.error();
    const double scale = options->scale != 0 ? static_cast<double>(options->scale) : 1;
    const auto rates = compute_rates(patches->value, topology, settings, at,
                                     edge_rates.first(per_edge ? topology.rate_edge_count : 0), scale);
    if (!rates) return rates.error();
    auto made = tessellate(topology, *rates, settings.spacing);
    if (!made) return made.error();
    return limn_tessellation{std::move(*made), topology.face_count};
}

Result<void> evaluate(const limn_tessellation* t, const limn_patch_table* patches,
                      const limn_tessellation_evaluation* given) {
    const auto e = read_struct(given);
    if (!e) return e.error();
    Reader reader;
    if (t == nullptr) return bad_argument("tessellation is null");
    check_faces(reader, patches, t->face_count);
    reader.flags(e->flags, 0);
    if (!reader.state) return reader.state;
    const uint64_t count = t->value.vertex_count();
    const auto exactly = [&](auto* data, uint64_t given_count, const char* name) {
        return reader.array(data, given_count, count, 3, name).first(reader.state ? 3 * count : 0);
    };
    const auto points = reader.array(e->points, e->point_value_count, patches->value.point_count(), 3, "points");
    const auto positions = exactly(e->positions, e->position_value_count, "positions");
    const auto normals = e->normals != nullptr ? exactly(e->normals, e->normal_value_count, "normals") : std::span<double>();
    if (e->heights == nullptr) {
        if (reader.state) evaluate_tessellation(patches->value, t->value, points, positions, normals);
        return reader.state;
    }
    if (e->normals == nullptr) reader.fail("displacement gives normals, too: they are null");
    const auto heights = exactly(e->heights, e->height_value_count, "heights");
    if (!reader.state) return reader.state;
    const double step = e->height_step != 0 ? e->height_step : static_cast<double>(shared::step_size(64));
    displace_tessellation(patches->value, t->value, points, heights, step, positions, normals);
    return {};
}

Result<void> evaluate_channel(const limn_tessellation* t, const limn_patch_table* channel, const double* points,
                              uint64_t point_value_count, uint32_t width, double* values, uint64_t value_count) {
    Reader reader;
    if (t == nullptr || width == 0) return bad_argument("tessellation is null, or width is 0");
    check_faces(reader, channel, t->face_count);
    if (!reader.state) return reader.state;
    const auto from = reader.array(points, point_value_count, channel->value.point_count(), width, "points");
    const auto to = reader.array(values, value_count, t->value.vertex_count(), width, "values");
    if (!reader.state) return reader.state;
    evaluate_tessellation_channel(channel->value, t->value, from, width,
                                  to.first(size_t{t->value.vertex_count()} * width));
    return {};
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_tessellation_create(const limn_patch_table* patches, const limn_tessellation_table* table,
                                     const double* points, uint64_t point_value_count,
                                     const limn_tessellation_options* options, limn_tessellation** tessellation,
                                     limn_error* error) noexcept {
    if (tessellation == nullptr) return report(bad_argument("tessellation is null"), error);
    *tessellation = nullptr;
    auto made = create_tessellation(patches, table, points, point_value_count, options);
    if (!made) return report(made.error(), error);
    *tessellation = new (std::nothrow) limn_tessellation(std::move(*made));
    return *tessellation != nullptr ? LIMN_SUCCESS : report(out_of_memory(), error);
}
void limn_tessellation_destroy(limn_tessellation* tessellation) noexcept {
    delete tessellation;
}
limn_result limn_tessellation_get_info(const limn_tessellation* tessellation, limn_tessellation_info* info,
                                       limn_error* error) noexcept {
    if (tessellation == nullptr) return report(bad_argument("tessellation is null"), error);
    const limn::Tessellation& t = tessellation->value;
    const limn_tessellation_info known = {0,
                                          t.vertex_count(),
                                          static_cast<uint32_t>(t.triangle_faces.size()),
                                          0,
                                          reinterpret_cast<const limn_patch_sample*>(t.places.data()),
                                          t.position_sources.data(),
                                          t.indices.data(),
                                          t.triangle_faces.data()};
    return write_struct(known, info, error);
}
limn_result limn_tessellation_evaluate(const limn_tessellation* tessellation, const limn_patch_table* patches,
                                       const limn_tessellation_evaluation* evaluation, limn_error* error) noexcept {
    const auto done = evaluate(tessellation, patches, evaluation);
    return done ? LIMN_SUCCESS : report(done.error(), error);
}
limn_result limn_tessellation_evaluate_channel(const limn_tessellation* tessellation, const limn_patch_table* channel,
                                               const double* points, uint64_t point_value_count, uint32_t width,
                                               double* values, uint64_t value_count, limn_error* error) noexcept {
    const auto done = evaluate_channel(tessellation, channel, points, point_value_count, width, values, value_count);
    return done ? LIMN_SUCCESS : report(done.error(), error);
}
