#include "limn/osd/device_context.h"

#include <algorithm>

namespace limn::osd {
namespace {

constexpr size_t kMostEvaluations = 256;

constexpr VkPipelineStageFlags kOurStages =
    VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
constexpr VkAccessFlags kOurWrites = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
constexpr vk::StageAccess kOurs = {kOurStages,
                                   kOurWrites | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT};
constexpr vk::StageAccess kOurResults = {kOurStages, kOurWrites};
constexpr vk::StageAccess kOthers = {VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                                     VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};

template <class Handle>
uint64_t word_of(Handle handle) {
    if constexpr (std::is_pointer_v<Handle>)
        return reinterpret_cast<uintptr_t>(handle);
    else
        return static_cast<uint64_t>(handle);
}

void add_points(std::vector<uint64_t>& key, const vk::PointBuffer& points) {
    key.insert(key.end(), {word_of(points.buffer), points.offset_bytes, points.first, points.stride});
}

std::vector<uint64_t> key_of(const vk::StencilEvaluationInfo& info) {
    std::vector<uint64_t> key = {word_of(info.table), info.width, info.first_row, info.row_count};
    for (const auto* points : {&info.source, &info.destination, &info.tangent1, &info.tangent2})
        add_points(key, *points);
    return key;
}

std::vector<uint64_t> key_of(const PatchEvaluationInfo& info) {
    std::vector<uint64_t> key = {word_of(info.patches), info.width, word_of(info.coords), info.coord_count};
    add_points(key, info.source);
    for (const vk::PointBuffer& points : info.outputs) add_points(key, points);
    return key;
}

}  // namespace

/// A command buffer that is submitted by itself.
struct VkDeviceContext::Submission {
    const vk::Device* device = nullptr;
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    bool pending = false;
    std::vector<Held> held;

    ~Submission() {
        if (fence != VK_NULL_HANDLE) device->functions.DestroyFence(device->handle, fence, device->host_allocator);
        if (pool != VK_NULL_HANDLE) device->functions.DestroyCommandPool(device->handle, pool, device->host_allocator);
    }

    static Result<std::unique_ptr<Submission>> create(const vk::Device& device) {
        auto out = std::make_unique<Submission>();
        out->device = &device;
        VkCommandPoolCreateInfo pool = {};
        pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
        pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
        pool.queueFamilyIndex = device.queue_family_index;
        VkResult result = device.functions.CreateCommandPool(device.handle, &pool, device.host_allocator, &out->pool);
        if (result != VK_SUCCESS) return vk::vulkan_error("vkCreateCommandPool", result);
        VkCommandBufferAllocateInfo allocate = {};
        allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
        allocate.commandPool = out->pool;
        allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        allocate.commandBufferCount = 1;
        result = device.functions.AllocateCommandBuffers(device.handle, &allocate, &out->commands);
        if (result != VK_SUCCESS) return vk::vulkan_error("vkAllocateCommandBuffers", result);
        VkFenceCreateInfo fence = {};
        fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
        result = device.functions.CreateFence(device.handle, &fence, device.host_allocator, &out->fence);
        if (result != VK_SUCCESS) return vk::vulkan_error("vkCreateFence", result);
        return out;
    }

    /// Whether the device is done with it, waiting for that up to `nanoseconds`. What it held is then let go.
    VkResult wait(uint64_t nanoseconds) {
        if (!pending) return VK_SUCCESS;
        const VkResult result =
            device->functions.WaitForFences(device->handle, 1, &fence, VK_TRUE, nanoseconds);
        if (result != VK_SUCCESS) return result;
        pending = false;
        held.clear();
        return device->functions.ResetFences(device->handle, 1, &fence);
    }
};

VkDeviceContext* VkDeviceContext::Create(const vk::Device& device) {
    return new VkDeviceContext(device);
}

VkDeviceContext::VkDeviceContext(const vk::Device& device) : device_(device) {}

VkDeviceContext::~VkDeviceContext() {
    Synchronize();
}

void VkDeviceContext::SetCommandBuffer(VkCommandBuffer commands) {
    commands_ = commands;
    Release(commands);
}

void VkDeviceContext::Release(VkCommandBuffer commands) {
    recorded_.erase(commands);
}

void VkDeviceContext::Forget(VkBuffer buffer) {
    ForgetHandle(word_of(buffer));
}

/// A number that happens to equal the handle costs an evaluation that is prepared again.
void VkDeviceContext::ForgetHandle(uint64_t handle) {
    Synchronize();
    std::erase_if(evaluations_, [&](const auto& entry) {
        return std::find(entry.first.begin(), entry.first.end(), handle) != entry.first.end();
    });
}

bool VkDeviceContext::Synchronize() {
    for (const auto& submission : submissions_)
        if (const VkResult result = submission->wait(~uint64_t{0}); result != VK_SUCCESS)
            return Fail(vk::vulkan_error("vkWaitForFences", result));
    return true;
}

bool VkDeviceContext::Fail(Error error) {
    error_ = std::move(error);
    return false;
}

Result<VkDeviceContext::Submission*> VkDeviceContext::begin_submission() {
    if (device_.queue == VK_NULL_HANDLE)
        return Error{
            ErrorCode::invalid_argument,
            "the device was borrowed without a queue, and there is no command buffer to record into"};
    Submission* idle = nullptr;
    for (const auto& submission : submissions_)
        if (submission->wait(0) == VK_SUCCESS) idle = submission.get();
    if (idle == nullptr) {
        auto created = Submission::create(device_);
        if (!created) return created.error();
        submissions_.push_back(std::move(*created));
        idle = submissions_.back().get();
    }
    VkCommandBufferBeginInfo begin = {};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    const VkResult result = device_.functions.BeginCommandBuffer(idle->commands, &begin);
    if (result != VK_SUCCESS) return vk::vulkan_error("vkBeginCommandBuffer", result);
    return idle;
}

Result<void> VkDeviceContext::end_submission(Submission& submission) {
    VkResult result = device_.functions.EndCommandBuffer(submission.commands);
    if (result != VK_SUCCESS) return vk::vulkan_error("vkEndCommandBuffer", result);
    VkSubmitInfo submit = {};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &submission.commands;
    result = device_.functions.QueueSubmit(device_.queue, 1, &submit, submission.fence);
    if (result != VK_SUCCESS) return vk::vulkan_error("vkQueueSubmit", result);
    submission.pending = true;
    return {};
}

bool VkDeviceContext::Execute(const std::function<Result<Held>(VkCommandBuffer)>& record) {
    if (commands_ != VK_NULL_HANDLE) {
        vk::record_barrier(device_, commands_, kOurResults, kOurs);
        auto held = record(commands_);
        if (!held) return Fail(held.error());
        recorded_[commands_].push_back(std::move(*held));
        return true;
    }
    auto submission = begin_submission();
    if (!submission) return Fail(submission.error());
    vk::record_barrier(device_, (*submission)->commands, kOthers, kOurs);
    auto held = record((*submission)->commands);
    if (!held) {
        device_.functions.EndCommandBuffer((*submission)->commands);  // to be begun anew
        return Fail(held.error());
    }
    (*submission)->held.push_back(std::move(*held));
    vk::record_barrier(device_, (*submission)->commands, kOurResults, kOthers);
    if (auto ended = end_submission(**submission); !ended) return Fail(ended.error());
    return true;
}

void VkDeviceContext::keep(const Key& key, Held evaluation) {
    if (evaluations_.size() >= kMostEvaluations) evaluations_.clear();  // those in use are held elsewhere
    evaluations_[key] = std::move(evaluation);
}

Result<VkDeviceContext::Held> VkDeviceContext::prepare_stencils(const vk::StencilEvaluationInfo& info) {
    const Key key = key_of(info);
    if (const auto found = evaluations_.find(key); found != evaluations_.end()) return found->second;
    if (stencils_ == nullptr) {
        auto created = vk::Evaluator::create(device_);
        if (!created) return created.error();
        stencils_ = std::make_unique<vk::Evaluator>(std::move(*created));
    }
    auto prepared = stencils_->prepare(info);
    if (!prepared) return prepared.error();
    Held held = std::make_shared<const vk::StencilEvaluation>(std::move(*prepared));
    keep(key, held);
    return held;
}

Result<VkDeviceContext::Held> VkDeviceContext::prepare_patches(const PatchEvaluationInfo& info) {
    const Key key = key_of(info);
    if (const auto found = evaluations_.find(key); found != evaluations_.end()) return found->second;
    if (patches_ == nullptr) {
        auto created = PatchEvaluator::create(device_);
        if (!created) return created.error();
        patches_ = std::make_unique<PatchEvaluator>(std::move(*created));
    }
    auto prepared = patches_->prepare(info);
    if (!prepared) return prepared.error();
    Held held = std::make_shared<const PatchEvaluation>(std::move(*prepared));
    keep(key, held);
    return held;
}

bool VkDeviceContext::EvalStencils(const vk::StencilEvaluationInfo& info) {
    auto prepared = prepare_stencils(info);
    if (!prepared) return Fail(prepared.error());
    return Execute([&](VkCommandBuffer commands) -> Result<Held> {
        static_cast<const vk::StencilEvaluation*>(prepared->get())->record(commands);
        return *prepared;
    });
}

bool VkDeviceContext::EvalPatches(const PatchEvaluationInfo& info) {
    auto prepared = prepare_patches(info);
    if (!prepared) return Fail(prepared.error());
    return Execute([&](VkCommandBuffer commands) -> Result<Held> {
        static_cast<const PatchEvaluation*>(prepared->get())->record(commands);
        return *prepared;
    });
}

}  // namespace limn::osd
