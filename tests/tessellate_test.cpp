// Tessellations: closed wherever the control mesh is, by their indices; every vertex on the surface, every copy the
// same bits.
#include "limn/tessellate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <random>
#include <tuple>

#include "limn/topology.h"
#include "shapes/random_mesh.h"
#include "shapes/tessellation_checks.h"

namespace limn::test {
namespace {

struct Built {
    ControlMesh mesh;
    PatchTable patches;
    TessellationTable table;
    std::vector<double> points;
};

Built build(const TestMesh& shape, const TessellationTableOptions& options = {}) {
    auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh);
    auto patches = build_patch_table<float>(*mesh, {});
    EXPECT_TRUE(patches);
    auto table = build_tessellation_table(*mesh, options);
    EXPECT_TRUE(table);
    Built built{std::move(*mesh), std::move(*patches), std::move(*table), {}};
    built.points.resize(size_t{built.patches.point_count()} * 3);
    build_patch_points<float>(built.patches, shape.positions_double(), 3, built.points);
    return built;
}

std::vector<uint32_t> all_channels(const TestMesh& shape) {
    std::vector<uint32_t> channels;
    for (uint32_t c = 0; c < shape.channels.size(); ++c) channels.push_back(c);
    return channels;
}

class TessellateShape : public testing::TestWithParam<TestMesh> {};
INSTANTIATE_TEST_SUITE_P(All, TessellateShape, testing::ValuesIn(all_shapes()),
                         [](const auto& info) { return info.param.name; });

TEST_P(TessellateShape, IsClosedWhereTheControlMeshIs) {
    const std::vector<uint32_t> channels = all_channels(GetParam());
    const Built b = build(GetParam(), {.channels = channels});
    std::mt19937 random(1);
    for (const TessellationSpacing spacing : {TessellationSpacing::integer, TessellationSpacing::fractional}) {
        for (const uint32_t most : {3u, 17u}) {
            const auto rates = random_rates(b.mesh, b.table, spacing, most, random);
            const auto tessellation = tessellate(b.table, rates, spacing);
            ASSERT_TRUE(tessellation);
            EXPECT_EQ(find_tessellation_fault(b.mesh, b.table, rates, spacing, *tessellation), "");
        }
    }
}

TEST_P(TessellateShape, LiesOnTheSurface) {
    const std::vector<uint32_t> channels = all_channels(GetParam());
    const Built b = build(GetParam(), {.channels = channels});
    std::mt19937 random(2);
    const auto rates = random_rates(b.mesh, b.table, TessellationSpacing::integer, 6, random);
    const auto t = tessellate(b.table, rates, TessellationSpacing::integer);
    ASSERT_TRUE(t);
    std::vector<double> positions(t->places.size() * 3), normals(positions.size());
    evaluate_tessellation(b.patches, *t, b.points, positions, normals);
    std::vector<double> values(t->places.size() * 9);
    std::vector<SampleStatus> statuses(t->places.size());
    evaluate_patches(b.patches, t->places, b.points, 3, Derivatives::first, values, statuses);
    const double tolerance = 1e-6 * GetParam().size();
    for (size_t i = 0; i < t->places.size(); ++i) {
        ASSERT_EQ(statuses[i], SampleStatus::valid) << i;
        for (size_t k = 0; k < 3; ++k) {
            // The place of a copy gives the same point of the surface as what it copies.
            ASSERT_NEAR(positions[3 * i + k], values[9 * i + k], tolerance) << "vertex " << i;
            const size_t source = t->position_sources[i];
            ASSERT_EQ(std::memcmp(&positions[3 * i], &positions[3 * source], 24), 0) << "vertex " << i;
        }
    }
}

// A vertex that faces share is at one place of each; all of these are the same point.
TEST_P(TessellateShape, CornersOfFacesAreWhereTheFaceSaysTheyAre) {
    const Built b = build(GetParam());
    const std::vector<uint32_t> rates(b.table.rate_edge_count, 2 * shared::kRateOne);
    const auto t = tessellate(b.table, rates, TessellationSpacing::integer);
    ASSERT_TRUE(t);
    std::vector<double> positions(t->places.size() * 3);
    evaluate_tessellation(b.patches, *t, b.points, positions, {});
    const bool triangle = GetParam().options.scheme == Scheme::loop;
    std::vector<PatchSample> samples;
    std::vector<uint32_t> vertices;
    for (uint32_t f = 0; f < b.table.face_count; ++f) {
        const uint32_t* words = b.table.faces.data() + size_t{f} * shared::kTessFaceWords;
        if (words[0] == shared::kNoSide) continue;
        for (uint32_t k = 0; k < (triangle ? 3u : 4u); ++k) {
            PatchSample s = {f, 0, 0};
            shared::locate_on_side(triangle, k, 0, s.u, s.v);
            samples.push_back(s);
            vertices.push_back(words[4 + k]);
        }
    }
    std::vector<double> values(samples.size() * 3);
    std::vector<SampleStatus> statuses(samples.size());
    evaluate_patches(b.patches, samples, b.points, 3, Derivatives::none, values, statuses);
    for (size_t i = 0; i < samples.size(); ++i)
        for (size_t k = 0; k < 3; ++k)
            ASSERT_NEAR(positions[3 * size_t{vertices[i]} + k], values[3 * i + k], 1e-6 * GetParam().size());
}

TEST(Tessellate, RandomMeshesAreClosed) {
    for (uint64_t seed = 0; seed < 200; ++seed) {
        const TestMesh shape = random_mesh(seed);
        const std::vector<uint32_t> channels = all_channels(shape);
        const Built b = build(shape, {.channels = channels});
        std::mt19937 random(static_cast<uint32_t>(seed));
        const auto spacing = static_cast<TessellationSpacing>(seed % 3);
        const auto rates = random_rates(b.mesh, b.table, spacing, static_cast<uint32_t>(2 + seed % 15), random);
        const auto t = tessellate(b.table, rates, spacing);
        ASSERT_TRUE(t);
        EXPECT_EQ(find_tessellation_fault(b.mesh, b.table, rates, spacing, *t), "") << "seed " << seed;
    }
}

TEST(Tessellate, FacesWithARateOfZeroLeaveTheOthersClosed) {
    std::mt19937 random(4);
    for (const TestMesh& shape : {make_globe(5, 3), make_prism(5), make_triangle_globe(6, 4)}) {
        const Built b = build(shape);
        auto rates = random_rates(b.mesh, b.table, TessellationSpacing::integer, 7, random);
        for (uint32_t& r : rates)
            if (random() % 6 == 0) r = 0;
        const auto t = tessellate(b.table, rates, TessellationSpacing::integer);
        ASSERT_TRUE(t);
        EXPECT_EQ(find_tessellation_fault(b.mesh, b.table, rates, TessellationSpacing::integer, *t), "");
    }
}

TEST(Tessellate, FaultsAreFound) {
    const Built b = build(make_globe(5, 3));
    std::mt19937 random(5);
    const auto rates = random_rates(b.mesh, b.table, TessellationSpacing::integer, 5, random);
    const auto fault = [&](const Tessellation& t) {
        return find_tessellation_fault(b.mesh, b.table, rates, TessellationSpacing::integer, t);
    };
    const auto good = tessellate(b.table, rates, TessellationSpacing::integer);
    ASSERT_TRUE(good);
    ASSERT_EQ(fault(*good), "");
    Tessellation bad = *good;
    std::swap(bad.indices[3], bad.indices[4]);
    EXPECT_NE(fault(bad), "");
    bad = *good;
    bad.indices.resize(bad.indices.size() - 3);
    bad.triangle_faces.pop_back();
    EXPECT_NE(fault(bad), "");
    // A vertex for each face where they should share one: a crack, however small.
    bad = *good;
    const uint32_t vertex = bad.indices.back();
    bad.places.push_back(bad.places[vertex]);
    bad.position_sources.push_back(static_cast<uint32_t>(bad.places.size() - 1));
    bad.indices.back() = bad.position_sources.back();
    EXPECT_NE(fault(bad), "");
}

double angle_between(const double* a, const double* b) {
    return std::acos(std::clamp(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], -1.0, 1.0)) * 180 / 3.14159265358979;
}

/// The largest angle between a triangle and the normals of its corners, degrees.
double largest_normal_angle(const Built& b, const Tessellation& t) {
    std::vector<double> positions(t.places.size() * 3), normals(positions.size());
    evaluate_tessellation(b.patches, t, b.points, positions, normals);
    double worst = 0;
    for (size_t i = 0; i < t.indices.size(); i += 3) {
        const double *p = &positions[3 * t.indices[i]], *q = &positions[3 * t.indices[i + 1]],
                     *r = &positions[3 * t.indices[i + 2]];
        double n[3];
        for (int k = 0; k < 3; ++k) {
            const int x = (k + 1) % 3, y = (k + 2) % 3;
            n[k] = (q[x] - p[x]) * (r[y] - p[y]) - (q[y] - p[y]) * (r[x] - p[x]);
        }
        const double length = std::hypot(n[0], n[1], n[2]);
        for (double& x : n) x /= length;
        for (size_t c = 0; c < 3; ++c) worst = std::max(worst, angle_between(n, &normals[3 * t.indices[i + c]]));
    }
    return worst;
}

// Beside a sharp crease each side has its own normal: no triangle's vertex normals are far from the triangle's own.
TEST(Tessellate, CreasesHaveANormalForEachSide) {
    TestMesh cube = make_cube();
    const Topology base = build_topology(*ControlMesh::create(cube.description()));
    for (uint32_t e = 0; e < base.edge_count; ++e)
        cube.add_crease(base.edge_vertices[2 * e], base.edge_vertices[2 * e + 1], 10);
    for (const bool split : {true, false}) {
        const Built b = build(cube, {.split_creases = split});
        const std::vector<uint32_t> rates(b.table.rate_edge_count, 4 * shared::kRateOne);
        const auto t = tessellate(b.table, rates, TessellationSpacing::integer);
        ASSERT_TRUE(t);
        EXPECT_EQ(t->vertex_count(), split ? 6 * 25u : 8 + 12 * 3 + 6 * 9u);
        const double worst = largest_normal_angle(b, *t);
        if (split)
            EXPECT_LT(worst, 5);  // its faces are not quite flat
        else
            EXPECT_GT(worst, 80);
    }
}

// At a corner that stays sharp faces have no normal in common, even where they share an edge; one that fades is smooth.
TEST(Tessellate, SharpCornersHaveANormalForEachFace) {
    double angles[2];
    for (const bool split : {true, false}) {
        TestMesh cube = make_cube();
        cube.add_corner(0, 10);
        const Built b = build(cube, {.split_creases = split});
        const std::vector<uint32_t> rates(b.table.rate_edge_count, 16 * shared::kRateOne);
        const auto t = tessellate(b.table, rates, TessellationSpacing::integer);
        ASSERT_TRUE(t);
        EXPECT_EQ(b.table.corner_count, split ? 10u : 8u);
        EXPECT_EQ(find_tessellation_fault(b.mesh, b.table, rates, TessellationSpacing::integer, *t), "");
        angles[split ? 0 : 1] = largest_normal_angle(b, *t);
    }
    EXPECT_LT(angles[0], 0.6 * angles[1]);
    TestMesh fading = make_cube();
    fading.add_corner(0, 3);
    EXPECT_EQ(build(fading).table.corner_count, 8u);
}

// On either side of a seam the channel has that side's values.
TEST(Tessellate, SeamsHaveTheValuesOfEachSide) {
    for (const TestMesh& shape : face_varying_shapes()) {
        const std::vector<uint32_t> channels = all_channels(shape);
        const Built b = build(shape, {.channels = channels});
        std::mt19937 random(6);
        const auto rates = random_rates(b.mesh, b.table, TessellationSpacing::integer, 5, random);
        const auto t = tessellate(b.table, rates, TessellationSpacing::integer);
        ASSERT_TRUE(t);
        for (const uint32_t channel : channels) {
            const auto patches = build_face_varying_patch_table<float>(b.mesh, channel, {});
            if (!patches) continue;  // said in build_face_varying_patch_table: smooth ones with Chaikin creases
            const auto& values = shape.channels[channel].values;
            std::vector<double> points(size_t{patches->point_count()} * 2), out(t->places.size() * 2);
            build_patch_points<float>(*patches, std::vector<double>(values.begin(), values.end()), 2, points);
            evaluate_tessellation_channel(*patches, *t, points, 2, out);
            // Where each triangle's corners are in the triangle's own face.
            const double fault = largest_channel_fault(*patches, b.table, rates, *t, points, out);
            EXPECT_LT(fault, 1e-5) << shape.name << " channel " << channel;
        }
    }
}

TEST(Tessellate, SettingsAreChecked) {
    EXPECT_TRUE(check_rate_settings({}));
    EXPECT_FALSE(check_rate_settings({.value = 0}));
    EXPECT_FALSE(check_rate_settings({.value = NAN}));
    EXPECT_FALSE(check_rate_settings({.max_rate = 1}));
    EXPECT_FALSE(check_rate_settings({.max_rate = 129}));
    RateSettings settings{.mode = RateMode::screen_length};
    EXPECT_TRUE(check_rate_settings(settings));
    settings.camera.width = 0;
    EXPECT_FALSE(check_rate_settings(settings));
    settings.camera.width = 1;
    settings.camera.matrix[5] = NAN;
    EXPECT_FALSE(check_rate_settings(settings));
    const Built b = build(make_cube());
    EXPECT_FALSE(compute_rates(b.patches, b.table, {.mode = RateMode::per_edge}, b.points));
    EXPECT_FALSE(tessellate(b.table, {}, TessellationSpacing::integer));
    const std::vector<uint32_t> channels = {0};
    EXPECT_FALSE(build_tessellation_table(b.mesh, {.channels = channels}));
}

TEST(Tessellate, RatesFollowTheMode) {
    const Built b = build(make_globe(5, 3));
    const auto rates = [&](RateSettings settings, double scale = 1) {
        const auto computed = compute_rates(b.patches, b.table, settings, b.points, {}, scale);
        EXPECT_TRUE(computed);
        return *computed;
    };
    for (const uint32_t r : rates({.value = 8})) EXPECT_TRUE(r == 8 * shared::kRateOne || r == 4 * shared::kRateOne);
    // Half the error takes 1.4 times the rate.
    const auto sum = [](const std::vector<uint32_t>& values) {
        double total = 0;
        for (const uint32_t r : values) total += static_cast<double>(r) / shared::kRateOne;
        return total;
    };
    RateSettings chord{.mode = RateMode::chord_error, .value = 1e-3f, .spacing = TessellationSpacing::fractional};
    const double coarse = sum(rates(chord));
    chord.value = 0.5e-3f;
    EXPECT_NEAR(sum(rates(chord)) / coarse, std::sqrt(2), 0.05);
    // What is flat needs one segment, and is drawn.
    TestMesh cube = make_cube();
    cube.options.scheme = Scheme::bilinear;
    const Built flat = build(cube);
    for (const RateMode mode : {RateMode::chord_error, RateMode::pixel_error}) {
        const auto least = compute_rates(flat.patches, flat.table, {.mode = mode, .value = 1e-3f}, flat.points);
        ASSERT_TRUE(least);
        for (const uint32_t r : *least) EXPECT_EQ(r, shared::kRateOne);
    }
    // One scale for all: sums follow it although each rate is whole.
    const double full = sum(rates({.value = 8}));
    for (const double scale : {0.9, 0.77, 0.5}) EXPECT_NEAR(sum(rates({.value = 8}, scale)) / full, scale, 0.03);
}

/// Of segments along rows: how far the surface in the middle of a segment is from the segment, by `scale(point)`.
std::vector<double> chord_errors(const Built& b, const std::vector<uint32_t>& rates,
                                 const std::function<double(const double*)>& scale) {
    std::vector<double> errors;
    for (uint32_t row = 0; row < b.table.row_count; ++row) {
        const uint32_t* words = b.table.rows.data() + size_t{row} * shared::kTessRowWords;
        const uint32_t n = rates[words[0]] / shared::kRateOne;
        std::vector<PatchSample> samples;
        for (uint32_t i = 0; i <= 2 * n; ++i) {
            PatchSample s = {words[1], 0, 0};
            shared::locate_on_row(words[2], i / (2.0 * n), s.u, s.v);
            samples.push_back(s);
        }
        std::vector<double> p(samples.size() * 3);
        std::vector<SampleStatus> statuses(samples.size());
        evaluate_patches(b.patches, samples, b.points, 3, Derivatives::none, p, statuses);
        double worst = 0;
        for (size_t i = 1; i < samples.size(); i += 2) {
            // From the segment, not from its middle: the surface may be faster in one half.
            double along[3], to[3], dot = 0, square = 0;
            for (size_t k = 0; k < 3; ++k) {
                along[k] = p[3 * i + 3 + k] - p[3 * i - 3 + k];
                to[k] = p[3 * i + k] - p[3 * i - 3 + k];
                dot += along[k] * to[k];
                square += along[k] * along[k];
            }
            const double t = std::clamp(dot / square, 0.0, 1.0);
            const double off = std::hypot(to[0] - t * along[0], to[1] - t * along[1], to[2] - t * along[2]);
            worst = std::max(worst, off * scale(&p[3 * i]));
        }
        errors.push_back(worst);
    }
    return errors;
}

// What errors are in the end, not what they were computed to be: seldom above, and not far below.
TEST(Tessellate, ErrorsAreWhatWasAskedFor) {
    for (TestMesh shape : {make_globe(7, 5), make_torus(9, 7), make_triangle_globe(8, 5)}) {
        if (std::ranges::all_of(shape.face_sizes, [](uint32_t n) { return n == 3; })) shape.options.scheme = Scheme::loop;
        const Built b = build(shape);
        const double size = shape.size();
        Camera camera;
        // Looks along -z from two sizes away; w is the distance.
        const float f = 1.7f, away = static_cast<float>(2 * size);
        const float matrix[16] = {f, 0, 0, 0, 0, -f, 0, 0, 0, 0, -1, -1, 0, 0, away, away};
        std::copy_n(matrix, 16, camera.matrix);
        camera.width = camera.height = 1000;
        const auto pixels = [&](const double* p) { return f * 500 / (away - p[2]); };
        const std::tuple<RateMode, float, std::function<double(const double*)>> modes[] = {
            {RateMode::chord_error, static_cast<float>(1e-4 * size), [](const double*) { return 1.0; }},
            {RateMode::pixel_error, 0.05f, pixels}};
        for (const auto& [mode, value, scale] : modes) {
            const auto rates = compute_rates(
                b.patches, b.table, {.mode = mode, .value = value, .max_rate = 128, .camera = camera}, b.points);
            ASSERT_TRUE(rates);
            std::vector<double> errors = chord_errors(b, *rates, scale);
            std::sort(errors.begin(), errors.end());
            EXPECT_LT(errors[errors.size() * 9 / 10], 1.3 * value) << shape.name << static_cast<int>(mode);
            EXPECT_LT(errors.back(), 3 * value) << shape.name << static_cast<int>(mode);
            EXPECT_GT(errors[errors.size() / 2], 0.3 * value) << shape.name << static_cast<int>(mode);
        }
        // At a distance of w a rate of value / w.
        const auto rates = compute_rates(b.patches, b.table,
                                         {.mode = RateMode::distance,
                                          .value = 20 * away,
                                          .spacing = TessellationSpacing::fractional,
                                          .max_rate = 128,
                                          .camera = camera},
                                         b.points);
        ASSERT_TRUE(rates);
        for (uint32_t e = 0; e < b.table.mesh_edge_count; ++e) {
            const uint32_t* edge = b.table.rate_edges.data() + size_t{e} * shared::kRateEdgeWords;
            const bool halves = (edge[0] & shared::kRateEdgeHalves) != 0;
            double nearest = HUGE_VAL;
            for (const uint32_t row : {shared::side_row(edge[0]), shared::side_row(edge[0]) + (halves ? 1u : 0u)})
                for (const double t : {0.0, 0.5, 1.0}) {
                    const uint32_t* words = b.table.rows.data() + size_t{row} * shared::kTessRowWords;
                    PatchSample s = {words[1], 0, 0};
                    shared::locate_on_row(words[2], t, s.u, s.v);
                    double p[3];
                    SampleStatus status;
                    evaluate_patches(b.patches, {&s, 1}, b.points, 3, Derivatives::none, p, {&status, 1});
                    nearest = std::min(nearest, away - p[2]);
                }
            const double rate = static_cast<double>((*rates)[e]) / shared::kRateOne * (halves ? 2 : 1);
            EXPECT_NEAR(rate, 20 * away / nearest, 0.02 * rate) << "edge " << e;
        }
    }
}

}  // namespace
}  // namespace limn::test
