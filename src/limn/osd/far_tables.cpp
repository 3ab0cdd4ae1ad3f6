#include "limn/osd/far_tables.h"

#include <opensubdiv/osd/cpuPatchTable.h>

#include <algorithm>

#include "limn/shared/osd_patch_eval_params.h"
#include "limn/vulkan/table_upload.h"

namespace limn::osd {

static_assert(sizeof(Osd::PatchArray) == 4 * shared::kOsdArrayWords);
static_assert(sizeof(Osd::PatchParam) == 4 * shared::kOsdParamWords);
static_assert(sizeof(Osd::PatchCoord) == 4 * shared::kOsdCoordWords);

namespace {

/// Far's weights may be more than its indices: those past the end are left over from building.
template <class Real>
bool copy_weights(const std::vector<Real>& weights, size_t count, Array<float>& out) {
    if (weights.size() < count) return false;
    out.allocate(count);
    std::transform(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(count), out.begin(),
                   [](Real w) { return static_cast<float>(w); });
    return true;
}

template <class Real>
Result<StencilTable> convert_rows(const Far::StencilTableReal<Real>& table) {
    StencilTable out;
    const std::vector<int>& sizes = table.GetSizes();
    const std::vector<Far::Index>& indices = table.GetControlIndices();
    out.offsets.allocate(sizes.size() + 1);
    uint64_t end = 0;
    for (size_t r = 0; r < sizes.size(); ++r) {
        out.offsets[r] = static_cast<uint32_t>(end);
        end += static_cast<uint32_t>(sizes[r]);
    }
    if (end > indices.size() || end > 0xffffffffu)
        return Error{ErrorCode::invalid_argument, "a stencil table has fewer indices than its sizes say"};
    out.offsets[sizes.size()] = static_cast<uint32_t>(end);
    out.indices.allocate(end);
    out.source_count = static_cast<uint32_t>(std::max(0, table.GetNumControlVertices()));
    for (size_t k = 0; k < end; ++k) {
        if (indices[k] < 0) return Error{ErrorCode::invalid_argument, "a stencil has an index below 0", k};
        out.indices[k] = static_cast<uint32_t>(indices[k]);
        out.source_count = std::max(out.source_count, out.indices[k] + 1);
    }
    return out;
}

Error no_weights() {
    return {ErrorCode::invalid_argument, "a stencil table lacks the weights that are asked for"};
}

}  // namespace

template <class Real>
Result<StencilTable> convert_stencil_table(const Far::StencilTableReal<Real>& table) {
    auto out = convert_rows(table);
    if (out && !copy_weights(table.GetWeights(), out->indices.size(), out->weights)) return no_weights();
    return out;
}

template <class Real>
Result<StencilTable> convert_limit_stencil_table(const Far::LimitStencilTableReal<Real>& table,
                                                 StencilWeights weights) {
    auto out = convert_rows(table);
    if (!out) return out;
    const bool first = weights == StencilWeights::first;
    const size_t count = out->indices.size();
    if (!copy_weights(first ? table.GetWeights() : table.GetDuuWeights(), count, out->weights))
        return no_weights();
    if (first && table.GetDuWeights().empty()) return out;
    if (!copy_weights(first ? table.GetDuWeights() : table.GetDuvWeights(), count, out->tangent1_weights) ||
        !copy_weights(first ? table.GetDvWeights() : table.GetDvvWeights(), count, out->tangent2_weights))
        return no_weights();
    return out;
}

template Result<StencilTable> convert_stencil_table(const Far::StencilTableReal<float>&);
template Result<StencilTable> convert_stencil_table(const Far::StencilTableReal<double>&);
template Result<StencilTable> convert_limit_stencil_table(const Far::LimitStencilTableReal<float>&,
                                                          StencilWeights);
template Result<StencilTable> convert_limit_stencil_table(const Far::LimitStencilTableReal<double>&,
                                                          StencilWeights);

namespace {

/// The arrays of one interpolation in host memory.
struct HostPatches {
    const Osd::PatchArray* arrays;
    size_t array_count;
    const int* indices;
    size_t index_count;
    const Osd::PatchParam* params;
    size_t param_count;
};

class PatchUploader {
  public:
    PatchUploader(const vk::Device& device, VkCommandBuffer command_buffer, std::vector<vk::Buffer>& staging)
        : device_(device), command_buffer_(command_buffer), staging_(staging) {}

    Result<DevicePatches> upload(const HostPatches& host) {
        DevicePatches out;
        out.arrays.assign(host.arrays, host.arrays + host.array_count);
        for (const Osd::PatchArray& array : out.arrays)
            out.types |= 1u << array.GetPatchTypeRegular() | 1u << array.GetPatchTypeIrregular();
        for (size_t i = 0; i < host.index_count; ++i) {
            if (host.indices[i] < 0)
                return Error{ErrorCode::invalid_argument, "a patch has an index below 0", i};
            out.source_count = std::max(out.source_count, static_cast<uint32_t>(host.indices[i]) + 1);
        }
        out.patch_count = static_cast<uint32_t>(host.param_count);
        if (auto done = put(host.arrays, host.array_count, out.array_words); !done) return done.error();
        if (auto done = put(host.indices, host.index_count, out.indices); !done) return done.error();
        if (auto done = put(host.params, host.param_count, out.params); !done) return done.error();
        return out;
    }

  private:
    template <class T>
    Result<void> put(const T* values, size_t count, vk::Buffer& out) {
        auto buffer = vk::create_table_buffer(device_, command_buffer_, count * sizeof(T), staging_);
        if (!buffer) return buffer.error();
        if (count != 0) std::memcpy(buffer->second, values, count * sizeof(T));
        out = std::move(buffer->first);
        return {};
    }

    const vk::Device& device_;
    VkCommandBuffer command_buffer_;
    std::vector<vk::Buffer>& staging_;
};

}  // namespace

const DevicePatches* DevicePatchTable::find(Primvar primvar, uint32_t channel) const {
    const DevicePatches* patches = primvar == Primvar::vertex ? &vertex : &varying;
    if (primvar == Primvar::face_varying)
        patches = channel < face_varying.size() ? &face_varying[channel] : nullptr;
    return patches != nullptr && !patches->arrays.empty() ? patches : nullptr;
}

Result<PatchTableUpload> record_patch_table_upload(const vk::Device& device, VkCommandBuffer command_buffer,
                                                   const Far::PatchTable& table) {
    PatchTableUpload out;
    if (table.GetNumPatchArrays() == 0) return out;
    const Osd::CpuPatchTable host(&table);
    PatchUploader uploader(device, command_buffer, out.staging);
    auto vertex =
        uploader.upload({host.GetPatchArrayBuffer(), host.GetNumPatchArrays(), host.GetPatchIndexBuffer(),
                         host.GetPatchIndexSize(), host.GetPatchParamBuffer(), host.GetPatchParamSize()});
    if (!vertex) return vertex.error();
    out.table.vertex = std::move(*vertex);
    if (host.GetVaryingPatchArrayBuffer() != nullptr && host.GetVaryingPatchIndexSize() != 0) {
        auto varying = uploader.upload({host.GetVaryingPatchArrayBuffer(), host.GetNumPatchArrays(),
                                        host.GetVaryingPatchIndexBuffer(), host.GetVaryingPatchIndexSize(),
                                        host.GetPatchParamBuffer(), host.GetPatchParamSize()});
        if (!varying) return varying.error();
        out.table.varying = std::move(*varying);
    }
    for (int channel = 0; channel < host.GetNumFVarChannels(); ++channel) {
        auto patches =
            uploader.upload({host.GetFVarPatchArrayBuffer(channel), host.GetNumPatchArrays(),
                             host.GetFVarPatchIndexBuffer(channel), host.GetFVarPatchIndexSize(channel),
                             host.GetFVarPatchParamBuffer(channel), host.GetFVarPatchParamSize(channel)});
        if (!patches) return patches.error();
        out.table.face_varying.push_back(std::move(*patches));
    }
    return out;
}

}  // namespace limn::osd
