// What a tessellation and the tessellator hold. Not part of the public interface.
#pragma once

#include <array>
#include <bit>
#include <vector>

#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/recording.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "limn/vulkan/tessellator_kernels.h"

namespace limn::vk {

using shared::TessParams;
using Dispatch = Recording::Dispatch;
using Stage = std::vector<Dispatch>;  ///< dispatches that need no barrier between them

/// A word of a payload.
inline float word(uint32_t value) {
    return std::bit_cast<float>(value);
}

/// Vertices, and what then has to be copied at seams.
struct PositionPass {
    Stage vertices, copies;
};

struct Tessellation::State {
    Recording sets, height_sets;
    const DeviceTessellationTable* table = nullptr;
    Buffer words;                        ///< limn/shared/tess_params.h
    std::vector<Buffer> local;           ///< of vertices, channels, the last frame
    std::vector<SurfaceEvaluation> local_points;
    Dispatch begin = {}, targets = {}, drawn = {};
    std::vector<Stage> rates;  ///< from targets and drawn faces to offsets
    PositionPass plain, displaced;
    Stage triangles, heights;
    Buffer own_heights;
    RateMode mode = RateMode::uniform;
    TessellationSpacing spacing = TessellationSpacing::integer;
    bool cull_outside = false, cull_backfaces = false;
    uint32_t max_rate = 0;

    const Device& device() const { return *sets.device; }
    void record_stage(VkCommandBuffer commands, std::span<const Dispatch> stage) const;
    void record_positions(VkCommandBuffer commands, const PositionPass& pass) const;
};

struct Tessellator::State {
    const Device* device = nullptr;
    SurfaceEvaluator surfaces;
    Kernel kernels[kTessKernelCount];
    bool texel = false;

    explicit State(SurfaceEvaluator evaluator) : surfaces(std::move(evaluator)) {}
};

}  // namespace limn::vk
