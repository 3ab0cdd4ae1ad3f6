// limn in an engine: memory known beforehand and only from the engine's allocator, every failure an Error that leaves
// nothing behind, recording that does nothing but record, threads, a pipeline cache.
#include "vulkan/engine.h"

#include <vulkan/vulkan.h>

#include <cstdlib>
#include <cstring>
#include <thread>

#include "limn/vulkan/retirement.h"
#include "vulkan/engine_scene.h"

namespace limn::vk {
namespace {

using test::Arena;
using test::Engine;
using test::kSceneSamples;
using test::kSceneTriangles;
using test::kSceneVertices;
using test::Objects;
using test::SceneFrame;
using test::SceneKernels;
using test::SceneTables;
using test::SceneUpload;

const SceneTables& scene() {
    static const SceneTables tables = test::build_scene();
    return tables;
}

class EngineTest : public testing::Test {
  protected:
    void SetUp() override { begin(true); }
    void begin(bool map_device_memory) {
        engine_.emplace();
        ASSERT_TRUE(engine_->is_ready());
        arena_.emplace(engine_->handles, map_device_memory);
        Objects::reset();
        engine_->handles.allocator = arena_->allocator();
        engine_->handles.get_device_proc_addr = test::get_counted_proc_addr;
        auto borrowed = Context::borrow(engine_->handles);
        ASSERT_TRUE(borrowed) << borrowed.error().message;
        context_.emplace(std::move(*borrowed));
    }
    void TearDown() override {
        context_.reset();
        if (!arena_) return;
        EXPECT_EQ(Objects::live, 0);
        EXPECT_EQ(Objects::live_pipelines, 0);
        EXPECT_EQ(engine_->message_count(), 0u) << engine_->first_message();
        arena_.reset();
    }
    const Device& device() const { return context_->device(); }

    std::optional<Engine> engine_;
    std::optional<Arena> arena_;
    std::optional<Context> context_;
};
/// Device memory mapped, or not mapped.
class EngineMemory : public EngineTest, public testing::WithParamInterface<bool> {
  protected:
    void SetUp() override { begin(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(DeviceMemory, EngineMemory, testing::Bool(),
                         [](const auto& info) { return std::string(info.param ? "Mapped" : "Staged"); });

uint64_t bytes_of(std::span<const Buffer> buffers) {
    uint64_t sum = 0;
    for (const Buffer& buffer : buffers) sum += buffer.size_bytes;
    return sum;
}

TEST_P(EngineMemory, UploadsTakeWhatIsSaid) {
    const bool staged = !GetParam();
    const auto check = [&](const char* name, const Result<MemoryNeed>& need, auto&& upload, uint64_t staging_bytes) {
        ASSERT_TRUE(need && upload) << name;
        EXPECT_EQ(need->device_bytes, upload->table.bytes()) << name;
        EXPECT_EQ(staged ? need->staging_bytes : 0, staging_bytes) << name;
        EXPECT_EQ(arena_->live_count(), static_cast<int>(need->buffer_count * (staged ? 2 : 1))) << name;
        EXPECT_GE(arena_->live_bytes(MemoryUse::device), need->device_bytes) << name;
        EXPECT_LT(arena_->live_bytes(MemoryUse::device), need->device_bytes + 64 * need->buffer_count) << name;
    };
    const SceneTables& t = scene();
    {
        const auto commands = Commands::begin(device());
        auto upload = record_patch_table_upload(device(), *commands, t.patches);
        check("patches", upload_memory(t.patches), upload, bytes_of(upload->staging));
    }
    {
        const auto commands = Commands::begin(device());
        auto upload = record_grid_table_upload(device(), *commands, t.grid);
        check("grid", upload_memory(device(), t.grid), upload, bytes_of(upload->staging));
    }
    {
        const auto commands = Commands::begin(device());
        auto upload = record_patch_trees_upload(device(), *commands, t.sample_trees);
        check("trees", upload_memory(device(), t.sample_trees), upload, bytes_of(upload->staging));
    }
    {
        const auto commands = Commands::begin(device());
        auto upload = record_tessellation_table_upload(device(), *commands, t.topology, t.trees);
        check("tessellation", upload_memory(device(), t.topology, t.trees), upload, bytes_of(upload->staging));
    }
    {
        const auto commands = Commands::begin(device());
        const StencilTable table = build_point_table(t.patches);
        auto upload = record_stencil_table_upload(device(), *commands, table);
        check("stencils", upload_memory(table), upload, upload->staging.size_bytes);
    }
}

TEST_F(EngineTest, EvaluationsTakeWhatIsSaid) {
    auto kernels = SceneKernels::create(device());
    auto commands = Commands::begin(device());
    ASSERT_TRUE(kernels && commands);
    const auto tables = SceneUpload::record(device(), *commands, scene());
    ASSERT_TRUE(tables);
    const int before = arena_->live_count();
    auto frame = SceneFrame::create(device(), *kernels, *tables);
    ASSERT_TRUE(frame) << frame.error().message;
    const MemoryNeed tessellation = tessellation_memory({.table = &scene().topology, .vertices = &scene().trees});
    EXPECT_EQ(frame->tessellation.state_bytes(), tessellation.device_bytes);
    const MemoryNeed samples = sample_memory(device(), kSceneSamples, 9);
    EXPECT_EQ(arena_->live_count() - before, static_cast<int>(7 + tessellation.buffer_count + samples.buffer_count));
    const uint64_t with_samples = arena_->live_bytes(MemoryUse::device);
    frame->sampled = *kernels->surfaces.prepare_locations({.patches = &tables->patches,
                                                           .samples = {frame->samples.handle, 0, kSceneSamples},
                                                           .places = {.buffer = frame->results.handle, .stride = 5}});
    const uint64_t taken = with_samples - arena_->live_bytes(MemoryUse::device);
    EXPECT_GE(taken, samples.device_bytes);
    EXPECT_LT(taken, samples.device_bytes + 64);
}

TEST_P(EngineMemory, EveryFailedAllocationIsAnError) {
    auto kernels = SceneKernels::create(device());
    ASSERT_TRUE(kernels);
    const auto make = [&]() -> Result<void> {
        auto commands = Commands::begin(device());
        if (!commands) return commands.error();
        auto tables = SceneUpload::record(device(), *commands, scene());
        if (!tables) return tables.error();
        auto frame = SceneFrame::create(device(), *kernels, *tables);
        if (!frame) return frame.error();
        return {};
    };
    const int objects = Objects::live;
    int failures = 0;
    for (;; ++failures) {  // memory
        arena_->fail_after(failures);
        const auto made = make();
        EXPECT_EQ(arena_->live_count(), 0);
        EXPECT_EQ(Objects::live, objects);
        if (made) break;
        ASSERT_EQ(made.error().code, ErrorCode::out_of_memory) << failures;
        ASSERT_EQ(made.error().vk_result, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    }
    EXPECT_GE(failures, GetParam() ? 17 : 25);
    arena_->fail_after(-1);
    int object_failures = 0;
    for (;; ++object_failures) {  // Vulkan objects, pipelines among them
        Objects::until_failure = object_failures;
        const auto made = make();
        EXPECT_EQ(arena_->live_count(), 0);
        EXPECT_EQ(Objects::live, objects);
        if (made) break;
        ASSERT_FALSE(made.error().message.empty());
        ASSERT_LT(made.error().vk_result, 0);
    }
    Objects::until_failure = -1;
    EXPECT_GT(object_failures, 60);
}

TEST_F(EngineTest, EveryFailedKernelIsAnError) {
    int failures = 0;
    for (;; ++failures) {
        Objects::until_failure = failures;
        const auto kernels = SceneKernels::create(device());
        if (kernels) break;
        EXPECT_EQ(Objects::live, 0);
        ASSERT_EQ(kernels.error().code, ErrorCode::out_of_memory);
    }
    Objects::until_failure = -1;
    EXPECT_GT(failures, 60);
}

void record_control(const Device& device, VkCommandBuffer commands, const SceneFrame& frame) {
    vkCmdUpdateBuffer(commands, frame.points.handle, 0, scene().control.size() * 4, scene().control.data());
    const float samples[3 * kSceneSamples] = {0, 0.5f, 0.5f};  // of face 0: as an integer, its bits are zero
    vkCmdUpdateBuffer(commands, frame.samples.handle, 0, sizeof samples, samples);
    record_barrier(device, commands, kCopyWrites, kKernelReads);
}
std::vector<float> read_vertices(const Device& device, const SceneFrame& frame) {
    const auto values = download<float>(device, frame.vertices, 6 * kSceneVertices);
    const auto samples = download<float>(device, frame.results, 9 * kSceneSamples);
    const auto command = download<uint32_t>(device, frame.command, 5);
    EXPECT_TRUE(values && samples && command);
    EXPECT_GT((*command)[0], 100u);
    std::vector<float> out(values->begin(), values->begin() + 6 * 26);  // rate 2: corners, edges, faces
    out.insert(out.end(), samples->begin(), samples->end());
    return out;
}

TEST_F(EngineTest, RecordsIntoPrimaryAndSecondaryAndDoesNothingElse) {
    auto kernels = SceneKernels::create(device());
    auto setup = Commands::begin(device());
    ASSERT_TRUE(kernels && setup);
    const auto tables = SceneUpload::record(device(), *setup, scene());
    ASSERT_TRUE(tables && setup->submit_and_wait());
    auto first = SceneFrame::create(device(), *kernels, *tables), second = SceneFrame::create(device(), *kernels, *tables);
    ASSERT_TRUE(first && second);

    VkCommandPoolCreateInfo pool_info = {};
    pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool_info.queueFamilyIndex = device().queue_family_index;
    VkCommandPool pool = VK_NULL_HANDLE;
    ASSERT_EQ(vkCreateCommandPool(device().handle, &pool_info, nullptr, &pool), VK_SUCCESS);
    VkCommandBufferAllocateInfo allocate = {};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_SECONDARY;
    allocate.commandBufferCount = 1;
    VkCommandBuffer secondary = VK_NULL_HANDLE;
    ASSERT_EQ(vkAllocateCommandBuffers(device().handle, &allocate, &secondary), VK_SUCCESS);
    VkCommandBufferInheritanceInfo inheritance = {};
    inheritance.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_INHERITANCE_INFO;
    VkCommandBufferBeginInfo begin = {};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.pInheritanceInfo = &inheritance;
    ASSERT_EQ(vkBeginCommandBuffer(secondary, &begin), VK_SUCCESS);
    auto commands = Commands::begin(device());
    ASSERT_TRUE(commands);

    const int created = Objects::created, allocated = arena_->allocation_count(), touched = Objects::mapped_or_submitted;
    record_control(device(), *commands, *first);
    ASSERT_TRUE(first->record(device(), *commands, true));
    record_control(device(), secondary, *second);
    ASSERT_TRUE(second->record(device(), secondary, true));
    EXPECT_EQ(Objects::created, created);
    EXPECT_EQ(arena_->allocation_count(), allocated);
    EXPECT_EQ(Objects::mapped_or_submitted, touched);

    ASSERT_EQ(vkEndCommandBuffer(secondary), VK_SUCCESS);
    vkCmdExecuteCommands(*commands, 1, &secondary);
    ASSERT_TRUE(commands->submit_and_wait());
    const auto by_primary = read_vertices(device(), *first), by_secondary = read_vertices(device(), *second);
    EXPECT_EQ(by_primary, by_secondary);
    EXPECT_NE(by_primary[0], 0);
    vkDestroyCommandPool(device().handle, pool, nullptr);
}

TEST_F(EngineTest, ThreadsPrepareAndRecordAtOnce) {
    auto kernels = SceneKernels::create(device());
    auto setup = Commands::begin(device());
    ASSERT_TRUE(kernels && setup);
    const auto tables = SceneUpload::record(device(), *setup, scene());
    ASSERT_TRUE(tables && setup->submit_and_wait());
    constexpr size_t kThreads = 4;
    std::vector<std::optional<SceneFrame>> frames(kThreads);
    std::vector<std::optional<Commands>> commands(kThreads);
    std::vector<std::thread> threads;
    for (size_t t = 0; t < kThreads; ++t)
        threads.emplace_back([&, t] {
            for (int repeat = 0; repeat < 3; ++repeat) {  // the last stays
                commands[t].reset();
                auto frame = SceneFrame::create(device(), *kernels, *tables);
                auto begun = Commands::begin(device());
                ASSERT_TRUE(frame && begun);
                frames[t].emplace(std::move(*frame));
                commands[t].emplace(std::move(*begun));
                record_control(device(), *commands[t], *frames[t]);
                ASSERT_TRUE(frames[t]->record(device(), *commands[t], true));
            }
        });
    for (std::thread& thread : threads) thread.join();
    std::vector<float> expected;
    for (size_t t = 0; t < kThreads; ++t) {
        ASSERT_TRUE(commands[t] && commands[t]->submit_and_wait());
        const auto values = read_vertices(device(), *frames[t]);
        if (t == 0) expected = values;
        EXPECT_EQ(values, expected) << t;
    }
}

TEST_F(EngineTest, PipelinesAreMadeWithTheCallersCache) {
    VkPipelineCacheCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
    VkPipelineCache cache = VK_NULL_HANDLE;
    ASSERT_EQ(vkCreatePipelineCache(device().handle, &info, nullptr, &cache), VK_SUCCESS);
    BorrowedHandles handles = engine_->handles;
    handles.pipeline_cache = cache;
    {
        const auto context = Context::borrow(handles);
        ASSERT_TRUE(context);
        size_t before = 0, after = 0;
        ASSERT_EQ(vkGetPipelineCacheData(device().handle, cache, &before, nullptr), VK_SUCCESS);
        auto kernels = SceneKernels::create(context->device());
        auto commands = Commands::begin(context->device());
        ASSERT_TRUE(kernels && commands);
        const auto tables = SceneUpload::record(context->device(), *commands, scene());
        ASSERT_TRUE(tables && SceneFrame::create(context->device(), *kernels, *tables));
        EXPECT_GT(Objects::live_pipelines, 10);
        EXPECT_EQ(Objects::pipeline_cache.load(), cache);
        ASSERT_EQ(vkGetPipelineCacheData(device().handle, cache, &after, nullptr), VK_SUCCESS);
        RecordProperty("cache_bytes", std::to_string(before) + " -> " + std::to_string(after));
        EXPECT_GE(after, before);  // drivers may keep what they like
    }
    vkDestroyPipelineCache(device().handle, cache, nullptr);
}

/// Counts what Vulkan takes from the host for limn's objects.
struct HostMemory {
    std::atomic<int> live = 0, total = 0;
    VkAllocationCallbacks callbacks() {
        VkAllocationCallbacks out = {};
        out.pUserData = this;
        out.pfnAllocation = [](void* user, size_t size, size_t alignment, VkSystemAllocationScope) -> void* {
            ++static_cast<HostMemory*>(user)->live;
            ++static_cast<HostMemory*>(user)->total;
            return std::aligned_alloc(std::max(alignment, sizeof(void*)), (size + alignment - 1) / alignment * alignment);
        };
        out.pfnReallocation = [](void*, void*, size_t, size_t, VkSystemAllocationScope) -> void* { return nullptr; };
        out.pfnFree = [](void* user, void* memory) {
            if (memory != nullptr) --static_cast<HostMemory*>(user)->live;
            std::free(memory);
        };
        return out;
    }
};

TEST(HostAllocator, IsUsedForAllObjects) {
    Engine engine({.validation = false});  // which allocates for itself
    ASSERT_TRUE(engine.is_ready());
    HostMemory memory;
    const VkAllocationCallbacks callbacks = memory.callbacks();
    engine.handles.host_allocator = &callbacks;
    {
        const auto context = Context::borrow(engine.handles);
        ASSERT_TRUE(context);
        auto kernels = SceneKernels::create(context->device());
        auto commands = Commands::begin(context->device());
        ASSERT_TRUE(kernels && commands);
        const auto tables = SceneUpload::record(context->device(), *commands, scene());
        ASSERT_TRUE(tables && SceneFrame::create(context->device(), *kernels, *tables));
        EXPECT_GT(memory.live, 40);
    }
    EXPECT_EQ(memory.live, 0);
}

/// Validation takes commands for unfinished until it has seen a wait. The host sees in mapped memory that they are finished,
/// so that destruction then is a mistake, but does no harm.
TEST(Retirement, SparesWhatIsInFlight) {
    for (const bool retire : {false, true}) {
        Engine engine;
        ASSERT_TRUE(engine.is_ready());
        const auto context = Context::borrow(engine.handles);
        ASSERT_TRUE(context);
        const Device& device = context->device();
        auto buffer = create_buffer(device, 64, kPointUsage, MemoryUse::device);
        auto marker = create_buffer(device, 4, kPointUsage, MemoryUse::readback);
        auto commands = Commands::begin(device);
        ASSERT_TRUE(buffer && marker && commands);
        const volatile uint32_t* const mark = static_cast<uint32_t*>(marker->mapped());
        *static_cast<uint32_t*>(marker->mapped()) = 0;
        vkCmdFillBuffer(*commands, buffer->handle, 0, 64, 7);
        record_barrier(device, *commands, kCopyWrites, kCopyWrites);
        vkCmdFillBuffer(*commands, marker->handle, 0, 4, 7);
        record_barrier(device, *commands, kCopyWrites, kHostReads);
        ASSERT_EQ(vkEndCommandBuffer(*commands), VK_SUCCESS);
        const VkCommandBuffer handle = *commands;
        VkSubmitInfo submit = {};
        submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &handle;
        ASSERT_EQ(vkQueueSubmit(engine.handles.queue, 1, &submit, VK_NULL_HANDLE), VK_SUCCESS);
        while (*mark != 7) std::this_thread::yield();
        Retirement retirement;
        if (retire) {
            retirement.retire(7, std::move(*buffer));
            EXPECT_EQ(retirement.collect(6), 0u);
            vkDeviceWaitIdle(device.handle);
            EXPECT_EQ(retirement.collect(7), 1u);
        } else {
            *buffer = Buffer();
            vkDeviceWaitIdle(device.handle);
        }
        EXPECT_EQ(engine.message_count() == 0, retire) << engine.first_message();
    }
}

}  // namespace
}  // namespace limn::vk
