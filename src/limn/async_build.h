// Builds that go on beside their caller: on a thread of their own, or as a job of the caller's system.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "limn/build_control.h"

namespace limn {

/// A thread of its own for one job; joined by its end.
class JobThread {
  public:
    JobThread() = default;
    JobThread(JobThread&& other) noexcept : state_(std::exchange(other.state_, nullptr)) {}
    JobThread& operator=(JobThread&& other) noexcept {
        std::swap(state_, other.state_);
        return *this;
    }
    ~JobThread();
    /// Errors: out_of_memory where the system has no thread left; the job is not run then.
    static Result<JobThread> start(std::function<void()> job);

  private:
    struct State;
    State* state_ = nullptr;
};

/// A build under way. Its control is made for it: hand that to the builders in their options.
///
///     auto build = AsyncBuild<PatchTable>::start([&](BuildControl& control) {
///         return build_patch_table<float>(mesh, {.control = &control}, &cache);
///     });
///     if (!build) return build.error();
///     ...every frame: if (build->is_ready()) use(build->take());
///
/// One thread owns it; only cancel() and progress() may be called from any. Destruction cancels, and waits
/// until the build has stopped and its thread is gone: what it reads may then be freed.
template <class T>
class AsyncBuild {
  public:
    using Job = std::function<void()>;
    using Build = std::function<Result<T>(BuildControl&)>;

    /// Calls build(control) on a new thread. Errors: out_of_memory where the system has none left.
    static Result<AsyncBuild> start(Build build) {
        AsyncBuild out;
        auto thread = JobThread::start(out.make_job(std::move(build)));
        if (!thread) return out.state_ = nullptr, thread.error();
        out.thread_ = std::move(*thread);
        return out;
    }
    /// `submit` gets the job and has it run once, on any thread, now or later; a job that never runs is waited
    /// for forever.
    static AsyncBuild start(Build build, const std::function<void(Job)>& submit) {
        AsyncBuild out;
        submit(out.make_job(std::move(build)));
        return out;
    }

    AsyncBuild(AsyncBuild&&) noexcept = default;
    AsyncBuild& operator=(AsyncBuild&& other) noexcept {
        const AsyncBuild old = std::move(*this);  // ends here
        state_ = std::move(other.state_);
        thread_ = std::move(other.thread_);
        return *this;
    }
    ~AsyncBuild() {
        if (state_ == nullptr) return;
        cancel();
        wait();
    }

    void cancel() { state_->control.cancel(); }
    float progress() const { return state_->control.progress(); }
    bool is_ready() const { return state_->ready.load(std::memory_order_acquire); }
    void wait() const { state_->ready.wait(false, std::memory_order_acquire); }
    /// Waits where it is not ready. To be called once.
    Result<T> take() {
        wait();
        return std::move(*state_->result);
    }

  private:
    struct State {
        BuildControl control;
        std::optional<Result<T>> result;
        std::atomic<bool> ready = false;
    };
    AsyncBuild() = default;
    /// The job keeps the state: it goes on for a moment after it has said that it is ready.
    Job make_job(Build build) {
        state_ = std::make_shared<State>();
        return [state = state_, build = std::move(build)]() mutable {
            const auto ok = BuildPart(&state->control).check();
            state->result.emplace(ok ? build(state->control) : Result<T>(ok.error()));
            build = nullptr;  // what it holds goes before anyone is told
            state->ready.store(true, std::memory_order_release);
            state->ready.notify_all();
        };
    }
    std::shared_ptr<State> state_;
    JobThread thread_;
};

}  // namespace limn
