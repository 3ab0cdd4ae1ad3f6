#include <array>

#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr BoundaryInterpolation kBoundaries[] = {
    BoundaryInterpolation::none, BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner};
constexpr CreasingMethod kCreasings[] = {CreasingMethod::uniform, CreasingMethod::chaikin};

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
    void add_for_creasings(const std::string& name, const TestMesh& mesh) {
        for (CreasingMethod creasing : kCreasings) {
            add(name + "_" + name_of(creasing), mesh).options.creasing = creasing;
        }
    }
};

void add_cubes(Suite& suite) {
    suite.add("cube", make_cube());
    for (double s : {0.1, 0.25, 0.7, 1.0, 1.4, 2.0, 2.8, 3.0, 3.6, 5.0, 9.9, 10.0}) {
        TestMesh corner = make_cube();
        corner.add_corner(3, s);
        suite.add("cube_corner_" + name_of_number(s), corner);
        TestMesh one = make_cube();
        one.add_crease(0, 1, s);  // both ends are darts
        suite.add_for_creasings("cube_one_crease_" + name_of_number(s), one);
        TestMesh two = make_cube();
        two.add_crease_path({0, 1, 3}, s);
        suite.add_for_creasings("cube_two_creases_" + name_of_number(s), two);
        TestMesh ring = make_cube();
        ring.add_crease_path({4, 5, 7, 6, 4}, s);
        suite.add("cube_ring_" + name_of_number(s), ring);
    }
    // Twelve edges of twelve values, and corners among them.
    TestMesh mixed = make_cube();
    const std::array<uint32_t, 24> edges = {0, 1, 1, 3, 3, 2, 2, 0, 4, 5, 5, 7,
                                            7, 6, 6, 4, 0, 4, 1, 5, 3, 7, 2, 6};
    const double values[12] = {0.1, 0.4, 0.9, 1.0, 1.3, 1.9, 2.5, 3.0, 4.2, 5.0, 0.6, 10.0};
    for (uint32_t i = 0; i < 12; ++i) mixed.add_crease(edges[2 * i], edges[2 * i + 1], values[i]);
    suite.add_for_creasings("cube_twelve_creases", mixed);
    TestMesh both = make_cube();
    both.add_crease_path({0, 1, 3, 2}, 1.7);
    both.add_corner(1, 0.6);
    both.add_corner(2, 2.3);
    both.add_corner(7, 10);
    suite.add_for_creasings("cube_creases_and_corners", both);
    // Four cubes in one mesh, as users combine parts.
    TestMesh four;
    for (uint32_t i = 0; i < 4; ++i) {
        TestMesh part = make_cube();
        for (size_t k = 0; k < part.positions.size(); k += 3)
            part.positions[k] += 3.0f * static_cast<float>(i);
        const uint32_t base = append(four, part)[0];
        const double s = i % 2 == 0 ? 10 : 1.6 + i;
        if (i != 1) four.add_crease_path({base + 4, base + 5, base + 7, base + 6, base + 4}, s);
        if (i != 2) four.add_corner(base, s);
        if (i == 3) four.add_crease_path({base, base + 1, base + 3}, 0.1);
    }
    suite.add("four_cubes", four);
}

// Sharpness that varies along a chain: what Chaikin creasing is for.
void add_chains(Suite& suite) {
    const std::vector<std::vector<double>> chains = {{1, 2, 3, 4, 5, 4, 3, 2},
                                                     {0.5, 3.5, 0.5, 3.5, 0.5, 3.5, 0.5, 3.5},
                                                     {1.2, 1.2, 0.3, 10, 0.3, 1.2, 2.2, 2.2},
                                                     {0.2, 0.7, 1.1, 1.6, 2.3, 0.9, 0.4, 0.6}};
    uint32_t index = 0;
    for (const std::vector<double>& chain : chains) {
        const std::string suffix = std::to_string(index++);
        TestMesh closed = make_torus(8, 4);
        for (uint32_t i = 0; i < 8; ++i) closed.add_crease(4 * i + 1, 4 * ((i + 1) % 8) + 1, chain[i]);
        suite.add_for_creasings("chain_closed_" + suffix, closed);
        TestMesh open = make_grid(6, 3);
        for (uint32_t i = 0; i < 6; ++i) open.add_crease(7 + i, 8 + i, chain[i]);
        suite.add_for_creasings("chain_open_" + suffix, open);
        TestMesh dart = make_grid(5, 4);
        for (uint32_t i = 1; i < 4; ++i) dart.add_crease(12 + i, 13 + i, chain[i]);
        suite.add_for_creasings("chain_darts_" + suffix, dart);
        TestMesh crossing = make_grid(4, 4);
        for (uint32_t i = 0; i < 4; ++i) crossing.add_crease(10 + i, 11 + i, chain[i]);
        for (uint32_t i = 0; i < 4; ++i) crossing.add_crease(2 + 5 * i, 7 + 5 * i, chain[i + 4]);
        suite.add_for_creasings("chain_crossing_" + suffix, crossing);
    }
}

void add_stars(Suite& suite) {
    for (uint32_t n = 3; n <= 12; ++n) suite.add("star_" + std::to_string(n), make_quad_star(n, 2));
    for (uint32_t n = 3; n <= 9; ++n) {
        for (double s : {0.6, 1.5, 2.0, 10.0}) {
            TestMesh dart = make_quad_star(n, 2);
            dart.add_crease_path({0, 1, 2}, s);
            suite.add("dart_" + std::to_string(n) + "_" + name_of_number(s), dart);
        }
    }
    // Interior creases through vertices of valence n, with k faces on one side.
    for (uint32_t n = 3; n <= 8; ++n) {
        for (uint32_t k = 1; k <= n / 2; ++k) {
            for (double s : {0.7, 2.5, 10.0}) {
                TestMesh crease = make_quad_star(n, 2);
                crease.add_crease_path({2, 1, 0, 1 + 2 * k, 2 + 2 * k}, s);
                suite.add(
                    "star_crease_" + std::to_string(n) + "_" + std::to_string(k) + "_" + name_of_number(s),
                    crease);
            }
        }
    }
    for (uint32_t k = 1; k <= 8; ++k) {
        suite.add_for_boundaries("half_star_" + std::to_string(k), make_quad_half_star(k, 2));
    }
    for (uint32_t n : {8u, 64u}) suite.add("pole_" + std::to_string(n), make_globe(n, 0));
    suite.add("pole_360", make_globe(360, 0));
    suite.add("globe_7", make_globe(7, 2));
}

void add_boundaries(Suite& suite) {
    suite.add_for_boundaries("quad", make_grid(1, 1));
    suite.add_for_boundaries("strip", make_grid(4, 1));
    suite.add_for_boundaries("grid", make_grid(4, 4));
    TestMesh corners = make_grid(4, 3);
    corners.add_corner(0, 2);
    corners.add_corner(4, 10);
    corners.add_corner(17, 0.4);
    corners.add_corner(2, 1.5);  // on the boundary, not at its corner
    suite.add_for_boundaries("grid_corners", corners);

    TestMesh sharpened = make_grid(4, 4);  // boundary edges sharpened by hand
    for (uint32_t i = 0; i < 4; ++i) {
        sharpened.add_crease(i, i + 1, 10);
        sharpened.add_crease(20 + i, 21 + i, 3);
        sharpened.add_crease(5 * i, 5 * i + 5, 10);
    }
    suite.add_for_boundaries("grid_sharp_boundary", sharpened);
    for (uint32_t v : {0u, 1u, 2u, 3u, 4u, 5u, 10u, 15u, 20u}) sharpened.add_corner(v, 10);
    suite.add_for_boundaries("grid_sharp_boundary_corners", sharpened);

    TestMesh dart = make_grid(4, 4);
    dart.add_crease_path({2, 7, 12}, 2);
    suite.add_for_boundaries("grid_dart_from_boundary", dart);
    TestMesh inf_dart = make_grid(4, 4);
    inf_dart.add_crease_path({2, 7, 12}, 10);
    suite.add_for_boundaries("grid_infinite_dart_from_boundary", inf_dart);
    TestMesh across = make_grid(4, 4);
    across.add_crease_path({10, 11, 12, 13, 14}, 10);
    suite.add_for_boundaries("grid_infinite_crease", across);
    TestMesh cross = make_grid(4, 4);
    cross.add_crease_path({10, 11, 12, 13, 14}, 10);
    cross.add_crease_path({2, 7, 12, 17, 22}, 10);
    suite.add_for_boundaries("grid_infinite_cross", cross);
    TestMesh bent = make_grid(4, 4);
    bent.add_crease_path({10, 11, 12, 7, 2}, 10);
    suite.add_for_boundaries("grid_infinite_bend", bent);

    for (double s : {0.2, 0.8, 1.0, 1.4, 2.0, 2.8, 5.0, 5.7, 10.0}) {
        TestMesh single = make_grid(4, 4);
        single.add_crease_path({10, 11, 12, 13, 14}, s);
        suite.add("single_crease_" + name_of_number(s), single);
    }
    // A flap: two quads and a triangle that meet at a boundary vertex; and a second sheet beside it.
    TestMesh flap = make_grid(2, 1);
    const uint32_t tip = flap.add_vertex(1.2, -0.9, 0.6);
    flap.add_face({0, tip, 1});
    suite.add_for_boundaries("flap", flap);
    const uint32_t far = flap.add_vertex(2.3, -0.8, 0.1);
    flap.add_face({tip, far, 2, 1});
    suite.add_for_boundaries("flap2", flap);
    // A fan: strips that leave one vertex in all directions.
    TestMesh fan = make_quad_half_star(5, 2);
    fan.add_crease_path({0, 3, 4}, 1.2);
    fan.add_crease_path({0, 5, 6}, 10);
    suite.add_for_boundaries("fan", fan);
    // Rings of one, two and three quads across, closed around.
    for (uint32_t rows = 1; rows <= 3; ++rows) {
        TestMesh ring = make_torus(6, 4);
        TestMesh open;
        open.vertex_count = ring.vertex_count;
        open.positions = ring.positions;
        for (uint32_t f = 0; f < 24; ++f) {
            if (f % 4 >= rows) continue;
            const auto begin = ring.face_vertices.begin() + 4 * f;
            open.add_face(std::vector<uint32_t>(begin, begin + 4));
        }
        suite.add_for_boundaries("ring_" + std::to_string(rows), open);
    }
    TestMesh tent = make_grid(3, 3);
    suite.add_for_boundaries("tent", tent);
    tent.add_crease_path({5, 6, 10, 9, 5}, 2);
    suite.add_for_boundaries("tent_creases", tent);
    tent.add_corner(6, 3);
    suite.add_for_boundaries("tent_creases_corner", tent);
}

void add_polygons(Suite& suite) {
    for (uint32_t n : {3u, 5u, 6u, 9u}) suite.add("prism_" + std::to_string(n), make_prism(n));
    for (uint32_t n : {4u, 5u}) {
        TestMesh pyramid = make_pyramid(n);
        suite.add("pyramid_" + std::to_string(n), pyramid);
        for (double s : {3.0, 2.5, 4.0, 0.5}) {
            TestMesh creased = pyramid;
            creased.add_crease_path({0, 1, 2}, s);
            if (s < 4) creased.add_crease(2, 3, s + 0.5);
            if (s == 2.5) creased.add_corner(0, 3);
            suite.add_for_creasings("pyramid_" + std::to_string(n) + "_crease_" + name_of_number(s), creased);
        }
    }
    // Quads, a triangle, a pentagon and a hexagon, with boundary.
    TestMesh mix;
    const double points[13][2] = {{0, 0},     {1, 0},     {2, 0},     {3, 0.2},   {0, 1},
                                  {1, 1},     {2, 1.2},   {3.2, 1.4}, {0.2, 2.2}, {1, 2.4},
                                  {1.9, 2.5}, {2.7, 2.6}, {3.6, 2.4}};
    for (const auto& p : points) mix.add_vertex(p[0], p[1], 0.4 - 0.1 * p[0] * p[0] + 0.13 * p[1]);
    mix.add_face({0, 1, 5, 4});
    mix.add_face({1, 2, 6, 5});
    mix.add_face({2, 3, 6});
    mix.add_face({4, 5, 9, 8});
    mix.add_face({5, 6, 11, 10, 9});
    mix.add_face({3, 7, 12, 11, 6});
    suite.add_for_boundaries("polygons", mix);
    mix.add_crease_path({5, 6, 11}, 1.3);
    mix.add_corner(5, 0.5);
    suite.add_for_boundaries("polygons_creased", mix);

    for (TriangleSubdivision rule : {TriangleSubdivision::catmark, TriangleSubdivision::smooth}) {
        const std::string suffix = rule == TriangleSubdivision::catmark ? "_catmark" : "_smooth";
        TestMesh grid = make_triangle_grid(3, 3);
        grid.options.triangles = rule;
        suite.add("triangles_grid" + suffix, grid);
        grid.add_crease_path({4, 5, 6, 7}, 0.7);
        suite.add("triangles_grid_crease" + suffix, grid);
        TestMesh solid = make_icosahedron();
        solid.options.triangles = rule;
        suite.add("triangles_icosahedron" + suffix, solid);
        TestMesh mixed = make_pyramid(5);
        mixed.options.triangles = rule;
        suite.add("triangles_pyramid" + suffix, mixed);
        mixed.add_crease_path({1, 0, 3}, 1.4);
        mixed.options.creasing = CreasingMethod::chaikin;
        suite.add("triangles_pyramid_crease" + suffix, mixed);
    }
    suite.add("tetrahedron", make_tetrahedron());
    suite.add("octahedron", make_octahedron());
}

void add_tori(Suite& suite) {
    suite.add("torus", make_torus(6, 4));
    TestMesh creased = make_torus(6, 4);
    for (uint32_t i = 0; i < 6; ++i) creased.add_crease(4 * i, 4 * ((i + 1) % 6), 4.7);
    suite.add("torus_crease", creased);
    creased.add_crease_path({5, 6, 7}, 10);
    creased.add_crease_path({13, 17, 18}, 1.1);
    suite.add("torus_creases", creased);
    suite.add("triangle_torus", make_triangle_torus(5, 4));
}

}  // namespace

std::vector<TestMesh> catmull_clark_shapes() {
    Suite suite;
    add_cubes(suite);
    add_chains(suite);
    add_stars(suite);
    add_boundaries(suite);
    add_polygons(suite);
    add_tori(suite);
    return suite.shapes;
}

std::vector<TestMesh> bilinear_shapes() {
    std::vector<TestMesh> shapes;
    auto add = [&](const std::string& name, TestMesh mesh) {
        for (BoundaryInterpolation boundary : kBoundaries) {
            mesh.options.scheme = Scheme::bilinear;
            mesh.options.boundary = boundary;
            mesh.name = "bilinear_" + name + "_" + name_of(boundary);
            shapes.push_back(mesh);
        }
    };
    add("cube", make_cube());
    TestMesh sharp = make_cube();
    sharp.add_crease_path({0, 1, 3}, 1.5);
    sharp.add_corner(2, 2.5);
    sharp.holes = {1};
    add("cube_creases", sharp);
    TestMesh warped = make_grid(2, 1);
    warped.perturb(0.6, 5);
    add("nonplanar", warped);
    add("prism_6", make_prism(6));
    add("pyramid_5", make_pyramid(5));
    TestMesh mixed = make_pyramid(4);
    append(mixed, make_prism(5), {{0, 1}});
    add("touching", mixed);
    add("star_5", make_quad_star(5, 1));
    add("book_3", make_book(3, false));
    add("grid", make_grid(3, 2));
    add("triangles", make_triangle_grid(2, 2));
    return shapes;
}

}  // namespace limn::test
