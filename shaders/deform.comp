#version 450
// Control points that move: a twist that swings about the vertical axis and a wave that runs along it.
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Rest {
    float rest[];
};
layout(std430, set = 0, binding = 1) writeonly buffer Points {
    float points[];
};
layout(push_constant) uniform Push {
    vec4 sphere;  // centre and radius of the surface at rest
    uint count;
    float time;  // seconds
    float amplitude;
} push;

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    vec3 p = vec3(rest[3u * i], rest[3u * i + 1u], rest[3u * i + 2u]) - push.sphere.xyz;
    const float height = p.y / push.sphere.w;
    const float angle = push.amplitude * 0.55 * sin(1.7 * push.time) * height;
    const float c = cos(angle), s = sin(angle);
    p.xz = vec2(c * p.x + s * p.z, c * p.z - s * p.x);
    // Nothing moves where the surface stands.
    p.x += push.amplitude * 0.06 * push.sphere.w * smoothstep(-1.0, 1.0, height) * sin(2.9 * push.time - 3.0 * height);
    p += push.sphere.xyz;
    points[3u * i] = p.x;
    points[3u * i + 1u] = p.y;
    points[3u * i + 2u] = p.z;
}
