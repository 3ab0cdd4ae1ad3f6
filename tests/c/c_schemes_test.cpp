// All schemes by way of the C interface: the C++ interface's bits.
#include <cstring>

#include "c/objects.h"
#include "limn/c/limn_schemes.h"
#include "limn/schemes/adaptive.h"
#include "limn/schemes/corner_values.h"
#include "limn/schemes/scheme_samples.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

/// A mesh for both.
struct Model {
    TestMesh shape;
    ControlMesh mesh;

    explicit Model(TestMesh of) : shape(std::move(of)), mesh(*ControlMesh::create(shape.description())) {
        shape.perturb(0.1, 3);
    }
    limn_control_mesh* mesh_in_c(Objects& objects) const {
        auto d = sized<limn_control_mesh_description>();
        d.vertex_count = mesh.vertex_count;
        d.face_sizes = shape.face_sizes.data(), d.face_count = shape.face_sizes.size();
        d.face_vertices = shape.face_vertices.data(), d.face_vertex_count = shape.face_vertices.size();
        return LIMN_NEW(objects, limn_control_mesh, limn_control_mesh_create, &d);
    }
};
Model model_of(const SubdivisionScheme& scheme) {
    return Model(scheme.faces == FaceKind::triangles ? make_icosahedron() : make_cube());
}

limn_scheme_surface_options options_of(const char* scheme, uint32_t level) {
    auto options = sized<limn_scheme_surface_options>();
    options.scheme = scheme, options.level = level;
    return options;
}

template <class T>
void expect_array(const T* in_c, const Array<T>& expected) {
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), in_c));
}

void expect_same_surface(const SchemeSurface& expected, const limn_scheme_surface* in_c,
                         const std::vector<float>& points, limn_scheme_surface_info& info) {
    info.struct_size = sizeof(info);
    ASSERT_EQ(limn_scheme_surface_get_info(in_c, &info, nullptr), LIMN_SUCCESS);
    EXPECT_EQ(info.control_count, expected.control_count);
    ASSERT_EQ(info.vertex_count, expected.vertex_count);
    ASSERT_EQ(info.face_count + 1, expected.face_offsets.size());
    ASSERT_EQ(3 * info.triangle_count, expected.triangles.size());
    ASSERT_EQ(2 * info.edge_count, expected.edges.size());
    expect_array(info.face_offsets, expected.face_offsets);
    expect_array(info.face_vertices, expected.face_vertices);
    expect_array(info.triangles, expected.triangles);
    expect_array(info.edges, expected.edges);
    const SchemeVertices vertices = apply_scheme_surface(expected, points);
    std::vector<float> positions(vertices.positions.size()), normals(positions);
    limn_error error = {};
    const auto apply = [&](float* to, uint64_t count) {
        return limn_scheme_surface_apply(in_c, points.data(), points.size(), positions.data(), positions.size(), to,
                                         count, &error);
    };
    ASSERT_EQ(apply(normals.data(), normals.size()), LIMN_SUCCESS) << error.message;
    EXPECT_EQ(positions, vertices.positions);
    EXPECT_EQ(normals, vertices.normals);
    EXPECT_EQ(apply(nullptr, 0), LIMN_SUCCESS);
    EXPECT_EQ(apply(normals.data(), normals.size() - 1), LIMN_ERROR_INVALID_ARGUMENT);
}

TEST(CInterfaceSchemes, are_all_listed) {
    const auto schemes = subdivision_schemes();
    ASSERT_EQ(limn_subdivision_scheme_get_count(), schemes.size());
    limn_error error = {};
    auto info = sized<limn_subdivision_scheme_info>();
    for (uint32_t i = 0; i < schemes.size(); ++i) {
        const SubdivisionScheme& s = schemes[i];
        ASSERT_EQ(limn_subdivision_scheme_get_info(i, &info, &error), LIMN_SUCCESS);
        EXPECT_STREQ(info.name, s.name);
        EXPECT_STREQ(info.title, s.title);
        EXPECT_STREQ(info.source, s.source);
        EXPECT_EQ(info.faces, static_cast<uint32_t>(s.faces));
        EXPECT_EQ(info.corner_values, static_cast<uint32_t>(s.corner_values));
        const std::pair<uint32_t, bool> flags[] = {{LIMN_SUBDIVISION_SCHEME_DUAL, s.dual},
                                                   {LIMN_SUBDIVISION_SCHEME_INTERPOLATES, s.interpolates},
                                                   {LIMN_SUBDIVISION_SCHEME_CREASES, s.creases != CreaseRules::none},
                                                   {LIMN_SUBDIVISION_SCHEME_ADAPTIVE, is_adaptive(s)},
                                                   {LIMN_SUBDIVISION_SCHEME_SAMPLES, has_coordinates(s)},
                                                   {LIMN_SUBDIVISION_SCHEME_RECONSTRUCTED, s.reconstructed}};
        for (const auto& [flag, is_set] : flags)
            EXPECT_EQ((info.flags & flag) != 0, is_set) << s.name << ", flag " << flag;
    }
    EXPECT_EQ(limn_subdivision_scheme_get_info(static_cast<uint32_t>(schemes.size()), &info, &error),
              LIMN_ERROR_INDEX_OUT_OF_RANGE);
    sweep(limn_subdivision_scheme_get_info, 0, 0, &info, &error);
}

TEST(CInterfaceSchemes, give_the_bits_of_the_cpp_interface) {
    for (const SubdivisionScheme& scheme : subdivision_schemes()) {
        SCOPED_TRACE(scheme.name);
        const Model model = model_of(scheme);
        Objects objects;
        const limn_scheme_surface_options options = options_of(scheme.name, 2);
        auto* in_c =
            LIMN_NEW(objects, limn_scheme_surface, limn_scheme_surface_create, model.mesh_in_c(objects), &options);
        const auto expected = build_scheme_surface(model.mesh, scheme, {.level = 2});
        ASSERT_TRUE(expected);
        limn_scheme_surface_info info;
        expect_same_surface(*expected, in_c, model.shape.positions, info);
        EXPECT_EQ(info.level, 2u);
        EXPECT_EQ(info.reached, 1u);
        EXPECT_EQ(info.tolerance, 0);
        EXPECT_EQ(info.face_levels, nullptr);
    }
}

TEST(CInterfaceSchemes, give_the_bits_of_adaptive_surfaces) {
    for (const char* name : {"catmark", "loop", "sqrt3"}) {
        SCOPED_TRACE(name);
        const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
        const Model model = model_of(scheme);
        const std::vector<double> positions(model.shape.positions.begin(), model.shape.positions.end());
        for (const uint32_t max_triangles : {0u, 200u}) {
            Objects objects;
            auto options = sized<limn_adaptive_surface_options>();
            options.scheme = name, options.max_level = 4, options.tolerance = 0.01,
            options.max_triangles = max_triangles;
            options.positions = positions.data(), options.position_value_count = positions.size();
            auto* in_c = LIMN_NEW(objects, limn_scheme_surface, limn_scheme_surface_create_adaptive,
                                  model.mesh_in_c(objects), &options);
            AdaptiveSurfaceOptions same{.tolerance = 0.01, .max_level = 4};
            if (max_triangles != 0) same.max_triangles = max_triangles;
            auto expected = build_adaptive_surface<float>(model.mesh, scheme, positions, same);
            ASSERT_TRUE(expected);
            limn_scheme_surface_info info;
            const auto levels = expected->face_levels;
            const uint32_t level = expected->level;
            const double tolerance = expected->tolerance;
            const bool reached = expected->reached;
            expect_same_surface(make_scheme_surface(std::move(*expected)), in_c, model.shape.positions, info);
            EXPECT_EQ(info.level, level);
            EXPECT_EQ(info.tolerance, tolerance);
            EXPECT_EQ(info.reached != 0, reached);
            ASSERT_NE(info.face_levels, nullptr);
            expect_array(info.face_levels, levels);
        }
    }
}

TEST(CInterfaceSchemes, give_the_bits_of_samples) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme("catmark");
    const Model model = model_of(scheme);
    Objects objects;
    const std::vector<PatchSample> samples = {{0, 0.3, 0.7}, {5, 0, 0}, {2, 0.5, 0.125}, {99, 0, 0}};
    std::vector<limn_patch_sample> samples_in_c;
    for (const PatchSample& s : samples) samples_in_c.push_back({s.face, 0, s.u, s.v});
    std::vector<limn_sample_status> statuses(samples.size(), 7);
    const limn_scheme_surface_options options = options_of("catmark", 0);
    auto* const mesh = model.mesh_in_c(objects);
    auto* table = LIMN_NEW(objects, limn_stencil_table, limn_stencil_table_create_scheme_samples, mesh, &options,
                           samples_in_c.data(), samples.size(), statuses.data(), statuses.size());
    const auto expected = build_scheme_sample_table<float>(model.mesh, scheme, samples);
    ASSERT_TRUE(expected);
    for (size_t i = 0; i < samples.size(); ++i)
        EXPECT_EQ(statuses[i], static_cast<limn_sample_status>(expected->statuses[i]));
    EXPECT_EQ(statuses[3], LIMN_SAMPLE_OUT_OF_RANGE);
    ASSERT_EQ(limn_stencil_table_get_row_count(table), samples.size());
    const Array<float>* const all[] = {&expected->table.weights, &expected->table.tangent1_weights,
                                       &expected->table.tangent2_weights};
    const std::vector<float>& points = model.shape.positions;
    std::vector<float> values(3 * samples.size()), right(values);
    for (uint32_t weights = 0; weights < 3; ++weights) {
        StencilTable rows = expected->table;
        rows.weights = *all[weights];
        apply_stencil_table<float>(rows, points, right, 3);
        ASSERT_EQ(limn_stencil_table_apply(table, weights, points.data(), points.size(), 3, values.data(),
                                           values.size(), nullptr),
                  LIMN_SUCCESS);
        EXPECT_EQ(values, right);
    }
    LIMN_SWEEP(limn_stencil_table_create_scheme_samples, 0, limn_stencil_table, mesh, &options, samples_in_c.data(),
               samples.size(), statuses.data(), statuses.size());
    limn_stencil_table* none = nullptr;
    const auto create = [&](const limn_scheme_surface_options& o, uint64_t status_count) {
        return limn_stencil_table_create_scheme_samples(mesh, &o, samples_in_c.data(), samples.size(), statuses.data(),
                                                        status_count, &none, nullptr);
    };
    EXPECT_EQ(create(options, 3), LIMN_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(create(options_of("doo-sabin", 0), 4), LIMN_ERROR_UNSUPPORTED);
    EXPECT_EQ(none, nullptr);
}

TEST(CInterfaceSchemes, take_corner_values) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme("nurss");
    const Model model = model_of(scheme);
    const std::vector<uint32_t> edge = {model.shape.face_vertices[0], model.shape.face_vertices[1]};
    const float interval = 2.5f;
    const std::vector<double> expected = *corner_intervals(model.mesh, edge, {&interval, 1});
    Objects objects;
    auto* const mesh = model.mesh_in_c(objects);
    std::vector<double> values(expected.size());
    limn_error error = {};
    const auto intervals = [&](uint64_t count) {
        return limn_control_mesh_get_corner_intervals(mesh, edge.data(), 2, &interval, 1, values.data(), count, &error);
    };
    EXPECT_EQ(intervals(values.size() - 1), LIMN_ERROR_INVALID_ARGUMENT);
    ASSERT_EQ(intervals(values.size()), LIMN_SUCCESS) << error.message;
    EXPECT_EQ(values, expected);
    limn_scheme_surface_options options = options_of("nurss", 2);
    options.corner_values = values.data(), options.corner_value_count = values.size();
    auto* in_c = LIMN_NEW(objects, limn_scheme_surface, limn_scheme_surface_create, mesh, &options);
    limn_scheme_surface_info info;
    expect_same_surface(*build_scheme_surface(model.mesh, scheme, {.level = 2}, expected), in_c, model.shape.positions,
                        info);
    options.corner_value_count -= 1;
    limn_scheme_surface* none = nullptr;
    EXPECT_EQ(limn_scheme_surface_create(mesh, &options, &none, &error), LIMN_ERROR_INVALID_ARGUMENT);
    const std::vector<float>& points = model.shape.positions;
    ASSERT_EQ(
        limn_control_mesh_get_corner_angles(mesh, points.data(), points.size(), values.data(), values.size(), &error),
        LIMN_SUCCESS);
    EXPECT_EQ(values, *corner_angles(model.mesh, points));
    sweep(limn_control_mesh_get_corner_intervals, 0, mesh, edge.data(), 2, &interval, 1, values.data(), values.size(),
          &error);
    sweep(limn_control_mesh_get_corner_angles, 0, mesh, points.data(), points.size(), values.data(), values.size(),
          &error);
}

TEST(CInterfaceSchemes, refuse_what_does_not_fit) {
    const Model model = model_of(*find_subdivision_scheme("catmark"));
    Objects objects;
    limn_error error = {};
    auto* const mesh = model.mesh_in_c(objects);
    const std::vector<double> positions(model.shape.positions.begin(), model.shape.positions.end());
    const limn_scheme_surface_options options = options_of("catmark", 1);
    auto adaptive = sized<limn_adaptive_surface_options>();
    adaptive.scheme = "catmark", adaptive.positions = positions.data(),
    adaptive.position_value_count = positions.size();
    LIMN_SWEEP(limn_scheme_surface_create, 0, limn_scheme_surface, mesh, &options);
    LIMN_SWEEP(limn_scheme_surface_create_adaptive, 0, limn_scheme_surface, mesh, &adaptive);
    auto* surface = LIMN_NEW(objects, limn_scheme_surface, limn_scheme_surface_create, mesh, &options);
    auto info = sized<limn_scheme_surface_info>();
    sweep(limn_scheme_surface_get_info, 0, surface, &info, &error);
    std::vector<float> vertices(size_t{3} * info.vertex_count);
    const std::vector<float>& points = model.shape.positions;
    sweep(limn_scheme_surface_apply, 0b100000, surface, points.data(), points.size(), vertices.data(), vertices.size(),
          nullptr, 0, &error);
    limn_scheme_surface* none = surface;
    const auto refused = [&](const char* scheme, limn_result code) {
        const limn_scheme_surface_options bad = options_of(scheme, 1);
        EXPECT_EQ(limn_scheme_surface_create(mesh, &bad, &none, &error), code);
        EXPECT_EQ(none, nullptr);
    };
    refused("no-such-scheme", LIMN_ERROR_INVALID_ARGUMENT);
    refused(nullptr, LIMN_ERROR_INVALID_ARGUMENT);
    refused("loop", LIMN_ERROR_NOT_A_TRIANGLE);
    adaptive.reserved = 1;
    EXPECT_EQ(limn_scheme_surface_create_adaptive(mesh, &adaptive, &none, &error), LIMN_ERROR_INVALID_ARGUMENT);
    adaptive.reserved = 0, adaptive.tolerance = -1;
    EXPECT_EQ(limn_scheme_surface_create_adaptive(mesh, &adaptive, &none, &error), LIMN_ERROR_INVALID_ARGUMENT);
    adaptive.tolerance = 1, adaptive.scheme = "doo-sabin";
    EXPECT_EQ(limn_scheme_surface_create_adaptive(mesh, &adaptive, &none, &error), LIMN_ERROR_UNSUPPORTED);
    limn_scheme_surface_destroy(nullptr);
}

}  // namespace
}  // namespace limn::test
