// Barriers by value, and destruction by frame.
#include "limn/vulkan/synchronization.h"

#include <thread>

#include "limn/vulkan/buffer.h"
#include "limn/vulkan/retirement.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk {
namespace {

TEST(Synchronization, BarriersSayWhatTheyAreGiven) {
    const VkMemoryBarrier2 barrier = memory_barrier(kKernelWrites, kDrawReads);
    EXPECT_EQ(barrier.sType, VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
    EXPECT_EQ(barrier.srcStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
    EXPECT_EQ(barrier.srcAccessMask, VK_ACCESS_2_SHADER_WRITE_BIT);
    EXPECT_EQ(barrier.dstStageMask, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT);
    EXPECT_EQ(barrier.dstAccessMask, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT |
                                         VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT);
}

TEST(Synchronization, ReleaseAndAcquireAgree) {
    const VkBufferMemoryBarrier2 release = release_barrier(VK_NULL_HANDLE, {1, 4}, kKernelWrites),
                                 acquire = acquire_barrier(VK_NULL_HANDLE, {1, 4}, kVertexReads);
    EXPECT_EQ(release.srcQueueFamilyIndex, 1u);
    EXPECT_EQ(release.dstQueueFamilyIndex, 4u);
    EXPECT_EQ(acquire.srcQueueFamilyIndex, release.srcQueueFamilyIndex);
    EXPECT_EQ(acquire.dstQueueFamilyIndex, release.dstQueueFamilyIndex);
    EXPECT_EQ(acquire.size, release.size);
    EXPECT_EQ(release.srcAccessMask, VK_ACCESS_2_SHADER_WRITE_BIT);
    EXPECT_EQ(acquire.srcStageMask, acquire.dstStageMask);
    EXPECT_EQ(acquire.dstAccessMask, VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT);
}

/// Says when it is destroyed.
struct Witness {
    std::vector<int>* destroyed;
    int name;
    Witness(std::vector<int>* list, int number) : destroyed(list), name(number) {}
    Witness(Witness&& other) noexcept : destroyed(std::exchange(other.destroyed, nullptr)), name(other.name) {}
    ~Witness() {
        if (destroyed != nullptr) destroyed->push_back(name);
    }
};

TEST(Retirement, DestroysWhatFramesHaveCompletedInOrder) {
    std::vector<int> destroyed;
    {
        Retirement retirement;
        retirement.retire(2, Witness(&destroyed, 0));
        retirement.retire(1, Witness(&destroyed, 1));
        retirement.retire(2, Witness(&destroyed, 2));
        retirement.retire(3, Witness(&destroyed, 3));
        EXPECT_EQ(retirement.collect(0), 0u);
        EXPECT_TRUE(destroyed.empty());
        EXPECT_EQ(retirement.collect(2), 3u);
        EXPECT_EQ(destroyed, (std::vector<int>{0, 1, 2}));
    }
    EXPECT_EQ(destroyed, (std::vector<int>{0, 1, 2, 3}));
}

class RetiredBuffers : public test::VulkanTest {};

TEST_F(RetiredBuffers, ComeFromAnyThread) {
    Retirement retirement;
    std::vector<std::thread> threads;
    for (uint64_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (uint64_t frame = 0; frame < 8; ++frame)
                if (auto buffer = create_buffer(device(), 64, kPointUsage, MemoryUse::device))
                    retirement.retire(4 * frame + t, std::move(*buffer));
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(retirement.collect(15), 16u);
    EXPECT_EQ(retirement.collect(31), 16u);
}

}  // namespace
}  // namespace limn::vk
