// Every shape, level by level, against OpenSubdiv in double.
#include <gtest/gtest.h>

#include "conformance/refinement_checks.h"

namespace limn::test {
namespace {

class RefinementConformance : public testing::TestWithParam<size_t> {
  public:
    static const std::vector<TestMesh>& shapes() {
        static const std::vector<TestMesh> all = all_shapes();
        return all;
    }
    static void TearDownTestSuite() { print_worst_errors(); }
};

TEST_P(RefinementConformance, equals_opensubdiv) {
    check_against_oracle(shapes()[GetParam()], {});
}

INSTANTIATE_TEST_SUITE_P(Shapes, RefinementConformance,
                         testing::Range(size_t{0}, RefinementConformance::shapes().size()),
                         [](const auto& info) { return RefinementConformance::shapes()[info.param].name; });

// Each comparison above, shown to notice one wrong number.
TEST(ConformanceHelpers, numbers_differ_when_one_is_perturbed) {
    const std::vector<double> numbers = {0.1, 0.2, 0.3};
    std::vector<double> other = numbers;
    EXPECT_TRUE(same_numbers(numbers, other, kDoubleTolerance));
    other[1] += 3e-12;
    EXPECT_FALSE(same_numbers(numbers, other, kDoubleTolerance));
    other[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(same_numbers(numbers, other, kDoubleTolerance));
    EXPECT_FALSE(same_numbers(numbers, std::span(numbers).first(2), kDoubleTolerance));
}

TEST(ConformanceHelpers, indices_differ_when_one_is_perturbed) {
    const std::vector<uint32_t> indices = {4, 5, 6};
    std::vector<uint32_t> other = indices;
    EXPECT_TRUE(same_indices(indices, other));
    other[2] = 7;
    EXPECT_FALSE(same_indices(indices, other));
    EXPECT_FALSE(same_indices(indices, std::span(indices).first(2)));
}

TEST(ConformanceHelpers, rows_differ_when_one_weight_is_perturbed) {
    const std::vector<SparseRow> rows = {{{0, 0.5}, {3, 0.5}}, {{1, 1.0}}};
    std::vector<SparseRow> other = rows;
    EXPECT_TRUE(same_rows(rows, other, kDoubleTolerance));
    other[0][1].second += 3e-12;
    EXPECT_FALSE(same_rows(rows, other, kDoubleTolerance));
    other = rows;
    other[0][1].first = 2;  // the right weight in the wrong column
    EXPECT_FALSE(same_rows(rows, other, kDoubleTolerance));
    other = rows;
    other[1].push_back({2, 1e-11});  // an entry that the other does not have
    EXPECT_FALSE(same_rows(rows, other, kDoubleTolerance));
    EXPECT_FALSE(same_rows(other, rows, kDoubleTolerance));
}

TEST(ConformanceHelpers, a_table_is_not_well_formed_once_perturbed) {
    const auto control = ControlMesh::create(make_cube().description());
    const auto refinement = build_refinement(*control, {1, false});
    const auto table = build_stencil_table<double>(*refinement, 1);
    ASSERT_TRUE(table);
    EXPECT_TRUE(well_formed(*table));
    auto fails = [&](auto&& perturb) {
        StencilTableDouble other = *table;
        perturb(other);
        EXPECT_FALSE(well_formed(other));
    };
    fails([](StencilTableDouble& t) { t.weights[20] += 1e-12; });
    fails([](StencilTableDouble& t) { t.indices[t.offsets[8]] = t.indices[t.offsets[8] + 1]; });
    fails([](StencilTableDouble& t) { t.indices[20] = t.source_count; });
    fails([](StencilTableDouble& t) { t.offsets.back() -= 1; });
}

TEST(ConformanceHelpers, normals_differ_when_one_tangent_is_perturbed) {
    const OsdOracle::Limits limits = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<uint8_t> all = {1}, none = {0};
    OsdOracle::Limits other = limits;
    EXPECT_TRUE(same_normals(limits, other, all, kNormalTolerance));
    other.tangents2[2] = 1e-8;
    EXPECT_FALSE(same_normals(limits, other, all, kNormalTolerance));
    EXPECT_TRUE(same_normals(limits, other, none, kNormalTolerance));
    other.tangents2 = {0, -1, 0};  // the other way
    EXPECT_FALSE(same_normals(limits, other, all, kNormalTolerance));
    other.tangents2 = {2, 0, 0};  // no normal at all
    EXPECT_FALSE(same_normals(limits, other, all, kNormalTolerance));
}

TEST(ConformanceHelpers, topology_differs_when_one_entry_is_perturbed) {
    TestMesh mesh = make_grid(2, 2);
    mesh.add_crease(4, 5, 1.5);
    mesh.holes = {3};
    const auto control = ControlMesh::create(mesh.description());
    ASSERT_TRUE(control);
    const auto oracle = OsdOracle::create(mesh, 0, nullptr);
    ASSERT_TRUE(oracle);
    const Topology topology = build_topology(*control);
    EXPECT_TRUE(same_topology(topology, *oracle, 0));
    auto fails = [&](auto&& perturb) {
        Topology other = topology;
        perturb(other);
        EXPECT_FALSE(same_topology(other, *oracle, 0));
    };
    fails([](Topology& t) { ++t.edge_count; });
    fails([](Topology& t) { std::swap(t.face_vertices[0], t.face_vertices[1]); });
    fails([](Topology& t) { t.face_holes[3] = 0; });
    fails([](Topology& t) { t.vertex_rules[4] = VertexRule::corner; });
    fails([](Topology& t) { t.vertex_manifold[4] = 0; });
    fails([](Topology& t) { t.vertex_sharpness[4] = 1; });
    fails([](Topology& t) { t.edge_sharpness[0] = 1; });
    fails([](Topology& t) { std::swap(t.edge_vertices[0], t.edge_vertices[3]); });
}

// The deviations are real: with them compared, the default mode does not equal OpenSubdiv.
TEST(ConformanceHelpers, deviations_of_opensubdiv_exist) {
    TestMesh dart = make_quad_star(3, 2);
    dart.add_crease_path({0, 1, 2}, 10);
    for (bool compatible : {true, false}) {
        dart.options.opensubdiv_compatible = compatible;
        const auto control = ControlMesh::create(dart.description());
        ASSERT_TRUE(control);
        const auto refinement = build_refinement(*control, {1, true});
        ASSERT_TRUE(refinement);
        const auto table = build_limit_table<double>(*refinement, 1);
        ASSERT_TRUE(table);
        const auto oracle = OsdOracle::create(dart, 1, nullptr);
        const std::vector<double> points = dart.positions_double();
        EXPECT_EQ(bool(same_numbers(apply(*table, points, 3), oracle->limits(points).positions, 1e-6)),
                  compatible);
    }
}

}  // namespace
}  // namespace limn::test
