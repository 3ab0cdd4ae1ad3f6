// Thousands of frames, two in flight, on one queue and on two of different families: control points that the first queue
// animates, tessellation on the last, and the first again, which draws (here: copies) what comes out.
#include <vulkan/vulkan.h>

#include <chrono>
#include <cstring>

#include "vulkan/engine.h"
#include "vulkan/engine_scene.h"

namespace limn::vk {
namespace {

using test::Arena;
using test::Engine;
using test::kSceneTriangles;
using test::kSceneVertices;
using test::SceneFrame;
using test::SceneKernels;
using test::SceneTables;
using test::SceneUpload;

constexpr uint32_t kFramesInFlight = 2, kFrameCount = 10'000;
constexpr size_t kReadBytes = 32;  // the command, and the first vertex

/// What a caller forgets, to see that it is noticed.
enum class Omission { none, release, acquire, wait };

void record_barriers(VkCommandBuffer commands, const std::vector<VkBufferMemoryBarrier2>& buffers,
                     const std::vector<VkMemoryBarrier2>& memory = {}) {
    VkDependencyInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    info.memoryBarrierCount = static_cast<uint32_t>(memory.size());
    info.pMemoryBarriers = memory.data();
    info.bufferMemoryBarrierCount = static_cast<uint32_t>(buffers.size());
    info.pBufferMemoryBarriers = buffers.data();
    vkCmdPipelineBarrier2(commands, &info);
}

/// A frame in flight: limn's objects, and the caller's commands and semaphores around them.
struct FrameInFlight {
    std::optional<SceneFrame> surface;
    Buffer readback;
    VkCommandPool pools[2] = {};          ///< of the first family, of the last
    VkCommandBuffer commands[3] = {};     ///< animate, evaluate, consume
    VkSemaphore ready[2] = {};            ///< points, surface
    VkFence done = VK_NULL_HANDLE;
    float moved_by = 0;  ///< the control points, along x
    bool is_submitted = false;
};

class Frames {
  public:
    Frames(Engine& engine, const Device& device, const SceneTables& tables) : engine_(engine), device_(device), tables_(tables) {}
    ~Frames() {
        vkDeviceWaitIdle(device_.handle);
        for (FrameInFlight& f : frames_) {
            for (VkCommandPool pool : f.pools) vkDestroyCommandPool(device_.handle, pool, nullptr);
            for (VkSemaphore semaphore : f.ready) vkDestroySemaphore(device_.handle, semaphore, nullptr);
            vkDestroyFence(device_.handle, f.done, nullptr);
        }
    }

    Result<void> create(const SceneKernels& kernels, const SceneUpload& tables) {
        for (FrameInFlight& f : frames_) {
            auto surface = SceneFrame::create(device_, kernels, tables);
            if (!surface) return surface.error();
            f.surface.emplace(std::move(*surface));
            auto readback = create_buffer(device_, kReadBytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback);
            if (!readback) return readback.error();
            f.readback = std::move(*readback);
            create_vulkan_objects(f);
        }
        return {};
    }

    /// Waits for the frame that had these objects before, checks it, and submits the next one.
    void run_frame(uint32_t number, Omission omission = Omission::none) {
        FrameInFlight& f = frames_[number % kFramesInFlight];
        finish(f);
        f.moved_by = static_cast<float>(number % 97) / 16;
        for (VkCommandPool pool : f.pools) ASSERT_EQ(vkResetCommandPool(device_.handle, pool, 0), VK_SUCCESS);
        record_animation(f, omission);
        record_evaluation(f, omission);
        record_consumption(f);
        if (engine_.queues.size() == 1) {  // in order, with barriers alone
            submit(f.commands, engine_.queues[0], {}, 0, {}, f.done);
        } else {
            const std::span<const VkCommandBuffer> all(f.commands);
            submit(all.subspan(0, 1), engine_.queues[0], {}, 0, f.ready[0], VK_NULL_HANDLE);
            const VkSemaphore points_ready = omission != Omission::wait ? f.ready[0] : VK_NULL_HANDLE;
            submit(all.subspan(1, 1), engine_.queues[1], points_ready, kKernelReads.stages, f.ready[1], VK_NULL_HANDLE);
            submit(all.subspan(2, 1), engine_.queues[0], f.ready[1], kCopyReads.stages, {}, f.done);
        }
        f.is_submitted = true;
    }
    void finish_all() {
        for (FrameInFlight& f : frames_) finish(f);
    }
    uint32_t checked_count() const { return checked_; }

  private:
    QueueTransfer to_compute() const { return {engine_.families.front(), engine_.families.back()}; }
    QueueTransfer from_compute() const { return {engine_.families.back(), engine_.families.front()}; }

    void create_vulkan_objects(FrameInFlight& f) {
        for (size_t p = 0; p < 2; ++p) {
            VkCommandPoolCreateInfo pool = {};
            pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
            pool.queueFamilyIndex = p == 0 ? engine_.families.front() : engine_.families.back();
            ASSERT_EQ(vkCreateCommandPool(device_.handle, &pool, nullptr, &f.pools[p]), VK_SUCCESS);
        }
        for (size_t c = 0; c < 3; ++c) {
            VkCommandBufferAllocateInfo allocate = {};
            allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
            allocate.commandPool = f.pools[c == 1 ? 1 : 0];
            allocate.commandBufferCount = 1;
            ASSERT_EQ(vkAllocateCommandBuffers(device_.handle, &allocate, &f.commands[c]), VK_SUCCESS);
        }
        VkSemaphoreCreateInfo semaphore = {};
        semaphore.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
        for (VkSemaphore& s : f.ready) ASSERT_EQ(vkCreateSemaphore(device_.handle, &semaphore, nullptr, &s), VK_SUCCESS);
        VkFenceCreateInfo fence = {};
        fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
        ASSERT_EQ(vkCreateFence(device_.handle, &fence, nullptr, &f.done), VK_SUCCESS);
    }

    static void begin(VkCommandBuffer commands) {
        VkCommandBufferBeginInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
        info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
        ASSERT_EQ(vkBeginCommandBuffer(commands, &info), VK_SUCCESS);
    }

    void record_animation(const FrameInFlight& f, Omission omission) const {
        const VkCommandBuffer commands = f.commands[0];
        std::vector<float> control = tables_.control;
        for (size_t i = 0; i < control.size(); i += 3) control[i] += f.moved_by;
        begin(commands);
        vkCmdUpdateBuffer(commands, f.surface->points.handle, 0, control.size() * 4, control.data());
        if (omission != Omission::release)
            record_barriers(commands, {release_barrier(f.surface->points.handle, to_compute(), kCopyWrites)});
        ASSERT_EQ(vkEndCommandBuffer(commands), VK_SUCCESS);
    }

    /// The buffers that the first queue reads.
    static std::array<VkBuffer, 3> outputs_of(const SceneFrame& surface) {
        return {surface.vertices.handle, surface.indices.handle, surface.command.handle};
    }

    void record_evaluation(const FrameInFlight& f, Omission omission) const {
        const VkCommandBuffer commands = f.commands[1];
        begin(commands);
        if (omission != Omission::acquire)
            record_barriers(commands, {acquire_barrier(f.surface->points.handle, to_compute(), kKernelReads | kKernelWrites)});
        ASSERT_TRUE(f.surface->record(device_, commands, false));
        std::vector<VkBufferMemoryBarrier2> releases;
        for (const VkBuffer buffer : outputs_of(*f.surface))
            releases.push_back(release_barrier(buffer, from_compute(), kKernelWrites));
        record_barriers(commands, releases);
        ASSERT_EQ(vkEndCommandBuffer(commands), VK_SUCCESS);
    }

    void record_consumption(const FrameInFlight& f) const {
        const VkCommandBuffer commands = f.commands[2];
        begin(commands);
        std::vector<VkBufferMemoryBarrier2> acquires;
        for (const VkBuffer buffer : outputs_of(*f.surface))
            acquires.push_back(acquire_barrier(buffer, from_compute(), kCopyReads));
        record_barriers(commands, acquires);
        const VkBufferCopy command = {0, 0, 20}, vertex = {0, 20, 12};
        vkCmdCopyBuffer(commands, f.surface->command.handle, f.readback.handle, 1, &command);
        vkCmdCopyBuffer(commands, f.surface->vertices.handle, f.readback.handle, 1, &vertex);
        record_barriers(commands, {}, {memory_barrier(kCopyWrites, kHostReads)});
        ASSERT_EQ(vkEndCommandBuffer(commands), VK_SUCCESS);
    }

    static void submit(std::span<const VkCommandBuffer> commands, VkQueue queue, VkSemaphore wait, VkPipelineStageFlags wait_stages,
                       VkSemaphore signal, VkFence fence) {
        VkSubmitInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        info.waitSemaphoreCount = wait != VK_NULL_HANDLE ? 1 : 0;
        info.pWaitSemaphores = &wait;
        info.pWaitDstStageMask = &wait_stages;
        info.commandBufferCount = static_cast<uint32_t>(commands.size());
        info.pCommandBuffers = commands.data();
        info.signalSemaphoreCount = signal != VK_NULL_HANDLE ? 1 : 0;
        info.pSignalSemaphores = &signal;
        ASSERT_EQ(vkQueueSubmit(queue, 1, &info, fence), VK_SUCCESS);
    }

    /// The surface moves with its control points.
    void finish(FrameInFlight& f) {
        if (!f.is_submitted) return;
        ASSERT_EQ(vkWaitForFences(device_.handle, 1, &f.done, VK_TRUE, ~uint64_t{0}), VK_SUCCESS);
        ASSERT_EQ(vkResetFences(device_.handle, 1, &f.done), VK_SUCCESS);
        f.is_submitted = false;
        VkDrawIndexedIndirectCommand command;
        float vertex[3];
        std::memcpy(&command, f.readback.mapped(), sizeof command);
        std::memcpy(vertex, static_cast<const std::byte*>(f.readback.mapped()) + 20, sizeof vertex);
        ASSERT_GT(command.indexCount, 100u);
        if (checked_++ == 0) first_x_ = vertex[0] - f.moved_by;
        ASSERT_NEAR(vertex[0] - f.moved_by, first_x_, 1e-5);
    }

    Engine& engine_;
    const Device& device_;
    const SceneTables& tables_;
    FrameInFlight frames_[kFramesInFlight];
    uint32_t checked_ = 0;
    float first_x_ = 0;
};

/// On two families or one.
class FramesTest : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        engine_.emplace(test::EngineOptions{.two_families = GetParam()});
        ASSERT_TRUE(engine_->is_ready());
        ASSERT_EQ(engine_->families.size(), GetParam() ? 2u : 1u);
        arena_.emplace(engine_->handles, true);
        engine_->handles.allocator = arena_->allocator();
        auto borrowed = Context::borrow(engine_->handles);
        ASSERT_TRUE(borrowed) << borrowed.error().message;
        context_.emplace(std::move(*borrowed));
        tables_ = test::build_scene();
        auto kernels = SceneKernels::create(context_->device());
        auto setup = Commands::begin(context_->device());
        ASSERT_TRUE(kernels && setup);
        kernels_.emplace(std::move(*kernels));
        auto upload = SceneUpload::record(context_->device(), *setup, tables_);
        ASSERT_TRUE(upload && setup->submit_and_wait());
        upload_.emplace(std::move(*upload));
        frames_.emplace(*engine_, context_->device(), tables_);
        ASSERT_TRUE(frames_->create(*kernels_, *upload_));
    }
    void TearDown() override {
        frames_.reset();
        upload_.reset();
        kernels_.reset();
        context_.reset();
        arena_.reset();
    }

    std::optional<Engine> engine_;
    std::optional<Arena> arena_;
    std::optional<Context> context_;
    SceneTables tables_;
    std::optional<SceneKernels> kernels_;
    std::optional<SceneUpload> upload_;
    std::optional<Frames> frames_;
};
INSTANTIATE_TEST_SUITE_P(Queues, FramesTest, testing::Bool(),
                         [](const auto& info) { return std::string(info.param ? "Two" : "One"); });

TEST_P(FramesTest, RunByTheThousandInConstantMemory) {
    frames_->run_frame(0);
    const int allocations = arena_->allocation_count();
    const uint64_t bytes = arena_->live_bytes(MemoryUse::device);
    for (uint32_t number = 1; number < kFrameCount && !HasFatalFailure(); ++number) frames_->run_frame(number);
    frames_->finish_all();
    EXPECT_EQ(frames_->checked_count(), kFrameCount);
    EXPECT_EQ(arena_->allocation_count(), allocations);
    EXPECT_EQ(arena_->live_bytes(MemoryUse::device), bytes);
    EXPECT_EQ(engine_->message_count(), 0u) << engine_->first_message();
}

// Synchronization validation of this time compares commands of one command buffer only, so that what is missing between
// queues shows where the bookkeeping of queue families and semaphores does not add up: of an acquire and of a wait that is
// the next frame with the same objects. Within one family there is nothing to transfer.
TEST_P(FramesTest, ValidationSeesWhatIsForgottenBetweenFamilies) {
    uint32_t seen = 0;
    for (const Omission omission : {Omission::release, Omission::acquire, Omission::wait}) {
        for (uint32_t number = 0; number < 2 * kFramesInFlight; ++number) frames_->run_frame(number, omission);
        frames_->finish_all();
        EXPECT_EQ(engine_->message_count() > seen, GetParam()) << static_cast<int>(omission);
        seen = engine_->message_count();
    }
}

}  // namespace
}  // namespace limn::vk
