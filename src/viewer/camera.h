// A camera that orbits around a target.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "limn/result.h"
#include "limn/tessellate.h"

namespace limn::viewer {

/// A box and the sphere around it.
struct Bounds {
    glm::vec3 low = glm::vec3(0), high = glm::vec3(0);

    glm::vec3 centre() const;
    float radius() const;  ///< positive even where the box is a point
};

/// Where a picture is taken from: angles in degrees; azimuth 0 looks along -z and grows counter-clockwise
/// seen from above (y is up), elevation is positive above. Distances are relative to the radius of what is
/// looked at.
struct CameraView {
    float azimuth = 30, elevation = 20;
    float distance = 0;  ///< 0: so that all of it is in the picture
    float fov = 30;      ///< vertical
};

/// AZIMUTH,ELEVATION[,DISTANCE[,FOV]]. Errors: parse_error, not_finite, invalid_argument (an elevation beyond
/// 90 degrees, a distance that is not positive, a field of view outside 1 to 150 degrees).
Result<CameraView> parse_camera(const std::string& text);

struct Camera {
    glm::vec3 target = glm::vec3(0);
    glm::vec3 eye = glm::vec3(0, 0, 1);
    float fov = 30;  ///< vertical, degrees
    float near_plane = 0.1f, far_plane = 10;

    /// Looks at the middle of `bounds` from where `view` says.
    static Camera frame(const Bounds& bounds, const CameraView& view, float aspect);
    /// Vulkan's clip space: y down, depth 0 to 1.
    glm::mat4 clip_from_world(float aspect) const;
};

/// The camera as rates see it, for a picture of so many pixels.
limn::Camera rate_camera(const Camera& camera, uint32_t width, uint32_t height);

/// To the direction with these angles, as CameraView has them.
glm::vec3 direction_of(float azimuth, float elevation);

}  // namespace limn::viewer
