// Colours: sRGB and linear, tone mapping, colour maps, and the noise that hides steps.

vec3 linear_from_srgb(vec3 c) {
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

// Khronos PBR Neutral tone mapper: leaves base colours alone and rolls off highlights.
vec3 tone_map(vec3 color) {
    const float start = 0.8 - 0.04;
    const float low = min(color.r, min(color.g, color.b));
    color -= low < 0.08 ? low - 6.25 * low * low : 0.04;
    const float peak = max(color.r, max(color.g, color.b));
    if (peak < start) return color;
    const float d = 1.0 - start;
    const float new_peak = 1.0 - d * d / (peak + d - start);
    color *= new_peak / peak;
    return mix(vec3(new_peak), color, 1.0 / (0.15 * (peak - new_peak) + 1.0));
}

// Interleaved gradient noise (Jimenez 2014), in [0, 1).
float pixel_noise(vec2 pixel) {
    return fract(52.9829189 * fract(dot(floor(pixel), vec2(0.06711056, 0.00583715))));
}

// Half a step of eight bits either way, so that gradients show no bands.
vec3 dither(vec3 color) {
    const float noise = pixel_noise(gl_FragCoord.xy + 17.0) - 0.5;
    return max(color + noise / 255.0 * (0.1 + 2.0 * sqrt(max(color, vec3(0)))), vec3(0));
}

// viridis (van der Walt and Smith, CC0), the polynomial of Matt Zucker (https://www.shadertoy.com/view/WlfXRN, CC0).
vec3 viridis(float t) {
    const vec3 c0 = vec3(0.2777273272234177, 0.005407344544966578, 0.3340998053353061);
    const vec3 c1 = vec3(0.1050930431085774, 1.404613529898575, 1.384590162594685);
    const vec3 c2 = vec3(-0.3308618287255563, 0.214847559468213, 0.09509516302823659);
    const vec3 c3 = vec3(-4.634230498983486, -5.799100973351585, -19.33244095627987);
    const vec3 c4 = vec3(6.228269936347081, 14.17993336680509, 56.69055260068105);
    const vec3 c5 = vec3(4.776384997670288, -13.74514537774601, -65.35303263337234);
    const vec3 c6 = vec3(-5.435455855934631, 4.645852612178535, 26.3124352495832);
    t = clamp(t, 0.0, 1.0);
    const vec3 srgb = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
    return linear_from_srgb(clamp(srgb, vec3(0), vec3(1)));
}

// RdBu (Brewer, https://colorbrewer2.org) from -1, blue, over 0, white, to 1, red.
vec3 blue_white_red(float t) {
    const vec3 stops[11] = vec3[](vec3(5, 48, 97), vec3(33, 102, 172), vec3(67, 147, 195), vec3(146, 197, 222),
                                  vec3(209, 229, 240), vec3(247, 247, 247), vec3(253, 219, 199),
                                  vec3(244, 165, 130), vec3(214, 96, 77), vec3(178, 24, 43), vec3(103, 0, 31));
    const float at = clamp(5.0 * t + 5.0, 0.0, 10.0);
    const int i = min(int(at), 9);
    return linear_from_srgb(mix(stops[i], stops[i + 1], at - float(i)) / 255.0);
}

// Colours that are told apart by everyone (Okabe and Ito 2008).
vec3 category(uint i) {
    const vec3 colors[8] = vec3[](vec3(230, 159, 0), vec3(204, 121, 167), vec3(150, 150, 150), vec3(86, 180, 233),
                                  vec3(0, 158, 115), vec3(240, 228, 66), vec3(0, 114, 178), vec3(213, 94, 0));
    return linear_from_srgb(colors[i & 7u] / 255.0);
}

// The backdrop: brightest behind the surface. The ground shows it, too, and so has no horizon.
vec3 background() {
    const vec2 at = (gl_FragCoord.xy * frame.viewport.zw - vec2(0.5, 0.46)) * vec2(1.0, 0.95);
    const float distance = smoothstep(0.0, 0.85, length(at));
    return mix(frame.background_centre.rgb, frame.background_edge.rgb, distance);
}
