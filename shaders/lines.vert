#version 450
// Line segments of a constant width in pixels: two triangles each, a pixel wider for smooth borders.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

layout(std430, set = 0, binding = kBindLinePoints) readonly buffer LinePoints {
    float line_points[];  // 3 each
};
layout(std430, set = 0, binding = kBindLines) readonly buffer Lines {
    uint lines[];  // pairs of points
};

layout(location = 0) noperspective out float across;  // pixels from the middle

vec4 clip_point(uint i) {
    return frame.clip_from_world * vec4(line_points[3u * i], line_points[3u * i + 1u], line_points[3u * i + 2u], 1);
}

void main() {
    const uint segment = uint(gl_VertexIndex) / 6u, corner = uint(gl_VertexIndex) % 6u;
    const uint corners[6] = uint[](0u, 1u, 2u, 2u, 1u, 3u);
    const bool at_end = (corners[corner] & 1u) != 0u, left = (corners[corner] & 2u) != 0u;
    vec4 a = clip_point(lines[2u * segment]), b = clip_point(lines[2u * segment + 1u]);
    const float near = 1e-3;  // behind the eye a line ends at a plane in front of it
    if (a.w < near && b.w < near) {
        gl_Position = vec4(0, 0, -1, 1);
        across = 0.0;
        return;
    }
    if (a.w < near) a = mix(a, b, (near - a.w) / (b.w - a.w));
    if (b.w < near) b = mix(b, a, (near - b.w) / (a.w - b.w));
    const vec2 half_size = 0.5 * frame.viewport.xy;
    const vec2 along = (b.xy / b.w - a.xy / a.w) * half_size;
    const vec2 direction = dot(along, along) > 1e-12 ? normalize(along) : vec2(1, 0);
    across = (left ? 1.0 : -1.0) * (0.5 * frame.line_color.w + 1.0);
    const vec4 end = at_end ? b : a;
    const vec2 offset = vec2(-direction.y, direction.x) * across / half_size;
    gl_Position = vec4(end.xy + offset * end.w, end.z - 2e-5 * end.w, end.w);
}
