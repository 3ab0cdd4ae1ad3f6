#include "cli/surface_runner.h"

#include <algorithm>

namespace limn::cli {
namespace {

constexpr size_t kSamplesPerPass = size_t{1} << 18;

static_assert(sizeof(SurfaceSample) == 12, "three words, as vk::SampleBuffer has them");

/// The curvatures of records of second derivatives, in the order of Curvature's members.
void append_curvatures(std::span<const double> numbers, size_t count, std::vector<float>& out) {
    std::vector<Curvature> curvatures(count);
    evaluate_curvature(numbers, 3, curvatures);
    for (const Curvature& c : curvatures) {
        for (const double x : {c.gaussian, c.mean, c.first, c.second}) out.push_back(static_cast<float>(x));
        for (const auto* direction : {&c.first_direction, &c.second_direction})
            for (const double x : *direction) out.push_back(static_cast<float>(x));
    }
}

/// Adds the values of samples to `out`.
void run_on_host(const RunSurface& surface, std::span<const SurfaceSample> samples, Derivatives derivatives,
                 bool curvature, SurfaceValues& out) {
    std::vector<PatchSample> places;
    places.reserve(samples.size());
    for (const SurfaceSample& s : samples)
        places.push_back({s.face, static_cast<double>(s.u), static_cast<double>(s.v)});
    std::vector<double> numbers(samples.size() * value_count(derivatives) * surface.width);
    std::vector<SampleStatus> statuses(samples.size());
    evaluate_patches<float>(*surface.table, places, surface.host_points, surface.width, derivatives, numbers,
                            statuses);
    for (const double x : numbers) out.numbers.push_back(static_cast<float>(x));
    out.statuses.insert(out.statuses.end(), statuses.begin(), statuses.end());
    if (curvature) append_curvatures(numbers, samples.size(), out.curvatures);
}

Result<vk::Buffer> create_words(const vk::Device& device, size_t count) {
    return vk::create_buffer(device, count * sizeof(uint32_t), vk::kPointUsage, vk::MemoryUse::device);
}

template <class Evaluation>
Result<void> submit(const vk::Device& device, const Evaluation& evaluation) {
    Result<vk::Commands> commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    evaluation.record(*commands);
    return commands->submit_and_wait();
}

/// Of the records that a device has in `values`, appended to `out`.
Result<void> append_curvatures(const vk::Device& device, const vk::CurvatureEvaluator& evaluator,
                               const vk::Buffer& values, size_t count, std::vector<float>& out) {
    constexpr uint32_t kFloats = shared::kCurvatureFloats;
    const Result<vk::Buffer> buffer = create_words(device, kFloats * count);
    if (!buffer) return buffer.error();
    const auto evaluation = evaluator.prepare({.sample_count = static_cast<uint32_t>(count),
                                               .values = {.buffer = values.handle, .stride = 18},
                                               .curvatures = {.buffer = buffer->handle, .stride = kFloats}});
    if (!evaluation) return evaluation.error();
    if (auto done = submit(device, *evaluation); !done) return done;
    const auto numbers = vk::download<float>(device, *buffer, kFloats * count);
    if (!numbers) return numbers.error();
    out.insert(out.end(), numbers->begin(), numbers->end());
    return {};
}

}  // namespace

Result<SurfaceRunner> SurfaceRunner::create(const RunDevice& device) {
    SurfaceRunner runner;
    runner.device_ = &device;
    if (device.is_host()) return runner;
    Result<vk::SurfaceEvaluator> evaluator = vk::SurfaceEvaluator::create(*device.vulkan());
    if (!evaluator) return evaluator.error();
    runner.evaluator_.emplace(std::move(*evaluator));
    Result<vk::CurvatureEvaluator> curvature = vk::CurvatureEvaluator::create(*device.vulkan());
    if (!curvature) return curvature.error();
    runner.curvature_.emplace(std::move(*curvature));
    return runner;
}

Result<RunSurface> SurfaceRunner::prepare(const PatchTable& table, std::span<const float> control_points,
                                          uint32_t width) const {
    RunSurface surface;
    surface.table = &table;
    surface.width = width;
    const size_t count = size_t{table.point_count()} * width;
    if (device_->is_host()) {
        surface.host_points.resize(count);
        build_patch_points<float>(table, std::vector<double>(control_points.begin(), control_points.end()),
                                  width, surface.host_points);
        return surface;
    }
    const vk::Device& device = *device_->vulkan();
    Result<vk::DevicePatchTable> patches = vk::upload_patch_table(device, table);
    if (!patches) return patches.error();
    surface.patches = std::move(*patches);
    Result<vk::Buffer> points = create_words(device, count);
    if (!points) return points.error();
    surface.points = std::move(*points);
    if (auto done = vk::upload_bytes(device, surface.points, 0, std::as_bytes(control_points)); !done)
        return done.error();
    const Result<vk::StencilEvaluation> refined =
        evaluator_->prepare_points({.patches = &surface.patches,
                                    .width = width,
                                    .points = {.buffer = surface.points.handle, .stride = width}});
    if (!refined) return refined.error();
    if (auto done = submit(device, *refined); !done) return done.error();
    return surface;
}

Result<void> SurfaceRunner::run_pass(const RunSurface& surface, std::span<const SurfaceSample> samples,
                                     Derivatives derivatives, bool curvature, SurfaceValues& out) const {
    const vk::Device& device = *device_->vulkan();
    const uint32_t record = value_count(derivatives) * surface.width;
    Result<vk::Buffer> places = create_words(device, 3 * samples.size());
    if (!places) return places.error();
    if (auto done = vk::upload_bytes(device, *places, 0, std::as_bytes(samples)); !done) return done;
    const Result<vk::Buffer> results = create_words(device, samples.size() * record);
    if (!results) return results.error();
    const Result<vk::Buffer> statuses = create_words(device, samples.size());
    if (!statuses) return statuses.error();
    const Result<vk::SurfaceEvaluation> evaluation =
        evaluator_->prepare_samples({.patches = &surface.patches,
                                     .derivatives = derivatives,
                                     .width = surface.width,
                                     .points = {.buffer = surface.points.handle, .stride = surface.width},
                                     .samples = {places->handle, 0, static_cast<uint32_t>(samples.size())},
                                     .results = {.buffer = results->handle, .stride = record},
                                     .statuses = {.buffer = statuses->handle, .stride = 1}});
    if (!evaluation) return evaluation.error();
    if (auto done = submit(device, *evaluation); !done) return done;
    const auto numbers = vk::download<float>(device, *results, samples.size() * record);
    if (!numbers) return numbers.error();
    const auto words = vk::download<uint32_t>(device, *statuses, samples.size());
    if (!words) return words.error();
    out.numbers.insert(out.numbers.end(), numbers->begin(), numbers->end());
    for (const uint32_t word : *words) out.statuses.push_back(static_cast<SampleStatus>(word));
    if (!curvature) return {};
    return append_curvatures(device, *curvature_, *results, samples.size(), out.curvatures);
}

Result<SurfaceValues> SurfaceRunner::run(const RunSurface& surface, std::span<const SurfaceSample> samples,
                                         Derivatives derivatives, bool curvature) const {
    assert(!curvature || (derivatives == Derivatives::second && surface.width == 3));
    SurfaceValues values;
    values.numbers.reserve(samples.size() * value_count(derivatives) * surface.width);
    values.statuses.reserve(samples.size());
    for (; !samples.empty(); samples = samples.subspan(std::min(samples.size(), kSamplesPerPass))) {
        const auto pass = samples.first(std::min(samples.size(), kSamplesPerPass));
        if (device_->is_host()) {
            run_on_host(surface, pass, derivatives, curvature, values);
        } else if (auto done = run_pass(surface, pass, derivatives, curvature, values); !done) {
            return done.error();
        }
    }
    return values;
}

}  // namespace limn::cli
