// Edits, crowds, curvatures and rows by way of the C interface: the C++ interface's bits.
#include "c/objects.h"
#include "limn/c/limn_changes.h"
#include "limn/crowd.h"
#include "limn/curvature.h"
#include "limn/mesh_edit.h"
#include "limn/stencil_table.h"
#include "limn/tessellate.h"

namespace limn::test {
namespace {

/// A grid of size x size quads.
struct Grid {
    uint32_t size;
    std::vector<uint32_t> sizes, vertices;

    explicit Grid(uint32_t n) : size(n), sizes(size_t{n} * n, 4) {
        for (uint32_t j = 0; j < n; ++j)
            for (uint32_t i = 0; i < n; ++i)
                for (const uint32_t v : {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)})
                    vertices.push_back(v);
    }
    uint32_t vertex(uint32_t i, uint32_t j) const { return j * (size + 1) + i; }
    uint32_t vertex_count() const { return (size + 1) * (size + 1); }
    ControlMesh mesh() const {
        return *ControlMesh::create({.vertex_count = vertex_count(), .face_sizes = sizes, .face_vertices = vertices});
    }
    limn_control_mesh* mesh_in_c(Objects& objects) const {
        auto d = sized<limn_control_mesh_description>();
        d.vertex_count = vertex_count();
        d.face_sizes = sizes.data(), d.face_count = sizes.size();
        d.face_vertices = vertices.data(), d.face_vertex_count = vertices.size();
        return LIMN_NEW(objects, limn_control_mesh, limn_control_mesh_create, &d);
    }
};

/// The same triangles, at the same places.
void expect_same_surface(const PatchTable& patches, const TessellationTable& topology,
                         const limn_patch_table* patches_in_c, const limn_tessellation_table* topology_in_c) {
    auto info = sized<limn_patch_table_info>();
    ASSERT_EQ(limn_patch_table_get_info(patches_in_c, &info, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(info.bytes, patches.bytes());
    EXPECT_EQ(info.ptex_face_count, patches.ptex_surfaces.size());
    ASSERT_EQ(info.point_count, patches.point_count());
    std::vector<double> control(size_t{3} * patches.control_count), points(size_t{3} * patches.point_count()),
        in_c(points);
    for (size_t i = 0; i < control.size(); ++i) control[i] = static_cast<double>(i * i % 29) / 7;
    build_patch_points(patches, control, 3, points);
    ASSERT_EQ(limn_patch_table_build_points(patches_in_c, control.data(), control.size(), 3, in_c.data(), in_c.size(),
                                            nullptr),
              LIMN_SUCCESS);
    EXPECT_EQ(points, in_c);
    const auto rates = compute_rates(patches, topology, {.value = 4}, points);
    const auto expected = tessellate(topology, *rates, {});
    auto options = sized<limn_tessellation_options>();
    options.value = 4;
    Objects objects;
    auto* made = LIMN_NEW(objects, limn_tessellation, limn_tessellation_create, patches_in_c, topology_in_c,
                          in_c.data(), in_c.size(), &options);
    auto counts = sized<limn_tessellation_info>();
    ASSERT_EQ(limn_tessellation_get_info(made, &counts, nullptr), LIMN_SUCCESS);
    ASSERT_EQ(3 * counts.triangle_count, expected->indices.size());
    EXPECT_TRUE(std::equal(expected->indices.begin(), expected->indices.end(), counts.indices));
    std::vector<double> positions(3 * expected->vertex_count()), normals(positions), positions_in_c(positions),
        normals_in_c(positions);
    evaluate_tessellation(patches, *expected, points, positions, normals);
    auto e = sized<limn_tessellation_evaluation>();
    e.points = in_c.data(), e.point_value_count = in_c.size();
    e.positions = positions_in_c.data(), e.position_value_count = positions_in_c.size();
    e.normals = normals_in_c.data(), e.normal_value_count = normals_in_c.size();
    ASSERT_EQ(limn_tessellation_evaluate(made, patches_in_c, &e, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(positions, positions_in_c);
    EXPECT_EQ(normals, normals_in_c);
}

limn_mesh_edit edit_in_c(const MeshEdit& edit) {
    auto out = sized<limn_mesh_edit>();
    out.new_vertex_count = edit.new_vertex_count;
    out.faces = edit.faces.data(), out.face_count = edit.faces.size();
    out.face_sizes = edit.face_sizes.data();
    out.face_vertices = edit.face_vertices.data(), out.face_vertex_count = edit.face_vertices.size();
    out.crease_vertices = edit.crease_vertices.data(), out.crease_vertex_count = edit.crease_vertices.size();
    out.crease_sharpness = edit.crease_sharpness.data(), out.crease_sharpness_count = edit.crease_sharpness.size();
    out.corner_vertices = edit.corner_vertices.data(), out.corner_sharpness = edit.corner_sharpness.data();
    out.corner_count = edit.corner_vertices.size();
    out.holes = edit.holes.data(), out.hole_count = edit.holes.size();
    out.filled_holes = edit.filled_holes.data(), out.filled_hole_count = edit.filled_holes.size();
    return out;
}

// Creases and a corner, holes, an inset face with new vertices, a face that goes; and a hole filled again.
constexpr uint32_t kCrease[] = {12, 13, 13, 14}, kCorner[] = {25}, kHoles[] = {3}, kInset[] = {14, 25, 26, 27, 28},
                   kInsetSizes[] = {4, 4, 4, 4, 4}, kRemoved[] = {8}, kNoSize[] = {0};
constexpr float kSharpness[] = {2.5f, 10}, kCornerSharpness[] = {3};
constexpr uint32_t kInsetFaces[] = {36, 37, 38, 39, 16, 17, 37, 36, 17, 23, 38, 37, 23, 22, 39, 38, 22, 16, 36, 39};
const MeshEdit kEdits[] = {
    {.crease_vertices = kCrease,
     .crease_sharpness = kSharpness,
     .corner_vertices = kCorner,
     .corner_sharpness = kCornerSharpness},
    {.holes = kHoles},
    {.faces = kInset, .face_sizes = kInsetSizes, .face_vertices = kInsetFaces, .new_vertex_count = 4},
    {.faces = kRemoved, .face_sizes = kNoSize, .filled_holes = kHoles},
};

TEST(CInterfaceEdits, give_the_bits_of_the_cpp_interface) {
    const Grid grid(5);
    Objects objects;
    auto* cache = LIMN_NEW(objects, limn_plan_cache, limn_plan_cache_create);
    auto options = sized<limn_editable_mesh_options>();
    options.flags = LIMN_EDITABLE_MESH_JOIN_CREASES;
    auto* in_c =
        LIMN_NEW(objects, limn_editable_mesh, limn_editable_mesh_create, grid.mesh_in_c(objects), &options, cache);
    const PlanCache plans;
    EditableMesh edited = *EditableMesh::create(grid.mesh(), {.split_creases = false}, &plans);
    const limn_patch_table* patches = limn_editable_mesh_get_patches(in_c);
    auto* before = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_copy, patches);
    auto* topology_before = LIMN_NEW(objects, limn_tessellation_table, limn_tessellation_table_create_copy,
                                     limn_editable_mesh_get_tessellation(in_c));
    const PatchTable patches_before = edited.patches();
    const TessellationTable tessellation_before = edited.tessellation();
    for (const MeshEdit& edit : kEdits) {
        const EditWork expected = *edited.edit(edit);
        const limn_mesh_edit given = edit_in_c(edit);
        auto work = sized<limn_edit_work>();
        limn_error error = {};
        ASSERT_EQ(limn_editable_mesh_edit(in_c, &given, &work, &error), LIMN_SUCCESS) << error.message;
        EXPECT_EQ(work.face_count, expected.face_count);
        EXPECT_EQ(work.tessellation != 0, expected.tessellation);
        EXPECT_EQ(limn_editable_mesh_get_patches(in_c), patches) << "tables stay where they are";
        expect_same_surface(edited.patches(), edited.tessellation(), patches,
                            limn_editable_mesh_get_tessellation(in_c));
        auto* fresh = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create, limn_editable_mesh_get_mesh(in_c),
                               nullptr, nullptr);
        expect_same_surface(edited.patches(), edited.tessellation(), fresh, limn_editable_mesh_get_tessellation(in_c));
    }
    expect_same_surface(patches_before, tessellation_before, before, topology_before);
}

TEST(CInterfaceEdits, change_nothing_where_they_are_refused) {
    const Grid grid(5);
    Objects objects;
    auto* in_c =
        LIMN_NEW(objects, limn_editable_mesh, limn_editable_mesh_create, grid.mesh_in_c(objects), nullptr, nullptr);
    const EditableMesh same = *EditableMesh::create(grid.mesh(), {});
    limn_error error = {};
    constexpr uint32_t kFar[] = {0, 20};
    const MeshEdit far{.crease_vertices = kFar, .crease_sharpness = std::span(kSharpness).first(1)};
    limn_mesh_edit given = edit_in_c(far);
    EXPECT_EQ(limn_editable_mesh_edit(in_c, &given, nullptr, &error), LIMN_ERROR_MISSING_EDGE);
    EXPECT_EQ(error.element, 0u);
    given = edit_in_c(kEdits[0]);
    limn_edit_work work = {4, 7, 7, 7};
    EXPECT_EQ(limn_editable_mesh_edit(in_c, &given, &work, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(work.face_count, 7u);
    given.holes = nullptr, given.hole_count = 1;
    EXPECT_EQ(limn_editable_mesh_edit(in_c, &given, nullptr, &error), LIMN_ERROR_INVALID_ARGUMENT);
    expect_same_surface(same.patches(), same.tessellation(), limn_editable_mesh_get_patches(in_c),
                        limn_editable_mesh_get_tessellation(in_c));
    auto* mesh = limn_editable_mesh_get_mesh(in_c);
    auto options = sized<limn_editable_mesh_options>();
    LIMN_SWEEP(limn_editable_mesh_create, 0b110, limn_editable_mesh, mesh, &options, nullptr);
    given = edit_in_c({});
    work = {sizeof(work), 0, 0, 0};
    sweep(limn_editable_mesh_edit, 0b100, in_c, &given, &work, &error);
    LIMN_SWEEP(limn_patch_table_create_copy, 0, limn_patch_table, limn_editable_mesh_get_patches(in_c));
    LIMN_SWEEP(limn_tessellation_table_create_copy, 0, limn_tessellation_table,
               limn_editable_mesh_get_tessellation(in_c));
    options.flags = 2;
    limn_editable_mesh* none = nullptr;
    EXPECT_EQ(limn_editable_mesh_create(mesh, &options, nullptr, &none, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_editable_mesh_get_mesh(nullptr), nullptr);
    EXPECT_EQ(limn_editable_mesh_get_patches(nullptr), nullptr);
    EXPECT_EQ(limn_editable_mesh_get_tessellation(nullptr), nullptr);
    limn_editable_mesh_destroy(nullptr);
}

/// Meshes of a crowd, for both.
struct Members {
    Objects objects;
    std::vector<PatchTable> patches;
    std::vector<TessellationTable> topologies;
    std::vector<limn_crowd_mesh> in_c;

    Members() {
        for (const uint32_t size : {2u, 4u, 7u}) {
            const Grid grid(size);
            const ControlMesh mesh = grid.mesh();
            patches.push_back(*build_patch_table<float>(mesh, {}));
            topologies.push_back(*build_tessellation_table(mesh, {}));
            auto* const of = grid.mesh_in_c(objects);
            in_c.push_back({LIMN_NEW(objects, limn_patch_table, limn_patch_table_create, of, nullptr, nullptr),
                            LIMN_NEW(objects, limn_tessellation_table, limn_tessellation_table_create, of, nullptr)});
        }
    }
    BatchMesh mesh(size_t i) const { return {&patches[i], &topologies[i]}; }
};

void expect_range(const limn_range& range, const BatchRange& expected) {
    EXPECT_EQ(range.first, expected.first);
    EXPECT_EQ(range.count, expected.count);
}

void expect_same_crowd(const Crowd& expected, const limn_crowd* crowd) {
    auto info = sized<limn_crowd_info>();
    ASSERT_EQ(limn_crowd_get_info(crowd, &info, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(info.instance_capacity, expected.instance_capacity());
    EXPECT_EQ(info.instance_count, expected.instance_count());
    EXPECT_EQ(info.layout, expected.layout());
    EXPECT_EQ(info.bytes, expected.bytes());
    EXPECT_EQ(info.changed_bytes, expected.changed_bytes());
    for (uint32_t i = 0; i <= info.instance_capacity; ++i) {
        auto instance = sized<limn_crowd_instance>();
        const CrowdInstance* found = expected.find(i);
        const limn_result result = limn_crowd_get_instance(crowd, i, &instance, nullptr);
        ASSERT_EQ(result, found != nullptr ? LIMN_SUCCESS : LIMN_ERROR_INDEX_OUT_OF_RANGE) << i;
        if (found == nullptr) continue;
        expect_range(instance.control_points, found->patches.control_points);
        expect_range(instance.ptex_faces, found->patches.ptex_faces);
        expect_range(instance.ptex_faces, found->topology.ptex_faces);
        expect_range(instance.surfaces, found->patches.surfaces);
        expect_range(instance.mesh_edges, found->topology.mesh_edges);
        expect_range(instance.sub_face_edges, found->topology.sub_face_edges);
        expect_range(instance.rows, found->topology.rows);
        expect_range(instance.corners, found->topology.corners);
    }
    expect_same_surface(expected.patches(), expected.topology(), limn_crowd_get_patches(crowd),
                        limn_crowd_get_tessellation(crowd));
}

TEST(CInterfaceCrowds, give_the_bits_of_the_cpp_interface) {
    const Members members;
    Objects objects;
    auto options = sized<limn_crowd_options>();
    options.max_rate = 16, options.reserve = 0.5f;
    auto* in_c = LIMN_NEW(objects, limn_crowd, limn_crowd_create, &options);
    Crowd crowd({.max_rate = 16, .reserve = 0.5f});
    const auto add = [&](std::initializer_list<size_t> which) {
        std::vector<BatchMesh> meshes;
        std::vector<limn_crowd_mesh> meshes_in_c;
        for (const size_t i : which) meshes.push_back(members.mesh(i)), meshes_in_c.push_back(members.in_c[i]);
        std::vector<uint32_t> numbers(which.size());
        const auto expected = crowd.add(meshes);
        ASSERT_EQ(limn_crowd_add(in_c, meshes_in_c.data(), meshes_in_c.size(), numbers.data(), nullptr), LIMN_SUCCESS);
        EXPECT_EQ(numbers, *expected);
        expect_same_crowd(crowd, in_c);
    };
    const auto remove = [&](uint32_t instance) {
        ASSERT_TRUE(crowd.remove(instance));
        ASSERT_EQ(limn_crowd_remove(in_c, instance, nullptr), LIMN_SUCCESS);
        expect_same_crowd(crowd, in_c);
    };
    add({0, 1, 2, 1});
    EXPECT_EQ(crowd.layout(), 1u);
    remove(2);
    crowd.forget_changes();
    limn_crowd_forget_changes(in_c);
    add({1});
    EXPECT_EQ(crowd.layout(), 1u);
    EXPECT_GT(crowd.changed_bytes(), 0u);
    add({2, 2, 2});
    EXPECT_EQ(crowd.layout(), 2u);
    remove(0);
    remove(5);
    ASSERT_TRUE(crowd.compact());
    ASSERT_EQ(limn_crowd_compact(in_c, nullptr), LIMN_SUCCESS);
    expect_same_crowd(crowd, in_c);
}

TEST(CInterfaceCrowds, have_a_reserve_or_none) {
    const Members members;
    const auto bytes_of = [&](uint32_t flags, float reserve) {
        Objects objects;
        auto options = sized<limn_crowd_options>();
        options.flags = flags, options.reserve = reserve;
        auto* crowd = LIMN_NEW(objects, limn_crowd, limn_crowd_create, &options);
        uint32_t number = 7;
        EXPECT_EQ(limn_crowd_add(crowd, members.in_c.data(), 1, &number, nullptr), LIMN_SUCCESS);
        EXPECT_EQ(number, 0u);
        auto info = sized<limn_crowd_info>();
        EXPECT_EQ(limn_crowd_get_info(crowd, &info, nullptr), LIMN_SUCCESS);
        return info.bytes;
    };
    const auto expected = [&](float reserve) {
        Crowd crowd({.reserve = reserve});
        EXPECT_TRUE(crowd.add(members.mesh(0)));
        return crowd.bytes();
    };
    EXPECT_EQ(bytes_of(0, 0), expected(0.25f));
    EXPECT_EQ(bytes_of(0, 2), expected(2));
    EXPECT_EQ(bytes_of(LIMN_CROWD_NO_RESERVE, 0), expected(0));
    EXPECT_LT(expected(0), expected(2));
}

TEST(CInterfaceCrowds, refuse_what_does_not_fit) {
    const Members members;
    Objects objects;
    limn_error error = {};
    auto options = sized<limn_crowd_options>();
    auto* crowd = LIMN_NEW(objects, limn_crowd, limn_crowd_create, &options);
    uint32_t numbers[2] = {7, 7};
    sweep(limn_crowd_add, 0, crowd, members.in_c.data(), 1, numbers, &error);
    const limn_crowd_mesh lacking[] = {members.in_c[0], {members.in_c[0].patches, nullptr}};
    EXPECT_EQ(limn_crowd_add(crowd, lacking, 2, numbers, &error), LIMN_ERROR_INVALID_ARGUMENT);
    const limn_crowd_mesh mixed[] = {members.in_c[0], {members.in_c[0].patches, members.in_c[1].tessellation}};
    EXPECT_EQ(limn_crowd_add(crowd, mixed, 2, numbers, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(error.element, 1u);
    EXPECT_EQ(numbers[0], 7u);
    EXPECT_EQ(limn_crowd_remove(crowd, 0, &error), LIMN_ERROR_INDEX_OUT_OF_RANGE);
    EXPECT_EQ(limn_crowd_remove(nullptr, 0, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_crowd_compact(nullptr, &error), LIMN_ERROR_INVALID_ARGUMENT);
    auto info = sized<limn_crowd_info>();
    sweep(limn_crowd_get_info, 0, crowd, &info, &error);
    ASSERT_EQ(limn_crowd_add(crowd, members.in_c.data(), 1, numbers, &error), LIMN_SUCCESS);
    auto instance = sized<limn_crowd_instance>();
    sweep(limn_crowd_get_instance, 0, crowd, 0, &instance, &error);
    const auto refused = [&](auto change) {
        auto bad = sized<limn_crowd_options>();
        change(bad);
        limn_crowd* none = crowd;
        EXPECT_EQ(limn_crowd_create(&bad, &none, &error), LIMN_ERROR_INVALID_ARGUMENT);
        EXPECT_EQ(none, nullptr);
    };
    refused([](auto& o) { o.flags = 2; });
    refused([](auto& o) { o.reserved = 1; });
    refused([](auto& o) { o.flags = LIMN_CROWD_NO_RESERVE, o.reserve = 1; });
    refused([](auto& o) { o.struct_size = 8; });
    EXPECT_EQ(limn_crowd_create(nullptr, nullptr, &error), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(limn_crowd_get_patches(nullptr), nullptr);
    EXPECT_EQ(limn_crowd_get_tessellation(nullptr), nullptr);
    limn_crowd_forget_changes(nullptr);
    limn_crowd_destroy(nullptr);
}

TEST(CInterfaceCurvature, gives_the_bits_of_the_cpp_interface) {
    for (const uint32_t width : {3u, 4u}) {
        constexpr size_t kCount = 5;
        std::vector<double> values(6 * width * kCount);
        for (size_t i = 0; i < values.size(); ++i) values[i] = 1 + static_cast<double>(i * i % 13) / 5;
        std::vector<Curvature> expected(kCount);
        evaluate_curvature(values, width, expected);
        std::vector<limn_curvature> in_c(kCount);
        limn_error error = {};
        ASSERT_EQ(limn_evaluate_curvature(values.data(), values.size(), width, in_c.data(), kCount, &error),
                  LIMN_SUCCESS);
        EXPECT_EQ(std::memcmp(in_c.data(), expected.data(), kCount * sizeof(Curvature)), 0);
        EXPECT_NE(in_c[0].gaussian, 0);
        EXPECT_EQ(limn_evaluate_curvature(values.data(), values.size() - 1, width, in_c.data(), kCount, &error),
                  LIMN_ERROR_INVALID_ARGUMENT);
        sweep(limn_evaluate_curvature, 0, values.data(), values.size(), width, in_c.data(), kCount, &error);
        for (const uint32_t bad : {0u, 2u, 5u})
            EXPECT_EQ(limn_evaluate_curvature(values.data(), values.size(), bad, in_c.data(), 1, &error),
                      LIMN_ERROR_INVALID_ARGUMENT);
    }
}

TEST(CInterfaceStencils, give_the_bits_of_the_cpp_interface) {
    const Grid grid(3);
    Objects objects;
    auto options = sized<limn_stencil_table_options>();
    options.level = 2, options.flags = LIMN_STENCIL_TABLE_LIMIT | LIMN_STENCIL_TABLE_TANGENTS;
    auto* in_c = LIMN_NEW(objects, limn_stencil_table, limn_stencil_table_create, grid.mesh_in_c(objects), &options);
    const auto table =
        *build_limit_table<float>(*build_refinement(grid.mesh(), {.level = 0, .full_last_level = true}), 2, true);
    std::vector<float> source(size_t{2} * table.source_count), expected(size_t{2} * table.row_count()),
        values(expected);
    for (size_t i = 0; i < source.size(); ++i) source[i] = static_cast<float>(i * i % 17) / 3;
    limn_error error = {};
    const auto apply = [&](limn_stencil_weights weights, uint64_t count) {
        return limn_stencil_table_apply(in_c, weights, source.data(), source.size(), 2, values.data(), count, &error);
    };
    const std::pair<limn_stencil_weights, const Array<float>*> all[] = {
        {LIMN_STENCIL_POINTS, &table.weights},
        {LIMN_STENCIL_TANGENT1, &table.tangent1_weights},
        {LIMN_STENCIL_TANGENT2, &table.tangent2_weights}};
    for (const auto& [choice, weights] : all) {
        StencilTable rows = table;
        rows.weights = *weights;
        apply_stencil_table<float>(rows, source, expected, 2);
        ASSERT_EQ(apply(choice, values.size()), LIMN_SUCCESS) << error.message;
        EXPECT_EQ(values, expected);
        EXPECT_EQ(apply(choice, values.size() - 1), LIMN_ERROR_INVALID_ARGUMENT);
    }
    EXPECT_EQ(apply(3, values.size()), LIMN_ERROR_INVALID_ARGUMENT);
    sweep(limn_stencil_table_apply, 0, in_c, LIMN_STENCIL_POINTS, source.data(), source.size(), 2, values.data(),
          values.size(), &error);
    options.flags = 0;
    in_c = LIMN_NEW(objects, limn_stencil_table, limn_stencil_table_create, grid.mesh_in_c(objects), &options);
    EXPECT_EQ(apply(LIMN_STENCIL_TANGENT1, values.size()), LIMN_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace limn::test
