#include "limn_patches.h"

#include <bit>
#include <memory>

#include "candidate.h"
#include "limn/packed_normal.h"
#include "patch_samples.h"
#include "timestamps.h"

namespace limn::bench {
namespace {

/// Members are destroyed in reverse: commands before what they refer to.
struct Frame {
    explicit Frame(const vk::Device& of) : device(of), timestamps(of) {}
    const vk::Device& device;
    vk::DevicePatchTable patches;
    vk::DeviceGridTable grid;  ///< of grids only
    vk::DevicePatchTrees trees;
    vk::Buffer local;  ///< local points of trees, if there are any
    vk::Buffer points;         ///< control points, then those of level 1
    vk::Buffer samples;        ///< of lists only
    vk::Buffer values;
    vk::Buffer normals;  ///< only where they are not among the values
    std::optional<vk::StencilEvaluation> refined;
    std::optional<vk::SurfaceEvaluation> local_points;
    std::optional<vk::SurfaceEvaluation> surface;
    Timestamps timestamps;
    std::optional<vk::Commands> commands;

    vk::PointBuffer bound_points() const { return {.buffer = points.handle, .stride = 3}; }
};

Result<void> create_floats(const vk::Device& device, uint64_t count, vk::Buffer& buffer) {
    auto created = vk::create_buffer(device, 4 * count, vk::kPointUsage, vk::MemoryUse::device);
    if (!created) return created.error();
    buffer = std::move(*created);
    return {};
}

/// The table and the points; the control points lie in theirs.
Result<std::shared_ptr<Frame>> make_frame(const LimnDevice& limn, const PatchTable& table,
                                          const std::vector<float>& positions) {
    auto frame = std::make_shared<Frame>(limn.device);
    auto uploaded = vk::upload_patch_table(limn.device, table);
    if (!uploaded) return uploaded.error();
    frame->patches = std::move(*uploaded);
    if (auto created = create_floats(limn.device, uint64_t{3} * table.point_count(), frame->points); !created)
        return created.error();
    if (auto done = vk::upload_bytes(limn.device, frame->points, 0, std::as_bytes(std::span(positions)));
        !done)
        return done.error();
    auto refined =
        limn.evaluator.prepare_points({.patches = &frame->patches, .points = frame->bound_points()});
    if (!refined) return refined.error();
    frame->refined.emplace(std::move(*refined));
    return frame;
}

/// Records the frame, and says what it is.
Result<PatchCandidate> make_candidate(const LimnDevice& limn, const std::shared_ptr<Frame>& frame,
                                      std::string name, uint64_t sample_count) {
    auto commands = vk::Commands::begin(limn.device);
    if (!commands) return commands.error();
    frame->timestamps.record_begin(*commands);
    frame->refined->record(*commands);
    vk::record_barrier(limn.device, *commands, vk::kKernelWrites, vk::kKernelReads);
    if (frame->local_points) {
        frame->local_points->record(*commands);
        vk::record_barrier(limn.device, *commands, vk::kKernelWrites, vk::kKernelReads);
    }
    frame->surface->record(*commands);
    vk::record_barrier(limn.device, *commands, vk::kKernelWrites, vk::kCopyReads);
    frame->timestamps.record_end(*commands);
    frame->commands.emplace(std::move(*commands));

    PatchCandidate candidate;
    candidate.name = std::move(name);
    candidate.is_limn = true;
    candidate.sample_count = sample_count;
    candidate.dispatch_count = frame->refined->dispatch_count() + frame->surface->dispatch_count();
    // Points are read or written to make those of level 1, and then all read.
    candidate.bytes = frame->patches.bytes() + uint64_t{2} * 12 * frame->patches.point_count;
    candidate.copy_rate = limn.copy_rate;
    candidate.note = megabytes(frame->patches.bytes()) + " patches";
    candidate.frame = [frame] { return frame->commands->submit_and_wait().has_value(); };
    if (frame->timestamps.available())
        candidate.device_milliseconds = [frame] { return frame->timestamps.milliseconds(); };
    return candidate;
}

std::vector<uint32_t> sample_words(std::span<const PatchSample> samples) {
    std::vector<uint32_t> words;
    words.reserve(3 * samples.size());
    for (const PatchSample& s : samples)
        for (const uint32_t word : {s.face, std::bit_cast<uint32_t>(static_cast<float>(s.u)),
                                    std::bit_cast<uint32_t>(static_cast<float>(s.v))})
            words.push_back(word);
    return words;
}

/// Floats of the samples of `faces`, which the buffer has among those of all ptex faces. Empty when it cannot
/// be read.
std::vector<float> download_grid(const Frame& frame, const vk::Buffer& buffer, uint32_t stride,
                                 std::span<const uint32_t> faces) {
    const auto all = vk::download<float>(frame.device, buffer, frame.grid.sample_count() * stride);
    std::vector<float> values;
    if (!all) return values;
    const size_t face_floats = size_t{frame.grid.samples_per_face} * stride;
    values.reserve(faces.size() * face_floats);
    for (const uint32_t face : faces)
        values.insert(values.end(), all->data() + face * face_floats, all->data() + (face + 1) * face_floats);
    return values;
}

Result<void> prepare_local_points(const LimnDevice& limn, const PatchTreeTable& trees, Frame& frame) {
    auto uploaded = vk::upload_patch_trees(limn.device, trees);
    if (!uploaded) return uploaded.error();
    frame.trees = std::move(*uploaded);
    if (auto created = create_floats(limn.device, uint64_t{4} * trees.local_count(), frame.local); !created)
        return created.error();
    auto points = limn.evaluator.prepare_local_points({.patches = &frame.patches,
                                                       .trees = &frame.trees,
                                                       .points = frame.bound_points(),
                                                       .local_points = frame.local.handle});
    if (!points) return points.error();
    frame.local_points.emplace(std::move(*points));
    return {};
}

/// Floats from one sample to the next: a position and, behind it, what else is interleaved.
uint32_t grid_stride(PatchTask task, GridLayout layout) {
    if (task == PatchTask::derivatives) return 9;
    if (task == PatchTask::points || layout == GridLayout::separate) return 3;
    return layout == GridLayout::packed ? 4 : 6;
}

Result<void> prepare_grid(const LimnDevice& limn, Frame& frame, PatchTask task, GridLayout layout) {
    const uint64_t count = frame.grid.sample_count();
    const bool separate = layout == GridLayout::separate;
    const uint32_t stride = grid_stride(task, layout);
    if (auto created = create_floats(limn.device, count * stride, frame.values); !created)
        return created.error();
    if (separate)
        if (auto created = create_floats(limn.device, count * stride, frame.normals); !created)
            return created.error();
    vk::GridEvaluationInfo info{
        .patches = &frame.patches, .grid = &frame.grid, .points = frame.bound_points()};
    const auto interleaved = [&](uint32_t first) {
        return vk::PointBuffer{.buffer = frame.values.handle, .first = first, .stride = stride};
    };
    info.values = interleaved(0);
    info.packed_normals = layout == GridLayout::packed;
    if (task == PatchTask::normals)
        info.normals =
            separate ? vk::PointBuffer{.buffer = frame.normals.handle, .stride = stride} : interleaved(3);
    if (task == PatchTask::derivatives) {
        info.du = interleaved(3);
        info.dv = interleaved(6);
    }
    auto surface = limn.evaluator.prepare_grid(info);
    if (!surface) return surface.error();
    frame.surface.emplace(std::move(*surface));
    return {};
}

/// What the frame wrote, apart; empty where it cannot be read.
PatchValues download_values(const Frame& frame, PatchTask task, GridLayout layout,
                            std::span<const uint32_t> faces) {
    const uint32_t stride = grid_stride(task, layout);
    const std::vector<float> values = download_grid(frame, frame.values, stride, faces);
    if (values.empty()) return {};
    const size_t count = values.size() / stride;
    const auto part = [&](size_t first) { return unpad_points(values.data() + first, count, stride); };
    PatchValues out;
    out.positions = part(0);
    if (layout == GridLayout::packed) {
        for (size_t i = 0; i < count; ++i) {
            const auto n = unpack_normal(std::bit_cast<uint32_t>(values[4 * i + 3]));
            out.normals.insert(out.normals.end(), n.begin(), n.end());
        }
    } else if (task == PatchTask::normals) {
        out.normals =
            layout == GridLayout::separate ? download_grid(frame, frame.normals, stride, faces) : part(3);
    }
    if (task == PatchTask::derivatives) {
        out.du = part(3);
        out.dv = part(6);
    }
    return out;
}

}  // namespace

Result<PatchCandidate> make_limn_patch_eval_candidate(const LimnDevice& limn, const PatchTable& table,
                                                      const PatchTreeTable* trees, std::span<const PatchSample> samples,
                                                      const std::vector<float>& positions) {
    const auto made = make_frame(limn, table, positions);
    if (!made) return made.error();
    const std::shared_ptr<Frame> frame = *made;
    const std::vector<uint32_t> words = sample_words(samples);
    constexpr uint32_t kRecord = 9;  // position, du, dv
    const size_t count = samples.size();
    if (auto created = create_floats(limn.device, words.size(), frame->samples); !created)
        return created.error();
    if (auto created = create_floats(limn.device, kRecord * count, frame->values); !created)
        return created.error();
    if (auto done = vk::upload_bytes(limn.device, frame->samples, 0, std::as_bytes(std::span(words))); !done)
        return done.error();
    if (trees != nullptr)
        if (auto prepared = prepare_local_points(limn, *trees, *frame); !prepared) return prepared.error();
    auto surface = limn.evaluator.prepare_samples(
        {.patches = &frame->patches,
         .derivatives = Derivatives::first,
         .points = frame->bound_points(),
         .samples = {.buffer = frame->samples.handle, .count = static_cast<uint32_t>(count)},
         .results = {.buffer = frame->values.handle, .stride = kRecord},
         .trees = trees != nullptr ? &frame->trees : nullptr,
         .local_points = frame->local.handle});
    if (!surface) return surface.error();
    frame->surface.emplace(std::move(*surface));

    auto candidate = make_candidate(limn, frame, trees == nullptr ? "limn" : "limn_trees", count);
    if (!candidate) return candidate;
    candidate->bytes += frame->samples.size_bytes + frame->values.size_bytes;
    if (trees != nullptr) {
        candidate->bytes += frame->trees.bytes() + uint64_t{2} * frame->local.size_bytes;
        candidate->dispatch_count += frame->local_points->dispatch_count();
        candidate->note += ", " + megabytes(trees->bytes()) + " trees, " + std::to_string(trees->local_count()) + " local points";
    }
    candidate->values = [frame, count] {
        const auto all = vk::download<float>(frame->device, frame->values, kRecord * count);
        if (!all) return PatchValues{};
        const auto value = [&](size_t k) { return unpad_points(all->data() + 3 * k, count, kRecord); };
        return PatchValues{value(0), value(1), value(2), {}};
    };
    return candidate;
}

Result<PatchCandidate> make_limn_grid_candidate(const LimnDevice& limn, const PatchTable& table,
                                                const std::vector<float>& positions, uint32_t rate,
                                                PatchTask task, GridLayout layout) {
    const auto made = make_frame(limn, table, positions);
    if (!made) return made.error();
    const std::shared_ptr<Frame> frame = *made;
    const auto grid = build_grid_table(table, {.rate = rate, .derivatives = task != PatchTask::points});
    if (!grid) return grid.error();
    auto uploaded = vk::upload_grid_table(limn.device, *grid);
    if (!uploaded) return uploaded.error();
    frame->grid = std::move(*uploaded);
    if (auto prepared = prepare_grid(limn, *frame, task, layout); !prepared) return prepared.error();

    const std::vector<uint32_t> faces = present_faces(table.ptex_surfaces);
    const uint64_t count = uint64_t{faces.size()} * frame->grid.samples_per_face;
    constexpr const char* kNames[] = {"limn", "limn_packed", "limn_separate"};
    auto candidate = make_candidate(limn, frame, kNames[static_cast<size_t>(layout)], count);
    if (!candidate) return candidate;
    const uint64_t words = grid_stride(task, layout) + (layout == GridLayout::separate ? 3u : 0u);
    candidate->bytes += frame->grid.bytes() + 4 * words * count;  // holes are not written
    candidate->flops = grid_flops(table, *grid);
    candidate->note += ", " + megabytes(frame->grid.bytes()) + " grid";
    candidate->values = [frame, faces, task, layout] { return download_values(*frame, task, layout, faces); };
    return candidate;
}

double grid_flops(const PatchTable& patches, const GridTable& grid) {
    double terms = 0;
    for (const GridSurface& surface : grid.surfaces) {
        const GridClass& c = grid.classes[surface.grid_class];
        terms += static_cast<double>(c.ring_size) * c.sample_count * grid.value_count;
    }
    for (const PointRun& run : patches.point_runs)
        terms += static_cast<double>(run.row_count) * run.entry_count;
    return 2 * 3 * terms;
}

PatchCandidate make_limn_host_patch_eval_candidate(const PatchTable& table,
                                                   std::span<const PatchSample> samples,
                                                   const std::vector<float>& positions, double copy_rate) {
    struct HostFrame {
        std::vector<double> control, points, values;
        std::vector<SampleStatus> statuses;
    };
    const size_t count = samples.size();
    const auto frame = std::make_shared<HostFrame>();
    frame->control.assign(positions.begin(), positions.end());
    frame->points.resize(size_t{3} * table.point_count());
    frame->values.resize(9 * count);
    frame->statuses.resize(count);

    PatchCandidate candidate;
    candidate.name = "limn_cpu_double";
    candidate.is_limn = true;
    candidate.sample_count = count;
    candidate.bytes = table.bytes() + uint64_t{2} * 24 * table.point_count() +
                      count * (sizeof(PatchSample) + 9 * sizeof(double) + sizeof(SampleStatus));
    candidate.copy_rate = copy_rate;
    candidate.frame = [frame, &table, samples] {
        build_patch_points(table, frame->control, 3, frame->points);
        evaluate_patches(table, samples, frame->points, 3, Derivatives::first, frame->values,
                         frame->statuses);
        return true;
    };
    candidate.values = [frame, count] {
        const std::vector<float> all(frame->values.begin(), frame->values.end());
        const auto value = [&](size_t k) { return unpad_points(all.data() + 3 * k, count, 9); };
        return PatchValues{value(0), value(1), value(2), {}};
    };
    return candidate;
}

}  // namespace limn::bench
