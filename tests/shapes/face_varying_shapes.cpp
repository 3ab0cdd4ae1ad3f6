// Face-varying layouts. Every mesh carries its layout six times, once for each interpolation option.
#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr FaceVaryingInterpolation kInterpolations[] = {
    FaceVaryingInterpolation::none,          FaceVaryingInterpolation::corners_only,
    FaceVaryingInterpolation::corners_plus1, FaceVaryingInterpolation::corners_plus2,
    FaceVaryingInterpolation::boundaries,    FaceVaryingInterpolation::all};
constexpr BoundaryInterpolation kBoundaries[] = {
    BoundaryInterpolation::none, BoundaryInterpolation::edge_only, BoundaryInterpolation::edge_and_corner};

struct Suite {
    std::vector<TestMesh> shapes;

    void add(Scheme scheme, const std::string& name, const TestMesh& mesh, const SeamPredicate& is_seam) {
        for (BoundaryInterpolation boundary : kBoundaries) {
            TestMesh shape = mesh;
            shape.options.scheme = scheme;
            shape.options.boundary = boundary;
            shape.name = std::string(name_of(scheme)) + "_fvar_" + name + "_" + name_of(boundary);
            for (FaceVaryingInterpolation interpolation : kInterpolations)
                add_channel(shape, interpolation, is_seam);
            shapes.push_back(std::move(shape));
        }
    }
    void add_regions(Scheme scheme, const std::string& name, const TestMesh& mesh,
                     const std::function<uint32_t(uint32_t)>& region_of_face) {
        std::vector<uint32_t> regions;
        for (uint32_t f = 0; f < mesh.face_count(); ++f) regions.push_back(region_of_face(f));
        for (BoundaryInterpolation boundary : kBoundaries) {
            TestMesh shape = mesh;
            shape.options.scheme = scheme;
            shape.options.boundary = boundary;
            shape.name = std::string(name_of(scheme)) + "_fvar_" + name + "_" + name_of(boundary);
            for (FaceVaryingInterpolation i : kInterpolations) add_channel_by_region(shape, i, regions);
            shapes.push_back(std::move(shape));
        }
    }
};

SeamPredicate path_seam(std::vector<uint32_t> path) {
    return [path](uint32_t a, uint32_t b) {
        for (size_t i = 0; i + 1 < path.size(); ++i) {
            if ((path[i] == a && path[i + 1] == b) || (path[i] == b && path[i + 1] == a)) return true;
        }
        return false;
    };
}

bool no_seam(uint32_t, uint32_t) {
    return false;
}

// Layouts on a grid of 4 x 4 quads, vertices v = 5 y + x. `per_quad` faces of the mesh make one quad.
void add_grid_layouts(Suite& suite, Scheme scheme, const TestMesh& grid, uint32_t per_quad) {
    auto x = [=](uint32_t f) { return (f / per_quad) % 4; };
    auto y = [=](uint32_t f) { return (f / per_quad) / 4; };
    suite.add(scheme, "grid_smooth", grid, no_seam);
    suite.add(scheme, "grid_seam_across", grid, path_seam({10, 11, 12, 13, 14}));
    suite.add(scheme, "grid_seam_bend", grid, path_seam({10, 11, 12, 7, 2}));
    suite.add(scheme, "grid_seam_dart", grid, path_seam({2, 7, 12}));
    suite.add(scheme, "grid_seam_interior", grid, path_seam({11, 12, 13}));
    suite.add(scheme, "grid_seam_short", grid, path_seam({11, 12}));
    suite.add(scheme, "grid_seam_tee", grid, [](uint32_t a, uint32_t b) {
        return path_seam({10, 11, 12, 13, 14})(a, b) || path_seam({2, 7, 12})(a, b);
    });
    suite.add_regions(scheme, "grid_quadrants", grid, [=](uint32_t f) { return x(f) / 2 + 2 * (y(f) / 2); });
    suite.add_regions(scheme, "grid_island", grid,
                      [=](uint32_t f) { return x(f) > 0 && x(f) < 3 && y(f) > 0 && y(f) < 3 ? 1u : 0u; });
    suite.add_regions(scheme, "grid_island_of_one", grid,
                      [=](uint32_t f) { return f / per_quad == 5 ? 1u : 0u; });
    suite.add_regions(scheme, "grid_checkers", grid, [=](uint32_t f) { return (x(f) + y(f)) % 2; });
    suite.add_regions(scheme, "grid_all_apart", grid, [](uint32_t f) { return f; });
    suite.add_regions(scheme, "grid_corner", grid,
                      [=](uint32_t f) { return x(f) < 2 && y(f) < 2 ? 1u : 0u; });

    TestMesh creased = grid;
    creased.add_crease_path({10, 11, 12, 13, 14}, 1.4);
    suite.add(scheme, "grid_crease_and_seam", creased, path_seam({2, 7, 12, 17, 22}));
    suite.add(scheme, "grid_crease_under_seam", creased, path_seam({11, 12, 13, 14}));
    TestMesh sharp = grid;
    sharp.add_crease_path({10, 11, 12}, 10);
    sharp.add_corner(7, 0.6);
    sharp.add_corner(17, 2.2);
    suite.add(scheme, "grid_sharp_features", sharp, path_seam({7, 12, 17, 22}));
    TestMesh dart = grid;
    dart.add_crease_path({2, 7, 12}, 0.7);
    suite.add(scheme, "grid_dart_and_seam", dart, path_seam({22, 17, 12}));
    TestMesh chaikin = grid;
    chaikin.options.creasing = CreasingMethod::chaikin;
    for (uint32_t i = 0; i < 4; ++i) chaikin.add_crease(10 + i, 11 + i, 0.5 + 0.8 * i);
    suite.add(scheme, "grid_chaikin", chaikin, path_seam({10, 11, 12, 7, 2}));
    // Sharp edges on both sides of a seam that fade at different levels: each side waits for itself, not for
    // the other.
    for (const auto& [low, high] :
         {std::pair(2.0, 0.25), std::pair(0.25, 2.0), std::pair(3.0, 3.5), std::pair(0.5, 0.75)}) {
        const std::string suffix = name_of_number(low) + "_" + name_of_number(high);
        TestMesh fading = grid;
        fading.add_crease(7, 12, low);
        fading.add_crease(12, 17, high);
        suite.add(scheme, "grid_fading_" + suffix, fading, path_seam({10, 11, 12, 13, 14}));
        fading.options.creasing = CreasingMethod::chaikin;
        suite.add(scheme, "grid_fading_chaikin_" + suffix, fading, path_seam({10, 11, 12, 13, 14}));
    }
    // A crease on the seam itself that outlives, or not, the one that ends at it.
    for (const auto& [on_seam, beside] : {std::pair(2.0, 0.25), std::pair(3.5, 3.0), std::pair(0.25, 2.0)}) {
        TestMesh fading = grid;
        fading.add_crease(11, 12, on_seam);
        fading.add_crease(12, 17, beside);
        suite.add(scheme, "grid_fading_on_seam_" + name_of_number(on_seam) + "_" + name_of_number(beside),
                  fading, path_seam({10, 11, 12, 13, 14}));
    }
    // Chaikin creasing averages over the whole vertex, also where the channel is cut.
    TestMesh across = grid;
    across.options.creasing = CreasingMethod::chaikin;
    across.add_crease(2, 7, 4.1);
    across.add_crease(7, 12, 2.2);
    across.add_crease(12, 17, 3.6);
    suite.add(scheme, "grid_chaikin_across", across, path_seam({10, 11, 12, 13, 14}));
    suite.add(scheme, "grid_chaikin_along", across, path_seam({7, 12, 17}));
    suite.add(scheme, "grid_chaikin_corner", across, path_seam({10, 11, 12, 7, 2}));
    TestMesh holes = grid;
    holes.holes = {5, 10};
    suite.add(scheme, "grid_holes", holes, path_seam({6, 7, 12, 13}));
}

void add_solid_layouts(Suite& suite, Scheme scheme, const TestMesh& cube, const std::string& name) {
    suite.add(scheme, name + "_smooth", cube, no_seam);
    suite.add(scheme, name + "_seam", cube, path_seam({0, 1, 3}));
    suite.add(scheme, name + "_unfolded", cube, path_seam({0, 1, 3, 2, 6, 4, 0}));
    suite.add(scheme, name + "_spider", cube, [](uint32_t a, uint32_t b) { return (a == 0) != (b == 0); });
    suite.add_regions(scheme, name + "_two", cube, [](uint32_t f) { return f % 2; });
    suite.add_regions(scheme, name + "_apart", cube, [](uint32_t f) { return f; });
}

}  // namespace

std::vector<TestMesh> face_varying_shapes() {
    Suite suite;
    TestMesh triangle_cube = make_cube();
    triangle_cube.triangulate();
    for (Scheme scheme : {Scheme::catmull_clark, Scheme::bilinear}) {
        add_grid_layouts(suite, scheme, make_grid(4, 4), 1);
        add_solid_layouts(suite, scheme, make_cube(), "cube");
        add_solid_layouts(suite, scheme, make_prism(5), "prism");
        suite.add_regions(scheme, "star_5_sectors", make_quad_star(5, 2), [](uint32_t f) { return f / 8; });
        suite.add(scheme, "star_6_seam", make_quad_star(6, 2), path_seam({2, 1, 0, 3, 4}));
        suite.add(scheme, "star_3_dart", make_quad_star(3, 2), path_seam({2, 1, 0}));
        suite.add(scheme, "half_star_3_seam", make_quad_half_star(3, 2), path_seam({0, 3, 4}));
        suite.add_regions(scheme, "book", make_book(3, false), [](uint32_t f) { return f; });
        suite.add(scheme, "book_smooth", make_book(4, false), no_seam);
        TestMesh bow = make_grid(2, 2);
        append(bow, make_grid(2, 2), {{0, 8}});
        suite.add(scheme, "bow_tie", bow, no_seam);
        TestMesh shared = make_cube();
        append(shared, make_cube(), {{0, 3}, {4, 7}});
        suite.add(scheme, "cubes_sharing_an_edge", shared, path_seam({3, 7}));
        suite.add(scheme, "pyramid", make_pyramid(5), path_seam({1, 0, 3}));
        TestMesh bare = make_grid(2, 2);
        bare.add_vertex(4, 4, 4);
        suite.add(scheme, "unused_vertex", bare, path_seam({1, 4}));
    }
    add_grid_layouts(suite, Scheme::loop, make_triangle_grid(4, 4), 2);
    add_solid_layouts(suite, Scheme::loop, triangle_cube, "cube");
    add_solid_layouts(suite, Scheme::loop, make_icosahedron(), "icosahedron");
    suite.add_regions(Scheme::loop, "star_5_sectors", make_triangle_star(5, 2),
                      [](uint32_t f) { return f / 4; });
    suite.add(Scheme::loop, "star_8_seam", make_triangle_star(8, 2), path_seam({2, 1, 0, 7, 8}));
    suite.add(Scheme::loop, "half_star_4_seam", make_triangle_half_star(4, 2), path_seam({0, 3, 4}));
    suite.add_regions(Scheme::loop, "book", make_book(3, true), [](uint32_t f) { return f; });
    // Smooth triangles act on channels, too.
    TestMesh triangles = make_triangle_grid(4, 4);
    triangles.options.triangles = TriangleSubdivision::smooth;
    suite.add(Scheme::catmull_clark, "smooth_triangles", triangles, path_seam({10, 11, 12, 7}));
    return suite.shapes;
}

}  // namespace limn::test
