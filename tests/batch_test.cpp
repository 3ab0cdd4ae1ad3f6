// Merged tables against the tables that they were made of: the same surface to the bit, the same triangles;
// and nothing stored twice.
#include "limn/batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <set>

#include "limn/evaluate.h"
#include "limn/grid_table.h"
#include "limn/patch_tree.h"
#include "limn/tessellate.h"
#include "limn/topology.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr auto kSpacing = TessellationSpacing::integer;

ControlMesh control_mesh(const TestMesh& shape) {
    auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh) << shape.name;
    return std::move(*mesh);
}

template <class Table>
std::vector<const Table*> pointers_to(const std::vector<Table>& tables) {
    std::vector<const Table*> pointers;
    for (const Table& table : tables) pointers.push_back(&table);
    return pointers;
}

/// Plans that are equal to the bit in all tables: those that are built again differ in the last bits of a
/// double.
const PlanCache& shared_plans() {
    static const PlanCache cache;
    return cache;
}

/// Shapes with options in common, and the tables of each.
struct Crowd {
    std::vector<TestMesh> shapes;
    std::vector<PatchTable> patches;
    std::vector<TessellationTable> topologies;

    void add(const TestMesh& shape, const PlanCache* cache = &shared_plans()) {
        const ControlMesh mesh = control_mesh(shape);
        shapes.push_back(shape);
        patches.push_back(*build_patch_table<float>(mesh, {}, cache));
        topologies.push_back(*build_tessellation_table(mesh, {}));
    }
    Result<PatchBatch> merge_patches() const { return merge_patch_tables<float>(pointers_to(patches)); }
    Result<TessellationBatch> merge_topologies() const {
        return merge_tessellation_tables(pointers_to(topologies));
    }
    std::vector<double> control_points() const {
        std::vector<double> all;
        for (const TestMesh& shape : shapes)
            all.insert(all.end(), shape.positions.begin(), shape.positions.end());
        return all;
    }
};

/// All shapes, in one crowd for each choice of options.
std::vector<Crowd> all_crowds(const PlanCache* cache = &shared_plans()) {
    std::vector<Crowd> crowds;
    for (const std::vector<TestMesh>& shapes : shapes_by_options()) {
        crowds.emplace_back();
        for (const TestMesh& shape : shapes) crowds.back().add(shape, cache);
    }
    return crowds;
}

std::vector<double> points_of(const PatchTable& table, const std::vector<double>& control) {
    std::vector<double> points(size_t{3} * table.point_count());
    build_patch_points<float>(table, control, 3, points);
    return points;
}

struct Evaluated {
    std::vector<double> values;
    std::vector<SampleStatus> statuses;
};
Evaluated evaluate(const PatchTable& table, const std::vector<PatchSample>& samples,
                   const std::vector<double>& points) {
    Evaluated out{std::vector<double>(18 * samples.size()), std::vector<SampleStatus>(samples.size())};
    evaluate_patches<float>(table, samples, points, 3, Derivatives::second, out.values, out.statuses);
    return out;
}

bool same_bits(const double* a, const double* b, size_t count) {
    return std::memcmp(a, b, count * sizeof(double)) == 0;
}

/// Every mesh of the crowd, evaluated by the merged table and by its own.
void expect_same_surface(const Crowd& crowd, uint32_t rate) {
    const PatchBatch batch = *crowd.merge_patches();
    ASSERT_EQ(batch.meshes.size(), crowd.shapes.size());
    const std::vector<double> merged_points = points_of(batch.table, crowd.control_points());
    uint32_t ptex = 0;
    for (size_t m = 0; m < crowd.shapes.size(); ++m) {
        SCOPED_TRACE(crowd.shapes[m].name);
        const PatchTable& own = crowd.patches[m];
        EXPECT_EQ(batch.meshes[m].ptex_faces.first, std::exchange(ptex, ptex + own.ptex_surfaces.size()));
        EXPECT_EQ(batch.meshes[m].ptex_faces.count, own.ptex_surfaces.size());
        std::vector<PatchSample> samples =
            list_grid_samples(own.options.scheme, static_cast<uint32_t>(own.ptex_surfaces.size()), rate);
        const Evaluated alone = evaluate(own, samples, points_of(own, crowd.shapes[m].positions_double()));
        for (PatchSample& s : samples) s.face += batch.meshes[m].ptex_faces.first;
        const Evaluated merged = evaluate(batch.table, samples, merged_points);
        EXPECT_TRUE(alone.statuses == merged.statuses);
        EXPECT_TRUE(same_bits(alone.values.data(), merged.values.data(), alone.values.size()));
    }
    EXPECT_EQ(batch.table.ptex_surfaces.size(), ptex);
}

TEST(Batch, EvaluatesWhatEachMeshAloneDoes) {
    const std::vector<Crowd> crowds = all_crowds();
    EXPECT_GT(crowds.size(), 5u);
    for (const Crowd& crowd : crowds) expect_same_surface(crowd, 4);
}

TEST(Batch, RandomMeshesEvaluateAsAlone) {
    std::map<std::vector<int>, Crowd> crowds;
    for (uint64_t seed = 0; seed < 60; ++seed) {
        const TestMesh shape = random_mesh(seed + 9000);
        const SchemeOptions& o = shape.options;
        crowds[{static_cast<int>(o.scheme), static_cast<int>(o.boundary), static_cast<int>(o.creasing),
                static_cast<int>(o.triangles), o.opensubdiv_compatible}]
            .add(shape);
    }
    for (const auto& [options, crowd] : crowds) expect_same_surface(crowd, 3);
}

// Indices of 16 bits where points are few, then rings of 32 bits over control points of 16, then all of 32.
TEST(Batch, IndicesAreAsWideAsTheyMustBe) {
    Crowd crowd;
    crowd.add(make_messy_torus(12, 12, 1));
    crowd.add(make_grid(3, 3));   // no level-1 points but at the boundary
    crowd.add(make_torus(5, 4));  // none at all
    EXPECT_EQ(crowd.patches[2].refined_count, 0u);
    std::set<std::pair<bool, bool>> widths;
    for (const uint32_t copies : {1u, 80u, 500u}) {
        Crowd many;
        for (uint32_t i = 0; i < copies; ++i)
            for (size_t m = 0; m < crowd.shapes.size(); ++m) {
                many.shapes.push_back(crowd.shapes[m]);
                many.patches.push_back(crowd.patches[m]);
            }
        const PatchBatch batch = *many.merge_patches();
        EXPECT_EQ(batch.table.point_indices.narrow, batch.table.control_count <= 0x10000);
        EXPECT_EQ(batch.table.ring_points.narrow, batch.table.point_count() <= 0x10000);
        EXPECT_EQ(batch.table.first_refined % 64, 0u);
        widths.insert({batch.table.point_indices.narrow, batch.table.ring_points.narrow});
        expect_same_surface(many, 1);
    }
    EXPECT_EQ(widths.size(), 3u);
}

/// All that a plan holds: plans that it refers to by their identity.
struct PlanContents {
    std::vector<uint64_t> structure;
    std::vector<float> weights;
};
PlanContents contents_of(const PatchTable& t, uint32_t p) {
    const Plan& plan = t.plans[p];
    const auto end = [&](uint32_t Plan::*first, size_t size) {
        return p + 1 < t.plans.size() ? t.plans[p + 1].*first : size;
    };
    PlanContents out{{plan.ring_size, plan.row_count, plan.has_corner_rows}, {}};
    for (size_t i = plan.first_node; i < end(&Plan::first_node, t.plan_nodes.size()); ++i) {
        const PlanNode& node = t.plan_nodes[i];
        const bool refers = node.kind() == PlanNodeKind::plan;
        const PlanIdentity other = refers ? t.plan_identities[node.plan()] : PlanIdentity{};
        out.structure.insert(out.structure.end(), {static_cast<uint64_t>(node.kind()), node.rotation(),
                                                   node.first, other[0], other[1]});
    }
    out.structure.insert(out.structure.end(), t.plan_points.begin() + plan.first_point,
                         t.plan_points.begin() + end(&Plan::first_point, t.plan_points.size()));
    out.weights.assign(t.plan_weights.begin() + plan.first_weight,
                       t.plan_weights.begin() + end(&Plan::first_weight, t.plan_weights.size()));
    return out;
}

// In all shapes, of all options, each built without what the others know: the same identity for the same
// contents. The merged tables' are among them.
TEST(Batch, IdentitiesSayWhatPlansHold) {
    std::map<PlanIdentity, PlanContents> known;
    size_t met = 0;
    const auto look = [&](const PatchTable& table) {
        ASSERT_EQ(table.plan_identities.size(), table.plans.size());
        for (uint32_t p = 0; p < table.plans.size(); ++p, ++met) {
            const PlanContents contents = contents_of(table, p);
            const PlanContents& same = known.try_emplace(table.plan_identities[p], contents).first->second;
            EXPECT_TRUE(same.structure == contents.structure);
            ASSERT_EQ(same.weights.size(), contents.weights.size());
            for (size_t i = 0; i < same.weights.size(); ++i)
                EXPECT_NEAR(same.weights[i], contents.weights[i], 1e-6);
        }
    };
    for (const Crowd& crowd : all_crowds(nullptr)) {
        for (const PatchTable& table : crowd.patches) look(table);
        look(crowd.merge_patches()->table);
    }
    EXPECT_GT(met, 2 * known.size());
}

TEST(Batch, StoresPlansAndRunsOnce) {
    for (const Crowd& crowd : all_crowds()) {
        std::set<PlanIdentity> plans;
        std::set<std::vector<float>> runs;
        for (const PatchTable& table : crowd.patches) {
            plans.insert(table.plan_identities.begin(), table.plan_identities.end());
            for (const PointRun& run : table.point_runs) {
                const float* weights = table.point_weights.data() + run.first_weight;
                runs.emplace(weights, weights + run.entry_count);
            }
        }
        const PatchTable merged = crowd.merge_patches()->table;
        EXPECT_EQ(merged.plans.size(), plans.size());
        EXPECT_EQ(merged.point_runs.size(), runs.size());
    }
}

// What a batch holds is what one control mesh of all the meshes would.
TEST(Batch, IsAsLargeAsOneMeshOfAll) {
    Crowd crowd;
    TestMesh whole = make_globe(5, 2);
    crowd.add(whole);
    for (const TestMesh& part : {make_prism(5), make_cube(), make_globe(7, 3), make_messy_torus(8, 8, 3)}) {
        crowd.add(part);
        append(whole, part);
    }
    const PatchTable merged = crowd.merge_patches()->table;
    const PatchTable one = *build_patch_table<float>(control_mesh(whole), {});
    EXPECT_EQ(merged.point_count(), one.point_count());
    EXPECT_EQ(merged.bytes(), one.bytes());
    EXPECT_EQ(merged.plan_bytes(), one.plan_bytes());
    const auto merged_grid = *build_grid_table(merged, {.rate = 7}),
               grid = *build_grid_table(one, {.rate = 7});
    EXPECT_EQ(merged_grid.classes.size(), grid.classes.size());
    EXPECT_EQ(merged_grid.bytes(), grid.bytes());
    EXPECT_EQ(build_patch_trees(merged, {})->tree_count, build_patch_trees(one, {})->tree_count);
    const TessellationTable topology = crowd.merge_topologies()->table;
    EXPECT_EQ(topology.bytes() - topology.instance_faces.bytes(),
              build_tessellation_table(control_mesh(whole), {})->bytes());
}

TEST(Batch, MergesChannelsAndTablesInDouble) {
    std::vector<PatchTableDouble> tables;
    std::vector<double> control;
    std::vector<std::vector<double>> own_control;
    for (const TestMesh& shape : {make_torus(6, 4), make_globe(6, 3), make_prism(5)}) {
        TestMesh seamed = shape;
        add_channel(seamed, FaceVaryingInterpolation::corners_only,
                    [](uint32_t a, uint32_t b) { return (a + b) % 3 == 0; });
        const ControlMesh mesh = control_mesh(seamed);
        tables.push_back(*build_face_varying_patch_table<double>(mesh, 0, {}, &shared_plans()));
        own_control.emplace_back(seamed.channels[0].values.begin(), seamed.channels[0].values.end());
        control.insert(control.end(), own_control.back().begin(), own_control.back().end());
    }
    const PatchBatchDouble batch = *merge_patch_tables<double>(pointers_to(tables));
    const auto values_of = [](const PatchTableDouble& table, const std::vector<double>& values,
                              uint32_t first, uint32_t count) {
        std::vector<PatchSample> samples = list_grid_samples(table.options.scheme, count, 5);
        for (PatchSample& s : samples) s.face += first;
        std::vector<double> points(size_t{2} * table.point_count()), results(6 * samples.size());
        std::vector<SampleStatus> statuses(samples.size());
        build_patch_points<double>(table, values, 2, points);
        evaluate_patches<double>(table, samples, points, 2, Derivatives::first, results, statuses);
        return results;
    };
    for (size_t m = 0; m < tables.size(); ++m) {
        const BatchRange faces = batch.meshes[m].ptex_faces;
        EXPECT_TRUE(values_of(batch.table, control, faces.first, faces.count) ==
                    values_of(tables[m], own_control[m], 0, faces.count));
    }
}

/// Rates of a mesh's own edges, each its own, among those of all.
std::vector<uint32_t> rates_of_mesh(const TessellationBatchMesh& mesh, const std::vector<uint32_t>& all) {
    std::vector<uint32_t> rates;
    for (const BatchRange& edges : {mesh.mesh_edges, mesh.sub_face_edges})
        rates.insert(rates.end(), all.begin() + edges.first, all.begin() + edges.first + edges.count);
    return rates;
}

/// Triangles of a mesh, from `first` of the merged tessellation on: vertex for vertex at the same places, in
/// the same order. Returns the number of vertices.
size_t expect_same_triangles(const Tessellation& merged, size_t first, const Tessellation& alone,
                             uint32_t first_face) {
    std::vector<uint32_t> vertices(alone.vertex_count(), kInvalidIndex);
    for (size_t t = 0; t < alone.triangle_faces.size(); ++t) {
        EXPECT_EQ(merged.triangle_faces[first + t], alone.triangle_faces[t] + first_face);
        for (size_t k = 3 * t; k < 3 * t + 3; ++k) {
            uint32_t& vertex = vertices[alone.indices[k]];
            if (vertex == kInvalidIndex) vertex = merged.indices[3 * first + k];
            if (vertex != merged.indices[3 * first + k]) return ADD_FAILURE() << "triangle " << t, 0;
        }
    }
    std::vector<uint32_t> used;
    for (uint32_t v = 0; v < vertices.size(); ++v) {
        if (vertices[v] == kInvalidIndex) continue;
        used.push_back(vertices[v]);
        const PatchSample &own = alone.places[v], &place = merged.places[vertices[v]];
        EXPECT_TRUE(own.face + first_face == place.face && own.u == place.u && own.v == place.v);
        const uint32_t source = vertices[alone.position_sources[v]];
        EXPECT_TRUE(source == kInvalidIndex || merged.position_sources[vertices[v]] == source);
    }
    EXPECT_TRUE(std::is_sorted(used.begin(), used.end()));
    EXPECT_TRUE(std::adjacent_find(used.begin(), used.end()) == used.end());
    return alone.vertex_count();
}

TEST(Batch, InstancesAreTheTablesMergedAndThoseOfMergedOnes) {
    Crowd crowd;
    for (const TestMesh& shape : {make_cube(), make_prism(5), make_torus(5, 4)}) crowd.add(shape);
    const TessellationTable pair = merge_tessellation_tables(std::vector<const TessellationTable*>{
        &crowd.topologies[0], &crowd.topologies[1]})->table;
    EXPECT_EQ(pair.instance_count(), 2u);
    EXPECT_EQ(crowd.topologies[0].instance_count(), 1u);
    const TessellationTable all = merge_tessellation_tables(
        std::vector<const TessellationTable*>{&crowd.topologies[2], &pair})->table;
    const uint32_t torus = crowd.topologies[2].face_count, cube = crowd.topologies[0].face_count;
    EXPECT_EQ(std::vector<uint32_t>(all.instance_faces.begin(), all.instance_faces.end()),
              (std::vector<uint32_t>{0, torus, torus + cube, all.face_count}));
}

TEST(Batch, TessellatesAsEachMeshAlone) {
    for (const Crowd& crowd : all_crowds()) {
        const TessellationBatch batch = *crowd.merge_topologies();
        RandomNumbers random(crowd.shapes.size());
        std::vector<uint32_t> rates(batch.table.rate_edge_count);
        for (uint32_t& rate : rates) rate = (1 + random.below(6)) * shared::kRateOne;
        const Tessellation merged = *tessellate(batch.table, rates, kSpacing);
        size_t triangle = 0, vertices = 0;
        for (size_t m = 0; m < crowd.shapes.size(); ++m) {
            SCOPED_TRACE(crowd.shapes[m].name);
            const Tessellation alone =
                *tessellate(crowd.topologies[m], rates_of_mesh(batch.meshes[m], rates), kSpacing);
            vertices += expect_same_triangles(merged, triangle, alone, batch.meshes[m].ptex_faces.first);
            triangle += alone.triangle_faces.size();
        }
        EXPECT_EQ(merged.triangle_faces.size(), triangle);
        EXPECT_EQ(merged.vertex_count(), vertices);
    }
}

TEST(Batch, MeasuresTheSameRates) {
    for (const Crowd& crowd : all_crowds()) {
        const PatchBatch patches = *crowd.merge_patches();
        const TessellationBatch batch = *crowd.merge_topologies();
        const RateSettings settings = {.mode = RateMode::chord_error, .value = 1e-3f};
        const auto rates = *compute_rates(patches.table, batch.table, settings,
                                          points_of(patches.table, crowd.control_points()));
        for (size_t m = 0; m < crowd.shapes.size(); ++m)
            EXPECT_EQ(rates_of_mesh(batch.meshes[m], rates),
                      *compute_rates(crowd.patches[m], crowd.topologies[m], settings,
                                     points_of(crowd.patches[m], crowd.shapes[m].positions_double())))
                << crowd.shapes[m].name;
    }
}

/// Both merges refuse table 2 of three.
template <class Merged>
void expect_refused(const Result<Merged>& merged, ErrorCode code) {
    ASSERT_FALSE(merged);
    EXPECT_EQ(merged.error().code, code);
    EXPECT_EQ(merged.error().element, 2u);
    EXPECT_NE(merged.error().message.find("table 2"), std::string::npos) << merged.error().message;
}

TEST(Batch, RefusesWhatDoesNotAgree) {
    Crowd schemes, boundaries;
    TestMesh open = make_triangle_grid(2, 2);
    for (Crowd* crowd : {&schemes, &boundaries}) {
        crowd->add(open);
        crowd->add(open);
    }
    open.options.scheme = Scheme::loop;
    schemes.add(open);
    open.options = {.boundary = BoundaryInterpolation::edge_and_corner};
    boundaries.add(open);
    for (const Crowd* crowd : {&schemes, &boundaries}) {
        expect_refused(crowd->merge_patches(), ErrorCode::invalid_argument);
        expect_refused(crowd->merge_topologies(), ErrorCode::invalid_argument);
    }
    Crowd caps;
    for (int i = 0; i < 2; ++i) caps.add(make_cube());
    caps.patches.push_back(
        *build_patch_table<float>(control_mesh(make_cube()), {.end_cap = EndCap::gregory}));
    expect_refused(caps.merge_patches(), ErrorCode::invalid_argument);
    caps.patches[2] = caps.patches[0];
    EXPECT_TRUE(caps.merge_patches());
    caps.patches[2].plan_identities = {};
    expect_refused(caps.merge_patches(), ErrorCode::invalid_argument);
}

TEST(Batch, MergesGregoryEndCaps) {
    std::vector<PatchTable> tables;
    for (const uint32_t sides : {5u, 6u, 5u})
        tables.push_back(
            *build_patch_table<float>(control_mesh(make_prism(sides)), {.end_cap = EndCap::gregory}));
    const PatchBatch batch = *merge_patch_tables<float>(pointers_to(tables));
    EXPECT_EQ(batch.table.end_cap, EndCap::gregory);
    EXPECT_LT(batch.table.plans.size(), tables[0].plans.size() + tables[1].plans.size());
}

TEST(Batch, RefusesWhatIndicesCannotHold) {
    std::vector<PatchTable> patches(3);
    for (PatchTable& table : patches) table.control_count = 0x60000000;
    const auto merged = merge_patch_tables<float>(pointers_to(patches));
    ASSERT_FALSE(merged);
    EXPECT_EQ(merged.error().code, ErrorCode::too_large);
    std::vector<TessellationTable> topologies(2);
    for (TessellationTable& table : topologies) table.face_count = 1u << 27;
    const auto topology = merge_tessellation_tables(pointers_to(topologies));
    ASSERT_FALSE(topology);
    EXPECT_EQ(topology.error().code, ErrorCode::too_large);
}

TEST(Batch, OfNothingIsEmpty) {
    const auto patches = merge_patch_tables<float>({});
    const auto topology = merge_tessellation_tables({});
    ASSERT_TRUE(patches && topology);
    EXPECT_TRUE(patches->meshes.empty() && topology->meshes.empty());
    EXPECT_EQ(patches->table.point_count(), 0u);
    EXPECT_EQ(topology->table.face_count, 0u);
    EXPECT_EQ(topology->table.instance_count(), 0u);
}

}  // namespace
}  // namespace limn::test
