// What is drawn: a surface and lines in device buffers, and how they look.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <glm/vec3.hpp>

#include "limn/vulkan/buffer.h"
#include "limn/vulkan/hardware_tessellation.h"
#include "viewer/camera.h"

namespace limn::viewer {

/// A triangle mesh whose size only the device knows. All buffers are the caller's, have STORAGE_BUFFER usage
/// and are no larger than maxStorageBufferRange; the indirect command's first index is a multiple of 3, its
/// vertex offset 0. Front faces are counter-clockwise.
struct RenderMesh {
    VkBuffer vertices = VK_NULL_HANDLE;  ///< x y z nx ny nz are the first floats of each
    VkDeviceSize vertices_offset = 0;    ///< bytes, a multiple of 4
    uint32_t vertex_stride_floats = 6;
    VkBuffer indices = VK_NULL_HANDLE;   ///< uint32, three a triangle; and INDEX_BUFFER usage
    VkBuffer indirect = VK_NULL_HANDLE;  ///< one VkDrawIndexedIndirectCommand; INDIRECT_BUFFER, TRANSFER_SRC
    VkDeviceSize indirect_offset = 0;    ///< bytes, a multiple of 4
    /// Optional, 4 words a vertex: ptex face, u, v (floats), leaf word (PlanNodeKind | level << 8).
    VkBuffer places = VK_NULL_HANDLE;
    VkBuffer triangle_faces = VK_NULL_HANDLE;  ///< optional: the ptex face of each triangle
    VkBuffer face_rates = VK_NULL_HANDLE;      ///< optional, of each ptex face: rate along u | along v << 16
    /// Draws instead of vertices, indices and the command, which are null then.
    const vk::HardwareTessellation* hardware = nullptr;
};

/// Reads of a RenderMesh and of lines: what writes them owes a barrier to these.
inline constexpr vk::StageAccess kRenderReads = {
    VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_VERTEX_INPUT_BIT |
        VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
    VK_ACCESS_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_SHADER_READ_BIT |
        VK_ACCESS_TRANSFER_READ_BIT};

/// Line segments between points of 3 floats.
struct RenderLines {
    VkBuffer points = VK_NULL_HANDLE;
    VkBuffer segments = VK_NULL_HANDLE;  ///< pairs of indices of points
    uint32_t segment_count = 0;
};

enum class ColorMode : uint32_t {
    clay,
    kind,       ///< of the patch: PlanNodeKind; needs RenderMesh::places
    level,      ///< of the patch, from 0 dark to 8 light; needs places
    curvature,  ///< mean, times the size of the surface: blue is concave, red convex
    rate,       ///< of tessellation, on a logarithmic scale; needs triangle_faces and face_rates
    normals,
    sides,  ///< fronts grey, backs magenta, nothing else: where a closed surface has a crack, magenta shows
    gaussian,   ///< curvature, its root times the size: blue are saddles, red what is convex or concave all around
    principal,  ///< the one of the principal curvatures that is farther from 0, as curvature
};

/// Reads of a RenderMesh with hardware tessellation.
inline constexpr vk::StageAccess kHardwareRenderReads = {
    vk::kHardwareReads.stages | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, vk::kHardwareReads.access};

/// It reads RenderMesh::places.
inline bool needs_places(ColorMode mode) {
    return mode == ColorMode::kind || mode == ColorMode::level;
}

/// Linear colours.
struct Background {
    glm::vec3 centre = glm::vec3(0.80f, 0.81f, 0.82f), edge = glm::vec3(0.42f, 0.44f, 0.47f);
};

struct RenderSettings {
    ColorMode color = ColorMode::clay;  ///< with hardware tessellation not kind or level: they are as level 0 there
    bool wireframe = false;             ///< not with hardware tessellation
    bool lines = false;
    bool ground = true;
    Background background;
    uint32_t sky_directions = 64;  ///< 0 .. 64, each with a pass over the mesh; 0: no ambient occlusion
    float key_azimuth = -12;       ///< where the key light is, as CameraView::azimuth
    uint32_t max_rate = 64;        ///< the bright end of ColorMode::rate
};

}  // namespace limn::viewer
