// Osd::GLPatchTable on Vulkan.
#pragma once

#include "limn/osd/device_context.h"

namespace limn::osd {

/// A Far patch table, varying and face-varying patches included, in device memory: arrays, indices and params
/// are bit for bit those of Osd::CpuPatchTable.
class VkPatchTable {
  public:
    using VertexBufferBinding = VkBuffer;  ///< what Osd::Mesh asks for

    /// Null on failure. The Far table may be deleted afterwards.
    static VkPatchTable* Create(const Far::PatchTable* table, VkDeviceContext* context);
    /// As ~VkVertexBuffer.
    ~VkPatchTable();
    VkPatchTable(const VkPatchTable&) = delete;
    VkPatchTable& operator=(const VkPatchTable&) = delete;

    const Osd::PatchArrayVector& GetPatchArrays() const { return table_.vertex.arrays; }
    VkBuffer GetPatchIndexBuffer() const { return table_.vertex.indices.handle; }
    VkBuffer GetPatchParamBuffer() const { return table_.vertex.params.handle; }

    const Osd::PatchArrayVector& GetVaryingPatchArrays() const { return table_.varying.arrays; }
    VkBuffer GetVaryingPatchIndexBuffer() const { return table_.varying.indices.handle; }

    /// Channels in [0, GetNumFVarChannels()).
    int GetNumFVarChannels() const { return static_cast<int>(table_.face_varying.size()); }
    const Osd::PatchArrayVector& GetFVarPatchArrays(int channel = 0) const { return fvar(channel).arrays; }
    VkBuffer GetFVarPatchIndexBuffer(int channel = 0) const { return fvar(channel).indices.handle; }
    VkBuffer GetFVarPatchParamBuffer(int channel = 0) const { return fvar(channel).params.handle; }

    /// For limn::osd::PatchEvaluator.
    const DevicePatchTable& GetTable() const { return table_; }
    VkDeviceContext* GetDeviceContext() const { return context_; }

  private:
    VkPatchTable() = default;
    const DevicePatches& fvar(int channel) const { return table_.face_varying[static_cast<size_t>(channel)]; }
    void forget(const DevicePatches& patches) const;

    VkDeviceContext* context_ = nullptr;
    DevicePatchTable table_;
};

}  // namespace limn::osd
