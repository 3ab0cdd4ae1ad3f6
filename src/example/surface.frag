#version 450
// A studio: a warm key light, a cool fill from the other side, light from the sky, and a rim.
layout(location = 0) in vec3 to_eye;
layout(location = 1) in vec3 surface_normal;
layout(location = 0) out vec4 color;

const vec3 kClay = vec3(0.52, 0.19, 0.09);

void main() {
    const vec3 n = normalize(surface_normal), e = normalize(to_eye);
    const vec3 key = normalize(vec3(-0.6, -0.7, 0.8)), fill = normalize(vec3(0.9, -0.4, 0.1));
    const vec3 light = 0.85 * vec3(1.0, 0.95, 0.87) * max(dot(n, key), 0) + 0.22 * vec3(0.6, 0.75, 1.0) * max(dot(n, fill), 0) +
                       mix(vec3(0.10, 0.08, 0.07), vec3(0.26, 0.29, 0.34), 0.5 + 0.5 * n.z);
    const float gloss = pow(max(dot(n, normalize(key + e)), 0), 60), rim = pow(1 - max(dot(n, e), 0), 4);
    color = vec4(kClay * light + 0.30 * gloss + 0.12 * rim * vec3(0.8, 0.9, 1.0), 1);
}
