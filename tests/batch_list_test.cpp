// Crowds that change: after any changes, the tables of a crowd that was never another one.
#include "limn/batch_list.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

constexpr PatchTreeOptions kTrees = {.max_rate = 8};

struct Tables {
    PatchTable patches;
    TessellationTable topology;
};
std::vector<Tables> some_tables() {
    static const PlanCache cache;
    std::vector<TestMesh> shapes = {make_cube(), make_torus(6, 4), make_prism(5), make_globe(7, 2), make_pyramid(4)};
    for (uint64_t seed = 0; seed < 4; ++seed) shapes.push_back(make_messy_torus(6, 6, seed));
    std::vector<Tables> tables;
    for (const TestMesh& shape : shapes) {
        const auto mesh = ControlMesh::create(shape.description());
        tables.push_back({*build_patch_table<float>(*mesh, {}, &cache), *build_tessellation_table(*mesh, {})});
    }
    return tables;
}

template <class T>
void expect_same(const char* what, const Array<T>& a, const Array<T>& b) {
    ASSERT_EQ(a.size(), b.size()) << what;
    EXPECT_TRUE(a.size() == 0 || std::memcmp(a.data(), b.data(), a.bytes()) == 0) << what;
}
void expect_same(const PatchTable& a, const PatchTable& b) {
    EXPECT_EQ(a.point_count(), b.point_count());
    EXPECT_EQ(a.first_refined, b.first_refined);
    expect_same("ring points", a.ring_points.words, b.ring_points.words);
    expect_same("point indices", a.point_indices.words, b.point_indices.words);
    expect_same("point weights", a.point_weights, b.point_weights);
    expect_same("surfaces", a.surfaces, b.surfaces);
    expect_same("identities", a.plan_identities, b.plan_identities);
    expect_same("weights", a.plan_weights, b.plan_weights);
    expect_same("ptex surfaces", a.ptex_surfaces, b.ptex_surfaces);
}
void expect_same(const TessellationTable& a, const TessellationTable& b) {
    expect_same("faces", a.faces, b.faces);
    expect_same("rows", a.rows, b.rows);
    expect_same("corners", a.corners, b.corners);
    expect_same("rate edges", a.rate_edges, b.rate_edges);
    expect_same("instances", a.instance_faces, b.instance_faces);
}
void expect_same(const PatchTreeTable& a, const PatchTreeTable& b) {
    EXPECT_EQ(a.tree_count, b.tree_count);
    expect_same("nodes", a.nodes, b.nodes);
    expect_same("leaf points", a.leaf_points, b.leaf_points);
    expect_same("surfaces", a.surfaces, b.surfaces);
    expect_same("weights", a.local_points.weights, b.local_points.weights);
    expect_same("grid surfaces", a.local_points.surfaces, b.local_points.surfaces);
    EXPECT_EQ(a.local_count(), b.local_count());
}

/// What a list should hold: instances by number, and the tables of each.
using Expected = std::map<uint32_t, const Tables*>;

void expect_as_merged_afresh(const BatchList& list, const Expected& expected) {
    std::vector<const PatchTable*> patches;
    std::vector<const TessellationTable*> topologies;
    for (const auto& [id, tables] : expected) {
        patches.push_back(&tables->patches);
        topologies.push_back(&tables->topology);
    }
    const auto merged = list.merge(kTrees);
    ASSERT_TRUE(merged);
    const PatchBatch fresh = *merge_patch_tables<float>(patches);
    expect_same(merged->patches, fresh.table);
    expect_same(merged->topology, merge_tessellation_tables(topologies)->table);
    expect_same(merged->trees, *build_patch_trees(fresh.table, kTrees));
    ASSERT_EQ(merged->instances.size(), expected.size());
    size_t i = 0;
    for (const auto& [id, tables] : expected) {
        EXPECT_EQ(merged->instances[i].id, id);
        EXPECT_EQ(merged->instances[i].patches.control_points.count, tables->patches.control_count);
        EXPECT_EQ(merged->instances[i].patches.control_points.first, fresh.meshes[i].control_points.first);
        EXPECT_EQ(merged->instances[i].topology.ptex_faces.count, tables->topology.face_count);
        ++i;
    }
}

TEST(BatchList, AfterAnyChangesTablesAreThoseOfAFreshMerge) {
    const std::vector<Tables> tables = some_tables();
    for (uint64_t seed = 0; seed < 4; ++seed) {
        RandomNumbers random(seed);
        BatchList list;
        std::map<uint32_t, const Tables*> meshes;
        std::map<uint32_t, uint32_t> mesh_of_instance;
        Expected expected;
        const auto any_of = [&](const auto& map) {
            return std::next(map.begin(), random.below(static_cast<uint32_t>(map.size())))->first;
        };
        for (uint32_t step = 0; step < 40; ++step) {
            const uint32_t what = random.below(8);
            if (what < 2 || meshes.empty()) {
                const Tables& some = tables[random.below(static_cast<uint32_t>(tables.size()))];
                meshes[list.add_mesh({&some.patches, &some.topology})] = &some;
            } else if (what < 5) {
                const uint32_t mesh = any_of(meshes), id = *list.add_instance(mesh);
                mesh_of_instance[id] = mesh;
                expected[id] = meshes[mesh];
            } else if (what < 7 && !expected.empty()) {
                const uint32_t id = any_of(expected);
                EXPECT_TRUE(list.remove_instance(id));
                EXPECT_FALSE(list.remove_instance(id));
                expected.erase(id);
            } else if (what == 7) {
                const uint32_t mesh = any_of(meshes);
                EXPECT_TRUE(list.remove_mesh(mesh));
                EXPECT_FALSE(list.add_instance(mesh));
                meshes.erase(mesh);
                std::erase_if(expected, [&](const auto& entry) { return mesh_of_instance[entry.first] == mesh; });
            }
            EXPECT_EQ(list.instance_count(), expected.size());
            EXPECT_EQ(list.mesh_count(), meshes.size());
            if (step % 4 == 3) expect_as_merged_afresh(list, expected);
        }
    }
}

TEST(BatchList, BlamesNumbersThatAreNot) {
    const std::vector<Tables> tables = some_tables();
    BatchList list;
    const uint32_t mesh = list.add_mesh({&tables[0].patches, &tables[0].topology});
    for (const auto& error :
         {list.remove_mesh(mesh + 1).error(), list.add_instance(mesh + 1).error(), list.remove_instance(mesh + 1).error()}) {
        EXPECT_EQ(error.code, ErrorCode::index_out_of_range);
        EXPECT_EQ(error.element, mesh + 1);
    }
    EXPECT_EQ(*list.add_instance(mesh), 0u);
    EXPECT_EQ(*list.add_instance(mesh), 1u);
    EXPECT_TRUE(list.remove_instance(1));
    EXPECT_EQ(*list.add_instance(mesh), 2u);  // not 1 again
}

TEST(PatchTreeCache, GrowsATreeOnce) {
    const std::vector<Tables> tables = some_tables();
    const PatchTreeCache cache;
    const auto size_after = [&](const PatchTable& table, const PatchTreeOptions& options) {
        expect_same(*build_patch_trees(table, options, cache), *build_patch_trees(table, options));
        EXPECT_GT(cache.bytes(), 0u);
        return cache.size();
    };
    const uint32_t first = size_after(tables[0].patches, kTrees);
    EXPECT_GT(first, 0u);
    EXPECT_EQ(size_after(tables[0].patches, kTrees), first);
    EXPECT_EQ(size_after(tables[0].patches, {.max_rate = 5}), first);  // as deep as for 8
    EXPECT_GT(size_after(tables[0].patches, {.max_rate = 64}), first);
    const uint32_t deep = cache.size();
    EXPECT_GT(size_after(tables[0].patches, {.max_rate = 64, .relative = true}), deep);
    PatchTable bare = tables[1].patches;
    bare.plan_identities.allocate(0);
    EXPECT_EQ(build_patch_trees(bare, kTrees, cache).error().code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace limn::test
