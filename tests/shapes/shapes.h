// Control meshes that tests share: one for every kind of neighbourhood that subdivision treats differently.
// All are made by the generators below; coordinates are perturbed so that symmetric mistakes do not cancel.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "limn/control_mesh.h"

namespace limn::test {

struct TestChannel {
    uint32_t value_count = 0;
    std::vector<uint32_t> face_values;  // one per face corner
    FaceVaryingInterpolation interpolation = FaceVaryingInterpolation::all;
    std::vector<float> values;  // 2 per value
};

struct TestMesh {
    std::string name;
    SchemeOptions options;
    uint32_t vertex_count = 0;
    std::vector<float> positions;  // 3 per vertex; float so that every consumer starts from the same numbers
    std::vector<uint32_t> face_sizes;
    std::vector<uint32_t> face_vertices;
    std::vector<uint32_t> creases;  // pairs of vertices
    std::vector<float> crease_sharpness;
    std::vector<uint32_t> corners;
    std::vector<float> corner_sharpness;
    std::vector<uint32_t> holes;
    std::vector<TestChannel> channels;
    bool left_handed = false;

    uint32_t face_count() const { return static_cast<uint32_t>(face_sizes.size()); }
    std::vector<double> positions_double() const { return {positions.begin(), positions.end()}; }
    // Largest side of the bounding box of the vertices.
    double size() const;
    // The largest sharpness that is not infinite, of edges and vertices.
    float max_finite_sharpness() const;
    // Views into this mesh: valid while it lives and stays unchanged.
    ControlMeshDescription description() const;

    // Building blocks.
    uint32_t add_vertex(double x, double y, double z);
    void add_face(std::initializer_list<uint32_t> vertices);
    void add_face(const std::vector<uint32_t>& vertices);
    void add_crease(uint32_t a, uint32_t b, double sharpness);
    void add_crease_path(const std::vector<uint32_t>& path, double sharpness);
    void add_corner(uint32_t vertex, double sharpness);
    bool has_edge(uint32_t a, uint32_t b) const;
    // Moves every coordinate by at most `amount`, differently for each vertex and seed.
    void perturb(double amount, uint64_t seed = 1);
    // Each face becomes triangles: a fan around its first corner.
    void triangulate();

  private:
    mutable std::vector<FaceVaryingDescription> channel_views_;
};

// A face-varying channel cut along the edges for which `is_seam(a, b)` holds: one value for every group of
// corners of a vertex that edges other than seams join.
using SeamPredicate = std::function<bool(uint32_t a, uint32_t b)>;
void add_channel(TestMesh& mesh, FaceVaryingInterpolation interpolation, const SeamPredicate& is_seam);
// Cut wherever two faces of different regions meet; regions[f] is the region of face f.
void add_channel_by_region(TestMesh& mesh, FaceVaryingInterpolation interpolation,
                           const std::vector<uint32_t>& regions);

// Generators. Faces are counter-clockwise seen from outside (or above); nothing is sharp; the default
// options.
TestMesh make_cube();
TestMesh make_tetrahedron();
TestMesh make_octahedron();
TestMesh make_icosahedron();
// (columns + 1) * (rows + 1) vertices, row by row.
TestMesh make_grid(uint32_t columns, uint32_t rows);
TestMesh make_triangle_grid(uint32_t columns, uint32_t rows);
TestMesh make_torus(uint32_t around, uint32_t across);
TestMesh make_triangle_torus(uint32_t around, uint32_t across);
// `valence` sectors around vertex 0, `rings` rings of quads (a disk). Vertex of sector s, i steps along ray s
// and j towards ray s + 1 as in sectors of a Catmull-Clark star.
TestMesh make_quad_star(uint32_t valence, uint32_t rings);
TestMesh make_triangle_star(uint32_t valence, uint32_t rings);
// `faces` sectors around boundary vertex 0, half a disk.
TestMesh make_quad_half_star(uint32_t faces, uint32_t rings);
TestMesh make_triangle_half_star(uint32_t faces, uint32_t rings);
// Closed: a fan of triangles at either pole, `bands` bands of quads between them.
TestMesh make_globe(uint32_t valence, uint32_t bands);
TestMesh make_triangle_globe(uint32_t valence, uint32_t bands);
// A prism over an n-gon, closed by two n-gons.
TestMesh make_prism(uint32_t sides);
TestMesh make_pyramid(uint32_t sides);
// `pages` quads (or triangles) that share the edge 0-1.
TestMesh make_book(uint32_t pages, bool triangles);

// Appends `other`, its vertices renumbered by `map` (identity past the end means new vertices). Returns the
// index that each vertex of `other` received.
std::vector<uint32_t> append(TestMesh& mesh, const TestMesh& other,
                             const std::vector<std::pair<uint32_t, uint32_t>>& shared = {});

// Every shape of the suite; names are unique and hold letters, digits and underscores only.
std::vector<TestMesh> all_shapes();
std::vector<TestMesh> shapes_of(Scheme scheme);
// All of them, those with equal options together.
std::vector<std::vector<TestMesh>> shapes_by_options();

// The parts that all_shapes() is made of.
std::vector<TestMesh> bilinear_shapes();
std::vector<TestMesh> catmull_clark_shapes();
std::vector<TestMesh> catmull_clark_odd_shapes();  // non-manifold, degenerate, valence 2, holes, winding
std::vector<TestMesh> loop_shapes();
std::vector<TestMesh> face_varying_shapes();  // all three schemes

const char* name_of(Scheme scheme);
const char* name_of(BoundaryInterpolation boundary);
const char* name_of(CreasingMethod creasing);
const char* name_of(FaceVaryingInterpolation interpolation);
// "0p7" for 0.7.
std::string name_of_number(double number);

}  // namespace limn::test
