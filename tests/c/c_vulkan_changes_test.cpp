// Tables that change on the device, surfaces of schemes and curvatures by way of the C interface: the C++ interface's
// bits.
#include "c/c_vulkan_objects.h"
#include "limn/c/limn_vulkan_changes.h"
#include "limn/c/limn_vulkan_schemes.h"
#include "limn/c/vulkan_interop.h"
#include "limn/crowd.h"
#include "limn/mesh_edit.h"
#include "limn/vulkan/crowd_tables.h"
#include "shapes/shapes.h"

namespace limn::vk::test {
namespace {

using limn::test::sweep;

constexpr float kReserve = 0.5f;
constexpr uint32_t kRate = 4, kMaxRate = 16;
constexpr limn_vk_stage_access kWrites = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_WRITES},
                               kReads = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_READS};

/// What is drawn, and where that is in one buffer of words.
struct Drawing {
    static constexpr uint32_t kVertices = 8192, kTriangles = 16384, kGridPoints = 8192;
    static constexpr VkDeviceSize kPositions = 0, kNormals = 12 * kVertices, kIndices = 24 * kVertices,
                                  kCommand = kIndices + 12 * kTriangles, kResult = kCommand + 32, kGrid = kResult + 32,
                                  kEnd = kGrid + 12 * kGridPoints;
};

class CInterfaceChanges : public VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        if (HasFatalFailure()) return;
        allocator_.emplace(CountingAllocator{device()});
        context_in_c_ = borrow_in_c(objects_, device(), *allocator_);
        evaluator_.emplace(*SurfaceEvaluator::create(device()));
        tessellator_.emplace(*Tessellator::create(device()));
    }
    void TearDown() override {
        objects_.clear();
        EXPECT_TRUE(!allocator_ || allocator_->live == 0);
        VulkanTest::TearDown();
    }

    /// Points of a table: some numbers, then what level 1 needs.
    Buffer points_for(const DevicePatchTable& patches) {
        const std::vector<float> control = some_floats(size_t{3} * patches.control_count, 0.1f);
        return filled_buffer(device(), std::as_bytes(std::span(control)), VkDeviceSize{12} * patches.point_count);
    }
    Buffer room() { return filled_buffer(device(), {}, Drawing::kEnd); }
    std::vector<uint32_t> read(const Buffer& drawing) {
        return *download<uint32_t>(device(), drawing, Drawing::kEnd / 4);
    }
    /// Level-1 points, a tessellation and, where there is one, a grid: with the C++ interface.
    std::vector<uint32_t> draw(const DevicePatchTable& patches, const DeviceTessellationTable& table,
                               const DeviceGridTable* grid = nullptr);
    /// The same with the C interface, but for the grid.
    std::vector<uint32_t> draw_in_c(const limn_vk_patch_table* patches, const limn_vk_tessellation_table* table);

    std::optional<CountingAllocator> allocator_;
    Objects objects_;
    limn_vk_context* context_in_c_ = nullptr;
    limn_vk_evaluator* evaluator_in_c_ = nullptr;  ///< of draw_in_c, as the next
    limn_vk_tessellator* tessellator_in_c_ = nullptr;
    std::optional<SurfaceEvaluator> evaluator_;
    std::optional<Tessellator> tessellator_;
};

std::vector<uint32_t> CInterfaceChanges::draw(const DevicePatchTable& patches, const DeviceTessellationTable& table,
                                              const DeviceGridTable* grid) {
    const Buffer points = points_for(patches), out = room();
    const PointBuffer from{points.handle};
    const auto refined = evaluator_->prepare_points({.patches = &patches, .points = from});
    const auto triangles = tessellator_->prepare({.patches = &patches,
                                                  .table = &table,
                                                  .points = from,
                                                  .vertex_capacity = Drawing::kVertices,
                                                  .triangle_capacity = Drawing::kTriangles,
                                                  .positions = {out.handle, Drawing::kPositions},
                                                  .normals = {out.handle, Drawing::kNormals},
                                                  .indices = {out.handle, Drawing::kIndices},
                                                  .command = {out.handle, Drawing::kCommand},
                                                  .result = {out.handle, Drawing::kResult}});
    EXPECT_TRUE(refined && triangles);
    std::optional<SurfaceEvaluation> samples;
    if (grid != nullptr) {
        EXPECT_LE(grid->sample_count(), Drawing::kGridPoints);
        samples.emplace(*evaluator_->prepare_grid(
            {.patches = &patches, .grid = grid, .points = from, .values = {out.handle, Drawing::kGrid}}));
    }
    run([&](VkCommandBuffer commands) {
        refined->record(commands);
        record_barrier(device(), commands, kKernelWrites, kKernelReads);
        EXPECT_TRUE(triangles->record(commands, {.value = kRate, .max_rate = kMaxRate}));
        if (samples) samples->record(commands);
    });
    return read(out);
}

std::vector<uint32_t> CInterfaceChanges::draw_in_c(const limn_vk_patch_table* patches,
                                                   const limn_vk_tessellation_table* table) {
    const Buffer points = points_for(patches->value), out = room();
    if (evaluator_in_c_ == nullptr) {
        evaluator_in_c_ = LIMN_NEW(objects_, limn_vk_evaluator, limn_vk_evaluator_create, context_in_c_);
        tessellator_in_c_ = LIMN_NEW(objects_, limn_vk_tessellator, limn_vk_tessellator_create, context_in_c_);
    }
    Objects objects;
    auto refine = sized<limn_vk_points_info>();
    refine.patches = patches, refine.points = points_of(points);
    auto* refined = LIMN_NEW(objects, limn_vk_evaluation, limn_vk_evaluator_prepare_points, evaluator_in_c_, &refine);
    auto info = sized<limn_vk_tessellation_info>();
    info.patches = patches, info.table = table, info.points = points_of(points);
    info.vertex_capacity = Drawing::kVertices, info.triangle_capacity = Drawing::kTriangles;
    info.positions = points_of(out, Drawing::kPositions), info.normals = points_of(out, Drawing::kNormals);
    info.indices = {out.handle, Drawing::kIndices};
    info.command = {out.handle, Drawing::kCommand}, info.result = {out.handle, Drawing::kResult};
    auto* triangles = LIMN_NEW(objects, limn_vk_tessellation, limn_vk_tessellator_prepare, tessellator_in_c_, &info);
    auto settings = sized<limn_vk_rate_settings>();
    settings.value = kRate, settings.max_rate = kMaxRate;
    run([&](VkCommandBuffer commands) {
        limn_vk_evaluation_record(refined, commands);
        limn_vk_record_barrier(context_in_c_, commands, kWrites, kReads);
        EXPECT_EQ(limn_vk_tessellation_record(triangles, commands, &settings, nullptr), LIMN_SUCCESS);
    });
    return read(out);
}

uint32_t triangles_of(const std::vector<uint32_t>& drawing) {
    return drawing[Drawing::kResult / 4 + 2];
}

void expect_same_update(const limn_vk_table_update* in_c, const TableUpdate& expected) {
    auto info = sized<limn_vk_table_update_info>();
    ASSERT_EQ(limn_vk_table_update_get_info(in_c, &info, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(info.prepare_again != 0, expected.prepare_again);
    EXPECT_EQ(info.copied_bytes, expected.copied_bytes);
}

// Edits of the surface of c_vulkan_scene.h: its channel keeps its faces.
constexpr uint32_t kEditedEdge[] = {3, 4}, kHole[] = {1};
constexpr float kEditedSharpness[][1] = {{1.5f}, {10}, {0}};

/// An edited mesh and what a device has of it, in C++ and in C, before and after an edit.
struct EditedTables {
    PatchTable patches;
    TessellationTable tessellation;
    PatchTreeTable trees;
    GridTable grid;
    TessellationTables sources() const { return {&tessellation, &trees}; }

    static std::unique_ptr<EditedTables> of(const EditableMesh& mesh) {
        auto out = std::make_unique<EditedTables>(EditedTables{mesh.patches(), mesh.tessellation(), {}, {}});
        out->trees = *build_patch_trees(out->patches, {});
        out->grid = *build_grid_table(out->patches, {.rate = kGridRate});
        return out;
    }
};
struct EditedTablesInC {
    limn_patch_table* patches;
    limn_tessellation_table* tessellation;
    limn_patch_trees* trees;
    limn_grid_table* grid;
    limn_vk_tessellation_sources sources() const { return {tessellation, trees, nullptr, 0}; }

    static EditedTablesInC of(Objects& objects, const limn_editable_mesh* mesh) {
        EditedTablesInC out = {};
        out.patches =
            LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_copy, limn_editable_mesh_get_patches(mesh));
        out.tessellation = LIMN_NEW(objects, limn_tessellation_table, limn_tessellation_table_create_copy,
                                    limn_editable_mesh_get_tessellation(mesh));
        out.trees = LIMN_NEW(objects, limn_patch_trees, limn_patch_trees_create, out.patches, nullptr);
        auto grid = sized<limn_grid_table_options>();
        grid.rate = kGridRate;
        out.grid = LIMN_NEW(objects, limn_grid_table, limn_grid_table_create, out.patches, &grid);
        return out;
    }
};

ControlMesh scene_mesh() {
    return *ControlMesh::create({.vertex_count = kVertexCount, .face_sizes = kSizes, .face_vertices = kFaces});
}
limn_control_mesh* scene_mesh_in_c(Objects& objects) {
    auto d = sized<limn_control_mesh_description>();
    d.vertex_count = kVertexCount;
    d.face_sizes = kSizes, d.face_count = 3;
    d.face_vertices = kFaces, d.face_vertex_count = 11;
    return LIMN_NEW(objects, limn_control_mesh, limn_control_mesh_create, &d);
}

TEST_F(CInterfaceChanges, edited_tables_have_the_bits_of_the_cpp_interface) {
    EditableMesh mesh = *EditableMesh::create(scene_mesh(), {});
    auto* mesh_in_c =
        LIMN_NEW(objects_, limn_editable_mesh, limn_editable_mesh_create, scene_mesh_in_c(objects_), nullptr, nullptr);
    DevicePatchTable patches;
    DeviceTessellationTable table;
    DeviceGridTable grid;
    auto* patches_in_c = LIMN_NEW(objects_, limn_vk_patch_table, limn_vk_patch_table_create_empty);
    auto* table_in_c = LIMN_NEW(objects_, limn_vk_tessellation_table, limn_vk_tessellation_table_create_empty);
    auto* grid_in_c = LIMN_NEW(objects_, limn_vk_grid_table, limn_vk_grid_table_create_empty);
    auto before = std::make_unique<EditedTables>();
    EditedTablesInC before_in_c = {};
    std::vector<std::vector<uint32_t>> drawings;
    for (uint32_t step = 0; step < 5; ++step) {
        SCOPED_TRACE(step);
        if (step != 0) {
            const bool has_hole = step == 4;
            const MeshEdit edit =
                has_hole ? MeshEdit{.holes = kHole}
                         : MeshEdit{.crease_vertices = kEditedEdge, .crease_sharpness = kEditedSharpness[step - 1]};
            auto given = sized<limn_mesh_edit>();
            given.crease_vertices = edit.crease_vertices.data(),
            given.crease_vertex_count = edit.crease_vertices.size();
            given.crease_sharpness = edit.crease_sharpness.data();
            given.crease_sharpness_count = edit.crease_sharpness.size();
            given.holes = edit.holes.data(), given.hole_count = edit.holes.size();
            ASSERT_TRUE(mesh.edit(edit));
            ASSERT_EQ(limn_editable_mesh_edit(mesh_in_c, &given, nullptr, nullptr), LIMN_SUCCESS);
        }
        auto after = EditedTables::of(mesh);
        const EditedTablesInC after_in_c = EditedTablesInC::of(objects_, mesh_in_c);
        const limn_vk_tessellation_sources from = before_in_c.sources(), to = after_in_c.sources();
        std::vector<TableUpdate> updates;
        Objects updates_in_c;
        run([&](VkCommandBuffer commands) {
            updates.push_back(
                *record_patch_table_update(device(), commands, patches, before->patches, after->patches, kReserve));
            updates.push_back(*record_tessellation_table_update(device(), commands, table, before->sources(),
                                                                after->sources(), kReserve));
            updates.push_back(*record_grid_table_update(device(), commands, grid, before->grid, after->grid, kReserve));
            const limn_vk_table_update* const all[] = {
                LIMN_NEW(updates_in_c, limn_vk_table_update, limn_vk_patch_table_update, context_in_c_, commands,
                         patches_in_c, before_in_c.patches, after_in_c.patches, kReserve),
                LIMN_NEW(updates_in_c, limn_vk_table_update, limn_vk_tessellation_table_update, context_in_c_, commands,
                         table_in_c, step == 0 ? nullptr : &from, &to, kReserve),
                LIMN_NEW(updates_in_c, limn_vk_table_update, limn_vk_grid_table_update, context_in_c_, commands,
                         grid_in_c, before_in_c.grid, after_in_c.grid, kReserve)};
            for (size_t i = 0; i < 3; ++i) expect_same_update(all[i], updates[i]);
        });
        drawings.push_back(draw(patches, table, &grid));
        EXPECT_GT(triangles_of(drawings.back()), 20u);
        EXPECT_EQ(draw(patches_in_c->value, table_in_c->value, &grid_in_c->value), drawings.back());
        before = std::move(after);
        before_in_c = after_in_c;
    }
    for (size_t i = 1; i < drawings.size(); ++i) EXPECT_NE(drawings[i], drawings[i - 1]) << i;
    EXPECT_EQ(drawings[3], drawings[0]);
    EXPECT_GT(allocator_->staged, 0);
}

TEST_F(CInterfaceChanges, crowds_have_the_bits_of_the_cpp_interface) {
    const PatchTable patches = *build_patch_table<float>(scene_mesh(), {});
    const TessellationTable topology = *build_tessellation_table(scene_mesh(), {});
    auto* const mesh = scene_mesh_in_c(objects_);
    const limn_crowd_mesh member = {
        LIMN_NEW(objects_, limn_patch_table, limn_patch_table_create, mesh, nullptr, nullptr),
        LIMN_NEW(objects_, limn_tessellation_table, limn_tessellation_table_create, mesh, nullptr)};
    Crowd crowd({.max_rate = kMaxRate});
    auto options = sized<limn_crowd_options>();
    options.max_rate = kMaxRate;
    auto* crowd_in_c = LIMN_NEW(objects_, limn_crowd, limn_crowd_create, &options);
    DeviceCrowd on_device;
    auto* on_device_in_c = LIMN_NEW(objects_, limn_vk_crowd, limn_vk_crowd_create);
    const auto update = [&](bool again) {
        std::optional<TableUpdate> expected;
        Objects updates;
        run([&](VkCommandBuffer commands) {
            expected.emplace(*record_crowd_update(device(), commands, crowd, on_device));
            const auto* made = LIMN_NEW(updates, limn_vk_table_update, limn_vk_crowd_update, context_in_c_, commands,
                                        on_device_in_c, crowd_in_c);
            expect_same_update(made, *expected);
        });
        EXPECT_EQ(expected->prepare_again, again);
        crowd.forget_changes();
        limn_crowd_forget_changes(crowd_in_c);
        const std::vector<uint32_t> drawing = draw(on_device.patches, on_device.topology);
        EXPECT_EQ(draw_in_c(limn_vk_crowd_get_patches(on_device_in_c), limn_vk_crowd_get_tessellation(on_device_in_c)),
                  drawing);
        return triangles_of(drawing);
    };
    const auto add = [&](size_t count) {
        const std::vector<BatchMesh> added(count, {&patches, &topology});
        const std::vector<limn_crowd_mesh> added_in_c(count, member);
        std::vector<uint32_t> numbers(count);
        ASSERT_TRUE(crowd.add(added));
        ASSERT_EQ(limn_crowd_add(crowd_in_c, added_in_c.data(), count, numbers.data(), nullptr), LIMN_SUCCESS);
    };
    add(4);
    const uint32_t four = update(true);
    EXPECT_GT(four, 80u);
    ASSERT_TRUE(crowd.remove(1));
    ASSERT_EQ(limn_crowd_remove(crowd_in_c, 1, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(update(false), four / 4 * 3);
    add(1);
    EXPECT_EQ(update(false), four);
    add(4);
    EXPECT_EQ(update(true), 2 * four);
}

TEST_F(CInterfaceChanges, surfaces_of_schemes_have_the_bits_of_the_cpp_interface) {
    limn::test::TestMesh shape = limn::test::make_prism(5);
    shape.perturb(0.2, 5);
    const SchemeSurface surface = *build_scheme_surface(*ControlMesh::create(shape.description()),
                                                        *find_subdivision_scheme("doo-sabin"), {.level = 3});
    auto description = sized<limn_control_mesh_description>();
    description.vertex_count = static_cast<uint32_t>(shape.positions.size() / 3);
    description.face_sizes = shape.face_sizes.data(), description.face_count = shape.face_sizes.size();
    description.face_vertices = shape.face_vertices.data(), description.face_vertex_count = shape.face_vertices.size();
    auto options = sized<limn_scheme_surface_options>();
    options.scheme = "doo-sabin", options.level = 3;
    auto* mesh = LIMN_NEW(objects_, limn_control_mesh, limn_control_mesh_create, &description);
    auto* surface_in_c = LIMN_NEW(objects_, limn_scheme_surface, limn_scheme_surface_create, mesh, &options);
    const Buffer points = *create_point_buffer(device(), shape.positions);
    const VkDeviceSize count = size_t{6} * surface.vertex_count;
    const Buffer out = filled_buffer(device(), {}, 4 * count), out_in_c = filled_buffer(device(), {}, 4 * count);

    const DeviceSchemeSurface uploaded = *upload_scheme_surface(device(), surface);
    const SchemeEvaluator evaluator = *SchemeEvaluator::create(device());
    const SchemeEvaluation evaluation = *evaluator.prepare({.surface = &uploaded,
                                                            .points = {points.handle},
                                                            .positions = {out.handle, 0, 0, 6},
                                                            .normals = {out.handle, 0, 3, 6}});
    auto* evaluator_in_c = LIMN_NEW(objects_, limn_vk_scheme_evaluator, limn_vk_scheme_evaluator_create, context_in_c_);
    Objects upload;
    run([&](VkCommandBuffer commands) {
        evaluation.record(commands);
        auto* recorded = LIMN_NEW(upload, limn_vk_upload, limn_vk_upload_create, context_in_c_, commands);
        auto info = sized<limn_vk_scheme_surface_info>();
        info.surface =
            LIMN_NEW(objects_, limn_vk_scheme_surface, limn_vk_scheme_surface_create, recorded, surface_in_c);
        info.points = points_of(points);
        info.positions = {out_in_c.handle, 0, 0, 6, 0}, info.normals = {out_in_c.handle, 12, 0, 6, 0};
        auto* made = LIMN_NEW(objects_, limn_vk_evaluation, limn_vk_scheme_evaluator_prepare, evaluator_in_c, &info);
        limn_vk_evaluation_record(made, commands);
        const VkBuffer triangles = limn_vk_scheme_surface_get_triangles(info.surface);
        EXPECT_NE(triangles, VkBuffer{VK_NULL_HANDLE});
        LIMN_SWEEP(limn_vk_scheme_surface_create, 0, limn_vk_scheme_surface, recorded, surface_in_c);
        LIMN_SWEEP(limn_vk_scheme_evaluator_prepare, 0, limn_vk_evaluation, evaluator_in_c, &info);
        limn_vk_evaluation* none = nullptr;
        info.reserved = 1;
        EXPECT_EQ(limn_vk_scheme_evaluator_prepare(evaluator_in_c, &info, &none, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
        info.reserved = 0, info.surface = nullptr;
        EXPECT_EQ(limn_vk_scheme_evaluator_prepare(evaluator_in_c, &info, &none, nullptr), LIMN_ERROR_INVALID_ARGUMENT);
    });
    const auto expected = *download<uint32_t>(device(), out, count);
    EXPECT_EQ(*download<uint32_t>(device(), out_in_c, count), expected);
    EXPECT_NE(expected[3], 0u);
    const auto triangles = *download<uint32_t>(device(), uploaded.triangles, surface.triangles.size());
    EXPECT_TRUE(std::equal(triangles.begin(), triangles.end(), surface.triangles.begin()));
    EXPECT_EQ(limn_vk_scheme_surface_get_triangles(nullptr), VkBuffer{VK_NULL_HANDLE});
    LIMN_SWEEP(limn_vk_scheme_evaluator_create, 0, limn_vk_scheme_evaluator, context_in_c_);
}

TEST_F(CInterfaceChanges, curvatures_have_the_bits_of_the_cpp_interface) {
    constexpr uint32_t kCount = 20;
    const CurvatureEvaluator evaluator = *CurvatureEvaluator::create(device());
    auto* evaluator_in_c =
        LIMN_NEW(objects_, limn_vk_curvature_evaluator, limn_vk_curvature_evaluator_create, context_in_c_);
    for (const uint32_t width : {3u, 4u}) {
        std::vector<float> numbers = some_floats(size_t{6} * width * kCount, 0.3f);
        for (float& x : numbers) x += 1;
        const Buffer values = *create_point_buffer(device(), numbers);
        const Buffer out = filled_buffer(device(), {}, 4 * 28 * kCount),
                     out_in_c = filled_buffer(device(), {}, 4 * 28 * kCount);
        const PointBuffer quotients{out.handle, 40 * kCount, 0, 18};
        const CurvatureEvaluation evaluation =
            *evaluator.prepare({.sample_count = kCount,
                                .width = width,
                                .values = {values.handle, 0, 0, 6 * width},
                                .curvatures = {out.handle, 0, 0, 10},
                                .quotients = width == 4 ? quotients : PointBuffer{}});
        auto info = sized<limn_vk_curvature_info>();
        info.sample_count = kCount, info.width = width == 3 ? 0 : width;
        info.values = points_of(values), info.curvatures = points_of(out_in_c);
        if (width == 4) info.quotients = points_of(out_in_c, 40 * kCount);
        auto* made = LIMN_NEW(objects_, limn_vk_evaluation, limn_vk_curvature_evaluator_prepare, evaluator_in_c, &info);
        run([&](VkCommandBuffer commands) {
            evaluation.record(commands);
            limn_vk_evaluation_record(made, commands);
        });
        const auto expected = *download<uint32_t>(device(), out, size_t{28} * kCount);
        EXPECT_EQ(*download<uint32_t>(device(), out_in_c, size_t{28} * kCount), expected);
        EXPECT_NE(expected[0], 0u);
        EXPECT_EQ(expected[10 * kCount] != 0, width == 4);
        LIMN_SWEEP(limn_vk_curvature_evaluator_prepare, 0, limn_vk_evaluation, evaluator_in_c, &info);
        limn_vk_evaluation* none = nullptr;
        info.reserved = 1;
        EXPECT_EQ(limn_vk_curvature_evaluator_prepare(evaluator_in_c, &info, &none, nullptr),
                  LIMN_ERROR_INVALID_ARGUMENT);
    }
    LIMN_SWEEP(limn_vk_curvature_evaluator_create, 0, limn_vk_curvature_evaluator, context_in_c_);
}

TEST_F(CInterfaceChanges, refuse_null_and_wrong_sizes) {
    auto* mesh =
        LIMN_NEW(objects_, limn_editable_mesh, limn_editable_mesh_create, scene_mesh_in_c(objects_), nullptr, nullptr);
    const EditedTablesInC tables = EditedTablesInC::of(objects_, mesh);
    auto* patches = LIMN_NEW(objects_, limn_vk_patch_table, limn_vk_patch_table_create_empty);
    auto* table = LIMN_NEW(objects_, limn_vk_tessellation_table, limn_vk_tessellation_table_create_empty);
    auto* grid = LIMN_NEW(objects_, limn_vk_grid_table, limn_vk_grid_table_create_empty);
    auto* crowd = LIMN_NEW(objects_, limn_crowd, limn_crowd_create, nullptr);
    auto* on_device = LIMN_NEW(objects_, limn_vk_crowd, limn_vk_crowd_create);
    const limn_vk_tessellation_sources sources = tables.sources();
    limn_error error = {};
    Objects updates;
    run([&](VkCommandBuffer commands) {
        LIMN_SWEEP(limn_vk_patch_table_update, 0b1000, limn_vk_table_update, context_in_c_, commands, patches, nullptr,
                   tables.patches, kReserve);
        LIMN_SWEEP(limn_vk_grid_table_update, 0b1000, limn_vk_table_update, context_in_c_, commands, grid, nullptr,
                   tables.grid, kReserve);
        LIMN_SWEEP(limn_vk_tessellation_table_update, 0b1000, limn_vk_table_update, context_in_c_, commands, table,
                   nullptr, &sources, kReserve);
        LIMN_SWEEP(limn_vk_crowd_update, 0, limn_vk_table_update, context_in_c_, commands, on_device, crowd);
        limn_vk_table_update* none = nullptr;
        for (const float reserve : {-1.0f, 5.0f, NAN})
            EXPECT_EQ(limn_vk_patch_table_update(context_in_c_, commands, patches, nullptr, tables.patches, reserve,
                                                 &none, &error),
                      LIMN_ERROR_INVALID_ARGUMENT);
        const limn_vk_tessellation_sources lacking[] = {{nullptr, tables.trees, nullptr, 0},
                                                        {tables.tessellation, nullptr, nullptr, 0},
                                                        {tables.tessellation, tables.trees, nullptr, 1}};
        for (const limn_vk_tessellation_sources& bad : lacking) {
            EXPECT_EQ(
                limn_vk_tessellation_table_update(context_in_c_, commands, table, nullptr, &bad, 0, &none, &error),
                LIMN_ERROR_INVALID_ARGUMENT);
            EXPECT_EQ(
                limn_vk_tessellation_table_update(context_in_c_, commands, table, &bad, &sources, 0, &none, &error),
                LIMN_ERROR_INVALID_ARGUMENT);
        }
        EXPECT_EQ(none, nullptr);
        auto* update = LIMN_NEW(updates, limn_vk_table_update, limn_vk_patch_table_update, context_in_c_, commands,
                                patches, nullptr, tables.patches, 0.0f);
        auto info = sized<limn_vk_table_update_info>();
        sweep(limn_vk_table_update_get_info, 0, update, &info, &error);
    });
    EXPECT_EQ(limn_vk_patch_table_create_empty(nullptr, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_grid_table_create_empty(nullptr, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_tessellation_table_create_empty(nullptr, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_crowd_create(nullptr, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_vk_crowd_get_patches(nullptr), nullptr);
    EXPECT_EQ(limn_vk_crowd_get_tessellation(nullptr), nullptr);
    limn_vk_table_update_destroy(nullptr);
    limn_vk_crowd_destroy(nullptr);
}

}  // namespace
}  // namespace limn::vk::test
