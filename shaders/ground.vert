#version 450
// The ground: a square below the surface, as far as shadows may fall.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

layout(location = 0) out vec3 position;

void main() {
    const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
    const vec2 at = frame.sphere.xz + 6.0 * frame.sphere.w * corner;
    position = vec3(at.x, frame.background_edge.w, at.y);
    gl_Position = frame.clip_from_world * vec4(position, 1);
}
