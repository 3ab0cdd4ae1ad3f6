// What one picture is drawn with: the uniform block of all graphics stages, and their push constants. GLSL and
// C++, so vectors of four only: std140 then lays them out as C++ does.
#ifndef LIMN_FRAME_PARAMS_H
#define LIMN_FRAME_PARAMS_H

#ifdef __cplusplus
#include <cstdint>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
namespace limn::viewer::shared {
using mat4 = glm::mat4;
using vec4 = glm::vec4;
using uvec4 = glm::uvec4;
using uint = uint32_t;
#endif

// Colour modes, in the order of ColorMode.
const uint kColorClay = 0;
const uint kColorKind = 1;
const uint kColorLevel = 2;
const uint kColorCurvature = 3;
const uint kColorRate = 4;
const uint kColorNormals = 5;
const uint kColorSides = 6;
const uint kColorGaussian = 7;
const uint kColorPrincipal = 8;

// FrameParams::options.y
const uint kFlagWireframe = 1;
const uint kFlagPlaces = 2;         // there are places
const uint kFlagTriangleFaces = 4;  // there are faces of triangles
const uint kFlagFaceRates = 8;

// Bindings of the one descriptor set.
const uint kBindFrame = 0;
const uint kBindVertices = 1;
const uint kBindIndices = 2;
const uint kBindPlaces = 3;
const uint kBindTriangleFaces = 4;
const uint kBindFaceRates = 5;
const uint kBindLinePoints = 6;
const uint kBindLines = 7;
const uint kBindShadow = 8;         // compared
const uint kBindShadowDepth = 9;    // the same, as depths
const uint kBindSky = 10;           // compared
const uint kBindingCount = 11;

const uint kSkyTiles = 8;  // along each side of the atlas of sky shadows
const uint kMaxSkyDirections = 64;

struct FrameParams {
    mat4 clip_from_world;
    mat4 shadow_from_world;  // to (u, v, depth) of the key light's shadow map
    vec4 eye;                // w: world units that a pixel covers at distance 1
    vec4 sphere;             // around the surface: centre and radius
    vec4 viewport;           // width, height and their inverses
    vec4 key_direction;      // to the light; w: tangent of its angular radius
    vec4 rim_direction;      // to the light
    vec4 background_centre;  // linear; w: how dark the ground's shadows are, 0 without ground
    vec4 background_edge;    // linear; w: height of the ground
    vec4 line_color;         // control mesh; w: width in pixels
    vec4 albedo;             // of clay; w: width of wireframe lines in pixels
    uvec4 options;           // colour mode, flags, sky directions, largest rate as its logarithm, rounded up
    // Direction i: rows that take the world to (u, v, depth) of its tile, u and v in [0, 1].
    vec4 sky_u[kMaxSkyDirections];
    vec4 sky_v[kMaxSkyDirections];
    vec4 sky_depth[kMaxSkyDirections];
    vec4 sky_light[kMaxSkyDirections];  // direction to it; w: radiance times solid angle / pi
};

struct PushParams {
    uint vertex_base;    // floats
    uint vertex_stride;  // floats
    uint view;           // of depth-only stages: 0 the key light, 1 + i sky direction i
    float opacity;       // of lines
};

#ifdef __cplusplus
static_assert(sizeof(FrameParams) == 2 * 64 + 10 * 16 + 4 * 16 * kMaxSkyDirections);
}  // namespace limn::viewer::shared
#endif
#endif
