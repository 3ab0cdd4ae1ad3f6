// Displaced tessellations: against the same in double, and where the displaced surface is known in closed form.
#include <vulkan/vulkan.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "limn/shared/tess_steps.h"
#include "shapes/random_mesh.h"
#include "vulkan/tessellation_parity.h"

namespace limn::vk::test {
namespace {

using limn::test::TestMesh;

/// Positions, normals, and the bits of seams; `heights` as the device had them.
void expect_displaced_as_on_host(const TessellatedShape& t, double normal_degrees) {
    const limn::Tessellation host = tessellate_on_host(t, TessellationSpacing::integer);
    ASSERT_EQ(t.result.status, TessellationStatus::complete);
    ASSERT_EQ(t.indices, host.indices);
    ASSERT_EQ(t.heights.size(), 3 * host.places.size());
    HostPoints positions{std::vector<double>(3 * host.places.size())};
    std::vector<double> normals(positions.values.size());
    displace_tessellation(t.patches, host, t.points, std::vector<double>(t.heights.begin(), t.heights.end()), shared::step_size(64),
                          positions.values, normals);
    double most = 0;
    for (size_t i = 0; i < t.heights.size(); i += 3) most = std::max(most, std::abs(double{t.heights[i]}));
    // Normals are differences of floats here.
    EXPECT_TRUE(points_match(positions, DevicePoints{t.positions}, t.tolerance + 1e-4 * most));
    size_t off = 0;
    for (size_t i = 0; i < host.places.size(); ++i) {
        off += degrees_between(&t.normals[3 * i], &normals[3 * i]) > normal_degrees;
        const size_t source = host.position_sources[i];
        ASSERT_EQ(std::memcmp(&t.positions[3 * i], &t.positions[3 * source], 12), 0);
    }
    EXPECT_LE(off, host.places.size() / 200);
}

class Displacement : public TessellatorTest {};

// z = a sin(k x) over a flat sheet.
TEST_F(Displacement, OfAPlaneIsTheGraphOfItsHeights) {
    TestMesh sheet = limn::test::make_grid(4, 4);
    for (uint32_t v = 0; v < sheet.vertex_count; ++v) {
        sheet.positions[3 * v] = static_cast<float>(v % 5);
        sheet.positions[3 * v + 1] = static_cast<float>(v / 5);
        sheet.positions[3 * v + 2] = 0;
    }
    sheet.options.boundary = BoundaryInterpolation::edge_and_corner;
    const PatchTable patches = *build_patch_table<float>(*ControlMesh::create(sheet.description()), {});
    std::vector<double> points(size_t{3} * patches.point_count());
    build_patch_points<float>(patches, sheet.positions_double(), 3, points);
    constexpr double a = 0.3, k = 2;
    TessellationRequest request;
    request.settings.value = 8;
    request.heights = [&](uint32_t face, float u, float v) {
        const PatchSample s = {face, u, v};
        double value[9];
        SampleStatus status;
        evaluate_patches(patches, {&s, 1}, points, 3, Derivatives::first, value, {&status, 1});
        const double slope = a * k * std::cos(k * value[0]);
        return std::array<float, 3>{static_cast<float>(a * std::sin(k * value[0])), static_cast<float>(slope * value[3]),
                                    static_cast<float>(slope * value[6])};
    };
    const TessellatedShape t = tessellate_on_device(sheet, request);
    expect_displaced_as_on_host(t, 0.1);
    ASSERT_FALSE(t.positions.empty());
    for (size_t i = 0; i < t.positions.size(); i += 3) {
        const double x = t.positions[i], slope = a * k * std::cos(k * x), length = std::hypot(1, slope);
        ASSERT_NEAR(t.positions[i + 2], a * std::sin(k * x), 1e-5);
        const double normal[3] = {-slope / length, 0, 1 / length};
        ASSERT_LT(degrees_between(&t.normals[i], normal), 0.2);
    }
}

// A constant height gives the offset surface, whose normals are those of the surface.
TEST_F(Displacement, ByAConstantKeepsNormals) {
    TestMesh loop = limn::test::make_triangle_globe(7, 5);
    loop.options.scheme = Scheme::loop;
    for (const TestMesh& shape : {limn::test::make_globe(5, 4), limn::test::make_prism(6), loop}) {
        TessellationRequest request;
        request.settings.value = 6;
        const TessellatedShape plain = tessellate_on_device(shape, request);
        request.heights = [](uint32_t, float, float) { return std::array<float, 3>{0.1f, 0, 0}; };
        const TessellatedShape t = tessellate_on_device(shape, request);
        expect_displaced_as_on_host(t, 0.5);
        size_t off = 0;
        for (size_t i = 0; i < t.positions.size(); i += 3) {
            double expected[3], normal[3];
            for (size_t c = 0; c < 3; ++c) {
                normal[c] = plain.normals[i + c];
                expected[c] = plain.positions[i + c] + 0.1 * normal[c];
                ASSERT_NEAR(t.positions[i + c], expected[c], 1e-5);
            }
            off += degrees_between(&t.normals[i], normal) > 1;
        }
        EXPECT_LE(off, t.positions.size() / 300) << shape.name;
    }
}

/// A float texture of `size` x `size` texels, and its sampler.
struct Texture {
    VkDevice device;
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkSampler sampler = VK_NULL_HANDLE;

    Texture(const Device& of, uint32_t size, const std::vector<float>& texels) : device(of.handle) {
        VkImageCreateInfo info = {VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
        info.imageType = VK_IMAGE_TYPE_2D;
        info.format = VK_FORMAT_R32_SFLOAT;
        info.extent = {size, size, 1};
        info.mipLevels = info.arrayLayers = 1;
        info.samples = VK_SAMPLE_COUNT_1_BIT;
        info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        EXPECT_EQ(vkCreateImage(device, &info, nullptr, &image), VK_SUCCESS);
        VkMemoryRequirements needs;
        vkGetImageMemoryRequirements(device, image, &needs);
        VkMemoryAllocateInfo allocate = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
        allocate.allocationSize = needs.size;
        allocate.memoryTypeIndex = static_cast<uint32_t>(std::countr_zero(needs.memoryTypeBits));
        EXPECT_EQ(vkAllocateMemory(device, &allocate, nullptr, &memory), VK_SUCCESS);
        EXPECT_EQ(vkBindImageMemory(device, image, memory, 0), VK_SUCCESS);
        VkImageViewCreateInfo view_info = {VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
        view_info.image = image;
        view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
        view_info.format = info.format;
        view_info.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        EXPECT_EQ(vkCreateImageView(device, &view_info, nullptr, &view), VK_SUCCESS);
        VkSamplerCreateInfo sampler_info = {VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
        sampler_info.magFilter = sampler_info.minFilter = VK_FILTER_LINEAR;
        sampler_info.addressModeU = sampler_info.addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        EXPECT_EQ(vkCreateSampler(device, &sampler_info, nullptr, &sampler), VK_SUCCESS);
        const Buffer staging = *create_point_buffer(of, texels);
        Result<Commands> commands = Commands::begin(of);
        change_layout(*commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        VkBufferImageCopy copy = {};
        copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        copy.imageExtent = info.extent;
        vkCmdCopyBufferToImage(*commands, staging.handle, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
        change_layout(*commands, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
        EXPECT_TRUE(commands->submit_and_wait());
    }
    Texture(const Texture&) = delete;
    ~Texture() {
        vkDestroySampler(device, sampler, nullptr);
        vkDestroyImageView(device, view, nullptr);
        vkDestroyImage(device, image, nullptr);
        vkFreeMemory(device, memory, nullptr);
    }
    void change_layout(VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) const {
        VkImageMemoryBarrier barrier = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
        barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_SHADER_READ_BIT;
        barrier.oldLayout = from;
        barrier.newLayout = to;
        barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.image = image;
        barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                             VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, nullptr, 0,
                             nullptr, 1, &barrier);
    }
};

// Heights that are linear in the texture coordinates come out of the texture to the last bit but rounding; and seams, where
// they are two, do not crack.
TEST_F(Displacement, ComesFromATexture) {
    constexpr uint32_t size = 64;
    std::vector<float> texels;
    for (uint32_t j = 0; j < size; ++j)
        for (uint32_t i = 0; i < size; ++i)
            texels.push_back((static_cast<float>(i) + 0.5f) / size + 2 * (static_cast<float>(j) + 0.5f) / size);
    const Texture texture(device(), size, texels);
    size_t with_seams = 0, compared = 0;
    for (TestMesh shape : limn::test::face_varying_shapes()) {
        // Four faces at an edge have no normal there; smooth channels with Chaikin creases no table.
        if (!shape.name.ends_with("edge_only") || shape.name.find("sharing_an_edge") != std::string::npos ||
            shape.name.find("chaikin") != std::string::npos)
            continue;
        for (limn::test::TestChannel& channel : shape.channels) {  // into the part of the texture that is linear
            const auto [low, high] = std::minmax_element(channel.values.begin(), channel.values.end());
            const float from = *low, size_of_values = *high - *low;
            for (float& x : channel.values) x = 0.1f + 0.8f * (x - from) / size_of_values;
        }
        const HeightTexture heights{.view = texture.view, .sampler = texture.sampler, .scale = 0.05f, .bias = 0.01f};
        TessellationRequest request;
        request.settings.value = 5;
        request.texture = &heights;
        const TessellatedShape t = tessellate_on_device(shape, request);
        if (t.channels.empty()) continue;
        SCOPED_TRACE(shape.name);
        if (compared == 0) {  // a buffer of limn's own makes no difference
            request.own_heights = true;
            EXPECT_EQ(tessellate_on_device(shape, request).positions, t.positions);
        }
        const limn::Tessellation host = tessellate_on_host(t, TessellationSpacing::integer);
        std::vector<double> channel(host.places.size() * 6);
        std::vector<SampleStatus> statuses(host.places.size());
        evaluate_patches(t.channel_patches[0], host.places, t.channel_points[0], 2, Derivatives::first, channel, statuses);
        for (size_t i = 0; i < host.places.size(); ++i) {
            const double* st = &channel[6 * i];
            ASSERT_NEAR(t.heights[3 * i], 0.05 * (st[0] + 2 * st[1]) + 0.01, 1e-3) << "vertex " << i;
            with_seams += host.position_sources[i] != i;
            // At corners of faces derivatives may be tangents, whose lengths mean nothing.
            const auto is_end = [](double x) { return x == 0 || x == 1; };
            if (is_end(host.places[i].u) && is_end(host.places[i].v)) continue;
            ++compared;
            for (size_t k = 0; k < 2; ++k)
                ASSERT_NEAR(t.heights[3 * i + 1 + k], 0.05 * (st[2 + 2 * k] + 2 * st[3 + 2 * k]), 2e-3)
                    << "vertex " << i << " of face " << host.places[i].face << " at " << host.places[i].u << ' '
                    << host.places[i].v;
        }
        expect_displaced_as_on_host(t, 1);
    }
    EXPECT_GT(with_seams, 100u);
    EXPECT_GT(compared, 1000u);
}

}  // namespace
}  // namespace limn::vk::test
