// Surfaces of schemes on the device: positions and normals as on the host.
#include "limn/vulkan/scheme_evaluator.h"

#include "shapes/shapes.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk {
namespace {

using test::points_match;

class SchemeEvaluatorTest : public test::VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        shape_ = limn::test::make_prism(5);
        shape_.perturb(0.2, 5);
        auto mesh = ControlMesh::create(shape_.description());
        ASSERT_TRUE(mesh);
        auto surface = build_scheme_surface(*mesh, *find_subdivision_scheme("doo-sabin"), {.level = 3});
        ASSERT_TRUE(surface) << surface.error().message;
        surface_ = std::move(*surface);
        expected_ = apply_scheme_surface(surface_, shape_.positions);
    }
    /// Six floats a vertex from float `first` on; 7 where nothing is written.
    std::vector<float> evaluate(uint32_t first, uint32_t stride) {
        auto evaluator = SchemeEvaluator::create(device());
        EXPECT_TRUE(evaluator);
        auto uploaded = upload_scheme_surface(device(), surface_);
        EXPECT_TRUE(uploaded) << uploaded.error().message;
        const Buffer points = *create_point_buffer(device(), shape_.positions);
        const size_t count = first + size_t{stride} * surface_.vertex_count;
        const Buffer vertices = words(count);
        auto evaluation = evaluator->prepare(
            {.surface = &*uploaded,
             .points = {.buffer = points.handle},
             .positions = {.buffer = vertices.handle, .first = first, .stride = stride},
             .normals = {.buffer = vertices.handle, .first = first + 3, .stride = stride}});
        EXPECT_TRUE(evaluation) << evaluation.error().message;
        for (int frame = 0; frame < 2; ++frame)
            run([&](VkCommandBuffer commands) { evaluation->record(commands); });
        return *download<float>(device(), vertices, count);
    }
    void expect_surface(const std::vector<float>& values, uint32_t first, uint32_t stride) {
        const std::vector<double> positions(expected_.positions.begin(), expected_.positions.end());
        const std::vector<double> normals(expected_.normals.begin(), expected_.normals.end());
        EXPECT_TRUE(points_match({positions, 3}, {values, first, stride}, test::tolerance_of(shape_.positions, 3)));
        EXPECT_TRUE(points_match({normals, 3}, {values, first + 3u, stride}, 2e-4));
    }

    limn::test::TestMesh shape_;
    SchemeSurface surface_;
    SchemeVertices expected_;
};

TEST_F(SchemeEvaluatorTest, GivesPositionsAndNormals) {
    const std::vector<float> once = evaluate(5, 8);
    expect_surface(once, 5, 8);
    EXPECT_EQ(once, evaluate(5, 8)) << "the same bits at every run";
    const uint32_t untouched = 7;
    for (size_t v = 0; v < surface_.vertex_count; ++v)
        for (const size_t k : {6u, 7u})
            EXPECT_EQ(std::bit_cast<uint32_t>(once[5 + 8 * v + k]), untouched) << "between vertices";
}

TEST_F(SchemeEvaluatorTest, GivesTheSameWhereStorageBuffersAreRead) {
    pretend_gpu();
    expect_surface(evaluate(0, 6), 0, 6);
}

TEST_F(SchemeEvaluatorTest, SaysWhatMemoryAnUploadTakes) {
    const auto need = upload_memory(surface_);
    const auto uploaded = upload_scheme_surface(device(), surface_);
    ASSERT_TRUE(need && uploaded);
    EXPECT_EQ(need->device_bytes, uploaded->bytes());
    EXPECT_EQ(need->buffer_count, uploaded->tables.size() + 1);
}

/// A comparison that could not fail would be none.
TEST_F(SchemeEvaluatorTest, SeesAPerturbedVertex) {
    std::vector<float> values = evaluate(0, 6);
    values[6 * 17 + 1] += 1e-4f;
    const std::vector<double> positions(expected_.positions.begin(), expected_.positions.end());
    EXPECT_FALSE(points_match({positions, 3}, {values, 0, 6}, test::tolerance_of(shape_.positions, 3)));
}

TEST_F(SchemeEvaluatorTest, RefusesBadArguments) {
    auto evaluator = SchemeEvaluator::create(device());
    auto uploaded = upload_scheme_surface(device(), surface_);
    ASSERT_TRUE(evaluator && uploaded);
    const Buffer buffer = words(size_t{6} * surface_.vertex_count);
    const SchemeEvaluationInfo good = {.surface = &*uploaded,
                                       .points = {.buffer = buffer.handle},
                                       .positions = {.buffer = buffer.handle, .stride = 6},
                                       .normals = {.buffer = buffer.handle, .first = 3, .stride = 6}};
    SchemeEvaluationInfo bad[4] = {good, good, good, good};
    bad[0].surface = nullptr;
    bad[1].points.buffer = VK_NULL_HANDLE;
    bad[2].positions.stride = 2;
    bad[3].normals.offset_bytes = 2;
    for (const SchemeEvaluationInfo& info : bad) {
        const auto refused = evaluator->prepare(info);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
    }
    EXPECT_TRUE(evaluator->prepare(good));
}

/// A flat control mesh has one normal; one point has none, and gets a unit vector all the same.
TEST_F(SchemeEvaluatorTest, NormalsAreUnitVectorsWhateverTheTangents) {
    for (float& x : shape_.positions) x = 1;
    expected_ = apply_scheme_surface(surface_, shape_.positions);
    const std::vector<float> values = evaluate(0, 6);
    for (size_t v = 0; v < surface_.vertex_count; ++v) {
        const float* n = values.data() + 6 * v + 3;
        ASSERT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
    }
}

}  // namespace
}  // namespace limn::vk
