// The example of docs/migrating_from_opensubdiv.md, run beside OpenSubdiv's CPU evaluator.
#include <gtest/gtest.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuPatchTable.h>

#include <memory>
#include <vector>

#include "conformance/osd_refiner.h"
#include "shapes/shapes.h"
#include "vulkan/vulkan_test.h"

// [docs]
#include <limn/osd/evaluator.h>

using namespace OpenSubdiv;
using limn::osd::VkEvaluator;

// P, du and dv at places of a surface, with the tables that Far made.
bool evaluate(const limn::vk::Device& device, const Far::StencilTable& far_stencils, const Far::PatchTable& far_patches,
              const std::vector<float>& control_points, const std::vector<Osd::PatchCoord>& coords, float* results) {
    const int control_count = far_stencils.GetNumControlVertices(), place_count = static_cast<int>(coords.size());
    const int point_count = control_count + far_stencils.GetNumStencils();
    std::unique_ptr<limn::osd::VkDeviceContext> context(limn::osd::VkDeviceContext::Create(device));
    std::unique_ptr<limn::osd::VkStencilTable> stencils(limn::osd::VkStencilTable::Create(&far_stencils, context.get()));
    std::unique_ptr<limn::osd::VkPatchTable> patches(limn::osd::VkPatchTable::Create(&far_patches, context.get()));
    std::unique_ptr<limn::osd::VkVertexBuffer> points(limn::osd::VkVertexBuffer::Create(3, point_count, context.get()));
    std::unique_ptr<limn::osd::VkVertexBuffer> places(limn::osd::VkVertexBuffer::Create(5, place_count, context.get()));
    std::unique_ptr<limn::osd::VkVertexBuffer> values(limn::osd::VkVertexBuffer::Create(9, place_count, context.get()));
    if (!stencils || !patches || !points || !places || !values) return false;  // context->GetError() says why

    using Osd::BufferDescriptor;
    const BufferDescriptor control(0, 3, 3), refined(3 * control_count, 3, 3);
    return points->UpdateData(control_points.data(), 0, control_count) &&
           places->UpdateData(reinterpret_cast<const float*>(coords.data()), 0, place_count) &&
           VkEvaluator::EvalStencils(points.get(), control, points.get(), refined, stencils.get()) &&
           VkEvaluator::EvalPatches(points.get(), control, values.get(), BufferDescriptor(0, 3, 9), values.get(),
                                    BufferDescriptor(3, 3, 9), values.get(), BufferDescriptor(6, 3, 9), place_count,
                                    places.get(), patches.get()) &&
           values->ReadData(results, 0, place_count);
}
// [/docs]

namespace {

class OsdDocsTest : public limn::vk::test::VulkanTest {};

TEST_F(OsdDocsTest, the_example_gives_what_opensubdiv_gives) {
    const limn::test::TestMesh mesh = limn::test::make_cube();
    std::string error;
    const auto refiner = limn::test::make_osd_refiner(mesh, &error);
    ASSERT_NE(refiner, nullptr) << error;
    Far::PatchTableFactory::Options options(3);
    options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    const std::unique_ptr<const Far::PatchTable> patches(Far::PatchTableFactory::Create(*refiner, options));
    const std::unique_ptr<const Far::StencilTable> refined(Far::StencilTableFactory::Create(*refiner));
    const std::unique_ptr<const Far::StencilTable> stencils(Far::StencilTableFactory::AppendLocalPointStencilTable(
        *refiner, refined.get(), patches->GetLocalPointStencilTable()));
    std::vector<Osd::PatchCoord> coords;
    for (int array = 0, first = 0; array < patches->GetNumPatchArrays(); first += patches->GetNumPatches(array++))
        for (int p = 0; p < patches->GetNumPatches(array); ++p) {
            float s = 0.3f, t = 0.6f;
            patches->GetPatchParam(array, p).Unnormalize(s, t);
            Far::PatchTable::PatchHandle handle;
            handle.arrayIndex = array;
            handle.patchIndex = first + p;
            handle.vertIndex = 0;
            coords.emplace_back(handle, s, t);
        }
    const int count = static_cast<int>(coords.size());
    std::vector<float> ours(coords.size() * 9), theirs(ours.size()), points = mesh.positions;
    ASSERT_TRUE(evaluate(device(), *stencils, *patches, mesh.positions, coords, ours.data()));

    points.resize(points.size() + static_cast<size_t>(3 * stencils->GetNumStencils()));
    const std::unique_ptr<Osd::CpuPatchTable> table(Osd::CpuPatchTable::Create(patches.get()));
    const Osd::BufferDescriptor xyz(0, 3, 3);
    Osd::CpuEvaluator::EvalStencils(points.data(), xyz, points.data() + mesh.positions.size(), xyz,
                                    stencils->GetSizes().data(), stencils->GetOffsets().data(),
                                    stencils->GetControlIndices().data(), stencils->GetWeights().data(), 0,
                                    stencils->GetNumStencils());
    Osd::CpuEvaluator::EvalPatches(points.data(), xyz, theirs.data(), Osd::BufferDescriptor(0, 3, 9), theirs.data() + 3,
                                   Osd::BufferDescriptor(0, 3, 9), theirs.data() + 6, Osd::BufferDescriptor(0, 3, 9), count,
                                   coords.data(), table->GetPatchArrayBuffer(), table->GetPatchIndexBuffer(),
                                   table->GetPatchParamBuffer());
    ASSERT_GT(count, 20);
    for (size_t i = 0; i < ours.size(); ++i) EXPECT_NEAR(ours[i], theirs[i], i % 9 < 3 ? 4e-6 : 4e-5) << i;
}

}  // namespace
