// Stopping a build, and watching how far it is, from other threads.
#pragma once

#include <atomic>

#include "limn/result.h"

namespace limn {

/// Given to a builder by its options; outlives the build. Any thread may call any of this at any time. One
/// control may go with several builds one after the other: its progress is then that of the latest, and a
/// cancellation lasts until reset().
class BuildControl {
  public:
    /// The build that has this control returns ErrorCode::cancelled, unless it is done before: at once while it walks
    /// around faces, builds plans or trees, else after the stage that it is in (topology, the split, level-1 points).
    void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool is_cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
    /// From 0 to 1, never falling within one build; 1 once it has succeeded. A measure of steps, not of time.
    float progress() const { return progress_.load(std::memory_order_relaxed); }
    /// For another use; no build is under way.
    void reset() {
        cancelled_.store(false, std::memory_order_relaxed);
        progress_.store(0, std::memory_order_relaxed);
    }
    /// For builders.
    void set_progress(float progress) { progress_.store(progress, std::memory_order_relaxed); }

  private:
    std::atomic<bool> cancelled_ = false;
    std::atomic<float> progress_ = 0;
};

/// Whether a build whose control may be null is to stop.
inline bool is_cancelled(const BuildControl* control) {
    return control != nullptr && control->is_cancelled();
}
inline Error cancelled_error() {
    return {ErrorCode::cancelled, "the build was cancelled"};
}

/// Marks that a step of a build is done. Errors: cancelled.
inline Result<void> reach(BuildControl* control, float progress) {
    if (control == nullptr) return {};
    if (control->is_cancelled()) return cancelled_error();
    control->set_progress(progress);
    return {};
}

}  // namespace limn
