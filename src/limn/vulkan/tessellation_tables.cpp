#include "limn/vulkan/tessellation_tables.h"

#include "limn/vulkan/tessellation_upload.h"

namespace limn::vk {

std::vector<TableSection> sections_of(const TessellationTable& table, const PatchTreeTable& vertices,
                                      std::span<const PatchTreeTable* const> channels, TessellationOffsets& out, MadeWords& made) {
    std::vector<TableSection> sections;
    out.channels.resize(channels.size());
    add_tree_sections(vertices, out.vertices, sections);
    for (size_t c = 0; c < channels.size(); ++c) add_tree_sections(*channels[c], out.channels[c], sections);
    sections.push_back(section_of(table.faces, out.topology.faces));
    sections.push_back(section_of(table.rows, out.topology.rows));
    sections.push_back(section_of(table.corners, out.topology.corners));
    sections.push_back(section_of(table.rate_edges, out.topology.rate_edges));
    made.copies.allocate(table.corner_copies.size() + table.row_copies.size());
    std::copy(table.corner_copies.begin(), table.corner_copies.end(), made.copies.begin());
    std::copy(table.row_copies.begin(), table.row_copies.end(), made.copies.begin() + table.corner_copies.size());
    sections.push_back(section_of(made.copies, out.topology.copies));
    made.instances = list_instances(table);
    sections.push_back(section_of(made.instances, out.instances));
    return sections;
}

void describe(const TessellationTable& table, DeviceTessellationTable& out) {
    out.scheme = table.options.scheme;
    out.face_count = table.face_count;
    out.row_count = table.row_count;
    out.corner_count = table.corner_count;
    out.rate_edge_count = table.rate_edge_count;
    out.corner_copy_count = table.corner_copy_count();
    out.row_copy_count = table.row_copy_count();
    out.instance_count = table.instance_count();
}

void set_offsets(const TessellationOffsets& offsets, DeviceTessellationTable& out) {
    out.offsets = offsets.topology;
    out.instances_offset = offsets.instances;
    out.vertices.offsets = offsets.vertices;
    for (size_t c = 0; c < out.channels.size(); ++c) out.channels[c].offsets = offsets.channels[c];
}

Result<MemoryNeed> upload_memory(const Device& device, const TessellationTable& table, const PatchTreeTable& vertices,
                                 std::span<const PatchTreeTable* const> channels) {
    TessellationOffsets offsets;
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
    for (size_t i = 0; i < 1 + channels.size(); ++i) {
        const PatchTreeTable& trees = i == 0 ? vertices : *channels[i - 1];
        if (trees.max_rate == 0) return Error{ErrorCode::invalid_argument, "there are no patch trees: the mesh was baked without"};
        if (trees.ptex_surfaces.size() != table.face_count)
            return Error{ErrorCode::invalid_argument, "patch trees are of another mesh than the tessellation table"};
    }
    TessellationTableUpload upload;
    DeviceTessellationTable& out = upload.table;
    describe(table, out);
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
    TessellationOffsets offsets;
    MadeWords made;
    const auto sections = sections_of(table, vertices, channels, offsets, made);
    auto words = record_sections_upload(device, command_buffer, sections, upload.staging);
    if (!words) return words.error();
    out.words = std::move(*words);
    set_offsets(offsets, out);
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
