// A device as an engine would make it, without limn: its own instance, layers, queues, allocator and function pointers,
// through which every object that limn makes is counted and can be made to fail.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "limn/vulkan/context.h"

namespace limn::vk::test {

/// Suballocates from large blocks, as engines do, and keeps account. Thread-safe.
class Arena {
  public:
    /// Device memory is mapped or not; where it is not, uploads are staged.
    Arena(const BorrowedHandles& handles, bool map_device_memory);
    ~Arena();
    Allocator allocator() { return {this, allocate, free}; }

    int allocation_count() const { return allocation_count_; }
    int live_count() const { return live_count_; }
    uint64_t live_bytes(MemoryUse use) const { return live_bytes_[static_cast<size_t>(use)]; }
    /// The allocation after this many more fails; negative: none does.
    void fail_after(int count) { until_failure_ = count; }

  private:
    struct Block {
        VkDeviceMemory memory;
        std::byte* mapped;
    };
    static VkResult allocate(void* user, const VkMemoryRequirements& requirements, MemoryUse use, MemoryBlock* block);
    static void free(void* user, const MemoryBlock& block);

    VkDevice device_;
    std::vector<Block> types_;  ///< a block for each memory type
    uint32_t host_types_ = 0;   ///< those that are visible and coherent
    bool map_device_memory_;
    std::mutex mutex_;
    struct Live {
        VkDeviceSize end;
        MemoryUse use;
    };
    std::map<std::pair<VkDeviceMemory, VkDeviceSize>, Live> live_;  ///< by where they begin
    std::atomic<int> allocation_count_ = 0, live_count_ = 0, until_failure_ = -1;
    std::atomic<uint64_t> live_bytes_[3] = {};
};

/// Vulkan objects that limn makes through the functions below: each creation may fail.
struct Objects {
    static std::atomic<int> live, live_pipelines, created;
    static std::atomic<int> until_failure;  ///< as Arena::fail_after
    static std::atomic<VkPipelineCache> pipeline_cache;  ///< of the last pipeline
    static std::atomic<int> mapped_or_submitted;  ///< calls of vkMapMemory, vkQueueSubmit and waits
    static void reset() { live = 0, live_pipelines = 0, created = 0, until_failure = -1, mapped_or_submitted = 0; }
};
/// vkGetDeviceProcAddr, but for functions that create, destroy, map, submit or wait.
PFN_vkVoidFunction VKAPI_PTR get_counted_proc_addr(VkDevice device, const char* name);

struct EngineOptions {
    bool validation = true;
    bool two_families = false;  ///< a second queue family for compute, through the layer two_queues where there is none
};

/// Instance, device and a queue of each family. Not movable.
class Engine {
  public:
    explicit Engine(const EngineOptions& options = {});
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    bool is_ready() const { return handles.device != VK_NULL_HANDLE; }
    uint32_t message_count() const { return message_count_; }
    const std::string& first_message() const { return first_message_; }

    BorrowedHandles handles;  ///< of the last family and its queue
    std::vector<uint32_t> families;
    std::vector<VkQueue> queues;

  private:
    static VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                  VkDebugUtilsMessageTypeFlagsEXT,
                                                  const VkDebugUtilsMessengerCallbackDataEXT* data, void* user);
    void create_instance(const EngineOptions& options, bool with_layer);
    void create_device(bool two_families);
    void destroy_instance();

    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    std::mutex mutex_;
    std::atomic<uint32_t> message_count_ = 0;
    std::string first_message_;
};

}  // namespace limn::vk::test
