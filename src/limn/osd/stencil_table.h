// Osd::GLStencilTableSSBO on Vulkan.
#pragma once

#include "limn/osd/device_context.h"

namespace limn::osd {

/// A Far stencil table, limit stencils and their derivatives included, in device memory.
class VkStencilTable {
  public:
    /// Null on failure. The Far table may be deleted afterwards. Weights in double are rounded to float.
    static VkStencilTable* Create(const Far::StencilTable* table, VkDeviceContext* context);
    static VkStencilTable* Create(const Far::LimitStencilTable* table, VkDeviceContext* context);
    static VkStencilTable* Create(const Far::StencilTableReal<double>* table, VkDeviceContext* context);
    static VkStencilTable* Create(const Far::LimitStencilTableReal<double>* table, VkDeviceContext* context);
    /// As ~VkVertexBuffer.
    ~VkStencilTable();
    VkStencilTable(const VkStencilTable&) = delete;
    VkStencilTable& operator=(const VkStencilTable&) = delete;

    int GetNumStencils() const { return static_cast<int>(table_.row_count); }
    bool HasFirstDerivatives() const { return table_.has_tangents; }
    bool HasSecondDerivatives() const { return second_.has_tangents; }

    /// For limn::vk::Evaluator: points, and du and dv as tangents.
    const vk::DeviceStencilTable& GetTable() const { return table_; }
    /// duu, and duv and dvv as tangents; empty without second derivatives.
    const vk::DeviceStencilTable& GetSecondTable() const { return second_; }
    VkDeviceContext* GetDeviceContext() const { return context_; }

  private:
    VkStencilTable() = default;
    static VkStencilTable* create(Result<StencilTable> first, Result<StencilTable>* second,
                                  VkDeviceContext* context);
    static Result<vk::DeviceStencilTable> upload(const StencilTable& table, VkDeviceContext& context);
    template <class Real>
    static VkStencilTable* create_limit(const Far::LimitStencilTableReal<Real>* table,
                                        VkDeviceContext* context);

    VkDeviceContext* context_ = nullptr;
    vk::DeviceStencilTable table_, second_;
};

}  // namespace limn::osd
