// limn bake as scripts see it, and the commands that take what it writes in place of a model.
#include <sstream>

#include "files.h"
#include "program_fixture.h"

namespace limn {
namespace {

class BakeProgram : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        bake("cube.obj", "cube.limn");
    }
    void bake(const std::string& model, const std::string& output) const {
        const Outcome outcome = run("bake " + model + " -o " + output);
        EXPECT_EQ(outcome.status, 0) << outcome.errors;
        EXPECT_EQ(outcome.errors, "");
        EXPECT_EQ(outcome.output.rfind(output + ": ", 0), 0u) << outcome.output;
    }
    std::string made(const std::string& command, const std::string& name) const {
        const Outcome outcome = run(command + " -o " + name);
        EXPECT_EQ(outcome.status, 0) << command << ": " << outcome.errors;
        EXPECT_EQ(outcome.errors, "") << command;
        return read(name);
    }
};

TEST_F(BakeProgram, says_what_is_in_it) {
    bake("cube.obj --grid-rate 4 8 --refine-level 2 --max-rate 32", "all.limn");
    const Outcome text = run("info all.limn");
    EXPECT_EQ(text.status, 0) << text.errors;
    for (const char* part : {"baked, catmark, 8 vertices, 12 edges, 6 faces; rates up to 32; ",
                             "limit surface: 6 ptex faces, 24 surfaces, ", "texture coordinates: 6 ptex faces",
                             "grids of rate: 4 8\n", "refined points of level: 2\n", "key: "})
        EXPECT_NE(text.output.find(part), std::string::npos) << part << "\n" << text.output;
    const Outcome json = run("info all.limn --json");
    EXPECT_EQ(json.status, 0) << json.errors;
    for (const char* part :
         {"\"baked\": true", "\"faces\": 6", "\"max_rate\": 32", "\"scheme\": \"catmark\"", "\"surfaces\": 24",
          "\"texture_surfaces\": 6", "\"file_bytes\": ", "\"key\": \""})
        EXPECT_NE(json.output.find(part), std::string::npos) << part << "\n" << json.output;
    // Model and baked file have tables of the same size.
    const auto line = [](const std::string& text, const std::string& key) {
        const size_t at = text.find("\"" + key + "\"");
        return at == text.npos ? "no " + key : text.substr(at, text.find('\n', at) - at);
    };
    const Outcome model = run("info cube.obj --json");
    for (const char* key : {"patch_table_bytes", "texture_patch_table_bytes", "plans", "level1_points"})
        EXPECT_EQ(line(json.output, key), line(model.output, key));
}

TEST_F(BakeProgram, bakes_the_same_bytes_again) {
    bake("cube.obj", "again.limn");
    EXPECT_EQ(read("again.limn"), read("cube.limn"));
    bake("cube.obj --scheme bilinear", "again.limn");
    EXPECT_NE(read("again.limn"), read("cube.limn"));
}

TEST_F(BakeProgram, tessellates_as_the_model) {
    for (const char* options : {"--rate 5", "--device cpu", "--pixel-error 0.5 --size 320x240", "--max-triangles 500",
                                "--pixel-error 0.5 --device cpu --max-rate 16", "--spacing fractional --rate 3.5"}) {
        const std::string more = std::string(options) + (std::string(options).find("cpu") == std::string::npos ? " --validation" : "");
        for (const char* name : {"a.ply", "a.glb"})
            EXPECT_EQ(made("tessellate cube.limn " + more, name), made("tessellate cube.obj " + more, name)) << more;
    }
    // What the bake settles holds: another surface, other bytes.
    bake("cube.obj --boundary none --scheme bilinear --uv none", "flat.limn");
    EXPECT_EQ(made("tessellate flat.limn", "a.obj"),
              made("tessellate cube.obj --boundary none --scheme bilinear --uv none", "a.obj"));
    EXPECT_NE(made("tessellate flat.limn", "a.obj"), made("tessellate cube.limn", "a.obj"));
}

TEST_F(BakeProgram, evaluates_as_the_model) {
    write("places.csv", "face,u,v\n0,0,0\n0,0.5,0.25\n5,1,1\n3,0.125,0.75\n6,0,0\n2,-1,0\n");
    for (const std::string options : {"", " --texture"})
        for (const char* device : {" --device cpu", " --validation"}) {
            const std::string rest = " --at places.csv" + options + device;
            const std::string rows = made("eval cube.obj" + rest, "a.csv");
            EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 7);
            EXPECT_EQ(made("eval cube.limn" + rest, "a.csv"), rows) << rest;
        }
    bake("cube.obj --scheme bilinear --uv none", "flat.limn");
    EXPECT_NE(made("eval flat.limn --at places.csv", "a.csv"), made("eval cube.limn --at places.csv", "a.csv"));
    expect_failure("eval flat.limn --at places.csv --texture -o result.csv", 1,
                   "flat.limn: was baked without texture coordinates");
}

TEST_F(BakeProgram, needs_no_model) {
    std::filesystem::remove(path("cube.obj"));
    EXPECT_FALSE(made("tessellate cube.limn --device cpu", "a.ply").empty());
    write("places.csv", "0,0,0\n");
    EXPECT_FALSE(made("eval cube.limn --at places.csv", "a.csv").empty());
}

TEST_F(BakeProgram, keeps_rates_within_those_it_was_baked_for) {
    bake("cube.obj --max-rate 8", "few.limn");
    EXPECT_FALSE(made("tessellate few.limn --rate 8", "a.ply").empty());
    EXPECT_FALSE(made("tessellate few.limn --pixel-error 0.01", "a.ply").empty());
    expect_failure("tessellate few.limn --rate 9 -o result.ply", 1, "baked for rates up to 8");
#ifdef LIMN_HAVE_WINDOW
    expect_failure("view few.limn --rate 9 --screenshot result.png", 1, "few.limn: was baked for rates up to 8");
#endif
    bake("cube.obj --max-rate 128", "many.limn");
    EXPECT_EQ(made("tessellate many.limn --rate 100", "a.ply"), made("tessellate cube.obj --rate 100", "a.ply"));
}

#ifdef LIMN_HAVE_PICTURES
TEST_F(BakeProgram, draws_the_same_picture) {
    const std::string look = " --size 96x64 --pixel-error 0.3 --control-mesh --validation";
    const std::string picture = made("render cube.obj" + look, "a.png");
    EXPECT_EQ(made("render cube.limn" + look, "a.png"), picture);
    bake("cube.obj --scheme bilinear", "flat.limn");
    EXPECT_NE(made("render flat.limn" + look, "a.png"), picture);
}
#endif
#ifdef LIMN_HAVE_WINDOW
TEST_F(BakeProgram, shows_a_window) {
    if (!has_display()) GTEST_SKIP() << kNoDisplay;
    bake("cube.obj --scheme bilinear --max-rate 2", "flat.limn");  // few rates are enough for it
    for (const char* model : {"cube.limn --animate", "flat.limn --color rate"}) {
        const Outcome outcome =
            show(std::string(model) + " --size 320x240 --pixel-error 0.3 --validation --frames 2 --screenshot a.png");
        EXPECT_EQ(outcome.status, 0) << model << ": " << outcome.errors;
        EXPECT_EQ(read("a.png").substr(0, 4), "\x89PNG") << model;
        std::filesystem::remove(path("a.png"));
    }
}
#endif

TEST_F(BakeProgram, refuses_damaged_files_in_one_line) {
    const std::string good = read("cube.limn");
    const auto refused = [&](const std::string& bytes, const std::string& cause) {
        put_contents(path("bad.limn"), bytes);
        for (const char* command : {"info bad.limn", "tessellate bad.limn -o result.ply", "tessellate bad.limn --device cpu -o result.ply"})
            expect_failure(command, 1, "bad.limn: " + cause);
#ifdef LIMN_HAVE_PICTURES
        expect_failure("render bad.limn -o result.png", 1, "bad.limn: " + cause);
#endif
    };
    refused(good.substr(0, good.size() / 2), "is cut short");
    refused(good.substr(0, 20), "is cut short");
    std::string other = good;
    other[12] = 99;  // the version
    refused(other, "has format version 99");
    other = good;
    other[good.size() / 2] ^= 1;
    refused(other, "is damaged");
    write("places.csv", "0,0,0\n");
    expect_failure("eval bad.limn --at places.csv -o result.csv", 1, "bad.limn: is damaged");
}

TEST_F(BakeProgram, says_what_needs_the_model_itself) {
    for (const char* command :
         {"refine cube.limn --level 1 -o result.obj", "bake cube.limn -o result.limn", "check cube.limn"})
        expect_failure(command, 1, "cube.limn: is a baked file, which does not keep the control mesh that this needs");
}

TEST_F(BakeProgram, refuses_options_that_the_bake_settled) {
    for (const char* option : {"--scheme loop", "--boundary none", "--creasing chaikin", "--triangles smooth", "--fvar all",
                               "--compat opensubdiv"}) {
        const std::string name = std::string(option).substr(0, std::string(option).find(' '));
        expect_failure("tessellate cube.limn -o result.ply " + std::string(option), 2, name);
        expect_failure("info cube.limn " + std::string(option), 2, name);
        expect_failure("eval cube.limn --at - -o result.csv " + std::string(option), 2, name);
#ifdef LIMN_HAVE_WINDOW
        expect_failure("view cube.limn --screenshot result.png " + std::string(option), 2, name);
#endif
#ifdef LIMN_HAVE_PICTURES
        expect_failure("render cube.limn -o result.png " + std::string(option), 2, name);
#endif
    }
    expect_failure("tessellate cube.limn -o result.ply --uv none", 2, "--uv");
}

TEST_F(BakeProgram, refuses_bad_usage_and_leaves_nothing) {
    for (const auto& [arguments, cause] :
         {std::pair("cube.obj", "output"), std::pair("-o result.limn", "MODEL"), std::pair("cube.obj -o result.obj", "result.obj"),
          std::pair("cube.obj -o result.limn --grid-rate 0", "grid-rate"),
          std::pair("cube.obj -o result.limn --refine-level 8", "refine-level"),
          std::pair("cube.obj -o result.limn --max-rate 1", "max-rate"), std::pair("cube.obj -o result.limn --uv x", "uv"),
          std::pair("cube.obj -o result.limn --scheme none", "scheme")})
        expect_failure("bake " + std::string(arguments), 2, cause);
    expect_failure("bake missing.obj -o result.limn", 1, "missing.obj: ");
    expect_failure("bake cube.obj -o result.limn --uv 1", 1, "cube.obj: there is no channel 1");
    expect_failure("bake cube.obj -o nowhere/result.limn", 1, "nowhere/result.limn: ");
    std::filesystem::create_directory(path("folder.limn"));
    expect_failure("bake cube.obj -o folder.limn", 1, "folder.limn: ");
    expect_failure("info folder.limn", 1, "folder.limn: ");
    EXPECT_TRUE(std::filesystem::is_empty(path("folder.limn")));
    // A file that was there stays as it was.
    const std::string good = read("cube.limn");
    write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    expect_failure("bake broken.obj -o cube.limn", 1, "broken.obj:2: ");
    EXPECT_EQ(read("cube.limn"), good);
}

}  // namespace
}  // namespace limn
