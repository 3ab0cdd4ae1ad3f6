// Spectra, masks and verdicts of the analysis against verified numbers (scheme_checks.json) and closed forms.
#include "limn/schemes/scheme_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "limn/schemes/scheme_limit.h"
#include "schemes/scheme_meshes.h"

namespace limn::test {
namespace {

using Complex = std::complex<double>;
using nlohmann::json;
using std::numbers::pi;

/// Names in scheme_checks.json -> limn's.
const std::map<std::string, const char*>& names() {
    static const std::map<std::string, const char*> names = {
        {"catmull_clark", "catmark"},
        {"loop", "loop"},
        {"loop_warren", "loop-warren"},
        {"doo_sabin", "doo-sabin"},
        {"doo_sabin_averaging", "averaging-2"},
        {"midedge_one_step", "mid-edge"},
        {"midedge_double_step", "midpoint"},
        {"midedge_double_step_normalised", "midpoint-normalised"},
        {"modified_butterfly", "butterfly"},
        {"kobbelt_interpolatory_quad", "kobbelt"},
        {"sqrt3", "sqrt3"},
        {"labsik_greiner", "sqrt3-interpolatory"},
        {"sqrt2_4_8", "4-8"},
        {"interpolatory_sqrt2_quincunx", "sqrt2-interpolatory"},
        {"repeated_averaging_degree_3", "averaging-3"},
        {"repeated_averaging_degree_4", "averaging-4"},
        {"repeated_averaging_degree_5", "averaging-5"},
        {"repeated_averaging_degree_6", "averaging-6"},
        {"repeated_averaging_degree_7", "averaging-7"},
        {"stam_quad_degree_5", "stam-5"},
        {"stam_quad_degree_7", "stam-7"},
        {"stam_tri_degree_7", "stam-triangles-7"},
        {"stam_tri_degree_10", "stam-triangles-10"},
        {"composite_sqrt3_P2", "sqrt3-composite-2"},
        {"composite_sqrt3_P3", "sqrt3-composite-3"},
        {"honeycomb_third", "honeycomb"},
        {"sabin_bounded_curvature_cc", "sabin"},
        {"pushback_catmull_clark", "push-back-catmark"},
        {"pushback_loop", "push-back-loop"},
    };
    return names;
}

Complex complex_of(const json& value) {
    if (value.is_array()) return {value[0].get<double>(), value[1].get<double>()};
    return value.is_null() ? 0 : value.get<double>();
}

/// Each verified eigenvalue is among the analysed ones, as often.
void expect_eigenvalues(const json& verified, std::vector<Complex> own, double tolerance) {
    for (const json& value : verified) {
        const Complex c = complex_of(value);
        if (std::abs(c) < 1e-6) continue;
        const auto nearest = std::min_element(own.begin(), own.end(),
                                              [&](Complex a, Complex b) { return std::abs(a - c) < std::abs(b - c); });
        ASSERT_NE(nearest, own.end());
        EXPECT_LT(std::abs(*nearest - c), tolerance) << value;
        own.erase(nearest);
    }
}

class VerifiedEigenvalues : public testing::TestWithParam<std::string> {};

TEST_P(VerifiedEigenvalues, AreFound) {
    ASSERT_TRUE(names().count(GetParam())) << "a verified scheme that this test knows nothing of";
    const SubdivisionScheme* scheme = find_subdivision_scheme(names().at(GetParam()));
    ASSERT_NE(scheme, nullptr) << names().at(GetParam());
    // Triple eigenvalues of interpolating schemes are defective: both sides have a third of the digits there.
    const double tolerance = 2e-5;
    for (const auto& [valence, verified] : scheme_checks().at("eigenvalues").at(GetParam()).items()) {
        SCOPED_TRACE("valence " + valence);
        const auto n = static_cast<uint32_t>(std::stoul(valence));
        const auto own = analyze_scheme(*scheme, {.valence = n});
        ASSERT_TRUE(own) << own.error().message;
        EXPECT_NEAR(own->lambda, verified.at("lambda").get<double>(), 1e-10);
        EXPECT_EQ(own->continuity == Continuity::smooth, verified.at("c1_spectral_ok").get<bool>())
            << describe(own->continuity);
        // Where only `third` is from three rings, larger ones may join frequency 0 there.
        if (!verified.contains("third_note")) {
            EXPECT_NEAR(std::abs(own->mu0), std::abs(complex_of(verified.at("mu0"))), tolerance);
        }
        if (verified.contains("third")) {
            EXPECT_NEAR(own->third, verified.at("third").get<double>(), tolerance);
        }
        // None where one ring has none; three rings may.
        const double mu2 = verified.contains("mu2") ? std::abs(complex_of(verified.at("mu2"))) : 0;
        if (mu2 > 1e-9) {
            EXPECT_NEAR(std::abs(own->mu2), mu2, tolerance);
        }
        if (!verified.contains("eigs")) continue;
        for (const auto& [frequency, values] : verified.at("eigs").items()) {
            SCOPED_TRACE("frequency " + frequency);
            expect_eigenvalues(values, own->frequencies.at(std::stoul(frequency)).eigenvalues, tolerance);
        }
    }
}

std::vector<std::string> verified_names() {
    std::vector<std::string> out;
    for (const auto& [name, values] : scheme_checks().at("eigenvalues").items()) out.push_back(name);
    return out;
}
INSTANTIATE_TEST_SUITE_P(Schemes, VerifiedEigenvalues, testing::ValuesIn(verified_names()),
                         [](const testing::TestParamInfo<std::string>& info) { return info.param; });

/// n faces around vertex 0, closed, or a fan of k; refined until the rest is regular and out of reach.
SchemeRefinementDouble refined_star(const SubdivisionScheme& scheme, uint32_t n, bool open) {
    RefinedMesh mesh;
    const bool triangles = scheme.faces == FaceKind::triangles;
    const uint32_t around = open ? (triangles ? n + 1 : 2 * n + 1) : (triangles ? n : 2 * n);
    mesh.points.resize(size_t{3} * (around + (open ? 1 : 2)));
    auto at = [&](uint32_t i) { return 1 + i % around; };
    auto add_face = [&](std::initializer_list<uint32_t> face) {
        mesh.face_sizes.push_back(static_cast<uint32_t>(face.size()));
        mesh.face_vertices.insert(mesh.face_vertices.end(), face);
    };
    for (uint32_t i = 0; i < n; ++i) {
        if (triangles)
            add_face({0, at(i), at(i + 1)});
        else
            add_face({0, at(2 * i), at(2 * i + 1), at(2 * i + 2)});
    }
    for (uint32_t i = 0; !open && i < n; ++i) {
        if (triangles)
            add_face({around + 1, at(i + 1), at(i)});
        else
            add_face({around + 1, at(2 * i + 3), at(2 * i + 2), at(2 * i + 1)});
    }
    auto refined = build_scheme_refinement<double>(control_mesh_of(mesh), scheme, {2, true});
    EXPECT_TRUE(refined) << refined.error().message;
    return std::move(*refined);
}

/// Row 0 of the star's limit table. Entries lie ring by ring, counter-clockwise: the vertex, edge 0, the vertex across
/// face 0 (of quads), edge 1, and so on.
struct CenterRow {
    std::vector<double> position, tangent1, tangent2;
};
CenterRow center_row(const SubdivisionScheme& scheme, uint32_t n, bool open) {
    const auto table = build_scheme_limit_table(refined_star(scheme, n, open), true);
    EXPECT_TRUE(table) << table.error().message;
    auto row = [&](const Array<double>& weights) {
        return std::vector<double>(weights.begin(), weights.begin() + table->offsets[1]);
    };
    return {row(table->weights), row(table->tangent1_weights), row(table->tangent2_weights)};
}

/// The weights along edges, or across faces, of a row.
std::vector<double> every(const std::vector<double>& row, size_t first, size_t step) {
    std::vector<double> out;
    for (size_t i = first; i < row.size(); i += step) out.push_back(row[i]);
    return out;
}

void expect_all(const std::vector<double>& values, double expected) {
    for (const double value : values) EXPECT_NEAR(value, expected, 1e-12);
}

void expect_proportional(const std::vector<double>& values, const std::vector<double>& expected, double scale) {
    ASSERT_EQ(values.size(), expected.size());
    for (size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i] * scale, expected[i], 1e-10) << i;
}

/// Sums of cosines and sines: tangents of a symmetric star, which steps may turn.
void expect_first_frequency(const std::vector<double>& values) {
    const auto n = static_cast<double>(values.size());
    std::complex<double> sum = 0;
    for (size_t i = 0; i < values.size(); ++i)
        sum += values[i] * std::polar(2 / n, 2 * pi * static_cast<double>(i) / n);
    EXPECT_GT(std::abs(sum), 0.5);
    for (size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(values[i], (std::conj(sum) * std::polar(1.0, 2 * pi * static_cast<double>(i) / n)).real(), 1e-10);
}

TEST(SchemeMasks, LimitsByValence) {
    for (const auto& [valence, masks] : scheme_checks().at("masks").items()) {
        if (!masks.is_object() || !masks.contains("catmull_clark")) continue;
        SCOPED_TRACE("valence " + valence);
        const auto n = static_cast<uint32_t>(std::stoul(valence));
        const CenterRow quads = center_row(*find_subdivision_scheme("catmark"), n, false);
        ASSERT_EQ(quads.position.size(), 2 * n + 1);
        const json& cc = masks.at("catmull_clark");
        EXPECT_NEAR(quads.position[0], cc.at("v").get<double>(), 1e-12);
        expect_all(every(quads.position, 1, 2), cc.at("edge_each").get<double>());
        expect_all(every(quads.position, 2, 2), cc.at("face_diag_each").get<double>());
        const auto edges = cc.at("tangent1").at("edge_i").get<std::vector<double>>();
        const double scale = edges[0] / quads.tangent1[1];
        expect_proportional(every(quads.tangent1, 1, 2), edges, scale);
        expect_proportional(every(quads.tangent1, 2, 2), cc.at("tangent1").at("face_i").get<std::vector<double>>(),
                            scale);
        for (const char* name : {"loop", "loop_warren", "sqrt3"}) {
            const SubdivisionScheme* scheme = find_subdivision_scheme(names().at(name));
            if (scheme == nullptr) continue;  // VerifiedEigenvalues says so
            SCOPED_TRACE(name);
            const CenterRow row = center_row(*scheme, n, false);
            ASSERT_EQ(row.position.size(), n + 1);
            EXPECT_NEAR(row.position[0], masks.at(name).at("v").get<double>(), 1e-12);
            expect_all(every(row.position, 1, 1), masks.at(name).at("ring_each").get<double>());
            expect_first_frequency(every(row.tangent1, 1, 1));
            expect_first_frequency(every(row.tangent2, 1, 1));
        }
    }
}

TEST(SchemeMasks, FacesOfDooSabin) {
    // A vertex of a cube's corner turns into a triangle, of a prism's rim too: its limit is the centroid of its
    // corners.
    const SubdivisionScheme& scheme = *find_subdivision_scheme("doo-sabin");
    const RefinedMesh mesh = make_irregular_mesh(scheme, false, 1);
    const auto level0 = build_scheme_refinement<double>(control_mesh_of(mesh), scheme, {0, true});
    const auto level1 = build_scheme_refinement<double>(control_mesh_of(mesh), scheme, {1, true});
    ASSERT_TRUE(level0 && level1);
    const auto table = build_scheme_limit_table(*level0, false);
    ASSERT_TRUE(table);
    std::vector<double> limit(mesh.points.size()), refined(size_t{3} * level1->mesh().vertex_count);
    apply_stencil_table<double>(*table, mesh.points, limit, 3);
    apply_stencil_table<double>(level1->tables[0], mesh.points, refined, 3);
    const Topology& t = level0->mesh();
    for (uint32_t v = 0; v < t.vertex_count; ++v) {
        const auto corners = t.corners_of_vertex(v);  // whose points are numbered alike
        for (size_t k = 0; k < 3; ++k) {
            double sum = 0;
            for (const uint32_t c : corners) sum += refined[3 * size_t{c} + k];
            EXPECT_NEAR(limit[3 * size_t{v} + k], sum / static_cast<double>(corners.size()), 1e-13);
        }
    }
}

TEST(SchemeMasks, AcrossBoundaries) {
    for (const char* name : {"catmull_clark", "loop"})
        for (const auto& [faces, masks] : scheme_checks().at("boundary_cross_tangents").at(name).items()) {
            SCOPED_TRACE(std::string(name) + ", faces " + faces);
            const auto k = static_cast<uint32_t>(std::stoul(faces));
            const SubdivisionScheme& scheme = *find_subdivision_scheme(names().at(name));
            const size_t step = scheme.faces == FaceKind::triangles ? 1 : 2;
            const CenterRow row = center_row(scheme, k, true);
            ASSERT_EQ(row.position.size(), 2 + step * k);
            const double scale = masks.at("v").get<double>() / row.tangent2[0];
            const std::vector<double> edges = every(row.tangent2, 1, step);
            std::vector<double> expected = masks.at("interior_edge_i").get<std::vector<double>>();
            expected.insert(expected.begin(), masks.at("boundary_edge_each").get<double>());
            expected.push_back(masks.at("boundary_edge_each").get<double>());
            expect_proportional(edges, expected, scale);
            if (step == 2)
                expect_proportional(every(row.tangent2, 2, 2), masks.at("face_diag_i").get<std::vector<double>>(),
                                    scale);
            EXPECT_GT(row.tangent1[1], 0);
            EXPECT_NEAR(row.tangent1[1], -row.tangent1.back(), 1e-12);
            const auto analysis = analyze_scheme(scheme, {.valence = k, .boundary = true});
            ASSERT_TRUE(analysis) << analysis.error().message;
            EXPECT_NEAR(analysis->lambda, masks.at("lambda_along").get<double>(), 1e-12);
            EXPECT_NEAR(analysis->lambda_cross, masks.at("lambda_cross").get<double>(), 1e-12);
        }
}

/// Each side of a crease is what a boundary of as many faces is, whatever lies beyond; eigenvalues across it in closed
/// form (schemes with standard boundary rules).
TEST(CreaseAnalysis, SidesAreLikeBoundaries) {
    for (const char* name : {"catmark", "loop", "catmark-blz", "loop-blz"})
        for (uint32_t n = 3; n <= 9; ++n)
            for (uint32_t k = 1; k < n; ++k) {
                SCOPED_TRACE(std::string(name) + ", " + std::to_string(k) + " of " + std::to_string(n));
                const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
                const auto crease = analyze_scheme(scheme, {.valence = n, .crease = k});
                const auto boundary = analyze_scheme(scheme, {.valence = k, .boundary = true});
                ASSERT_TRUE(crease && boundary);
                EXPECT_NEAR(crease->lambda, boundary->lambda, 1e-12);
                EXPECT_NEAR(crease->lambda_cross, boundary->lambda_cross, 1e-9);
                EXPECT_NEAR(crease->third, boundary->third, 1e-6);
                EXPECT_EQ(crease->continuity, boundary->continuity);
                EXPECT_EQ(crease->map_is_regular, boundary->map_is_regular);
                EXPECT_EQ(crease->face_sizes.size(), boundary->face_sizes.size());
                const double c = std::cos(pi / k);
                if (k >= 2 && scheme.name == std::string("catmark")) {
                    EXPECT_NEAR(crease->lambda_cross, (5 + c + std::sqrt((c + 9) * (c + 1))) / 16, 1e-12);
                } else if (k >= 2 && scheme.name == std::string("loop")) {
                    EXPECT_NEAR(crease->lambda_cross, 0.375 + c / 4, 1e-12);
                }
            }
}

/// The map of a side is an eigenvector: one refinement makes it lambda times as large along the crease, lambda_cross
/// times across it, which nothing beyond the crease changes.
TEST(CreaseAnalysis, MapsLieOnOneSide) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme("catmark");
    for (const uint32_t k : {2u, 3u}) {
        const auto crease = analyze_scheme(scheme, {.valence = 5, .crease = k});
        ASSERT_TRUE(crease);
        ASSERT_EQ(crease->continuity, Continuity::smooth);
        double low = 1, high = -1;
        for (const uint32_t v : crease->face_vertices) {
            low = std::min(low, crease->points[2 * size_t{v} + 1]);
            high = std::max(high, crease->points[2 * size_t{v} + 1]);
        }
        EXPECT_NEAR(low * high, 0, 1e-8);  // all on one side of a straight crease
        EXPECT_GT(high - low, 0.1);
        EXPECT_EQ(std::count(crease->face_rings.begin(), crease->face_rings.end(), 1u), k);
    }
}

/// Around a dart the vertex is smooth, its one sharp edge apart: eigenvalues of the whole star, without symmetry.
TEST(CreaseAnalysis, Darts) {
    for (const char* name : {"catmark", "loop"}) {
        const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
        for (const uint32_t n : {3u, 4u, 5u, 6u, 8u}) {
            SCOPED_TRACE(std::string(name) + std::to_string(n));
            const auto dart = analyze_scheme(scheme, {.valence = n, .dart = true});
            ASSERT_TRUE(dart) << dart.error().message;
            ASSERT_EQ(dart->frequencies.size(), 1u);
            EXPECT_NEAR(dart->frequencies[0].eigenvalues[0].real(), 1, 1e-12);
            // Across the dart nothing sharp is felt: odd eigenvectors are those of the smooth star.
            const auto smooth = analyze_scheme(scheme, {.valence = n});
            ASSERT_TRUE(smooth);
            const bool found = std::abs(dart->lambda - smooth->lambda) < 1e-10 ||
                               std::abs(dart->lambda_cross - smooth->lambda) < 1e-10;
            EXPECT_TRUE(found) << dart->lambda << " " << dart->lambda_cross << " " << smooth->lambda;
        }
    }
}

TEST(SchemeMasks, FourEightIsABoxSpline) {
    const SubdivisionScheme* scheme = find_subdivision_scheme("4-8");
    ASSERT_NE(scheme, nullptr);
    constexpr uint32_t n = 16;
    const auto refined =
        build_scheme_refinement<double>(control_mesh_of(make_regular_torus(n, false)), *scheme, {0, true});
    ASSERT_TRUE(refined);
    const auto table = build_scheme_limit_table(*refined, false);
    ASSERT_TRUE(table);
    std::map<std::pair<int, int>, double> weights;
    for (uint32_t k = 0; k < table->offsets[1]; ++k) {
        auto distance = [](uint32_t i) { return static_cast<int>(std::min(i, n - i)); };
        const int i = distance(table->indices[k] % n), j = distance(table->indices[k] / n);
        weights[{std::max(i, j), std::min(i, j)}] = table->weights[k];
    }
    const json& values = scheme_checks().at("four_eight_box_spline_values");
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {2, 0}, {2, 1}}) {
        const json& value = values.at("(" + std::to_string(i) + "," + std::to_string(j) + ")");
        EXPECT_NEAR((weights[{i, j}]), value[0].get<double>() / value[1].get<double>(), 1e-13) << i << j;
    }
    EXPECT_EQ(weights.size(), 5u);
}

TEST(SchemeVerdicts, StandardBoundariesAreSmoothUpToSomeValence) {
    auto verdict = [](const char* name, uint32_t faces) {
        const auto analysis = analyze_scheme(*find_subdivision_scheme(name), {.valence = faces, .boundary = true});
        EXPECT_TRUE(analysis) << analysis.error().message;
        return analysis->continuity;
    };
    for (const auto& [name, borderline] : {std::pair{"catmark", 4u}, {"loop", 6u}})
        for (uint32_t faces = 2; faces <= 8; ++faces)
            EXPECT_EQ(verdict(name, faces), faces < borderline    ? Continuity::smooth
                                            : faces == borderline ? Continuity::borderline
                                                                  : Continuity::not_smooth)
                << name << faces;
    for (const char* name : {"catmark-blz", "loop-blz"})
        for (uint32_t faces = 2; faces <= 8 && find_subdivision_scheme(name) != nullptr; ++faces)
            EXPECT_EQ(verdict(name, faces), Continuity::smooth) << name << faces;
}

TEST(SchemeVerdicts, LinearInterpolationHasNoTangents) {
    for (const char* name : {"bilinear", "linear"})
        for (uint32_t n = 3; n <= 8; ++n) {
            const auto analysis = analyze_scheme(*find_subdivision_scheme(name), {.valence = n});
            ASSERT_TRUE(analysis);
            EXPECT_NE(analysis->continuity, Continuity::smooth) << name << n;
        }
}

TEST(SchemeVerdicts, OptionsAreChecked) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme("doo-sabin");
    EXPECT_EQ(analyze_scheme(scheme, {.valence = 2}).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(analyze_scheme(scheme, {.valence = 65}).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(analyze_scheme(scheme, {.rings = 7}).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(analyze_scheme(scheme, {.boundary = true}).error().code, ErrorCode::unsupported);
    EXPECT_EQ(analyze_scheme(scheme, {.crease = 2}).error().code, ErrorCode::unsupported);
    EXPECT_EQ(analyze_scheme(scheme, {.dart = true}).error().code, ErrorCode::unsupported);
    const SubdivisionScheme& creased = *find_subdivision_scheme("catmark");
    EXPECT_EQ(analyze_scheme(creased, {.valence = 4, .crease = 4}).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(analyze_scheme(creased, {.boundary = true, .crease = 1}).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(analyze_scheme(creased, {.crease = 1, .dart = true}).error().code, ErrorCode::invalid_argument);
}

/// A map's control net is an eigenvector: faces counter-clockwise, ring within ring.
TEST(CharacteristicMaps, AreWhatTheySay) {
    for (const char* name : {"catmark", "loop", "doo-sabin", "sqrt3"})
        for (const uint32_t n : {3u, 5u, 9u}) {
            const SubdivisionScheme& scheme = *find_subdivision_scheme(name);
            const auto analysis = analyze_scheme(scheme, {.valence = n});
            ASSERT_TRUE(analysis);
            SCOPED_TRACE(std::string(name) + std::to_string(n));
            size_t begin = 0;
            double area = 0;
            for (const uint32_t size : analysis->face_sizes) {
                double face = 0;
                for (size_t i = 0; i < size; ++i) {
                    const double* a = &analysis->points[2 * size_t{analysis->face_vertices[begin + i]}];
                    const double* b = &analysis->points[2 * size_t{analysis->face_vertices[begin + (i + 1) % size]}];
                    face += (a[0] * b[1] - a[1] * b[0]) / 2;
                }
                EXPECT_GT(face, 0);
                area += face;
                begin += size;
            }
            EXPECT_GT(area, 1);
            EXPECT_EQ(analysis->face_sizes.size(), analysis->face_rings.size());
            EXPECT_EQ(*std::max_element(analysis->face_rings.begin(), analysis->face_rings.end()), 3u);
        }
}

}  // namespace
}  // namespace limn::test
