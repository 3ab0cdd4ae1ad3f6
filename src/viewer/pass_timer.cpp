#include "viewer/pass_timer.h"

namespace limn::viewer {

PassTimer::PassTimer(const vk::Device& device) : device_(&device) {
    uint32_t count = device.queue_family_index + 1;
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device.physical_device, &count, families.data());
    const uint32_t bits = families[device.queue_family_index].timestampValidBits;
    if (bits == 0) return;
    VkQueryPoolCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = kMost + 1;
    auto pool = create_unique<UniqueQueryPool>(device.handle, vkCreateQueryPool, info, "vkCreateQueryPool");
    if (!pool) return;
    pool_ = std::move(*pool);
    mask_ = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
}

void PassTimer::record_begin(VkCommandBuffer commands) {
    names_.clear();
    if (mask_ == 0) return;
    vkCmdResetQueryPool(commands, pool_, 0, kMost + 1);
    vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_, 0);
}

void PassTimer::record_mark(VkCommandBuffer commands, const char* name) {
    if (mask_ == 0 || names_.size() == kMost) return;
    names_.push_back(name);
    vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_,
                        static_cast<uint32_t>(names_.size()));
}

std::span<const PassTimer::Pass> PassTimer::read() {
    passes_.clear();
    if (mask_ == 0 || names_.empty()) return passes_;
    uint64_t times[kMost + 1] = {};
    const auto count = static_cast<uint32_t>(names_.size() + 1);
    if (vkGetQueryPoolResults(device_->handle, pool_, 0, count, sizeof times, times, sizeof times[0],
                              VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
        return passes_;
    const double period = static_cast<double>(device_->properties.limits.timestampPeriod) * 1e-6;
    for (size_t i = 0; i < names_.size(); ++i)
        passes_.push_back({names_[i], static_cast<double>((times[i + 1] - times[i]) & mask_) * period});
    return passes_;
}

}  // namespace limn::viewer
