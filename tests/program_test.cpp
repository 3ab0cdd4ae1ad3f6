// The program as scripts see it: exit statuses, one-line errors, files.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <sstream>
#include <utility>
#include <vector>

#include "limn/obj.h"
#include "program_fixture.h"

namespace limn {
namespace {

TEST_F(Program, says_what_a_model_is_made_of) {
    const Outcome text = run("info cube.obj");
    EXPECT_EQ(text.status, 0);
    EXPECT_NE(text.output.find("8 vertices, 12 edges, 6 faces"), std::string::npos) << text.output;
    EXPECT_NE(text.output.find("semi-sharp edges: 1"), std::string::npos);
    const Outcome json = run("info cube.obj --json");
    EXPECT_EQ(json.status, 0);
    EXPECT_NE(json.output.find("\"largest_finite_sharpness\": 2.5"), std::string::npos) << json.output;
    EXPECT_NE(json.output.find("\"edges\": 12"), std::string::npos);
}

TEST_F(Program, says_what_a_patch_table_takes) {
    const Outcome text = run("info cube.obj");
    EXPECT_NE(text.output.find("limit surface: 6 ptex faces, 24 surfaces, "), std::string::npos);
    EXPECT_NE(text.output.find("texture coordinates, patch table: "), std::string::npos) << text.output;
    const Outcome json = run("info cube.obj --json");
    for (const char* key : {"ptex_faces\": 6", "surfaces\": 24",
                            "plans\": ", "largest_ring\": ", "level1_points\": 26", "patch_table_bytes\": ",
                            "plan_bytes\": ", "texture_surfaces\": 6", "texture_patch_table_bytes\": "})
        EXPECT_NE(json.output.find(std::string("\"") + key), std::string::npos) << key << json.output;
    // What has no patch table is told about all the same.
    const Outcome chaikin = run("info cube.obj --json --creasing chaikin --fvar none");
    EXPECT_EQ(chaikin.status, 0) << chaikin.errors;
    EXPECT_NE(chaikin.output.find("\"texture_surfaces\": null"), std::string::npos) << chaikin.output;
    // Linear channels take no notice of creases.
    const Outcome linear = run("info cube.obj --json --creasing chaikin --fvar all");
    EXPECT_NE(linear.output.find("\"texture_surfaces\": 6"), std::string::npos) << linear.output;
}

TEST_F(Program, refines_on_the_device_as_on_the_host) {
    for (const char* more : {"", " --limit", " --scheme bilinear", " --boundary none --creasing chaikin"}) {
        SCOPED_TRACE(more);
        ASSERT_EQ(run(std::string("refine cube.obj --level 3 -o device.obj --validation") + more).status, 0);
        ASSERT_EQ(run(std::string("refine cube.obj --level 3 -o host.obj --device cpu") + more).status, 0);
        const auto device = read_obj(path("device.obj")), host = read_obj(path("host.obj"));
        ASSERT_TRUE(device && host);
        EXPECT_EQ(device->face_vertices, host->face_vertices);
        EXPECT_EQ(device->face_count(), 6u * 64);
        EXPECT_EQ(device->face_texture_coordinates.size(), device->face_vertices.size());
        ASSERT_EQ(device->positions.size(), host->positions.size());
        for (size_t i = 0; i < device->positions.size(); ++i)
            EXPECT_NEAR(device->positions[i], host->positions[i], 4e-6);
    }
}

TEST_F(Program, level_zero_keeps_the_mesh_or_moves_it_to_the_limit) {
    ASSERT_EQ(run("refine cube.obj --level 0 -o same.obj").status, 0);
    const auto same = read_obj(path("same.obj")), cube = read_obj(path("cube.obj"));
    ASSERT_TRUE(same && cube);
    EXPECT_EQ(same->positions, cube->positions);
    EXPECT_EQ(same->face_vertices, cube->face_vertices);
    // The limit of vertex 0 does not depend on the level that it is asked at.
    ASSERT_EQ(run("refine cube.obj --level 0 --limit -o limit0.obj").status, 0);
    ASSERT_EQ(run("refine cube.obj --level 4 --limit -o limit4.obj").status, 0);
    const auto limit0 = read_obj(path("limit0.obj")), limit4 = read_obj(path("limit4.obj"));
    ASSERT_TRUE(limit0 && limit4);
    for (size_t i = 0; i < 24; ++i) EXPECT_NEAR(limit0->positions[i], limit4->positions[i], 2e-6);
}

TEST_F(Program, writes_ply) {
    ASSERT_EQ(run("refine cube.obj --level 2 --limit -o cube.ply").status, 0);
    const std::string ply = read("cube.ply");
    EXPECT_EQ(ply.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0u);
    EXPECT_NE(ply.find("element face 96\n"), std::string::npos);
}

TEST_F(Program, leaves_out_holes) {
    write("holes.obj", std::string(kCube) + "t hole 1/0/0 0\n");
    ASSERT_EQ(run("refine holes.obj --level 2 -o holes2.obj").status, 0);
    const auto refined = read_obj(path("holes2.obj"));
    ASSERT_TRUE(refined);
    EXPECT_EQ(refined->face_count(), 5u * 16);
}

TEST_F(Program, agrees_with_opensubdiv) {
    const Outcome outcome = run("check cube.obj cube.obj --level 4");
    EXPECT_EQ(outcome.status, 0) << outcome.output << outcome.errors;
    EXPECT_NE(outcome.output.find("all within tolerance"), std::string::npos);
    EXPECT_NE(outcome.output.find("texture coordinates"), std::string::npos);
    for (const char* row : {"device points", "device derivatives", "device 2nd derivatives", "device normals",
                            "device limits", "surface, texture", "device texture"})
        EXPECT_NE(outcome.output.find(row), std::string::npos) << row;
}

TEST_F(Program, agrees_with_opensubdiv_about_the_demo_model) {
    const Outcome outcome = run("check " LIMN_DEMO_MODEL " --validation");
    EXPECT_EQ(outcome.status, 0) << outcome.output << outcome.errors;
}

TEST_F(Program, checks_the_limit_surface) {
    // A polygon, an infinite dart, a hole and a boundary.
    write("mixed.obj",
          "v 0 0 0\nv 1 0 0.2\nv 2 0 0\nv 0 1 0.3\nv 1 1 0\nv 2 1 0.1\nv 0 2 0\nv 1 2 0.4\nv 2 2 0\nv 3 1 0\n"
          "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\nf 3 10 9 6\nt crease 2/1/0 3 4 10\nt hole 1/0/0 1\n");
    write("loop.obj", "v 0 0 0\nv 1 0 0.2\nv 0 1 0.3\nv 0.3 0.3 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    for (const char* model :
         {"cube.obj", "mixed.obj", "loop.obj --scheme loop", "cube.obj --scheme bilinear"}) {
        const Outcome outcome = run(std::string("check --device cpu ") + model);
        EXPECT_EQ(outcome.status, 0) << model << outcome.output << outcome.errors;
        for (const char* row : {"surface points", "surface derivatives", "surface 2nd derivatives",
                                "surface normals", "float table, points", "surface, level-3 limits"})
            EXPECT_NE(outcome.output.find(row), std::string::npos) << model << ": " << row;
        EXPECT_EQ(outcome.output.find(" OUT"), std::string::npos) << outcome.output;
    }
    const Outcome mixed = run("check --device cpu mixed.obj");
    EXPECT_NE(mixed.output.find("points, irregular"), std::string::npos) << mixed.output;
    EXPECT_NE(mixed.output.find("Bfr"), std::string::npos) << mixed.output;
    // Where OpenSubdiv's patches are no reference, the program says so.
    const Outcome chaikin = run("check --device cpu cube.obj --creasing chaikin");
    EXPECT_EQ(chaikin.status, 0) << chaikin.output << chaikin.errors;
    EXPECT_NE(chaikin.output.find("Chaikin creases: "), std::string::npos) << chaikin.output;
    EXPECT_EQ(chaikin.output.find("surface points"), std::string::npos) << chaikin.output;
}

/// A CSV file: what stands between commas, line by line.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(text);
    for (std::string line, word; std::getline(lines, line);) {
        std::istringstream words(line);
        for (rows.emplace_back(); std::getline(words, word, ',');) rows.back().push_back(word);
    }
    return rows;
}

constexpr const char* kEvalHeader =
    "face,u,v,px,py,pz,dux,duy,duz,dvx,dvy,dvz,duux,duuy,duuz,duvx,duvy,duvz,dvvx,dvvy,dvvz,status\n";

TEST_F(Program, writes_curvatures) {
    std::string samples = "face,u,v\n";
    for (int i = 0; i < 60; ++i)
        samples += std::to_string(i % 6) + "," + std::to_string(0.05 + i % 10 / 11.0) + "," +
                   std::to_string(0.05 + i % 7 / 8.0) + "\n";
    write("samples.csv", samples + "9,0,0\n");
    const std::string eval = "eval cube.obj --at samples.csv --curvature ";
    ASSERT_EQ(run(eval + "-o device.csv --validation").status, 0) << read("err.txt");
    ASSERT_EQ(run(eval + "-o host.csv --device cpu").status, 0) << read("err.txt");
    const auto device = parse_csv(read("device.csv")), host = parse_csv(read("host.csv"));
    ASSERT_EQ(device.size(), 62u);
    ASSERT_EQ(host.size(), 62u);
    const std::vector<std::string> names = {"gaussian", "mean", "k1",  "k2",  "d1x",   "d1y",
                                            "d1z",      "d2x",  "d2y", "d2z", "status"};
    ASSERT_EQ(host[0].size(), 32u);
    EXPECT_EQ(std::vector<std::string>(host[0].begin() + 21, host[0].end()), names);
    EXPECT_EQ(device[0], host[0]);
    for (size_t r = 1; r < 62; ++r) {
        ASSERT_EQ(device[r].size(), 32u);
        EXPECT_EQ(device[r][31], r < 61 ? "valid" : "out_of_range");
        double a[10], b[10];
        for (size_t k = 0; k < 10; ++k) {
            a[k] = std::stod(device[r][21 + k]);
            b[k] = std::stod(host[r][21 + k]);
        }
        const double largest = std::max({std::abs(b[2]), std::abs(b[3]), 1e-3});
        EXPECT_NEAR(a[0], b[0], 1e-3 * largest * largest);
        for (size_t k = 1; k < 4; ++k) EXPECT_NEAR(a[k], b[k], 1e-3 * largest);
        EXPECT_NEAR(b[0], b[2] * b[3], 1e-4 * largest * largest);
        EXPECT_NEAR(2 * b[1], b[2] + b[3], 1e-4 * largest);
        EXPECT_GE(b[2], b[3]);
        if (r == 61) {
            for (const double x : b) EXPECT_EQ(x, 0);
        } else {
            EXPECT_NEAR(b[4] * b[7] + b[5] * b[8] + b[6] * b[9], 0, 1e-5);
        }
    }
    EXPECT_EQ(run(eval + "--texture -o no.csv").status, 2);
}

TEST_F(Program, converts_surfaces_to_control_meshes_and_back) {
    // Two patches beside each other with a crease between them, clamped.
    std::string surface;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 7; ++i)
            surface += "v " + std::to_string(i) + " " + std::to_string(j) + " " + std::to_string((i * i + 3 * j) % 5) + "\n";
    surface += "cstype bspline\ndeg 3 3\nsurf 0 2 0 1";
    for (int i = 1; i <= 28; ++i) surface += " " + std::to_string(i);
    surface += "\nparm u 0 0 0 0 1 1 1 2 2 2 2\nparm v 0 0 0 0 1 1 1 1\nend\n";
    write("surface.obj", surface);
    const Outcome outcome = run("nurbs surface.obj -o mesh.obj");
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_EQ(outcome.output, "mesh.obj: 1 surface in 2 parts, 18 faces\n");
    // Corners of Bezier patches are control points: (0, 0) and where the patches meet, from both sides.
    write("samples.csv", "4,0,0\n4,1,0\n13,0,0\n13,1,1\n0,0.5,0.5\n");
    ASSERT_EQ(run("eval mesh.obj --at samples.csv -o out.csv --device cpu").status, 0);
    const auto rows = parse_csv(read("out.csv"));
    ASSERT_EQ(rows.size(), 6u);
    const double expected[4][3] = {{0, 0, 0}, {3, 0, 4}, {3, 0, 4}, {6, 3, (36 + 9) % 5}};
    for (size_t r = 0; r < 4; ++r)
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(std::stod(rows[r + 1][3 + c]), expected[r][c], 1e-5) << r;
    EXPECT_EQ(rows[5].back(), "hole");

    // A mesh of quads in rows, there and back.
    std::string mesh;
    for (int j = 0; j < 5; ++j)
        for (int i = 0; i < 6; ++i) mesh += "v " + std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(i * j % 3) + "\n";
    for (int j = 0; j < 4; ++j)
        for (int i = 1; i <= 5; ++i) {
            const int a = 6 * j + i;
            mesh += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + 7) + " " + std::to_string(a + 6) + "\n";
        }
    write("rows.obj", mesh + "t interpolateboundary 1/0/0 0\n");
    ASSERT_EQ(run("nurbs rows.obj -o rows_surface.obj").output, "rows_surface.obj: a surface of 6 by 5 control points\n");
    ASSERT_EQ(run("nurbs rows_surface.obj -o rows_again.obj").status, 0);
    const auto before = read_obj(path("rows.obj")), after = read_obj(path("rows_again.obj"));
    ASSERT_TRUE(before && after);
    EXPECT_EQ(before->positions, after->positions);
    EXPECT_EQ(before->face_vertices, after->face_vertices);

    EXPECT_EQ(run("nurbs cube.obj -o no.obj").status, 1);
    const std::string rational = surface.substr(0, surface.find('\n')) + " 2" + surface.substr(surface.find('\n'));
    write("rational.obj", std::string(rational).replace(rational.find("cstype "), 7, "cstype rat "));
    const Outcome refused = run("nurbs rational.obj -o no.obj");
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.errors.find("rational.obj: surface 1: its weights differ"), std::string::npos) << refused.errors;
    EXPECT_EQ(run("nurbs surface.obj").status, 2);
}

TEST_F(Program, evaluates_samples_on_the_device_as_on_the_host) {
    std::string samples = "face,u,v\n";
    for (int i = 0; i < 400; ++i)
        samples += std::to_string(i % 360) + "," + std::to_string(i * 7 % 20 / 20.0) + "," +
                   std::to_string(i * 3 % 17 / 17.0) + "\n";
    write("samples.csv", samples);
    const std::string eval = "eval " LIMN_DEMO_MODEL " --at samples.csv ";
    for (const std::string quantity : {"", "--texture"}) {
        SCOPED_TRACE(quantity);
        ASSERT_EQ(run(eval + quantity + " -o device.csv --validation").status, 0) << read("err.txt");
        ASSERT_EQ(run(eval + quantity + " -o host.csv --device cpu").status, 0) << read("err.txt");
        const auto device = parse_csv(read("device.csv")), host = parse_csv(read("host.csv"));
        ASSERT_EQ(device.size(), 401u);
        ASSERT_EQ(host.size(), 401u);
        EXPECT_EQ(device[0], host[0]);
        const size_t columns = 4 + 6 * (quantity.empty() ? 3 : 2);
        for (size_t r = 1; r < device.size(); ++r) {
            ASSERT_EQ(device[r].size(), columns);
            ASSERT_EQ(host[r].size(), columns);
            EXPECT_EQ(device[r][0], std::to_string((r - 1) % 360));
            EXPECT_EQ(device[r].back(), (r - 1) % 360 < 352 ? "valid" : "out_of_range");
            EXPECT_EQ(device[r].back(), host[r].back());
            for (size_t c = 3; c + 1 < columns; ++c) {
                // Rounding grows with the depth of the patch, for each order of derivatives.
                const size_t value = (c - 3) / (columns / 6);
                const double tolerance = value == 0 ? 4e-6 : value < 3 ? 2e-5 : 2e-3;
                EXPECT_NEAR(std::stof(device[r][c]), std::stof(host[r][c]), tolerance)
                    << r << " " << device[0][c];
            }
        }
    }
}

TEST_F(Program, evaluates_what_is_known_in_closed_form) {
    write("samples.csv", "1,0.25,0.75\n0,0.1,0.7\n");
    // Face 0 of the cube spans x and y at z = 1, its texture coordinates are u and v.
    const Outcome points = run("eval cube.obj --scheme bilinear --at samples.csv -o -");
    EXPECT_EQ(points.status, 0) << points.errors;
    const auto rows = parse_csv(points.output);
    ASSERT_EQ(rows.size(), 3u);
    const double expected[] = {0, 0.1, 0.7, -0.8, 0.4, 1, 2, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (size_t c = 0; c < 21; ++c) EXPECT_NEAR(std::stof(rows[2][c]), expected[c], 1e-6) << rows[0][c];
    EXPECT_EQ(std::stof(rows[2][1]), 0.1f);
    EXPECT_EQ(rows[1][0] + rows[1][1] + rows[1][2], "10.250.75");
    const Outcome texture = run("eval cube.obj --texture --at samples.csv -o -");
    EXPECT_EQ(texture.output.rfind("face,u,v,s,t,dus,dut,dvs,dvt,duus,duut,duvs,duvt,dvvs,dvvt,status\n", 0),
              0u)
        << texture.output;
    const auto st = parse_csv(texture.output);
    ASSERT_EQ(st.size(), 3u);
    const double coordinates[] = {0, 0.1, 0.7, 0.1, 0.7, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0};
    for (size_t c = 0; c < 15; ++c) EXPECT_NEAR(std::stof(st[2][c]), coordinates[c], 1e-6) << st[0][c];
}

TEST_F(Program, keeps_a_row_for_every_sample) {
    write("holes.obj", std::string(kCube) + "t hole 1/0/0 2\n");
    write("samples.csv",
          "\xef\xbb\xbf Face, U ,v\r\n2,0.5,0.5\r\n\n +0 , +0.5 ,5e-1\n6,0,0\n-1,0,0\n"
          "99999999999999999999,0,0\n4294967295,0,0\n0,nan,0\n0,0,inf\n0,1.001,0\n0,0,1e999\n0,1e-400,0");
    for (const std::string device : {"", " --device cpu"}) {
        const Outcome outcome = run("eval holes.obj --at samples.csv -o result.csv --validation" + device);
        EXPECT_EQ(outcome.status, 0) << outcome.errors;
        EXPECT_TRUE(outcome.output.empty() && outcome.errors.empty());
        const auto rows = parse_csv(read("result.csv"));
        const char* statuses[] = {"status",       "hole",         "valid",        "out_of_range",
                                  "out_of_range", "out_of_range", "out_of_range", "out_of_range",
                                  "out_of_range", "out_of_range", "out_of_range", "valid"};
        ASSERT_EQ(rows.size(), 12u);
        for (size_t r = 0; r < rows.size(); ++r) {
            ASSERT_EQ(rows[r].size(), 22u);
            EXPECT_EQ(rows[r].back(), statuses[r]) << r << device;
            if (r == 0 || rows[r].back() == "valid") continue;
            for (size_t c = 3; c < 21; ++c) EXPECT_EQ(rows[r][c], "0") << r << device;
        }
        EXPECT_EQ(rows[4][0], "-1");
        EXPECT_EQ(rows[7][1], "nan");
    }
}

TEST_F(Program, reads_and_writes_streams) {
    write("samples.csv", "face,u,v\n0,0.5,0.5\n");
    ASSERT_EQ(run("eval cube.obj --at samples.csv -o file.csv").status, 0);
    const Outcome stream = run("eval cube.obj --at - -o -", "samples.csv");
    EXPECT_EQ(stream.status, 0) << stream.errors;
    EXPECT_EQ(stream.output, read("file.csv"));
    EXPECT_EQ(stream.output.rfind(kEvalHeader, 0), 0u);
    // No samples are none to evaluate.
    const Outcome empty = run("eval cube.obj --at - -o -");
    EXPECT_EQ(empty.status, 0) << empty.errors;
    EXPECT_EQ(empty.output, kEvalHeader);
    // More than one block of input and one pass.
    {
        std::ofstream out(path("many.csv"));
        for (int i = 0; i < 300000; ++i) out << i % 7 << ",0.5,0.25\n";
    }
    ASSERT_EQ(run("eval cube.obj --at many.csv -o many_out.csv").status, 0) << read("err.txt");
    const auto rows = parse_csv(read("many_out.csv"));
    ASSERT_EQ(rows.size(), 300001u);
    for (size_t r = 1; r < rows.size(); ++r) {
        ASSERT_EQ(rows[r][0], std::to_string((r - 1) % 7)) << r;
        ASSERT_EQ(rows[r].back(), (r - 1) % 7 == 6 ? "out_of_range" : "valid") << r;
    }
}

TEST_F(Program, refuses_bad_samples_with_file_line_and_cause) {
    const std::string eval = "eval cube.obj --at samples.csv -o result.csv";
    for (const auto& [row, cause] : std::initializer_list<std::pair<std::string, std::string>>{
             {"0,0.5", "three values, not 2"},
             {"0,0.5,0.5,1", "three values, not 4"},
             {"one,0,0", "'one' is not a whole number"},
             {"1.5,0,0", "'1.5' is not a whole number"},
             {"0,,0", "u '' is not a number"},
             {"0,0,0x1p-1", "v '0x1p-1' is not a number"},
             {"face,u,v", "'face' is not a whole number"},
             {std::string(2 << 20, '0'), "too long"}}) {
        write("samples.csv", "face,u,v\n0,0,0\n\n" + row + "\n0,0,0\n");
        expect_failure(eval, 1, "samples.csv:4: ");
        expect_failure(eval, 1, cause);
        EXPECT_EQ(read("out.txt"), "");
    }
    expect_failure("eval cube.obj --at missing.csv -o result.csv", 1, "missing.csv: cannot open");
    expect_failure("eval cube.obj --at . -o result.csv", 1, ".: cannot read");
    write("samples.csv", "0,0,0\n");
    expect_failure("eval missing.obj --at samples.csv -o result.csv", 1, "missing.obj: ");
    expect_failure("eval cube.obj --at samples.csv -o nowhere/result.csv", 1, "nowhere/result.csv: ");
    expect_failure("eval cube.obj --at samples.csv -o /dev/full", 1, "/dev/full: cannot write");
    expect_failure(eval + " --device 99", 3, "99");
    write("plain.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    expect_failure("eval plain.obj --texture --at samples.csv -o result.csv", 1, "plain.obj: ");
    write("result_before.csv", "before");
    write("samples.csv", "0,0\n");
    EXPECT_EQ(run("eval cube.obj --at samples.csv -o result_before.csv").status, 1);
    EXPECT_EQ(read("result_before.csv"), "before");
}

TEST_F(Program, lists_devices) {
    const Outcome outcome = run("devices");
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_EQ(outcome.output.rfind("0  ", 0), 0u) << outcome.output;
}

TEST_F(Program, helps) {
    for (const char* arguments :
         {"--help", "refine --help", "eval --help", "check --help", "render --help", "view --help"}) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 0);
        EXPECT_NE(outcome.output.find("Usage"), std::string::npos);
        EXPECT_TRUE(outcome.errors.empty());
    }
    EXPECT_EQ(run("--version").output.rfind("limn ", 0), 0u);
}

TEST_F(Program, refuses_bad_usage) {
    expect_failure("", 2, "subcommand");
    expect_failure("frobnicate", 2, "frobnicate");
    expect_failure("refine cube.obj", 2, "output");
    expect_failure("refine cube.obj --level 11 -o result.obj", 2, "level");
    expect_failure("refine cube.obj -o result.stl", 2, "result.stl");
    expect_failure("refine cube.obj -o result.obj --scheme doo", 2, "scheme");
    expect_failure("refine cube.obj -o result.obj --device gpu", 2, "gpu");
    expect_failure("eval cube.obj -o result.csv", 2, "--at");
    expect_failure("eval cube.obj --at samples.csv", 2, "output");
}

TEST_F(Program, refuses_bad_input_with_file_line_and_cause) {
    expect_failure("refine missing.obj -o result.obj", 1, "missing.obj: ");
    write("broken.obj", "v 0 0 0\nv 1 0 0\nv x 1 0\nf 1 2 3\n");
    expect_failure("refine broken.obj -o result.obj", 1, "broken.obj:3: ");
    write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    expect_failure("info range.obj", 1, "range.obj:4: ");
    write("crease.obj",
          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt crease 2/1/0 0 1 1\nt crease 2/1/0 0 2 1\n");
    expect_failure("refine crease.obj -o result.obj", 1, "crease.obj:7: ");
    expect_failure("refine cube.obj --scheme loop -o result.obj", 1, "cube.obj:13: ");
    expect_failure("refine cube.obj -o nowhere/result.obj", 1, "nowhere/result.obj: ");
    expect_failure("check cube.obj missing.obj", 1, "missing.obj: ");
}

TEST_F(Program, says_when_there_is_no_such_device) {
    expect_failure("refine cube.obj -o result.obj --device 99", 3, "99");
}

TEST_F(Program, refuses_levels_that_do_not_fit) {
    std::string grid;
    for (int i = 0; i < 4; ++i) grid += "v " + std::to_string(i % 2) + " " + std::to_string(i / 2) + " 0\n";
    for (int i = 0; i < 3000; ++i) grid += "f 1 2 4 3\n";
    write("many.obj", grid);
    expect_failure("refine many.obj --level 10 -o result.obj", 1, "2^31 - 1");
}

#ifdef LIMN_HAVE_PICTURES

/// "WIDTHxHEIGHT" of a PNG file's bytes; empty where they are none.
std::string png_size(const std::string& bytes) {
    if (bytes.rfind("\x89PNG\r\n\x1a\n", 0) != 0 || bytes.size() < 24) return {};
    const auto number = [&](size_t at) {
        uint32_t value = 0;
        for (size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[i]);
        return std::to_string(value);
    };
    return number(16) + "x" + number(20);
}

TEST_F(Program, draws_pictures) {
    const std::string common = "render cube.obj --size 96x64 --rate 4 --validation -o ";
    const Outcome outcome = run(common + "plain.png");
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_TRUE(outcome.output.empty() && outcome.errors.empty()) << outcome.errors;
    EXPECT_EQ(png_size(read("plain.png")), "96x64");
    ASSERT_EQ(run(common + "again.png").status, 0);
    EXPECT_EQ(read("again.png"), read("plain.png"));
    // Modes and overlays one by one are what limn_viewer_test is for.
    for (const char* more : {"--wireframe --control-mesh", "--color level --camera 200,-10,3,60",
                             "--background '#ff8800' --no-ground --scheme bilinear", "--hardware-tessellation", "--color gaussian"}) {
        const Outcome other = run(common + "other.png " + more);
        EXPECT_EQ(other.status, 0) << more << ": " << other.errors;
        EXPECT_EQ(png_size(read("other.png")), "96x64") << more;
        EXPECT_NE(read("other.png"), read("plain.png")) << more;
    }
    EXPECT_EQ(run("render cube.obj --size 96x64 --validation -o other.png").status, 0);
    const Outcome times = run(common + "plain.png --times --device cpu");
    EXPECT_NE(times.output.find("192 triangles, 98 vertices"), std::string::npos) << times.output << times.errors;
    EXPECT_NE(times.output.find("picture"), std::string::npos) << times.output;
}

TEST_F(Program, refuses_bad_pictures) {
    for (const char* size : {"0x100", "100x0", "100", "x", "-1x5", "100x100x100", "9999999x10"})
        expect_failure("render cube.obj -o result.png --size " + std::string(size), 2, size);
    expect_failure("render cube.obj -o result.png --size 1000000x10", 2, "1000000x10");
    for (const char* camera : {"nan,0", "0,0,0", "0,inf", "0", "0,0,1,200", "0,100"})
        expect_failure("render cube.obj -o result.png --camera " + std::string(camera), 2, "camera");
    expect_failure("render cube.obj -o result.png --background mauve", 2, "mauve");
    expect_failure("render cube.obj -o result.png --color red", 2, "red");
    expect_failure("render cube.obj -o result.png --rate 65", 2, "rate");
    expect_failure("render cube.obj -o result.png --pixel-error 0", 2, "pixel-error");
    expect_failure("render cube.obj -o result.png --rate 4 --chord-error 0.1", 2, "rate");
    expect_failure("render cube.obj -o result.png --hardware-tessellation --wireframe", 2, "wireframe");
    expect_failure("render cube.obj -o result.png --hardware-tessellation --color level", 2, "level");
    expect_failure("render cube.obj", 2, "output");
    expect_failure("render missing.obj -o result.png", 1, "missing.obj: ");
    expect_failure("render cube.obj -o nowhere/result.png --size 16x16 --rate 1", 1, "nowhere/result.png: ");
    expect_failure("render cube.obj -o result.png --device 99", 3, "99");
    write("empty.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nt hole 1/0/0 0\n");
    expect_failure("render empty.obj -o result.png", 1, "no surface");
}

#endif
#ifdef LIMN_HAVE_WINDOW

TEST_F(Program, shows_a_window) {
    if (!has_display()) GTEST_SKIP() << kNoDisplay;
    const std::string look = "cube.obj --size 480x360 --rate 4 --validation ";
    const Outcome still = show(look + "--screenshot still.png --frames 2");
    ASSERT_EQ(still.status, 0) << still.output << still.errors;
    EXPECT_EQ(png_size(read("still.png")), "480x360");
    const Outcome moving = show(look + "--screenshot moving.png --frames 4 --animate --color level --wireframe");
    ASSERT_EQ(moving.status, 0) << moving.output << moving.errors;
    EXPECT_EQ(png_size(read("moving.png")), "480x360");
    EXPECT_NE(read("moving.png"), read("still.png"));
}

TEST_F(Program, says_when_there_is_no_display) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    expect_failure("view cube.obj", 3, "display");
    expect_failure("view cube.obj --screenshot result.png", 3, "display");
    expect_failure("view missing.obj", 1, "missing.obj: ");
    expect_failure("view cube.obj --frames 3", 2, "screenshot");
}

#endif

}  // namespace
}  // namespace limn
