#version 450
// The surface as a light sees it: depths only.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "vertices.glsl"

void main() {
    const vec4 position = vec4(vertex_position(uint(gl_VertexIndex)), 1);
    vec3 at;
    if (push.view == 0u) {
        at = (frame.shadow_from_world * position).xyz;
    } else {
        const uint i = push.view - 1u;
        at = vec3(dot(frame.sky_u[i], position), dot(frame.sky_v[i], position), dot(frame.sky_depth[i], position));
    }
    gl_Position = vec4(2.0 * at.xy - 1.0, at.z, 1);
}
