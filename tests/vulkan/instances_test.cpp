// Instances of merged tables, each in a place of its own: drawn as their meshes alone are, by a camera that sees them there.
#include <cmath>

#include "vulkan/crowd_fixture.h"

namespace limn::vk::test {
namespace {

class InstancesOnDevice : public CrowdTest {
  protected:
    void expect_instances_as_alone(const std::vector<Surfaces>& all, const Request& request);
    void expect_instances_as_alone(RateMode mode, float value);
};

/// A turn about an axis by quarters, a size and a place for each: exact in float, so that the camera that sees an instance
/// from its own coordinates is.
TessellationInstance make_instance(uint32_t i) {
    TessellationInstance instance = {};
    const float size = i % 2 == 0 ? 1.0f : 0.5f;
    const uint32_t from[3] = {i % 3, (i + 1) % 3, (i + 2) % 3};
    for (uint32_t row = 0; row < 3; ++row) instance.object_to_world[4 * row + from[row]] = size;
    instance.object_to_world[3] = static_cast<float>(i) - 1.5f;
    instance.object_to_world[11] = 0.25f * static_cast<float>(i);
    instance.value_scale = i % 2 == 0 ? 1.0f : 2.0f;
    return instance;
}

/// camera * object_to_world.
Camera camera_of(const Camera& camera, const TessellationInstance& instance) {
    Camera out = camera;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            float sum = j == 3 ? camera.matrix[12 + i] : 0;
            for (int k = 0; k < 3; ++k) sum += camera.matrix[4 * k + i] * instance.object_to_world[4 * k + j];
            out.matrix[4 * j + i] = sum;
        }
    return out;
}

/// 8 units before the origin, looking at it: coefficients that sums of a few stay exact with.
constexpr Camera kCamera = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 7, 8}, 512, 512};

/// What a mesh alone is asked for, to be drawn as instance i of all is: edges' rates and errors in the world are its own.
Request request_of(const Request& all, const TessellationInstance& instance, const TessellationBatchMesh& mesh) {
    Request own = {.settings = all.settings};
    own.settings.camera = camera_of(all.settings.camera, instance);
    own.settings.value *= instance.value_scale;
    if (all.settings.mode == RateMode::chord_error)
        own.settings.value /=
            std::abs(instance.object_to_world[0] + instance.object_to_world[1] + instance.object_to_world[2]);
    if ((instance.flags & shared::kInstanceKeepOutside) != 0) own.settings.cull_outside = false;
    if ((instance.flags & shared::kInstanceKeepBackfaces) != 0) own.settings.cull_backfaces = false;
    if (all.edge_rates.empty()) return own;
    for (const BatchRange& range : {mesh.mesh_edges, mesh.sub_face_edges})
        for (uint32_t e = range.first; e < range.first + range.count; ++e)
            own.edge_rates.push_back(all.edge_rates[e] * instance.value_scale);
    return own;
}

// Every instance, but those hidden, as its mesh alone through camera * object_to_world and with its own value; commands
// say where its triangles are, and come to all of them.
void InstancesOnDevice::expect_instances_as_alone(const std::vector<Surfaces>& all, const Request& request) {
    const Crowd crowd = merge(all);
    const Drawn merged = draw_triangles(crowd.merged, request);
    EXPECT_EQ(merged.result.status, TessellationStatus::complete);
    uint32_t triangle = 0;
    for (uint32_t i = 0; i < all.size(); ++i) {
        const bool is_hidden = (request.instances[i].flags & shared::kInstanceHidden) != 0;
        const Request own = request_of(request, request.instances[i], crowd.topologies[i]);
        const Drawn alone = is_hidden ? Drawn{} : draw_triangles(all[i], own);
        EXPECT_EQ(is_hidden, alone.result.triangle_count == 0);
        const std::vector<uint32_t> command(merged.commands.begin() + 5 * i, merged.commands.begin() + 5 * i + 5);
        EXPECT_EQ(command, (std::vector<uint32_t>{3 * alone.result.triangle_count, 1, 3 * triangle, 0, i}));
        expect_same_triangles(merged, triangle, alone, crowd.meshes[i].ptex_faces.first);
        triangle += alone.result.triangle_count;
    }
    EXPECT_EQ(triangle, merged.result.triangle_count);
}

std::vector<Surfaces> all_surfaces_of(const std::vector<TestMesh>& shapes) {
    std::vector<Surfaces> all;
    for (const TestMesh& shape : shapes) all.push_back(surfaces_of(shape, true));
    return all;
}
std::vector<Surfaces> four_meshes() {
    return all_surfaces_of(
        {limn::test::make_prism(5), limn::test::make_torus(6, 4), limn::test::make_cube(), limn::test::make_torus(20, 12)});
}

Request place_instances(RateMode mode, float value, uint32_t count) {
    Request request = {
        {.mode = mode, .value = value, .max_rate = 8, .camera = kCamera, .cull_outside = true, .cull_backfaces = true}};
    for (uint32_t i = 0; i < count; ++i) request.instances.push_back(make_instance(i));
    return request;
}

void InstancesOnDevice::expect_instances_as_alone(RateMode mode, float value) {
    const std::vector<Surfaces> all = four_meshes();
    Request request = place_instances(mode, value, 4);
    for (const uint32_t hidden : {~0u, 1u, 3u}) {
        if (hidden != ~0u) request.instances[hidden].flags |= shared::kInstanceHidden;
        expect_instances_as_alone(all, request);
    }
}

TEST_F(InstancesOnDevice, InstancesAreDrawnAsAloneInTheirPlaces) {
    expect_instances_as_alone(RateMode::uniform, 2);
    expect_instances_as_alone(RateMode::screen_length, 4);
    expect_instances_as_alone(RateMode::pixel_error, 0.1f);
    expect_instances_as_alone(RateMode::chord_error, 0.01f);
    expect_instances_as_alone(RateMode::distance, 16);
}

TEST_F(InstancesOnDevice, RatesOfEdgesAreScaledByInstance) {
    const std::vector<Surfaces> all = four_meshes();
    Request request = place_instances(RateMode::per_edge, 1, 4);
    limn::test::RandomNumbers random(3);
    for (uint32_t e = 0; e < merge(all).merged.topology.rate_edge_count; ++e)
        request.edge_rates.push_back(static_cast<float>(random.uniform(1, 4)));
    expect_instances_as_alone(all, request);
}

// In the middle of nowhere, and turned away: what the flags keep is what culling would have left out.
TEST_F(InstancesOnDevice, FlagsKeepWhatWouldBeCulled) {
    const std::vector<Surfaces> all = four_meshes();
    const Request request = place_instances(RateMode::screen_length, 4, 4);
    for (const uint32_t flag : {shared::kInstanceKeepOutside, shared::kInstanceKeepBackfaces}) {
        Request kept = request;
        for (const uint32_t i : {1u, 3u}) kept.instances[i].flags = flag;
        kept.instances[3].object_to_world[3] = 9;  // some of it outside
        expect_instances_as_alone(all, kept);
        Request culled = kept;
        for (TessellationInstance& instance : culled.instances) instance.flags = 0;
        const Surfaces merged = merge(all).merged;
        EXPECT_GT(draw_triangles(merged, kept).result.triangle_count, draw_triangles(merged, culled).result.triangle_count);
    }
}

TEST_F(InstancesOnDevice, InstancesOfTriangleMeshes) {
    std::vector<TestMesh> shapes = {limn::test::make_icosahedron(), limn::test::make_triangle_torus(8, 6),
                                    limn::test::make_octahedron()};
    for (TestMesh& shape : shapes) shape.options.scheme = Scheme::loop;
    expect_instances_as_alone(all_surfaces_of(shapes), place_instances(RateMode::screen_length, 4, 3));
}

TEST_F(InstancesOnDevice, InstancesHaveChannels) {
    std::vector<TestMesh> shapes = {limn::test::make_cube(), limn::test::make_prism(5), limn::test::make_torus(6, 4)};
    for (TestMesh& shape : shapes) {
        std::vector<uint32_t> regions;
        for (uint32_t f = 0; f < shape.face_sizes.size(); ++f) regions.push_back(f / 3);
        limn::test::add_channel_by_region(shape, FaceVaryingInterpolation::corners_only, regions);
    }
    expect_instances_as_alone(all_surfaces_of(shapes), place_instances(RateMode::screen_length, 4, 3));
}

/// A turn by any angle about a slanted axis, as a Rodrigues matrix, with a size and a place.
TessellationInstance turned_instance(double angle, double size, double x) {
    const double axis[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7}, c = std::cos(angle), s = std::sin(angle);
    TessellationInstance instance = {};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) {
            const double turn = i == j ? 0 : ((j + 3 - i) % 3 == 1 ? -1 : 1) * axis[3 - i - j];
            instance.object_to_world[4 * i + j] =
                static_cast<float>(size * ((i == j ? c : 0) + (1 - c) * axis[i] * axis[j] + s * turn));
        }
    instance.object_to_world[3] = static_cast<float>(x);
    instance.value_scale = 1;
    return instance;
}

// Rates before they are rounded: of an instance through the world, of the mesh alone through a camera that has turned.
TEST_F(InstancesOnDevice, TurnedInstancesHaveTheRatesOfTurnedCameras) {
    const std::vector<Surfaces> all = four_meshes();
    const Crowd crowd = merge(all);
    for (const auto& [mode, value] : {std::pair{RateMode::screen_length, 20.0f}, {RateMode::pixel_error, 0.5f}}) {
        Request request = place_instances(mode, value, 0);
        for (uint32_t i = 0; i < 4; ++i) request.instances.push_back(turned_instance(0.3 + i, 0.5 + 0.25 * i, 0.7 * i - 1));
        const Drawn merged = draw_triangles(crowd.merged, request);
        for (uint32_t i = 0; i < 4; ++i) {
            const TessellationBatchMesh& mesh = crowd.topologies[i];
            const Drawn alone = draw_triangles(all[i], request_of(request, request.instances[i], mesh));
            uint32_t edge = 0;
            for (const BatchRange& range : {mesh.mesh_edges, mesh.sub_face_edges})
                for (uint32_t e = range.first; e < range.first + range.count; ++e, ++edge)
                    ASSERT_NEAR(merged.targets[e], alone.targets[edge], 1e-3 * std::max(1.0f, alone.targets[edge])) << e;
            EXPECT_EQ(edge, alone.targets.size());
        }
    }
}

TEST_F(InstancesOnDevice, NothingMergedDrawsNothing) {
    const Crowd crowd = merge({});
    const Drawn drawn = draw_triangles(crowd.merged, {.instances = {make_instance(0)}});
    EXPECT_EQ(drawn.result.status, TessellationStatus::complete);
    EXPECT_EQ(drawn.result.triangle_count, 0u);
    EXPECT_TRUE(drawn.commands.empty());
}

TEST_F(InstancesOnDevice, InstancesInStorageBuffersToo) {
    pretend_gpu();
    expect_instances_as_alone(RateMode::screen_length, 4);
}

// All instances share what fits; their commands still come to what is drawn.
TEST_F(InstancesOnDevice, CapacityIsFittedAcrossInstances) {
    const Surfaces torus = surfaces_of(limn::test::make_torus(6, 4));
    const Crowd crowd = merge({torus, torus, torus});
    Request request = {{.value = 8, .max_rate = 8}};
    for (uint32_t i = 0; i < 3; ++i) request.instances.push_back(make_instance(2 * i));
    const auto scale_of = [&] {
        const Drawn drawn = draw_triangles(crowd.merged, request);
        EXPECT_EQ(drawn.commands[0] + drawn.commands[5] + drawn.commands[10], 3 * drawn.result.triangle_count);
        EXPECT_LE(drawn.result.triangle_count, request.triangle_capacity);
        EXPECT_GT(drawn.result.triangle_count, request.triangle_capacity / 2);
        return drawn.result.rate_scale;
    };
    request.triangle_capacity = 3 * 24 * 2 * 25;  // of 64 cells a face 25 or fewer
    const float all = scale_of();
    EXPECT_LT(all, 1);
    request.instances[0].flags = shared::kInstanceHidden;  // more for the others
    EXPECT_GT(scale_of(), all);
}

}  // namespace
}  // namespace limn::vk::test
