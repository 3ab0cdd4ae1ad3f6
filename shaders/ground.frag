#version 450
// The ground is the backdrop, darker where the surface keeps light from it.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "color.glsl"
#include "light.glsl"

layout(location = 0) in vec3 position;
layout(location = 0) out vec4 color;

void main() {
    const vec3 up = vec3(0, 1, 0);
    // Towards the square's border all of it is lit.
    const float away = length(position.xz - frame.sphere.xz) / frame.sphere.w;
    float shade = 1.0;
    if (away < 4.5) {
        const float key = 0.9 * max(frame.key_direction.y, 0.0);
        const float sky = sky_light(position, up, 1.6).open;
        const float lit = (key * key_visibility(position, up) + 0.9 * sky) / (key + 0.9);
        shade = mix(lit, 1.0, smoothstep(2.5, 4.5, away));
    }
    color = vec4(dither(background() * mix(1.0, shade, frame.background_centre.w)), 1);
}
