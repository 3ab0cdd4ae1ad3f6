// How long the commands of a frame take by the device's own clock.
#pragma once

#include "limn/vulkan/context.h"

namespace limn::bench {

/// Timestamps, two or more, where the queue has them. `device` must outlive them.
class Timestamps {
  public:
    explicit Timestamps(const vk::Device& device, uint32_t count = 2);
    Timestamps(const Timestamps&) = delete;
    Timestamps& operator=(const Timestamps&) = delete;
    ~Timestamps();

    bool available() const { return pool_ != VK_NULL_HANDLE; }
    /// Before the first of the commands, and after the last.
    void record_begin(VkCommandBuffer commands) const;
    void record_end(VkCommandBuffer commands) const;
    /// Any of those between.
    void record(VkCommandBuffer commands, uint32_t index) const;
    /// From the first to the last, once these have completed.
    double milliseconds() const { return milliseconds(0, count_ - 1); }
    double milliseconds(uint32_t from, uint32_t to) const;

  private:
    const vk::Device& device_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
    uint32_t count_;
    uint64_t mask_ = 0;
};

}  // namespace limn::bench
