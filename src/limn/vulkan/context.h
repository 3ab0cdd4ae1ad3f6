// Where kernels run: a Vulkan device, limn's own (create) or the caller's (borrow). limn links no Vulkan
// library: every function comes through vkGetInstanceProcAddr into a plain table.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "limn/result.h"

namespace limn::vk {

// clang-format off
#define LIMN_VK_INSTANCE_FUNCTIONS(X) \
    X(EnumeratePhysicalDevices) X(GetPhysicalDeviceProperties) X(GetPhysicalDeviceMemoryProperties) \
    X(GetPhysicalDeviceFormatProperties) X(GetPhysicalDeviceQueueFamilyProperties) X(CreateDevice) \
    X(GetDeviceProcAddr)

#define LIMN_VK_DEVICE_FUNCTIONS(X) \
    X(DestroyDevice) X(GetDeviceQueue) X(QueueSubmit) X(DeviceWaitIdle) \
    X(AllocateMemory) X(FreeMemory) X(MapMemory) X(UnmapMemory) \
    X(CreateBuffer) X(DestroyBuffer) X(GetBufferMemoryRequirements) X(BindBufferMemory) \
    X(CreateBufferView) X(DestroyBufferView) \
    X(CreateShaderModule) X(DestroyShaderModule) X(CreateComputePipelines) X(DestroyPipeline) \
    X(CreatePipelineLayout) X(DestroyPipelineLayout) X(CreateDescriptorSetLayout) X(DestroyDescriptorSetLayout) \
    X(CreateDescriptorPool) X(DestroyDescriptorPool) X(AllocateDescriptorSets) X(UpdateDescriptorSets) \
    X(CreateCommandPool) X(DestroyCommandPool) X(AllocateCommandBuffers) X(BeginCommandBuffer) X(EndCommandBuffer) \
    X(CreateFence) X(DestroyFence) X(ResetFences) X(WaitForFences) \
    X(CreateQueryPool) X(DestroyQueryPool) X(GetQueryPoolResults) \
    X(CmdBindPipeline) X(CmdBindDescriptorSets) X(CmdPushConstants) X(CmdDispatch) X(CmdDispatchIndirect) X(CmdDraw) \
    X(CmdPipelineBarrier) X(CmdCopyBuffer) X(CmdFillBuffer) X(CmdResetQueryPool) X(CmdWriteTimestamp)
// clang-format on

/// functions.CmdDispatch is vkCmdDispatch, and so on.
struct Functions {
    PFN_vkGetInstanceProcAddr GetInstanceProcAddr = nullptr;
#define LIMN_VK_DECLARE(name) PFN_vk##name name = nullptr;
    LIMN_VK_INSTANCE_FUNCTIONS(LIMN_VK_DECLARE)
    LIMN_VK_DEVICE_FUNCTIONS(LIMN_VK_DECLARE)
#undef LIMN_VK_DECLARE
};

enum class MemoryUse : uint8_t {
    device,    ///< kernels read and write it
    upload,    ///< the host writes, the device reads; mapped and coherent
    readback,  ///< the device writes, the host reads; mapped and coherent
};

/// A piece of device memory. `mapped` is where the host sees its first byte: never null for upload and
/// readback, may be null for device; memory that is mapped is coherent.
struct MemoryBlock {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    void* mapped = nullptr;
    void* user = nullptr;  ///< the allocator's own
};

/// Where buffers get their memory, all of it: limn makes no VkDeviceMemory and no image of its own beside this. The
/// default makes one vkAllocateMemory for each buffer; a caller may put its own allocator here, with a block at an offset
/// that is a multiple of requirements.alignment, of a type in requirements.memoryTypeBits. Both functions are called from
/// the thread that calls limn: from several at once where the caller prepares, uploads or destroys in several.
struct Allocator {
    void* user = nullptr;
    VkResult (*allocate)(void* user, const VkMemoryRequirements& requirements, MemoryUse use,
                         MemoryBlock* block) = nullptr;
    void (*free)(void* user, const MemoryBlock& block) = nullptr;
};

/// Everything that limn::vk needs to know of a device. Handles are never limn's to destroy through this
/// struct. Read only, and so for all threads at once; but one thread at a time may submit to `queue`.
struct Device {
    Functions functions;
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice handle = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;  ///< null when borrowed without one: then nothing here can submit
    uint32_t queue_family_index = 0;
    VkPipelineCache pipeline_cache = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties = {};
    VkPhysicalDeviceMemoryProperties memory_properties = {};
    Allocator allocator;
    const VkAllocationCallbacks* host_allocator = nullptr;

    const char* name() const { return properties.deviceName; }
    /// The host shares memory with it: staging copies are waste.
    bool has_host_memory() const {
        return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU ||
               properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    }
};

/// The Error for a failed Vulkan call: out_of_memory or vulkan_failure.
Error vulkan_error(const char* call, VkResult result);

/// One line of `limn devices`.
struct DeviceInfo {
    uint32_t index = 0;  ///< what ContextOptions::device_index takes
    std::string name;
    VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
    uint32_t api_version = 0;  ///< VK_API_VERSION_MAJOR and so on take it apart
    uint32_t driver_version = 0;
    bool usable = false;  ///< Vulkan 1.2 and a compute queue
};

/// Errors: no_device when there is no Vulkan loader or no device at all, vulkan_failure.
Result<std::vector<DeviceInfo>> list_devices();

inline constexpr uint32_t kAutomaticDevice = ~uint32_t{0};  ///< first discrete GPU, else integrated, else any
inline constexpr uint32_t kCpuDevice = ~uint32_t{0} - 1;    ///< first device of type CPU

struct ContextOptions {
    uint32_t device_index = kAutomaticDevice;  ///< an index of list_devices(), kAutomaticDevice or kCpuDevice
    bool validation = false;  ///< VK_LAYER_KHRONOS_validation with synchronization validation
};

/// The caller's device, made with Vulkan 1.2 or later; no feature or extension needs to be enabled. limn
/// destroys none of these and submits nothing unless `queue` is given and a function that says it submits is
/// called. Functions that do say so: the uploads without record_ in their names, upload_bytes, download_bytes, download,
/// create_point_buffer, Commands. All others only make objects or record, into primary and secondary command buffers of
/// queue_family_index or of any other family that supports compute.
struct BorrowedHandles {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    uint32_t queue_family_index = 0;  ///< of the command buffers that will be recorded into; supports compute
    PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;  ///< the only way in: limn links no loader
    PFN_vkGetDeviceProcAddr get_device_proc_addr = nullptr;      ///< optional: else what the instance gives
    VkPipelineCache pipeline_cache = VK_NULL_HANDLE;             ///< optional: all pipelines are made with it
    VkQueue queue = VK_NULL_HANDLE;                              ///< optional
    Allocator allocator;                                   ///< optional: the default when its functions are null
    const VkAllocationCallbacks* host_allocator = nullptr;  ///< optional: of every Vulkan object; outlives the Context
};

/// Owns (create) or refers to (borrow) a device. Must outlive all that is made from its device(); moving it
/// does not move the Device.
class Context {
  public:
    /// A headless instance, device and queue.
    /// Errors: no_device (no loader, no such index, none that is usable), unsupported (validation asked for
    /// and the layer is not installed), vulkan_failure.
    static Result<Context> create(const ContextOptions& options = {});

    /// Errors: invalid_argument (a handle is null), unsupported (older than Vulkan 1.2), vulkan_failure (a
    /// function is missing).
    static Result<Context> borrow(const BorrowedHandles& handles);

    Context(Context&&) noexcept;
    Context& operator=(Context&&) noexcept;
    ~Context();

    const Device& device() const { return *device_; }

    /// Validation errors and warnings so far, and the text of the first. 0 and "" without validation.
    uint32_t validation_message_count() const;
    std::string first_validation_message() const;

  private:
    struct Owned;
    Context();
    std::unique_ptr<Device> device_;
    std::unique_ptr<Owned> owned_;  ///< null when borrowed
};

}  // namespace limn::vk
