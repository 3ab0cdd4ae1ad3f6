#include "osd_gl.h"

#if defined(LIMN_HAVE_OPENSUBDIV_GL)

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <opensubdiv/osd/glComputeEvaluator.h>
#include <opensubdiv/osd/glVertexBuffer.h>

#include <algorithm>
#include <cstring>

#include "osd_stencils.h"

// Exported by libosdGPU for programs that bring their own context; its header is not installed.
namespace OpenSubdiv::internal::GLLoader {
extern bool applicationInitializeGL();
}

namespace limn::bench {

namespace Osd = OpenSubdiv::Osd;

namespace {

constexpr uint32_t kGroupSize = 64, kMaxGroups = 65535;  // of OpenSubdiv's kernel, and of one dispatch

const char* gl_text(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text != nullptr ? reinterpret_cast<const char*>(text) : "unknown";
}

}  // namespace

struct GlContext::State {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    std::string description;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (display == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
        eglTerminate(display);
    }
};

GlContext::GlContext(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;
const std::string& GlContext::description() const {
    return state_->description;
}

Result<GlContext> GlContext::create() {
    const auto failed = [](const char* what) {
        return Error{ErrorCode::no_device, std::string("no OpenGL 4.5 through EGL: ") + what};
    };
    auto state = std::make_unique<State>();
    state->display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    if (state->display == EGL_NO_DISPLAY) return failed("no surfaceless platform");
    if (eglInitialize(state->display, nullptr, nullptr) != EGL_TRUE) {
        state->display = EGL_NO_DISPLAY;
        return failed("eglInitialize");
    }
    const char* extensions = eglQueryString(state->display, EGL_EXTENSIONS);
    if (extensions == nullptr || std::strstr(extensions, "EGL_KHR_surfaceless_context") == nullptr)
        return failed("EGL_KHR_surfaceless_context");
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return failed("eglBindAPI");
    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                        EGL_NONE};
    EGLConfig config = nullptr;
    EGLint config_count = 0;
    if (eglChooseConfig(state->display, config_attributes, &config, 1, &config_count) != EGL_TRUE ||
        config_count == 0)
        return failed("eglChooseConfig");
    const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                         4,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         5,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
    state->context = eglCreateContext(state->display, config, EGL_NO_CONTEXT, context_attributes);
    if (state->context == EGL_NO_CONTEXT) return failed("eglCreateContext");
    if (eglMakeCurrent(state->display, EGL_NO_SURFACE, EGL_NO_SURFACE, state->context) != EGL_TRUE)
        return failed("eglMakeCurrent");
    if (!OpenSubdiv::internal::GLLoader::applicationInitializeGL()) return failed("OpenSubdiv's loader");
    state->description = std::string(gl_text(GL_RENDERER)) + ", OpenGL " + gl_text(GL_VERSION);
    return GlContext(std::move(state));
}

double GlContext::measure_copy(const Options& options) const {
    constexpr GLsizeiptr kBytes = GLsizeiptr{256} << 20;
    GLuint buffers[2] = {};
    glCreateBuffers(2, buffers);
    for (const GLuint buffer : buffers) glNamedBufferData(buffer, kBytes, nullptr, GL_STATIC_COPY);
    const GLuint pattern = 0x3F800000;  // memory never written may not be there at all
    glClearNamedBufferData(buffers[0], GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &pattern);
    const Timing timing = measure(options, [&] {
        glCopyNamedBufferSubData(buffers[0], buffers[1], 0, 0, kBytes);
        glFinish();
        return glGetError() == GL_NO_ERROR;
    });
    glDeleteBuffers(2, buffers);
    return timing.count != 0 ? 2 * static_cast<double>(kBytes) / timing.median * 1000 : 0;
}

Result<Candidate> make_osd_gl_candidate(const GlContext&, const std::shared_ptr<const OsdTable>& table,
                                        const std::vector<float>& positions, uint32_t width,
                                        double copy_rate) {
    GLint64 most_bytes = 0;  // one less than a power of two on some drivers
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most_bytes);
    const uint64_t buffer_bytes =
        4 * std::max(table->entry_count(), width * (table->control_count + table->row_count()));
    if (buffer_bytes > static_cast<uint64_t>(most_bytes) + 1)
        return Error{ErrorCode::unsupported,
                     "a buffer of " + megabytes(buffer_bytes) + ", more than GL binds"};
    struct Frame {
        std::unique_ptr<Osd::GLVertexBuffer> points;  // control points, then the points of all rows
        std::unique_ptr<Osd::GLStencilTableSSBO> table;
        std::unique_ptr<Osd::GLComputeEvaluator> evaluator;
    };
    const auto frame = std::make_shared<Frame>();
    const int w = static_cast<int>(width);
    const Osd::BufferDescriptor from(0, w, w), to(w * static_cast<int>(table->control_count), w, w);
    const auto point_count = static_cast<int>(table->control_count + table->row_count());
    frame->points.reset(Osd::GLVertexBuffer::Create(w, point_count));
    frame->table.reset(Osd::GLStencilTableSSBO::Create(table->table.get()));
    frame->evaluator.reset(
        Osd::GLComputeEvaluator::Create(from, to, Osd::BufferDescriptor(), Osd::BufferDescriptor()));
    if (!frame->points || !frame->table || !frame->evaluator)
        return Error{ErrorCode::unsupported, "OpenSubdiv's GL compute evaluator cannot be made"};
    const std::vector<float> padded = pad_points(positions, width);
    frame->points->UpdateData(padded.data(), 0, static_cast<int>(table->control_count));
    glFinish();

    Candidate candidate = describe_osd_candidate("gl", *table, width);
    candidate.copy_rate = copy_rate;
    candidate.frame = [=] {
        const auto points = frame->points->BindVBO();
        const auto& t = *frame->table;
        for (const auto& pass : table->passes) {
            if (pass.begin != 0) glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
            const Osd::BufferDescriptor source(w * static_cast<int>(pass.source), w, w);
            for (uint32_t begin = pass.begin, end = begin; begin < pass.end; begin = end) {
                end = std::min(pass.end, begin + kGroupSize * kMaxGroups);
                if (!frame->evaluator->EvalStencils(
                        points, source, points, to, 0, Osd::BufferDescriptor(), 0, Osd::BufferDescriptor(),
                        t.GetSizesBuffer(), t.GetOffsetsBuffer(), t.GetIndicesBuffer(), t.GetWeightsBuffer(),
                        0, 0, static_cast<int>(begin), static_cast<int>(end)))
                    return false;
            }
        }
        Osd::GLComputeEvaluator::Synchronize(nullptr);
        return glGetError() == GL_NO_ERROR;
    };
    candidate.points = [=] {
        const uint64_t begin = table->last_level_begin(), count = table->row_count() - begin;
        std::vector<float> values(count * width);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(frame->points->BindVBO(),
                                static_cast<GLintptr>(4 * width * (table->control_count + begin)),
                                static_cast<GLsizeiptr>(4 * values.size()), values.data());
        return unpad_points(values.data(), count, width);
    };
    return candidate;
}

}  // namespace limn::bench

#endif
