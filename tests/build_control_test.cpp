// Cancelling builds, their progress, and builds beside their caller.
#include "limn/build_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <thread>
#include <vector>

#include "limn/async_build.h"
#include "limn/parallel.h"
#include "limn/patch_tree.h"
#include "limn/refined_grid.h"
#include "limn/tessellation_table.h"

namespace limn {
namespace {

/// A plane of quads with creases here and there; every 7th quad is two triangles.
ControlMesh make_mesh(uint32_t side) {
    std::vector<uint32_t> sizes, vertices, creases;
    std::vector<float> sharpness;
    for (uint32_t i = 0; i < side; ++i)
        for (uint32_t j = 0; j < side; ++j) {
            const uint32_t v = i * (side + 1) + j, a = v + side + 1, b = v + side + 2, c = v + 1;
            if ((i + 3 * j) % 7 == 0) {
                sizes.insert(sizes.end(), {3, 3});
                vertices.insert(vertices.end(), {v, a, b, v, b, c});
            } else {
                sizes.push_back(4);
                vertices.insert(vertices.end(), {v, a, b, c});
            }
            if ((5 * i + j) % 11 != 0) continue;
            creases.insert(creases.end(), {v, a});
            sharpness.push_back(static_cast<float>(1 + (i + j) % 4));
        }
    ControlMeshDescription d;
    d.vertex_count = (side + 1) * (side + 1);
    d.face_sizes = sizes;
    d.face_vertices = vertices;
    d.crease_vertices = creases;
    d.crease_sharpness = sharpness;
    const FaceVaryingDescription channel{d.vertex_count, vertices};
    d.channels = {&channel, 1};
    return *ControlMesh::create(d);
}

template <class T>
bool equal(const Array<T>& a, const Array<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.bytes()) == 0);
}
bool equal(const PatchTable& a, const PatchTable& b) {
    return equal(a.surfaces, b.surfaces) && equal(a.ring_points.words, b.ring_points.words) &&
           equal(a.plans, b.plans) && equal(a.plan_weights, b.plan_weights) &&
           equal(a.point_indices.words, b.point_indices.words) && equal(a.ptex_surfaces, b.ptex_surfaces);
}

TEST(BuildControl, StopsBuildersBeforeTheyBegin) {
    const ControlMesh mesh = make_mesh(8);
    const auto table = build_patch_table<float>(mesh, {});
    ASSERT_TRUE(table);
    BuildControl control;
    control.cancel();
    const auto patches = build_patch_table<float>(mesh, {.control = &control});
    ASSERT_FALSE(patches);
    EXPECT_EQ(patches.error().code, ErrorCode::cancelled);
    const auto topology = build_tessellation_table(mesh, {.control = &control});
    ASSERT_FALSE(topology);
    EXPECT_EQ(topology.error().code, ErrorCode::cancelled);
    const auto trees = build_patch_trees(*table, {.control = &control});
    ASSERT_FALSE(trees);
    EXPECT_EQ(trees.error().code, ErrorCode::cancelled);
    EXPECT_EQ(control.progress(), 0);
    control.reset();
    EXPECT_TRUE(build_patch_table<float>(mesh, {.control = &control}));
    EXPECT_EQ(control.progress(), 1);
}

/// Every builder, as one that takes a control.
struct Builder {
    const char* name;
    std::function<Result<void>(const BuildPart&)> build;
};
template <class T>
Result<void> outcome(const Result<T>& result) {
    if (!result) return result.error();
    return {};
}
std::vector<Builder> make_builders(const ControlMesh& mesh, const Refinement& base, const PatchTable& patches) {
    return {
        {"patch table", [&](auto& part) { return outcome(build_patch_table<float>(mesh, {.control = part})); }},
        {"face-varying patch table",
         [&](auto& part) { return outcome(build_face_varying_patch_table<float>(mesh, 0, {.control = part})); }},
        {"tessellation table",
         [&](auto& part) { return outcome(build_tessellation_table(mesh, {.control = part})); }},
        {"patch trees", [&](auto& part) { return outcome(build_patch_trees(patches, {.control = part})); }},
        {"grid table", [&](auto& part) { return outcome(build_grid_table(patches, {.control = part})); }},
        {"refined grid",
         [&](auto& part) { return outcome(build_refined_grid_table(base, {.level = 3, .control = part})); }},
        {"refinement",
         [&](auto& part) { return outcome(build_refinement(mesh, {.level = 2, .control = part})); }},
        {"face-varying refinement",
         [&](auto& part) { return outcome(build_face_varying_refinement(mesh, 0, {.level = 2, .control = part})); }},
        {"step table",
         [&](auto& part) { return outcome(build_step_table<float>(base, 1, Interpolation::vertex, part)); }},
        {"stencil table",
         [&](auto& part) { return outcome(build_stencil_table<float>(base, 2, Interpolation::vertex, part)); }},
        {"limit table", [&](auto& part) { return outcome(build_limit_table<float>(base, 1, true, part)); }},
    };
}

TEST(BuildControl, StopsEveryBuilderAtAnyMoment) {
    const ControlMesh mesh = make_mesh(40);
    const auto base = build_refinement(mesh, {.level = 0, .full_last_level = true});
    const auto patches = build_patch_table<float>(mesh, {});
    ASSERT_TRUE(base && patches);
    int cancelled = 0;  // of all: one that is quick may be done each time before it is told
    for (const Builder& builder : make_builders(mesh, *base, *patches)) {
        SCOPED_TRACE(builder.name);
        BuildControl control;
        ASSERT_TRUE(builder.build(&control));
        EXPECT_EQ(control.progress(), 1);
        ASSERT_TRUE(builder.build({&control, 0.25f, 0.5f}));
        EXPECT_EQ(control.progress(), 0.5f);
        for (int step = 0; step <= 40; ++step) {
            control.reset();
            std::atomic<bool> done = false;
            std::thread canceller([&] {
                while (!done && control.progress() < static_cast<float>(step) / 40) std::this_thread::yield();
                control.cancel();
            });
            const Result<void> result = builder.build(&control);
            done = true;
            canceller.join();
            if (result) {
                EXPECT_EQ(control.progress(), 1);
            } else {
                EXPECT_EQ(result.error().code, ErrorCode::cancelled);
                ++cancelled;
            }
        }
        control.cancel();
        EXPECT_FALSE(builder.build(&control));
    }
    EXPECT_GT(cancelled, 0);
}

TEST(BuildControl, SortsByBlocksWhatOneSortDoes) {
    const auto less = [](uint64_t a, uint64_t b) { return a < b; };
    for (const uint32_t count : {0u, 1u, 8192u, 8193u, 16384u, 50000u, 70000u}) {
        std::vector<uint64_t> items(count);
        for (uint32_t i = 0; i < count; ++i) items[i] = uint64_t{i} * 2654435761u % 100003;
        std::vector<uint64_t> expected = items;
        std::sort(expected.begin(), expected.end());
        BuildControl control;
        sort_items(items, &control, less);
        EXPECT_EQ(items, expected) << count;
        EXPECT_EQ(control.progress(), 1) << count;
        control.cancel();
        std::reverse(items.begin(), items.end());
        sort_items(items, &control, less);  // comes to an end, in whatever order
        EXPECT_EQ(items.size(), expected.size());
    }
}

TEST(BuildControl, ProgressRisesToOne) {
    const ControlMesh mesh = make_mesh(60);
    auto build = AsyncBuild<PatchTable>::start(
        [&](BuildControl& control) { return build_patch_table<float>(mesh, {.control = &control}); });
    ASSERT_TRUE(build);
    float last = 0;
    while (!build->is_ready()) {
        const float now = build->progress();
        ASSERT_GE(now, last);
        ASSERT_LE(now, 1);
        last = now;
    }
    EXPECT_EQ(build->progress(), 1);
    EXPECT_TRUE(build->take());
}

/// Whatever the moment, the cache serves later builds as before.
TEST(BuildControl, CancelledAtAnyMomentTheCacheStaysGood) {
    const ControlMesh mesh = make_mesh(60);
    const auto expected = build_patch_table<float>(mesh, {});
    ASSERT_TRUE(expected);
    const PlanCache cache;
    uint32_t cancelled = 0;
    for (int step = 0; step < 20; ++step) {
        auto build = AsyncBuild<PatchTable>::start(
            [&](BuildControl& control) { return build_patch_table<float>(mesh, {.control = &control}, &cache); });
        ASSERT_TRUE(build);
        std::this_thread::sleep_for(std::chrono::microseconds(step * 700));
        build->cancel();
        const auto table = build->take();
        if (table) {
            EXPECT_TRUE(equal(*table, *expected));
        } else {
            EXPECT_EQ(table.error().code, ErrorCode::cancelled);
            ++cancelled;
        }
    }
    EXPECT_GT(cancelled, 0u);
    const auto table = build_patch_table<float>(mesh, {}, &cache);
    ASSERT_TRUE(table);
    EXPECT_TRUE(equal(*table, *expected));
}

TEST(AsyncBuild, ManyShareOneCache) {
    const ControlMesh mesh = make_mesh(24);
    const auto expected = build_patch_table<float>(mesh, {});
    ASSERT_TRUE(expected);
    const PlanCache cache;
    std::vector<AsyncBuild<PatchTable>> builds;
    for (int i = 0; i < 12; ++i) {
        auto build = AsyncBuild<PatchTable>::start(
            [&](BuildControl& control) { return build_patch_table<float>(mesh, {.control = &control}, &cache); });
        ASSERT_TRUE(build);
        builds.push_back(std::move(*build));
    }
    for (size_t i = 0; i < builds.size(); i += 3) builds[i].cancel();
    for (size_t i = 0; i < builds.size(); ++i) {
        const auto table = builds[i].take();
        if (table)
            EXPECT_TRUE(equal(*table, *expected));
        else
            EXPECT_TRUE(i % 3 == 0 && table.error().code == ErrorCode::cancelled);
    }
}

TEST(AsyncBuild, RunsAsAJobOfTheCaller) {
    const ControlMesh mesh = make_mesh(8);
    std::vector<AsyncBuild<PatchTable>::Job> queue;
    const auto submit = [&](AsyncBuild<PatchTable>::Job job) { queue.push_back(std::move(job)); };
    const auto start = [&] {
        return AsyncBuild<PatchTable>::start(
            [&](BuildControl& control) { return build_patch_table<float>(mesh, {.control = &control}); }, submit);
    };
    auto build = start(), stopped = start();
    stopped.cancel();
    EXPECT_FALSE(build.is_ready());
    for (auto& job : queue) job();
    EXPECT_TRUE(build.is_ready());
    EXPECT_TRUE(build.take());
    EXPECT_EQ(stopped.take().error().code, ErrorCode::cancelled);
}

TEST(AsyncBuild, DestructionStopsTheBuild) {
    std::atomic<bool> running = false, stopped = false;
    {
        auto build = AsyncBuild<int>::start([&](BuildControl& control) -> Result<int> {
            running = true;
            while (!control.is_cancelled()) std::this_thread::yield();
            stopped = true;
            return BuildPart(&control).check().error();
        });
        ASSERT_TRUE(build);
        while (!running) std::this_thread::yield();
    }
    EXPECT_TRUE(stopped);
}

}  // namespace
}  // namespace limn
