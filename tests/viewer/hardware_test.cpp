// Hardware tessellation: pictures as those of the compute kernels' triangles, and no cracks in them.
#include <cmath>
#include <random>

#include "shapes/shapes.h"
#include "viewer/leaks.h"
#include "viewer/surface_mesh.h"
#include "viewer/viewer_test.h"

namespace limn::viewer {
namespace {

using limn::test::TestMesh;
using test::count_covered;
using test::count_leaks;

constexpr VkExtent2D kSize = {240, 180};
constexpr uint32_t kMostRateEdges = 4096;

struct Difference {
    double mean = 255;         ///< of a channel
    size_t outlier_count = 0;  ///< pixels that differ by more than 24
};
Difference compare(const Picture& a, const Picture& b) {
    Difference out;
    if (a.rgb.size() != b.rgb.size() || a.rgb.empty()) return out;
    double sum = 0;
    for (size_t i = 0; i < a.rgb.size(); i += 3) {
        int worst = 0;
        for (size_t k = 0; k < 3; ++k) {
            const int difference = std::abs(a.rgb[i + k] - b.rgb[i + k]);
            sum += difference;
            worst = std::max(worst, difference);
        }
        out.outlier_count += worst > 24;
    }
    out.mean = sum / static_cast<double>(a.rgb.size());
    return out;
}

TestMesh named(TestMesh mesh, const char* name) {
    mesh.name = name;
    return mesh;
}
TestMesh creased(double sharpness) {
    TestMesh cube = limn::test::make_cube();
    for (const auto& [a, b] : {std::pair{0u, 1u}, {1u, 3u}, {3u, 2u}, {2u, 0u}})
        if (cube.has_edge(a, b)) cube.add_crease(a, b, sharpness);
    return cube;
}
TestMesh loop(TestMesh mesh) {
    mesh.options.scheme = Scheme::loop;
    return mesh;
}
/// Quads, an n-gon among them, creases of which two meet in corners; Loop's triangles with a crease.
std::vector<TestMesh> closed_shapes() {
    TestMesh cut = limn::test::make_prism(5);
    for (uint32_t i = 0; i < 5; ++i) {
        if (cut.has_edge(i, (i + 1) % 5)) cut.add_crease(i, (i + 1) % 5, 10);
    }
    cut.add_corner(0, 10);
    TestMesh sharp = loop(limn::test::make_icosahedron());
    sharp.add_crease(sharp.face_vertices[0], sharp.face_vertices[1], 10);
    sharp.add_crease(sharp.face_vertices[1], sharp.face_vertices[2], 10);
    return {named(limn::test::make_cube(), "cube"),
            named(limn::test::make_torus(6, 5), "torus"),
            named(limn::test::make_prism(7), "prism"),
            named(creased(10), "sharp cube"),
            named(creased(2.3), "semi-sharp cube"),
            named(cut, "sharp prism"),
            named(loop(limn::test::make_triangle_torus(6, 5)), "loop torus"),
            named(sharp, "sharp loop")};
}

class Hardware : public test::ViewerTest {
  protected:
    void SetUp() override {
        test::ViewerTest::SetUp();
        if (HasFatalFailure()) return;
        if (!test::shared_device()->has_tessellation_shader()) GTEST_SKIP() << "no tessellation stages";
        // Compiled once; they outlive the tests, as the device does.
        static const SurfaceKernels* const shared = [this] {
            auto created = SurfaceKernels::create(device(), true);
            EXPECT_TRUE(created);
            return new SurfaceKernels(std::move(*created));
        }();
        kernels_ = shared;
        auto renderer = Renderer::create(device());
        ASSERT_TRUE(renderer);
        renderer_.emplace(std::move(*renderer));
        ASSERT_TRUE(renderer_->resize(kSize));
    }

    /// The surface, and a view of it.
    void load(const TestMesh& shape, const CameraView& camera = {.azimuth = 17, .elevation = 21}) {
        const auto mesh = ControlMesh::create(shape.description());
        ASSERT_TRUE(mesh);
        auto surface = SurfaceMesh::create(device(), *kernels_, *mesh, shape.positions, {});
        ASSERT_TRUE(surface) << surface.error().message;
        surface_.emplace(std::move(*surface));
        RateSettings coarse;
        coarse.value = 4;
        ASSERT_TRUE(surface_->tessellate(coarse));
        const auto bounds = surface_->measure();
        ASSERT_TRUE(bounds);
        view_ = {.camera = Camera::frame(*bounds, camera, 4 / 3.0f), .bounds = *bounds, .settings = {}};
        view_.settings.sky_directions = 8;
        ASSERT_TRUE(renderer_->prepare_hardware(*kernels_->hardware, surface_->scheme()));
    }

    Picture draw_by(bool hardware, RateSettings rates, std::span<const float> edge_rates = {}) {
        vk::Buffer buffer;
        if (!edge_rates.empty()) {
            auto uploaded = vk::create_point_buffer(device(), edge_rates);
            EXPECT_TRUE(uploaded);
            buffer = std::move(*uploaded);
        }
        const auto prepared = surface_->prepare({.mode = rates.mode,
                                                 .spacing = rates.spacing,
                                                 .hardware = hardware,
                                                 .edge_rates = buffer.handle});
        EXPECT_TRUE(prepared) << prepared.error().message;
        rates.camera = rate_camera(view_.camera, kSize.width, kSize.height);
        const auto done = surface_->tessellate(rates);
        EXPECT_TRUE(done) << done.error().message;
        renderer_->set_scene(surface_->mesh(), surface_->control_lines());
        return draw(*renderer_, view_);
    }

    static RateSettings settings(RateMode mode, float value, TessellationSpacing spacing) {
        RateSettings out;
        out.mode = mode;
        out.value = value;
        out.spacing = spacing;
        return out;
    }
    /// Where they are too small, triangles that join coarse sides to fine insides fold over, and show their backs.
    static std::vector<float> random_rates(uint32_t seed, float least, float most) {
        std::mt19937 random(seed);
        std::vector<float> rates(kMostRateEdges);
        for (float& rate : rates) rate = least + (most - least) * static_cast<float>(random() % 1024) / 1023;
        return rates;
    }

    const SurfaceKernels* kernels_ = nullptr;
    std::optional<Renderer> renderer_;
    std::optional<SurfaceMesh> surface_;
    Renderer::View view_;
};

constexpr TessellationSpacing kSpacings[] = {TessellationSpacing::integer, TessellationSpacing::fractional};

TEST_F(Hardware, DrawsWhatComputeKernelsDraw) {
    std::vector<TestMesh> shapes = closed_shapes();
    shapes.push_back(named(limn::test::make_grid(3, 2), "boundary"));
    shapes.push_back(named(loop(limn::test::make_triangle_grid(3, 3)), "loop boundary"));
    shapes.push_back(named(limn::test::make_book(3, false), "book"));
    for (const TestMesh& shape : shapes) {
        load(shape);
        for (const TessellationSpacing spacing : kSpacings) {
            SCOPED_TRACE(shape.name + (spacing == TessellationSpacing::integer ? "" : ", fractional"));
            const RateSettings rates = settings(RateMode::uniform, 11.3f, spacing);
            for (const ColorMode mode : {ColorMode::clay, ColorMode::normals, ColorMode::rate}) {
                view_.settings.color = mode;
                const Picture expected = draw_by(false, rates);
                const Difference difference = compare(draw_by(true, rates), expected);
                EXPECT_LT(difference.mean, 0.3);
                EXPECT_LT(difference.outlier_count, 60u);
            }
        }
    }
}

/// Where rates differ much, faces are divided otherwise, but by not more than their triangles' size.
TEST_F(Hardware, DrawsMixedRates) {
    for (const TestMesh& shape : closed_shapes()) {
        load(shape);
        for (const TessellationSpacing spacing : kSpacings) {
            SCOPED_TRACE(shape.name);
            const std::vector<float> edge_rates = random_rates(7, 1, 20);
            const RateSettings rates = settings(RateMode::per_edge, 1, spacing);
            const Picture expected = draw_by(false, rates, edge_rates);
            const Difference difference = compare(draw_by(true, rates, edge_rates), expected);
            EXPECT_LT(difference.mean, 2);
        }
    }
}

TEST_F(Hardware, HasNoCracks) {
    for (const TestMesh& shape : closed_shapes()) {
        for (const CameraView& camera : {CameraView{.azimuth = 17, .elevation = 21},
                                         CameraView{.azimuth = 101, .elevation = -13}}) {
            load(shape, camera);
            view_.settings.color = ColorMode::sides;
            view_.settings.sky_directions = 0;
            for (const TessellationSpacing spacing :
                 {TessellationSpacing::integer, TessellationSpacing::power_of_two, TessellationSpacing::fractional})
                for (const auto& [mode, value] : {std::pair{RateMode::chord_error, 0.003f},
                                                  {RateMode::pixel_error, 0.2f},
                                                  {RateMode::screen_length, 5.0f},
                                                  {RateMode::uniform, 64.0f}}) {
                    SCOPED_TRACE(shape.name + ", mode " + std::to_string(static_cast<int>(mode)));
                    const Picture picture = draw_by(true, settings(mode, value, spacing));
                    EXPECT_GT(count_covered(picture), 2000u);
                    EXPECT_EQ(count_leaks(picture), 0u);
                }
            for (const uint32_t seed : {1u, 2u, 3u}) {
                SCOPED_TRACE(shape.name + ", rates of edges " + std::to_string(seed));
                const RateSettings rates = settings(RateMode::per_edge, 1, kSpacings[seed % 2]);
                const Picture picture = draw_by(true, rates, random_rates(seed, 7, seed == 3 ? 64 : 20));
                EXPECT_GT(count_covered(picture), 2000u);
                EXPECT_EQ(count_leaks(picture), 0u);
            }
        }
    }
}

TEST_F(Hardware, DrawsNoFacesBesideEdgesOfRateZero) {
    size_t leaks = 0;
    for (const TestMesh& shape : closed_shapes()) {
        SCOPED_TRACE(shape.name);
        load(shape);
        view_.settings.color = ColorMode::sides;
        view_.settings.sky_directions = 0;
        const RateSettings rates = settings(RateMode::per_edge, 1, TessellationSpacing::integer);
        std::vector<float> edge_rates(kMostRateEdges, 8.0f);
        EXPECT_EQ(count_leaks(draw_by(true, rates, edge_rates)), 0u);
        edge_rates[0] = edge_rates[4] = 0;
        const Picture holes = draw_by(true, rates, edge_rates), expected = draw_by(false, rates, edge_rates);
        EXPECT_LT(compare(holes, expected).mean, 0.5);
        leaks += count_leaks(holes);
        EXPECT_EQ(count_covered(draw_by(true, rates, std::vector<float>(kMostRateEdges, 0.0f))), 0u);
    }
    EXPECT_GT(leaks, 1000u);
}

TEST_F(Hardware, DrawsNothingAfterBadSettings) {
    load(limn::test::make_cube());
    ASSERT_TRUE(surface_->prepare({.hardware = true}));
    RateSettings rates;
    rates.value = 4;
    rates.max_rate = 100;  // than which patch trees are coarser
    auto commands = vk::Commands::begin(device());
    ASSERT_TRUE(commands);
    EXPECT_FALSE(surface_->record(*commands, rates));
    ASSERT_TRUE(commands->submit_and_wait());
    view_.settings.color = ColorMode::sides;
    renderer_->set_scene(surface_->mesh(), surface_->control_lines());
    EXPECT_EQ(count_covered(draw(*renderer_, view_)), 0u);
}

TEST_F(Hardware, HoldsNoVertices) {
    load(limn::test::make_torus(12, 10));
    RateSettings rates;
    rates.value = 64;
    ASSERT_TRUE(surface_->tessellate(rates));
    const VkDeviceSize triangles = surface_->tessellation_bytes();
    ASSERT_TRUE(surface_->prepare({.hardware = true}));
    EXPECT_LT(100 * surface_->tessellation_bytes(), triangles);
}

TEST_F(Hardware, TakesTheFeature) {
    const auto refused = vk::HardwareTessellator::create({&device(), false});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::unsupported);
    const auto kernels = SurfaceKernels::create(device(), false);
    ASSERT_TRUE(kernels);
    const TestMesh shape = limn::test::make_cube();
    const auto mesh = ControlMesh::create(shape.description());
    ASSERT_TRUE(mesh);
    const auto surface = SurfaceMesh::create(device(), *kernels, *mesh, shape.positions, {.hardware = true});
    ASSERT_FALSE(surface);
    EXPECT_EQ(surface.error().code, ErrorCode::unsupported);
}

}  // namespace
}  // namespace limn::viewer
