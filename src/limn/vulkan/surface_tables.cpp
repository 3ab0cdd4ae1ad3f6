#include "limn/vulkan/surface_tables.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "limn/shared/grid_eval_params.h"
#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/table_upload.h"

namespace limn::vk {

void describe(const PatchTable& table, DevicePatchTable& out) {
    out.scheme = table.options.scheme;
    out.end_cap = table.end_cap;
    out.control_count = table.control_count;
    out.first_refined = table.first_refined;
    out.point_count = table.point_count();
    out.ptex_count = static_cast<uint32_t>(table.ptex_surfaces.size());
    out.narrow_rings = table.ring_points.narrow;
    out.max_ring_size = 0;
    for (const Plan& plan : table.plans) out.max_ring_size = std::max(out.max_ring_size, plan.ring_size);
}

void describe(const GridTable& table, DeviceGridTable& out) {
    out.rate = table.rate;
    out.value_count = table.value_count;
    out.ptex_count = table.ptex_count;
    out.samples_per_face = table.samples_per_face;
    out.faces_per_pass = table.faces_per_pass;
    out.relative = table.relative;
    out.total_sample_count = table.total_sample_count;
}

std::array<TableSection, 7> patch_sections(const PatchTable& table, shared::PatchTableOffsets& offsets) {
    return {section_of(table.ptex_surfaces, offsets.ptex_surfaces),
            section_of(table.surfaces, offsets.surfaces),
            section_of(table.ring_points.words, offsets.ring_points),
            section_of(table.plans, offsets.plans),
            section_of(table.plan_nodes, offsets.plan_nodes),
            section_of(table.plan_points, offsets.plan_points),
            section_of(table.plan_weights, offsets.plan_weights)};
}

Result<MemoryNeed> upload_memory(const PatchTable& table) {
    shared::PatchTableOffsets offsets;
    auto need = sections_memory(patch_sections(table, offsets));
    if (!need || table.refined_count == 0) return need;
    const auto points = upload_memory(build_point_table(table));
    if (!points) return points.error();
    *need += *points;
    return need;
}

Result<PatchTableUpload> record_patch_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                   const PatchTable& table) {
    PatchTableUpload upload;
    DevicePatchTable& out = upload.table;
    describe(table, out);
    const auto sections = patch_sections(table, out.offsets);
    auto words = record_sections_upload(device, command_buffer, sections, upload.staging);
    if (!words) return words.error();
    out.words = std::move(*words);
    if (table.refined_count == 0) return upload;
    auto points = record_stencil_table_upload(device, command_buffer, build_point_table(table));
    if (!points) return points.error();
    out.points = std::move(points->table);
    upload.staging.push_back(std::move(points->staging));
    return upload;
}

namespace {

/// Where placements lie among the words; 0 where none is yet, since something always precedes them.
struct PlacementWords {
    std::vector<uint32_t> offsets, row_offsets;
};

void append_turn(const GridPlacement& p, std::vector<uint32_t>& words) {
    for (const int32_t x : {p.uu, p.uv, p.vu, p.vv}) words.push_back(static_cast<uint32_t>(x));
}

/// Of the surfaces that go into tiles, and of those that go by rows.
PlacementWords append_placements(const GridTable& table, const std::vector<bool>& by_rows, std::vector<uint32_t>& words) {
    PlacementWords out;
    out.offsets.resize(table.placements.size());
    out.row_offsets.resize(table.placements.size());
    const uint32_t* samples = table.placement_samples.data();
    for (const GridSurface& s : table.surfaces) {
        const GridPlacement& placement = table.placements[s.placement];
        if (!by_rows[s.grid_class]) {
            if (out.offsets[s.placement] != 0) continue;
            out.offsets[s.placement] = static_cast<uint32_t>(words.size());
            append_turn(placement, words);
            words.insert(words.end(), samples + placement.first, samples + placement.first + placement.count);
        } else if (!table.lattices.empty() && out.row_offsets[s.placement] == 0) {
            const GridLattice& lattice = table.lattices[s.placement];
            out.row_offsets[s.placement] = static_cast<uint32_t>(words.size());
            append_turn(placement, words);
            for (const int32_t x : {lattice.x, lattice.y, lattice.step}) words.push_back(static_cast<uint32_t>(x));
            words.insert(words.end(), {lattice.columns, lattice.rows});
            words.insert(words.end(), samples + lattice.first, samples + lattice.first + size_t{lattice.columns} * lattice.rows);
        }
    }
    return out;
}

/// The second word of a surface.
uint32_t face_word(const GridTable& table, const GridSurface& s, uint32_t first_slot) {
    return table.slots.empty() ? s.ptex_face % table.faces_per_pass : first_slot + s.ptex_face;
}

void append_tile(const GridTable& table, std::span<const GridSurface> surfaces, uint32_t capacity, uint32_t first_slot,
                 const std::vector<uint32_t>& placements, std::vector<uint32_t>& words) {
    const GridClass& c = table.classes[surfaces[0].grid_class];
    const size_t end = words.size() + shared::kGridTileHeader + shared::kGridTileSurfaceWords * capacity;
    words.insert(words.end(), {c.first_weight, static_cast<uint32_t>(surfaces.size()), c.ring_size});
    for (const GridSurface& s : surfaces)
        words.insert(words.end(),
                     {s.first_ring, face_word(table, s, first_slot), placements[s.placement]});
    words.resize(end, 0);
}

/// Large tiles load weights less often; small ones waste less where few surfaces are alike. Two sizes only, and
/// one for all of a class: on CPU devices a dispatch costs as much as some thousand samples.
uint32_t choose_tile(size_t class_size) {
    return class_size >= 4 ? shared::kGridMaxTileSurfaces : 1;
}

/// Group count, sample count, corners and surfaces per tile of a batch, and its tiles.
using Batches = std::map<std::array<uint32_t, 4>, std::vector<std::span<const GridSurface>>>;

/// Cuts the surfaces of one class into tiles.
void add_tiles(const GridClass& c, std::span<const GridSurface> surfaces, Batches& batches) {
    const uint32_t capacity = choose_tile(surfaces.size());
    auto& tiles = batches[{c.group_count, c.sample_count, c.corners, capacity}];
    for (size_t i = 0; i < surfaces.size(); i += capacity)
        tiles.push_back(surfaces.subspan(i, std::min<size_t>(capacity, surfaces.size() - i)));
}

/// Records of the regular patches of a pass, alike lattices side by side, since lanes of a vector go through theirs
/// together.
void add_records(const GridTable& table, uint32_t pass, std::vector<const GridSurface*>& surfaces,
                 const std::vector<uint32_t>& placements, uint32_t first_slot, GridWords& out) {
    if (surfaces.empty()) return;
    std::stable_sort(surfaces.begin(), surfaces.end(),
                     [](const GridSurface* a, const GridSurface* b) { return a->placement < b->placement; });
    GridBatch batch = {};
    batch.pass = pass;
    if (table.lattices.empty()) batch.sample_count = table.classes[surfaces[0]->grid_class].ring_size;
    batch.tile_base = static_cast<uint32_t>(out.words.size());
    batch.tile_count = static_cast<uint32_t>(surfaces.size());
    batch.by_rows = true;
    out.batches.push_back(batch);
    for (const GridSurface* s : surfaces)
        out.words.insert(out.words.end(), {s->first_ring, face_word(table, *s, first_slot), placements[s->placement]});
}

/// Whether local points of class c (patch_tree.h) are those of the ring, in order.
bool copies_ring(const GridTable& table, size_t c) {
    const GridClass& of = table.classes[c];
    if (table.rate != 0 || table.value_count != 1 || of.ring_size > 16) return false;
    const uint32_t* samples = table.placement_samples.data() + table.placements[c].first;
    const float* weights = table.weights.data() + size_t{4} * of.first_weight;
    for (uint32_t s = 0; s < of.sample_count; ++s) {
        if (samples[s] != (s < of.ring_size ? s : kInvalidIndex)) return false;
        for (uint32_t j = 0; j < of.ring_size && s < of.ring_size; ++j)
            if (weights[4 * (size_t{j / 4} * of.sample_count + s) + j % 4] != (s == j ? 1.0f : 0.0f)) return false;
    }
    return true;
}

/// Whether surfaces of each class are for grid_rows_texel. A CPU device ends loops after 65,535 rounds, all of an
/// invocation together. Rings that are copied all have the same size.
std::vector<bool> find_row_classes(const GridTable& table, bool cpu_device) {
    std::vector<bool> by_rows(table.classes.size());
    uint32_t copied_size = 0;
    for (size_t c = 0; c < by_rows.size() && cpu_device; ++c) {
        const GridClass& of = table.classes[c];
        if (!table.lattices.empty()) {
            by_rows[c] = of.corners == shared::kGridCornersBicubic && table.rate < 250;
        } else if ((copied_size == 0 || copied_size == of.ring_size) && copies_ring(table, c)) {
            by_rows[c] = true;
            copied_size = of.ring_size;
        }
    }
    return by_rows;
}

}  // namespace

GridWords lay_out(const GridTable& table, bool cpu_device) {
    GridWords out;
    out.words.push_back(0);
    const auto first_slot = static_cast<uint32_t>(out.words.size());
    out.words.insert(out.words.end(), table.slots.begin(), table.slots.end());
    const std::vector<bool> by_rows = find_row_classes(table, cpu_device);
    const PlacementWords placements = append_placements(table, by_rows, out.words);
    auto pass_of = [&](size_t i) { return table.slots.empty() ? table.surfaces[i].ptex_face / table.faces_per_pass : 0; };
    for (size_t begin = 0, end = 0; begin < table.surfaces.size(); begin = end) {
        const uint32_t pass = pass_of(begin);
        Batches batches;
        std::vector<const GridSurface*> records;
        while (end < table.surfaces.size() && pass_of(end) == pass) {
            const size_t first = end;
            const uint32_t grid_class = table.surfaces[first].grid_class;
            while (end < table.surfaces.size() && table.surfaces[end].grid_class == grid_class &&
                   pass_of(end) == pass)
                ++end;
            const std::span<const GridSurface> surfaces(table.surfaces.data() + first, end - first);
            if (by_rows[grid_class])
                for (const GridSurface& s : surfaces) records.push_back(&s);
            else
                add_tiles(table.classes[grid_class], surfaces, batches);
        }
        add_records(table, pass, records, placements.row_offsets, first_slot, out);
        for (const auto& [key, tiles] : batches) {
            out.batches.push_back({key[0], key[1], key[2], pass, key[3],
                                   static_cast<uint32_t>(out.words.size()),
                                   static_cast<uint32_t>(tiles.size())});
            for (const auto& tile : tiles) append_tile(table, tile, key[3], first_slot, placements.offsets, out.words);
        }
    }
    return out;
}

Result<MemoryNeed> upload_memory(const Device& device, const GridTable& table) {
    const uint64_t words = lay_out(table, reads_texels(device)).words.size();
    if (words > 0xffffffffu) return Error{ErrorCode::too_large, "a grid of 2^32 words or more"};
    MemoryNeed need = table_memory(words * 4);
    need += table_memory(table.weights.bytes());
    return need;
}

Result<MemoryNeed> upload_memory(const Device& device, const RefinedGridTable& table) {
    auto need = upload_memory(device, table.grid);
    if (need) *need += table_memory(table.ring_points.bytes());
    return need;
}

Result<MemoryNeed> upload_memory(const Device& device, const PatchTreeTable& table) {
    shared::TreeOffsets offsets;
    std::vector<TableSection> sections;
    add_tree_sections(table, offsets, sections);
    auto need = sections_memory(sections);
    if (!need) return need;
    const auto local_points = upload_memory(device, table.local_points);
    if (!local_points) return local_points.error();
    *need += *local_points;
    return need;
}

Result<GridTableUpload> record_grid_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                 const GridTable& table) {
    GridTableUpload upload;
    DeviceGridTable& out = upload.table;
    describe(table, out);
    GridWords grid = lay_out(table, reads_texels(device));
    if (grid.words.size() > 0xffffffffu) return Error{ErrorCode::too_large, "a grid of 2^32 words or more"};
    out.batches = std::move(grid.batches);
    auto words = create_table_buffer(device, command_buffer, grid.words.size() * 4, upload.staging);
    if (!words) return words.error();
    out.words = std::move(words->first);
    if (!grid.words.empty()) std::memcpy(words->second, grid.words.data(), grid.words.size() * 4);
    auto weights = create_table_buffer(device, command_buffer, table.weights.bytes(), upload.staging);
    if (!weights) return weights.error();
    out.weights = std::move(weights->first);
    if (!table.weights.empty()) std::memcpy(weights->second, table.weights.data(), table.weights.bytes());
    return upload;
}

Result<RefinedGridUpload> record_refined_grid_upload(const Device& device, VkCommandBuffer command_buffer,
                                                     const RefinedGridTable& table) {
    auto grid = record_grid_table_upload(device, command_buffer, table.grid);
    if (!grid) return grid.error();
    RefinedGridUpload upload{{table.source_count, std::move(grid->table), {}}, std::move(grid->staging)};
    auto rings = create_table_buffer(device, command_buffer, table.ring_points.bytes(), upload.staging);
    if (!rings) return rings.error();
    upload.table.rings = std::move(rings->first);
    if (!table.ring_points.empty()) std::memcpy(rings->second, table.ring_points.data(), table.ring_points.bytes());
    return upload;
}

Result<PatchTreesUpload> record_patch_trees_upload(const Device& device, VkCommandBuffer command_buffer,
                                                   const PatchTreeTable& table) {
    PatchTreesUpload upload;
    auto trees = record_local_points_upload(device, command_buffer, table, upload.staging);
    if (!trees) return trees.error();
    upload.table = std::move(*trees);
    std::vector<TableSection> sections;
    add_tree_sections(table, upload.table.offsets, sections);
    auto words = record_sections_upload(device, command_buffer, sections, upload.staging);
    if (!words) return words.error();
    upload.table.words = std::move(*words);
    return upload;
}

Result<DevicePatchTable> upload_patch_table(const Device& device, const PatchTable& table) {
    return upload_and_wait(
        device, [&](VkCommandBuffer commands) { return record_patch_table_upload(device, commands, table); });
}

Result<DeviceRefinedGrid> upload_refined_grid_table(const Device& device, const RefinedGridTable& table) {
    return upload_and_wait(
        device, [&](VkCommandBuffer commands) { return record_refined_grid_upload(device, commands, table); });
}

Result<DeviceGridTable> upload_grid_table(const Device& device, const GridTable& table) {
    return upload_and_wait(
        device, [&](VkCommandBuffer commands) { return record_grid_table_upload(device, commands, table); });
}

Result<DevicePatchTrees> upload_patch_trees(const Device& device, const PatchTreeTable& table) {
    return upload_and_wait(
        device, [&](VkCommandBuffer commands) { return record_patch_trees_upload(device, commands, table); });
}

}  // namespace limn::vk
