#version 450
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "color.glsl"

layout(location = 0) out vec4 color;

void main() {
    color = vec4(frame.options.x == kColorSides ? vec3(0) : dither(background()), 1);
}
