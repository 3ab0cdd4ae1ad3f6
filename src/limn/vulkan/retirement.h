// Destruction that waits for the device, by frame numbers of the caller's.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace limn::vk {

/// Holds what command buffers in flight may still use: buffers, tables, evaluations, tessellations, evaluators, anything
/// that moves. Any thread may call either function at any time. Must be gone before the Context is, with the device idle
/// if it still holds anything.
class Retirement {
  public:
    /// Takes an object that was last used in `frame`. An object that refers to others is retired before them.
    template <class Object>
    void retire(uint64_t frame, Object object) {
        auto held = std::make_shared<Object>(std::move(object));
        const std::lock_guard lock(mutex_);
        retired_.push_back({frame, std::move(held)});
    }

    /// Destroys, in the calling thread and in the order of retirement, what was retired with a frame up to
    /// `completed_frame`: the device has completed that frame and all before it. Returns how many objects.
    size_t collect(uint64_t completed_frame) {
        std::vector<Retired> done;
        {
            const std::lock_guard lock(mutex_);
            const auto first_done =
                std::stable_partition(retired_.begin(), retired_.end(),
                                      [&](const Retired& r) { return r.frame > completed_frame; });
            done.assign(std::make_move_iterator(first_done), std::make_move_iterator(retired_.end()));
            retired_.erase(first_done, retired_.end());
        }
        for (Retired& retired : done) retired.object.reset();
        return done.size();
    }

    Retirement() = default;
    Retirement(const Retirement&) = delete;
    Retirement& operator=(const Retirement&) = delete;
    ~Retirement() { collect(~uint64_t{0}); }

  private:
    struct Retired {
        uint64_t frame;
        std::shared_ptr<void> object;
    };
    std::mutex mutex_;
    std::vector<Retired> retired_;
};

}  // namespace limn::vk
