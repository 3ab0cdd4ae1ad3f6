// std::thread throws where the system has no thread left; pthread_create tells.
#include "limn/async_build.h"

#include <pthread.h>

#include <string>

namespace limn {

struct JobThread::State {
    std::function<void()> job;
    pthread_t thread = {};
};

Result<JobThread> JobThread::start(std::function<void()> job) {
    auto state = std::make_unique<State>();
    state->job = std::move(job);
    auto run = [](void* data) -> void* {
        static_cast<State*>(data)->job();
        return nullptr;
    };
    if (const int code = pthread_create(&state->thread, nullptr, run, state.get()); code != 0)
        return Error{ErrorCode::out_of_memory, "the system has no thread left (error " + std::to_string(code) + ")"};
    JobThread out;
    out.state_ = state.release();
    return out;
}

JobThread::~JobThread() {
    if (state_ == nullptr) return;
    pthread_join(state_->thread, nullptr);
    delete state_;
}

}  // namespace limn
