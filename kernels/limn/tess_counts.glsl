// How many vertices and triangles an item has. Before it: rate_of(edge), the rate of a rate edge in fixed point.

uint segments_of(uint rate) { return segment_count(rate, kFractional); }

TessPattern pattern_of(uvec4 sides) {
    uvec4 rates = uvec4(0);
    [[unroll]] for (uint k = 0; k < (kTriangles != 0 ? 3 : 4); ++k) rates[k] = rate_of(row_edge(side_row(sides[k])));
    return make_face_pattern(kTriangles != 0, kSpacing, sides.x, sides.y, sides.z, sides.w, rates.x, rates.y, rates.z, rates.w);
}

bool is_drawn(uint face) { return SETTLED(drawn_at() + face) != 0; }

// Items are rows, then faces. Rows lie beside a face that is drawn, or have no vertices.
uvec2 count_item(uint item) {
    if (item < params.row_count) {
        const uint edge = row_edge(item), first = edge_word(edge, 1), second = edge_word(edge, 2);
        const uint rate = rate_of(edge);
        const bool live = first == kManyFaces || (first != kNoFace && is_drawn(min(first, params.face_count - 1))) ||
                          (second != kNoFace && is_drawn(min(second, params.face_count - 1)));
        return uvec2(live && rate != 0 ? segments_of(rate) - 1 : 0, 0);
    }
    const uint face = item - params.row_count;
    if (!is_drawn(face)) return uvec2(0);
    const TessPattern pattern = pattern_of(face_sides(face));
    return uvec2(inner_vertex_count(pattern), triangle_count(pattern));
}
