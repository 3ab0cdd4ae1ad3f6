// The neighbourhood of a vertex or face, cut out of a mesh and numbered so that equal ones are equal; and one step of a
// scheme from there to the neighbourhood of the child. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/index_map.h"
#include "limn/row.h"
#include "limn/schemes/split.h"

namespace limn {

/// SubdivisionScheme::patch_rings.
inline uint32_t patch_rings(const SubdivisionScheme& scheme) {
    return scheme.patch_rings != 0 ? scheme.patch_rings : scheme.rings + 1;
}

/// Where a walk begins: an element and, counted within its fan or face, a corner of it.
struct StarStart {
    Element element;
    uint32_t corner = 0;
};

/// Numbers the vertices around an element ring by ring, counter-clockwise: those of fewer rings come first, in the same
/// order. Ring 0 is the vertex, or the vertices of the face. Kept from walk to walk for its memory.
class StarWalk {
  public:
    /// Walks all faces that touch a vertex of a ring below `rings`.
    void walk(const Topology& t, StarStart start, uint32_t rings);
    /// The same, and all faces around vertices in which walked faces would meet at a point alone: the splits of schemes
    /// take manifolds.
    void walk_manifold(const Topology& t, StarStart start, uint32_t rings);

    std::vector<uint32_t> vertices;      ///< label -> vertex
    std::vector<uint32_t> ring_ends;     ///< labels below ring_ends[r] lie in rings 0 .. r
    std::vector<uint32_t> face_corners;  ///< the corner at which the walk entered each face; in its order

    uint32_t label(uint32_t vertex) const { return labels_.find(vertex); }

  private:
    void add_face(const Topology& t, uint32_t corner);

    bool is_pinched(const Topology& t, uint32_t v) const;

    IndexMap labels_, walked_faces_;
    std::vector<uint32_t> entries_;  // label -> the corner at which the vertex was found
};

/// A neighbourhood as a mesh of its own. Two of them refine alike where their keys agree.
struct StarPatch {
    Element element;         ///< vertex 0, or face 0
    uint32_t ring_size = 0;  ///< labels below it are the vertices of the element's own faces
    std::vector<uint32_t> ring_ends;
    std::vector<uint32_t> key;
    Stage stage;

    uint32_t size() const { return stage.topology.vertex_count; }
};

/// Where the walk around `element` begins, so that equal neighbourhoods have equal keys: boundary vertices at their
/// boundary, creased ones at a crease, others where the key is least. Fills `walk` from there.
StarStart canonical_start(const Stage& stage, Element element, uint32_t period, uint32_t rings, StarWalk& walk);

/// The key of the patch that `walk` has walked.
std::vector<uint32_t> patch_key(const Stage& stage, Element element, uint32_t period, uint32_t rings,
                                const StarWalk& walk);

/// The patch that `walk` has walked. Its own edges are boundaries, be they boundaries of the mesh or cuts.
StarPatch make_patch(const Stage& stage, Element element, uint32_t period, uint32_t rings, const StarWalk& walk);

/// canonical_start, walk and make_patch.
StarPatch extract_patch(const Stage& stage, Element element, uint32_t period, uint32_t rings);

/// What one step of a scheme makes of a patch.
struct PatchStep {
    StarPatch child;        ///< around the element's child, as many rings
    std::vector<Row> rows;  ///< of the child's vertices over the parent's
    bool exists = true;     ///< false: the element has no child
};
PatchStep refine_patch(const StarPatch& patch, const SubdivisionScheme& scheme, uint32_t rings);

/// The mesh after one step of a scheme, the rows of its points over those before, and what becomes of an element.
struct StageStep {
    Stage child;
    std::vector<Row> rows;
    Element element;
};
StageStep refine_stage(Stage&& stage, const SubdivisionScheme& scheme, Element element);

/// The vertices of a disk in the plane, counter-clockwise, without folds: its boundary on the unit circle, the others
/// between their neighbours. x and y of each vertex. As symmetric as the disk is.
std::vector<double> planar_layout(const Topology& disk);

}  // namespace limn
