#include "limn/osd/patch_table.h"

namespace limn::osd {

VkPatchTable* VkPatchTable::Create(const Far::PatchTable* table, VkDeviceContext* context) {
    if (table == nullptr || context == nullptr) return nullptr;
    std::unique_ptr<VkPatchTable> out(new VkPatchTable);
    const bool done = context->Execute([&](VkCommandBuffer commands) -> Result<VkDeviceContext::Held> {
        auto uploaded = record_patch_table_upload(context->GetDevice(), commands, *table);
        if (!uploaded) return uploaded.error();
        out->table_ = std::move(uploaded->table);
        return VkDeviceContext::Held(
            std::make_shared<const std::vector<vk::Buffer>>(std::move(uploaded->staging)));
    });
    if (!done) return nullptr;
    out->context_ = context;
    return out.release();
}

void VkPatchTable::forget(const DevicePatches& patches) const {
    context_->ForgetHandle(reinterpret_cast<uintptr_t>(&patches));
}

VkPatchTable::~VkPatchTable() {
    if (context_ == nullptr) return;
    forget(table_.vertex);
    forget(table_.varying);
    for (const DevicePatches& patches : table_.face_varying) forget(patches);
}

}  // namespace limn::osd
