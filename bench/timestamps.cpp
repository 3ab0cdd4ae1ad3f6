#include "timestamps.h"

#include <vector>

namespace limn::bench {

Timestamps::Timestamps(const vk::Device& device, uint32_t count) : device_(device), count_(count) {
    uint32_t family_count = device.queue_family_index + 1;
    std::vector<VkQueueFamilyProperties> families(family_count);
    device.functions.GetPhysicalDeviceQueueFamilyProperties(device.physical_device, &family_count, families.data());
    const uint32_t bits = families[device.queue_family_index].timestampValidBits;
    if (bits == 0) return;
    mask_ = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
    VkQueryPoolCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = count;
    if (device.functions.CreateQueryPool(device.handle, &info, nullptr, &pool_) != VK_SUCCESS)
        pool_ = VK_NULL_HANDLE;
}

Timestamps::~Timestamps() {
    if (available()) device_.functions.DestroyQueryPool(device_.handle, pool_, nullptr);
}

void Timestamps::record_begin(VkCommandBuffer commands) const {
    if (!available()) return;
    device_.functions.CmdResetQueryPool(commands, pool_, 0, count_);
    device_.functions.CmdWriteTimestamp(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, pool_, 0);
}

void Timestamps::record(VkCommandBuffer commands, uint32_t index) const {
    if (available()) device_.functions.CmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_, index);
}

void Timestamps::record_end(VkCommandBuffer commands) const {
    record(commands, count_ - 1);
}

double Timestamps::milliseconds(uint32_t from, uint32_t to) const {
    const auto time = [&](uint32_t index) {
        uint64_t ticks = 0;
        device_.functions.GetQueryPoolResults(device_.handle, pool_, index, 1, sizeof ticks, &ticks, sizeof ticks,
                                              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
        return ticks;
    };
    const double ticks = static_cast<double>((time(to) - time(from)) & mask_);
    return ticks * static_cast<double>(device_.properties.limits.timestampPeriod) * 1e-6;
}

}  // namespace limn::bench
