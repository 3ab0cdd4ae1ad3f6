#version 450
// The surface: clay in a studio, or colours of what is known about it. LIMN_HARDWARE: from limn's stages of hardware
// tessellation, which know faces, but neither triangles nor leaves.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "color.glsl"
#include "light.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 vertex_normal;
#ifdef LIMN_HARDWARE
layout(location = 2) in vec2 place;  // not read
layout(location = 3) flat in uint ptex_face;
layout(std430, set = SCENE_SET, binding = kBindFaceRates) readonly buffer FaceRates {
    uint face_rates[];
};
const vec3 edge = vec3(1);
uint face_rate() {
    return (frame.options.y & kFlagFaceRates) != 0u ? face_rates[ptex_face] : 0u;
}
uint leaf_word() {
    return 0u;
}
#else
layout(location = 2) in vec3 edge;
layout(location = 3) flat in uvec2 leaf;
uint face_rate() {
    return leaf.y;
}
uint leaf_word() {
    return leaf.x;
}
#endif
layout(location = 0) out vec4 color;

// Mean and Gaussian curvature, from how position and normal change from pixel to pixel: half the trace and the
// determinant of the shape operator, for a surface of size 1.
vec2 curvatures(vec3 n) {
    const vec3 px = dFdx(position), py = dFdy(position), nx = dFdx(n), ny = dFdy(n);
    const float ee = dot(px, px), ff = dot(px, py), gg = dot(py, py);
    const float e = dot(px, nx), f = 0.5 * (dot(px, ny) + dot(py, nx)), g = dot(py, ny);
    const float area = ee * gg - ff * ff;
    const float size = frame.sphere.w;
    return area > 0.0 ? vec2(0.5 * (e * gg - 2.0 * f * ff + g * ee) * size, (e * g - f * f) * size * size) / area : vec2(0);
}

// What a mode shows of them: one curvature.
float shown_curvature(uint mode, vec2 mean_gaussian) {
    const float mean = mean_gaussian.x, gaussian = mean_gaussian.y;
    if (mode == kColorGaussian) return sign(gaussian) * sqrt(abs(gaussian));
    if (mode == kColorPrincipal) return mean + (mean < 0.0 ? -1.0 : 1.0) * sqrt(max(mean * mean - gaussian, 0.0));
    return mean;
}

vec3 surface_albedo(vec3 n) {
    const uint mode = frame.options.x;
    if (mode == kColorKind) return category(leaf_word() & 255u);
    if (mode == kColorLevel) return viridis(float(leaf_word() >> 8) / 8.0);
    if (mode == kColorCurvature || mode == kColorGaussian || mode == kColorPrincipal) {
        const float h = shown_curvature(mode, curvatures(n));
        return blue_white_red(0.22 * sign(h) * log2(1.0 + abs(h)));
    }
    if (mode == kColorRate) {
        const uint both = face_rate();
        const float rate = 0.5 * float((both & 0xffffu) + (both >> 16));
        return viridis(log2(max(rate, 1.0)) / float(max(frame.options.w, 1u)));
    }
    if (mode == kColorNormals) return linear_from_srgb(0.5 + 0.5 * n);
    return frame.albedo.rgb;
}

// GGX with Smith's visibility, for a rough surface of index of refraction 1.5.
float specular(vec3 n, vec3 view, vec3 light) {
    const float alpha = 0.36 * 0.36 * 1.6;
    const vec3 h = normalize(view + light);
    const float nh = max(dot(n, h), 0.0), nl = max(dot(n, light), 0.0), nv = max(dot(n, view), 1e-3);
    const float d = nh * nh * (alpha * alpha - 1.0) + 1.0;
    const float k = 0.5 * alpha;
    const float fresnel = 0.04 + 0.96 * pow(1.0 - max(dot(view, h), 0.0), 5.0);
    return fresnel * alpha * alpha / (kPi * d * d) * nl / (4.0 * (nl * (1.0 - k) + k) * (nv * (1.0 - k) + k));
}

// Light through a rough skin goes a little around the terminator.
float wrapped(float cosine) {
    return max((cosine + 0.12) / 1.12, 0.0);
}

vec3 shade(vec3 n, vec3 view, vec3 albedo, float gloss) {
    const vec3 key = frame.key_direction.xyz, rim = frame.rim_direction.xyz;
    // Where light grazes, shadow maps say little.
    const float key_lit = key_visibility(position, n) * smoothstep(-0.12, 0.14, dot(n, key));
    const Sky sky = sky_light(position, n, 0.8);
    // What the ground throws back, less where the surface is close to it.
    const float height = (position.y - frame.background_edge.w) / frame.sphere.w;
    const float above = frame.background_centre.w > 0.0 ? smoothstep(-0.15, 0.9, height) : 0.6;
    const vec3 bounce = kBounce * (0.5 - 0.5 * n.y) * mix(0.3, 1.0, above) * vec3(1.02, 1.0, 0.97);
    const vec3 key_color = kKeyLight * vec3(1.0, 0.965, 0.92), rim_color = kRimLight * vec3(0.93, 0.97, 1.0);
    const float rim_lit = wrapped(dot(n, rim)) * sky.open;
    vec3 light = key_color * key_lit * wrapped(dot(n, key)) / 1.6 + sky.light + bounce * mix(0.5, 1.0, sky.open);
    light += rim_color * rim_lit * 0.35;
    vec3 result = albedo * light;
    const float edge_on = pow(1.0 - max(dot(n, view), 0.0), 5.0);
    const vec3 mirror = reflect(-view, n);
    const float env = mix(0.25, 0.9, smoothstep(-0.2, 0.9, mirror.y));
    const vec3 key_shine = key_color * key_lit * specular(n, view, key) * 1.6;
    const vec3 rim_shine = rim_color * specular(n, view, rim) * sky.open;
    result += gloss * (key_shine + rim_shine + env * sky.open * (0.022 + 0.28 * edge_on));
    return result;
}

// Lines along triangle edges, thinner than they are far apart.
float wireframe() {
    float line = 0.0;
    for (int i = 0; i < 3; ++i) {
        const float height = 1.0 / max(length(vec2(dFdx(edge[i]), dFdy(edge[i]))), 1e-6);  // pixels
        const float width = 0.5 * frame.albedo.w;
        const float cover = 1.0 - smoothstep(width - 0.5, width + 0.5, edge[i] * height);
        line = max(line, cover * smoothstep(1.0, 6.0, height));
    }
    return line;
}

void main() {
    const uint mode = frame.options.x;
    vec3 n = normalize(vertex_normal);
    const bool front = gl_FrontFacing;
    const vec3 albedo = surface_albedo(n);
    const vec3 view = normalize(frame.eye.xyz - position);
    const float line = (frame.options.y & kFlagWireframe) != 0u ? wireframe() : 0.0;
    if (!front) n = -n;
    if (mode == kColorSides) {
        color = vec4(front ? vec3(0.6) * (0.4 + 0.6 * max(dot(n, view), 0.0)) : vec3(1, 0, 1), 1);
        return;
    }
    // Silhouettes: interpolated normals may point away from the eye.
    const float facing = dot(n, view);
    if (facing < 0.0) n = normalize(n - view * facing);
    vec3 result = shade(n, view, albedo, mode == kColorClay ? 1.0 : 0.25);
    result = mix(result, vec3(0.012, 0.014, 0.02), 0.8 * line);
    color = vec4(dither(tone_map(result)), 1);
}
