// Devices made and borrowed, validation that counts, buffers, and the comparison helper itself.
#include <vulkan/vulkan.h>

#include <algorithm>

#include "limn/vulkan/evaluator.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk {
namespace {

using test::DevicePoints;
using test::HostPoints;
using test::points_match;

TEST(Comparison, AcceptsEqualPoints) {
    EXPECT_TRUE(points_match({{1, 2, 3, 4}, 2}, {{9, 1, 2, 9, 3, 4}, 1, 3}, 0));
}

TEST(Comparison, RejectsOnePerturbedPoint) {
    HostPoints host = {std::vector<double>(3000, 0.5), 3};
    const DevicePoints device = {std::vector<float>(3000, 0.5f), 0, 3};
    EXPECT_TRUE(points_match(host, device, 1e-6));
    host.values[1234] += 1e-5;
    EXPECT_FALSE(points_match(host, device, 1e-6));
}

TEST(Comparison, RejectsNanMissingAndNoPoints) {
    EXPECT_FALSE(points_match({{1}, 1}, {{std::nanf("")}, 0, 1}, 1e9));
    EXPECT_FALSE(points_match({{1, 2}, 1}, {{1}, 0, 1}, 1e9));
    EXPECT_FALSE(points_match({{}, 3}, {{}, 0, 3}, 1e9));
}

TEST(Context, ListsDevices) {
    const auto devices = list_devices();
    ASSERT_TRUE(devices) << devices.error().message;
    EXPECT_TRUE(
        std::any_of(devices->begin(), devices->end(), [](const DeviceInfo& info) { return info.usable; }));
    for (uint32_t i = 0; i < devices->size(); ++i) {
        EXPECT_EQ((*devices)[i].index, i);
        EXPECT_FALSE((*devices)[i].name.empty());
    }
}

TEST(Context, SelectsByIndexAndRefusesOthers) {
    const auto devices = list_devices();
    ASSERT_TRUE(devices) << devices.error().message;
    for (const DeviceInfo& info : *devices) {
        if (!info.usable) continue;
        const auto context = Context::create({.device_index = info.index});
        ASSERT_TRUE(context) << context.error().message;
        EXPECT_EQ(context->device().name(), info.name);
    }
    const auto missing = Context::create({.device_index = static_cast<uint32_t>(devices->size())});
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::no_device);
}

TEST(Context, SelectsTheCpu) {
    const auto devices = list_devices();
    ASSERT_TRUE(devices) << devices.error().message;
    const bool has_cpu = std::any_of(devices->begin(), devices->end(), [](const DeviceInfo& info) {
        return info.usable && info.type == VK_PHYSICAL_DEVICE_TYPE_CPU;
    });
    const auto context = Context::create({.device_index = kCpuDevice});
    ASSERT_EQ(context.has_value(), has_cpu);
    if (!has_cpu) return;
    EXPECT_EQ(context->device().properties.deviceType, VK_PHYSICAL_DEVICE_TYPE_CPU);
}

TEST(Context, CanBeMoved) {
    auto created = Context::create();
    ASSERT_TRUE(created) << created.error().message;
    const Device* const device = &created->device();
    Context moved = std::move(*created);
    EXPECT_EQ(&moved.device(), device);
    auto other = Context::create();
    ASSERT_TRUE(other);
    moved = std::move(*other);
    EXPECT_TRUE(create_buffer(moved.device(), 64, kPointUsage, MemoryUse::device));
}

TEST(Validation, CountsMessages) {
    const auto context = Context::create({.validation = true});
    ASSERT_TRUE(context) << context.error().message;
    EXPECT_EQ(context->validation_message_count(), 0u) << context->first_validation_message();
    (void)create_buffer(context->device(), 64, 0, MemoryUse::device);  // a buffer without any usage
    EXPECT_GT(context->validation_message_count(), 0u);
    EXPECT_NE(context->first_validation_message().find("usage"), std::string::npos);
}

TEST(Validation, SeesMissingBarriers) {
    const auto context = Context::create({.validation = true});
    ASSERT_TRUE(context) << context.error().message;
    const Device& device = context->device();
    const auto buffer = create_point_buffer(device, std::vector<float>(64));
    ASSERT_TRUE(buffer);
    const auto commands = Commands::begin(device);
    ASSERT_TRUE(commands);
    const VkBufferCopy region = {0, 128, 128};
    device.functions.CmdCopyBuffer(*commands, buffer->handle, buffer->handle, 1, &region);
    record_barrier(device, *commands, kCopyWrites, kCopyWrites);
    device.functions.CmdCopyBuffer(*commands, buffer->handle, buffer->handle, 1, &region);
    EXPECT_EQ(context->validation_message_count(), 0u) << context->first_validation_message();
    device.functions.CmdCopyBuffer(*commands, buffer->handle, buffer->handle, 1, &region);
    EXPECT_GT(context->validation_message_count(), 0u);
}

class Buffers : public test::VulkanTest {};

TEST_F(Buffers, KeepWhatIsWritten) {
    const std::vector<float> values = {1, 2, 3, 4, 5, 6, 7};
    auto created = create_point_buffer(device(), values);
    ASSERT_TRUE(created) << created.error().message;
    Buffer buffer = std::move(*created);
    EXPECT_EQ(buffer.size_bytes, 28u);
    const float more[2] = {8, 9};
    ASSERT_TRUE(upload_bytes(device(), buffer, 8, std::as_bytes(std::span(more))));
    const auto read = download<float>(device(), buffer, 6, 4);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, (std::vector<float>{2, 8, 9, 5, 6, 7}));
}

TEST_F(Buffers, MapUploadAndReadbackMemory) {
    for (const MemoryUse use : {MemoryUse::upload, MemoryUse::readback}) {
        const auto buffer = create_buffer(device(), 0, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, use);
        ASSERT_TRUE(buffer) << buffer.error().message;
        EXPECT_NE(buffer->mapped(), nullptr);
    }
}

TEST_F(Buffers, FailWhenMemoryRunsOut) {
    const auto buffer = create_buffer(device(), VkDeviceSize{1} << 46, kPointUsage, MemoryUse::device);
    EXPECT_FALSE(buffer);
}

/// A device as an engine would make it, without limn.
class Borrowed : public testing::Test {
  protected:
    void SetUp() override {
        VkApplicationInfo application = {};
        application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
        application.apiVersion = VK_API_VERSION_1_2;
        VkInstanceCreateInfo instance = {};
        instance.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
        instance.pApplicationInfo = &application;
        ASSERT_EQ(vkCreateInstance(&instance, nullptr, &handles_.instance), VK_SUCCESS);
        uint32_t count = 1;
        ASSERT_GE(vkEnumeratePhysicalDevices(handles_.instance, &count, &handles_.physical_device),
                  VK_SUCCESS);
        ASSERT_EQ(count, 1u);
        const float priority = 1;
        VkDeviceQueueCreateInfo queue = {};
        queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
        queue.queueCount = 1;
        queue.pQueuePriorities = &priority;
        VkDeviceCreateInfo device = {};
        device.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
        device.queueCreateInfoCount = 1;
        device.pQueueCreateInfos = &queue;
        ASSERT_EQ(vkCreateDevice(handles_.physical_device, &device, nullptr, &handles_.device), VK_SUCCESS);
        VkPipelineCacheCreateInfo cache = {};
        cache.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
        ASSERT_EQ(vkCreatePipelineCache(handles_.device, &cache, nullptr, &handles_.pipeline_cache),
                  VK_SUCCESS);
        vkGetDeviceQueue(handles_.device, 0, 0, &handles_.queue);
        handles_.get_instance_proc_addr = vkGetInstanceProcAddr;
    }
    void TearDown() override {
        if (handles_.device != VK_NULL_HANDLE) {
            vkDestroyPipelineCache(handles_.device, handles_.pipeline_cache, nullptr);
            vkDestroyDevice(handles_.device, nullptr);
        }
        if (handles_.instance != VK_NULL_HANDLE) vkDestroyInstance(handles_.instance, nullptr);
    }

    BorrowedHandles handles_;
};

/// The points of one row: twice the first point minus the second one.
void evaluate_on(const Device& device) {
    StencilTable table;
    table.source_count = 2;
    table.offsets.allocate(2), table.indices.allocate(2), table.weights.allocate(2);
    table.offsets[0] = 0, table.offsets[1] = 2;
    table.indices[0] = 0, table.indices[1] = 1;
    table.weights[0] = 2, table.weights[1] = -1;
    const auto evaluator = Evaluator::create(device);
    ASSERT_TRUE(evaluator) << evaluator.error().message;
    const auto source = create_point_buffer(device, std::vector<float>{1, 2, 3, 4, 5, 7});
    const auto destination = create_point_buffer(device, std::vector<float>(3));
    auto commands = Commands::begin(device);
    ASSERT_TRUE(source && destination && commands);
    const auto upload = record_stencil_table_upload(device, *commands, table);
    ASSERT_TRUE(upload) << upload.error().message;
    const auto evaluation = evaluator->prepare({.table = &upload->table,
                                                .source = {.buffer = source->handle},
                                                .destination = {.buffer = destination->handle}});
    ASSERT_TRUE(evaluation) << evaluation.error().message;
    evaluation->record(*commands);
    ASSERT_TRUE(commands->submit_and_wait());
    const auto result = download<float>(device, *destination, 3);
    ASSERT_TRUE(result);
    EXPECT_EQ(*result, (std::vector<float>{-2, -1, -1}));
}

TEST_F(Borrowed, DeviceEvaluates) {
    const auto context = Context::borrow(handles_);
    ASSERT_TRUE(context) << context.error().message;
    EXPECT_EQ(context->device().handle, handles_.device);
    EXPECT_EQ(context->device().instance, handles_.instance);
    evaluate_on(context->device());
}

/// Suballocates from one piece of memory that the caller owns, as engines do.
struct Arena {
    static constexpr VkDeviceSize kSize = 1 << 20;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::byte* mapped = nullptr;
    VkDeviceSize used = 0;
    int live = 0;

    static VkResult allocate(void* user, const VkMemoryRequirements& requirements, MemoryUse use,
                             MemoryBlock* block) {
        Arena& arena = *static_cast<Arena*>(user);
        arena.used =
            (arena.used + requirements.alignment - 1) / requirements.alignment * requirements.alignment;
        // Device memory is not mapped, so that uploads go through staging.
        *block = {arena.memory, arena.used, use == MemoryUse::device ? nullptr : arena.mapped + arena.used,
                  user};
        arena.used += requirements.size;
        ++arena.live;
        return arena.used <= kSize ? VK_SUCCESS : VK_ERROR_OUT_OF_DEVICE_MEMORY;
    }
    static void free(void* user, const MemoryBlock&) { --static_cast<Arena*>(user)->live; }
};

TEST_F(Borrowed, MemoryComesFromTheCaller) {
    VkPhysicalDeviceMemoryProperties properties;
    vkGetPhysicalDeviceMemoryProperties(handles_.physical_device, &properties);
    constexpr VkMemoryPropertyFlags kHost =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryAllocateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    info.allocationSize = Arena::kSize;
    while ((properties.memoryTypes[info.memoryTypeIndex].propertyFlags & kHost) != kHost)
        ++info.memoryTypeIndex;
    Arena arena;
    ASSERT_EQ(vkAllocateMemory(handles_.device, &info, nullptr, &arena.memory), VK_SUCCESS);
    void* mapped = nullptr;
    ASSERT_EQ(vkMapMemory(handles_.device, arena.memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
    arena.mapped = static_cast<std::byte*>(mapped);
    handles_.allocator = {&arena, Arena::allocate, Arena::free};
    {
        const auto context = Context::borrow(handles_);
        ASSERT_TRUE(context) << context.error().message;
        evaluate_on(context->device());
    }
    EXPECT_GT(arena.used, 0u);
    EXPECT_EQ(arena.live, 0);
    vkFreeMemory(handles_.device, arena.memory, nullptr);
}

TEST_F(Borrowed, HandlesMustBeComplete) {
    BorrowedHandles handles = handles_;
    handles.device = VK_NULL_HANDLE;
    const auto context = Context::borrow(handles);
    ASSERT_FALSE(context);
    EXPECT_EQ(context.error().code, ErrorCode::invalid_argument);
}

TEST_F(Borrowed, NothingIsSubmittedWithoutAQueue) {
    handles_.queue = VK_NULL_HANDLE;
    const auto context = Context::borrow(handles_);
    ASSERT_TRUE(context) << context.error().message;
    EXPECT_FALSE(Commands::begin(context->device()));
}

}  // namespace
}  // namespace limn::vk
