// Hardware tessellation: a vertex per ptex face, of which only the number counts.
#version 450

void main() {
    gl_Position = vec4(0, 0, 0, 1);
}
