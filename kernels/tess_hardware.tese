// Hardware tessellation: the surface at a vertex. The tessellator's coordinates only tell which vertex it is: of the
// inside, or point i of a side. Where that lies is what the compute kernels say (tess_pattern.h), to the bit, so that
// faces that share a side, halves of one among them, evaluate the same place of the same ptex face. Spacing is limn's
// own: to the tessellator all of them are equal.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "limn/tess_hardware.glsl"
#include "limn/patch_tree.glsl"

// Clockwise where v grows downwards, as the tessellator has it: counter-clockwise in (u, v).
#ifdef LIMN_TRIANGLES
layout(triangles, equal_spacing, cw) in;
#else
layout(quads, equal_spacing, cw) in;
#endif
PATCH_LAYOUT(in)

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec2 place;
layout(location = 3) flat out uint ptex_face;
invariant gl_Position;

// A place of the surface.
struct Spot {
    uint face;
    float u, v;
};
Spot corner_spot(uint corner) {
    const uint at = params.table.corners + kTessCornerWords * corner, halves = WORD(at + 1);
    return Spot(WORD(at), float(halves & 3) * 0.5, float(halves >> 2) * 0.5);
}
Spot row_spot(uint row, float t) {
    Spot spot;
    spot.face = row_word(row, 1);
    locate_on_row(row_word(row, 2), t, spot.u, spot.v);
    return spot;
}

// What a vertex is: where it is on its face, where its normal is evaluated, and where its position.
struct Vertex {
    float u, v;
    Spot own, source;
};

// Nearer than that to a side is on it: the first row inside is at least 2 / 3 of a 64th away.
const float kOnSide = 1.0 / 256.0;

// Which side, and how far along it; kInside: none.
uint find_side(out float along) {
    const vec3 c = gl_TessCoord;
    uint side = kInside;
    along = 0;
    if (kTriangles != 0) {
        side = c.z < kOnSide ? 0 : c.x < kOnSide ? 1 : c.y < kOnSide ? 2 : kInside;
        along = side == 0 ? c.y : side == 1 ? c.z : c.x;
    } else {
        side = c.y < kOnSide ? 0 : c.x > 1 - kOnSide ? 1 : c.y > 1 - kOnSide ? 2 : c.x < kOnSide ? 3 : kInside;
        along = side == 0 ? c.x : side == 1 ? c.y : side == 2 ? 1 - c.x : 1 - c.y;
    }
    return side;
}

Vertex side_vertex(TessPattern p, uint k, float along) {
    const uint n = p.segments[k], i = uint(along * float(n) + 0.5), end = i == 0 ? k : (k + 1) % kSides;
    const uvec4 side = patch_sides[k];
    const bool halves = (side.x & kSideHalves) != 0;
    uint row;
    const uint point = point_of_row(side.x, n, i, row);
    const float t = point_on_side(side.y, p.fractional, point);
    Vertex vertex;
    float whole = halves ? 0.5 * t + (row != side_row(side.x) ? 0.5 : 0.0) : t;
    if ((side.x & kSideReversed) != 0) whole = 1 - whole;
    locate_on_side(kTriangles != 0, k, whole, vertex.u, vertex.v);
    if (i == 0 || i == n) {
        vertex.own = corner_spot(patch_corners[end]);
        vertex.source = corner_spot(corner_positions[end]);
    } else if (halves && 2 * i == n) {
        vertex.own = corner_spot(patch_middles[k]);
        vertex.source = corner_spot(side.w);
    } else {
        vertex.own = row_spot(row, t);
        vertex.source = row_spot(side.z + row - side_row(side.x), t);
    }
    return vertex;
}

// Inside, a level of 1 is 2 to the tessellator.
float inner_point(uint rate, uint n, bool fractional, float at) {
    return n < 2 ? at : point_on_side(rate, fractional, uint(at * float(n) + 0.5));
}

// Rings around the middle of a triangle.
void locate_on_ring(TessPattern p, out float u, out float v) {
    const vec3 c = gl_TessCoord;
    const uint n = p.columns, k = c.z <= min(c.x, c.y) ? 0 : c.x <= c.y ? 1 : 2;
    const float least = min(c.x, min(c.y, c.z));
    const uint ring = uint(least * 1.5 * float(n) + 0.5);
    u = 1.0 / 3.0;
    v = u;
    if (2 * ring >= n) return;
    const float even = 2.0 / 3.0 * float(ring) / float(n), along = k == 0 ? c.y : k == 1 ? c.z : c.x;
    const uint i = ring + uint((along - even) / (1 - 3 * even) * float(n - 2 * ring) + 0.5);
    locate_ring_point(p, ring, k, i, u, v);
}

Vertex inner_vertex(uint face, TessPattern p) {
    Vertex vertex;
    if (kTriangles != 0) {
        locate_on_ring(p, vertex.u, vertex.v);
    } else {
        vertex.u = inner_point(p.column_rate, p.columns, p.fractional, gl_TessCoord.x);
        vertex.v = inner_point(p.row_rate, p.rows, p.fractional, gl_TessCoord.y);
    }
    vertex.own = Spot(face, vertex.u, vertex.v);
    vertex.source = vertex.own;
    return vertex;
}

// One piece of code, whoever asks: what compilers make of two might differ in the last bit. After the position comes
// the normal where that lies elsewhere, and once more, further inside, where tangents span no plane (collapsed edges,
// cusps).
void evaluate(Vertex vertex) {
    const bool copied = vertex.own != vertex.source;
    const float middle = kTriangles != 0 ? 1.0 / 3.0 : 0.5;
    const uint steps = copied ? 3 : 2;
    Spot spot = vertex.source;
    [[dont_unroll]] for (uint step = 0; step < steps; ++step) {
        const Leaf leaf = find_leaf(params.tree, spot.face, spot.u, spot.v);
        vec4 points[16], value, du, dv;
        load_leaf(leaf, points);
        evaluate_leaf(leaf, points, value, du, dv);
        if (step == 0) position = value.xyz;
        normal = unit_normal(du.xyz, dv.xyz);
        const bool own = !copied || step > 0;
        if (own && spans_plane(du.xyz, dv.xyz)) break;
        spot = vertex.own;
        if (own) {
            spot.u = mix(spot.u, middle, 0.25);
            spot.v = mix(spot.v, middle, 0.25);
        }
    }
}

void main() {
    const TessPattern p = pattern_of(patch_sides[0].x, patch_sides[1].x, patch_sides[2].x, patch_sides[3].x,
                                     uvec4(patch_sides[0].y, patch_sides[1].y, patch_sides[2].y, patch_sides[3].y));
    float along;
    const uint side = find_side(along);
    ptex_face = patch_face;
    Vertex vertex;
    if (side == kInside)
        vertex = inner_vertex(ptex_face, p);
    else
        vertex = side_vertex(p, side, along);
    evaluate(vertex);
    place = vec2(vertex.u, vertex.v);
    vec4 clip = vec4(0);
    for (uint j = 0; j < 4; ++j) {
        const float x = j < 3 ? position[j] : 1.0;
        clip += x * vec4(params.clip_from_points[4 * j], params.clip_from_points[4 * j + 1],
                         params.clip_from_points[4 * j + 2], params.clip_from_points[4 * j + 3]);
    }
    gl_Position = clip;
}
