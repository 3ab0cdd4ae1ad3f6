#include "limn_osd.h"

#include <optional>

#include "limn/osd/evaluator.h"
#include "timestamps.h"

namespace limn::bench {
namespace {

using osd::VkVertexBuffer;

/// Members are destroyed in reverse: commands before what they refer to, the context last.
struct Frame {
    explicit Frame(const vk::Device& of) : device(of), context(osd::VkDeviceContext::Create(of)), timestamps(of) {}
    const vk::Device& device;
    std::unique_ptr<osd::VkDeviceContext> context;
    Timestamps timestamps;
    std::unique_ptr<osd::VkStencilTable> stencils;
    std::unique_ptr<osd::VkPatchTable> patches;
    std::unique_ptr<VkVertexBuffer> points, places;  ///< control points, then those of all rows
    std::unique_ptr<VkVertexBuffer> values[3];
    std::optional<vk::Commands> commands;

    Error error() const { return context->GetError(); }
    /// The table, and the points, control points in place.
    bool make_points(const OpenSubdiv::Far::StencilTable& table, const std::vector<float>& positions) {
        const int control = static_cast<int>(positions.size() / 3);
        stencils.reset(osd::VkStencilTable::Create(&table, context.get()));
        points.reset(VkVertexBuffer::Create(3, control + table.GetNumStencils(), context.get()));
        return stencils && points && points->UpdateData(positions.data(), 0, control);
    }
};

/// `evaluate()` is what a frame calls. Errors: its.
template <class AnyCandidate, class Evaluate>
Result<void> set_frame(const std::shared_ptr<Frame>& frame, OsdFrame how, const Evaluate& evaluate, AnyCandidate& out) {
    if (!frame->context->Synchronize()) return frame->error();
    if (how == OsdFrame::submitted) {
        out.frame = [=] { return evaluate() && frame->context->Synchronize(); };
        return {};
    }
    auto commands = vk::Commands::begin(frame->device);
    if (!commands) return commands.error();
    frame->context->SetCommandBuffer(*commands);
    frame->timestamps.record_begin(*commands);
    const bool recorded = evaluate();
    frame->timestamps.record_end(*commands);
    frame->context->SetCommandBuffer(VK_NULL_HANDLE);  // what is read back is submitted
    if (!recorded) return frame->error();
    frame->commands.emplace(std::move(*commands));
    out.frame = [frame] { return frame->commands->submit_and_wait().has_value(); };
    if (frame->timestamps.available()) out.device_milliseconds = [frame] { return frame->timestamps.milliseconds(); };
    return {};
}

std::vector<float> read(const VkVertexBuffer& buffer, uint64_t first, uint64_t count) {
    std::vector<float> values(3 * count);
    if (!buffer.ReadData(values.data(), static_cast<int>(first), static_cast<int>(count))) values.clear();
    return values;
}

const char* suffix(OsdFrame how) {
    return how == OsdFrame::submitted ? "_submitted" : "";
}

}  // namespace

Result<Candidate> make_limn_osd_candidate(const vk::Device& device, const std::shared_ptr<const OsdTable>& table,
                                          const std::vector<float>& positions, OsdFrame how, double copy_rate) {
    Candidate candidate = describe_osd_candidate("", *table, 3);
    candidate.name = (table->passes.size() > 1 ? "limn_osd_chain" : "limn_osd_composed") + std::string(suffix(how));
    candidate.is_limn = true;
    candidate.copy_rate = copy_rate;
    const auto frame = std::make_shared<Frame>(device);
    if (!frame->make_points(*table->table, positions)) return frame->error();
    const auto evaluate = [=] {
        const VkBuffer points = frame->points->BindVkBuffer();
        for (const auto& [begin, end, source] : table->passes) {
            const osd::BoundPoints from{points, {3 * static_cast<int>(source), 3, 3}};
            const osd::BoundPoints to[6] = {{points, {3 * static_cast<int>(table->control_count), 3, 3}}};
            if (!osd::VkEvaluator::Stencils(from, to, frame->stencils.get(), frame->context.get(), static_cast<int>(begin),
                                            static_cast<int>(end)))
                return false;
        }
        return true;
    };
    if (auto made = set_frame(frame, how, evaluate, candidate); !made) return made.error();
    candidate.points = [=] {
        const uint64_t begin = table->last_level_begin();
        return read(*frame->points, table->control_count + begin, table->row_count() - begin);
    };
    return candidate;
}

Result<PatchCandidate> make_limn_osd_patch_candidate(const vk::Device& device,
                                                     const std::shared_ptr<const OsdPlaces>& places,
                                                     const std::vector<float>& positions, OsdFrame how,
                                                     double copy_rate) {
    PatchCandidate candidate = describe_osd_patch_candidate("", PatchTask::derivatives, *places, 3);
    candidate.name = "limn_osd" + std::string(suffix(how));
    candidate.is_limn = true;
    candidate.copy_rate = copy_rate;
    const OsdPatches& tables = *places->patches;
    const auto frame = std::make_shared<Frame>(device);
    osd::VkDeviceContext* context = frame->context.get();
    const int count = static_cast<int>(places->places.size());
    if (!frame->make_points(*tables.stencils, positions)) return frame->error();
    frame->patches.reset(osd::VkPatchTable::Create(tables.patches.get(), context));
    frame->places.reset(VkVertexBuffer::Create(5, count, context));
    for (auto& values : frame->values) values.reset(VkVertexBuffer::Create(3, count, context));
    if (!frame->patches || !frame->places || !frame->values[0] || !frame->values[1] || !frame->values[2] ||
        !frame->places->UpdateData(reinterpret_cast<const float*>(places->places.data()), 0, count))
        return frame->error();
    const auto evaluate = [=, control = static_cast<int>(tables.control_count)] {
        const osd::BufferDescriptor from(0, 3, 3), to(3 * control, 3, 3);
        VkVertexBuffer* points = frame->points.get();
        auto& [position, du, dv] = frame->values;
        return osd::VkEvaluator::EvalStencils(points, from, points, to, frame->stencils.get(), nullptr, context) &&
               osd::VkEvaluator::EvalPatches(points, from, position.get(), from, du.get(), from, dv.get(), from, count,
                                             frame->places.get(), frame->patches.get(), nullptr, context);
    };
    if (auto made = set_frame(frame, how, evaluate, candidate); !made) return made.error();
    candidate.values = [=] {
        const auto all = [&](size_t k) { return read(*frame->values[k], 0, static_cast<uint64_t>(count)); };
        return PatchValues{all(0), all(1), all(2), {}};
    };
    return candidate;
}

}  // namespace limn::bench
