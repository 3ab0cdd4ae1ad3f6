// Tessellation on the device against limn::tessellate: every index, every copied bit; vertices against the same surface
// in double, which other tests compare with OpenSubdiv.
#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "shapes/random_mesh.h"
#include "vulkan/tessellation_parity.h"

namespace limn::vk::test {
namespace {

using limn::test::TestMesh;

class TessellateOnDevice : public TessellatorTest, public testing::WithParamInterface<TestMesh> {};
INSTANTIATE_TEST_SUITE_P(All, TessellateOnDevice, testing::ValuesIn(limn::test::all_shapes()),
                         [](const auto& info) { return info.param.name; });

TEST_P(TessellateOnDevice, IsAsOnTheHost) {
    static uint32_t seed = 0;
    const auto spacing = static_cast<TessellationSpacing>(++seed % 3);
    TessellationRequest request = random_request(GetParam(), spacing, 9, seed);
    if (GetParam().face_count() > 500) request.vertex_capacity = request.triangle_capacity = 1 << 19;
    expect_as_on_host(tessellate_on_device(GetParam(), request), spacing);
}

TEST_F(TessellatorTest, RandomMeshesAreAsOnTheHost) {
    for (uint32_t seed = 0; seed < 25; ++seed) {
        const TestMesh shape = limn::test::random_mesh(seed + 5000);
        const auto spacing = static_cast<TessellationSpacing>(seed % 3);
        SCOPED_TRACE("seed " + std::to_string(seed + 5000));
        expect_as_on_host(tessellate_on_device(shape, random_request(shape, spacing, 7, seed)), spacing);
    }
}

TEST_F(TessellatorTest, DooSabinIsAsOnTheHost) {
    uint32_t seed = 0;
    for (const TestMesh& shape : limn::test::doo_sabin_shapes()) {
        const auto spacing = static_cast<TessellationSpacing>(++seed % 3);
        SCOPED_TRACE(shape.name);
        expect_as_on_host(tessellate_on_device(shape, random_request(shape, spacing, 9, seed)), spacing);
    }
}

// The kernels that read storage buffers, which devices other than CPUs run.
TEST_F(TessellatorTest, StorageBuffersAreAsTexelBuffers) {
    pretend_gpu();
    TestMesh loop = limn::test::make_triangle_globe(7, 3);
    loop.options.scheme = Scheme::loop;
    std::vector<TestMesh> shapes = {limn::test::make_globe(5, 2), limn::test::make_prism(5), loop};
    for (const TestMesh& shape : limn::test::face_varying_shapes())
        if (shape.name.ends_with("edge_only") && shapes.size() < 12) shapes.push_back(shape);
    for (size_t i = 0; i < shapes.size(); ++i) {
        const auto spacing = static_cast<TessellationSpacing>(i % 3);
        TessellationRequest request = random_request(shapes[i], spacing, 9, static_cast<uint32_t>(i));
        request.offset_words = 5;
        SCOPED_TRACE(shapes[i].name);
        expect_as_on_host(tessellate_on_device(shapes[i], request), spacing);
        request.settings = {.mode = RateMode::chord_error, .value = 1e-3f, .spacing = spacing};
        request.settings.cull_outside = request.settings.cull_backfaces = true;
        request.fit_capacity = true;
        request.triangle_capacity = 900;
        const TessellatedShape t = tessellate_on_device(shapes[i], request);
        EXPECT_NE(t.result.status, TessellationStatus::bad_settings);
        EXPECT_LE(t.result.triangle_count, 900u);
    }
}

// Vertices and triangles are written in slices where they are more than a device binds at once.
TEST_F(TessellatorTest, SlicesAreAsOne) {
    constexpr uint32_t range = 1 << 18;
    pretend_gpu(range);
    for (const TestMesh& shape : {limn::test::make_globe(6, 3), limn::test::make_torus(6, 4)}) {
        TessellationRequest request = random_request(shape, TessellationSpacing::integer, 40, 2);
        request.offset_words = 3;
        const TessellatedShape t = tessellate_on_device(shape, request);
        EXPECT_GT(24 * uint64_t{t.result.vertex_count}, range);
        EXPECT_GT(12 * uint64_t{t.result.triangle_count}, range);
        expect_as_on_host(t, TessellationSpacing::integer);
    }
}

// The deepest that trees go.
TEST_F(TessellatorTest, HighRatesAreAsOnTheHost) {
    for (const TestMesh& shape : {limn::test::make_globe(5, 1), limn::test::make_prism(5), limn::test::make_icosahedron()}) {
        TestMesh scheme = shape;
        if (std::ranges::all_of(shape.face_sizes, [](uint32_t n) { return n == 3; })) scheme.options.scheme = Scheme::loop;
        for (const auto spacing : {TessellationSpacing::integer, TessellationSpacing::fractional}) {
            TessellationRequest request = random_request(scheme, spacing, 64, 3);
            request.max_rate = request.settings.max_rate = 128;
            request.vertex_capacity = request.triangle_capacity = 1 << 19;
            expect_as_on_host(tessellate_on_device(scheme, request), spacing);
        }
    }
}

TEST_F(TessellatorTest, TwoRunsHaveTheSameBits) {
    const TestMesh shape = limn::test::make_messy_torus(12, 9, 4);
    TessellationRequest request;
    request.settings = {.mode = RateMode::chord_error, .value = 1e-3f};
    request.fit_capacity = true;
    request.triangle_capacity = 9000;
    const TessellatedShape first = tessellate_on_device(shape, request), second = tessellate_on_device(shape, request);
    EXPECT_EQ(std::memcmp(&first.result, &second.result, sizeof(first.result)), 0);
    EXPECT_EQ(first.indices, second.indices);
    EXPECT_EQ(first.places, second.places);
    ASSERT_EQ(first.positions.size(), second.positions.size());
    EXPECT_EQ(std::memcmp(first.positions.data(), second.positions.data(), 4 * first.positions.size()), 0);
    EXPECT_EQ(std::memcmp(first.normals.data(), second.normals.data(), 4 * first.normals.size()), 0);
}

// It decides how many invocations share rows and faces, not what they write.
TEST_F(TessellatorTest, TheLargestRateChangesNoBit) {
    for (const TestMesh& shape : {limn::test::make_messy_torus(12, 9, 4), limn::test::make_globe(5, 2)}) {
        for (const float rate : {1.0f, 5.0f, 12.0f}) {
            TestMesh moved = shape;
            for (size_t i = 0; i < moved.positions.size(); i += 3) moved.positions[i] *= 3;
            TessellationRequest request;
            request.settings = {.value = rate};
            const TessellatedShape frame = tessellate_on_device(moved, request);
            request.later_positions = moved.positions;
            const TessellatedShape passes = tessellate_on_device(shape, request);
            EXPECT_EQ(frame.indices, passes.indices);
            ASSERT_EQ(frame.positions.size(), passes.positions.size());
            EXPECT_EQ(std::memcmp(frame.positions.data(), passes.positions.data(), 4 * frame.positions.size()), 0);
            EXPECT_EQ(std::memcmp(frame.normals.data(), passes.normals.data(), 4 * frame.normals.size()), 0);
        }
    }
}

TEST_F(TessellatorTest, OffsetsAndStridesAreKept) {
    const TestMesh shape = limn::test::make_globe(6, 2);
    TessellationRequest request = random_request(shape, TessellationSpacing::integer, 6, 8);
    request.offset_words = 37;
    request.stride = 11;
    expect_as_on_host(tessellate_on_device(shape, request), TessellationSpacing::integer);
    request.outputs = false;  // positions alone
    const TessellatedShape bare = tessellate_on_device(shape, request);
    EXPECT_EQ(bare.result.status, TessellationStatus::complete);
    EXPECT_EQ(bare.indices, tessellate_on_host(bare, TessellationSpacing::integer).indices);
}

TEST_F(TessellatorTest, PreviousPositionsAreThoseOfThePreviousPoints) {
    const TestMesh shape = limn::test::make_globe(5, 2);
    TessellationRequest request = random_request(shape, TessellationSpacing::integer, 6, 9);
    request.previous = true;
    const TessellatedShape t = tessellate_on_device(shape, request);
    ASSERT_EQ(t.previous.size(), t.positions.size());
    ASSERT_FALSE(t.previous.empty());
    for (size_t i = 0; i < t.positions.size(); ++i)
        ASSERT_NEAR(t.previous[i], t.positions[i] + (i % 3 == 0 ? 1 : 0), 2 * t.tolerance);
}

// Curvature decides the rates: computed anew, they would change with the points.
TEST_F(TessellatorTest, VerticesMoveWhileRatesStay) {
    for (const TestMesh& shape : {limn::test::make_globe(5, 2), limn::test::make_prism(5)}) {
        TessellationRequest request;
        request.settings = {.mode = RateMode::chord_error, .value = 1e-2f};
        const TessellatedShape before = tessellate_on_device(shape, request);
        request.later_positions = shape.positions;
        for (size_t i = 0; i < shape.positions.size(); i += 3) request.later_positions[i] *= 3;
        const TessellatedShape after = tessellate_on_device(shape, request);
        EXPECT_EQ(after.rates, before.rates);
        EXPECT_EQ(after.indices, before.indices);
        expect_as_on_host(after, TessellationSpacing::integer);
        const auto anew = compute_rates(after.patches, after.table, request.settings, after.points);
        ASSERT_TRUE(anew);
        EXPECT_NE(*anew, after.rates);
    }
}

TEST_F(TessellatorTest, TrianglesRunTheOtherWay) {
    const TestMesh shape = limn::test::make_globe(5, 2);
    TessellationRequest request = random_request(shape, TessellationSpacing::integer, 6, 12);
    request.clockwise = true;
    TessellatedShape t = tessellate_on_device(shape, request);
    ASSERT_FALSE(t.indices.empty());
    for (size_t i = 0; i < t.indices.size(); i += 3) std::swap(t.indices[i + 1], t.indices[i + 2]);
    expect_as_on_host(t, TessellationSpacing::integer);
}

/// Rates that each mode gives, device against host: they may round a target in two ways.
TEST_F(TessellatorTest, ModesMeasureAsOnTheHost) {
    const TestMesh shape = limn::test::make_messy_torus(10, 8, 2);
    Camera camera;
    const float size = static_cast<float>(shape.size());
    // Looks along -z from three sizes away, 60 degrees wide: x and y times 1.7, w = 3 sizes - z.
    const float matrix[16] = {1.7f, 0, 0, 0, 0, -1.7f, 0, 0, 0, 0, -1, -1, 0, 0, 3 * size - 0.1f, 3 * size};
    std::copy_n(matrix, 16, camera.matrix);
    camera.width = 800;
    camera.height = 600;
    const std::pair<RateMode, float> modes[] = {{RateMode::uniform, 12},        {RateMode::screen_length, 6},
                                                {RateMode::pixel_error, 0.05f}, {RateMode::chord_error, size * 1e-4f},
                                                {RateMode::distance, size * 20}};
    for (const auto& [mode, value] : modes) {
        for (const auto spacing : {TessellationSpacing::integer, TessellationSpacing::power_of_two,
                                   TessellationSpacing::fractional}) {
            TessellationRequest request;
            request.outputs = false;
            request.settings = {.mode = mode, .value = value, .spacing = spacing, .camera = camera};
            request.vertex_capacity = request.triangle_capacity = 1 << 20;
            const TessellatedShape t = tessellate_on_device(shape, request);
            ASSERT_EQ(t.result.status, TessellationStatus::complete);
            const auto host = compute_rates(t.patches, t.table, request.settings, t.points);
            ASSERT_TRUE(host);
            size_t different = 0, many = 0;
            for (size_t e = 0; e < t.rates.size(); ++e) {
                const double ratio = static_cast<double>(t.rates[e]) / (*host)[e];
                different += std::abs(ratio - 1) > 1e-4;
                many += (*host)[e] > 2 * shared::kRateOne;
            }
            EXPECT_LE(different, t.rates.size() / 100) << static_cast<int>(mode);
            EXPECT_GT(many, t.rates.size() / 4) << static_cast<int>(mode);
            EXPECT_EQ(t.indices, tessellate_on_host(t, spacing).indices);
        }
    }
}

// What the issue of a budget is: never more than fits, and not much less.
TEST_F(TessellatorTest, RatesAreScaledToFitTheCapacity) {
    const TestMesh torus = limn::test::make_messy_torus(16, 12, 6);
    TestMesh globe = limn::test::make_globe(7, 12), loop = limn::test::make_triangle_torus(14, 10);
    loop.options.scheme = Scheme::loop;
    for (const TestMesh& shape : {torus, globe, loop}) {
        for (const auto spacing : {TessellationSpacing::integer, TessellationSpacing::power_of_two,
                                   TessellationSpacing::fractional}) {
            for (const RateMode mode : {RateMode::uniform, RateMode::chord_error}) {
                TessellationRequest request;
                request.outputs = false;
                request.fit_capacity = true;
                request.settings = {.mode = mode,
                                    .value = mode == RateMode::uniform ? 24 : static_cast<float>(shape.size() * 1e-6),
                                    .spacing = spacing};
                request.vertex_capacity = 1 << 19;
                for (const uint32_t capacity : {11000u, 30000u, 77777u}) {
                    request.triangle_capacity = capacity;
                    const TessellatedShape t = tessellate_on_device(shape, request);
                    ASSERT_EQ(t.result.status, TessellationStatus::scaled);
                    EXPECT_LE(t.result.triangle_count, capacity);
                    EXPECT_GE(t.result.triangle_count, capacity * 0.9) << static_cast<int>(spacing) << static_cast<int>(mode);
                    EXPECT_LT(t.result.rate_scale, 1);
                    EXPECT_EQ(t.indices, tessellate_on_host(t, spacing).indices);
                }
                request.triangle_capacity = 1 << 20;
                request.vertex_capacity = 12000;  // vertices may bind, too
                const TessellatedShape t = tessellate_on_device(shape, request);
                EXPECT_LE(t.result.vertex_count, 12000u);
                EXPECT_GE(t.result.vertex_count, 12000 * 0.9);
            }
        }
    }
}

TEST_F(TessellatorTest, FlatFacesAreDrawnAndSmallErrorsFit) {
    TestMesh cube = limn::test::make_cube();
    cube.options.scheme = Scheme::bilinear;
    TessellationRequest request;
    request.settings = {.mode = RateMode::chord_error, .value = 1e-3f};
    EXPECT_EQ(tessellate_on_device(cube, request).result.triangle_count, 12u);
    request.settings.value = 1e-30f;
    request.fit_capacity = true;
    request.triangle_capacity = 1000;
    const TessellatedShape t = tessellate_on_device(limn::test::make_globe(5, 4), request);
    EXPECT_EQ(t.result.status, TessellationStatus::scaled);
    EXPECT_GE(t.result.triangle_count, 900u);
}

TEST_F(TessellatorTest, RatesThatFitAreNotScaled) {
    const TestMesh shape = limn::test::make_globe(5, 3);
    TessellationRequest request = random_request(shape, TessellationSpacing::integer, 9, 1);
    request.fit_capacity = true;
    expect_as_on_host(tessellate_on_device(shape, request), TessellationSpacing::integer);
}

void expect_empty(const TessellatedShape& t, TessellationStatus status) {
    EXPECT_EQ(t.result.status, status);
    EXPECT_EQ(t.result.vertex_count, 0u);
    EXPECT_EQ(t.result.triangle_count, 0u);
    EXPECT_EQ(t.command[0], 0u);
    EXPECT_EQ(t.command[1], 1u);
}

TEST_F(TessellatorTest, WhatCannotBeDrawnIsEmpty) {
    TestMesh shape = limn::test::make_globe(5, 3);
    TessellationRequest request;
    request.settings.value = 6;
    for (const bool fit : {false, true}) {
        request.fit_capacity = fit;
        for (const uint32_t capacity : {0u, 1u, 10u}) {
            request.triangle_capacity = capacity;
            request.vertex_capacity = 1 << 16;
            expect_empty(tessellate_on_device(shape, request), TessellationStatus::too_small);
            request.vertex_capacity = capacity;
            request.triangle_capacity = 1 << 16;
            expect_empty(tessellate_on_device(shape, request), TessellationStatus::too_small);
        }
    }
    request = {};
    request.settings.value = NAN;
    TessellatedShape t = tessellate_on_device(shape, request);
    EXPECT_FALSE(t.recorded);
    expect_empty(t, TessellationStatus::bad_settings);
    request.settings = {.mode = RateMode::screen_length, .value = 4};
    for (const float width : {0.0f, -1.0f, HUGE_VALF, NAN}) {
        request.settings.camera.width = width;
        expect_empty(tessellate_on_device(shape, request), TessellationStatus::bad_settings);
    }
    request.settings.camera.width = 640;
    for (const float bad : {NAN, HUGE_VALF}) {
        request.settings.camera.matrix[6] = bad;
        expect_empty(tessellate_on_device(shape, request), TessellationStatus::bad_settings);
    }
    // More than the trees are for, and than loops over powers of two could count to.
    for (const uint32_t most : {128u, ~0u}) {
        request.settings = {.value = 4e9f, .spacing = TessellationSpacing::power_of_two, .max_rate = most};
        expect_empty(tessellate_on_device(shape, request), TessellationStatus::bad_settings);
    }
    // A point that is no number, wherever it is.
    const std::vector<float> positions = shape.positions;
    for (size_t i = 0; i < positions.size(); i += 7) {
        shape.positions[i] = i % 2 == 0 ? NAN : HUGE_VALF;
        for (const RateMode mode : {RateMode::uniform, RateMode::chord_error}) {
            request = {};
            request.settings = {.mode = mode, .value = mode == RateMode::uniform ? 5 : 1e-2f};
            const TessellatedShape broken = tessellate_on_device(shape, request);
            EXPECT_EQ(broken.result.status, TessellationStatus::not_finite) << i;
            EXPECT_EQ(broken.command[0], 0u);
        }
        shape.positions = positions;
    }
    // A camera that all is behind is a good camera.
    request = {};
    request.settings = {.mode = RateMode::screen_length, .value = 4};
    const float behind[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, -50, -50};
    std::copy_n(behind, 16, request.settings.camera.matrix);
    request.settings.camera.width = request.settings.camera.height = 100;
    const TessellatedShape least = tessellate_on_device(shape, request);
    EXPECT_EQ(least.result.status, TessellationStatus::complete);
    for (const uint32_t rate : least.rates) EXPECT_EQ(rate, shared::kRateOne);
}

/// x y z of each of a triangle's corners.
std::array<double, 9> corners_of(const TessellatedShape& t, size_t triangle) {
    std::array<double, 9> out;
    for (size_t c = 0; c < 3; ++c)
        for (size_t k = 0; k < 3; ++k) out[3 * c + k] = t.positions[3 * size_t{t.indices[3 * triangle + c]} + k];
    return out;
}

// What is culled is not seen; what is drawn has the same rates as without, so that no crack opens between.
TEST_F(TessellatorTest, CullingLeavesOutWhatIsNotSeen) {
    TestMesh globe = limn::test::make_globe(16, 14), loop = limn::test::make_triangle_torus(24, 16);
    loop.options.scheme = Scheme::loop;
    for (const TestMesh& shape : {globe, limn::test::make_messy_torus(24, 16, 3), loop}) {
        const auto size = static_cast<float>(shape.size());
        for (const bool perspective : {true, false}) {
            TessellationRequest request;
            request.settings = {.value = 4};
            Camera& camera = request.settings.camera;
            const float zoom = shape.face_count() == globe.face_count() ? 14 : 9;  // the globe has larger faces
            const float matrix[16] = {zoom / size, 0, 0, 0, 0, -zoom / size, 0, 0, 0, 0, -1 / (9 * size), -1 / size,
                                      0.3f,     0, 1, 3};
            std::copy_n(matrix, 16, camera.matrix);
            if (!perspective) {
                camera.matrix[11] = 0;
                camera.matrix[15] = 1.2f;
            }
            camera.width = camera.height = 512;
            const TessellatedShape whole = tessellate_on_device(shape, request);
            for (const bool outside : {true, false}) {
                request.settings.cull_outside = outside;
                request.settings.cull_backfaces = !outside;
                const TessellatedShape t = tessellate_on_device(shape, request);
                ASSERT_EQ(t.rates, whole.rates);
                EXPECT_LT(t.result.triangle_count, whole.result.triangle_count * 0.9) << outside << perspective;
                EXPECT_GT(t.result.triangle_count, 0u);
                std::set<uint32_t> drawn(t.triangle_faces.begin(), t.triangle_faces.end());
                // Each face that is drawn has all of its triangles.
                std::map<uint32_t, size_t> with, without;
                for (const uint32_t f : t.triangle_faces) ++with[f];
                for (const uint32_t f : whole.triangle_faces) ++without[f];
                for (const auto& [f, count] : with) ASSERT_EQ(count, without[f]);
                // And what is left out lies outside, or faces away.
                for (size_t i = 0; i < whole.triangle_faces.size(); ++i) {
                    if (drawn.count(whole.triangle_faces[i]) != 0) continue;
                    const auto p = corners_of(whole, i);
                    double clip[3][4];
                    for (size_t c = 0; c < 3; ++c)
                        for (size_t k = 0; k < 4; ++k)
                            clip[c][k] = camera.matrix[k] * p[3 * c] + camera.matrix[4 + k] * p[3 * c + 1] +
                                         camera.matrix[8 + k] * p[3 * c + 2] + camera.matrix[12 + k];
                    if (outside) {
                        bool beyond = false;
                        for (const int axis : {0, 1})
                            for (const int sign : {-1, 1}) {
                                bool all = true;
                                for (const auto& v : clip) all &= sign * v[axis] > v[3];
                                beyond |= all;
                            }
                        ASSERT_TRUE(beyond) << "triangle " << i;
                    } else {
                        // On screen, y down, what faces the camera runs clockwise.
                        double x[3], y[3];
                        for (size_t c = 0; c < 3; ++c) x[c] = clip[c][0] / clip[c][3], y[c] = clip[c][1] / clip[c][3];
                        const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
                        ASSERT_GT(area, -1e-9) << "triangle " << i;
                    }
                }
                // Between faces that are drawn no edge is open.
                std::map<std::pair<uint32_t, uint32_t>, int> edges;
                const limn::Tessellation sources = tessellate_on_host(whole, TessellationSpacing::integer);
                std::map<std::array<float, 3>, uint32_t> numbers;
                std::vector<uint32_t> number(t.positions.size() / 3);
                for (size_t v = 0; v < number.size(); ++v)
                    number[v] = numbers.try_emplace({t.positions[3 * v], t.positions[3 * v + 1], t.positions[3 * v + 2]},
                                                    static_cast<uint32_t>(v)).first->second;
                for (size_t i = 0; i < t.indices.size(); i += 3)
                    for (size_t c = 0; c < 3; ++c)
                        ++edges[{number[t.indices[i + c]], number[t.indices[i + (c + 1) % 3]]}];
                size_t open = 0;
                for (const auto& [edge, uses] : edges) open += edges.count({edge.second, edge.first}) == 0;
                // Open edges are those next to faces that are not drawn, of which there are few.
                std::set<uint32_t> beside;
                size_t border = 0;
                for (size_t e = 0; e < t.table.rate_edge_count; ++e) {
                    const uint32_t* words = t.table.rate_edges.data() + e * shared::kRateEdgeWords;
                    if (words[0] == shared::kNoRateEdge || words[1] == shared::kManyFaces || words[2] == shared::kNoFace)
                        continue;
                    if (drawn.count(words[1]) != drawn.count(words[2])) border += t.rates[e] / shared::kRateOne;
                }
                EXPECT_GE(open, border);
                if (shape.options.scheme == Scheme::loop) {
                    EXPECT_EQ(open, border);
                }
            }
        }
    }
}

// Projected edges of a tessellation for one pixel, of what is seen.
TEST_F(TessellatorTest, SegmentsAreAsLongOnScreenAsAsked) {
    const TestMesh shape = limn::test::make_torus(20, 12);
    const auto size = static_cast<float>(shape.size());
    TessellationRequest request;
    request.settings = {.mode = RateMode::screen_length, .value = 1};
    Camera& camera = request.settings.camera;
    const float matrix[16] = {1.9f / size, 0, 0, 0, 0, -1.9f / size, 0, 0, 0, 0, -1 / (9 * size), -1 / size,
                              0,           0, 1, 3};
    std::copy_n(matrix, 16, camera.matrix);
    camera.width = camera.height = 600;
    request.vertex_capacity = 1 << 19;
    request.triangle_capacity = 1 << 20;
    const TessellatedShape t = tessellate_on_device(shape, request);
    ASSERT_EQ(t.result.status, TessellationStatus::complete);
    // Vertices of a face's sides and inside, along rows and columns: diagonals are longer by their nature.
    size_t count = 0, good = 0;
    for (size_t i = 0; i < t.triangle_faces.size(); ++i) {
        const auto p = corners_of(t, i);
        double x[3], y[3];
        for (size_t c = 0; c < 3; ++c) {
            double clip[4];
            for (size_t k = 0; k < 4; ++k)
                clip[k] = camera.matrix[k] * p[3 * c] + camera.matrix[4 + k] * p[3 * c + 1] +
                          camera.matrix[8 + k] * p[3 * c + 2] + camera.matrix[12 + k];
            x[c] = clip[0] / clip[3] * camera.width / 2;
            y[c] = clip[1] / clip[3] * camera.height / 2;
        }
        if ((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]) > 0) continue;  // faces away
        for (int c = 0; c < 3; ++c) {
            const double length = std::hypot(x[(c + 1) % 3] - x[c], y[(c + 1) % 3] - y[c]);
            ++count;
            good += length >= 0.5 && length <= 2;
        }
    }
    ASSERT_GT(count, 100000u);
    EXPECT_GE(static_cast<double>(good) / static_cast<double>(count), 0.99);
}

TEST_F(TessellatorTest, RatesAloneAreThoseOfTriangles) {
    TestMesh shape = limn::test::make_prism(7);
    for (const RateMode mode : {RateMode::uniform, RateMode::chord_error}) {
        TessellationRequest request;
        request.settings.mode = mode;
        request.settings.value = mode == RateMode::uniform ? 6.4f : 0.001f;
        request.outputs = false;
        const TessellatedShape whole = tessellate_on_device(shape, request);
        request.rates_only = true;
        const TessellatedShape rates = tessellate_on_device(shape, request);
        EXPECT_TRUE(rates.recorded);
        EXPECT_EQ(rates.rates, whole.rates);
        EXPECT_EQ(rates.result.status, TessellationStatus::complete);
        EXPECT_EQ(rates.result.vertex_count, 0u);
        EXPECT_EQ(std::bit_cast<float>(rates.command[0]), -7.5f);  // untouched
        EXPECT_EQ(rates.positions.size() + rates.indices.size(), 0u);
    }
    TessellationRequest request;
    request.outputs = false;
    request.rates_only = true;
    shape.positions[0] = NAN;
    EXPECT_EQ(tessellate_on_device(shape, request).result.status, TessellationStatus::not_finite);
    request.settings.value = NAN;
    EXPECT_FALSE(tessellate_on_device(shape, request).recorded);
}

/// Copies are searched by halving (tess_hardware.tesc).
TEST_F(TessellatorTest, CopiesAscend) {
    TestMesh shape = limn::test::make_torus(6, 5);
    for (uint32_t i = 0; i < shape.vertex_count; i += 3)
        for (uint32_t j = 0; j < shape.vertex_count; ++j)
            if (i < j && shape.has_edge(i, j)) shape.add_crease(i, j, 10);
    const TessellationTable table = *build_tessellation_table(*ControlMesh::create(shape.description()), {});
    for (const Array<uint32_t>* copies : {&table.corner_copies, &table.row_copies}) {
        ASSERT_GT(copies->size(), 4u);
        for (size_t i = 2; i < copies->size(); i += 2) EXPECT_LT((*copies)[i - 2], (*copies)[i]);
    }
}

TEST_F(TessellatorTest, PrepareChecksWhatItIsGiven) {
    const DevicePatchTable patches;
    const DeviceTessellationTable table;
    EXPECT_FALSE(tessellator_->prepare({}));
    EXPECT_FALSE(tessellator_->prepare({.patches = &patches, .table = &table}));
}

}  // namespace
}  // namespace limn::vk::test
