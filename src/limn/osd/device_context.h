// What limn's counterparts of OpenSubdiv's Osd classes run on: OpenSubdiv's DEVICE_CONTEXT.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "limn/osd/patch_evaluator.h"

namespace limn::osd {

/// A device, and where its commands go. Classes named after OpenSubdiv's follow its conventions: pointers
/// that the caller deletes, null or false on failure. Why is in GetError().
///
/// Submitting, as OpenSubdiv's other back ends do: every UpdateData and Eval... is submitted to
/// Device::queue, in order, with barriers to and from what else runs on that queue; VkEvaluator::Synchronize
/// waits. Queue access is the caller's to synchronise.
///
/// Recording: after SetCommandBuffer everything goes into that command buffer, outside a render pass, each
/// step after a barrier from kernel and copy writes before it. Nothing is submitted, nothing waits. Owed
/// after: a barrier from vk::kKernelWrites to what reads the results.
///
/// What an Eval... needs bound is prepared at its first call and found again by its arguments: a frame that
/// repeats those of the last one allocates nothing on the device. To be used by one thread at a time; must
/// outlive all that is made with it.
class VkDeviceContext {
  public:
    /// `device` must outlive the context. Null never: kernels are made when first needed.
    static VkDeviceContext* Create(const vk::Device& device);
    ~VkDeviceContext();
    VkDeviceContext(const VkDeviceContext&) = delete;
    VkDeviceContext& operator=(const VkDeviceContext&) = delete;

    const vk::Device& GetDevice() const { return device_; }

    /// Records into `commands`, which has just been begun, hence is not pending: what its last recording
    /// needed is let go. VK_NULL_HANDLE: submits again.
    void SetCommandBuffer(VkCommandBuffer commands);
    VkCommandBuffer GetCommandBuffer() const { return commands_; }

    /// Lets go of what was recorded into `commands`: call it before they are freed, when they have completed.
    void Release(VkCommandBuffer commands);

    /// Lets go of what was prepared with a buffer of the caller's own: call it before that is destroyed.
    /// Vertex buffers and tables of limn::osd do so themselves. Waits for what has been submitted.
    void Forget(VkBuffer buffer);

    /// Waits for all that has been submitted. False: the device is lost.
    bool Synchronize();

    /// Why the last call that failed did so.
    const Error& GetError() const { return error_; }

    // For the classes of limn::osd.

    using Held = std::shared_ptr<const void>;
    /// Records what `record` does, and keeps what it returns until the device is done with it.
    bool Execute(const std::function<Result<Held>(VkCommandBuffer)>& record);
    bool Fail(Error error);
    bool EvalStencils(const vk::StencilEvaluationInfo& info);
    bool EvalPatches(const PatchEvaluationInfo& info);
    /// `handle` is a table or buffer among the arguments of evaluations.
    void ForgetHandle(uint64_t handle);

  private:
    struct Submission;
    using Key = std::vector<uint64_t>;

    explicit VkDeviceContext(const vk::Device& device);
    Result<Submission*> begin_submission();
    Result<void> end_submission(Submission& submission);
    Result<Held> prepare_stencils(const vk::StencilEvaluationInfo& info);
    Result<Held> prepare_patches(const PatchEvaluationInfo& info);
    void keep(const Key& key, Held evaluation);

    const vk::Device& device_;
    std::unique_ptr<vk::Evaluator> stencils_;
    std::unique_ptr<PatchEvaluator> patches_;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    std::map<Key, Held> evaluations_;
    std::map<VkCommandBuffer, std::vector<Held>> recorded_;
    std::vector<std::unique_ptr<Submission>> submissions_;
    Error error_;
};

}  // namespace limn::osd
