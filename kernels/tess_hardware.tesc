// Hardware tessellation: how finely each ptex face is divided.
// One invocation per ptex face.
// Reads: tables, rates, which faces are drawn. Writes: levels, all 0 where nothing is drawn; and what the evaluation
// stage has to know of sides and corners.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_hardware.glsl"

layout(vertices = 1) out;
layout(location = 0) in uint faces[];
PATCH_LAYOUT(out)

bool is_drawn(uint face) {
    return SETTLED(kTessResultStatus) < kTessTooSmall && SETTLED(kTessResultNotFinite) == 0 &&
           SETTLED(tess_drawn(params.rate_edge_count) + face) != 0;
}

uint rate_of(uint edge) {
    const bool halves = (WORD(params.table.rate_edges + kRateEdgeWords * edge) & kRateEdgeHalves) != 0;
    return limit_hardware_rate(SETTLED(tess_rates(params.rate_edge_count) + edge), halves);
}

// Which one it has its position from: itself, or what stands beside it among `count` copies, which ascend.
uint source_of(uint item, uint copies, uint count) {
    uint low = 0, high = count;
    while (low < high) {
        const uint middle = (low + high) / 2;
        if (WORD(copies + kTessCopyWords * middle) < item)
            low = middle + 1;
        else
            high = middle;
    }
    const uint at = copies + kTessCopyWords * low;
    return low < count && WORD(at) == item ? WORD(at + 1) : item;
}
uint corner_source(uint corner) {
    return source_of(corner, params.table.copies, params.corner_copy_count);
}
uint row_source(uint row) {
    return source_of(row, params.table.copies + kTessCopyWords * params.corner_copy_count, params.row_copy_count);
}

void set_levels(TessPattern p) {
    gl_TessLevelInner[0] = float(p.columns);
    gl_TessLevelInner[1] = float(p.rows);
    // Level k is of where coordinate k is 0 or, of quads from 2 on, 1.
    const uint sides[4] = kTriangles != 0 ? uint[4](1, 2, 0, 0) : uint[4](3, 0, 1, 2);
    for (uint k = 0; k < 4; ++k) gl_TessLevelOuter[k] = float(p.segments[sides[k]]);
}

void main() {
    const uint face = faces[0];
    if (!is_drawn(face)) {
        for (uint k = 0; k < 4; ++k) gl_TessLevelOuter[k] = 0;
        for (uint k = 0; k < 2; ++k) gl_TessLevelInner[k] = 0;
        return;
    }
    patch_face = face;
    uvec4 rates = uvec4(0), words = uvec4(0);
    for (uint k = 0; k < kSides; ++k) {
        const uint side = face_word(face, k), row = side_row(side), corner = face_word(face, 4 + k);
        words[k] = side;
        rates[k] = rate_of(row_word(row, 0));
        uint middle = 0;
        if ((side & kSideHalves) != 0) middle = row_word(row, 3);
        patch_sides[k] = uvec4(side, rates[k], row_source(row), (side & kSideHalves) != 0 ? corner_source(middle) : 0);
        patch_corners[k] = corner;
        corner_positions[k] = corner_source(corner);
        patch_middles[k] = middle;
    }
    set_levels(pattern_of(words.x, words.y, words.z, words.w, rates));
}
