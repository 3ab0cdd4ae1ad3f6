// Pictures: that they are what they should be, again and again, and that they tell a crack.
#include "viewer/renderer.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "viewer/leaks.h"
#include "viewer/surface_mesh.h"
#include "viewer/test_mesh.h"
#include "viewer/viewer_test.h"

namespace limn::viewer {
namespace {

using test::count_covered;
using test::count_leaks;
using test::cut_sliver;
using test::DeviceMesh;
using test::find_triangle;
using test::HostMesh;
using test::pull_apart;
using test::refine_to_limit;

constexpr VkExtent2D kSize = {240, 180};

/// Pixels with a channel that differs by more than `tolerance`.
size_t count_different(const Picture& a, const Picture& b, int tolerance) {
    if (a.rgb.size() != b.rgb.size() || a.rgb.empty()) return ~size_t{0};
    size_t count = 0;
    for (size_t i = 0; i < a.rgb.size(); i += 3) {
        int worst = 0;
        for (size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(a.rgb[i + k] - b.rgb[i + k]));
        count += worst > tolerance;
    }
    return count;
}

class Pictures : public test::ViewerTest {
  protected:
    void SetUp() override {
        test::ViewerTest::SetUp();
        if (HasFatalFailure()) return;
        renderer_ = make_renderer(kSize);
        ASSERT_TRUE(renderer_);
    }

    std::optional<Renderer> make_renderer(VkExtent2D size) const {
        auto renderer = Renderer::create(device());
        EXPECT_TRUE(renderer);
        if (!renderer) return std::nullopt;
        const auto sized = renderer->resize(size);
        EXPECT_TRUE(sized) << sized.error().message;
        return std::move(*renderer);
    }

    static Renderer::View view_of(const HostMesh& mesh, const CameraView& camera = {}) {
        const float aspect = static_cast<float>(kSize.width) / static_cast<float>(kSize.height);
        return {.camera = Camera::frame(mesh.bounds(), camera, aspect), .bounds = mesh.bounds()};
    }

    Picture draw_mesh(const HostMesh& mesh, const Renderer::View& view) {
        const DeviceMesh on_device = test::upload(device(), mesh);
        renderer_->set_scene(on_device.mesh(), {});
        return draw(*renderer_, view);
    }

    Picture draw_sides(const HostMesh& mesh, const CameraView& camera = {}) {
        Renderer::View view = view_of(mesh, camera);
        view.settings.color = ColorMode::sides;
        view.settings.sky_directions = 0;
        return draw_mesh(mesh, view);
    }

    std::optional<Renderer> renderer_;
};

TEST_F(Pictures, AreTheSameEveryTime) {
    const HostMesh cube = refine_to_limit(limn::test::make_cube(), 3);
    const Renderer::View view = view_of(cube);
    const Picture first = draw_mesh(cube, view), second = draw_mesh(cube, view);
    EXPECT_EQ(count_different(first, second, 0), 0u);
    renderer_ = make_renderer(kSize);
    EXPECT_EQ(count_different(first, draw_mesh(cube, view), 0), 0u);
}

TEST_F(Pictures, CoverWhatTheShapeCovers) {
    const HostMesh sphere = test::make_sphere(64);
    const float distance = 3, fov = 40;
    Renderer::View view = view_of(sphere);
    view.camera.eye = distance * direction_of(20, 15);
    view.camera.target = glm::vec3(0);
    view.camera.fov = fov;
    view.settings.color = ColorMode::sides;
    const Picture picture = draw_mesh(sphere, view);
    // Towards the border of its outline a pixel is covered where one of its four samples is: half a pixel
    // more.
    const double tangent = std::tan(std::asin(1 / distance)) / std::tan(0.5 * glm::radians(fov));
    const double radius = 0.5 * kSize.height * tangent + 0.4;
    EXPECT_NEAR(static_cast<double>(count_covered(picture)), M_PI * radius * radius,
                0.01 * M_PI * radius * radius);
    EXPECT_EQ(count_leaks(picture), 0u);
}

TEST_F(Pictures, ShowLightAndShadow) {
    const HostMesh sphere = test::make_sphere(32);
    Renderer::View view = view_of(sphere, {.azimuth = 0, .elevation = 25});
    view.settings.key_azimuth = -60;
    const Picture lit = draw_mesh(sphere, view);
    const auto brightness = [](const Picture& picture, uint32_t x, uint32_t y) {
        const uint8_t* rgb = picture.at(x, y);
        return rgb[0] + rgb[1] + rgb[2];
    };
    const uint32_t middle = kSize.width / 2, row = kSize.height / 2;
    EXPECT_GT(brightness(lit, middle - 40, row), brightness(lit, middle + 40, row) + 40);
    // The ground is darker where the sphere stands than without it, and the same far away.
    Renderer::View bare = view;
    bare.settings.ground = false;
    const Picture unlit = draw_mesh(sphere, bare);
    size_t darker = 0;
    for (uint32_t x = 0; x < kSize.width; ++x)
        darker += brightness(lit, x, kSize.height - 14) + 20 < brightness(unlit, x, kSize.height - 14);
    EXPECT_GT(darker, 20u);
    EXPECT_LT(std::abs(brightness(lit, 2, 2) - brightness(unlit, 2, 2)), 6);
}

TEST_F(Pictures, DifferByModeAndOverlay) {
    const HostMesh cube = refine_to_limit(limn::test::make_cube(), 3);
    Renderer::View view = view_of(cube);
    view.settings.sky_directions = 8;
    std::vector<Picture> pictures;
    for (uint32_t mode = 0; mode <= static_cast<uint32_t>(ColorMode::sides); ++mode) {
        view.settings.color = static_cast<ColorMode>(mode);
        pictures.push_back(draw_mesh(cube, view));
    }
    view.settings.color = ColorMode::clay;
    view.settings.wireframe = true;
    pictures.push_back(draw_mesh(cube, view));
    for (size_t i = 0; i < pictures.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            EXPECT_GT(count_different(pictures[i], pictures[j], 12), 500u) << i << " and " << j;
}

TEST_F(Pictures, HaveLinesOfTheControlMesh) {
    const HostMesh sphere = test::make_sphere(16);
    const DeviceMesh mesh = test::upload(device(), sphere);
    const std::vector<float> points = {-2, 0, 0, 2, 0, 0, 0, -1, 30, 0, 1, 30};  // the last behind the eye
    const auto point_buffer = vk::create_point_buffer(device(), points);
    ASSERT_TRUE(point_buffer);
    const std::vector<float> words = {std::bit_cast<float>(0u), std::bit_cast<float>(1u),
                                      std::bit_cast<float>(2u), std::bit_cast<float>(3u),
                                      std::bit_cast<float>(0u), std::bit_cast<float>(2u)};
    const auto segments = vk::create_point_buffer(device(), words);
    ASSERT_TRUE(segments);
    renderer_->set_scene(mesh.mesh(), {point_buffer->handle, segments->handle, 3});
    Renderer::View view = view_of(sphere);
    view.settings.sky_directions = 0;
    const Picture without = draw(*renderer_, view);
    view.settings.lines = true;
    const Picture with = draw(*renderer_, view);
    EXPECT_GT(count_different(without, with, 20), 50u);
    EXPECT_LT(count_different(without, with, 20), 3000u);
}

TEST_F(Pictures, NeedNoOptionalBuffers) {
    const HostMesh cube = refine_to_limit(limn::test::make_cube(), 2);
    const DeviceMesh on_device = test::upload(device(), cube);
    RenderMesh mesh = on_device.mesh();
    mesh.places = mesh.triangle_faces = mesh.face_rates = VK_NULL_HANDLE;
    renderer_->set_scene(mesh, {});
    Renderer::View view = view_of(cube);
    view.settings.sky_directions = 0;
    for (const ColorMode mode : {ColorMode::kind, ColorMode::level, ColorMode::rate}) {
        view.settings.color = mode;
        EXPECT_FALSE(draw(*renderer_, view).rgb.empty());
    }
}

TEST_F(Pictures, DrawWhatTheDeviceCounted) {
    const HostMesh sphere = test::make_sphere(16);
    DeviceMesh mesh = test::upload(device(), sphere);
    renderer_->set_scene(mesh.mesh(), {});
    Renderer::View view = view_of(sphere);
    view.settings.color = ColorMode::sides;
    const size_t whole = count_covered(draw(*renderer_, view));
    for (const bool wireframe : {false, true}) {
        view.settings.wireframe = wireframe;
        for (const uint32_t count : {0u, static_cast<uint32_t>(sphere.indices.size())}) {
            ASSERT_TRUE(vk::upload_bytes(device(), mesh.indirect, 0, std::as_bytes(std::span(&count, 1))));
            EXPECT_EQ(count_covered(draw(*renderer_, view)), count == 0 ? 0 : whole);
        }
    }
}

TEST_F(Pictures, KeepTheirShadows) {
    const HostMesh cube = refine_to_limit(limn::test::make_cube(), 2);
    const DeviceMesh mesh = test::upload(device(), cube);
    renderer_->set_scene(mesh.mesh(), {});
    Renderer::View view = view_of(cube);
    const Picture first = draw(*renderer_, view);
    view.keep_shadows = true;
    EXPECT_EQ(count_different(first, draw(*renderer_, view), 0), 0u);
}

TEST_F(Pictures, TellHowLongPassesTook) {
    const HostMesh cube = refine_to_limit(limn::test::make_cube(), 2);
    const DeviceMesh mesh = test::upload(device(), cube);
    renderer_->set_scene(mesh.mesh(), {});
    PassTimer timer(device());
    (void)draw(*renderer_, view_of(cube), &timer);
    const auto passes = timer.read();
    if (passes.empty()) GTEST_SKIP() << "the queue has no timestamps";
    ASSERT_EQ(passes.size(), 3u);
    EXPECT_STREQ(passes[0].name, "key shadow");
    EXPECT_STREQ(passes[2].name, "picture");
    for (const auto& pass : passes) {
        EXPECT_GE(pass.milliseconds, 0);
        EXPECT_LT(pass.milliseconds, 60000);
    }
}

TEST_F(Pictures, HaveASizeThatTheDeviceDraws) {
    const auto none = renderer_->resize({0, 10});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::invalid_argument);
    const auto huge = renderer_->resize({1u << 20, 10});
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, ErrorCode::unsupported);
    EXPECT_NE(huge.error().message.find("1048576x10"), std::string::npos);
    EXPECT_EQ(renderer_->extent().width, kSize.width);
    ASSERT_TRUE(renderer_->resize({1, 1}));
    const HostMesh cube = refine_to_limit(limn::test::make_cube(), 1);
    EXPECT_EQ(draw_mesh(cube, view_of(cube)).rgb.size(), 3u);
}

using Cracks = Pictures;

const CameraView kCrackCameras[] = {{.azimuth = 17, .elevation = 21}, {.azimuth = 101, .elevation = -13}};

/// The size of a pixel where the eye looks.
float pixel_size(const Camera& camera) {
    return 2 * glm::distance(camera.eye, camera.target) * std::tan(0.5f * glm::radians(camera.fov)) /
           kSize.height;
}

TEST_F(Cracks, AreNotSeenWhereThereAreNone) {
    const HostMesh meshes[] = {
        refine_to_limit(limn::test::make_cube(), 4), refine_to_limit(limn::test::make_torus(6, 5), 3),
        refine_to_limit(limn::test::make_icosahedron(), 3), refine_to_limit(limn::test::make_prism(7), 3)};
    for (const HostMesh& mesh : meshes)
        for (const CameraView& camera : kCrackCameras) EXPECT_EQ(count_leaks(draw_sides(mesh, camera)), 0u);
}

TEST_F(Cracks, OfAMissingTriangleAreSeen) {
    for (const CameraView& view : kCrackCameras) {
        HostMesh mesh = refine_to_limit(limn::test::make_cube(), 2);
        const Camera camera = view_of(mesh, view).camera;
        const size_t triangle = find_triangle(mesh, camera.eye, camera.target + glm::vec3(0.05f));
        ASSERT_LT(triangle, mesh.triangle_count());
        cut_sliver(mesh, triangle, 1.5f * pixel_size(camera));
        EXPECT_EQ(count_leaks(draw_sides(mesh, view)), 0u);
        mesh.indices.resize(mesh.indices.size() - 3);
        EXPECT_GE(count_leaks(draw_sides(mesh, view)), 1u);
    }
}

TEST_F(Cracks, OfEdgesPulledApartAreSeen) {
    for (const CameraView& view : kCrackCameras) {
        HostMesh mesh = refine_to_limit(limn::test::make_cube(), 3);
        const Camera camera = view_of(mesh, view).camera;
        const size_t triangle = find_triangle(mesh, camera.eye, camera.target + glm::vec3(0.05f));
        ASSERT_LT(triangle, mesh.triangle_count());
        pull_apart(mesh, triangle, pixel_size(camera));
        EXPECT_GE(count_leaks(draw_sides(mesh, view)), 1u);
    }
}

using Surfaces = Pictures;

RateSettings uniform(float rate) {
    RateSettings settings;
    settings.value = rate;
    return settings;
}

limn::test::TestMesh loop_torus() {
    limn::test::TestMesh shape = limn::test::make_triangle_torus(6, 5);
    shape.options.scheme = Scheme::loop;
    return shape;
}

/// Of all tests; they are compiled once.
const SurfaceKernels* shared_kernels(const vk::Device& device) {
    static const SurfaceKernels* const kernels = [&device] {
        auto created = SurfaceKernels::create(device);
        EXPECT_TRUE(created);
        return new SurfaceKernels(std::move(*created));  // outlive the tests, as the device does
    }();
    return kernels;
}

/// Empty, and the test failed, on an error.
std::optional<SurfaceMesh> make_surface(const vk::Device& device, const limn::test::TestMesh& shape,
                                        const SurfaceMeshOptions& options = {}) {
    const auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh);
    if (!mesh) return std::nullopt;
    auto surface = SurfaceMesh::create(device, *shared_kernels(device), *mesh, shape.positions, options);
    EXPECT_TRUE(surface) << surface.error().message;
    if (!surface) return std::nullopt;
    return std::move(*surface);
}

TEST_F(Surfaces, AreTessellatedOnTheDevice) {
    for (const auto& shape : {limn::test::make_cube(), loop_torus()}) {
        auto surface = make_surface(device(), shape);
        ASSERT_TRUE(surface);
        const auto outcome = surface->tessellate(uniform(8));
        ASSERT_TRUE(outcome) << outcome.error().message;
        const HostMesh expected = refine_to_limit(shape, 3);
        EXPECT_EQ(outcome->triangle_count, expected.triangle_count());
        EXPECT_EQ(outcome->vertex_count, expected.positions.size());
        const auto bounds = surface->measure();
        ASSERT_TRUE(bounds) << bounds.error().message;
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(bounds->low[k], expected.bounds().low[k], 1e-4);
            EXPECT_NEAR(bounds->high[k], expected.bounds().high[k], 1e-4);
        }
        // The same picture as that of the mesh refined on the host, but for diagonals and rounding.
        renderer_->set_scene(surface->mesh(), surface->control_lines());
        const Renderer::View view = view_of(expected);
        const Picture picture = draw(*renderer_, view);
        EXPECT_LT(count_different(picture, draw_mesh(expected, view), 24), picture.rgb.size() / 3 / 100);
    }
}

TEST_F(Surfaces, HaveNoCracks) {
    for (const auto& shape : {limn::test::make_cube(), limn::test::make_prism(7), loop_torus()}) {
        auto surface = make_surface(device(), shape);
        ASSERT_TRUE(surface);
        ASSERT_TRUE(surface->tessellate(uniform(4)));
        const auto bounds = surface->measure();
        ASSERT_TRUE(bounds);
        for (const RateMode mode : {RateMode::pixel_error, RateMode::screen_length, RateMode::chord_error})
            for (const CameraView& camera : kCrackCameras) {
                const float aspect = static_cast<float>(kSize.width) / static_cast<float>(kSize.height);
                Renderer::View view = {.camera = Camera::frame(*bounds, camera, aspect), .bounds = *bounds};
                view.settings.color = ColorMode::sides;
                view.settings.sky_directions = 0;
                ASSERT_TRUE(surface->prepare({.mode = mode}));
                RateSettings rates;
                rates.mode = mode;
                rates.value = mode == RateMode::chord_error   ? 0.003f
                              : mode == RateMode::pixel_error ? 0.2f
                                                              : 5;
                rates.camera = rate_camera(view.camera, kSize.width, kSize.height);
                ASSERT_TRUE(surface->tessellate(rates));
                renderer_->set_scene(surface->mesh(), surface->control_lines());
                const Picture picture = draw(*renderer_, view);
                EXPECT_GT(count_covered(picture), 2000u);
                EXPECT_EQ(count_leaks(picture), 0u);
            }
    }
}

TEST_F(Surfaces, KnowFacesLevelsAndRates) {
    limn::test::TestMesh shape = limn::test::make_cube();
    shape.add_crease(0, 1, 2.3);
    auto surface = make_surface(device(), shape, {.places = true});
    ASSERT_TRUE(surface);
    std::vector<Picture> pictures;
    for (const float rate : {2.0f, 32.0f}) {
        ASSERT_TRUE(surface->tessellate(uniform(rate)));
        const auto bounds = surface->measure();
        ASSERT_TRUE(bounds);
        renderer_->set_scene(surface->mesh(), surface->control_lines());
        Renderer::View view = {.camera = Camera::frame(*bounds, {}, 4 / 3.0f), .bounds = *bounds};
        view.settings.sky_directions = 0;
        for (const ColorMode mode : {ColorMode::rate, ColorMode::level, ColorMode::kind}) {
            view.settings.color = mode;
            pictures.push_back(draw(*renderer_, view));
        }
    }
    EXPECT_GT(count_different(pictures[0], pictures[3], 40), 5000u);  // dark and bright rates
    EXPECT_GT(count_different(pictures[4], pictures[5], 40), 5000u);
}

TEST_F(Surfaces, MakeRoomForMore) {
    auto surface = make_surface(device(), limn::test::make_cube(), {.triangle_capacity = 16});
    ASSERT_TRUE(surface);
    const auto outcome = surface->tessellate(uniform(16));
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->status, vk::TessellationStatus::complete);
    EXPECT_EQ(outcome->triangle_count, 6u * 2 * 16 * 16);
    EXPECT_GE(surface->options().triangle_capacity, outcome->triangle_count);
    EXPECT_GE(surface->max_triangle_capacity(), surface->options().triangle_capacity);
}

TEST_F(Surfaces, MoveTheirVerticesAlone) {
    const auto shape = limn::test::make_cube();
    auto surface = make_surface(device(), shape);
    ASSERT_TRUE(surface);
    ASSERT_TRUE(surface->tessellate(uniform(4)));
    const auto before = surface->measure();
    ASSERT_TRUE(before);
    std::vector<float> moved = shape.positions;
    for (float& x : moved) x *= 2;
    const auto points = vk::create_point_buffer(device(), moved);
    ASSERT_TRUE(points);
    auto commands = vk::Commands::begin(device());
    ASSERT_TRUE(commands);
    const VkBufferCopy region = {0, 0, moved.size() * sizeof(float)};
    vkCmdCopyBuffer(*commands, points->handle, surface->control_points(), 1, &region);
    vk::record_barrier(device(), *commands, vk::kCopyWrites, vk::kKernelReads);
    surface->record_vertices(*commands);
    ASSERT_TRUE(commands->submit_and_wait());
    const auto after = surface->measure();
    ASSERT_TRUE(after);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(after->high[k], 2 * before->high[k], 1e-5);
}

TEST_F(Surfaces, RefuseWhatIsNotFinite) {
    const limn::test::TestMesh shape = limn::test::make_cube();
    const auto mesh = ControlMesh::create(shape.description());
    ASSERT_TRUE(mesh);
    std::vector<float> positions = shape.positions;
    positions[4] = NAN;
    auto surface = SurfaceMesh::create(device(), *shared_kernels(device()), *mesh, positions, {});
    ASSERT_TRUE(surface);
    const auto outcome = surface->tessellate(uniform(4));
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, ErrorCode::not_finite);
}

TEST(GraphicsDevices, AreRefusedByName) {
    const auto missing = GraphicsDevice::create({.device_index = 999});
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::no_device);
    EXPECT_NE(missing.error().message.find("999"), std::string::npos);
}

}  // namespace
}  // namespace limn::viewer
