// Places of a patch tree: the leaf, and the surface there. Before it: WORD(i), WORD_GROUP(i), LOCAL(i), SECOND_LOCAL(i),
// kTriangles.

struct Leaf {
    uint kind;
    uint first_word;   // group of leaf_points
    uint first_local;  // local point of the surface
    uint level;
    PatchLocation at;
};

Leaf find_leaf(TreeOffsets tree, uint face, float u, float v) {
    Leaf leaf;
    leaf.at = make_location(u, v);
    leaf.level = 0;
    uint surface = WORD(tree.ptex_surfaces + face);
    if ((surface & kPtexSplit) != 0) {
        surface = (surface & ~kPtexSplit) + descend_location(leaf.at, kTriangles != 0);
        leaf.level = 1;
    }
    const uint at = tree.surfaces + 3 * surface, word = WORD(at);
    leaf.first_local = WORD(at + 1);
    rotate_location(leaf.at, surface_rotation(word), kTriangles != 0);
    uint node = WORD(tree.nodes + surface_plan(word));
    // A tree is never deeper than this; the bound only says that this ends.
    for (uint step = 0; step < 64 && node_kind(node) <= kNodeSplitV; ++step) {
        uint child;
        if (node_kind(node) == kNodeSplit) {
            child = descend_location(leaf.at, kTriangles != 0);
            ++leaf.level;
        } else {
            child = descend_location_half(leaf.at, node_kind(node) == kNodeSplitU);
        }
        node = WORD(tree.nodes + tree_first(node) + child);
        if (node_rotation(node) != 0) rotate_location(leaf.at, node_rotation(node), kTriangles != 0);
    }
    leaf.kind = node_kind(node);
    leaf.first_word = tree.leaf_points / 4 + tree_first(node) * (kLeafWords / 4);
    return leaf;
}

#define LOAD_LEAF(SOURCE)                                                                                      \
    const uvec4 low = WORD_GROUP(leaf.first_word), high = WORD_GROUP(leaf.first_word + 1);                     \
    [[unroll]] for (uint k = 0; k < 8; ++k) {                                                                  \
        const uint word = k < 4 ? low[k] : high[k - 4];                                                        \
        points[2 * k] = SOURCE(leaf.first_local + (word & 0xffffu));                                           \
        points[2 * k + 1] = SOURCE(leaf.first_local + (word >> 16));                                           \
    }
// From either of the two sources of local points that are bound.
void load_leaf(Leaf leaf, out vec4 points[16]) {
    LOAD_LEAF(LOCAL)
}
void load_second_leaf(Leaf leaf, out vec4 points[16]) {
    LOAD_LEAF(SECOND_LOCAL)
}

// Cubic B-splines or, of bilinear leaves, linear functions in the places of the first two.
void side_basis(uint kind, float t, out float f[4], out float d[4], out float dd[4]) {
    cubic_basis(t, f, d, dd);
    if (kind == kNodeBilinear) {
        f = float[4](1 - t, t, 0, 0);
        d = float[4](-1, 1, 0, 0);
        dd = float[4](0, 0, 0, 0);
    }
}

// Value, du, dv, duu, duv and dvv by the leaf's coordinates, relative to the first point. Not of corners. What a caller
// has no use for is left out by the compiler.
void sum_leaf(Leaf leaf, vec4 points[16], out vec4 sums[6]) {
    const vec4 origin = points[0];
    sums = vec4[6](vec4(0), vec4(0), vec4(0), vec4(0), vec4(0), vec4(0));
    if (kTriangles == 0) {
        float a[4], da[4], dda[4], b[4], db[4], ddb[4];
        side_basis(leaf.kind, leaf.at.u, a, da, dda);
        side_basis(leaf.kind, leaf.at.v, b, db, ddb);
        [[unroll]] for (uint j = 0; j < 4; ++j) {
            vec4 row = vec4(0), row_u = vec4(0), row_uu = vec4(0);
            [[unroll]] for (uint i = 0; i < 4; ++i) {
                const vec4 point = points[4 * j + i] - origin;
                row += a[i] * point;
                row_u += da[i] * point;
                row_uu += dda[i] * point;
            }
            sums[0] += b[j] * row;
            sums[1] += b[j] * row_u;
            sums[2] += db[j] * row;
            sums[3] += b[j] * row_uu;
            sums[4] += db[j] * row_u;
            sums[5] += ddb[j] * row;
        }
    } else {
        Jet basis[kMaxPatchPoints];
        if (leaf.kind == kNodeLinear)
            linear_basis(leaf.at.u, leaf.at.v, true, basis);
        else
            box_spline_basis(leaf.at.u, leaf.at.v, basis);
        const uint count = patch_point_count(leaf.kind);
        [[unroll]] for (uint k = 0; k < 12; ++k) {
            const vec4 point = k < count ? points[k] - origin : vec4(0);
            sums[0] += basis[k].f * point;
            sums[1] += basis[k].u * point;
            sums[2] += basis[k].v * point;
            sums[3] += basis[k].uu * point;
            sums[4] += basis[k].uv * point;
            sums[5] += basis[k].vv * point;
        }
    }
}

// Value, du and dv by the ptex face's coordinates. Of corners du and dv are tangents, whose lengths mean nothing.
void evaluate_leaf(Leaf leaf, vec4 points[16], out vec4 value, out vec4 du, out vec4 dv) {
    const vec4 origin = points[0];
    vec4 sums[6];
    sum_leaf(leaf, points, sums);
    value = sums[0] + origin;
    vec4 u = sums[1], v = sums[2];
    if (leaf.kind == kNodeCorner) {
        value = origin;
        u = points[1] - origin;
        v = points[2] - origin;
    }
    du = u * leaf.at.uu + v * leaf.at.vu;
    dv = u * leaf.at.uv + v * leaf.at.vv;
}

// More than rounding would make of tangents that span none.
bool spans_plane(vec3 du, vec3 dv) {
    const vec3 normal = cross(du, dv);
    const float longest = max(dot(du, du), dot(dv, dv));
    return dot(normal, normal) > 1e-10 * longest * longest;
}
vec3 unit_normal(vec3 du, vec3 dv) {
    const vec3 normal = cross(du, dv);
    return spans_plane(du, dv) ? normal * inversesqrt(dot(normal, normal)) : vec3(0, 0, 1);
}

vec3 tree_point(TreeOffsets tree, uint face, float u, float v) {
    const Leaf leaf = find_leaf(tree, face, u, v);
    vec4 points[16], value, du, dv;
    load_leaf(leaf, points);
    evaluate_leaf(leaf, points, value, du, dv);
    return value.xyz;
}
