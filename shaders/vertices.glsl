// Vertices as compute kernels leave them: floats at any stride, so that no vertex buffer layout is baked into a
// pipeline.
layout(std430, set = 0, binding = kBindVertices) readonly buffer Vertices {
    float vertices[];
};

vec3 vertex_position(uint vertex) {
    const uint at = push.vertex_base + vertex * push.vertex_stride;
    return vec3(vertices[at], vertices[at + 1u], vertices[at + 2u]);
}

vec3 vertex_normal(uint vertex) {
    const uint at = push.vertex_base + vertex * push.vertex_stride + 3u;
    return vec3(vertices[at], vertices[at + 1u], vertices[at + 2u]);
}
