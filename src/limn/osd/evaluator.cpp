#include "limn/osd/evaluator.h"

namespace limn::osd {
namespace {

Error bad_descriptors() {
    return {ErrorCode::invalid_argument, "buffer descriptors are not valid, or differ in length"};
}

bool is_usable(const BufferDescriptor& desc, int length) {
    return desc.IsValid() && desc.offset >= 0 && desc.length == length;
}

vk::PointBuffer points_of(const BoundPoints& points) {
    return {points.buffer, 0, static_cast<uint64_t>(points.desc.offset),
            static_cast<uint32_t>(points.desc.stride)};
}

/// All buffers that are not null have points of the source's length.
bool agree(const BoundPoints& src, const BoundPoints (&outputs)[6]) {
    if (!is_usable(src.desc, src.desc.length)) return false;
    for (const BoundPoints& output : outputs)
        if (output.buffer != VK_NULL_HANDLE && !is_usable(output.desc, src.desc.length)) return false;
    return true;
}

bool any(const BoundPoints (&outputs)[6], size_t begin, size_t end) {
    for (size_t d = begin; d < end; ++d)
        if (outputs[d].buffer != VK_NULL_HANDLE) return true;
    return false;
}

}  // namespace

VkEvaluator* VkEvaluator::Create(const BufferDescriptor& srcDesc, const BufferDescriptor& dstDesc,
                                 const BufferDescriptor& duDesc, const BufferDescriptor& dvDesc,
                                 VkDeviceContext* context) {
    return Create(srcDesc, dstDesc, duDesc, dvDesc, {}, {}, {}, context);
}

VkEvaluator* VkEvaluator::Create(const BufferDescriptor& srcDesc, const BufferDescriptor& dstDesc,
                                 const BufferDescriptor& duDesc, const BufferDescriptor& dvDesc,
                                 const BufferDescriptor& duuDesc, const BufferDescriptor& duvDesc,
                                 const BufferDescriptor& dvvDesc, VkDeviceContext* context) {
    auto evaluator = std::make_unique<VkEvaluator>();
    evaluator->context_ = context;
    if (evaluator->Compile(srcDesc, dstDesc, duDesc, dvDesc, duuDesc, duvDesc, dvvDesc))
        return evaluator.release();
    if (context != nullptr) context->Fail(bad_descriptors());
    return nullptr;
}

bool VkEvaluator::Compile(const BufferDescriptor& srcDesc, const BufferDescriptor& dstDesc,
                          const BufferDescriptor& duDesc, const BufferDescriptor& dvDesc,
                          const BufferDescriptor& duuDesc, const BufferDescriptor& duvDesc,
                          const BufferDescriptor& dvvDesc) {
    if (!is_usable(srcDesc, srcDesc.length) || !is_usable(dstDesc, srcDesc.length)) return false;
    for (const BufferDescriptor* desc : {&duDesc, &dvDesc, &duuDesc, &duvDesc, &dvvDesc})
        if (desc->length != 0 && !is_usable(*desc, srcDesc.length)) return false;
    return true;
}

bool VkEvaluator::Stencils(const BoundPoints& src, const BoundPoints (&outputs)[6],
                           const VkStencilTable* table, VkDeviceContext* context, int start, int end) {
    if (table == nullptr) return false;
    if (context == nullptr) context = table->GetDeviceContext();
    if (end < 0) end = table->GetNumStencils();
    if (start < 0 || end > table->GetNumStencils())
        return context->Fail({ErrorCode::index_out_of_range, "rows outside of a stencil table"});
    if (end <= start) return true;
    if (!agree(src, outputs)) return context->Fail(bad_descriptors());
    // Second derivatives are a table of their own, whose points are duu.
    if (any(outputs, 3, 6) && !table->HasSecondDerivatives())
        return context->Fail({ErrorCode::invalid_argument, "the stencil table has no second derivatives"});
    for (size_t first : {size_t{0}, size_t{3}}) {
        if (!any(outputs, first, first + 3)) continue;
        vk::StencilEvaluationInfo info;
        info.table = first == 0 ? &table->GetTable() : &table->GetSecondTable();
        info.width = static_cast<uint32_t>(src.desc.length);
        info.source = points_of(src);
        info.destination = points_of(outputs[first]);
        info.tangent1 = points_of(outputs[first + 1]);
        info.tangent2 = points_of(outputs[first + 2]);
        info.first_row = static_cast<uint32_t>(start);
        info.row_count = static_cast<uint32_t>(end - start);
        if (!context->EvalStencils(info)) return false;
    }
    return true;
}

bool VkEvaluator::Patches(Primvar primvar, int fvarChannel, const BoundPoints& src,
                          const BoundPoints (&outputs)[6], int numPatchCoords, VkBuffer patchCoords,
                          const VkPatchTable* table, VkDeviceContext* context) {
    if (table == nullptr) return false;
    if (context == nullptr) context = table->GetDeviceContext();
    if (numPatchCoords <= 0) return numPatchCoords == 0;
    if (!agree(src, outputs)) return context->Fail(bad_descriptors());
    PatchEvaluationInfo info;
    info.patches =
        fvarChannel < 0 ? nullptr : table->GetTable().find(primvar, static_cast<uint32_t>(fvarChannel));
    info.width = static_cast<uint32_t>(src.desc.length);
    info.source = points_of(src);
    info.coords = patchCoords;
    info.coord_count = static_cast<uint32_t>(numPatchCoords);
    for (size_t d = 0; d < 6; ++d) info.outputs[d] = points_of(outputs[d]);
    return context->EvalPatches(info);
}

}  // namespace limn::osd
