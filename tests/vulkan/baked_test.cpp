// Tables that lie in a mapped file, on the device: the same bits as of tables that were just built.
#include "files.h"
#include "limn/baked_file.h"
#include "shapes/bake_shape.h"
#include "vulkan/device_tessellation.h"

namespace limn::vk::test {
namespace {

using limn::test::TestMesh;
using Words = std::vector<uint32_t>;

/// What one frame writes: level-1 points, a grid with normals, a tessellation with normals.
struct Frame {
    Words points, grid, grid_normals, positions, normals, indices, command;
};

class BakedOnDevice : public TessellatorTest {
  protected:
    void evaluate_triangles(const BakedMesh& mesh, const DevicePatchTable& patches, const Buffer& points, Frame& out);
    Frame evaluate(const BakedMesh& mesh);
};

void BakedOnDevice::evaluate_triangles(const BakedMesh& mesh, const DevicePatchTable& patches, const Buffer& points,
                                       Frame& out) {
    const RateSettings settings = {.value = 5, .max_rate = mesh.trees.max_rate};
    const Words rates(mesh.tessellation.rate_edge_count, 5 * shared::kRateOne);
    const TessellationCounts most = count_tessellation(mesh.tessellation, rates, TessellationSpacing::integer);
    const DeviceTessellationTable table = *upload_tessellation_table(device(), mesh.tessellation, mesh.trees);
    Buffer positions = words(3 * most.vertices), normals = words(3 * most.vertices), indices = words(3 * most.triangles),
           command = words(5), result = words(4);
    const auto tessellation = tessellator_->prepare({.patches = &patches,
                                                     .table = &table,
                                                     .points = {.buffer = points.handle},
                                                     .vertex_capacity = static_cast<uint32_t>(most.vertices),
                                                     .triangle_capacity = static_cast<uint32_t>(most.triangles),
                                                     .positions = {.buffer = positions.handle},
                                                     .normals = {.buffer = normals.handle},
                                                     .indices = {indices.handle},
                                                     .command = {command.handle},
                                                     .result = {result.handle}});
    ASSERT_TRUE(tessellation);
    run([&](VkCommandBuffer commands) { EXPECT_TRUE(tessellation->record(commands, settings)); });
    EXPECT_EQ((*download<TessellationResult>(device(), result, 1))[0].status, TessellationStatus::complete);
    out.positions = read(positions, 3 * most.vertices);
    out.normals = read(normals, 3 * most.vertices);
    out.indices = read(indices, 3 * most.triangles);
    out.command = read(command, 5);
}

Frame BakedOnDevice::evaluate(const BakedMesh& mesh) {
    Frame out;
    const DevicePatchTable patches = *upload_patch_table(device(), mesh.patches);
    Buffer points = words(size_t{3} * patches.point_count);
    const std::span<const float> positions(mesh.positions.data(), mesh.positions.size());
    EXPECT_TRUE(upload_bytes(device(), points, 0, std::as_bytes(positions)));
    const auto refined = surfaces_->prepare_points({.patches = &patches, .points = {.buffer = points.handle}});
    EXPECT_TRUE(refined);
    run([&](VkCommandBuffer commands) { refined->record(commands); });
    out.points = read(points, size_t{3} * patches.point_count);
    GridBits grid = evaluate_grid(*upload_grid_table(device(), mesh.grids[0]), patches, points);
    out.grid = std::move(grid.values);
    out.grid_normals = std::move(grid.normals);
    evaluate_triangles(mesh, patches, points, out);
    return out;
}

/// Names of what differs.
std::vector<std::string> differences(const Frame& a, const Frame& b) {
    std::vector<std::string> names;
    const std::pair<const char*, Words Frame::*> all[] = {
        {"points", &Frame::points},       {"grid", &Frame::grid},       {"grid normals", &Frame::grid_normals},
        {"positions", &Frame::positions}, {"normals", &Frame::normals}, {"indices", &Frame::indices},
        {"command", &Frame::command}};
    for (const auto& [name, words] : all)
        if (a.*words != b.*words) names.emplace_back(name);
    return names;
}

TEST_F(BakedOnDevice, MappedTablesGiveTheSameBits) {
    const limn::TemporaryDirectory directory;
    const std::string path = directory.file("a.limn");
    std::vector<TestMesh> shapes = limn::test::all_shapes();
    uint32_t compared = 0;
    for (size_t i = 0; i < shapes.size(); i += 9) {
        SCOPED_TRACE(shapes[i].name);
        const auto built = limn::test::bake_shape(shapes[i], true);
        ASSERT_TRUE(built.has_value()) << built.error().message;
        ASSERT_TRUE(write_baked_file(path, *built).has_value());
        const auto file = BakedFile::open(path);
        ASSERT_TRUE(file.has_value()) << file.error().message;
        EXPECT_TRUE(file->mesh().patches.surfaces.empty() || file->mesh().patches.surfaces.is_borrowed());
        EXPECT_EQ(differences(evaluate(*built), evaluate(file->mesh())), std::vector<std::string>());
        ++compared;
    }
    EXPECT_GT(compared, 10u);
}

TEST_F(BakedOnDevice, RefusesToTessellateWithoutTrees) {
    const auto mesh = bake_mesh(limn::test::make_pyramid(5).description(), {.max_rate = 0});
    ASSERT_TRUE(mesh);
    const auto table = upload_tessellation_table(device(), mesh->tessellation, mesh->trees);
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(table.error().message.find("no patch trees"), std::string::npos);
}

TEST_F(BakedOnDevice, ComparisonSeesOneWeightAndOnePosition) {
    auto mesh = *limn::test::bake_shape(limn::test::make_pyramid(5), true);
    const Frame before = evaluate(mesh);
    EXPECT_EQ(differences(before, evaluate(mesh)), std::vector<std::string>());
    for (float& weight : mesh.grids[0].weights) weight *= 1.0001f;
    const std::vector<std::string> of_grid = {"grid", "grid normals"};
    EXPECT_EQ(differences(before, evaluate(mesh)), of_grid);
    mesh.positions[0] += 0.125f;
    EXPECT_GE(differences(before, evaluate(mesh)).size(), 4u);
}

}  // namespace
}  // namespace limn::vk::test
