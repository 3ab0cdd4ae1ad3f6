// Cameras: their text form, and what they frame.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "viewer/camera.h"

namespace limn::viewer {
namespace {

TEST(CameraText, TakesTwoToFourNumbers) {
    const auto two = parse_camera("30,-20.5");
    ASSERT_TRUE(two) << two.error().message;
    EXPECT_EQ(two->azimuth, 30);
    EXPECT_EQ(two->elevation, -20.5f);
    EXPECT_EQ(two->distance, 0);
    const auto four = parse_camera("-400,90,2.5,45");
    ASSERT_TRUE(four) << four.error().message;
    EXPECT_EQ(four->azimuth, -400);
    EXPECT_EQ(four->distance, 2.5f);
    EXPECT_EQ(four->fov, 45);
}

TEST(CameraText, RefusesAllElse) {
    for (const char* text :
         {"", "30", "30,", ",", "30,20,", "1,2,3,4,5", "30;20", "30, 20", "a,b", "30,20x"}) {
        const auto camera = parse_camera(text);
        ASSERT_FALSE(camera) << text;
        EXPECT_EQ(camera.error().code, ErrorCode::parse_error) << text;
        EXPECT_EQ(camera.error().message.find('\n'), std::string::npos);
    }
    for (const char* text : {"nan,20", "30,inf", "30,20,nan", "30,20,2,-inf", "1e99,2"}) {
        const auto camera = parse_camera(text);
        ASSERT_FALSE(camera) << text;
        EXPECT_EQ(camera.error().code, ErrorCode::not_finite) << text;
    }
    for (const char* text : {"0,91", "0,-90.5", "0,0,0", "0,0,-1", "0,0,1e9", "0,0,1,0", "0,0,1,180"}) {
        const auto camera = parse_camera(text);
        ASSERT_FALSE(camera) << text;
        EXPECT_EQ(camera.error().code, ErrorCode::invalid_argument) << text;
    }
}

/// Every corner of the box is in the picture and between the planes.
void expect_inside(const Bounds& bounds, const CameraView& view, float aspect) {
    const Camera camera = Camera::frame(bounds, view, aspect);
    const glm::mat4 clip = camera.clip_from_world(aspect);
    float widest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) != 0 ? bounds.high.x : bounds.low.x,
                          (corner & 2) != 0 ? bounds.high.y : bounds.low.y,
                          (corner & 4) != 0 ? bounds.high.z : bounds.low.z);
        const glm::vec4 at = clip * glm::vec4(p, 1);
        ASSERT_GT(at.w, 0);
        widest = std::max({widest, std::abs(at.x / at.w), std::abs(at.y / at.w)});
        EXPECT_GT(at.z / at.w, 0);
        EXPECT_LT(at.z / at.w, 1);
    }
    EXPECT_LT(widest, 1);
    EXPECT_GT(widest, 0.3f);
}

TEST(Camera, FramesABox) {
    const Bounds bounds = {glm::vec3(-1, 5, 2), glm::vec3(3, 6, 4)};
    for (const float aspect : {0.5f, 1.0f, 2.0f})
        for (const float elevation : {-90.0f, -30.0f, 0.0f, 50.0f, 90.0f})
            for (const float fov : {10.0f, 30.0f, 90.0f})
                expect_inside(bounds, {.azimuth = 33, .elevation = elevation, .fov = fov}, aspect);
}

TEST(Camera, LooksFromWhereItSays) {
    const Bounds bounds = {glm::vec3(-1), glm::vec3(1)};
    const Camera camera = Camera::frame(bounds, {.azimuth = 90, .elevation = 0, .distance = 4}, 1);
    EXPECT_NEAR(camera.eye.x, 4 * std::sqrt(3.0f), 1e-4);
    EXPECT_NEAR(camera.eye.y, 0, 1e-4);
    // Right of the picture is -z then, up is up: Vulkan's y points down.
    const glm::mat4 clip = camera.clip_from_world(1);
    EXPECT_GT((clip * glm::vec4(0, 0, -1, 1)).x, 0);
    EXPECT_LT((clip * glm::vec4(0, 1, 0, 1)).y, 0);
}

TEST(Camera, FramesAPoint) {
    const Bounds bounds = {glm::vec3(7), glm::vec3(7)};
    EXPECT_GT(bounds.radius(), 0);
    const Camera camera = Camera::frame(bounds, {}, 1);
    EXPECT_TRUE(std::isfinite(camera.eye.x + camera.eye.y + camera.eye.z));
}

}  // namespace
}  // namespace limn::viewer
