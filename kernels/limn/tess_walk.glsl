// All vertices of a domain (kMode), each once: corners one invocation each, rows and faces shared_item() by invocations that
// take turns. Before it: visit(vertex, face, u, v). Payload 4 and 5: vertices of the slice, first and end.

uint rate_of(uint edge) { return SETTLED(rates_at() + edge); }
#include "limn/tess_counts.glsl"

void main() {
    const uint item = shared_item(), lanes = lane_count();
    if (is_empty()) return;
    // The item's vertices [begin, end), and those of them within the slice.
    uint begin = item, end = item + 1, face = item, place = 0, rate = 0;
    TessPattern pattern;
    if (kMode == kTessCorners) {
        if (item >= params.corner_count) return;
        const uint at = params.table.corners + kTessCornerWords * item;
        face = WORD(at);
        place = WORD(at + 1);
        if (face == kNoFace) return;  // of a crowd: nobody's
    } else {
        if (item >= (kMode == kTessRows ? params.row_count : params.face_count)) return;
        const uint of_all = kMode == kTessRows ? item : params.row_count + item;
        begin = first_vertex(of_all);
        end = first_vertex(of_all + 1);
        if (begin == end) return;
        if (kMode == kTessRows) {
            const uvec4 words = row_words(item);
            rate = rate_of(words[0]);
            face = words[1];
            place = words[2];
        } else {
            pattern = pattern_of(face_sides(item));
        }
    }
    const uint first = max(begin, payload(4)), last = min(end, payload(5));
    uint vertex = first + lane_of_item();
    do {  // llvmpipe goes through a loop once more if its condition comes first
        float u, v;
        if (kMode == kTessCorners) {
            u = float(place & 3) * 0.5;
            v = float(place >> 2) * 0.5;
        } else if (kMode == kTessRows) {
            locate_on_row(place, point_on_side(rate, kFractional, vertex - begin + 1), u, v);
        } else {
            locate_inner_vertex(pattern, vertex - begin, u, v);
        }
        if (vertex < last) visit(vertex, face, u, v);
        vertex += lanes;
    } while (vertex < last);
}
