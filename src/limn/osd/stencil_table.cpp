#include "limn/osd/stencil_table.h"

namespace limn::osd {

Result<vk::DeviceStencilTable> VkStencilTable::upload(const StencilTable& table, VkDeviceContext& context) {
    vk::DeviceStencilTable out;
    const bool done = context.Execute([&](VkCommandBuffer commands) -> Result<VkDeviceContext::Held> {
        auto uploaded = vk::record_stencil_table_upload(context.GetDevice(), commands, table);
        if (!uploaded) return uploaded.error();
        out = std::move(uploaded->table);
        return VkDeviceContext::Held(std::make_shared<const vk::Buffer>(std::move(uploaded->staging)));
    });
    if (!done) return context.GetError();
    return out;
}

VkStencilTable* VkStencilTable::create(Result<StencilTable> first, Result<StencilTable>* second,
                                       VkDeviceContext* context) {
    std::unique_ptr<VkStencilTable> out(new VkStencilTable);
    const auto put = [&](const Result<StencilTable>& rows, vk::DeviceStencilTable& table) {
        if (!rows) return context->Fail(rows.error());
        auto uploaded = upload(*rows, *context);
        if (!uploaded) return false;
        table = std::move(*uploaded);
        return true;
    };
    if (!put(first, out->table_) || (second != nullptr && !put(*second, out->second_))) {
        context->Synchronize();
        return nullptr;
    }
    out->context_ = context;
    return out.release();
}

template <class Real>
VkStencilTable* VkStencilTable::create_limit(const Far::LimitStencilTableReal<Real>* table,
                                             VkDeviceContext* context) {
    if (table == nullptr || context == nullptr) return nullptr;
    auto first = convert_limit_stencil_table(*table, StencilWeights::first);
    if (table->GetDuuWeights().empty()) return create(std::move(first), nullptr, context);
    auto second = convert_limit_stencil_table(*table, StencilWeights::second);
    return create(std::move(first), &second, context);
}

VkStencilTable* VkStencilTable::Create(const Far::StencilTable* table, VkDeviceContext* context) {
    if (table == nullptr || context == nullptr) return nullptr;
    return create(convert_stencil_table<float>(*table), nullptr, context);
}

VkStencilTable* VkStencilTable::Create(const Far::StencilTableReal<double>* table, VkDeviceContext* context) {
    if (table == nullptr || context == nullptr) return nullptr;
    return create(convert_stencil_table<double>(*table), nullptr, context);
}

VkStencilTable* VkStencilTable::Create(const Far::LimitStencilTable* table, VkDeviceContext* context) {
    return create_limit<float>(table, context);
}

VkStencilTable* VkStencilTable::Create(const Far::LimitStencilTableReal<double>* table,
                                       VkDeviceContext* context) {
    return create_limit<double>(table, context);
}

VkStencilTable::~VkStencilTable() {
    if (context_ == nullptr) return;
    context_->ForgetHandle(reinterpret_cast<uintptr_t>(&table_));
    context_->ForgetHandle(reinterpret_cast<uintptr_t>(&second_));
}

}  // namespace limn::osd
