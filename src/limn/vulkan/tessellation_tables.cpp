#include "limn/vulkan/tessellation_tables.h"

#include "limn/vulkan/table_upload.h"

namespace limn::vk {
namespace {

/// Words that are not a table's own.
struct MadeWords {
    Array<uint32_t> copies, instances;
};

/// Of the words of a tessellation table: trees first, which start at offsets of `out`, as all sections do. `made`, what is made
/// for them, has to live as long as they are in use.
std::vector<TableSection> sections_of(const TessellationTable& table, const PatchTreeTable& vertices,
                                      std::span<const PatchTreeTable* const> channels, DeviceTessellationTable& out,
                                      MadeWords& made) {
    std::vector<TableSection> sections;
    add_tree_sections(vertices, out.vertices.offsets, sections);
    for (size_t c = 0; c < channels.size(); ++c) add_tree_sections(*channels[c], out.channels[c].offsets, sections);
    sections.push_back(section_of(table.faces, out.offsets.faces));
    sections.push_back(section_of(table.rows, out.offsets.rows));
    sections.push_back(section_of(table.corners, out.offsets.corners));
    sections.push_back(section_of(table.rate_edges, out.offsets.rate_edges));
    made.copies.allocate(table.corner_copies.size() + table.row_copies.size());
    std::copy(table.corner_copies.begin(), table.corner_copies.end(), made.copies.begin());
    std::copy(table.row_copies.begin(), table.row_copies.end(), made.copies.begin() + table.corner_copies.size());
    sections.push_back(section_of(made.copies, out.offsets.copies));
    made.instances = list_instances(table);
    sections.push_back(section_of(made.instances, out.instances_offset));
    return sections;
}

}  // namespace

Result<MemoryNeed> upload_memory(const Device& device, const TessellationTable& table, const PatchTreeTable& vertices,
                                 std::span<const PatchTreeTable* const> channels) {
    DeviceTessellationTable offsets;
    offsets.channels.resize(channels.size());
    MadeWords made;
    auto need = sections_memory(sections_of(table, vertices, channels, offsets, made));
    for (size_t i = 0; i < 1 + channels.size() && need; ++i) {
        const auto local_points = upload_memory(device, (i == 0 ? vertices : *channels[i - 1]).local_points);
        if (!local_points) return local_points.error();
        *need += *local_points;
    }
    return need;
}

Result<TessellationTableUpload> record_tessellation_table_upload(const Device& device, VkCommandBuffer command_buffer,
                                                                 const TessellationTable& table,
                                                                 const PatchTreeTable& vertices,
                                                                 std::span<const PatchTreeTable* const> channels) {
    TessellationTableUpload upload;
    DeviceTessellationTable& out = upload.table;
    out.scheme = table.options.scheme;
    out.face_count = table.face_count;
    out.row_count = table.row_count;
    out.corner_count = table.corner_count;
    out.rate_edge_count = table.rate_edge_count;
    out.corner_copy_count = table.corner_copy_count();
    out.row_copy_count = table.row_copy_count();
    out.max_rate = vertices.max_rate;
    auto trees = record_local_points_upload(device, command_buffer, vertices, upload.staging);
    if (!trees) return trees.error();
    out.vertices = std::move(*trees);
    for (const PatchTreeTable* channel : channels) {
        auto channel_trees = record_local_points_upload(device, command_buffer, *channel, upload.staging);
        if (!channel_trees) return channel_trees.error();
        out.channels.push_back(std::move(*channel_trees));
        out.max_rate = std::min(out.max_rate, channel->max_rate);
    }
    for (size_t i = 0; i < 1 + channels.size(); ++i)
        if ((i == 0 ? vertices : *channels[i - 1]).ptex_surfaces.size() != table.face_count)
            return Error{ErrorCode::invalid_argument, "patch trees are of another mesh than the tessellation table"};
    out.instance_count = table.instance_count();
    MadeWords made;
    const auto sections = sections_of(table, vertices, channels, out, made);
    auto words = record_sections_upload(device, command_buffer, sections, upload.staging);
    if (!words) return words.error();
    out.words = std::move(*words);
    return upload;
}

Result<DeviceTessellationTable> upload_tessellation_table(const Device& device, const TessellationTable& table,
                                                          const PatchTreeTable& vertices,
                                                          std::span<const PatchTreeTable* const> channels) {
    return upload_and_wait(device, [&](VkCommandBuffer commands) {
        return record_tessellation_table_upload(device, commands, table, vertices, channels);
    });
}

}  // namespace limn::vk
