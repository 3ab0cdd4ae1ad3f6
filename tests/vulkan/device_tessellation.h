// A shape tessellated on the device and read back, for tests.
#pragma once

#include <array>
#include <functional>

#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"
#include "shapes/tessellation_checks.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk::test {

/// What is asked for, beyond positions.
struct TessellationRequest {
    RateSettings settings = {};
    std::vector<float> edge_rates = {};
    bool fit_capacity = false;
    bool rates_only = false;  ///< no vertices, no triangles; without `outputs`
    bool outputs = true;  ///< normals, places, tangents, faces of triangles, channels
    uint32_t max_rate = 64;
    uint32_t vertex_capacity = 1 << 17;
    uint32_t triangle_capacity = 1 << 17;
    uint32_t offset_words = 0;       ///< before everything that is written
    uint32_t stride = 6;             ///< of positions with normals
    /// Heights by the caller: of a vertex from its place and position, h, dh/du, dh/dv.
    std::function<std::array<float, 3>(uint32_t face, float u, float v)> heights = {};
    const HeightTexture* texture = nullptr;  ///< of channel 0
    bool own_heights = false;  ///< limn has the buffer of heights; with a texture
    bool clockwise = false;
    /// Where not empty, control points that vertices are made of once more, after the frame; triangles are, too. The passes are
    /// recorded as for rates of any size.
    std::vector<float> later_positions = {};
    bool previous = false;           ///< positions of the last frame, from points moved by one along x
};

struct TessellatedShape {
    ControlMesh mesh;
    PatchTable patches;
    TessellationTable table;
    std::vector<double> points;
    std::vector<PatchTable> channel_patches;
    std::vector<std::vector<double>> channel_points;
    double size = 0, tolerance = 0;

    Result<void> recorded;
    TessellationResult result = {};
    uint32_t command[5] = {};
    std::vector<uint32_t> indices, triangle_faces, rates;
    std::vector<float> positions, normals, tangents, previous;  ///< 3, 3, 4 and 3 per vertex
    std::vector<uint32_t> places;                               ///< 4 per vertex
    std::vector<std::vector<float>> channels;                   ///< 2 per vertex
    std::vector<float> heights;                                 ///< 3 per vertex
    std::vector<float> untouched;  ///< floats between vertices and before them
};

class TessellatorTest : public VulkanTest {
  protected:
    void SetUp() override;
    TessellatedShape tessellate_on_device(const limn::test::TestMesh& shape, const TessellationRequest& request);

    /// A grid with normals, bit for bit: 3 floats per sample each.
    struct GridBits {
        std::vector<uint32_t> values, normals;
    };
    GridBits evaluate_grid(const DeviceGridTable& grid, const DevicePatchTable& patches, const Buffer& points);

    /// As VulkanTest's, with evaluators of its own.
    void pretend_gpu(uint32_t max_range = ~0u);

    const SurfaceEvaluator* surfaces_ = nullptr;
    const Tessellator* tessellator_ = nullptr;

  private:
    std::optional<SurfaceEvaluator> gpu_surfaces_;
    std::optional<Tessellator> gpu_tessellator_;
};

/// The same by limn::tessellate, with the rates that the device had.
limn::Tessellation tessellate_on_host(const TessellatedShape& shape, TessellationSpacing spacing);

}  // namespace limn::vk::test
