// A small surface with all that limn evaluates of it, for tests of how limn fits into an engine.
#pragma once

#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"

namespace limn::vk::test {

/// A creased cube: tables of the CPU's.
struct SceneTables {
    PatchTable patches;
    TessellationTable topology;
    PatchTreeTable trees;       ///< of the tessellation
    PatchTreeTable sample_trees;
    GridTable grid;
    std::vector<float> control;  ///< 3 per point
};
SceneTables build_scene();

/// What a device shares among frames, queues and threads.
struct SceneKernels {
    SurfaceEvaluator surfaces;
    Tessellator tessellator;
    static Result<SceneKernels> create(const Device& device);
};
struct SceneUpload {
    DevicePatchTable patches;
    DeviceTessellationTable topology;
    DevicePatchTrees sample_trees;
    DeviceGridTable grid;
    std::vector<Buffer> staging;
    static Result<SceneUpload> record(const Device& device, VkCommandBuffer commands, const SceneTables& tables);
};

inline constexpr uint32_t kSceneVertices = 400, kSceneTriangles = 800, kSceneSamples = 5;

/// What a frame in flight has of its own.
struct SceneFrame {
    Buffer points, vertices, indices, command;
    Buffer local_points, samples, results;
    StencilEvaluation refined;
    Tessellation tessellation;
    SurfaceEvaluation local, sampled;
    static Result<SceneFrame> create(const Device& device, const SceneKernels& kernels, const SceneUpload& tables);

    /// From control points to triangles; samples, too, if asked for.
    Result<void> record(const Device& device, VkCommandBuffer commands, bool with_samples) const;
};

}  // namespace limn::vk::test
