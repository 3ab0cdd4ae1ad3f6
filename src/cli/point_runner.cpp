#include "cli/point_runner.h"

#include "limn/schemes/scheme_surface.h"

namespace limn::cli {
namespace {

std::vector<float> apply_on_host(const StencilTable& table, std::span<const float> source, uint32_t width) {
    std::vector<float> out(size_t{table.row_count()} * width);
    apply_stencil_table<float>(table, source, out, width);
    return out;
}

Result<vk::Buffer> create_points(const vk::Device& device, uint64_t points, uint32_t width) {
    return vk::create_buffer(device, points * width * sizeof(float), vk::kPointUsage, vk::MemoryUse::device);
}

}  // namespace

Result<PointRunner> PointRunner::create(const RunDevice& device) {
    PointRunner runner;
    runner.device_ = &device;
    if (device.is_host()) return runner;
    Result<vk::Evaluator> evaluator = vk::Evaluator::create(*device.vulkan());
    if (!evaluator) return evaluator.error();
    runner.evaluator_.emplace(std::move(*evaluator));
    return runner;
}

Result<std::vector<float>> PointRunner::run(std::span<const StencilTable> tables,
                                            std::span<const float> source, uint32_t width) const {
    if (device_->is_host()) {
        std::vector<float> points(source.begin(), source.end());
        for (const StencilTable& table : tables) points = apply_on_host(table, points, width);
        return points;
    }
    if (tables.empty()) return std::vector<float>(source.begin(), source.end());
    const vk::Device& device = *device_->vulkan();
    std::vector<vk::DeviceStencilTable> device_tables;
    std::vector<vk::Buffer> points;
    std::vector<vk::StencilEvaluation> evaluations;
    device_tables.reserve(tables.size());  // evaluations refer to their tables
    Result<vk::Buffer> control = vk::create_point_buffer(device, source);
    if (!control) return control.error();
    points.push_back(std::move(*control));
    for (const StencilTable& table : tables) {
        Result<vk::DeviceStencilTable> uploaded = vk::upload_stencil_table(device, table);
        if (!uploaded) return uploaded.error();
        device_tables.push_back(std::move(*uploaded));
        Result<vk::Buffer> out = create_points(device, table.row_count(), width);
        if (!out) return out.error();
        Result<vk::StencilEvaluation> evaluation =
            evaluator_->prepare({.table = &device_tables.back(),
                                 .width = width,
                                 .source = {.buffer = points.back().handle, .stride = width},
                                 .destination = {.buffer = out->handle, .stride = width}});
        if (!evaluation) return evaluation.error();
        evaluations.push_back(std::move(*evaluation));
        points.push_back(std::move(*out));
    }
    Result<vk::Commands> commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    for (const vk::StencilEvaluation& evaluation : evaluations) {
        evaluation.record(*commands);
        vk::record_barrier(device, *commands, vk::kKernelWrites, vk::kKernelReads);
    }
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    return vk::download<float>(device, points.back(), size_t{tables.back().row_count()} * width);
}

Result<LimitPoints> PointRunner::run_limits(const StencilTable& table, std::span<const float> source) const {
    LimitPoints limits;
    if (device_->is_host()) {
        limits.positions = apply_on_host(table, source, 3);
        limits.tangents1 = apply_on_host(with_weights(table, table.tangent1_weights), source, 3);
        limits.tangents2 = apply_on_host(with_weights(table, table.tangent2_weights), source, 3);
        return limits;
    }
    const vk::Device& device = *device_->vulkan();
    Result<vk::Buffer> control = vk::create_point_buffer(device, source);
    if (!control) return control.error();
    Result<vk::DeviceStencilTable> uploaded = vk::upload_stencil_table(device, table);
    if (!uploaded) return uploaded.error();
    std::vector<vk::Buffer> out;
    for (int i = 0; i < 3; ++i) {
        Result<vk::Buffer> points = create_points(device, table.row_count(), 3);
        if (!points) return points.error();
        out.push_back(std::move(*points));
    }
    Result<vk::StencilEvaluation> evaluation = evaluator_->prepare({.table = &*uploaded,
                                                                    .width = 3,
                                                                    .source = {.buffer = control->handle},
                                                                    .destination = {.buffer = out[0].handle},
                                                                    .tangent1 = {.buffer = out[1].handle},
                                                                    .tangent2 = {.buffer = out[2].handle}});
    if (!evaluation) return evaluation.error();
    Result<vk::Commands> commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    evaluation->record(*commands);
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    std::vector<float>* results[] = {&limits.positions, &limits.tangents1, &limits.tangents2};
    for (size_t i = 0; i < 3; ++i) {
        Result<std::vector<float>> values =
            vk::download<float>(device, out[i], size_t{table.row_count()} * 3);
        if (!values) return values.error();
        *results[i] = std::move(*values);
    }
    return limits;
}

}  // namespace limn::cli
