#version 450
layout(push_constant) uniform View {
    mat4 clip_from_world;
    vec4 eye;
};
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 to_eye;
layout(location = 1) out vec3 surface_normal;

void main() {
    gl_Position = clip_from_world * vec4(position, 1);
    to_eye = eye.xyz - position;
    surface_normal = normal;
}
