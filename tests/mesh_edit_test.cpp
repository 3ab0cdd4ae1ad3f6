// Edited meshes: after any edits, the tables of a mesh that has been as it is now from the beginning.
#include "limn/mesh_edit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>

#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

/// A MeshEdit that owns what it refers to.
struct Edit {
    std::vector<uint32_t> faces, face_sizes, face_vertices;
    uint32_t new_vertex_count = 0;
    std::vector<uint32_t> crease_vertices, corner_vertices, holes, filled_holes;
    std::vector<float> crease_sharpness, corner_sharpness;

    MeshEdit view() const {
        return {faces,           face_sizes,       face_vertices,   new_vertex_count,
                crease_vertices, crease_sharpness, corner_vertices, corner_sharpness,
                holes,           filled_holes};
    }
    size_t new_face_count(size_t face_count) const {
        const auto is_new = [&](uint32_t f) { return f >= face_count; };
        return static_cast<size_t>(std::count_if(faces.begin(), faces.end(), is_new));
    }
    void set_face(uint32_t face, const std::vector<uint32_t>& vertices) {
        faces.push_back(face);
        face_sizes.push_back(static_cast<uint32_t>(vertices.size()));
        face_vertices.insert(face_vertices.end(), vertices.begin(), vertices.end());
    }
    void set_crease(uint32_t a, uint32_t b, float sharpness) {
        crease_vertices.insert(crease_vertices.end(), {a, b});
        crease_sharpness.push_back(sharpness);
    }
    void set_corner(uint32_t v, float sharpness) {
        corner_vertices.push_back(v);
        corner_sharpness.push_back(sharpness);
    }
};

/// What an edited mesh should be, by simpler means.
struct Model {
    struct Crease {
        uint32_t a, b;
        float sharpness;
    };
    ControlMesh mesh;  ///< for what does not change
    uint32_t vertex_count = 0;
    std::vector<std::vector<uint32_t>> faces;
    std::vector<Crease> creases;
    std::vector<std::pair<uint32_t, float>> corners;
    std::vector<uint32_t> holes;

    explicit Model(const ControlMesh& m) : mesh(m), vertex_count(m.vertex_count), holes(m.holes) {
        for (uint32_t f = 0; f < m.face_count(); ++f)
            faces.emplace_back(m.face_vertices.begin() + m.face_offsets[f],
                               m.face_vertices.begin() + m.face_offsets[f + 1]);
        for (size_t i = 0; i < m.crease_sharpness.size(); ++i)
            creases.push_back({m.crease_edges[2 * i], m.crease_edges[2 * i + 1], m.crease_sharpness[i]});
        for (size_t i = 0; i < m.corner_vertices.size(); ++i)
            corners.emplace_back(m.corner_vertices[i], m.corner_sharpness[i]);
    }

    bool has_edge(uint32_t a, uint32_t b) const {
        for (const auto& face : faces)
            for (size_t i = 0; i < face.size(); ++i) {
                const uint32_t p = face[i], q = face[(i + 1) % face.size()];
                if ((p == a && q == b) || (p == b && q == a)) return true;
            }
        return false;
    }
    void change_faces(const Edit& edit) {
        vertex_count += edit.new_vertex_count;
        faces.resize(faces.size() + edit.new_face_count(faces.size()));
        const uint32_t* vertices = edit.face_vertices.data();
        for (size_t i = 0; i < edit.faces.size(); ++i) {
            faces[edit.faces[i]].assign(vertices, vertices + edit.face_sizes[i]);
            vertices += edit.face_sizes[i];
        }
        std::vector<std::vector<uint32_t>> kept;
        std::vector<uint32_t> kept_holes, number(faces.size());
        for (size_t f = 0; f < faces.size(); ++f) {
            number[f] = static_cast<uint32_t>(kept.size());
            if (!faces[f].empty()) kept.push_back(faces[f]);
        }
        for (const uint32_t f : holes)
            if (!faces[f].empty()) kept_holes.push_back(number[f]);
        faces = std::move(kept);
        holes = std::move(kept_holes);
        std::erase_if(creases, [&](const Crease& c) { return !has_edge(c.a, c.b); });
    }
    void apply(const Edit& edit) {
        if (!edit.faces.empty() || edit.new_vertex_count != 0) change_faces(edit);
        for (size_t i = 0; i < edit.crease_sharpness.size(); ++i) {
            const uint32_t a = edit.crease_vertices[2 * i], b = edit.crease_vertices[2 * i + 1];
            const auto at = std::find_if(creases.rbegin(), creases.rend(), [&](const Crease& c) {
                return (c.a == a && c.b == b) || (c.a == b && c.b == a);
            });
            if (at == creases.rend())
                creases.push_back({a, b, edit.crease_sharpness[i]});
            else
                at->sharpness = edit.crease_sharpness[i];
        }
        for (size_t i = 0; i < edit.corner_sharpness.size(); ++i) {
            const uint32_t v = edit.corner_vertices[i];
            const auto at = std::find_if(corners.rbegin(), corners.rend(),
                                         [&](const auto& corner) { return corner.first == v; });
            if (at == corners.rend())
                corners.emplace_back(v, edit.corner_sharpness[i]);
            else
                at->second = edit.corner_sharpness[i];
        }
        for (const uint32_t f : edit.holes)
            if (std::count(holes.begin(), holes.end(), f) == 0) holes.push_back(f);
        for (const uint32_t f : edit.filled_holes) std::erase(holes, f);
    }
    ControlMesh create() const {
        std::vector<uint32_t> sizes, vertices, crease_vertices, corner_vertices;
        std::vector<float> crease_sharpness, corner_sharpness;
        for (const auto& face : faces) {
            sizes.push_back(static_cast<uint32_t>(face.size()));
            vertices.insert(vertices.end(), face.begin(), face.end());
        }
        for (const Crease& crease : creases) {
            crease_vertices.insert(crease_vertices.end(), {crease.a, crease.b});
            crease_sharpness.push_back(crease.sharpness);
        }
        for (const auto& [v, sharpness] : corners) {
            corner_vertices.push_back(v);
            corner_sharpness.push_back(sharpness);
        }
        auto made = ControlMesh::create({.options = mesh.options,
                                         .vertex_count = vertex_count,
                                         .face_sizes = sizes,
                                         .face_vertices = vertices,
                                         .crease_vertices = crease_vertices,
                                         .crease_sharpness = crease_sharpness,
                                         .corner_vertices = corner_vertices,
                                         .corner_sharpness = corner_sharpness,
                                         .holes = holes});
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        made->channels = mesh.channels;
        return std::move(*made);
    }
};

template <class T>
bool same(const Array<T>& a, const Array<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.bytes()) == 0);
}
/// The name of the first thing that differs, or "".
std::string difference(const ControlMesh& a, const ControlMesh& b) {
    if (a.vertex_count != b.vertex_count || a.face_offsets != b.face_offsets ||
        a.face_vertices != b.face_vertices)
        return "faces";
    if (a.crease_edges != b.crease_edges || a.crease_sharpness != b.crease_sharpness) return "creases";
    if (a.corner_vertices != b.corner_vertices || a.corner_sharpness != b.corner_sharpness) return "corners";
    return a.holes != b.holes ? "holes" : "";
}
std::string difference(const Topology& a, const Topology& b) {
    if (a.vertex_count != b.vertex_count || a.edge_count != b.edge_count || a.face_count != b.face_count)
        return "counts";
    if (a.face_size != b.face_size || !same(a.face_offsets, b.face_offsets)) return "sizes";
    if (!same(a.face_vertices, b.face_vertices) || !same(a.face_edges, b.face_edges)) return "faces";
    if (!same(a.edge_vertices, b.edge_vertices) || !same(a.edge_corners, b.edge_corners)) return "edges";
    if (!same(a.vertex_corners, b.vertex_corners) || !same(a.vertex_edges, b.vertex_edges)) return "stars";
    if (!same(a.edge_sharpness, b.edge_sharpness)) return "edge sharpness";
    if (!same(a.half_edge_sharpness, b.half_edge_sharpness)) return "half edge sharpness";
    if (!same(a.vertex_sharpness, b.vertex_sharpness) || !same(a.vertex_rules, b.vertex_rules))
        return "rules";
    return same(a.face_holes, b.face_holes) ? "" : "holes";
}
std::string difference(const PatchTable& a, const PatchTable& b) {
    if (a.control_count != b.control_count || a.first_refined != b.first_refined ||
        a.refined_count != b.refined_count)
        return "counts";
    if (!same(a.point_runs, b.point_runs) || !same(a.point_weights, b.point_weights)) return "point runs";
    if (a.point_indices.narrow != b.point_indices.narrow ||
        !same(a.point_indices.words, b.point_indices.words))
        return "point indices";
    if (!same(a.surfaces, b.surfaces) || !same(a.ptex_surfaces, b.ptex_surfaces)) return "surfaces";
    if (a.ring_points.narrow != b.ring_points.narrow || !same(a.ring_points.words, b.ring_points.words))
        return "rings";
    if (!same(a.plans, b.plans) || !same(a.plan_identities, b.plan_identities)) return "plans";
    return same(a.plan_nodes, b.plan_nodes) && same(a.plan_points, b.plan_points) &&
                   same(a.plan_weights, b.plan_weights)
               ? ""
               : "contents of plans";
}
std::string difference(const TessellationTable& a, const TessellationTable& b) {
    if (a.face_count != b.face_count || a.rate_edge_count != b.rate_edge_count ||
        a.row_count != b.row_count || a.corner_count != b.corner_count ||
        a.mesh_edge_count != b.mesh_edge_count)
        return "counts";
    if (!same(a.faces, b.faces) || !same(a.rows, b.rows) || !same(a.corners, b.corners)) return "contents";
    return same(a.rate_edges, b.rate_edges) && same(a.corner_copies, b.corner_copies) &&
                   same(a.row_copies, b.row_copies)
               ? ""
               : "edges and copies";
}

/// Of an edited mesh and the mesh that it should be.
std::string difference(const EditableMesh& edited, const ControlMesh& mesh,
                       const EditableMeshOptions& options, const PlanCache& cache) {
    const auto patches = build_patch_table<float>(mesh, options.patches, &cache);
    const auto tessellation = build_tessellation_table(
        mesh, {.split_creases = options.split_creases, .channels = options.channels});
    if (!patches || !tessellation) return "the mesh itself";
    if (const auto what = difference(edited.mesh(), mesh); !what.empty()) return "mesh: " + what;
    if (const auto what = difference(edited.topology(), build_topology(mesh)); !what.empty())
        return "topology: " + what;
    if (const auto what = difference(edited.patches(), *patches); !what.empty()) return "patches: " + what;
    const auto what = difference(edited.tessellation(), *tessellation);
    return what.empty() ? "" : "tessellation: " + what;
}

/// Random edits of what a model is.
struct RandomEdits {
    RandomNumbers& random;

    uint32_t any_face(const Model& model) { return random.below(static_cast<uint32_t>(model.faces.size())); }
    uint32_t any_vertex(const Model& model) {
        const auto& face = model.faces[any_face(model)];
        return face[random.below(static_cast<uint32_t>(face.size()))];
    }
    float any_sharpness() {
        const float some[] = {0, 0.4f, 1.5f, 2, kInfiniteSharpness, 12};
        return some[random.below(6)];
    }
    void add_sharpness(const Model& model, Edit& edit) {
        for (uint32_t i = random.below(3); i != 0; --i) {
            const auto& face = model.faces[any_face(model)];
            const size_t k = random.below(static_cast<uint32_t>(face.size()));
            edit.set_crease(face[k], face[(k + 1) % face.size()], any_sharpness());
        }
        if (random.chance(0.3)) edit.set_corner(any_vertex(model), any_sharpness());
        if (random.chance(0.3)) edit.holes.push_back(any_face(model));
        if (random.chance(0.3)) edit.filled_holes.push_back(any_face(model));
        if (!model.holes.empty() && random.chance(0.3)) edit.filled_holes.push_back(model.holes[0]);
    }
    /// Of one face that has not been changed yet: gone, cut in two, wound differently, with a vertex of its
    /// own or another's, or with a new face beside it.
    void add_face_change(const Model& model, Edit& edit) {
        const uint32_t f = any_face(model);
        if (std::count(edit.faces.begin(), edit.faces.end(), f) != 0) return;
        std::vector<uint32_t> face = model.faces[f];
        const auto size = static_cast<uint32_t>(face.size());
        const auto new_face = [&] {
            return static_cast<uint32_t>(model.faces.size() + edit.new_face_count(model.faces.size()));
        };
        const auto new_vertex = [&] { return model.vertex_count + edit.new_vertex_count++; };
        const bool triangles = model.mesh.options.scheme == Scheme::loop;
        switch (random.below(7)) {
            case 0:
                return edit.set_face(f, {});
            case 1:
                if (size < 4) return edit.set_face(f, {});
                edit.set_face(f, {face[0], face[1], face[2]});
                face.erase(face.begin() + 1);
                return edit.set_face(new_face(), face);
            case 2:
                std::reverse(face.begin(), face.end());
                return edit.set_face(f, face);
            case 3:
                face[random.below(size)] = new_vertex();
                return edit.set_face(f, face);
            case 4:
                face[random.below(size)] = any_vertex(model);
                return edit.set_face(f, face);
            case 5:
                std::rotate(face.begin(), face.begin() + 1, face.end());
                return edit.set_face(f, face);
            default:
                if (triangles || random.chance(0.3))
                    return edit.set_face(new_face(), {face[1], face[0], new_vertex()});
                const uint32_t a = new_vertex(), b = new_vertex();
                return edit.set_face(new_face(), {face[1], face[0], a, b});
        }
    }
    /// Faces, and sharpness of what they become.
    Edit any(const Model& model, bool with_faces) {
        Edit edit;
        Model after = model;
        if (with_faces) {
            for (uint32_t i = 1 + random.below(3); i != 0; --i) add_face_change(model, edit);
            after.change_faces(edit);
            if (after.faces.empty()) return {};
        }
        if (!with_faces || random.chance(0.5)) add_sharpness(after, edit);
        return edit;
    }
};

size_t largest_valence(const ControlMesh& mesh) {
    std::vector<size_t> corners(mesh.vertex_count, 0);
    for (const uint32_t v : mesh.face_vertices) ++corners[v];
    return *std::max_element(corners.begin(), corners.end());
}

/// Edits a mesh again and again; the first difference, or "". Plans take the time: they are not what is
/// tested here.
std::string edit_and_compare(const ControlMesh& mesh, EditableMeshOptions options, uint32_t steps,
                             double faces, uint64_t seed) {
    options.patches.plan_depth = 1;
    // A plan beside a sharp vertex of valence 720 takes 35 MB, and random edits make many: by varying rules,
    // none.
    if (largest_valence(mesh) > 100) options.patches.interpolation = Interpolation::varying;
    RandomNumbers random(seed);
    RandomEdits edits{random};
    const PlanCache cache;
    auto edited = EditableMesh::create(mesh, options, &cache);
    if (!edited) return edited.error().message;
    Model model(mesh);
    if (const auto what = difference(*edited, mesh, options, cache); !what.empty())
        return "at first, " + what;
    for (uint32_t step = 0; step < steps; ++step) {
        const Edit edit = edits.any(model, random.chance(faces));
        const auto work = edited->edit(edit.view());
        if (!work) return "step " + std::to_string(step) + ": " + work.error().message;
        model.apply(edit);
        const auto what = difference(*edited, model.create(), options, cache);
        if (!what.empty()) return "step " + std::to_string(step) + ", " + what;
    }
    return "";
}

ControlMesh control_mesh(const TestMesh& mesh) {
    auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control) << mesh.name;
    return std::move(*control);
}
/// Shapes that have equal options, as one mesh of many chunks.
ControlMesh joined(const std::vector<TestMesh>& shapes) {
    TestMesh all = shapes[0];
    all.channels.clear();
    all.left_handed = false;
    for (size_t i = 1; i < shapes.size(); ++i) append(all, shapes[i]);
    return control_mesh(all);
}
TestMesh without_channels(TestMesh mesh) {
    mesh.channels.clear();
    return mesh;
}

TEST(MeshEdit, TablesAreThoseOfAFreshBuildWhateverGetsSharp) {
    for (const TestMesh& shape : all_shapes()) {
        EditableMeshOptions options;
        for (uint32_t i = 0; i < shape.channels.size(); ++i) options.channels.push_back(i);
        EXPECT_EQ(edit_and_compare(control_mesh(shape), options, 4, 0, 1), "") << shape.name;
    }
}

TEST(MeshEdit, TablesAreThoseOfAFreshBuildWhateverFacesChange) {
    for (const TestMesh& shape : all_shapes())
        EXPECT_EQ(edit_and_compare(control_mesh(without_channels(shape)), {}, 4, 0.8, 2), "") << shape.name;
}

TEST(MeshEdit, AndSoAreThoseOfMeshesOfManyParts) {
    uint64_t seed = 0;
    for (const auto& shapes : shapes_by_options())
        EXPECT_EQ(edit_and_compare(joined(shapes), {}, 8, 0.5, ++seed), "") << shapes[0].name;
}

TEST(MeshEdit, AndSoAreThoseOfRandomMeshes) {
    for (uint64_t seed = 0; seed < 200; ++seed) {
        const TestMesh mesh = without_channels(random_mesh(seed));
        EditableMeshOptions options;
        if (seed % 3 == 1) options.patches.interpolation = Interpolation::varying;
        if (seed % 3 == 2) options.patches = {.end_cap = EndCap::gregory, .isolation_level = 2};
        options.split_creases = seed % 2 == 0;
        EXPECT_EQ(edit_and_compare(control_mesh(mesh), options, 6, 0.5, seed), "") << "seed " << seed;
    }
}

/// Quads alone, most of them regular, with two creases.
TestMesh make_creased_grid() {
    constexpr uint32_t kColumns = 20, kRows = 16;
    TestMesh mesh = make_grid(kColumns, kRows);
    for (uint32_t row = 0; row < kRows; ++row)
        for (const uint32_t column : {6u, 13u}) {
            const uint32_t v = row * (kColumns + 1) + column;
            mesh.add_crease(v, v + kColumns + 1, column == 6 ? 2.5 : kInfiniteSharpness);
        }
    return mesh;
}

TEST(MeshEdit, AndSoAreThoseOfLargerMeshesWithAnyOptions) {
    uint64_t seed = 0;
    for (const auto boundary : {BoundaryInterpolation::none, BoundaryInterpolation::edge_only,
                                BoundaryInterpolation::edge_and_corner})
        for (const auto creasing : {CreasingMethod::uniform, CreasingMethod::chaikin}) {
            TestMesh meshes[] = {make_messy_torus(24, 20, ++seed), make_creased_grid(),
                                 make_triangle_torus(20, 16)};
            meshes[2].options.scheme = Scheme::loop;
            for (TestMesh& mesh : meshes) {
                mesh.options.boundary = boundary;
                mesh.options.creasing = creasing;
                EXPECT_EQ(edit_and_compare(control_mesh(mesh), {}, 30, 0.5, seed), "") << "seed " << seed;
            }
        }
}

/// Indices take 16 bits where all fit: here none do. What stays in place is not written again; what moves is.
TEST(MeshEdit, AndSoAreThoseOfMeshesOfMorePointsThan16BitsTell) {
    TestMesh mesh = make_torus(300, 240);
    RandomNumbers random(1);
    for (uint32_t i = 0; i < 300; ++i) {
        const uint32_t c = 4 * random.below(mesh.face_count());
        mesh.add_crease(mesh.face_vertices[c], mesh.face_vertices[c + 1],
                        i % 3 == 0 ? kInfiniteSharpness : 1.5);
    }
    EXPECT_EQ(edit_and_compare(control_mesh(mesh), {}, 8, 0, 1), "");
    EXPECT_EQ(edit_and_compare(control_mesh(mesh), {}, 8, 0.7, 2), "");
}

/// With Chaikin creasing, what an edge of a chain gets changes its neighbours in the chain, and what touches
/// those: also where that is in another part of the mesh.
TEST(MeshEdit, ChaikinCreasesReachOneEdgeFurther) {
    constexpr uint32_t kColumns = 20, kRows = 16;
    TestMesh mesh = make_grid(kColumns, kRows);
    mesh.options.creasing = CreasingMethod::chaikin;
    const auto vertex = [](uint32_t row, uint32_t column) { return row * (kColumns + 1) + column; };
    for (uint32_t row = 0; row < kRows; ++row)
        for (uint32_t column = 1; column < kColumns; ++column)
            mesh.add_crease(vertex(row, column), vertex(row + 1, column), 2.5);
    const PlanCache cache;
    auto edited = EditableMesh::create(control_mesh(mesh), {}, &cache);
    ASSERT_TRUE(edited);
    Model model(control_mesh(mesh));
    for (uint32_t row = 0; row < kRows; ++row)
        for (const uint32_t column : {3u, 9u, 15u}) {
            Edit edit;
            edit.set_crease(vertex(row, column), vertex(row + 1, column), 1.5f);
            ASSERT_TRUE(edited->edit(edit.view()));
            model.apply(edit);
            ASSERT_EQ(difference(*edited, model.create(), {}, cache), "") << row << " " << column;
        }
}

TEST(MeshEdit, TouchesOnlyWhatLiesAround) {
    const ControlMesh mesh = control_mesh(make_messy_torus(80, 60, 1));
    auto edited = EditableMesh::create(mesh, {});
    ASSERT_TRUE(edited);
    Edit crease;
    crease.set_crease(mesh.face_vertices[0], mesh.face_vertices[1], 1.5f);
    auto work = edited->edit(crease.view());
    ASSERT_TRUE(work);
    EXPECT_FALSE(work->tessellation);
    EXPECT_GT(work->face_count, 0u);
    EXPECT_LE(work->face_count, mesh.face_count() / 6);
    crease.crease_sharpness = {kInfiniteSharpness};
    work = edited->edit(crease.view());
    ASSERT_TRUE(work);
    EXPECT_TRUE(work->tessellation);
    Edit face;
    face.set_face(mesh.face_count() / 2, {});
    work = edited->edit(face.view());
    ASSERT_TRUE(work);
    EXPECT_LE(work->face_count, mesh.face_count() / 6);
}

/// The edit fails so, and nothing has changed.
void expect_refused(EditableMesh& edited, const Edit& edit, ErrorCode code, uint64_t element,
                    const PlanCache& cache) {
    const ControlMesh before = edited.mesh();
    const auto work = edited.edit(edit.view());
    ASSERT_FALSE(work);
    EXPECT_EQ(work.error().code, code) << work.error().message;
    EXPECT_TRUE(element == kNoElement || work.error().element == element) << work.error().message;
    EXPECT_EQ(difference(edited, before, {}, cache), "") << work.error().message;
}

TEST(MeshEdit, ErrorsLeaveEverythingAsItWas) {
    const PlanCache cache;
    TestMesh shape = make_messy_torus(8, 8, 3);
    shape.add_corner(3, 2);
    shape.holes = {5};
    const ControlMesh mesh = control_mesh(shape);
    auto edited = EditableMesh::create(mesh, {}, &cache);
    ASSERT_TRUE(edited);
    const auto& vertices = mesh.face_vertices;
    const uint32_t faces = mesh.face_count();
    const auto refused = [&](const auto& make, ErrorCode code, uint64_t element = kNoElement) {
        Edit edit;  // a good part before the bad one
        edit.set_crease(vertices[0], vertices[1], 2);
        edit.set_corner(7, 3);
        edit.holes = {1};
        make(edit);
        expect_refused(*edited, edit, code, element, cache);
    };
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    refused([&](Edit& e) { e.set_crease(0, mesh.vertex_count, 1); }, ErrorCode::index_out_of_range, 1);
    refused([&](Edit& e) { e.set_crease(vertices[0], vertices[0], 1); }, ErrorCode::missing_edge, 1);
    refused([&](Edit& e) { e.set_crease(vertices[0], vertices[1], -1); }, ErrorCode::invalid_sharpness, 1);
    refused([&](Edit& e) { e.set_crease(vertices[0], vertices[1], kNan); }, ErrorCode::invalid_sharpness, 1);
    refused([&](Edit& e) { e.set_corner(mesh.vertex_count, 1); }, ErrorCode::index_out_of_range, 1);
    refused([&](Edit& e) { e.set_corner(0, kNan); }, ErrorCode::invalid_sharpness, 1);
    refused([&](Edit& e) { e.holes.push_back(faces); }, ErrorCode::index_out_of_range, 1);
    refused([&](Edit& e) { e.filled_holes.push_back(faces); }, ErrorCode::index_out_of_range, 0);
    refused([&](Edit& e) { e.crease_sharpness.pop_back(); }, ErrorCode::invalid_argument);
    refused([&](Edit& e) { e.set_face(2, {0, 1}); }, ErrorCode::face_too_small, 0);
    refused([&](Edit& e) { e.set_face(faces, {}); }, ErrorCode::face_too_small, 0);
    refused([&](Edit& e) { e.set_face(faces + 1, {0, 1, 2}); }, ErrorCode::invalid_argument);
    refused([&](Edit& e) { e.set_face(2, {0, 1, mesh.vertex_count}); }, ErrorCode::index_out_of_range, 0);
    refused([&](Edit& e) { e.face_vertices = {0}; }, ErrorCode::invalid_argument);
    refused([&](Edit& e) { e.new_vertex_count = 0x80000000; }, ErrorCode::too_large);
    refused(
        [&](Edit& e) {
            e.set_face(2, {});
            e.set_face(2, {});
        },
        ErrorCode::invalid_argument);
    refused(
        [&](Edit& e) {
            for (uint32_t f = 0; f < faces; ++f) e.set_face(f, {});
        },
        ErrorCode::invalid_argument);
    refused(
        [&](Edit& e) {  // between vertices that no face joins
            e.set_face(faces, {vertices[0], vertices[1], mesh.vertex_count});
            e.new_vertex_count = 2;
            e.set_crease(vertices[0], mesh.vertex_count + 1, 1);
        },
        ErrorCode::missing_edge, 1);
}

TEST(MeshEdit, WhatPlansCannotBeMadeOfIsTakenBack) {
    const PlanCache cache;
    TestMesh star = make_triangle_star(2100, 1);  // more than 4,096 points around one face
    for (uint32_t f = 0; f < star.face_count(); ++f) star.holes.push_back(f);
    auto edited = EditableMesh::create(control_mesh(star), {}, &cache);
    ASSERT_TRUE(edited) << edited.error().message;
    Edit fill;
    fill.set_crease(star.face_vertices[0], star.face_vertices[1], 1);
    fill.set_corner(4, 1);
    fill.filled_holes = {7};
    expect_refused(*edited, fill, ErrorCode::unsupported, kNoElement, cache);
    fill.set_face(9, {});
    expect_refused(*edited, fill, ErrorCode::unsupported, kNoElement, cache);
    fill.filled_holes = {};
    ASSERT_TRUE(edited->edit(fill.view()));
    Model model(control_mesh(star));
    model.apply(fill);
    EXPECT_EQ(difference(*edited, model.create(), {}, cache), "");
}

TEST(MeshEdit, FacesOfMeshesWithChannelsAreNotChanged) {
    for (const TestMesh& shape : face_varying_shapes()) {
        const PlanCache cache;
        auto edited = EditableMesh::create(control_mesh(shape), {}, &cache);
        ASSERT_TRUE(edited);
        Edit edit;
        edit.set_face(0, {});
        expect_refused(*edited, edit, ErrorCode::unsupported, kNoElement, cache);
    }
}

}  // namespace
}  // namespace limn::test
