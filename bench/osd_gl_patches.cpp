// OpenSubdiv's GL compute evaluator at places of the surface.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <opensubdiv/osd/glComputeEvaluator.h>
#include <opensubdiv/osd/glPatchTable.h>
#include <opensubdiv/osd/glVertexBuffer.h>

#include "osd_patches.h"

namespace limn::bench {

namespace Osd = OpenSubdiv::Osd;

namespace {

constexpr uint64_t kGroupSize = 64, kMaxGroups = 65535;  // of OpenSubdiv's kernels, and of one dispatch

struct Frame {
    std::unique_ptr<Osd::GLVertexBuffer> points;  // control points, then the points of all rows
    std::unique_ptr<Osd::GLVertexBuffer> places;
    std::unique_ptr<Osd::GLVertexBuffer> values[3];  // position, du, dv
    std::unique_ptr<Osd::GLStencilTableSSBO> stencils;
    std::unique_ptr<Osd::GLPatchTable> patches;
    std::unique_ptr<Osd::GLComputeEvaluator> stencil_evaluator, patch_evaluator;

    bool complete() const {
        return points && places && values[0] && values[1] && values[2] && stencils && patches &&
               stencil_evaluator && patch_evaluator;
    }
};

std::vector<float> read(Osd::GLVertexBuffer& buffer, size_t count, uint32_t width) {
    std::vector<float> values(count * width);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(buffer.BindVBO(), 0, static_cast<GLsizeiptr>(4 * values.size()), values.data());
    return unpad_points(values.data(), count, width);
}

std::shared_ptr<Frame> make_frame(PatchTask task, const OsdPlaces& places,
                                  const std::vector<float>& positions, uint32_t width) {
    const OsdPatches& patches = *places.patches;
    const int w = static_cast<int>(width), place_count = static_cast<int>(places.places.size());
    const Osd::BufferDescriptor from(0, w, w), to(w * static_cast<int>(patches.control_count), w, w);
    const Osd::BufferDescriptor none;
    auto frame = std::make_shared<Frame>();
    frame->points.reset(Osd::GLVertexBuffer::Create(w, static_cast<int>(patches.point_count())));
    static_assert(sizeof(Osd::PatchCoord) == 5 * sizeof(float));
    frame->places.reset(Osd::GLVertexBuffer::Create(5, place_count));
    for (auto& values : frame->values) values.reset(Osd::GLVertexBuffer::Create(w, place_count));
    frame->stencils.reset(Osd::GLStencilTableSSBO::Create(patches.stencils.get()));
    frame->patches.reset(Osd::GLPatchTable::Create(patches.patches.get()));
    frame->stencil_evaluator.reset(Osd::GLComputeEvaluator::Create(from, to, none, none));
    const Osd::BufferDescriptor derivative = task == PatchTask::points ? none : from;
    frame->patch_evaluator.reset(Osd::GLComputeEvaluator::Create(from, from, derivative, derivative));
    if (!frame->complete()) return nullptr;
    const std::vector<float> padded = pad_points(positions, width);
    frame->points->UpdateData(padded.data(), 0, static_cast<int>(patches.control_count));
    frame->places->UpdateData(reinterpret_cast<const float*>(places.places.data()), 0, place_count);
    glFinish();
    return frame;
}

}  // namespace

Result<PatchCandidate> make_osd_gl_patch_candidate(const GlContext&, PatchTask task,
                                                   const std::shared_ptr<const OsdPlaces>& places,
                                                   const std::vector<float>& positions, uint32_t width,
                                                   double copy_rate) {
    const uint64_t most = kGroupSize * kMaxGroups;
    if (places->places.size() > most || places->patches->stencil_count() > most)
        return Error{ErrorCode::unsupported, "more than one dispatch of OpenSubdiv's GL evaluator"};
    const auto frame = make_frame(task, *places, positions, width);
    if (frame == nullptr)
        return Error{ErrorCode::unsupported, "OpenSubdiv's GL compute evaluator cannot be made"};

    PatchCandidate candidate = describe_osd_patch_candidate("gl", task, *places, width);
    candidate.copy_rate = copy_rate;
    candidate.dispatch_count = 2;
    candidate.frame = [=] {
        const int w = static_cast<int>(width);
        const Osd::BufferDescriptor from(0, w, w),
            to(w * static_cast<int>(places->patches->control_count), w, w);
        auto& [position, du, dv] = frame->values;
        if (!frame->stencil_evaluator->EvalStencils(frame->points.get(), from, frame->points.get(), to,
                                                    frame->stencils.get()))
            return false;
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        const int count = static_cast<int>(places->places.size());
        const bool done =
            task == PatchTask::points
                ? frame->patch_evaluator->EvalPatches(frame->points.get(), from, position.get(), from, count,
                                                      frame->places.get(), frame->patches.get())
                : frame->patch_evaluator->EvalPatches(frame->points.get(), from, position.get(), from,
                                                      du.get(), from, dv.get(), from, count,
                                                      frame->places.get(), frame->patches.get());
        if (!done) return false;
        Osd::GLComputeEvaluator::Synchronize(nullptr);
        return glGetError() == GL_NO_ERROR;
    };
    candidate.values = [=] {
        const auto& [position, du, dv] = frame->values;
        const size_t count = places->places.size();
        if (task == PatchTask::points) return PatchValues{read(*position, count, width), {}, {}, {}};
        return PatchValues{
            read(*position, count, width), read(*du, count, width), read(*dv, count, width), {}};
    };
    return candidate;
}

}  // namespace limn::bench
