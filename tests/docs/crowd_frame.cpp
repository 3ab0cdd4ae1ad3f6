// The crowd of docs/integrating.md, compiled.
#include <limn/vulkan/crowd_tables.h>
#include <limn/vulkan/retirement.h>

// [docs]
// Between frames: one comes, one goes, and this frame's commands begin with what that changes on the device. True: prepare
// evaluations and tessellations again, those of all frames in flight as their turn comes.
limn::Result<bool> change_crowd(const limn::vk::Device& device, VkCommandBuffer commands, limn::Crowd& crowd,
                                limn::vk::DeviceCrowd& tables, const limn::BatchMesh& comes, uint32_t goes,
                                limn::vk::Retirement& retirement, uint64_t frame) {
    if (auto removed = crowd.remove(goes); !removed) return removed.error();
    const auto number = crowd.add(comes);  // its element of TessellationInfo::instances, and of instance_commands
    if (!number) return number.error();
    auto update = limn::vk::record_crowd_update(device, commands, crowd, tables);
    if (!update) return update.error();
    crowd.forget_changes();
    for (limn::vk::Buffer& buffer : update->staging) retirement.retire(frame, std::move(buffer));
    for (limn::vk::Buffer& buffer : update->replaced) retirement.retire(frame, std::move(buffer));
    return update->prepare_again;
}
// [/docs]
