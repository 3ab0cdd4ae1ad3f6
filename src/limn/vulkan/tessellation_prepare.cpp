// From what is asked for to dispatches with all bound.
#include <algorithm>
#include <tuple>

#include "limn/vulkan/tessellation_state.h"

namespace limn::vk {
namespace {

constexpr VkFormat kWords = VK_FORMAT_R32_UINT, kFloats = VK_FORMAT_R32_SFLOAT,
                   kWordGroups = VK_FORMAT_R32G32B32A32_UINT, kFloatGroups = VK_FORMAT_R32G32B32A32_SFLOAT;

Result<void> check_optional(const PointBuffer& points, uint32_t width) {
    return points.buffer != VK_NULL_HANDLE ? check_points(points, width) : Result<void>();
}
Result<void> check_words(const WordBuffer& words, bool optional) {
    if (words.buffer == VK_NULL_HANDLE && !optional) return bad_argument("a buffer is null");
    if (words.offset_bytes % 4 != 0) return bad_argument("the offset of a buffer is not a multiple of 4");
    return {};
}

VkDeviceSize local_bytes_of(uint32_t local_count) {
    return std::max<VkDeviceSize>(VkDeviceSize{local_count} * 16, 16);
}
VkDeviceSize height_bytes_of(uint32_t vertex_capacity) {
    return std::max<VkDeviceSize>(VkDeviceSize{vertex_capacity} * 12, 4);
}
/// Of a TessellationTable or a DeviceTessellationTable.
template <class Table>
VkDeviceSize word_bytes_of(const Table& table, uint32_t rate_edge_count, bool rates_only) {
    return 4ull * (rates_only ? shared::tess_items(rate_edge_count, table.face_count)
                              : shared::tess_state_words(rate_edge_count, table.face_count, table.row_count));
}

/// For hardware tessellation: no vertices, no triangles.
bool is_rates_only(const TessellationInfo& info) {
    return info.positions.buffer == VK_NULL_HANDLE && info.indices.buffer == VK_NULL_HANDLE &&
           info.command.buffer == VK_NULL_HANDLE;
}

Result<void> check_rates_only(const TessellationInfo& info) {
    for (const PointBuffer* points : {&info.normals, &info.places, &info.tangents, &info.previous_points,
                                      &info.previous_positions, &info.heights})
        if (points->buffer != VK_NULL_HANDLE) return bad_argument("there are outputs of vertices, but no positions");
    if (info.vertex_capacity != 0 || info.triangle_capacity != 0 || !info.channels.empty() ||
        info.height_texture.view != VK_NULL_HANDLE || info.triangle_faces.buffer != VK_NULL_HANDLE ||
        info.instance_commands.buffer != VK_NULL_HANDLE)
        return bad_argument("rates alone are asked for, but also what vertices or triangles have");
    if (auto checked = check_points(info.points, 3); !checked) return checked;
    if (auto checked = check_words(info.result, true); !checked) return checked;
    return check_words(info.edge_rates, info.mode != RateMode::per_edge);
}

Result<void> check(const TessellationInfo& info) {
    if (info.patches == nullptr || info.table == nullptr) return bad_argument("there are no tables to tessellate");
    if (info.table->face_count != info.patches->ptex_count) return bad_argument("the tables are of different meshes");
    if (info.instances.offset_bytes % 4 != 0) return bad_argument("the offset of instances is not a multiple of 4");
    if (is_rates_only(info)) return check_rates_only(info);
    const std::pair<const PointBuffer*, uint32_t> outputs[] = {
        {&info.normals, 3}, {&info.places, 4}, {&info.tangents, 4}, {&info.previous_points, 3},
        {&info.previous_positions, 3}};
    for (const auto& [points, width] : outputs)
        if (auto checked = check_optional(*points, width); !checked) return checked;
    for (const PointBuffer* points : {&info.points, &info.positions})
        if (auto checked = check_points(*points, 3); !checked) return checked;
    if ((info.previous_points.buffer == VK_NULL_HANDLE) != (info.previous_positions.buffer == VK_NULL_HANDLE))
        return bad_argument("previous points and positions go together");
    for (const WordBuffer* words : {&info.indices, &info.command})
        if (auto checked = check_words(*words, false); !checked) return checked;
    for (const WordBuffer* words : {&info.triangle_faces, &info.result, &info.instance_commands})
        if (auto checked = check_words(*words, true); !checked) return checked;
    if (auto checked = check_words(info.edge_rates, info.mode != RateMode::per_edge); !checked) return checked;
    if (auto checked = check_optional(info.heights, 3); !checked) return checked;
    const HeightTexture& texture = info.height_texture;
    bool has_tangent_channel = false, has_height_channel = texture.view == VK_NULL_HANDLE;
    if (!has_height_channel && texture.sampler == VK_NULL_HANDLE) return bad_argument("a texture of heights has no sampler");
    for (const TessellatedChannel& channel : info.channels) {
        if (channel.patches == nullptr || channel.channel >= info.table->channels.size())
            return bad_argument("there is no such channel");
        if (channel.width < 1 || channel.width > 4) return bad_argument("a channel has 1 to 4 components");
        if (auto checked = check_points(channel.points, channel.width); !checked) return checked;
        if (auto checked = check_optional(channel.values, channel.width); !checked) return checked;
        has_tangent_channel |= channel.channel == info.tangent_channel && channel.width >= 2;
        has_height_channel |= channel.channel == texture.channel && channel.width >= 2;
    }
    if (!has_height_channel)
        return bad_argument("heights follow a channel of two components or more, which has to be among the channels");
    if (info.tangents.buffer != VK_NULL_HANDLE && info.tangent_channel != ~0u && !has_tangent_channel)
        return bad_argument("tangents follow a channel of two components or more, which has to be among the channels");
    return {};
}

}  // namespace

/// Per-vertex outputs of one dispatch: one or two.
struct VertexOutput {
    TessKernel kernel;
    uint32_t output;
    PointBuffer first;
    uint32_t first_width;
    PointBuffer second = {};  ///< optional
    uint32_t second_width = 0;
    uint32_t source = 0;  ///< which local points
    shared::TreeOffsets trees = {};
    BoundBuffer second_source = {};  ///< what is read beside them; optional
    std::array<uint32_t, 5> payload = {};  ///< from 6 on
};

/// Builds the dispatches of one tessellation.
struct TessellationPreparation {
    Tessellator::State& tessellator;
    const TessellationInfo& info;
    Tessellation::State& out;
    std::vector<VkDeviceSize> local_bytes = {};
    PointBuffer heights = {};  ///< the caller's, or limn's own

    const Device& device() const { return *tessellator.device; }
    const DeviceTessellationTable& table() const { return *info.table; }

    BoundBuffer read(VkBuffer buffer, VkDeviceSize bytes, VkFormat format) const {
        return {buffer, 0, bytes,
                tessellator.texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, format};
    }
    /// Floats of the caller's, `bytes` from byte `begin` on; `base` is where they begin in what is bound.
    BoundBuffer read_floats(VkBuffer buffer, uint64_t begin, uint64_t bytes, uint32_t& base) const {
        const VkPhysicalDeviceLimits& limits = device().properties.limits;
        const uint64_t alignment = std::max<uint64_t>(16, tessellator.texel ? limits.minTexelBufferOffsetAlignment
                                                                            : limits.minStorageBufferOffsetAlignment);
        const uint64_t aligned = begin - begin % alignment;
        base = static_cast<uint32_t>((begin - aligned) / 4);
        BoundBuffer bound = read(buffer, begin + bytes - aligned, kFloats);
        bound.offset_bytes = aligned;
        return bound;
    }
    /// `bytes` from byte `begin` of a buffer that is written; `base` is where they begin, in words of what is bound.
    BoundBuffer write(VkBuffer buffer, uint64_t begin, uint64_t bytes, uint32_t& base) const {
        const uint64_t alignment = std::max<uint64_t>(4, device().properties.limits.minStorageBufferOffsetAlignment);
        const uint64_t aligned = begin - begin % alignment;
        base = static_cast<uint32_t>((begin - aligned) / 4);
        return {buffer, aligned, begin + bytes - aligned, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_FORMAT_UNDEFINED};
    }
    BoundBuffer state_words() const {
        return {out.words.handle, 0, out.words.size_bytes, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_FORMAT_UNDEFINED};
    }
    BoundBuffer local(uint32_t source) const {
        return read(out.local[source].handle, local_bytes[source], kFloatGroups);
    }

    Result<VkDescriptorSet> add_set(const BoundBuffer& local_points, const BoundBuffer& second, const BoundBuffer& first_out,
                                    const BoundBuffer& second_out) {
        const VkDeviceSize bytes = table().words.size_bytes;
        const BoundBuffer buffers[] = {read(table().words.handle, bytes, kWords),
                                       read(table().words.handle, bytes, kWordGroups),
                                       local_points,
                                       second,
                                       state_words(),
                                       first_out,
                                       second_out,
                                       read(out.words.handle, out.words.size_bytes, kWords)};
        const bool texture = second.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        Recording& sets = texture ? out.height_sets : out.sets;
        return sets.add_set(tessellator.kernels[texture ? kTessHeightKernel : kTessBudgetKernel].set_layout, buffers);
    }

    TessParams params(const shared::TreeOffsets& trees) const {
        TessParams p = {};
        p.tree = trees;
        p.table = table().offsets;
        p.face_count = table().face_count;
        p.row_count = table().row_count;
        p.corner_count = table().corner_count;
        p.rate_edge_count = table().rate_edge_count;
        p.max_rate = out.max_rate;
        p.payload[1] = word(info.vertex_capacity);
        p.payload[2] = word(info.triangle_capacity);
        return p;
    }
    Result<Dispatch> dispatch(TessKernel kernel, VkDescriptorSet set, uint64_t invocations, const TessParams& p,
                              uint32_t mode = 0, uint32_t output = 0) {
        const uint32_t constants[] = {table().scheme == Scheme::loop, static_cast<uint32_t>(info.spacing), mode, output};
        auto pipeline = tessellator.kernels[kernel].pipeline(constants);
        if (!pipeline) return pipeline.error();
        const uint64_t groups = (invocations - 1) / shared::kTessWorkgroupSize + 1;
        return out.sets.make_dispatch(*pipeline, set, groups, p);
    }

    Result<void> add_items(ItemStage& stage, TessKernel kernel, VkDescriptorSet set, uint32_t count, uint32_t Lanes::*lanes,
                           const TessParams& p, uint32_t mode, uint32_t output) {
        if (count == 0) return {};
        auto made = dispatch(kernel, set, count, p, mode, output);
        if (!made) return made.error();
        stage.push_back({*made, count, lanes});
        return {};
    }

    Result<void> add_local(const DevicePatchTable& patches, const DevicePatchTrees& trees, const PointBuffer& points,
                           uint32_t width);
    Result<void> add_rates();
    Result<void> add_instance_commands();
    Result<void> add_triangles();
    Result<void> add_output(const VertexOutput& output, ItemStage& stage);
    Result<void> add_heights(const std::vector<uint32_t>& channel_sources);
    Result<void> add_displacement();
    Result<void> add_outputs();
    Result<void> add_copies(const PointBuffer& positions, ItemStage& stage);
};

Result<void> TessellationPreparation::add_local(const DevicePatchTable& patches, const DevicePatchTrees& trees,
                                    const PointBuffer& points, uint32_t width) {
    const VkDeviceSize bytes = local_bytes_of(trees.local_count);
    auto buffer = create_buffer(device(), bytes, kPointUsage, MemoryUse::device);
    if (!buffer) return buffer.error();
    local_bytes.push_back(bytes);
    auto grid = tessellator.surfaces.prepare_grid({.patches = &patches,
                                                   .grid = &trees.local_points,
                                                   .width = width,
                                                   .points = points,
                                                   .values = {buffer->handle, 0, 0, 4}});
    if (!grid) return grid.error();
    out.local.push_back(std::move(*buffer));
    out.local_points.push_back(std::move(*grid));
    return {};
}

/// From points to where the vertices and triangles of each face begin.
Result<void> TessellationPreparation::add_rates() {
    const bool given = info.mode == RateMode::per_edge;
    TessParams p = params(table().vertices.offsets);
    BoundBuffer second = local(0);
    if (given) {
        uint32_t base = 0;
        second = read_floats(info.edge_rates.buffer, info.edge_rates.offset_bytes, 4ull * table().rate_edge_count, base);
        p.payload[15] = word(base);
    }
    const bool rates_only = is_rates_only(info);
    uint32_t command = shared::kNoFace, result = shared::kNoFace;
    const auto bind_optional = [&](const WordBuffer& words, uint64_t bytes, uint32_t& base) {
        return words.buffer != VK_NULL_HANDLE ? write(words.buffer, words.offset_bytes, bytes, base) : state_words();
    };
    const BoundBuffer command_out = bind_optional(info.command, 20, command);
    const BoundBuffer result_out = bind_optional(info.result, 16, result);
    auto set = add_set(local(0), second, command_out, result_out);
    if (!set) return set.error();
    // What looks at instances has a set of its own: no binding is left beside the command and the result.
    auto measured_set = set;
    p.payload[16] = p.payload[17] = word(shared::kNoFace);
    if (info.instances.buffer != VK_NULL_HANDLE && table().instance_count != 0) {
        uint32_t base = 0;
        const BoundBuffer instances = write(info.instances.buffer, info.instances.offset_bytes,
                                            sizeof(TessellationInstance) * table().instance_count, base);
        if (base != 0) return bad_argument("the offset of instances is not aligned as the device asks for");
        measured_set = add_set(local(0), second, instances, instances);
        if (!measured_set) return measured_set.error();
        p.payload[16] = p.payload[17] = word(table().instances_offset);
    }
    const uint64_t edges = table().rate_edge_count, faces = table().face_count,
                   items = uint64_t{table().row_count} + faces;
    Result<void> failed;
    const auto add = [&](TessKernel kernel, uint64_t invocations, const TessParams& constants, uint32_t mode) {
        const bool measures = kernel == kTessTargetKernel || kernel == kTessDrawnKernel;
        auto made = dispatch(kernel, measures ? *measured_set : *set, std::max<uint64_t>(invocations, 1), constants, mode);
        if (!made && failed) failed = made.error();
        return made ? *made : Dispatch{};
    };
    out.begin = add(kTessBudgetKernel, 1, p, rates_only ? shared::kTessRatesOnly : 0);
    out.targets = add(kTessTargetKernel, edges, p, static_cast<uint32_t>(info.mode));
    const uint32_t culling = (info.cull_outside ? shared::kTessCullOutside : 0) |
                             (info.cull_backfaces ? shared::kTessCullBackfaces : 0);
    out.drawn = add(kTessDrawnKernel, faces, p, culling);
    p.payload[0] = shared::measures_edges(static_cast<uint32_t>(info.mode));
    p.payload[4] = word(command);
    p.payload[5] = word(result);
    out.rates.push_back({add(kTessRoundKernel, edges, p, 0)});
    if (rates_only) {
        out.rates.push_back({add(kTessScanKernel, 1, p, shared::kTessRatesOnly)});
        return failed;
    }
    Dispatch groups = {};
    out.sets.set_groups(groups, std::max(edges, items + 1) / shared::kTessWorkgroupSize + 1);
    p.payload[6] = word(groups.groups[0]);
    p.payload[7] = word(groups.groups[1]);
    out.rates.push_back({add(kTessCountKernel, items + 1, p, 0)});
    out.rates.push_back({add(kTessScanKernel, 1, p, info.fit_capacity ? shared::kTessTry : 0)});
    if (!info.fit_capacity) return failed;
    const auto add_scaled = [&](TessKernel kernel, uint32_t mode, uint32_t groups_at) {
        Dispatch again = add(kernel, 1, p, mode);
        again.indirect = out.words.handle;
        again.indirect_bytes = VkDeviceSize{4} * groups_at;
        out.scaled.push_back({again});
    };
    for (const uint32_t mode : {1u, 2u}) {
        add_scaled(kTessTrialKernel, 0, shared::kTessScaleItems);
        add_scaled(kTessBudgetKernel, mode, shared::kTessScaleOnce);
    }
    add_scaled(kTessRoundKernel, 0, shared::kTessScaleItems);
    add_scaled(kTessCountKernel, 0, shared::kTessScaleItems);
    add_scaled(kTessScanKernel, 0, shared::kTessScaleOnce);
    return failed;
}

Result<void> TessellationPreparation::add_instance_commands() {
    if (info.instance_commands.buffer == VK_NULL_HANDLE || table().instance_count == 0) return {};
    uint32_t base = 0;
    const uint64_t bytes = 4ull * shared::kTessCommandWords * table().instance_count;
    const BoundBuffer commands = write(info.instance_commands.buffer, info.instance_commands.offset_bytes, bytes, base);
    auto set = add_set(local(0), local(0), commands, commands);
    if (!set) return set.error();
    TessParams p = params(table().vertices.offsets);
    p.payload[0] = word(base);
    p.payload[1] = word(table().instances_offset);
    p.payload[2] = word(info.number_instances ? 1 : 0);
    auto made = dispatch(kTessCommandsKernel, *set, table().instance_count, p);
    if (!made) return made.error();
    out.instance_commands.push_back(*made);
    return {};
}

/// How many elements of so many bytes are bound at once.
static uint64_t slice_size(const Device& device, uint64_t element_bytes) {
    return std::max<uint64_t>(1, (device.properties.limits.maxStorageBufferRange - 4096) / element_bytes);
}

Result<void> TessellationPreparation::add_triangles() {
    const uint64_t slice = slice_size(device(), 12);
    for (uint64_t first = 0; first == 0 || first < info.triangle_capacity; first += slice) {
        const uint64_t count = std::min<uint64_t>(slice, info.triangle_capacity - first);
        if (count == 0) break;
        TessParams p = params(table().vertices.offsets);
        uint32_t indices = 0, faces = 0;
        const bool has_faces = info.triangle_faces.buffer != VK_NULL_HANDLE;
        const BoundBuffer indices_out =
            write(info.indices.buffer, info.indices.offset_bytes + 12 * first, 12 * count, indices);
        const BoundBuffer faces_out =
            has_faces ? write(info.triangle_faces.buffer, info.triangle_faces.offset_bytes + 4 * first, 4 * count, faces)
                      : indices_out;
        auto set = add_set(local(0), local(0), indices_out, faces_out);
        if (!set) return set.error();
        p.payload[0] = word(indices);
        p.payload[2] = word(faces);
        p.payload[4] = word(static_cast<uint32_t>(first));
        p.payload[5] = word(static_cast<uint32_t>(first + count));
        const uint32_t output =
            (has_faces ? shared::kTessFacesOfTriangles : 0) | (info.clockwise ? shared::kTessClockwise : 0);
        auto added = add_items(out.triangles, kTessTrianglesKernel, *set, table().face_count, &Lanes::triangles, p, 0, output);
        if (!added) return added;
    }
    return {};
}

Result<void> TessellationPreparation::add_output(const VertexOutput& output, ItemStage& stage) {
    const bool two = output.second.buffer != VK_NULL_HANDLE;
    const uint64_t slice = slice_size(device(), 4ull * std::max(output.first.stride, two ? output.second.stride : 1));
    for (uint64_t first = 0; first < info.vertex_capacity; first += slice) {
        const uint64_t end = std::min<uint64_t>(info.vertex_capacity, first + slice);
        uint32_t first_base = 0, second_base = 0;
        const auto bind = [&](const PointBuffer& points, uint32_t width, uint32_t& base) {
            const uint64_t begin = byte_of(points, first, 0);
            return write(points.buffer, begin, 4 * ((end - first - 1) * points.stride + width), base);
        };
        const BoundBuffer first_out = bind(output.first, output.first_width, first_base);
        const BoundBuffer second_out = two ? bind(output.second, output.second_width, second_base) : first_out;
        auto set = add_set(local(output.source),
                           output.second_source.size_bytes != 0 ? output.second_source : local(output.source), first_out,
                           second_out);
        if (!set) return set.error();
        TessParams p = params(output.trees);
        const uint32_t payload[6] = {first_base,           output.first.stride,          second_base,
                                     output.second.stride, static_cast<uint32_t>(first), static_cast<uint32_t>(end)};
        for (int i = 0; i < 6; ++i) p.payload[i] = word(payload[i]);
        for (size_t i = 0; i < output.payload.size(); ++i) p.payload[6 + i] = word(output.payload[i]);
        const std::tuple<uint32_t, uint32_t, uint32_t Lanes::*> domains[] = {
            {shared::kTessCorners, table().corner_count, &Lanes::corners},
            {shared::kTessRows, table().row_count, &Lanes::rows},
            {shared::kTessFaces, table().face_count, &Lanes::faces}};
        for (const auto& [domain, count, lanes] : domains)
            if (auto added = add_items(stage, output.kernel, *set, count, lanes, p, domain, output.output); !added)
                return added;
    }
    return {};
}

Result<void> TessellationPreparation::add_copies(const PointBuffer& positions, ItemStage& stage) {
    const uint32_t corners = table().corner_copy_count, rows = table().row_copy_count;
    if (corners + rows == 0 || info.vertex_capacity == 0) return {};
    // Corners and rows come first, and nothing within faces is copied: all that must be bound at once.
    const uint64_t vertices = std::min<uint64_t>(
        info.vertex_capacity, table().corner_count + uint64_t{table().row_count} * table().max_rate);
    uint32_t base = 0;
    const BoundBuffer bound = write(positions.buffer, positions.offset_bytes + 4 * positions.first,
                                    4 * ((vertices - 1) * positions.stride + 3), base);
    auto set = add_set(local(0), local(0), bound, bound);
    if (!set) return set.error();
    TessParams p = params(table().vertices.offsets);
    p.payload[0] = word(base);
    p.payload[1] = word(positions.stride);
    const std::tuple<uint32_t, uint32_t, uint32_t, uint32_t Lanes::*> domains[] = {
        {shared::kTessCorners, corners, 0, &Lanes::corners}, {shared::kTessRows, rows, corners, &Lanes::rows}};
    for (const auto& [domain, count, first, lanes] : domains) {
        p.payload[7] = word(count);
        p.payload[8] = word(first);
        if (auto added = add_items(stage, kTessCopyKernel, *set, count, lanes, p, domain, 0); !added) return added;
    }
    return {};
}

/// Heights by the texture, and what they move.
Result<void> TessellationPreparation::add_heights(const std::vector<uint32_t>& channel_sources) {
    const HeightTexture& texture = info.height_texture;
    for (size_t c = 0; c < info.channels.size(); ++c) {
        if (info.channels[c].channel != texture.channel) continue;
        BoundBuffer image = {};
        image.type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        image.size_bytes = 1;
        image.image = {texture.sampler, texture.view, texture.layout};
        return add_output({.kernel = kTessHeightKernel,
                           .output = shared::kTessOutputValue,
                           .first = heights,
                           .first_width = 3,
                           .source = channel_sources[c],
                           .trees = table().channels[texture.channel].offsets,
                           .second_source = image,
                           .payload = {std::bit_cast<uint32_t>(texture.scale), std::bit_cast<uint32_t>(texture.bias)}},
                          out.heights);
    }
    return {};
}

Result<void> TessellationPreparation::add_displacement() {
    const bool normals = info.normals.buffer != VK_NULL_HANDLE;
    const uint64_t floats = (uint64_t{info.vertex_capacity} - 1) * heights.stride + 3;
    uint32_t base = 0;
    const BoundBuffer source = read_floats(heights.buffer, byte_of(heights, 0, 0), 4 * floats, base);
    return add_output({.kernel = kTessDisplaceKernel,
                       .output = normals ? shared::kTessOutputNormal : shared::kTessOutputValue,
                       .first = info.positions,
                       .first_width = 3,
                       .second = info.normals,
                       .second_width = 3,
                       .trees = table().vertices.offsets,
                       .second_source = source,
                       .payload = {base, heights.stride}},
                      out.displaced.vertices);
}

Result<void> TessellationPreparation::add_outputs() {
    const shared::TreeOffsets& trees = table().vertices.offsets;
    const bool normals = info.normals.buffer != VK_NULL_HANDLE, texture = info.height_texture.view != VK_NULL_HANDLE;
    heights = info.heights;
    if (texture && heights.buffer == VK_NULL_HANDLE) {
        auto buffer = create_buffer(device(), height_bytes_of(info.vertex_capacity), kPointUsage, MemoryUse::device);
        if (!buffer) return buffer.error();
        out.own_heights = std::move(*buffer);
        heights = {.buffer = out.own_heights.handle};
    }
    std::vector<VertexOutput> outputs;
    if (!texture)  // else displacement writes them at once
        outputs.push_back({kTessVerticesKernel, normals ? shared::kTessOutputNormal : shared::kTessOutputValue,
                           info.positions, 3, info.normals, 3, 0, trees, {}, {3}});
    if (info.places.buffer != VK_NULL_HANDLE)
        outputs.push_back({kTessVerticesKernel, shared::kTessOutputPlace, info.places, 4, {}, 0, 0, trees});
    VertexOutput tangents = {kTessVerticesKernel, shared::kTessOutputTangent, info.tangents, 4, {}, 0, 0, trees, {},
                             {0, shared::kNoFace}};
    std::vector<uint32_t> channel_sources;
    for (const TessellatedChannel& channel : info.channels) {
        const DevicePatchTrees& own = table().channels[channel.channel];
        if (auto added = add_local(*channel.patches, own, channel.points, channel.width); !added) return added;
        channel_sources.push_back(static_cast<uint32_t>(out.local.size() - 1));
        if (channel.channel == info.tangent_channel) {
            tangents.second_source = local(channel_sources.back());
            tangents.payload = {0, own.offsets.ptex_surfaces, own.offsets.surfaces, own.offsets.nodes,
                                own.offsets.leaf_points};
        }
        if (channel.values.buffer != VK_NULL_HANDLE)
            outputs.push_back({kTessVerticesKernel, shared::kTessOutputValue, channel.values, channel.width, {}, 0,
                               channel_sources.back(), own.offsets, {}, {channel.width}});
    }
    if (info.tangents.buffer != VK_NULL_HANDLE) outputs.push_back(tangents);
    if (info.previous_points.buffer != VK_NULL_HANDLE) {
        if (auto added = add_local(*info.patches, table().vertices, info.previous_points, 3); !added) return added;
        outputs.push_back({kTessVerticesKernel, shared::kTessOutputValue, info.previous_positions, 3, {}, 0,
                           static_cast<uint32_t>(out.local.size() - 1), trees, {}, {3}});
    }
    for (const VertexOutput& output : outputs)
        if (auto added = add_output(output, out.plain.vertices); !added) return added;
    if (heights.buffer != VK_NULL_HANDLE && info.vertex_capacity != 0) {
        if (texture)
            if (auto added = add_heights(channel_sources); !added) return added;
        if (auto added = add_displacement(); !added) return added;
        if (auto added = add_copies(info.positions, out.displaced.copies); !added) return added;
    }
    if (!texture)
        if (auto added = add_copies(info.positions, out.plain.copies); !added) return added;
    if (info.previous_points.buffer == VK_NULL_HANDLE) return {};
    return add_copies(info.previous_positions, out.plain.copies);
}

MemoryNeed tessellation_memory(const TessellationMemoryInfo& info) {
    MemoryNeed need = {word_bytes_of(*info.table, info.table->rate_edge_count, info.rates_only), 0, 1};
    const auto add = [&](VkDeviceSize bytes) { need += {bytes, 0, 1}; };
    add(local_bytes_of(info.vertices->local_count()));
    if (info.previous_points) add(local_bytes_of(info.vertices->local_count()));
    for (const PatchTreeTable* channel : info.channels) add(local_bytes_of(channel->local_count()));
    if (info.own_height_count != 0) add(height_bytes_of(info.own_height_count));
    return need;
}

Result<Tessellation> Tessellator::prepare(const TessellationInfo& info) const {
    if (auto checked = check(info); !checked) return checked.error();
    Tessellation tessellation;
    Tessellation::State& out = *tessellation.state_;
    const DeviceTessellationTable& table = *info.table;
    out.sets.device = state_->device;
    out.sets.layout = state_->kernels[0].layout;
    out.sets.push_constant_bytes = sizeof(TessParams);
    out.height_sets.device = state_->device;
    out.height_sets.layout = state_->kernels[kTessHeightKernel].layout;
    out.height_sets.push_constant_bytes = sizeof(TessParams);
    out.mode = info.mode;
    out.spacing = info.spacing;
    out.cull_outside = info.cull_outside;
    out.cull_backfaces = info.cull_backfaces;
    out.has_instances = info.instances.buffer != VK_NULL_HANDLE;
    out.cpu_device = state_->texel;
    out.max_rate = table.max_rate;
    out.table = &table;
    const VkDeviceSize words = word_bytes_of(table, table.rate_edge_count, is_rates_only(info));
    auto buffer = create_buffer(*state_->device, words, kPointUsage | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, MemoryUse::device);
    if (!buffer) return buffer.error();
    out.words = std::move(*buffer);
    TessellationPreparation preparation{*state_, info, out};
    if (auto added = preparation.add_local(*info.patches, table.vertices, info.points, 3); !added) return added.error();
    if (auto added = preparation.add_rates(); !added) return added.error();
    if (is_rates_only(info)) return tessellation;
    if (auto added = preparation.add_instance_commands(); !added) return added.error();
    if (auto added = preparation.add_triangles(); !added) return added.error();
    if (auto added = preparation.add_outputs(); !added) return added.error();
    return tessellation;
}

}  // namespace limn::vk
