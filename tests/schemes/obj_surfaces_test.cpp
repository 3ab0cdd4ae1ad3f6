// Free-form surfaces of OBJ files, read and written.
#include "limn/schemes/obj_surfaces.h"

#include <gtest/gtest.h>

#include "files.h"
#include "schemes/rational_sphere.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

std::string grid_of_points() {
    std::string text;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 5; ++i)
            text += "v " + std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(i * j) + "\n";
    return text;
}
std::string indices(int first, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += " " + std::to_string(first + i);
    return text;
}

TEST(ObjSurfaces, reads_b_splines) {
    const std::string text =
        "# a patch\r\n" + grid_of_points() + "f 1 2 7 6\ncstype bspline\ndeg 3 3\nsurf 0 2 0 1" +
        indices(1, 10) + " \\\n" + indices(11, 10) +
        "  # continued\nparm u 0 0 0 0 1 2 2 2 2\r\nparm v 0 0 0 0 \\\n 1 1 1 +1\nend\ng more\n";
    const auto surfaces = parse_obj_surfaces(text, "text");
    ASSERT_TRUE(surfaces) << surfaces.error().message;
    ASSERT_EQ(surfaces->size(), 1u);
    const BSplineSurface& s = (*surfaces)[0];
    EXPECT_EQ(s.u, make_clamped_knots(3, 5));
    EXPECT_EQ(s.v, make_clamped_knots(3, 4));
    EXPECT_EQ(s.width, 3u);
    ASSERT_EQ(s.points.size(), 60u);
    EXPECT_EQ(s.points[(2 * 5 + 3) * 3 + 2], 6);
}

TEST(ObjSurfaces, reads_bezier_patches_weights_and_curves_between) {
    std::string text = "v 0 0 0 1\nv 1 0 0 0.5\nv 2 0 1\nv 3 0 0 2\nv 4 0 0 0.1 0.2 0.3\n";
    for (int i = 0; i < 5; ++i) text += "v " + std::to_string(i) + " 1 0\n";
    text +=
        "cstype rat bezier\ndeg 2 1\ncurv 0 1 1 2 3\nparm u 0 1\nend\n"
        "surf 0 3 -1 1 -10/1/1 -9/2 -8//3 -7 -6 -5 -4 -3 -2 -1\nparm u 0 1 3\nparm v -1 1\nend\n";
    const auto surfaces = parse_obj_surfaces(text, "text");
    ASSERT_TRUE(surfaces) << surfaces.error().message;
    ASSERT_EQ(surfaces->size(), 1u);
    const BSplineSurface& s = (*surfaces)[0];
    EXPECT_EQ(s.u, (KnotVector{2, {0, 0, 0, 1, 1, 3, 3, 3}}));
    EXPECT_EQ(s.v, (KnotVector{1, {-1, -1, 1, 1}}));
    const std::vector<double> first = {0, 0, 0, 1, 0.5, 0, 0, 0.5, 2, 0, 1, 1, 6, 0, 0, 2, 4, 0, 0, 1};
    EXPECT_EQ(std::vector<double>(s.points.begin(), s.points.begin() + 20), first);
    EXPECT_EQ(split_at_full_knots(s).size(), 2u);
}

TEST(ObjSurfaces, what_is_written_reads_back) {
    RandomNumbers random(3);
    BSplineSurface plain{make_clamped_knots(3, 6), {2, {-0.1, 0.3, 1.0 / 3, 0.7, 0.8, 1}}, 3, {}};
    plain.points.resize(6 * 3 * 3);
    for (double& x : plain.points) x = random.uniform(-1, 1);
    const TemporaryDirectory directory;
    const std::string path = directory.file("surfaces.obj");
    const std::vector<BSplineSurface> surfaces = {plain, make_sphere(), plain};
    ASSERT_TRUE(write_obj_surfaces(path, surfaces));
    const auto read = read_obj_surfaces(path);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ((*read)[i].u, surfaces[i].u);
        EXPECT_EQ((*read)[i].v, surfaces[i].v);
        ASSERT_EQ((*read)[i].width, surfaces[i].width);
        ASSERT_EQ((*read)[i].points.size(), surfaces[i].points.size());
        for (size_t k = 0; k < surfaces[i].points.size(); ++k)
            EXPECT_NEAR((*read)[i].points[k], surfaces[i].points[k], surfaces[i].width == 3 ? 0 : 1e-15);
    }
}

TEST(ObjSurfaces, refuses_with_the_line) {
    const std::string points = grid_of_points();  // 20 lines
    const std::string good =
        "cstype bspline\ndeg 3 3\nsurf 0 2 0 1" + indices(1, 20) + "\nparm u 0 0 0 0 1 2 2 2 2\n";
    const auto refused = [&](const std::string& text, ErrorCode code, uint64_t line) {
        const auto surfaces = parse_obj_surfaces(points + text, "text");
        ASSERT_FALSE(surfaces) << text;
        EXPECT_EQ(surfaces.error().code, code) << surfaces.error().message;
        EXPECT_EQ(surfaces.error().element, line) << surfaces.error().message;
        EXPECT_EQ(surfaces.error().message.rfind("text:" + std::to_string(line) + ": ", 0), 0u)
            << surfaces.error().message;
    };
    using enum ErrorCode;
    EXPECT_TRUE(parse_obj_surfaces(points + good + "parm v 0 0 0 0 1 1 1 1\nend\n", "text"));
    refused(good + "parm v 0 0 0 0 1 1 1\nend\n", invalid_argument, 26);
    refused(good + "parm v 0 0 0 0 2 2 2 2\nend\n", unsupported, 26);
    refused(good + "parm v 0 0 0 0 1 1 1 x\nend\n", parse_error, 25);
    refused(good + "parm v 0 0 0 0 1 1 1 1e999\nend\n", parse_error, 25);
    refused(good + "trim 0 1 1\nend\n", unsupported, 25);
    refused(good + good, parse_error, 27);
    refused("cstype cardinal\ndeg 3 3\nsurf 0 1 0 1 1\n", unsupported, 23);
    refused("surf 0 1 0 1 1\n", unsupported, 21);
    refused("cstype bspline\nsurf 0 1 0 1 21\n", index_out_of_range, 22);
    refused("cstype bspline\nsurf 0 1 0 1 -21\n", index_out_of_range, 22);
    refused("cstype bspline\nsurf 0 1 0 1 0\n", parse_error, 22);
    refused("deg 3 x\n", parse_error, 21);
    refused("parm u 0 1\n", parse_error, 21);
    refused("cstype bezier\ndeg 4294967295 1\nsurf 0 1 0 1 1 2\nparm u 0 1\nparm v 0 1\nend\n",
            invalid_argument, 26);
    refused("v 1 2\n", parse_error, 21);
    refused("v 1 2 nan\n", not_finite, 21);
    EXPECT_FALSE(parse_obj_surfaces(points + good, "text"));  // no end
    EXPECT_TRUE(parse_obj_surfaces("", "text")->empty());
    EXPECT_TRUE(parse_obj_surfaces(points + "f 1 2 3\nend\nend\n", "text")->empty());
    EXPECT_EQ(read_obj_surfaces("/nowhere/at/all.obj").error().code, cannot_open);
    BSplineSurface weightless = make_sphere();
    weightless.points[3] = 0;
    EXPECT_EQ(write_obj_surfaces("/nowhere/at/all.obj", {&weightless, 1}).error().code, invalid_argument);
}

}  // namespace
}  // namespace limn::test
