// The C interface: meshes that are edited, and crowds.
#include "limn/c/limn_changes.h"

#include "limn/c/change_interop.h"

namespace limn::c {
namespace {

Result<EditableMesh> create_editable(const limn_control_mesh* mesh, const limn_editable_mesh_options* given,
                                     const limn_plan_cache* cache) {
    const auto options = read_optional(given);
    if (!options) return options.error();
    const auto patches = read_patch_table_options(options->patches);
    if (!patches) return patches.error();
    Reader reader;
    if (mesh == nullptr) reader.fail("mesh is null");
    reader.flags(options->flags, LIMN_EDITABLE_MESH_JOIN_CREASES);
    const auto channels = reader.array(options->channels, options->channel_count, "channels");
    if (!reader.state) return reader.state.error();
    return EditableMesh::create(mesh->value,
                                {.patches = *patches,
                                 .split_creases = (options->flags & LIMN_EDITABLE_MESH_JOIN_CREASES) == 0,
                                 .channels = {channels.begin(), channels.end()}},
                                cache != nullptr ? &cache->value : nullptr);
}

Result<EditWork> edit(limn_editable_mesh* edited, const limn_mesh_edit* given) {
    const auto e = read_struct(given);
    if (!e) return e.error();
    Reader reader;
    if (edited == nullptr) reader.fail("the mesh is null");
    const MeshEdit out = {
        .faces = reader.array(e->faces, e->face_count, "faces"),
        .face_sizes = reader.array(e->face_sizes, e->face_count, "face_sizes"),
        .face_vertices = reader.array(e->face_vertices, e->face_vertex_count, "face_vertices"),
        .new_vertex_count = e->new_vertex_count,
        .crease_vertices = reader.array(e->crease_vertices, e->crease_vertex_count, "crease_vertices"),
        .crease_sharpness = reader.array(e->crease_sharpness, e->crease_sharpness_count, "crease_sharpness"),
        .corner_vertices = reader.array(e->corner_vertices, e->corner_count, "corner_vertices"),
        .corner_sharpness = reader.array(e->corner_sharpness, e->corner_count, "corner_sharpness"),
        .holes = reader.array(e->holes, e->hole_count, "holes"),
        .filled_holes = reader.array(e->filled_holes, e->filled_hole_count, "filled_holes")};
    if (!reader.state) return reader.state.error();
    return edited->value.edit(out);
}

Result<Crowd> create_crowd(const limn_crowd_options* given) {
    const auto options = read_optional(given);
    if (!options) return options.error();
    Reader reader;
    reader.flags(options->flags, LIMN_CROWD_NO_RESERVE);
    if (options->reserved != 0) reader.fail("reserved is not 0");
    const bool exact = (options->flags & LIMN_CROWD_NO_RESERVE) != 0;
    if (exact && options->reserve != 0) reader.fail("a reserve, and none");
    if (!reader.state) return reader.state.error();
    CrowdOptions out;
    if (options->max_rate != 0) out.max_rate = options->max_rate;
    if (options->points_per_pass != 0) out.points_per_pass = options->points_per_pass;
    if (options->max_weight_bytes != 0) out.max_weight_bytes = options->max_weight_bytes;
    if (options->reserve != 0 || exact) out.reserve = options->reserve;
    return Crowd(out);
}

Result<void> add(limn_crowd* crowd, const limn_crowd_mesh* given, uint64_t count, uint32_t* instances) {
    Reader reader;
    if (crowd == nullptr) reader.fail("crowd is null");
    const auto meshes = reader.array(given, count, "meshes");
    const auto numbers = reader.array(instances, count, "instances");
    std::vector<BatchMesh> out;
    for (const limn_crowd_mesh& mesh : meshes) {
        out.push_back({value_of(mesh.patches), value_of(mesh.tessellation)});
        if (mesh.patches == nullptr || mesh.tessellation == nullptr) reader.fail("a mesh lacks a table");
    }
    if (!reader.state) return reader.state;
    const auto added = crowd->value.add(out);
    if (!added) return added.error();
    std::copy(added->begin(), added->end(), numbers.begin());
    return {};
}

limn_range range_of(const BatchRange& range) {
    return {range.first, range.count};
}

/// The table, where there is one, as an object of its own.
template <class Object>
limn_result copy_table(const Object* from, Object** table, limn_error* error) {
    return create(table, error, [&]() -> Result<decltype(Object::value)> {
        if (from == nullptr) return bad_argument("the table to copy is null");
        return decltype(Object::value)(from->value);
    });
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_editable_mesh_create(const limn_control_mesh* mesh, const limn_editable_mesh_options* options,
                                      limn_plan_cache* cache, limn_editable_mesh** edited, limn_error* error) noexcept {
    return create(edited, error, [&] { return create_editable(mesh, options, cache); });
}
void limn_editable_mesh_destroy(limn_editable_mesh* edited) noexcept {
    delete edited;
}

limn_result limn_editable_mesh_edit(limn_editable_mesh* edited, const limn_mesh_edit* given, limn_edit_work* work,
                                    limn_error* error) noexcept {
    if (work != nullptr)  // before anything changes
        if (const auto room = check_room(work); !room) return report(room.error(), error);
    const auto done = edit(edited, given);
    if (!done) return report(done.error(), error);
    if (work == nullptr) return LIMN_SUCCESS;
    return write_struct({0, done->face_count, done->tessellation ? 1u : 0u, 0}, work, error);
}

const limn_control_mesh* limn_editable_mesh_get_mesh(const limn_editable_mesh* edited) noexcept {
    return edited != nullptr ? as_object<limn_control_mesh>(&edited->value.mesh()) : nullptr;
}
const limn_patch_table* limn_editable_mesh_get_patches(const limn_editable_mesh* edited) noexcept {
    return edited != nullptr ? as_object<limn_patch_table>(&edited->value.patches()) : nullptr;
}
const limn_tessellation_table* limn_editable_mesh_get_tessellation(const limn_editable_mesh* edited) noexcept {
    return edited != nullptr ? as_object<limn_tessellation_table>(&edited->value.tessellation()) : nullptr;
}

limn_result limn_patch_table_create_copy(const limn_patch_table* from, limn_patch_table** table,
                                         limn_error* error) noexcept {
    return copy_table(from, table, error);
}
limn_result limn_tessellation_table_create_copy(const limn_tessellation_table* from, limn_tessellation_table** table,
                                                limn_error* error) noexcept {
    return copy_table(from, table, error);
}

limn_result limn_crowd_create(const limn_crowd_options* options, limn_crowd** crowd, limn_error* error) noexcept {
    return create(crowd, error, [&] { return create_crowd(options); });
}
void limn_crowd_destroy(limn_crowd* crowd) noexcept {
    delete crowd;
}

limn_result limn_crowd_add(limn_crowd* crowd, const limn_crowd_mesh* meshes, uint64_t mesh_count, uint32_t* instances,
                           limn_error* error) noexcept {
    return report(add(crowd, meshes, mesh_count, instances), error);
}
limn_result limn_crowd_remove(limn_crowd* crowd, uint32_t instance, limn_error* error) noexcept {
    if (crowd == nullptr) return report(bad_argument("crowd is null"), error);
    return report(crowd->value.remove(instance), error);
}
limn_result limn_crowd_compact(limn_crowd* crowd, limn_error* error) noexcept {
    if (crowd == nullptr) return report(bad_argument("crowd is null"), error);
    return report(crowd->value.compact(), error);
}

limn_result limn_crowd_get_info(const limn_crowd* crowd, limn_crowd_info* info, limn_error* error) noexcept {
    if (crowd == nullptr) return report(bad_argument("crowd is null"), error);
    const limn::Crowd& c = crowd->value;
    return write_struct({0, c.instance_capacity(), c.instance_count(), 0, c.layout(), c.bytes(), c.changed_bytes()},
                        info, error);
}

limn_result limn_crowd_get_instance(const limn_crowd* crowd, uint32_t instance, limn_crowd_instance* info,
                                    limn_error* error) noexcept {
    if (crowd == nullptr) return report(bad_argument("crowd is null"), error);
    const limn::CrowdInstance* found = crowd->value.find(instance);
    if (found == nullptr)
        return report({limn::ErrorCode::index_out_of_range, "there is no such instance", instance}, error);
    const auto& [patches, topology] = *found;
    return write_struct({0, 0, range_of(patches.control_points), range_of(patches.ptex_faces),
                         range_of(patches.surfaces), range_of(topology.mesh_edges), range_of(topology.sub_face_edges),
                         range_of(topology.rows), range_of(topology.corners)},
                        info, error);
}

const limn_patch_table* limn_crowd_get_patches(const limn_crowd* crowd) noexcept {
    return crowd != nullptr ? as_object<limn_patch_table>(&crowd->value.patches()) : nullptr;
}
const limn_tessellation_table* limn_crowd_get_tessellation(const limn_crowd* crowd) noexcept {
    return crowd != nullptr ? as_object<limn_tessellation_table>(&crowd->value.topology()) : nullptr;
}
void limn_crowd_forget_changes(limn_crowd* crowd) noexcept {
    if (crowd != nullptr) crowd->value.forget_changes();
}
