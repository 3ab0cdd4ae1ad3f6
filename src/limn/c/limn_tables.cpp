// The C interface: what devices take beside patch tables.
#include <vector>

#include "limn/batch.h"
#include "limn/c/interop.h"
#include "limn/schemes/scheme_surface.h"

namespace limn::c {
namespace {

Result<PatchTreeTable> create_trees(const limn_patch_table* table, const limn_patch_trees_options* given) {
    const auto options = read_optional(given);
    if (!options) return options.error();
    Reader reader;
    if (table == nullptr) reader.fail("table is null");
    reader.flags(options->flags, LIMN_PATCH_TREES_RELATIVE);
    if (!reader.state) return reader.state.error();
    PatchTreeOptions out;
    out.relative = (options->flags & LIMN_PATCH_TREES_RELATIVE) != 0;
    out.control = control_of(options->control);
    if (options->max_rate != 0) out.max_rate = options->max_rate;
    if (options->points_per_pass != 0) out.points_per_pass = options->points_per_pass;
    if (options->max_weight_bytes != 0) out.max_weight_bytes = options->max_weight_bytes;
    return build_patch_trees(table->value, out);
}

Result<TessellationTable> create_tessellation(const limn_control_mesh* mesh,
                                              const limn_tessellation_table_options* given) {
    const auto options = read_optional(given);
    if (!options) return options.error();
    Reader reader;
    if (mesh == nullptr) reader.fail("mesh is null");
    reader.flags(options->flags, LIMN_TESSELLATION_TABLE_JOIN_CREASES);
    const auto channels = reader.array(options->channels, options->channel_count, "channels");
    if (!reader.state) return reader.state.error();
    return build_tessellation_table(
        mesh->value, {.split_creases = (options->flags & LIMN_TESSELLATION_TABLE_JOIN_CREASES) == 0,
                      .channels = channels,
                      .control = control_of(options->control)});
}

Result<GridTable> create_grid(const limn_patch_table* table, const limn_grid_table_options* given) {
    const auto options = read_optional(given);
    if (!options) return options.error();
    Reader reader;
    if (table == nullptr) reader.fail("table is null");
    reader.flags(options->flags, LIMN_GRID_TABLE_POINTS_ONLY);
    if (!reader.state) return reader.state.error();
    GridOptions out;
    out.control = control_of(options->control);
    out.derivatives = (options->flags & LIMN_GRID_TABLE_POINTS_ONLY) == 0;
    if (options->rate != 0) out.rate = options->rate;
    if (options->samples_per_pass != 0) out.samples_per_pass = options->samples_per_pass;
    if (options->max_weight_bytes != 0) out.max_weight_bytes = options->max_weight_bytes;
    return build_grid_table(table->value, out);
}

constexpr Interpolation kInterpolations[] = {Interpolation::vertex, Interpolation::varying};

Result<StencilTable> create_stencils(const limn_control_mesh* mesh, const limn_stencil_table_options* given) {
    const auto options = read_struct(given);
    if (!options) return options.error();
    const bool limit = (options->flags & LIMN_STENCIL_TABLE_LIMIT) != 0;
    const bool tangents = (options->flags & LIMN_STENCIL_TABLE_TANGENTS) != 0;
    Reader reader;
    if (mesh == nullptr) reader.fail("mesh is null");
    reader.flags(options->flags, LIMN_STENCIL_TABLE_LIMIT | LIMN_STENCIL_TABLE_TANGENTS);
    const Interpolation interpolation =
        reader.choice(options->interpolation, kInterpolations, "interpolation");
    if (tangents && !limit) reader.fail("tangents are those of limits");
    if (limit && interpolation != Interpolation::vertex) reader.fail("limits are those of vertex data");
    if (!reader.state) return reader.state.error();
    const auto base = build_refinement(mesh->value, {.level = 0, .full_last_level = true});
    if (!base) return base.error();
    const BuildPart control = control_of(options->control);
    if (limit) return build_limit_table<float>(*base, options->level, tangents, control);
    return build_stencil_table<float>(*base, options->level, interpolation, control);
}

Result<void> apply(const limn_stencil_table* table, uint32_t weights, const float* source, uint64_t source_count,
                   uint32_t width, float* values, uint64_t value_count) {
    if (table == nullptr || width == 0) return bad_argument("table is null, or width is 0");
    const StencilTable& t = table->value;
    Reader reader;
    if (weights > LIMN_STENCIL_TANGENT2) reader.fail("there are no such weights");
    if (weights != LIMN_STENCIL_POINTS && t.tangent1_weights.empty() && t.row_count() != 0)
        reader.fail("the table has no tangents");
    const auto from = reader.array(source, source_count, t.source_count, width, "source");
    const auto to = reader.array(values, value_count, t.row_count(), width, "values");
    if (!reader.state) return reader.state;
    const auto run = [&](const StencilTable& rows) {
        apply_stencil_table<float>(rows, from.first(size_t{width} * t.source_count),
                                   to.first(size_t{width} * t.row_count()), width);
    };
    if (weights == LIMN_STENCIL_POINTS)
        run(t);
    else
        run(with_weights(t, weights == LIMN_STENCIL_TANGENT1 ? t.tangent1_weights : t.tangent2_weights));
    return {};
}

/// `refine(mesh, options)` makes the level that the table begins with.
template <class Refine>
Result<RefinedGridTable> create_refined_grid(const limn_control_mesh* mesh, const limn_refined_grid_table_options* given,
                                             const Refine& refine) {
    const auto options = read_optional(given);
    if (!options) return options.error();
    Reader reader;
    if (mesh == nullptr) reader.fail("mesh is null");
    if (options->reserved != 0) reader.fail("reserved is not 0");
    RefinedGridOptions out;
    out.interpolation = reader.choice(options->interpolation, kInterpolations, "interpolation");
    if (!reader.state) return reader.state.error();
    if (options->level != 0) out.level = options->level;
    if (options->max_weight_bytes != 0) out.max_weight_bytes = options->max_weight_bytes;
    out.control = control_of(options->control);
    const auto base = refine(mesh->value, RefinementOptions{.level = 0, .full_last_level = true});
    if (!base) return base.error();
    return build_refined_grid_table(*base, out);
}

/// What objects hold, of an array of them.
template <class T, class Object>
Result<std::vector<const T*>> read_objects(const Object* const* objects, uint64_t count) {
    Reader reader;
    std::vector<const T*> out;
    for (const Object* object : reader.array(objects, count, "tables")) {
        if (object == nullptr) return bad_argument("one of the tables is null");
        out.push_back(&object->value);
    }
    if (!reader.state) return reader.state.error();
    return out;
}

Result<PatchTable> merge(const limn_patch_table* const* tables, uint64_t count) {
    const auto read = read_objects<PatchTable>(tables, count);
    if (!read) return read.error();
    auto merged = merge_patch_tables<float>(*read);
    if (!merged) return merged.error();
    return std::move(merged->table);
}

Result<TessellationTable> merge(const limn_tessellation_table* const* tables, uint64_t count) {
    const auto read = read_objects<TessellationTable>(tables, count);
    if (!read) return read.error();
    auto merged = merge_tessellation_tables(*read);
    if (!merged) return merged.error();
    return std::move(merged->table);
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_patch_table_create_merged(const limn_patch_table* const* tables, uint64_t table_count,
                                           limn_patch_table** table, limn_error* error) noexcept {
    return create(table, error, [&] { return merge(tables, table_count); });
}

limn_result limn_patch_trees_create(const limn_patch_table* table, const limn_patch_trees_options* options,
                                    limn_patch_trees** trees, limn_error* error) noexcept {
    return create(trees, error, [&] { return create_trees(table, options); });
}
void limn_patch_trees_destroy(limn_patch_trees* trees) noexcept {
    delete trees;
}

limn_result limn_tessellation_table_create(const limn_control_mesh* mesh,
                                           const limn_tessellation_table_options* options,
                                           limn_tessellation_table** table, limn_error* error) noexcept {
    return create(table, error, [&] { return create_tessellation(mesh, options); });
}
limn_result limn_tessellation_table_create_merged(const limn_tessellation_table* const* tables,
                                                  uint64_t table_count, limn_tessellation_table** table,
                                                  limn_error* error) noexcept {
    return create(table, error, [&] { return merge(tables, table_count); });
}
void limn_tessellation_table_destroy(limn_tessellation_table* table) noexcept {
    delete table;
}
limn_result limn_tessellation_table_get_info(const limn_tessellation_table* table,
                                             limn_tessellation_table_info* info, limn_error* error) noexcept {
    if (table == nullptr) return report(bad_argument("table is null"), error);
    const limn::TessellationTable& t = table->value;
    const limn_tessellation_table_info known = {
        0,           t.face_count,   t.rate_edge_count,  t.mesh_edge_count,
        t.row_count, t.corner_count, t.instance_count(), 0,
        t.bytes()};
    return write_struct(known, info, error);
}

limn_result limn_grid_table_create(const limn_patch_table* table, const limn_grid_table_options* options,
                                   limn_grid_table** grid, limn_error* error) noexcept {
    return create(grid, error, [&] { return create_grid(table, options); });
}
void limn_grid_table_destroy(limn_grid_table* grid) noexcept {
    delete grid;
}
uint64_t limn_grid_table_get_sample_count(const limn_grid_table* grid) noexcept {
    return grid != nullptr ? grid->value.sample_count() : 0;
}

limn_result limn_stencil_table_create(const limn_control_mesh* mesh,
                                      const limn_stencil_table_options* options, limn_stencil_table** table,
                                      limn_error* error) noexcept {
    return create(table, error, [&] { return create_stencils(mesh, options); });
}
void limn_stencil_table_destroy(limn_stencil_table* table) noexcept {
    delete table;
}
uint32_t limn_stencil_table_get_row_count(const limn_stencil_table* table) noexcept {
    return table != nullptr ? table->value.row_count() : 0;
}

limn_result limn_stencil_table_apply(const limn_stencil_table* table, limn_stencil_weights weights, const float* source,
                                     uint64_t source_value_count, uint32_t width, float* values, uint64_t value_count,
                                     limn_error* error) noexcept {
    return report(apply(table, weights, source, source_value_count, width, values, value_count), error);
}

limn_result limn_refined_grid_table_create(const limn_control_mesh* mesh, const limn_refined_grid_table_options* options,
                                           limn_refined_grid_table** table, limn_error* error) noexcept {
    return create(table, error, [&] { return create_refined_grid(mesh, options, limn::build_refinement); });
}
limn_result limn_refined_grid_table_create_channel(const limn_control_mesh* mesh, uint32_t channel,
                                                   const limn_refined_grid_table_options* options,
                                                   limn_refined_grid_table** table, limn_error* error) noexcept {
    return create(table, error, [&] {
        return create_refined_grid(mesh, options, [&](const auto& of, const auto& base) {
            return limn::build_face_varying_refinement(of, channel, base);
        });
    });
}
void limn_refined_grid_table_destroy(limn_refined_grid_table* table) noexcept {
    delete table;
}
uint32_t limn_refined_grid_table_get_point_count(const limn_refined_grid_table* table) noexcept {
    return table != nullptr ? table->value.point_count() : 0;
}
