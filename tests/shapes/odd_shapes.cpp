// Catmull-Clark meshes that modelling tools should not write, and do.
#include <algorithm>

#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr BoundaryInterpolation kBoundaries[] = {
    BoundaryInterpolation::none, BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner};

struct Suite {
    std::vector<TestMesh> shapes;

    TestMesh& add(const std::string& name, TestMesh mesh) {
        mesh.name = "catmark_" + name;
        shapes.push_back(std::move(mesh));
        return shapes.back();
    }
    void add_for_boundaries(const std::string& name, const TestMesh& mesh) {
        for (BoundaryInterpolation boundary : kBoundaries) {
            add(name + "_" + name_of(boundary), mesh).options.boundary = boundary;
        }
    }
};

void remove_face(TestMesh& mesh, uint32_t face) {
    size_t begin = 0;
    for (uint32_t f = 0; f < face; ++f) begin += mesh.face_sizes[f];
    const auto first = mesh.face_vertices.begin() + static_cast<ptrdiff_t>(begin);
    mesh.face_vertices.erase(first, first + static_cast<ptrdiff_t>(mesh.face_sizes[face]));
    mesh.face_sizes.erase(mesh.face_sizes.begin() + face);
}

void reverse_face(TestMesh& mesh, uint32_t face) {
    size_t begin = 0;
    for (uint32_t f = 0; f < face; ++f) begin += mesh.face_sizes[f];
    const auto first = mesh.face_vertices.begin() + static_cast<ptrdiff_t>(begin);
    std::reverse(first + 1, first + static_cast<ptrdiff_t>(mesh.face_sizes[face]));
}

void add_non_manifold_edges(Suite& suite) {
    for (uint32_t pages : {3u, 4u, 5u})
        suite.add_for_boundaries("book_" + std::to_string(pages), make_book(pages, false));
    suite.add("book_100", make_book(100, false));
    suite.add("triangle_book_3", make_book(3, true));
    TestMesh semi = make_book(3, false);
    semi.add_crease(0, 1, 1.5);
    suite.add("book_3_crease", semi);
    // Fins on a grid: on one interior edge, and along a whole line of edges (a crease without corners).
    TestMesh fin = make_grid(4, 4);
    uint32_t a = fin.add_vertex(1.6, 2.3, 1.9), b = fin.add_vertex(2.6, 2.2, 2.1);
    fin.add_face({11, 12, b, a});
    suite.add_for_boundaries("grid_fin", fin);
    TestMesh wall = make_grid(4, 4);
    std::vector<uint32_t> top;
    for (uint32_t i = 0; i < 5; ++i) top.push_back(wall.add_vertex(i, 2.1, 2 + 0.1 * i));
    for (uint32_t i = 0; i < 4; ++i) wall.add_face({10 + i, 11 + i, top[i + 1], top[i]});
    suite.add_for_boundaries("grid_wall", wall);
    // A closed line of non-manifold edges: every vertex has two of them and no boundary nearby.
    TestMesh torus = make_torus(6, 4);
    TestMesh other = make_torus(6, 4);
    std::vector<std::pair<uint32_t, uint32_t>> shared;
    for (uint32_t i = 0; i < 6; ++i) shared.push_back({4 * i, 4 * i + 2});
    append(torus, other, shared);
    suite.add("tori_sharing_a_line_of_vertices", torus);
    TestMesh membrane = make_torus(6, 4);
    const uint32_t centre = membrane.add_vertex(0.1, 0.05, 0.3);
    for (uint32_t i = 0; i < 6; ++i) membrane.add_face({centre, 4 * i + 2, 4 * ((i + 1) % 6) + 2});
    suite.add("torus_membrane", membrane);
    // Two cubes that share an edge, and two that share a face (an interior wall).
    TestMesh edge = make_cube();
    append(edge, make_cube(), {{0, 3}, {4, 7}});
    suite.add("cubes_sharing_an_edge", edge);
    edge.add_crease_path({0, 1, 3}, 2.2);
    suite.add("cubes_sharing_an_edge_creased", edge);
    TestMesh wall_cubes = make_cube();
    append(wall_cubes, make_cube(), {{0, 1}, {2, 3}, {4, 5}, {6, 7}});
    suite.add("cubes_sharing_a_face", wall_cubes);
    wall_cubes = make_cube();
    TestMesh lid = make_cube();
    remove_face(lid, 4);
    append(wall_cubes, lid, {{0, 1}, {2, 3}, {4, 5}, {6, 7}});
    suite.add("cubes_with_an_interior_wall", wall_cubes);
}

void add_non_manifold_vertices(Suite& suite) {
    TestMesh bow = make_grid(2, 2);
    append(bow, make_grid(2, 2), {{0, 8}});
    suite.add_for_boundaries("bow_tie_corners", bow);
    bow = make_grid(2, 2);
    append(bow, make_grid(2, 2), {{4, 4}});
    suite.add_for_boundaries("bow_tie_interiors", bow);
    bow = make_grid(2, 2);
    append(bow, make_grid(2, 2), {{1, 4}});
    suite.add_for_boundaries("bow_tie_mixed", bow);
    TestMesh cubes = make_cube();
    append(cubes, make_cube(), {{0, 7}});
    suite.add("cubes_touching", cubes);
    cubes.add_corner(7, 0.5);
    cubes.add_crease(7, 6, 1.5);
    suite.add("cubes_touching_sharp", cubes);
    for (uint32_t n : {4u, 8u, 64u}) {
        // Both poles are one vertex.
        TestMesh globe = make_globe(n, 1), pinched;
        std::vector<uint32_t> map;
        for (uint32_t v = 0; v < globe.vertex_count; ++v) map.push_back(v < 2 ? 0 : v - 1);
        pinched.vertex_count = globe.vertex_count - 1;
        pinched.positions.assign(globe.positions.begin() + 3, globe.positions.end());
        pinched.face_sizes = globe.face_sizes;
        for (uint32_t v : globe.face_vertices) pinched.face_vertices.push_back(map[v]);
        suite.add("pinched_globe_" + std::to_string(n), pinched);
    }
    TestMesh flipped = make_grid(3, 3);
    reverse_face(flipped, 4);
    suite.add_for_boundaries("one_face_reversed", flipped);
    flipped.add_crease_path({4, 5, 6, 7}, 1.4);
    suite.add_for_boundaries("one_face_reversed_creased", flipped);
    TestMesh cube = make_cube();
    reverse_face(cube, 0);
    suite.add("cube_one_face_reversed", cube);
    TestMesh half = make_grid(4, 2);
    for (uint32_t f : {2u, 3u, 6u, 7u}) reverse_face(half, f);
    suite.add_for_boundaries("half_reversed", half);
    TestMesh moebius = make_torus(6, 4), strip;  // a strip glued with a half twist
    strip.vertex_count = 12;
    strip.positions.assign(moebius.positions.begin(), moebius.positions.begin() + 36);
    for (uint32_t i = 0; i < 5; ++i) strip.add_face({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    strip.add_face({10, 1, 0, 11});
    suite.add_for_boundaries("moebius", strip);
}

void add_low_valence(Suite& suite) {
    // Quads split along a path through a new vertex, which then has two faces.
    auto split_quad = [](TestMesh& mesh, uint32_t face, bool other_diagonal) {
        const auto begin = mesh.face_vertices.begin() + 4 * static_cast<ptrdiff_t>(face);
        std::vector<uint32_t> q(begin, begin + 4);
        if (other_diagonal) std::rotate(q.begin(), q.begin() + 1, q.end());
        double centre[3] = {0, 0, 0.2};
        for (uint32_t v : q) {
            for (size_t axis = 0; axis < 3; ++axis) {
                centre[axis] += (axis == 0 ? 0.23 : 0.25) * static_cast<double>(mesh.positions[3 * v + axis]);
            }
        }
        const uint32_t m = mesh.add_vertex(centre[0], centre[1], centre[2]);
        const uint32_t first[4] = {q[0], q[1], q[2], m};
        std::copy(first, first + 4, mesh.face_vertices.begin() + 4 * static_cast<ptrdiff_t>(face));
        mesh.add_face({q[0], m, q[2], q[3]});
        return m;
    };
    TestMesh grid = make_grid(3, 3);
    const uint32_t middle = split_quad(grid, 4, false);
    suite.add_for_boundaries("valence2_interior", grid);
    TestMesh sharp = grid;
    sharp.add_crease_path({5, middle, 10}, 1.5);
    suite.add("valence2_crease", sharp);
    sharp = grid;
    sharp.add_crease(5, middle, 0.8);
    suite.add("valence2_dart", sharp);
    sharp = grid;
    sharp.add_corner(middle, 1.2);
    suite.add("valence2_corner", sharp);
    split_quad(grid, 0, true);
    split_quad(grid, 8, false);
    split_quad(grid, 9, true);
    suite.add_for_boundaries("valence2_several", grid);
    TestMesh cube = make_cube();
    for (uint32_t f = 0; f < 6; ++f) split_quad(cube, f, f % 2 == 0);
    suite.add("valence2_cube", cube);

    TestMesh pillow = make_grid(1, 1);  // two quads with the same edges
    pillow.add_face({0, 2, 3, 1});
    suite.add("back_to_back", pillow);
    pillow.add_crease_path({0, 1, 3}, 1.3);
    suite.add("back_to_back_creased", pillow);
    TestMesh pillows = make_grid(2, 2);
    const TestMesh below = make_grid(2, 2);
    TestMesh reversed = below;
    for (uint32_t f = 0; f < 4; ++f) reverse_face(reversed, f);
    std::vector<std::pair<uint32_t, uint32_t>> rim;
    for (uint32_t v = 0; v < 9; ++v) {
        if (v != 4) rim.push_back({v, v});
    }
    append(pillows, reversed, rim);
    suite.add("back_to_back_grids", pillows);
    TestMesh doubled = make_grid(2, 1);  // the same face twice, the same way round: non-manifold
    doubled.add_face({0, 1, 4, 3});
    suite.add_for_boundaries("face_twice", doubled);
    TestMesh fold = make_grid(2, 2);  // a quad folded over the centre: shares two edges with its neighbour
    const uint32_t tip = fold.add_vertex(0.4, 0.5, 1.4);
    fold.face_vertices[0] = tip;
    fold.add_face({0, 1, tip, 3});
    suite.add_for_boundaries("fold_over", fold);
    TestMesh triangles = make_tetrahedron();
    triangles.face_sizes.resize(1);
    triangles.face_vertices.resize(3);
    triangles.add_face({triangles.face_vertices[0], triangles.face_vertices[2], triangles.face_vertices[1]});
    triangles.vertex_count = 4;  // vertex 3 is now unused
    suite.add("back_to_back_triangles", triangles);
}

void add_degenerate(Suite& suite) {
    TestMesh bare = make_grid(2, 2);
    for (uint32_t i = 0; i < 3; ++i) bare.add_vertex(0.5 * i, 3, 1);
    suite.add_for_boundaries("unused_vertices", bare);
    TestMesh bare_first;
    bare_first.add_vertex(5, 5, 5);
    append(bare_first, make_cube());
    bare_first.add_vertex(6, 5, 5);
    suite.add("unused_vertices_at_both_ends", bare_first);
    TestMesh repeated =
        make_grid(3, 2);  // faces with a vertex twice in a row: an edge from a vertex to itself
    const uint32_t v = repeated.add_vertex(1.5, 2.8, 0.1);
    repeated.add_face({9, 8, 8, v});
    suite.add_for_boundaries("degenerate_edge", repeated);
    TestMesh collapsed = make_grid(3, 3);
    for (uint32_t& index : collapsed.face_vertices) index = index == 6 ? 5 : index;
    suite.add_for_boundaries("collapsed_edge", collapsed);
}

void add_holes_and_winding(Suite& suite) {
    TestMesh grid = make_grid(4, 4);
    grid.holes = {5};
    suite.add_for_boundaries("hole_interior", grid);
    grid.holes = {5, 6, 15};
    suite.add_for_boundaries("holes_interior_and_corner", grid);
    grid.holes = {0, 1};
    grid.add_crease_path({5, 6, 7, 8, 9}, 1.6);
    suite.add_for_boundaries("holes_beside_crease", grid);
    grid.add_crease_path({5, 6, 7}, 10);
    suite.add_for_boundaries("holes_beside_infinite_crease", grid);
    TestMesh polygons = make_pyramid(5);
    polygons.holes = {2, 5};
    suite.add("holes_polygons", polygons);
    TestMesh cube = make_cube();
    cube.holes = {0, 3};
    suite.add("holes_cube", cube);

    TestMesh left = make_grid(3, 2);
    left.left_handed = true;
    left.add_crease_path({4, 5, 6}, 1.5);
    suite.add_for_boundaries("left_handed_grid", left);
    TestMesh left_polygons = make_prism(5);
    left_polygons.left_handed = true;
    left_polygons.add_corner(2, 1.5);
    suite.add("left_handed_prism", left_polygons);
    TestMesh left_channel = make_pyramid(4);
    left_channel.left_handed = true;
    add_channel_by_region(left_channel, FaceVaryingInterpolation::corners_plus1, {0, 0, 1, 1, 2});
    suite.add("left_handed_channel", left_channel);
}

}  // namespace

std::vector<TestMesh> catmull_clark_odd_shapes() {
    Suite suite;
    add_non_manifold_edges(suite);
    add_non_manifold_vertices(suite);
    add_low_valence(suite);
    add_degenerate(suite);
    add_holes_and_winding(suite);
    return suite.shapes;
}

}  // namespace limn::test
