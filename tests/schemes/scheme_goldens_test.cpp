// Refined meshes and eigenvalues against numbers that were verified independently of limn (other libraries, closed
// forms, 30-digit arithmetic): scheme_checks.json.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "schemes/scheme_meshes.h"

namespace limn::test {
namespace {

struct Named {
    const char* scheme;
    BoundaryInterpolation boundary = BoundaryInterpolation::edge_only;
};
/// Names in scheme_checks.json -> limn's.
const std::map<std::string, Named>& names() {
    static const std::map<std::string, Named> names = {
        {"bilinear", {"bilinear"}},
        {"catmull_clark", {"catmark"}},
        {"loop", {"loop"}},
        {"loop_warren", {"loop-warren"}},
        {"modified_butterfly_reflect", {"butterfly"}},
        {"sqrt3", {"sqrt3"}},
        {"doo_sabin", {"doo-sabin"}},
        {"doo_sabin_boundary_curve", {"doo-sabin"}},
        {"doo_sabin_boundary_shrink", {"doo-sabin", BoundaryInterpolation::none}},
        {"doo_sabin_averaging", {"averaging-2"}},
        {"midedge", {"mid-edge"}},
        {"kobbelt_interpolatory_quad", {"kobbelt"}},
        {"labsik_greiner", {"sqrt3-interpolatory"}},
        {"sqrt2_4_8", {"4-8"}},
        {"interpolatory_sqrt2_quincunx", {"sqrt2-interpolatory"}},
        {"repeated_averaging_degree_3", {"averaging-3"}},
        {"repeated_averaging_degree_4", {"averaging-4"}},
        {"repeated_averaging_degree_5", {"averaging-5"}},
        {"repeated_averaging_degree_7", {"averaging-7"}},
        {"stam_quad_degree_5", {"stam-5"}},
        {"stam_tri_degree_7", {"stam-triangles-7"}},
        {"composite_sqrt3_P2", {"sqrt3-composite-2"}},
        {"honeycomb_third", {"honeycomb"}},
        {"sabin_bounded_curvature_cc", {"sabin"}},
        {"pushback_catmull_clark", {"push-back-catmark"}},
        {"pushback_loop", {"push-back-loop"}},
    };
    return names;
}

struct Moments {
    double sum[3] = {}, outer[6] = {}, low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9}, area = 0, volume = 0;
};

/// Sums over points and, faces as fans around their centroids, area and volume.
Moments moments_of(const RefinedMesh& mesh) {
    Moments m;
    for (size_t v = 0; v < mesh.points.size(); v += 3) {
        const double* p = mesh.points.data() + v;
        size_t k = 0;
        for (size_t i = 0; i < 3; ++i) {
            m.sum[i] += p[i];
            m.low[i] = std::min(m.low[i], p[i]);
            m.high[i] = std::max(m.high[i], p[i]);
            for (size_t j = i; j < 3; ++j) m.outer[k++] += p[i] * p[j];
        }
    }
    size_t begin = 0;
    for (const uint32_t n : mesh.face_sizes) {
        double c[3] = {};
        auto point = [&](size_t i) { return mesh.points.data() + size_t{3} * mesh.face_vertices[begin + i % n]; };
        for (size_t i = 0; i < n; ++i)
            for (size_t k = 0; k < 3; ++k) c[k] += point(i)[k] / n;
        for (size_t i = 0; i < n; ++i) {
            double a[3], b[3];
            for (size_t k = 0; k < 3; ++k) {
                a[k] = point(i)[k] - c[k];
                b[k] = point(i + 1)[k] - c[k];
            }
            const double normal[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
            m.area += std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) / 2;
            m.volume += (c[0] * normal[0] + c[1] * normal[1] + c[2] * normal[2]) / 6;
        }
        begin += n;
    }
    return m;
}

void expect_moments(const RefinedMesh& mesh, const nlohmann::json& level) {
    EXPECT_EQ(mesh.vertex_count(), level.at("n_vertices").get<uint32_t>());
    EXPECT_EQ(mesh.face_sizes.size(), level.at("n_faces").get<size_t>());
    const Moments m = moments_of(mesh);
    const double tolerance = 1e-11 * mesh.vertex_count();
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(m.sum[i], level.at("sum")[i].get<double>(), tolerance);
        EXPECT_NEAR(m.low[i], level.at("bbox")[0][i].get<double>(), 1e-11);
        EXPECT_NEAR(m.high[i], level.at("bbox")[1][i].get<double>(), 1e-11);
    }
    for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(m.outer[i], level.at("sum_outer")[i].get<double>(), tolerance);
    EXPECT_NEAR(m.area, level.at("area_fan").get<double>(), 1e-9);
    if (level.contains("volume_fan")) {  // of closed meshes
        EXPECT_NEAR(m.volume, level.at("volume_fan").get<double>(), 1e-9);
    }
}

TEST(SchemeGoldens, RefinedMeshes) {
    for (const auto& item : scheme_checks().at("refinement")) {
        const auto scheme_name = item.at("scheme").get<std::string>(), mesh_name = item.at("mesh").get<std::string>();
        SCOPED_TRACE(scheme_name + " of " + mesh_name);
        ASSERT_TRUE(names().count(scheme_name));
        const Named& named = names().at(scheme_name);
        const SubdivisionScheme* scheme = find_subdivision_scheme(named.scheme);
        ASSERT_NE(scheme, nullptr) << named.scheme;
        SchemeOptions options;
        options.boundary = named.boundary;
        const RefinedMesh mesh = json_mesh(mesh_name);
        for (const auto& level : item.at("levels")) {
            SCOPED_TRACE("level " + level.at("level").dump());
            expect_moments(refine_mesh(mesh, *scheme, level.at("level").get<uint32_t>(), options), level);
        }
    }
}

}  // namespace
}  // namespace limn::test
