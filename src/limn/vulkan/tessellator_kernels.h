// The tess_* kernels by name. Not part of the public interface.
#pragma once

#include <cstdint>
#include <span>

#include "limn_kernels/tess_budget.h"
#include "limn_kernels/tess_budget_texel.h"
#include "limn_kernels/tess_commands.h"
#include "limn_kernels/tess_commands_texel.h"
#include "limn_kernels/tess_copy.h"
#include "limn_kernels/tess_copy_texel.h"
#include "limn_kernels/tess_count.h"
#include "limn_kernels/tess_count_texel.h"
#include "limn_kernels/tess_displace.h"
#include "limn_kernels/tess_displace_texel.h"
#include "limn_kernels/tess_drawn.h"
#include "limn_kernels/tess_drawn_texel.h"
#include "limn_kernels/tess_height.h"
#include "limn_kernels/tess_height_texel.h"
#include "limn_kernels/tess_round.h"
#include "limn_kernels/tess_round_texel.h"
#include "limn_kernels/tess_scan.h"
#include "limn_kernels/tess_scan_texel.h"
#include "limn_kernels/tess_target.h"
#include "limn_kernels/tess_target_texel.h"
#include "limn_kernels/tess_trial.h"
#include "limn_kernels/tess_trial_texel.h"
#include "limn_kernels/tess_triangles.h"
#include "limn_kernels/tess_triangles_texel.h"
#include "limn_kernels/tess_vertices.h"
#include "limn_kernels/tess_vertices_texel.h"

namespace limn::vk {

enum TessKernel : uint32_t {
    kTessBudgetKernel,
    kTessTargetKernel,
    kTessDrawnKernel,
    kTessTrialKernel,
    kTessRoundKernel,
    kTessCountKernel,
    kTessScanKernel,
    kTessCommandsKernel,
    kTessVerticesKernel,
    kTessCopyKernel,
    kTessTrianglesKernel,
    kTessDisplaceKernel,
    kTessHeightKernel,  // the last: it binds a texture
    kTessKernelCount
};

/// As built to read storage buffers or texel buffers.
inline std::span<const uint32_t> tess_kernel_spirv(TessKernel kernel, bool texel) {
    const std::span<const uint32_t> spirv[kTessKernelCount][2] = {
        {kTessBudget, kTessBudgetTexel},     {kTessTarget, kTessTargetTexel}, {kTessDrawn, kTessDrawnTexel},
        {kTessTrial, kTessTrialTexel},       {kTessRound, kTessRoundTexel},   {kTessCount, kTessCountTexel},
        {kTessScan, kTessScanTexel},
        {kTessCommands, kTessCommandsTexel}, {kTessVertices, kTessVerticesTexel},
        {kTessCopy, kTessCopyTexel},         {kTessTriangles, kTessTrianglesTexel},
        {kTessDisplace, kTessDisplaceTexel}, {kTessHeight, kTessHeightTexel}};
    return spirv[kernel][texel ? 1 : 0];
}

}  // namespace limn::vk
