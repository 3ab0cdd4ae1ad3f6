// The program under schemes without patches.
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "limn/obj.h"
#include "limn/schemes/subdivision_scheme.h"
#include "program_fixture.h"

namespace limn {
namespace {

TEST_F(Program, lists_schemes) {
    const Outcome listed = run("schemes");
    EXPECT_EQ(listed.status, 0);
    for (const SubdivisionScheme& scheme : subdivision_schemes())
        EXPECT_NE(listed.output.find(std::string(scheme.name) + " "), std::string::npos) << scheme.name;
}

/// Every edge has two faces that pass it in opposite directions.
bool is_closed(const Model& mesh) {
    std::set<std::pair<uint32_t, uint32_t>> edges;
    size_t begin = 0;
    for (const uint32_t n : mesh.face_sizes) {
        for (size_t i = 0; i < n; ++i)
            if (!edges.insert({mesh.face_vertices[begin + i], mesh.face_vertices[begin + (i + 1) % n]}).second) return false;
        begin += n;
    }
    for (const auto& [a, b] : edges)
        if (edges.count({b, a}) == 0) return false;
    return true;
}

/// A cube, as the scheme takes it.
std::string cube_options(const SubdivisionScheme& scheme) {
    const std::string name = std::string(" --scheme ") + scheme.name;
    return scheme.faces == FaceKind::triangles ? name + " --triangulate" : name;
}

TEST_F(Program, refines_and_tessellates_by_schemes_of_every_split) {
    std::set<SplitKind> splits;
    for (const SubdivisionScheme& scheme : subdivision_schemes()) {
        if (!splits.insert(scheme.passes.back().split).second) continue;  // each by itself: tests of the library
        SCOPED_TRACE(scheme.name);
        const std::string options = cube_options(scheme);
        ASSERT_EQ(run("refine cube.obj --level 2 -o device.obj --validation" + options).status, 0) << read("err.txt");
        ASSERT_EQ(run("refine cube.obj --level 2 -o host.obj --device cpu" + options).status, 0) << read("err.txt");
        const auto device = read_obj(path("device.obj")), host = read_obj(path("host.obj"));
        ASSERT_TRUE(device && host);
        EXPECT_EQ(device->face_vertices, host->face_vertices);
        ASSERT_EQ(device->positions.size(), host->positions.size());
        for (size_t i = 0; i < host->positions.size(); ++i)
            ASSERT_NEAR(device->positions[i], host->positions[i], 4e-6) << i;
        EXPECT_TRUE(is_closed(*device));
        ASSERT_EQ(run("tessellate cube.obj --rate 4 -o triangles.obj --validation" + options).status, 0) << read("err.txt");
        const auto triangles = read_obj(path("triangles.obj"));
        ASSERT_TRUE(triangles);
        // With patches there are texture coordinates: seams have vertices of their own.
        const bool has_patches = scheme.creases != CreaseRules::none || scheme.name == std::string("doo-sabin");
        EXPECT_TRUE(is_closed(*triangles) || has_patches);
    }
}

TEST_F(Program, tessellates_schemes_as_finely_as_they_need) {
    for (const char* name : {"kobbelt", "butterfly --triangulate", "sqrt3 --triangulate", "4-8"}) {
        SCOPED_TRACE(name);
        const std::string options = std::string(" --scheme ") + name + " --chord-error ";
        size_t last = 0;
        for (const char* error : {"0.3", "0.03", "0.01"}) {
            ASSERT_EQ(run("tessellate cube.obj -o device.obj --validation" + options + error).status, 0) << read("err.txt");
            ASSERT_EQ(run("tessellate cube.obj -o host.obj --device cpu" + options + error).status, 0) << read("err.txt");
            const auto device = read_obj(path("device.obj")), host = read_obj(path("host.obj"));
            ASSERT_TRUE(device && host);
            EXPECT_TRUE(is_closed(*device));
            EXPECT_EQ(device->face_vertices, host->face_vertices);
            ASSERT_EQ(device->positions.size(), host->positions.size());
            for (size_t i = 0; i < host->positions.size(); ++i)
                ASSERT_NEAR(device->positions[i], host->positions[i], 4e-6) << i;
            EXPECT_GT(host->face_sizes.size(), last);
            last = host->face_sizes.size();
        }
        const Outcome limited = run("tessellate cube.obj -o some.obj --max-triangles 200" + options + "0.01");
        ASSERT_EQ(limited.status, 0) << limited.errors;
        EXPECT_NE(limited.output.find("rates scaled by 0."), std::string::npos) << limited.output;
        const auto some = read_obj(path("some.obj"));
        ASSERT_TRUE(some);
        EXPECT_LE(some->face_sizes.size(), 200u);
        EXPECT_TRUE(is_closed(*some));
    }
    EXPECT_NE(run("tessellate cube.obj -o some.obj --max-rate 2 --scheme sabin --chord-error 1e-4").errors.find("--max-rate"),
              std::string::npos);
    expect_failure("tessellate cube.obj --scheme sabin --chord-error 0.1 --max-triangles 3 -o result.obj", 1, "3 triangles");
    expect_failure("tessellate cube.obj --scheme sabin --pixel-error 1 -o result.obj", 2, "--chord-error");
}

TEST_F(Program, refines_to_the_limit_by_schemes) {
    // Limits do not depend on the level at which they are taken: vertices keep their numbers in primal schemes.
    for (const char* name : {"sqrt3 --triangulate", "averaging-3"}) {
        SCOPED_TRACE(name);
        const std::string options = std::string(" --limit --scheme ") + name;
        ASSERT_EQ(run("refine cube.obj --level 1 -o coarse.obj" + options).status, 0) << read("err.txt");
        ASSERT_EQ(run("refine cube.obj --level 3 -o fine.obj" + options).status, 0) << read("err.txt");
        const auto coarse = read_obj(path("coarse.obj")), fine = read_obj(path("fine.obj"));
        ASSERT_TRUE(coarse && fine);
        size_t found = 0;
        for (size_t v = 0; v < 24; v += 3) {
            double nearest = 1;
            for (size_t w = 0; w < fine->positions.size(); w += 3) {
                double sum = 0;
                for (size_t k = 0; k < 3; ++k)
                    sum += std::pow(double{coarse->positions[v + k]} - double{fine->positions[w + k]}, 2);
                nearest = std::min(nearest, std::sqrt(sum));
            }
            found += nearest < 1e-5;
        }
        EXPECT_EQ(found, 8u);
    }
}

TEST_F(Program, says_which_schemes_a_command_takes) {
    expect_failure("refine cube.obj --level 1 --scheme doo -o result.obj", 2, "limn schemes");
    expect_failure("bake cube.obj --scheme kobbelt -o result.limn", 2, "limn bake takes no 'kobbelt': catmark, loop, bilinear, doo-sabin");
    const Outcome info = run("info cube.obj --scheme butterfly --triangulate");
    ASSERT_EQ(info.status, 0) << info.errors;
    EXPECT_NE(info.output.find("Modified Butterfly has no patches"), std::string::npos) << info.output;
    const auto json = nlohmann::json::parse(run("info cube.obj --scheme kobbelt --json").output);
    EXPECT_GT(json.at("level1_stencil_bytes").get<int>(), 0);
    EXPECT_TRUE(json.at("patch_table_bytes").is_null());
    EXPECT_GT(nlohmann::json::parse(run("info cube.obj --scheme doo-sabin --json").output).at("level1_stencil_bytes"), 0);
    expect_failure("check cube.obj --scheme doo-sabin", 2, "limn check takes no 'doo-sabin': catmark, loop, bilinear");
    expect_failure("refine cube.obj --level 1 --scheme sqrt3 -o result.obj", 1,
                   "cube.obj:13: sqrt(3) takes triangles only: face 0 has 4 vertices (--triangulate cuts it)");
    expect_failure("tessellate cube.obj --scheme mid-edge --chord-error 0.1 -o result.obj", 2, "--rate");
    expect_failure("tessellate cube.obj --scheme kobbelt --max-triangles 10 -o result.obj", 2, "--rate");
    expect_failure("tessellate cube.obj --scheme loop --triangulate --quads -o result.obj", 2, "--quads");
    write("book.obj", "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    expect_failure("refine book.obj --level 1 --scheme doo-sabin -o result.obj", 1, "three faces");
    write("hole.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt hole 1/0/0 0\n");
    expect_failure("refine hole.obj --level 1 --scheme doo-sabin -o result.obj", 1, "holes");
}

TEST_F(Program, cuts_faces_for_schemes_that_want_others) {
    write("prism.obj",
          "v 0 0 0\nv 2 0 0\nv 3 2 0\nv 1 3 0\nv -1 2 0\nv 0 0 1\nv 2 0 1\nv 3 2 1\nv 1 3 1\nv -1 2 1\n"
          "f 5 4 3 2 1\nf 6 7 8 9 10\nf 1 2 7 6\nf 2 3 8 7\nf 3 4 9 8\nf 4 5 10 9\nf 5 1 6 10\nt crease 3/2/0 0 1 2 2 3\n");
    ASSERT_EQ(run("refine prism.obj --level 0 --triangulate -o triangles.obj").status, 0) << read("err.txt");
    ASSERT_EQ(run("refine prism.obj --level 0 --quads -o quads.obj").status, 0) << read("err.txt");
    const auto triangles = read_obj(path("triangles.obj")), quads = read_obj(path("quads.obj"));
    ASSERT_TRUE(triangles && quads);
    EXPECT_EQ(triangles->face_sizes, std::vector<uint32_t>(16, 3));
    EXPECT_EQ(quads->face_sizes, std::vector<uint32_t>(30, 4));
    EXPECT_EQ(quads->vertex_count(), 10u + 15 + 7);
    EXPECT_TRUE(is_closed(*triangles));
    EXPECT_TRUE(is_closed(*quads));
}

TEST_F(Program, analyzes_schemes) {
    const Outcome one = run("analyze --scheme catmark --valence 5 -o map.svg");
    ASSERT_EQ(one.status, 0) << one.errors;
    EXPECT_NE(one.output.find("0.549988"), std::string::npos) << one.output;  // schemes.md 4.2
    EXPECT_NE(read("map.svg").find("<svg"), std::string::npos);
    EXPECT_NE(read("map.svg").find("</svg>"), std::string::npos);
    const Outcome all = run("analyze --scheme doo-sabin --json");
    ASSERT_EQ(all.status, 0) << all.errors;
    EXPECT_NE(all.output.find("0.5"), std::string::npos);
    ASSERT_EQ(run("analyze --scheme sqrt3 --valence 6 -o map.png").status, 0) << read("err.txt");
    EXPECT_EQ(read("map.png").substr(1, 3), "PNG");
    const Outcome crease = run("analyze --scheme loop --valence 7 --crease 3 -o crease.png");
    ASSERT_EQ(crease.status, 0) << crease.errors;
    EXPECT_NE(crease.output.find("side of 3 faces of 7"), std::string::npos) << crease.output;
    EXPECT_NE(crease.output.find("side of 4 faces of 7"), std::string::npos) << crease.output;
    EXPECT_EQ(run("analyze --scheme catmark --valence 5 --dart").status, 0);
    expect_failure("analyze --scheme sqrt3 --valence 6 --crease 3", 1, "no rules for creases");
    expect_failure("analyze --scheme loop --valence 6 --crease 6", 1, "both of its sides");
    expect_failure("analyze --scheme loop --crease 3", 2, "--valence");
    expect_failure("analyze --scheme nothing", 2, "nothing");
    expect_failure("analyze --scheme loop --valence 2", 2, "valence");
    expect_failure("analyze --scheme loop --valence 5 -o nowhere/result.svg", 1, "nowhere/result.svg");
}

TEST_F(Program, takes_knot_intervals_of_edges) {
    write("even.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 1\nv 1 1 0\nv 2 1 1\nv 0 2 0\nv 1 2 1\nv 2 2 0\n"
                      "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\n");
    write("uneven.obj", read("even.obj") + "t interval 2/1/0 4 5 3\nt interval 2/1/0 1 2 3\nt interval 2/1/0 7 8 3\n");
    for (const char* name : {"even", "uneven"})
        ASSERT_EQ(run(std::string("refine ") + name + ".obj --scheme nurss --level 2 -o " + name + "_2.obj").status, 0) << read("err.txt");
    EXPECT_NE(read("even_2.obj"), read("uneven_2.obj"));
    ASSERT_EQ(run("refine even.obj --scheme catmark --level 2 -o catmark_2.obj").status, 0);
    const auto a = read_obj(path("even_2.obj")), b = read_obj(path("catmark_2.obj"));
    ASSERT_TRUE(a && b);
    ASSERT_EQ(a->positions.size(), b->positions.size());
    for (size_t i = 0; i < a->positions.size(); ++i) EXPECT_NEAR(a->positions[i], b->positions[i], 2e-6);
}

TEST_F(Program, evaluates_schemes_by_limit_stencils) {
    write("samples.csv", "0,0,0\n0,0.5,0.5\n5,0.25,0.75\n9,0,0\n0,2,0\n");
    ASSERT_EQ(run("eval cube.obj --scheme kobbelt --at samples.csv -o device.csv --validation").status, 0) << read("err.txt");
    ASSERT_EQ(run("eval cube.obj --scheme kobbelt --at samples.csv -o host.csv --device cpu").status, 0) << read("err.txt");
    const std::string device = read("device.csv");
    EXPECT_EQ(device.substr(0, device.find('\n')), "face,u,v,px,py,pz,nx,ny,nz,status");
    EXPECT_NE(device.find("0,0,0,-1,-1,1,"), std::string::npos) << "the scheme interpolates\n" << device;
    EXPECT_NE(device.find("9,0,0,0,0,0,0,0,0,out_of_range"), std::string::npos) << device;
    EXPECT_EQ(std::count(device.begin(), device.end(), '\n'), 6);
    const std::string host = read("host.csv");
    EXPECT_EQ(std::count(host.begin(), host.end(), '\n'), 6);
    write("plain.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    expect_failure("eval plain.obj --scheme mid-edge --at samples.csv -o result.csv", 1, "no coordinates");
    expect_failure("eval cube.obj --scheme kobbelt --texture --at samples.csv -o result.csv", 2, "no patches");
}

TEST_F(Program, evaluates_doo_sabin_by_patches) {
    write("pyramid.obj",
          "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 2 4\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
    write("samples.csv", "0,0.5,0.5\n1,1,1\n");  // the middles of the square and of a triangle stay
    const std::string options = " --scheme doo-sabin";
    for (const char* device : {" --validation", " --device cpu"}) {
        ASSERT_EQ(run("eval pyramid.obj --at samples.csv -o at.csv" + options + device).status, 0) << read("err.txt");
        const std::string rows = read("at.csv");
        float x[2][3] = {};
        for (size_t row = 0, at = 0; row < 2; ++row) {
            at = rows.find('\n', at) + 1;
            ASSERT_EQ(std::sscanf(rows.c_str() + at, "%*u,%*f,%*f,%f,%f,%f", &x[row][0], &x[row][1], &x[row][2]), 3) << rows;
        }
        const float expected[2][3] = {{2, 2, 0}, {2, 2.0f / 3, 4.0f / 3}};
        for (size_t row = 0; row < 2; ++row)
            for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(x[row][k], expected[row][k], 1e-5f);
        ASSERT_EQ(run("tessellate pyramid.obj --chord-error 0.05 -o triangles.obj" + options + device).status, 0) << read("err.txt");
        const auto triangles = read_obj(path("triangles.obj"));
        ASSERT_TRUE(triangles);
        EXPECT_TRUE(is_closed(*triangles));
    }
    ASSERT_EQ(run("bake pyramid.obj -o pyramid.limn" + options).status, 0) << read("err.txt");
    ASSERT_EQ(run("eval pyramid.limn --at samples.csv -o baked.csv --device cpu").status, 0) << read("err.txt");
    EXPECT_EQ(read("baked.csv"), read("at.csv"));
    EXPECT_EQ(run("info pyramid.obj" + options).status, 0);
    // At boundaries there are no patches, but refinement.
    write("open.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    EXPECT_EQ(run("tessellate open.obj --rate 4 -o open_triangles.obj" + options).status, 0) << read("err.txt");
    expect_failure("tessellate open.obj --chord-error 0.1 -o result.obj" + options, 2, "--rate");
    expect_failure("bake open.obj -o result.limn" + options, 1, "boundaries");
    expect_failure("eval open.obj --at samples.csv -o result.csv" + options, 1, "boundaries");
}

#ifdef LIMN_HAVE_WINDOW

TEST_F(Program, draws_a_gallery) {
    const Outcome drawn = run("gallery cube.obj -o gallery.png --size 64x48 --columns 2 --rate 2 --schemes doo-sabin,sqrt3,catmark --validation");
    ASSERT_EQ(drawn.status, 0) << drawn.errors;
    const std::string png = read("gallery.png");
    ASSERT_GT(png.size(), 24u);
    const auto number = [&](size_t at) { return static_cast<uint8_t>(png[at]) * 256 + static_cast<uint8_t>(png[at + 1]); };
    EXPECT_EQ(number(18), 2 * 64);
    EXPECT_EQ(number(22), 2 * 48);
    expect_failure("gallery cube.obj -o result.png --schemes nothing", 2, "nothing");
    expect_failure("gallery cube.obj -o result.png --color level", 2, "--color level");
    expect_failure("gallery missing.obj -o result.png", 1, "missing.obj");
}

#endif

}  // namespace
}  // namespace limn
