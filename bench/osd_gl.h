// OpenSubdiv's GL compute evaluator, without a window: EGL on its surfaceless platform. Where EGL, OpenGL or
// OpenSubdiv's GPU library are not here, only stand-ins that say so.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench.h"
#include "candidate.h"
#include "osd.h"

namespace limn::bench {

#if defined(LIMN_HAVE_OPENSUBDIV_GL)

/// A GL context, current on the thread that created it until it is destroyed.
class GlContext {
  public:
    /// Errors: no_device (no such context here).
    static Result<GlContext> create();
    GlContext(GlContext&&) noexcept;
    GlContext& operator=(GlContext&&) noexcept;
    ~GlContext();

    const std::string& description() const;
    /// Bytes per second that glCopyBufferSubData reads and writes.
    double measure_copy(const Options& options) const;

  private:
    struct State;
    explicit GlContext(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// The context must outlive the candidate. Errors: unsupported (a kernel that does not compile).
Result<Candidate> make_osd_gl_candidate(const GlContext& context,
                                        const std::shared_ptr<const OsdTable>& table,
                                        const std::vector<float>& positions, uint32_t width,
                                        double copy_rate);

#else

struct GlContext {
    static Result<GlContext> create() {
        return Error{ErrorCode::unsupported, "built without EGL, OpenGL or OpenSubdiv's GPU library"};
    }
    std::string description() const { return {}; }
    double measure_copy(const Options&) const { return 0; }
};
inline Result<Candidate> make_osd_gl_candidate(const GlContext&, const std::shared_ptr<const OsdTable>&,
                                               const std::vector<float>&, uint32_t, double) {
    return GlContext::create().error();
}

#endif

}  // namespace limn::bench
