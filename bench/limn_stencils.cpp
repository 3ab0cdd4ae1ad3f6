#include "limn_stencils.h"

#include <memory>
#include <utility>

#include "timestamps.h"

namespace limn::bench {
namespace {

/// Members are destroyed in reverse: commands before what they refer to.
struct Frame {
    explicit Frame(const vk::Device& of) : device(of), timestamps(of) {}
    const vk::Device& device;
    std::vector<vk::DeviceStencilTable> tables;
    std::vector<vk::Buffer> points;  ///< control points, then those of each table
    std::vector<vk::StencilEvaluation> evaluations;
    vk::DeviceRefinedGrid grid;  ///< in place of tables
    std::optional<vk::SurfaceEvaluation> refined;
    Timestamps timestamps;
    std::optional<vk::Commands> commands;
};

void end(Frame& frame, vk::Commands commands) {
    vk::record_barrier(frame.device, commands, vk::kKernelWrites, vk::kCopyReads);
    frame.timestamps.record_end(commands);
    frame.commands.emplace(std::move(commands));
}

/// How the candidate runs the frame, and reads `count` points of its last buffer.
void finish(const std::shared_ptr<Frame>& frame, uint32_t width, size_t count, Candidate& candidate) {
    candidate.is_limn = true;
    candidate.frame = [frame] { return frame->commands->submit_and_wait().has_value(); };
    if (frame->timestamps.available())
        candidate.device_milliseconds = [frame] { return frame->timestamps.milliseconds(); };
    candidate.points = [frame, width, count] {
        const auto values = vk::download<float>(frame->device, frame->points.back(), width * count);
        return values ? unpad_points(values->data(), count, width) : std::vector<float>{};
    };
}

}  // namespace

std::string device_description(const vk::Device& device) {
    VkPhysicalDeviceDriverProperties driver = {};
    driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
    VkPhysicalDeviceProperties2 properties = {};
    properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
    properties.pNext = &driver;
    const auto query = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(
        device.functions.GetInstanceProcAddr(device.instance, "vkGetPhysicalDeviceProperties2"));
    if (query != nullptr) query(device.physical_device, &properties);
    const uint32_t version = device.properties.apiVersion;
    return std::string(device.name()) + ", " + driver.driverName + " " + driver.driverInfo + ", Vulkan " +
           std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
           std::to_string(VK_API_VERSION_MINOR(version));
}

Result<double> measure_device_copy(const Options& options, const vk::Device& device) {
    for (VkDeviceSize bytes = VkDeviceSize{256} << 20; bytes >= VkDeviceSize{16} << 20; bytes /= 2) {
        auto from = vk::create_buffer(device, bytes, vk::kPointUsage, vk::MemoryUse::device);
        auto to = vk::create_buffer(device, bytes, vk::kPointUsage, vk::MemoryUse::device);
        if (!from || !to) continue;
        auto fill = vk::Commands::begin(device), commands = vk::Commands::begin(device);
        if (!fill || !commands) return (fill ? commands : fill).error();
        device.functions.CmdFillBuffer(*fill, from->handle, 0, bytes,
                                       1);  // memory never written may not be there at all
        if (auto filled = fill->submit_and_wait(); !filled) return filled.error();
        const VkBufferCopy region = {0, 0, bytes};
        device.functions.CmdCopyBuffer(*commands, from->handle, to->handle, 1, &region);
        const Timing timing = measure(options, [&] { return commands->submit_and_wait().has_value(); });
        if (timing.count != 0) return 2 * static_cast<double>(bytes) / timing.median * 1000;
    }
    return Error{ErrorCode::out_of_memory, "no device memory to measure a copy in"};
}

Result<Candidate> make_limn_candidate(const vk::Device& device, const vk::Evaluator& evaluator,
                                      std::span<const StencilTable> tables,
                                      const std::vector<float>& positions, uint32_t width) {
    const auto frame = std::make_shared<Frame>(device);
    Candidate candidate;
    auto source = vk::create_point_buffer(device, pad_points(positions, width));
    if (!source) return source.error();
    frame->points.push_back(std::move(*source));
    // Points between tables are padded, as limn/vulkan/scheme_evaluator.h does.
    const auto is_padded = [&](size_t i) { return width == 3 && i != 0 && i != tables.size(); };
    const auto points_of = [&](size_t i) {
        return vk::PointBuffer{.buffer = frame->points[i].handle, .stride = is_padded(i) ? 4 : width};
    };
    for (const StencilTable& table : tables) {
        auto uploaded = vk::upload_stencil_table(device, table);
        if (!uploaded) return uploaded.error();
        const uint64_t point_bytes = uint64_t{4} * (is_padded(frame->points.size()) ? 4 : width) * table.row_count();
        auto points = vk::create_buffer(device, point_bytes, vk::kPointUsage, vk::MemoryUse::device);
        if (!points) return points.error();
        candidate.row_count += table.row_count();
        candidate.entry_count += table.weights.size();
        candidate.bytes += uploaded->bytes() + point_bytes + uint64_t{4} * width * table.source_count;
        frame->tables.push_back(std::move(*uploaded));
        frame->points.push_back(std::move(*points));
    }
    candidate.flops = 2.0 * width * static_cast<double>(candidate.entry_count);
    auto commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    frame->timestamps.record_begin(*commands);
    uint32_t dispatch_count = 0;
    for (size_t i = 0; i < tables.size(); ++i) {
        auto evaluation =
            evaluator.prepare({.table = &frame->tables[i],
                               .width = width,
                               .source = points_of(i),
                               .destination = points_of(i + 1),
                               .padded_source = is_padded(i)});
        if (!evaluation) return evaluation.error();
        if (i != 0) vk::record_barrier(device, *commands, vk::kKernelWrites, vk::kKernelReads);
        evaluation->record(*commands);
        dispatch_count += evaluation->dispatch_count();
        frame->evaluations.push_back(std::move(*evaluation));
    }
    end(*frame, std::move(*commands));

    candidate.name =
        std::string("limn") + (tables.size() == 1 ? "_composed" : "_chain") + (width == 4 ? "_xyzw" : "");
    candidate.dispatch_count = dispatch_count;
    finish(frame, width, tables.back().row_count(), candidate);
    return candidate;
}

Result<Candidate> make_limn_refined_grid_candidate(const vk::Device& device, const vk::SurfaceEvaluator& evaluator,
                                                   const RefinedGridTable& table, const std::vector<float>& positions,
                                                   uint32_t width) {
    const auto frame = std::make_shared<Frame>(device);
    auto uploaded = vk::upload_refined_grid_table(device, table);
    auto source = vk::create_point_buffer(device, pad_points(positions, width));
    auto points = vk::create_buffer(device, uint64_t{4} * width * table.point_count(), vk::kPointUsage, vk::MemoryUse::device);
    if (!uploaded) return uploaded.error();
    if (!source || !points) return (source ? points : source).error();
    frame->grid = std::move(*uploaded);
    frame->points.push_back(std::move(*source));
    frame->points.push_back(std::move(*points));
    auto refined = evaluator.prepare_refined({.table = &frame->grid,
                                              .width = width,
                                              .source = {.buffer = frame->points[0].handle, .stride = width},
                                              .refined = {.buffer = frame->points[1].handle, .stride = width}});
    if (!refined) return refined.error();
    frame->refined.emplace(std::move(*refined));
    auto commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    frame->timestamps.record_begin(*commands);
    frame->refined->record(*commands);
    end(*frame, std::move(*commands));

    Candidate candidate;
    candidate.name = std::string("limn_refined_grid") + (width == 4 ? "_xyzw" : "");
    candidate.row_count = table.point_count();
    candidate.bytes = frame->grid.bytes() + uint64_t{4} * width * (uint64_t{table.source_count} + table.point_count());
    candidate.dispatch_count = frame->refined->dispatch_count();
    finish(frame, width, table.point_count(), candidate);
    return candidate;
}

}  // namespace limn::bench
