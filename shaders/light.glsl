// A studio: a key light with soft shadows, a rim light, and a sky of many directions, each with a shadow map of
// its own; where those are left out, a sky without shadows.
layout(set = SCENE_SET, binding = kBindShadow) uniform sampler2DShadow shadow_map;
layout(set = SCENE_SET, binding = kBindShadowDepth) uniform sampler2D shadow_depth;
layout(set = SCENE_SET, binding = kBindSky) uniform sampler2DShadow sky_map;

const float kPi = 3.14159265;
const float kKeyLight = 2.1;
const float kRimLight = 1.3;
const float kBounce = 0.24;  // of what falls on the ground

// Points spread evenly over the unit disk: Vogel's spiral, turned for each pixel.
vec2 disk_point(int i, int count, float turn) {
    const float radius = sqrt((float(i) + 0.5) / float(count));
    const float angle = 2.39996323 * float(i) + turn;
    return radius * vec2(cos(angle), sin(angle));
}

// What the key light reaches: percentage-closer soft shadows (Fernando 2005).
float key_visibility(vec3 position, vec3 normal) {
    const float texel = 2.0 * frame.sphere.w / float(textureSize(shadow_depth, 0).x);
    const float slope = 1.0 - max(dot(normal, frame.key_direction.xyz), 0.0);
    const vec3 at = (frame.shadow_from_world * vec4(position + normal * texel * (1.0 + 2.0 * slope), 1)).xyz;
    if (any(greaterThan(abs(at.xy - 0.5), vec2(0.5)))) return 1.0;  // beside all that could cast a shadow
    const float turn = 2.0 * kPi * pixel_noise(gl_FragCoord.xy);
    // Depths beside `at` are those of the surface's tangent plane, or it would shadow itself.
    const vec3 facing = mat3(frame.shadow_from_world) * normal;
    const vec2 plane = -facing.xy / min(facing.z, -0.2 * length(facing));
    // Shadow maps are as deep as they are wide: depths and widths compare.
    const float spread = frame.key_direction.w;
    const float reach = spread * clamp(at.z, 0.2, 1.0);
    float blocker = 0.0, blocker_count = 0.0;
    const int kSearchTaps = 24;
    for (int i = 0; i < kSearchTaps; ++i) {
        const vec2 tap = disk_point(i, kSearchTaps, 0.0) * reach;
        const float depth = textureLod(shadow_depth, at.xy + tap, 0.0).r;
        if (depth < min(at.z + dot(plane, tap), 1.0) - 0.002 - 0.05 * length(tap))
            blocker += depth, blocker_count += 1.0;
    }
    if (blocker_count == 0.0) blocker = at.z, blocker_count = 1.0;
    const float penumbra = max(spread * (at.z - blocker / blocker_count), 1.5 * texel / (2.0 * frame.sphere.w));
    float lit = 0.0;
    const int kTaps = 32;
    for (int i = 0; i < kTaps; ++i) {
        const vec2 tap = disk_point(i, kTaps, turn) * penumbra;
        const float depth = min(at.z + dot(plane, tap), 1.0) - 0.0008 - 0.08 * length(tap);
        lit += textureLod(shadow_map, vec3(at.xy + tap, depth), 0.0);
    }
    return lit / float(kTaps);
}

struct Sky {
    vec3 light;  // on a white surface, over pi
    float open;  // how much of it is seen, 0 to 1
};

// Warm from the key light's side, cool from the other.
vec3 sky_tint(vec3 direction) {
    const float side = 0.5 + 0.5 * dot(direction, frame.key_direction.xyz);
    return mix(vec3(0.90, 0.97, 1.08), vec3(1.05, 1.0, 0.94), side);
}

// `blur`: how far, in texels, shadows of single directions are scattered, so that they melt into each other.
Sky sky_light(vec3 position, vec3 normal, float blur) {
    Sky sky = Sky(vec3(0), 1.0);
    const uint count = frame.options.z;
    if (count == 0u) {
        sky.light = mix(0.35, 1.0, 0.5 + 0.5 * normal.y) * sky_tint(normal) * 0.8;
        return sky;
    }
    const float tile = 1.0 / float(kSkyTiles);
    const float texel = float(kSkyTiles) / float(textureSize(sky_map, 0).x);
    const vec4 from = vec4(position + normal * 2.6 * texel * frame.sphere.w, 1);
    const vec2 jitter = disk_point(int(15.99 * pixel_noise(gl_FragCoord.yx + 5.0)), 16, 0.0) * texel * blur;
    float seen = 0.0, whole = 0.0;
    for (uint i = 0u; i < count; ++i) {
        const vec4 light = frame.sky_light[i];
        const float weight = light.w * max(dot(light.xyz, normal), 0.0);
        if (weight <= 0.0) continue;
        const vec3 at = vec3(dot(frame.sky_u[i], from), dot(frame.sky_v[i], from), dot(frame.sky_depth[i], from));
        float visible = 1.0;
        if (all(lessThan(abs(at.xy - 0.5), vec2(0.5 - 4.0 * texel)))) {
            const vec2 corner = vec2(i % kSkyTiles, i / kSkyTiles);
            visible = textureLod(sky_map, vec3((corner + at.xy + jitter) * tile, min(at.z, 1.0)), 0.0);
        }
        whole += weight;
        seen += weight * visible;
        sky.light += weight * visible * sky_tint(light.xyz);
    }
    sky.open = whole > 0.0 ? seen / whole : 1.0;
    return sky;
}
