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

Camera Camera::frame(const Bounds& bounds, const CameraView& view, float aspect) {
    Camera camera;
    const float radius = bounds.radius();
    // The narrower side decides what fits.
    const float half = std::tan(0.5f * glm::radians(view.fov)) * std::min(1.0f, aspect);
    const float fitting = 1.02f / std::sin(std::atan(half));
    const float distance = radius * (view.distance > 0 ? view.distance : fitting);
    camera.fov = view.fov;
    camera.target = bounds.centre();
    // Straight from above there is no up.
    const float elevation = std::clamp(view.elevation, -89.9f, 89.9f);
    camera.eye = camera.target + distance * direction_of(view.azimuth, elevation);
    camera.near_plane = std::max(distance - 8.5f * radius, 0.02f * std::min(distance, radius));
    camera.far_plane = distance + 8.5f * radius;
    return camera;
}

glm::mat4 Camera::clip_from_world(float aspect) const {
    glm::mat4 projection = glm::perspectiveRH_ZO(glm::radians(fov), aspect, near_plane, far_plane);
    projection[1][1] = -projection[1][1];
    return projection * glm::lookAtRH(eye, target, glm::vec3(0, 1, 0));
}

}  // namespace limn::viewer
