// How long the passes of a frame take, by the device's own clock.
#pragma once

#include <span>
#include <vector>

#include "viewer/handles.h"

namespace limn::viewer {

/// Timestamps between passes. Where the queue has none, no pass is ever reported.
class PassTimer {
  public:
    struct Pass {
        const char* name;
        double milliseconds;
    };

    explicit PassTimer(const vk::Device& device);

    /// Outside a render pass; forgets the last frame.
    void record_begin(VkCommandBuffer commands);
    /// What was recorded since the last mark is `name`, a literal. Outside a render pass.
    void record_mark(VkCommandBuffer commands, const char* name);
    /// The passes of the last frame, whose commands have completed.
    std::span<const Pass> read();

  private:
    static constexpr uint32_t kMost = 16;
    const vk::Device* device_;
    UniqueQueryPool pool_;
    uint64_t mask_ = 0;
    std::vector<const char*> names_;
    std::vector<Pass> passes_;
};

}  // namespace limn::viewer
