#include "cli/tessellation_runner.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace limn::cli {
namespace {

using Counts = TessellationCounts;

constexpr uint64_t kMaxVertices = 0x7fffffff;  // of mesh writers
// Of results, for a vertex and a triangle. The host takes more on the way: places, and values in double.
constexpr uint64_t kVertexBytes = 6 * sizeof(float), kTextureBytes = 2 * sizeof(float),
                   kTriangleBytes = 3 * sizeof(uint32_t), kHostVertexBytes = 150, kHostTriangleBytes = 4;

Error too_many_triangles(uint32_t max_triangles) {
    return {ErrorCode::invalid_argument,
            "not even the least rates give " + plural(max_triangles, "triangle") + " or fewer"};
}

Error surface_not_finite() {
    return {ErrorCode::not_finite, "the surface is too large: its points are no finite numbers"};
}

/// What indices and files can tell apart, and what memory there is, on `device` (or null) and here.
Result<void> check_size(const Counts& counts, bool texture, const vk::Device* device) {
    const std::string what = plural(counts.triangles, "triangle");
    const char* remedy = "; lower rates or --max-triangles give fewer";
    if (3 * counts.triangles > kInvalidIndex)
        return Error{ErrorCode::too_large, "more than 2^32 indices" + std::string(remedy)};
    if (counts.vertices > kMaxVertices)
        return Error{ErrorCode::too_large, "more than 2^31 - 1 vertices" + std::string(remedy)};
    const uint64_t bytes =
        counts.vertices * (kVertexBytes + (texture ? kTextureBytes : 0)) + counts.triangles * kTriangleBytes;
    const auto refuse = [&](uint64_t needed, uint64_t there, const std::string& where) {
        return Error{ErrorCode::too_large, what + " take " + human_bytes(needed) + ", and " + where +
                                               " has " + human_bytes(there) + remedy};
    };
    if (device != nullptr) {
        uint64_t heap = 0;
        for (uint32_t i = 0; i < device->memory_properties.memoryHeapCount; ++i)
            heap = std::max<uint64_t>(heap, device->memory_properties.memoryHeaps[i].size);
        if (bytes > heap) return refuse(bytes, heap, device->name());
    }
    const uint64_t memory =
        static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    const uint64_t on_the_way =
        device != nullptr ? (device->has_host_memory() ? bytes : 0)
                          : counts.vertices * kHostVertexBytes + counts.triangles * kHostTriangleBytes;
    if (bytes + on_the_way > memory) return refuse(bytes + on_the_way, memory, "this machine");
    return {};
}

struct HostRates {
    std::vector<uint32_t> rates;
    double scale = 1;
    Counts counts = {};
};

/// At one scale. Errors: as compute_rates, not_finite.
Result<HostRates> rates_at(const BakedMesh& model, const RateSettings& settings,
                           std::span<const double> points, double scale) {
    Result<std::vector<uint32_t>> rates =
        compute_rates(model.patches, model.tessellation, settings, points, {}, scale);
    if (!rates) return rates.error();
    for (uint32_t e = 0; e < model.tessellation.rate_edge_count; ++e)
        if ((*rates)[e] == 0 &&
            model.tessellation.rate_edges[size_t{e} * shared::kRateEdgeWords] != shared::kNoRateEdge)
            return surface_not_finite();
    const Counts counts = count_tessellation(model.tessellation, *rates, settings.spacing);
    return HostRates{std::move(*rates), scale, counts};
}

/// At the largest scale that fits, to a fraction of a percent.
Result<HostRates> fitting_rates(const BakedMesh& model, const TessellationRequest& request,
                                std::span<const double> points) {
    const auto at = [&](double scale) { return rates_at(model, request.settings, points, scale); };
    Result<HostRates> best = at(1);
    if (!best || !request.max_triangles || best->counts.triangles <= *request.max_triangles) return best;
    constexpr int kSteps = 16;
    double low = 1e-30, high = 1;  // a small error may ask for any rate
    best = at(low);
    if (!best) return best;
    if (best->counts.triangles > *request.max_triangles) return too_many_triangles(*request.max_triangles);
    for (int i = 0; i < kSteps; ++i) {
        const double middle = std::sqrt(low * high);
        Result<HostRates> trial = at(middle);
        if (!trial) return trial;
        const bool fits = trial->counts.triangles <= *request.max_triangles;
        (fits ? low : high) = middle;
        if (fits) best = std::move(trial);
    }
    return best;
}

std::vector<float> to_floats(std::span<const double> values) {
    std::vector<float> out(values.size());
    std::transform(values.begin(), values.end(), out.begin(), [](double x) { return static_cast<float>(x); });
    return out;
}

bool all_finite(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
}

/// Takes out corners beside which nothing is drawn.
void drop_unused_vertices(TriangleMesh& mesh) {
    std::vector<uint32_t> numbers(mesh.vertex_count(), kInvalidIndex);
    for (const uint32_t v : mesh.indices) numbers[v] = 0;
    uint32_t count = 0;
    const auto keep = [&](std::vector<float>& values, size_t width, size_t from) {
        if (!values.empty())
            std::copy_n(values.begin() + static_cast<ptrdiff_t>(from * width), width,
                        values.begin() + static_cast<ptrdiff_t>(count * width));
    };
    for (size_t v = 0; v < numbers.size(); ++v) {
        if (numbers[v] == kInvalidIndex) continue;
        keep(mesh.positions, 3, v);
        keep(mesh.normals, 3, v);
        keep(mesh.texture_coordinates, 2, v);
        numbers[v] = count++;
    }
    for (uint32_t& v : mesh.indices) v = numbers[v];
    mesh.positions.resize(size_t{count} * 3);
    mesh.normals.resize(size_t{count} * 3);
    if (!mesh.texture_coordinates.empty()) mesh.texture_coordinates.resize(size_t{count} * 2);
}

/// What one tessellation on the device needs.
struct DeviceModel {
    RunSurface surface;
    std::optional<RunSurface> texture;
    vk::DeviceTessellationTable table;
};

struct DeviceBuffers {
    vk::Buffer positions, normals, texture, indices, command, result;
};

std::span<const float> values_of(const Array<float>& values) {
    return {values.data(), values.size()};
}

Result<DeviceModel> upload_model(const SurfaceRunner& surfaces, const vk::Device& device, const BakedMesh& model) {
    DeviceModel out;
    std::vector<const PatchTreeTable*> channels;
    if (const BakedChannel* channel = texture_of(model)) {
        channels.push_back(&channel->trees);
        Result<RunSurface> texture = surfaces.prepare(channel->patches, values_of(channel->values), 2);
        if (!texture) return texture.error();
        out.texture.emplace(std::move(*texture));
    }
    Result<RunSurface> surface = surfaces.prepare(model.patches, values_of(model.positions), 3);
    if (!surface) return surface.error();
    out.surface = std::move(*surface);
    Result<vk::DeviceTessellationTable> table =
        vk::upload_tessellation_table(device, model.tessellation, model.trees, channels);
    if (!table) return table.error();
    out.table = std::move(*table);
    return out;
}

Result<DeviceBuffers> create_buffers(const vk::Device& device, uint64_t vertices, uint64_t triangles,
                                     bool texture) {
    DeviceBuffers out;
    const std::pair<vk::Buffer*, uint64_t> buffers[] = {{&out.positions, 3 * vertices},
                                                        {&out.normals, 3 * vertices},
                                                        {&out.texture, texture ? 2 * vertices : 0},
                                                        {&out.indices, 3 * triangles},
                                                        {&out.command, 5},
                                                        {&out.result, 4}};
    for (const auto& [buffer, words] : buffers) {
        Result<vk::Buffer> created =
            vk::create_buffer(device, words * sizeof(uint32_t), vk::kPointUsage, vk::MemoryUse::device);
        if (!created) return created.error();
        *buffer = std::move(*created);
    }
    return out;
}

/// A tessellation of the request's settings, before capacities and what vertices have.
vk::TessellationInfo tessellation_info(const DeviceModel& model, const RateSettings& settings,
                                       const DeviceBuffers& buffers) {
    return {.patches = &model.surface.patches,
            .table = &model.table,
            .points = {.buffer = model.surface.points.handle},
            .mode = settings.mode,
            .spacing = settings.spacing,
            .cull_outside = settings.cull_outside,
            .cull_backfaces = settings.cull_backfaces,
            .fit_capacity = false,
            .positions = {.buffer = buffers.positions.handle},
            .indices = {buffers.indices.handle},
            .command = {buffers.command.handle},
            .result = {buffers.result.handle}};
}

Result<void> execute(const vk::Device& device, const vk::Tessellation& tessellation,
                     const RateSettings& settings) {
    Result<vk::Commands> commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    if (auto recorded = tessellation.record(*commands, settings); !recorded) return recorded;
    return commands->submit_and_wait();
}

Result<vk::TessellationResult> read_result(const vk::Device& device, const DeviceBuffers& buffers) {
    const auto result = vk::download<vk::TessellationResult>(device, buffers.result, 1);
    if (!result) return result.error();
    if ((*result)[0].status == vk::TessellationStatus::not_finite) return surface_not_finite();
    return (*result)[0];
}

/// The totals that the state of an executed tessellation holds, whatever its capacity: 2^32 - 1 where there are as many
/// or more.
Result<Counts> read_totals(const vk::Device& device, const vk::Tessellation& tessellation) {
    Result<vk::Buffer> totals =
        vk::create_buffer(device, 2 * sizeof(uint32_t), vk::kPointUsage, vk::MemoryUse::readback);
    if (!totals) return totals.error();
    Result<vk::Commands> commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    static_assert(shared::kTessNeededTriangles == shared::kTessNeededVertices + 1);
    const VkBufferCopy region = {shared::kTessNeededVertices * sizeof(uint32_t), 0, 2 * sizeof(uint32_t)};
    device.functions.CmdCopyBuffer(*commands, tessellation.state_buffer(), totals->handle, 1, &region);
    vk::record_barrier(device, *commands, vk::kCopyWrites, vk::kHostReads);
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    const auto* words = static_cast<const uint32_t*>(totals->mapped());
    return Counts{words[0], words[1]};
}

/// How much there would be, by a tessellation without room for anything.
Result<Counts> count_on_device(const vk::Device& device, const vk::Tessellator& tessellator,
                               const DeviceModel& model, const RateSettings& settings) {
    const Result<DeviceBuffers> buffers = create_buffers(device, 0, 0, false);
    if (!buffers) return buffers.error();
    const Result<vk::Tessellation> tessellation =
        tessellator.prepare(tessellation_info(model, settings, *buffers));
    if (!tessellation) return tessellation.error();
    if (auto done = execute(device, *tessellation, settings); !done) return done.error();
    if (auto result = read_result(device, *buffers); !result) return result.error();
    return read_totals(device, *tessellation);
}

Result<TriangleMesh> download_mesh(const vk::Device& device, const DeviceBuffers& buffers,
                                   const vk::TessellationResult& result, bool texture) {
    TriangleMesh mesh;
    const auto read = [&](const vk::Buffer& buffer, auto& values, size_t count) -> Result<void> {
        values.resize(count);
        return vk::download_bytes(device, buffer, 0, std::as_writable_bytes(std::span(values)));
    };
    const size_t vertices = result.vertex_count;
    if (auto done = read(buffers.positions, mesh.positions, 3 * vertices); !done) return done.error();
    if (auto done = read(buffers.normals, mesh.normals, 3 * vertices); !done) return done.error();
    if (texture) {
        if (auto done = read(buffers.texture, mesh.texture_coordinates, 2 * vertices); !done)
            return done.error();
    }
    if (auto done = read(buffers.indices, mesh.indices, 3 * size_t{result.triangle_count}); !done)
        return done.error();
    mesh.rate_scale = static_cast<double>(result.rate_scale);
    return mesh;
}

/// With room for `capacity`, which rates are scaled down to fit if `fit`.
Result<TriangleMesh> tessellate_within(const vk::Device& device, const vk::Tessellator& tessellator,
                                       const DeviceModel& model, const RateSettings& settings,
                                       const Counts& capacity, bool fit) {
    const bool texture = model.texture.has_value();
    const Result<DeviceBuffers> buffers =
        create_buffers(device, capacity.vertices, capacity.triangles, texture);
    if (!buffers) return buffers.error();
    vk::TessellationInfo info = tessellation_info(model, settings, *buffers);
    info.vertex_capacity = static_cast<uint32_t>(capacity.vertices);
    info.triangle_capacity = static_cast<uint32_t>(capacity.triangles);
    info.fit_capacity = fit;
    info.normals = {.buffer = buffers->normals.handle};
    vk::TessellatedChannel channel;
    if (texture) {
        channel.patches = &model.texture->patches;
        channel.points = {.buffer = model.texture->points.handle, .stride = 2};
        channel.values = {.buffer = buffers->texture.handle, .stride = 2};
        info.channels = {&channel, 1};
    }
    const Result<vk::Tessellation> tessellation = tessellator.prepare(info);
    if (!tessellation) return tessellation.error();
    if (auto done = execute(device, *tessellation, settings); !done) return done.error();
    const Result<vk::TessellationResult> result = read_result(device, *buffers);
    if (!result) return result.error();
    if (result->status == vk::TessellationStatus::too_small && fit)
        return too_many_triangles(info.triangle_capacity);
    if (result->status > vk::TessellationStatus::scaled)
        return Error{ErrorCode::vulkan_failure, "the device counted its triangles differently twice"};
    return download_mesh(device, *buffers, *result, texture);
}

}  // namespace

Result<TessellationRunner> TessellationRunner::create(const RunDevice& device) {
    TessellationRunner runner;
    runner.device_ = &device;
    Result<SurfaceRunner> surfaces = SurfaceRunner::create(device);
    if (!surfaces) return surfaces.error();
    runner.surfaces_.emplace(std::move(*surfaces));
    if (device.is_host()) return runner;
    Result<vk::Tessellator> tessellator = vk::Tessellator::create(*device.vulkan());
    if (!tessellator) return tessellator.error();
    runner.tessellator_.emplace(std::move(*tessellator));
    return runner;
}

Result<TriangleMesh> TessellationRunner::run_on_host(const BakedMesh& model,
                                                     const TessellationRequest& request) const {
    if (request.settings.cull_outside || request.settings.cull_backfaces)
        return Error{ErrorCode::unsupported, "the host does not cull"};
    const Result<RunSurface> surface = surfaces_->prepare(model.patches, values_of(model.positions), 3);
    if (!surface) return surface.error();
    const Result<HostRates> rates = fitting_rates(model, request, surface->host_points);
    if (!rates) return rates.error();
    if (auto checked = check_size(rates->counts, texture_of(model) != nullptr, nullptr); !checked)
        return checked.error();
    Result<Tessellation> tessellation = tessellate(model.tessellation, rates->rates, request.settings.spacing);
    if (!tessellation) return tessellation.error();

    const size_t count = tessellation->vertex_count();
    std::vector<double> positions(3 * count), normals(3 * count);
    evaluate_tessellation(model.patches, *tessellation, surface->host_points, positions, normals);
    TriangleMesh mesh;
    mesh.rate_scale = rates->scale;
    mesh.positions = to_floats(positions);
    mesh.normals = to_floats(normals);
    if (const BakedChannel* channel = texture_of(model)) {
        const Result<RunSurface> texture = surfaces_->prepare(channel->patches, values_of(channel->values), 2);
        if (!texture) return texture.error();
        std::vector<double> values(2 * count);
        evaluate_tessellation_channel(channel->patches, *tessellation, texture->host_points, 2, values);
        mesh.texture_coordinates = to_floats(values);
    }
    mesh.indices = std::move(tessellation->indices);
    return mesh;
}

Result<TriangleMesh> TessellationRunner::run_on_device(const BakedMesh& model,
                                                       const TessellationRequest& request) const {
    const vk::Device& device = *device_->vulkan();
    const RateSettings& settings = request.settings;
    const Result<DeviceModel> uploaded = upload_model(*surfaces_, device, model);
    if (!uploaded) return uploaded.error();
    Result<Counts> capacity = count_on_device(device, *tessellator_, *uploaded, settings);
    if (!capacity) return capacity.error();
    const bool scaled = request.max_triangles && capacity->triangles > *request.max_triangles;
    // By Euler's formula a face of n triangles has at most n vertices that are no corners of its own.
    if (scaled)
        *capacity = {uint64_t{model.tessellation.corner_count} + *request.max_triangles, *request.max_triangles};
    if (auto checked = check_size(*capacity, texture_of(model) != nullptr, &device); !checked)
        return checked.error();
    return tessellate_within(device, *tessellator_, *uploaded, settings, *capacity, scaled);
}

Result<TriangleMesh> TessellationRunner::run(const BakedMesh& model,
                                             const TessellationRequest& request) const {
    Result<TriangleMesh> mesh =
        device_->is_host() ? run_on_host(model, request) : run_on_device(model, request);
    if (!mesh) return mesh;
    for (const auto* values : {&mesh->positions, &mesh->normals, &mesh->texture_coordinates})
        if (!all_finite(*values)) return surface_not_finite();
    drop_unused_vertices(*mesh);
    return mesh;
}

}  // namespace limn::cli
