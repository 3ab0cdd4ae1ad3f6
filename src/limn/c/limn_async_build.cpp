// The C interface: builds that go on beside their caller.
#include "limn/async_build.h"

#include <optional>
#include <type_traits>

#include "limn/c/interop.h"

namespace limn::c {
namespace {

struct Done {};  // what C builds, it keeps itself

limn_build_control* as_c(BuildControl& control) {
    static_assert(std::is_standard_layout_v<limn_build_control> && sizeof(limn_build_control) == sizeof(BuildControl));
    return reinterpret_cast<limn_build_control*>(&control);
}

Result<Done> run(limn_build_function build, void* user, BuildControl& control) {
    limn_error error = {};
    error.element = LIMN_NO_ELEMENT;
    const limn_result code = build(user, as_c(control), &error);
    if (code == LIMN_SUCCESS) return Done{};
    if (code < LIMN_SUCCESS || code > LIMN_ERROR_CANCELLED) return bad_argument("the build returned what is no code of limn's");
    error.message[LIMN_MESSAGE_BYTES - 1] = 0;
    return Error{static_cast<ErrorCode>(code - 1), error.message, error.element, error.vk_result};
}

}  // namespace
}  // namespace limn::c

struct limn_async_build {
    limn::AsyncBuild<limn::c::Done> value;
    std::optional<limn::Result<limn::c::Done>> result = {};
};

namespace limn::c {
namespace {

Result<AsyncBuild<Done>> start(limn_build_function build, void* user, const limn_job_system* jobs) {
    using Job = AsyncBuild<Done>::Job;
    if (build == nullptr || (jobs != nullptr && jobs->submit == nullptr)) return bad_argument("a function is null");
    const auto job = [=](BuildControl& control) { return run(build, user, control); };
    if (jobs == nullptr) return AsyncBuild<Done>::start(job);
    return AsyncBuild<Done>::start(job, [jobs](Job made) {
        const auto call = [](void* data) {
            const std::unique_ptr<Job> owned(static_cast<Job*>(data));
            (*owned)();
        };
        jobs->submit(jobs->user, call, new Job(std::move(made)));
    });
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_async_build_start(limn_build_function build, void* user, const limn_job_system* jobs,
                                   limn_async_build** started, limn_error* error) noexcept {
    return create(started, error, [&] { return start(build, user, jobs); });
}
void limn_async_build_cancel(limn_async_build* build) noexcept {
    if (build != nullptr) build->value.cancel();
}
float limn_async_build_get_progress(const limn_async_build* build) noexcept {
    return build != nullptr ? build->value.progress() : 0;
}
uint32_t limn_async_build_is_ready(const limn_async_build* build) noexcept {
    return build != nullptr && build->value.is_ready() ? 1 : 0;
}
limn_result limn_async_build_wait(limn_async_build* build, limn_error* error) noexcept {
    if (build == nullptr) return report(bad_argument("build is null"), error);
    if (!build->result) build->result = build->value.take();
    return *build->result ? LIMN_SUCCESS : report(build->result->error(), error);
}
void limn_async_build_destroy(limn_async_build* build) noexcept {
    delete build;
}
