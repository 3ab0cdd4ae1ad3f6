#include "limn/baked_mesh.h"

#include <bit>
#include <cstdio>

#include "limn/baked_format.h"
#include "limn/hash.h"

namespace limn {
namespace {

template <class T>
Array<T> to_array(std::span<const T> values) {
    Array<T> out;
    out.allocate(values.size());
    std::copy(values.begin(), values.end(), out.begin());
    return out;
}

Result<PatchTreeTable> bake_trees(const PatchTable& patches, const BakeOptions& options) {
    if (options.max_rate == 0) return PatchTreeTable{};
    return build_patch_trees(patches, {.max_rate = options.max_rate});
}

Result<BakedChannel> bake_channel(const ControlMesh& mesh, uint32_t channel, std::span<const float> values,
                                  const BakeOptions& options, const PlanCache& cache) {
    const uint32_t count = mesh.channels[channel].value_count;
    BakedChannel out;
    out.width = count == 0 ? 0 : static_cast<uint32_t>(values.size() / count);
    if (out.width < 1 || out.width > 4 || values.size() != size_t{count} * out.width)
        return Error{ErrorCode::invalid_argument,
                     "channel " + std::to_string(channel) + " has " + std::to_string(values.size()) + " floats for " +
                         std::to_string(count) + " values of 1 to 4",
                     channel};
    auto patches = build_face_varying_patch_table<float>(mesh, channel, options.patches, &cache);
    if (!patches) return patches.error();
    auto trees = bake_trees(*patches, options);
    if (!trees) return trees.error();
    out.values = to_array(values);
    out.patches = std::move(*patches);
    out.trees = std::move(*trees);
    return out;
}

/// What is only baked where asked for.
Result<void> bake_extras(const ControlMesh& mesh, const BakeOptions& options, BakedMesh& out) {
    for (const uint32_t rate : options.grid_rates) {
        auto grid = build_grid_table(out.patches, {.rate = rate});
        if (!grid) return grid.error();
        out.grids.push_back(std::move(*grid));
    }
    if (options.refined_levels.empty() && options.stencil_levels.empty() && options.limit_levels.empty()) return {};
    const auto refinement = build_refinement(mesh, {1, false});
    if (!refinement) return refinement.error();
    for (const uint32_t level : options.refined_levels) {
        auto refined = build_refined_grid_table(*refinement, {.level = level});
        if (!refined) return refined.error();
        out.refined.push_back(std::move(*refined));
    }
    for (const bool limit : {false, true}) {
        for (const uint32_t level : limit ? options.limit_levels : options.stencil_levels) {
            auto table = limit ? build_limit_table<float>(*refinement, level, true)
                               : build_stencil_table<float>(*refinement, level);
            if (!table) return table.error();
            out.stencils.push_back({level, limit, std::move(*table)});
        }
    }
    return {};
}

}  // namespace

std::string ContentHash::hex() const {
    char text[33];
    std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(high),
                  static_cast<unsigned long long>(low));
    return text;
}

uint64_t BakedMesh::bytes() const {
    uint64_t sum = patches.bytes() + tessellation.bytes() + trees.bytes() + positions.bytes() + edges.bytes();
    for (const BakedChannel& c : channels) sum += c.values.bytes() + c.patches.bytes() + c.trees.bytes();
    for (const GridTable& grid : grids) sum += grid.bytes();
    for (const RefinedGridTable& grid : refined) sum += grid.bytes();
    for (const BakedStencils& s : stencils) sum += s.table.bytes();
    return sum;
}

ContentHash content_hash(const ControlMeshDescription& d, const BakeOptions& o) {
    ContentHasher hash;
    hash.add(kBakedVersion);
    for (const uint32_t value :
         {static_cast<uint32_t>(d.options.scheme), static_cast<uint32_t>(d.options.boundary),
          static_cast<uint32_t>(d.options.creasing), static_cast<uint32_t>(d.options.triangles),
          uint32_t{d.options.opensubdiv_compatible}, uint32_t{d.left_handed}, d.vertex_count})
        hash.add(value);
    for (const std::span<const uint32_t> list :
         {d.face_sizes, d.face_vertices, d.crease_sizes, d.crease_vertices, d.corner_vertices, d.holes})
        hash.add(list);
    for (const std::span<const float> list : {d.crease_sharpness, d.corner_sharpness, d.positions}) hash.add(list);
    hash.add(static_cast<uint32_t>(d.channels.size()));
    for (const FaceVaryingDescription& channel : d.channels) {
        hash.add(channel.value_count);
        hash.add(channel.face_values);
        hash.add(static_cast<uint32_t>(channel.interpolation));
    }
    for (const uint32_t value : {static_cast<uint32_t>(o.patches.interpolation), o.patches.plan_depth,
                                 static_cast<uint32_t>(o.patches.end_cap), o.patches.isolation_level,
                                 uint32_t{o.split_creases}, o.max_rate, static_cast<uint32_t>(o.channel_values.size())})
        hash.add(value);
    for (const std::span<const float> values : o.channel_values) hash.add(values);
    for (const auto* list : {&o.grid_rates, &o.refined_levels, &o.stencil_levels, &o.limit_levels})
        hash.add(std::span<const uint32_t>(*list));
    return hash.finish();
}

Result<BakedMesh> bake_mesh(const ControlMeshDescription& description, const BakeOptions& options) {
    const auto mesh = ControlMesh::create(description);
    if (!mesh) return mesh.error();
    if (options.channel_values.size() > mesh->channels.size())
        return Error{ErrorCode::invalid_argument, "there are values of a channel that the mesh does not have"};
    const PlanCache cache;
    BakedMesh out;
    out.key = content_hash(description, options);
    out.face_count = mesh->face_count();
    out.edges = build_topology(*mesh).edge_vertices;
    out.positions = to_array(description.positions);
    auto patches = build_patch_table<float>(*mesh, options.patches, &cache);
    if (!patches) return patches.error();
    out.patches = std::move(*patches);
    auto trees = bake_trees(out.patches, options);
    if (!trees) return trees.error();
    out.trees = std::move(*trees);
    std::vector<uint32_t> seams;
    for (uint32_t c = 0; c < options.channel_values.size(); ++c) {
        auto channel = bake_channel(*mesh, c, options.channel_values[c], options, cache);
        if (!channel) return channel.error();
        out.channels.push_back(std::move(*channel));
        seams.push_back(c);
    }
    auto topology = build_tessellation_table(*mesh, {options.split_creases, seams});
    if (!topology) return topology.error();
    out.tessellation = std::move(*topology);
    if (auto done = bake_extras(*mesh, options, out); !done) return done.error();
    return out;
}

}  // namespace limn
