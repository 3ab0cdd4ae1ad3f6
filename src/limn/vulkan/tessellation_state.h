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

/// How many invocations share an item, a power of two or none at all: a corner, the vertices of a row, those within a face, or
/// a face's triangles.
struct Lanes {
    uint32_t corners = 1, rows, faces, triangles;
};
/// A dispatch over items that invocations share. How many do is decided when it is recorded.
struct ItemDispatch {
    Dispatch dispatch;
    uint32_t item_count;
    uint32_t Lanes::*lanes;
};
using ItemStage = std::vector<ItemDispatch>;

/// Vertices, and what then has to be copied at seams.
struct PositionPass {
    ItemStage vertices, copies;
};

struct Tessellation::State {
    Recording sets, height_sets;
    const DeviceTessellationTable* table = nullptr;
    Buffer words;                        ///< limn/shared/tess_params.h
    std::vector<Buffer> local;           ///< of vertices, channels, the last frame
    std::vector<SurfaceEvaluation> local_points;
    Dispatch begin = {}, targets = {}, drawn = {};
    std::vector<Stage> rates;   ///< from targets and drawn faces to offsets
    std::vector<Stage> scaled;  ///< the same with rates scaled to fit, without workgroups where all fits as it is
    Stage instance_commands;
    PositionPass plain, displaced;
    ItemStage triangles, heights;
    Buffer own_heights;
    RateMode mode = RateMode::uniform;
    TessellationSpacing spacing = TessellationSpacing::integer;
    bool cull_outside = false, cull_backfaces = false;
    bool has_instances = false;  ///< which may scale rates
    bool cpu_device = false;
    uint32_t max_rate = 0;

    const Device& device() const { return *sets.device; }
    Lanes lanes_for(uint32_t largest_rate) const;
    void record_stage(VkCommandBuffer commands, std::span<const Dispatch> stage) const;
    void record_items(VkCommandBuffer commands, const Recording& recording, const ItemStage& stage, uint32_t largest_rate) const;
    void record_positions(VkCommandBuffer commands, const PositionPass& pass, uint32_t largest_rate) const;
};

struct Tessellator::State {
    const Device* device = nullptr;
    SurfaceEvaluator surfaces;
    Kernel kernels[kTessKernelCount];
    bool texel = false;

    explicit State(SurfaceEvaluator evaluator) : surfaces(std::move(evaluator)) {}
};

}  // namespace limn::vk
