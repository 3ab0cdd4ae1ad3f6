#include "limn/batch_copy.h"

#include "limn/topology.h"

namespace limn {

void copy_topology(const TessellationTable& from, const TessellationBatchMesh& at, uint32_t first_corner_copy,
                   uint32_t first_row_copy, TessellationTable& to) {
    // Flags are above what is counted, and what stands for nothing is above all.
    const auto moved = [](uint32_t word, uint32_t first) {
        return word == kInvalidIndex ? word : word + first;
    };
    const auto moved_face = [&](uint32_t face) {
        return face >= shared::kManyFaces ? face : face + at.ptex_faces.first;
    };
    const auto moved_edge = [&](uint32_t edge) {
        return edge < from.mesh_edge_count ? edge + at.mesh_edges.first
                                           : edge - from.mesh_edge_count + at.sub_face_edges.first;
    };
    uint32_t* word = to.faces.data() + size_t{at.ptex_faces.first} * shared::kTessFaceWords;
    for (size_t i = 0; i < from.faces.size(); ++i)
        *word++ = moved(from.faces[i], i % shared::kTessFaceWords < 4 ? at.rows.first : at.corners.first);
    word = to.rows.data() + size_t{at.rows.first} * shared::kTessRowWords;
    for (const uint32_t* row = from.rows.begin(); row != from.rows.end(); row += shared::kTessRowWords) {
        *word++ = moved_edge(row[0]);
        *word++ = moved_face(row[1]);
        *word++ = row[2];
        *word++ = moved(row[3], at.corners.first);
    }
    word = to.corners.data() + size_t{at.corners.first} * shared::kTessCornerWords;
    for (const uint32_t* corner = from.corners.begin(); corner != from.corners.end();
         corner += shared::kTessCornerWords) {
        *word++ = moved_face(corner[0]);
        *word++ = corner[1];
    }
    for (uint32_t e = 0; e < from.rate_edge_count; ++e) {
        const uint32_t* edge = from.rate_edges.data() + size_t{e} * shared::kRateEdgeWords;
        word = to.rate_edges.data() + size_t{moved_edge(e)} * shared::kRateEdgeWords;
        word[0] = moved(edge[0], at.rows.first);
        word[1] = moved_face(edge[1]);
        word[2] = moved_face(edge[2]);
    }
    for (size_t i = 0; i < from.corner_copies.size(); ++i)
        to.corner_copies[first_corner_copy + i] = from.corner_copies[i] + at.corners.first;
    for (size_t i = 0; i < from.row_copies.size(); ++i)
        to.row_copies[first_row_copy + i] = from.row_copies[i] + at.rows.first;
}

}  // namespace limn
