// OBJ in and out, PLY out, and the files below them.
#include "limn/obj.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>

#include "files.h"
#include "limn/file.h"
#include "limn/ply.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::string kQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Model parsed(const std::string& text) {
    auto model = parse_obj(text, "test.obj");
    EXPECT_TRUE(model) << model.error().message << "\n" << text;
    return model ? std::move(*model) : Model{};
}

using Indices = std::vector<uint32_t>;
using Floats = std::vector<float>;

TEST(ObjRead, EverySpellingOfAFace) {
    const std::string head = kQuad + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n";
    const auto read = [&](const std::string& face, const Indices& texture) {
        for (const char* end : {"", "\n", "\r\n", "\n\n#"}) {
            const Model model = parsed(head + face + end);
            EXPECT_EQ(model.face_sizes, Indices{3});
            EXPECT_EQ(model.face_vertices, (Indices{0, 1, 2}));
            EXPECT_EQ(model.face_texture_coordinates, texture) << face;
        }
    };
    for (const char* face : {"f 1 2 3", "f 1//1 2//1 3//1", "f -4 -3 -2", "f -4//-1 -3//-1 -2//-1",
                             "f 1/ 2/ 3/", "f 1// 2// 3//", "f\t1\t\t2   3   ", "  f 1 2 3 # a comment",
                             "f 1 2\\\n3", "f 1 \\\n 2 \\\r\n 3", "f 1 2 3\r"})
        read(face, {});
    for (const char* face : {"f 1/1 2/2 3/3", "f 1/1/1 2/2/1 3/3/1", "f -4/-3 -3/-2 -2/-1",
                             "f 1/1/ 2/2/ 3/3/", "f -4/-3/-1 -3/-2/-1 -2/-1/-1"})
        read(face, {0, 1, 2});
    EXPECT_FALSE(parse_obj(head + "f 1 2 3\\", "test.obj"));  // continues nothing
}

TEST(ObjRead, IndicesPointBackAndForward) {
    const Model back = parsed("v 0 0 0\nv 1 0 0\nv 2 0 0\nf -3 -2 -1\nv 3 0 0\nf -3 -2 -1\n");
    EXPECT_EQ(back.face_vertices, (Indices{0, 1, 2, 1, 2, 3}));
    const Model forward = parsed("t corner 1/1/0 2 1\nf 1/1 2/2 3/1\nvt 0 0\nvt 1 1\n" + kQuad);
    EXPECT_EQ(forward.face_vertices, (Indices{0, 1, 2}));
    EXPECT_EQ(forward.face_texture_coordinates, (Indices{0, 1, 0}));
    EXPECT_EQ(forward.corner_vertices, Indices{2});
}

TEST(ObjRead, Numbers) {
    const Model model = parsed(
        "v +1 +2e+1 -.5\nv 1.e0 1E-2 -0\nv 1 2 3 1\nv 1 2 3 .1 .2 .3\nv 1 2 3 4 .1 .2 .3\n"
        "v 1e-50 -1e-400 1e-40\nv 0.1 16777217 3.4028235e38\nvt 7\nvt 1 2\nvt 1 2 3\nvn 0 nan 1\nf 1 2 3\n");
    const Floats expected = {1, 20, -.5f, 1,      .01f, -0.f,       1,
                             2, 3,  1,    2,      3,    1,          2,
                             3, 0,  0,    1e-40f, .1f,  16777216.f, std::numeric_limits<float>::max()};
    EXPECT_EQ(model.positions, expected);
    EXPECT_EQ(model.texture_coordinates, (Floats{7, 0, 1, 2, 1, 2}));
    const std::string zeros(400, '0');
    EXPECT_EQ(parsed("v 0." + zeros + "1 " + zeros + "5 0\n" + kQuad + "f 1 2 3").positions[1], 5.f);
}

TEST(ObjRead, IgnoresWhatIsNotASurface) {
    const Model model =
        parsed("\xef\xbb\xbf# caf\xc3\xa9 \\\nmtllib a b.mtl\no name\ng one two \\\nthree\n" + kQuad +
               "vp 1 2\ns off\nusemtl x\\y \xff\np 1\nl 1 2 3 \\\n 4\nt unknown x/y z\ncstype rat "
               "bspline\n\n\t \nf 1 2 3 4\n");
    EXPECT_EQ(model.face_sizes.size() + model.vertex_count(), 5u);
}

TEST(ObjRead, TextureCoordinatesNeedEveryCorner) {
    for (const char* faces :
         {"f 1/1 2/1 3\nf 1/1 2/1 3/1", "f 1 2 3\nf 1/1 2/1 3/1", "f 1/1 2/1 3/1\nf 1 2 3"}) {
        const Model model = parsed(kQuad + "vt 0 0\n" + faces);
        EXPECT_TRUE(model.face_texture_coordinates.empty() && model.face_count() == 2);
    }
}

TEST(ObjRead, Tags) {
    const Model model = parsed(kQuad +
                               "f 1 2 3 4\nf 1 2 3\n"
                               "t crease 2/1/0 0 1 2.5\nt crease 3/1/0 1 2 3 4\nt crease 3/2/0 1 2 3 5 inf\n"
                               "t corner 1/1/0 0 1.5\nt corner 2/1/0 1 2 10\nt corner 2/2/0 2 3 0 +3 # note\n"
                               "t hole 1/0/0 1\nt hole 2/0/0 0 \\\n1\n");
    EXPECT_EQ(model.crease_sizes, (Indices{2, 3, 2, 2}));
    EXPECT_EQ(model.crease_vertices, (Indices{0, 1, 1, 2, 3, 1, 2, 2, 3}));
    EXPECT_EQ(model.crease_sharpness, (Floats{2.5f, 4, 5, HUGE_VALF}));
    EXPECT_EQ(model.corner_vertices, (Indices{0, 1, 2, 2, 3}));
    EXPECT_EQ(model.corner_sharpness, (Floats{1.5f, 10, 10, 0, 3}));
    EXPECT_EQ(model.holes, (Indices{1, 0, 1}));
    const Model intervals = parsed(kQuad + "f 1 2 3 4\nt interval 2/1/0 0 1 2.5\nt interval 3/1/0 1 2 3 4\n"
                                           "t interval 3/2/0 3 2 1 0 7\n");
    EXPECT_EQ(intervals.interval_edges, (Indices{0, 1, 1, 2, 2, 3, 3, 2, 2, 1}));
    EXPECT_EQ(intervals.intervals, (Floats{2.5f, 4, 4, 0, 7}));
    EXPECT_FALSE(model.boundary || model.face_varying || model.creasing || model.triangles);
}

TEST(ObjRead, OptionTags) {
    const auto with = [](const std::string& tag) { return parsed(kQuad + "f 1 2 3\nt " + tag + "\n"); };
    EXPECT_EQ(with("interpolateboundary 1/0/0 0").boundary, BoundaryInterpolation::none);
    EXPECT_EQ(with("interpolateboundary 1/0/0 1").boundary, BoundaryInterpolation::edge_and_corner);
    EXPECT_EQ(with("interpolateboundary 1/0/0 2").boundary, BoundaryInterpolation::edge_only);
    using enum FaceVaryingInterpolation;
    const FaceVaryingInterpolation values[] = {none,          corners_only, corners_plus1,
                                               corners_plus2, boundaries,   all};
    for (int i = 0; i < 6; ++i)
        EXPECT_EQ(with("facevaryinginterpolateboundary 1/0/0 " + std::to_string(i)).face_varying, values[i]);
    EXPECT_EQ(with("creasemethod 0/0/1 normal").creasing, CreasingMethod::uniform);
    EXPECT_EQ(with("creasemethod 0/0/1 chaikin").creasing, CreasingMethod::chaikin);
    EXPECT_EQ(with("smoothtriangles 0/0/1 catmark").triangles, TriangleSubdivision::catmark);
    EXPECT_EQ(with("smoothtriangles 0/0/1 smooth").triangles, TriangleSubdivision::smooth);
}

TEST(ObjRead, Description) {
    Model model =
        parsed(kQuad +
               "vt 0 0\nvt 1 1\nf 1/1 2/2 3/1\nt crease 2/1/0 0 1 2\nt corner 1/1/0 0 1\nt hole 1/0/0 0\n"
               "t interpolateboundary 1/0/0 1\nt facevaryinginterpolateboundary 1/0/0 2\n");
    SchemeOptions defaults;
    defaults.scheme = Scheme::loop;
    defaults.creasing = CreasingMethod::chaikin;
    const ControlMeshDescription description = describe(model, defaults);
    EXPECT_EQ(description.options.scheme, Scheme::loop);
    EXPECT_EQ(description.options.creasing, CreasingMethod::chaikin);
    EXPECT_EQ(description.options.boundary, BoundaryInterpolation::edge_and_corner);
    EXPECT_EQ(description.vertex_count, 4u);
    EXPECT_EQ(description.face_vertices.data(), model.face_vertices.data());
    EXPECT_EQ(description.crease_vertices.size() + description.positions.size(), 2u + 12u);
    EXPECT_EQ(description.corner_sharpness.size() + description.holes.size(), 2u);
    ASSERT_EQ(description.channels.size(), 1u);
    EXPECT_EQ(description.channels[0].value_count + description.channels[0].face_values.size(), 2u + 3u);
    EXPECT_EQ(description.channels[0].interpolation, FaceVaryingInterpolation::corners_plus1);
    Model plain = parsed(kQuad + "f 1 2 3\n");
    EXPECT_TRUE(describe(plain).channels.empty());
}

struct Malformed {
    const char* texts;  // one, or several between `|`; the last line is to blame
    ErrorCode code;
    const char* cause;  // after `FILE:LINE: `
};

using enum ErrorCode;
constexpr ErrorCode kParse = parse_error, kRange = index_out_of_range, kSharpness = invalid_sharpness,
                    kArgument = invalid_argument;
constexpr Malformed kMalformed[] = {
    {"v 0 abc 0|vn 0 0 abc|vt abc|t crease 2/1/0 0 1 abc|v 1 2 3 abc", kParse, "malformed number 'abc'"},
    {"v 0 +-1 0", kParse, "malformed number '+-1'"},
    {"v 0 1,5 0", kParse, "malformed number '1,5'"},
    {"v 0 1|v|v # 1 2 3", kParse, "v needs at least 3 numbers"},
    {"v nan 0 0|v 0 -inf 0|v 0 0 1e39|v 0 0 1e999", not_finite, "v number is not finite"},
    {"vt", kParse, "vt needs at least 1 numbers"},
    {"vt 1 2 3 4", kParse, "vt takes at most 3 numbers"},
    {"vt inf|vt 0 nan", not_finite, "vt number is not finite"},
    {"vn 1 2", kParse, "vn needs at least 3 numbers"},
    {"\n# x\nf 1 2|f 1 2|g a \\\n b\nf 1 2", face_too_small, "a face of 2 vertices"},
    {"f|f #", face_too_small, "a face of 0 vertices"},
    {"f 1 2 0|f 0/1 2 3", kRange, "vertex index 0: they count from 1"},
    {"f 1 2 5", kRange, "vertex index 5 is out of range: 4 in the file"},
    {"f 1 2 -5", kRange, "vertex index -5 is out of range: 4 so far"},
    {"f 1 2 4294967297", kRange, "vertex index 4294967297 is out of range: 4 in the file"},
    {"f 1 2 99999999999999999999", kRange, "vertex index 9223372036854775807 is out of range: 4 in the file"},
    {"f 1 2 -99999999999999999999", kRange, "vertex index -9223372036854775808 is out of range: 4 so far"},
    {"f 1/1 2/1 3/2|f 1 2 3/2", kRange, "texture coordinate index 2 is out of range: 1 in the file"},
    {"f 1/1 2/0 3/1", kRange, "texture coordinate index 0: they count from 1"},
    {"f 1//1 2//1 3//7", kRange, "normal index 7 is out of range: 1 in the file"},
    {"f 1//1 2//1 3//-2", kRange, "normal index -2 is out of range: 1 so far"},
    {"f 1 2x 3|f 1/1 1/2x 3", kParse, "malformed face corner '2x'"},
    {"f 1/1/1/1 2 3", kParse, "a face corner of more than three indices"},
    {"f /1 2 3", kParse, "malformed face corner '/1'"},
    {"t", kParse, "a tag without a name"},
    {"t crease|t crease x/y/z 0 1 2|t crease 2/1 0 1 2|t crease -2/1/0 0 1 2|t crease 2/1/0x 0 1 2", kParse,
     "tag crease needs counts such as 2/1/0"},
    {"t crease 2/1/0 0 1|t crease 1000000000000/1/0", kParse,
     "tag crease has fewer values than it announces"},
    {"t crease 2/1/0 0 1 2 3", kParse, "tag crease has more values than it announces"},
    {"t crease 2/1/0 0 b 2|t crease 9999999999999999999999/1/0 0 1 2.5", kParse,
     "tag crease has a malformed integer"},
    {"t crease 1/1/0 0 1", kParse, "tag crease needs at least 2 vertices"},
    {"t crease 4/2/0 0 1 2 3 1 1", kParse, "tag crease needs 1 sharpness value, or one for each of 3"},
    {"t crease 2/1/0 0 1 -1|t crease 2/1/0 0 1 nan|t corner 1/1/0 1 -inf", kSharpness,
     "sharpness is negative or not a number"},
    {"t interval 2/1/0 0 1 -1|t interval 2/1/0 0 1 nan|t interval 3/2/0 0 1 2 1 inf", kArgument,
     "an interval is negative or no number"},
    {"t interval 3/0/0 0 1 2", kParse, "tag interval needs 1 interval, or one for each of 2"},
    {"t interval 1/1/0 0 1", kParse, "tag interval needs at least 2 vertices"},
    {"t interval 2/1/0 0 4 1", kRange, "interval vertex index 4 is out of range: 4 in the file"},
    {"t crease 2/1/0 0 4 1", kRange, "crease vertex index 4 is out of range: 4 in the file"},
    {"t crease 2/1/0 0 -1 1", kRange, "crease vertex index is negative"},
    {"t corner 1/1/0 4 1", kRange, "corner vertex index 4 is out of range: 4 in the file"},
    {"t hole 1/0/0 2", kRange, "hole face index 2 is out of range: 1 in the file"},
    {"t hole 0/0/0", kParse, "tag hole needs at least 1 face"},
    {"t interpolateboundary 1/0/0 3|t interpolateboundary 0/0/0", kParse,
     "tag interpolateboundary needs 0, 1 or 2"},
    {"t facevaryinginterpolateboundary 1/0/0 6", kParse, "tag facevaryinginterpolateboundary needs 0 to 5"},
    {"t creasemethod 0/0/1 odd", kParse, "tag creasemethod needs normal or chaikin"},
    {"t smoothtriangles 0/0/0", kParse, "tag smoothtriangles needs catmark or smooth"},
    {"\x01 3|\xff", kParse, "not an OBJ file: a line begins with '?'"},
};

TEST(ObjRead, ErrorsNameFileLineAndCause) {
    const std::string head = kQuad + "vt 0 0\nvn 0 0 1\nf 1 2 3 4\n";
    for (const Malformed& malformed : kMalformed) {
        std::istringstream texts(malformed.texts);
        for (std::string text; std::getline(texts, text, '|');) {
            text.insert(0, head);
            const auto line = 1 + static_cast<uint64_t>(std::count(text.begin(), text.end(), '\n'));
            for (const char* tail : {"\n", "", " \r\n", "\nusemtl x\n"}) {
                const auto model = parse_obj(text + tail, "a.obj");
                ASSERT_FALSE(model) << text;
                EXPECT_EQ(model.error().message, "a.obj:" + std::to_string(line) + ": " + malformed.cause);
                EXPECT_EQ(model.error().element, line);
                EXPECT_EQ(model.error().code, malformed.code) << text;
            }
        }
    }
    // A face is blamed where it begins.
    EXPECT_EQ(parse_obj("v 0 0 0\\\n\nf 1 \\\n 2 \\\n", "a.obj").error().element, 3u);
}

TEST(ObjRead, ErrorsOfWholeFiles) {
    const auto message = [](std::string_view text, const std::string& name = "a.obj") {
        const auto model = parse_obj(text, name);
        return model ? std::string("no error") : model.error().message;
    };
    EXPECT_EQ(message(""), "a.obj:1: no faces");
    EXPECT_EQ(message(kQuad + "f 1 2 3\nf 1 2 5\nf 1 2 9"),
              "a.obj:6: vertex index 5 is out of range: 4 in the file");
    EXPECT_EQ(message(kQuad + "f 1 2 3\n" + std::string(3, '\0')),
              "a.obj:6: not a text file: it holds a zero byte");
    EXPECT_EQ(message(std::string("\xff\xfev\0 \0", 6)), "a.obj:1: not a text file: it holds a zero byte");
    EXPECT_EQ(message("v x\x1b[2J 0 0", "a\nb.obj"), "a?b.obj:1: malformed number 'x?[2J'");
    EXPECT_EQ(message("v " + std::string(100000, 'x')),
              "a.obj:1: malformed number '" + std::string(40, 'x') + "...'");
}

TEST(ObjRead, FilesThatCannotBeRead) {
    const TemporaryDirectory directory;
    const auto error = [](const std::string& path) { return read_obj(path).error(); };
    const std::string none = directory.file("none.obj"), empty = directory.file("empty.obj");
    EXPECT_EQ(error(none).code, ErrorCode::cannot_open);
    EXPECT_EQ(error(none).element, kNoElement);
    EXPECT_EQ(error(none).message, none + ": cannot open: No such file or directory");
    EXPECT_EQ(error(directory.path.string()).message,
              directory.path.string() + ": cannot read: Is a directory");
    EXPECT_FALSE(read_obj("/dev/zero"));
    EXPECT_FALSE(read_obj(""));
    put_contents(empty, "");
    EXPECT_EQ(error(empty).message, empty + ":1: no faces");
    put_contents(empty, kQuad + "f 1 2 3 4");
    EXPECT_TRUE(read_obj(empty));
}

const std::string kEverything =
    "\xef\xbb\xbf# all of it\r\nv 0 0 0\nv +1 0 -.5e-3\nv 1 1 0 1\nv 0 1 0 .1 .2 .3\nvt 0 0\nvt 1 \\\n 0\nvt "
    "1\n"
    "vn 0 0 1\ng a \\\n b\nf 1/1/1 2/2/1 3/3/1 -1/-1/-1\nf 1//1 2//1 3//1\nf 1 2 3\np 1\n"
    "t crease 3/2/0 0 1 2 1 inf\nt interval 2/1/0 0 1 2\nt corner 2/1/0 0 1 2.5\nt hole 1/0/0 1\nt interpolateboundary 1/0/0 1\n"
    "t facevaryinginterpolateboundary 1/0/0 3\nt creasemethod 0/0/1 chaikin\nt smoothtriangles 0/0/1 "
    "smooth\n";

/// Whatever the text, either a consistent model or an error of one line that names a line of the file.
void expect_sound(const std::string& text) {
    // A copy of exactly this size, so that a sanitizer sees a read past its end.
    const std::vector<char> bytes(text.begin(), text.end());
    const auto model = parse_obj({bytes.data(), bytes.size()}, "a.obj");
    if (!model) {
        const Error& error = model.error();
        EXPECT_EQ(error.message.find('\n'), std::string::npos);
        EXPECT_EQ(error.message.find("a.obj:" + std::to_string(error.element) + ": "), 0u);
        EXPECT_LE(error.element, 1 + static_cast<uint64_t>(std::count(text.begin(), text.end(), '\n')));
        return;
    }
    const auto below = [](const Indices& indices, size_t count) {
        return indices.empty() || *std::max_element(indices.begin(), indices.end()) < count;
    };
    const uint64_t corner_count =
        std::accumulate(model->face_sizes.begin(), model->face_sizes.end(), uint64_t{0});
    const uint64_t crease_vertex_count =
        std::accumulate(model->crease_sizes.begin(), model->crease_sizes.end(), uint64_t{0});
    EXPECT_EQ(corner_count, model->face_vertices.size());
    EXPECT_EQ(crease_vertex_count, model->crease_vertices.size());
    EXPECT_EQ(model->crease_sizes.size(), model->crease_sharpness.size());
    EXPECT_EQ(model->corner_vertices.size(), model->corner_sharpness.size());
    EXPECT_TRUE(below(model->face_vertices, model->vertex_count()));
    EXPECT_TRUE(below(model->crease_vertices, model->vertex_count()));
    EXPECT_TRUE(below(model->corner_vertices, model->vertex_count()));
    EXPECT_TRUE(below(model->interval_edges, model->vertex_count()));
    EXPECT_EQ(model->interval_edges.size(), 2 * model->intervals.size());
    EXPECT_TRUE(below(model->holes, model->face_count()));
    EXPECT_TRUE(below(model->face_texture_coordinates, model->texture_coordinates.size() / 2));
    const size_t textured = model->face_texture_coordinates.size();
    EXPECT_TRUE(textured == 0 || textured == corner_count);
    for (const float x : model->positions) EXPECT_TRUE(std::isfinite(x));
}

TEST(ObjFuzz, Truncations) {
    parsed(kEverything);
    for (size_t size = 0; size <= kEverything.size(); ++size) expect_sound(kEverything.substr(0, size));
}

TEST(ObjFuzz, Mutations) {
    std::mt19937 random(20240229);
    const std::string likely = "0123456789-+./\\\n\r\t #eEvftn\xff\x7f";
    for (int i = 0; i < 20000; ++i) {
        std::string text = kEverything;
        for (uint32_t edits = 1 + random() % 4; edits > 0; --edits) {
            const size_t at = random() % text.size();
            const auto kind = random() % 5;
            if (kind == 0) text.erase(at, 1 + random() % 8);
            if (kind == 1) text.insert(at, 1, likely[random() % likely.size()]);
            if (kind == 2) text.insert(at, text.substr(random() % text.size(), random() % 16));
            if (kind > 2)
                text[at] = kind == 3 ? likely[random() % likely.size()] : static_cast<char>(random());
            if (text.empty()) text = "f";
        }
        expect_sound(text);
        if (HasFailure()) FAIL() << "mutation " << i << ":\n" << text;
    }
}

TEST(ObjFuzz, TimeIsLinear) {
    const auto repeated = [](const std::string& text, int count) {
        std::string all;
        for (int i = 0; i < count; ++i) all += text;
        return all;
    };
    const auto start = std::chrono::steady_clock::now();
    const std::string texts[] = {
        kQuad + "f" + repeated(" 1 2 3", 500000),
        kQuad + "f 1 2 3\nt crease 1000000/999999/0" + repeated(" 0 1", 500000) + repeated(" 1", 999999),
        kQuad + repeated("\\\n", 1000000) + "f 1 2 3",
        kQuad + "g" + repeated("\\\r\r", 500000) + "\nf 1 2 3",
        "v " + std::string(1000000, '1') + " 0." + std::string(1000000, '3') + " 0\n" + kQuad + "f 1 2 3",
        kQuad + repeated("f 1 2 3\n", 300000) + repeated("t hole 1/0/0 5\n", 100000) + "f 9 9 9"};
    for (const std::string& text : texts) (void)parse_obj(text, "a.obj");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));  // quadratic: minutes
}

/// Two quads, a triangle between them left out, a pentagon; texture coordinates per corner.
struct Sample {
    Floats positions = {0, -0.f,     1e-40f, 1, 0.1f, 3.4028235e38f, 1.f / 3, 1e20f, -1e-5f, 0,
                        1, 16777216, 5,      6, 7};
    Floats normals = {0, 0, 1, 0, 1, 0, 1, 0, 0, -1, 0, 0, 0.6f, 0.8f, 0};
    Floats texture = {0.25f, 0.5f, 1, 0, 0.1f, 0.2f};
    Indices sizes = {4, 3, 5};
    Indices vertices = {0, 1, 2, 3, 3, 2, 4, 4, 3, 2, 1, 0};
    Indices face_texture = {0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2};
    std::vector<uint8_t> skip = {0, 1, 0};

    MeshOutput mesh() const { return {positions, normals, texture, face_texture, 0, sizes, vertices, skip}; }
};

TEST(ObjWrite, RoundTripIsExact) {
    const TemporaryDirectory directory;
    Sample sample;
    std::mt19937 random(7);
    while (sample.positions.size() < 30000) {
        const float x = std::bit_cast<float>(static_cast<uint32_t>(random()));
        sample.positions.push_back(std::isfinite(x) ? x : 0.f);
    }
    sample.normals.resize(sample.positions.size(), 1.f);
    const std::string path = directory.file("out.obj");
    ASSERT_TRUE(write_obj(path, sample.mesh()));
    const auto model = read_obj(path);
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->positions.size(), sample.positions.size());
    EXPECT_EQ(std::memcmp(model->positions.data(), sample.positions.data(), 4 * sample.positions.size()), 0);
    EXPECT_EQ(model->texture_coordinates, sample.texture);
    EXPECT_EQ(model->face_sizes, (Indices{4, 5}));
    EXPECT_EQ(model->face_vertices, (Indices{0, 1, 2, 3, 4, 3, 2, 1, 0}));
    EXPECT_EQ(model->face_texture_coordinates, (Indices{0, 1, 2, 0, 1, 2, 0, 1, 2}));
    EXPECT_EQ(directory.entry_count(), 1u);
}

TEST(ObjWrite, CornersNameWhatThereIs) {
    const TemporaryDirectory directory;
    const Floats positions = {0, 0, 0, 1, 0, 0, 1.5f, 1, 0}, normals(9, 1.f), texture(6, 0.5f);
    const Indices vertices = {0, 1, 2};
    MeshOutput mesh = {positions, {}, {}, {}, 3, {}, vertices, {}};
    const auto written = [&] {
        EXPECT_TRUE(write_obj(directory.file("out.obj"), mesh));
        return contents(directory.file("out.obj"));
    };
    const std::string v = "v 0 0 0\nv 1 0 0\nv 1.5 1 0\n", vt = "vt 0.5 0.5\nvt 0.5 0.5\nvt 0.5 0.5\n";
    const std::string vn = "vn 1 1 1\nvn 1 1 1\nvn 1 1 1\n";
    EXPECT_EQ(written(), v + "f 1 2 3\n");
    mesh.normals = normals;
    EXPECT_EQ(written(), v + vn + "f 1//1 2//2 3//3\n");
    mesh.texture_coordinates = texture;
    EXPECT_EQ(written(), v + vt + vn + "f 1/1/1 2/2/2 3/3/3\n");
    mesh.normals = {};
    EXPECT_EQ(written(), v + vt + "f 1/1 2/2 3/3\n");
}

ByteReader ply_payload(const std::string& path, const std::string& header) {
    const std::string bytes = contents(path),
                      whole = "ply\nformat binary_little_endian 1.0\n" + header + "end_header\n";
    EXPECT_EQ(bytes.substr(0, whole.size()), whole);
    return {bytes.substr(std::min(whole.size(), bytes.size()))};
}

TEST(PlyWrite, HeaderAndPayload) {
    const TemporaryDirectory directory;
    const Sample sample;
    const std::string path = directory.file("out.ply");
    ASSERT_TRUE(write_ply(path, sample.mesh()));
    ByteReader reader = ply_payload(
        path,
        "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
        "property float ny\nproperty float nz\nelement face 2\nproperty list uchar int vertex_indices\n"
        "property list uchar float texcoord\n");
    for (size_t vertex = 0; vertex < 5; ++vertex) {
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(reader.f32(), sample.positions[3 * vertex + i]);
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(reader.f32(), sample.normals[3 * vertex + i]);
    }
    for (const auto& [offset, size] : {std::pair<size_t, size_t>{0, 4}, {7, 5}}) {
        EXPECT_EQ(reader.byte(), size);
        for (size_t i = 0; i < size; ++i) EXPECT_EQ(reader.u32(), sample.vertices[offset + i]);
        EXPECT_EQ(reader.byte(), 2 * size);
        for (size_t i = 0; i < 2 * size; ++i)
            EXPECT_EQ(reader.f32(), sample.texture[2 * sample.face_texture[offset + i / 2] + i % 2]);
    }
    EXPECT_EQ(reader.at, reader.bytes.size());
}

TEST(PlyWrite, VerticesHaveNormalsAndTextureCoordinates) {
    const TemporaryDirectory directory;
    const Sample sample;
    const Floats texture = {0, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f};
    MeshOutput mesh = sample.mesh();
    mesh.texture_coordinates = texture;
    mesh.face_texture_coordinates = {};
    ASSERT_TRUE(write_ply(directory.file("out.ply"), mesh));
    ByteReader reader = ply_payload(
        directory.file("out.ply"),
        "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
        "property float ny\nproperty float nz\nproperty float s\nproperty float t\nelement face 2\n"
        "property list uchar int vertex_indices\n");
    for (size_t vertex = 0; vertex < 5; ++vertex) {
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(reader.f32(), sample.positions[3 * vertex + i]);
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(reader.f32(), sample.normals[3 * vertex + i]);
        for (size_t i = 0; i < 2; ++i) EXPECT_EQ(reader.f32(), texture[2 * vertex + i]);
    }
}

TEST(PlyWrite, LongListsAndTextureCoordinatesPerVertex) {
    const TemporaryDirectory directory;
    Floats positions(3 * 300, 0.5f), texture(2 * 300);
    Indices vertices(300);
    for (uint32_t i = 0; i < 300; ++i) vertices[i] = i, texture[2 * i] = static_cast<float>(i);
    const MeshOutput mesh = {positions, {}, texture, {}, 300, {}, vertices, {}};
    ASSERT_TRUE(write_ply(directory.file("out.ply"), mesh));
    ByteReader reader = ply_payload(
        directory.file("out.ply"),
        "element vertex 300\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty float t\nelement face 1\nproperty list uint int vertex_indices\n");
    ASSERT_EQ(reader.bytes.size(), 300u * 20 + 4 + 300u * 4);
    reader.at = 299 * 20 + 12;
    EXPECT_EQ(reader.f32() + reader.f32(), 299.f);
    EXPECT_EQ(reader.u32(), 300u);
    for (uint32_t i = 0; i < 300; ++i) EXPECT_EQ(reader.u32(), i);
}

TEST(MeshOutputCheck, ArraysThatDisagree) {
    const TemporaryDirectory directory;
    const Sample sample;
    const auto expect = [&](ErrorCode code, void (*change)(MeshOutput&)) {
        MeshOutput mesh = sample.mesh();
        change(mesh);
        for (auto* write : {write_obj, write_ply}) {
            const auto written = write(directory.file("out"), mesh);
            ASSERT_FALSE(written);
            EXPECT_EQ(written.error().code, code);
            EXPECT_EQ(written.error().message.find(directory.file("out") + ": "), 0u);
        }
    };
    expect(invalid_argument, [](MeshOutput& m) { m.positions = m.positions.first(4); });
    expect(invalid_argument, [](MeshOutput& m) { m.positions = m.positions.first(12); });
    expect(index_out_of_range, [](MeshOutput& m) { m.positions = m.positions.first(12), m.normals = {}; });
    expect(invalid_argument, [](MeshOutput& m) { m.texture_coordinates = m.texture_coordinates.first(3); });
    expect(index_out_of_range, [](MeshOutput& m) { m.texture_coordinates = m.texture_coordinates.first(4); });
    expect(invalid_argument, [](MeshOutput& m) { m.face_texture_coordinates = {}; });
    expect(invalid_argument, [](MeshOutput& m) { m.face_texture_coordinates = m.face_vertices.first(1); });
    expect(invalid_argument, [](MeshOutput& m) { m.face_sizes = m.face_sizes.first(2); });
    expect(invalid_argument, [](MeshOutput& m) { m.face_size = 4; });
    expect(invalid_argument, [](MeshOutput& m) { m.face_size = 5, m.face_sizes = {}; });
    expect(invalid_argument, [](MeshOutput& m) { m.face_skip = m.face_skip.first(2); });
    EXPECT_EQ(directory.entry_count(), 0u);
}

TEST(FileWrite, NothingIsLeftWhereNothingCanBeWritten) {
    const TemporaryDirectory directory;
    const Sample sample;
    const std::string path = directory.file("none/out.obj");
    const auto missing = write_obj(path, sample.mesh());
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::cannot_open);
    EXPECT_EQ(missing.error().message, path + ": cannot write: No such file or directory");
    EXPECT_FALSE(write_ply(directory.path.string(), sample.mesh()));
    EXPECT_FALSE(write_obj("", sample.mesh()));
    EXPECT_EQ(directory.entry_count(), 0u);
    fs::permissions(directory.path, fs::perms::owner_read | fs::perms::owner_exec);
    const bool is_root = geteuid() == 0;  // who may write anywhere
    EXPECT_TRUE(is_root || !write_obj(directory.file("out.obj"), sample.mesh()));
    fs::permissions(directory.path, fs::perms::owner_all);
    EXPECT_FALSE(write_obj("/proc/limn_obj_test.obj", sample.mesh()));
}

TEST(FileWrite, AFailedWriteLeavesTheOldFile) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("out.obj");
    put_contents(path, "precious");
    const Floats positions(3 << 20, 0.123f);
    const MeshOutput mesh = {positions, {}, {}, {}, 3, {}, {}, {}};
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    auto* handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = before;
    small.rlim_cur = 3 << 20;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const auto obj = write_obj(path, mesh);
    const auto ply = write_ply(path, mesh);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    ASSERT_FALSE(obj || ply);
    EXPECT_EQ(obj.error().message, path + ": cannot write: File too large");
    EXPECT_EQ(contents(path), "precious");
    EXPECT_EQ(directory.entry_count(), 1u);
    EXPECT_TRUE(write_ply(path, mesh));
    EXPECT_EQ(contents(path).substr(0, 4), "ply\n");
}

TEST(FileWrite, AppearsOnlyOnCommit) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("out");
    put_contents(path + ".tmp0", "someone else's");
    {
        auto writer = FileWriter::create(path);
        ASSERT_TRUE(writer);
        auto second = FileWriter::create(path);
        ASSERT_TRUE(second);
        writer->append("abandoned");
        EXPECT_FALSE(fs::exists(path));
        second->append("kept");
        EXPECT_TRUE(second->commit());
    }
    EXPECT_EQ(contents(path), "kept");
    EXPECT_EQ(contents(path + ".tmp0"), "someone else's");
    EXPECT_EQ(directory.entry_count(), 2u);
}

TEST(FileWrite, LinksAreFollowedAndDevicesStay) {
    const TemporaryDirectory directory;
    put_contents(directory.file("target"), "old");
    fs::create_symlink("target", directory.file("link"));
    auto writer = FileWriter::create(directory.file("link"));
    ASSERT_TRUE(writer);
    writer->append("new");
    ASSERT_TRUE(writer->commit());
    EXPECT_TRUE(fs::is_symlink(directory.file("link")));
    EXPECT_EQ(contents(directory.file("target")), "new");
    if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const auto full = write_obj("/dev/full", Sample().mesh());
    ASSERT_FALSE(full);
    EXPECT_EQ(full.error().message, "/dev/full: cannot write: No space left on device");
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace limn
