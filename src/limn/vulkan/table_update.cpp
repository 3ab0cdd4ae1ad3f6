#include "limn/vulkan/table_update.h"

#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/table_copies.h"
#include "limn/vulkan/tessellation_upload.h"

namespace limn::vk {
namespace {

std::span<const std::byte> bytes_of(const TableSection& section) {
    return {static_cast<const std::byte*>(section.data), section.bytes};
}
std::span<const std::byte> bytes_of(const std::vector<uint32_t>& words) {
    return std::as_bytes(std::span(words));
}

/// Arrays of groups of four words stay such.
VkDeviceSize with_reserve(VkDeviceSize bytes, float reserve) {
    return bytes + (static_cast<VkDeviceSize>(static_cast<double>(reserve) * static_cast<double>(bytes)) + 15) / 16 * 16;
}

/// Plans a buffer of sections, which begin at the offsets that `after` refers to and, where they do not fit,
/// at others afterwards. Errors: too_large.
Result<void> plan_sections(const Buffer& buffer, std::span<const TableSection> before,
                           std::span<const TableSection> after, float reserve, TableCopies& copies) {
    bool fits = buffer.handle != VK_NULL_HANDLE;
    for (size_t i = 0; i < after.size() && fits; ++i) {
        const VkDeviceSize end =
            i + 1 < after.size() ? VkDeviceSize{4} * *after[i + 1].offset : buffer.size_bytes;
        fits = VkDeviceSize{4} * *after[i].offset + after[i].bytes <= end;
    }
    VkDeviceSize at = 0;
    for (size_t i = 0; i < after.size() && !fits; ++i) {
        *after[i].offset = static_cast<uint32_t>(at / 4);
        at += (with_reserve(after[i].bytes, reserve) + 15) / 16 * 16;
        if (at / 4 > 0xffffffffu) return Error{ErrorCode::too_large, "a table of 2^32 words or more"};
    }
    const uint32_t target = copies.add_target(fits ? 0 : std::max<VkDeviceSize>(at, 16));
    for (size_t i = 0; i < after.size(); ++i)
        copies.add_differences(target, VkDeviceSize{4} * *after[i].offset, bytes_of(before[i]),
                               bytes_of(after[i]));
    return {};
}

/// A buffer of one array.
void plan_array(const Buffer& buffer, std::span<const std::byte> before, std::span<const std::byte> after,
                float reserve, TableCopies& copies) {
    const bool fits = buffer.handle != VK_NULL_HANDLE && after.size() <= buffer.size_bytes;
    const uint32_t target =
        copies.add_target(fits ? 0 : std::max<VkDeviceSize>(with_reserve(after.size(), reserve), 16));
    copies.add_differences(target, 0, before, after);
}

/// Rows of level-1 points as devices have them.
struct PointWords {
    StencilRuns runs;
    std::vector<uint32_t> words;
};
Result<PointWords> lay_out_points(const PatchTable& table) {
    PointWords out;
    if (table.refined_count == 0) return out;
    const StencilTable rows = build_point_table(table);
    auto planned = plan_stencil_runs(rows);
    if (!planned) return planned.error();
    out.runs = std::move(*planned);
    out.words.resize(2 * std::max<uint64_t>(out.runs.pair_count, 1));
    write_stencil_runs(rows, out.runs, out.words.data());
    return out;
}

struct PatchUpdate {
    TableCopies copies;
    shared::PatchTableOffsets offsets = {};
    PointWords before, after;
};

Result<PatchUpdate> plan(const DevicePatchTable& table, const PatchTable& before, const PatchTable& after,
                         float reserve) {
    PatchUpdate out;
    auto points_before = lay_out_points(before), points_after = lay_out_points(after);
    if (!points_before) return points_before.error();
    if (!points_after) return points_after.error();
    out.before = std::move(*points_before);
    out.after = std::move(*points_after);
    shared::PatchTableOffsets unused;
    out.offsets = table.offsets;
    const auto old_sections = patch_sections(before, unused), sections = patch_sections(after, out.offsets);
    if (auto planned = plan_sections(table.words, old_sections, sections, reserve, out.copies); !planned)
        return planned.error();
    if (after.refined_count != 0)
        plan_array(table.points.data, bytes_of(out.before.words), bytes_of(out.after.words), reserve,
                   out.copies);
    return out;
}

/// Grids of an update: their words before and after, in that order.
struct GridLayouts {
    GridWords before, after;
};
Result<GridLayouts> plan_grid(const Device& device, const DeviceGridTable& table, const GridTable& before,
                              const GridTable& after, float reserve, TableCopies& copies) {
    GridLayouts out = {lay_out(before, reads_texels(device)), lay_out(after, reads_texels(device))};
    if (out.after.words.size() > 0xffffffffu)
        return Error{ErrorCode::too_large, "a grid of 2^32 words or more"};
    plan_array(table.words, bytes_of(out.before.words), bytes_of(out.after.words), reserve, copies);
    const auto weights = [](const GridTable& t) {
        return std::as_bytes(std::span(t.weights.data(), t.weights.size()));
    };
    plan_array(table.weights, weights(before), weights(after), reserve, copies);
    return out;
}

struct GridUpdate {
    TableCopies copies;
    GridLayouts layouts;
};
Result<GridUpdate> plan(const Device& device, const DeviceGridTable& table, const GridTable& before,
                        const GridTable& after, float reserve) {
    GridUpdate out;
    auto planned = plan_grid(device, table, before, after, reserve, out.copies);
    if (!planned) return planned.error();
    out.layouts = std::move(*planned);
    return out;
}

struct TessellationUpdate {
    TableCopies copies;
    TessellationOffsets offsets;
    MadeWords before, after;
    std::vector<GridLayouts> grids;  ///< of vertices, then of channels
};

const PatchTreeTable& trees_of(const TessellationTables& tables, size_t i) {
    return i == 0 ? *tables.vertices : *tables.channels[i - 1];
}

Result<TessellationUpdate> plan(const Device& device, const DeviceTessellationTable& table,
                                const TessellationTables& before, const TessellationTables& after,
                                float reserve) {
    const size_t channels = after.channels.size();
    const bool is_empty = table.words.handle == VK_NULL_HANDLE;
    if (before.channels.size() != channels || (!is_empty && table.channels.size() != channels))
        return Error{ErrorCode::invalid_argument,
                     "a tessellation table is updated to other channels than it has"};
    for (size_t i = 0; i < 1 + channels; ++i)
        if (trees_of(after, i).ptex_surfaces.size() != after.topology->face_count)
            return Error{ErrorCode::invalid_argument,
                         "patch trees are of another mesh than the tessellation table"};
    TessellationUpdate out;
    TessellationOffsets unused;
    const auto old_sections =
                   sections_of(*before.topology, *before.vertices, before.channels, unused, out.before),
               sections =
                   sections_of(*after.topology, *after.vertices, after.channels, out.offsets, out.after);
    out.offsets.vertices = table.vertices.offsets;
    out.offsets.topology = table.offsets;
    out.offsets.instances = table.instances_offset;
    for (size_t c = 0; c < table.channels.size(); ++c) out.offsets.channels[c] = table.channels[c].offsets;
    if (auto planned = plan_sections(table.words, old_sections, sections, reserve, out.copies); !planned)
        return planned.error();
    const DeviceGridTable none;
    for (size_t i = 0; i < 1 + channels; ++i) {
        const DeviceGridTable& grid = i == 0     ? table.vertices.local_points
                                      : is_empty ? none
                                                 : table.channels[i - 1].local_points;
        auto planned = plan_grid(device, grid, trees_of(before, i).local_points,
                                 trees_of(after, i).local_points, reserve, out.copies);
        if (!planned) return planned.error();
        out.grids.push_back(std::move(*planned));
    }
    return out;
}

/// Whether a member is another one afterwards.
template <class Table, class... Members>
bool differs(const Table& a, const Table& b, Members Table::*... members) {
    return ((a.*members != b.*members) || ...);
}

/// Takes batches over. True: what is prepared with the grid is out of date.
bool settle(const GridTable& table, std::vector<GridBatch>&& batches, DeviceGridTable& out) {
    DeviceGridTable counts;
    describe(table, counts);
    const bool changed =
        out.batches != batches || differs(counts, out, &DeviceGridTable::rate, &DeviceGridTable::value_count,
                                          &DeviceGridTable::ptex_count, &DeviceGridTable::samples_per_face,
                                          &DeviceGridTable::faces_per_pass, &DeviceGridTable::relative,
                                          &DeviceGridTable::total_sample_count);
    describe(table, out);
    out.batches = std::move(batches);
    return changed;
}

}  // namespace

Result<TableUpdate> record_patch_table_update(const Device& device, VkCommandBuffer command_buffer,
                                              DevicePatchTable& table, const PatchTable& before,
                                              const PatchTable& after, float reserve) {
    auto planned = plan(table, before, after, reserve);
    if (!planned) return planned.error();
    TableUpdate update;
    Buffer* const targets[] = {&table.words, &table.points.data};
    const std::span used = std::span(targets).first(after.refined_count != 0 ? 2 : 1);
    if (auto recorded = planned->copies.record(device, command_buffer, used, update); !recorded)
        return recorded.error();
    DevicePatchTable counts;
    describe(after, counts);
    update.prepare_again = planned->copies.replaces_any() || table.points.runs != planned->after.runs.runs ||
                           differs(counts, table, &DevicePatchTable::scheme, &DevicePatchTable::end_cap,
                                   &DevicePatchTable::control_count, &DevicePatchTable::first_refined,
                                   &DevicePatchTable::point_count, &DevicePatchTable::ptex_count,
                                   &DevicePatchTable::narrow_rings, &DevicePatchTable::max_ring_size);
    describe(after, table);
    table.offsets = planned->offsets;
    table.points.source_count = after.control_count;
    table.points.row_count = after.refined_count;
    table.points.runs = std::move(planned->after.runs.runs);
    return update;
}

Result<TableUpdate> record_grid_table_update(const Device& device, VkCommandBuffer command_buffer,
                                             DeviceGridTable& table, const GridTable& before,
                                             const GridTable& after, float reserve) {
    auto planned = plan(device, table, before, after, reserve);
    if (!planned) return planned.error();
    TableUpdate update;
    Buffer* const targets[] = {&table.words, &table.weights};
    if (auto recorded = planned->copies.record(device, command_buffer, targets, update); !recorded)
        return recorded.error();
    const bool changed = settle(after, std::move(planned->layouts.after.batches), table);
    update.prepare_again = changed || planned->copies.replaces_any();
    return update;
}

Result<TableUpdate> record_tessellation_table_update(const Device& device, VkCommandBuffer command_buffer,
                                                     DeviceTessellationTable& table,
                                                     const TessellationTables& before,
                                                     const TessellationTables& after, float reserve) {
    auto planned = plan(device, table, before, after, reserve);
    if (!planned) return planned.error();
    TableUpdate update;
    table.channels.resize(after.channels.size());
    std::vector<Buffer*> targets = {&table.words};
    const auto trees = [&](size_t i) -> DevicePatchTrees& {
        return i == 0 ? table.vertices : table.channels[i - 1];
    };
    for (size_t i = 0; i < planned->grids.size(); ++i) {
        targets.push_back(&trees(i).local_points.words);
        targets.push_back(&trees(i).local_points.weights);
    }
    if (auto recorded = planned->copies.record(device, command_buffer, targets, update); !recorded)
        return recorded.error();
    DeviceTessellationTable counts;
    describe(*after.topology, counts);
    bool changed = planned->copies.replaces_any();
    counts.max_rate = after.vertices->max_rate;
    for (size_t i = 0; i < planned->grids.size(); ++i) {
        const PatchTreeTable& from = trees_of(after, i);
        counts.max_rate = std::min(counts.max_rate, from.max_rate);
        trees(i).local_count = from.local_count();
        changed |=
            settle(from.local_points, std::move(planned->grids[i].after.batches), trees(i).local_points);
    }
    update.prepare_again =
        changed ||
        differs(counts, table, &DeviceTessellationTable::scheme, &DeviceTessellationTable::face_count,
                &DeviceTessellationTable::row_count, &DeviceTessellationTable::corner_count,
                &DeviceTessellationTable::rate_edge_count, &DeviceTessellationTable::corner_copy_count,
                &DeviceTessellationTable::row_copy_count, &DeviceTessellationTable::instance_count,
                &DeviceTessellationTable::max_rate);
    describe(*after.topology, table);
    table.max_rate = counts.max_rate;
    set_offsets(planned->offsets, table);
    return update;
}

Result<MemoryNeed> update_memory(const Device& device, const DevicePatchTable& table,
                                 const PatchTable& before, const PatchTable& after, float reserve) {
    const auto planned = plan(table, before, after, reserve);
    if (!planned) return planned.error();
    return planned->copies.memory(device);
}

Result<MemoryNeed> update_memory(const Device& device, const DeviceGridTable& table, const GridTable& before,
                                 const GridTable& after, float reserve) {
    const auto planned = plan(device, table, before, after, reserve);
    if (!planned) return planned.error();
    return planned->copies.memory(device);
}

Result<MemoryNeed> update_memory(const Device& device, const DeviceTessellationTable& table,
                                 const TessellationTables& before, const TessellationTables& after,
                                 float reserve) {
    const auto planned = plan(device, table, before, after, reserve);
    if (!planned) return planned.error();
    return planned->copies.memory(device);
}

}  // namespace limn::vk
