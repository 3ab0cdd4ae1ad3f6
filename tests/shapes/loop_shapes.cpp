#include <algorithm>

#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr BoundaryInterpolation kBoundaries[] = {
    BoundaryInterpolation::none, BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner};
constexpr CreasingMethod kCreasings[] = {CreasingMethod::uniform, CreasingMethod::chaikin};

struct Suite {
    std::vector<TestMesh> shapes;

    TestMesh& add(const std::string& name, TestMesh mesh) {
        mesh.name = "loop_" + name;
        mesh.options.scheme = Scheme::loop;
        shapes.push_back(std::move(mesh));
        return shapes.back();
    }
    void add_for_boundaries(const std::string& name, const TestMesh& mesh) {
        for (BoundaryInterpolation boundary : kBoundaries) {
            add(name + "_" + name_of(boundary), mesh).options.boundary = boundary;
        }
    }
    void add_for_creasings(const std::string& name, const TestMesh& mesh) {
        for (CreasingMethod creasing : kCreasings) {
            add(name + "_" + name_of(creasing), mesh).options.creasing = creasing;
        }
    }
};

TestMesh make_triangle_cube() {
    TestMesh mesh = make_cube();
    mesh.triangulate();
    return mesh;
}

// Faces turned the other way round, keeping their first vertex first.
void reverse_triangle(TestMesh& mesh, uint32_t face) {
    std::swap(mesh.face_vertices[3 * face + 1], mesh.face_vertices[3 * face + 2]);
}

void add_solids(Suite& suite) {
    suite.add("cube", make_triangle_cube());
    suite.add("tetrahedron", make_tetrahedron());
    suite.add("octahedron", make_octahedron());
    suite.add("icosahedron", make_icosahedron());
    suite.add("torus", make_triangle_torus(6, 4));
    for (double s : {0.1, 0.7, 1.0, 1.4, 2.8, 5.0, 10.0}) {
        TestMesh corner = make_triangle_cube();
        corner.add_corner(3, s);
        suite.add("cube_corner_" + name_of_number(s), corner);
        TestMesh one = make_triangle_cube();
        one.add_crease(0, 1, s);
        suite.add_for_creasings("cube_one_crease_" + name_of_number(s), one);
        TestMesh ring = make_triangle_cube();
        ring.add_crease_path({4, 5, 7, 6, 4}, s);
        suite.add_for_creasings("cube_ring_" + name_of_number(s), ring);
        TestMesh icosahedron = make_icosahedron();
        icosahedron.add_crease_path({0, 1, 2, 11}, s);
        icosahedron.add_corner(5, s);
        suite.add("icosahedron_creases_" + name_of_number(s), icosahedron);
    }
    TestMesh all = make_tetrahedron();
    all.add_crease(0, 1, 0.4);
    all.add_crease(0, 2, 1.9);
    all.add_crease(0, 3, 2.6);
    all.add_crease(1, 2, 10);
    all.add_crease(1, 3, 1);
    all.add_crease(2, 3, 0.3);
    suite.add_for_creasings("tetrahedron_six_creases", all);
}

void add_chains(Suite& suite) {
    const std::vector<std::vector<double>> chains = {{1, 2, 3, 4, 5, 4},
                                                     {0.5, 3.5, 0.5, 3.5, 0.5, 3.5},
                                                     {1.2, 0.3, 10, 0.3, 1.2, 2.2},
                                                     {0.2, 0.7, 1.1, 1.6, 2.3, 0.9}};
    uint32_t index = 0;
    for (const std::vector<double>& chain : chains) {
        const std::string suffix = std::to_string(index++);
        TestMesh closed = make_triangle_torus(6, 4);
        for (uint32_t i = 0; i < 6; ++i) closed.add_crease(4 * i + 1, 4 * ((i + 1) % 6) + 1, chain[i]);
        suite.add_for_creasings("chain_closed_" + suffix, closed);
        TestMesh open = make_triangle_grid(6, 2);
        for (uint32_t i = 0; i < 6; ++i) open.add_crease(7 + i, 8 + i, chain[i]);
        suite.add_for_creasings("chain_open_" + suffix, open);
        TestMesh darts = make_triangle_grid(5, 3);
        for (uint32_t i = 1; i < 4; ++i) darts.add_crease(6 + i, 7 + i, chain[i]);
        suite.add_for_creasings("chain_darts_" + suffix, darts);
    }
}

void add_stars(Suite& suite) {
    for (uint32_t n = 3; n <= 12; ++n) suite.add("star_" + std::to_string(n), make_triangle_star(n, 2));
    for (uint32_t n = 3; n <= 9; ++n) {
        for (double s : {0.6, 1.5, 10.0}) {
            TestMesh dart = make_triangle_star(n, 2);
            dart.add_crease_path({0, 1, 2}, s);
            suite.add("dart_" + std::to_string(n) + "_" + name_of_number(s), dart);
        }
    }
    for (uint32_t n = 3; n <= 8; ++n) {
        for (uint32_t k = 1; k <= n / 2; ++k) {
            for (double s : {0.7, 10.0}) {
                TestMesh crease = make_triangle_star(n, 2);
                crease.add_crease_path({2, 1, 0, 1 + 2 * k, 2 + 2 * k}, s);
                suite.add(
                    "star_crease_" + std::to_string(n) + "_" + std::to_string(k) + "_" + name_of_number(s),
                    crease);
            }
        }
    }
    for (uint32_t k = 1; k <= 8; ++k) {
        suite.add_for_boundaries("half_star_" + std::to_string(k), make_triangle_half_star(k, 2));
    }
    for (uint32_t n : {8u, 64u, 360u})
        suite.add("pole_" + std::to_string(n), make_triangle_globe(n, n > 100 ? 0 : 1));
}

void add_boundaries(Suite& suite) {
    suite.add_for_boundaries("triangle", make_triangle_star(3, 1));
    TestMesh single;
    single.add_vertex(0, 0, 0.1);
    single.add_vertex(1, 0.1, 0);
    single.add_vertex(0.2, 1, 0.3);
    single.add_face({0, 1, 2});
    suite.add_for_boundaries("single_triangle", single);
    suite.add_for_boundaries("strip", make_triangle_grid(4, 1));
    TestMesh saddle = make_triangle_half_star(4, 1);
    suite.add_for_boundaries("saddle", saddle);
    suite.add_for_boundaries("grid", make_triangle_grid(4, 3));
    TestMesh sharp = make_triangle_grid(3, 3);
    for (uint32_t i = 0; i < 3; ++i) {
        sharp.add_crease(i, i + 1, 10);
        sharp.add_crease(4 * i, 4 * i + 4, 10);
    }
    for (uint32_t v : {0u, 1u, 2u, 3u, 4u, 8u, 12u}) sharp.add_corner(v, 10);
    sharp.add_corner(15, 1.5);
    suite.add_for_boundaries("grid_sharp_boundary", sharp);
    TestMesh dart = make_triangle_grid(4, 4);
    dart.add_crease_path({2, 7, 12}, 10);
    suite.add_for_boundaries("grid_infinite_dart", dart);
    TestMesh across = make_triangle_grid(4, 4);
    across.add_crease_path({10, 11, 12, 13, 14}, 10);
    suite.add_for_boundaries("grid_infinite_crease", across);
    across.add_crease_path({2, 7, 12}, 1.3);
    suite.add_for_boundaries("grid_infinite_crease_and_dart", across);
    for (double s : {0.2, 0.8, 1.4, 2.0, 5.7}) {
        TestMesh crease = make_triangle_grid(4, 3);
        crease.add_crease_path({5, 6, 7, 8, 9}, s);
        suite.add("single_crease_" + name_of_number(s), crease);
    }
}

void add_odd(Suite& suite) {
    for (uint32_t pages : {3u, 4u})
        suite.add_for_boundaries("book_" + std::to_string(pages), make_book(pages, true));
    suite.add("book_100", make_book(100, true));
    TestMesh edge = make_triangle_cube();
    append(edge, make_triangle_cube(), {{0, 3}, {4, 7}});
    suite.add("cubes_sharing_an_edge", edge);
    TestMesh cubes = make_triangle_cube();
    append(cubes, make_tetrahedron(), {{0, 7}});
    suite.add("solids_touching", cubes);
    TestMesh face = make_tetrahedron();
    append(face, make_tetrahedron(), {{0, 0}, {1, 1}, {2, 2}});
    suite.add("tetrahedra_sharing_a_face", face);
    TestMesh bow = make_triangle_grid(2, 2);
    append(bow, make_triangle_grid(2, 2), {{0, 8}});
    suite.add_for_boundaries("bow_tie", bow);
    bow = make_triangle_star(5, 1);
    append(bow, make_triangle_star(6, 1), {{0, 0}});
    suite.add_for_boundaries("bow_tie_interiors", bow);
    TestMesh membrane = make_triangle_torus(6, 4);
    const uint32_t centre = membrane.add_vertex(0.1, 0.05, 0.3);
    for (uint32_t i = 0; i < 6; ++i) membrane.add_face({centre, 4 * i + 2, 4 * ((i + 1) % 6) + 2});
    suite.add("torus_membrane", membrane);
    TestMesh flipped = make_triangle_grid(3, 3);
    reverse_triangle(flipped, 8);
    suite.add_for_boundaries("one_face_reversed", flipped);

    TestMesh pillow = make_triangle_star(3, 1);  // vertex 0 has three faces; closed by one more
    pillow.add_face({1, 3, 2});
    suite.add("closed_star", pillow);
    TestMesh back;
    back.add_vertex(0, 0, 0.1);
    back.add_vertex(1, 0.1, 0);
    back.add_vertex(0.2, 1, 0.3);
    back.add_face({0, 1, 2});
    back.add_face({0, 2, 1});
    suite.add("back_to_back", back);
    TestMesh split = make_triangle_grid(3, 3);  // a triangle that folds over an edge: its tip has two faces
    const uint32_t tip = split.add_vertex(1.4, 1.3, 1.5);
    const uint32_t q[3] = {split.face_vertices[24], split.face_vertices[25], split.face_vertices[26]};
    split.face_vertices[26] = tip;
    split.add_face({q[1], q[2], tip});
    split.add_face({q[2], q[0], tip});
    suite.add_for_boundaries("valence3_inserted", split);
    TestMesh valence2 = make_triangle_grid(3, 3);  // edge 5-6 doubled by way of a new vertex of two faces
    const uint32_t m = valence2.add_vertex(1.5, 1.1, 1.2);
    valence2.add_face({5, 6, m});
    valence2.add_face({6, 5, m});
    suite.add_for_boundaries("valence2_fin", valence2);
    TestMesh bare = make_triangle_grid(2, 2);
    bare.add_vertex(1, 4, 0);
    bare.add_vertex(1, 5, 0);
    suite.add("unused_vertices", bare);
    TestMesh degenerate = make_triangle_grid(3, 3);
    for (uint32_t& index : degenerate.face_vertices) index = index == 6 ? 5 : index;
    suite.add_for_boundaries("collapsed_edge", degenerate);
    TestMesh holes = make_triangle_grid(3, 3);
    holes.holes = {2, 8, 9};
    holes.add_crease_path({4, 5, 6, 7}, 1.3);
    suite.add_for_boundaries("holes", holes);
    TestMesh left = make_triangle_grid(3, 2);
    left.left_handed = true;
    left.add_crease_path({4, 5, 6}, 1.6);
    suite.add_for_boundaries("left_handed", left);
}

}  // namespace

std::vector<TestMesh> loop_shapes() {
    Suite suite;
    add_solids(suite);
    add_chains(suite);
    add_stars(suite);
    add_boundaries(suite);
    add_odd(suite);
    return suite.shapes;
}

}  // namespace limn::test
