// Crowds that change in place: after any changes, what each instance has is to the bit what a fresh merge
// gives it.
#include "limn/crowd.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "limn/tessellate.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

struct MeshTables {
    PatchTable patches;
    TessellationTable topology;
    std::vector<float> positions;
    BatchMesh batch_mesh() const { return {&patches, &topology}; }
};

MeshTables build_tables(const TestMesh& shape) {
    static const PlanCache cache;
    const auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh) << shape.name;
    return {*build_patch_table<float>(*mesh, {}, &cache), *build_tessellation_table(*mesh, {}),
            shape.positions};
}

std::vector<MeshTables> some_meshes() {
    std::vector<TestMesh> shapes = {
        make_cube(),     make_torus(6, 4), make_prism(5), make_globe(7, 2),
        make_pyramid(4), make_globe(70, 2)};  // the last has level-1 points of more than 64 entries
    for (uint64_t seed = 0; seed < 4; ++seed) shapes.push_back(make_messy_torus(6, 6, seed));
    std::vector<MeshTables> tables;
    for (const TestMesh& shape : shapes) tables.push_back(build_tables(shape));
    return tables;
}

/// A tessellation by the error of its chords, evaluated.
struct Evaluated {
    std::vector<double> points;
    Tessellation triangles;
    std::vector<double> positions, normals;
};

Evaluated evaluate(const PatchTable& patches, const TessellationTable& topology,
                   const std::vector<double>& control) {
    Evaluated out;
    out.points.resize(size_t{3} * patches.point_count());
    build_patch_points(patches, control, 3, out.points);
    const auto rates = compute_rates(
        patches, topology, {.mode = RateMode::chord_error, .value = 0.02f, .max_rate = 8}, out.points);
    out.triangles = *tessellate(topology, *rates, TessellationSpacing::integer);
    out.positions.resize(size_t{3} * out.triangles.vertex_count());
    out.normals.resize(out.positions.size());
    evaluate_tessellation(patches, out.triangles, out.points, out.positions, out.normals);
    return out;
}

/// Triangles of the faces in a range, in their order.
std::vector<size_t> triangles_of(const Evaluated& e, BatchRange faces) {
    std::vector<size_t> out;
    for (size_t t = 0; t < e.triangles.triangle_faces.size(); ++t)
        if (const uint32_t face = e.triangles.triangle_faces[t];
            face >= faces.first && face - faces.first < faces.count)
            out.push_back(t);
    return out;
}

/// The same triangles, over vertices that they share in the same way, with the same bits.
testing::AssertionResult are_alike(const Evaluated& a, BatchRange a_faces, const Evaluated& b,
                                   BatchRange b_faces) {
    const std::vector<size_t> a_triangles = triangles_of(a, a_faces), b_triangles = triangles_of(b, b_faces);
    if (a_triangles.size() != b_triangles.size())
        return testing::AssertionFailure() << a_triangles.size() << " triangles, and " << b_triangles.size();
    std::map<uint32_t, uint32_t> to, back;
    for (size_t i = 0; i < a_triangles.size(); ++i) {
        if (a.triangles.triangle_faces[a_triangles[i]] - a_faces.first !=
            b.triangles.triangle_faces[b_triangles[i]] - b_faces.first)
            return testing::AssertionFailure() << "triangle " << i << " is of another face";
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = a.triangles.indices[3 * a_triangles[i] + k],
                           w = b.triangles.indices[3 * b_triangles[i] + k];
            if (to.try_emplace(v, w).first->second != w || back.try_emplace(w, v).first->second != v)
                return testing::AssertionFailure()
                       << "vertices " << v << " and " << w << " are shared in other ways";
            if (std::memcmp(&a.positions[3 * v], &b.positions[3 * w], 24) != 0 ||
                std::memcmp(&a.normals[3 * v], &b.normals[3 * w], 24) != 0)
                return testing::AssertionFailure() << "vertices " << v << " and " << w << " differ";
        }
    }
    return testing::AssertionSuccess();
}

/// What a crowd should hold: the mesh of each instance, and how far it is moved.
struct Expected {
    const MeshTables* mesh;
    float shift;
};
using Instances = std::map<uint32_t, Expected>;

void put_points(const Expected& instance, uint32_t first, std::vector<double>& control) {
    for (size_t i = 0; i < instance.mesh->positions.size(); ++i)
        control[3 * size_t{first} + i] = instance.mesh->positions[i] + instance.shift;
}

void expect_as_merged_afresh(const Crowd& crowd, const Instances& instances) {
    ASSERT_EQ(crowd.instance_count(), instances.size());
    if (instances.empty()) return;
    std::vector<const PatchTable*> patches;
    std::vector<const TessellationTable*> topologies;
    for (const auto& [number, instance] : instances) {
        patches.push_back(&instance.mesh->patches);
        topologies.push_back(&instance.mesh->topology);
    }
    const PatchBatch merged = *merge_patch_tables<float>(patches);
    const TessellationBatch topology = *merge_tessellation_tables(topologies);
    std::vector<double> control(size_t{3} * crowd.patches().control_count),
        merged_control(size_t{3} * merged.table.control_count);
    size_t i = 0;
    for (const auto& [number, instance] : instances) {
        ASSERT_NE(crowd.find(number), nullptr);
        put_points(instance, crowd.find(number)->patches.control_points.first, control);
        put_points(instance, merged.meshes[i++].control_points.first, merged_control);
    }
    const Evaluated own = evaluate(crowd.patches(), crowd.topology(), control),
                    fresh = evaluate(merged.table, topology.table, merged_control);
    EXPECT_EQ(own.triangles.indices.size(), fresh.triangles.indices.size());
    i = 0;
    for (const auto& [number, instance] : instances) {
        const BatchRange faces = crowd.find(number)->patches.ptex_faces,
                         fresh_faces = merged.meshes[i++].ptex_faces;
        ASSERT_TRUE(are_alike(own, faces, fresh, fresh_faces)) << "instance " << number;
        const TessellationTable& table = crowd.topology();
        const auto at = std::find(table.instance_numbers.begin(), table.instance_numbers.end(), number);
        const size_t place = static_cast<size_t>(at - table.instance_numbers.begin());
        ASSERT_LT(place, table.instance_count());
        EXPECT_EQ(table.instance_faces[place], faces.first);
        EXPECT_GE(table.instance_faces[place + 1], faces.first + faces.count);
    }
}

TEST(Crowd, AfterAnyChangesInstancesAreAsMergedAfresh) {
    const std::vector<MeshTables> meshes = some_meshes();
    for (uint64_t seed = 0; seed < 3; ++seed) {
        RandomNumbers random(seed);
        Crowd crowd({.max_rate = 8, .reserve = seed == 2 ? 0.0f : 0.5f});
        Instances instances;
        for (uint32_t step = 0; step < 60; ++step) {
            SCOPED_TRACE(step);
            if (random.below(5) < 3 || instances.empty()) {
                std::vector<BatchMesh> added;
                std::vector<const MeshTables*> tables;
                for (uint32_t n = 1 + random.below(3); n-- != 0;) {
                    tables.push_back(&meshes[random.below(static_cast<uint32_t>(meshes.size()))]);
                    added.push_back(tables.back()->batch_mesh());
                }
                const auto numbers = crowd.add(added);
                ASSERT_TRUE(numbers);
                for (size_t i = 0; i < added.size(); ++i) {
                    ASSERT_FALSE(instances.contains((*numbers)[i]));
                    instances[(*numbers)[i]] = {tables[i], static_cast<float>(step)};
                }
            } else {
                const auto at =
                    std::next(instances.begin(), random.below(static_cast<uint32_t>(instances.size())));
                EXPECT_TRUE(crowd.remove(at->first));
                EXPECT_EQ(crowd.remove(at->first).error().code, ErrorCode::index_out_of_range);
                instances.erase(at);
            }
            if (step % 5 == 4) expect_as_merged_afresh(crowd, instances);
        }
        EXPECT_LT(crowd.layout(), seed == 2 ? 60u : 20u);
    }
}

TEST(Crowd, ASmallChangeIsSmallAndMovesNothing) {
    const std::vector<MeshTables> meshes = some_meshes();
    Crowd crowd({.max_rate = 8});
    std::vector<BatchMesh> many;
    for (uint32_t i = 0; i < 200; ++i) many.push_back(meshes[i % meshes.size()].batch_mesh());
    ASSERT_TRUE(crowd.add(many));
    EXPECT_EQ(crowd.changed_bytes(), 0u);
    const uint64_t layout = crowd.layout();
    const CrowdInstance before = *crowd.find(7);
    ASSERT_TRUE(crowd.remove(20));
    EXPECT_EQ(*crowd.add(many[20]), 20u);
    EXPECT_EQ(crowd.layout(), layout);
    EXPECT_EQ(std::memcmp(&before, crowd.find(7), sizeof before), 0);
    EXPECT_GT(crowd.changed_bytes(), 0u);
    EXPECT_LT(crowd.changed_bytes(), crowd.bytes() / 50);
    crowd.forget_changes();
    EXPECT_EQ(crowd.changed_bytes(), 0u);
}

TEST(Crowd, CompactsWhatIsLeft) {
    const std::vector<MeshTables> meshes = some_meshes();
    Crowd crowd({.max_rate = 8});
    std::vector<BatchMesh> many;
    Instances instances;
    for (uint32_t i = 0; i < 60; ++i) many.push_back(meshes[i % meshes.size()].batch_mesh());
    const std::vector<uint32_t> numbers = *crowd.add(many);
    for (uint32_t i = 0; i < 60; ++i) {
        if (i % 6 == 0)
            instances[numbers[i]] = {&meshes[i % meshes.size()], static_cast<float>(i)};
        else
            ASSERT_TRUE(crowd.remove(numbers[i]));
    }
    expect_as_merged_afresh(crowd, instances);
    const size_t surfaces = crowd.patches().surfaces.size();
    ASSERT_TRUE(crowd.compact());
    EXPECT_EQ(crowd.layout(), 2u);
    EXPECT_LT(crowd.patches().surfaces.size(), surfaces / 3);
    expect_as_merged_afresh(crowd, instances);
}

TEST(Crowd, RefusesWhatDoesNotBelongAndStaysAsItWas) {
    const std::vector<MeshTables> meshes = some_meshes();
    const MeshTables loop = build_tables(shapes_of(Scheme::loop)[0]);
    Crowd crowd({.max_rate = 8});
    Instances instances;
    for (const MeshTables& mesh : {std::cref(meshes[0]), std::cref(meshes[6])})
        instances[*crowd.add(mesh.batch_mesh())] = {&mesh, 1};
    const BatchMesh mixed[] = {meshes[1].batch_mesh(), loop.batch_mesh()};
    const auto refused = crowd.add(mixed);
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(refused.error().element, 1u);
    MeshTables bare = build_tables(make_prism(5));
    bare.patches.plan_identities.allocate(0);
    EXPECT_EQ(crowd.add(bare.batch_mesh()).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(crowd.remove(5).error().element, 5u);
    expect_as_merged_afresh(crowd, instances);

    Crowd tiny({.max_rate = 64, .max_weight_bytes = 20'000});
    EXPECT_EQ(tiny.add(meshes[7].batch_mesh()).error().code, ErrorCode::too_large);
    EXPECT_EQ(tiny.instance_count(), 0u);
    EXPECT_EQ(Crowd({.max_rate = 1}).add(meshes[0].batch_mesh()).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(Crowd({.points_per_pass = 0}).add(meshes[0].batch_mesh()).error().code,
              ErrorCode::invalid_argument);
    EXPECT_EQ(Crowd({.reserve = -1}).add(meshes[0].batch_mesh()).error().code, ErrorCode::invalid_argument);
}

// Holes, creases, larger faces, boundaries, what is no manifold, triangles.
TEST(Crowd, OfAnyOptions) {
    for (const std::vector<TestMesh>& alike : shapes_by_options()) {
        std::vector<MeshTables> meshes;
        for (const TestMesh& shape : alike) meshes.push_back(build_tables(shape));
        Crowd crowd({.max_rate = 8});
        Instances instances;
        uint32_t last = 0;
        for (uint32_t i = 0; i < meshes.size() + 4; ++i) {
            if (i % 3 == 2) {
                ASSERT_TRUE(crowd.remove(last));
                instances.erase(last);
            }
            const MeshTables& mesh = meshes[i % meshes.size()];
            last = *crowd.add(mesh.batch_mesh());
            instances[last] = {&mesh, 0};
        }
        SCOPED_TRACE(alike[0].name);
        expect_as_merged_afresh(crowd, instances);
    }
}

}  // namespace
}  // namespace limn::test
