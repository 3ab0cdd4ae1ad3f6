#define GLM_FORCE_DEPTH_ZERO_TO_ONE
#include "viewer/camera.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <optional>
#include <vector>

namespace limn::viewer {
namespace {

/// The numbers of a comma-separated list; nothing where one is malformed.
std::optional<std::vector<float>> parse_numbers(const std::string& text) {
    std::vector<float> numbers;
    const char* at = text.c_str();
    while (true) {
        char* end = nullptr;
        const float number = std::strtof(at, &end);
        if (end == at || std::isspace(static_cast<unsigned char>(*at))) return std::nullopt;
        numbers.push_back(number);
        if (*end == '\0') return numbers;
        if (*end != ',') return std::nullopt;
        at = end + 1;
    }
}

}  // namespace

glm::vec3 Bounds::centre() const {
    return 0.5f * (low + high);
}

float Bounds::radius() const {
    const float radius = 0.5f * glm::length(high - low);
    return radius > 0 ? radius : 1;
}

Result<CameraView> parse_camera(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (!numbers || numbers->size() < 2 || numbers->size() > 4)
        return Error{ErrorCode::parse_error,
                     "a camera is AZIMUTH,ELEVATION[,DISTANCE[,FOV]], not '" + text + "'"};
    for (const float number : *numbers)
        if (!std::isfinite(number))
            return Error{ErrorCode::not_finite, "a camera takes finite numbers, not '" + text + "'"};
    CameraView view;
    view.azimuth = (*numbers)[0];
    view.elevation = (*numbers)[1];
    if (std::abs(view.elevation) > 90)
        return Error{ErrorCode::invalid_argument, "a camera's elevation is -90 to 90 degrees"};
    if (numbers->size() > 2) {
        view.distance = (*numbers)[2];
        if (!(view.distance > 0 && view.distance <= 1e4f))
            return Error{ErrorCode::invalid_argument,
                         "a camera's distance is more than 0, and at most 10000, radii of the model"};
    }
    if (numbers->size() > 3) {
        view.fov = (*numbers)[3];
        if (!(view.fov >= 1 && view.fov <= 150))
            return Error{ErrorCode::invalid_argument, "a camera's field of view is 1 to 150 degrees"};
    }
    return view;
}

glm::vec3 direction_of(float azimuth, float elevation) {
    const float a = glm::radians(azimuth), e = glm::radians(elevation);
    return {std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)};
}

namespace {

/// How far from the middle of the box an eye in direction `back` sees all of its corners, with some room.
float fitting_distance(const Bounds& bounds, const glm::vec3& back, float fov, float aspect) {
    constexpr float kRoom = 1.12f;
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), back)),
                    up = glm::cross(back, right);
    const float tall = std::tan(0.5f * glm::radians(fov)), wide = tall * aspect;
    const glm::vec3 half = 0.5f * (bounds.high - bounds.low);
    float distance = 0.1f * bounds.radius();
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner((i & 1) != 0 ? half.x : -half.x, (i & 2) != 0 ? half.y : -half.y,
                               (i & 4) != 0 ? half.z : -half.z);
        const float across =
            std::max(std::abs(glm::dot(corner, right)) / wide, std::abs(glm::dot(corner, up)) / tall);
        distance = std::max(distance, glm::dot(corner, back) + kRoom * across);
    }
    return distance;
}

}  // namespace

Camera Camera::frame(const Bounds& bounds, const CameraView& view, float aspect) {
    Camera camera;
    const float radius = bounds.radius();
    // Straight from above there is no up.
    const glm::vec3 back = direction_of(view.azimuth, std::clamp(view.elevation, -89.9f, 89.9f));
    const float distance =
        view.distance > 0 ? radius * view.distance : fitting_distance(bounds, back, view.fov, aspect);
    camera.fov = view.fov;
    camera.target = bounds.centre();
    camera.eye = camera.target + distance * back;
    camera.near_plane = std::max(distance - 8.5f * radius, 0.02f * std::min(distance, radius));
    camera.far_plane = distance + 8.5f * radius;
    return camera;
}

glm::mat4 Camera::clip_from_world(float aspect) const {
    glm::mat4 projection = glm::perspectiveRH_ZO(glm::radians(fov), aspect, near_plane, far_plane);
    projection[1][1] = -projection[1][1];
    return projection * glm::lookAtRH(eye, target, glm::vec3(0, 1, 0));
}

limn::Camera rate_camera(const Camera& camera, uint32_t width, uint32_t height) {
    limn::Camera out;
    out.width = static_cast<float>(width);
    out.height = static_cast<float>(height);
    const glm::mat4 matrix = camera.clip_from_world(out.width / out.height);
    for (int i = 0; i < 16; ++i) out.matrix[i] = matrix[i / 4][i % 4];
    return out;
}

}  // namespace limn::viewer
