#version 450
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

layout(location = 0) noperspective in float across;
layout(location = 0) out vec4 color;

void main() {
    const float half_width = 0.5 * frame.line_color.w;
    const float cover = 1.0 - smoothstep(half_width - 0.5, half_width + 0.5, abs(across));
    color = vec4(frame.line_color.rgb, cover * push.opacity);
}
