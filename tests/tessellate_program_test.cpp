// limn tessellate as scripts see it: the files, what each option does to them, and what is refused.
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "files.h"
#include "limn/obj.h"
#include "program_fixture.h"

namespace limn {
namespace {

using Point = std::array<float, 3>;

/// A PLY file of triangles.
struct Triangles {
    std::vector<Point> positions, normals;
    std::vector<std::array<float, 2>> texture;
    std::vector<std::array<uint32_t, 3>> indices;

    std::array<Point, 3> corners(size_t t) const {
        return {positions[indices[t][0]], positions[indices[t][1]], positions[indices[t][2]]};
    }
};

Triangles read_ply(const std::string& bytes) {
    Triangles out;
    size_t vertices = 0, faces = 0, floats = 0;
    std::istringstream header(bytes);
    for (std::string line; std::getline(header, line) && line != "end_header";) {
        std::istringstream words(line);
        std::string keyword, name;
        words >> keyword >> name;
        if (keyword == "element") words >> (name == "vertex" ? vertices : faces);
        if (keyword == "property" && name == "float") ++floats;
    }
    EXPECT_TRUE(vertices == 0 || floats == 6 || floats == 8) << floats;
    ByteReader reader{bytes, static_cast<size_t>(header.tellg())};
    for (size_t v = 0; v < vertices; ++v) {
        for (auto* points : {&out.positions, &out.normals}) {
            const float x = reader.f32(), y = reader.f32(), z = reader.f32();
            points->push_back({x, y, z});
        }
        if (floats < 8) continue;
        const float s = reader.f32(), t = reader.f32();
        out.texture.push_back({s, t});
    }
    std::vector<bool> used(vertices);
    for (size_t f = 0; f < faces; ++f) {
        EXPECT_EQ(reader.byte(), 3u);
        std::array<uint32_t, 3> corners = {};
        for (uint32_t& corner : corners) {
            corner = reader.u32();
            used.at(corner) = true;
        }
        out.indices.push_back(corners);
    }
    EXPECT_EQ(reader.at, bytes.size());
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "vertices of no triangle";
    return out;
}

/// Edges that no other triangle has in the opposite direction; vertices of equal positions count as one.
size_t count_open_edges(const Triangles& mesh) {
    std::map<Point, uint32_t> numbers;
    std::map<std::pair<uint32_t, uint32_t>, int> balance;
    for (const auto& triangle : mesh.indices) {
        uint32_t v[3];
        for (size_t k = 0; k < 3; ++k)
            v[k] = numbers.try_emplace(mesh.positions[triangle[k]], static_cast<uint32_t>(numbers.size()))
                       .first->second;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = v[k], b = v[(k + 1) % 3];
            EXPECT_NE(a, b) << "a triangle without area";
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    return static_cast<size_t>(
        std::count_if(balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; }));
}

std::set<std::array<Point, 3>> triangles_of(const Triangles& mesh) {
    std::set<std::array<Point, 3>> out;
    for (size_t t = 0; t < mesh.indices.size(); ++t) out.insert(mesh.corners(t));
    return out;
}

class TessellateProgram : public Program {
  protected:
    /// What `limn tessellate` makes; the summary has the counts.
    Triangles tessellate(const std::string& arguments) const {
        SCOPED_TRACE(arguments);
        const Outcome outcome = run("tessellate " + arguments + " -o out.ply");
        EXPECT_EQ(outcome.status, 0) << outcome.errors;
        EXPECT_EQ(outcome.errors, "");
        const Triangles mesh = read_ply(contents(path("out.ply")));
        const std::string summary = "out.ply: " + std::to_string(mesh.indices.size()) + " triangles, " +
                                    std::to_string(mesh.positions.size()) + " vertices, by ";
        EXPECT_EQ(outcome.output.rfind(summary, 0), 0u) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1);
        return mesh;
    }
    size_t count(const std::string& arguments) const { return tessellate(arguments).indices.size(); }
    void expect_refusal(const std::string& arguments, int status, const std::string& cause) const {
        expect_failure("tessellate -o result.obj " + arguments, status, cause);
    }
};

void expect_near(const Triangles& a, const Triangles& b) {
    ASSERT_EQ(a.indices, b.indices);
    ASSERT_EQ(a.positions.size(), b.positions.size());
    ASSERT_EQ(a.texture.size(), b.texture.size());
    size_t turned = 0;
    for (size_t v = 0; v < a.positions.size(); ++v) {
        float cosine = 0;
        for (size_t k = 0; k < 3; ++k) {
            ASSERT_NEAR(a.positions[v][k], b.positions[v][k], 1e-5) << v;
            cosine += a.normals[v][k] * b.normals[v][k];
        }
        turned += cosine < 0.999f ? 1 : 0;
        for (size_t k = 0; k < (a.texture.empty() ? 0u : 2u); ++k)
            ASSERT_NEAR(a.texture[v][k], b.texture[v][k], 1e-5) << v;
    }
    EXPECT_LE(turned, a.positions.size() / 1000);  // where there is no tangent plane
}

TEST_F(TessellateProgram, gives_the_same_on_the_device_as_on_the_host) {
    write("loop.obj", "v 0 0 0\nv 1 0 0.2\nv 0 1 0.3\nv 0.3 0.3 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    for (const std::string model :
         {LIMN_DEMO_MODEL " --rate 5 --validation", LIMN_DEMO_MODEL " --rate 3.7 --spacing fractional",
          "cube.obj --uv none --rate 6 --spacing pow2", "loop.obj --scheme loop --rate 100"}) {
        SCOPED_TRACE(model);
        const Triangles device = tessellate(model), host = tessellate(model + " --device cpu");
        expect_near(device, host);
        EXPECT_EQ(count_open_edges(device), 0u);
        EXPECT_EQ(count_open_edges(host), 0u);
        EXPECT_EQ(device.texture.empty(), model.find("demo") == model.npos);
    }
}

TEST_F(TessellateProgram, puts_vertices_on_the_surface_with_normals_that_point_outward) {
    const Triangles mesh = tessellate("cube.obj --scheme bilinear --rate 4");
    ASSERT_EQ(mesh.positions.size(), 6u * 25);  // every edge of the cube is a crease, and a seam
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        float distance = 0, length = 0;
        for (size_t k = 0; k < 3; ++k) {
            distance += mesh.positions[v][k] * mesh.normals[v][k];
            length += std::abs(mesh.normals[v][k]);
        }
        EXPECT_NEAR(distance, 1, 1e-6);
        EXPECT_NEAR(length, 1, 1e-6);
    }
    for (size_t t = 0; t < mesh.indices.size(); ++t) {
        const auto [a, b, c] = mesh.corners(t);
        float volume = 0;
        for (size_t k = 0; k < 3; ++k) {
            const size_t l = (k + 1) % 3, m = (k + 2) % 3;
            volume += a[k] * (b[l] * c[m] - b[m] * c[l]);
        }
        EXPECT_NEAR(volume, 1.0 / 4, 1e-5);  // counter-clockwise from outside
    }
}

TEST_F(TessellateProgram, keeps_seams_of_texture_coordinates) {
    // Each face of the cube has all of the unit square to itself.
    for (const std::string device : {"", " --device cpu"}) {
        const Triangles mesh = tessellate("cube.obj --rate 4" + device);
        ASSERT_EQ(mesh.texture.size(), 6u * 25);
        std::map<std::array<float, 2>, int> places;
        for (const auto& place : mesh.texture) ++places[place];
        EXPECT_EQ(places.size(), 25u);
        for (const auto& [place, times] : places) EXPECT_EQ(times, 6) << place[0] << " " << place[1];
        EXPECT_EQ(count_open_edges(mesh), 0u);
    }
    EXPECT_EQ(tessellate("cube.obj --rate 4 --uv 0 --device cpu").texture.size(), 6u * 25);
    const Triangles plain = tessellate("cube.obj --rate 4 --uv none --device cpu");
    EXPECT_TRUE(plain.texture.empty());
    EXPECT_EQ(plain.positions.size(), 98u);
}

TEST_F(TessellateProgram, writes_every_format) {
    const std::string command = "tessellate cube.obj --rate 4 --device cpu -o ";
    for (const char* file : {"out.obj", "out.ply", "out.glb"})
        ASSERT_EQ(run(command + file).status, 0) << file;
    const Triangles ply = read_ply(contents(path("out.ply")));
    const auto obj = read_obj(path("out.obj"));
    ASSERT_TRUE(obj);
    ASSERT_EQ(obj->face_count(), ply.indices.size());
    EXPECT_EQ(obj->positions.size(), 3 * ply.positions.size());
    EXPECT_EQ(std::memcmp(obj->positions.data(), ply.positions.data(), obj->positions.size() * 4), 0);
    EXPECT_EQ(obj->texture_coordinates.size(), 2 * ply.texture.size());
    EXPECT_EQ(obj->face_texture_coordinates, obj->face_vertices);
    EXPECT_NE(read("out.obj").find("\nvn "), std::string::npos);
    const std::string glb = contents(path("out.glb"));
    EXPECT_EQ(glb.rfind("glTF", 0), 0u);
    for (const char* attribute : {"POSITION", "NORMAL", "TEXCOORD_0", "\"count\":150", "\"count\":576"})
        EXPECT_NE(glb.find(attribute), std::string::npos) << attribute;
}

TEST_F(TessellateProgram, does_as_the_options_say) {
    const auto on_host = [&](const std::string& options) {
        return count("cube.obj --device cpu " + options);
    };
    EXPECT_EQ(on_host(""), 6u * 64 * 2);
    EXPECT_EQ(on_host("--rate 1"), 12u);
    EXPECT_EQ(on_host("--rate 4"), 6u * 16 * 2);
    EXPECT_EQ(on_host("--rate 100"), 6u * 10000 * 2);
    EXPECT_EQ(on_host("--rate 5 --spacing pow2"), 6u * 16 * 2);
    EXPECT_EQ(on_host("--rate 3.2"), 6u * 9 * 2);
    EXPECT_EQ(on_host("--rate 3.2 --spacing fractional"), 6u * 16 * 2);
    EXPECT_EQ(on_host("--edge-pixels 0.01 --max-rate 4"), 6u * 16 * 2);

    // Rates go with the inverse of lengths and distances, and with the square root of errors.
    const auto expect_ratio = [&](const std::string& more, const std::string& less, double ratio) {
        const auto a = static_cast<double>(on_host(more)), b = static_cast<double>(on_host(less));
        EXPECT_NEAR(a / b, ratio, 0.25 * ratio) << more << ": " << a << ", " << less << ": " << b;
    };
    expect_ratio("--edge-pixels 8", "--edge-pixels 16", 4);
    expect_ratio("--edge-pixels 8 --size 1280x960", "--edge-pixels 8 --size 640x480", 4);
    expect_ratio("--edge-pixels 8 --camera 10,20,6", "--edge-pixels 8 --camera 10,20,12", 4);
    expect_ratio("--edge-pixels 8 --camera 10,20,6,30", "--edge-pixels 8 --camera 10,20,6,57", 4);
    expect_ratio("--pixel-error 0.05", "--pixel-error 0.2", 4);
    expect_ratio("--chord-error 0.001", "--chord-error 0.004", 4);
    expect_ratio("--distance 200", "--distance 100", 4);
    // And so they do on the device.
    for (const char* options :
         {"--edge-pixels 12 --camera=-40,70,5,40 --size 300x200", "--chord-error 0.001"}) {
        const auto device = static_cast<double>(count(std::string("cube.obj ") + options));
        const auto host = static_cast<double>(on_host(options));
        EXPECT_NEAR(device, host, 0.02 * host) << options;
    }
}

TEST_F(TessellateProgram, makes_triangles_where_they_are_needed) {
    const Triangles mesh = tessellate(LIMN_DEMO_MODEL " --device cpu --pixel-error 0.1");
    EXPECT_EQ(count_open_edges(mesh), 0u);
    const Triangles far = tessellate(LIMN_DEMO_MODEL
                                     " --device cpu --edge-pixels 3 --camera 0,0,1.2 --spacing "
                                     "fractional");
    EXPECT_EQ(count_open_edges(far), 0u);
}

TEST_F(TessellateProgram, fits_a_number_of_triangles) {
    for (const std::string device : {"", " --device cpu"}) {
        for (const size_t most : {3000u, 20000u}) {
            const Triangles mesh =
                tessellate(LIMN_DEMO_MODEL " --rate 20 --max-triangles " + std::to_string(most) + device);
            EXPECT_LE(mesh.indices.size(), most);
            EXPECT_GE(mesh.indices.size(), most * 9 / 10);
            EXPECT_EQ(count_open_edges(mesh), 0u);
            EXPECT_NE(read("out.txt").find(", rates scaled by 0."), std::string::npos) << read("out.txt");
        }
        EXPECT_EQ(count("cube.obj --rate 4 --max-triangles 192" + device), 192u);
        EXPECT_NE(read("out.txt").find(", rates scaled by 1\n"), std::string::npos) << read("out.txt");
        expect_refusal("cube.obj --max-triangles 11" + device, 1, "cube.obj: not even the least rates");
    }
    EXPECT_LE(count("cube.obj --device cpu --chord-error 1e-20 --max-triangles 1000"), 1000u);
}

TEST_F(TessellateProgram, culls_what_the_camera_does_not_see) {
    const auto all = triangles_of(tessellate(LIMN_DEMO_MODEL " --rate 4"));
    const auto model = read_obj(LIMN_DEMO_MODEL);
    ASSERT_TRUE(model);
    Point low = {1e9f, 1e9f, 1e9f}, high = {-1e9f, -1e9f, -1e9f};
    for (size_t i = 0; i < model->positions.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], model->positions[i]);
        high[i % 3] = std::max(high[i % 3], model->positions[i]);
    }
    // From in front, at two radii.
    Point eye;
    float diagonal = 0;
    for (size_t k = 0; k < 3; ++k) {
        eye[k] = (low[k] + high[k]) / 2;
        diagonal += (high[k] - low[k]) * (high[k] - low[k]);
    }
    eye[2] += std::sqrt(diagonal);
    const auto faces_eye = [&](const std::array<Point, 3>& t) {
        float volume = 0;
        for (size_t k = 0; k < 3; ++k) {
            const size_t l = (k + 1) % 3, m = (k + 2) % 3;
            volume += (t[0][k] - eye[k]) *
                      ((t[1][l] - eye[l]) * (t[2][m] - eye[m]) - (t[1][m] - eye[m]) * (t[2][l] - eye[l]));
        }
        return volume < 0;
    };
    for (const char* cull : {"outside", "backfaces", "outside,backfaces"}) {
        SCOPED_TRACE(cull);
        const auto left = triangles_of(
            tessellate(LIMN_DEMO_MODEL " --rate 4 --camera 0,0,2,10 --cull " + std::string(cull)));
        EXPECT_LT(left.size(), all.size());
        EXPECT_GT(left.size(), all.size() / 20);
        EXPECT_TRUE(std::includes(all.begin(), all.end(), left.begin(), left.end()));
        if (std::string(cull) != "backfaces") continue;
        for (const auto& triangle : all) EXPECT_TRUE(left.contains(triangle) || !faces_eye(triangle));
    }
    // Nothing to see is no error.
    EXPECT_EQ(count("cube.obj --scheme bilinear --cull backfaces --camera 0,0,2"), 5u * 128);
}

TEST_F(TessellateProgram, leaves_out_holes) {
    write("holes.obj", std::string(kCube) + "t hole 2/0/0 0 2\n");
    for (const std::string device : {"", " --device cpu"})
        EXPECT_EQ(count("holes.obj --rate 4" + device), 4u * 32);
    write("nothing.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nt hole 1/0/0 0\n");
    for (const std::string device : {"", " --device cpu"}) EXPECT_EQ(count("nothing.obj" + device), 0u);
}

TEST_F(TessellateProgram, goes_without_texture_coordinates_that_have_no_patch_table) {
    const Outcome outcome =
        run("tessellate cube.obj --creasing chaikin --fvar none --device cpu --rate 4 -o out.ply");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.errors.rfind("limn: cube.obj: goes without texture coordinates: ", 0), 0u)
        << outcome.errors;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1);
    EXPECT_TRUE(read_ply(contents(path("out.ply"))).texture.empty());
}

TEST_F(TessellateProgram, refuses_bad_usage) {
    expect_failure("tessellate cube.obj", 2, "output");
    expect_failure("tessellate cube.obj -o result.stl", 2, "result.stl");
    for (const char* option : {"--rate", "--pixel-error", "--edge-pixels", "--chord-error", "--distance"})
        for (const char* value : {"0", "-1", "nan", "inf", "1e40", "1e-50", "8x", "''"})
            expect_refusal(std::string("cube.obj ") + option + "=" + value, 2, option);
    expect_refusal("cube.obj --rate 129", 2, "129");
    expect_refusal("cube.obj --rate 0.5", 2, "0.5");
    expect_refusal("cube.obj --rate 4 --chord-error 0.1", 2, "--chord-error");
    expect_refusal("cube.obj --rate 20 --max-rate 16", 2, "--max-rate");
    for (const char* rate : {"0", "1", "129", "-4", "many"})
        expect_refusal(std::string("cube.obj --max-rate=") + rate, 2, "--max-rate");
    for (const char* most : {"0", "-1", "4294967295", "1e6", "99999999999999999999"})
        expect_refusal(std::string("cube.obj --max-triangles=") + most, 2, "--max-triangles");
    expect_refusal("cube.obj --spacing odd", 2, "--spacing");
    for (const char* camera :
         {"nan,0", "0,inf", "0", "0,100", "0,0,0", "0,0,-1", "0,0,1,0", "0,0,1,200", "0,0,1,2,3", "a,b"})
        expect_refusal(std::string("cube.obj --edge-pixels 8 --camera=") + camera, 2, "camera");
    for (const char* size : {"0x100", "100x0", "100", "x", "-1x5", "1x2x3", "9999999x10", "nanx5"})
        expect_refusal(std::string("cube.obj --size=") + size, 2, size);
    for (const char* cull : {"inside", "outside,", ",outside", "''"})
        expect_refusal(std::string("cube.obj --cull=") + cull, 2, "--cull");
    expect_refusal("cube.obj --cull outside --device cpu", 2, "--cull");
    for (const char* uv : {"-1", "some", "0.5"})
        expect_refusal(std::string("cube.obj --uv=") + uv, 2, "--uv");
    const Outcome help = run("tessellate --help");
    EXPECT_EQ(help.status, 0);
    EXPECT_NE(help.output.find("--chord-error"), std::string::npos);
}

TEST_F(TessellateProgram, refuses_bad_input_with_file_and_cause) {
    expect_refusal("missing.obj", 1, "missing.obj: ");
    expect_failure("tessellate cube.obj --device cpu -o nowhere/result.obj", 1, "nowhere/result.obj: ");
    expect_refusal("cube.obj --device 99", 3, "99");
    expect_refusal("cube.obj --uv 1 --device cpu", 1, "cube.obj: there is no channel 1");
    write("plain.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    expect_refusal("plain.obj --uv 0 --device cpu", 1, "plain.obj: not every corner");
    EXPECT_TRUE(tessellate("plain.obj --device cpu").texture.empty());
    write("huge.obj", "v -3e38 0 0\nv 3e38 0 0\nv 3e38 3e38 0\nv -3e38 3e38 0\nf 1 2 3 4\n");
    expect_refusal("huge.obj --edge-pixels 8 --device cpu", 1, "huge.obj: the camera");
}

TEST_F(TessellateProgram, refuses_more_triangles_than_indices_can_tell_apart) {
    constexpr int kSide = 220;
    std::ostringstream grid;
    for (int i = 0; i <= kSide; ++i)
        for (int j = 0; j <= kSide; ++j) grid << "v " << i << " " << j << " " << i * j % 3 << "\n";
    for (int i = 0; i < kSide; ++i)
        for (int j = 1; j <= kSide; ++j) {
            const int a = i * (kSide + 1) + j, b = a + kSide + 1;
            grid << "f " << a << " " << b << " " << b + 1 << " " << a + 1 << "\n";
        }
    write("grid.obj", grid.str());
    for (const std::string device : {"", " --device cpu"}) {
        expect_refusal("grid.obj --rate 128" + device, 1, "grid.obj: more than 2^32 indices");
        EXPECT_LE(count("grid.obj --rate 128 --max-triangles 200000" + device), 200000u);
    }
}

}  // namespace
}  // namespace limn
