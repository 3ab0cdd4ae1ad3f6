// Hardware tessellation: a vertex per ptex face, of which only the number counts.
#version 450

layout(location = 0) out uint face;

void main() {
    face = uint(gl_VertexIndex);
    gl_Position = vec4(0, 0, 0, 1);
}
