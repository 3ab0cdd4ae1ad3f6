// The comparisons of patch_checks.h, each shown to notice one wrong number; and what OpenSubdiv has wrong
// that they allow for, shown to be so.
#include "conformance/patch_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn::test {
namespace {

// A surface with irregular and regular places, and all that there is to compare it with.
struct Case {
    TestMesh mesh;
    SurfaceUnderTest surface;
    std::vector<PatchSample> places;
    SurfaceUnderTest::Values ours;
    std::vector<OsdPlace> far, bfr;
    PatchCheckLog log;

    explicit Case(const TestMesh& m) : mesh(m), surface(mesh, false) {
        std::string error;
        const auto oracle = OsdPatchOracle::create(mesh, 10, &error);
        EXPECT_TRUE(oracle) << error;
        places = scattered_places(oracle->ptex_face_count(), surface.triangles, 3);
        ours = surface.evaluate(places, Derivatives::second);
        far = oracle->far_places(surface.control_points, places);
        bfr = oracle->bfr_places(surface.control_points, 10, places);
    }
    testing::AssertionResult regular() {
        return same_regular_places(surface, ours, far, kSurfaceTolerance, log);
    }
    testing::AssertionResult caps() { return near_caps(surface, places, ours, far, log); }
    testing::AssertionResult near() { return near_bfr(surface, ours, far, bfr, log); }
    size_t find(bool is_regular) const {
        size_t s = 0;
        while (s < far.size() && far[s].regular != is_regular) ++s;
        EXPECT_LT(s, far.size());
        return s;
    }
};

TestMesh perturbed(TestMesh mesh, Scheme scheme = Scheme::catmull_clark) {
    mesh.options.scheme = scheme;
    mesh.perturb(0.1);
    return mesh;
}

TEST(PatchChecks, regular_places_differ_when_one_value_is_perturbed) {
    for (const Scheme scheme : {Scheme::catmull_clark, Scheme::loop}) {
        Case c(perturbed(scheme == Scheme::loop ? make_triangle_star(5, 2) : make_quad_star(5, 2), scheme));
        ASSERT_TRUE(c.regular());
        const size_t s = c.find(true);
        for (size_t k = 0; k < 6; ++k) {
            const double unit = c.surface.size * std::exp2((k > 2   ? 2.0
                                                            : k > 0 ? 1.0
                                                                    : 0.0) *
                                                           c.far[s].depth);
            const double before = c.far[s].values[k][1];
            c.far[s].values[k][1] += 2 * kSurfaceTolerance * unit;
            EXPECT_FALSE(c.regular()) << "value " << k;
            c.far[s].values[k][1] = std::numeric_limits<double>::quiet_NaN();
            EXPECT_FALSE(c.regular()) << "value " << k;
            c.far[s].values[k][1] = before;
        }
        c.far[s].valid = false;
        EXPECT_FALSE(c.regular());
    }
}

TEST(PatchChecks, end_caps_differ_when_a_point_or_a_normal_is_moved) {
    Case c(perturbed(make_quad_star(5, 2)));
    ASSERT_TRUE(c.caps());
    EXPECT_GT(c.log.cap_normal_count, 0u);
    const size_t s = c.find(false);
    OsdPlace& place = c.far[s];
    const OsdPlace before = place;
    for (size_t i = 0; i < 3; ++i) place.values[0][i] += kCapTolerance * place.cap_size;
    EXPECT_FALSE(c.caps());
    place = before;
    const Vector normal = c.ours.normal(s);
    for (size_t i = 0; i < 3; ++i) place.values[0][i] += 0.2 * place.cap_size * normal[i] / length(normal);
    EXPECT_FALSE(c.caps()) << "off the surface";
    place = before;
    for (size_t i = 0; i < 3; ++i)
        place.values[1][i] += 0.02 * length(place.values[1]) * normal[i] / length(normal);
    EXPECT_FALSE(c.caps()) << "tilted by a degree";
    place = before;
    EXPECT_TRUE(c.caps());
}

TEST(PatchChecks, bfr_differs_when_one_value_is_perturbed) {
    Case c(perturbed(make_prism(5)));
    ASSERT_TRUE(c.near());
    const size_t s = c.find(true);
    for (size_t k = 0; k < 3; ++k) {
        const double before = c.bfr[s].values[k][2];
        c.bfr[s].values[k][2] += 6 * kBfrTolerance * c.surface.size * std::exp2(c.far[s].depth);
        EXPECT_FALSE(c.near()) << "value " << k;
        c.bfr[s].values[k][2] = before;
    }
    c.bfr[s].valid = false;
    EXPECT_FALSE(c.near());
}

TEST(PatchChecks, borders_differ_when_they_gape_or_bend) {
    Case c(perturbed(make_quad_star(5, 2)));
    const std::vector<PatchSample> place = {{0, 0.3, 0.2}};
    const std::vector<uint8_t> smooth = {1}, sharp = {0};
    const auto one = c.surface.evaluate(place, Derivatives::first);
    auto other = one;
    EXPECT_TRUE(same_borders(c.surface, one, other, smooth, c.log));
    other.numbers[1] += 3 * kBorderTolerance * c.surface.size;
    EXPECT_FALSE(same_borders(c.surface, one, other, smooth, c.log));
    other = one;
    const Vector normal = one.normal(0);
    for (size_t i = 0; i < 3; ++i)
        other.numbers[3 + i] += 1e-3 * length(one.at(0, 1)) * normal[i] / length(normal);
    EXPECT_FALSE(same_borders(c.surface, one, other, smooth, c.log));
    EXPECT_TRUE(same_borders(c.surface, one, other, sharp, c.log));
    const auto nowhere = c.surface.evaluate(std::vector<PatchSample>{{0, 1.5, 0.2}}, Derivatives::first);
    EXPECT_FALSE(same_borders(c.surface, one, nowhere, smooth, c.log));
}

// Far has places where limn has, and no others.
TEST(PatchChecks, holes_and_places_out_of_range) {
    for (const BoundaryInterpolation boundary :
         {BoundaryInterpolation::none, BoundaryInterpolation::edge_only}) {
        TestMesh mesh = perturbed(make_grid(4, 3));
        mesh.options.boundary = boundary;
        mesh.holes = {5};
        const SurfaceUnderTest surface(mesh, false);
        std::string error;
        const auto oracle = OsdPatchOracle::create(mesh, 4, &error);
        ASSERT_TRUE(oracle) << error;
        std::vector<PatchSample> places;
        for (uint32_t f = 0; f < oracle->ptex_face_count() + 2; ++f) places.push_back({f, 0.3, 0.6});
        const auto ours = surface.evaluate(places, Derivatives::first);
        const auto far = oracle->far_places(surface.control_points, places);
        const auto bfr = oracle->bfr_places(surface.control_points, 4, places);
        for (size_t s = 0; s < places.size(); ++s) {
            const bool exists = places[s].face < oracle->ptex_face_count();
            EXPECT_EQ(ours.statuses[s] == SampleStatus::valid, far[s].valid) << "face " << s;
            EXPECT_EQ(ours.statuses[s] == SampleStatus::valid, bfr[s].valid) << "face " << s;
            EXPECT_EQ(ours.statuses[s] == SampleStatus::out_of_range, !exists) << "face " << s;
        }
        EXPECT_EQ(ours.statuses[5], SampleStatus::hole);
        EXPECT_EQ(ours.statuses[0],
                  boundary == BoundaryInterpolation::none ? SampleStatus::hole : SampleStatus::valid);
    }
}

// Second derivatives of Far against differences of its own first ones.
TEST(OpenSubdivDeviations, second_derivatives_have_the_wrong_sign_in_turned_triangles) {
    const TestMesh mesh = perturbed(make_triangle_grid(4, 4), Scheme::loop);
    std::string error;
    const auto oracle = OsdPatchOracle::create(mesh, 1, &error);
    ASSERT_TRUE(oracle) << error;
    constexpr double kStep = 1e-4;
    bool seen[2] = {};
    for (uint32_t f = 0; f < oracle->ptex_face_count(); ++f) {
        for (const double u : {0.2, 0.3}) {
            const std::vector<PatchSample> places = {
                {f, u, 0.25}, {f, u + kStep, 0.25}, {f, u - kStep, 0.25}};
            const auto at = oracle->far_places(mesh.positions_double(), places);
            if (!at[0].regular || at[0].depth == 0) continue;
            const double sign = at[0].turned ? -1 : 1;
            for (size_t i = 0; i < 3; ++i)
                EXPECT_NEAR((at[1].values[1][i] - at[2].values[1][i]) / (2 * kStep),
                            sign * at[0].values[3][i], 1e-3);
            seen[at[0].turned] = true;
        }
    }
    EXPECT_TRUE(seen[0] && seen[1]);
}

// Far's adaptive refinement against OpenSubdiv's own uniform one, and limn's surface: a semi-sharp edge
// between two holes, which Far does not refine, meets another.
TEST(OpenSubdivDeviations, chaikin_creasing_in_adaptive_refinement_misses_edges_between_holes) {
    TestMesh mesh = perturbed(make_grid(3, 3));
    mesh.options.creasing = CreasingMethod::chaikin;
    mesh.holes = {4, 5};
    mesh.add_crease(5, 6, 3);
    mesh.add_crease(6, 10, 1.5);
    std::string error;
    const auto uniform = OsdOracle::create(mesh, 4, &error);
    const auto patches = OsdPatchOracle::create(mesh, 10, &error);
    ASSERT_TRUE(uniform && patches) << error;
    const SurfaceUnderTest surface(mesh, false);
    const std::vector<double> limits = uniform->limits(surface.control_points).positions;
    const std::vector<RefinedCorner> corners = refined_corners(*uniform, false);
    std::vector<PatchSample> places;
    for (const RefinedCorner& corner : corners) places.push_back(corner.place);
    const auto ours = surface.evaluate(places, Derivatives::none);
    const auto far = patches->far_places(surface.control_points, places);
    double our_error = 0, far_error = 0;
    for (size_t c = 0; c < corners.size(); ++c) {
        if (!far[c].valid) continue;
        const Vector truth = vector_at(limits, corners[c].vertex);
        our_error = std::max(our_error, length(ours.at(c, 0) - truth));
        far_error = std::max(far_error, length(truth - far[c].values[0]));
    }
    EXPECT_LE(our_error, kFadingSurfaceTolerance * surface.size);
    EXPECT_GT(far_error, 1e-4 * surface.size);
}

}  // namespace
}  // namespace limn::test
