#include "limn/vulkan/surface_tables.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "limn/shared/grid_eval_params.h"
#include "limn/vulkan/table_upload.h"

namespace limn::vk {

Result<PatchTableUpload> record_patch_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                   const PatchTable& table) {
    PatchTableUpload upload;
    DevicePatchTable& out = upload.table;
    out.scheme = table.options.scheme;
    out.end_cap = table.end_cap;
    out.control_count = table.control_count;
    out.first_refined = table.first_refined;
    out.point_count = table.point_count();
    out.ptex_count = static_cast<uint32_t>(table.ptex_surfaces.size());
    out.narrow_rings = table.ring_points.narrow;
    for (const Plan& plan : table.plans) out.max_ring_size = std::max(out.max_ring_size, plan.ring_size);
    const TableSection sections[] = {section_of(table.ptex_surfaces, out.offsets.ptex_surfaces),
                                     section_of(table.surfaces, out.offsets.surfaces),
                                     section_of(table.ring_points.words, out.offsets.ring_points),
                                     section_of(table.plans, out.offsets.plans),
                                     section_of(table.plan_nodes, out.offsets.plan_nodes),
                                     section_of(table.plan_points, out.offsets.plan_points),
                                     section_of(table.plan_weights, out.offsets.plan_weights)};
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

struct GridWords {
    std::vector<uint32_t> words;
    std::vector<GridBatch> batches;
};

void append_placements(const GridTable& table, std::vector<uint32_t>& words, std::vector<uint32_t>& offsets) {
    for (size_t p = 0; p < table.placements.size(); ++p) {
        const GridPlacement& placement = table.placements[p];
        const size_t end =
            p + 1 < table.placements.size() ? table.placements[p + 1].first : table.placement_samples.size();
        offsets.push_back(static_cast<uint32_t>(words.size()));
        for (const int32_t x : {placement.uu, placement.uv, placement.vu, placement.vv})
            words.push_back(static_cast<uint32_t>(x));
        words.insert(words.end(), table.placement_samples.begin() + placement.first,
                     table.placement_samples.begin() + end);
    }
}

void append_tile(const GridTable& table, std::span<const GridSurface> surfaces, uint32_t capacity,
                 const std::vector<uint32_t>& placements, std::vector<uint32_t>& words) {
    const GridClass& c = table.classes[surfaces[0].grid_class];
    const size_t end = words.size() + shared::kGridTileHeader + shared::kGridTileSurfaceWords * capacity;
    words.insert(words.end(), {c.first_weight, static_cast<uint32_t>(surfaces.size()), c.ring_size});
    for (const GridSurface& s : surfaces)
        words.insert(words.end(),
                     {s.first_ring, s.ptex_face % table.faces_per_pass, placements[s.placement]});
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

/// Tiles of each pass: those that one dispatch can take follow each other.
GridWords lay_out(const GridTable& table) {
    GridWords out;
    std::vector<uint32_t> placements;
    append_placements(table, out.words, placements);
    auto pass_of = [&](size_t i) { return table.surfaces[i].ptex_face / table.faces_per_pass; };
    for (size_t begin = 0, end = 0; begin < table.surfaces.size(); begin = end) {
        const uint32_t pass = pass_of(begin);
        Batches batches;
        while (end < table.surfaces.size() && pass_of(end) == pass) {
            const size_t first = end;
            const uint32_t grid_class = table.surfaces[first].grid_class;
            while (end < table.surfaces.size() && table.surfaces[end].grid_class == grid_class &&
                   pass_of(end) == pass)
                ++end;
            add_tiles(table.classes[grid_class], {table.surfaces.data() + first, end - first}, batches);
        }
        for (const auto& [key, tiles] : batches) {
            out.batches.push_back({key[0], key[1], key[2], pass, key[3],
                                   static_cast<uint32_t>(out.words.size()),
                                   static_cast<uint32_t>(tiles.size())});
            for (const auto& tile : tiles) append_tile(table, tile, key[3], placements, out.words);
        }
    }
    return out;
}

}  // namespace

Result<GridTableUpload> record_grid_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                 const GridTable& table) {
    GridTableUpload upload;
    DeviceGridTable& out = upload.table;
    out.rate = table.rate;
    out.value_count = table.value_count;
    out.ptex_count = table.ptex_count;
    out.samples_per_face = table.samples_per_face;
    out.faces_per_pass = table.faces_per_pass;
    out.relative = table.relative;
    out.total_sample_count = table.total_sample_count;
    GridWords grid = lay_out(table);
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

Result<DeviceGridTable> upload_grid_table(const Device& device, const GridTable& table) {
    return upload_and_wait(
        device, [&](VkCommandBuffer commands) { return record_grid_table_upload(device, commands, table); });
}

Result<DevicePatchTrees> upload_patch_trees(const Device& device, const PatchTreeTable& table) {
    return upload_and_wait(
        device, [&](VkCommandBuffer commands) { return record_patch_trees_upload(device, commands, table); });
}

}  // namespace limn::vk
