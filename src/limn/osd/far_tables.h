// OpenSubdiv's tables in device memory.
#pragma once

#include <opensubdiv/far/patchTable.h>
#include <opensubdiv/far/stencilTable.h>
#include <opensubdiv/osd/types.h>

#include "limn/vulkan/device_tables.h"

namespace limn::osd {

namespace Far = OpenSubdiv::Far;
namespace Osd = OpenSubdiv::Osd;

/// Which weights of a limit stencil table.
enum class StencilWeights : uint8_t {
    first,   ///< the points; with derivatives, du and dv as tangents
    second,  ///< duu; duv and dvv as tangents
};

/// The rows of a Far table as limn has them: the same sizes, indices and order, weights in float. Real is
/// float or double. source_count covers all that rows refer to, which in tables of unfactorized stencils is
/// more than control vertices. Errors: invalid_argument (weights that the table does not have, an index below
/// 0).
template <class Real>
Result<StencilTable> convert_stencil_table(const Far::StencilTableReal<Real>& table);
template <class Real>
Result<StencilTable> convert_limit_stencil_table(const Far::LimitStencilTableReal<Real>& table,
                                                 StencilWeights weights);

/// One of the interpolations of a patch table: bit for bit the arrays that Osd::CpuPatchTable has.
struct DevicePatches {
    Osd::PatchArrayVector arrays;
    vk::Buffer array_words;     ///< arrays.size() Osd::PatchArray
    vk::Buffer indices;         ///< int32, control vertices
    vk::Buffer params;          ///< Osd::PatchParam, 12 bytes each
    uint32_t types = 0;         ///< bit t: patches of Far::PatchDescriptor type t may occur
    uint32_t source_count = 0;  ///< the largest index, plus one
    uint32_t patch_count = 0;
};

/// `channel` counts from 0.
enum class Primvar : uint8_t { vertex, varying, face_varying };

/// All interpolations of a patch table.
struct DevicePatchTable {
    DevicePatches vertex;
    DevicePatches varying;                    ///< no arrays: the table has none
    std::vector<DevicePatches> face_varying;  ///< by channel

    /// Null: the table has no such patches.
    const DevicePatches* find(Primvar primvar, uint32_t channel) const;
};
struct PatchTableUpload {
    DevicePatchTable table;
    std::vector<vk::Buffer> staging;  ///< to be kept until the commands have completed
};

/// Records the upload into the caller's command buffer, barrier to kernel reads included.
/// Errors: out_of_memory, too_large, vulkan_failure.
Result<PatchTableUpload> record_patch_table_upload(const vk::Device& device, VkCommandBuffer command_buffer,
                                                   const Far::PatchTable& table);

}  // namespace limn::osd
