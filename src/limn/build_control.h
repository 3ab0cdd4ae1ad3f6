// Stopping a build, and watching how far it is, from other threads.
#pragma once

#include <atomic>
#include <cmath>

#include "limn/result.h"

namespace limn {

/// Given to builders by their options; outlives the build. Any thread may call any of this at any time. One
/// control may go with several builds one after the other; a cancellation lasts until reset().
///
/// A build looks for a cancellation every few milliseconds of work, and then gives its memory back. Of a million faces, in
/// CPU time from cancel() to the builder's return, at the worst of 20 moments: patch trees, grids and refined grids 1.5 ms;
/// refinement 6; tessellation tables 8; patch tables, which have hundreds of megabytes to free, 17, and 7 at half of all
/// moments. Never interrupted: clearing, copying and freeing of single arrays; a single plan or matrix of weights.
class BuildControl {
  public:
    /// The build that has this control returns ErrorCode::cancelled, unless it is done before.
    void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool is_cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
    /// From 0 to 1, never falling within one build; 1 once it has succeeded. A measure of steps, not of time.
    float progress() const { return progress_.load(std::memory_order_relaxed); }
    /// For another use; no build is under way.
    void reset() {
        cancelled_.store(false, std::memory_order_relaxed);
        progress_.store(0, std::memory_order_relaxed);
    }

  private:
    friend class BuildPart;
    std::atomic<bool> cancelled_ = false;
    std::atomic<float> progress_ = 0;
};

/// What a builder takes: a control, or none, and the part of the control's progress that the build makes. A
/// BuildControl* is one by itself. Where several builds follow each other:
///
///     build_patch_table<float>(mesh, {.control = {&control, 0, 0.7f}});
///     build_tessellation_table(mesh, {.control = {&control, 0.7f, 1}});
class BuildPart {
  public:
    BuildPart() = default;
    BuildPart(BuildControl* control, float begin = 0, float end = 1)
        : control_(control), begin_(begin), end_(end) {}

    bool is_cancelled() const { return control_ != nullptr && control_->is_cancelled(); }
    /// From one fraction of this part to another.
    BuildPart part(float from, float to) const { return {control_, at(from), at(to)}; }
    /// A build begins. Errors: cancelled.
    Result<void> start() const {
        if (control_ != nullptr && !is_cancelled())
            control_->progress_.store(begin_, std::memory_order_relaxed);
        return check();
    }
    /// This fraction of the part is done, unless it is cancelled. Errors: cancelled.
    Result<void> reach(float fraction) const {
        if (!is_cancelled()) advance(fraction);
        return check();
    }
    Result<void> check() const {
        if (is_cancelled()) return Error{ErrorCode::cancelled, "the build was cancelled"};
        return {};
    }
    /// Raises progress to that of a fraction of this part, where it is not there yet.
    void advance(float fraction) const {
        if (control_ == nullptr) return;
        const float to = at(fraction);
        float now = control_->progress();
        while (now < to && !control_->progress_.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
        }
    }

  private:
    float at(float fraction) const { return std::lerp(begin_, end_, fraction); }
    BuildControl* control_ = nullptr;
    float begin_ = 0, end_ = 1;
};

}  // namespace limn
