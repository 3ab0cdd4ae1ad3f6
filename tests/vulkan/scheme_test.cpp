// Every scheme on the device, refined and brought to its limit, against the same tables in double on the host.
#include "limn/schemes/scheme_limit.h"
#include "limn/vulkan/evaluator.h"
#include "shapes/shapes.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk {
namespace {

using limn::test::TestMesh;
using test::DevicePoints;
using test::HostPoints;
using test::points_match;

TestMesh shape_for(const SubdivisionScheme& scheme, bool open) {
    TestMesh shape = open                                 ? limn::test::make_grid(4, 3)
                     : scheme.faces == FaceKind::polygons ? limn::test::make_prism(5)
                                                          : limn::test::make_cube();
    shape.perturb(0.2, 3);
    if (scheme.faces == FaceKind::triangles) shape.triangulate();
    return shape;
}

ControlMesh control_mesh_of(const TestMesh& shape) {
    ControlMeshDescription description;
    description.vertex_count = static_cast<uint32_t>(shape.positions_double().size() / 3);
    description.face_sizes = shape.face_sizes;
    description.face_vertices = shape.face_vertices;
    auto mesh = ControlMesh::create(description);
    EXPECT_TRUE(mesh) << mesh.error().message;
    return std::move(*mesh);
}

std::vector<double> sums(const StencilTableDouble& table, const Array<double>& weights,
                         const std::vector<double>& from) {
    std::vector<double> to(size_t{3} * table.row_count(), 0.0);
    for (uint32_t r = 0; r < table.row_count(); ++r)
        for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k)
            for (size_t i = 0; i < 3; ++i) to[3 * size_t{r} + i] += weights[k] * from[3 * size_t{table.indices[k]} + i];
    return to;
}

class SchemeOnDevice : public test::VulkanTest {
  protected:
    Buffer upload(const std::vector<float>& values) {
        auto buffer = create_point_buffer(device(), std::span<const float>(values));
        EXPECT_TRUE(buffer) << buffer.error().message;
        return buffer ? std::move(*buffer) : Buffer{};
    }
    DevicePoints read(const Buffer& buffer) {
        auto values = download<float>(device(), buffer, buffer.size_bytes / 4);
        EXPECT_TRUE(values) << values.error().message;
        return {values ? std::move(*values) : std::vector<float>{}, 0, 3};
    }

    /// All tables in one command buffer, the limits last.
    void check(const SubdivisionScheme& scheme, const TestMesh& shape) {
        const ControlMesh mesh = control_mesh_of(shape);
        const auto refined = build_scheme_refinement<float>(mesh, scheme, {2, true});
        const auto exact = build_scheme_refinement<double>(mesh, scheme, {2, true});
        ASSERT_TRUE(refined && exact);
        const auto limits = build_scheme_limit_table(*refined, true);
        const auto exact_limits = build_scheme_limit_table(*exact, true);
        ASSERT_TRUE(limits && exact_limits);

        std::vector<double> points = shape.positions_double();
        const std::vector<float> control(points.begin(), points.end());
        for (const StencilTableDouble& table : exact->tables) points = sums(table, table.weights, points);

        auto evaluator = Evaluator::create(device());
        ASSERT_TRUE(evaluator);
        std::vector<DeviceStencilTable> tables;
        std::vector<Buffer> buffers;
        std::vector<StencilEvaluation> evaluations;
        buffers.push_back(upload(control));
        for (size_t i = 0; i <= refined->tables.size(); ++i) {
            const StencilTable& table = i < refined->tables.size() ? refined->tables[i] : *limits;
            auto uploaded = upload_stencil_table(device(), table);
            ASSERT_TRUE(uploaded) << uploaded.error().message;
            tables.push_back(std::move(*uploaded));
            const std::vector<float> empty(size_t{3} * table.row_count(), 7.0f);
            for (size_t k = 0; k < (i < refined->tables.size() ? 1 : 3); ++k) buffers.push_back(upload(empty));
        }
        auto commands = Commands::begin(device());
        ASSERT_TRUE(commands);
        for (size_t i = 0; i < tables.size(); ++i) {
            StencilEvaluationInfo info = {.table = &tables[i],
                                          .width = 3,
                                          .source = {.buffer = buffers[i].handle},
                                          .destination = {.buffer = buffers[i + 1].handle}};
            if (i + 1 == tables.size()) {
                info.tangent1 = {.buffer = buffers[i + 2].handle};
                info.tangent2 = {.buffer = buffers[i + 3].handle};
            }
            auto evaluation = evaluator->prepare(info);
            ASSERT_TRUE(evaluation) << evaluation.error().message;
            evaluation->record(*commands);
            record_barrier(device(), *commands, kKernelWrites, kKernelReads | kCopyReads);
            evaluations.push_back(std::move(*evaluation));
        }
        ASSERT_TRUE(commands->submit_and_wait());
        const double tolerance = test::tolerance_of(control, 3);
        const size_t last = tables.size();
        EXPECT_TRUE(
            points_match({sums(*exact_limits, exact_limits->weights, points), 3}, read(buffers[last]), tolerance));
        // Tangents are sums of some ten points with weights of up to one.
        EXPECT_TRUE(points_match({sums(*exact_limits, exact_limits->tangent1_weights, points), 3},
                                 read(buffers[last + 1]), 5 * tolerance));
        EXPECT_TRUE(points_match({sums(*exact_limits, exact_limits->tangent2_weights, points), 3},
                                 read(buffers[last + 2]), 5 * tolerance));
    }
};

TEST_F(SchemeOnDevice, RefinesAndFindsLimits) {
    for (const SubdivisionScheme& scheme : subdivision_schemes())
        for (const bool open : {false, true}) {
            SCOPED_TRACE(std::string(scheme.name) + (open ? ", open" : ", closed"));
            check(scheme, shape_for(scheme, open));
        }
}

}  // namespace
}  // namespace limn::vk
