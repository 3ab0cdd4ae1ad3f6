// Builds that go on beside their caller: on a thread of their own, or as a job of the caller's system.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "limn/build_control.h"

namespace limn {

/// A build under way. Its control is made for it: hand that to the builders in their options.
///
///     auto build = AsyncBuild<PatchTable>::start([&](BuildControl& control) {
///         return build_patch_table<float>(mesh, {.control = &control}, &cache);
///     });
///     ...every frame: if (build.is_ready()) use(build.take());
///
/// One thread owns it; only cancel() and progress() may be called from any. Destruction cancels, and waits
/// until the build has stopped: what it reads may then be freed.
template <class T>
class AsyncBuild {
  public:
    using Job = std::function<void()>;
    using Build = std::function<Result<T>(BuildControl&)>;

    /// Calls build(control) on a new thread.
    static AsyncBuild start(Build build) {
        return start(std::move(build), [](Job job) { std::thread(std::move(job)).detach(); });
    }
    /// `submit` gets the job and has it run once, on any thread, now or later; a job that never runs is waited
    /// for forever.
    static AsyncBuild start(Build build, const std::function<void(Job)>& submit) {
        AsyncBuild out;
        out.state_ = std::make_shared<State>();
        submit([state = out.state_, build = std::move(build)]() mutable {
            state->result.emplace(state->control.is_cancelled() ? Result<T>(cancelled_error())
                                                                : build(state->control));
            build = nullptr;  // what it holds goes before anyone is told
            state->ready.store(true, std::memory_order_release);
            state->ready.notify_all();
        });
        return out;
    }

    AsyncBuild(AsyncBuild&&) noexcept = default;
    AsyncBuild& operator=(AsyncBuild&& other) noexcept {
        AsyncBuild old = std::move(*this);
        state_ = std::move(other.state_);
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
    std::shared_ptr<State> state_;
};

}  // namespace limn
