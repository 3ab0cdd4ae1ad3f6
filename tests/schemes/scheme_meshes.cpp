#include "schemes/scheme_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

RefinedMesh from_shape(const TestMesh& shape) {
    return {shape.positions_double(), shape.face_sizes, shape.face_vertices};
}

/// Without the faces around v, and v itself.
RefinedMesh without_star(const RefinedMesh& mesh, uint32_t v) {
    RefinedMesh out;
    std::vector<uint32_t> number(mesh.vertex_count(), kInvalidIndex);
    auto begin = mesh.face_vertices.begin();
    for (const uint32_t size : mesh.face_sizes) {
        const auto end = begin + size;
        if (std::find(begin, end, v) == end) {
            out.face_sizes.push_back(size);
            out.face_vertices.insert(out.face_vertices.end(), begin, end);
        }
        begin = end;
    }
    for (uint32_t& w : out.face_vertices) {
        if (number[w] == kInvalidIndex) {
            number[w] = out.vertex_count();
            for (size_t k = 0; k < 3; ++k) out.points.push_back(mesh.points[3 * size_t{w} + k]);
        }
        w = number[w];
    }
    return out;
}

}  // namespace

const nlohmann::json& scheme_checks() {
    static const nlohmann::json checks = nlohmann::json::parse(std::ifstream(LIMN_SCHEME_CHECKS));
    return checks;
}

RefinedMesh json_mesh(const std::string& name) {
    const auto& json = scheme_checks().at("meshes").at(name);
    RefinedMesh mesh;
    for (const auto& vertex : json.at("vertices"))
        for (const auto& x : vertex) mesh.points.push_back(x.get<double>());
    for (const auto& face : json.at("faces")) {
        mesh.face_sizes.push_back(static_cast<uint32_t>(face.size()));
        for (const auto& v : face) mesh.face_vertices.push_back(v.get<uint32_t>());
    }
    return mesh;
}

ControlMesh control_mesh_of(const RefinedMesh& mesh, const SchemeOptions& options) {
    ControlMeshDescription description;
    description.options = options;
    description.vertex_count = mesh.vertex_count();
    description.face_sizes = mesh.face_sizes;
    description.face_vertices = mesh.face_vertices;
    auto control = ControlMesh::create(description);
    EXPECT_TRUE(control) << control.error().message;
    return std::move(*control);
}

RefinedMesh refine_mesh(const RefinedMesh& mesh, const SubdivisionScheme& scheme, uint32_t level,
                        const SchemeOptions& options) {
    auto refined = build_scheme_refinement<double>(control_mesh_of(mesh, options), scheme, {level});
    RefinedMesh out;
    EXPECT_TRUE(refined) << refined.error().message;
    if (!refined) return out;
    std::vector<double> points = mesh.points;
    for (const StencilTableDouble& table : refined->tables) {
        std::vector<double> next(size_t{3} * table.row_count());
        apply_stencil_table<double>(table, points, next, 3);
        points = std::move(next);
    }
    const Topology& t = refined->mesh();
    std::vector<uint32_t> number(t.vertex_count, kInvalidIndex);
    for (const uint32_t v : t.face_vertices) {
        if (number[v] == kInvalidIndex) {
            number[v] = out.vertex_count();
            for (size_t k = 0; k < 3; ++k) out.points.push_back(points[3 * size_t{v} + k]);
        }
        out.face_vertices.push_back(number[v]);
    }
    for (uint32_t f = 0; f < t.face_count; ++f) out.face_sizes.push_back(t.size_of_face(f));
    return out;
}

RefinedMesh make_regular_torus(uint32_t n, bool triangles) {
    RefinedMesh mesh;
    RandomNumbers random(n);
    for (uint32_t i = 0; i < 3 * n * n; ++i) mesh.points.push_back(random.uniform(-1, 1));
    auto at = [&](uint32_t i, uint32_t j) { return j % n * n + i % n; };
    for (uint32_t j = 0; j < n; ++j)
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            if (triangles) {
                mesh.face_sizes.insert(mesh.face_sizes.end(), {3, 3});
                mesh.face_vertices.insert(mesh.face_vertices.end(), {a, b, c, a, c, d});
            } else {
                mesh.face_sizes.push_back(4);
                mesh.face_vertices.insert(mesh.face_vertices.end(), {a, b, c, d});
            }
        }
    return mesh;
}

RefinedMesh make_irregular_mesh(const SubdivisionScheme& scheme, bool open, uint64_t seed) {
    TestMesh shape = open ? make_grid(4, 3) : make_cube();
    shape.perturb(0.3, seed);
    if (scheme.faces == FaceKind::triangles) shape.triangulate();
    if (scheme.faces == FaceKind::polygons && !open) shape = make_prism(5 + static_cast<uint32_t>(seed % 3));
    if (scheme.faces == FaceKind::polygons && open) {  // a hole in the middle, and a polygon
        shape.face_vertices.erase(shape.face_vertices.begin() + 4 * 5, shape.face_vertices.begin() + 4 * 6);
        shape.face_sizes.pop_back();
        shape.add_face({shape.face_vertices[1], shape.face_vertices[0], shape.add_vertex(0.2, -1, 0),
                        shape.add_vertex(0.5, -1.4, 0), shape.add_vertex(0.8, -1, 0)});
    }
    shape.perturb(0.2, seed + 1);
    RefinedMesh mesh = from_shape(shape);
    if (scheme.faces == FaceKind::quads && !open) mesh = refine_mesh(mesh, *find_subdivision_scheme("bilinear"), 1);
    RandomNumbers random(seed);
    for (double& x : mesh.points) x += random.uniform(-0.05, 0.05);
    return mesh;
}

RefinedMesh make_random_manifold(const SubdivisionScheme& scheme, bool open, uint64_t seed) {
    TestMesh shape = make_messy_torus(9, 7, seed);
    if (scheme.faces == FaceKind::triangles) shape.triangulate();
    RefinedMesh mesh = from_shape(shape);
    RandomNumbers random(seed);
    for (uint32_t holes = open ? 2 : 0, tries = 0; holes != 0 && tries < 100; ++tries) {
        RefinedMesh cut = without_star(mesh, random.below(mesh.vertex_count()));
        if (!build_first_stage(control_mesh_of(cut), scheme)) continue;
        mesh = std::move(cut);
        --holes;
    }
    return mesh;
}

}  // namespace limn::test
