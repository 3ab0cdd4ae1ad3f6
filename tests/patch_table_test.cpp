// Patch tables against the limits of uniformly refined vertices, which conformance tests compare with
// OpenSubdiv; and what tables must be, whatever the mesh.
#include "limn/patch_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <thread>

#include "limn/evaluate.h"
#include "limn/patch_tree.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr uint32_t kLevel = 2;

/// A corner of a refined face, as a place on the base face that it descends from.
struct Corner {
    uint32_t vertex;
    PatchSample sample;
};

/// Refined faces are visited in their order; coordinates go from those of a child to those of the base face.
struct Walk {
    const Topology& last;
    bool triangles;
    uint32_t next_face = 0;
    std::vector<Corner> corners;

    struct Frame {
        double u0, v0, size;  ///< size < 0: turned by 180 degrees
    };
    void visit(uint32_t ptex, Frame f, uint32_t levels) {
        if (levels == 0) {
            constexpr double us[2][4] = {{0, 1, 1, 0}, {0, 1, 0, 0}}, vs[2][4] = {{0, 0, 1, 1}, {0, 0, 1, 0}};
            const auto vertices = last.vertices_of_face(next_face);
            for (size_t k = 0; k < vertices.size(); ++k)
                corners.push_back(
                    {vertices[k],
                     {ptex, f.u0 + f.size * us[triangles][k], f.v0 + f.size * vs[triangles][k]}});
            ++next_face;
            return;
        }
        const double h = f.size / 2;
        visit(ptex, {f.u0, f.v0, h}, levels - 1);
        visit(ptex, {f.u0 + h, f.v0, h}, levels - 1);
        if (triangles) {
            visit(ptex, {f.u0, f.v0 + h, h}, levels - 1);
            visit(ptex, {f.u0 + h, f.v0 + h, -h}, levels - 1);
        } else {
            visit(ptex, {f.u0 + h, f.v0 + h, h}, levels - 1);
            visit(ptex, {f.u0, f.v0 + h, h}, levels - 1);
        }
    }
};

/// Every corner of every face over the base, and whether that face is part of the surface.
std::vector<Corner> refined_corners(const Refinement& refinement, std::vector<uint8_t>& present) {
    const Topology& base = refinement.levels[0];
    Walk walk{refinement.last(), base.options.scheme == Scheme::loop, 0, {}};
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t size = base.size_of_face(f);
        const bool whole = size == (walk.triangles ? 3u : 4u);
        for (uint32_t i = 0; i < (whole ? 1 : size); ++i)
            walk.visit(ptex++, {0, 0, 1}, refinement.level_count() - 1 - (whole ? 0 : 1));
        present.resize(walk.corners.size(), base.face_holes[f] == 0);
    }
    return walk.corners;
}

struct Evaluation {
    std::vector<double> values;
    std::vector<SampleStatus> statuses;
};
Evaluation evaluate(const PatchTableDouble& table, const std::vector<PatchSample>& samples,
                    const std::vector<double>& control, uint32_t width, Derivatives derivatives) {
    std::vector<double> points(size_t{table.point_count()} * width);
    build_patch_points(table, control, width, points);
    Evaluation out;
    out.values.resize(samples.size() * value_count(derivatives) * width);
    out.statuses.resize(samples.size());
    evaluate_patches(table, samples, points, width, derivatives, out.values, out.statuses);
    return out;
}

std::vector<PatchSample> samples_of(const std::vector<Corner>& corners) {
    std::vector<PatchSample> samples;
    for (const Corner& c : corners) samples.push_back(c.sample);
    return samples;
}

/// The largest distance between the surface and the limits of refined vertices, in sizes of the mesh.
double limit_error(TestMesh mesh, const PatchTableOptions& options) {
    mesh.options.opensubdiv_compatible = false;
    const auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control);
    const auto refinement = build_refinement(*control, {kLevel, false});
    EXPECT_TRUE(refinement);
    const auto limits = build_limit_table<double>(*refinement, kLevel);
    const auto table = build_patch_table<double>(*control, options);
    EXPECT_TRUE(limits && table);
    if (!limits || !table) return 1;
    std::vector<double> truth(size_t{limits->row_count()} * 3);
    apply_stencil_table<double>(*limits, mesh.positions_double(), truth, 3);
    std::vector<uint8_t> present;
    const std::vector<Corner> corners = refined_corners(*refinement, present);
    const Evaluation ours =
        evaluate(*table, samples_of(corners), mesh.positions_double(), 3, Derivatives::none);
    double worst = 0;
    for (size_t c = 0; c < corners.size(); ++c) {
        const SampleStatus expected = present[c] != 0 ? SampleStatus::valid : SampleStatus::hole;
        EXPECT_EQ(ours.statuses[c], expected);
        if (present[c] == 0) continue;
        for (size_t i = 0; i < 3; ++i) {
            const double difference =
                std::abs(ours.values[3 * c + i] - truth[corners[c].vertex * size_t{3} + i]);
            worst = std::isfinite(difference) ? std::max(worst, difference) : 1;
        }
    }
    return worst / mesh.size();
}

TEST(PatchTable, equals_the_limits_of_refined_vertices) {
    for (const TestMesh& mesh : all_shapes()) EXPECT_LE(limit_error(mesh, {}), 1e-12) << mesh.name;
}

TEST(PatchTable, equals_the_limits_of_refined_random_meshes) {
    for (uint64_t seed = 0; seed < 300; ++seed)
        EXPECT_LE(limit_error(random_mesh(seed), {}), 1e-12) << "seed " << seed;
}

std::vector<TestMesh> some_shapes(size_t step) {
    std::vector<TestMesh> all = all_shapes(), result;
    for (size_t i = 0; i < all.size(); i += step) result.push_back(std::move(all[i]));
    return result;
}

ControlMesh control_mesh(const TestMesh& mesh) {
    auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control) << mesh.name;
    return std::move(control).value();
}

/// Places of every face, a few of them close to its corners.
std::vector<PatchSample> scattered_samples(const PatchTableDouble& table, uint64_t seed) {
    RandomNumbers random(seed);
    const bool triangles = table.options.scheme == Scheme::loop;
    std::vector<PatchSample> samples;
    for (uint32_t f = 0; f < table.ptex_surfaces.size(); ++f) {
        for (uint32_t i = 0; i < 6; ++i) {
            const double scale = i < 4 ? 1 : std::exp2(-4.0 * i);
            double u = random.uniform(0, 1), v = random.uniform(0, 1);
            if (triangles && u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            samples.push_back({f, u * scale, v * scale});
        }
    }
    return samples;
}

double worst_difference(const std::vector<double>& a, const std::vector<double>& b) {
    EXPECT_EQ(a.size(), b.size());
    double worst = 0;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
}

TEST(PatchTable, does_not_depend_on_the_depth_of_plans) {
    for (const TestMesh& mesh : some_shapes(11)) {
        const ControlMesh control = control_mesh(mesh);
        const auto shallow = build_patch_table<double>(control, {.plan_depth = 1});
        const auto deep = build_patch_table<double>(control, {.plan_depth = 4});
        ASSERT_TRUE(shallow && deep);
        const std::vector<PatchSample> samples = scattered_samples(*shallow, 7);
        const auto a = evaluate(*shallow, samples, mesh.positions_double(), 3, Derivatives::first);
        const auto b = evaluate(*deep, samples, mesh.positions_double(), 3, Derivatives::first);
        // Derivatives differ by rounding that 2^depth magnifies.
        EXPECT_LE(worst_difference(a.values, b.values), 1e-6 * mesh.size()) << mesh.name;
    }
}

TEST(PatchTable, derivatives_are_those_of_the_surface) {
    constexpr double kStep = 1e-5;
    for (const TestMesh& mesh : some_shapes(7)) {
        const ControlMesh control = control_mesh(mesh);
        const auto table = build_patch_table<double>(control, {});
        ASSERT_TRUE(table);
        // Away from lines on which second derivatives jump: none of these places is near a dyadic one.
        const double places[3][2] = {{0.3, 0.21}, {0.13, 0.59}, {0.41, 0.077}};
        for (uint32_t f = 0; f < table->ptex_surfaces.size(); ++f) {
            for (const auto& [u, v] : places) {
                const std::vector<PatchSample> samples = {
                    {f, u, v}, {f, u + kStep, v}, {f, u - kStep, v}, {f, u, v + kStep}, {f, u, v - kStep}};
                const auto e = evaluate(*table, samples, mesh.positions_double(), 3, Derivatives::second);
                if (e.statuses[0] != SampleStatus::valid) continue;
                auto at = [&](size_t s, size_t k, size_t i) { return e.values[(s * 6 + k) * 3 + i]; };
                for (size_t i = 0; i < 3; ++i) {
                    const double tolerance = 1e-4 * mesh.size();
                    EXPECT_NEAR((at(1, 0, i) - at(2, 0, i)) / (2 * kStep), at(0, 1, i), tolerance)
                        << mesh.name;
                    EXPECT_NEAR((at(3, 0, i) - at(4, 0, i)) / (2 * kStep), at(0, 2, i), tolerance)
                        << mesh.name;
                    EXPECT_NEAR((at(1, 1, i) - at(2, 1, i)) / (2 * kStep), at(0, 3, i), 30 * tolerance);
                    EXPECT_NEAR((at(3, 1, i) - at(4, 1, i)) / (2 * kStep), at(0, 4, i), 30 * tolerance);
                    EXPECT_NEAR((at(3, 2, i) - at(4, 2, i)) / (2 * kStep), at(0, 5, i), 30 * tolerance);
                }
            }
        }
    }
}

TEST(PatchTable, rows_of_plans_sum_to_one) {
    for (const TestMesh& mesh : all_shapes()) {
        const auto table = build_patch_table<double>(control_mesh(mesh), {});
        ASSERT_TRUE(table);
        for (const Plan& plan : table->plans)
            for (uint32_t r = 0; r < plan.row_count; ++r) {
                double sum = 0;
                const size_t stride = shared::plan_row_stride(plan.ring_size);
                for (size_t j = 0; j < stride; ++j)
                    sum += table->plan_weights[plan.first_weight + r * stride + j];
                const bool tangent = plan.has_corner_rows != 0 && (r == 1 || r == 2);
                ASSERT_NEAR(sum, tangent ? 0 : 1, 1e-11) << mesh.name << " row " << r;
            }
    }
}

template <class T>
bool same_bytes(const Array<T>& a, const Array<T>& b) {
    return a.bytes() == b.bytes() && (a.empty() || std::memcmp(a.data(), b.data(), a.bytes()) == 0);
}

TEST(PatchTable, does_not_depend_on_what_the_cache_holds) {
    const PlanCache cache;
    for (const TestMesh& mesh : some_shapes(5)) {
        const ControlMesh control = control_mesh(mesh);
        const auto alone = build_patch_table<float>(control, {});
        const auto cold = build_patch_table<float>(control, {}, &cache);
        const uint32_t plans = cache.size();
        const auto warm = build_patch_table<float>(control, {}, &cache);
        ASSERT_TRUE(alone && cold && warm);
        EXPECT_EQ(cache.size(), plans) << mesh.name;
        for (const auto* other : {&*cold, &*warm}) {
            EXPECT_TRUE(same_bytes(alone->surfaces, other->surfaces)) << mesh.name;
            EXPECT_TRUE(same_bytes(alone->plan_nodes, other->plan_nodes)) << mesh.name;
            EXPECT_TRUE(same_bytes(alone->plan_weights, other->plan_weights)) << mesh.name;
            EXPECT_TRUE(same_bytes(alone->ring_points.words, other->ring_points.words)) << mesh.name;
        }
    }
}

TEST(PatchTable, alike_neighbourhoods_of_different_meshes_share_plans) {
    const PlanCache cache;
    const auto small = build_patch_table<float>(control_mesh(make_quad_star(5, 4)), {}, &cache);
    const uint32_t plans = cache.size();
    TestMesh turned = make_quad_star(5, 4);  // faces in another order, each from another corner
    std::vector<uint32_t> reversed;
    for (uint32_t f = turned.face_count(); f-- > 0;)
        for (uint32_t k = 0; k < 4; ++k) reversed.push_back(turned.face_vertices[4 * f + (k + f) % 4]);
    turned.face_vertices = reversed;
    const auto other = build_patch_table<float>(control_mesh(turned), {}, &cache);
    ASSERT_TRUE(small && other);
    // A plan that turned faces cannot share is a regular one, whose corners all look alike.
    EXPECT_LE(cache.size(), plans + 3);
    EXPECT_LT(small->plans.size(), 20u);
}

/// Two semi-sharp creases that cross.
ControlMesh crossing_creases(double sharpness) {
    TestMesh mesh = make_grid(6, 6);
    mesh.add_crease_path({21, 22, 23, 24, 25, 26, 27}, sharpness);
    mesh.add_crease_path({3, 10, 17, 24, 31, 38, 45}, sharpness);
    return control_mesh(mesh);
}

TEST(PatchTable, patches_along_creases_are_plans_that_others_share) {
    const auto table = build_patch_table<float>(crossing_creases(9.5), {});
    ASSERT_TRUE(table);
    std::set<size_t> crease_sizes;
    for (size_t p = 0; p < table->plans.size(); ++p) {
        const size_t first = table->plans[p].first_node;
        const size_t end = p + 1 < table->plans.size() ? table->plans[p + 1].first_node : table->plan_nodes.size();
        const auto is_half = [](const PlanNode& node) {
            return node.kind() == PlanNodeKind::split_u || node.kind() == PlanNodeKind::split_v;
        };
        if (!is_half(table->plan_nodes[first])) {
            EXPECT_TRUE(std::none_of(table->plan_nodes.begin() + first, table->plan_nodes.begin() + end, is_half));
            continue;
        }
        // One for each sharpness that there is on the way down, wherever the crease lies.
        EXPECT_TRUE(crease_sizes.insert(end - first).second);
    }
    EXPECT_EQ(crease_sizes.size(), 10u);  // 9.5 on whole faces, 8.5 to 0.5 below
}

TEST(PatchTable, plans_have_corner_rows_where_no_patch_ends_at_the_corner) {
    for (const TestMesh& mesh : all_shapes()) {
        const auto table = build_patch_table<float>(control_mesh(mesh), {});
        ASSERT_TRUE(table);
        for (const Plan& plan : table->plans) {
            if (plan.has_corner_rows == 0) continue;
            uint32_t node = 0;
            while (table->plan_nodes[plan.first_node + node].kind() == PlanNodeKind::split)
                node = table->plan_nodes[plan.first_node + node].first;
            EXPECT_EQ(table->plan_nodes[plan.first_node + node].kind(), PlanNodeKind::plan) << mesh.name;
        }
    }
}

TEST(PatchTable, trees_have_no_point_twice) {
    const auto table = build_patch_table<float>(crossing_creases(9.5), {});
    ASSERT_TRUE(table);
    const auto trees = build_patch_trees(*table, {});
    ASSERT_TRUE(trees);
    const GridTable& grid = trees->local_points;
    for (size_t k = 0; k < grid.classes.size(); ++k) {
        const GridClass& c = grid.classes[k];
        std::set<std::vector<float>> rows;
        uint32_t count = 0;
        for (uint32_t s = 0; s < c.sample_count; ++s) {
            if (grid.placement_samples[grid.placements[k].first + s] == kInvalidIndex) continue;
            std::vector<float> row;
            for (uint32_t j = 0; j < 4 * c.group_count; ++j)
                row.push_back(grid.weights[4 * (c.first_weight + size_t{j / 4} * c.sample_count + s) + j % 4]);
            rows.insert(row);
            ++count;
        }
        EXPECT_EQ(rows.size(), count);
    }
}

TEST(PatchTable, face_varying_channels_equal_the_limits_of_refined_values) {
    for (TestMesh mesh : face_varying_shapes()) {
        mesh.options.opensubdiv_compatible = false;
        const ControlMesh control = control_mesh(mesh);
        for (uint32_t channel = 0; channel < mesh.channels.size(); ++channel) {
            const auto table = build_face_varying_patch_table<double>(control, channel, {});
            if (mesh.options.creasing == CreasingMethod::chaikin) {
                EXPECT_TRUE(table || table.error().code == ErrorCode::unsupported);
                if (!table) continue;
            }
            const auto refinement = build_face_varying_refinement(control, channel, {kLevel, false});
            ASSERT_TRUE(table && refinement);
            const auto limits = build_limit_table<double>(*refinement, kLevel);
            ASSERT_TRUE(limits);
            const auto& floats = mesh.channels[channel].values;
            const std::vector<double> values(floats.begin(), floats.end());
            std::vector<double> truth(size_t{limits->row_count()} * 2);
            apply_stencil_table<double>(*limits, values, truth, 2);
            std::vector<uint8_t> present;
            const std::vector<Corner> corners = refined_corners(*refinement, present);
            const auto ours = evaluate(*table, samples_of(corners), values, 2, Derivatives::none);
            double worst = 0;
            for (size_t c = 0; c < corners.size(); ++c)
                for (size_t i = 0; present[c] != 0 && i < 2; ++i)
                    worst = std::max(
                        worst, std::abs(ours.values[2 * c + i] - truth[corners[c].vertex * size_t{2} + i]));
            EXPECT_LE(worst, 1e-11) << mesh.name << " channel " << channel;
        }
    }
}

TEST(PatchTable, varying_data_is_linear_in_each_face) {
    const TestMesh mesh = make_prism(5);
    const auto table =
        build_patch_table<double>(control_mesh(mesh), {.interpolation = Interpolation::varying});
    ASSERT_TRUE(table);
    const auto e = evaluate(*table, {{0, 0, 0}, {0, 1, 1}, {0, 0.5, 0.5}}, mesh.positions_double(), 3,
                            Derivatives::none);
    const auto positions = mesh.positions_double();
    const bool polygon_first = mesh.face_sizes[0] != 4;
    for (size_t i = 0; i < 3; ++i) {
        const uint32_t n = mesh.face_sizes[0];
        auto corner = [&](uint32_t k) { return positions[3 * size_t{mesh.face_vertices[k]} + i]; };
        double centroid = 0;
        for (uint32_t k = 0; k < n; ++k) centroid += corner(k) / n;
        EXPECT_NEAR(e.values[i], corner(0), 1e-12);
        EXPECT_NEAR(e.values[3 + i], polygon_first ? centroid : corner(2), 1e-12);
    }
}

TEST(PatchTable, flags_samples_that_are_not_on_the_surface) {
    TestMesh mesh = make_cube();
    mesh.holes = {2};
    const auto table = build_patch_table<double>(control_mesh(mesh), {});
    ASSERT_TRUE(table);
    const double nan = std::nan("");
    const auto e = evaluate(*table, {{0, 0.5, 0.5}, {2, 0.5, 0.5}, {6, 0, 0}, {0, 1.01, 0}, {0, 0, nan}},
                            mesh.positions_double(), 3, Derivatives::none);
    EXPECT_EQ(e.statuses[0], SampleStatus::valid);
    EXPECT_EQ(e.statuses[1], SampleStatus::hole);
    for (size_t s = 2; s < 5; ++s) EXPECT_EQ(e.statuses[s], SampleStatus::out_of_range);
    for (size_t i = 3; i < 15; ++i) EXPECT_EQ(e.values[i], 0);
    for (uint32_t depth : {0u, 11u}) {
        const auto refused = build_patch_table<double>(control_mesh(mesh), {.plan_depth = depth});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
    }
}

// What sharing is for: tables of one plan per face would take 100 MB here.
TEST(PatchTable, messy_meshes_need_few_plans_and_bytes) {
    const TestMesh mesh = make_messy_torus(80, 60, 3);
    EXPECT_GT(mesh.face_count(), 5800u);
    EXPECT_LT(mesh.face_count(), 6600u);
    const auto table = build_patch_table<float>(control_mesh(mesh), {});
    ASSERT_TRUE(table);
    EXPECT_LT(table->plans.size(), 80u);
    EXPECT_LT(table->bytes(), 3000000u);
    EXPECT_LE(limit_error(mesh, {}), 1e-12);
}

// Each of two builders at the same time takes from the cache, and adds to it, what the other does.
TEST(PatchTable, one_cache_serves_many_threads) {
    const PlanCache cache;
    std::vector<TestMesh> meshes = some_shapes(23);
    std::vector<std::thread> threads;
    std::vector<uint8_t> same(meshes.size(), 0);
    for (uint32_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (size_t i = t % 2; i < meshes.size(); i += 2) {
                const ControlMesh control = control_mesh(meshes[i]);
                const auto shared_table = build_patch_table<float>(control, {}, &cache);
                const auto alone = build_patch_table<float>(control, {});
                if (t < 2)
                    same[i] = same_bytes(shared_table->plan_weights, alone->plan_weights) &&
                              same_bytes(shared_table->surfaces, alone->surfaces);
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (size_t i = 0; i < meshes.size(); ++i) EXPECT_TRUE(same[i]) << meshes[i].name;
    EXPECT_GT(cache.bytes(), 0u);
}

}  // namespace
}  // namespace limn::test
