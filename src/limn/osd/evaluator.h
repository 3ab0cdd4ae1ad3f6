// Osd::GLComputeEvaluator on Vulkan: stencils and patches, evaluated from OpenSubdiv's tables.
#pragma once

#include <opensubdiv/osd/bufferDescriptor.h>

#include "limn/osd/device_context.h"
#include "limn/osd/patch_table.h"
#include "limn/osd/stencil_table.h"
#include "limn/osd/vertex_buffer.h"

namespace limn::osd {

using Osd::BufferDescriptor;

/// A buffer and how points lie in it: component i of point p is float offset + p * stride + i.
struct BoundPoints {
    VkBuffer buffer = VK_NULL_HANDLE;
    BufferDescriptor desc = {};
};

/// As OpenSubdiv's evaluators: EvalStencils, EvalPatches, EvalPatchesVarying and EvalPatchesFaceVarying,
/// static and of an instance, for values, first and second derivatives; true on success. Buffers are of any
/// class with VkBuffer BindVkBuffer(VkDeviceContext*), made with vk::kSourceUsage where they are read.
/// Primvars have any length of 1 or more, the same in source and destinations; a destination that is null is
/// left out. Whether an Eval... submits or records is the context's to say (device_context.h); without one it
/// is that of the table. Instances hold nothing that a call without one would have to make: pipelines are the
/// context's.
class VkEvaluator {
  public:
    typedef bool Instantiatable;  ///< Osd::EvaluatorCacheT makes instances

    /// The context is kept: instance calls do without. Null when Compile fails.
    static VkEvaluator* Create(const BufferDescriptor& srcDesc, const BufferDescriptor& dstDesc,
                               const BufferDescriptor& duDesc, const BufferDescriptor& dvDesc,
                               VkDeviceContext* context = nullptr);
    static VkEvaluator* Create(const BufferDescriptor& srcDesc, const BufferDescriptor& dstDesc,
                               const BufferDescriptor& duDesc, const BufferDescriptor& dvDesc,
                               const BufferDescriptor& duuDesc, const BufferDescriptor& duvDesc,
                               const BufferDescriptor& dvvDesc, VkDeviceContext* context = nullptr);
    /// Whether these descriptors agree: source and destination valid, all lengths the same. Pipelines follow
    /// from tables, too, and are made at their first use.
    bool Compile(const BufferDescriptor& srcDesc, const BufferDescriptor& dstDesc,
                 const BufferDescriptor& duDesc = {}, const BufferDescriptor& dvDesc = {},
                 const BufferDescriptor& duuDesc = {}, const BufferDescriptor& duvDesc = {},
                 const BufferDescriptor& dvvDesc = {});

    // Stencils.

    template <class Src, class Dst>
    static bool EvalStencils(Src* src, const BufferDescriptor& srcDesc, Dst* dst,
                             const BufferDescriptor& dstDesc, const VkStencilTable* table,
                             const VkEvaluator* instance = nullptr, VkDeviceContext* context = nullptr) {
        const BoundPoints outputs[6] = {bind(dst, dstDesc)};
        return Stencils(bind(src, srcDesc), outputs, table, pick(context, instance));
    }
    template <class Src, class Dst>
    static bool EvalStencils(Src* src, const BufferDescriptor& srcDesc, Dst* dst,
                             const BufferDescriptor& dstDesc, Dst* du, const BufferDescriptor& duDesc,
                             Dst* dv, const BufferDescriptor& dvDesc, const VkStencilTable* table,
                             const VkEvaluator* instance = nullptr, VkDeviceContext* context = nullptr) {
        const BoundPoints outputs[6] = {bind(dst, dstDesc), bind(du, duDesc), bind(dv, dvDesc)};
        return Stencils(bind(src, srcDesc), outputs, table, pick(context, instance));
    }
    template <class Src, class Dst>
    static bool EvalStencils(Src* src, const BufferDescriptor& srcDesc, Dst* dst,
                             const BufferDescriptor& dstDesc, Dst* du, const BufferDescriptor& duDesc,
                             Dst* dv, const BufferDescriptor& dvDesc, Dst* duu,
                             const BufferDescriptor& duuDesc, Dst* duv, const BufferDescriptor& duvDesc,
                             Dst* dvv, const BufferDescriptor& dvvDesc, const VkStencilTable* table,
                             const VkEvaluator* instance = nullptr, VkDeviceContext* context = nullptr) {
        const BoundPoints outputs[6] = {bind(dst, dstDesc), bind(du, duDesc),   bind(dv, dvDesc),
                                        bind(duu, duuDesc), bind(duv, duvDesc), bind(dvv, dvvDesc)};
        return Stencils(bind(src, srcDesc), outputs, table, pick(context, instance));
    }
    /// Rows [start, end): row r goes to point r of each output, as in Far's UpdateValues with a range.
    /// outputs are the value, du, dv, duu, duv, dvv. Tables of unfactorized stencils are evaluated level by
    /// level in this way.
    static bool Stencils(const BoundPoints& src, const BoundPoints (&outputs)[6], const VkStencilTable* table,
                         VkDeviceContext* context = nullptr, int start = 0, int end = -1);

    // Patches. patchCoords holds numPatchCoords Osd::PatchCoord.

#define LIMN_OSD_EVAL_PATCHES(Name, primvar)                                                               \
    template <class Src, class Dst, class Coords>                                                          \
    static bool Name(Src* src, const BufferDescriptor& srcDesc, Dst* dst, const BufferDescriptor& dstDesc, \
                     int numPatchCoords, Coords* patchCoords, const VkPatchTable* table,                   \
                     const VkEvaluator* instance = nullptr, VkDeviceContext * context = nullptr) {         \
        const BoundPoints outputs[6] = {bind(dst, dstDesc)};                                               \
        return Patches(primvar, 0, bind(src, srcDesc), outputs, numPatchCoords, handle_of(patchCoords),    \
                       table, pick(context, instance));                                                    \
    }                                                                                                      \
    template <class Src, class Dst, class Coords>                                                          \
    static bool Name(Src* src, const BufferDescriptor& srcDesc, Dst* dst, const BufferDescriptor& dstDesc, \
                     Dst* du, const BufferDescriptor& duDesc, Dst* dv, const BufferDescriptor& dvDesc,     \
                     int numPatchCoords, Coords* patchCoords, const VkPatchTable* table,                   \
                     const VkEvaluator* instance = nullptr, VkDeviceContext * context = nullptr) {         \
        const BoundPoints outputs[6] = {bind(dst, dstDesc), bind(du, duDesc), bind(dv, dvDesc)};           \
        return Patches(primvar, 0, bind(src, srcDesc), outputs, numPatchCoords, handle_of(patchCoords),    \
                       table, pick(context, instance));                                                    \
    }                                                                                                      \
    template <class Src, class Dst, class Coords>                                                          \
    static bool Name(Src* src, const BufferDescriptor& srcDesc, Dst* dst, const BufferDescriptor& dstDesc, \
                     Dst* du, const BufferDescriptor& duDesc, Dst* dv, const BufferDescriptor& dvDesc,     \
                     Dst* duu, const BufferDescriptor& duuDesc, Dst* duv, const BufferDescriptor& duvDesc, \
                     Dst* dvv, const BufferDescriptor& dvvDesc, int numPatchCoords, Coords* patchCoords,   \
                     const VkPatchTable* table, const VkEvaluator* instance = nullptr,                     \
                     VkDeviceContext * context = nullptr) {                                                \
        const BoundPoints outputs[6] = {bind(dst, dstDesc), bind(du, duDesc),   bind(dv, dvDesc),          \
                                        bind(duu, duuDesc), bind(duv, duvDesc), bind(dvv, dvvDesc)};       \
        return Patches(primvar, 0, bind(src, srcDesc), outputs, numPatchCoords, handle_of(patchCoords),    \
                       table, pick(context, instance));                                                    \
    }
    LIMN_OSD_EVAL_PATCHES(EvalPatches, Primvar::vertex)
    LIMN_OSD_EVAL_PATCHES(EvalPatchesVarying, Primvar::varying)
#undef LIMN_OSD_EVAL_PATCHES

    template <class Src, class Dst, class Coords>
    static bool EvalPatchesFaceVarying(Src* src, const BufferDescriptor& srcDesc, Dst* dst,
                                       const BufferDescriptor& dstDesc, int numPatchCoords,
                                       Coords* patchCoords, const VkPatchTable* table, int fvarChannel = 0,
                                       const VkEvaluator* instance = nullptr,
                                       VkDeviceContext* context = nullptr) {
        const BoundPoints outputs[6] = {bind(dst, dstDesc)};
        return Patches(Primvar::face_varying, fvarChannel, bind(src, srcDesc), outputs, numPatchCoords,
                       handle_of(patchCoords), table, pick(context, instance));
    }
    template <class Src, class Dst, class Coords>
    static bool EvalPatchesFaceVarying(Src* src, const BufferDescriptor& srcDesc, Dst* dst,
                                       const BufferDescriptor& dstDesc, Dst* du,
                                       const BufferDescriptor& duDesc, Dst* dv,
                                       const BufferDescriptor& dvDesc, int numPatchCoords,
                                       Coords* patchCoords, const VkPatchTable* table, int fvarChannel = 0,
                                       const VkEvaluator* instance = nullptr,
                                       VkDeviceContext* context = nullptr) {
        const BoundPoints outputs[6] = {bind(dst, dstDesc), bind(du, duDesc), bind(dv, dvDesc)};
        return Patches(Primvar::face_varying, fvarChannel, bind(src, srcDesc), outputs, numPatchCoords,
                       handle_of(patchCoords), table, pick(context, instance));
    }
    template <class Src, class Dst, class Coords>
    static bool EvalPatchesFaceVarying(
        Src* src, const BufferDescriptor& srcDesc, Dst* dst, const BufferDescriptor& dstDesc, Dst* du,
        const BufferDescriptor& duDesc, Dst* dv, const BufferDescriptor& dvDesc, Dst* duu,
        const BufferDescriptor& duuDesc, Dst* duv, const BufferDescriptor& duvDesc, Dst* dvv,
        const BufferDescriptor& dvvDesc, int numPatchCoords, Coords* patchCoords, const VkPatchTable* table,
        int fvarChannel = 0, const VkEvaluator* instance = nullptr, VkDeviceContext* context = nullptr) {
        const BoundPoints outputs[6] = {bind(dst, dstDesc), bind(du, duDesc),   bind(dv, dvDesc),
                                        bind(duu, duuDesc), bind(duv, duvDesc), bind(dvv, dvvDesc)};
        return Patches(Primvar::face_varying, fvarChannel, bind(src, srcDesc), outputs, numPatchCoords,
                       handle_of(patchCoords), table, pick(context, instance));
    }
    /// outputs are the value, du, dv, duu, duv, dvv; the channel matters to face-varying primvars only.
    static bool Patches(Primvar primvar, int fvarChannel, const BoundPoints& src,
                        const BoundPoints (&outputs)[6], int numPatchCoords, VkBuffer patchCoords,
                        const VkPatchTable* table, VkDeviceContext* context = nullptr);

    /// Waits for all that the context has submitted; what it has recorded is the caller's to wait for.
    static void Synchronize(VkDeviceContext* context) {
        if (context != nullptr) context->Synchronize();
    }

  private:
    template <class Buffer>
    static VkBuffer handle_of(Buffer* buffer) {
        return buffer != nullptr ? buffer->BindVkBuffer() : VkBuffer{VK_NULL_HANDLE};
    }
    template <class Buffer>
    static BoundPoints bind(Buffer* buffer, const BufferDescriptor& desc) {
        return {handle_of(buffer), desc};
    }
    static VkDeviceContext* pick(VkDeviceContext* context, const VkEvaluator* instance) {
        return context == nullptr && instance != nullptr ? instance->context_ : context;
    }

    VkDeviceContext* context_ = nullptr;
};

}  // namespace limn::osd
