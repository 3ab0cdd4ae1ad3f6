#version 450
// A surface drawn triangle by triangle, indices read by hand: for what is known of triangles only, without a
// geometry stage.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "vertices.glsl"

layout(std430, set = 0, binding = kBindIndices) readonly buffer Indices {
    uint indices[];
};
layout(std430, set = 0, binding = kBindPlaces) readonly buffer Places {
    uvec4 places[];  // ptex face, u, v, leaf
};
layout(std430, set = 0, binding = kBindTriangleFaces) readonly buffer TriangleFaces {
    uint triangle_faces[];
};
layout(std430, set = 0, binding = kBindFaceRates) readonly buffer FaceRates {
    uint face_rates[];
};

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 edge;
layout(location = 3) flat out uvec2 leaf;  // leaf word and rates

// A vertex on a border belongs to one side of it; of three, the deepest that is of this triangle's face.
uint triangle_leaf(uint first, uint face, bool faces_known) {
    uint word = 0u;
    bool found = false;
    for (uint i = 0u; i < 3u; ++i) {
        const uvec4 place = places[indices[first + i]];
        const bool own = !faces_known || place.x == face;
        if (own && (!found || (place.w >> 8) > (word >> 8))) word = place.w, found = true;
    }
    return found ? word : places[indices[first]].w;
}

void main() {
    const uint at = uint(gl_VertexIndex), first = at / 3u * 3u;
    const uint vertex = indices[at];
    position = vertex_position(vertex);
    normal = vertex_normal(vertex);
    edge = vec3(at == first, at == first + 1u, at == first + 2u);
    const bool faces_known = (frame.options.y & kFlagTriangleFaces) != 0u;
    const uint face = faces_known ? triangle_faces[first / 3u] : 0u;
    leaf = uvec2(0);
    if ((frame.options.y & kFlagPlaces) != 0u) leaf.x = triangle_leaf(first, face, faces_known);
    if (faces_known && (frame.options.y & kFlagFaceRates) != 0u) leaf.y = face_rates[face];
    gl_Position = frame.clip_from_world * vec4(position, 1);
}
