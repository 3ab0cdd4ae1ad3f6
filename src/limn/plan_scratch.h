// Memory that building one plan leaves to the next. Not part of the public interface.
#pragma once

#include <array>
#include <memory>

#include "limn/plan_rows.h"
#include "limn/refinement.h"

namespace limn {

/// The faces around the quad of a star, whose vertices are the points of its ring. Face 0 is the quad.
struct StarMesh {
    QuadStar star;  ///< that it is of, but for sharpness that makes no difference to rows
    Topology topology;
    RowCache rows;  ///< of its children
    // Faces beyond edges of the quad's corners 1 ("next") and 3 ("previous"): those at corner 2, and those across;
    // then the rest around corner 2.
    uint32_t side_next = 0, side_previous = 0, far_next = 0, far_previous = 0, rest = 0;

    StarMesh(const SchemeOptions& options, const QuadStar& from);
    /// Of another star with such faces, or the same one.
    void sharpen(const QuadStar& from);
    uint32_t child_count() const { return topology.vertex_count + topology.face_count + topology.edge_count; }
    /// The children of edge k of a face, of a star's edge, of a face.
    uint32_t edge_child(uint32_t face, uint32_t k) const {
        return child_of_edge(topology, topology.face_edges[4 * face + k]);
    }
    uint32_t star_edge_child(uint32_t i) const;
    uint32_t face_child(uint32_t face) const { return child_of_face(topology, face); }
    /// Which face lies in the star at `i`.
    uint32_t star_face(uint32_t i) const { return (i + star.face_count - star.own) % star.face_count; }
};

struct PlanScratch {
    /// What splitting one face needs, one for each depth.
    struct Level {
        Topology child, part;  ///< of the face and those around it; those around one of its children
        LazyRows rows;         ///< of `child`
        std::vector<uint32_t> vertices;  ///< of `child`, that those of `part` are
        VertexRows part_rows;
    };
    std::array<Level, 10> levels;
    PlanRows rows;
    LazyRows root;
    Neighborhood hood;
    LocalPatch patch;
    /// Of faces met around quads, the latest ones: plans have many in common.
    std::vector<std::unique_ptr<StarMesh>> stars;
    StarMesh& find_star_mesh(const SchemeOptions& options, const QuadStar& star);
    std::vector<double> row, lines, child_lines;
};

}  // namespace limn
