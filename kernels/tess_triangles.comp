// Triangles of a tessellation: three indices each, and the face that each belongs to.
// lane_count() invocations per ptex face, which take turns. Each reads the face's sides for itself: sharing them behind a
// barrier made llvmpipe slower (rate 4: from 1.1 to 1.3 of the time of the vertices).
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

Side read_side(uint face, uint k, TessPattern p) {
    const uint word = face_word(face, k), n = p.segments[k], row = side_row(word);
    const bool reversed = (word & kSideReversed) != 0;
    Side side;
    side.begin = face_word(face, 4 + k);
    side.end = face_word(face, 4 + (k + 1) % side_count(p));
    side.step = reversed ? ~0u : 1;
    // Points of a row are 1 .. n - 1; reversed n - i.
    side.first = SETTLED(items_at() + 2 * row) - 1;
    side.second_first = side.first;
    side.middle = 0;
    if (p.halves[k]) {
        const uint next = SETTLED(items_at() + 2 * (row + 1)) - 1 - n / 2;
        side.middle = row_word(row, 3);
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

void write(uint triangle, uint face, uint a, uint b, uint c) {
    const uint first = floatBitsToUint(params.payload[4]), end = floatBitsToUint(params.payload[5]);
    if (triangle < first || triangle >= end) return;
    const uint at = floatBitsToUint(params.payload[0]) + 3 * (triangle - first);
    indices[at] = a;
    indices[at + 1] = (kOutput & kTessClockwise) != 0 ? c : b;
    indices[at + 2] = (kOutput & kTessClockwise) != 0 ? b : c;
    if ((kOutput & kTessFacesOfTriangles) != 0) triangle_faces[floatBitsToUint(params.payload[2]) + triangle - first] = face;
}

void main() {
    const uint face = shared_item(), lane = lane_of_item(), lanes = lane_count();
    if (face >= params.face_count || is_empty() || !is_drawn(face)) return;
    const uint item = items_at() + 2 * (params.row_count + face), inner = SETTLED(item);
    uint triangle = SETTLED(item + 1);
    const TessPattern p = pattern_of(face);
    Side sides[4];
    [[unroll]] for (uint k = 0; k < 4; ++k) sides[k] = read_side(face, kTriangles != 0 ? min(k, 2) : k, p);
    const uint inner_triangles = inner_triangle_count(p);
    TessVertex a, b, c;
    if (kTriangles == 0) {
        for (uint cell = lane; cell < inner_triangles / 2; cell += lanes) {
            uint corners[4];
            grid_cell(p, 1 + cell % (p.columns - 2), 1 + cell / (p.columns - 2), corners);
            write(triangle + 2 * cell, face, inner + corners[0], inner + corners[1], inner + corners[2]);
            write(triangle + 2 * cell + 1, face, inner + corners[0], inner + corners[2], inner + corners[3]);
        }
    } else {
        for (uint i = lane; i < inner_triangles; i += lanes) {
            inner_triangle(p, i, a, b, c);
            write(triangle + i, face, inner + a.i, inner + b.i, inner + c.i);
        }
    }
    triangle += inner_triangles;
    const bool hollow = is_hollow(p);
    [[unroll]] for (uint k = 0; k < 4; ++k) {
        if (kTriangles != 0 && k == 3) break;
        const uint n = p.segments[k], count = strip_triangle_count(p, k);
        for (uint i = lane; i < (hollow ? 0 : count); i += lanes) {
            strip_triangle(p, k, i, a, b, c);
            const bool outer = i < n;  // stands on the side, or on the inside
            const uint x = outer ? side_vertex(p, k, sides[k], a.i) : inner + a.i;
            const uint y = outer ? side_vertex(p, k, sides[k], b.i) : inner + b.i;
            const uint z = outer ? inner + c.i : side_vertex(p, k, sides[k], c.i);
            write(triangle + i, face, x, y, z);
        }
        for (uint i = lane; i < (hollow ? count : 0); i += lanes) {
            hollow_triangle(p, k, i, a, b, c);
            uint v[3];
            [[unroll]] for (uint corner = 0; corner < 3; ++corner) {
                TessVertex at = a;
                if (corner == 1) at = b;
                if (corner == 2) at = c;
                v[corner] = 0;
                [[unroll]] for (uint s = 0; s < 4; ++s)
                    if (at.side == s) v[corner] = side_vertex(p, s, sides[s], at.i);
            }
            write(triangle + i, face, v[0], v[1], v[2]);
        }
        triangle += count;
    }
}
