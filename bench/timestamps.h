// How long the commands of a frame take by the device's own clock.
#pragma once

#include "limn/vulkan/context.h"

namespace limn::bench {

/// Two timestamps, where the queue has them. `device` must outlive them.
class Timestamps {
  public:
    explicit Timestamps(const vk::Device& device);
    Timestamps(const Timestamps&) = delete;
    Timestamps& operator=(const Timestamps&) = delete;
    ~Timestamps();

    bool available() const { return pool_ != VK_NULL_HANDLE; }
    /// Before the first of the commands, and after the last.
    void record_begin(VkCommandBuffer commands) const;
    void record_end(VkCommandBuffer commands) const;
    /// From the first to the last, once these have completed.
    double milliseconds() const;

  private:
    const vk::Device& device_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
    uint64_t mask_ = 0;
};

}  // namespace limn::bench
