#include "vulkan/tessellation_parity.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include "limn/topology.h"

namespace limn::vk::test {

using limn::test::find_tessellation_fault;
using limn::test::random_rates;
using limn::test::TestMesh;

namespace {

/// Rates as a caller gives them: of whole edges.
std::vector<float> as_floats(const TessellationTable& table, const std::vector<uint32_t>& rates) {
    std::vector<float> floats;
    for (uint32_t e = 0; e < rates.size(); ++e) {
        const uint32_t word = table.rate_edges[size_t{e} * shared::kRateEdgeWords];
        const bool halves = (word & (shared::kRateEdgeHalves | shared::kRateEdgeSubFace)) != 0;
        floats.push_back(static_cast<float>(rates[e]) / shared::kRateOne * (halves ? 2 : 1));
    }
    return floats;
}

/// Places at vertices where several faces meet at a corner that stays sharp: the surface has no normal there.
std::set<std::tuple<uint32_t, double, double>> find_corners(const ControlMesh& mesh) {
    const Topology base = build_topology(mesh);
    const uint32_t own = base.options.scheme == Scheme::loop ? 3 : 4;
    std::set<std::tuple<uint32_t, double, double>> corners;
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t n = base.size_of_face(f);
        for (uint32_t k = 0; k < n; ++k) {
            double u = 0, v = 0;
            if (n == own) shared::locate_on_side(own == 3, k, 0, u, v);
            const uint32_t vertex = base.vertices_of_face(f)[k];
            if (base.vertex_rules[vertex] == VertexRule::corner && base.corners_of_vertex(vertex).size() > 1)
                corners.insert({ptex, u, v});
            if (n != own) ++ptex;
        }
        if (n == own) ++ptex;
    }
    return corners;
}

/// The direction in which the first coordinate of a channel grows on the surface and, fourth, whether the second grows to
/// its left (1) or right; of derivatives by u and v. Zero where the channel folds or the surface has no tangent plane.
std::array<double, 4> tangent_of(const double* du, const double* dv, const double* st_u, const double* st_v,
                                 const double* normal) {
    const double area = st_u[0] * st_v[1] - st_v[0] * st_u[1];
    const double scale = std::hypot(st_u[0], st_u[1]) * std::hypot(st_v[0], st_v[1]);
    if (!(std::abs(area) > 1e-2 * scale)) return {};
    double t[3], along = 0, length = 0;
    for (int k = 0; k < 3; ++k) {
        t[k] = (du[k] * st_v[1] - dv[k] * st_u[1]) / area;
        along += t[k] * normal[k];
    }
    for (int k = 0; k < 3; ++k) {
        t[k] -= along * normal[k];
        length = std::hypot(length, t[k]);
    }
    if (!(length > 0)) return {};
    return {t[0] / length, t[1] / length, t[2] / length, area > 0 ? 1.0 : -1.0};
}

/// Tangents follow channel 0 or, without channels, u of the ptex face; not where `skip` says so.
void expect_tangents(const TessellatedShape& t, const limn::Tessellation& host, const std::vector<double>& derivatives,
                     const std::vector<double>& normals, const std::vector<uint8_t>& skip) {
    const size_t count = host.places.size();
    std::vector<double> channel(count * 6);
    std::vector<SampleStatus> statuses(count);
    if (!t.channels.empty())
        evaluate_patches(t.channel_patches[0], host.places, t.channel_points[0], 2, Derivatives::first, channel, statuses);
    size_t compared = 0, candidates = 0;
    for (size_t i = 0; i < count; ++i) {
        const PatchSample& place = host.places[i];
        // At corners of faces du and dv may be tangents, whose lengths mean nothing.
        const auto is_end = [](double x) { return x == 0 || x == 1; };
        if (skip[i] != 0 || (is_end(place.u) && is_end(place.v))) continue;
        ++candidates;
        const double unit[4] = {1, 0, 0, 1};
        const double* st = t.channels.empty() ? unit : &channel[6 * i + 2];
        const auto expected =
            tangent_of(&derivatives[9 * i + 3], &derivatives[9 * i + 6], st, st + 2, &normals[3 * i]);
        if (expected[3] == 0) continue;
        ++compared;
        const double dot = t.tangents[4 * i] * expected[0] + t.tangents[4 * i + 1] * expected[1] +
                           t.tangents[4 * i + 2] * expected[2];
        ASSERT_GT(dot, 0.999) << "vertex " << i << " of face " << place.face << " at " << place.u << ' ' << place.v;
        ASSERT_EQ(t.tangents[4 * i + 3], expected[3]) << "vertex " << i;
    }
    EXPECT_GE(compared * 4, candidates);
}

/// The leaf that evaluation ends in: bicubic and of level 0 where the ptex face is one regular patch, deeper elsewhere.
void expect_leaves(const TessellatedShape& t) {
    for (size_t i = 0; i < t.places.size(); i += 4) {
        const uint32_t surface = t.patches.ptex_surfaces[t.places[i]], kind = t.places[i + 3] & 255,
                       level = t.places[i + 3] >> 8;
        ASSERT_TRUE(kind > shared::kNodeSplitV && kind <= shared::kNodeCorner && kind != shared::kNodePlan);
        if ((surface & shared::kPtexSplit) != 0) {
            ASSERT_GE(level, 1u);
        } else {
            const Plan& plan = t.patches.plans[t.patches.surfaces[surface].plan()];
            const PlanNodeKind root = t.patches.plan_nodes[plan.first_node].kind();
            if (root > PlanNodeKind::split_v) {
                ASSERT_EQ(level, 0u);
                ASSERT_EQ(kind, static_cast<uint32_t>(root));
            }
        }
        ASSERT_LE(level, 8u);
    }
}

}  // namespace

TessellationRequest random_request(const TestMesh& shape, TessellationSpacing spacing, uint32_t most, uint32_t seed) {
    const ControlMesh mesh = *ControlMesh::create(shape.description());
    const TessellationTable table = *build_tessellation_table(mesh, {});  // rate edges do not depend on seams
    std::mt19937 random(seed);
    TessellationRequest request;
    request.settings.mode = RateMode::per_edge;
    request.settings.spacing = spacing;
    request.edge_rates = as_floats(table, random_rates(mesh, table, spacing, most, random));
    return request;
}

double degrees_between(const float* a, const double* b) {
    return std::acos(std::clamp(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], -1.0, 1.0)) * 180 / std::numbers::pi;
}

void expect_as_on_host(const TessellatedShape& shape, TessellationSpacing spacing) {
    ASSERT_TRUE(shape.recorded);
    const limn::Tessellation host = tessellate_on_host(shape, spacing);
    ASSERT_EQ(shape.result.status, TessellationStatus::complete);
    ASSERT_EQ(shape.result.vertex_count, host.vertex_count());
    ASSERT_EQ(shape.result.triangle_count, host.triangle_faces.size());
    ASSERT_EQ(shape.command[0], host.indices.size());
    ASSERT_EQ(shape.command[1], 1u);
    ASSERT_EQ(shape.command[2] + shape.command[3] + shape.command[4], 0u);
    ASSERT_EQ(shape.indices, host.indices);
    ASSERT_EQ(shape.triangle_faces, host.triangle_faces);
    EXPECT_EQ(find_tessellation_fault(shape.mesh, shape.table, shape.rates, spacing, host), "");
    if (host.places.empty()) return;  // the whole mesh is holes, as faces at boundaries that are not interpolated are
    const auto corners = find_corners(shape.mesh);
    HostPoints positions{std::vector<double>(host.places.size() * 3)};
    std::vector<double> normals(positions.values.size()), derivatives(host.places.size() * 9);
    std::vector<SampleStatus> statuses(host.places.size());
    evaluate_tessellation(shape.patches, host, shape.points, positions.values, normals);
    EXPECT_TRUE(points_match(positions, DevicePoints{shape.positions}, shape.tolerance));
    evaluate_patches(shape.patches, host.places, shape.points, 3, Derivatives::first, derivatives, statuses);
    std::vector<uint8_t> skip(host.places.size(), 0);  // where there is no normal
    for (size_t i = 0; i < host.places.size(); ++i) {
        ASSERT_EQ(shape.places[4 * i], host.places[i].face);
        ASSERT_NEAR(std::bit_cast<float>(shape.places[4 * i + 1]), host.places[i].u, 1e-6);
        ASSERT_NEAR(std::bit_cast<float>(shape.places[4 * i + 2]), host.places[i].v, 1e-6);
        const size_t source = host.position_sources[i];
        ASSERT_EQ(std::memcmp(&shape.positions[3 * i], &shape.positions[3 * source], 12), 0) << "vertex " << i;
        const float* n = &shape.normals[3 * i];
        ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
        // Where tangents span no plane a normal is any unit vector.
        const double *u = &derivatives[9 * i + 3], *v = &derivatives[9 * i + 6];
        const double across = std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
        const float* t = &shape.tangents[4 * i];
        ASSERT_NEAR(std::hypot(t[0], t[1], t[2]), 1, 1e-5);
        ASSERT_NEAR(t[0] * n[0] + t[1] * n[1] + t[2] * n[2], 0, 1e-5);
        ASSERT_EQ(std::abs(t[3]), 1);
        skip[i] = 1;
        if (corners.count({host.places[i].face, host.places[i].u, host.places[i].v}) != 0) continue;
        if (across > 1e-3 * std::hypot(u[0], u[1], u[2]) * std::hypot(v[0], v[1], v[2]) &&
            std::min(std::hypot(u[0], u[1], u[2]), std::hypot(v[0], v[1], v[2])) > 1e-3 * shape.size) {
            skip[i] = 0;
            ASSERT_LT(degrees_between(n, &normals[3 * i]), 0.1) << "vertex " << i << " of face " << host.places[i].face
                                                                << " at " << host.places[i].u << ' ' << host.places[i].v;
        }
    }
    expect_tangents(shape, host, derivatives, normals, skip);
    expect_leaves(shape);
    for (size_t c = 0; c < shape.channels.size(); ++c) {
        HostPoints values{std::vector<double>(host.places.size() * 2), 2};
        evaluate_tessellation_channel(shape.channel_patches[c], host, shape.channel_points[c], 2, values.values);
        EXPECT_TRUE(points_match(values, DevicePoints{shape.channels[c], 0, 2}, 2e-6 * 4));
    }
}

}  // namespace limn::vk::test
