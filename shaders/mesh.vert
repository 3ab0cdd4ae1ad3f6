#version 450
// A surface drawn by its indices: each vertex once.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "vertices.glsl"

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 edge;  // barycentric
layout(location = 3) flat out uvec2 leaf;

void main() {
    const uint vertex = uint(gl_VertexIndex);
    position = vertex_position(vertex);
    normal = vertex_normal(vertex);
    edge = vec3(1);
    leaf = uvec2(0);
    gl_Position = frame.clip_from_world * vec4(position, 1);
}
