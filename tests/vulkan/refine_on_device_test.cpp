// Every shape of the suite, refined on the device: chains, composed tables, limits, varying and face-varying
// data, against the same tables in double. Those are compared with OpenSubdiv elsewhere.
#include <algorithm>
#include <functional>

#include "limn/vulkan/surface_evaluator.h"
#include "shapes/shapes.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk::test {
namespace {

using limn::test::TestMesh;

constexpr uint32_t kMaxVertices = 3000;

class RefineOnDevice : public VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        if (HasFatalFailure()) return;
        static const Evaluator* const shared = [this] {
            Result<Evaluator> created = Evaluator::create(device());
            return created ? new Evaluator(std::move(*created))
                           : nullptr;  // outlives the tests, as the device does
        }();
        evaluator_ = shared;
        ASSERT_NE(evaluator_, nullptr);
    }

    /// Applies tables one after the other in one command buffer; the last points.
    std::vector<float> run(const std::vector<StencilTable>& tables, const std::vector<float>& source,
                           uint32_t width) {
        std::vector<DeviceStencilTable> device_tables;
        std::vector<Buffer> points;
        std::vector<StencilEvaluation> steps;
        device_tables.reserve(tables.size());
        points.push_back(*create_point_buffer(device(), source));
        for (const StencilTable& table : tables) {
            device_tables.push_back(*upload_stencil_table(device(), table));
            points.push_back(*create_buffer(device(), table.row_count() * VkDeviceSize{4} * width,
                                            kPointUsage, MemoryUse::device));
            steps.push_back(
                *evaluator_->prepare({.table = &device_tables.back(),
                                      .width = width,
                                      .source = {.buffer = points[points.size() - 2].handle, .stride = width},
                                      .destination = {.buffer = points.back().handle, .stride = width}}));
        }
        Result<Commands> commands = Commands::begin(device());
        for (const StencilEvaluation& step : steps) {
            step.record(*commands);
            record_barrier(device(), *commands, kKernelWrites, kKernelReads);
        }
        EXPECT_TRUE(commands->submit_and_wait());
        return *download<float>(device(), points.back(), size_t{tables.back().row_count()} * width);
    }

    /// The same table in both precisions gives the same points.
    void expect_same(const std::vector<StencilTable>& tables, const StencilTableDouble& expected,
                     const std::vector<float>& source, uint32_t width, const char* what) {
        HostPoints host{std::vector<double>(size_t{expected.row_count()} * width), width};
        const std::vector<double> source_double(source.begin(), source.end());
        apply_stencil_table<double>(expected, source_double, host.values, width);
        EXPECT_TRUE(points_match(host, {run(tables, source, width), 0, width}, tolerance_of(source, width)))
            << what;
    }

    std::vector<float> run(const SurfaceEvaluator& evaluator, const RefinedGridTable& table, const std::vector<float>& source,
                           uint32_t width) {
        const auto uploaded = *upload_refined_grid_table(device(), table);
        const Buffer points = *create_point_buffer(device(), source);
        const Buffer refined = *create_point_buffer(device(), std::vector<float>(size_t{table.point_count()} * (width + 1) + 2, -7.0f));
        const auto evaluation = evaluator.prepare_refined({.table = &uploaded,
                                                           .width = width,
                                                           .source = {.buffer = points.handle, .stride = width},
                                                           .refined = {.buffer = refined.handle, .first = 2, .stride = width + 1}});
        EXPECT_TRUE(evaluation);
        Result<Commands> commands = Commands::begin(device());
        evaluation->record(*commands);
        EXPECT_TRUE(commands->submit_and_wait());
        return *download<float>(device(), refined, size_t{table.point_count()} * (width + 1) + 2);
    }

    void check(const TestMesh& shape);
    void check_channel(const TestMesh& shape, const ControlMesh& mesh, uint32_t channel, uint32_t level);

    const Evaluator* evaluator_ = nullptr;
};

template <class T>
std::vector<T> one(Result<T> value) {
    std::vector<T> values;
    values.push_back(std::move(*value));
    return values;
}

void RefineOnDevice::check(const TestMesh& shape) {
    const Result<ControlMesh> mesh = ControlMesh::create(shape.description());
    ASSERT_TRUE(mesh) << mesh.error().message;
    uint32_t level = 1;
    while (level < 3 && shape.vertex_count * (4u << (2 * level)) < kMaxVertices) ++level;
    const Result<Refinement> refinement = build_refinement(*mesh, {level, true});
    ASSERT_TRUE(refinement);
    const std::vector<float>& points = shape.positions;
    const auto composed = build_stencil_table<double>(*refinement, level);
    ASSERT_TRUE(composed);
    std::vector<StencilTable> chain;
    for (uint32_t l = 1; l <= level; ++l) chain.push_back(*build_step_table<float>(*refinement, l));
    expect_same(chain, *composed, points, 3, "level by level");
    expect_same(one(build_stencil_table<float>(*refinement, level)), *composed, points, 3, "composed");
    expect_same(one(build_limit_table<float>(*refinement, level)),
                *build_limit_table<double>(*refinement, level), points, 3, "limits");
    expect_same(one(build_stencil_table<float>(*refinement, level, Interpolation::varying)),
                *build_stencil_table<double>(*refinement, level, Interpolation::varying), points, 3,
                "varying");
    for (uint32_t channel = 0; channel < mesh->channels.size(); ++channel)
        check_channel(shape, *mesh, channel, level);
}

void RefineOnDevice::check_channel(const TestMesh& shape, const ControlMesh& mesh, uint32_t channel,
                                   uint32_t level) {
    const Result<Refinement> refinement = build_face_varying_refinement(mesh, channel, {0, false});
    ASSERT_TRUE(refinement);
    expect_same(one(build_stencil_table<float>(*refinement, level)),
                *build_stencil_table<double>(*refinement, level), shape.channels[channel].values, 2,
                "face-varying");
}

TEST_F(RefineOnDevice, gives_the_points_of_the_tables_in_double) {
    size_t count = 0;
    for (const TestMesh& shape : limn::test::all_shapes()) {
        SCOPED_TRACE(shape.name);
        // Layouts of channels differ in six interpolations only: one in three is enough on a device.
        if (!shape.channels.empty() && ++count % 3 != 0) continue;
        check(shape);
        if (HasFailure()) break;
    }
}

/// Refined grids of the shape, of vertices and of a channel, whose widths and strides differ.
void check_refined_grid(const TestMesh& shape, const ControlMesh& mesh,
                        const std::function<std::vector<float>(const RefinedGridTable&, const std::vector<float>&, uint32_t)>& run) {
    auto compare = [&](const Refinement& base, const std::vector<float>& source, uint32_t width, const char* what) {
        const uint32_t level = shape.vertex_count < 60 ? 3 : 2;
        const auto table = build_refined_grid_table(base, {.level = level});
        const auto expected = build_stencil_table<double>(base, level);
        EXPECT_EQ(table.has_value(), expected.has_value());
        if (!table) return;
        HostPoints host{std::vector<double>(size_t{expected->row_count()} * width), width};
        apply_stencil_table<double>(*expected, std::vector<double>(source.begin(), source.end()), host.values, width);
        std::vector<float> values = run(*table, source, width);
        for (size_t v = 0; v + 1 < table->point_count(); ++v)
            EXPECT_EQ(values[2 + v * (width + 1) + width], -7.0f) << "written between points";
        EXPECT_TRUE(points_match(host, {std::move(values), 2, width + 1}, tolerance_of(source, width))) << what;
    };
    compare(*build_refinement(mesh, {.level = 0}), shape.positions, 3, "vertices");
    if (!mesh.channels.empty())
        compare(*build_face_varying_refinement(mesh, 0, {0, false}), shape.channels[0].values, 2, "channel");
}

TEST_F(RefineOnDevice, gives_the_points_of_refined_grids) {
    const auto by_rows = SurfaceEvaluator::create(device());
    ASSERT_TRUE(by_rows);
    size_t count = 0;
    for (const TestMesh& shape : limn::test::all_shapes()) {
        SCOPED_TRACE(shape.name);
        if (!shape.channels.empty() && ++count % 3 != 0) continue;
        const Result<ControlMesh> mesh = ControlMesh::create(shape.description());
        check_refined_grid(shape, *mesh, [&](const auto& table, const auto& source, uint32_t width) {
            return run(*by_rows, table, source, width);
        });
        if (HasFailure()) break;
    }
}

TEST_F(RefineOnDevice, gives_the_points_of_refined_grids_as_gpus_do) {
    pretend_gpu();
    const auto by_tiles = SurfaceEvaluator::create(device());
    ASSERT_TRUE(by_tiles);
    size_t count = 0;
    for (const TestMesh& shape : limn::test::all_shapes()) {
        SCOPED_TRACE(shape.name);
        if (++count % 5 != 0) continue;
        const Result<ControlMesh> mesh = ControlMesh::create(shape.description());
        check_refined_grid(shape, *mesh, [&](const auto& table, const auto& source, uint32_t width) {
            return run(*by_tiles, table, source, width);
        });
        if (HasFailure()) break;
    }
}

TEST_F(RefineOnDevice, refuses_refined_grids_that_make_no_sense) {
    const auto evaluator = SurfaceEvaluator::create(device());
    const Result<ControlMesh> mesh = ControlMesh::create(limn::test::make_cube().description());
    const auto base = build_refinement(*mesh, {.level = 0});
    for (const uint32_t level : {0u, 8u})
        EXPECT_EQ(build_refined_grid_table(*base, {.level = level}).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(build_refined_grid_table(*base, {.level = 5, .max_weight_bytes = 1000}).error().code, ErrorCode::too_large);
    const auto table = *upload_refined_grid_table(device(), *build_refined_grid_table(*base, {.level = 2}));
    const Buffer points = *create_point_buffer(device(), std::vector<float>(3000));
    const RefinedGridInfo good = {.table = &table, .source = {.buffer = points.handle}, .refined = {.buffer = points.handle}};
    for (const auto& spoil : std::initializer_list<void (*)(RefinedGridInfo&)>{
             [](RefinedGridInfo& i) { i.table = nullptr; }, [](RefinedGridInfo& i) { i.width = 5; },
             [](RefinedGridInfo& i) { i.source.stride = 2; }, [](RefinedGridInfo& i) { i.refined.buffer = VK_NULL_HANDLE; }}) {
        RefinedGridInfo bad = good;
        spoil(bad);
        EXPECT_EQ(evaluator->prepare_refined(bad).error().code, ErrorCode::invalid_argument);
    }
}

TEST_F(RefineOnDevice, notices_a_wrong_table) {
    const TestMesh cube = limn::test::make_cube();
    const Result<ControlMesh> mesh = ControlMesh::create(cube.description());
    const Result<Refinement> refinement = build_refinement(*mesh, {2, false});
    const auto expected = build_stencil_table<double>(*refinement, 2);
    auto tables = one(build_stencil_table<float>(*refinement, 2));
    tables[0].weights[5] += 1e-3f;
    HostPoints host{std::vector<double>(size_t{expected->row_count()} * 3), 3};
    apply_stencil_table<double>(*expected, cube.positions_double(), host.values, 3);
    EXPECT_FALSE(points_match(host, {run(tables, cube.positions, 3), 0, 3}, tolerance_of(cube.positions, 3)));
}

TEST_F(RefineOnDevice, gives_the_same_bits_at_every_run) {
    TestMesh torus = limn::test::make_torus(12, 9);
    torus.perturb(0.1);
    const Result<ControlMesh> mesh = ControlMesh::create(torus.description());
    const Result<Refinement> refinement = build_refinement(*mesh, {3, false});
    const auto tables = one(build_stencil_table<float>(*refinement, 3));
    EXPECT_EQ(run(tables, torus.positions, 3), run(tables, torus.positions, 3));
}

}  // namespace
}  // namespace limn::vk::test
