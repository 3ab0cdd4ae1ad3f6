// A crowd on the device: what of its tables has changed is copied there, in your command buffer.
#pragma once

#include "limn/crowd.h"
#include "limn/vulkan/table_update.h"
#include "limn/vulkan/tessellation_tables.h"

namespace limn::vk {

/// Tables of one crowd, as others are: prepare with them what is evaluated and tessellated. Their counts are what
/// there is room for. Empty before the first update. They stay where they are while anything is prepared with them.
struct DeviceCrowd {
    DevicePatchTable patches;
    DeviceTessellationTable topology;
    uint64_t layout = 0;  ///< Crowd::layout of what is there; 0: nothing

    VkDeviceSize bytes() const { return patches.bytes() + topology.bytes(); }
};

/// Brings the device's tables to the crowd's state, as TableUpdate says: all of it where the layout is
/// another, else the changes that the crowd remembers; forget them (Crowd::forget_changes) once this has been
/// recorded. Commands recorded afterwards see the new state, commands recorded before it the old one. Host
/// objects prepared with the tables must not be recorded meanwhile. Errors: out_of_memory, too_large (2^32
/// words), vulkan_failure; the tables are then as they were.
Result<TableUpdate> record_crowd_update(const Device& device, VkCommandBuffer command_buffer,
                                        const Crowd& crowd, DeviceCrowd& table);
/// What that takes. Errors: too_large.
Result<MemoryNeed> crowd_update_memory(const Device& device, const Crowd& crowd, const DeviceCrowd& table);
/// What Tessellator::prepare makes memory for, as tessellation_memory, without channels and heights.
MemoryNeed crowd_tessellation_memory(const Crowd& crowd, bool previous_points = false);

}  // namespace limn::vk
