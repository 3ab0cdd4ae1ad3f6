#include "viewer/frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

namespace limn::viewer {
namespace {

constexpr float kKeyElevation = 48;
constexpr float kKeySoftness = 0.16f;   // tangent of the light's angular radius
constexpr float kShadowMargin = 1.06f;  // so that no shadow touches the border of its map

/// Rows that take the world to a light's shadow map: u, v and depth, all in [0, 1] within the sphere.
struct LightRows {
    glm::vec4 u, v, depth;
};

LightRows light_rows(const glm::vec3& direction, const glm::vec3& centre, float radius) {
    const glm::vec3 helper = std::abs(direction.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 u = glm::normalize(glm::cross(helper, direction)), v = glm::cross(direction, u);
    const float scale = 0.5f / (radius * kShadowMargin);
    const auto row = [&](const glm::vec3& axis) {
        return glm::vec4(axis * scale, 0.5f - glm::dot(axis, centre) * scale);
    };
    return {row(u), row(v), row(-direction)};
}

/// Directions spread over the upper hemisphere (a Fibonacci spiral), each with its part of the light:
/// brighter above than at the horizon, and all together about as bright as a white sky of radiance 1.
void add_sky(shared::FrameParams& frame, uint32_t count, const glm::vec3& centre, float radius) {
    const float golden = glm::pi<float>() * (3 - std::sqrt(5.0f));
    for (uint32_t i = 0; i < count; ++i) {
        const float y = 1 - (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
        const float ring = std::sqrt(1 - y * y), angle = golden * static_cast<float>(i);
        const glm::vec3 direction(ring * std::cos(angle), y, ring * std::sin(angle));
        const LightRows rows = light_rows(direction, centre, radius);
        frame.sky_u[i] = rows.u;
        frame.sky_v[i] = rows.v;
        frame.sky_depth[i] = rows.depth;
        const float radiance = 0.40f + 0.42f * y;
        frame.sky_light[i] = glm::vec4(direction, radiance * 2 / static_cast<float>(count));
    }
}

}  // namespace

shared::FrameParams build_frame_params(const Camera& camera, const Bounds& bounds,
                                       const RenderSettings& settings, const RenderMesh& mesh,
                                       VkExtent2D extent) {
    shared::FrameParams frame = {};
    const float width = static_cast<float>(extent.width), height = static_cast<float>(extent.height);
    const glm::vec3 centre = bounds.centre();
    const float radius = bounds.radius();
    frame.clip_from_world = camera.clip_from_world(width / height);
    frame.eye = glm::vec4(camera.eye, 2 * std::tan(0.5f * glm::radians(camera.fov)) / height);
    frame.sphere = glm::vec4(centre, radius);
    frame.viewport = {width, height, 1 / width, 1 / height};
    const glm::vec3 key = direction_of(settings.key_azimuth, kKeyElevation);
    const LightRows rows = light_rows(key, centre, radius);
    frame.shadow_from_world = glm::transpose(glm::mat4(rows.u, rows.v, rows.depth, glm::vec4(0, 0, 0, 1)));
    frame.key_direction = glm::vec4(key, kKeySoftness);
    frame.rim_direction = glm::vec4(direction_of(settings.key_azimuth + 190, 28), 0);
    const bool ground = settings.ground && camera.eye.y > bounds.low.y;
    frame.background_centre = glm::vec4(settings.background.centre, ground ? 1.0f : 0.0f);
    frame.background_edge = glm::vec4(settings.background.edge, bounds.low.y);
    frame.line_color = {0.02f, 0.10f, 0.32f, 1.6f * std::max(1.0f, height / 1080)};
    frame.albedo = {0.50f, 0.42f, 0.345f, 1.2f * std::max(1.0f, height / 1080)};
    using namespace shared;
    const uint32_t flags = (settings.wireframe ? kFlagWireframe : 0) |
                           (mesh.places != VK_NULL_HANDLE ? kFlagPlaces : 0) |
                           (mesh.triangle_faces != VK_NULL_HANDLE ? kFlagTriangleFaces : 0) |
                           (mesh.face_rates != VK_NULL_HANDLE ? kFlagFaceRates : 0);
    const uint32_t sky = std::min(settings.sky_directions, kMaxSkyDirections);
    frame.options = {static_cast<uint32_t>(settings.color), flags, sky,
                     std::bit_width(std::max(settings.max_rate, 2u) - 1)};
    add_sky(frame, sky, centre, radius);
    return frame;
}

}  // namespace limn::viewer
