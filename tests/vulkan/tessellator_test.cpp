// Tessellation on the device against limn::tessellate: every index, every copied bit; vertices against the same surface
// in double, which other tests compare with OpenSubdiv.
#include <algorithm>
#include <bit>
#include <cstring>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include "limn/topology.h"
#include "shapes/random_mesh.h"
#include "vulkan/device_tessellation.h"

namespace limn::vk::test {
namespace {

using limn::test::find_tessellation_fault;
using limn::test::random_rates;
using limn::test::TestMesh;

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

/// Indices and faces are the host's; vertices are where they should be.
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
        if (corners.count({host.places[i].face, host.places[i].u, host.places[i].v}) != 0) continue;
        if (across > 1e-3 * std::hypot(u[0], u[1], u[2]) * std::hypot(v[0], v[1], v[2]) &&
            std::min(std::hypot(u[0], u[1], u[2]), std::hypot(v[0], v[1], v[2])) > 1e-3 * shape.size) {
            ASSERT_LT(degrees_between(n, &normals[3 * i]), 0.1) << "vertex " << i << " of face " << host.places[i].face
                                                                << " at " << host.places[i].u << ' ' << host.places[i].v;
        }
        const float* t = &shape.tangents[4 * i];
        ASSERT_NEAR(std::hypot(t[0], t[1], t[2]), 1, 1e-5);
        ASSERT_NEAR(t[0] * n[0] + t[1] * n[1] + t[2] * n[2], 0, 1e-5);
        ASSERT_EQ(std::abs(t[3]), 1);
    }
    for (size_t c = 0; c < shape.channels.size(); ++c) {
        HostPoints values{std::vector<double>(host.places.size() * 2), 2};
        evaluate_tessellation_channel(shape.channel_patches[c], host, shape.channel_points[c], 2, values.values);
        EXPECT_TRUE(points_match(values, DevicePoints{shape.channels[c], 0, 2}, 2e-6 * 4));
    }
}

class TessellateOnDevice : public TessellatorTest, public testing::WithParamInterface<TestMesh> {};
INSTANTIATE_TEST_SUITE_P(All, TessellateOnDevice, testing::ValuesIn(limn::test::all_shapes()),
                         [](const auto& info) { return info.param.name; });

TEST_P(TessellateOnDevice, IsAsOnTheHost) {
    static uint32_t seed = 0;
    const auto spacing = static_cast<TessellationSpacing>(++seed % 3);
    TessellationRequest request = random_request(GetParam(), spacing, 9, seed);
    if (GetParam().face_count() > 500) request.vertex_capacity = request.triangle_capacity = 1 << 19;
    expect_as_on_host(tessellate_on_device(GetParam(), request), spacing);
}

}  // namespace
}  // namespace limn::vk::test
