// Triangles of a tessellation: three indices each, and the face that each belongs to.
// lane_count() invocations per ptex face, which take turns. Each reads the face's sides for itself.
// Reads: tables, rates, offsets. Writes: each triangle once; of them those within the slice that is bound. Deterministic.
// kOutput: kTessFacesOfTriangles, kTessClockwise. Payload: 0: base of indices, 2: of faces; 4, 5: triangles of the slice, first and end
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_bindings.glsl"

layout(std430, binding = kTessOutBinding) writeonly buffer Indices { uint indices[]; };
layout(std430, binding = kTessOut2Binding) writeonly buffer Faces { uint triangle_faces[]; };

uint rate_of(uint edge) { return SETTLED(rates_at() + edge); }
#include "limn/tess_counts.glsl"

// A side as vertices see it: point i is vertex first + step * i, but for both ends and, of halves, the middle.
struct Side {
    uint begin, end;   // corners
    uint first, step;  // step is 1 or -1
    uint second_first;
    uint middle;
};

Side read_side(uvec4 words, uvec4 corners, uint k, TessPattern p) {
    const uint word = words[k], n = p.segments[k], row = side_row(word);
    const bool reversed = (word & kSideReversed) != 0;
    Side side;
    side.begin = corners[k];
    side.end = corners[kTriangles != 0 ? (k + 1) % 3 : (k + 1) % 4];
    side.step = reversed ? ~0u : 1;
    // Points of a row are 1 .. n - 1; reversed n - i.
    side.first = first_vertex(row) - 1;
    side.second_first = side.first;
    side.middle = 0;
    if (p.halves[k]) {
        const uint next = first_vertex(row + 1) - 1 - n / 2;
        side.middle = row_words(row)[3];
        side.second_first = reversed ? side.first + n : next;
        side.first = reversed ? next + n : side.first;
    } else if (reversed) {
        side.first += n;
        side.second_first = side.first;
    }
    return side;
}

uint side_vertex(TessPattern p, uint k, Side side, uint i) {
    const uint n = p.segments[k];
    uint vertex = (2 * i > n ? side.second_first : side.first) + side.step * i;
    if (p.halves[k] && 2 * i == n) vertex = side.middle;
    if (i == 0) vertex = side.begin;
    return i == n ? side.end : vertex;
}

void write(bool is_one, uint triangle, uint face, uint a, uint b, uint c) {
    const uint first = floatBitsToUint(params.payload[4]), end = floatBitsToUint(params.payload[5]);
    if (!is_one || triangle < first || triangle >= end) return;
    const uint at = floatBitsToUint(params.payload[0]) + 3 * (triangle - first);
    indices[at] = a;
    indices[at + 1] = (kOutput & kTessClockwise) != 0 ? c : b;
    indices[at + 2] = (kOutput & kTessClockwise) != 0 ? b : c;
    if ((kOutput & kTessFacesOfTriangles) != 0) triangle_faces[floatBitsToUint(params.payload[2]) + triangle - first] = face;
}

// Loops have their condition at the end: else llvmpipe goes through one more round, in which no invocation is active.

void write_inside(TessPattern p, uint face, uint inner, uint triangle) {
    const uint count = inner_triangle_count(p), lanes = lane_count();
    uint i = lane_of_item();
    if (kTriangles == 0) {
        do {
            const uint row = quotient(i, p.columns - 2);
            uint corners[4];
            grid_cell(p, 1 + i - row * (p.columns - 2), 1 + row, corners);
            write(2 * i < count, triangle + 2 * i, face, inner + corners[0], inner + corners[1], inner + corners[2]);
            write(2 * i < count, triangle + 2 * i + 1, face, inner + corners[0], inner + corners[2], inner + corners[3]);
            i += lanes;
        } while (2 * i < count);
    } else {
        do {
            TessVertex a, b, c;
            inner_triangle(p, min(i, max(count, 1u) - 1), a, b, c);
            write(i < count, triangle + i, face, inner + a.i, inner + b.i, inner + c.i);
            i += lanes;
        } while (i < count);
    }
}

void write_strip(TessPattern p, uint k, uint face, Side side, Side across, uint inner, inout uint triangle) {
    const uint count = strip_triangle_count(p, k), lanes = lane_count();
    const bool ladder = is_hollow(p);
    uint i = lane_of_item();
    do {
        const StripTriangle t = strip_triangle_at(p, k, i);
        const uint on_side = side_vertex(p, k, side, t.outer ? t.segment : t.apex);
        const uint inside = inner + inner_vertex(p, k, t.outer ? t.apex : t.segment + 1).i;
        const uint apex = ladder ? side_vertex(p, (k + 2) % 4, across, t.apex) : inside;
        const uint next = t.outer ? side_vertex(p, k, side, t.segment + 1) : inner + inner_vertex(p, k, t.segment).i;
        write(i < count, triangle + i, face, t.outer ? on_side : inside, next, t.outer ? apex : on_side);
        i += lanes;
    } while (i < count);
    triangle += count;
}

void write_hollow(TessPattern p, uint face, Side sides[4], uint triangle) {
    for (uint i = lane_of_item(); i < strip_triangle_count(p, 0); i += lane_count()) {
        TessVertex corners[3];
        hollow_triangle(p, i, corners[0], corners[1], corners[2]);
        uint v[3] = uint[3](0, 0, 0);
        [[unroll]] for (uint c = 0; c < 3; ++c)
            [[unroll]] for (uint s = 0; s < 3; ++s)
                if (corners[c].side == s) v[c] = side_vertex(p, s, sides[s], corners[c].i);
        write(true, triangle + i, face, v[0], v[1], v[2]);
    }
}

void main() {
    const uint face = shared_item();
    if (face >= params.face_count || is_empty() || !is_drawn(face)) return;
    const uint inner = first_vertex(params.row_count + face);
    uint triangle = first_triangle(params.row_count + face);
    const uvec4 words = face_sides(face), corners = face_corners(face);
    const TessPattern p = pattern_of(words);
    Side sides[4];
    [[unroll]] for (uint k = 0; k < 4; ++k) sides[k] = read_side(words, corners, kTriangles != 0 ? min(k, 2) : k, p);
    write_inside(p, face, inner, triangle);
    triangle += inner_triangle_count(p);
    if (kTriangles != 0 && is_hollow(p)) {
        write_hollow(p, face, sides, triangle);
        return;
    }
    // One by one: Mesa does not unroll a loop around loops, and reads arrays at indices that are no constants element by
    // element (four times the time).
    write_strip(p, 0, face, sides[0], sides[2], inner, triangle);
    write_strip(p, 1, face, sides[1], sides[3], inner, triangle);
    write_strip(p, 2, face, sides[2], sides[0], inner, triangle);
    if (kTriangles == 0) write_strip(p, 3, face, sides[3], sides[1], inner, triangle);
}
