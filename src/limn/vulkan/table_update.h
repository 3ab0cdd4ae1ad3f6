// Tables on the device that follow those on the host: only what differs is copied, in your command buffer.
#pragma once

#include "limn/vulkan/tessellation_tables.h"

namespace limn::vk {

/// A recorded update of tables, which stay where they are.
///
/// Barriers. The commands begin with one from kKernelReads to kCopyWrites, so that what was submitted to the
/// same queue before reads the old state, and end with one from kCopyWrites to kKernelReads. Owed by the
/// caller: the first where other stages read tables (hardware tessellation: its stages), and after those
/// again; a semaphore where frames on another queue do.
struct TableUpdate {
    std::vector<Buffer> staging;   ///< read by the commands: keep it until they have completed
    std::vector<Buffer> replaced;  ///< that were too small: retire them in the last frame that was recorded
                                   ///< before (retirement.h)
    VkDeviceSize copied_bytes = 0;
    /// Evaluations and tessellations of these tables are to be prepared again before they are recorded again:
    /// buffers, or what is dispatched, are others. Else they stay as they are; but record them anew, since
    /// how much is dispatched may differ.
    bool prepare_again = false;
};

}  // namespace limn::vk
